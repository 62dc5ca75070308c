//! Which rooms the building has: those the prompt names, completed from the program of its building type.

use std::collections::BTreeSet;

use d3dgen_knowledge::Applicable;
use d3dgen_model::domain::{Access, RobotUse, RoomType, Zone};
use d3dgen_model::offer::most_docks;
use d3dgen_model::scene_graph::Note;

use super::{hosts, large, layout, occupants, vital, workers};
use crate::built::growth::{Build, may_grow};
use crate::built::planned::Planned;
use crate::levels::{carry, spread, units};
use crate::reading::Reading;
use crate::subject::programs::{is_dwelling, is_office};
use crate::tokens::words::words;

/// Toilets that a home of several storeys has where its list of rooms names fewer: one by day, one by night.
const TOILETS_GRANTED: usize = 2;
/// Kinds of rooms from which on the prompt lists rooms.
const LEAST_LISTED: usize = 3;

/// Returns the rooms of the building, circulation aside.
pub(crate) fn complete<'a>(reading: &mut Reading<'a>) -> Vec<Planned<'a>> {
    let mut build = Build::new(reading, reading.program);
    build.take_wishes();
    build.house_parents();
    match (reading.total, reading.closed) {
        (None, true) => {}
        (Some(total), _) => build.fill_to(total as usize),
        (None, false) => build.fill_usual(),
    }
    let mut rooms = build.rooms;
    hosts::equip_hosts(reading, &mut rooms);
    vital::accompany(reading, &mut rooms);
    vital::complete(reading, &mut rooms);
    large::complete(reading, &mut rooms);
    house_robots(reading, &mut rooms);
    let mut rooms = units::divide(reading, rooms);
    layout::follow(reading, &mut rooms);
    let mut rooms = finish(reading, rooms);
    spread::open_offices(reading, &mut rooms);
    carry::fill(reading, &mut rooms);
    rooms
}

/// Gives rooms that are settled their people and hosts, and states which of them the prompt does not name.
pub(crate) fn finish<'a>(reading: &mut Reading<'a>, mut rooms: Vec<Planned<'a>>) -> Vec<Planned<'a>> {
    wash_on_every_storey(reading, &mut rooms);
    serve_every_storey(reading, &mut rooms);
    if reading.building_type.as_ref().is_some_and(|b| words().dwelling.shared.contains(b)) {
        // a room to sleep and work in is not to come out small
        let own = |r: &&mut Planned| r.room_type == words().dwelling.bedroom && r.area_m2.is_none();
        rooms.iter_mut().filter(own).for_each(|r| r.size = r.size.or(Some(1.0)));
    }
    occupants::make_room_for_things(reading, &mut rooms);
    occupants::hold_beds(reading, &mut rooms);
    workers::settle(reading, &mut rooms);
    call_as_told(reading, &mut rooms);
    occupants::hold_people(reading, &mut rooms);
    occupants::make_room_for_companions(reading, &mut rooms);
    occupants::serve_people(reading, &mut rooms);
    workers::seat_guests(reading, &mut rooms);
    occupants::seat_waiting(reading, &mut rooms);
    hosts::hang_on_hosts(reading, &mut rooms);
    hosts::hang_on_locks(reading, &mut rooms);
    hosts::share_last_bathroom(reading, &mut rooms);
    hosts::give_main_bedroom_a_bath(reading, &mut rooms);
    state_additions(reading, &rooms);
    rooms
}

/// Names the rooms that a brief calls otherwise than their type is called.
fn call_as_told(reading: &Reading, rooms: &mut [Planned]) {
    for told in &reading.names {
        let own = |r: &&mut Planned| r.requested && r.called.is_none() && r.room_type == told.room_type;
        let known = reading.domain.room_type_or_lent(&told.room_type).is_some();
        // a room that no domain knows has no other name than the one it is told by
        let all = if known { told.count.max(1) as usize } else { usize::MAX };
        for room in rooms.iter_mut().filter(own).take(all) {
            room.called = Some(told.name.clone());
        }
    }
}

