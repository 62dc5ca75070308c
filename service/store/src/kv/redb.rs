//! Records in a `redb` file: copy on write, checksummed pages, two-phase commits.
//!
//! One process writes, any number read beside it (`ConcurrencyMode::SingleWriter`).
//!
//! After a write that the system refuses, redb answers nothing more through that handle, reads included. Reads then go
//! through a second handle, which is opened beside it as another process would, and the first one is opened again when there
//! is room.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

use redb::{
    Builder, ConcurrencyMode, Database, DatabaseError, ReadOnlyDatabase, ReadOnlyTable, ReadTransaction,
    ReadableDatabase, StorageError, TableDefinition, TableError, TableHandle, TransactionError, WriteTransaction,
};

use super::{Batch, KeyRange, KeyValue, Mode, Opened, View, Visit, shielded};
use crate::error::{Error, Result};

type Table = ReadOnlyTable<&'static [u8], &'static [u8]>;

fn definition(table: &str) -> TableDefinition<'_, &'static [u8], &'static [u8]> {
    TableDefinition::new(table)
}

/// Opens or makes the file at `path`.
pub(super) fn open(path: &Path, mode: Mode, cache_bytes: u64) -> Result<Opened> {
    let builder = builder(cache_bytes);
    let opened = shielded(path, || {
        Ok(match mode {
            Mode::Read => builder.open_read_only(path).map(Handle::Reader),
            Mode::Write => builder.open(path).map(Handle::Writer),
            Mode::Create => builder.create(path).map(Handle::Writer),
        })
    })?;
    match opened {
        Ok(handle) => {
            let handles = RwLock::new(Handles { first: Some(handle), beside: None });
            Ok(Opened::Ready(Box::new(Redb {
                handles,
                failed: AtomicBool::new(false),
                cache_bytes,
                path: path.to_path_buf(),
            })))
        }
        Err(DatabaseError::DatabaseAlreadyOpen | DatabaseError::LockProtocolMismatch) => Ok(Opened::Busy),
        Err(DatabaseError::RepairAborted) => Ok(Opened::NeedsRepair),
        Err(other) => Err(said(path, other.into())),
    }
}

fn builder(cache_bytes: u64) -> Builder {
    let mut builder = Builder::new();
    builder.set_concurrency_mode(ConcurrencyMode::SingleWriter);
    builder.set_cache_size(usize::try_from(cache_bytes).unwrap_or(usize::MAX));
    builder
}

enum Handle {
    Writer(Database),
    Reader(ReadOnlyDatabase),
}

struct Handles {
    /// None when it is dropped, and when it could not be opened again.
    first: Option<Handle>,
    /// What is read through after a write of the first one has failed.
    beside: Option<ReadOnlyDatabase>,
}

struct Redb {
    handles: RwLock<Handles>,
    /// True once the first handle has failed: it answers nothing more.
    failed: AtomicBool,
    path: PathBuf,
    cache_bytes: u64,
}

impl Redb {
    fn begin_read(&self) -> Result<ReadTransaction> {
        if !self.failed.load(Ordering::SeqCst) {
            let handles = self.handles();
            let begun = match &handles.first {
                Some(Handle::Writer(database)) => database.begin_read(),
                Some(Handle::Reader(database)) => database.begin_read(),
                None => Err(TransactionError::Storage(StorageError::DatabaseClosed)),
            };
            match begun {
                Err(_) if !matches!(handles.first, Some(Handle::Reader(_))) => {
                    self.failed.store(true, Ordering::SeqCst)
                }
                begun => return begun.map_err(|e| said(&self.path, e.into())),
            }
        }
        self.begin_read_beside()
    }

    /// Reads what was stored before a write failed.
    fn begin_read_beside(&self) -> Result<ReadTransaction> {
        let mut handles = self.change_handles();
        if handles.first.is_none() {
            self.open_again(&mut handles)?;
        }
        let Handles { first, beside } = &mut *handles;
        let begun = match first {
            Some(Handle::Writer(database)) if !self.failed.load(Ordering::SeqCst) => database.begin_read(),
            _ => {
                if beside.is_none() {
                    let opened = builder(self.cache_bytes).open_read_only(&self.path);
                    *beside = Some(opened.map_err(|e| said(&self.path, e.into()))?);
                }
                match beside {
                    Some(beside) => beside.begin_read(),
                    None => Err(TransactionError::Storage(StorageError::DatabaseClosed)),
                }
            }
        };
        begun.map_err(|e| said(&self.path, e.into()))
    }

    fn begin_write(&self) -> Result<WriteTransaction> {
        if self.failed.load(Ordering::SeqCst) {
            self.recover()?;
        }
        let handles = self.handles();
        let Some(Handle::Writer(database)) = &handles.first else {
            let dir = self.path.parent().unwrap_or(&self.path).to_path_buf();
            return Err(Error::ReadOnly { dir });
        };
        database.begin_write().map_err(|e| said(&self.path, e.into()))
    }

    /// Opens the first handle again, which repairs the file, and reads through it from now on.
    fn open_again(&self, handles: &mut Handles) -> Result<()> {
        handles.beside = None;
        handles.first = None; // lets go of the file
        let opened = builder(self.cache_bytes).open(&self.path);
        handles.first = Some(Handle::Writer(opened.map_err(|e| said(&self.path, e.into()))?));
        self.failed.store(false, Ordering::SeqCst);
        Ok(())
    }

