//! Routes of robots on the free floor: from where one starts to its goals in turn, and to its dock.
//!
//! The shortest way on the grid of the occupancy, where floor with little play counts twice, pulled straight between its
//! corners where that makes nothing narrower.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use d3dgen_model::Point;
use d3dgen_model::geometry::to_mm;
use d3dgen_model::passage::clear_widths;
use d3dgen_model::scenario::{Poi, RobotTask, Route};

use super::floor::Floor;

/// Play beside a robot on both sides that is enough, m.
const PLAY_M: f64 = 0.2;
/// Cost of a step along and across the grid.
const STRAIGHT: u32 = 10;
const DIAGONAL: u32 = 14;
/// How often floor with little play counts.
const TIGHT: u32 = 2;
/// Neighbors of a cell.
const AROUND: [(i64, i64); 8] = [(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)];

/// Finds routes on one storey.
pub(super) struct Router<'f> {
    floor: &'f Floor<'f>,
    /// Diameter of the largest disc at each cell, mm.
    wide: Vec<u32>,
    /// By cell: search it was reached in, cost of the way there, neighbor it came from.
    seen: Vec<(u32, u32, u8)>,
    search: u32,
    /// Width that has play enough, mm.
    roomy: u32,
}

impl<'f> Router<'f> {
    pub fn new(floor: &'f Floor<'f>) -> Self {
        let roomy = (2000.0 * (floor.radius + PLAY_M)).round() as u32;
        Self { floor, wide: Vec::new(), seen: Vec::new(), search: 0, roomy }
    }

    /// Returns the legs of a robot's round that can be driven.
    pub fn round(&mut self, task: &RobotTask, pois: &[Poi]) -> Vec<Route> {
        let mut here = (String::new(), Point::new(task.start.x, task.start.y));
        let mut out = Vec::new();
        for id in task.goals.iter().chain(&task.dock) {
            let Some(poi) = pois.iter().find(|p| &p.poi_id == id) else { continue };
            let there = Point::new(poi.pose.x, poi.pose.y);
            out.extend(self.leg((&here.0, here.1), (id, there)));
            here = (id.clone(), there);
        }
        out
    }

    fn leg(&mut self, (from, a): (&str, Point), (to, b): (&str, Point)) -> Option<Route> {
        if self.wide.is_empty() {
            self.wide = clear_widths(&self.floor.occupancy, self.floor.plan);
            self.seen = vec![(0, 0, 0); self.wide.len()];
        }
        let frame = &self.floor.occupancy.frame;
        let (start, goal) = (frame.cell(a)?, frame.cell(b)?);
        let cells = self.cells(start, goal)?;
        let center = |cell: usize| {
            let c = frame.center(cell % frame.nx, cell / frame.nx);
            Point::new(to_mm(c.x), to_mm(c.y))
        };
        let mut corners = self.corners(&cells).into_iter().map(center).collect::<Vec<Point>>();
        (corners[0], *corners.last_mut()?) = (a, b);
        let legs = || corners.windows(2).map(|w| (w[0], w[1]));
        let narrowest = legs().map(|(p, q)| self.narrowest(p, q)).min()?;
        Some(Route {
            from: from.to_owned(),
            to: to.to_owned(),
            length_m: to_mm(legs().map(|(p, q)| p.distance(q)).sum()),
            clear_width_m: f64::from(narrowest) / 1000.0,
            path: corners,
        })
    }

