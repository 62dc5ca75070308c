//! Edits of a world: other states of its parts by field mask, objects added and removed, parts pinned and freed.

use std::collections::BTreeSet;

use d3dgen_model::Document;
use d3dgen_model::edits::{Edit as Planned, Edits, StepKept};
use d3dgen_model::placements::Placement;
use d3dgen_model::world::World;
use d3dgen_pipeline::{Stop, edit};
use d3dgen_proto::v1::world_edit::Edit;
use d3dgen_proto::v1::{JobChange, ObjectMove, WorldEdit};
use prost::{Message, Name};
use prost_types::FieldMask;
use serde::Serialize;
use serde::de::DeserializeOwned;
use tonic::Status;

use crate::convert::{masked, message, part};
use crate::domains::Snapshot;
use crate::grpc::domain::plugin;
use crate::grpc::required;
use crate::status::{self, invalid};

/// Applies edits in their order; returns the rooms that edits with repair changed.
///
/// # Errors
/// `INVALID_ARGUMENT` with the edit at fault, `FAILED_PRECONDITION` when a repair finds no way; the world is then not to
/// be used.
pub(super) fn apply(
    world: &mut World,
    edits: Vec<WorldEdit>,
    now: &Snapshot,
    stop: Stop<'_>,
) -> Result<Vec<String>, Status> {
    if edits.is_empty() {
        return Err(invalid("edits", "is empty: say what to change"));
    }
    let mut changed = BTreeSet::new();
    for (i, edit) in edits.into_iter().enumerate() {
        let field = format!("edits[{i}]");
        let Some(planned) = one(world, &field, required(&field, edit.edit)?)? else { continue };
        let problems = [Edits { version: 1, edits: vec![planned.clone()] }.check(), world.check()].concat();
        if !problems.is_empty() {
            return Err(status::problems(&field, &problems));
        }
        let plugin = plugin(now, "world.scene_graph.domain", &world.scene_graph.domain)?;
        let edited = edit::apply(world, &[planned], plugin, stop).map_err(|e| status::stage(&field, e))?;
        *world = edited.world;
        changed.extend(edited.changed_room_ids);
    }
    Ok(world.floorplan.rooms.iter().map(|r| r.room_id.clone()).filter(|id| changed.contains(id)).collect())
}

/// Changes the documents as an edit says; returns an edit that repairs what is around it in the pipeline's words instead.
fn one(world: &mut World, field: &str, edit: Edit) -> Result<Option<Planned>, Status> {
    let given = |text: String| (!text.is_empty()).then_some(text);
    let at = |name: &str| format!("{field}.{name}");
    match edit {
        Edit::GraphRoom(u) => {
            let given = required(&at("graph_room.room"), u.room)?;
            let room = world.scene_graph.rooms.iter_mut().find(|r| r.id == given.room_id);
            update(&at("graph_room"), room, &given, u.update_mask, "room_id")?;
        }
        Edit::PlanRoom(u) => {
            let given = required(&at("plan_room.room"), u.room)?;
            let room = world.floorplan.rooms.iter_mut().find(|r| r.room_id == given.room_id);
            update(&at("plan_room"), room, &given, u.update_mask, "room_id")?;
        }
        Edit::Door(u) => {
            let given = required(&at("door.door"), u.door)?;
            let door = world.floorplan.doors.iter_mut().find(|d| d.door_id == given.door_id);
            update(&at("door"), door, &given, u.update_mask, "door_id")?;
        }
        Edit::Placement(u) => {
            let given = required(&at("placement.placement"), u.placement)?;
            let placement = world.placements.placements.iter_mut().find(|p| p.placement_id == given.placement_id);
            update(&at("placement"), placement, &given, u.update_mask, "placement_id")?;
        }
        Edit::AddedPlacement(given) => {
            let placement: Placement = part(&at("added_placement"), &given)?;
            world.placements.placements.push(placement);
        }
        Edit::RemovedPlacementId(id) => remove(world, &at("removed_placement_id"), &id)?,
        Edit::Lock(u) => lock(world, &at("lock.ids"), &u.ids, u.include_contents, u.locked)?,
        Edit::MovedWall(m) => return Ok(Some(Planned::MoveWall { wall_id: m.wall_id, by_m: m.by_m })),
        Edit::MovedOpening(m) => {
            return Ok(Some(Planned::MoveOpening { opening_id: m.opening_id, by_m: m.by_m }));
        }
        Edit::AddedRoom(a) => {
            let entered_from = given(a.entered_from_room_id);
            return Ok(Some(Planned::AddRoom { room_type: a.room_type, area_m2: a.area_m2, entered_from }));
        }
        Edit::RemovedRoomId(room_id) => return Ok(Some(Planned::RemoveRoom { room_id })),
        Edit::SwappedObject(s) => {
            let (object, asset) = (given(s.object), given(s.asset));
            return Ok(Some(Planned::SwapObject { placement_id: s.placement_id, object, asset }));
        }
        Edit::MovedObject(m) => {
            let ObjectMove { placement_id, x_m: x, y_m: y, yaw_rad } = m;
            return Ok(Some(Planned::MoveObject { placement_id, x, y, yaw_rad }));
        }
        Edit::AddedObject(a) => return Ok(Some(Planned::AddObject { room_id: a.room_id, object: a.object })),
        Edit::RefurnishedRoomId(room_id) => return Ok(Some(Planned::Refurnish { room_id })),
        Edit::ChangedJob(c) => {
            let JobChange { robot_id, job_id, from_poi_id, to_poi_ids: to, load_kg, seconds } = c;
            let from = given(from_poi_id);
            return Ok(Some(Planned::ChangeJob { robot_id, job_id, from, to, load_kg, seconds }));
        }
        Edit::ChangedSteps(c) => {
            let steps = c.steps.into_iter().map(|s| StepKept { number: s.number, seconds: s.seconds }).collect();
            return Ok(Some(Planned::ChangeSteps { agent_id: c.agent_id, steps }));
        }
    }
    Ok(None)
}

