//! Lifts: a car of the size of its shaft, its doors as the car sees them, and which of them open on which storey.

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::floorplan::{Door, Floorplan, PlanRoom};
use d3dgen_model::geometry::{Point, to_mm};
use d3dgen_model::storeys::VerticalLink;
use serde_json::{Map, Value, json};

use super::level_name;

/// Doors at places closer than this are one, m.
const ONE_DOOR_M: f64 = 0.05;

/// A lift of a plan.
struct Lift<'a> {
    link: &'a VerticalLink,
    /// Middle of the car, and its heading: that of its first door's line, rad.
    at: Point,
    yaw: f64,
    /// Along the door and across it, m.
    size: [f64; 2],
    /// Rooms of the shaft from the lowest storey up.
    rooms: Vec<&'a PlanRoom>,
    /// Doors by storey.
    doors: Vec<(i32, &'a Door)>,
}

impl<'a> Lift<'a> {
    fn of(link: &'a VerticalLink, plan: &'a Floorplan) -> Option<Self> {
        let mut rooms: Vec<&PlanRoom> = link.room_ids.iter().filter_map(|id| plan.room(id)).collect();
        rooms.sort_by_key(|r| r.level);
        let lowest = *rooms.first()?;
        let doors: Vec<(i32, &Door)> =
            rooms.iter().flat_map(|r| plan.doors_of(&r.room_id).map(|d| (r.level, d))).collect();
        let line = doors.first().map(|(_, d)| d.line);
        let yaw = line.map_or(0.0, |l| (l.end.y - l.start.y).atan2(l.end.x - l.start.x));
        // the box around the shaft in the directions of its door
        let (sin, cos) = yaw.sin_cos();
        let seen = |p: Point| (p.x * cos + p.y * sin, p.y * cos - p.x * sin);
        let corners: Vec<(f64, f64)> = lowest.net_polygon.corners().iter().map(|p| seen(*p)).collect();
        let span = |of: fn(&(f64, f64)) -> f64| {
            let values = || corners.iter().map(of);
            (values().fold(f64::MAX, f64::min), values().fold(f64::MIN, f64::max))
        };
        let ((u0, u1), (v0, v1)) = (span(|c| c.0), span(|c| c.1));
        let (u, v) = ((u0 + u1) / 2.0, (v0 + v1) / 2.0);
        let at = Point::new(u * cos - v * sin, u * sin + v * cos);
        Some(Self { link, at, yaw, size: [u1 - u0, v1 - v0], rooms, doors })
    }

    /// Returns the doors by name, each as the car sees it, and the names of those that open on each storey.
    fn doors(&self) -> (Map<String, Value>, BTreeMap<i32, Vec<String>>) {
        let (sin, cos) = self.yaw.sin_cos();
        let mut places: Vec<Point> = Vec::new();
        let (mut doors, mut levels) = (Map::new(), BTreeMap::<i32, Vec<String>>::new());
        for (level, door) in &self.doors {
            let m = door.line.middle();
            let (dx, dy) = (m.x - self.at.x, m.y - self.at.y);
            let at = Point::new(dx * cos + dy * sin, dy * cos - dx * sin);
            let known = places.iter().position(|p| p.distance(at) < ONE_DOOR_M);
            let number = known.unwrap_or_else(|| {
                places.push(at);
                let turn = (door.line.end.y - door.line.start.y).atan2(door.line.end.x - door.line.start.x) - self.yaw;
                let name = format!("door{}", places.len());
                let document = json!({
                    "door_type": 2, "motion_axis_orientation": to_mm(turn), "width": to_mm(door.clear_width_m),
                    "x": to_mm(at.x), "y": to_mm(at.y),
                });
                doors.insert(name, document);
                places.len() - 1
            });
            levels.entry(*level).or_default().push(format!("door{}", number + 1));
        }
        (doors, levels)
    }
}

fn lifts<'a>(plan: &'a Floorplan, ids: &BTreeSet<String>) -> impl Iterator<Item = Lift<'a>> {
    plan.links.iter().filter(|l| ids.contains(&l.link_id)).filter_map(|l| Lift::of(l, plan))
}

/// Returns lifts as a building map has them.
pub(super) fn document(plan: &Floorplan, ids: &BTreeSet<String>) -> Value {
    let lift = |lift: Lift<'_>| {
        let (doors, levels) = lift.doors();
        let level = |room: Option<&&PlanRoom>| room.map_or_else(String::new, |r| level_name(r.level));
        let (lowest, highest) = (level(lift.rooms.first()), level(lift.rooms.last()));
        let stops: Map<String, Value> = levels.into_iter().map(|(l, names)| (level_name(l), json!(names))).collect();
        let document = json!({
            "x": to_mm(lift.at.x), "y": to_mm(lift.at.y), "yaw": (lift.yaw * 1e6).round() / 1e6,
            "width": to_mm(lift.size[0]), "depth": to_mm(lift.size[1]), "doors": doors, "level_doors": stops,
            "initial_floor_name": lowest, "lowest_floor": lowest, "highest_floor": highest,
            "reference_floor_name": lowest, "plugins": true,
        });
        (lift.link.link_id.clone(), document)
    };
    Value::Object(lifts(plan, ids).map(lift).collect())
}

/// Returns lifts as a navigation graph has them: where each is and how large.
pub(super) fn graph(plan: &Floorplan, ids: &BTreeSet<String>) -> Value {
    let lift = |lift: Lift<'_>| {
        let [width, depth] = lift.size.map(to_mm);
        let yaw = (lift.yaw * 1e6).round() / 1e6;
        let document = json!({"position": [to_mm(lift.at.x), to_mm(lift.at.y), yaw], "dims": [width, depth]});
        (lift.link.link_id.clone(), document)
    };
    Value::Object(lifts(plan, ids).map(lift).collect())
}
