//! `world.yaml`: rooms as zones with their walls, doors and things.
//!
//! What Arena has no word for is left out: windows (walls run through them) and door leaves that swing (its readers turn
//! hinged doors into teleporting ones, so every door slides). An open passage is a stretch without wall; one that leads off the
//! level, to open stairs, is a door.

use d3dgen_model::TOLERANCE_M;
use d3dgen_model::domain::{Domain, RobotUse, RoomType, Zone};
use d3dgen_model::floorplan::{Door, DoorKind, FixedObstacle, Floorplan, PlanRoom};
use d3dgen_model::geometry::Segment;
use d3dgen_model::placements::Placement;
use d3dgen_model::scenario::RoiKind;
use d3dgen_model::world::World;
use serde_json::{Value, json};

use super::{position, snake};
use crate::error::Error;
use crate::used::UsedModels;

/// Thickness of a sliding panel, m.
const PANEL_M: f64 = 0.1;

/// Returns the level's document.
pub(super) fn level(world: &World, domain: &Domain, models: &UsedModels) -> Result<Value, Error> {
    let walls = solid_walls(&world.floorplan);
    let zones = world
        .floorplan
        .rooms
        .iter()
        .map(|room| zone(room, world, domain, models, &walls))
        .collect::<Result<Vec<Value>, Error>>()?;
    Ok(json!({ "zones": zones }))
}

fn zone(
    room: &PlanRoom,
    world: &World,
    domain: &Domain,
    models: &UsedModels,
    walls: &[SolidWall],
) -> Result<Value, Error> {
    let id = &room.room_id;
    let room_type = domain.room_type_or_generic(&room.room_type);
    let description = world.scene_graph.room(id).map_or(room.name.as_str(), |r| r.description.as_str());
    let wall_material = json!([room.materials.wall, {}]);
    let walls: Vec<Value> = walls
        .iter()
        .filter(|w| &w.owner == id)
        .map(|w| {
            let Segment { start, end } = w.line;
            json!({"start": position(start.x, start.y, 0.0), "end": position(end.x, end.y, 0.0), "material": wall_material})
        })
        .collect();
    let doors = world
        .floorplan
        .doors
        .iter()
        .filter(|d| {
            (d.kind != DoorKind::Open || d.room_ids.len() == 1)
                && owner(&d.room_ids, &world.floorplan) == Some(id.as_str())
        })
        .map(door)
        .collect::<Vec<Value>>();
    let things = world
        .placements
        .placements
        .iter()
        .filter(|p| &p.room_id == id)
        .map(|p| thing(p, models))
        .collect::<Result<Vec<Value>, Error>>()?;
    Ok(json!({
        "name": id,
        "description": description,
        "material": [room.materials.floor, {}],
        "corners": room.polygon.corners().iter().map(|p| position(p.x, p.y, 0.0)).collect::<Vec<_>>(),
        "walls": walls,
        "doors": doors,
        "elevators": [],
        "ceiling": room_type.zone != Zone::Outdoor,
        "ceiling_height": room.ceiling_height_m,
        "ceiling_material": [room.materials.ceiling, {}],
        "wall_material": wall_material,
        "semantics": semantics(room, room_type, world),
        "entities": {"static": things, "dynamic": []},
    }))
}

fn door(door: &Door) -> Value {
    let Segment { start, end } = door.line;
    json!({
        "name": snake(&door.door_id),
        "start": position(start.x, start.y, 0.0),
        "end": position(end.x, end.y, 0.0),
        "kind": "sliding",
        "width": PANEL_M,
        "height": door.height_m,
        "material": ["Aluminum_Anodized", {}],
    })
}

fn thing(placement: &Placement, models: &UsedModels) -> Result<Value, Error> {
    let [w, d, h] = placement.size_m;
    let pose = &placement.pose;
    let [qw, qz] = model_quaternion(pose.yaw_rad);
    Ok(json!({
        "name": placement.placement_id,
        "model": models.reference(placement)?,
        "pose": {
            "position": position(pose.x, pose.y, pose.z),
            "orientation": {"w": qw, "x": 0.0, "y": 0.0, "z": qz},
        },
        "bbox": [[-w / 2.0, w / 2.0], [-d / 2.0, d / 2.0], [0.0, h]],
        "type": placement.object,
    }))
}

/// Returns w and z of the model's turn: its front is -y where ours is +x, a quarter turn more.
fn model_quaternion(yaw_rad: f64) -> [f64; 2] {
    use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};
    let quarters = yaw_rad / FRAC_PI_2;
    // Quarter turns from a table: the platform's sine must not decide the last digit of a file.
    if (quarters - quarters.round()).abs() < 1e-9 {
        return match (quarters.round() as i64).rem_euclid(4) {
            0 => [FRAC_1_SQRT_2, FRAC_1_SQRT_2],
            1 => [0.0, 1.0],
            2 => [-FRAC_1_SQRT_2, FRAC_1_SQRT_2],
            _ => [1.0, 0.0],
        };
    }
    let (sin, cos) = ((yaw_rad + FRAC_PI_2) / 2.0).sin_cos();
    [cos, sin].map(|v| (v * 1e9).round() / 1e9)
}

