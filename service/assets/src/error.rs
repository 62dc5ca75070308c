//! The one error type of this crate. Messages say what to do.

/// Why the asset database cannot do what was asked.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The storage refused.
    #[error(transparent)]
    Store(#[from] d3dgen_store::Error),
    /// A document is not of its form; every problem is listed.
    #[error(transparent)]
    Document(#[from] d3dgen_model::Error),
    /// There is no asset of this id.
    #[error("there is no asset `{asset_id}`; `assets search` finds by any words{}", near(known))]
    NoAsset {
        /// What was asked for.
        asset_id: String,
        /// Ids that are spelled alike.
        known: Vec<String>,
    },
    /// A file of the database cannot be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: std::path::PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The process that reads models cannot be started.
    #[error("cannot start the process that reads models, {}: {source}", program.display())]
    Start {
        /// The file of the program.
        program: std::path::PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A filter or argument is not usable.
    #[error("{0}")]
    Input(String),
}

fn near(known: &[String]) -> String {
    if known.is_empty() { String::new() } else { format!("; alike are {}", known.join(", ")) }
}
