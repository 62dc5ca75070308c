//! The one error type of this crate: why a server cannot start or go on. Answers to clients are made in `status`.

use std::path::PathBuf;

/// Why a server cannot start or go on.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A setting cannot be used.
    #[error("{place}: {reason}")]
    Config {
        /// File, variable, flag or key.
        place: String,
        /// What is wrong and what would work.
        reason: String,
    },
    /// A file cannot be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The address cannot be listened on.
    #[error("cannot listen on {address}: {source}")]
    Listen {
        /// The address.
        address: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// Certificate or key cannot be used.
    #[error("TLS: {0}")]
    Tls(String),
    /// The transport broke down.
    #[error("the server stopped: {0}")]
    Transport(String),
    /// The storage refused.
    #[error(transparent)]
    Store(#[from] d3dgen_store::Error),
    /// The database of rules refused.
    #[error(transparent)]
    Knowledge(#[from] d3dgen_knowledge::Error),
    /// The database of assets refused.
    #[error(transparent)]
    Assets(#[from] d3dgen_assets::Error),
    /// A registered domain cannot be read any more.
    #[error("domain `{id}`: {reason}")]
    Domain {
        /// Its id.
        id: String,
        /// What is wrong.
        reason: String,
    },
    /// A record of the server is not what it should be.
    #[error("record {key} of table {table} is damaged ({reason}): restore a backup")]
    Record {
        /// Its table.
        table: &'static str,
        /// Its key.
        key: String,
        /// What is wrong.
        reason: String,
    },
}
