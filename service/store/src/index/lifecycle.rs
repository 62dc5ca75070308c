//! When an index is opened and when it is made anew, so that killed, damaged, outdated and concurrent ones all end in
//! an index that answers.
//!
//! A folder of an index holds `manifest.json`, the folder of files that it names, and `build.lock`. A rebuild takes the
//! lock, writes a new folder beside the old one, replaces the manifest in one step and then removes the old folder. So
//! whatever is killed when, the manifest names whole files; what else lies there is removed by the next rebuild.

use std::fs::{File, OpenOptions, TryLockError};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use super::document::{IndexSpec, Phase, Watch};
use super::gather::Feed;
use super::manifest::{FORMAT, Manifest, Unreadable};
use super::parts::Parts;
use crate::embed::Embedder;
use crate::error::{Error, Result};
use crate::files::UNFINISHED;

const LOCK: &str = "build.lock";
/// How the names of folders of files begin.
const FOLDER: &str = "files-";

/// How often another process's rebuild is looked at, and how many times before this one builds in memory instead.
const PAUSE: Duration = Duration::from_millis(50);
const LOOKS: usize = 1200;

/// How often a reader starts again because the index was replaced under it.
const RETRIES: usize = 5;

/// Why an index was made anew.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reason {
    /// There was none.
    Missing,
    /// The records have changed since.
    Stale {
        /// Revision of the records that it was made of.
        indexed: u64,
    },
    /// A file is not as it was written.
    Damaged {
        /// Which, and how it was noticed.
        what: String,
    },
    /// Its vectors are of another embedder.
    OtherEmbedder {
        /// Which one.
        id: String,
    },
    /// Its fields are others.
    OtherSpec,
    /// Another release wrote it.
    OtherFormat {
        /// Its format.
        format: u32,
    },
}

impl std::fmt::Display for Reason {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Missing => write!(f, "there was no index"),
            Self::Stale { indexed } => write!(f, "the records have changed since revision {indexed}"),
            Self::Damaged { what } => write!(f, "the index was damaged: {what}"),
            Self::OtherEmbedder { id } => write!(f, "the index was made with embedder {id}"),
            Self::OtherSpec => write!(f, "the index had other fields"),
            Self::OtherFormat { format } => write!(f, "the index had format {format}, this release writes {FORMAT}"),
        }
    }
}

/// What an index is made of and with.
pub(super) struct Wanted<'a> {
    pub(super) spec: &'a IndexSpec,
    pub(super) embedder: &'a Arc<dyn Embedder>,
    pub(super) revision: u64,
    /// From how many rows on there is a graph: [`graph::FROM_ROWS`](super::graph::FROM_ROWS), but in tests.
    pub(super) graph_from: u32,
}

/// The parts of an index, and how they came to be.
pub(super) struct Found {
    pub(super) parts: Parts,
    pub(super) rebuilt: Option<Reason>,
    pub(super) unsaved: Option<Error>,
}

/// Opens the index, or makes it anew.
pub(super) fn open_or_rebuild<E: From<Error>>(
    dir: &Path,
    wanted: &Wanted<'_>,
    expected: usize,
    feed: Feed<'_, E>,
    watch: Watch<'_>,
) -> Result<Found, E> {
    let mut reason = match open(dir, wanted) {
        Ok(parts) => {
            tidy(dir);
            return Ok(Found { parts, rebuilt: None, unsaved: None });
        }
        Err(reason) => reason,
    };
    let lock = match lock(dir, watch) {
        Err(Error::Cancelled) => return Err(Error::Cancelled.into()),
        other => other,
    };
    if lock.is_ok() {
        // Whoever held the lock before may have made it.
        match open(dir, wanted) {
            Ok(parts) => return Ok(Found { parts, rebuilt: None, unsaved: None }),
            Err(now) => reason = now,
        }
    }
    let parts = Parts::new(wanted, expected, feed, watch)?;
    let saved = lock.and_then(|lock| save(dir, wanted, &parts, lock, watch));
    match saved {
        Ok(()) => Ok(Found { parts, rebuilt: Some(reason), unsaved: None }),
        Err(Error::Cancelled) => Err(Error::Cancelled.into()),
        Err(error) => Ok(Found { parts, rebuilt: Some(reason), unsaved: Some(error) }),
    }
}

