//! The one small file that makes a folder an index: what it was made of and with, and a checksum of each file.
//!
//! It names the folder that holds the files. It is replaced in one step, so a reader sees the old index or the new one.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};
use twox_hash::XxHash3_64;

use crate::error::{Error, Result};
use crate::files::write_whole;

/// Name of the file.
pub(crate) const FILE: &str = "manifest.json";

/// The form of the files of an index; raised whenever it changes, as an index is made anew more easily than converted.
/// The terms of `analyze.rs` are part of it.
pub(crate) const FORMAT: u32 = 1;

/// What is known of an index without opening its files.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Manifest {
    pub(crate) format: u32,
    /// Digest of the specification.
    pub(crate) spec: String,
    /// See `Embedder::id`.
    pub(crate) embedder: String,
    /// Revision of the records that the documents were made of.
    pub(crate) revision: u64,
    pub(crate) documents: u32,
    /// The folder of the files, beside this one.
    pub(crate) folder: String,
    pub(crate) files: BTreeMap<String, Sum>,
    /// Checksum of all the above.
    checksum: String,
}

/// Size and checksum of a file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Sum {
    pub(crate) bytes: u64,
    pub(crate) xxh3: String,
}

impl Sum {
    pub(crate) fn of(content: &[u8]) -> Self {
        Self { bytes: content.len() as u64, xxh3: format!("{:016x}", XxHash3_64::oneshot(content)) }
    }
}

/// Why a manifest cannot be used.
pub(crate) enum Unreadable {
    Missing,
    Damaged(String),
}

impl Manifest {
    /// Reads the manifest of an index.
    pub(crate) fn read(dir: &Path) -> Result<Self, Unreadable> {
        let bytes = std::fs::read(dir.join(FILE)).map_err(|e| match e.kind() {
            std::io::ErrorKind::NotFound | std::io::ErrorKind::NotADirectory => Unreadable::Missing,
            _ => Unreadable::Damaged(format!("{FILE} cannot be read: {e}")),
        })?;
        let damaged = || Unreadable::Damaged(format!("{FILE} is not as it was written"));
        let manifest: Self = serde_json::from_slice(&bytes).map_err(|_| damaged())?;
        // The same bytes again, so that a change anywhere in the file is noticed.
        let same = manifest.clone().sealed().text().is_ok_and(|text| text.as_bytes() == bytes);
        if same { Ok(manifest) } else { Err(damaged()) }
    }

    /// Puts the manifest in place of the one that is there.
    pub(crate) fn write(self, dir: &Path) -> Result<()> {
        let path = dir.join(FILE);
        let text = self.sealed().text()?;
        write_whole(&path, true, |writer| std::io::Write::write_all(writer, text.as_bytes()).map_err(Error::io(&path)))
    }

    pub(crate) fn new(spec: String, embedder: &str, revision: u64, documents: u32) -> Self {
        let embedder = embedder.to_owned();
        let (folder, checksum) = (String::new(), String::new());
        Self { format: FORMAT, spec, embedder, revision, documents, folder, files: BTreeMap::new(), checksum }
    }

    fn sealed(mut self) -> Self {
        self.checksum.clear();
        let text = self.text().unwrap_or_default();
        self.checksum = format!("{:016x}", XxHash3_64::oneshot(text.as_bytes()));
        self
    }

    fn text(&self) -> Result<String> {
        serde_json::to_string_pretty(self).map_err(|e| Error::Index { what: format!("{FILE}: {e}") })
    }
}
