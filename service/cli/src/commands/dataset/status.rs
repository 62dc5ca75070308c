//! `d3dgen dataset status`: how far a data set is.

use std::path::PathBuf;

use d3dgen_dataset::assemble::is_finished;
use d3dgen_dataset::part::{Part, SPEC};
use d3dgen_dataset::shelf::failures;
use d3dgen_dataset::spec::Spec;
use d3dgen_dataset::tasks::Tasks;
use serde_json::json;

use super::{WORK, disk};
use crate::error::Error;
use crate::input::{text, write_text};

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// Folder of a data set, finished or not, or of a shard
    folder: PathBuf,
    /// Print one JSON line
    #[arg(long)]
    json: bool,
}

/// What is said of a data set.
struct Standing {
    tasks: u64,
    worlds: u64,
    failed: u64,
    bytes: u64,
    finished: bool,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let standing = if is_finished(&self.folder) { self.finished()? } else { self.unfinished()? };
        let Standing { tasks, worlds, failed, bytes, finished } = standing;
        if self.json {
            let line =
                json!({ "tasks": tasks, "worlds": worlds, "failed": failed, "bytes": bytes, "finished": finished });
            return write_text(None, &format!("{line}\n"));
        }
        let state = if finished { "finished" } else { "in the making" };
        eprintln!(
            "{state}: {} of {tasks} tasks done, {worlds} worlds, {failed} without one, {}",
            worlds + failed,
            disk::size(bytes)
        );
        Ok(())
    }

    fn finished(&self) -> Result<Standing, Error> {
        let (path, spec) = text(&self.folder.join(SPEC), SPEC)?;
        let spec = Spec::from_toml(&spec, &path.display().to_string())?;
        let tasks = Tasks::of(&spec).map_err(Error::Input)?.len();
        let failed = failures(&self.folder)?.len() as u64;
        let shards = d3dgen_dataset::shelf::tars(&self.folder)?;
        let bytes = shards.iter().filter_map(|p| p.metadata().ok()).map(|m| m.len()).sum();
        Ok(Standing { tasks, worlds: tasks - failed.min(tasks), failed, bytes, finished: true })
    }

    fn unfinished(&self) -> Result<Standing, Error> {
        let work = self.folder.join(WORK);
        let part = Part::open(if Part::is_at(&work) { &work } else { &self.folder })?;
        let (mut worlds, mut failed, mut bytes) = (0, 0, 0);
        for done in part.done() {
            worlds += done.worlds;
            failed += done.failed;
            bytes += done.bytes;
        }
        let tasks = part.own_blocks().map(|b| part.tasks_of(b).count() as u64).sum();
        Ok(Standing { tasks, worlds, failed, bytes, finished: false })
    }
}
