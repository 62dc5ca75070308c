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
    /// Documents, stage files or settings have problems; every one is listed with its file and place.
    #[error("{}", .0.join("\n"))]
    Problems(Vec<String>),
}

impl Error {
    /// Returns the problems of a document of the model, each with the file's name.
    pub fn of_document(file: &str, error: d3dgen_model::Error) -> Self {
        match error {
            d3dgen_model::Error::Invalid { problems, .. } => {
                Self::Problems(problems.iter().map(|p| format!("{file}: {p}")).collect())
            }
            d3dgen_model::Error::NotJson { reason, .. } => {
                Self::Problems(vec![format!("{file}: is not JSON: {reason}")])
            }
        }
    }
}
