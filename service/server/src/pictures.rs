//! Pictures of kept worlds over plain GET, for pages and documents that name them by address.

use std::sync::Arc;

use axum::body::Body;
use axum::extract::{Path, State};
use axum::routing::get;
use axum::{Extension, Router};
use d3dgen_plugins::Plugin;
use http::{HeaderMap, HeaderValue, Response, StatusCode, header};
use tonic::Status;

use crate::access::{Caller, Scope};
use crate::core::Core;
use crate::grpc::domain::plugin;
use crate::methods::{Kind, Need};
use crate::pool::Lane;
use crate::{library, page, status};

/// Where kept worlds have their addresses.
const WORLDS: &str = "/worlds/";
/// What such a call needs.
const NEED: Need = Need { scope: Some(Scope::Read), kind: Kind::Work };

/// Returns what a path of a picture needs; none for another path.
pub fn need(path: &str) -> Option<Need> {
    path.starts_with(WORLDS).then_some(NEED)
}

/// Returns what answers the paths of pictures.
pub fn router() -> Router<Arc<Core>> {
    Router::new().route("/worlds/{id}/plan.svg", get(plan))
}

/// Returns the plan of a kept world, or only that it has not changed.
async fn plan(
    State(core): State<Arc<Core>>,
    Path(id): Path<String>,
    Extension(caller): Extension<Caller>,
    headers: HeaderMap,
) -> Response<Body> {
    let asked = Arc::clone(&core);
    let drawn = core.pool.run(Lane::Work, move |_| {
        let kept = library::get(&asked, &id, &caller)?;
        let etag = format!("\"{}\"", kept.etag());
        if page::lists(&headers, header::IF_NONE_MATCH, &etag) {
            return Ok((etag, None));
        }
        let world = library::state(&asked, &kept, kept.revision)?.world;
        let now = asked.domains.now();
        let plugin: &dyn Plugin = plugin(&now, "world.scene_graph.domain", &world.scene_graph.domain)?;
        Ok((etag, Some(d3dgen_export::exporters::plan::svg(&world, plugin.domain()))))
    });
    match drawn.await {
        Ok((etag, svg)) => picture(&etag, svg),
        Err(refused) => refusal(&refused),
    }
}

fn picture(etag: &str, svg: Option<String>) -> Response<Body> {
    let unchanged = svg.is_none();
    let mut response = Response::new(svg.map_or_else(Body::empty, Body::from));
    if unchanged {
        *response.status_mut() = StatusCode::NOT_MODIFIED;
    }
    let headers = response.headers_mut();
    headers.insert(header::CONTENT_TYPE, HeaderValue::from_static("image/svg+xml"));
    headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("private, no-cache"));
    headers.insert(header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff"));
    // opened by itself, a picture runs nothing and loads nothing
    let policy = HeaderValue::from_static("default-src 'none'; style-src 'unsafe-inline'");
    headers.insert(header::CONTENT_SECURITY_POLICY, policy);
    if let Ok(etag) = HeaderValue::from_str(etag) {
        headers.insert(header::ETAG, etag);
    }
    response
}

fn refusal(refused: &Status) -> Response<Body> {
    let mut response = Response::new(Body::from(format!("{}\n", refused.message())));
    *response.status_mut() = status::http(refused.code());
    response
}
