//! Both ways to the nearest vectors by themselves, for the bench that decides between them. Not for other use.

use super::document::Watch;
use super::graph::Graph;
use super::row_set::RowSet;
use super::vectors::Vectors;
use crate::error::Result;

/// Vectors of length 1, one after the other, with a graph if one was asked for.
pub struct Paths {
    vectors: Vectors,
    graph: Option<Graph>,
    rows: u32,
}

impl Paths {
    /// Keeps the vectors, and links them when `linked`.
    ///
    /// # Errors
    /// None but those of the graph.
    pub fn new(dim: usize, full: Vec<f32>, linked: bool) -> Result<Self> {
        let rows = u32::try_from(full.len() / dim).unwrap_or(u32::MAX);
        let vectors = Vectors::new(dim, full);
        let graph = if linked { Some(Graph::new(&vectors, rows, Watch::nobody())?) } else { None };
        Ok(Self { vectors, graph, rows })
    }

    /// Returns the nearest rows with their cosines, by the scan or by the graph. Only every `every`-th row counts.
    #[must_use]
    pub fn nearest(&self, question: &[f32], limit: usize, every: u32, by_graph: bool) -> Vec<(u32, f32)> {
        let allowed = (every > 1).then(|| {
            let mut set = RowSet::none(self.rows);
            (0..self.rows).step_by(every as usize).for_each(|row| set.insert(row));
            set
        });
        let found = match &self.graph {
            Some(graph) if by_graph => {
                let near = graph.near(question, limit, allowed.as_ref());
                self.vectors.rank(question, near.into_iter(), limit)
            }
            _ => self.vectors.scan(question, limit, allowed.as_ref()),
        };
        found.into_iter().map(|s| (s.row, s.score)).collect()
    }

    /// Returns the same by the full vectors alone, one by one.
    #[must_use]
    pub fn exact(&self, question: &[f32], limit: usize, every: u32) -> Vec<(u32, f32)> {
        let rows = (0..self.rows).step_by(every.max(1) as usize);
        self.vectors.rank(question, rows, limit).into_iter().map(|s| (s.row, s.score)).collect()
    }
}
