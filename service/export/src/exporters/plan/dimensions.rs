//! Dimension chains around each storey: what its outer walls and their openings measure, side by side, and the whole.
//!
//! A side is every outer wall that faces one direction, whatever that is; its chain runs beyond all of the building.

use d3dgen_model::floorplan::{Floorplan, Wall};
use d3dgen_model::geometry::{Point, Rect, Segment};

use super::building::{Opening, is_at, outward_reach};
use super::page::{Anchor, Frame, Page, Path};
use super::style;

/// Distance of the nearest chain from the building, sheet units.
const NEAR: f64 = 48.0;
/// Distance between a chain and the one that measures the whole, in units of type.
const APART: f64 = 2.3;
/// What an arrow and a name at a door take outside, in units of type.
const AT_DOOR: f64 = 4.4;
/// Marks nearer to each other are one, m.
const ONE_MARK_M: f64 = 0.02;
/// Walls that face within this of each other are one side, as the cosine of the angle.
const ONE_SIDE: f64 = 0.999;
/// Type size of small pieces, as a share of the usual one.
const SMALL: f64 = 0.82;

/// The outer walls that face one direction.
struct Side {
    /// Unit vector outwards.
    n: (f64, f64),
    /// Ends of walls and openings along the side, m, in order.
    marks: Vec<f64>,
    /// True where people go in or out.
    door: bool,
}

impl Side {
    /// Returns the unit vector along the side, so that type on it reads from below or from the right.
    fn t(&self) -> (f64, f64) {
        let (x, y) = (-self.n.1, self.n.0);
        if x > 1e-9 || x.abs() <= 1e-9 && y > 0.0 { (x, y) } else { (-x, -y) }
    }
}

fn dot(p: Point, v: (f64, f64)) -> f64 {
    p.x * v.0 + p.y * v.1
}

/// One line of dimensions.
struct Chain {
    n: (f64, f64),
    t: (f64, f64),
    /// Distance of the line from the origin along `n`, and where the building ends there, m.
    at: f64,
    from: f64,
    marks: Vec<f64>,
    whole: bool,
}

impl Chain {
    fn point(&self, along: f64, out: f64) -> Point {
        Point::new(self.t.0 * along + self.n.0 * out, self.t.1 * along + self.n.1 * out)
    }
}

/// The chains of a plan.
pub(super) struct Dimensions(Vec<Chain>);

impl Dimensions {
    /// Returns the chains of one storey at a scale; `size` is that of their type, sheet units.
    pub fn of(plan: &Floorplan, scale: f64, size: f64) -> Self {
        let sides = sides(plan);
        let corners: Vec<Point> = plan.walls.iter().flat_map(|w| super::building::wall_body(w, plan).0).collect();
        let swing = outward_reach(plan);
        let mut chains = Vec::new();
        // the whole is measured once in each direction, where nobody goes in if there is such a side
        let mut whole: Vec<usize> = Vec::new();
        let mut by_door: Vec<usize> = (0..sides.len()).collect();
        by_door.sort_by_key(|i| sides[*i].door);
        for i in by_door {
            let n = sides[i].n;
            let parallel = |k: &usize| (sides[*k].n.0 * n.0 + sides[*k].n.1 * n.1).abs() > ONE_SIDE;
            if !whole.iter().any(parallel) {
                whole.push(i);
            }
        }
        for (i, side) in sides.iter().enumerate() {
            let (n, t) = (side.n, side.t());
            let from = corners.iter().map(|p| dot(*p, n)).fold(f64::MIN, f64::max);
            let clear = if side.door { swing + AT_DOOR * size / scale } else { 0.0 };
            let mut at = from + clear + NEAR / scale;
            let ends = [
                corners.iter().map(|p| dot(*p, t)).fold(f64::MAX, f64::min),
                corners.iter().map(|p| dot(*p, t)).fold(f64::MIN, f64::max),
            ];
            let says_more = side.marks.iter().any(|m| ends.iter().all(|e| (m - e).abs() > ONE_MARK_M));
            if says_more {
                chains.push(Chain { n, t, at, from, marks: side.marks.clone(), whole: false });
                at += APART * size / scale;
            }
            if whole.contains(&i) {
                chains.push(Chain { n, t, at, from, marks: ends.to_vec(), whole: true });
            }
        }
        Self(chains)
    }

    /// Returns the least rectangle around all lines, m; absent when there are none.
    pub fn bounds(&self) -> Option<Rect> {
        let ends = self.0.iter().flat_map(|c| c.marks.iter().map(|m| c.point(*m, c.at)));
        ends.map(|p| Rect::new(p.x, p.y, p.x, p.y)).reduce(|a, b| a.union(&b))
    }

