//! Room outlines from lattice boxes, and wall pieces between them.

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::courts::enclosed;
use d3dgen_model::geometry::to_mm;
use d3dgen_model::{Point, Polygon};

use super::lattice::{Cellbox, INNER_HALF_M, OUTER_HALF_M, meters};
use crate::lattice::{is_narrow, tidied};

/// A straight stretch of boundary on the lattice between two rooms, or between a room and outdoors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Stretch {
    /// True for a wall that runs north-south.
    pub vertical: bool,
    /// x of a vertical, y of a horizontal stretch.
    pub at: i32,
    pub from: i32,
    pub to: i32,
    /// Room on the west or south side.
    pub low: Option<usize>,
    /// Room on the east or north side.
    pub high: Option<usize>,
    /// Number of the court with the building all around that an outer wall stands on: there is daylight, and no way out.
    pub court: Option<usize>,
}

impl Stretch {
    pub(crate) fn len(&self) -> i32 {
        self.to - self.from
    }

    pub(crate) fn is_outer(&self) -> bool {
        self.low.is_none() || self.high.is_none()
    }

    /// Returns the room of an outer stretch from which one comes to the street.
    pub(crate) fn leads_out_of(&self) -> Option<usize> {
        self.only_room().filter(|_| self.court.is_none())
    }

    /// Returns the room of an outer stretch.
    pub(crate) fn only_room(&self) -> Option<usize> {
        match (self.low, self.high) {
            (Some(room), None) | (None, Some(room)) => Some(room),
            _ => None,
        }
    }

    pub(crate) fn joins(&self, a: usize, b: usize) -> bool {
        (self.low, self.high) == (Some(a), Some(b)) || (self.low, self.high) == (Some(b), Some(a))
    }

    /// Returns the point at a position along the stretch, m.
    pub(crate) fn point(&self, along_m: f64) -> Point {
        let at = meters(self.at);
        if self.vertical { Point::new(to_mm(at), to_mm(along_m)) } else { Point::new(to_mm(along_m), to_mm(at)) }
    }
}

/// Which room owns each cell of the compressed grid that all box edges span.
pub(crate) struct Mosaic {
    xs: Vec<i32>,
    ys: Vec<i32>,
    owner: Vec<Option<usize>>,
    /// By cell between the edges: the court it belongs to, floor of no room with rooms all around.
    court: Vec<Option<usize>>,
}

impl Mosaic {
    pub(crate) fn new(boxes: &[(usize, Cellbox)]) -> Self {
        let mut xs: Vec<i32> = boxes.iter().flat_map(|(_, b)| [b.x0, b.x1]).collect();
        let mut ys: Vec<i32> = boxes.iter().flat_map(|(_, b)| [b.y0, b.y1]).collect();
        for list in [&mut xs, &mut ys] {
            list.sort_unstable();
            list.dedup();
        }
        let mut owner = vec![None; xs.len() * ys.len()];
        for (room, b) in boxes {
            let range =
                |list: &[i32], lo: i32, hi: i32| list.partition_point(|v| *v < lo)..list.partition_point(|v| *v < hi);
            for j in range(&ys, b.y0, b.y1) {
                for i in range(&xs, b.x0, b.x1) {
                    owner[j * xs.len() + i] = Some(*room);
                }
            }
        }
        let mut mosaic = Self { xs, ys, owner, court: Vec::new() };
        mosaic.court = mosaic.court_of_cells();
        mosaic
    }

    /// Returns the rectangles of each court, in the order of their numbers.
    pub(crate) fn courts(&self) -> Vec<Vec<Cellbox>> {
        let columns = self.xs.len().saturating_sub(1);
        let mut courts: Vec<Vec<Cellbox>> = Vec::new();
        for (cell, court) in self.court.iter().enumerate() {
            let Some(court) = *court else { continue };
            courts.resize_with(courts.len().max(court + 1), Vec::new);
            let (i, j) = (cell % columns, cell / columns);
            courts[court].push(Cellbox::new(self.xs[i], self.ys[j], self.xs[i + 1], self.ys[j + 1]));
        }
        courts.iter().map(|cells| tidied(cells)).collect()
    }

    /// Returns the numbers of the courts that are shafts: narrower than `least`, lattice units.
    pub(crate) fn shafts(&self, least: i32) -> BTreeSet<usize> {
        self.courts().iter().enumerate().filter(|(_, court)| is_narrow(court, least)).map(|(n, _)| n).collect()
    }

