//! Objects as upright boxes turned about the vertical, and the floor and walls they stand on and at.

use d3dgen_model::floorplan::{Door, Floorplan, PlanRoom};
use d3dgen_model::placements::Placement;
use d3dgen_model::world::World;
use d3dgen_model::{Point, Rect, Segment};
use geo::{Area, BooleanOps};
use parry2d::math::{Pose, Vector};
use parry2d::query::{self, PointQuery};
use parry2d::shape::Cuboid;

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
    /// Where the outline lies, x along its front.
    at: Pose,
    /// The outline, in its own frame.
    outline: Cuboid,
}

impl<'a> Solid<'a> {
    /// Returns the box of an object.
    pub fn new(placement: &'a Placement) -> Self {
        let [width, depth, height] = placement.size_m;
        let (f, l) = (depth / 2.0, width / 2.0);
        let at = Pose::new(vector(Point::new(placement.pose.x, placement.pose.y)), placement.pose.yaw_rad);
        let quad = [(-f, -l), (f, -l), (f, l), (-f, l)].map(|(x, y)| point(at.transform_point(Vector::new(x, y))));
        let mut bounds = Rect { x0: quad[0].x, y0: quad[0].y, x1: quad[0].x, y1: quad[0].y };
        for p in &quad {
            bounds.x0 = bounds.x0.min(p.x);
            bounds.y0 = bounds.y0.min(p.y);
            bounds.x1 = bounds.x1.max(p.x);
            bounds.y1 = bounds.y1.max(p.y);
        }
        let z0 = placement.pose.z;
        let center = Point::new(placement.pose.x, placement.pose.y);
        Self { placement, center, quad, bounds, z0, z1: z0 + height, at, outline: Cuboid::new(Vector::new(f, l)) }
    }

    /// Returns true for rugs, mats and the like.
    pub fn is_covering(&self) -> bool {
        self.z1 <= COVERING_M && self.z0 <= COVERING_M
    }

    /// Returns a point of the own frame (forward, left) on the plan.
    pub fn at(&self, forward: f64, left: f64) -> Point {
        point(self.at.transform_point(Vector::new(forward, left)))
    }

    /// Returns true when the point lies in the outline or no further than `margin` outside it, m.
    pub fn covers(&self, p: Point, margin: f64) -> bool {
        self.distance(p) <= margin
    }

    /// Returns the distance of a point from the outline, m; 0 inside.
    pub fn distance(&self, p: Point) -> f64 {
        self.outline.distance_to_point(&self.at, vector(p), true)
    }

    /// Returns how far one would have to be moved to be clear of the other, m; zero or less when they do not overlap.
    pub fn penetration(&self, other: &Self) -> f64 {
        let vertical = self.z1.min(other.z1) - self.z0.max(other.z0);
        if vertical <= 0.0 || !self.bounds.overlaps(&other.bounds) {
            return vertical.min(0.0);
        }
        let contact = query::contact(&self.at, &self.outline, &other.at, &other.outline, 0.0);
        contact.ok().flatten().map_or(0.0, |c| vertical.min(-c.dist))
    }

    /// Returns the area of the outline in a rectangle, m^2.
    pub fn area_inside(&self, rect: &Rect) -> f64 {
        let outline = geo::Polygon::new(self.quad.iter().map(|p| (p.x, p.y)).collect::<Vec<_>>().into(), Vec::new());
        let rect = geo::Rect::new((rect.x0, rect.y0), (rect.x1, rect.y1)).to_polygon();
        outline.intersection(&rect).unsigned_area()
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

/// Returns a point as parry has it.
pub fn vector(p: Point) -> Vector {
    Vector::new(p.x, p.y)
}

fn point(v: Vector) -> Point {
    Point::new(v.x, v.y)
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
    fn areas_in_rectangles_are_those_of_the_outline() {
        let mut p = sample::thing("a", (0.0, 0.0), [2.0, 2.0, 1.0]);
        let right = Rect::new(0.0, -5.0, 5.0, 5.0);
        assert!((Solid::new(&p).area_inside(&right) - 2.0).abs() < 1e-6);
        p.pose.yaw_rad = std::f64::consts::FRAC_PI_4;
        assert!((Solid::new(&p).area_inside(&right) - 2.0).abs() < 1e-6);
        assert_eq!(Solid::new(&p).area_inside(&Rect::new(3.0, 3.0, 4.0, 4.0)), 0.0);
    }
}
