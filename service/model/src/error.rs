//! The one error type of this crate.

use crate::document::Problem;

/// Why a document could not be read.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The text is not JSON at all.
    #[error("{kind} is not JSON: {reason}")]
    NotJson {
        /// Which document was expected, for instance `floorplan`.
        kind: &'static str,
        /// Line, column and cause as the JSON parser reports them.
        reason: String,
    },
    /// The document is JSON but breaks its schema or its own rules; every problem is listed.
    #[error("{kind} has {} problem(s):{}", problems.len(), listed(problems))]
    Invalid {
        /// Which document was expected, for instance `floorplan`.
        kind: &'static str,
        /// Every problem found, in document order.
        problems: Vec<Problem>,
    },
}

fn listed(problems: &[Problem]) -> String {
    problems.iter().map(|p| format!("\n  {p}")).collect()
}
