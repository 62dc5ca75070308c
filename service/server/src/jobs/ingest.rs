//! An ingest: a folder of models, uploaded or of the server's machine, into the database of assets.

use std::collections::BTreeMap;
use std::path::PathBuf;

use d3dgen_assets::database::Provenance;
use d3dgen_assets::ingest::{Options, Outcome, Summary, ingest};
use d3dgen_assets::readers::Pool;
use serde::{Deserialize, Serialize};
use tonic::Status;

use super::{Level, Run};
use crate::status;

/// A folder to ingest.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Ingest {
    /// A folder of the server's machine; none for files that were uploaded.
    pub folder: Option<PathBuf>,
    /// Name of an uploaded folder, which begins the paths of annotations.
    pub name: String,
    /// Domain under which assets are kept when nothing else tells.
    pub domain: Option<String>,
    /// Why, for the history.
    pub why: String,
    /// Files of an upload that were left out for their names, with the reason.
    #[serde(default)]
    pub refused: BTreeMap<String, String>,
}

/// Lines about refused files at most.
const REFUSED: usize = 200;

/// Ingests what is not there yet: what an earlier run kept is passed over.
///
/// # Errors
/// `CANCELLED`; `FAILED_PRECONDITION` when the folder cannot be read any more.
pub(super) fn run(run: &Run, spec: &Ingest) -> Result<serde_json::Value, Status> {
    let core = &run.core;
    let upload = core.upload_dir(&run.job.id);
    let folder = spec.folder.clone().unwrap_or_else(|| upload.join(&spec.name));
    if !folder.exists() {
        return Err(Status::failed_precondition("the folder is not there any more"));
    }
    let Some(program) = core.programs.models.clone() else {
        return Err(Status::unimplemented("this server was started without a program that reads models"));
    };
    run.step("read", 0.0, "looking for models");
    let progress = |done: usize, total: usize, path: &str| {
        let fraction = done as f64 / total.max(1) as f64 * 0.95;
        run.step("read", fraction, &format!("{done} of {total}: {path}"));
    };
    let by = Provenance { who: run.job.owner.clone(), when: core.clock.text(), why: spec.why.clone() };
    let options = Options {
        domain: spec.domain.as_deref(),
        by: &by,
        workers: core.config.limits.threads.min(8),
        progress: &progress,
        cancelled: &|| run.check().is_err(),
    };
    let pool = Pool::new(program, core.config.limits.threads.min(8));
    let catalog = core.domains.now().catalog.clone();
    // Others change assets between the batches of this one: each is whole.
    let mut summary = ingest(&core.databases.assets, &folder, &catalog, &pool, &options).map_err(status::assets)?;
    let named = |(path, reason): (&String, &String)| (path.clone(), Outcome::Refused { reason: reason.clone() });
    summary.files.extend(spec.refused.iter().map(named));
    for (path, reason) in summary.refused().take(REFUSED) {
        run.log(Level::Warning, &format!("refused {path}: {reason}"));
    }
    run.checkpoint(&summary, |_| ())?;
    {
        let _alone = core.writing();
        core.changed_assets(&summary.changed())?;
    }
    if summary.cancelled {
        return Err(Status::cancelled("stopped"));
    }
    super::run::remove_dir(&upload);
    serde_json::to_value(&summary).map_err(|e| status::internal(&e))
}

/// Returns what became of a file as words: outcome, asset, reason.
pub fn words(outcome: &Outcome) -> (&'static str, Option<&str>, Option<&str>) {
    match outcome {
        Outcome::Added { asset_id } => ("added", Some(asset_id), None),
        Outcome::Updated { asset_id } => ("updated", Some(asset_id), None),
        Outcome::Unchanged { asset_id } => ("unchanged", Some(asset_id), None),
        Outcome::Refused { reason } => ("refused", None, Some(reason)),
    }
}

/// Returns what a job has ingested so far.
pub fn summary(value: &serde_json::Value) -> Option<Summary> {
    serde_json::from_value(value.clone()).ok()
}
