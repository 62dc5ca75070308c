//! Who is in the rooms, and how large that makes them: beds, desks, places to be treated at and to wait.

use d3dgen_model::domain::{Access, Domain, Furnishing, Occupants, Privacy, RoomType, Shape, Zone};
use d3dgen_model::offer;
use d3dgen_model::offer::{MOST_IN_TEAM, sleeps};

use crate::built::planned::Planned;
use crate::named::objects::Thing;
use crate::people::held::Held;
use crate::reading::Reading;
use crate::subject::programs::is_dwelling;
use crate::tokens::words::words;

/// Floor for a desk of a room whose domain says nothing of it, m^2.
const DESK_AREA_M2: f64 = 9.0;

/// Share of a room's usual area from which on its people need all of it.
const FULL: f64 = 0.8;

/// Floor of a room to live in with a table for many, over the least that such a table comes in.
const BESIDE_TABLE: f64 = 1.3;

/// Floor of a room with a table of a size that is asked for, over the least that such a table comes in.
const ROUND_NAMED: f64 = 1.15;

/// Floor of a desk in a room that one lives in, m^2.
const AT_DESK_M2: f64 = 5.0;

/// Floor of such a room for who comes to the table in a wheelchair, as a factor.
const STEP_FREE: f64 = 1.15;

/// Seats that people find where they wait for each room that sees them one at a time.
const SEATS_PER_ROOM: u32 = 2;

/// Factor on the area of an entrance hall with a wardrobe in it.
const HALL_WITH_WARDROBE: f64 = 1.35;

/// Factor on the area of a bedroom with a desk or a cot in it.
const WITH_THING: f64 = 1.12;

/// Floor of the bed for who stays with a patient, m^2.
const COMPANION_M2: f64 = 4.0;

/// Floor of a room for a team beside its desks, m^2.
const BESIDE_DESKS_M2: f64 = 3.0;

/// Returns the head count a program entry speaks of.
pub(crate) fn head_count(reading: &Reading, of: Occupants) -> Option<u32> {
    let o = &reading.occupancy;
    match of {
        Occupants::Staff => o.staff.max(o.desks),
        Occupants::Visitors => o.visitors,
        // who stays in a ward are its patients, whatever the prompt calls them
        Occupants::Beds => o.beds.or(reading.residents).or(o.visitors),
        Occupants::Residents => reading.residents,
    }
}

/// Returns true when a head count of the prompt says how many rooms of a type there are.
pub(crate) fn is_counted(reading: &Reading, room_type: &str) -> bool {
    let mut entries = reading.program.rooms.iter().filter(|e| e.room_type == room_type);
    entries.any(|e| head_count(reading, e.occupants).is_some())
}

/// Makes bedrooms of a home larger by the desk or the cot that the prompt wants in them.
pub(super) fn make_room_for_things(reading: &Reading, rooms: &mut [Planned]) {
    let d = &words().dwelling;
    let larger = |t: &&Thing| t.object == d.own_desk || t.object == d.baby_bed;
    // a wardrobe needs floor before it that an entrance hall of the usual size has for the door
    let halls = &reading.domain.circulation.entrance_room_types;
    let stores = |t: &&Thing| reading.domain.object(&t.object).is_some_and(|o| o.shape == Shape::Cabinet);
    for thing in reading.objects.iter().filter(stores) {
        let hall = |r: &&mut Planned| halls.contains(&r.room_type) && thing.room_type.as_deref() == Some(&r.room_type);
        rooms.iter_mut().filter(hall).take(1).for_each(|r| r.size = r.size.or(Some(HALL_WITH_WARDROBE)));
    }
    for thing in reading.objects.iter().filter(larger).filter(|_| is_dwelling(reading.program)) {
        let asked = |r: &&mut Planned| {
            r.kind.zone == Zone::Night && thing.room_type.as_deref() == Some(&r.room_type) && r.area_m2.is_none()
        };
        let count = if thing.each { rooms.len() } else { 1 };
        rooms.iter_mut().filter(asked).take(count).for_each(|r| r.size = r.size.or(Some(WITH_THING)));
    }
}

