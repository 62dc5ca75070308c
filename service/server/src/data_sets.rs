//! Data sets in the making, and those that are made, in the folders that the configuration names: somebody else makes them, with
//! `d3dgen dataset make` or with workers over a queue; here one sees how far they are, and has them stopped.

use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

use d3dgen_dataset::part::SPEC;
use d3dgen_dataset::row::Failure;
use d3dgen_dataset::standing::{self, Standing};
use d3dgen_dataset::{Error, standing::is_data_set};
use tonic::Status;

use crate::status;

/// What the ids of data sets begin with, among those of jobs.
const PREFIX: &str = "data_set/";

/// A data set in one of the folders.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Found {
    /// Its id among the jobs: the number of the folder that it is in, and its own folder's name.
    pub id: String,
    /// Its folder.
    pub folder: PathBuf,
}

impl Found {
    /// Returns how far it is.
    ///
    /// # Errors
    /// `DATA_LOSS` for a folder that cannot be read.
    pub fn standing(&self) -> Result<Standing, Status> {
        Standing::of(&self.folder).map_err(|e| refused(&e))
    }

    /// Returns the first tasks that came to no world.
    ///
    /// # Errors
    /// As [`Found::standing`].
    pub fn failed(&self, most: usize) -> Result<Vec<Failure>, Status> {
        standing::failed(&self.folder, most).map_err(|e| refused(&e))
    }

    /// Has the run that makes it stop.
    ///
    /// # Errors
    /// `FAILED_PRECONDITION` where nobody makes it, `INTERNAL` where the wish cannot be written.
    pub fn stop(&self) -> Result<(), Status> {
        match self.standing()?.doing {
            standing::Doing::Running => standing::stop(&self.folder).map_err(|e| status::internal(&e)),
            _ => Err(Status::failed_precondition("no run adds to this data set")),
        }
    }

    /// Returns when it was begun, ms since 1970, where the system says so.
    pub fn begun_ms(&self) -> Option<u64> {
        let work = self.folder.join(standing::WORK).join(SPEC);
        let spec = if work.is_file() { work } else { self.folder.join(SPEC) };
        let since = spec.metadata().ok()?.modified().ok()?.duration_since(UNIX_EPOCH).ok()?;
        u64::try_from(since.as_millis()).ok()
    }
}

fn refused(error: &Error) -> Status {
    Status::data_loss(format!("the data set cannot be read: {error}"))
}

/// Returns the data sets of the folders, by name.
pub fn all(roots: &[PathBuf]) -> Vec<Found> {
    roots.iter().enumerate().flat_map(|(number, root)| of(number, root)).collect()
}

/// Returns a data set by its id among the jobs; none where there is none.
pub fn get(roots: &[PathBuf], id: &str) -> Option<Found> {
    let (number, name) = id.strip_prefix(PREFIX)?.split_once('/')?;
    let number: usize = number.parse().ok()?;
    // one of those that are there, so that no id leads out of the folder
    of(number, roots.get(number)?).into_iter().find(|found| found.folder.file_name().is_some_and(|n| n == name))
}

fn of(number: usize, root: &Path) -> Vec<Found> {
    let Ok(entries) = std::fs::read_dir(root) else { return Vec::new() };
    let mut folders: Vec<PathBuf> = entries.filter_map(|e| Some(e.ok()?.path())).collect();
    folders.retain(|folder| is_data_set(folder));
    folders.sort();
    let found = |folder: PathBuf| {
        let id = format!("{PREFIX}{number}/{}", folder.file_name()?.to_str()?);
        Some(Found { id, folder })
    };
    folders.into_iter().filter_map(found).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_lead_to_data_sets_of_the_folders_alone() {
        let root = tempfile::tempdir().expect("a folder");
        for name in ["wards", "other"] {
            std::fs::create_dir(root.path().join(name)).expect("a folder");
        }
        std::fs::write(root.path().join("wards/part.json"), "{}").expect("a file");
        let roots = [root.path().to_path_buf()];
        let found = all(&roots);
        assert_eq!(found.iter().map(|f| f.id.as_str()).collect::<Vec<_>>(), ["data_set/0/wards"]);
        assert_eq!(get(&roots, "data_set/0/wards").as_ref(), found.first());
        for wrong in
            ["data_set/1/wards", "data_set/0/other", "data_set/0/../wards", "data_set/0/", "wards", "data_set/x/wards"]
        {
            assert_eq!(get(&roots, wrong), None, "{wrong}");
        }
        assert_eq!(found[0].standing().expect_err("it is none").code(), tonic::Code::DataLoss);
    }
}
