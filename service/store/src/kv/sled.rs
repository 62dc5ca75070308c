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
            Err(other) => return Err(said(path, other)),
        }
    }
    Ok(Opened::Busy)
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