/// Adds the room that robots live in, where the rooms are left open and none of them suits that.
fn house_robots<'a>(reading: &Reading<'a>, rooms: &mut Vec<Planned<'a>>) {
    let open = reading.total.is_none() && (!reading.closed || reading.may_join) && !reading.single;
    if !open || reading.robots.is_empty() || !reading.docked.is_empty() {
        return;
    }
    let robots: u32 = reading.robots.iter().map(|r| r.count).fold(0, u32::saturating_add);
    // rooms that are there to charge robots grow with them
    let holds = |kind: &RoomType| match kind.zone == Zone::Service && kind.robot.contains(&RobotUse::Charging) {
        true if kind.furnishing.iter().any(|f| reading.domain.is_dock(&f.item)) => robots,
        true => most_docks(kind.area_m2.target),
        false => 0,
    };
    let have: u32 = rooms.iter().map(|r| holds(r.kind)).fold(0, u32::saturating_add);
    let mut kinds = reading.program.robot_rooms.iter().filter_map(|id| reading.domain.room_type(id));
    let new = |k: &RoomType| reading.may_add(&k.id) && !rooms.iter().any(|r| r.room_type == k.id);
    let kind = kinds.find(|k| new(k) && have.saturating_add(holds(k)) >= robots);
    if let Some(kind) = kind.filter(|_| have < robots) {
        rooms.push(Planned::new(&kind.id, kind));
    }
}

/// Sees to it that there are as many toilets and bathrooms as storeys, where the prompt leaves the rooms open.
fn wash_on_every_storey<'a>(reading: &Reading<'a>, rooms: &mut Vec<Planned<'a>>) {
    let storeys = reading.storeys.above_ground();
    // where people work, a list of rooms that says nothing of that does not mean that one goes to another storey; nor does
    // anybody go up to the bedrooms for a toilet, unless the list says that it is all
    let works = is_office(reading.program) && !reading.only;
    let lives = is_dwelling(reading.program) && !reading.only && !reading.single;
    let open = !reading.closed || works || lives && reading.total.is_none();
    let Some(rules) = reading.domain.circulation.storeys.as_ref().filter(|_| storeys > 1 && open) else {
        return;
    };
    let storeys = if reading.closed && lives { storeys.min(TOILETS_GRANTED) } else { storeys };
    let kinds = rules.each_level_room_types.iter().filter_map(|id| reading.domain.room_type(id));
    let wet: Vec<&RoomType> =
        kinds.filter(|k| k.wet && !reading.wishes.forbidden.contains(&k.id) && k.access != Access::Host).collect();
    let usual = wet.iter().copied().find(|k| words().dwelling.toilets.contains(&k.id));
    let Some(kind) = usual.or(wet.first().copied()) else { return };
    if rooms.iter().any(|r| r.unit.is_some()) {
        return wash_in_units(reading, rooms, kind);
    }
    for _ in rooms.iter().filter(|r| is_washed_in(reading, r)).count()..storeys {
        if reading.total.is_none() {
            rooms.push(Planned::new(&kind.id, kind));
            continue;
        }
        let Some(spare) = spare_for_toilet(reading, rooms, None).filter(|s| *s > storeys) else { return };
        rooms[spare] = Planned::new(&kind.id, kind);
    }
}

/// Returns true for toilets and bathrooms that all use.
fn is_washed_in(reading: &Reading, room: &Planned) -> bool {
    room.kind.access != Access::Host && reading.wet.has_toilet(room.kind)
}

/// Returns the room that gives way to a toilet where their number is fixed: what comes last in the program, or in that of a unit.
/// No bathroom is left without its bedroom.
fn spare_for_toilet(reading: &Reading, rooms: &[Planned], unit: Option<&String>) -> Option<usize> {
    let entered = |r: &Planned| {
        let guest =
            |g: &Planned| g.kind.access == Access::Host && g.unit == r.unit && g.kind.hosts.contains(&r.room_type);
        rooms.iter().any(guest)
    };
    let spare = |r: &Planned| {
        !r.requested
            && !is_washed_in(reading, r)
            && r.kind.access != Access::Host
            && !entered(r)
            && r.unit.as_ref() == unit
    };
    rooms.iter().rposition(spare)
}

/// Gives each unit whose people have no toilets of their own one: who sleeps there may have, who works or learns there has not.
fn wash_in_units<'a>(reading: &Reading<'a>, rooms: &mut Vec<Planned<'a>>, kind: &'a RoomType) {
    let mut units: Vec<String> = Vec::new();
    for unit in rooms.iter().filter_map(|r| r.unit.as_ref()) {
        if !units.contains(unit) {
            units.push(unit.clone());
        }
    }
    for unit in units {
        let own = || rooms.iter().filter(|r| r.unit.as_ref() == Some(&unit));
        let count = |test: &dyn Fn(&Planned) -> bool| own().filter(|r| test(r)).count();
        let asleep = count(&|r| r.kind.zone == Zone::Night && r.kind.access != Access::Host);
        let bathed = count(&|r| r.kind.access == Access::Host && reading.wet.has_toilet(r.kind));
        let awake =
            count(&|r| matches!(r.kind.zone, Zone::Public | Zone::Day | Zone::Staff) && r.kind.access != Access::Host);
        if own().any(|r| is_washed_in(reading, r)) || awake == 0 && bathed >= asleep {
            continue;
        }
        let toilet = Planned { unit: Some(unit.clone()), ..Planned::new(&kind.id, kind) };
        match (reading.total, spare_for_toilet(reading, rooms, Some(&unit))) {
            (None, _) => rooms.push(toilet),
            (Some(_), Some(spare)) => rooms[spare] = toilet,
            (Some(_), None) => {}
        }
    }
}

