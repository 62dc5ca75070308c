//! The files of one asset.

use d3dgen_assets::annotation::{Annotation, Origin, asa};
use d3dgen_mesh::{Model3d, builds, writers};
use d3dgen_model::Document;
use tonic::Status;

use crate::core::Core;
use crate::domains::Snapshot;
use crate::status::{self, invalid};

/// Side of the pictures that are drawn when asked for, px.
const THUMBNAIL_PX: usize = 128;
/// Forms that an asset can be written in.
const FORMATS: [&str; 4] = ["usdz", "glb", "sdf", "json"];

/// Returns the files of an asset, by path.
///
/// # Errors
/// `NOT_FOUND`; `INVALID_ARGUMENT` for a format that is none; `FAILED_PRECONDITION` when its model is not kept.
pub(crate) fn of(core: &Core, asset_id: &str, formats: &[String]) -> Result<Vec<(String, Vec<u8>)>, Status> {
    if let Some(wrong) = formats.iter().find(|f| !FORMATS.contains(&f.as_str())) {
        return Err(invalid("formats", format!("`{wrong}` is no format; there are {}", FORMATS.join(", "))));
    }
    let now = core.domains.now();
    let shelf = super::shelf(core, &now.catalog)?;
    let mut annotation = shelf.get(asset_id).map_err(status::assets)?;
    let mut model = match core.databases.assets.model(asset_id).map_err(status::assets)? {
        Some(model) => model,
        None => made(&now, &annotation)?,
    };
    let (domain, name) = asset_id.split_once('/').unwrap_or(("Common", asset_id));
    model.name = name.to_owned();
    annotation.triangle_count = model.triangle_count() as u64;
    let folder = format!("{domain}/Object/{name}");
    let failed = |e: d3dgen_mesh::Error| Status::failed_precondition(format!("{asset_id} cannot be written: {e}"));
    let mut files = vec![(format!("{folder}/annotation.yaml"), asa::write(&annotation).into_bytes())];
    files.push((format!("{folder}/thumbnail.png"), picture(core, &model, asset_id)?));
    let wanted = |format: &str| formats.is_empty() || formats.iter().any(|f| f == format);
    if wanted("usdz") {
        files.push((format!("{folder}/{name}.usdz"), writers::usdz(&model).map_err(failed)?));
    }
    if wanted("glb") {
        files.push((format!("{folder}/{name}.glb"), writers::glb(&model).map_err(failed)?));
    }
    if wanted("sdf") {
        let parts = writers::sdf(&model).map_err(failed)?;
        files.extend(parts.into_iter().map(|f| (format!("{folder}/{name}.sdf/{}", f.name), f.bytes)));
    }
    if wanted("json") {
        files.push((format!("{folder}/{name}.json"), annotation.to_json().into_bytes()));
    }
    Ok(files)
}

/// Returns the thumbnail of an asset by its id, as [`thumbnail`] does.
///
/// # Errors
/// `NOT_FOUND`, and what the database refuses.
pub(crate) fn thumbnail_of(core: &Core, asset_id: &str) -> Result<Vec<u8>, Status> {
    let now = core.domains.now();
    let asset = super::shelf(core, &now.catalog)?.get(asset_id).map_err(status::assets)?;
    thumbnail(core, &now, &asset)
}

/// Returns the thumbnail of an asset, PNG: the one kept with it, or one drawn now; empty when its model is not kept.
///
/// # Errors
/// What the database refuses.
pub(super) fn thumbnail(core: &Core, now: &Snapshot, annotation: &Annotation) -> Result<Vec<u8>, Status> {
    let id = &annotation.asset_id;
    if let Some(kept) = core.databases.assets.thumbnail(id).map_err(status::assets)? {
        return Ok(kept);
    }
    match made(now, annotation) {
        Ok(model) => picture(core, &model, id),
        Err(_) => Ok(Vec::new()),
    }
}

fn picture(core: &Core, model: &Model3d, asset_id: &str) -> Result<Vec<u8>, Status> {
    if let Some(kept) = core.databases.assets.thumbnail(asset_id).map_err(status::assets)? {
        return Ok(kept);
    }
    d3dgen_mesh::picture::thumbnail(model, THUMBNAIL_PX).png().map_err(|e| status::internal(&e))
}

/// Makes the model of an asset that has no file.
fn made(now: &Snapshot, annotation: &Annotation) -> Result<Model3d, Status> {
    let (domain, object, seed) = match &annotation.origin {
        Origin::Generated { domain, object, seed } => (domain, object, *seed),
        Origin::Library { domain, object } => (domain, object, 0),
        Origin::Ingested { .. } => {
            return Err(Status::failed_precondition("the model is not kept any more: ingest it again"));
        }
    };
    generate(now, domain, object, annotation.width_depth_height(), seed)
}

/// Makes a model of an object.
///
/// # Errors
/// `NOT_FOUND`; `INVALID_ARGUMENT` when it cannot be made at this size.
pub(super) fn generate(
    now: &Snapshot,
    domain: &str,
    object: &str,
    size_m: [f64; 3],
    seed: u64,
) -> Result<Model3d, Status> {
    let plugin = now.registry.get(domain).ok_or_else(|| Status::not_found(format!("there is no domain `{domain}`")))?;
    let domain = plugin.domain();
    let object_type = domain.objects.iter().find(|o| o.id == object);
    let object_type =
        object_type.ok_or_else(|| Status::not_found(format!("domain {} has no object `{object}`", domain.id)))?;
    let library = builds::Library::shipped().with(&domain.builds);
    builds::generate(&library, object_type, size_m, seed).map_err(|e| invalid("size_m", e.to_string()))
}
