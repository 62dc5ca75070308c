//! What a brief states and the reader of words missed: it is added to what that reader found.
//!
//! Both read the same prompt. Where the reader of words made something of a phrase, that stands. A room of whose words it made
//! nothing or said that they are nothing that can be planned, a number it read as one, a storey, a seat count or an object that
//! it did not see at all are taken from the brief.

use std::ops::Range;

use d3dgen_model::brief::{Ask, Bound, Brief, CapacityAsk, Fact, PlaceKind, RoomsAsk, SiteKind};
use d3dgen_model::domain::{Domain, GENERIC_ROOM_TYPE, Zone};
use d3dgen_model::offer::{self, has_counters};
use d3dgen_model::scene_graph::Note;
use d3dgen_plugins::Registry;

use super::machines;
use super::site;
use super::wishes::Facts;
use crate::levels::storeys::Storeys;
use crate::people::held::Held;
use crate::people::seats::Called;
use crate::reading::{Reading, Understood};
use crate::request::MAX_AREA_M2;
use crate::tokens::storey::Where;
use crate::tokens::text::{Span, capital};
use crate::wished::unread::Unread;
use crate::wished::wishes::{Pair, Wish};

/// Adds to a reading what it lacks of a brief of the same prompt.
pub(crate) fn restore(reading: &mut Reading, brief: &Brief, registry: &Registry) {
    let facts = Facts::of(brief, reading.domain, registry);
    restore_single(reading, brief, &facts);
    restore_site(reading, brief);
    restore_heads(reading, brief);
    if !reading.single {
        restore_rooms(reading, brief, registry);
        restore_each(reading, brief, &facts);
        restore_seats(reading, brief, &facts);
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
        restore_stations(reading, &facts);
    }
    reading.wishes.garden.clone_from(&facts.wishes.garden);
    reading.errands = machines::restored(&reading.robots, &reading.errands, brief, &facts);
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

/// Gives rooms what they have many of, where nothing was read of that, with the room where none was read.
fn restore_stations(reading: &mut Reading, facts: &Facts) {
    let told = |id: &str| reading.seats.iter().chain(&reading.stationed).any(|h| h.room_type == id);
    let lost: Vec<Held> = facts.stations.iter().filter(|h| !told(&h.room_type)).cloned().collect();
    let counters = |h: &&Held| reading.domain.room_type(&h.room_type).is_some_and(|k| has_counters(reading.domain, k));
    let lost_counters: Vec<Held> =
        facts.seats.iter().filter(counters).filter(|h| !told(&h.room_type)).cloned().collect();
    for held in lost.iter().chain(&lost_counters) {
        let own = facts.wishes.wishes.iter().find(|w| w.room_type == held.room_type);
        if !reading.wishes.wishes.iter().any(|w| w.room_type == held.room_type) {
            reading.wishes.wishes.extend(own.cloned());
        }
    }
    reading.stationed.extend(lost);
    reading.seats.extend(lost_counters);
}

/// Takes the storey on which a flat lies in its house for no storey of the flat, and a house in a row for one between others.
fn restore_site(reading: &mut Reading, brief: &Brief) {
    if let Some(row) = site::in_a_row(brief, reading.domain, reading.building_type.as_deref()) {
        reading.building_type = Some(row);
    }
    let inside = |a: &Ask| matches!(&a.fact, Fact::Site(s) if s.kind == SiteKind::Inside);
    let storeys = |a: &Ask| match &a.fact {
        Fact::Storeys(storeys) => storeys.count.n > 1 || storeys.basement,
        Fact::Rooms(rooms) => rooms.level.is_some(),
        _ => false,
    };
    if brief.asks.iter().any(inside) && !brief.asks.iter().any(storeys) {
        reading.storeys = Storeys { levels: vec![0], ..Storeys::default() };
    }
}

/// Takes a number that the brief says of a room without desks for no number of people of the building.
fn restore_heads(reading: &mut Reading, brief: &Brief) {
    let domain = reading.domain;
    let visited = |c: &CapacityAsk| {
        let kind = c.room.as_ref().and_then(|room| domain.room_type(room.id.as_deref()?));
        kind.is_some_and(|kind| !offer::works_in(domain, kind) && offer::desks(domain, kind).is_none())
    };
    let of_room =
        |n: u32| brief.asks.iter().any(|a| matches!(&a.fact, Fact::Capacity(c) if c.count.n == n && visited(c)));
    let of_building = |n: u32| {
        brief.asks.iter().any(|a| match &a.fact {
            Fact::Capacity(c) => c.room.is_none() && c.count.n == n,
            Fact::People(people) => people.count.n == n,
            _ => false,
        })
    };
    for heads in [&mut reading.occupancy.staff, &mut reading.occupancy.visitors] {
        *heads = heads.filter(|n| !of_room(*n) || of_building(*n));
    }
}

/// Takes a prompt for one room that names one and no building, whatever more it says of that room, with the sides that it gives.
fn restore_single(reading: &mut Reading, brief: &Brief, facts: &Facts) {
    let ([wish], Some(asked)) = (&mut reading.wishes.wishes[..], facts.only_room()) else { return };
    if wish.room_type != asked.room_type || wish.count > 1 || reading.storeys.levels.len() > 1 {
        return;
    }
    if !reading.single {
        let message = "the prompt asks for one room and no building; it was planned by itself";
        reading.assumptions.push(Note::new("single_room", message.into()));
    }
    (reading.single, reading.closed, reading.total) = (true, true, None);
    wish.area_m2 = wish.area_m2.or(asked.area_m2);
    wish.sides_m = asked.sides_m;
    if wish.sides_m.is_some() {
        let kept = |u: &&Unread| brief.asks.iter().any(|a| rooms_of(a).is_some() && overlaps(brief, a, u));
        let read: Vec<Note> = reading.unread.iter().filter(kept).map(|u| u.note.clone()).collect();
        reading.conflicts.retain(|note| !read.contains(note));
    }
}

/// Adds the rooms whose words nothing was made of, with how they lie, and the rooms that a number lacks; those of which a part of
/// the name was read are called as the brief has it.
fn restore_rooms(reading: &mut Reading, brief: &Brief, registry: &Registry) {
    // stairs and lifts follow from the storeys, one shaft for all of them
    let storeys = reading.domain.circulation.storeys.as_ref();
    let plain = |r: &RoomsAsk| !r.room.id.as_deref().is_some_and(|id| storeys.is_some_and(|s| s.joins(id)));
    let rooms = || brief.asks.iter().filter_map(|a| Some((a, rooms_of(a)?))).filter(|(_, r)| plain(r));
    rooms().for_each(|(ask, asked)| retype(reading, brief, ask, asked));
    let lost: Vec<&Ask> = rooms().filter(|(a, r)| is_lost(reading, brief, a, r)).map(|found| found.0).collect();
    let part = Brief { asks: lost.iter().map(|a| (*a).clone()).collect(), ..brief.clone() };
    let found = Facts::of(&part, reading.domain, registry);
    let new = |w: &&Wish| !reading.wishes.wishes.iter().any(|o| o.room_type == w.room_type);
    let added: Vec<Wish> = found.wishes.wishes.iter().filter(new).cloned().collect();
    restore_pairs(reading, &Facts::of(brief, reading.domain, registry), &added);
    reading.wishes.wishes.extend(added);
    reading.names.extend(found.called);
    let said: Vec<Unread> =
        reading.unread.iter().filter(|u| lost.iter().any(|a| overlaps(brief, a, u))).cloned().collect();
    reading.conflicts.retain(|note| !said.iter().any(|u| &u.note == note));
    for (ask, asked) in rooms().filter(|(_, r)| r.room.id.is_none()) {
        if let Some(room_type) = part_read(reading, brief, ask, asked) {
            let name = capital(&asked.room.name);
            reading.names.push(Called { span: Span { start: 0, end: 0 }, room_type, name, count: asked.count.n });
        }
    }
    let counted = rooms().map(|(_, r)| r).filter(|r| r.count.n > 1 && r.count.bound == Bound::Exactly);
    for asked in counted {
        let Some(id) = &asked.room.id else { continue };
        let short = |w: &&mut Wish| &w.room_type == id && w.count < asked.count.n && !w.exact;
        if let Some(wish) = reading.wishes.wishes.iter_mut().find(short) {
            (wish.count, wish.exact) = (asked.count.n, true);
        }
    }
}

/// Gives rooms of which the reader of words knew no more than their name, or only the end of it, the type that the brief knows
/// them by: a "committal hall" is no hall like another.
fn retype(reading: &mut Reading, brief: &Brief, ask: &Ask, asked: &RoomsAsk) {
    let domain = reading.domain;
    let known =
        asked.room.id.as_ref().filter(|id| domain.room_type_or_lent(id).is_some_and(|k| k.id != GENERIC_ROOM_TYPE));
    let Some((id, bytes)) = known.zip(bytes_of(brief, ask, &asked.room.name)) else { return };
    let here = |u: &&Understood| u.bytes.start < bytes.end && bytes.start < u.bytes.end;
    // neither type is called so: the reader of words knew the end of the name, the brief another part of it
    let name = asked.room.name.to_lowercase();
    let name = name.trim_end_matches('s');
    let end_only = |read: &str| {
        words_for(domain, read).all(|word| word != name)
            && words_for(domain, read).any(|word| name.ends_with(word))
            && words_for(domain, id).all(|word| !name.ends_with(word))
    };
    let less = |u: &&Understood| match &u.room_type {
        Some(read) if domain.room_type_or_lent(read).is_none() => read != id,
        // rooms to sleep and wash in have names that say it
        Some(read) => {
            let plain = domain.room_type_or_lent(read).is_some_and(|k| k.zone != Zone::Night && !k.wet);
            read != id && plain && u.bytes.end == bytes.end && end_only(read)
        }
        None => false,
    };
    let Some(named) = reading.understood.iter().filter(here).find(less).and_then(|u| u.room_type.clone()) else {
        return;
    };
    let Some(at) = reading.wishes.wishes.iter().position(|w| w.room_type == named) else { return };
    let mut wish = reading.wishes.wishes[at].clone();
    // "a hall and a committal hall": one of the two
    let rest = wish.count.saturating_sub(asked.count.n);
    if rest > 0 {
        wish.count -= rest;
        reading.wishes.wishes[at].count = rest;
    } else {
        reading.wishes.wishes.remove(at);
    }
    match reading.wishes.wishes.iter_mut().find(|w| &w.room_type == id) {
        Some(same) => same.count += wish.count,
        None => {
            wish.room_type.clone_from(id);
            reading.wishes.wishes.insert(at, wish);
        }
    }
    for pair in &mut reading.wishes.pairs {
        [&mut pair.a, &mut pair.b].into_iter().filter(|end| **end == named).for_each(|end| end.clone_from(id));
    }
    reading.understood.iter_mut().filter(|u| u.room_type.as_ref() == Some(&named)).for_each(|u| {
        u.room_type = Some(id.clone());
    });
    let name = capital(&asked.room.name);
    reading.names.push(Called { span: Span { start: 0, end: 0 }, room_type: id.clone(), name, count: asked.count.n });
}

/// Returns the words of a domain for a type of room, in the singular.
fn words_for<'d>(domain: &'d Domain, id: &str) -> impl Iterator<Item = &'d str> {
    let kind = domain.room_type_or_lent(id).into_iter();
    let words = kind.flat_map(|kind| kind.keywords.values().chain(kind.called.values()).flatten());
    words.map(|word| word.trim_end_matches('s'))
}

