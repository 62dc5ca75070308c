//! A room more or less in the scene graph.

use d3dgen_knowledge::jurisdiction::rules_here;
use d3dgen_model::domain::{AdjacencyRelation, Domain, RoomType};
use d3dgen_model::sanitary;
use d3dgen_model::scene_graph::{Connector, GraphEdge, GraphRoom, Note, SceneGraph};
use d3dgen_model::stage::Error;

use super::{mismatch, refused};
use crate::scene_graph::{is_missed, room_type_called, wished_assets};

/// Reason of edges that an edit adds.
const BY_EDIT: &str = "edit";

/// Adds a room to the graph, on the storey of the room that it is entered from; returns its id.
///
/// # Errors
/// `Mismatch` for a room type that the domain has neither by this id nor by this name, or a room to enter from that the graph does not have.
pub(super) fn add(
    graph: &mut SceneGraph,
    domain: &Domain,
    room_type: &str,
    area_m2: Option<f64>,
    entered_from: Option<&str>,
) -> Result<String, Error> {
    let called = || room_type_called(domain, room_type);
    let kind = domain.room_type_or_lent(room_type).or_else(called).ok_or_else(|| {
        let known: Vec<&str> = domain.room_types.iter().map(|t| t.id.as_str()).collect();
        mismatch(format!("domain `{}` has no room type `{room_type}`; it has {}", domain.id, known.join(", ")))
    })?;
    let from = match entered_from {
        Some(id) => graph.room(id).ok_or_else(|| mismatch(format!("the world has no room `{id}` to enter from")))?,
        None => graph
            .rooms
            .iter()
            .find(|r| r.circulation && r.level == 0)
            .or_else(|| busiest(graph))
            .ok_or_else(|| mismatch("the world has no room that another could be entered from".to_owned()))?,
    };
    if graph.links.iter().any(|l| l.room_ids.contains(&from.id)) {
        return Err(refused(format!(
            "no room is entered from stairs or elevator `{}`; name the corridor or hall of its storey",
            from.id
        )));
    }
    let (from, level) = (from.id.clone(), from.level);
    let room = GraphRoom { level, ..described(graph, domain, kind, area_m2) };
    let id = room.id.clone();
    let connector = if kind.open_front && entered_from.is_none() { Connector::Open } else { Connector::Door };
    graph.edges.push(GraphEdge { a: id.clone(), b: from.clone(), connector, required: true, reason: BY_EDIT.into() });
    let country = graph.place_code().map(str::to_owned);
    let apart = rules_here(domain, country.as_deref())
        .filter(|r| r.relation == AdjacencyRelation::MustNot && r.via == "wall" && (r.a == kind.id || r.b == kind.id));
    for rule in apart {
        let other = if rule.a == kind.id { &rule.b } else { &rule.a };
        for room in graph.rooms.iter().filter(|r| &r.room_type == other && r.id != from && r.level == level) {
            graph.apart.push([id.clone(), room.id.clone()]);
        }
    }
    graph
        .assumptions
        .push(Note { code: "room_by_edit".into(), message: format!("{} was added by an edit", room.name) });
    let missed = missed(domain, kind);
    graph.conflicts.retain(|n| *n != missed);
    // circulation comes last, as in a graph that was made
    let at = graph.rooms.iter().position(|r| r.circulation).unwrap_or(graph.rooms.len());
    graph.rooms.insert(at, room);
    Ok(id)
}

