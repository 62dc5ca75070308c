//! The graph of near neighbors (HNSW) for large indexes, over the same codes that the scan reads.
//!
//! It finds candidates only; the full vectors decide. It cannot delete, which does not matter here, as an index is never
//! changed but made anew. Filters slow it down sharply when they leave little, so narrow ones are scanned.

use std::path::Path;

use hnsw_rs::api::AnnT;
use hnsw_rs::prelude::{Distance, Hnsw, HnswIo};

use super::document::{Phase, Watch};
use super::row_set::RowSet;
use super::vectors::{Vectors, dot_codes, quantize};
use crate::error::{Error, Result};

/// From this many rows on an index has a graph.
///
/// Measured by `benches/search.rs` on 2 cores of a virtual Intel Xeon (x86-64, no special instructions), busy with other work;
/// time the thread ran, 256 components, 10 nearest of all rows, the graph searched with a width of 128:
///
/// | rows | scan | graph | its recall@10 | linking |
/// |---|---|---|---|---|
/// | 3,000 | 0.08 ms | 0.22 ms | 0.998 | 0.3 s |
/// | 10,000 | 0.30 ms | 0.60 ms | 0.999 | 2.2 s |
/// | 30,000 | 2.3 ms | 1.2 ms | 0.989 | 16.5 s |
/// | 100,000 | 8.6 ms | 1.7 ms | 0.970 | 90 s |
///
/// So a question is answered faster from about 20,000 rows on. But linking takes up to 0.9 ms a row, at every rebuild,
/// where all other parts together take 0.1 ms: 100,000 rows pay for their links after 13,000 unfiltered questions.
/// Up to here the scan, which is also exact, answers soon enough.
pub(crate) const FROM_ROWS: u32 = 200_000;

/// The least share of rows that a filter must leave for the graph to be asked.
///
/// Measured as above with 30,000 rows: a filter that leaves half takes the graph 4.0 ms and the scan 0.8 ms; one that
/// leaves 1/64 takes 44 ms and 0.04 ms.
pub(crate) const LEAST_SHARE: f64 = 0.9;

/// Names of the files: the crate adds `.hnsw.graph` and `.hnsw.data`.
const BASENAME: &str = "neighbors";

/// Neighbors a row keeps, and candidates looked at while linking and while searching.
const NEIGHBORS: usize = 16;
const LINKING_WIDTH: usize = 100;
/// Three times the width that was measured above, because its recall fell below 0.98 at 100,000 rows.
const SEARCH_WIDTH: usize = 384;
/// The crate dumps graphs of this many layers only.
const LAYERS: usize = 16;

/// Angle between codes: 1 - cosine. A point is its codes and, in four more bytes, 1 / length of these codes.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CodeDistance;

impl Distance<i8> for CodeDistance {
    fn eval(&self, a: &[i8], b: &[i8]) -> f32 {
        let (Some((a, a_length)), Some((b, b_length))) = (a.split_last_chunk::<4>(), b.split_last_chunk::<4>()) else {
            return 1.0;
        };
        let length = |bytes: &[i8; 4]| f32::from_le_bytes(bytes.map(i8::cast_unsigned));
        (1.0 - dot_codes(a, b) as f32 * length(a_length) * length(b_length)).max(0.0)
    }
}

/// Neighbors of every row that has a vector.
pub(crate) struct Graph {
    hnsw: Hnsw<'static, i8, CodeDistance>,
}

impl std::fmt::Debug for Graph {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Graph of {} rows", self.hnsw.get_nb_point())
    }
}

impl Graph {
    /// Links all rows, one after the other: in parallel the graph would depend on the order of threads.
    pub(crate) fn new(vectors: &Vectors, rows: u32, watch: Watch<'_>) -> Result<Self> {
        let hnsw = Hnsw::new(NEIGHBORS, rows as usize, LAYERS, LINKING_WIDTH, CodeDistance);
        for (done, (row, codes)) in vectors.coded().enumerate() {
            if done % 1000 == 0 {
                watch.step(Phase::Linking, done, rows as usize)?;
            }
            hnsw.insert_slice((&point(codes), row as usize));
        }
        Ok(Self { hnsw })
    }

    /// Returns candidates for the rows nearest to a vector, in no order that means anything.
    pub(crate) fn near(&self, question: &[f32], wanted: usize, allowed: Option<&RowSet>) -> Vec<u32> {
        let mut codes = Vec::with_capacity(question.len() + 4);
        quantize(question, &mut codes);
        let width = SEARCH_WIDTH.max(wanted.saturating_mul(2));
        let found = match allowed {
            None => self.hnsw.search(&point(&codes), width, width),
            Some(allowed) => {
                let filter = |row: &usize| u32::try_from(*row).is_ok_and(|row| allowed.contains(row));
                self.hnsw.search_filter(&point(&codes), width, width, Some(&filter))
            }
        };
        found.iter().filter_map(|n| u32::try_from(n.get_origin_id()).ok()).collect()
    }

    /// Writes the files of the graph into a folder.
    pub(crate) fn write(&self, dir: &Path) -> Result<()> {
        let failed =
            |reason: String| Error::Index { what: format!("the graph of neighbors was not written: {reason}") };
        let name = self.hnsw.file_dump(dir, BASENAME).map_err(|e| failed(e.to_string()))?;
        if name == BASENAME { Ok(()) } else { Err(failed(format!("its files were named {name}"))) }
    }

    /// Reads what [`Graph::write`] wrote. The caller has checked that the files are whole: the crate panics on others.
    pub(crate) fn read(dir: &Path) -> Result<Self> {
        // The crate lets a graph borrow from its reader, for files that are mapped. These are not, but the type asks
        // for it all the same; a reader is a path and a few numbers.
        let reader: &'static mut HnswIo = Box::leak(Box::new(HnswIo::new(dir, BASENAME)));
        let hnsw = reader.load_hnsw::<i8, CodeDistance>();
        let hnsw = hnsw.map_err(|e| Error::Index { what: format!("the graph of neighbors was not read: {e}") })?;
        Ok(Self { hnsw })
    }
}

fn point(codes: &[i8]) -> Vec<i8> {
    let length = (dot_codes(codes, codes).max(1) as f32).sqrt();
    let mut point = Vec::with_capacity(codes.len() + 4);
    point.extend_from_slice(codes);
    point.extend((1.0 / length).to_le_bytes().map(u8::cast_signed));
    point
}
