//! Rooms that are no simple outline (around a court, in parts, touching themselves at a corner) become several that are.

use std::collections::BTreeSet;

use crate::cells::Cells;

/// Parts smaller than this are no rooms, mm^2, nor are parts narrower than this, mm.
const LEAST_AREA: i64 = 500_000;
const LEAST_WIDTH: i64 = 300;
/// Most lines tried for one cut.
const MOST_CUTS: usize = 40;
/// Most cuts of one room.
const MOST_PIECES: usize = 64;

/// Cells by column and row.
type Part = BTreeSet<(usize, usize)>;

/// Returns the parts of an owner's floor, each with one simple outline, the largest first; parts too small are left out.
pub(crate) fn pieces(cells: &Cells, owner: u32) -> Vec<Part> {
    let mut all = Part::new();
    for j in 0..cells.rows() {
        all.extend((0..cells.columns()).filter(|i| cells.at(*i, j) == Some(owner)).map(|i| (i, j)));
    }
    let mut todo = connected(&all);
    let mut done: Vec<Part> = Vec::new();
    while let Some(part) = todo.pop() {
        if is_too_small(cells, &part) {
            continue;
        }
        if is_simple(cells, &part) || done.len() + todo.len() > MOST_PIECES {
            done.push(part);
            continue;
        }
        match best_cut(cells, &part) {
            Some(parts) => todo.extend(parts),
            None => done.push(part),
        }
    }
    done.sort_by_key(|p| (-area(cells, p), p.first().copied()));
    done
}

/// Returns the cells of an owner in rows or columns that are no wider than a wall, mm.
pub(crate) fn necks(cells: &Cells, owner: u32, wall: i64) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    let (columns, rows) = (cells.columns(), cells.rows());
    for j in 0..rows {
        let mut i = 0;
        while i < columns {
            let start = i;
            while i < columns && cells.at(i, j) == Some(owner) {
                i += 1;
            }
            if i > start && cells.xs[i] - cells.xs[start] <= wall {
                found.extend((start..i).map(|k| (k, j)));
            }
            i += usize::from(i == start);
        }
    }
    for i in 0..columns {
        let mut j = 0;
        while j < rows {
            let start = j;
            while j < rows && cells.at(i, j) == Some(owner) {
                j += 1;
            }
            if j > start && cells.ys[j] - cells.ys[start] <= wall {
                found.extend((start..j).map(|k| (i, k)));
            }
            j += usize::from(j == start);
        }
    }
    found
}

fn area(cells: &Cells, part: &Part) -> i64 {
    part.iter().map(|&(i, j)| (cells.xs[i + 1] - cells.xs[i]) * (cells.ys[j + 1] - cells.ys[j])).sum()
}

fn is_too_small(cells: &Cells, part: &Part) -> bool {
    let Some([i0, i1, j0, j1]) = window(part) else { return true };
    let (width, height) = (cells.xs[i1 + 1] - cells.xs[i0], cells.ys[j1 + 1] - cells.ys[j0]);
    width.min(height) < LEAST_WIDTH || area(cells, part) < LEAST_AREA
}

/// Returns first and last column and row.
fn window(part: &Part) -> Option<[usize; 4]> {
    let first = part.first()?.0;
    let last = part.last()?.0;
    let rows = part.iter().fold((usize::MAX, 0), |r, c| (r.0.min(c.1), r.1.max(c.1)));
    Some([first, last, rows.0, rows.1])
}

fn connected(part: &Part) -> Vec<Part> {
    let mut left = part.clone();
    let mut out = Vec::new();
    while let Some(start) = left.pop_first() {
        let mut group = Part::from([start]);
        let mut todo = vec![start];
        while let Some((i, j)) = todo.pop() {
            for near in [(i + 1, j), (i.wrapping_sub(1), j), (i, j + 1), (i, j.wrapping_sub(1))] {
                if left.remove(&near) {
                    group.insert(near);
                    todo.push(near);
                }
            }
        }
        out.push(group);
    }
    out
}

fn is_simple(cells: &Cells, part: &Part) -> bool {
    let Some([i0, i1, j0, j1]) = window(part) else { return false };
    let (xs, ys) = (cells.xs[i0..=i1 + 1].to_vec(), cells.ys[j0..=j1 + 1].to_vec());
    let Some(mut own) = Cells::new(xs, ys) else { return false };
    part.iter().for_each(|&(i, j)| own.set(i - i0, j - j0, Some(0)));
    own.outline(0).is_some()
}

/// Returns the parts of the cut along one grid line that leaves the fewest parts that are still no simple outline, then the
/// fewest parts, then the shortest cut.
fn best_cut(cells: &Cells, part: &Part) -> Option<Vec<Part>> {
    let [i0, i1, j0, j1] = window(part)?;
    // lines where the shape changes, by how much it does
    let differs = |vertical: bool, at: usize| {
        let pair = |k: usize| if vertical { ((at - 1, k), (at, k)) } else { ((k, at - 1), (k, at)) };
        let along = if vertical { j0..=j1 } else { i0..=i1 };
        along.filter(|k| part.contains(&pair(*k).0) != part.contains(&pair(*k).1)).count()
    };
    let columns = (i0 + 1..=i1).map(|i| (differs(true, i), true, i));
    let rows = (j0 + 1..=j1).map(|j| (differs(false, j), false, j));
    let mut lines: Vec<(usize, bool, usize)> = columns.chain(rows).filter(|l| l.0 > 0).collect();
    lines.sort_by_key(|l| (std::cmp::Reverse(l.0), !l.1, l.2));
    lines.truncate(MOST_CUTS);
    let mut best: Option<((usize, usize, i64), Vec<Part>)> = None;
    for (_, vertical, at) in lines {
        let side = |c: &(usize, usize)| if vertical { c.0 < at } else { c.1 < at };
        let (low, high): (Part, Part) = part.iter().partition(|c| side(c));
        let across = |&&(i, j): &&(usize, usize)| {
            if vertical { i == at && part.contains(&(i - 1, j)) } else { j == at && part.contains(&(i, j - 1)) }
        };
        let length = |&(i, j): &(usize, usize)| {
            if vertical { cells.ys[j + 1] - cells.ys[j] } else { cells.xs[i + 1] - cells.xs[i] }
        };
        let cut: i64 = part.iter().filter(across).map(length).sum();
        let parts = [connected(&low), connected(&high)].concat();
        let open = parts.iter().filter(|p| !is_simple(cells, p)).count();
        let rank = (open, parts.len(), cut);
        if best.as_ref().is_none_or(|b| rank < b.0) {
            best = Some((rank, parts));
        }
    }
    best.map(|b| b.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_becomes_two_rooms() {
        let mut cells = Cells::new(vec![0, 2000, 6000, 8000], vec![0, 2000, 6000, 8000]).expect("small");
        for j in 0..3 {
            for i in 0..3 {
                cells.set(i, j, ((i, j) != (1, 1)).then_some(0));
            }
        }
        let parts = pieces(&cells, 0);
        assert_eq!(parts.len(), 2);
        assert!(parts.iter().all(|p| is_simple(&cells, p)));
        assert_eq!(parts.iter().map(Part::len).sum::<usize>(), 8);
    }

    #[test]
    fn necks_are_found_in_both_directions() {
        let mut cells = Cells::new(vec![0, 4000, 4100, 8000], vec![0, 100, 3000]).expect("small");
        for (i, j) in [(0, 0), (0, 1), (1, 0), (2, 0), (2, 1)] {
            cells.set(i, j, Some(7));
        }
        assert_eq!(necks(&cells, 7, 120), [(1, 0)]);
    }
}
