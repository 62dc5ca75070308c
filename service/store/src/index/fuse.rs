//! Reciprocal rank fusion: one ranking of two, without comparing scores that have no common scale.
//!
//! Cormack, Clarke, Büttcher: Reciprocal rank fusion outperforms Condorcet and individual rank learning methods
//! (SIGIR 2009); k = 60 is theirs.

use std::collections::BTreeMap;

use super::top::Scored;

const K: f64 = 60.0;

/// A row with its places in the rankings, from 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Fused {
    pub(crate) row: u32,
    pub(crate) score: f64,
    pub(crate) text_rank: Option<usize>,
    pub(crate) vector_rank: Option<usize>,
    pub(crate) similarity: Option<f32>,
}

/// Returns the rows of both rankings, best first; equal scores in the order of rows.
pub(crate) fn fuse(by_text: &[Scored], by_vector: &[Scored]) -> Vec<Fused> {
    let mut rows: BTreeMap<u32, Fused> = BTreeMap::new();
    for (rank, found) in (1..).zip(by_text) {
        let fused = rows.entry(found.row).or_insert(Fused { row: found.row, ..Fused::default() });
        fused.text_rank = Some(rank);
        fused.score += 1.0 / (K + rank as f64);
    }
    for (rank, found) in (1..).zip(by_vector) {
        let fused = rows.entry(found.row).or_insert(Fused { row: found.row, ..Fused::default() });
        fused.vector_rank = Some(rank);
        fused.similarity = Some(found.score);
        fused.score += 1.0 / (K + rank as f64);
    }
    let mut fused: Vec<Fused> = rows.into_values().collect();
    fused.sort_by(|a, b| b.score.total_cmp(&a.score).then(a.row.cmp(&b.row)));
    fused
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_in_both_rankings_come_first() {
        let ranking = |rows: &[u32]| rows.iter().map(|&row| Scored { score: 0.5, row }).collect::<Vec<_>>();
        let fused = fuse(&ranking(&[7, 3, 5]), &ranking(&[9, 3]));
        assert_eq!(fused.iter().map(|f| f.row).collect::<Vec<_>>(), [3, 7, 9, 5]);
        assert_eq!((fused[0].text_rank, fused[0].vector_rank), (Some(2), Some(2)));
        assert!((fused[0].score - 2.0 / 62.0).abs() < 1e-12);
    }
}
