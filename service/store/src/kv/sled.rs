//! Records in a `sled` folder.
//!
//! sled serves one process at a time and has no read transactions: a view is a lock that batches wait for. Tables
//! share one tree, with the table's name before each key, because a batch of sled is atomic within a tree only.

use std::ops::{Bound, ControlFlow};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use super::gate::{Gate, Reading};
use super::{Batch, KeyRange, KeyValue, Mode, Opened, View, Visit, shielded};
use crate::error::{Error, Result};

/// Between a table's name and the key. Names of tables have no such byte.
const SEPARATOR: u8 = 0;

/// How often, and after which pause, a folder is tried again that a closing handle of this process still locks: sled
/// lets go of it in the background.
const REOPEN: (u32, Duration) = (100, Duration::from_millis(20));

/// Opens or makes the folder at `path`.
pub(super) fn open(path: &Path, mode: Mode, cache_bytes: u64) -> Result<Opened> {
    if mode != Mode::Create && !path.join("db").is_file() {
        let reason = "file db is missing in it".to_owned();
        return Err(Error::Corrupt { path: path.to_path_buf(), reason });
    }
    // No background flushes: every batch is flushed before it counts.
    let config = sled::Config::new().path(path).cache_capacity(cache_bytes).flush_every_ms(None);
    for _ in 0..REOPEN.0 {
        match shielded(path, || Ok(config.open()))? {
            Ok(database) => return Ok(Opened::Ready(Box::new(Sled::new(database, path)))),
            Err(sled::Error::Io(e)) if e.to_string().contains("could not acquire lock") => std::thread::sleep(REOPEN.1),
            Err(sled::Error::Corruption { .. }) if removed_unfinished(path)? => {}
            Err(other) => return Err(said(path, other)),
        }
    }
    Ok(Opened::Busy)
}

/// Removes the snapshots of the log that an opening process was writing when it was killed, and returns whether there
/// were any. sled takes them for the latest ones and gives up (https://github.com/spacejam/sled/issues/1527); without
/// them it reads the log from the snapshot before, as it does after any other crash. Only for a folder that sled has
/// found damaged: it had the lock by then, so that nobody is writing one.
fn removed_unfinished(path: &Path) -> Result<bool> {
    let mut removed = false;
    for entry in std::fs::read_dir(path).map_err(Error::io(path))? {
        let name = entry.map_err(Error::io(path))?.file_name();
        if name.to_str().is_some_and(|n| n.starts_with("snap.") && n.ends_with(".generating")) {
            let file = path.join(name);
            std::fs::remove_file(&file).map_err(Error::io(&file))?;
            removed = true;
        }
    }
    Ok(removed)
}

struct Sled {
    /// Taken when dropped only.
    database: Option<sled::Db>,
    path: PathBuf,
    gate: Gate,
    /// Whether a batch may be in memory that is not on the disk; such a state is not shown to anybody.
    failed: AtomicBool,
}

impl Sled {
    fn new(database: sled::Db, path: &Path) -> Self {
        let (gate, failed) = (Gate::default(), AtomicBool::new(false));
        Self { database: Some(database), path: path.to_path_buf(), gate, failed }
    }

    fn database(&self) -> Result<&sled::Db> {
        match &self.database {
            Some(database) if !self.failed.load(Ordering::Acquire) => Ok(database),
            _ => {
                let source = std::io::Error::other("an earlier write failed: make room, then open the store again");
                Err(Error::Io { path: self.path.clone(), source })
            }
        }
    }
}

impl Drop for Sled {
    fn drop(&mut self) {
        let database = self.database.take();
        // What is not on the disk by now was never acknowledged.
        let _ = shielded(&self.path, || {
            drop(database);
            Ok(())
        });
    }
}

impl KeyValue for Sled {
    fn view(&self) -> Result<Box<dyn View + '_>> {
        let reading = self.gate.read();
        Ok(Box::new(SledView { database: self.database()?, path: &self.path, _reading: reading }))
    }

    fn apply(&self, batch: &Batch) -> Result<()> {
        let mut changes = sled::Batch::default();
        for (table, entries) in batch.tables() {
            for (key, value) in entries {
                match value {
                    Some(value) => changes.insert(full_key(table, key), value.as_slice()),
                    None => changes.remove(full_key(table, key)),
                }
            }
        }
        let _writing = self.gate.write();
        let database = self.database()?;
        let stored = shielded(&self.path, || {
            database.apply_batch(changes).and_then(|()| database.flush()).map_err(|e| said(&self.path, e))
        });
        if stored.is_err() {
            self.failed.store(true, Ordering::Release);
        }
        stored.map(|_| ())
    }
}

struct SledView<'a> {
    database: &'a sled::Db,
    path: &'a Path,
    _reading: Reading<'a>,
}

