//! The store: a folder with records, opened by one writer and any number of readers.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use super::state::{self, State};
use super::verify::{self, Problem, Progress};
use super::view::{self, View};
use super::witness::Witness;
use super::{check_record, check_table, envelope, open};
use crate::error::{Error, Result};
use crate::kv::{Backend, Batch, KeyValue};
use crate::lock::Lock;

/// What a store is opened for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Access {
    /// To read, beside others who read, and with `redb` beside one who writes.
    Read,
    /// To read and change. One at a time.
    Write,
}

/// How stores are made and opened.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Options {
    /// What a new store keeps its records in. A store that exists knows by itself.
    pub backend: Backend,
    /// How long to wait, about, for another process that has the store open.
    pub wait: Duration,
    /// Memory for pages of the records, bytes.
    pub cache_bytes: u64,
    /// What a new store says it was made by.
    pub written_by: String,
    /// Opens a store that has lost changes which it had acknowledged, and goes on with what is there.
    pub accept_loss: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            backend: Backend::Redb,
            wait: Duration::from_secs(2),
            cache_bytes: 64 << 20,
            written_by: concat!("d3dgen ", env!("CARGO_PKG_VERSION")).to_owned(),
            accept_loss: false,
        }
    }
}

/// An open store. Clones are cheap and share it; threads read beside one that writes.
///
/// # Examples
/// ```
/// use d3dgen_store::{Access, Batch, KeyRange, Options, Store};
///
/// # fn main() -> d3dgen_store::Result<()> {
/// # let folder = tempfile::tempdir().expect("a temporary folder");
/// # let dir = folder.path().join("knowledge");
/// let store = Store::create(&dir, &Options::default())?;
/// let mut batch = Batch::new();
/// batch.put("constraints", "kitchen/area", "at least 6 m2");
/// batch.put("constraints", "kitchen/width", "at least 1.8 m");
/// let revision = store.apply(batch)?; // on the disk when it returns, both or none
///
/// assert_eq!(store.get("constraints", "kitchen/area")?.as_deref(), Some(&b"at least 6 m2"[..]));
/// let view = store.view()?;
/// let found: Vec<_> = view.records("constraints", KeyRange::prefix("kitchen/")).collect::<Result<_, _>>()?;
/// assert_eq!((found.len(), found[1].0.as_str()), (2, "kitchen/width"));
///
/// // Another handle, here or in another process, reads beside the writer and follows it.
/// let reader = Store::open(&dir, Access::Read, &Options::default())?;
/// assert_eq!(reader.revision()?, revision);
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct Store {
    inner: Arc<Inner>,
}

impl std::fmt::Debug for Store {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Inner { dir, backend, access, .. } = &*self.inner;
        f.debug_struct("Store").field("dir", dir).field("backend", backend).field("access", access).finish()
    }
}

struct Inner {
    dir: PathBuf,
    backend: Backend,
    access: Access,
    records: Box<dyn KeyValue>,
    writing: Mutex<Writing>,
    /// Let go of after the records: fields are dropped in their order.
    _lock: Option<Lock>,
}

/// What the writer keeps from one batch to the next.
pub(super) struct Writing {
    /// What the last batch left; none before the first one and after one that failed.
    state: Option<State>,
    /// None when the store is open for reading.
    witness: Option<Witness>,
}

impl Store {
    /// Opens the store in `dir`; one of an earlier format is upgraded, one whose writer was killed is repaired.
    ///
    /// # Errors
    /// [`Error::NotFound`], [`Error::NotAStore`], [`Error::Newer`], [`Error::InUse`] after [`Options::wait`],
    /// [`Error::NeedsWriter`], [`Error::NoBackend`]; [`Error::Corrupt`], also when the records are sound but lack
    /// changes that were acknowledged, unless [`Options::accept_loss`].
    pub fn open(dir: impl AsRef<Path>, access: Access, options: &Options) -> Result<Self> {
        open::open(dir.as_ref(), access, options)
    }

    /// Makes an empty store in `dir`, which is made or is empty, and opens it for writing.
    ///
    /// # Errors
    /// [`Error::Exists`] when something is in `dir`; [`Error::InUse`]; [`Error::NoBackend`].
    pub fn create(dir: impl AsRef<Path>, options: &Options) -> Result<Self> {
        open::create(dir.as_ref(), options)
    }

    /// Opens the store in `dir` for writing, or makes one when the folder is missing or empty.
    ///
    /// # Errors
    /// Those of [`Store::open`] and [`Store::create`].
    pub fn open_or_create(dir: impl AsRef<Path>, options: &Options) -> Result<Self> {
        open::open_or_create(dir.as_ref(), options)
    }

    pub(super) fn new(
        dir: &Path,
        backend: Backend,
        access: Access,
        records: Box<dyn KeyValue>,
        lock: Option<Lock>,
        witness: Option<Witness>,
    ) -> Self {
        let (dir, writing) = (dir.to_path_buf(), Mutex::new(Writing { state: None, witness }));
        Self { inner: Arc::new(Inner { dir, backend, access, records, writing, _lock: lock }) }
    }