/// Makes rooms of patients larger by the bed of who stays with them.
pub(super) fn make_room_for_companions(reading: &Reading, rooms: &mut [Planned]) {
    let domain = reading.domain;
    let own = |r: &&mut Planned| r.kind.privacy == Privacy::Private && sleeps(domain, r.kind).is_some();
    for room in rooms.iter_mut().filter(|_| reading.stays).filter(own) {
        let area = room.people_area_m2.unwrap_or(room.kind.area_m2.target);
        room.size_for_people(area + COMPANION_M2);
    }
}

/// Spreads the people over the rooms that the program gives them.
pub(super) fn hold_people(reading: &mut Reading, rooms: &mut [Planned]) {
    hold_stations(reading, rooms);
    // who has a desk elsewhere needs none here
    let at_desks = |r: &&Planned| offer::desks(reading.domain, r.kind).is_some();
    let seated: u32 = rooms.iter().filter(at_desks).filter_map(|r| r.occupants).sum();
    for entry in &reading.program.rooms {
        let Some(people) = head_count(reading, entry.occupants) else { continue };
        let elsewhere = if entry.occupants == Occupants::Staff { seated } else { 0 };
        let Some(people) = people.checked_sub(elsewhere).filter(|n| *n > 0) else { continue };
        let places: Vec<usize> = (0..rooms.len()).filter(|&i| rooms[i].room_type == entry.room_type).collect();
        let flushes = reading.wet.has_toilet(reading.domain.room_type_or_generic(&entry.room_type));
        let sits = entry.area_per_occupant_m2.is_some() || entry.occupants != Occupants::Staff && !flushes;
        if !sits || places.is_empty() || places.iter().any(|&i| rooms[i].occupants.is_some()) || reading.single {
            continue;
        }
        let n = places.len() as u32;
        for (k, &i) in places.iter().enumerate() {
            rooms[i].occupants = Some(people / n + u32::from((k as u32) < people % n));
            let area = entry.area_per_occupant_m2.map(|per| per * f64::from(people) / f64::from(n));
            rooms[i].people_area_m2 = area;
        }
    }
    // beds the program does not know of stand in the rooms the prompt names for sleeping
    if let Some(beds) = reading.occupancy.beds
        && rooms.iter().all(|r| r.occupants.is_none())
    {
        let places: Vec<usize> =
            (0..rooms.len()).filter(|&i| rooms[i].requested && rooms[i].kind.zone == Zone::Night).collect();
        if (1..=beds as usize).contains(&places.len()) {
            let n = places.len() as u32;
            for (k, &i) in places.iter().enumerate() {
                rooms[i].occupants = Some(beds / n + u32::from((k as u32) < beds % n));
            }
        }
    }
}

/// Gives rooms the places to be treated at that the prompt says, and the floor for them.
fn hold_stations(reading: &Reading, rooms: &mut [Planned]) {
    for held in &reading.stationed {
        for room in rooms_of(held, rooms) {
            let Some(places) = offer::places(reading.domain, room.kind) else { continue };
            room.occupants = Some(held.beds);
            room.size_for_people(places.area_m2(held.beds));
        }
    }
}

/// Sizes rooms that serve all who work there by how many these are: as many as the prompt says, else as have a desk.
pub(super) fn serve_people(reading: &Reading, rooms: &mut [Planned]) {
    let entries = reading.program.rooms.iter().filter_map(|e| Some((e, e.area_per_person_m2?))).collect::<Vec<_>>();
    if entries.is_empty() || reading.single {
        return;
    }
    // in a home those who sleep there eat there
    let lives = is_dwelling(reading.program);
    let beds = rooms.iter().filter_map(|r| Some(sleeps(reading.domain, r.kind)?[0])).sum::<u32>();
    // who has a room alone has its double bed alone
    let rooms_to_sleep = rooms.iter().filter(|r| sleeps(reading.domain, r.kind).is_some()).count() as u32;
    // and in a ward its patients, for whom the day room is
    let nurses = reading.program.rooms.iter().any(|e| e.occupants == Occupants::Beds);
    let people = match (lives, reading.each_alone, nurses) {
        (true, true, _) => reading.residents.unwrap_or(rooms_to_sleep),
        (true, false, _) => reading.residents.unwrap_or(0).max(beds),
        (false, _, true) => reading.occupancy.beds.unwrap_or(beds),
        (false, _, false) => places_to_work(reading, rooms),
    };
    let people = f64::from(people);
    let mut sized: Vec<&str> = Vec::new();
    for (entry, each) in entries {
        if sized.contains(&entry.room_type.as_str()) {
            continue;
        }
        sized.push(&entry.room_type);
        let alike: Vec<usize> = (0..rooms.len()).filter(|&i| rooms[i].room_type == entry.room_type).collect();
        let at_table = if lives { table_for(reading, rooms, alike.first().copied(), people) } else { 0.0 };
        for &i in &alike {
            let range = rooms[i].kind.area_m2;
            rooms[i].table_area_m2 = (at_table > 0.0).then(|| at_table.min(range.max));
            // a table for a few stands in a room of the usual size
            let table = if at_table > range.target { at_table } else { 0.0 };
            let area = (each * people / alike.len() as f64).max(table).clamp(range.min, range.max);
            // those of a usual size hold a usual number; a small office has small toilets
            if !lives || area > range.target {
                rooms[i].size_for_people(area);
            } else if lives && area > FULL * range.target {
                // as many as the usual size is for: it is not to come out small
                rooms[i].size_for_people(range.target);
            }
        }
    }
}

