//! The one error type of this crate.

/// How a refusal of walls that enclose nothing begins.
pub(crate) const ENCLOSE_NONE: &str = "enclose no room";

/// Why a plan cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// No reader knows the file, or the named format does not exist.
    #[error("{0}")]
    UnknownFormat(String),
    /// The file is not what its format demands.
    #[error("{format}: {place}: {message}")]
    Broken {
        /// Name of the format.
        format: &'static str,
        /// Where in the file: a line, a path, a feature, an element.
        place: String,
        /// What is wrong and what would be right: lower case, no full stop.
        message: String,
    },
    /// What is drawn cannot be a plan.
    #[error("{place}: {message}")]
    Refused {
        /// Which room, wall, edge or flag.
        place: String,
        /// What is wrong and what would work: lower case, no full stop.
        message: String,
    },
}

impl Error {
    pub(crate) fn refused(place: impl Into<String>, message: impl Into<String>) -> Self {
        Self::Refused { place: place.into(), message: message.into() }
    }

    /// Returns the error with the storey in its place.
    pub(crate) fn on_level(self, level: &str) -> Self {
        match self {
            Self::Refused { place, message } => Self::Refused { place: format!("level {level}: {place}"), message },
            other => other,
        }
    }

    /// Returns the error with the layers of the drawing, where nothing in it encloses a room.
    pub(crate) fn with_layers(self, layers: &str) -> Self {
        match self {
            Self::Refused { place, message } if message.starts_with(ENCLOSE_NONE) => {
                Self::Refused { place, message: message + layers }
            }
            other => other,
        }
    }

    /// Returns the error of a part of a file, with its name in the place.
    pub(crate) fn in_file(self, format: &'static str, file: &str) -> Self {
        match self {
            Self::Broken { place, message, .. } => Self::Broken { format, place: format!("{file}: {place}"), message },
            other => other,
        }
    }

    pub(crate) fn broken(format: &'static str, place: impl Into<String>, message: impl Into<String>) -> Self {
        Self::Broken { format, place: place.into(), message: message.into() }
    }
}
