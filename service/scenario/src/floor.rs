//! The free floor of a furnished building, and spots on it.

use std::cell::OnceCell;
use std::collections::BTreeMap;

use d3dgen_knowledge::clearance::quarter;
use d3dgen_model::domain::{Domain, Goods, ObjectType, RobotUse, RoomType, Shape};
use d3dgen_model::floorplan::{Door, DoorKind, Floorplan, PlanRoom};
use d3dgen_model::geometry::to_mm;
use d3dgen_model::measures::LEAST_RADIUS_M;
use d3dgen_model::obstacles::Obstacles;
use d3dgen_model::occupancy::{Bitmap, CELL_M, Occupancy, ROBOT_HEIGHT_M};
use d3dgen_model::placements::{Placement, Placements};
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::storeys::LinkKind;
use d3dgen_model::{Point, Pose, Rect};

use super::tour::Doors;

/// How much farther off a spot may be that is not tight, or only clear of the swing of doors and of chairs in use, m.
const TIGHT_M: f64 = 1.6;
const SWING_M: f64 = 1.0;
/// Floor behind a chair that whoever sits there takes and gets up on, m.
pub(crate) const CHAIR_BACK_M: f64 = 0.6;
/// Of that, what a chair takes that is pushed back, m: robots go around it where there is a way.
const PUSHED_BACK_M: f64 = 0.4;
/// Floor between a robot that serves and a chair, m.
const FROM_CHAIR_M: f64 = 0.35;
/// How far around a point spots are looked for at first, m.
const FIRST_REACH_M: f64 = 0.8;
/// Spots of a room that are looked at exactly, at most.
const MOST_TOUCHED: usize = 400;
/// Play around a spot that is enough, m, and how much farther off one may be that has it than one that has none.
const PLAY_M: f64 = 0.08;
const CLOSE_M: f64 = 0.4;
/// Slack for points that are rounded to millimeters, m.
pub(crate) const ROUNDING_M: f64 = 0.001;
/// Floor on both sides of a door, from the middle of its wall, on which nobody stops, m.
const IN_DOORWAY_M: f64 = 0.5;
/// Forward and left of the four headings.
const FORWARD: [(f64, f64); 4] = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)];

/// The building as robots and people find it.
pub(crate) struct Floor<'a> {
    pub plan: &'a Floorplan,
    placements: &'a Placements,
    pub domain: &'a Domain,
    pub rooms: Vec<Room<'a>>,
    /// Radius that everything here is reachable for, m.
    pub radius: f64,
    /// Height of the highest robot, m.
    pub height: f64,
    pub occupancy: Occupancy,
    doors: OnceCell<Doors<'a>>,
    obstacles: OnceCell<Obstacles>,
}

/// A room with what stands in it.
pub(crate) struct Room<'a> {
    pub plan: &'a PlanRoom,
    pub kind: &'a RoomType,
    pub objects: Vec<(&'a Placement, &'a ObjectType)>,
    /// Reachable cells of the room that are still free of robots and people, in a grid of the room's own.
    spots: Bitmap,
    /// Cells where the disc lies within the room, clear of all that stands there by a cell, as also on the way in where
    /// that is possible.
    roomy: Bitmap,
    /// Those of them where no door opens against the disc, no chair is pushed back against it, and nobody comes through a
    /// door.
    undisturbed: Bitmap,
    /// Floor that nothing stands on, in no doorway, over which no door opens and no chair is pushed back.
    pub quiet: Bitmap,
    /// Floor that nothing stands on, m^2.
    pub free_m2: f64,
    /// True where robots stay out: by its type, by the prompt, or because they would fall down the steps.
    pub keep_out: bool,
    /// Highest speed of robots that the prompt asks for, m/s.
    pub max_speed_m_s: Option<f64>,
    /// Its first cell in the grid of the building.
    pub corner: (i64, i64),
}

