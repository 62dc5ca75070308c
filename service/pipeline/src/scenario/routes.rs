//! Routes of robots on the free floor: from where one starts to its goals in turn, and to its dock.
//!
//! A short way on the grid of the occupancy, where floor with little play counts more, pulled straight between its corners
//! where that makes nothing narrower than it is or than a robot passes with ease.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use d3dgen_model::Point;
use d3dgen_model::geometry::to_mm;
use d3dgen_model::passage::clear_widths;
use d3dgen_model::scenario::{Poi, RobotTask, Route};

use super::floor::Floor;

/// Play beside a robot on both sides that is enough, m.
const PLAY_M: f64 = 0.2;
/// Play beside it on straight lines between corners, m.
const LINE_PLAY_M: f64 = 0.05;
/// Cost of a step along and across the grid, and on floor with little play.
const STEPS: [u32; 2] = [10, 14];
const TIGHT_STEPS: [u32; 2] = [13, 18];
/// What a step that is still to go is taken for.
const LEFT_STEPS: [u32; 2] = [16, 22];
/// Neighbors of a cell.
const AROUND: [(i64, i64); 8] = [(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)];

/// What a cell is to a robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Grade {
    Closed,
    Tight,
    Roomy,
}

/// Finds routes on one storey.
pub(super) struct Router<'f, 'a> {
    floor: &'f Floor<'a>,
    /// Diameter of the largest disc at each cell, mm.
    wide: Vec<u32>,
    /// By cell: whether the robot can be there, and with play.
    grade: Vec<Grade>,
    /// By cell: search it was reached in, cost of the way there, neighbor it came from, whether it is done.
    seen: Vec<(u32, u32, u8, bool)>,
    search: u32,
    /// Width that has play enough, and that lines may have, mm.
    roomy: u32,
    passed: u32,
}

impl<'f, 'a> Router<'f, 'a> {
    pub fn new(floor: &'f Floor<'a>) -> Self {
        let with = |play: f64| (2000.0 * (floor.radius + play)).round() as u32;
        let (roomy, passed) = (with(PLAY_M), with(LINE_PLAY_M));
        Self { floor, wide: Vec::new(), grade: Vec::new(), seen: Vec::new(), search: 0, roomy, passed }
    }

    /// Returns the legs of a robot's round that can be driven.
    pub fn round(&mut self, task: &RobotTask, pois: &[Poi]) -> Vec<Route> {
        let mut here = (String::new(), Point::new(task.start.x, task.start.y));
        let mut out: Vec<Route> = Vec::new();
        for id in task.goals.iter().chain(&task.dock) {
            let Some(poi) = pois.iter().find(|p| &p.poi_id == id) else { continue };
            let there = Point::new(poi.pose.x, poi.pose.y);
            // the way home from the only goal is the way there
            let back = out.last().filter(|r| r.path.first() == Some(&there) && r.path.last() == Some(&here.1));
            let leg = match back.cloned() {
                Some(mut leg) => {
                    leg.path.reverse();
                    Some(Route { from: here.0.clone(), to: id.clone(), ..leg })
                }
                None => self.leg((&here.0, here.1), (id, there)),
            };
            out.extend(leg);
            here = (id.clone(), there);
        }
        out
    }