/// Adds how rooms that were `added` lie to others.
fn restore_pairs(reading: &mut Reading, facts: &Facts, added: &[Wish]) {
    let new = |id: &String| added.iter().any(|w| &w.room_type == id);
    let there = |id: &String| new(id) || reading.wishes.wishes.iter().any(|w| &w.room_type == id);
    let pairs = facts.wishes.pairs.iter().filter(|p| (new(&p.a) || new(&p.b)) && there(&p.a) && there(&p.b));
    let pairs: Vec<Pair> = pairs.cloned().collect();
    reading.wishes.pairs.extend(pairs);
}

/// Takes seats of one room for no number of rooms: "교육실 20명" is one room for 20.
fn restore_seats(reading: &mut Reading, brief: &Brief, facts: &Facts) {
    let told = |n: u32| brief.asks.iter().filter_map(rooms_of).any(|r| r.count.n == n);
    for ask in &brief.asks {
        let Fact::Capacity(CapacityAsk { of: PlaceKind::Seats, count, room: Some(room), of_rooms: None, .. }) =
            &ask.fact
        else {
            continue;
        };
        let id = facts.type_of(room);
        let seats = |w: &&mut Wish| w.room_type == id && w.count == count.n && count.n > 1 && !told(count.n);
        if let Some(wish) = reading.wishes.wishes.iter_mut().find(seats) {
            wish.count = 1;
        }
    }
}

