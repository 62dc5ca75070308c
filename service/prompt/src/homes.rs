//! Homes that are named by how many rooms they have: the rooms that a list names are among those, not beside them.

use std::ops::Range;

use d3dgen_model::brief::{Fact, RoomsAsk};

use crate::facts::Stated;
use crate::subjects::facts_data;

/// Takes the rooms that are named from those that the name of a home counts; returns what is left, and the words of what is not.
///
/// "Dreizimmerwohnung: Wohnzimmer, Schlafzimmer, Arbeitszimmer" has three rooms. A study is beside them where the list does not tell
/// all of them ("3LDK with a study", "三室，主卧，书房"), and where nothing says where one sleeps or sits.
pub(crate) fn named_among(mut facts: Vec<Stated>) -> (Vec<Stated>, Vec<Range<usize>>) {
    let data = facts_data();
    let named: Vec<(String, u32)> = facts.iter().filter_map(named_rooms).collect();
    let is_list = named.iter().any(|(id, _)| data.lists.contains(id));
    let mut whole = Vec::new();
    for stated in &mut facts {
        let words = stated.tokens.clone();
        let Some(counted) = counted_rooms(stated) else { continue };
        let Some(of) = counted.room.id.as_ref().and_then(|id| data.counted.get(id)) else { continue };
        let so_many = |is_told: &dyn Fn(&String) -> bool| -> u32 {
            named.iter().filter(|(id, _)| of.contains(id) && is_told(id)).map(|(_, n)| n).sum()
        };
        let all = so_many(&|_| is_list);
        let certain = so_many(&|id| data.lists.contains(id) || counted.room.id.as_ref() == Some(id));
        let told = if all >= counted.count.n { all } else { certain };
        counted.count.n = counted.count.n.saturating_sub(told);
        if counted.count.n == 0 {
            whole.push(words);
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
