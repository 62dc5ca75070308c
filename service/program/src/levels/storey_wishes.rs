//! What storeys change of the rooms that are wished for: rooms of every storey are as many as there are, stairs and elevators
//! are what joins them, and a basement has a room.

use d3dgen_model::domain::{Domain, Zone};
use d3dgen_model::scene_graph::Note;

use super::storeys::{Phrase, Storeys, Wanted};
use crate::named::mention::{Mention, What};
use crate::tokens::storey::Where;
use crate::tokens::words::words;
use crate::wished::wishes::{Wish, Wishes};

/// Takes phrases that say how many people are on every storey ("40 people per floor") from those that put rooms there; returns
/// the mentions of these people.
pub(crate) fn people_on_each(mentions: &[Mention], phrases: &mut Vec<Phrase>) -> Vec<usize> {
    let people = [What::People, What::Staff, What::Visitors, What::Residents, What::Beds, What::Desks];
    let mut out = Vec::new();
    for (i, m) in mentions.iter().enumerate().filter(|(_, m)| people.contains(&m.what) && m.count.is_some()) {
        let behind = phrases.iter().position(|p| p.at == Where::Each && p.span.start == m.span.end);
        if let Some(phrase) = behind {
            phrases.remove(phrase);
            out.push(i);
        }
    }
    out
}

/// Plans a flat by itself whose rooms all lie on one storey of its house, "on the third floor": what is below belongs to others.
pub(crate) fn lie_on_one_storey(storeys: &mut Storeys, domain: &Domain) -> Option<Note> {
    let mut at = storeys.wanted.iter().map(|w| w.at);
    let Some(Where::Level(level)) = at.next().filter(|first| at.all(|l| l == *first)) else { return None };
    let has = |zone: Zone| storeys.wanted.iter().any(|w| domain.room_type_or_generic(&w.room_type).zone == zone);
    // "a flat with the bedrooms on the upper floor" has another one below
    if level < 2 && !(has(Zone::Day) && has(Zone::Night)) {
        return None;
    }
    storeys.levels = vec![0];
    storeys.wanted.clear();
    let message = format!("the flat lies on level {level} of its house; it was planned by itself");
    Some(Note::new("storey_of_house", message))
}

/// Gives a basement of which nothing is said the room that it has for things.
pub(crate) fn furnish_basement(storeys: &mut Storeys, wishes: &mut Wishes, domain: &Domain) {
    let kind = words().dwelling.basement.iter().find_map(|id| domain.room_type(id));
    let Some(kind) = kind.filter(|k| storeys.bare_basement && !wishes.forbidden.contains(&k.id)) else { return };
    storeys.wanted.push(Wanted { room_type: kind.id.clone(), count: 1, at: Where::Level(-1) });
    match wishes.wishes.iter_mut().find(|w| w.room_type == kind.id) {
        Some(wish) => wish.count += 1,
        None => wishes.wishes.push(Wish::one(&kind.id, &kind.label.to_lowercase())),
    }
}

/// Counts rooms on every storey for each of them, and leaves stairs and elevators to what joins the storeys.
pub(crate) fn wish_for_storeys(storeys: &mut Storeys, wishes: &mut Wishes, domain: &Domain, conflicts: &mut Vec<Note>) {
    let rules = domain.circulation.storeys.as_ref();
    let climbs = |id: &str| rules.is_some_and(|r| goes_up(domain, id, &r.stairs.room_type));
    if storeys.levels.len() < 2 {
        // "a core with lifts and stairs" on one storey has one of them
        let stairs = wishes.wishes.iter_mut().filter(|w| !w.exact && climbs(&w.room_type));
        stairs.for_each(|w| w.count = 1);
        return;
    }
    let above = storeys.above_ground() as u32;
    let mut sums: Vec<(&str, u32)> = Vec::new();
    for wanted in &storeys.wanted {
        let count = if wanted.at == Where::Each { wanted.count * above } else { wanted.count };
        match sums.iter_mut().find(|s| s.0 == wanted.room_type) {
            Some(sum) => sum.1 += count,
            None => sums.push((&wanted.room_type, count)),
        }
    }
    for wish in &mut wishes.wishes {
        if let Some((_, sum)) = sums.iter().find(|s| s.0 == wish.room_type) {
            wish.count = wish.count.max(*sum);
        }
    }
    if let Some(rules) = rules {
        let lifts = |id: &str| rules.elevator.as_ref().is_some_and(|e| goes_up(domain, id, &e.room_type));
        let joins = |id: &String| climbs(id) || lifts(id);
        let stairs = wishes.wishes.iter().filter(|w| w.exact && climbs(&w.room_type)).map(|w| w.count).max();
        storeys.stairs = stairs.unwrap_or(0);
        storeys.elevator = storeys.elevator.or(wishes.wishes.iter().any(|w| lifts(&w.room_type)).then_some(true));
        storeys.wanted.retain(|w| !joins(&w.room_type));
        wishes.wishes.retain(|w| !joins(&w.room_type));
        for pair in wishes.pairs.iter().filter(|p| joins(&p.a) || joins(&p.b)) {
            let [a, b] = [&pair.a, &pair.b].map(|id| id.replace('_', " "));
            let why = "stairs and elevators stand where they join the storeys";
            conflicts.push(Note::new("not_beside", format!("{a} and {b} were not planned beside each other: {why}")));
        }
        wishes.pairs.retain(|p| !joins(&p.a) && !joins(&p.b));
        wishes.forbidden.retain(|f| !joins(f));
    }
    // what joins the rooms of a storey cannot be ruled out
    wishes.forbidden.retain(|f| *f != domain.circulation.room_type);
}

/// Returns true for rooms that lead to other storeys as those of a type do: "two staircases" are what joins the storeys,
/// whatever room a building of one storey has for that.
fn goes_up(domain: &Domain, id: &str, of: &str) -> bool {
    let spaces = |id: &str| domain.room_type(id).map_or(&[][..], |k| &k.spaces);
    let known = domain.room_type(id);
    // "stair" is the word of another domain for the same
    let same = known.is_none() && spaces(of).iter().any(|s| s == id);
    let circulates = known.is_some_and(|k| k.zone == Zone::Circulation);
    id == of || same || circulates && spaces(id).iter().any(|s| spaces(of).contains(s))
}
