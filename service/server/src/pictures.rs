//! Pictures and models of kept worlds and of assets over plain GET, for pages and documents that name them by address.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use axum::body::Body;
use axum::extract::{Path, State};
use axum::routing::get;
use axum::{Extension, Router};
use d3dgen_model::world::World;
use d3dgen_plugins::Plugin;
use http::{HeaderMap, HeaderValue, Response, StatusCode, header};
use sha2::{Digest, Sha256};
use tonic::Status;

use crate::access::{Caller, Scope, hex};
use crate::core::Core;
use crate::grpc::asset::files;
use crate::grpc::domain::plugin;
use crate::grpc::world::export;
use crate::methods::{Kind, Need};
use crate::pool::Lane;
use crate::{library, names, page, status};

/// Where kept worlds, and where assets have their addresses.
const PLACES: [&str; 2] = ["/worlds/", "/models/"];
/// What such a call needs.
const NEED: Need = Need { scope: Some(Scope::Read), kind: Kind::Work };
const SVG: &str = "image/svg+xml";
const PNG: &str = "image/png";
const GLB: &str = "model/gltf-binary";

/// Returns what a path of a picture needs; none for another path.
pub fn need(path: &str) -> Option<Need> {
    PLACES.iter().any(|place| path.starts_with(place)).then_some(NEED)
}

/// Returns what answers the paths of pictures and models.
pub fn router() -> Router<Arc<Core>> {
    Router::new()
        .route("/worlds/{id}/plan.svg", get(plan))
        .route("/worlds/{id}/world.glb", get(world_model))
        .route("/models/{domain}/{name}/thumbnail.png", get(thumbnail))
        .route("/models/{domain}/{name}/model.glb", get(model))
}

/// Who asks for what, and the state that it knows.
type Asked = (State<Arc<Core>>, Extension<Caller>, HeaderMap);

/// Answers with the plan of a kept world.
async fn plan(
    Path(id): Path<String>,
    core: State<Arc<Core>>,
    who: Extension<Caller>,
    known: HeaderMap,
) -> Response<Body> {
    of_world(id, (core, who, known), SVG, |core, world, _| {
        let now = core.domains.now();
        let plugin: &dyn Plugin = plugin(&now, "world.scene_graph.domain", &world.scene_graph.domain)?;
        Ok(d3dgen_export::exporters::plan::svg(world, plugin.domain()).into_bytes())
    })
    .await
}

/// Answers with a kept world in three dimensions.
async fn world_model(
    Path(id): Path<String>,
    core: State<Arc<Core>>,
    who: Extension<Caller>,
    known: HeaderMap,
) -> Response<Body> {
    of_world(id, (core, who, known), GLB, |core, world, stop| glb(export::files(core, world, &["gltf".into()], stop)?))
        .await
}

/// Answers with what is made of a kept world, or only that it has not changed.
async fn of_world(
    id: String,
    (State(core), Extension(caller), known): Asked,
    kind: &'static str,
    make: fn(&Core, &World, &AtomicBool) -> Result<Vec<u8>, Status>,
) -> Response<Body> {
    let asked = Arc::clone(&core);
    let made = core.pool.run(Lane::Work, move |stop| {
        let kept = library::get(&asked, &id, &caller)?;
        let etag = format!("\"{}\"", kept.etag());
        if page::lists(&known, header::IF_NONE_MATCH, &etag) {
            return Ok((etag, None));
        }
        let world = library::state(&asked, &kept, kept.revision)?.world;
        Ok((etag, Some(make(&asked, &world, stop)?)))
    });
    answer(made.await, kind)
}

/// Answers with the picture of an asset.
async fn thumbnail(Path(id): Path<(String, String)>, core: State<Arc<Core>>, known: HeaderMap) -> Response<Body> {
    of_asset(id, core, known, PNG, files::thumbnail_of).await
}

/// Answers with the model of an asset.
async fn model(Path(id): Path<(String, String)>, core: State<Arc<Core>>, known: HeaderMap) -> Response<Body> {
    of_asset(id, core, known, GLB, |core, id| glb(files::of(core, id, &["glb".into()])?)).await
}

/// Answers with what is made of an asset, or only that it has not changed.
async fn of_asset(
    (domain, name): (String, String),
    State(core): State<Arc<Core>>,
    known: HeaderMap,
    kind: &'static str,
    make: fn(&Core, &str) -> Result<Vec<u8>, Status>,
) -> Response<Body> {
    let asked = Arc::clone(&core);
    let made = core.pool.run(Lane::Work, move |_| {
        let id = format!("{domain}/{name}");
        let bytes = make(&asked, names::reference("asset_id", &id)?)?;
        if bytes.is_empty() {
            return Err(Status::not_found(format!("the model of `{id}` is not kept")));
        }
        let etag = format!("\"{}\"", hex(&Sha256::digest(&bytes)[..16]));
        let is_known = page::lists(&known, header::IF_NONE_MATCH, &etag);
        Ok((etag, (!is_known).then_some(bytes)))
    });
    answer(made.await, kind)
}

/// Returns the model among the files of a format.
fn glb(files: Vec<(String, Vec<u8>)>) -> Result<Vec<u8>, Status> {
    let found = files.into_iter().find(|(path, _)| path.ends_with(".glb"));
    found.map(|(_, bytes)| bytes).ok_or_else(|| status::internal(&"a format has no model"))
}

fn answer(made: Result<(String, Option<Vec<u8>>), Status>, kind: &'static str) -> Response<Body> {
    let (etag, bytes) = match made {
        Ok(made) => made,
        Err(refused) => return refusal(&refused),
    };
    let unchanged = bytes.is_none();
    let mut response = Response::new(bytes.map_or_else(Body::empty, Body::from));
    if unchanged {
        *response.status_mut() = StatusCode::NOT_MODIFIED;
    }
    let headers = response.headers_mut();
    headers.insert(header::CONTENT_TYPE, HeaderValue::from_static(kind));
    headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("private, no-cache"));
    headers.insert(header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff"));
    // opened by itself, a picture runs nothing and loads nothing
    let policy = HeaderValue::from_static("default-src 'none'; style-src 'unsafe-inline'");
    headers.insert(header::CONTENT_SECURITY_POLICY, policy);
    if let Ok(etag) = HeaderValue::from_str(&etag) {
        headers.insert(header::ETAG, etag);
    }
    response
}

fn refusal(refused: &Status) -> Response<Body> {
    let mut response = Response::new(Body::from(format!("{}\n", refused.message())));
    *response.status_mut() = status::http(refused.code());
    response
}
