//! Backups while the server runs: one folder with a snapshot of each store and the files of models.
//!
//! A snapshot is of one moment, and its files are copied after it: a model that a record names is there, as files are never
//! changed, only added and removed. One that was removed meanwhile is named in the answer.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use d3dgen_store::snapshot;
use tonic::Status;

use crate::core::Core;
use crate::error::Error;
use crate::status;

/// Names of the snapshots in a backup: the server's records; rules and assets.
pub const SNAPSHOTS: [&str; 2] = ["server.snapshot", "knowledge.snapshot"];
/// Folders that are copied, below the folder of the databases: their place there and in a backup.
const FOLDERS: [(&str, &str); 2] = [("knowledge/models", "models"), ("jobs", "jobs")];

/// What a backup holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Summary {
    /// Its folder.
    pub folder: PathBuf,
    /// Records in both snapshots.
    pub records: u64,
    /// Files copied.
    pub files: u64,
}

/// Writes a backup into a new folder below `backups` in the folder of the databases.
///
/// # Errors
/// `CANCELLED`; `DATA_LOSS` when a record is damaged; `INTERNAL`.
pub fn write(core: &Core, cancelled: &AtomicBool) -> Result<Summary, Status> {
    let home = core.config.data_dir.join("backups");
    std::fs::create_dir_all(&home).map_err(|e| status::io(&e))?;
    let name = core.clock.text().replace(':', "");
    let folder = (0..).map(|n| if n == 0 { home.join(&name) } else { home.join(format!("{name}-{n}")) });
    let Some(folder) = folder.take(100).find(|f| !f.exists()) else {
        return Err(Status::already_exists("there are many backups of this second"));
    };
    let fresh = tempfile::Builder::new().prefix(".backup-").tempdir_in(&home).map_err(|e| status::io(&e))?;
    let by = concat!("d3dgen ", env!("CARGO_PKG_VERSION"));
    let mut records = 0;
    for (store, name) in [&core.databases.own, core.databases.shared()].into_iter().zip(SNAPSHOTS) {
        let summary = snapshot::write(store, fresh.path().join(name), by, &mut |_| (), cancelled);
        records += summary.map_err(status::store)?.records;
    }
    let mut files = 0;
    for (from, to) in FOLDERS {
        copy(&core.config.data_dir.join(from), &fresh.path().join(to), &mut files, cancelled)?;
    }
    std::fs::rename(fresh.keep(), &folder).map_err(|e| status::io(&e))?;
    tracing::info!(folder = %folder.display(), records, files, "backup written");
    Ok(Summary { folder, records, files })
}

fn copy(from: &Path, to: &Path, files: &mut u64, cancelled: &AtomicBool) -> Result<(), Status> {
    if cancelled.load(std::sync::atomic::Ordering::SeqCst) {
        return Err(Status::cancelled("the call was given up"));
    }
    let Ok(entries) = std::fs::read_dir(from) else { return Ok(()) };
    std::fs::create_dir_all(to).map_err(|e| status::io(&e))?;
    for entry in entries.flatten() {
        let (path, target) = (entry.path(), to.join(entry.file_name()));
        match path.is_dir() {
            true => copy(&path, &target, files, cancelled)?,
            // hard links share the bytes, which never change; across disks they are copied
            false => match std::fs::hard_link(&path, &target).or_else(|_| std::fs::copy(&path, &target).map(drop)) {
                Ok(()) => *files += 1,
                Err(e) if e.kind() == std::io::ErrorKind::NotFound => {} // removed meanwhile
                Err(e) => return Err(status::io(&e)),
            },
        }
    }
    Ok(())
}

/// Makes the folder of a server's databases of a backup.
///
/// # Errors
/// `Store`: the folder is not free, or a snapshot is not whole; `File`.
pub fn restore(backup: &Path, data_dir: &Path) -> Result<u64, Error> {
    let file = |path: &Path| {
        let path = path.to_path_buf();
        move |source| Error::File { path, source }
    };
    for name in SNAPSHOTS {
        snapshot::check(backup.join(name))?; // both, before anything is written
    }
    std::fs::create_dir_all(data_dir).map_err(file(data_dir))?;
    let options = d3dgen_store::Options::default();
    let mut records = 0;
    for name in SNAPSHOTS {
        let dir = data_dir.join(name.trim_end_matches(".snapshot"));
        let store = snapshot::restore(backup.join(name), &dir, &options, &mut |_| (), &AtomicBool::new(false))?;
        let view = store.view()?;
        for table in view.tables()? {
            records += view.count(&table)?;
        }
    }
    for (to, from) in FOLDERS {
        restore_files(&backup.join(from), &data_dir.join(to))?;
    }
    Ok(records)
}

fn restore_files(from: &Path, to: &Path) -> Result<(), Error> {
    let Ok(entries) = std::fs::read_dir(from) else { return Ok(()) };
    let failed = |path: &Path| {
        let path = path.to_path_buf();
        move |source| Error::File { path, source }
    };
    std::fs::create_dir_all(to).map_err(failed(to))?;
    for entry in entries {
        let entry = entry.map_err(failed(from))?;
        let (path, target) = (entry.path(), to.join(entry.file_name()));
        match path.is_dir() {
            true => restore_files(&path, &target)?,
            false => drop(std::fs::copy(&path, &target).map_err(failed(&target))?),
        }
    }
    Ok(())
}