    /// Returns the court of each cell between the edges.
    fn court_of_cells(&self) -> Vec<Option<usize>> {
        let (columns, rows) = (self.xs.len().saturating_sub(1), self.ys.len().saturating_sub(1));
        let built: Vec<bool> =
            (0..columns * rows).map(|cell| self.at(cell % columns, cell / columns).is_some()).collect();
        enclosed(columns, &built)
    }

    /// Returns the court that a cell belongs to; as [`Mosaic::at`] for what is outside of the grid.
    fn court_at(&self, i: usize, j: usize) -> Option<usize> {
        let inside = i != usize::MAX && j != usize::MAX && i + 1 < self.xs.len() && j + 1 < self.ys.len();
        if inside { self.court[j * (self.xs.len() - 1) + i] } else { None }
    }

    /// Returns how many corners of the building turn inwards, those of its courts aside: an L has one, a rectangle none.
    pub(crate) fn reflex_corners(&self) -> usize {
        let outdoors = |i: usize, j: usize| self.at(i, j).is_none() && self.court_at(i, j).is_none();
        let corners = (0..self.ys.len()).flat_map(|j| (0..self.xs.len()).map(move |i| (i, j)));
        let around = corners.map(|(i, j)| {
            let (west, south) = (i.wrapping_sub(1), j.wrapping_sub(1));
            [(west, south), (i, south), (west, j), (i, j)].into_iter().filter(|(i, j)| outdoors(*i, *j)).count()
        });
        around.filter(|outdoors| *outdoors == 1).count()
    }

    fn at(&self, i: usize, j: usize) -> Option<usize> {
        // Index usize::MAX stands for one step before the first.
        if i == usize::MAX || j == usize::MAX || i + 1 >= self.xs.len() || j + 1 >= self.ys.len() {
            return None;
        }
        self.owner[j * self.xs.len() + i]
    }

    /// Returns all boundary stretches, as long as they stay between the same two sides.
    pub(crate) fn stretches(&self) -> Vec<Stretch> {
        let mut found = Vec::new();
        for vertical in [true, false] {
            let (across, along) = if vertical { (&self.xs, &self.ys) } else { (&self.ys, &self.xs) };
            for (i, &at) in across.iter().enumerate() {
                let mut open: Option<Stretch> = None;
                for j in 0..along.len().saturating_sub(1) {
                    let before = i.wrapping_sub(1);
                    let [low, high] = [before, i].map(|i| if vertical { (i, j) } else { (j, i) });
                    let court = self.court_at(low.0, low.1).or(self.court_at(high.0, high.1));
                    let (low, high) = (self.at(low.0, low.1), self.at(high.0, high.1));
                    let continues = open.is_some_and(|s| (s.low, s.high, s.court) == (low, high, court));
                    if continues {
                        if let Some(s) = &mut open {
                            s.to = along[j + 1];
                        }
                        continue;
                    }
                    found.extend(open.take());
                    if low != high {
                        open = Some(Stretch { vertical, at, from: along[j], to: along[j + 1], low, high, court });
                    }
                }
                found.extend(open);
            }
        }
        found.sort();
        found
    }
}

/// A corner-by-corner outline, counter-clockwise on the lattice, and whether each edge (from corner i to i + 1) is an outer
/// wall. A straight side changes from outer to inner wall at a corner of its own.
pub(crate) struct Outline {
    pub corners: Vec<(i32, i32)>,
    pub outer: Vec<bool>,
}

/// Returns the outline of a room from the stretches around it, or `None` when it is not one simple ring.
pub(crate) fn outline(room: usize, stretches: &[Stretch]) -> Option<Outline> {
    let ring: Vec<_> = ring(room, stretches)?.into_iter().map(|side| (side.from, side.beyond.is_none())).collect();
    Some(merge_straight(&ring))
}

/// Returns the rooms around a room, clockwise from its south-west corner, each as often as its walls begin; `None` when the
/// room is not one simple ring.
pub(crate) fn neighbors_around(room: usize, stretches: &[Stretch]) -> Option<Vec<usize>> {
    Some(ring(room, stretches)?.into_iter().rev().filter_map(|side| side.beyond).collect())
}