    /// Returns the cells of the cheapest way, both ends with it.
    fn cells(&mut self, start: (usize, usize), goal: (usize, usize)) -> Option<Vec<usize>> {
        let (nx, ny) = (self.floor.occupancy.frame.nx as i64, self.floor.occupancy.frame.ny as i64);
        let main = &self.floor.main;
        let clear = |i: i64, j: i64| i >= 0 && j >= 0 && i < nx && j < ny && main.get(i as usize, j as usize);
        let (start, goal) = ((start.0 as i64, start.1 as i64), (goal.0 as i64, goal.1 as i64));
        if !clear(start.0, start.1) || !clear(goal.0, goal.1) {
            return None;
        }
        let left = |i: i64, j: i64| {
            let (dx, dy) = ((goal.0 - i).unsigned_abs() as u32, (goal.1 - j).unsigned_abs() as u32);
            STRAIGHT * dx.max(dy) + (DIAGONAL - STRAIGHT) * dx.min(dy)
        };
        self.search += 1;
        let (first, last) = ((start.1 * nx + start.0) as usize, (goal.1 * nx + goal.0) as usize);
        self.seen[first] = (self.search, 0, 0);
        let mut open = BinaryHeap::from([Reverse((left(start.0, start.1), first as u32, 0_u32))]);
        while let Some(Reverse((_, cell, cost))) = open.pop() {
            if cell as usize == last {
                return Some(self.back(first, last, nx));
            }
            if cost > self.seen[cell as usize].1 {
                continue;
            }
            let (i, j) = (i64::from(cell) % nx, i64::from(cell) / nx);
            for (k, (di, dj)) in AROUND.into_iter().enumerate() {
                let (x, y) = (i + di, j + dj);
                if !clear(x, y) || di != 0 && dj != 0 && !(clear(x, j) && clear(i, y)) {
                    continue;
                }
                let next = (y * nx + x) as usize;
                let step = if di != 0 && dj != 0 { DIAGONAL } else { STRAIGHT };
                let cost = cost + step * if self.wide[next] < self.roomy { TIGHT } else { 1 };
                let (search, known, _) = self.seen[next];
                if search != self.search || cost < known {
                    self.seen[next] = (self.search, cost, k as u8);
                    open.push(Reverse((cost + left(x, y), next as u32, cost)));
                }
            }
        }
        None
    }

    fn back(&self, first: usize, last: usize, nx: i64) -> Vec<usize> {
        let mut out = vec![last];
        let mut here = last;
        while here != first {
            let (di, dj) = AROUND[usize::from(self.seen[here].2)];
            here = (here as i64 - dj * nx - di) as usize;
            out.push(here);
        }
        out.reverse();
        out
    }

    /// Returns the cells of a way where it turns, both ends with them, as few as the floor allows.
    fn corners(&self, cells: &[usize]) -> Vec<usize> {
        let frame = &self.floor.occupancy.frame;
        let center = |k: usize| frame.center(cells[k] % frame.nx, cells[k] / frame.nx);
        let end = cells.len() - 1;
        let turns = (1..end).filter(|&k| cells[k] + cells[k] != cells[k - 1] + cells[k + 1]).chain([end]);
        let (mut out, mut from, mut before) = (vec![cells[0]], 0, 0);
        for turn in turns {
            let width = cells[from..=turn].iter().map(|c| self.wide[*c]).min().unwrap_or(0).min(self.roomy);
            if before > from && !self.is_open(center(from), center(turn), width) {
                out.push(cells[before]);
                from = before;
            }
            before = turn;
        }
        out.push(cells[end]);
        out
    }

    /// Returns true when the robot drives straight between two points and nothing is narrower than this, mm.
    fn is_open(&self, a: Point, b: Point, width: u32) -> bool {
        let frame = &self.floor.occupancy.frame;
        let open = |(i, j): (usize, usize)| self.floor.main.get(i, j) && self.wide[j * frame.nx + i] >= width;
        between(a, b).all(|p| frame.cell(p).is_some_and(open))
    }

    fn narrowest(&self, a: Point, b: Point) -> u32 {
        let frame = &self.floor.occupancy.frame;
        let widths = between(a, b).filter_map(|p| frame.cell(p)).map(|(i, j)| self.wide[j * frame.nx + i]);
        widths.min().unwrap_or(0)
    }
}

/// Returns points on a line, half a cell apart at most, both ends with them.
fn between(a: Point, b: Point) -> impl Iterator<Item = Point> {
    let count = (2.0 * a.distance(b) / d3dgen_model::occupancy::CELL_M).ceil().max(1.0);
    (0..=count as u32).map(move |k| {
        let t = f64::from(k) / count;
        Point::new(a.x + t * (b.x - a.x), a.y + t * (b.y - a.y))
    })
}