    /// Stores all changes of `batch` or none; when it returns, not even a power failure undoes them. Returns the new
    /// [`Store::revision`]. A batch without changes stores nothing.
    ///
    /// # Errors
    /// [`Error::ReadOnly`]; [`Error::StillReading`] when this thread holds a view of the store; [`Error::Limit`];
    /// [`Error::Full`] when there is no room: nothing of it is stored, reading goes on, and so does storing once there is
    /// some.
    pub fn apply(&self, batch: Batch) -> Result<u64> {
        let inner = &*self.inner;
        if inner.access == Access::Read {
            return Err(Error::ReadOnly { dir: inner.dir.clone() });
        }
        if view::is_reading(self.id()) {
            return Err(Error::StillReading { dir: inner.dir.clone() });
        }
        // A panic while it was held has left none or the last good state in it.
        let mut writing = inner.writing.lock().unwrap_or_else(PoisonError::into_inner);
        let (changes, state) = {
            let view = inner.records.view()?;
            let state = match writing.state.take() {
                Some(state) => state,
                None => State::read(&*view)?,
            };
            if batch.is_empty() {
                let revision = state.revision;
                writing.state = Some(state);
                return Ok(revision);
            }
            enveloped(batch, state, &*view)?
        };
        crate::files::check_room(&inner.dir.join(crate::lock::FILE), bytes(&changes))?;
        inner.records.apply(&changes)?;
        let revision = state.revision;
        writing.state = Some(state);
        if let Some(witness) = &mut writing.witness {
            witness.note(revision);
        }
        Ok(revision)
    }

    /// Returns an error while nothing can be stored. What a full disk has broken is mended first, when there is room.
    ///
    /// # Errors
    /// [`Error::ReadOnly`]; [`Error::Full`]; what the records were refused with.
    pub fn check_writable(&self) -> Result<()> {
        let inner = &*self.inner;
        if inner.access == Access::Read {
            return Err(Error::ReadOnly { dir: inner.dir.clone() });
        }
        crate::files::check_room(&inner.dir.join(crate::lock::FILE), 0)?;
        inner.records.recover()
    }

    /// Takes a view of the records as they are now.
    pub fn view(&self) -> Result<View<'_>> {
        Ok(View::new(self, self.inner.records.view()?))
    }

    /// Returns the payload of one record, see [`View::get`].
    pub fn get(&self, table: &str, key: &str) -> Result<Option<Vec<u8>>> {
        self.view()?.get(table, key)
    }

    /// Returns how many records a table has, without counting them.
    pub fn count(&self, table: &str) -> Result<u64> {
        self.view()?.count(table)
    }

    /// Returns how often the store was changed. It grows with each batch, in the same step, and survives snapshots: what
    /// is derived from the records is stale when it remembers another one.
    pub fn revision(&self) -> Result<u64> {
        state::revision(&*self.inner.records.view()?)
    }

    /// Walks all records and returns every problem: damaged ones, and such as vanished or came from nowhere.
    ///
    /// # Errors
    /// [`Error::Cancelled`] soon after `cancelled` is set; what keeps the store from being read at all.
    pub fn verify(&self, observe: &mut dyn FnMut(Progress), cancelled: &AtomicBool) -> Result<Vec<Problem>> {
        verify::verify(&self.view()?, observe, cancelled)
    }

    /// The folder of the store.
    pub fn dir(&self) -> &Path {
        &self.inner.dir
    }

    /// The folder for what is derived from the records. It may be missing, and can be removed at any time.
    pub fn index_dir(&self) -> PathBuf {
        self.inner.dir.join("index")
    }

    /// What the records are kept in.
    pub fn backend(&self) -> Backend {
        self.inner.backend
    }

    /// What the store was opened for.
    pub fn access(&self) -> Access {
        self.inner.access
    }

    /// Tells open stores apart.
    pub(super) fn id(&self) -> usize {
        Arc::as_ptr(&self.inner) as usize
    }
}

/// Returns the bytes of keys and values of a batch.
fn bytes(batch: &Batch) -> u64 {
    let entries = batch.tables().flat_map(|(_, entries)| entries);
    entries.map(|(key, value)| (key.len() + value.as_ref().map_or(0, Vec::len)) as u64).sum()
}

/// Returns what is to be stored for `batch`, and the state after it.
fn enveloped(batch: Batch, mut state: State, view: &dyn crate::kv::View) -> Result<(Batch, State)> {
    let mut changes = Batch::new();
    for (table, entries) in batch.tables() {
        check_table(table)?;
        let mut tally = state.tallies.get(table).copied().unwrap_or_default();
        for (key, payload) in entries {
            check_record(table, key, payload.as_deref())?;
            let is_there = view.contains(table, key)?;
            match payload {
                Some(payload) => {
                    changes.put(table, key.as_slice(), envelope::wrap(table, key, payload));
                    if !is_there {
                        tally.add(table, key);
                    }
                }
                None if is_there => {
                    changes.delete(table, key.as_slice());
                    tally.remove(table, key);
                }
                None => {}
            }
        }
        state.tallies.insert(table.to_owned(), tally);
        state.put_tally(table, &mut changes);
    }
    state.revision += 1;
    state.put_revision(&mut changes);
    Ok((changes, state))
}
