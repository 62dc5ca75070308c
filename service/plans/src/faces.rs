//! Rooms from walls that are drawn as lines: what the lines, with the doors in their gaps, enclose.

use d3dgen_model::Point;

use crate::cells::Cells;
use crate::drawing::DrawnOpening;
use crate::snap::{Axis, Corner};

/// A space narrower than this in one direction is the inside of a wall drawn with two lines, mm.
const THIN: i64 = 400;
/// A door closes the gap in a wall line this close to it, mm.
const REACH: i64 = 250;

/// Returns the outlines of the enclosed spaces, west to east and south to north; `None` when there are too many lines.
pub(crate) fn faces(walls: &[[Point; 2]], openings: &[DrawnOpening], xs: &Axis, ys: &Axis) -> Option<Vec<Vec<Corner>>> {
    let mut lines: Vec<(Corner, Corner)> = walls
        .iter()
        .map(|[a, b]| {
            let (mut p, mut q) = ((xs.at(a.x), ys.at(a.y)), (xs.at(b.x), ys.at(b.y)));
            if (p.0 - q.0).abs() < (p.1 - q.1).abs() {
                let x = xs.at((a.x + b.x) / 2.0);
                (p.0, q.0) = (x, x);
            } else {
                let y = ys.at((a.y + b.y) / 2.0);
                (p.1, q.1) = (y, y);
            }
            (p, q)
        })
        .collect();
    lines.extend(openings.iter().filter_map(|o| closing(o, &lines)).collect::<Vec<_>>());
    let coordinates = |pick: fn(&Corner) -> i64| {
        let mut list: Vec<i64> = lines.iter().flat_map(|(a, b)| [pick(a), pick(b)]).collect();
        let (least, most) = (list.iter().min().copied().unwrap_or(0), list.iter().max().copied().unwrap_or(0));
        list.extend([least - 1000, most + 1000]); // outdoors all around
        list
    };
    let mut cells = Cells::new(coordinates(|c| c.0), coordinates(|c| c.1))?;
    let (columns, rows) = (cells.columns(), cells.rows());
    // whether a wall stands west, or south, of a cell
    let (mut west, mut south) = (vec![false; columns * rows], vec![false; columns * rows]);
    let index = |list: &[i64], v: i64| list.partition_point(|o| *o < v);
    for (a, b) in &lines {
        if a.0 == b.0 {
            let i = index(&cells.xs, a.0);
            for j in index(&cells.ys, a.1.min(b.1))..index(&cells.ys, a.1.max(b.1)) {
                west[j * columns + i] = true;
            }
        } else {
            let j = index(&cells.ys, a.1);
            for i in index(&cells.xs, a.0.min(b.0))..index(&cells.xs, a.0.max(b.0)) {
                south[j * columns + i] = true;
            }
        }
    }
    let mut count = 0_u32;
    for start in 0..columns * rows {
        if cells.owner[start].is_some() {
            continue;
        }
        let mut todo = vec![start];
        cells.owner[start] = Some(count);
        while let Some(k) = todo.pop() {
            let (i, j) = (k % columns, k / columns);
            let ways = [
                (i > 0 && !west[k], k.wrapping_sub(1)),
                (i + 1 < columns && !west[(k + 1).min(columns * rows - 1)], k + 1),
                (j > 0 && !south[k], k.wrapping_sub(columns)),
                (j + 1 < rows && !south[(k + columns).min(columns * rows - 1)], k + columns),
            ];
            for (_, to) in ways.into_iter().filter(|w| w.0) {
                if cells.owner[to].is_none() {
                    cells.owner[to] = Some(count);
                    todo.push(to);
                }
            }
        }
        count += 1;
    }
    // the first space is outdoors
    let stretches = cells.stretches(|_, _, _| [0, 0]);
    let mut by_room: Vec<Vec<_>> = vec![Vec::new(); count as usize];
    for s in stretches {
        s.rooms().for_each(|r| by_room[r].push(s));
    }
    let rings = (1..count as usize).filter_map(|face| crate::cells::outline(face, &by_room[face]));
    Some(rings.filter(|ring| !is_thin(ring)).collect())
}

/// Returns true for the inside of a wall: a long thin box, or one whose area a strip of that width would have.
fn is_thin(ring: &[Corner]) -> bool {
    let n = ring.len();
    let edge = |k: usize| (ring[k], ring[(k + 1) % n]);
    let area: i64 = (0..n).map(|k| (edge(k).0.0 * edge(k).1.1) - (edge(k).1.0 * edge(k).0.1)).sum::<i64>().abs() / 2;
    let around: i64 = (0..n).map(|k| (edge(k).0.0 - edge(k).1.0).abs() + (edge(k).0.1 - edge(k).1.1).abs()).sum();
    area < THIN * (around / 2 - THIN).max(THIN)
}

/// Returns the line with which an opening closes the gap in the wall it is drawn in.
fn closing(opening: &DrawnOpening, lines: &[(Corner, Corner)]) -> Option<(Corner, Corner)> {
    let points: Vec<Point> = if let Some([hinge, ..]) = opening.arc { vec![hinge] } else { opening.points.clone() };
    let mm = |v: f64| (v * 1000.0).round() as i64;
    let (x0, x1) = (points.iter().map(|p| mm(p.x)).min()?, points.iter().map(|p| mm(p.x)).max()?);
    let (y0, y1) = (points.iter().map(|p| mm(p.y)).min()?, points.iter().map(|p| mm(p.y)).max()?);
    let (mx, my) = ((x0 + x1) / 2, (y0 + y1) / 2);
    // the nearest ends of two collinear walls with the opening's middle between them
    let gap = |vertical: bool| {
        let (middle, across) = if vertical { (my, mx) } else { (mx, my) };
        let pieces = lines
            .iter()
            .filter(|(a, b)| (a.0 == b.0) == vertical)
            .map(|(a, b)| if vertical { (a.0, a.1.min(b.1), a.1.max(b.1)) } else { (a.1, a.0.min(b.0), a.0.max(b.0)) });
        let near: Vec<(i64, i64, i64)> = pieces.filter(|p| (p.0 - across).abs() <= REACH).collect();
        let at = near.iter().min_by_key(|p| (p.0 - across).abs())?.0;
        let on = near.iter().filter(|p| p.0 == at);
        let slack = 50;
        let before = on.clone().filter(|p| p.2 <= middle + slack).map(|p| p.2).max()?;
        let after = on.filter(|p| p.1 >= middle - slack).map(|p| p.1).min()?;
        (after > before && after - before <= 4000).then(|| {
            let end = |along: i64| if vertical { (at, along) } else { (along, at) };
            (end(before), end(after))
        })
    };
    let wide = x1 - x0 >= y1 - y0;
    gap(!wide).or_else(|| gap(wide))
}
