//! Texts to vectors: the trait, the static table that is always there, a transformer behind feature `fastembed`, and
//! both together.
//!
//! Vectors of two embedders cannot be compared: an index remembers which one made it by [`Embedder::id`]. What texts
//! mean to a domain is not known here.

mod ensemble;
pub mod table;
#[cfg(feature = "fastembed")]
pub mod transformer;
mod word_piece;

pub use ensemble::Ensemble;
pub use table::StaticTable;
#[cfg(feature = "fastembed")]
pub use transformer::{Transformer, TransformerFiles};

use crate::error::Result;

/// Makes vectors of texts.
pub trait Embedder: Send + Sync {
    /// Returns name, version, digest of the weights and dimension: equal for two embedders only if their vectors are.
    fn id(&self) -> &str;

    /// Returns how many components a vector has.
    fn dim(&self) -> usize;

    /// Returns one vector a text, in order, each of length 1, so that a dot product is the cosine. A text without any
    /// known word has the zero vector, which is similar to nothing.
    ///
    /// # Errors
    /// [`Error::Embedder`](crate::Error::Embedder) when a model fails; the static table never does.
    fn embed(&self, texts: &[&str]) -> Result<Vec<Vec<f32>>>;
}

/// Scales a vector to length 1; the zero vector, and one that is not finite, become zero.
pub(crate) fn normalize(vector: &mut [f32]) {
    let length = vector.iter().map(|x| x * x).sum::<f32>().sqrt();
    let factor = if length.is_finite() && length > 1e-12 { 1.0 / length } else { 0.0 };
    for x in vector {
        *x = if factor > 0.0 { *x * factor } else { 0.0 };
    }
}