/// Returns the floor of a room in which the people of a home eat for want of a room for that, m^2: what the table for all
/// of them asks for, and the way past it to the rest; 0 where such a table is nothing out of the usual.
fn table_for(reading: &Reading, rooms: &[Planned], room: Option<usize>, people: f64) -> f64 {
    let domain = reading.domain;
    let Some(kind) = room.and_then(|i| rooms.get(i)).map(|r| r.kind) else { return 0.0 };
    let elsewhere = |line: &Furnishing| rooms.iter().any(|r| line.unless_rooms.contains(&r.room_type));
    let table = |line: &&Furnishing| {
        let is = domain.anchor(&line.item).is_some_and(|o| matches!(o.shape, Shape::Table | Shape::RoundTable));
        is && line.sleepers > 0 && f64::from(line.sleepers) <= people.max(2.0) && !line.unless_rooms.is_empty()
    };
    let line = kind.furnishing.iter().filter(table).max_by_key(|line| line.sleepers).filter(|line| !elsewhere(line));
    let beside = if reading.accessible { BESIDE_TABLE * STEP_FREE } else { BESIDE_TABLE };
    // a desk in the room takes floor of its own
    let desk = |t: &&Thing| t.object == words().dwelling.own_desk && t.room_type.as_deref() == Some(&kind.id);
    let at_desk = if reading.objects.iter().any(|t| desk(&t)) { AT_DESK_M2 } else { 0.0 };
    let of_all = line.map_or(0.0, |line| beside * line.area_per_item_m2 + at_desk);
    // "a dining table for eight"
    let named = |line: &&Furnishing| {
        let table = domain.anchor(&line.item).filter(|_| line.sleepers > 0);
        table.is_some_and(|o| reading.objects.iter().any(|t| t.object == o.id)) && !elsewhere(line)
    };
    kind.furnishing.iter().filter(named).map(|line| ROUND_NAMED * line.area_per_item_m2).fold(of_all, f64::max)
}

/// Returns how many people work there: as many as the prompt says, else as have a desk.
pub(super) fn places_to_work(reading: &Reading, rooms: &[Planned]) -> u32 {
    let desks = || rooms.iter().map(|r| workplaces(reading.domain, r)).sum::<u32>();
    match reading.occupancy.staff {
        Some(staff) => staff.max(reading.occupancy.desks.unwrap_or(0)),
        // "10 offices and an open plan with 12 desks"
        None => head_count(reading, Occupants::Staff).unwrap_or(0).max(desks()),
    }
}

/// Sizes rooms to wait in by the rooms that people wait for, where these ask for more than usual.
pub(super) fn seat_waiting(reading: &Reading, rooms: &mut [Planned]) {
    let waits = |kind: &RoomType| {
        let line = kind.furnishing.first().filter(|f| f.required && f.area_per_item_m2 > 0.0)?;
        let bench = reading.domain.object(&line.item).filter(|o| o.shape == Shape::Bench)?;
        let seats = f64::from(offer::seats_on(bench));
        (kind.privacy == Privacy::Public).then_some(line.area_per_item_m2 / seats)
    };
    let sees = |r: &&Planned| r.kind.zone == Zone::Day && r.kind.privacy == Privacy::Private;
    let seen = rooms.iter().filter(sees).count() as u32;
    let places: Vec<usize> = (0..rooms.len()).filter(|&i| waits(rooms[i].kind).is_some()).collect();
    for &i in &places {
        let Some(each) = waits(rooms[i].kind).filter(|_| rooms[i].area_m2.is_none() && !reading.single) else {
            continue;
        };
        let seats = (SEATS_PER_ROOM * seen).div_ceil(places.len() as u32);
        let range = rooms[i].kind.area_m2;
        let area = (each * f64::from(seats)).min(range.max);
        if area > range.target && rooms[i].people_area_m2.is_none() {
            rooms[i].people_area_m2 = Some(area);
        }
    }
}

