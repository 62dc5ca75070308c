//! Ways within a room past what stands there, on a lattice of points whose distance to everything is exact.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use d3dgen_model::geometry::to_mm;
use d3dgen_model::obstacles::Obstacles;
use d3dgen_model::{Point, Rect};

/// Play beside a robot, on each side, beyond which more makes a way no better, m.
pub(crate) const PLAY_M: f64 = 0.25;
/// Play that straight lines between corners keep where the way has it, m.
pub(crate) const LINE_PLAY_M: f64 = 0.15;
/// How much of its length a way without play costs on top, m/m.
const TIGHT: f64 = 3.0;
/// Distances between points, m: fine ones where coarse ones find no way.
const STEPS_M: [f64; 3] = [0.1, 0.05, 0.025];
/// Floor from which on points lie farther apart at first, m^2, and how far.
const LARGE_M2: f64 = 120.0;
const LARGE_STEP_M: f64 = 0.2;
/// Distances beyond the play that counts which are still told apart, m: they say how far around nothing is near.
const BEYOND_M: f64 = 0.6;
/// Length of the pieces in which the play of a line is compared with that of the way, m.
const PIECE_M: f64 = 0.4;
/// How much of what is left to go is taken to cost more than its length: fewer points are looked at.
const HASTE: f32 = 1.1;
/// Distance that is not known yet.
const UNKNOWN: f32 = -1.0;
/// Neighbors of a point.
const AROUND: [(i32, i32); 8] = [(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)];

/// Returns how much a meter costs with this play, m.
pub(crate) fn factor(play: f64) -> f64 {
    let tight = ((PLAY_M - play) / PLAY_M).clamp(0.0, 1.0);
    1.0 + TIGHT * tight * tight
}

/// What a way must keep clear of.
pub(crate) struct Room<'o> {
    pub obstacles: &'o Obstacles,
    /// Least distance, m.
    pub need: f64,
}

/// What a search knows of a point.
#[derive(Debug, Clone, Copy)]
struct Seen {
    /// Number of the search.
    search: u32,
    cost: f32,
    /// Neighbor it was reached from; 8 for where the search began.
    from: u8,
    done: bool,
}

/// The points of one room.
pub(crate) struct Lattice {
    origin: Point,
    step: f64,
    nx: i32,
    ny: i32,
    /// Distance of each point to the nearest edge, m, or less than that where it is more than counts.
    clear: Vec<f32>,
    seen: Vec<Seen>,
    search: u32,
}

impl Lattice {
    /// Returns the lattices of a room, the coarsest first.
    pub fn all(bounds: &Rect) -> Vec<Self> {
        let coarse = (bounds.area() >= LARGE_M2).then_some(LARGE_STEP_M);
        coarse.into_iter().chain(STEPS_M).map(|step| Self::new(bounds, step)).collect()
    }

    fn new(bounds: &Rect, step: f64) -> Self {
        let (half_x, half_y) = ((bounds.width() / 2.0 / step).floor(), (bounds.height() / 2.0 / step).floor());
        let c = bounds.center();
        // in line with the middle of the room: there is where narrow ones are widest
        let origin = Point::new(c.x - half_x * step, c.y - half_y * step);
        let (nx, ny) = (2 * half_x as i32 + 1, 2 * half_y as i32 + 1);
        Self { origin, step, nx, ny, clear: Vec::new(), seen: Vec::new(), search: 0 }
    }

    fn at(&self, k: usize) -> Point {
        let (i, j) = (k as i32 % self.nx, k as i32 / self.nx);
        Point::new(self.origin.x + f64::from(i) * self.step, self.origin.y + f64::from(j) * self.step)
    }

    /// Returns the corners of a way between two points and its cost, m; `None` where the lattice has none that costs at most so
    /// much.
    pub fn path(&mut self, room: &Room, a: Point, b: Point, most: f64) -> Option<(Vec<Point>, f64)> {
        if self.clear.is_empty() {
            let count = self.nx as usize * self.ny as usize;
            self.clear = vec![UNKNOWN; count];
            self.seen = vec![Seen { search: 0, cost: 0.0, from: 8, done: false }; count];
        }
        let found = self.find(room, a, b, most as f32)?;
        let points: Vec<Point> = [a].into_iter().chain(found.iter().map(|&k| self.at(k))).chain([b]).collect();
        let most = room.need + PLAY_M;
        let clear: Vec<f64> = points.iter().map(|p| room.obstacles.distance(*p, most)).collect();
        let pieces = points.windows(2).zip(clear.windows(2));
        let cost = pieces.map(|(p, c)| p[0].distance(p[1]) * factor((c[0] + c[1]) / 2.0 - room.need)).sum();
        let corners = straightened(room, &points, &clear);
        let round = |p: Point| Point::new(to_mm(p.x), to_mm(p.y));
        let last = corners.len() - 1;
        let ends = |(k, p): (usize, Point)| if k == 0 || k == last { p } else { round(p) };
        Some((corners.into_iter().enumerate().map(ends).collect(), cost))
    }

    /// Returns the points beside another one that a robot gets to from it straight.
    fn beside(&mut self, room: &Room, p: Point) -> Vec<usize> {
        let (i, j) = ((p.x - self.origin.x) / self.step, (p.y - self.origin.y) / self.step);
        let near =
            |v: f64, n: i32| ((v.floor() as i32 - 1).max(0)..(v.floor() as i32 + 3).min(n)).collect::<Vec<i32>>();
        let mut out = Vec::new();
        for y in near(j, self.ny) {
            for x in near(i, self.nx) {
                let k = (y * self.nx + x) as usize;
                let q = self.at(k);
                if self.distance(room, k) >= room.need && room.obstacles.along(p, q, room.need) >= room.need {
                    out.push(k);
                }
            }
        }
        out
    }