/// What robots and people should know of a zone; Arena takes author-defined names.
fn semantics(room: &PlanRoom, room_type: &RoomType, world: &World) -> Vec<Value> {
    let mut list = vec![
        json!({"state": "room_type", "value": room.room_type}),
        json!({"state": "max_speed", "value": max_speed_m_s(room_type.zone)}),
    ];
    let mut predicate = |name: &str, value: Value| list.push(json!({"predicate": name, "value": value}));
    if room_type.zone == Zone::Night {
        predicate("quiet", true.into());
    }
    let has = |kind: RoiKind| world.scenario.rois.iter().any(|r| r.kind == kind && r.room_id == room.room_id);
    let used = |what: RobotUse| room_type.robot.contains(&what);
    if used(RobotUse::KeepOut) || has(RoiKind::KeepOut) {
        predicate("restricted", true.into());
    }
    if used(RobotUse::Service) || has(RoiKind::ServiceZone) {
        predicate("service_zone", true.into());
    }
    if used(RobotUse::CleaningHigh) {
        predicate("cleaning_zone", "high".into());
    } else if used(RobotUse::CleaningLow) || has(RoiKind::CleaningZone) {
        predicate("cleaning_zone", "low".into());
    }
    if used(RobotUse::Charging) || has(RoiKind::ChargingBuffer) {
        predicate("charging_buffer", true.into());
    }
    list
}

/// Returns how fast a robot may drive where people sleep, work or walk, m/s.
fn max_speed_m_s(zone: Zone) -> f64 {
    match zone {
        Zone::Night | Zone::Service => 0.6,
        Zone::Day | Zone::Public | Zone::Staff => 0.8,
        Zone::Circulation | Zone::Outdoor => 1.0,
    }
}

/// A stretch of wall and the one zone that lists it.
struct SolidWall {
    owner: String,
    line: Segment,
}

/// Returns the zone that lists a wall or door: the room rather than the corridor beside it.
fn owner<'a>(room_ids: &'a [String], plan: &Floorplan) -> Option<&'a str> {
    let circulation = |id: &&String| plan.room(id).is_some_and(|r| r.circulation);
    room_ids.iter().find(|id| !circulation(id)).or(room_ids.first()).map(String::as_str)
}

/// Returns the walls with window openings closed again, pieces in line joined.
fn solid_walls(plan: &Floorplan) -> Vec<SolidWall> {
    let walls = plan.walls.iter().map(|w| (owner(&w.room_ids, plan).unwrap_or_default().to_owned(), w.line));
    let windows = plan.windows.iter().map(|w| (w.room_id.clone(), w.line));
    // (owner, vertical, coordinate across in mm) -> (from, to) along, m.
    let mut lines: std::collections::BTreeMap<(String, bool, i64), Vec<(f64, f64)>> = Default::default();
    for (owner, line) in walls.chain(windows) {
        let vertical = line.is_vertical();
        let (a, b) = if vertical { (line.start.y, line.end.y) } else { (line.start.x, line.end.x) };
        let across = if vertical { line.start.x } else { line.start.y };
        let key = (owner, vertical, (across * 1000.0).round() as i64);
        lines.entry(key).or_default().push((a.min(b), a.max(b)));
    }
    let mut solid = Vec::new();
    for ((owner, vertical, across_mm), mut spans) in lines {
        spans.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut joined: Vec<(f64, f64)> = Vec::new();
        for span in spans {
            match joined.last_mut() {
                Some(last) if span.0 <= last.1 + TOLERANCE_M => last.1 = last.1.max(span.1),
                _ => joined.push(span),
            }
        }
        let across = across_mm as f64 / 1000.0;
        let at = |along: f64| {
            let (x, y) = if vertical { (across, along) } else { (along, across) };
            d3dgen_model::Point::new(x, y)
        };
        solid.extend(
            joined
                .into_iter()
                .map(|(a, b)| SolidWall { owner: owner.clone(), line: Segment { start: at(a), end: at(b) } }),
        );
    }
    // columns and walls that stand free, by their faces
    let faces = |o: &FixedObstacle| {
        o.outline.edges().map(|line| SolidWall { owner: o.room_id.clone(), line }).collect::<Vec<_>>()
    };
    solid.extend(plan.obstacles.iter().flat_map(faces));
    solid
}