/// Gives each of several rooms the one that the brief says it comes with, where fewer were read: an induction room for each of
/// three operating rooms.
fn restore_each(reading: &mut Reading, brief: &Brief, facts: &Facts) {
    let hosts = brief.asks.iter().filter_map(rooms_of).filter(|r| r.count.bound == Bound::Exactly);
    for (host, guest) in hosts.filter_map(|host| Some((host, host.each.as_ref()?))) {
        let (host_type, guest_type) = (facts.type_of(&host.room), facts.type_of(guest));
        let lone = |w: &&mut Wish| w.room_type == guest_type && w.count == 1;
        let Some(wish) = reading.wishes.wishes.iter_mut().find(lone) else { continue };
        (wish.count, wish.exact) = (host.count.n, true);
        let told = |p: &&Pair| p.a == guest_type && p.b == host_type;
        if !reading.wishes.pairs.iter().any(|p| told(&p)) {
            reading.wishes.pairs.extend(facts.wishes.pairs.iter().find(told).cloned());
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

/// Returns true for rooms of whose words nothing was made, or of which the reader of words said that they are nothing that can be
/// planned.
fn is_lost(reading: &Reading, brief: &Brief, ask: &Ask, rooms: &RoomsAsk) -> bool {
    let name = rooms.room.name.to_lowercase();
    if let Some(bytes) = bytes_of(brief, ask, &rooms.room.name) {
        let read = |u: &Understood| u.bytes.start < bytes.end && bytes.start < u.bytes.end;
        if !reading.understood.iter().any(read) {
            return true;
        }
    }
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

/// Returns the type of the room that a part of a room's own words was read as: the hall of a "sculpture hall".
fn part_read(reading: &Reading, brief: &Brief, ask: &Ask, rooms: &RoomsAsk) -> Option<String> {
    let bytes = bytes_of(brief, ask, &rooms.room.name)?;
    let within = |u: &&Understood| bytes.start <= u.bytes.start && u.bytes.end <= bytes.end;
    let room_type = reading.understood.iter().filter(within).find_map(|u| u.room_type.clone())?;
    let known = reading.domain.room_type(&room_type).is_some_and(|k| k.id != GENERIC_ROOM_TYPE);
    let called = reading.called.iter().chain(&reading.names).any(|c| c.room_type == room_type);
    (known && !called).then_some(room_type)
}

/// Returns where the name of a room stands in the words of an ask.
fn bytes_of(brief: &Brief, ask: &Ask, name: &str) -> Option<Range<usize>> {
    if name.is_empty() {
        return None;
    }
    ask.words.iter().find_map(|w| {
        let start = byte(brief, w.start) + w.text.rfind(name)?;
        Some(start..start + name.len())
    })
}

/// Returns where a character of the prompt begins.
fn byte(brief: &Brief, char: u32) -> usize {
    brief.prompt.char_indices().nth(char as usize).map_or(brief.prompt.len(), |c| c.0)
}

/// Returns true where words of an ask are among those.
fn overlaps(brief: &Brief, ask: &Ask, unread: &Unread) -> bool {
    ask.words.iter().any(|w| byte(brief, w.start) < unread.bytes.end && unread.bytes.start < byte(brief, w.end))
}
