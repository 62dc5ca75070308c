//! Free floor beside a placed object, and the floor that doors need.

use d3dgen_model::domain::Mount;
use d3dgen_model::floorplan::Door;
use d3dgen_model::placements::Placement;
use d3dgen_model::{Point, Polygon, Rect, TOLERANCE_M};

/// Depth in front of a door that must stay free, m.
pub const DOOR_LANE_M: f64 = 0.5;
/// Depth up to which something on a wall narrows no passage and takes nobody's floor, m: what building codes let project
/// into a walk.
pub const PROJECTION_M: f64 = 0.10;
/// Height under which something on a wall is in the way of people who pass, m (80 in, ADA Standards 307.4).
pub const HEAD_ROOM_M: f64 = 2.03;
/// Overlap at which an obstacle counts as beside, not ahead, m.
const GRAZE_M: f64 = 0.02;

/// A side of an object in its own frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Where its user stands.
    Front,
    /// Its left; of the depth only the front three fifths count (a bed's side below the bedside table).
    Left,
    /// Its right, as left.
    Right,
}

/// Returns true for what hangs on a wall and is so shallow that it narrows no passage.
pub fn is_shallow(p: &Placement) -> bool {
    p.mount == Mount::Wall && p.size_m[1] <= PROJECTION_M + TOLERANCE_M
}

/// Returns the heading of a placement in quarter turns counter-clockwise from east, 0 to 3.
pub fn quarter(yaw_rad: f64) -> u8 {
    (yaw_rad / std::f64::consts::FRAC_PI_2).round().rem_euclid(4.0) as u8
}

/// Returns the free depth beside an object up to the next wall or obstacle, m.
pub fn free_depth(object: &Placement, side: Side, outline: &Polygon, obstacles: impl Iterator<Item = Rect>) -> f64 {
    let turn = match side {
        Side::Front => 0,
        Side::Left => 1,
        Side::Right => 3,
    };
    let ahead = (quarter(object.pose.yaw_rad) + turn) % 4;
    // look along +x: turn everything back by `ahead` quarters about the origin
    let mut own = turned(&object.footprint().bounds(), ahead);
    if side != Side::Front {
        // seen along its left the object's front lies to the right (low y); along its right, to the left
        let length = (own.y1 - own.y0) * 0.6;
        if side == Side::Left { own.y1 = own.y0 + length } else { own.y0 = own.y1 - length }
    }
    depth_along(own, ahead, outline, obstacles)
}

/// Returns the free depth beside a rectangle towards a quarter turn (0 east, 1 north, ...) over its whole side, m.
pub fn depth_beside(own: &Rect, ahead: u8, outline: &Polygon, obstacles: impl Iterator<Item = Rect>) -> f64 {
    depth_along(turned(own, ahead), ahead, outline, obstacles)
}

/// Returns how far one can look along +x from a rectangle that was turned back by `ahead` quarters, m.
fn depth_along(own: Rect, ahead: u8, outline: &Polygon, obstacles: impl Iterator<Item = Rect>) -> f64 {
    let (low, high) = (own.y0, own.y1);
    let meets = |y0: f64, y1: f64| y0 < high - GRAZE_M && y1 > low + GRAZE_M;
    let mut depth = f64::MAX;
    for edge in outline.edges() {
        let (a, b) = (turned_point(edge.start, ahead), turned_point(edge.end, ahead));
        if (a.x - b.x).abs() < GRAZE_M && meets(a.y.min(b.y), a.y.max(b.y)) && a.x >= own.x1 - GRAZE_M {
            depth = depth.min(a.x - own.x1);
        }
    }
    for obstacle in obstacles {
        let r = turned(&obstacle, ahead);
        if meets(r.y0, r.y1) && r.x1 > own.x1 + GRAZE_M && r.x0 > own.x0 {
            depth = depth.min(r.x0 - own.x1);
        }
    }
    if depth == f64::MAX { 0.0 } else { depth.max(0.0) }
}

/// Returns the floor a door needs: the lane through it on both sides, and the square its leaf sweeps.
pub fn door_zones(door: &Door) -> Vec<Rect> {
    let (a, b) = (door.line.start, door.line.end);
    let r = Rect::new(a.x, a.y, b.x, b.y);
    let lane = if door.line.is_vertical() {
        Rect { x0: r.x0 - DOOR_LANE_M, x1: r.x1 + DOOR_LANE_M, ..r }
    } else {
        Rect { y0: r.y0 - DOOR_LANE_M, y1: r.y1 + DOOR_LANE_M, ..r }
    };
    vec![lane]
}

fn turned_point(p: Point, quarters: u8) -> Point {
    match quarters % 4 {
        0 => p,
        1 => Point::new(p.y, -p.x),
        2 => Point::new(-p.x, -p.y),
        _ => Point::new(-p.y, p.x),
    }
}

/// Returns a rectangle turned back by quarter turns about the origin: what lay ahead lies along +x.
pub(crate) fn turned(r: &Rect, quarters: u8) -> Rect {
    let (a, b) = (turned_point(Point::new(r.x0, r.y0), quarters), turned_point(Point::new(r.x1, r.y1), quarters));
    Rect::new(a.x, a.y, b.x, b.y)
}
