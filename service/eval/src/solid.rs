//! Objects as upright boxes turned about the vertical, and the floor and walls they stand on and at: exact geometry.

use d3dgen_model::floorplan::{Door, Floorplan, PlanRoom};
use d3dgen_model::placements::Placement;
use d3dgen_model::world::World;
use d3dgen_model::{Point, Rect, Segment};

/// Things on the floor that are no higher than this can be walked and stood on, m.
pub const COVERING_M: f64 = 0.03;

/// An object as a box.
#[derive(Debug, Clone)]
pub struct Solid<'a> {
    /// The object.
    pub placement: &'a Placement,
    /// Center of the outline.
    pub center: Point,
    /// Outline, counter-clockwise.
    pub quad: [Point; 4],
    /// Rectangle around the outline.
    pub bounds: Rect,
    /// Height of the underside, m.
    pub z0: f64,
    /// Height of the top, m.
    pub z1: f64,
    /// Unit vector of the front.
    front: (f64, f64),
}

impl<'a> Solid<'a> {
    /// Returns the box of an object.
    pub fn new(placement: &'a Placement) -> Self {
        let (sin, cos) = placement.pose.yaw_rad.sin_cos();
        let center = Point::new(placement.pose.x, placement.pose.y);
        let [width, depth, height] = placement.size_m;
        let at = |f: f64, l: f64| Point::new(center.x + cos * f - sin * l, center.y + sin * f + cos * l);
        let (f, l) = (depth / 2.0, width / 2.0);
        let quad = [at(-f, -l), at(f, -l), at(f, l), at(-f, l)];
        let mut bounds = Rect { x0: quad[0].x, y0: quad[0].y, x1: quad[0].x, y1: quad[0].y };
        for p in &quad {
            bounds.x0 = bounds.x0.min(p.x);
            bounds.y0 = bounds.y0.min(p.y);
            bounds.x1 = bounds.x1.max(p.x);
            bounds.y1 = bounds.y1.max(p.y);
        }
        let z0 = placement.pose.z;
        Self { placement, center, quad, bounds, z0, z1: z0 + height, front: (cos, sin) }
    }

    /// Returns true for rugs, mats and the like.
    pub fn is_covering(&self) -> bool {
        self.z1 <= COVERING_M && self.z0 <= COVERING_M
    }

    /// Returns a point of the own frame (forward, left) on the plan.
    pub fn at(&self, forward: f64, left: f64) -> Point {
        let (cos, sin) = self.front;
        Point::new(self.center.x + cos * forward - sin * left, self.center.y + sin * forward + cos * left)
    }

    /// Returns true when the point lies in the outline or no further than `margin` outside it, m.
    pub fn covers(&self, p: Point, margin: f64) -> bool {
        let (dx, dy) = (p.x - self.center.x, p.y - self.center.y);
        let (cos, sin) = self.front;
        let [width, depth, _] = self.placement.size_m;
        (dx * cos + dy * sin).abs() <= depth / 2.0 + margin && (dy * cos - dx * sin).abs() <= width / 2.0 + margin
    }

    /// Returns the distance of a point from the outline, m; 0 inside.
    pub fn distance(&self, p: Point) -> f64 {
        let (dx, dy) = (p.x - self.center.x, p.y - self.center.y);
        let (cos, sin) = self.front;
        let [width, depth, _] = self.placement.size_m;
        let beyond = |along: f64, half: f64| (along.abs() - half).max(0.0);
        beyond(dx * cos + dy * sin, depth / 2.0).hypot(beyond(dy * cos - dx * sin, width / 2.0))
    }

    /// Returns how far one would have to be moved to be clear of the other, m; zero or less when they do not overlap.
    pub fn penetration(&self, other: &Self) -> f64 {
        let vertical = self.z1.min(other.z1) - self.z0.max(other.z0);
        if vertical <= 0.0 || !self.bounds.overlaps(&other.bounds) {
            return vertical.min(0.0);
        }
        let axes = [self.front, (-self.front.1, self.front.0), other.front, (-other.front.1, other.front.0)];
        axes.iter().map(|axis| overlap(&self.quad, &other.quad, *axis)).fold(vertical, f64::min)
    }

    /// Returns evenly spaced points of the outline, `n` by `n`, the outermost a millimeter inside.
    pub fn samples(&self, n: usize) -> impl Iterator<Item = Point> + '_ {
        let [width, depth, _] = self.placement.size_m;
        let step = move |i: usize, length: f64| {
            let inner = (length - 2.0 * d3dgen_model::TOLERANCE_M).max(0.0);
            inner * (i as f64 / (n - 1).max(1) as f64 - 0.5)
        };
        (0..n).flat_map(move |i| (0..n).map(move |j| self.at(step(i, depth), step(j, width))))
    }
}

fn overlap(a: &[Point], b: &[Point], (x, y): (f64, f64)) -> f64 {
    let reach = |quad: &[Point]| {
        quad.iter().map(|p| p.x * x + p.y * y).fold((f64::MAX, f64::MIN), |(lo, hi), v| (lo.min(v), hi.max(v)))
    };
    let ((a0, a1), (b0, b1)) = (reach(a), reach(b));
    a1.min(b1) - a0.max(b0)
}

