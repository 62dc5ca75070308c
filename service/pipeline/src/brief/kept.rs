//! How much of a brief the rooms of a scene graph keep: what decides between two readings of one prompt.

use std::collections::BTreeSet;

use d3dgen_model::brief::{Ask, Brief, CapacityAsk, Fact, OnlyAsk, RoomsAsk, StoreysAsk, Subject};
use d3dgen_model::scene_graph::{GraphRoom, SceneGraph};

/// Returns how many things are otherwise in the rooms than the brief asks for: numbers, storeys, seats, and types of rooms that
/// the prompt was read to name and the brief does not.
pub(super) fn missed(brief: &Brief, graph: &SceneGraph) -> usize {
    let lost = brief.asks.iter().filter(|ask| !is_kept(&ask.fact, graph));
    let (rooms, others): (Vec<&Ask>, Vec<&Ask>) = lost.partition(|ask| matches!(ask.fact, Fact::Rooms(_)));
    // a room that was read as one of another type is one thing
    let several = rooms.iter().filter(|ask| matches!(&ask.fact, Fact::Rooms(r) if is_lost_whole(r, graph))).count();
    (rooms.len() + several).max(unasked(brief, graph)) + others.len() + usize::from(is_in_the_air(graph))
}

/// Returns true where not one is there of several rooms that have a name of their own.
fn is_lost_whole(asked: &RoomsAsk, graph: &SceneGraph) -> bool {
    asked.count.n > 1 && asked.room.id.is_none() && called(&asked.room, graph).next().is_none()
}

/// Returns true where the prompt names no room at the ground, of several storeys.
fn is_in_the_air(graph: &SceneGraph) -> bool {
    let mut requested = graph.rooms.iter().filter(|r| r.requested).map(|r| r.level).peekable();
    requested.peek().is_some() && requested.all(|level| level > 0)
}

fn is_kept(fact: &Fact, graph: &SceneGraph) -> bool {
    match fact {
        Fact::Rooms(rooms) => rooms.among || keeps_rooms(rooms, graph),
        Fact::Capacity(capacity) => keeps_places(capacity, graph),
        Fact::Storeys(storeys) => keeps_storeys(storeys, graph),
        Fact::Only(only) => keeps_to_list(only, graph),
        Fact::Forbidden(forbidden) => forbidden.room.iter().all(|room| called(room, graph).next().is_none()),
        _ => true,
    }
}

/// Returns the rooms that go by a name: its type or a kind of it, or called so.
fn called<'g>(subject: &'g Subject, graph: &'g SceneGraph) -> impl Iterator<Item = &'g GraphRoom> {
    let name = subject.name.to_lowercase();
    graph.rooms.iter().filter(move |room| match &subject.id {
        Some(id) => is_kind_of(&room.room_type, id),
        None => {
            !name.is_empty()
                && (room.name.to_lowercase().starts_with(&name) || name.starts_with(&room.name.to_lowercase()))
        }
    })
}

/// Returns true for a type that is another, or a kind of it: `patient_room_double` of `patient_room`.
fn is_kind_of(id: &str, of: &str) -> bool {
    let rest = id.strip_prefix(of).map(|r| r.is_empty() || r.starts_with('_'));
    rest.or_else(|| id.strip_suffix(of).map(|r| r.ends_with('_'))).unwrap_or(false)
}

fn keeps_rooms(asked: &RoomsAsk, graph: &SceneGraph) -> bool {
    let on_level = |room: &&GraphRoom| asked.level.is_none_or(|level| room.level == level);
    let all: Vec<&GraphRoom> = called(&asked.room, graph).filter(on_level).collect();
    let own = all.iter().filter(|room| asked.room.id.as_ref() == Some(&room.room_type)).count();
    let one_each = asked.each.as_ref().is_none_or(|each| called(each, graph).count() >= all.len());
    one_each && (asked.count.allows(all.len() as u32) || asked.count.allows(own as u32))
}

/// Returns true where the rooms have so many places, together or each, or where the graph says nothing of places.
fn keeps_places(asked: &CapacityAsk, graph: &SceneGraph) -> bool {
    let Some(room) = &asked.room else { return true };
    let held: Vec<u32> = called(room, graph).filter_map(|r| r.occupants).collect();
    let all: u32 = held.iter().sum();
    called(room, graph).next().is_some()
        && (held.is_empty() || asked.count.allows(all) || held.iter().any(|n| asked.count.allows(*n)))
}

fn keeps_storeys(asked: &StoreysAsk, graph: &SceneGraph) -> bool {
    let levels: BTreeSet<i32> = graph.rooms.iter().map(|r| r.level).collect();
    asked.count.allows(levels.iter().filter(|l| **l >= 0).count() as u32) || asked.count.allows(levels.len() as u32)
}

fn keeps_to_list(asked: &OnlyAsk, graph: &SceneGraph) -> bool {
    !asked.closed || graph.rooms.iter().all(|r| r.requested || r.circulation)
}

/// Returns how many types of rooms the prompt was read to name that the brief does not ask for, and how many storeys are more
/// than it tells of.
fn unasked(brief: &Brief, graph: &SceneGraph) -> usize {
    let asked: BTreeSet<&str> =
        brief.asks.iter().flat_map(|ask| named_in(&ask.fact)).filter_map(|s| s.id.as_deref()).collect();
    let is_asked =
        |room: &GraphRoom| asked.iter().any(|id| is_kind_of(&room.room_type, id) || is_kind_of(id, &room.room_type));
    // rooms may be for those who are there, and none of the facts names them
    let peopled = brief.asks.iter().any(|a| matches!(a.fact, Fact::People(_)));
    let others = graph.rooms.iter().filter(|r| !peopled && r.requested && !is_asked(r));
    let others: BTreeSet<&str> = others.map(|r| r.room_type.as_str()).collect();
    let told = brief.asks.iter().any(|a| match &a.fact {
        Fact::Storeys(_) => true,
        Fact::Rooms(rooms) => rooms.level.is_some(),
        _ => false,
    });
    let site = brief.asks.iter().any(|a| matches!(a.fact, Fact::Site(_)));
    let storeys: BTreeSet<i32> = graph.rooms.iter().map(|r| r.level).collect();
    others.len() + if site && !told { storeys.len() - 1 } else { 0 }
}

/// Returns the rooms that a fact names.
fn named_in(fact: &Fact) -> Vec<&Subject> {
    match fact {
        Fact::Rooms(rooms) => std::iter::once(&rooms.room).chain(&rooms.each).collect(),
        Fact::Capacity(capacity) => capacity.room.iter().collect(),
        Fact::Objects(objects) => objects.room.iter().collect(),
        _ => Vec::new(),
    }
}