impl View for SledView<'_> {
    fn get(&self, table: &str, key: &[u8]) -> Result<Option<Vec<u8>>> {
        let value = shielded(self.path, || self.database.get(full_key(table, key)).map_err(|e| said(self.path, e)))?;
        Ok(value.map(|v| v.to_vec()))
    }

    fn contains(&self, table: &str, key: &[u8]) -> Result<bool> {
        shielded(self.path, || self.database.contains_key(full_key(table, key)).map_err(|e| said(self.path, e)))
    }

    fn scan(&self, table: &str, range: &KeyRange, visit: &mut Visit<'_>) -> Result<()> {
        if range.is_empty() {
            return Ok(());
        }
        let skipped = table.len() + 1;
        let mut entries = self.database.range(full_range(table, range));
        while let Some(entry) = shielded(self.path, || entries.next().transpose().map_err(|e| said(self.path, e)))? {
            let (key, value) = entry;
            if visit(key.get(skipped..).unwrap_or_default(), &value)? == ControlFlow::Break(()) {
                break;
            }
        }
        Ok(())
    }

    fn tables(&self) -> Result<Vec<String>> {
        let mut names: Vec<String> = Vec::new();
        // From the first key of each table to the first key behind the table.
        let mut next = Vec::new();
        while let Some((key, _)) = shielded(self.path, || {
            self.database.range(next.clone()..).next().transpose().map_err(|e| said(self.path, e))
        })? {
            let name = key.split(|b| *b == SEPARATOR).next().unwrap_or_default();
            next = [name, &[SEPARATOR + 1]].concat();
            names.push(String::from_utf8_lossy(name).into_owned());
        }
        Ok(names)
    }
}

fn full_key(table: &str, key: &[u8]) -> Vec<u8> {
    let mut full = Vec::with_capacity(table.len() + 1 + key.len());
    full.extend_from_slice(table.as_bytes());
    full.push(SEPARATOR);
    full.extend_from_slice(key);
    full
}

fn full_range(table: &str, range: &KeyRange) -> (Bound<Vec<u8>>, Bound<Vec<u8>>) {
    let start = match &range.start {
        Bound::Unbounded => Bound::Included(full_key(table, b"")),
        Bound::Included(key) => Bound::Included(full_key(table, key)),
        Bound::Excluded(key) => Bound::Excluded(full_key(table, key)),
    };
    let end = match &range.end {
        Bound::Unbounded => Bound::Excluded([table.as_bytes(), &[SEPARATOR + 1]].concat()),
        Bound::Included(key) => Bound::Included(full_key(table, key)),
        Bound::Excluded(key) => Bound::Excluded(full_key(table, key)),
    };
    (start, end)
}

/// What sled reports, in our words.
fn said(path: &Path, error: sled::Error) -> Error {
    let path = path.to_path_buf();
    match error {
        sled::Error::Io(source) => Error::Io { path, source },
        other => Error::Corrupt { path, reason: other.to_string() },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The value under `key` in the folder at `path`, opened and closed for it.
    fn stored(path: &Path, key: &[u8]) -> Result<Option<Vec<u8>>> {
        match open(path, Mode::Write, 8 << 20)? {
            Opened::Ready(records) => records.view()?.get("rooms", key),
            Opened::Busy | Opened::NeedsRepair => panic!("nobody else has it"),
        }
    }

    #[test]
    fn a_snapshot_that_a_killed_process_was_writing_does_no_harm() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("records");
        let Opened::Ready(records) = open(&path, Mode::Create, 8 << 20).expect("a new folder") else {
            panic!("nobody else has it")
        };
        let mut batch = Batch::new();
        batch.put("rooms", "a", vec![7; 100_000]);
        records.apply(&batch).expect("a batch that is stored");
        drop(records);
        let value = stored(&path, b"a").expect("records that open");
        assert_eq!(value, Some(vec![7; 100_000]));
        let names = || std::fs::read_dir(&path).expect("a folder").map(|e| e.expect("an entry").file_name());
        let snapshot = names().find(|n| n.to_string_lossy().starts_with("snap.")).expect("a snapshot");
        let whole = std::fs::read(path.join(&snapshot)).expect("a snapshot that is read");
        let unfinished = path.join("snap.7FFFFFFFFFFFFFFF.generating");
        for length in [0, 5, 12, whole.len() / 2, whole.len() - 1] {
            std::fs::write(&unfinished, &whole[..length]).expect("half a snapshot");
            assert_eq!(stored(&path, b"a").expect("records that open"), value, "{length} bytes of a snapshot");
            assert!(!unfinished.exists(), "{length} bytes of a snapshot");
        }
        // One that was finished and is damaged is still an error.
        let snapshot = names().find(|n| n.to_string_lossy().starts_with("snap.")).expect("a snapshot");
        std::fs::write(path.join(snapshot), &whole[..whole.len() / 2]).expect("a spoiled snapshot");
        assert!(matches!(stored(&path, b"a"), Err(Error::Corrupt { .. })));
    }
}