/// Sees to it that who works on a storey has a place for tea there, where the prompt leaves the rooms open.
fn serve_every_storey<'a>(reading: &Reading<'a>, rooms: &mut Vec<Planned<'a>>) {
    let storeys = reading.storeys.above_ground();
    let open = storeys > 1 && !reading.closed && reading.total.is_none() && is_office(reading.program);
    let Some(rules) = reading.domain.circulation.storeys.as_ref().filter(|_| open) else { return };
    let served =
        |id: &&String| reading.program.rooms.iter().any(|e| &e.room_type == *id && e.area_per_person_m2.is_some());
    let kinds = rules.each_level_room_types.iter().filter(served).filter_map(|id| reading.domain.room_type(id));
    for kind in kinds.filter(|k| !reading.wet.has_toilet(k) && may_grow(reading, &k.id)) {
        let have = rooms.iter().filter(|r| r.room_type == kind.id).count();
        rooms.extend((have..storeys).filter(|_| have > 0).map(|_| Planned::new(&kind.id, kind)));
    }
}

/// Adds rooms that a building rule asks for; returns true when something was added or said.
pub(crate) fn follow_rules<'a>(
    reading: &mut Reading<'a>,
    rooms: &mut Vec<Planned<'a>>,
    missing: &[Applicable],
) -> bool {
    let mut changed = false;
    // a room by itself is no building
    for rule in missing.iter().filter(|_| !reading.single) {
        let space = &rule.constraint.space_type;
        let speaks = |t: &&RoomType| &t.id == space || t.spaces.contains(space);
        let Some(kind) = reading.domain.room_types.iter().find(speaks) else { continue };
        let what = format!("{} by {}", kind.label.to_lowercase(), rule.constraint.constraint_id);
        changed = true;
        if reading.total.is_some() || reading.closed || reading.wishes.forbidden.contains(&kind.id) {
            let message = format!("the building needs a {what}; the prompt's own list of rooms was followed");
            reading.conflicts.push(Note::new("rule_asks_for_room", message));
            continue;
        }
        reading.assumptions.push(Note::new("room_by_rule", format!("added a {what}")));
        rooms.push(Planned::new(&kind.id, kind));
    }
    changed
}

/// States which rooms the prompt does not name. Beside a list of rooms others are a change of what was asked for, but for the toilets
/// that no list of rooms names.
fn state_additions(reading: &mut Reading, rooms: &[Planned]) {
    let listed: BTreeSet<&str> = rooms.iter().filter(|r| r.requested).map(|r| r.room_type.as_str()).collect();
    let is_change = |room: &&Planned| listed.len() >= LEAST_LISTED && !reading.wet.has_toilet(room.kind);
    let added = rooms.iter().filter(|r| !r.requested);
    let (changes, usual): (Vec<&Planned>, Vec<&Planned>) = added.partition(is_change);
    let note = |rooms: &[&Planned]| {
        let message = format!("rooms added from program {}: {}", reading.program.id, counted(rooms));
        (!rooms.is_empty()).then(|| Note::new("rooms_added", message))
    };
    let (changed, assumed) = (note(&changes), note(&usual));
    reading.conflicts.extend(changed);
    reading.assumptions.extend(assumed);
}

/// Returns how many rooms of each kind there are, as people list them.
fn counted(rooms: &[&Planned]) -> String {
    let mut kinds: Vec<(&str, u32)> = Vec::new();
    for room in rooms {
        match kinds.iter_mut().find(|known| known.0 == room.kind.label) {
            Some(known) => known.1 += 1,
            None => kinds.push((&room.kind.label, 1)),
        }
    }
    let list: Vec<String> = kinds.iter().map(|(label, n)| format!("{n} {}", label.to_lowercase())).collect();
    list.join(", ")
}
