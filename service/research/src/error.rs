//! The one error type of this crate.

/// Why text cannot be worked on.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
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
    /// A file of a run cannot be read or written.
    #[error("cannot {action} {path}: {reason}")]
    File {
        /// What was tried: `read`, `write`, `make`.
        action: &'static str,
        /// The file or folder.
        path: String,
        /// What the system says.
        reason: String,
    },
    /// A document cannot be fetched.
    #[error("{url}: {reason}")]
    Fetch {
        /// The address that was asked for.
        url: String,
        /// Why, for programs.
        code: crate::fetch::Code,
        /// Why, for persons.
        reason: String,
    },
    /// A file of the cache of fetched documents cannot be written, or its folder cannot be read.
    #[error("cache: {path}: {reason}")]
    Cache {
        /// The file or folder.
        path: String,
        /// What the system says.
        reason: String,
    },
    /// A document cannot be read.
    #[error("{name}: {reason}")]
    Read {
        /// The file or address.
        name: String,
        /// Why, for programs: `too_large`, `unsupported_type`, `pdf_unavailable`, `pdf_timeout` and others of `read::pdf`.
        code: &'static str,
        /// Why, for persons.
        reason: String,
    },
    /// The user stopped; finished files are kept and the next run goes on from them.
    #[error("interrupted; what was finished is kept, and the same command goes on from there")]
    Interrupted,
    /// A language model could not be asked, or gave nothing that can be used.
    #[error("{stage}: {source}")]
    Model {
        /// What was asked.
        stage: String,
        /// Why.
        source: Box<d3dgen_llm::Error>,
    },
}

impl Error {
    /// Returns that a file of a run cannot be worked with.
    pub(crate) fn file(action: &'static str, path: &std::path::Path, error: &std::io::Error) -> Self {
        Self::File { action, path: path.display().to_string(), reason: error.to_string() }
    }

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
