//! STL, text and binary.
//!
//! The format has no unit and no axis: lengths are taken as meters and z as up, which plausibility may correct.

use std::collections::HashMap;

use super::builder::{Builder, MAX_TRIANGLES, Piece, fan};
use super::facts::{ReadModel, Refusal};
use super::frame::Matrix;
use super::{Reader, Source};

/// Bytes before the triangles of a binary file, and of each triangle.
const HEADER: usize = 84;
const TRIANGLE: usize = 50;

/// Reads STL.
pub struct Stl;

impl Reader for Stl {
    fn name(&self) -> &'static str {
        "stl"
    }

    fn endings(&self) -> &'static [&'static str] {
        &["stl"]
    }

    fn recognizes(&self, head: &[u8], ending: &str) -> bool {
        ending == "stl" && (head.trim_ascii_start().starts_with(b"solid") || head.len() >= HEADER)
    }

    fn read(&self, source: &Source) -> Result<ReadModel, Refusal> {
        let mut builder = Builder::new("stl");
        match fill(&mut builder, source.bytes, &Matrix::IDENTITY, 0) {
            Ok(()) => builder.finish(&source.name),
            Err(refusal) => Err(builder.refuse(refusal)),
        }
    }
}

/// Reads an STL file into a body of a builder, put in place by a matrix.
pub fn fill(builder: &mut Builder, bytes: &[u8], place: &Matrix, body: usize) -> Result<(), Refusal> {
    // Binary files may begin with `solid` too; their length tells.
    let count = bytes.get(80..HEADER).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes).map(|c| c as usize);
    let exact = count.and_then(|c| c.checked_mul(TRIANGLE)).is_some_and(|l| l + HEADER == bytes.len());
    let text = bytes.trim_ascii_start().starts_with(b"solid") && !exact;
    let (triangles, solids) = if text { ascii(bytes)? } else { (binary(bytes, count)?, 1) };
    builder.facts.mesh_count += solids;
    builder.facts.triangle_count += triangles.len() as u64;
    let mut piece = Piece { name: "solid".into(), ..Piece::default() };
    let mut index: HashMap<[u32; 3], u32> = HashMap::new();
    for corners in triangles {
        piece.triangles.push(corners.map(|corner| {
            builder.extent.add(place.point(corner.map(f64::from)));
            *index.entry(corner.map(f32::to_bits)).or_insert_with(|| {
                piece.positions.push(corner);
                piece.positions.len() as u32 - 1
            })
        }));
    }
    builder.add(body, piece, place)
}

type Corners = [[f32; 3]; 3];

fn binary(bytes: &[u8], count: Option<usize>) -> Result<Vec<Corners>, Refusal> {
    let count = count.ok_or("is cut off in its header")?;
    let body = bytes.get(HEADER..).unwrap_or_default();
    if count > MAX_TRIANGLES || count > body.len() / TRIANGLE {
        let there = body.len() / TRIANGLE;
        return Err(format!("says that it has {count} triangles and has {there}: it is cut off or no STL").into());
    }
    let number = |b: &[u8]| b.try_into().map_or(f32::NAN, f32::from_le_bytes);
    let corner = |b: &[u8]| [number(&b[..4]), number(&b[4..8]), number(&b[8..12])];
    let triangles = body.chunks_exact(TRIANGLE).take(count);
    Ok(triangles.map(|t| [corner(&t[12..24]), corner(&t[24..36]), corner(&t[36..48])]).collect())
}

fn ascii(bytes: &[u8]) -> Result<(Vec<Corners>, u64), Refusal> {
    let text = String::from_utf8_lossy(bytes);
    let mut triangles = Vec::new();
    let mut corners: Vec<[f32; 3]> = Vec::new();
    let mut solids = 0;
    for (number, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("solid") => solids += 1,
            Some("vertex") => {
                let mut corner = [0f32; 3];
                for value in &mut corner {
                    let word = words.next().and_then(|w| w.parse().ok());
                    *value = word.ok_or_else(|| format!("line {}: `vertex` needs three numbers", number + 1))?;
                }
                corners.push(corner);
            }
            Some("endloop") => {
                triangles.extend(fan(&corners));
                corners.clear();
            }
            _ => {}
        }
        if triangles.len().max(corners.len()) > MAX_TRIANGLES {
            return Err(format!("has more than {MAX_TRIANGLES} triangles; simplify it first").into());
        }
    }
    if !text.contains("endsolid") {
        return Err("is cut off: `endsolid` is missing".into());
    }
    Ok((triangles, solids))
}