/// Takes a room out of the graph; rooms that were entered through it are entered from the corridor or hall. What no such
/// building is without is missed in a conflict.
///
/// # Errors
/// `Mismatch` when there is none; `Refused` for a locked one, for circulation, and for the last room.
pub(super) fn remove(graph: &mut SceneGraph, domain: &Domain, room_id: &str) -> Result<(), Error> {
    let room = graph.room(room_id).ok_or_else(|| mismatch(format!("the world has no room `{room_id}`")))?;
    if graph.links.iter().any(|l| l.room_ids.iter().any(|id| id == room_id)) {
        return Err(refused(format!("`{room_id}` joins the storeys of the building")));
    }
    if room.locked {
        return Err(refused(format!("`{room_id}` is locked; unlock it first")));
    }
    let others = graph.rooms.iter().filter(|r| !r.circulation && r.level == room.level && r.id != room_id);
    if room.circulation || room.entrance || others.count() == 0 {
        return Err(refused(format!(
            "the other rooms are entered through `{room_id}`, or it is the only one on its storey"
        )));
    }
    let (name, room_type, level) = (room.name.clone(), room.room_type.clone(), room.level);
    let walkable = |e: &GraphEdge| e.required && matches!(e.connector, Connector::Door | Connector::Open);
    let other = |e: &GraphEdge| if e.a == room_id { e.b.clone() } else { e.a.clone() };
    let guests: Vec<String> =
        graph.edges.iter().filter(|e| walkable(e) && (e.a == room_id || e.b == room_id)).map(other).collect();
    graph.edges.retain(|e| e.a != room_id && e.b != room_id);
    graph.apart.retain(|pair| pair.iter().all(|id| id != room_id));
    graph.rooms.retain(|r| r.id != room_id);
    let is_link = |r: &GraphRoom| graph.links.iter().any(|l| l.room_ids.contains(&r.id));
    let way = graph.rooms.iter().find(|r| r.circulation && r.level == level && !is_link(r));
    let hub = way.or_else(|| busiest(graph)).map(|r| r.id.clone());
    for guest in guests {
        let entered = graph.edges.iter().any(|e| walkable(e) && (e.a == guest || e.b == guest));
        if let Some(hub) = hub.as_ref().filter(|h| !entered && **h != guest) {
            let (a, b) = (guest, hub.clone());
            graph.edges.push(GraphEdge { a, b, connector: Connector::Door, required: true, reason: BY_EDIT.into() });
        }
    }
    if is_missed(graph, &room_type, domain) {
        graph.conflicts.push(missed(domain, domain.room_type_or_generic(&room_type)));
    }
    graph.assumptions.push(Note { code: "room_by_edit".into(), message: format!("{name} was taken out by an edit") });
    Ok(())
}

/// Says that a building has no room any more of a type that such a building needs.
fn missed(domain: &Domain, kind: &RoomType) -> Note {
    let message = format!("an edit took out the last {}, which such a building needs", kind.label.to_lowercase());
    let code = if sanitary::is_for_all(domain, kind) { sanitary::LEFT_OUT } else { "vital_room_missing" };
    Note { code: code.into(), message }
}

/// Returns the room that most others are entered from.
fn busiest(graph: &SceneGraph) -> Option<&GraphRoom> {
    let doors = |id: &str| graph.edges.iter().filter(|e| e.required && (e.a == id || e.b == id)).count();
    graph.rooms.iter().rev().max_by_key(|r| doors(&r.id))
}

fn described(graph: &SceneGraph, domain: &Domain, kind: &RoomType, area_m2: Option<f64>) -> GraphRoom {
    let number = (1..).find(|n| graph.room(&format!("{}_{n}", kind.id)).is_none()).unwrap_or(1);
    let range = kind.area_m2;
    let target = area_m2.unwrap_or(range.target);
    let margin = if area_m2.is_some() { 0.1 } else { f64::MAX };
    GraphRoom {
        id: format!("{}_{number}", kind.id),
        room_type: kind.id.clone(),
        name: if number > 1 { format!("{} {number}", kind.label) } else { kind.label.clone() },
        description: kind.description.clone(),
        target_area_m2: target,
        area_range_m2: [
            range.min.max(target * (1.0 - margin)).min(target),
            range.max.min(target * (1.0 + margin)).max(target),
        ],
        wished_assets: wished_assets(domain, kind, &[]),
        sides_m: None,
        occupants: None,
        circulation: false,
        requested: true,
        entrance: false,
        level: Default::default(),
        unit: None,
        garden_door: false,
        locked: false,
    }
}
