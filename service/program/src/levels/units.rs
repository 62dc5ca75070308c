//! Large buildings are made of units (wards, departments), each with what it needs at hand, as programs of the domain say.

use d3dgen_model::domain::{Access, Occupants, Program, Units, Zone};
use d3dgen_model::scene_graph::Note;

use crate::built::growth::{fill_unit, may_grow};
use crate::built::large;
use crate::built::occupants::{head_count, is_counted};
use crate::built::planned::Planned;
use crate::built::vital::guests;
use crate::reading::Reading;

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
    // twenty patient rooms with their en suites are one ward, and one reception more makes no two of it
    let counts = |r: &&Planned| r.kind.access != Access::Host && !is_once_for_all(reading, r);
    let along = rooms.iter().filter(counts).count();
    let is_large = |u: &Units| along >= u.from_rooms as usize;
    let storeys = own_storeys(reading, along, program.units.as_ref().is_some_and(is_large));
    let large = |u: &&Units| !reading.closed && (is_large(u) || storeys > 1);
    let Some(rules) = program.units.as_ref().filter(large) else { return rooms };
    let count = how_many(rooms.len(), rules, storeys);
    let later = rules.programs.iter().filter_map(|id| reading.domain.program(id)).cycle();
    let mut units: Vec<Unit> =
        [program].into_iter().chain(later).take(count).map(|program| Unit { program, rooms: Vec::new() }).collect();
    let stays = fixed_rooms(reading, &rooms);
    let (fixed, others): (Vec<_>, Vec<_>) = rooms.into_iter().zip(stays).partition(|(_, stays)| *stays);
    let fixed: Vec<Planned> = fixed.into_iter().map(|(room, _)| room).collect();
    let others: Vec<Planned> = others.into_iter().map(|(room, _)| room).collect();
    // storeys of a building whose size is open have as many rooms as it would have on one, and those of a unit; an area is
    // filled, and what serves rooms or people that are counted comes beside them
    let usual = (program.default_rooms as usize).max(USUAL_ON_STOREY) * count;
    let usual = match reading.area_m2 {
        Some(_) => Some(fixed.len() + others.len()),
        None => Some(usual).filter(|usual| is_open(reading) && fixed.len() < *usual),
    };
    let total = reading.total.map(|total| total as usize).or(usual.filter(|_| storeys > 1));
    let mut free = total.map(|total| total.saturating_sub(fixed.len()));
    spread(reading, fixed, &mut units);
    if storeys > 1 {
        equip(reading, &mut units, free.as_mut());
    }
    let totals = free.map(|free| level_up(free, &units));
    for (k, unit) in units.iter_mut().enumerate() {
        let rooms = std::mem::take(&mut unit.rooms);
        unit.rooms = fill_unit(reading, unit.program, rooms, totals.as_ref().map(|t| t[k]));
    }
    if storeys > 1 {
        keep_all(reading, &mut units, others);
        even_out(reading, &mut units);
    }
    let mut out = Vec::new();
    let mut made: Vec<&str> = Vec::new();
    for unit in units {
        made.push(&unit.program.id);
        let id = format!("{}_{}", unit.program.id, made.iter().filter(|m| **m == unit.program.id).count());
        out.extend(unit.rooms.into_iter().map(|room| Planned { unit: Some(id.clone()), ..room }));
    }
    let message = format!("the building was made of {} units: {}", made.len(), made.join(", ").replace('_', " "));
    reading.assumptions.push(Note::new("units", message));
    out
}

/// Returns how many units so many rooms make: at least two, and on each storey as many.
fn how_many(rooms: usize, rules: &Units, storeys: usize) -> usize {
    let by_size = rooms as f64 / f64::from(rules.rooms);
    if storeys > 1 {
        storeys * ((by_size / storeys as f64).round() as usize).max(1)
    } else {
        (by_size.round() as usize).max(2)
    }
}

/// Gives each unit what its program calls vital, and the first the toilets that those after it have, as far as the number of
/// rooms allows.
fn equip<'a>(reading: &Reading<'a>, units: &mut [Unit<'a>], mut free: Option<&mut usize>) {
    let of_second: Vec<&String> = units.get(1).map_or(Vec::new(), |unit| unit.program.vital.iter().collect());
    let flushes = |id: &String| reading.domain.room_type(id).is_some_and(|k| reading.wet.has_toilet(k));
    for (n, unit) in units.iter_mut().enumerate() {
        let as_well = of_second.iter().copied().filter(|id| n == 0 && flushes(id) && unit.knows(id));
        let vital: Vec<&String> = unit.program.vital.iter().chain(as_well).collect();
        for id in vital.into_iter().filter(|id| may_grow(reading, id)) {
            let missing = unit.rooms.iter().all(|r| &r.room_type != id);
            let Some(kind) = reading.domain.room_type(id).filter(|_| missing) else { continue };
            match free.as_deref_mut() {
                Some(0) => return,
                Some(left) => *left -= 1,
                None => {}
            }
            unit.rooms.push(Planned::new(&kind.id, kind));
        }
    }
}

