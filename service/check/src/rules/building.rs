//! Rules about how the rooms hang together.

use std::collections::BTreeSet;

use d3dgen_model::domain::{Access, Privacy, Shape, tags};
use d3dgen_model::sanitary;
use d3dgen_model::scene_graph::BY_HOST;

use super::Findings;
use crate::context::{Context, Room};

/// Rooms are entered from outdoors or through rooms that are not private; what belongs to a host (en suite, closet,
/// anteroom and what lies behind it) may be entered through the host.
pub fn private_passage(c: &Context, out: &mut Findings) {
    let mut entered: BTreeSet<&str> = BTreeSet::new();
    let mut open: Vec<&str> = Vec::new();
    for door in c.plan().ways_out() {
        open.extend(door.room_ids.iter().map(String::as_str));
    }
    // a building without a way in lacks an entrance, which is another rule's
    if open.is_empty() {
        open.extend(c.rooms.iter().filter(|r| r.plan.circulation).map(|r| r.plan.room_id.as_str()));
    }
    while let Some(id) = open.pop() {
        if !entered.insert(id) {
            continue;
        }
        let Some(from) = c.room(id) else { continue };
        for next in neighbors(from) {
            if c.room(next).is_some_and(|to| may_pass(c, from, to)) {
                open.push(next);
            }
        }
    }
    for room in &c.rooms {
        out.look();
        let id = room.plan.room_id.as_str();
        if !entered.contains(id) {
            let through: Vec<&str> = neighbors(room).collect();
            let message = match through.as_slice() {
                [] => "no door leads into it".to_owned(),
                rooms => format!("one reaches it only through private rooms ({})", rooms.join(", ")),
            };
            out.add(id, message);
        }
    }
}

/// Rooms for anybody are reached without a room or corridor that is closed to all but those whose work it is.
pub fn public_path_in_restricted(c: &Context, out: &mut Findings) {
    let closed = |room: &Room| {
        let name = &room.plan.name;
        let behind_lock =
            room.plan.circulation && c.domain.circulation.locked.iter().any(|part| &part.corridor == name);
        behind_lock || c.domain.tags_of(room.kind).contains(tags::RESTRICTED)
    };
    let mut reached: BTreeSet<&str> = BTreeSet::new();
    let mut open: Vec<&str> = c.plan().ways_out().iter().flat_map(|d| d.room_ids.iter().map(String::as_str)).collect();
    while let Some(id) = open.pop() {
        let Some(room) = c.room(id).filter(|room| !closed(room)) else { continue };
        if reached.insert(id) {
            open.extend(neighbors(room));
        }
    }
    let public = |room: &&Room| !closed(room) && c.domain.tags_of(room.kind).contains(tags::PUBLIC);
    for room in c.rooms.iter().filter(public).filter(|_| !reached.is_empty()) {
        out.look();
        if !reached.contains(room.plan.room_id.as_str()) {
            out.add(&room.plan.room_id, "one who visits it goes through a room that is closed to visitors");
        }
    }
}

/// A building that is no home has a toilet, and one for wheelchairs on each storey that visitors come to, unless somebody wanted
/// none and the world says so.
pub fn toilets(c: &Context, out: &mut Findings) {
    let graph = c.graph();
    let flushes = |shape: Shape| matches!(shape, Shape::Toilet | Shape::Cubicle);
    let ruled_out = c
        .domain
        .room_types
        .iter()
        .any(|k| sanitary::is_for_all(c.domain, k) && graph.forbidden_room_types.contains(&k.id));
    if !sanitary::applies(graph, c.domain) || ruled_out || sanitary::is_left_out(graph) {
        return;
    }
    out.look();
    let stands = |r: &Room| {
        let mut objects = c.objects_in(&r.plan.room_id);
        objects.any(|o| o.kind.is_some_and(|k| flushes(k.shape)))
    };
    if !c.rooms.iter().any(stands) {
        out.add("building", "has no toilet; ask for one, or for a building without");
        return;
    }
    if !c.domain.room_types.iter().any(|k| sanitary::is_accessible(c.domain, k)) {
        return;
    }
    for level in sanitary::without_accessible(graph, c.domain) {
        out.add("building", format!("storey {level} has no toilet for wheelchairs, and visitors come there"));
    }
}

fn neighbors<'r>(room: &'r Room) -> impl Iterator<Item = &'r str> {
    let own = room.plan.room_id.as_str();
    room.doors.iter().flat_map(move |d| d.room_ids.iter().map(String::as_str).filter(move |id| *id != own))
}

fn may_pass(c: &Context, from: &Room, to: &Room) -> bool {
    let hub = c.domain.circulation.hub_room_types.contains(&from.plan.room_type);
    let hosted = |inner: &Room, outer: &Room| {
        inner.kind.access == Access::Host && inner.kind.hosts.contains(&outer.plan.room_type)
    };
    // what the scene graph gives to one room is that room's own
    let belongs = |inner: &Room, outer: &Room| {
        let pair = [inner.plan.room_id.as_str(), outer.plan.room_id.as_str()];
        let mut edges = c.graph().edges.iter().filter(|e| e.required && e.reason == BY_HOST);
        inner.kind.may_hang_on(outer.kind) && edges.any(|e| pair == [e.a.as_str(), e.b.as_str()])
    };
    // an anteroom hangs on its host and is the way into it
    let hangs = hosted(to, from) || hosted(from, to) || belongs(to, from);
    from.plan.circulation || hub || from.kind.privacy != Privacy::Private || hangs
}
