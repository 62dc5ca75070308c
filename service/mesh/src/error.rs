//! The one error type of this crate.

/// Why a model could not be made or written.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// An object names a build that does not exist.
    #[error("object `{object}` is made by the build `{build}`, which does not exist; see domains/builds")]
    NoBuild {
        /// Id of the object type.
        object: String,
        /// Id of the build.
        build: String,
    },
    /// A list of builds cannot be used.
    #[error("build at {path}: {reason}")]
    Builds {
        /// JSON pointer into the list.
        path: String,
        /// What is wrong.
        reason: String,
    },
    /// A build cannot be made at a size.
    #[error("build `{build}` at {size} m, {place}: {reason}")]
    Build {
        /// Id of the build.
        build: String,
        /// Width x depth x height.
        size: String,
        /// Part and field: `part 3 (seat), x/1`.
        place: String,
        /// What is wrong, and what would be right.
        reason: String,
    },
    /// A size is not one that models can have.
    #[error("object `{object}` cannot be {size} m: each extent is between 0.001 and 100 m")]
    Size {
        /// Id of the object type.
        object: String,
        /// Width x depth x height.
        size: String,
    },
    /// A model has something that a file format cannot say.
    #[error("model `{model}` cannot be written: {reason}")]
    Model {
        /// Name of the model.
        model: String,
        /// What is wrong.
        reason: String,
    },
    /// The picture library refused; a bug of ours.
    #[error("the picture could not be written: {reason}")]
    Picture {
        /// What the library said.
        reason: String,
    },
}