    fn distance(&mut self, room: &Room, k: usize) -> f64 {
        if self.clear[k] == UNKNOWN {
            self.clear[k] = room.obstacles.distance(self.at(k), room.need + PLAY_M + BEYOND_M) as f32;
        }
        f64::from(self.clear[k])
    }

    /// Returns the points of the cheapest way, or of one that is little dearer, if it costs at most so much.
    fn find(&mut self, room: &Room, a: Point, b: Point, dearest: f32) -> Option<Vec<usize>> {
        let goals = self.beside(room, b);
        let starts = self.beside(room, a);
        if goals.is_empty() {
            return None;
        }
        self.search += 1;
        let (search, origin, step, nx) = (self.search, self.origin, self.step, self.nx);
        let to = [(b.x - origin.x) / step, (b.y - origin.y) / step].map(|v| v as f32);
        let left = |i: i32, j: i32| {
            let (dx, dy) = ((to[0] - i as f32).abs(), (to[1] - j as f32).abs());
            HASTE * step as f32 * (dx.max(dy) + (std::f32::consts::SQRT_2 - 1.0) * dx.min(dy))
        };
        // costs are positive: their bits have their order
        let key = |cost: f32, k: usize| Reverse((cost.to_bits(), k as u32));
        let mut open = BinaryHeap::new();
        for k in starts {
            let cost = a.distance(self.at(k)) as f32;
            self.seen[k] = Seen { search, cost, from: 8, done: false };
            open.push(key(cost + left(k as i32 % nx, k as i32 / nx), k));
        }
        while let Some(Reverse((_, k))) = open.pop() {
            let k = k as usize;
            if self.seen[k].done {
                continue;
            }
            self.seen[k].done = true;
            if goals.contains(&k) {
                return Some(self.back(k));
            }
            let (i, j) = (k as i32 % nx, k as i32 / nx);
            let (here, cost) = (self.clear[k], self.seen[k].cost);
            for (n, (di, dj)) in AROUND.into_iter().enumerate() {
                let (x, y) = (i + di, j + dj);
                if x < 0 || y < 0 || x >= nx || y >= self.ny {
                    continue;
                }
                let next = (y * nx + x) as usize;
                if self.seen[next].search == search && self.seen[next].done {
                    continue;
                }
                let length = if n < 4 { step } else { step * std::f64::consts::SQRT_2 };
                let (need, most) = (room.need, room.need + PLAY_M);
                if self.clear[next] == UNKNOWN && f64::from(here) - length >= most {
                    self.clear[next] = here - length as f32;
                }
                let there = self.distance(room, next);
                if there < need {
                    continue;
                }
                let between = (f64::from(here) + there - length) / 2.0;
                if between < need && room.obstacles.along(self.at(k), self.at(next), need) < need {
                    continue;
                }
                let cost = cost + (length * factor(there - need)) as f32;
                if cost + left(x, y) / HASTE > dearest {
                    continue;
                }
                if self.seen[next].search != search || cost < self.seen[next].cost {
                    self.seen[next] = Seen { search, cost, from: n as u8, done: false };
                    open.push(key(cost + left(x, y), next));
                }
            }
        }
        None
    }

    fn back(&self, last: usize) -> Vec<usize> {
        let mut out = vec![last];
        let mut here = last;
        while let Some((di, dj)) = AROUND.get(usize::from(self.seen[here].from)) {
            here = (here as i32 - dj * self.nx - di) as usize;
            out.push(here);
        }
        out.reverse();
        out
    }
}

/// Returns the points of a way where it turns, as few as its play allows.
fn straightened(room: &Room, points: &[Point], clear: &[f64]) -> Vec<Point> {
    let last = points.len() - 1;
    let mut out = vec![points[0]];
    let mut here = 0;
    while here < last {
        // twice as far each time, then between the last that went and the first that did not
        let (mut good, mut reach) = (here + 1, 2);
        while good < last && is_straight(room, points, clear, (here, (here + reach).min(last))) {
            good = (here + reach).min(last);
            reach *= 2;
        }
        let mut bad = (here + reach).min(last + 1);
        while good + 1 < bad {
            let middle = (good + bad) / 2;
            match is_straight(room, points, clear, (here, middle)) {
                true => good = middle,
                false => bad = middle,
            }
        }
        out.push(points[good]);
        here = good;
    }
    out
}

/// Returns true when a straight line keeps as much play all along as the way that it is taken for.
fn is_straight(room: &Room, points: &[Point], clear: &[f64], (from, to): (usize, usize)) -> bool {
    let (a, b) = (points[from], points[to]);
    let pieces = (a.distance(b) / PIECE_M).ceil().max(1.0);
    let count = (to - from) as f64;
    (0..pieces as u32).all(|k| {
        let [t0, t1] = [f64::from(k) / pieces, f64::from(k + 1) / pieces];
        let at = |t: f64| Point::new(a.x + t * (b.x - a.x), a.y + t * (b.y - a.y));
        let first = (from as f64 + t0 * count).floor() as usize;
        let end = ((from as f64 + t1 * count).ceil() as usize).min(to);
        let nearby = clear[first.saturating_sub(2).max(from)..=(end + 2).min(to)].iter();
        let least = nearby.fold(room.need + LINE_PLAY_M, |l, c| l.min(*c)).max(room.need);
        room.obstacles.along(at(t0), at(t1), least) >= least - 1e-9
    })
}