/// Returns how many people have a desk in a room: as many as it is told to hold, else as in one of its usual size.
pub(super) fn workplaces(domain: &Domain, room: &Planned) -> u32 {
    if let Some(told) = room.occupants.filter(|_| !room.visited) {
        return told;
    }
    let area = room.reckoned_m2();
    let lines = room.kind.furnishing.iter().filter(|line| line.instead_of.is_empty());
    lines.map(|line| offer::desks_of(domain, &line.item) * line.units(area)).max().unwrap_or(0)
}

/// Returns the floor for each desk of a room type, m^2: as the programs say, else as its furnishing.
pub(super) fn desk_area_m2(domain: &Domain, room_type: &str) -> f64 {
    let entries = domain.programs.iter().flat_map(|p| &p.rooms).filter(|e| e.room_type == room_type);
    let lines = domain.room_type_or_generic(room_type).furnishing.iter().filter(|f| f.required);
    let by_program = entries.filter_map(|e| e.area_per_occupant_m2).next();
    by_program.or_else(|| lines.map(|f| f.area_per_item_m2).find(|a| *a > 0.0)).unwrap_or(DESK_AREA_M2)
}

/// Gives rooms to sleep in the beds that the prompt says, and where its beds are those of its rooms the usual ones.
pub(super) fn hold_beds(reading: &Reading, rooms: &mut [Planned]) {
    for held in &reading.held {
        for room in rooms_of(held, rooms) {
            room.occupants = Some(held.beds);
            if offer::desks(reading.domain, room.kind).is_some() {
                let area = desk_area_m2(reading.domain, &room.room_type) * f64::from(held.beds);
                room.size_for_people(area + beside_desks(held.beds));
            }
            let Some([low, high]) = sleeps(reading.domain, room.kind) else { continue };
            if !(low..=high).contains(&held.beds) || high > low {
                room.size_for_people(room.kind.area_m2.target * f64::from(held.beds) / f64::from(low.max(1)));
            }
        }
    }
    let o = &reading.occupancy;
    let heads = o.beds.or(o.staff).or(o.desks).or(o.visitors).or(reading.residents);
    if let Some(room) = rooms.first_mut().filter(|r| reading.single && r.occupants.is_none()) {
        room.occupants = heads;
    }
    let Some(beds) = o.beds else { return };
    let held: u32 = rooms.iter().filter_map(|r| r.occupants).sum();
    let open: Vec<(usize, u32)> = (0..rooms.len())
        .filter(|&i| rooms[i].requested && rooms[i].occupants.is_none())
        .filter_map(|i| Some((i, sleeps(reading.domain, rooms[i].kind)?[0])))
        .collect();
    let sum = |rooms: &mut dyn Iterator<Item = &(usize, u32)>| held + rooms.map(|r| r.1).sum::<u32>();
    let beside = sum(&mut open.iter().filter(|r| rooms[r.0].kind.access != Access::Host));
    if sum(&mut open.iter()) == beds || beside == beds {
        open.into_iter().for_each(|(i, each)| rooms[i].occupants = Some(each));
    }
}

/// Returns the rooms that the prompt gives so many heads, and that have none yet.
fn rooms_of<'r, 'a>(held: &Held, rooms: &'r mut [Planned<'a>]) -> impl Iterator<Item = &'r mut Planned<'a>> {
    let free = |r: &&mut Planned| r.requested && r.occupants.is_none() && r.room_type == held.room_type;
    rooms.iter_mut().filter(free).take(held.count as usize)
}

/// Returns the floor of a small room beside its desks, m^2: the door and the cupboard.
pub(super) fn beside_desks(desks: u32) -> f64 {
    if (3..=MOST_IN_TEAM).contains(&desks) { BESIDE_DESKS_M2 } else { 0.0 }
}