impl<'a> Floor<'a> {
    pub fn new(graph: &SceneGraph, plan: &'a Floorplan, placements: &'a Placements, domain: &'a Domain) -> Self {
        let occupancy = Occupancy::of_world(plan, placements);
        let radius = graph.robots.iter().map(|r| r.planned_radius_m()).fold(LEAST_RADIUS_M, f64::max);
        let height = graph.robots.iter().map(|r| r.height_m).fold(0.0, f64::max);
        let main = occupancy.reach(plan, radius).main;
        // grids that begin elsewhere see gaps a cell narrower
        let surely = occupancy.clear(radius + CELL_M).largest();
        let mut by_room: BTreeMap<&str, Vec<&Placement>> = BTreeMap::new();
        for p in &placements.placements {
            by_room.entry(&p.room_id).or_default().push(p);
        }
        let kinds = domain.objects_by_id();
        let mut painted = Bitmap::new(occupancy.frame.nx, occupancy.frame.ny);
        let mut room = |room: &'a PlanRoom| {
            let (i0, i1, j0, j1) = occupancy.frame.span(&room.net_polygon.bounds());
            occupancy.frame.paint(&mut painted, &room.net_polygon, true);
            let mut spots = painted.window(i0, i1, j0, j1);
            painted.fill(i0, i1, j0, j1, false);
            let disc = radius / CELL_M + 1.0;
            let mut floor = spots.clone();
            floor.intersect(&occupancy.free.window(i0, i1, j0, j1));
            let free_m2 = floor.count() as f64 * CELL_M * CELL_M;
            let mut roomy = floor.eroded(disc);
            if let Some(surely) = surely.as_ref().map(|map| map.window(i0, i1, j0, j1))
                && roomy.count_common(&surely) > 0
            {
                roomy.intersect(&surely);
            }
            let swings = plan.doors.iter().filter_map(|d| swept(d, &room.room_id));
            for taken in swings.chain(plan.doors_of(&room.room_id).map(|d| lane(d, IN_DOORWAY_M))) {
                let (a0, a1, b0, b1) = occupancy.frame.span(&taken);
                floor.fill(a0 - i0.max(0), a1 - i0.max(0), b0 - j0.max(0), b1 - j0.max(0), false);
            }
            let here = by_room.get(room.room_id.as_str()).into_iter().flatten();
            let objects: Vec<_> = here.filter_map(|p| Some((*p, *kinds.get(p.object.as_str())?))).collect();
            for (chair, _) in objects.iter().filter(|(_, o)| matches!(o.shape, Shape::Chair | Shape::SwivelChair)) {
                let back = floor_beside(chair, quarter(chair.pose.yaw_rad) + 2, CHAIR_BACK_M, 0.0);
                let (a0, a1, b0, b1) = occupancy.frame.span(&back);
                floor.fill(a0 - i0.max(0), a1 - i0.max(0), b0 - j0.max(0), b1 - j0.max(0), false);
            }
            let mut undisturbed = floor.eroded(disc);
            undisturbed.intersect(&roomy);
            spots.intersect(&main.window(i0, i1, j0, j1));
            Room {
                plan: room,
                kind: domain.room_type_or_generic(&room.room_type),
                objects,
                spots,
                roomy,
                undisturbed,
                quiet: floor,
                free_m2,
                keep_out: keeps_out(graph, plan, domain, &room.room_id),
                max_speed_m_s: graph.robot_speed_m_s(&room.room_id),
                corner: (i0.max(0), j0.max(0)),
            }
        };
        let rooms = plan.rooms.iter().map(&mut room).collect();
        let (doors, obstacles) = (OnceCell::new(), OnceCell::new());
        Self { rooms, plan, placements, domain, radius, height, occupancy, doors, obstacles }
    }

    /// Returns the reachable spot of a room nearest to a point, a little farther off rather than in a doorway or against
    /// something; `None` when the room has none.
    pub fn spot_near(&self, room: &Room, p: Point) -> Option<Point> {
        self.best_spot(room, p).map(|(_, spot)| spot)
    }

    /// Returns the same with how far off it is, m, with what is added for a bad place.
    pub fn best_spot(&self, room: &Room, p: Point) -> Option<(f64, Point)> {
        let bounds = room.plan.net_polygon.bounds();
        let mut reach = FIRST_REACH_M;
        loop {
            let near = Rect { x0: p.x - reach, y0: p.y - reach, x1: p.x + reach, y1: p.y + reach };
            let best = self.best_spot_in(room, p, &near);
            // what lies farther away is no better than its distance
            if best.is_some_and(|(off, _)| off <= reach) || near.contains(&bounds) {
                return best;
            }
            reach *= 2.0;
        }
    }

    /// Returns the best of the spots in a rectangle.
    fn best_spot_in(&self, room: &Room, p: Point, near: &Rect) -> Option<(f64, Point)> {
        let mut left: Vec<(f64, Point)> = Vec::new();
        let (i0, i1, j0, j1) = self.occupancy.frame.span(near);
        let within = |v: i64, corner: i64, n: usize| (v - corner).clamp(0, n as i64) as usize;
        for j in within(j0, room.corner.1, room.spots.ny())..within(j1, room.corner.1, room.spots.ny()) {
            for i in within(i0, room.corner.0, room.spots.nx())..within(i1, room.corner.0, room.spots.nx()) {
                if room.spots.get(i, j) {
                    let farther = match (room.undisturbed.get(i, j), room.roomy.get(i, j)) {
                        (true, _) => 0.0,
                        (_, true) => SWING_M,
                        _ => TIGHT_M,
                    };
                    let spot = self.occupancy.frame.center(i + room.corner.0 as usize, j + room.corner.1 as usize);
                    left.push((spot.distance(p) + farther, spot));
                }
            }
        }
        let any = nearest(&left).map(|k| left[k]);
        let mut looked: Option<(f64, Point)> = None;
        for _ in 0..MOST_TOUCHED {
            let Some(k) = nearest(&left).filter(|&k| looked.is_none_or(|known| left[k].0 < known.0)) else { break };
            let (off, spot) = left.remove(k);
            let play = self.obstacles().distance(spot, self.radius + PLAY_M) - self.radius;
            let off = off + CLOSE_M * (1.0 - play / PLAY_M).max(0.0);
            if play >= ROUNDING_M && looked.is_none_or(|known| off < known.0) {
                looked = Some((off, spot));
            }
        }
        // at worst one that touches something by less than a cell
        looked.or(any)
    }

    /// Returns every so many-th reachable spot of a room.
    pub fn every(&self, room: &Room, step: usize) -> Vec<Point> {
        self.all(room).step_by(step).collect()
    }

    /// Returns the number of spots of a room.
    pub fn spots(&self, room: &Room) -> usize {
        room.spots.count()
    }

    /// Returns the doors that tours lead through.
    pub fn doors(&self) -> &Doors<'a> {
        self.doors.get_or_init(|| Doors::new(self.plan))
    }

    /// Returns the type of a room; empty for rooms that the plan does not know.
    pub fn room_type(&self, room_id: &str) -> &str {
        self.rooms.iter().find(|r| r.plan.room_id == room_id).map_or("", |r| r.plan.room_type.as_str())
    }

    /// Returns how clean what robots carry to and from a room is.
    pub fn goods(&self, room_id: &str) -> Goods {
        self.rooms.iter().find(|r| r.plan.room_id == room_id).map_or(Goods::Usual, |r| r.kind.goods)
    }

    /// Returns what robots must not touch, exactly.
    pub fn obstacles(&self) -> &Obstacles {
        let below = self.height.max(ROBOT_HEIGHT_M);
        self.obstacles.get_or_init(|| Obstacles::of_world(self.plan, self.placements, below))
    }

    /// Returns the same with the chairs at tables as they stand while somebody gets up, and with floor that others take.
    pub fn obstacles_in_use(&self, others: &[Rect]) -> Obstacles {
        let below = self.height.max(ROBOT_HEIGHT_M);
        let chairs = || {
            let seats = self.rooms.iter().flat_map(|room| &room.objects).filter(|(_, o)| o.shape == Shape::Chair);
            seats.filter(|(chair, _)| chair.group.is_some())
        };
        let back = |chair: &Placement| floor_beside(chair, quarter(chair.pose.yaw_rad) + 2, PUSHED_BACK_M, 0.0);
        let taken: Vec<Rect> = chairs().map(|(chair, _)| back(chair)).chain(others.iter().copied()).collect();
        Obstacles::with(self.plan, self.placements, below, &taken)
    }

    /// Returns true when a robot at a spot has this much play around, m, measured exactly.
    pub fn has_play(&self, p: Point, play: f64) -> bool {
        let needed = self.radius + play.max(ROUNDING_M);
        self.obstacles().distance(p, needed) >= needed
    }

    /// Returns true when the disc can be at one of the spots in a rectangle.
    pub fn is_reached(&self, room: &Room, r: &Rect) -> bool {
        let (i0, i1, j0, j1) = self.occupancy.frame.span(r);
        let (i, j) = room.corner;
        room.spots.any_in(i0 - i, i1 - i, j0 - j, j1 - j)
    }

    /// Returns true for a spot on which the robot is close to a chair at a desk or table.
    pub fn is_at_chair(&self, room: &Room, p: Point) -> bool {
        let chairs = room.objects.iter().filter(|(_, o)| matches!(o.shape, Shape::Chair | Shape::SwivelChair));
        let reach = self.radius + FROM_CHAIR_M;
        chairs.map(|(chair, _)| chair.footprint().bounds()).any(|r| r.distance_to(p) < reach)
    }

    /// Takes the floor around a robot or person (of this radius) from the spots of all rooms.
    pub fn take(&mut self, p: Point, radius: f64) {
        let reach = radius + self.radius;
        let taken = Rect::new(p.x - reach, p.y - reach, p.x + reach, p.y + reach);
        let (i0, i1, j0, j1) = self.occupancy.frame.span(&taken);
        for room in &mut self.rooms {
            let (i, j) = room.corner;
            room.spots.fill(i0 - i, i1 - i, j0 - j, j1 - j, false);
        }
    }

    /// Returns all spots of a room in rows from south to north.
    fn all<'r>(&'r self, room: &'r Room) -> impl Iterator<Item = Point> + 'r {
        self.cells(room).map(|(_, spot)| spot)
    }

    /// Returns the same with the cell of each in the grid of the room.
    fn cells<'r>(&'r self, room: &'r Room) -> impl Iterator<Item = ((usize, usize), Point)> + 'r {
        let (i0, j0) = (room.corner.0 as usize, room.corner.1 as usize);
        room.spots.cells().map(move |(i, j)| ((i, j), self.occupancy.frame.center(i0 + i, j0 + j)))
    }
}

