//! The one error type of this crate. Messages name the file or record and say what to do.

use std::path::{Path, PathBuf};

/// What this crate's functions return.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Why something stored cannot be had, or something cannot be stored.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The operating system refused.
    #[error("{}: {source}", path.display())]
    Io {
        /// What was to be read or written.
        path: PathBuf,
        /// What it said.
        source: std::io::Error,
    },
    /// There is no room for a change; nothing of it was stored, and reading goes on.
    #[error("{}: no room is left on the disk: make some and try again", path.display())]
    Full {
        /// What was to be written.
        path: PathBuf,
    },
    /// There is no store in this folder.
    #[error("{} holds no store: create one there, or name another folder", dir.display())]
    NotFound {
        /// Where it was looked for.
        dir: PathBuf,
    },
    /// The folder, or the file, is there already and is not overwritten.
    #[error("{} exists already: remove it first, or name another place", path.display())]
    Exists {
        /// What would have been overwritten.
        path: PathBuf,
    },
    /// The folder holds something else than a store, or a part of one.
    #[error("{} is not a store: {reason}", dir.display())]
    NotAStore {
        /// The folder.
        dir: PathBuf,
        /// What is wrong with it, and what to do.
        reason: String,
    },
    /// Another process, or another handle of this one, has the store open.
    #[error("{}", in_use(dir, *pid, *shared))]
    InUse {
        /// The store.
        dir: PathBuf,
        /// The process that has it open, when it could be found out.
        pid: Option<u32>,
        /// Whether the store could still be opened for reading now.
        shared: bool,
    },
    /// A change was asked of a store that was opened for reading.
    #[error("{} is open for reading only: open it for writing", dir.display())]
    ReadOnly {
        /// The store.
        dir: PathBuf,
    },
    /// The store must be repaired or upgraded before it can be read, and this process may not write there.
    #[error("{} {what}, and cannot be written to: open it once with write permission", dir.display())]
    NeedsWriter {
        /// The store.
        dir: PathBuf,
        /// Why it cannot be read as it is.
        what: &'static str,
    },
    /// A change was asked for by a thread that is still reading the same store.
    #[error("{} is still being read by the thread that changes it: finish the scan or drop the view first", dir.display())]
    StillReading {
        /// The store.
        dir: PathBuf,
    },
    /// A record is not what was stored. It is never handed out.
    #[error("record {key} of table {table} is damaged ({reason}): restore a snapshot, or import the record again")]
    Damaged {
        /// Its table.
        table: String,
        /// Its key; bytes that are no text are replaced.
        key: String,
        /// How it was noticed.
        reason: String,
    },
    /// A file of the store cannot be read as what it should be.
    #[error("{} is damaged ({reason}): restore a snapshot into a new folder", path.display())]
    Corrupt {
        /// The file.
        path: PathBuf,
        /// What was found.
        reason: String,
    },
    /// A store or snapshot was written by a later release.
    #[error("{} has format {found}, this release knows up to {known}: use the release that wrote it ({written_by})", path.display())]
    Newer {
        /// The store or snapshot.
        path: PathBuf,
        /// Its format.
        found: u32,
        /// The latest that this release can read.
        known: u32,
        /// What wrote it.
        written_by: String,
    },
    /// A snapshot is cut off, altered or something else.
    #[error("{} is not a whole snapshot ({reason}): nothing was restored, use another one", path.display())]
    Snapshot {
        /// The file.
        path: PathBuf,
        /// What was found.
        reason: String,
    },
    /// The store needs a backend that this program was built without.
    #[error(
        "backend {name} is not in this program: build it with feature {name}, or restore a snapshot with another backend"
    )]
    NoBackend {
        /// Its name.
        name: String,
    },
    /// A table's name or a record's size is outside of what can be stored.
    #[error("{what}")]
    Limit {
        /// Value and limit.
        what: String,
    },
    /// A document or a filter names a field that the index does not have.
    #[error("no {kind} of the index is called {name}: it has {known}")]
    UnknownField {
        /// Text field, facet or number.
        kind: &'static str,
        /// The name.
        name: String,
        /// The names there are.
        known: String,
    },
    /// An index cannot be made, written or searched.
    #[error("{what}")]
    Index {
        /// What went wrong.
        what: String,
    },
    /// An embedder cannot be loaded, or failed.
    #[error("embedder {id}: {what}")]
    Embedder {
        /// Which one.
        id: String,
        /// What went wrong, and what to do.
        what: String,
    },
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
}

impl Error {
    /// Wraps what the operating system said about `path`.
    pub fn io(path: impl AsRef<Path>) -> impl FnOnce(std::io::Error) -> Self {
        move |source| {
            let path = path.as_ref().to_path_buf();
            if is_full(&source) { Self::Full { path } } else { Self::Io { path, source } }
        }
    }
}

/// Returns true when the system says that there is no room: of the disk, of a quota, or for files as large.
pub fn is_full(error: &std::io::Error) -> bool {
    use std::io::ErrorKind::{FileTooLarge, QuotaExceeded, StorageFull};
    matches!(error.kind(), StorageFull | QuotaExceeded | FileTooLarge)
}

fn in_use(dir: &Path, pid: Option<u32>, shared: bool) -> String {
    let by = pid.map_or_else(|| "another process".to_owned(), |pid| format!("process {pid}"));
    let dir = dir.display();
    if shared {
        format!("{dir} is being written by {by}: wait until it is done, or open the store for reading")
    } else {
        format!("{dir} is open in {by}, and its backend serves one process at a time: wait until it is done")
    }
}
