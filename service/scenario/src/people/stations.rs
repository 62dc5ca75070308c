//! Places at objects where people do something: seats, beds, what is operated, counters with those who wait before them.

use d3dgen_model::domain::{ObjectType, Shape};
use d3dgen_model::offer::seats_across;
use d3dgen_model::placements::Placement;
use d3dgen_model::scenario::{Act, Station};
use d3dgen_model::{Point, Pose};

use super::facing;
use super::ground::{Ground, Room, STANDING_M, is_for_lying};

/// Gap between somebody and the object that is used, m.
const GAP_M: f64 = 0.05;
/// How far off the wanted place one may stand, m.
const OFF_M: f64 = 0.4;
/// Breadth of a seat on what has no seats of its own, m.
const SEAT_M: f64 = 0.6;
/// From one of those who wait in turn to the next, m: with the room that strangers leave (0.6 to 0.8 m, Fruin 1971).
const QUEUE_STEP_M: f64 = 0.75;
/// Floor of a room for each who waits in it, m^2: those who go past them need as much as they.
const WAITING_M2: f64 = 2.0;
/// Most who wait in one queue.
const MOST_IN_QUEUE: usize = 10;

/// Returns all places of a room where an act is done.
pub(super) fn of_room(ground: &Ground, room: &Room, act: Act) -> Vec<Station> {
    let Some(affordance) = act.affordance() else { return Vec::new() };
    let fits = |(p, o): &&(&Placement, &ObjectType)| {
        let served = act != Act::Queue || o.shape == Shape::Counter;
        let seat = act != Act::Sit || !is_for_lying(o);
        let wet = matches!(o.shape, Shape::Toilet | Shape::Cubicle | Shape::Bathtub | Shape::Shower);
        served && seat && !wet && p.support.is_none() && o.affordances.iter().any(|a| a == affordance)
    };
    let mut all: Vec<Station> =
        room.objects.iter().filter(fits).flat_map(|(p, o)| of_object(ground, room, (p, o), act)).collect();
    if act == Act::Queue {
        add_lines(ground, room, &mut all);
    }
    all
}

/// Adds the lines before the counters of a room: beside each other, and together no longer than its floor holds.
fn add_lines(ground: &Ground, room: &Room, counters: &mut [Station]) {
    let point = |pose: &Pose| Point::new(pose.x, pose.y);
    let mut taken: Vec<Point> = counters.iter().map(|s| point(&s.before)).collect();
    let most = ((room.plan.net_area_m2 / WAITING_M2) as usize / counters.len().max(1)).min(MOST_IN_QUEUE);
    for counter in counters {
        let (before, object) = (point(&counter.before), middle_of(room, &counter.placement_id));
        counter.queue = queue(ground, room, (before, object), &taken, most);
        taken.extend(&counter.queue);
    }
}

fn middle_of(room: &Room, placement_id: &str) -> Point {
    let found = room.objects.iter().find(|(p, _)| p.placement_id == placement_id);
    found.map_or(room.plan.net_polygon.bounds().center(), |(p, _)| Point::new(p.pose.x, p.pose.y))
}

fn of_object(ground: &Ground, room: &Room, (p, o): (&Placement, &ObjectType), act: Act) -> Vec<Station> {
    let count = if act == Act::Sit { seats(o, p) } else { 1 };
    let station = |k: u32| {
        let middle = seat(p, k, count);
        let before = sides(act, o.shape).iter().find_map(|&side| {
            let wanted = beside(p, middle, side, STANDING_M + GAP_M);
            ground.near(room.plan, wanted, OFF_M)
        })?;
        let pose = facing(before, middle);
        let at = match act {
            Act::Sit | Act::Lie => Pose { z: 0.0, ..Pose { yaw_rad: p.pose.yaw_rad, ..facing(middle, middle) } },
            _ => pose,
        };
        let station_id = format!("{}_{}_{}", p.placement_id, act.name(), k + 1);
        let (room_id, placement_id) = (room.plan.room_id.clone(), p.placement_id.clone());
        Some(Station { station_id, room_id, placement_id, act, before: pose, at, queue: Vec::new() })
    };
    (0..count).filter_map(station).collect()
}

/// Returns how many people sit on an object.
fn seats(o: &ObjectType, p: &Placement) -> u32 {
    match seats_across(o.shape, p.size_m[0]) {
        0 => ((p.size_m[0] / SEAT_M) as u32).max(1),
        n => n,
    }
}

/// Returns the middle of one of several seats side by side.
fn seat(p: &Placement, k: u32, count: u32) -> Point {
    let left = p.size_m[0] * ((f64::from(k) + 0.5) / f64::from(count) - 0.5);
    let (sin, cos) = p.pose.yaw_rad.sin_cos();
    Point::new(p.pose.x - sin * left, p.pose.y + cos * left)
}

/// Returns the sides (in quarters to the left of the front) from which an act is done, the usual one first.
fn sides(act: Act, shape: Shape) -> &'static [u8] {
    match act {
        // whoever serves stands behind the counter
        Act::Operate if shape == Shape::Counter => &[2, 1, 3],
        Act::Queue | Act::Operate => &[0],
        Act::Lie => &[1, 3, 0],
        _ => &[0, 1, 3, 2],
    }
}

/// Returns the point this far beside an object, on the height of one of its seats.
fn beside(p: &Placement, middle: Point, side: u8, distance: f64) -> Point {
    let (sin, cos) = p.pose.yaw_rad.sin_cos();
    let [width, depth, _] = p.size_m;
    let (forward, left) = match side {
        0 => (depth / 2.0 + distance, 0.0),
        1 => (0.0, width / 2.0 + distance),
        2 => (-depth / 2.0 - distance, 0.0),
        _ => (0.0, -width / 2.0 - distance),
    };
    // to the sides one leaves from the middle of the object
    let from = if side.is_multiple_of(2) { middle } else { Point::new(p.pose.x, p.pose.y) };
    Point::new(from.x + cos * forward - sin * left, from.y + sin * forward + cos * left)
}

/// Returns where those stand who wait for a place: in a line away from it, off others, that turns where there is no floor.
fn queue(ground: &Ground, room: &Room, (before, object): (Point, Point), taken: &[Point], most: usize) -> Vec<Point> {
    let far = before.distance(object).max(0.01);
    let (mut dx, mut dy) = ((before.x - object.x) / far, (before.y - object.y) / far);
    let mut out: Vec<Point> = Vec::new();
    let mut last = before;
    while out.len() < most {
        let turned = [(dx, dy), (-dy, dx), (dy, -dx)];
        let next = turned.into_iter().find_map(|(x, y)| {
            let wanted = Point::new(last.x + x * QUEUE_STEP_M, last.y + y * QUEUE_STEP_M);
            let at = ground.near(room.plan, wanted, 0.1)?;
            let apart = taken.iter().chain(&out).all(|p| p.distance(at) > QUEUE_STEP_M - 0.15);
            apart.then_some((at, (x, y)))
        });
        let Some((at, way)) = next else { break };
        (dx, dy) = way;
        out.push(at);
        last = at;
    }
    out.into_iter()
        .map(|p| Point::new(d3dgen_model::geometry::to_mm(p.x), d3dgen_model::geometry::to_mm(p.y)))
        .collect()
}
