//! Nearest vectors by cosine, exactly: a scan over int8 codes picks candidates, their full vectors decide.
//!
//! A scan costs the same for any question and only looks at the rows that a filter leaves, so it serves everything that
//! is small or filtered. The graph in `graph.rs` takes over where it is measured to be faster.

use std::path::Path;

use super::row_set::RowSet;
use super::top::{Scored, Top};
use crate::error::{Error, Result};

/// Candidates by codes for each row asked for. Codes err by about 0.004 in the cosine; 4 loses nothing measurable.
const CANDIDATES: usize = 4;

/// The vectors of all rows, as they are and as codes.
#[derive(Debug, Default)]
pub(crate) struct Vectors {
    dim: usize,
    full: Vec<f32>,
    codes: Vec<i8>,
    /// What a row's codes are multiplied with; 0 for rows without a vector.
    scales: Vec<f32>,
}

impl Vectors {
    /// Keeps one vector a row, one after the other.
    pub(crate) fn new(dim: usize, full: Vec<f32>) -> Self {
        let mut codes = Vec::with_capacity(full.len());
        let mut scales = Vec::with_capacity(full.len() / dim.max(1));
        for vector in full.chunks_exact(dim.max(1)) {
            scales.push(quantize(vector, &mut codes));
        }
        Self { dim, full, codes, scales }
    }

    /// Reads what [`Vectors::bytes`] wrote.
    pub(crate) fn from_bytes(dim: usize, rows: u32, bytes: &[u8], path: &Path) -> Result<Self> {
        let (numbers, rest) = bytes.as_chunks::<4>();
        let expected = rows as usize * dim;
        if !rest.is_empty() || numbers.len() != expected {
            let reason = format!("{} bytes, expected {}", bytes.len(), expected * 4);
            return Err(Error::Corrupt { path: path.to_path_buf(), reason });
        }
        Ok(Self::new(dim, numbers.iter().map(|n| f32::from_le_bytes(*n)).collect()))
    }

    pub(crate) fn bytes(&self) -> Vec<u8> {
        self.full.iter().flat_map(|x| x.to_le_bytes()).collect()
    }

    /// Returns the codes of each row that has a vector.
    pub(crate) fn coded(&self) -> impl Iterator<Item = (u32, &[i8])> {
        let rows = (0..).zip(self.codes.chunks_exact(self.dim.max(1))).zip(&self.scales);
        rows.filter(|(_, scale)| **scale > 0.0).map(|(row, _)| row)
    }

    /// Returns the `limit` rows nearest to `question` of length 1, best first, with their cosines.
    pub(crate) fn scan(&self, question: &[f32], limit: usize, allowed: Option<&RowSet>) -> Vec<Scored> {
        let mut codes = Vec::with_capacity(self.dim);
        if question.len() != self.dim || quantize(question, &mut codes) <= 0.0 {
            return Vec::new();
        }
        let mut top = Top::new(limit.saturating_mul(CANDIDATES).max(32));
        let mut consider = |row: u32, row_codes: &[i8], scale: f32| {
            if scale > 0.0 {
                top.push(dot_codes(&codes, row_codes) as f32 * scale, row);
            }
        };
        match allowed {
            None => {
                let rows = (0..).zip(self.codes.chunks_exact(self.dim)).zip(&self.scales);
                rows.for_each(|((row, codes), &scale)| consider(row, codes, scale));
            }
            Some(allowed) => allowed.iter().for_each(|row| {
                let begin = row as usize * self.dim;
                if let (Some(codes), Some(&scale)) =
                    (self.codes.get(begin..begin + self.dim), self.scales.get(row as usize))
                {
                    consider(row, codes, scale);
                }
            }),
        }
        self.rank(question, top.into_sorted().into_iter().map(|s| s.row), limit)
    }

    /// Returns the best `limit` of some rows by their full vectors.
    pub(crate) fn rank(&self, question: &[f32], rows: impl Iterator<Item = u32>, limit: usize) -> Vec<Scored> {
        let mut top = Top::new(limit);
        for row in rows {
            let begin = row as usize * self.dim;
            if let Some(vector) = self.full.get(begin..begin + self.dim) {
                top.push(vector.iter().zip(question).map(|(a, b)| a * b).sum(), row);
            }
        }
        top.into_sorted()
    }
}

/// Appends the codes of a vector, and returns what they are to be multiplied with.
pub(crate) fn quantize(vector: &[f32], codes: &mut Vec<i8>) -> f32 {
    let largest = vector.iter().fold(0.0_f32, |most, x| most.max(x.abs()));
    let usable = largest > 0.0 && largest.is_finite();
    let factor = if usable { 127.0 / largest } else { 0.0 };
    codes.extend(vector.iter().map(|x| (x * factor).round() as i8));
    if usable { largest / 127.0 } else { 0.0 }
}

/// Returns the dot product. Written so that the compiler makes 16-bit multiply-adds of it.
#[inline]
pub(crate) fn dot_codes(a: &[i8], b: &[i8]) -> i32 {
    a.iter().zip(b).map(|(&x, &y)| i32::from(i16::from(x) * i16::from(y))).sum()
}
