//! The default scenario: robots with their goals, people with their rounds, those who come in by the entrance.
//!
//! Only keys that every current reader of Arena knows: an unknown one makes the whole scenario unreadable.

use std::collections::BTreeMap;

use d3dgen_model::floorplan::Door;
use d3dgen_model::geometry::{Point, Pose, Rect, to_mm};
use d3dgen_model::scenario::RobotTask;
use d3dgen_model::world::World;
use serde_json::{Map, Value, json};

use super::snake;

/// Depth of the strip inside an entrance where visitors appear, m.
const SOURCE_DEPTH_M: f64 = 1.0;

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

/// Those who come in flow from their entrance to the rooms that their rounds lead to, which are such as they may enter.
fn regions(world: &World) -> Value {
    let mut regions = Map::new();
    for flow in &world.scenario.flows {
        let Some(door) = world.floorplan.doors.iter().find(|d| d.door_id == flow.door_id) else { continue };
        let mut sinks: BTreeMap<&str, u32> = BTreeMap::new();
        for step in flow.steps().filter(|s| world.floorplan.room(&s.room_id).is_some()) {
            *sinks.entry(&step.room_id).or_default() += 1;
        }
        if sinks.is_empty() {
            continue;
        }
        let affinity = sinks.iter().map(|(id, n)| json!({"sink": format!("{id}_sink"), "weight": f64::from(*n)}));
        let speeds = json!({"min": to_mm(0.8 * flow.speed_m_s), "max": to_mm(1.2 * flow.speed_m_s)});
        regions.insert(
            snake(&flow.flow_id),
            json!({
                "type": "source",
                "polygon": strip_inside(door, world).corners().map(|p| json!({"x": to_mm(p.x), "y": to_mm(p.y)})),
                "config": {
                    "rate_profile": [{"t": 0.0, "rate": to_mm(flow.per_min / 60.0)}],
                    "max_concurrent": flow.most, "max_total": -1,
                    "agent": {"agent_type": "adult", "desired_velocity": speeds, "sink_affinity": affinity.collect::<Vec<_>>()},
                },
            }),
        );
        for id in sinks.keys() {
            let sink = json!({"type": "sink", "ref": id, "config": {"absorption_radius": 0.5, "capacity": flow.most}});
            regions.insert(format!("{id}_sink"), sink);
        }
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