/// One stretch of a room's outline.
struct Side {
    /// Where it begins, on the lattice.
    from: (i32, i32),
    /// The room on its other side; `None` outside the building.
    beyond: Option<usize>,
}

/// Returns the stretches of a room's outline, counterclockwise from the corner that is south of those farthest west; `None`
/// when it is not one simple ring.
fn ring(room: usize, stretches: &[Stretch]) -> Option<Vec<Side>> {
    // Directed edges with the room on the left, by where they begin, with where they end.
    let mut next: BTreeMap<(i32, i32), ((i32, i32), Side)> = BTreeMap::new();
    for s in stretches.iter().filter(|s| s.low == Some(room) || s.high == Some(room)) {
        let west_or_south = s.low == Some(room);
        let (a, b) = if s.vertical { ((s.at, s.from), (s.at, s.to)) } else { ((s.from, s.at), (s.to, s.at)) };
        let forward = s.vertical == west_or_south;
        let (start, end) = if forward { (a, b) } else { (b, a) };
        let side = Side { from: start, beyond: if west_or_south { s.high } else { s.low } };
        if next.insert(start, (end, side)).is_some() {
            return None;
        }
    }
    let first = *next.keys().next()?;
    let mut ring = Vec::with_capacity(next.len());
    let mut here = first;
    loop {
        let (to, side) = next.remove(&here)?;
        ring.push(side);
        here = to;
        if here == first {
            break;
        }
    }
    next.is_empty().then_some(ring)
}

/// Joins edges that go on in the same direction with the same wall.
fn merge_straight(ring: &[((i32, i32), bool)]) -> Outline {
    let n = ring.len();
    let direction = |i: usize| {
        let ((x0, y0), (x1, y1)) = (ring[i % n].0, ring[(i + 1) % n].0);
        ((x1 - x0).signum(), (y1 - y0).signum())
    };
    let goes_on = |i: usize| direction(i + n - 1) == direction(i) && ring[(i + n - 1) % n].1 == ring[i % n].1;
    let start = (0..n).find(|&i| !goes_on(i)).unwrap_or(0);
    let mut outline = Outline { corners: Vec::new(), outer: Vec::new() };
    for k in 0..n {
        let i = start + k;
        if k == 0 || !goes_on(i) {
            outline.corners.push(ring[i % n].0);
            outline.outer.push(ring[i % n].1);
        }
    }
    outline
}

impl Outline {
    /// Returns the outline on wall center lines, m.
    pub(crate) fn polygon(&self) -> Polygon {
        let turns = (0..self.corners.len()).filter(|&i| !self.is_straight(i));
        Polygon(turns.map(|i| self.corners[i]).map(|(x, y)| Point::new(to_mm(meters(x)), to_mm(meters(y)))).collect())
    }

    /// Returns the outline on wall faces, m: every edge moved inwards by half its wall's thickness. Where a straight side
    /// changes its wall, the faces step.
    pub(crate) fn net_polygon(&self) -> Polygon {
        let n = self.corners.len();
        let half = |i: usize| if self.outer[i % n] { OUTER_HALF_M } else { INNER_HALF_M };
        // The line of edge i, moved to its left: x for vertical edges, y for horizontal ones.
        let line = |i: usize| {
            let ((x0, y0), (dx, dy)) = (self.corners[i % n], self.direction(i));
            if dx == 0 { meters(x0) - f64::from(dy) * half(i) } else { meters(y0) + f64::from(dx) * half(i) }
        };
        let point = |vertical: bool, across: f64, along: f64| {
            let (x, y) = if vertical { (across, along) } else { (along, across) };
            Point::new(to_mm(x), to_mm(y))
        };
        let mut corners = Vec::with_capacity(n);
        for i in 0..n {
            let vertical = self.direction(i).0 == 0;
            if self.is_straight(i) {
                let along = meters(if vertical { self.corners[i].1 } else { self.corners[i].0 });
                corners.push(point(vertical, line(i + n - 1), along));
                corners.push(point(vertical, line(i), along));
            } else {
                corners.push(point(vertical, line(i), line(i + n - 1)));
            }
        }
        Polygon(corners)
    }

