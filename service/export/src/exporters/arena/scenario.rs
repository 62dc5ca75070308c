//! The default scenario: robots with their goals, people with their rounds, visitors who come in by the entrance.
//!
//! Only keys that every current reader of Arena knows: an unknown one makes the whole scenario unreadable.

use d3dgen_model::floorplan::Door;
use d3dgen_model::geometry::{Point, Pose, Rect, to_mm};
use d3dgen_model::scenario::RobotTask;
use d3dgen_model::world::World;
use serde_json::{Map, Value, json};

use super::snake;

/// Depth of the strip inside an entrance where visitors appear, m.
const SOURCE_DEPTH_M: f64 = 1.0;
/// Most visitors at a time.
const MAX_VISITORS: u32 = 4;

/// Returns `scenario.yaml`.
pub(super) fn scenario(world: &World) -> Value {
    let dynamic: Vec<Value> = world
        .scenario
        .agents
        .iter()
        .map(|a| {
            json!({
                "name": snake(&a.agent_id), "model": a.model, "pose": pose(&a.start),
                "agent": {"agent_type": "adult", "desired_velocity": a.speed_m_s},
                "waypoints": a.waypoints,
            })
        })
        .collect();
    let robots: Vec<Value> = world.scenario.robots.iter().map(|r| robot(r, world)).collect();
    json!({"static": [], "dynamic": dynamic, "robots": robots, "regions": regions(world)})
}

fn robot(task: &RobotTask, world: &World) -> Value {
    let poi = |id: &String| world.scenario.pois.iter().find(|p| &p.poi_id == id);
    // The reader wants at least one phase: a robot without work goes to its dock, or stays where it starts.
    let mut phases: Vec<Value> =
        task.goals.iter().chain(&task.dock).filter_map(poi).map(|p| json!({"goto": pose(&p.pose)})).collect();
    if phases.is_empty() {
        phases.push(json!({"goto": pose(&task.start)}));
    }
    json!({"start": pose(&task.start), "phases": phases})
}

/// Visitors flow from the main entrance to the rooms that people of this scenario visit.
fn regions(world: &World) -> Value {
    let mut sinks: Vec<&str> = Vec::new();
    for room in world.scenario.agents.iter().flat_map(|a| &a.waypoints) {
        if sinks.len() < 4 && !sinks.contains(&room.as_str()) {
            sinks.push(room);
        }
    }
    let entrance = world.floorplan.ways_out().into_iter().max_by_key(|d| d.entrance);
    let (Some(door), false) = (entrance, sinks.is_empty()) else {
        return json!({});
    };
    let affinity: Vec<Value> = sinks.iter().map(|id| json!({"sink": format!("{id}_sink"), "weight": 1.0})).collect();
    let mut regions = Map::new();
    regions.insert(
        "main_entrance".into(),
        json!({
            "type": "source",
            "polygon": strip_inside(door, world).corners().map(|p| json!({"x": to_mm(p.x), "y": to_mm(p.y)})),
            "config": {
                "rate_profile": [{"t": 0.0, "rate": 0.1}], "max_concurrent": MAX_VISITORS, "max_total": -1,
                "agent": {"agent_type": "adult", "desired_velocity": {"min": 1.0, "max": 1.5}, "sink_affinity": affinity},
            },
        }),
    );
    for id in sinks {
        let sink = json!({"type": "sink", "ref": id, "config": {"absorption_radius": 0.5, "capacity": MAX_VISITORS}});
        regions.insert(format!("{id}_sink"), sink);
    }
    Value::Object(regions)
}

/// The floor just inside a door to the outside, as wide as the door.
fn strip_inside(door: &Door, world: &World) -> Rect {
    let inside = |p: Point| world.floorplan.rooms.iter().any(|r| r.polygon.contains(p));
    let (a, b, middle) = (door.line.start, door.line.end, door.line.middle());
    let probe = door.wall_thickness_m / 2.0 + 0.05;
    let near = door.wall_thickness_m / 2.0;
    if door.line.is_vertical() {
        let sign = if inside(Point::new(middle.x + probe, middle.y)) { 1.0 } else { -1.0 };
        Rect::new(a.x + sign * near, a.y, b.x + sign * (near + SOURCE_DEPTH_M), b.y)
    } else {
        let sign = if inside(Point::new(middle.x, middle.y + probe)) { 1.0 } else { -1.0 };
        Rect::new(a.x, a.y + sign * near, b.x, b.y + sign * (near + SOURCE_DEPTH_M))
    }
}

fn pose(pose: &Pose) -> Value {
    json!([to_mm(pose.x), to_mm(pose.y), (pose.yaw_rad * 1e6).round() / 1e6])
}
