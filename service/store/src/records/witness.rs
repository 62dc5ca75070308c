//! A second opinion on how far the records are: a small file that the writer notes each revision in, after the backend
//! has stored it.
//!
//! A backend that finds its own log damaged may go back to an older state that is sound in itself (sled does), and no
//! checksum tells. The note is not flushed to the disk, so that it may lag behind after a power failure, and is never
//! ahead; one that cannot be read says nothing.

use std::fs::{File, OpenOptions};
use std::io::{Seek, SeekFrom, Write};
use std::path::Path;

use twox_hash::XxHash3_64;

use crate::error::{Error, Result};

/// Name of the file.
pub(crate) const FILE: &str = "acknowledged";

/// Where the writer notes revisions.
pub(super) struct Witness(File);

impl Witness {
    pub(super) fn open(dir: &Path) -> Result<Self> {
        let path = dir.join(FILE);
        let file = OpenOptions::new().write(true).create(true).truncate(false).open(&path);
        file.map(Self).map_err(Error::io(path))
    }

    /// Notes that `revision` was stored.
    pub(super) fn note(&mut self, revision: u64) {
        let noted = self.0.seek(SeekFrom::Start(0)).and_then(|_| self.0.write_all(line(revision).as_bytes()));
        // The change is stored, whatever becomes of the note: a full disk must not make it look refused.
        drop(noted);
    }
}

/// Returns the revision that was noted in the store's folder, if any.
pub(super) fn noted(dir: &Path) -> Option<u64> {
    let text = std::fs::read_to_string(dir.join(FILE)).ok()?;
    let revision = text.split(' ').next()?.parse().ok()?;
    (line(revision) == text).then_some(revision)
}

/// All lines have the same length, so that one replaces the other.
fn line(revision: u64) -> String {
    format!("{revision:020} {:016x}\n", XxHash3_64::oneshot(&revision.to_le_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_note_is_read_as_it_was_written_or_not_at_all() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        assert_eq!(noted(folder.path()), None);
        let mut witness = Witness::open(folder.path()).expect("a witness");
        for revision in [1, u64::MAX, 7] {
            witness.note(revision);
            assert_eq!(noted(folder.path()), Some(revision));
        }
        let whole = std::fs::read(folder.path().join(FILE)).expect("a note");
        for at in 0..whole.len() {
            let mut bytes = whole.clone();
            bytes[at] ^= 1;
            std::fs::write(folder.path().join(FILE), &bytes).expect("a spoiled note");
            assert_eq!(noted(folder.path()), None, "byte {at}");
            std::fs::write(folder.path().join(FILE), &whole[..at]).expect("a cut note");
            assert_eq!(noted(folder.path()), None, "{at} bytes");
        }
    }
}
