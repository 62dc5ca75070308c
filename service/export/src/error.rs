//! The one error type of this crate.

/// Why a world could not be written in a format.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The format has no way to say something that the world contains.
    #[error("{exporter} cannot write {subject}: {reason}")]
    Unsupported {
        /// Name of the exporter.
        exporter: &'static str,
        /// Id of the room, door or placement.
        subject: String,
        /// What the format lacks, and what would be right.
        reason: String,
    },
    /// The model of an object could not be made.
    #[error(transparent)]
    Model(#[from] d3dgen_mesh::Error),
    /// A model is broken.
    #[error("the model of {asset} cannot be written: {source}; remove it from the database of assets or mend it")]
    Asset {
        /// Its reference.
        asset: String,
        /// What is wrong with it.
        source: d3dgen_mesh::Error,
    },
    /// A database of assets could not give a model.
    #[error("{asset}: {reason}")]
    Kept {
        /// Its reference.
        asset: String,
        /// What went wrong, and what to do.
        reason: String,
    },
    /// The world is larger than the pictures of this format may be.
    #[error("{picture} would be {width} x {height} px, the limit is {limit} px a side")]
    TooLarge {
        /// Which picture.
        picture: &'static str,
        /// Width, px.
        width: usize,
        /// Height, px.
        height: usize,
        /// Largest side allowed, px.
        limit: usize,
    },
    /// The drawing library refused a picture; a bug of ours.
    #[error("{picture} could not be drawn: {reason}")]
    Picture {
        /// Which picture.
        picture: &'static str,
        /// What the library said.
        reason: String,
    },
}
