//! Exact distances on one storey from where a robot drives to what it must not touch: walls, jambs, things on its way.
//!
//! [`crate::occupancy`] answers on cells of 5 cm, which is enough to find a way and too coarse to promise one.

use crate::floorplan::{Door, Floorplan};
use crate::geometry::{Point, Rect, Segment};
use crate::occupancy::FLAT_M;
use crate::placements::Placements;

/// Edge of the squares that edges are sorted into, m.
const BIN_M: f64 = 1.0;
/// How far beyond half its wall a door still opens the faces of rooms, m: plaster, and plans drawn by hand.
const FACE_M: f64 = 0.1;
/// Lines with less of an angle between them than this have the same direction (sine).
const SAME_DIRECTION: f64 = 0.01;
/// Length of a piece of wall that is none, m.
const NO_LENGTH_M: f64 = 1e-6;

/// Edges of all that stops a robot, sorted by where they are.
#[derive(Debug)]
pub struct Obstacles {
    edges: Vec<Segment>,
    bins: Vec<Vec<u32>>,
    origin: Point,
    nx: usize,
    ny: usize,
}

impl Obstacles {
    /// Returns the obstacles of a storey for a robot: things that are no floor covering and begin below a height, m.
    pub fn of_world(plan: &Floorplan, placements: &Placements, below_m: f64) -> Self {
        Self::with(plan, placements, below_m, &[])
    }

    /// Returns the same with floor that is taken now and then.
    pub fn with(plan: &Floorplan, placements: &Placements, below_m: f64, taken: &[Rect]) -> Self {
        let mut edges = walls(plan);
        let ring = |c: [Point; 4]| (0..4).map(move |k| Segment { start: c[k], end: c[(k + 1) % 4] });
        edges.extend(taken.iter().flat_map(|r| ring(r.corners())));
        let things = placements.placements.iter().filter(|p| p.top_m() > FLAT_M && p.pose.z < below_m);
        things.for_each(|p| edges.extend(p.footprint().edges()));
        Self::sorted(edges)
    }

    fn sorted(edges: Vec<Segment>) -> Self {
        let mut b = Rect { x0: f64::MAX, y0: f64::MAX, x1: f64::MIN, y1: f64::MIN };
        for p in edges.iter().flat_map(|e| [e.start, e.end]) {
            b = Rect { x0: b.x0.min(p.x), y0: b.y0.min(p.y), x1: b.x1.max(p.x), y1: b.y1.max(p.y) };
        }
        if edges.is_empty() {
            b = Rect::new(0.0, 0.0, 0.0, 0.0);
        }
        let count = |length: f64| (length / BIN_M).floor() as usize + 1;
        let (nx, ny) = (count(b.width()), count(b.height()));
        let mut out = Self { bins: vec![Vec::new(); nx * ny], origin: Point::new(b.x0, b.y0), nx, ny, edges };
        for k in 0..out.edges.len() {
            let (columns, rows) = out.span(&bounds(out.edges[k].start, out.edges[k].end));
            for j in rows {
                for i in columns.clone() {
                    out.bins[j * nx + i].push(k as u32);
                }
            }
        }
        out
    }

    /// Returns the columns and rows of the squares that a rectangle touches.
    fn span(&self, r: &Rect) -> (std::ops::Range<usize>, std::ops::Range<usize>) {
        // a float below zero becomes 0
        let at = |v: f64, o: f64, n: usize| (((v - o) / BIN_M) as usize).min(n - 1);
        let (o, nx, ny) = (self.origin, self.nx, self.ny);
        (at(r.x0, o.x, nx)..at(r.x1, o.x, nx) + 1, at(r.y0, o.y, ny)..at(r.y1, o.y, ny) + 1)
    }

    /// Returns the distance of a point to the nearest edge, or `most` where that is farther, m.
    pub fn distance(&self, p: Point, most: f64) -> f64 {
        let mut least = most * most;
        let (columns, rows) = self.span(&bounds(p, p).grown(most));
        for j in rows {
            for &k in self.bins[j * self.nx + columns.start..j * self.nx + columns.end].iter().flatten() {
                least = least.min(squared(p, &self.edges[k as usize]));
            }
        }
        least.sqrt()
    }

