//! Nearest vectors by cosine, exactly: a scan over int8 codes picks candidates, their full vectors decide.
//!
//! A scan costs the same for any question and only looks at the rows that a filter leaves, so it serves everything that
//! is small or filtered. The graph in `graph.rs` takes over where it is measured to be faster.

use std::path::Path;

use pulp::{Arch, Simd, WithSimd};

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

    /// Reads what [`Vectors::write`] wrote.
    pub(crate) fn from_bytes(dim: usize, rows: u32, bytes: &[u8], path: &Path) -> Result<Self> {
        let (numbers, rest) = bytes.as_chunks::<4>();
        let expected = rows as usize * dim;
        if !rest.is_empty() || numbers.len() != expected {
            let reason = format!("{} bytes, expected {}", bytes.len(), expected * 4);
            return Err(Error::Corrupt { path: path.to_path_buf(), reason });
        }
        Ok(Self::new(dim, numbers.iter().map(|n| f32::from_le_bytes(*n)).collect()))
    }

    /// Writes the vectors as numbers of four bytes, the low one first.
    pub(crate) fn write(&self, to: &mut impl std::io::Write) -> std::io::Result<()> {
        self.full.iter().try_for_each(|x| to.write_all(&x.to_le_bytes()))
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
        Arch::new().dispatch(Scan { vectors: self, codes: &codes, allowed, top: &mut top });
        self.rank(question, top.into_sorted().into_iter().map(|s| s.row), limit)
    }

    /// Returns the best `limit` of some rows by their full vectors.
    pub(crate) fn rank(&self, question: &[f32], rows: impl Iterator<Item = u32>, limit: usize) -> Vec<Scored> {
        let mut top = Top::new(limit);
        for row in rows {
            let begin = row as usize * self.dim;
            if let Some(vector) = self.full.get(begin..begin + self.dim) {
                top.push(dot(vector, question), row);
            }
        }
        top.into_sorted()
    }
}

/// A scan over the codes, compiled for each width of vector registers; which one runs is decided when it begins.
struct Scan<'a> {
    vectors: &'a Vectors,
    codes: &'a [i8],
    allowed: Option<&'a RowSet>,
    top: &'a mut Top,
}

impl WithSimd for Scan<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Vectors { dim, codes, scales, .. } = self.vectors;
        let mut consider = |row: u32, row_codes: &[i8], scale: f32| {
            if scale > 0.0 {
                self.top.push(dot_codes(self.codes, row_codes) as f32 * scale, row);
            }
        };
        match self.allowed {
            None => {
                for ((row, codes), &scale) in (0..).zip(codes.chunks_exact(*dim)).zip(scales) {
                    consider(row, codes, scale);
                }
            }
            Some(allowed) => {
                for row in allowed.iter() {
                    let begin = row as usize * dim;
                    if let (Some(codes), Some(&scale)) = (codes.get(begin..begin + dim), scales.get(row as usize)) {
                        consider(row, codes, scale);
                    }
                }
            }
        }
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

/// Returns the dot product of codes. Blocks of a fixed length let the compiler make 16-bit multiply-adds of it: 24 ns for
/// 256 codes where a plain sum takes 55.
#[inline(always)]
pub(crate) fn dot_codes(a: &[i8], b: &[i8]) -> i32 {
    let product = |(x, y): (&i8, &i8)| i32::from(*x) * i32::from(*y);
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<32>(), b.as_chunks::<32>());
    let blocks: i32 = a.iter().zip(b).map(|(a, b)| a.iter().zip(b).map(product).sum::<i32>()).sum();
    blocks + a_rest.iter().zip(b_rest).map(product).sum::<i32>()
}

/// Returns the dot product. Sixteen sums side by side, as floats may not be added in another order by the compiler.
fn dot(a: &[f32], b: &[f32]) -> f32 {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<16>(), b.as_chunks::<16>());
    let mut sums = [0.0_f32; 16];
    for (a, b) in a.iter().zip(b) {
        for ((sum, x), y) in sums.iter_mut().zip(a).zip(b) {
            *sum += x * y;
        }
    }
    sums.iter().sum::<f32>() + a_rest.iter().zip(b_rest).map(|(x, y)| x * y).sum::<f32>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dot_products_take_every_length() {
        for length in [0, 1, 31, 32, 33, 256, 300] {
            let a: Vec<i8> = (0..length).map(|i| (i * 7 % 255 - 127) as i8).collect();
            let b: Vec<i8> = (0..length).map(|i| (i * 13 % 255 - 127) as i8).collect();
            let plain: i32 = a.iter().zip(&b).map(|(&x, &y)| i32::from(x) * i32::from(y)).sum();
            assert_eq!(dot_codes(&a, &b), plain);
            let floats = |codes: &[i8]| codes.iter().map(|&c| f32::from(c) / 8.0).collect::<Vec<_>>();
            assert!((dot(&floats(&a), &floats(&b)) - plain as f32 / 64.0).abs() <= f32::EPSILON * plain.abs() as f32);
        }
    }

    #[test]
    fn the_scan_finds_what_the_full_vectors_say() {
        let mut state = 9_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1 << 23) as f32 - 1.0
        };
        let (dim, rows) = (40, 2000);
        let mut full: Vec<f32> = (0..dim * rows).map(|_| random()).collect();
        full.chunks_exact_mut(dim).for_each(crate::embed::normalize);
        // One row without a vector.
        full[dim * 5..dim * 6].fill(0.0);
        let vectors = Vectors::new(dim, full.clone());
        let mut allowed = RowSet::none(rows as u32);
        (0..rows as u32).filter(|row| row % 7 < 3).for_each(|row| allowed.insert(row));
        for question in full.chunks_exact(dim).skip(10).step_by(97) {
            for allowed in [None, Some(&allowed)] {
                let usable = |row: &u32| *row != 5 && allowed.is_none_or(|a| a.contains(*row));
                let exact = vectors.rank(question, (0..rows as u32).filter(usable), 10);
                assert_eq!(vectors.scan(question, 10, allowed), exact);
            }
        }
        assert!(vectors.scan(&vec![0.0; dim], 10, None).is_empty());
    }
}