fn open(dir: &Path, wanted: &Wanted<'_>) -> Result<Parts, Reason> {
    let read = || {
        Manifest::read(dir).map_err(|e| match e {
            Unreadable::Missing => Reason::Missing,
            Unreadable::Damaged(what) => Reason::Damaged { what },
        })
    };
    let mut manifest = read()?;
    let mut retries = RETRIES;
    loop {
        if manifest.format != FORMAT {
            return Err(Reason::OtherFormat { format: manifest.format });
        }
        if manifest.spec != wanted.spec.digest() {
            return Err(Reason::OtherSpec);
        }
        if manifest.embedder != wanted.embedder.id() {
            return Err(Reason::OtherEmbedder { id: manifest.embedder });
        }
        if manifest.revision != wanted.revision {
            return Err(Reason::Stale { indexed: manifest.revision });
        }
        let files = dir.join(&manifest.folder);
        let damage = match Parts::read(wanted.spec, wanted.embedder.dim(), &files, &manifest.files) {
            Ok(parts) if parts.columns.rows() == manifest.documents => return Ok(parts),
            Ok(parts) => format!("{} documents, expected {}", parts.columns.rows(), manifest.documents),
            Err(error) => error.to_string(),
        };
        // A rebuild may have removed the files while they were being read.
        let now = read()?;
        if now == manifest || retries == 0 {
            return Err(Reason::Damaged { what: damage });
        }
        retries -= 1;
        manifest = now;
    }
}

/// Waits until no other process rebuilds this index; keeps others waiting until it is dropped.
fn lock(dir: &Path, watch: Watch<'_>) -> Result<File> {
    std::fs::create_dir_all(dir).map_err(Error::io(dir))?;
    let path = dir.join(LOCK);
    let options = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path);
    let file = options.map_err(Error::io(&path))?;
    for _ in 0..LOOKS {
        match file.try_lock() {
            Ok(()) => return Ok(file),
            Err(TryLockError::Error(source)) => return Err(Error::Io { path, source }),
            Err(TryLockError::WouldBlock) => {
                watch.step(Phase::Waiting, 0, 0)?;
                std::thread::sleep(PAUSE);
            }
        }
    }
    Err(Error::Index { what: format!("another process holds {} for over a minute", path.display()) })
}

fn save(dir: &Path, wanted: &Wanted<'_>, parts: &Parts, lock: File, watch: Watch<'_>) -> Result<()> {
    let current = Manifest::read(dir).map(|m| m.folder).unwrap_or_default();
    remove_all_but(dir, &current);
    let mut builder = tempfile::Builder::new();
    builder.prefix(FOLDER);
    // A temporary folder would be private; this one is for everybody who may read the store.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o777));
    let files = builder.tempdir_in(dir).map_err(Error::io(dir))?;
    let rows = parts.columns.rows();
    let mut manifest = Manifest::new(wanted.spec.digest(), wanted.embedder.id(), wanted.revision, rows);
    manifest.files = parts.write(files.path(), watch)?;
    let name = files.path().file_name().and_then(|n| n.to_str()).unwrap_or_default().to_owned();
    manifest.folder.clone_from(&name);
    manifest.write(dir)?;
    // From here on the manifest names it.
    let _ = files.keep();
    remove_all_but(dir, &name);
    drop(lock);
    Ok(())
}

/// Removes what a killed rebuild left, unless somebody is rebuilding.
fn tidy(dir: &Path) {
    let folders = std::fs::read_dir(dir).into_iter().flatten().flatten();
    let folders = folders.filter(|entry| entry.file_name().to_str().is_some_and(|name| name.starts_with(FOLDER)));
    if folders.count() < 2 {
        return;
    }
    let Ok(lock) = OpenOptions::new().write(true).open(dir.join(LOCK)) else { return };
    if lock.try_lock().is_ok()
        && let Ok(manifest) = Manifest::read(dir)
    {
        remove_all_but(dir, &manifest.folder);
    }
}

/// Removes folders of files that no manifest names, and files that a killed rebuild began. What cannot be removed stays:
/// it is in nobody's way, and the next rebuild tries again.
fn remove_all_but(dir: &Path, current: &str) {
    for entry in std::fs::read_dir(dir).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let Some(name) = name.to_str() else { continue };
        if name.starts_with(FOLDER) && name != current {
            let _ = std::fs::remove_dir_all(entry.path());
        } else if name.starts_with(UNFINISHED) {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}
