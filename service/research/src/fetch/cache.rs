//! Fetched documents on disk: bodies named by their hash, and an entry a URL with where, when and what it was.
//!
//! What it is not for: deciding how old a copy may be. The cache belongs to its user; its files may be copied, deleted and
//! given to others for replay. Every file is written whole or not at all, and checked when it is read.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use data_encoding::HEXLOWER;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::Error;
use crate::read::Kind;

/// The form of the entries.
const VERSION: u32 = 1;

/// What the cache knows about a document.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// The form of this entry.
    pub version: u32,
    /// The address that was asked for, without its fragment.
    pub url: String,
    /// The address it was found at, after redirects.
    pub final_url: String,
    /// When, in seconds since 1970 UTC.
    pub fetched_at_s: u64,
    /// The same as `2026-11-21T14:31:00Z`, for readers.
    pub fetched_at: String,
    /// The status of the answer.
    pub status: u16,
    /// The content type that the server sent.
    pub content_type: Option<String>,
    /// What its bytes are.
    pub kind: Kind,
    /// The hash of its bytes, in hexadecimal.
    pub sha256: String,
    /// How many bytes it has.
    pub bytes: u64,
}

/// What looking up a document gives.
#[derive(Debug)]
pub(super) enum Found {
    Hit(Entry, Vec<u8>),
    Miss,
    Damaged(String),
}

/// A folder of fetched documents.
#[derive(Debug, Clone)]
pub struct Cache {
    entries: PathBuf,
    bodies: PathBuf,
}

impl Cache {
    /// Opens a folder, and makes it when it is missing.
    ///
    /// # Errors
    ///
    /// [`Error::Cache`] when the folder cannot be made.
    pub fn open(folder: &Path) -> Result<Self, Error> {
        let cache = Self { entries: folder.join("entries"), bodies: folder.join("bodies") };
        for folder in [&cache.entries, &cache.bodies] {
            fs::create_dir_all(folder).map_err(|e| failed(folder, &e))?;
        }
        Ok(cache)
    }

    /// Returns all entries that can be read, in the order of their URLs.
    ///
    /// # Errors
    ///
    /// [`Error::Cache`] when the folder cannot be read.
    pub fn entries(&self) -> Result<Vec<Entry>, Error> {
        let files = fs::read_dir(&self.entries).map_err(|e| failed(&self.entries, &e))?;
        let paths =
            files.filter_map(Result::ok).map(|f| f.path()).filter(|p| p.extension().is_some_and(|e| e == "json"));
        let mut entries: Vec<Entry> =
            paths.filter_map(|p| fs::read(p).ok()).filter_map(|b| serde_json::from_slice(&b).ok()).collect();
        entries.sort_by(|a, b| a.url.cmp(&b.url));
        Ok(entries)
    }

    /// Returns the copy of a document.
    pub(super) fn find(&self, url: &str) -> Found {
        let path = self.entry_path(url);
        let text = match fs::read(&path) {
            Ok(text) => text,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Found::Miss,
            Err(e) => return Found::Damaged(format!("its entry {} cannot be read: {e}", path.display())),
        };
        let entry: Entry = match serde_json::from_slice(&text) {
            Ok(entry) => entry,
            Err(e) => return Found::Damaged(format!("its entry {} is not valid: {e}", path.display())),
        };
        if entry.version != VERSION || entry.url != url {
            return Found::Damaged(format!("its entry {} is of another document or version", path.display()));
        }
        // The hash names a file, and the entry may be edited: it must not name one outside of the folder.
        if entry.sha256.len() != 64 || !entry.sha256.bytes().all(|b| b.is_ascii_hexdigit()) {
            return Found::Damaged(format!("its entry {} has no valid hash", path.display()));
        }
        let body = self.bodies.join(&entry.sha256);
        match fs::read(&body) {
            Ok(bytes) if hash(&bytes) == entry.sha256 => Found::Hit(entry, bytes),
            Ok(_) => Found::Damaged(format!("its copy {} does not match its hash", body.display())),
            Err(e) => Found::Damaged(format!("its copy {} cannot be read: {e}", body.display())),
        }
    }

    /// Keeps a document. The body is complete on disk before the entry that names it.
    ///
    /// # Errors
    ///
    /// [`Error::Cache`] when a file cannot be written.
    pub fn keep(&self, entry: &Entry, bytes: &[u8]) -> Result<(), Error> {
        let body = self.bodies.join(&entry.sha256);
        let present = fs::read(&body).is_ok_and(|old| old == bytes);
        if !present {
            write_whole(&self.bodies, &body, bytes)?;
        }
        let path = self.entry_path(&entry.url);
        let mut text = serde_json::to_vec_pretty(entry).map_err(|e| failed(&path, &std::io::Error::other(e)))?;
        text.push(b'\n');
        write_whole(&self.entries, &path, &text)
    }

    fn entry_path(&self, url: &str) -> PathBuf {
        self.entries.join(format!("{}.json", hash(url.as_bytes())))
    }
}

impl Entry {
    /// Returns the entry of a document that was fetched at a time in seconds since 1970 UTC.
    pub fn new(url: &str, final_url: &str, at_s: u64, content_type: Option<String>, kind: Kind, bytes: &[u8]) -> Self {
        Self {
            version: VERSION,
            url: url.to_owned(),
            final_url: final_url.to_owned(),
            fetched_at_s: at_s,
            fetched_at: date_time(at_s),
            status: 200,
            content_type,
            kind,
            sha256: hash(bytes),
            bytes: bytes.len() as u64,
        }
    }
}

fn write_whole(folder: &Path, path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let write = || -> std::io::Result<()> {
        let mut file = tempfile::Builder::new().prefix(".unfinished-").tempfile_in(folder)?;
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        file.persist(path)?;
        Ok(())
    };
    write().map_err(|e| failed(path, &e))
}

fn failed(path: &Path, error: &std::io::Error) -> Error {
    Error::Cache { path: path.display().to_string(), reason: error.to_string() }
}

/// Returns the SHA-256 of bytes in hexadecimal.
pub(super) fn hash(bytes: &[u8]) -> String {
    HEXLOWER.encode(&Sha256::digest(bytes))
}

/// Returns seconds since 1970 UTC as date and time (the days by Howard Hinnant's `civil_from_days`).
fn date_time(seconds: u64) -> String {
    let (days, rest) = (seconds / 86_400 + 719_468, seconds % 86_400);
    let (era, day_of_era) = (days / 146_097, days % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * shifted + 2) / 5 + 1;
    let month = if shifted < 10 { shifted + 3 } else { shifted - 9 };
    let year = year_of_era + era * 400 + u64::from(month <= 2);
    let (hour, minute, second) = (rest / 3600, rest / 60 % 60, rest % 60);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
}

#[cfg(test)]
mod tests {
    use super::date_time;

    #[test]
    fn dates_are_written_for_readers() {
        for (seconds, expected) in [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_399, "2000-02-28T23:59:59Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
            (1_795_271_460, "2026-11-21T14:31:00Z"),
        ] {
            assert_eq!(date_time(seconds), expected);
        }
    }
}
