//! Two embedders as one: each puts right what the other misjudges.

use std::sync::Arc;

use super::{Embedder, StaticTable, normalize};
use crate::error::Result;

/// Puts the vectors of two embedders behind each other, so that a cosine is the weighted mean of both cosines. Where one
/// does not know a text, the other speaks for both.
pub struct Ensemble {
    parts: [(Arc<dyn Embedder>, f32); 2],
    id: String,
}

impl std::fmt::Debug for Ensemble {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Ensemble of {}", self.id)
    }
}

impl Ensemble {
    /// Joins two embedders, each with its weight.
    #[must_use]
    pub fn new(parts: [(Arc<dyn Embedder>, f32); 2]) -> Self {
        let id =
            parts.iter().map(|(part, weight)| format!("{weight} {}", part.id())).collect::<Vec<_>>().join(" with ");
        Self { parts, id }
    }

    /// Joins the table of this program with a model of sentences. The table was trained on the words of buildings, the
    /// model on everything: together they find assets better than each alone (mean reciprocal rank over the questions
    /// of `service/assets/tests/retrieval.rs`), and most so with twice the weight on the table.
    #[must_use]
    pub fn of_table_and(model: Arc<dyn Embedder>) -> Self {
        Self::new([(Arc::new(StaticTable::new()), 2.0), (model, 1.0)])
    }
}

impl Embedder for Ensemble {
    fn id(&self) -> &str {
        &self.id
    }

    fn dim(&self) -> usize {
        self.parts.iter().map(|(part, _)| part.dim()).sum()
    }

    fn embed(&self, texts: &[&str]) -> Result<Vec<Vec<f32>>> {
        let [(first, first_weight), (second, second_weight)] = &self.parts;
        // A cosine is a sum of products, so that each factor has the root of the weight.
        let (a_factor, b_factor) = (first_weight.sqrt(), second_weight.sqrt());
        let join = |(a, b): (Vec<f32>, Vec<f32>)| {
            let mut joined: Vec<f32> = a.iter().map(|x| x * a_factor).chain(b.iter().map(|x| x * b_factor)).collect();
            normalize(&mut joined);
            joined
        };
        Ok(first.embed(texts)?.into_iter().zip(second.embed(texts)?).map(join).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Knows only one word.
    struct Door;

    impl Embedder for Door {
        fn id(&self) -> &str {
            "door"
        }

        fn dim(&self) -> usize {
            2
        }

        fn embed(&self, texts: &[&str]) -> Result<Vec<Vec<f32>>> {
            Ok(texts.iter().map(|t| if t.contains("door") { vec![0.6, 0.8] } else { vec![0.0; 2] }).collect())
        }
    }

    #[test]
    fn a_cosine_is_the_weighted_mean_of_both() {
        let table: Arc<dyn Embedder> = Arc::new(StaticTable::new());
        let both = Ensemble::new([(table.clone(), 3.0), (Arc::new(Door), 1.0)]);
        assert_eq!((both.dim(), both.id()), (258, format!("3 {} with 1 door", table.id()).as_str()));
        let dot = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f32>();
        let texts = ["the front door", "a door to the yard", "corridor width"];
        let (joined, alone) = (both.embed(&texts).unwrap(), table.embed(&texts).unwrap());
        let mean = (3.0 * dot(&alone[0], &alone[1]) + 1.0) / 4.0;
        assert!((dot(&joined[0], &joined[1]) - mean).abs() < 1e-5);
        // The door is not known to the last text: its table's vector is all it has.
        let share = dot(&alone[0], &alone[2]) * 0.75_f32.sqrt();
        assert!((dot(&joined[0], &joined[2]) - share).abs() < 1e-5);
        joined.iter().for_each(|v| assert!((dot(v, v) - 1.0).abs() < 1e-5));
    }
}
