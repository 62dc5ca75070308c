//! The one error type of this crate, and the exit code each kind ends with.

use std::io;
use std::path::PathBuf;

/// Why a command stopped.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A flag or argument cannot be used; the message says which and what would work.
    #[error("{0}")]
    Input(String),
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
    /// A file is not the document it should be.
    #[error("{}: {source}", path.display())]
    Document {
        /// The file.
        path: PathBuf,
        /// Every problem found in it.
        source: d3dgen_model::Error,
    },
    /// A plan cannot be read.
    #[error("{}: {source}", path.display())]
    Plan {
        /// The file.
        path: PathBuf,
        /// What is wrong with it, and where.
        source: d3dgen_plans::Error,
    },
    /// A domain folder cannot be used.
    #[error(transparent)]
    Domain(#[from] d3dgen_plugins::Error),
    /// The knowledge database refused.
    #[error(transparent)]
    Knowledge(#[from] d3dgen_knowledge::Error),
    /// The asset database refused.
    #[error(transparent)]
    Assets(#[from] d3dgen_assets::Error),
    /// A stage refused.
    #[error(transparent)]
    Stage(#[from] d3dgen_pipeline::Error),
    /// A world cannot be written in a format.
    #[error(transparent)]
    Export(#[from] d3dgen_export::Error),
    /// A data set cannot be made or read.
    #[error(transparent)]
    Dataset(#[from] d3dgen_dataset::Error),
    /// A list of the measures cannot be used.
    #[error(transparent)]
    Eval(#[from] d3dgen_eval::Error),
    /// The server cannot start or go on.
    #[error(transparent)]
    Server(#[from] d3dgen_server::Error),
    /// A server refused, cannot be reached, or answers in another way than it should.
    #[error("server: {0}")]
    Remote(String),
    /// A world breaks hard rules.
    #[error("{0}")]
    Unsound(String),
    /// The user pressed Ctrl-C.
    #[error("interrupted; nothing half-written is left behind")]
    Interrupted,
}

impl Error {
    /// Returns the exit code: 1 for an unsound world, 130 after Ctrl-C, 2 for all else.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Unsound(_) => 1,
            Self::Interrupted
            | Self::Knowledge(d3dgen_knowledge::Error::Store(d3dgen_store::Error::Cancelled))
            | Self::Assets(d3dgen_assets::Error::Store(d3dgen_store::Error::Cancelled))
            | Self::Dataset(d3dgen_dataset::Error::Interrupted)
            | Self::Stage(d3dgen_pipeline::Error::Cancelled) => 130,
            _ => 2,
        }
    }
}
