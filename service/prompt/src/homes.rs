//! Homes that are named by how many rooms they have: the rooms that a list names are among those, not beside them.

use std::ops::Range;

use d3dgen_model::brief::{Fact, RoomsAsk};

use crate::facts::Stated;
use crate::subjects::facts_data;

/// Takes the rooms that are named from those that the name of a home counts; returns what is left, and the words of what is not.
///
/// "Dreizimmerwohnung: Wohnzimmer, Schlafzimmer, Kinderzimmer" has three rooms. A study alone is beside them ("3LDK with a study"):
/// a list tells the rooms of a home where it says where one sleeps or sits.
pub(crate) fn named_among(mut facts: Vec<Stated>) -> (Vec<Stated>, Vec<Range<usize>>) {
    let data = facts_data();
    let named: Vec<(String, u32)> = facts.iter().filter_map(|f| named_rooms(f)).collect();
    let is_list = named.iter().any(|(id, _)| data.lists.contains(id));
    let mut whole = Vec::new();
    for at in 0..facts.len() {
        let Some(counted) = counted_rooms(&mut facts[at]) else { continue };
        let Some(of) = counted.room.id.as_ref().and_then(|id| data.counted.get(id)) else { continue };
        let told = named.iter().filter(|(id, _)| of.contains(id));
        let told = told.filter(|(id, _)| is_list || counted.room.id.as_ref() == Some(id)).map(|(_, n)| n).sum();
        counted.count.n = counted.count.n.saturating_sub(told);
        if counted.count.n == 0 {
            whole.push(facts[at].tokens.clone());
        }
    }
    facts.retain_mut(|f| counted_rooms(f).is_none_or(|rooms| rooms.count.n > 0));
    let left: Vec<String> = facts.iter_mut().filter_map(|f| counted_rooms(f)?.room.id.clone()).collect();
    // what is left is beside those that are named, which are none of them
    for stated in facts.iter_mut().filter(|f| named_rooms(f).is_some_and(|(id, _)| left.contains(&id))) {
        stated.own = true;
    }
    (facts, whole)
}

/// Returns the rooms of a fact that the name of a home counts.
fn counted_rooms(stated: &mut Stated) -> Option<&mut RoomsAsk> {
    match &mut stated.fact {
        Fact::Rooms(rooms) if stated.counted => Some(rooms),
        _ => None,
    }
}

/// Returns type and number of rooms that a fact asks for by their own name.
fn named_rooms(stated: &Stated) -> Option<(String, u32)> {
    match &stated.fact {
        Fact::Rooms(rooms) if !stated.counted && !stated.mention && !rooms.among => {
            Some((rooms.room.id.clone()?, rooms.count.n))
        }
        _ => None,
    }
}