/// Returns which of some spots is the best; of equal ones the southernmost, then the westernmost.
fn nearest(spots: &[(f64, Point)]) -> Option<usize> {
    (0..spots.len()).min_by(|a, b| spots[*a].0.total_cmp(&spots[*b].0))
}

/// Returns true for a room that robots stay out of: of a kind that they do, where none is sent there, or because the prompt says so.
pub(crate) fn keeps_out(graph: &SceneGraph, plan: &Floorplan, domain: &Domain, room_id: &str) -> bool {
    let room = plan.room(room_id);
    let kind = room.map(|r| domain.room_type_or_generic(&r.room_type));
    let sent = graph.robots.iter().any(|robot| {
        robot.stops.iter().any(|id| id == room_id) || room.is_some_and(|r| robot.room_types.contains(&r.room_type))
    });
    kind.is_some_and(|kind| kind.robot.contains(&RobotUse::KeepOut) && !sent)
        || graph.keeps_robots_out(room_id)
        || plan.link_of(room_id).is_some_and(|link| link.kind == LinkKind::Stairs)
}

impl Room<'_> {
    pub fn is_for(&self, usage: RobotUse) -> bool {
        self.kind.robot.contains(&usage)
    }
}

/// Returns the floor that the leaf of a door sweeps in a room, with as much beyond the wall; `None` where it opens elsewhere.
pub(crate) fn swept(door: &Door, room_id: &str) -> Option<Rect> {
    door.swing.as_ref().filter(|swing| swing.into_room_id.as_deref() == Some(room_id))?;
    let leaves = if door.kind == DoorKind::DoubleHinged { 2.0 } else { 1.0 };
    Some(lane(door, door.line.length() / leaves + door.wall_thickness_m / 2.0))
}