/// Returns the area of a convex polygon inside a rectangle, m^2 (Sutherland and Hodgman's clipping).
pub fn area_inside(polygon: &[Point], rect: &Rect) -> f64 {
    type Inside = fn(&Point, &Rect) -> f64;
    const EDGES: [Inside; 4] = [|p, r| p.x - r.x0, |p, r| r.x1 - p.x, |p, r| p.y - r.y0, |p, r| r.y1 - p.y];
    let mut points = polygon.to_vec();
    for inside in EDGES {
        let mut kept = Vec::with_capacity(points.len() + 2);
        for (i, p) in points.iter().enumerate() {
            let q = points[(i + 1) % points.len()];
            let (a, b) = (inside(p, rect), inside(&q, rect));
            if a >= 0.0 {
                kept.push(*p);
            }
            if (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0) {
                let t = a / (a - b);
                kept.push(Point::new(p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)));
            }
        }
        points = kept;
    }
    shoelace(&points).abs()
}

/// Returns the signed area of a polygon by the shoelace formula, m^2.
pub fn shoelace(points: &[Point]) -> f64 {
    let turn = |(i, p): (usize, &Point)| {
        let q = points[(i + 1) % points.len()];
        p.x * q.y - q.x * p.y
    };
    points.iter().enumerate().map(turn).sum::<f64>() / 2.0
}

/// Returns a strip along a line, `half` wide to each side, as long as the line.
pub fn along(line: &Segment, half: f64) -> Rect {
    let r = Rect::new(line.start.x, line.start.y, line.end.x, line.end.y);
    if line.is_vertical() {
        Rect { x0: r.x0 - half, x1: r.x1 + half, ..r }
    } else {
        Rect { y0: r.y0 - half, y1: r.y1 + half, ..r }
    }
}

/// Returns the floor of a door's opening through its wall, as wide as it is clear.
pub fn threshold(door: &Door) -> Rect {
    let (length, middle) = (door.line.length(), door.line.middle());
    let k = if length > 0.0 { (door.clear_width_m / length).min(1.0) / 2.0 } else { 0.0 };
    let (dx, dy) = ((door.line.end.x - door.line.start.x) * k, (door.line.end.y - door.line.start.y) * k);
    let clear =
        Segment { start: Point::new(middle.x - dx, middle.y - dy), end: Point::new(middle.x + dx, middle.y + dy) };
    along(&clear, door.wall_thickness_m / 2.0)
}

/// A world in boxes.
pub struct Scene<'a> {
    /// The documents.
    pub world: &'a World,
    /// Objects in order of the placements.
    pub solids: Vec<Solid<'a>>,
    /// Rectangles of each room's net floor, in order of the rooms.
    pub rooms: Vec<Vec<Rect>>,
    /// The floor through each door, in order of the doors.
    pub thresholds: Vec<Rect>,
}

impl<'a> Scene<'a> {
    /// Returns the world in boxes.
    pub fn new(world: &'a World) -> Self {
        let plan: &Floorplan = &world.floorplan;
        Self {
            world,
            solids: world.placements.placements.iter().map(Solid::new).collect(),
            rooms: plan.rooms.iter().map(|r| net_floor(plan, r)).collect(),
            thresholds: plan.doors.iter().map(threshold).collect(),
        }
    }

    /// Returns every rectangle of floor; they do not overlap.
    pub fn floor(&self) -> impl Iterator<Item = &Rect> {
        self.rooms.iter().flatten().chain(&self.thresholds)
    }

    /// Returns true when there is floor at a point.
    pub fn has_floor(&self, p: Point) -> bool {
        self.floor().any(|r| r.x0 <= p.x && p.x <= r.x1 && r.y0 <= p.y && p.y <= r.y1)
    }

    /// Returns the ceiling height of the room with this id, m; infinite for one that is not in the plan.
    pub fn ceiling(&self, room_id: &str) -> f64 {
        self.world.floorplan.room(room_id).map_or(f64::INFINITY, |r| r.ceiling_height_m)
    }
}

/// Returns the net floor of a room without its columns and free walls.
fn net_floor(plan: &Floorplan, room: &PlanRoom) -> Vec<Rect> {
    let taken = plan.taken_in(&room.room_id);
    taken.iter().fold(room.net_polygon.rects(), |floor, t| floor.iter().flat_map(|r| r.without(t)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn turned_boxes_overlap_by_their_outlines() {
        let a = sample::thing("a", (0.0, 0.0), [1.0, 1.0, 1.0]);
        let mut b = sample::thing("b", (1.1, 0.0), [1.0, 1.0, 1.0]);
        assert!(Solid::new(&a).penetration(&Solid::new(&b)) <= 0.0);
        b.pose.yaw_rad = std::f64::consts::FRAC_PI_4; // half a diagonal of 0.707 m towards a
        let found = Solid::new(&a).penetration(&Solid::new(&b));
        assert!((found - (0.5 + 0.5 * 2.0f64.sqrt() - 1.1)).abs() < 1e-9, "{found}");
        b.pose.z = 1.0;
        assert!(Solid::new(&a).penetration(&Solid::new(&b)) <= 0.0, "one stands on the other");
    }

    #[test]
    fn clipped_areas_are_exact() {
        let mut p = sample::thing("a", (0.0, 0.0), [2.0, 2.0, 1.0]);
        let right = Rect::new(0.0, -5.0, 5.0, 5.0);
        assert!((area_inside(&Solid::new(&p).quad, &right) - 2.0).abs() < 1e-9);
        p.pose.yaw_rad = std::f64::consts::FRAC_PI_4;
        assert!((area_inside(&Solid::new(&p).quad, &right) - 2.0).abs() < 1e-9);
        assert_eq!(area_inside(&Solid::new(&p).quad, &Rect::new(3.0, 3.0, 4.0, 4.0)), 0.0);
    }
}
