//! The one error type of this crate. Messages say what to do.

use d3dgen_model::Problem;

/// Why the database cannot do what was asked.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The storage refused.
    #[error(transparent)]
    Store(#[from] d3dgen_store::Error),
    /// A knowledge base is not JSON, or breaks its schema or its rules; every problem is listed.
    #[error(transparent)]
    Document(#[from] d3dgen_model::Error),
    /// The database has no such domain.
    #[error("the database holds no rules of domain `{domain}`; it has {}", listed(known))]
    NoDomain {
        /// What was asked for.
        domain: String,
        /// What there is.
        known: Vec<String>,
    },
    /// There is no change of this number.
    #[error("there is no change {seq}; `history` lists them")]
    NoChange {
        /// What was asked for.
        seq: u64,
    },
    /// A change cannot be undone.
    #[error("change {seq} cannot be undone: {reason}")]
    NotUndoable {
        /// The change.
        seq: u64,
        /// Why, and what would help.
        reason: String,
    },
    /// A change would leave a knowledge base that breaks its rules.
    #[error("the change would break the rules of domain `{domain}`:{}", problems.iter().map(|p| format!("\n  {p}")).collect::<String>())]
    Breaks {
        /// The domain.
        domain: String,
        /// Every problem, with its path.
        problems: Vec<Problem>,
    },
    /// The domain was changed between the look and the write.
    #[error("domain `{domain}` was changed meanwhile: look at the difference again")]
    Outdated {
        /// The domain.
        domain: String,
    },
    /// A filter or argument is not usable.
    #[error("{0}")]
    Input(String),
}

fn listed(known: &[String]) -> String {
    if known.is_empty() { "none".into() } else { known.join(", ") }
}
