//! The one error type of this crate.

/// Why a built-in list cannot be used; its text is checked by a test, so a release never returns it.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A data file of this crate is broken.
    #[error("service/eval/data/{file}: {reason}")]
    Data {
        /// The file.
        file: &'static str,
        /// What the parser said, with line and column.
        reason: String,
    },
}
