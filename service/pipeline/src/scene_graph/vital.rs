//! Rooms that no building is without, whose list the prompt leaves open: a home has a room to live in, to cook, to wash and
//! to sleep, a place to work at has a toilet. Where a number or list of rooms leaves no place for them, a conflict says so.

use d3dgen_model::domain::{Access, Domain, Occupants, Program, Zone};

use super::beds::sleeps;
use super::places::note;
use super::program::Planned;
use super::reading::{MOST_IN_OFFICE, Reading, is_dwelling};
use super::words::words;

/// Returns the kinds of rooms that the building is not without, each with what can stand for it.
fn classes(reading: &Reading) -> &'static [Vec<String>] {
    if is_dwelling(reading.program) {
        &words().dwelling.vital
    } else if is_worked_at(reading.program) {
        &words().work_vital
    } else {
        &[]
    }
}

/// Returns true for programs that seat people at work.
fn is_worked_at(program: &Program) -> bool {
    program.rooms.iter().any(|r| {
        let seat = r.area_per_occupant_m2.is_some() || r.occupants_per_room.is_some_and(|n| n <= MOST_IN_OFFICE);
        r.occupants == Occupants::Staff && seat
    })
}

/// Returns true for a room that is the last of its kind, or one of the bedrooms that the people need.
pub(super) fn is_vital(reading: &Reading, rooms: &[Planned], i: usize) -> bool {
    let id = &rooms[i].room_type;
    let main = reading.program.rooms.first().is_some_and(|e| &e.room_type == id);
    if main && rooms.iter().filter(|r| &r.room_type == id).count() == 1 {
        return true;
    }
    let last =
        |class: &&Vec<String>| class.contains(id) && rooms.iter().filter(|r| class.contains(&r.room_type)).count() == 1;
    classes(reading).iter().any(|class| last(&class))
        || sleeps_in(reading.domain, &rooms[i]) && bedrooms(reading, rooms) <= bedrooms_needed(reading)
}

fn sleeps_in(domain: &Domain, room: &Planned) -> bool {
    room.room_type == words().dwelling.studio || room.kind.zone == Zone::Night && sleeps(domain, room.kind).is_some()
}

fn bedrooms(reading: &Reading, rooms: &[Planned]) -> usize {
    rooms.iter().filter(|r| sleeps_in(reading.domain, r)).count()
}

/// Returns how many bedrooms the people need: two share one, everyone else has one.
fn bedrooms_needed(reading: &Reading) -> usize {
    let people = reading.residents.filter(|_| is_dwelling(reading.program));
    people.map_or(0, |n| n.saturating_sub(1).max(1) as usize)
}

/// Sees to it that the building has what none is without; what finds no place becomes a conflict.
pub(super) fn complete<'a>(reading: &mut Reading<'a>, rooms: &mut Vec<Planned<'a>>) {
    if reading.single {
        return;
    }
    let mut missing: Vec<String> = Vec::new();
    for class in classes(reading) {
        let present = rooms.iter().any(|r| class.contains(&r.room_type));
        let unwanted = class.iter().any(|id| reading.wishes.forbidden.contains(id));
        let listed = |id: &&String| reading.program.rooms.iter().any(|e| e.room_type == **id);
        let known = |id: &&String| reading.domain.room_type(id).is_some();
        let Some(id) = class.iter().find(listed).or_else(|| class.iter().find(known)) else { continue };
        if present || unwanted {
            continue;
        }
        let kind = reading.domain.room_type_or_generic(id);
        if !put(reading, rooms, Planned::new(&kind.id, kind)) {
            missing.push(kind.label.to_lowercase());
        }
    }
    let needed = bedrooms_needed(reading);
    let bedroom = reading.domain.room_type(&words().dwelling.bedroom);
    if let Some(kind) = bedroom.filter(|_| bedrooms(reading, rooms) < needed) {
        let fixed = reading.wishes.wishes.iter().any(|w| w.exact && w.room_type == kind.id);
        let mut full = fixed;
        while !full && bedrooms(reading, rooms) < needed {
            full = !put(reading, rooms, Planned::new(&kind.id, kind));
        }
        let beds: u32 = rooms.iter().filter_map(|r| Some(sleeps(reading.domain, r.kind)?[1])).sum();
        if full && reading.residents.is_some_and(|n| n > beds) {
            let (people, have) = (reading.residents.unwrap_or(0), bedrooms(reading, rooms));
            let message = format!(
                "{people} people are to live there, and {have} bedrooms have {beds} beds; the rooms asked for were planned"
            );
            reading.conflicts.push(note("too_few_bedrooms", message));
        }
    }
    // a home's own list of rooms is its own affair
    let own_list = reading.closed && reading.total.is_none() && is_dwelling(reading.program);
    if !missing.is_empty() && !own_list {
        let what = missing.join(", ");
        let message = match reading.total {
            Some(n) => format!("{n} rooms leave no place for what such a building needs: {what}"),
            None => {
                format!("the list of rooms has nothing of what such a building needs: {what}; the list was followed")
            }
        };
        reading.conflicts.push(note("vital_room_missing", message));
    }
}

/// Adds a room, where the number of rooms is fixed in place of one that can be spared; returns false where none can.
fn put<'a>(reading: &Reading<'a>, rooms: &mut Vec<Planned<'a>>, room: Planned<'a>) -> bool {
    match (reading.total, reading.closed) {
        (None, true) if !reading.named || is_dwelling(reading.program) => false,
        (None, _) => {
            rooms.push(room);
            true
        }
        (Some(_), _) => {
            let hosts = |i: usize| rooms[i].kind.access == Access::Host;
            let spare =
                (0..rooms.len()).rev().find(|&i| !rooms[i].requested && !hosts(i) && !is_vital(reading, rooms, i));
            if let Some(i) = spare {
                rooms[i] = room;
            }
            spare.is_some()
        }
    }
}