/// Gives the first unit, which people enter, what the building had before and no unit has; where the number of rooms is fixed
/// the programs decide.
fn keep_all<'a>(reading: &Reading<'a>, units: &mut [Unit<'a>], others: Vec<Planned<'a>>) {
    for room in others.into_iter().filter(|_| reading.total.is_none()) {
        if !units.iter().flat_map(|u| &u.rooms).any(|r| r.room_type == room.room_type) {
            units[0].rooms.push(room);
        }
    }
}

/// Moves rooms to work, learn or sleep in from the largest unit to the smallest while that makes them more alike: storeys stand
/// on each other, and what all share takes floor of the first.
fn even_out(reading: &Reading, units: &mut [Unit]) {
    let area = |unit: &Unit| unit.rooms.iter().map(Planned::reckoned_m2).sum::<f64>();
    let rooms = units.iter().map(|u| u.rooms.len()).sum::<usize>();
    for _ in 0..rooms {
        let by_area = |a: &usize, b: &usize| area(&units[*a]).total_cmp(&area(&units[*b]));
        let (Some(from), Some(to)) = ((0..units.len()).max_by(by_area), (0..units.len()).min_by(by_area)) else {
            return;
        };
        let gap = area(&units[from]) - area(&units[to]);
        let movable =
            (0..units[from].rooms.len()).rev().filter_map(|i| with_guests(reading, &units[from], &units[to], i));
        let size = |moved: &Vec<usize>| moved.iter().map(|&i| units[from].rooms[i].reckoned_m2()).sum::<f64>();
        let off = |m: &Vec<usize>| (size(m) - gap / 2.0).abs();
        let Some(mut moved) = movable.filter(|m| size(m) < gap).min_by(|a, b| off(a).total_cmp(&off(b))) else {
            return;
        };
        moved.sort_unstable_by(|a, b| b.cmp(a));
        for i in moved {
            let room = units[from].rooms.remove(i);
            units[to].rooms.push(room);
        }
    }
}

/// Returns a room of a unit that another can have as well, with what is entered from it; `None` for others and for the last one.
fn with_guests(reading: &Reading, from: &Unit, to: &Unit, i: usize) -> Option<Vec<usize>> {
    let room = &from.rooms[i];
    let used = matches!(room.kind.zone, Zone::Day | Zone::Night) && room.kind.access != Access::Host;
    let several = from.rooms.iter().filter(|r| r.room_type == room.room_type).count() > 1;
    if !used || !several || !to.knows(&room.room_type) || large::is_of_all(reading, room) {
        return None;
    }
    let mut out = vec![i];
    for guest in guests(reading, &room.room_type).iter().filter(|k| k.access == Access::Host) {
        out.extend(from.rooms.iter().rposition(|r| r.room_type == guest.id));
    }
    Some(out)
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

/// Returns which rooms stay whatever the units' programs say: those that the prompt names, those of which it counts the people,
/// what comes with these, and what a large building has once for all.
fn fixed_rooms(reading: &Reading, rooms: &[Planned]) -> Vec<bool> {
    let comes_with = |room: &Planned| {
        let mut counted = reading.program.rooms.iter().filter(|e| is_counted(reading, &e.room_type));
        counted.any(|e| e.with.contains(&room.room_type))
    };
    let asked = rooms.iter().filter(|r| r.requested).flat_map(|r| guests(reading, &r.room_type)).collect::<Vec<_>>();
    let belongs = |room: &Planned| asked.iter().any(|k| k.id == room.room_type);
    let stays = |room: &Planned| {
        let told = room.requested || is_counted(reading, &room.room_type) || comes_with(room) || belongs(room);
        told || is_once_for_all(reading, room)
    };
    rooms.iter().map(stays).collect()
}

/// Returns true for what a large building has once for all, where the number of rooms is open.
fn is_once_for_all(reading: &Reading, room: &Planned) -> bool {
    reading.total.is_none() && large::is_of_all(reading, room)
}

impl Unit<'_> {
    /// Returns true for types of rooms that its program has.
    fn knows(&self, kind: &str) -> bool {
        self.program.rooms.iter().any(|e| e.room_type == kind || e.with.iter().any(|w| w == kind))
    }
}

/// Deals rooms out to the units whose programs have their type, so many to each; what none has goes to the first, as what the
/// building has once for all.
fn spread<'a>(reading: &Reading, rooms: Vec<Planned<'a>>, units: &mut [Unit<'a>]) {
    let mut kinds: Vec<(String, Vec<Planned>)> = Vec::new();
    for room in rooms {
        match kinds.iter_mut().find(|k| k.0 == room.room_type) {
            Some(known) => known.1.push(room),
            None => kinds.push((room.room_type.clone(), vec![room])),
        }
    }
    for (kind, rooms) in kinds {
        let of_all = rooms.len() == 1 && large::is_of_all(reading, &rooms[0]);
        let mut able: Vec<usize> = (0..units.len()).filter(|&u| !of_all && units[u].knows(&kind)).collect();
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
