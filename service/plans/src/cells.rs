//! The compressed grid that all wall lines of a plan span: which room owns each cell, and the lines between owners.

use crate::shape::Corner;

/// Most cells; a plan of 500 rooms has some millions.
const MOST_CELLS: usize = 16_000_000;

/// A straight stretch of boundary between two rooms, or between a room and outdoors, in millimeters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Stretch {
    /// True for a wall that runs north-south.
    pub vertical: bool,
    /// x of a vertical, y of a horizontal stretch.
    pub at: i64,
    pub from: i64,
    pub to: i64,
    /// Room on the west or south side.
    pub low: Option<usize>,
    /// Room on the east or north side.
    pub high: Option<usize>,
    /// From the line to the wall's face on the low and the high side.
    pub half: [i64; 2],
}

impl Stretch {
    pub(crate) fn len(&self) -> i64 {
        self.to - self.from
    }

    pub(crate) fn is_outer(&self) -> bool {
        self.low.is_none() || self.high.is_none()
    }

    pub(crate) fn rooms(&self) -> impl Iterator<Item = usize> {
        [self.low, self.high].into_iter().flatten()
    }

    pub(crate) fn thickness(&self) -> i64 {
        match (self.low, self.high) {
            (Some(_), Some(_)) => self.half[0] + self.half[1],
            (Some(_), None) => 2 * self.half[0],
            _ => 2 * self.half[1],
        }
    }

    /// Returns the distance from the line to the wall's face in a room.
    pub(crate) fn half_of(&self, room: usize) -> i64 {
        if self.low == Some(room) { self.half[0] } else { self.half[1] }
    }

    /// Returns the point at a position along the stretch.
    pub(crate) fn point(&self, along: i64) -> Corner {
        if self.vertical { (self.at, along) } else { (along, self.at) }
    }
}

/// The grid: columns between neighboring `xs`, rows between neighboring `ys`, with the room of each cell.
#[derive(Debug, Clone)]
pub(crate) struct Cells {
    pub xs: Vec<i64>,
    pub ys: Vec<i64>,
    pub owner: Vec<Option<u32>>,
}

impl Cells {
    /// Returns an empty grid, or `None` when it would have too many cells.
    pub(crate) fn new(mut xs: Vec<i64>, mut ys: Vec<i64>) -> Option<Self> {
        for list in [&mut xs, &mut ys] {
            list.sort_unstable();
            list.dedup();
        }
        let count = xs.len().saturating_sub(1).checked_mul(ys.len().saturating_sub(1)).filter(|n| *n <= MOST_CELLS)?;
        Some(Self { xs, ys, owner: vec![None; count] })
    }

    pub(crate) fn columns(&self) -> usize {
        self.xs.len().saturating_sub(1)
    }

    pub(crate) fn rows(&self) -> usize {
        self.ys.len().saturating_sub(1)
    }

    pub(crate) fn at(&self, i: usize, j: usize) -> Option<u32> {
        // usize::MAX stands for one step before the first
        if i >= self.columns() || j >= self.rows() { None } else { self.owner[j * self.columns() + i] }
    }

    pub(crate) fn set(&mut self, i: usize, j: usize, owner: Option<u32>) {
        let k = j * self.columns() + i;
        self.owner[k] = owner;
    }

    /// Returns the cells inside an upright outline, row by row.
    pub(crate) fn inside(&self, ring: &[Corner]) -> Vec<(usize, usize, usize)> {
        let n = ring.len();
        let mut sides: Vec<(i64, i64, i64)> = Vec::new(); // x, from, to of the vertical edges
        for k in 0..n {
            let (a, b) = (ring[k], ring[(k + 1) % n]);
            if a.0 == b.0 && a.1 != b.1 {
                sides.push((a.0, a.1.min(b.1), a.1.max(b.1)));
            }
        }
        sides.sort_unstable();
        let low = sides.iter().map(|s| s.1).min().unwrap_or(0);
        let high = sides.iter().map(|s| s.2).max().unwrap_or(0);
        let mut out = Vec::new();
        let first = self.ys.partition_point(|y| *y < low);
        for j in first..self.rows() {
            if self.ys[j] >= high {
                break;
            }
            let across: Vec<i64> =
                sides.iter().filter(|s| s.1 <= self.ys[j] && self.ys[j] < s.2).map(|s| s.0).collect();
            for pair in across.chunks_exact(2) {
                let index = |x: i64| self.xs.partition_point(|v| *v < x);
                out.push((j, index(pair[0]), index(pair[1])));
            }
        }
        out
    }