/// Returns the floor on both sides of a door that people come through on, this deep.
pub(crate) fn lane(door: &Door, deep: f64) -> Rect {
    let r = door.line.bounds();
    match door.line.is_vertical() {
        true => Rect { x0: r.x0 - deep, x1: r.x1 + deep, ..r },
        false => Rect { y0: r.y0 - deep, y1: r.y1 + deep, ..r },
    }
}

/// Returns the points at this distance before an object and beside it: in front, left, behind, right.
pub(crate) fn around(p: &Placement, distance: f64) -> [Point; 4] {
    let [width, depth, _] = p.size_m;
    let side = |turns: u8| {
        let (dx, dy) = FORWARD[usize::from((quarter(p.pose.yaw_rad) + turns) % 4)];
        let away = if turns.is_multiple_of(2) { depth } else { width } / 2.0 + distance;
        Point::new(p.pose.x + dx * away, p.pose.y + dy * away)
    };
    [side(0), side(1), side(2), side(3)]
}

/// Returns the floor in front of an object: its width and `beside` on both sides, `depth` deep.
pub(crate) fn floor_in_front(p: &Placement, depth: f64, beside: f64) -> Rect {
    floor_beside(p, quarter(p.pose.yaw_rad), depth, beside)
}

/// Returns the same on the side of an object that looks along one of the four headings.
pub(crate) fn floor_beside(p: &Placement, heading: u8, depth: f64, beside: f64) -> Rect {
    let r = p.footprint().bounds();
    match heading % 4 {
        0 => Rect { x0: r.x1, x1: r.x1 + depth, y0: r.y0 - beside, y1: r.y1 + beside },
        1 => Rect { y0: r.y1, y1: r.y1 + depth, x0: r.x0 - beside, x1: r.x1 + beside },
        2 => Rect { x1: r.x0, x0: r.x0 - depth, y0: r.y0 - beside, y1: r.y1 + beside },
        _ => Rect { y1: r.y0, y0: r.y0 - depth, x0: r.x0 - beside, x1: r.x1 + beside },
    }
}

/// Returns the pose at a point that looks the nearest way along an axis at another point.
pub(crate) fn looking_at(from: Point, to: Point) -> Pose {
    use std::f64::consts::{FRAC_PI_2, PI};
    let (dx, dy) = (to.x - from.x, to.y - from.y);
    let yaw_rad = match (dx.abs() >= dy.abs(), dx >= 0.0, dy >= 0.0) {
        (true, true, _) => 0.0,
        (true, false, _) => PI,
        (false, _, true) => FRAC_PI_2,
        (false, _, false) => -FRAC_PI_2,
    };
    Pose { x: to_mm(from.x), y: to_mm(from.y), z: 0.0, yaw_rad }
}
