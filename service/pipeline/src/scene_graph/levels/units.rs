//! Large buildings are made of units (wards, departments), each with what it needs at hand, as programs of the domain say.

use d3dgen_model::domain::{Access, Occupants, Program, Units};

use crate::scene_graph::built::occupants::{head_count, is_counted};
use crate::scene_graph::built::program::{Planned, fill_unit};
use crate::scene_graph::built::vital::guests;
use crate::scene_graph::reading::Reading;
use crate::scene_graph::subject::places::note;

/// Rooms of a storey that is a unit of its own, at least, and of one whose number is open.
const LEAST_ON_STOREY: usize = 12;
const USUAL_ON_STOREY: usize = 16;

/// A unit to be.
struct Unit<'a> {
    program: &'a Program,
    rooms: Vec<Planned<'a>>,
}

/// Returns the rooms dealt out to units where the building is large and its program knows units: those that the prompt names
/// or counts stay, the rest is what each unit's own program has. The rooms of a unit follow each other.
pub(crate) fn divide<'a>(reading: &mut Reading<'a>, rooms: Vec<Planned<'a>>) -> Vec<Planned<'a>> {
    let program = reading.program;
    // twenty patient rooms with their en suites are one ward
    let along = rooms.iter().filter(|r| r.kind.access != Access::Host).count();
    let is_large = |u: &Units| along >= u.from_rooms as usize;
    let storeys = own_storeys(reading, along, program.units.as_ref().is_some_and(is_large));
    let large = |u: &&Units| !reading.closed && (is_large(u) || storeys > 1);
    let Some(rules) = program.units.as_ref().filter(large) else { return rooms };
    let count = ((rooms.len() as f64 / f64::from(rules.rooms)).round() as usize).max(2).max(storeys);
    let later = rules.programs.iter().filter_map(|id| reading.domain.program(id)).cycle();
    let mut units: Vec<Unit> =
        [program].into_iter().chain(later).take(count).map(|program| Unit { program, rooms: Vec::new() }).collect();
    let rooms_in_all = rooms.len();
    let fixed = fixed_rooms(reading, rooms);
    // storeys of a building whose size is open have as many rooms as it would have on one, and those of a unit
    let usual = (program.default_rooms as usize).max(USUAL_ON_STOREY) * count;
    let usual = if is_open(reading) { usual } else { rooms_in_all };
    let total = reading.total.map(|total| total as usize).or_else(|| (storeys > 1).then_some(usual));
    let free = total.map(|total| total.saturating_sub(fixed.len()));
    spread(fixed, &mut units);
    let totals = free.map(|free| level_up(free, &units));
    let mut out = Vec::new();
    let mut made: Vec<&str> = Vec::new();
    for (k, unit) in units.into_iter().enumerate() {
        made.push(&unit.program.id);
        let id = format!("{}_{}", unit.program.id, made.iter().filter(|m| **m == unit.program.id).count());
        let filled = fill_unit(reading, unit.program, unit.rooms, totals.as_ref().map(|t| t[k]));
        out.extend(filled.into_iter().map(|room| Planned { unit: Some(id.clone()), ..room }));
    }
    let message = format!("the building was made of {} units: {}", made.len(), made.join(", ").replace('_', " "));
    reading.assumptions.push(note("units", message));
    out
}

/// Returns how many storeys, counted from the ground, are each to be a unit: with what is needed at hand on that storey, rather
/// than with what is left over from the others. Too few rooms are dealt out one by one.
fn own_storeys(reading: &Reading, rooms: usize, large: bool) -> usize {
    let storeys = reading.storeys.above_ground();
    if large || rooms >= LEAST_ON_STOREY * storeys || is_open(reading) { storeys } else { 1 }
}

/// Returns true where neither a number of rooms or people nor an area says how large the building is.
fn is_open(reading: &Reading) -> bool {
    let counted = [Occupants::Staff, Occupants::Visitors, Occupants::Beds, Occupants::Residents];
    let people = counted.iter().any(|&who| head_count(reading, who).is_some());
    reading.total.is_none() && reading.area_m2.is_none() && !people
}

/// Returns the rooms that the prompt names, those of which it counts the people, and what comes with these.
fn fixed_rooms<'a>(reading: &Reading<'a>, rooms: Vec<Planned<'a>>) -> Vec<Planned<'a>> {
    let comes_with = |room: &Planned| {
        let mut counted = reading.program.rooms.iter().filter(|e| is_counted(reading, &e.room_type));
        counted.any(|e| e.with.contains(&room.room_type))
    };
    let asked = rooms.iter().filter(|r| r.requested).flat_map(|r| guests(reading, &r.room_type)).collect::<Vec<_>>();
    let belongs = |room: &Planned| asked.iter().any(|k| k.id == room.room_type);
    let stays =
        |room: &Planned| room.requested || is_counted(reading, &room.room_type) || comes_with(room) || belongs(room);
    rooms.into_iter().filter(stays).collect()
}

/// Deals rooms out to the units whose programs have their type, so many to each; what none has goes to the first.
fn spread<'a>(rooms: Vec<Planned<'a>>, units: &mut [Unit<'a>]) {
    let knows = |unit: &Unit, kind: &str| {
        unit.program.rooms.iter().any(|e| e.room_type == kind || e.with.iter().any(|w| w == kind))
    };
    let mut kinds: Vec<(String, Vec<Planned>)> = Vec::new();
    for room in rooms {
        match kinds.iter_mut().find(|k| k.0 == room.room_type) {
            Some(known) => known.1.push(room),
            None => kinds.push((room.room_type.clone(), vec![room])),
        }
    }
    for (kind, rooms) in kinds {
        let mut able: Vec<usize> = (0..units.len()).filter(|&u| knows(&units[u], &kind)).collect();
        if able.is_empty() {
            able.push(0);
        }
        let count = rooms.len();
        for (k, room) in rooms.into_iter().enumerate() {
            let at = if count < able.len() { k } else { k * able.len() / count };
            units[able[at]].rooms.push(room);
        }
    }
}

/// Returns how many rooms each unit is to have so that all have about as many and `free` are added.
fn level_up(free: usize, units: &[Unit]) -> Vec<usize> {
    let mut totals: Vec<usize> = units.iter().map(|u| u.rooms.len()).collect();
    for _ in 0..free {
        let least = (0..totals.len()).min_by_key(|&u| totals[u]);
        if let Some(least) = least {
            totals[least] += 1;
        }
    }
    totals
}