    fn leg(&mut self, (from, a): (&str, Point), (to, b): (&str, Point)) -> Option<Route> {
        if self.wide.is_empty() {
            self.survey();
        }
        let frame = &self.floor.occupancy.frame;
        let (start, goal) = (frame.cell(a)?, frame.cell(b)?);
        // every other cell first: a quarter of them
        let cells = self.cells(start, goal, 2).or_else(|| self.cells(start, goal, 1))?;
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

    fn survey(&mut self) {
        self.wide = clear_widths(&self.floor.occupancy, self.floor.plan);
        self.grade = vec![Grade::Closed; self.wide.len()];
        self.seen = vec![(0, 0, 0, false); self.wide.len()];
        let nx = self.floor.occupancy.frame.nx;
        for (i, j) in self.floor.main.cells() {
            let cell = j * nx + i;
            self.grade[cell] = if self.wide[cell] < self.roomy { Grade::Tight } else { Grade::Roomy };
        }
    }

    /// Returns the cells of a way, every `stride`-th and both ends with it. What is left counts as more
    /// than tight floor: that looks at few cells, and the way costs no more than that over the cheapest.
    fn cells(&mut self, a: (usize, usize), b: (usize, usize), stride: i64) -> Option<Vec<usize>> {
        let (nx, ny) = (self.floor.occupancy.frame.nx as i64, self.floor.occupancy.frame.ny as i64);
        let (start, goal) = (self.on_stride(a, stride)?, self.on_stride(b, stride)?);
        let left = |i: i64, j: i64| {
            let (dx, dy) = ((goal.0 - i).unsigned_abs() as u32, (goal.1 - j).unsigned_abs() as u32);
            (LEFT_STEPS[0] * dx.max(dy) + (LEFT_STEPS[1] - LEFT_STEPS[0]) * dx.min(dy)) / stride as u32
        };
        self.search += 1;
        let (first, last) = ((start.1 * nx + start.0) as usize, (goal.1 * nx + goal.0) as usize);
        self.seen[first] = (self.search, 0, 0, false);
        let mut open = BinaryHeap::from([Reverse((left(start.0, start.1), first as u32))]);
        while let Some(Reverse((_, cell))) = open.pop() {
            let (_, cost, _, done) = self.seen[cell as usize];
            if cell as usize == last {
                let mut way = self.back(first, last, stride * nx, stride);
                let ends = [a, b].map(|(i, j)| j * nx as usize + i);
                way.insert(0, ends[0]);
                way.push(ends[1]);
                way.dedup();
                return Some(way);
            }
            if done {
                continue;
            }
            self.seen[cell as usize].3 = true;
            let (i, j) = (i64::from(cell) % nx, i64::from(cell) / nx);
            for (k, (di, dj)) in AROUND.into_iter().enumerate() {
                let (x, y) = (i + stride * di, j + stride * dj);
                if x < 0 || y < 0 || x >= nx || y >= ny {
                    continue;
                }
                let next = (y * nx + x) as usize;
                let (search, known, _, done) = self.seen[next];
                if self.grade[next] == Grade::Closed || search == self.search && done {
                    continue;
                }
                // what lies beside and between must be open too
                let open_at = |x: i64, y: i64| self.grade[(y * nx + x) as usize] != Grade::Closed;
                let slanted = di != 0 && dj != 0;
                if slanted && !(open_at(i + di, j) && open_at(i, j + dj)) || stride > 1 && !open_at(i + di, j + dj) {
                    continue;
                }
                let steps = if self.grade[next] == Grade::Roomy { STEPS } else { TIGHT_STEPS };
                let cost = cost + steps[usize::from(slanted)];
                if search != self.search || cost < known {
                    self.seen[next] = (self.search, cost, k as u8, false);
                    open.push(Reverse((cost + left(x, y), next as u32)));
                }
            }
        }
        None
    }

    /// Returns the open cell at a cell, or beside it, whose column and row are multiples of the stride.
    fn on_stride(&self, (i, j): (usize, usize), stride: i64) -> Option<(i64, i64)> {
        let (nx, ny) = (self.floor.occupancy.frame.nx as i64, self.floor.occupancy.frame.ny as i64);
        let near = |v: usize| (v as i64 - stride + 1..v as i64 + stride).filter(move |v| v % stride == 0);
        let open = |(x, y): &(i64, i64)| {
            *x >= 0 && *y >= 0 && *x < nx && *y < ny && self.grade[(y * nx + x) as usize] != Grade::Closed
        };
        let here = open(&(i as i64, j as i64));
        near(j).flat_map(|y| near(i).map(move |x| (x, y))).find(open).filter(|_| here)
    }

    fn back(&self, first: usize, last: usize, row: i64, column: i64) -> Vec<usize> {
        let mut out = vec![last];
        let mut here = last;
        while here != first {
            let (di, dj) = AROUND[usize::from(self.seen[here].2)];
            here = (here as i64 - dj * row - di * column) as usize;
            out.push(here);
        }
        out.reverse();
        out
    }

    /// Returns the cells of a way where it turns, both ends with them, as few as the floor allows.
    fn corners(&self, cells: &[usize]) -> Vec<usize> {
        if cells.len() < 2 {
            return vec![cells[0]; 2];
        }
        let frame = &self.floor.occupancy.frame;
        let center = |k: usize| frame.center(cells[k] % frame.nx, cells[k] / frame.nx);
        let end = cells.len() - 1;
        let turns = (1..end).filter(|&k| cells[k] + cells[k] != cells[k - 1] + cells[k + 1]).chain([end]);
        let (mut out, mut from, mut before) = (vec![cells[0]], 0, 0);
        for turn in turns {
            let width = cells[from..=turn].iter().map(|c| self.wide[*c]).min().unwrap_or(0).min(self.passed);
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