    /// Returns the distance of the nearest edge to any point of a straight line, or `most` where that is farther, m; 0
    /// where the line goes through one.
    pub fn along(&self, a: Point, b: Point, most: f64) -> f64 {
        // a long slanted line in pieces: the rectangles around them hold little else
        let pieces = (a.distance(b) / (2.0 * BIN_M)).ceil().max(1.0);
        let at = |k: f64| Point::new(a.x + (b.x - a.x) * k / pieces, a.y + (b.y - a.y) * k / pieces);
        let mut least = most * most;
        for k in 0..pieces as u32 {
            let line = Segment { start: at(f64::from(k)), end: at(f64::from(k + 1)) };
            let around = bounds(line.start, line.end).grown(least.sqrt());
            let (columns, rows) = self.span(&around);
            for j in rows {
                for &k in self.bins[j * self.nx + columns.start..j * self.nx + columns.end].iter().flatten() {
                    let edge = &self.edges[k as usize];
                    if bounds(edge.start, edge.end).grown(NO_LENGTH_M).overlaps(&around) {
                        least = least.min(squared_between(&line, edge));
                    }
                }
            }
        }
        least.sqrt()
    }

    /// Returns the distance of the nearest edge to a way from corner to corner, or `most` where that is farther, m.
    pub fn along_path(&self, path: &[Point], most: f64) -> f64 {
        path.windows(2).fold(most, |least, w| least.min(self.along(w[0], w[1], least)))
    }
}

/// Returns the part of a door's opening that is clear when it is open, on the center line of its wall: its middle.
pub fn clear_opening(door: &Door) -> Segment {
    let (length, middle) = (door.line.length(), door.line.middle());
    let k = if length > 0.0 { (door.clear_width_m / length).min(1.0) / 2.0 } else { 0.0 };
    let (dx, dy) = ((door.line.end.x - door.line.start.x) * k, (door.line.end.y - door.line.start.y) * k);
    Segment { start: Point::new(middle.x - dx, middle.y - dy), end: Point::new(middle.x + dx, middle.y + dy) }
}

/// Returns the faces of all walls, open where doors between two rooms are clear, and the jambs of those doors.
fn walls(plan: &Floorplan) -> Vec<Segment> {
    let mut out: Vec<Segment> = plan.obstacles.iter().flat_map(|o| o.outline.edges()).collect();
    for room in &plan.rooms {
        // all of its openings in the order of the doors: a face may have several
        let doors: Vec<&Door> = plan.doors_of(&room.room_id).filter(|d| d.room_ids.len() > 1).collect();
        for face in room.net_polygon.edges() {
            let mut left = vec![face];
            for door in &doors {
                left = left.into_iter().flat_map(|piece| without(piece, door)).collect();
            }
            out.extend(left);
        }
    }
    for door in plan.doors.iter().filter(|d| d.room_ids.len() > 1) {
        let clear = clear_opening(door);
        let length = clear.length().max(NO_LENGTH_M);
        let half = door.wall_thickness_m / 2.0 / length;
        // along the wall's normal
        let (dx, dy) = (-(clear.end.y - clear.start.y) * half, (clear.end.x - clear.start.x) * half);
        for p in [clear.start, clear.end] {
            out.push(Segment { start: Point::new(p.x - dx, p.y - dy), end: Point::new(p.x + dx, p.y + dy) });
        }
    }
    out
}

