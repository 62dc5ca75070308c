//! How far a data set is, for everybody who looks at its folder: the command, a server, the page.
//!
//! The ledger says what is done. How fast it goes only the run knows, for it has a clock: it leaves a note beside the ledger. A run
//! is there while somebody holds the part's lock; who wants it to stop leaves a wish there, which it looks at between blocks.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::assemble::is_finished;
use crate::error::Error;
use crate::pack::write_whole;
use crate::part::{Part, SPEC};
use crate::row::Failure;
use crate::shelf::{failures, failures_of, tars};
use crate::spec::Spec;
use crate::tasks::Tasks;

/// Folder in that of a data set where it is made.
pub const WORK: &str = ".part";
const PACE: &str = "pace.json";
const STOP: &str = "stop";

/// What a data set is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Doing {
    /// A run adds to it.
    Running,
    /// No run adds to it, and something is missing.
    Stopped,
    /// Nothing is missing.
    Finished,
}

/// How fast a run goes.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pace {
    /// Tasks done in a second since the run began.
    pub per_second: f64,
    /// Seconds until the last task is done, at that pace.
    pub seconds_left: f64,
}

impl Pace {
    /// Returns the pace of a run that has done some tasks in some seconds and has others left; none before the first is done.
    pub fn of(done: u64, seconds: f64, left: u64) -> Option<Self> {
        let per_second = done as f64 / seconds.max(1e-3);
        (done > 0).then(|| Self { per_second, seconds_left: left as f64 / per_second })
    }
}

/// How far a data set is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Standing {
    /// Its name.
    pub name: String,
    /// What it is doing.
    pub doing: Doing,
    /// Whether nothing is missing.
    pub finished: bool,
    /// Tasks that it has, or that its shard has.
    pub tasks: u64,
    /// Worlds that are there.
    pub worlds: u64,
    /// Tasks that came to none.
    pub failed: u64,
    /// Bytes on the disk.
    pub bytes: u64,
    /// How fast it goes, while it does.
    #[serde(flatten)]
    pub pace: Option<Pace>,
}

impl Standing {
    /// Returns how many tasks are done.
    pub fn done(&self) -> u64 {
        self.worlds + self.failed
    }

    /// Looks at the folder of a data set, finished or not, or of a shard.
    ///
    /// # Errors
    /// `Read`, `Spec`, `Damaged` for a folder that is none.
    pub fn of(folder: &Path) -> Result<Self, Error> {
        if is_finished(folder) { Self::of_finished(folder) } else { Self::of_part(&Part::open(&part_of(folder))?) }
    }

    fn of_finished(folder: &Path) -> Result<Self, Error> {
        let path = folder.join(SPEC);
        let text = fs::read_to_string(&path).map_err(Error::read(&path))?;
        let spec = Spec::from_toml(&text, &path.display().to_string())?;
        let tasks = Tasks::of(&spec).map_err(Error::Input)?.len();
        let failed = failures(folder)?.len() as u64;
        let bytes = tars(folder)?.iter().filter_map(|p| p.metadata().ok()).map(|m| m.len()).sum();
        let worlds = tasks.saturating_sub(failed);
        Ok(Self { name: spec.name, doing: Doing::Finished, finished: true, tasks, worlds, failed, bytes, pace: None })
    }

    fn of_part(part: &Part) -> Result<Self, Error> {
        let running = part.is_held()?;
        let done = part.done();
        let sum = |of: fn(&crate::part::Done) -> u64| done.iter().map(of).sum();
        Ok(Self {
            name: part.spec.name.clone(),
            doing: if running { Doing::Running } else { Doing::Stopped },
            finished: false,
            tasks: part.own_tasks(),
            worlds: sum(|d| d.worlds),
            failed: sum(|d| d.failed),
            bytes: sum(|d| d.bytes),
            pace: running.then(|| pace(part.folder())).flatten(),
        })
    }
}

/// Returns the tasks of a data set, finished or not, that came to no world so far; the first `most` of them.
///
/// # Errors
/// As [`Standing::of`].
pub fn failed(folder: &Path, most: usize) -> Result<Vec<Failure>, Error> {
    if !is_finished(folder) {
        return failures_of(&Part::open(&part_of(folder))?, most);
    }
    let mut all = failures(folder)?;
    all.truncate(most);
    Ok(all)
}

/// Returns true for the folder of a data set, finished or not, or of a shard.
pub fn is_data_set(folder: &Path) -> bool {
    is_finished(folder) || Part::is_at(&part_of(folder))
}

/// Has the run that adds to a data set stop after the blocks in hand; what is done is kept.
///
/// # Errors
/// `Write`.
pub fn stop(folder: &Path) -> Result<(), Error> {
    write_whole(&part_of(folder).join(STOP), |_| Ok(()))
}

/// Returns true when somebody wants the run to stop.
pub fn is_to_stop(part: &Part) -> bool {
    part.folder().join(STOP).exists()
}

/// Forgets an earlier wish to stop, and how fast an earlier run went.
pub(crate) fn begin(part: &Path) {
    for name in [STOP, PACE] {
        let _ = fs::remove_file(part.join(name)); // most often it is not there
    }
}

/// Leaves a note how fast the run goes.
///
/// # Errors
/// `Write`, `Full`.
pub fn tell(part: &Part, pace: &Pace) -> Result<(), Error> {
    let text = serde_json::to_vec(pace).expect("it has string keys only");
    write_whole(&part.folder().join(PACE), |file| file.write_all(&text))
}

fn pace(part: &Path) -> Option<Pace> {
    serde_json::from_slice(&fs::read(part.join(PACE)).ok()?).ok()
}

fn part_of(folder: &Path) -> PathBuf {
    let work = folder.join(WORK);
    if Part::is_at(&work) { work } else { folder.to_path_buf() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::part::Shard;
    use crate::snapshot::Snapshot;

    #[test]
    fn a_run_is_seen_with_its_pace_and_can_be_asked_to_stop() {
        let folder = tempfile::tempdir().unwrap();
        let (home, work) = (folder.path(), folder.path().join(WORK));
        assert!(!is_data_set(home));
        let snapshot = Snapshot::take(&d3dgen_plugins::Registry::builtin()).unwrap();
        let spec = "name = \"x\"\nseeds = 8\nprompts = [{ text = \"flat\" }]\n";
        let part = Part::begin(&work, spec, &snapshot, Shard::WHOLE, 2).unwrap();
        part.keep(1, b"a block", 1).unwrap();
        tell(&part, &Pace::of(2, 4.0, 6).unwrap()).unwrap();
        let seen = Standing::of(home).unwrap();
        assert_eq!((seen.doing, seen.tasks, seen.done(), seen.failed), (Doing::Running, 8, 2, 1));
        assert_eq!(seen.pace, Some(Pace { per_second: 0.5, seconds_left: 12.0 }));
        assert!(!is_to_stop(&part));
        stop(home).unwrap();
        assert!(is_to_stop(&part));
        drop(part);
        let seen = Standing::of(home).unwrap();
        assert_eq!((seen.doing, seen.pace), (Doing::Stopped, None));
        let again = Part::begin(&work, spec, &snapshot, Shard::WHOLE, 2).unwrap();
        assert!(!is_to_stop(&again) && is_data_set(home));
        assert_eq!(Pace::of(0, 1.0, 8), None);
    }
}
