//! The one error type of this crate.

/// Why a stage could not produce its artifact.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The request cannot be honored in any form; the message says what and what to ask instead.
    #[error("{stage}: {message}")]
    Refused {
        /// Stage that refused.
        stage: &'static str,
        /// What is wrong and what would work: lower case, no full stop.
        message: String,
    },
    /// No artifact satisfies all hard rules within the search budget.
    #[error("{stage}: no solution found: {message}")]
    Infeasible {
        /// Stage that gave up.
        stage: &'static str,
        /// Which rules clash, and the least change that would help.
        message: String,
    },
    /// A document handed in does not fit the others (a floorplan of another graph).
    #[error("{stage}: {message}")]
    Mismatch {
        /// Stage that found it.
        stage: &'static str,
        /// What does not fit, with ids.
        message: String,
    },
    /// A plan that somebody brings cannot be read.
    #[error(transparent)]
    Plan(#[from] d3dgen_plans::Error),
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
}