    fn handles(&self) -> RwLockReadGuard<'_, Handles> {
        self.handles.read().unwrap_or_else(PoisonError::into_inner)
    }

    fn change_handles(&self) -> RwLockWriteGuard<'_, Handles> {
        self.handles.write().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Redb {
    fn drop(&mut self) {
        let mut handles = self.change_handles();
        let taken = (handles.beside.take(), handles.first.take());
        drop(handles);
        // What a close has to say (a file that was damaged meanwhile) the next open says again.
        let _ = shielded(&self.path, || {
            drop(taken);
            Ok(())
        });
    }
}

impl KeyValue for Redb {
    fn view(&self) -> Result<Box<dyn View + '_>> {
        let transaction = shielded(&self.path, || self.begin_read())?;
        Ok(Box::new(RedbView { transaction, path: &self.path }))
    }

    fn apply(&self, batch: &Batch) -> Result<()> {
        let applied = shielded(&self.path, || {
            let transaction = self.begin_write()?;
            write(transaction, batch).map_err(|e| said(&self.path, e))
        });
        if matches!(applied, Err(Error::Full { .. } | Error::Io { .. })) {
            self.failed.store(true, Ordering::SeqCst);
        }
        applied
    }

    fn recover(&self) -> Result<()> {
        if !self.failed.load(Ordering::SeqCst) {
            return Ok(());
        }
        // A file that needs a repair cannot be read, and the repair writes: not without room.
        crate::files::check_room(&self.path, 0)?;
        crate::files::try_room(&self.path)?;
        shielded(&self.path, || self.open_again(&mut self.change_handles()))
    }
}

struct RedbView<'a> {
    transaction: ReadTransaction,
    path: &'a Path,
}

impl RedbView<'_> {
    fn table(&self, name: &str) -> Result<Option<Table>> {
        match self.transaction.open_table(definition(name)) {
            Ok(table) => Ok(Some(table)),
            Err(TableError::TableDoesNotExist(_)) => Ok(None),
            Err(other) => Err(said(self.path, other.into())),
        }
    }
}

impl View for RedbView<'_> {
    fn get(&self, table: &str, key: &[u8]) -> Result<Option<Vec<u8>>> {
        shielded(self.path, || {
            let Some(table) = self.table(table)? else { return Ok(None) };
            let value = table.get(key).map_err(|e| said(self.path, e.into()))?;
            Ok(value.map(|v| v.value().to_vec()))
        })
    }

    fn contains(&self, table: &str, key: &[u8]) -> Result<bool> {
        shielded(self.path, || {
            let Some(table) = self.table(table)? else { return Ok(false) };
            Ok(table.get(key).map_err(|e| said(self.path, e.into()))?.is_some())
        })
    }

    fn scan(&self, table: &str, range: &KeyRange, visit: &mut Visit<'_>) -> Result<()> {
        if range.is_empty() {
            return Ok(());
        }
        let found = shielded(self.path, || {
            let Some(table) = self.table(table)? else { return Ok(None) };
            table.range::<&[u8]>(range.bounds()).map(Some).map_err(|e| said(self.path, e.into()))
        })?;
        let Some(mut entries) = found else { return Ok(()) };
        while let Some((key, value)) = shielded(self.path, || {
            let entry = entries.next().transpose().map_err(|e| said(self.path, e.into()))?;
            // In a damaged page this may panic, so it must not happen below for the first time.
            let _ = entry.as_ref().map(|(key, value)| (key.value(), value.value()));
            Ok(entry)
        })? {
            if visit(key.value(), value.value())? == ControlFlow::Break(()) {
                break;
            }
        }
        Ok(())
    }

    fn tables(&self) -> Result<Vec<String>> {
        shielded(self.path, || {
            let tables = self.transaction.list_tables().map_err(|e| said(self.path, e.into()))?;
            let mut names: Vec<_> = tables.map(|t| t.name().to_owned()).collect();
            names.sort();
            Ok(names)
        })
    }
}

/// Commits with `Durability::Immediate`, redb's default; a transaction that is dropped changes nothing.
fn write(transaction: WriteTransaction, batch: &Batch) -> Result<(), redb::Error> {
    for (name, changes) in batch.tables() {
        let mut table = transaction.open_table(definition(name))?;
        for (key, value) in changes {
            match value {
                Some(value) => drop(table.insert(key.as_slice(), value.as_slice())?),
                None => drop(table.remove(key.as_slice())?),
            }
        }
    }
    Ok(transaction.commit()?)
}

/// What redb reports, in our words.
fn said(path: &Path, error: redb::Error) -> Error {
    use std::io::ErrorKind::{InvalidData, UnexpectedEof};
    let path = path.to_path_buf();
    match error {
        redb::Error::Io(source) if !matches!(source.kind(), InvalidData | UnexpectedEof) => Error::io(path)(source),
        redb::Error::PreviousIo => {
            let source = std::io::Error::other("an earlier write failed: make room, then open the store again");
            Error::Io { path, source }
        }
        redb::Error::ValueTooLarge(bytes) => {
            Error::Limit { what: format!("value has {bytes} bytes, too many for redb") }
        }
        other => Error::Corrupt { path, reason: other.to_string() },
    }
}
