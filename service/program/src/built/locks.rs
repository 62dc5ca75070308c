//! Parts of a building behind a lock: operating rooms are not on the corridor that visitors wait at. The corridor there is a room of its
//! own, which a door parts from the other.

use d3dgen_model::domain::LockedPart;
use d3dgen_model::scene_graph::{BY_CIRCULATION, Connector, GraphEdge, GraphRoom, Note};

use super::rooms;
use crate::reading::Reading;

/// Rooms up to which a building has one straight corridor, which a door can part.
const MOST_ROOMS: usize = 26;
/// Rooms before the lock at least: a building that is all operating rooms has nobody to keep away.
const LEAST_BEFORE: usize = 2;

/// Puts the rooms of each locked part of the domain that the building has at a corridor of their own.
pub(crate) fn lock(reading: &mut Reading, rooms: &mut Vec<GraphRoom>, edges: &mut Vec<GraphEdge>) {
    let domain = reading.domain;
    let whole = rooms.iter().all(|r| r.level == 0 && r.unit.is_none()) && rooms.len() <= MOST_ROOMS;
    let mut ways = rooms.iter().filter(|r| r.circulation).map(|r| r.id.clone());
    let (Some(corridor), None) = (ways.next(), ways.next()) else { return };
    if !whole || reading.style.form.is_some() || reading.single {
        return;
    }
    let Some(part) = domain.circulation.locked.iter().find(|part| is_there(part, rooms)) else { return };
    let joins = |e: &GraphEdge, id: &str| e.a == corridor && e.b == id || e.b == corridor && e.a == id;
    let walkable = |e: &&GraphEdge| e.required && matches!(e.connector, Connector::Door | Connector::Open);
    let at_corridor = |r: &&GraphRoom| edges.iter().filter(walkable).any(|e| joins(e, &r.id));
    let (behind, before): (Vec<&GraphRoom>, Vec<&GraphRoom>) =
        rooms.iter().filter(at_corridor).partition(|r| part.rooms.contains(&r.room_type) && !r.entrance);
    if behind.is_empty() || before.len() < LEAST_BEFORE {
        return;
    }
    let behind: Vec<String> = behind.into_iter().map(|r| r.id.clone()).collect();
    let locks: Vec<String> =
        before.into_iter().filter(|r| part.locks.contains(&r.room_type)).map(|r| r.id.clone()).collect();
    let mut inner = rooms::circulation(reading);
    inner.id = format!("{}_2", inner.room_type);
    inner.name.clone_from(&part.corridor);
    for edge in edges.iter_mut().filter(|e| walkable(&&**e)) {
        if let Some(room) = behind.iter().find(|id| joins(edge, id)) {
            (edge.a, edge.b) = (room.clone(), inner.id.clone());
        }
    }
    let door = |a: &str, required: bool| GraphEdge {
        a: a.to_owned(),
        b: inner.id.clone(),
        connector: Connector::Door,
        required,
        reason: BY_CIRCULATION.into(),
    };
    edges.push(door(&corridor, true));
    edges.extend(locks.iter().map(|id| door(id, false)));
    rooms.push(inner);
    let message =
        format!("{} rooms open to a {} of their own ({})", behind.len(), part.corridor.to_lowercase(), part.source);
    reading.assumptions.push(Note::new("locked_part", message));
}

fn is_there(part: &LockedPart, rooms: &[GraphRoom]) -> bool {
    rooms.iter().any(|r| part.because.contains(&r.room_type))
}