    /// Returns the direction of the edge from corner `i`.
    fn direction(&self, i: usize) -> (i32, i32) {
        let n = self.corners.len();
        let ((x0, y0), (x1, y1)) = (self.corners[i % n], self.corners[(i + 1) % n]);
        ((x1 - x0).signum(), (y1 - y0).signum())
    }

    /// Returns true when the outline does not turn at corner `i`.
    fn is_straight(&self, i: usize) -> bool {
        self.direction(i + self.corners.len() - 1) == self.direction(i)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_l_shaped_room_has_six_corners_and_a_net_area_inside_its_walls() {
        let boxes =
            [(0, Cellbox::new(0, 0, 80, 60)), (0, Cellbox::new(0, 60, 40, 100)), (1, Cellbox::new(40, 60, 80, 100))];
        let stretches = Mosaic::new(&boxes).stretches();
        let l = outline(0, &stretches).expect("one ring");
        assert_eq!(l.corners.len(), 6);
        assert!((l.polygon().signed_area() - 16.0).abs() < 1e-9);
        let net = l.net_polygon();
        // 4.0 x 3.0 less (0.24, 0.18), plus 2.0 x 2.0 less (0.18, 0.06).
        let expected = (4.0 - 0.24) * (3.0 - 0.18) + (2.0 - 0.18) * (2.0 - 0.06);
        assert!((net.signed_area() - expected).abs() < 1e-6, "{} {expected}", net.signed_area());
    }

    #[test]
    fn a_wall_that_turns_from_outer_to_inner_steps_by_half_its_thickness() {
        let boxes = [(0, Cellbox::new(0, 0, 40, 80)), (1, Cellbox::new(40, 0, 80, 40))];
        let stretches = Mosaic::new(&boxes).stretches();
        let long = outline(0, &stretches).expect("one ring");
        assert_eq!(long.polygon().corners().len(), 4);
        let net = long.net_polygon();
        assert_eq!(net.corners().len(), 6);
        // east side: 2 m of inner wall, 2 m of outer wall
        let expected = (2.0 - 0.12 - 0.06) * (2.0 - 0.12) + (2.0 - 0.24) * (2.0 - 0.12);
        assert!((net.signed_area() - expected).abs() < 1e-6, "{} {expected}", net.signed_area());
    }

    #[test]
    fn walls_on_a_court_lead_nowhere() {
        let boxes = [
            (0, Cellbox::new(0, 0, 90, 30)),
            (0, Cellbox::new(0, 30, 30, 60)),
            (0, Cellbox::new(0, 60, 90, 90)),
            (1, Cellbox::new(60, 30, 90, 60)),
        ];
        let around = Mosaic::new(&boxes).stretches();
        let on_court: i32 = around.iter().filter(|s| s.court == Some(0)).map(Stretch::len).sum();
        assert_eq!(on_court, 4 * 30);
        assert!(around.iter().filter(|s| s.court.is_some()).all(|s| s.is_outer() && s.leads_out_of().is_none()));
        // the same with one side open is a yard
        let yard = Mosaic::new(&boxes[..3]).stretches();
        assert!(yard.iter().all(|s| s.court.is_none()));
    }

    #[test]
    fn corners_that_turn_inwards_are_counted_outside_of_courts() {
        let of = |boxes: &[(usize, Cellbox)]| Mosaic::new(boxes).reflex_corners();
        let (low, arm) = (Cellbox::new(0, 0, 90, 30), Cellbox::new(0, 30, 30, 90));
        assert_eq!(of(&[(0, low)]), 0);
        assert_eq!(of(&[(0, low), (1, arm)]), 1);
        assert_eq!(of(&[(0, low), (1, Cellbox::new(30, 30, 60, 90))]), 2);
        let around = [low, arm, Cellbox::new(30, 60, 90, 90), Cellbox::new(60, 30, 90, 60)];
        assert_eq!(of(&around.map(|b| (0, b))), 0);
    }

    #[test]
    fn stretches_cover_both_sides_of_a_shared_wall_once() {
        let boxes = [(0, Cellbox::new(0, 0, 40, 40)), (1, Cellbox::new(40, 0, 80, 60))];
        let shared: Vec<_> = Mosaic::new(&boxes).stretches().into_iter().filter(|s| !s.is_outer()).collect();
        let wall = Stretch { vertical: true, at: 40, from: 0, to: 40, low: Some(0), high: Some(1), court: None };
        assert_eq!(shared, vec![wall]);
    }
}
