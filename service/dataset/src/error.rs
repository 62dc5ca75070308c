//! Why a data set cannot be made, read or served.

use std::io;
use std::path::{Path, PathBuf};

/// Why work on a data set stopped.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// What was asked for cannot be done; the message says what would work.
    #[error("{0}")]
    Input(String),
    /// A spec is no TOML, or breaks a rule of its form.
    #[error("{file}: {reason}")]
    Spec {
        /// The file.
        file: String,
        /// Every problem, with its place.
        reason: String,
    },
    /// A file or folder cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A file or folder cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A file is not what its name or its sum says.
    #[error("{}: {reason}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A world cannot be written in a format: a fault of the run, not of one world.
    #[error(transparent)]
    Export(#[from] d3dgen_export::Error),
    /// A queue or a store of objects refused or cannot be reached.
    #[error("{0}")]
    Cluster(String),
    /// There is no room left on the disk, or the run has used up what it may.
    #[error("{0}")]
    Full(String),
    /// Whoever waits for the data set has given up.
    #[error("interrupted; what is done is kept, and the same command goes on from there")]
    Interrupted,
}

impl Error {
    /// Returns a failure to read.
    pub(crate) fn read(path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_path_buf();
        move |source| Self::Read { path, source }
    }

    /// Returns a failure to write; a full disk is said as such.
    pub(crate) fn write(path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_path_buf();
        move |source| match source.kind() {
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => Self::Full(format!(
                "no room left for {}; what is done is kept: free some and run the same command again",
                path.display()
            )),
            _ => Self::Write { path, source },
        }
    }

    /// Returns that a file is damaged.
    pub(crate) fn damaged(path: &Path, reason: impl Into<String>) -> Self {
        Self::Damaged { path: path.to_path_buf(), reason: reason.into() }
    }
}
