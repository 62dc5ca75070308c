//! The one error type of this crate.

use std::path::PathBuf;

/// Why a folder is not a domain.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A file is missing or is not TOML.
    #[error("domain folder {folder}: {reason}", folder = folder.display())]
    Unreadable {
        /// The folder.
        folder: PathBuf,
        /// File and cause.
        reason: String,
    },
    /// A file breaks its schema or its own rules; every problem is in the source.
    #[error("{file}: {source}", file = file.display())]
    Invalid {
        /// The file, or `domain.toml` for the merged tables.
        file: PathBuf,
        /// Every problem with its path.
        source: d3dgen_model::Error,
    },
    /// Another domain has the id.
    #[error("domain folder {folder}: id `{id}` is taken by a built-in domain or an earlier folder; choose another", folder = folder.display())]
    Taken {
        /// The folder.
        folder: PathBuf,
        /// The id.
        id: String,
    },
}
