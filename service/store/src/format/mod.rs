//! `store.json`: what a folder must say to be a store, and how a store of an earlier release becomes one of today.
//!
//! It does not say what is in the records.

mod upgrade;

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::files;
use crate::kv::Backend;

pub(crate) use upgrade::upgrade;

/// Name of the file.
pub(crate) const FILE: &str = "store.json";

/// The format that is written. What changed with each is told by `format/upgrade.rs`.
pub const FORMAT: u32 = 2;

/// A store of today.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Manifest {
    /// Always [`FORMAT`] in memory.
    pub(crate) format: u32,
    /// Name of the backend.
    pub(crate) backend: String,
    /// File or folder of the records, in the store's folder. An upgrade makes new ones beside the old ones; to change
    /// this name is the one step that counts.
    pub(crate) records: String,
    /// What made the store, such as `d3dgen 0.1.0`.
    pub(crate) written_by: String,
    /// False while the store is being made or restored; such a store is empty.
    pub(crate) complete: bool,
}

/// Read first, of any format.
#[derive(Debug, Deserialize)]
struct Head {
    format: u32,
    #[serde(default)]
    written_by: Option<String>,
}

/// What a folder's `store.json` says.
pub(crate) enum Found {
    /// A store of today.
    Current(Manifest),
    /// A store of an earlier format, with the whole file.
    Older(u32, serde_json::Value),
}

impl Manifest {
    /// A store that is about to be filled.
    pub(crate) fn new(backend: Backend, written_by: &str) -> Self {
        Self {
            format: FORMAT,
            backend: backend.name().to_owned(),
            records: records_name(FORMAT, backend),
            written_by: written_by.to_owned(),
            complete: false,
        }
    }

    /// Reads the file of the store in `dir`.
    ///
    /// # Errors
    /// [`Error::NotFound`], [`Error::NotAStore`] and [`Error::Newer`].
    pub(crate) fn read(dir: &Path) -> Result<Found> {
        let path = dir.join(FILE);
        let bytes = match std::fs::read(&path) {
            Ok(bytes) => bytes,
            Err(e) if matches!(e.kind(), std::io::ErrorKind::NotFound | std::io::ErrorKind::NotADirectory) => {
                return Err(missing(dir));
            }
            Err(source) => return Err(Error::Io { path, source }),
        };
        let not = |reason: String| Error::NotAStore { dir: dir.to_path_buf(), reason };
        let unreadable =
            |e: serde_json::Error| not(format!("{FILE} cannot be read ({e}): restore a snapshot into a new folder"));
        let value: serde_json::Value = serde_json::from_slice(&bytes).map_err(unreadable)?;
        let head: Head = serde_json::from_value(value.clone()).map_err(unreadable)?;
        if head.format > FORMAT {
            let written_by = head.written_by.unwrap_or_else(|| "unknown".to_owned());
            return Err(Error::Newer { path: dir.to_path_buf(), found: head.format, known: FORMAT, written_by });
        }
        if head.format < FORMAT {
            return Ok(Found::Older(head.format, value));
        }
        let manifest: Self = serde_json::from_value(value).map_err(unreadable)?;
        let plain = Path::new(&manifest.records).components().count() == 1 && manifest.records.starts_with(RECORDS);
        if !plain {
            return Err(not(format!(
                "{FILE} names {:?} as its records, which is no name of records",
                manifest.records
            )));
        }
        Ok(Found::Current(manifest))
    }

    /// Writes the file, in the place of what is there.
    pub(crate) fn write(&self, dir: &Path) -> Result<()> {
        let path = dir.join(FILE);
        let mut text =
            serde_json::to_vec_pretty(self).map_err(|e| Error::Io { path: path.clone(), source: e.into() })?;
        text.push(b'\n');
        files::write_whole(&path, true, |w| std::io::Write::write_all(w, &text).map_err(Error::io(&path)))
    }

    pub(crate) fn records_path(&self, dir: &Path) -> PathBuf {
        dir.join(&self.records)
    }
}

/// How the names of records begin.
const RECORDS: &str = "records";

fn records_name(format: u32, backend: Backend) -> String {
    format!("{RECORDS}-{format}.{}", backend.name())
}

/// Removes what interrupted upgrades and writes left in `dir`. Only the holder of the lock may do so.
pub(crate) fn sweep(dir: &Path, manifest: &Manifest) -> Result<()> {
    for entry in std::fs::read_dir(dir).map_err(Error::io(dir))? {
        let entry = entry.map_err(Error::io(dir))?;
        let name = entry.file_name();
        let Some(name) = name.to_str() else { continue };
        if name.starts_with(files::UNFINISHED) || (name.starts_with(RECORDS) && name != manifest.records) {
            remove(&entry.path())?;
        }
    }
    Ok(())
}

/// Removes a file or folder of records, if it is there.
pub(crate) fn remove(path: &Path) -> Result<()> {
    let removed = match path.symlink_metadata() {
        Ok(found) if found.is_dir() => std::fs::remove_dir_all(path),
        Ok(_) => std::fs::remove_file(path),
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(()),
        Err(other) => Err(other),
    };
    removed.map_err(Error::io(path))
}

/// Whether nothing is in `dir` that a new store would have to fear for: it is missing, empty, or the rest of a store
/// that was never finished.
pub(crate) fn is_free(dir: &Path) -> Result<bool> {
    match Manifest::read(dir) {
        Ok(Found::Current(manifest)) => return Ok(!manifest.complete),
        Ok(Found::Older(..)) => return Ok(false),
        Err(Error::NotFound { .. }) => {}
        Err(other) => return Err(other),
    }
    let entries = match std::fs::read_dir(dir) {
        Ok(entries) => entries,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(true),
        Err(source) => return Err(Error::Io { path: dir.to_path_buf(), source }),
    };
    for entry in entries {
        let name = entry.map_err(Error::io(dir))?.file_name();
        let ours = name == crate::lock::FILE
            || name == crate::records::WITNESS
            || name.to_string_lossy().starts_with(files::UNFINISHED);
        if !ours {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Says what a folder without `store.json` is.
fn missing(dir: &Path) -> Error {
    let entries = std::fs::read_dir(dir).ok().into_iter().flatten().flatten();
    let has_records = entries.into_iter().any(|e| e.file_name().to_string_lossy().starts_with(RECORDS));
    if has_records {
        let reason =
            format!("{FILE} is missing beside its records: put it back, or restore a snapshot into a new folder");
        return Error::NotAStore { dir: dir.to_path_buf(), reason };
    }
    Error::NotFound { dir: dir.to_path_buf() }
}