    /// Draws them.
    pub fn draw(&self, page: &mut Page, frame: &Frame, size: f64) {
        for chain in &self.0 {
            lines(page, frame, chain, size);
            labels(page, frame, chain, size);
        }
    }

    /// Returns each chain as the points it measures between, on its line, and where the building ends at each of them, m.
    pub fn measured(&self) -> Vec<Vec<[Point; 2]>> {
        let points = |c: &Chain| c.marks.iter().map(|m| [c.point(*m, c.at), c.point(*m, c.from)]).collect();
        self.0.iter().map(points).collect()
    }
}

/// Draws a chain's line, its marks and the lines that lead to them.
fn lines(page: &mut Page, frame: &Frame, chain: &Chain, size: f64) {
    let (tick, over) = (0.42 * size, 0.5 * size);
    let on = |along: f64, out: f64, shift: (f64, f64)| {
        // along the line and outwards, on the sheet, where y runs down
        let (x, y) = frame.map(chain.point(along, out));
        let (t, n) = (chain.t, chain.n);
        (x + t.0 * shift.0 + n.0 * shift.1, y - t.1 * shift.0 - n.1 * shift.1)
    };
    let (Some(first), Some(last)) = (chain.marks.first(), chain.marks.last()) else { return };
    let mut thin = Path::new().segment(on(*first, chain.at, (-over, 0.0)), on(*last, chain.at, (over, 0.0)));
    let mut ticks = Path::new();
    for (i, mark) in chain.marks.iter().enumerate() {
        let outermost = i == 0 || i + 1 == chain.marks.len();
        let begins = if outermost || chain.whole {
            on(*mark, chain.from, (0.0, 0.3 * NEAR))
        } else {
            on(*mark, chain.at, (0.0, -over))
        };
        thin = thin.segment(begins, on(*mark, chain.at, (0.0, over)));
        ticks = ticks.segment(on(*mark, chain.at, (-tick, -tick)), on(*mark, chain.at, (tick, tick)));
    }
    page.path("dm", thin);
    page.path("dt", ticks);
}

/// Writes what the pieces of a chain measure: over its line, or where a piece is too short for that further out.
fn labels(page: &mut Page, frame: &Frame, chain: &Chain, size: f64) {
    let degrees = -chain.t.1.atan2(chain.t.0).to_degrees();
    // the side of the line that is up for who reads along it
    let up = (-chain.t.1, chain.t.0);
    let mut raised_to = f64::MIN;
    for pair in chain.marks.windows(2) {
        let (length, middle) = (pair[1] - pair[0], (pair[0] + pair[1]) / 2.0);
        let text = if chain.whole { format!("{length:.2} m") } else { format!("{length:.2}") };
        let space = length * frame.scale - 0.4 * size;
        let fits = |size: f64| page.font(style::SMALL.weight).width(&text, size) <= space;
        let (size_of, lift) = match () {
            () if fits(size) => (size, 0.45),
            () if fits(SMALL * size) => (SMALL * size, 0.45),
            () => (SMALL * size, 1.25),
        };
        let half = page.font(style::SMALL.weight).width(&text, size_of) / 2.0;
        let at = middle * frame.scale;
        if lift > 1.0 {
            if at - half < raised_to {
                continue;
            }
            raised_to = at + half + 0.3 * size;
        }
        let (x, y) = frame.map(chain.point(middle, chain.at));
        let (x, y) = (x + up.0 * lift * size, y - up.1 * lift * size);
        page.turned(degrees, (x, y), |page| {
            page.text(&text, (x, y), size_of, style::SMALL, Anchor::Middle);
        });
    }
}

/// Returns the sides of a plan's outer walls with the marks of their chains.
fn sides(plan: &Floorplan) -> Vec<Side> {
    let inside = |p: Point| plan.rooms.iter().any(|r| r.polygon.contains(p));
    let seen = |p: Point, n: (f64, f64)| {
        let far = Segment { start: p, end: Point::new(p.x + n.0 * 1e4, p.y + n.1 * 1e4) };
        !plan.rooms.iter().flat_map(|r| r.polygon.edges()).any(|e| meet(&far, &e))
    };
    let mut sides: Vec<Side> = Vec::new();
    let mut add = |o: &Opening, marks: &[f64], door: bool| {
        let side = match sides.iter().position(|s| s.n.0 * o.n.0 + s.n.1 * o.n.1 > ONE_SIDE) {
            Some(k) => &mut sides[k],
            None => {
                sides.push(Side { n: o.n, marks: Vec::new(), door: false });
                sides.last_mut().expect("one was put there")
            }
        };
        let t = side.t();
        side.marks.extend(marks.iter().map(|along| dot(o.at(*along, 0.0), t)));
        side.door |= door;
    };
    let out_of = |o: &Opening| o.at(o.length / 2.0, o.half + 0.1);
    for wall in plan.walls.iter().filter(|w| w.exterior) {
        let o = Opening::new(wall.line, wall.thickness_m, |p| !inside(p));
        if seen(out_of(&o), o.n) {
            add(&o, &face_ends(wall, &o, plan, &inside), false);
        }
    }
    let windows = plan.windows.iter().map(|w| (w.line, w.wall_thickness_m, false));
    let doors = plan.doors.iter().filter(|d| d.room_ids.len() == 1).map(|d| (d.line, d.wall_thickness_m, true));
    for (line, thickness, door) in windows.chain(doors) {
        let o = Opening::new(line, thickness, |p| !inside(p));
        if !inside(out_of(&o)) && seen(out_of(&o), o.n) {
            add(&o, &[0.0, o.length], door);
        }
    }
    for side in &mut sides {
        side.marks.sort_by(f64::total_cmp);
        side.marks.dedup_by(|b, a| *b - *a < ONE_MARK_M);
    }
    sides
}

