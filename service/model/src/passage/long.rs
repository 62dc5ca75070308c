//! Where a long robot gets to: its outline in headings around the half circle, driven along its heading and turned about
//! its middle, on the grid of the occupancy.

use crate::geometry::Rect;
use crate::occupancy::{Bitmap, CELL_M, Frame};

/// Headings in half a turn; forward and backward are the same outline.
const HEADINGS: usize = 16;
/// Discs that cover the outline lie this share of its width apart.
const APART: f64 = 0.25;
/// Neighbors of a cell, counter-clockwise through half a turn.
const AROUND: [(i64, i64); 5] = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0)];

/// The discs that cover an outline in one heading.
struct Cover {
    /// Middles, in cells from the middle of the outline.
    discs: Vec<(i64, i64)>,
    /// Cells that it drives over next, one way; the other way is the opposite.
    steps: Vec<(i64, i64)>,
}

/// Returns the cells where the middle of a body (width, length, m) gets to from one of the starts; `wide` has the diameter
/// of the largest disc at each cell, mm.
pub(super) fn driven(frame: &Frame, wide: &[u32], (width, length): (f64, f64), starts: &[Rect]) -> Bitmap {
    let (nx, ny) = (frame.nx as i64, frame.ny as i64);
    let covers: Vec<Cover> = (0..HEADINGS).map(|h| cover(h, width, length)).collect();
    let disc = width.hypot(width * APART);
    let needed = (1000.0 * disc).floor() as u32;
    let circle = (1000.0 * width.hypot(length)).ceil() as u32;
    let at = |i: i64, j: i64| if i < 0 || j < 0 || i >= nx || j >= ny { 0 } else { wide[(j * nx + i) as usize] };
    let stands = |i: i64, j: i64, h: usize| match at(i, j) {
        w if w < needed => false,
        w if w >= circle => true,
        _ => covers[h].discs.iter().all(|(di, dj)| at(i + di, j + dj) >= needed),
    };
    let mut seen = vec![0_u16; wide.len()];
    let mut open: Vec<(i64, i64, usize)> = Vec::new();
    for (i, j) in starts.iter().flat_map(|r| frame.cells(r)) {
        open.extend((0..HEADINGS).map(|h| (i as i64, j as i64, h)));
    }
    let mut out = Bitmap::new(frame.nx, frame.ny);
    while let Some((i, j, h)) = open.pop() {
        let inside = i >= 0 && j >= 0 && i < nx && j < ny;
        if !inside || seen[(j * nx + i) as usize] & (1 << h) != 0 {
            continue;
        }
        seen[(j * nx + i) as usize] |= 1 << h;
        if !stands(i, j, h) {
            continue;
        }
        out.set(i as usize, j as usize);
        open.extend([(i, j, (h + 1) % HEADINGS), (i, j, (h + HEADINGS - 1) % HEADINGS)]);
        open.extend(covers[h].steps.iter().flat_map(|(di, dj)| [(i + di, j + dj, h), (i - di, j - dj, h)]));
    }
    out
}

fn cover(heading: usize, width: f64, length: f64) -> Cover {
    let (sin, cos) = (std::f64::consts::PI * heading as f64 / HEADINGS as f64).sin_cos();
    let reach = (length - APART * width).max(0.0) / 2.0;
    let count = (2.0 * reach / (APART * width)).ceil().max(1.0);
    let cell = |along: f64| ((along * cos / CELL_M).round() as i64, (along * sin / CELL_M).round() as i64);
    let discs = (0..=count as i64).map(|k| cell(reach * (2.0 * k as f64 / count - 1.0))).collect();
    // the two neighbors on either side of the heading: taken in turn they keep to it
    let eighth = HEADINGS / 4;
    let mut steps = vec![AROUND[heading / eighth]];
    if !heading.is_multiple_of(eighth) {
        steps.push(AROUND[heading / eighth + 1]);
    }
    Cover { discs, steps }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;

    /// A corridor from the west and one to the north, meeting in a corner, as widths of the grid in mm.
    fn corner(corridor: usize, branch: usize) -> (Frame, Vec<u32>) {
        let (nx, ny) = (120_usize, 120_usize);
        let free = |i: usize, j: usize| {
            (5..5 + corridor).contains(&j) && (2..118).contains(&i)
                || (60..60 + branch).contains(&i) && (5..118).contains(&j)
        };
        let d2 = super::super::squared_distances(nx, ny, free);
        let wide = d2.into_iter().map(|d| (2.0 * CELL_M * 1000.0 * f64::from(d).sqrt()) as u32).collect();
        (Frame { origin: Point::new(0.0, 0.0), nx, ny }, wide)
    }

    #[test]
    fn a_long_body_turns_a_corner_where_a_bed_does() {
        let north = |corridor: usize, branch: usize| {
            let (frame, wide) = corner(corridor, branch);
            let middle = CELL_M * (5.0 + corridor as f64 / 2.0);
            let starts = [Rect::new(1.4, middle - 0.1, 1.6, middle + 0.1)];
            let reached = driven(&frame, &wide, (0.6, 1.8), &starts);
            (0..120).any(|i| reached.get(i, 85))
        };
        assert!(north(40, 40), "2 m and 2 m");
        assert!(north(40, 20), "through 1 m off a corridor of 2 m, whose circle of 1.9 m it does not have there");
        assert!(!north(20, 16), "1 m and 0.8 m");
        assert!(!north(40, 10), "0.5 m is narrower than it is");
    }
}
