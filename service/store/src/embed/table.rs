//! The static table: one vector for each of 30,522 tokens, in the binary; a text is the mean of its tokens.
//!
//! Needs no download, no start-up and about a microsecond a word. It knows no word order and little German; how it was
//! made and measured, and how to make it anew, is in `service/store/embedder/`.

use std::sync::OnceLock;

use super::word_piece::WordPiece;
use super::{Embedder, normalize};
use crate::error::Result;

pub(super) const VOCABULARY: &str = include_str!("../../embedder/vocab.txt");
static ROWS: &[u8] = include_bytes!("../../embedder/rows.i8");
static SCALES: &[u8] = include_bytes!("../../embedder/scales.f32");
static ID: &str = include_str!("../../embedder/table.txt");

/// Components of a vector.
const DIM: usize = 256;

/// The table that is built into the program.
///
/// # Examples
/// ```
/// use d3dgen_store::embed::{Embedder, StaticTable};
///
/// let table = StaticTable::new();
/// let vectors = table.embed(&["corridor width", "width of a hallway", "kitchen sink"])?;
/// let cosine = |a: usize, b: usize| vectors[a].iter().zip(&vectors[b]).map(|(x, y)| x * y).sum::<f32>();
/// assert!(cosine(0, 1) > cosine(0, 2));
/// # Ok::<(), d3dgen_store::Error>(())
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct StaticTable;

impl StaticTable {
    /// Returns the table. The vocabulary is indexed when the first text is embedded (about 2 ms), once a process.
    #[must_use]
    pub fn new() -> Self {
        Self
    }
}

impl Embedder for StaticTable {
    fn id(&self) -> &str {
        ID.trim_end()
    }

    fn dim(&self) -> usize {
        DIM
    }

    fn embed(&self, texts: &[&str]) -> Result<Vec<Vec<f32>>> {
        static WORD_PIECE: OnceLock<WordPiece> = OnceLock::new();
        let word_piece = WORD_PIECE.get_or_init(|| WordPiece::new(VOCABULARY));
        Ok(texts.iter().map(|text| embed_one(word_piece, text)).collect())
    }
}

fn embed_one(word_piece: &WordPiece, text: &str) -> Vec<f32> {
    let mut sum = vec![0.0; DIM];
    word_piece.tokens(text, |token| {
        let token = token as usize;
        let (rows, _) = ROWS.as_chunks::<DIM>();
        let (scales, _) = SCALES.as_chunks::<4>();
        let (Some(row), Some(&scale)) = (rows.get(token), scales.get(token)) else { return };
        let scale = f32::from_le_bytes(scale);
        for (total, &code) in sum.iter_mut().zip(row) {
            *total += f32::from(code.cast_signed()) * scale;
        }
    });
    // The mean has the direction of the sum.
    normalize(&mut sum);
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cosine(a: &str, b: &str) -> f32 {
        let vectors = StaticTable::new().embed(&[a, b]).unwrap();
        vectors[0].iter().zip(&vectors[1]).map(|(x, y)| x * y).sum()
    }

    #[test]
    fn files_fit_together() {
        let tokens = VOCABULARY.lines().count();
        assert_eq!(ROWS.len(), tokens * DIM);
        assert_eq!(SCALES.len(), tokens * 4);
        assert!(ID.trim_end().ends_with("+256"), "{ID}");
    }

    #[test]
    fn texts_without_known_words_are_similar_to_nothing() {
        for text in ["", "  \n", "\u{200b}"] {
            assert!(StaticTable::new().embed(&[text]).unwrap()[0].iter().all(|x| *x == 0.0), "{text:?}");
        }
    }

    #[test]
    fn similar_meanings_are_near() {
        for (text, near, far) in [
            ("sofa", "couch", "bathtub"),
            ("sofa", "settee", "forklift"),
            ("Breite des Flurs", "corridor width", "kitchen sink"),
            ("Krankenzimmer", "patient room", "parking space"),
        ] {
            assert!(cosine(text, near) > cosine(text, far) + 0.1, "{text}: {near} {far}");
        }
        assert!((cosine("Corridor, WIDTH!", "corridor , width !") - 1.0).abs() < 1e-5);
    }
}
