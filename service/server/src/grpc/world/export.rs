//! Worlds and assets as archives.

use std::sync::atomic::AtomicBool;

use d3dgen_assets::annotation::asa;
use d3dgen_export::manifest::Manifest;
use d3dgen_export::models::{KeptModel, KeptModels};
use d3dgen_export::{Subject, exporters};
use d3dgen_model::world::World;
use d3dgen_plugins::Plugin;
use tonic::Status;

use super::go_on;
use crate::core::Core;
use crate::grpc::domain::plugin;
use crate::grpc::zip;
use crate::names;
use crate::status::{self, invalid};

/// The models of the database, for the files of worlds.
struct Kept<'a>(&'a Core);

impl KeptModels for Kept<'_> {
    fn model(&self, asset_id: &str) -> Result<Option<KeptModel>, d3dgen_export::Error> {
        let kept = self.0.databases.assets.placed_model(asset_id);
        let kept =
            kept.map_err(|e| d3dgen_export::Error::Kept { asset: asset_id.to_owned(), reason: e.to_string() })?;
        Ok(kept.map(|(model, annotation)| {
            let tags = asa::tags(&annotation);
            KeptModel { model, tags, description: annotation.description }
        }))
    }
}

/// Returns the files of a world, by path.
///
/// # Errors
/// `INVALID_ARGUMENT` for a format that is none, and for names in the world that lead out of its folder.
pub(super) fn files(
    core: &Core,
    world: &World,
    formats: &[String],
    stop: &AtomicBool,
) -> Result<Vec<(String, Vec<u8>)>, Status> {
    for (i, placement) in world.placements.placements.iter().enumerate() {
        names::reference(&format!("world.placements.placements[{i}].asset_id"), &placement.asset)?;
    }
    let now = core.domains.now();
    let plugin: &dyn Plugin = plugin(&now, "world.scene_graph.domain", &world.scene_graph.domain)?;
    let exporters = match formats {
        [] => exporters::usual().collect(),
        names => exporters::named(names.iter().map(String::as_str)).map_err(|e| invalid("formats", e.to_string()))?,
    };
    let mut files = std::collections::BTreeMap::new();
    let kept = Kept(core);
    let subject = Subject::new(world, plugin.domain(), &kept);
    let mut manifest = Manifest::of(&subject).map_err(status::export)?;
    for exporter in exporters {
        go_on(stop)?;
        let made = exporter.export(&subject).map_err(status::export)?;
        manifest.add(exporter, &made);
        files.extend(made.into_iter().map(|f| (f.path, f.bytes)));
    }
    let manifest = manifest.file(None);
    files.insert(manifest.path, manifest.bytes);
    for path in files.keys() {
        names::upload_path("world", path)?;
    }
    Ok(files.into_iter().collect())
}

/// An archive on its way to a client, made whole: what is not taken yet lies in memory, and no thread waits for it.
pub(in crate::grpc) type Pieces<T> = tokio_stream::Iter<std::vec::IntoIter<Result<T, Status>>>;

/// Returns files as the pieces of an archive.
///
/// # Errors
/// `CANCELLED` once nobody waits for it; `INTERNAL`.
pub(in crate::grpc) fn archive<T>(
    files: Vec<(String, Vec<u8>)>,
    stop: &AtomicBool,
    piece: impl Fn(Vec<u8>) -> T,
) -> Result<Pieces<T>, Status> {
    let mut pieces = Vec::new();
    zip::write(files, |bytes| {
        pieces.push(Ok(piece(bytes)));
        !stop.load(std::sync::atomic::Ordering::SeqCst)
    })?;
    Ok(tokio_stream::iter(pieces))
}
