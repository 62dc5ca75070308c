//! The key-value trait that records are stored through, and its backends.
//!
//! A backend knows tables, keys and values as bytes. It does not know checksums, revisions, formats or locks between
//! processes: [`crate::records`] and `lock` do, so that all backends behave alike.

mod change;
#[cfg(feature = "sled")]
mod gate;
mod redb;
#[cfg(feature = "sled")]
mod sled;
#[cfg(test)]
mod tests;

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

pub use change::{Batch, KeyRange};

use crate::error::{Error, Result};

/// What a scan calls with each key and value, in ascending order of keys; `Break` ends the scan.
pub type Visit<'a> = dyn FnMut(&[u8], &[u8]) -> Result<ControlFlow<()>> + 'a;

/// An ordered, durable map of bytes in named tables. One process writes.
pub trait KeyValue: Send + Sync {
    /// Returns what is stored now, unchanged by later batches for as long as the view lives. It stays in its thread.
    ///
    /// A backend may let writers wait meanwhile: a thread that holds a view must not call [`KeyValue::apply`].
    fn view(&self) -> Result<Box<dyn View + '_>>;

    /// Stores all changes of `batch`, or none of them. When it returns, a crash does not undo them.
    ///
    /// # Errors
    /// [`Error::Full`] when there is no room: views go on, and a later call stores again once there is some.
    fn apply(&self, batch: &Batch) -> Result<()>;

    /// Makes sure that [`KeyValue::apply`] can store again after it failed; nothing to do for a backend that never needs it.
    ///
    /// # Errors
    /// What it failed with, while that lasts.
    fn recover(&self) -> Result<()> {
        Ok(())
    }
}

/// An unchanging sight of a [`KeyValue`]. A table that was never written to is empty.
pub trait View {
    /// Returns the value of `key`, if there is one.
    fn get(&self, table: &str, key: &[u8]) -> Result<Option<Vec<u8>>>;

    /// Returns whether `key` has a value.
    fn contains(&self, table: &str, key: &[u8]) -> Result<bool>;

    /// Visits what lies in `range`, without holding more than a page of it in memory.
    fn scan(&self, table: &str, range: &KeyRange, visit: &mut Visit<'_>) -> Result<()>;

    /// Returns the names of the tables that were written to, sorted.
    fn tables(&self) -> Result<Vec<String>>;
}

/// The databases that records can be kept in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Backend {
    /// One file; readers of other processes work beside the writer. The default.
    Redb,
    /// A folder; serves one process at a time. Needs feature `sled`.
    Sled,
}

impl Backend {
    /// All of them, with or without the feature.
    pub const ALL: &[Self] = &[Self::Redb, Self::Sled];

    /// Returns its name, as it stands in `store.json`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Redb => "redb",
            Self::Sled => "sled",
        }
    }

    /// Returns the backend of that name.
    ///
    /// # Errors
    /// [`Error::NoBackend`] for any other.
    pub fn from_name(name: &str) -> Result<Self> {
        let found = Self::ALL.iter().find(|b| b.name() == name);
        found.copied().ok_or_else(|| Error::NoBackend { name: name.to_owned() })
    }

    /// Whether this program was built with it.
    pub fn is_built_in(self) -> bool {
        match self {
            Self::Redb => true,
            Self::Sled => cfg!(feature = "sled"),
        }
    }

    /// Whether other processes can read while one has the records open for writing.
    pub(crate) fn shares(self) -> bool {
        matches!(self, Self::Redb)
    }

    /// Opens the records at `path`. Only the holder of the store's lock may ask for more than `Mode::Read`.
    pub(crate) fn open(self, path: &Path, mode: Mode, cache_bytes: u64) -> Result<Opened> {
        match self {
            Self::Redb => redb::open(path, mode, cache_bytes),
            #[cfg(feature = "sled")]
            Self::Sled => sled::open(path, mode, cache_bytes),
            #[cfg(not(feature = "sled"))]
            Self::Sled => Err(Error::NoBackend { name: self.name().to_owned() }),
        }
    }
}

/// What the records are opened for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Mode {
    /// They exist and are not changed.
    Read,
    /// They exist and are repaired if that is needed.
    Write,
    /// They are made; nothing is there yet.
    Create,
}

/// What came of opening records.
pub(crate) enum Opened {
    /// They can be used.
    Ready(Box<dyn KeyValue>),
    /// Another process has them.
    Busy,
    /// The last writer was killed; `Mode::Write` repairs them.
    NeedsRepair,
}

/// Runs a call into a backend; a panic inside of it, which both backends answer some damaged files with, becomes an
/// error. Nothing of ours runs in there: a panic of ours stays one.
fn shielded<T>(path: &Path, call: impl FnOnce() -> Result<T>) -> Result<T> {
    catch_unwind(AssertUnwindSafe(call)).unwrap_or_else(|cause| {
        let said = cause.downcast_ref::<String>().map(String::as_str).or_else(|| cause.downcast_ref::<&str>().copied());
        let reason = format!("its backend gave up: {}", said.unwrap_or("no reason given"));
        Err(Error::Corrupt { path: path.to_path_buf(), reason })
    })
}
