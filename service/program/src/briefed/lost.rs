//! What a brief states and the reader of words missed: it is added to what that reader found.
//!
//! Both read the same prompt. Where the reader of words made something of a phrase, that stands. A room of whose words it
//! said that they are nothing that can be planned, a number it read as one, a storey, a seat count or an object that it did
//! not see at all are taken from the brief.

use d3dgen_model::brief::{Ask, Brief, Fact, RoomsAsk};
use d3dgen_plugins::Registry;

use super::wishes::Facts;
use crate::reading::Reading;
use crate::request::MAX_AREA_M2;
use crate::tokens::storey::Where;
use crate::wished::unread::Unread;
use crate::wished::wishes::Wish;

/// Adds to a reading what it lacks of a brief of the same prompt.
pub(crate) fn restore(reading: &mut Reading, brief: &Brief, registry: &Registry) {
    let facts = Facts::of(brief, reading.domain, registry);
    if !reading.single {
        restore_rooms(reading, brief, registry);
        restore_levels(reading, &facts);
        let wished = |id: &String| reading.wishes.wishes.iter().any(|w| &w.room_type == id);
        let forbidden =
            facts.wishes.forbidden.iter().filter(|id| !wished(id) && !reading.wishes.forbidden.contains(id));
        let forbidden: Vec<String> = forbidden.cloned().collect();
        reading.wishes.forbidden.extend(forbidden);
        let unseated = |id: &str| reading.seats.iter().chain(&reading.held).all(|h| h.room_type != id);
        let seats: Vec<_> =
            facts.seats.iter().filter(|h| wished(&h.room_type) && unseated(&h.room_type)).cloned().collect();
        reading.seats.extend(seats);
    }
    for thing in &facts.things {
        let asked = facts.things.iter().filter(|t| t.object == thing.object).count();
        let have = reading.objects.iter().filter(|t| t.object == thing.object);
        // one of each of several rooms says how many there are
        let each = have.clone().any(|t| t.each);
        if reading.domain.object(&thing.object).is_some() && !each && have.count() < asked {
            reading.objects.push(thing.clone());
        }
    }
    let usable = |a: &f64| (5.0..=MAX_AREA_M2).contains(a);
    reading.area_m2 = reading.area_m2.or(facts.area_m2.filter(usable));
}

/// Adds the rooms whose words nothing was made of, and the rooms that a number lacks.
fn restore_rooms(reading: &mut Reading, brief: &Brief, registry: &Registry) {
    let lost: Vec<&Ask> =
        brief.asks.iter().filter(|a| rooms_of(a).is_some_and(|r| is_lost(reading, brief, a, r))).collect();
    let part = Brief { asks: lost.iter().map(|a| (*a).clone()).collect(), ..brief.clone() };
    let found = Facts::of(&part, reading.domain, registry);
    let new = |w: &&Wish| !reading.wishes.wishes.iter().any(|o| o.room_type == w.room_type);
    let rooms: Vec<Wish> = found.wishes.wishes.iter().filter(new).cloned().collect();
    reading.wishes.wishes.extend(rooms);
    reading.names.extend(found.called);
    let said: Vec<Unread> =
        reading.unread.iter().filter(|u| lost.iter().any(|a| overlaps(brief, a, u))).cloned().collect();
    reading.conflicts.retain(|note| !said.iter().any(|u| &u.note == note));
    for ask in &brief.asks {
        let Some(rooms) = rooms_of(ask).filter(|r| r.count.n > 1 && r.count.bound == Default::default()) else {
            continue;
        };
        let Some(id) = &rooms.room.id else { continue };
        let short = |w: &&mut Wish| &w.room_type == id && w.count < rooms.count.n && !w.exact;
        if let Some(wish) = reading.wishes.wishes.iter_mut().find(short) {
            (wish.count, wish.exact) = (rooms.count.n, true);
        }
    }
}

/// Puts rooms on the storeys that the brief says, where nothing else was read of that.
fn restore_levels(reading: &mut Reading, facts: &Facts) {
    let storeys = facts.storeys(&mut Vec::new());
    if reading.storeys.levels.len() < 2 && storeys.levels.len() > 1 {
        reading.storeys.levels = storeys.levels.clone();
        reading.storeys.bare_basement = storeys.bare_basement;
    }
    if reading.storeys.levels.len() < 2 {
        return;
    }
    for wanted in storeys.wanted {
        let Where::Level(level) = wanted.at else { continue };
        let dealt = reading.storeys.wanted.iter().any(|w| w.room_type == wanted.room_type);
        let there = reading.wishes.wishes.iter().any(|w| w.room_type == wanted.room_type);
        // what follows a basement in a list need not lie in it
        if level >= 0 && !dealt && there && reading.storeys.levels.contains(&level) {
            reading.storeys.wanted.push(wanted);
        }
    }
}

fn rooms_of(ask: &Ask) -> Option<&RoomsAsk> {
    if let Fact::Rooms(rooms) = &ask.fact { Some(rooms) } else { None }
}

/// Returns true for rooms of which the reader of words said that they are nothing that can be planned.
fn is_lost(reading: &Reading, brief: &Brief, ask: &Ask, rooms: &RoomsAsk) -> bool {
    let name = rooms.room.name.to_lowercase();
    // a word of the domain's own was understood, if only as something else: "bureau" in a bedroom is a desk
    let kind = rooms.room.id.as_deref().and_then(|id| reading.domain.room_type(id));
    if kind.is_some_and(|k| k.keywords.values().flatten().any(|w| *w == name)) {
        return false;
    }
    let last = name.split_whitespace().next_back().unwrap_or_default();
    let told = |u: &Unread| {
        let words = brief.prompt.get(u.bytes.clone()).unwrap_or_default().to_lowercase();
        overlaps(brief, ask, u) && words.contains(last)
    };
    !last.is_empty() && reading.unread.iter().any(told)
}

/// Returns true where words of an ask are among those.
fn overlaps(brief: &Brief, ask: &Ask, unread: &Unread) -> bool {
    let byte = |char: u32| brief.prompt.char_indices().nth(char as usize).map_or(brief.prompt.len(), |c| c.0);
    ask.words.iter().any(|w| byte(w.start) < unread.bytes.end && unread.bytes.start < byte(w.end))
}
