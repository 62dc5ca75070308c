//! The one error type of this crate.

/// Why text cannot be worked on.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// A line is not `{"id", "text", "lang"}`.
    #[error("line {line}: {reason}")]
    Line {
        /// Counting from 1.
        line: usize,
        /// What is wrong with it.
        reason: String,
    },
}
