//! Worlds, batches of them, and assets as archives.

use std::collections::BTreeSet;
use std::sync::atomic::AtomicBool;

use d3dgen_assets::annotation::asa;
use d3dgen_export::manifest::Manifest;
use d3dgen_export::models::{KeptModel, KeptModels};
use d3dgen_export::{Subject, exporters};
use d3dgen_model::Document;
use d3dgen_model::report::Report;
use d3dgen_model::world::World;
use d3dgen_plugins::Plugin;
use d3dgen_proto::v1::{ExportBatchRequest, ExportBatchResponse};
use tonic::Status;

use super::go_on;
use crate::core::Core;
use crate::grpc::domain::plugin;
use crate::grpc::zip;
use crate::status::{self, invalid, reason};
use crate::{jobs, names};

/// Bytes of an archive of a batch at most: it lies in memory until it is taken.
const LARGEST: usize = 512 << 20;

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
pub(crate) fn files(
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

/// Refuses a world that no simulator can use; `which` names it.
///
/// # Errors
/// `FAILED_PRECONDITION` with the first hard rule that it breaks.
pub(super) fn refuse_unsound(report: &Report, which: &str) -> Result<(), Status> {
    if report.is_writable() {
        return Ok(());
    }
    let broken = report.rules.iter().find(|r| r.violations.iter().any(|v| !v.given));
    let first = broken.map_or("a hard rule", |r| r.rule.as_str());
    let refused = Status::failed_precondition(format!("{which} is not sound: it breaks {first}"));
    Err(status::because_of(reason::UNSOUND, &[("rule", first)], &refused))
}

/// Returns worlds of a batch as the pieces of one archive, each in a folder of its own; one world at a time is in memory.
///
/// # Errors
/// `NOT_FOUND` for a seed that the batch has no world of, `FAILED_PRECONDITION` where a world is not sound or there is
/// none, `RESOURCE_EXHAUSTED` where the archive would be too large, and as [`files`].
pub(super) fn batch(
    core: &Core,
    job_id: &str,
    asked: &ExportBatchRequest,
    stop: &AtomicBool,
) -> Result<Pieces<ExportBatchResponse>, Status> {
    let seeds = match asked.seeds.as_slice() {
        [] => sound_seeds(core, job_id)?,
        seeds => seeds.iter().copied().collect(),
    };
    if seeds.is_empty() {
        return Err(Status::failed_precondition("the batch has no sound world yet"));
    }
    let world = |seed: u64| -> Result<Vec<(String, Vec<u8>)>, Status> {
        let (world, report) = jobs::batch::read(&core.job_dir(job_id), seed)?;
        refuse_unsound(&report, &format!("the world of seed {seed}"))?;
        let mut all = files(core, &world, &asked.formats, stop)?;
        all.push(("report.json".into(), report.to_json().into_bytes()));
        all.push(("world.json".into(), world.to_json().into_bytes()));
        Ok(all.into_iter().map(|(path, bytes)| (format!("world-{seed}/{path}"), bytes)).collect())
    };
    let mut refused = None;
    let all = seeds.into_iter().map_while(|seed| world(seed).map_err(|e| refused = Some(e)).ok()).flatten();
    let (mut pieces, mut bytes, mut is_full) = (Vec::new(), 0, false);
    let written = zip::write(all, |chunk| {
        bytes += chunk.len();
        is_full = bytes > LARGEST;
        pieces.push(Ok(ExportBatchResponse { chunk }));
        !is_full && !stop.load(std::sync::atomic::Ordering::SeqCst)
    });
    if is_full {
        let most = LARGEST >> 20;
        return Err(Status::resource_exhausted(format!(
            "the archive is larger than {most} MiB; name fewer seeds at a time"
        )));
    }
    match refused {
        Some(refused) => Err(refused),
        None => written.map(|()| tokio_stream::iter(pieces)),
    }
}

/// Returns the seeds of a batch's sound worlds.
fn sound_seeds(core: &Core, job_id: &str) -> Result<BTreeSet<u64>, Status> {
    let all = jobs::batch::list(&core.databases.own, job_id, None, usize::MAX).map_err(status::own)?;
    Ok(all.into_iter().filter(|made| made.sound).map(|made| made.seed).collect())
}

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