/// Returns what is left of a face of a wall beside the opening of a door.
fn without(face: Segment, door: &Door) -> Vec<Segment> {
    let length = face.length();
    let clear = clear_opening(door);
    if length < NO_LENGTH_M || clear.length() < NO_LENGTH_M {
        return vec![face];
    }
    let (ux, uy) = ((face.end.x - face.start.x) / length, (face.end.y - face.start.y) / length);
    let off = |p: Point| ((p.x - face.start.x) * uy - (p.y - face.start.y) * ux).abs();
    let along = |p: Point| (p.x - face.start.x) * ux + (p.y - face.start.y) * uy;
    let turned = (off(clear.start) - off(clear.end)).abs() > SAME_DIRECTION * clear.length();
    if turned || off(clear.middle()) > door.wall_thickness_m / 2.0 + FACE_M {
        return vec![face];
    }
    let (a, b) = (along(clear.start).min(along(clear.end)), along(clear.start).max(along(clear.end)));
    if b <= 0.0 || a >= length {
        return vec![face];
    }
    let at = |t: f64| Point::new(face.start.x + t * ux, face.start.y + t * uy);
    let pieces = [(0.0, a), (b, length)].into_iter().filter(|(from, to)| to - from > NO_LENGTH_M);
    pieces.map(|(from, to)| Segment { start: at(from), end: at(to) }).collect()
}

fn bounds(a: Point, b: Point) -> Rect {
    Rect::new(a.x.min(b.x), a.y.min(b.y), a.x.max(b.x), a.y.max(b.y))
}

/// Returns the squared distance of a point to a segment, m^2.
fn squared(p: Point, s: &Segment) -> f64 {
    let (dx, dy) = (s.end.x - s.start.x, s.end.y - s.start.y);
    let (px, py) = (p.x - s.start.x, p.y - s.start.y);
    let length = dx * dx + dy * dy;
    let t = if length > 0.0 { ((px * dx + py * dy) / length).clamp(0.0, 1.0) } else { 0.0 };
    let (x, y) = (px - t * dx, py - t * dy);
    x * x + y * y
}

/// Returns the squared distance between two segments, m^2; 0 where they cross.
fn squared_between(s: &Segment, t: &Segment) -> f64 {
    let turn = |a: Point, b: Point, p: Point| (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
    let apart = |u: &Segment, v: &Segment| turn(u.start, u.end, v.start) * turn(u.start, u.end, v.end) < 0.0;
    if apart(s, t) && apart(t, s) {
        return 0.0;
    }
    let ends = squared(s.start, t).min(squared(s.end, t));
    ends.min(squared(t.start, s)).min(squared(t.end, s))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(x0: f64, y0: f64, x1: f64, y1: f64) -> Segment {
        Segment { start: Point::new(x0, y0), end: Point::new(x1, y1) }
    }

    #[test]
    fn distances_are_those_to_every_edge() {
        let edges: Vec<Segment> = (0..40)
            .map(|k| {
                let (x, y) = (f64::from(k * 37 % 101) / 10.0, f64::from(k * 53 % 97) / 10.0);
                line(x, y, x + f64::from(k % 5) * 0.7, y + f64::from(k % 3) * 0.9)
            })
            .collect();
        let all = Obstacles::sorted(edges.clone());
        for k in 0..60 {
            let a = Point::new(f64::from(k * 29 % 113) / 10.0 - 0.5, f64::from(k * 71 % 107) / 10.0 - 0.5);
            let b = Point::new(f64::from(k * 17 % 113) / 10.0, f64::from(k * 13 % 107) / 10.0);
            let point = edges.iter().map(|e| squared(a, e)).fold(4.0, f64::min).sqrt();
            assert!((all.distance(a, 2.0) - point).abs() < 1e-9, "{a:?}");
            let way = line(a.x, a.y, b.x, b.y);
            let along = edges.iter().map(|e| squared_between(&way, e)).fold(4.0, f64::min).sqrt();
            assert!((all.along(a, b, 2.0) - along).abs() < 1e-9, "{a:?} {b:?}");
        }
    }

    #[test]
    fn lines_that_cross_have_no_distance_and_others_that_of_their_nearest_ends() {
        let wall = line(0.0, 0.0, 4.0, 0.0);
        assert_eq!(squared_between(&wall, &line(2.0, -1.0, 2.0, 1.0)), 0.0);
        assert!((squared_between(&wall, &line(2.0, 0.5, 3.0, 2.0)) - 0.25).abs() < 1e-12);
        assert!((squared_between(&wall, &line(7.0, 4.0, 8.0, 4.0)) - 25.0).abs() < 1e-12);
    }
}