/// Puts the fields of a mask into a part of the world.
fn update<T, M>(field: &str, target: Option<&mut T>, given: &M, mask: Option<FieldMask>, id: &str) -> Result<(), Status>
where
    T: Serialize + DeserializeOwned,
    M: Message + Name + Default,
{
    let target = target.ok_or_else(|| invalid(field, "the world has no part with this id"))?;
    let changed = masked(field, message::<M>(target), given, mask, &[id])?;
    *target = part(field, &changed)?;
    Ok(())
}

/// Removes an object and what stands on it.
fn remove(world: &mut World, field: &str, id: &str) -> Result<(), Status> {
    let all = &mut world.placements.placements;
    if !all.iter().any(|p| p.placement_id == id) {
        return Err(invalid(field, "the world has no such object"));
    }
    let mut gone = BTreeSet::from([id.to_owned()]);
    loop {
        let stands = |p: &&Placement| p.support.as_ref().is_some_and(|s| gone.contains(s));
        let more: Vec<String> =
            all.iter().filter(stands).map(|p| p.placement_id.clone()).filter(|p| !gone.contains(p)).collect();
        if more.is_empty() {
            break;
        }
        gone.extend(more);
    }
    all.retain(|p| !gone.contains(&p.placement_id));
    Ok(())
}

/// Pins or frees parts.
fn lock(world: &mut World, field: &str, ids: &[String], contents: bool, locked: bool) -> Result<(), Status> {
    let mut left: BTreeSet<&str> = ids.iter().map(String::as_str).collect();
    let wanted = left.clone();
    let mut found = |id: &str| {
        left.remove(id);
        wanted.contains(id)
    };
    let mut rooms = BTreeSet::new();
    for room in &mut world.scene_graph.rooms {
        if found(&room.id) {
            room.locked = locked;
            rooms.insert(room.id.clone());
        }
    }
    for room in &mut world.floorplan.rooms {
        if found(&room.room_id) {
            room.locked = locked;
            rooms.insert(room.room_id.clone());
        }
    }
    let inside = |id: &str| contents && rooms.contains(id);
    for wall in &mut world.floorplan.walls {
        if found(&wall.wall_id) {
            wall.locked = locked;
        }
    }
    for door in &mut world.floorplan.doors {
        if found(&door.door_id) || door.room_ids.iter().any(|r| inside(r)) {
            door.locked = locked;
        }
    }
    for window in &mut world.floorplan.windows {
        if found(&window.window_id) || inside(&window.room_id) {
            window.locked = locked;
        }
    }
    for placement in &mut world.placements.placements {
        if found(&placement.placement_id) || inside(&placement.room_id) {
            placement.locked = locked;
        }
    }
    for robot in &mut world.scenario.robots {
        if found(&robot.robot_id) {
            robot.locked = locked;
        }
    }
    for agent in &mut world.scenario.agents {
        if found(&agent.agent_id) {
            agent.locked = locked;
        }
    }
    match left.first() {
        Some(id) => Err(invalid(field, format!("the world has no part {:?}", id.chars().take(60).collect::<String>()))),
        None => Ok(()),
    }
}
