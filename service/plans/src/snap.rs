//! Coordinates that mean the same wall face become the same whole millimeters.

use d3dgen_model::Point;

use crate::shape::{Corner, edges};

/// Coordinates of one axis: each group of close ones with the one that stands for it.
#[derive(Debug, Default)]
pub(crate) struct Axis {
    /// Least coordinate of each group and its millimeters, ascending.
    groups: Vec<(f64, i64)>,
    tolerance: f64,
}

impl Axis {
    /// Groups coordinates, given with the length of wall that speaks for each; the longest of a group decides.
    pub(crate) fn new(mut found: Vec<(f64, f64)>, tolerance: f64) -> Self {
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut groups: Vec<(f64, f64, f64)> = Vec::new(); // least, best, its weight
        for (at, weight) in found {
            match groups.last_mut().filter(|g| at - g.0 <= tolerance) {
                Some(group) if weight > group.2 => (group.1, group.2) = (at, weight),
                Some(_) => {}
                None => groups.push((at, at, weight)),
            }
        }
        let mm = |v: f64| (v * 1000.0).round() as i64;
        let mut groups: Vec<(f64, i64)> = groups.into_iter().map(|g| (g.0, mm(g.1))).collect();
        groups.dedup_by(|later, earlier| later.1 <= earlier.1);
        Self { groups, tolerance }
    }

    /// Returns the millimeters that stand for a coordinate.
    pub(crate) fn at(&self, v: f64) -> i64 {
        let i = self.groups.partition_point(|g| g.0 <= v + 1e-9);
        match i.checked_sub(1).map(|i| self.groups[i]).filter(|g| v - g.0 <= self.tolerance + 1e-9) {
            Some((_, mm)) => mm,
            None => (v * 1000.0).round() as i64,
        }
    }
}

/// Adds the coordinates of upright lines: x of vertical ones, y of the others, with their length.
pub(crate) fn collect(lines: impl Iterator<Item = (Point, Point)>, xs: &mut Vec<(f64, f64)>, ys: &mut Vec<(f64, f64)>) {
    for (a, b) in lines {
        if is_vertical(a, b) {
            xs.extend([(a.x, a.distance(b)), (b.x, a.distance(b))]);
        } else {
            ys.extend([(a.y, a.distance(b)), (b.y, a.distance(b))]);
        }
    }
}

pub(crate) fn is_vertical(a: Point, b: Point) -> bool {
    (a.x - b.x).abs() < (a.y - b.y).abs()
}

/// Returns the outline on the lattice, each edge exactly along x or y.
pub(crate) fn ring(corners: &[Point], xs: &Axis, ys: &Axis) -> Vec<Corner> {
    let n = corners.len();
    let list: Vec<(Point, Point)> = edges(corners).collect();
    let mut out: Vec<Corner> = Vec::with_capacity(n);
    for i in 0..n {
        let ((a0, a1), (b0, b1)) = (list[(i + n - 1) % n], list[i]);
        let p = corners[i];
        match (is_vertical(a0, a1), is_vertical(b0, b1)) {
            (true, false) => out.push((xs.at((a0.x + a1.x) / 2.0), ys.at((b0.y + b1.y) / 2.0))),
            (false, true) => out.push((xs.at((b0.x + b1.x) / 2.0), ys.at((a0.y + a1.y) / 2.0))),
            (true, true) => {
                let y = ys.at(p.y);
                out.extend([(xs.at((a0.x + a1.x) / 2.0), y), (xs.at((b0.x + b1.x) / 2.0), y)]);
            }
            (false, false) => {
                let x = xs.at(p.x);
                out.extend([(x, ys.at((a0.y + a1.y) / 2.0)), (x, ys.at((b0.y + b1.y) / 2.0))]);
            }
        }
    }
    out.dedup();
    while out.len() > 1 && out.first() == out.last() {
        out.pop();
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn close_coordinates_become_one() {
        let axis = Axis::new(vec![(0.0, 1.0), (0.004, 5.0), (0.1, 1.0), (4.0, 1.0), (3.993, 0.5)], 0.015);
        assert_eq!((axis.at(0.0), axis.at(0.004), axis.at(0.1), axis.at(3.993), axis.at(4.0)), (4, 4, 100, 4000, 4000));
        assert_eq!(axis.at(2.0005), 2001);
    }
}