/// Returns where the outer face of a wall ends at corners of the building, along the wall from its start: beyond its middle
/// line's end where the corner turns away, short of it where another wall comes out.
fn face_ends(wall: &Wall, o: &Opening, plan: &Floorplan, inside: &impl Fn(Point) -> bool) -> Vec<f64> {
    let near = o.half + 0.05;
    let end = |along: f64, sign: f64| {
        if is_at(plan, &wall.line, o.at(along, 0.0)) {
            return None;
        }
        match (inside(o.at(along + sign * near, near)), inside(o.at(along + sign * near, -near))) {
            (true, _) => Some(along - sign * o.half),
            (false, true) => None,
            (false, false) => Some(along + sign * o.half),
        }
    };
    [end(0.0, -1.0), end(o.length, 1.0)].into_iter().flatten().collect()
}

/// Returns true when two segments cross.
fn meet(a: &Segment, b: &Segment) -> bool {
    let turn = |p: Point, q: Point, r: Point| (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
    turn(a.start, a.end, b.start) * turn(a.start, a.end, b.end) <= 0.0
        && turn(b.start, b.end, a.start) * turn(b.start, b.end, a.end) < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn chains_add_up_and_hold_every_opening_of_a_facade() {
        let plan = sample::floorplan();
        let around = super::super::building::outer_bounds(&plan);
        let chains = Dimensions::of(&plan, 60.0, 16.0).0;
        let whole: Vec<f64> = chains.iter().filter(|c| c.whole).map(|c| c.marks[1] - c.marks[0]).collect();
        assert_eq!(whole.len(), 2, "once along, once across");
        for side in [around.width(), around.height()] {
            assert!(whole.iter().any(|w| (w - side).abs() < 1e-6), "{whole:?} has {side}");
        }
        for chain in chains.iter().filter(|c| !c.whole) {
            let sum: f64 = chain.marks.windows(2).map(|p| p[1] - p[0]).sum();
            assert!(whole.iter().any(|w| (w - sum).abs() < 0.02), "{sum} m of {whole:?}");
        }
        for line in plan.windows.iter().map(|w| w.line) {
            let found = chains.iter().filter(|c| !c.whole).any(|c| {
                let ends = [line.start, line.end].map(|p| dot(p, c.t));
                ends.iter().all(|e| c.marks.iter().any(|m| (m - e).abs() < ONE_MARK_M))
            });
            assert!(found, "the window {line:?} is measured");
        }
    }

    #[test]
    fn a_building_that_stands_askew_is_measured_along_its_walls() {
        let turned = |p: Point| {
            let (sin, cos) = 0.5_f64.sin_cos();
            Point::new(cos * p.x - sin * p.y, sin * p.x + cos * p.y)
        };
        let (straight, mut askew) = (sample::floorplan(), sample::floorplan());
        let lines = askew.walls.iter_mut().map(|w| &mut w.line);
        let lines = lines.chain(askew.doors.iter_mut().map(|d| &mut d.line));
        for line in lines.chain(askew.windows.iter_mut().map(|w| &mut w.line)) {
            (line.start, line.end) = (turned(line.start), turned(line.end));
        }
        askew.rooms.iter_mut().flat_map(|r| &mut r.polygon.0).for_each(|p| *p = turned(*p));
        let lengths = |plan: &Floorplan| {
            let chains = Dimensions::of(plan, 60.0, 16.0).0;
            let pieces = chains.iter().flat_map(|c| c.marks.windows(2).map(|p| ((p[1] - p[0]) * 100.0).round() as i64));
            let mut pieces: Vec<i64> = pieces.collect();
            pieces.sort_unstable();
            pieces
        };
        assert_eq!(lengths(&straight), lengths(&askew));
    }
}