    /// Returns the same grid with further lines, or `None` when it would have too many cells.
    pub(crate) fn refined(&self, more_x: &[i64], more_y: &[i64]) -> Option<Self> {
        let mut out = Self::new([&self.xs[..], more_x].concat(), [&self.ys[..], more_y].concat())?;
        let old = |list: &[i64], v: i64| list.partition_point(|o| *o <= v).wrapping_sub(1);
        let columns: Vec<usize> = out.xs.iter().map(|x| old(&self.xs, *x)).collect();
        for j in 0..out.rows() {
            let oj = old(&self.ys, out.ys[j]);
            for (i, column) in columns.iter().enumerate().take(out.columns()) {
                let owner = self.at(*column, oj);
                out.set(i, j, owner);
            }
        }
        Some(out)
    }

    /// Returns the owner of the floor at a point, mm.
    pub(crate) fn owner_at(&self, (x, y): Corner) -> Option<usize> {
        let index = |list: &[i64], v: i64| list.partition_point(|o| *o <= v).wrapping_sub(1);
        self.at(index(&self.xs, x), index(&self.ys, y)).map(|o| o as usize)
    }

    /// Returns the same grid with rows and columns exchanged.
    pub(crate) fn transposed(&self) -> Self {
        let mut out = Self { xs: self.ys.clone(), ys: self.xs.clone(), owner: vec![None; self.owner.len()] };
        for j in 0..self.rows() {
            for i in 0..self.columns() {
                out.set(j, i, self.at(i, j));
            }
        }
        out
    }

    /// Returns all boundary stretches between different owners, with what `halves` says about the wall before the cell
    /// pair (vertical, the column or row behind the line, the row or column along it).
    pub(crate) fn stretches(&self, halves: impl Fn(bool, usize, usize) -> [i64; 2]) -> Vec<Stretch> {
        let mut found = Vec::new();
        for vertical in [true, false] {
            let (across, along) = if vertical { (&self.xs, &self.ys) } else { (&self.ys, &self.xs) };
            for (i, &at) in across.iter().enumerate() {
                let mut open: Option<Stretch> = None;
                for j in 0..along.len().saturating_sub(1) {
                    let before = i.wrapping_sub(1);
                    let (low, high) = if vertical {
                        (self.at(before, j), self.at(i, j))
                    } else {
                        (self.at(j, before), self.at(j, i))
                    };
                    let (low, high) = (low.map(|r| r as usize), high.map(|r| r as usize));
                    let half = if low == high { [0, 0] } else { halves(vertical, i, j) };
                    if let Some(s) = open.as_mut().filter(|s| (s.low, s.high, s.half) == (low, high, half)) {
                        s.to = along[j + 1];
                        continue;
                    }
                    found.extend(open.take());
                    if low != high {
                        open = Some(Stretch { vertical, at, from: along[j], to: along[j + 1], low, high, half });
                    }
                }
                found.extend(open);
            }
        }
        found.sort();
        found
    }

    /// Returns the one outline of an owner, counter-clockwise; `None` when it has holes, parts, or touches itself.
    pub(crate) fn outline(&self, owner: u32) -> Option<Vec<Corner>> {
        outline(owner as usize, &self.stretches(|_, _, _| [0, 0]))
    }
}

/// Returns the outline of a room from the stretches of the plan, straight corners left out.
pub(crate) fn outline(room: usize, stretches: &[Stretch]) -> Option<Vec<Corner>> {
    let mut next = std::collections::BTreeMap::new();
    for s in stretches.iter().filter(|s| s.rooms().any(|r| r == room)) {
        let (a, b) = (s.point(s.from), s.point(s.to));
        let forward = s.vertical == (s.low == Some(room));
        let (start, end) = if forward { (a, b) } else { (b, a) };
        if next.insert(start, end).is_some() {
            return None;
        }
    }
    let first = *next.keys().next()?;
    let (mut ring, mut here) = (Vec::new(), first);
    loop {
        ring.push(here);
        here = next.remove(&here)?;
        if here == first {
            break;
        }
    }
    if !next.is_empty() {
        return None;
    }
    let n = ring.len();
    let straight = |i: usize| {
        let (a, b, c): (Corner, Corner, Corner) = (ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]);
        (a.0 == b.0 && b.0 == c.0) || (a.1 == b.1 && b.1 == c.1)
    };
    Some((0..n).filter(|&i| !straight(i)).map(|i| ring[i]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_l_is_filled_and_traced_back() {
        let l = [(0, 0), (4, 0), (4, 2), (2, 2), (2, 5), (0, 5)];
        let mut cells = Cells::new(vec![0, 2, 4, 9], vec![0, 2, 5, 7]).expect("small");
        for (j, from, to) in cells.inside(&l) {
            (from..to).for_each(|i| cells.set(i, j, Some(0)));
        }
        assert_eq!(cells.owner.iter().flatten().count(), 3);
        assert_eq!(cells.outline(0).expect("one ring"), l);
        assert_eq!(cells.transposed().transposed().owner, cells.owner);
        let fine = cells.refined(&[1, 3], &[1]).expect("small");
        assert_eq!(fine.outline(0).expect("one ring"), l);
    }
}
