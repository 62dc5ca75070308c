//! Places to work at follow those who work there: desks for as many as the prompt says, toilets for women and men, seats in
//! break rooms and canteens, and the names that the prompt gives its rooms.

use std::collections::BTreeMap;

use d3dgen_model::domain::{Domain, Occupants, Privacy, Program, RoomType, Zone};
use d3dgen_model::offer;
use d3dgen_model::offer::{MOST_IN_TEAM, Seating, has_counters, most_desks, seating, works_in};
use d3dgen_model::scene_graph::{GraphRoom, Note};

use super::occupants::{desk_area_m2, head_count, places_to_work, workplaces};
use super::vital;
use crate::built::occupants::beside_desks;
use crate::built::planned::Planned;
use crate::reading::Reading;
use crate::subject::programs::is_office;
use crate::tokens::text::capital;
use crate::tokens::words::words;
use crate::wished::wishes::{Wish, Wishes};

/// Tag of rooms that people meet in.
const MEET: &str = "meet";
/// People from which on women and men have a toilet each.
const PEOPLE_FOR_TWO: u32 = 10;
/// People and rooms from which on there is a toilet for wheelchairs.
const PEOPLE_FOR_ACCESSIBLE: u32 = 15;
const ROOMS_FOR_ACCESSIBLE: usize = 8;
/// Desks that an open office is worth a room for.
const LEAST_OPEN: u32 = 3;
/// Rooms to work in that the name of a small office counts beside its toilets, at most: "two-room office with a toilet".
const MOST_COUNTED: u32 = 3;
/// Floor of the kitchen or counter of a room to eat in, as a share of its least area.
const KITCHEN_SHARE: f64 = 0.45;

/// Most single offices that a share of the people gets.
const MOST_SHARED_OUT: u32 = 60;

/// Returns the domain's room type with the most desks.
fn open_kind(domain: &Domain) -> Option<&RoomType> {
    domain.room_types.iter().max_by_key(|k| most_desks(domain, k)).filter(|k| most_desks(domain, k) > MOST_IN_TEAM)
}

/// Returns the room that a list leaves out which names those who work there and no room with desks enough for them: neither
/// by the types of its rooms nor by the desks that it gives these (`told`).
pub(crate) fn room_left_out<'a>(
    wishes: &Wishes,
    program: &Program,
    domain: &'a Domain,
    people: Option<u32>,
    told: u32,
) -> Option<&'a RoomType> {
    let heads = people.filter(|n| *n > told && is_office(program))?;
    let kind = open_kind(domain)?;
    let holds = |w: &Wish| w.count.saturating_mul(domain.room_type(&w.room_type).map_or(0, |k| most_desks(domain, k)));
    let have = wishes.wishes.iter().map(holds).fold(0, u32::saturating_add);
    (have < heads).then_some(kind)
}

/// Makes the rooms to work in of a list that does not count them as many as seat everybody: "20 people, only private offices";
/// `None` where there are none.
pub(crate) fn seat_in_listed(wishes: &mut Wishes, domain: &Domain, people: u32) -> Option<Note> {
    let desks = |w: &Wish| domain.room_type(&w.room_type).map_or(0, |k| most_desks(domain, k));
    let open = wishes.wishes.iter().position(|w| !w.exact && w.listed && desks(w) > 0)?;
    let others = wishes.wishes.iter().enumerate().filter(|(i, _)| *i != open).map(|(_, w)| w.count * desks(w));
    let left = people.saturating_sub(others.fold(0, u32::saturating_add));
    let wish = &mut wishes.wishes[open];
    wish.count = left.div_ceil(desks(wish)).clamp(wish.count, MOST_SHARED_OUT.max(wish.count));
    Some(Note::new("rooms_for_people", format!("{} x {} seat those who work there", wish.count, wish.name)))
}

/// Counts the toilets of "two-room office with a small toilet" beside its rooms, which are to work in.
pub(crate) fn beside_rooms(wishes: &mut Wishes, total: Option<u32>, domain: &Domain, program: &Program) -> Option<u32> {
    let wet = |w: &Wish| domain.room_type(&w.room_type).is_some_and(|k| k.wet && k.zone == Zone::Service);
    let rooms = total.filter(|n| *n <= MOST_COUNTED && is_office(program) && !wishes.wishes.is_empty())?;
    if !wishes.wishes.iter().all(wet) {
        return None;
    }
    let beside: u32 = wishes.wishes.iter().map(|w| w.count).sum();
    let small = |k: &&RoomType| works_in(domain, k) && k.privacy == Privacy::Private && most_desks(domain, k) > 1;
    let kind = domain.room_types.iter().filter(small).min_by_key(|k| most_desks(domain, k))?;
    let wish = Wish { count: rooms, ..Wish::one(&kind.id, &kind.label) };
    wishes.wishes.insert(0, wish);
    Some(rooms + beside)
}

/// Gives the people desks, the rooms that serve them their size, and all rooms their names.
pub(crate) fn settle<'a>(reading: &mut Reading<'a>, rooms: &mut Vec<Planned<'a>>) {
    if !is_office(reading.program) || reading.single {
        return;
    }
    call(reading, rooms);
    share_halves(reading, rooms);
    give_desks(reading, rooms);
    part_toilets(reading, rooms);
}

/// Names rooms as the prompt does.
fn call(reading: &Reading, rooms: &mut [Planned]) {
    for called in &reading.called {
        let own = |r: &&mut Planned| r.requested && r.called.is_none() && r.room_type == called.room_type;
        for room in rooms.iter_mut().filter(own).take(called.count as usize) {
            // those that are called as their type are it all the same
            room.called = Some(called.name.clone());
        }
    }
    let as_type = |r: &Planned| {
        let toilet = reading.wet.has_toilet(r.kind);
        let unknown = r.kind.id != r.room_type;
        toilet || unknown || r.called.as_ref().is_some_and(|c| c.to_lowercase() == r.kind.label.to_lowercase())
    };
    rooms.iter_mut().filter(|r| as_type(r)).for_each(|r| r.called = None);
}

/// Shares out those who work there: "half open plan, half offices".
fn share_halves<'a>(reading: &Reading<'a>, rooms: &mut Vec<Planned<'a>>) {
    let Some(people) = head_count(reading, Occupants::Staff).filter(|_| reading.halves.len() == 2) else { return };
    for (k, id) in reading.halves.iter().enumerate() {
        let Some(kind) = reading.domain.room_type(id) else { continue };
        let share = if k == 0 { people.div_ceil(2) } else { people / 2 };
        let most = most_desks(reading.domain, kind);
        if most == 0 || share == 0 {
            continue;
        }
        let wanted = share.div_ceil(most).min(MOST_SHARED_OUT) as usize;
        let mut seen = 0;
        rooms.retain(|r| {
            let own = &r.room_type == id;
            seen += usize::from(own);
            !own || seen <= wanted
        });
        let have = rooms.iter().filter(|r| &r.room_type == id).count();
        if reading.total.is_none() {
            rooms.extend((have..wanted).map(|_| Planned { requested: true, ..Planned::new(id, kind) }));
        }
        let own: Vec<usize> = (0..rooms.len()).filter(|&i| &rooms[i].room_type == id).collect();
        for (n, &i) in own.iter().enumerate() {
            let each = share / own.len() as u32 + u32::from((n as u32) < share % own.len() as u32);
            seat(reading, &mut rooms[i], each);
        }
    }
}

/// Gives a room so many desks and the floor for them.
pub(crate) fn seat(reading: &Reading, room: &mut Planned, desks: u32) {
    room.occupants = Some(desks);
    if most_desks(reading.domain, room.kind) > 2 {
        let mut own = reading.program.rooms.iter().filter(|e| e.room_type == room.room_type);
        let each = own.find_map(|e| e.area_per_occupant_m2);
        let each = each.unwrap_or_else(|| desk_area_m2(reading.domain, &room.room_type));
        room.size_for_people(each * f64::from(desks) + beside_desks(desks));
    }
}

/// Returns the desks of a room: as many as it is told to have, else the least of its type.
fn desks(domain: &Domain, room: &Planned) -> u32 {
    if !works_in(domain, room.kind) {
        return 0;
    }
    room.occupants.or_else(|| offer::desks(domain, room.kind).map(|d| d[0])).unwrap_or(0)
}

/// Gives open offices the people who have no desk elsewhere; rooms to work in that nobody asked for and nobody needs go.
fn give_desks<'a>(reading: &mut Reading<'a>, rooms: &mut Vec<Planned<'a>>) {
    let Some(people) = head_count(reading, Occupants::Staff) else { return };
    let domain = reading.domain;
    seat_teams(reading, rooms);
    let open = |r: &Planned| most_desks(domain, r.kind) > MOST_IN_TEAM;
    let one_storey = reading.storeys.levels.len() == 1;
    if reading.total.is_none() && one_storey {
        let counts = |r: &&Planned| !open(r) || r.occupants.is_some();
        let sum = |rooms: &[Planned]| rooms.iter().filter(counts).map(|r| desks(domain, r)).sum::<u32>();
        let spare = |rooms: &[Planned]| {
            let may_go = |&i: &usize| {
                let r = &rooms[i];
                !r.requested && !open(r) && desks(domain, r) > 0 && !vital::is_vital(reading, rooms, i)
            };
            (0..rooms.len()).rev().find(may_go)
        };
        // counted desks are all there are to be; an open office is worth a few of them
        let counted = reading.occupancy.staff.is_none();
        let has_open = rooms.iter().any(|r| open(r) && r.occupants.is_none());
        let most = people.saturating_sub(if has_open { LEAST_OPEN } else { 0 });
        while counted && has_open || sum(rooms) > most {
            let Some(last) = spare(rooms) else { break };
            rooms.remove(last);
        }
        if sum(rooms) >= people {
            rooms.retain(|r| r.requested || !open(r) || r.occupants.is_some());
        }
    }
    let seated: u32 = if reading.occupancy.desks.is_some_and(|n| n >= people) {
        // "60 workstations, supervisor office": the supervisor has one more
        rooms.iter().filter(|r| works_in(domain, r.kind)).filter_map(|r| r.occupants).sum()
    } else {
        rooms.iter().filter(|r| !(open(r) && r.occupants.is_none())).map(|r| desks(domain, r)).sum()
    };
    let free: Vec<usize> = (0..rooms.len()).filter(|&i| open(&rooms[i]) && rooms[i].occupants.is_none()).collect();
    let left = people.saturating_sub(seated);
    if left > 0 && !free.is_empty() {
        let n = free.len() as u32;
        for (k, &i) in free.iter().enumerate() {
            let each = left / n + u32::from((k as u32) < left % n);
            if each > 0 {
                seat(reading, &mut rooms[i], each);
            }
        }
        return;
    }
    let team = |r: &Planned| (3..=MOST_IN_TEAM).contains(&most_desks(domain, r.kind)) && r.occupants.is_none();
    let teams: Vec<usize> = (0..rooms.len()).filter(|&i| team(&rooms[i])).collect();
    let mut short = left;
    for i in teams {
        let [low, high] = offer::desks(domain, rooms[i].kind).unwrap_or([0, 0]);
        let more = short.min(high - low.min(high));
        if more > 0 {
            seat(reading, &mut rooms[i], low + more);
            short -= more;
        }
    }
    let most: u32 = rooms.iter().map(|r| r.occupants.unwrap_or(most_desks(domain, r.kind))).sum();
    if short > 0 && most < people {
        let message = format!(
            "{people} people are to work there, and the rooms asked for have {most} desks at most; an open office would have the others"
        );
        reading.conflicts.push(Note::new("too_few_desks", message));
    }
}

/// Gives the rooms for teams that the program adds as many desks as one of a usual size has: there are no more than are counted.
fn seat_teams(reading: &Reading, rooms: &mut [Planned]) {
    let team = |r: &&mut Planned| {
        let size = most_desks(reading.domain, r.kind);
        !r.requested && (3..=MOST_IN_TEAM).contains(&size) && r.occupants.is_none() && r.area_m2.is_none()
    };
    for room in rooms.iter_mut().filter(team) {
        let Some([low, high]) = offer::desks(reading.domain, room.kind) else { continue };
        let usual = room.kind.area_m2.target / desk_area_m2(reading.domain, &room.room_type);
        seat(reading, room, (usual as u32).clamp(low, high));
    }
}

/// Gives women and men a toilet each where many work, and a toilet for wheelchairs.
fn part_toilets<'a>(reading: &mut Reading<'a>, rooms: &mut Vec<Planned<'a>>) {
    let domain = reading.domain;
    let entries = || reading.program.rooms.iter().filter_map(|e| Some((e, domain.room_type(&e.room_type)?)));
    let flushes = |k: &RoomType| reading.wet.has_toilet(k);
    let Some((_, kind)) = entries().find(|(e, k)| e.area_per_person_m2.is_some() && flushes(k)) else { return };
    let wheelchairs = entries().map(|e| e.1).find(|k| k.id != kind.id && flushes(k));
    let people = places_to_work(reading, rooms);
    let own = |r: &Planned| r.room_type == kind.id;
    let fixed = reading.wishes.wishes.iter().any(|w| w.room_type == kind.id && w.exact);
    let storeys = reading.storeys.above_ground().max(1);
    let open = reading.total.is_none() && !reading.only;
    let may = |k: &RoomType| open && !reading.wishes.forbidden.contains(&k.id);
    let joins = !reading.closed || reading.may_join;
    let count = rooms.iter().filter(|r| own(r)).count();
    let mut added = None;
    // two on every storey
    let each = people as usize / storeys;
    let two = each > PEOPLE_FOR_TWO as usize && (1..2 * storeys).contains(&count);
    let in_units = rooms.iter().any(|r| r.unit.is_some());
    if two && may(kind) && !fixed && !in_units {
        rooms.extend((count..2 * storeys).map(|_| Planned::new(&kind.id, kind)));
        added = Some(kind);
    }
    if in_units && storeys > 1 && may(kind) && !fixed && part_in_units(reading, rooms, kind) {
        added = Some(kind);
    }
    let many = people > PEOPLE_FOR_ACCESSIBLE || rooms.len() > ROOMS_FOR_ACCESSIBLE;
    // as many for the ones as for the others
    if added.is_none()
        && storeys == 1
        && count > 1
        && !count.is_multiple_of(words().sexes.len().max(1))
        && may(kind)
        && !fixed
    {
        rooms.push(Planned::new(&kind.id, kind));
    }
    let missing = |k: &&RoomType| many && joins && may(k) && !rooms.iter().any(|r| r.room_type == k.id);
    if let Some(kind) = wheelchairs.filter(missing) {
        rooms.push(Planned::new(&kind.id, kind));
    }
    let toilets: Vec<usize> = (0..rooms.len()).filter(|&i| own(&rooms[i])).collect();
    if toilets.len() > 1 && toilets.len().is_multiple_of(words().sexes.len().max(1)) {
        for (k, &i) in toilets.iter().enumerate() {
            rooms[i].called = Some(whose(k, &kind.label));
        }
    }
    if let Some(kind) = added {
        let message = format!("{people} people work there; women and men have {} each", kind.label.to_lowercase());
        reading.assumptions.push(Note::new("toilets_by_people", message));
    }
}

/// Adds a second toilet to each unit with one where many work; returns true when it did.
fn part_in_units<'a>(reading: &Reading, rooms: &mut Vec<Planned<'a>>, kind: &'a RoomType) -> bool {
    let mut people: BTreeMap<&str, (u32, u32)> = BTreeMap::new();
    for (room, unit) in rooms.iter().filter_map(|r| Some((r, r.unit.as_deref()?))) {
        let of_unit = people.entry(unit).or_default();
        of_unit.0 += workplaces(reading.domain, room);
        of_unit.1 += u32::from(room.room_type == kind.id);
    }
    let many = people.iter().filter(|(_, (people, toilets))| *people > PEOPLE_FOR_TWO && *toilets == 1);
    let second = |(unit, _): (&&str, _)| Planned { unit: Some((*unit).to_owned()), ..Planned::new(&kind.id, kind) };
    let more: Vec<Planned> = many.map(second).collect();
    let any = !more.is_empty();
    rooms.extend(more);
    any
}

/// Gives rooms to wait in seats by the counters that people wait for.
fn seat_waiting(domain: &Domain, rooms: &mut [Planned]) {
    let served = |r: &&Planned| has_counters(domain, r.kind);
    let counters: u32 = rooms.iter().filter(served).filter_map(|r| r.occupants).sum();
    for (id, each) in words().waiting.iter().filter(|_| counters > 0) {
        let waits: Vec<usize> = (0..rooms.len()).filter(|&i| &rooms[i].room_type == id).collect();
        for &i in &waits {
            if rooms[i].occupants.is_some() {
                continue;
            }
            let seats = (each * f64::from(counters) / waits.len() as f64).ceil() as u32;
            let Some(Seating { area_m2: area, .. }) = seating(domain, rooms[i].kind, seats) else { continue };
            (rooms[i].occupants, rooms[i].visited) = (Some(seats), true);
            rooms[i].size_for_people(area);
        }
    }
}

/// Returns whose toilets these are.
pub(super) fn whose(k: usize, label: &str) -> String {
    let sexes = &words().sexes;
    format!("{} {}", capital(&sexes[k % sexes.len()]), label.to_lowercase())
}

/// Names the toilets of women and men by storey, where they are dealt out to several: each of them has both.
pub(crate) fn name_toilets(domain: &Domain, rooms: &mut [GraphRoom]) {
    let parted = |r: &GraphRoom| {
        let kind = domain.room_type(&r.room_type)?;
        let named = (0..words().sexes.len()).any(|k| r.name.starts_with(&whose(k, &kind.label)));
        named.then_some(&kind.label)
    };
    let all: Vec<(usize, i32, &String)> =
        rooms.iter().enumerate().filter_map(|(i, r)| Some((i, r.level, parted(r)?))).collect();
    for (n, &(i, level, label)) in all.iter().enumerate() {
        let here = all.iter().filter(|t| t.1 == level).count();
        let before = all[..n].iter().filter(|t| t.1 == level).count();
        rooms[i].name = if here > 1 { whose(before, label) } else { label.clone() };
        if here > words().sexes.len() {
            rooms[i].name = format!("{} {}", rooms[i].name, 1 + before / words().sexes.len());
        }
    }
}

/// Returns the room of the same use that seats so many in rows, with their floor: a conference of 80 sits at no one table.
fn in_rows<'a>(domain: &'a Domain, kind: &RoomType, wanted: u32) -> Option<(&'a RoomType, Seating)> {
    let meets = |k: &RoomType| k.tags.iter().any(|t| t == MEET);
    let all =
        domain.room_types.iter().chain(domain.lent.room_types()).filter(|k| meets(kind) && meets(k) && k.id != kind.id);
    let fits = |k: &'a RoomType| {
        let seats = seating(domain, k, wanted).filter(|s| s.most == u32::MAX && s.area_m2 <= k.area_m2.max)?;
        Some((k, seats))
    };
    all.filter_map(fits).min_by(|a, b| a.1.area_m2.total_cmp(&b.1.area_m2))
}

/// Gives rooms to meet, to wait and to be served in the places that the prompt says, and those to eat in seats for a share
/// of the people.
pub(super) fn seat_guests<'a>(reading: &mut Reading<'a>, rooms: &mut [Planned<'a>]) {
    let domain = reading.domain;
    for held in reading.seats.clone() {
        let free = |r: &&mut Planned| r.requested && r.occupants.is_none() && r.room_type == held.room_type;
        for room in rooms.iter_mut().filter(free).take(held.count as usize) {
            let Some(mut seats) = seating(domain, room.kind, held.beds) else { continue };
            if let Some((kind, rows)) = in_rows(domain, room.kind, held.beds).filter(|_| held.beds > seats.most) {
                room.called.get_or_insert_with(|| room.kind.label.clone());
                (room.kind, room.room_type, seats) = (kind, kind.id.clone(), rows);
            }
            let Seating { most, area_m2: area } = seats;
            room.occupants = Some(held.beds);
            room.visited = true;
            room.size_for_people(area);
            let (wanted, largest) = (held.beds, room.kind.area_m2.max);
            if area > largest && room.area_m2.is_none() && wanted <= most {
                let label = room.called.clone().unwrap_or_else(|| room.kind.label.clone());
                let message = format!(
                    "{label} for {wanted} would need {area:.0} m2, and such a room has {largest:.0} m2 at most; as many as fit were planned"
                );
                reading.conflicts.push(Note::new("too_many_seats", message));
            }
        }
    }
    if !is_office(reading.program) || reading.single {
        return;
    }
    seat_waiting(domain, rooms);
    let people = places_to_work(reading, rooms);
    for (id, share) in &words().eating {
        let eats: Vec<usize> = (0..rooms.len()).filter(|&i| &rooms[i].room_type == id).collect();
        for &i in &eats {
            if rooms[i].occupants.is_some() {
                continue;
            }
            let seats = (share * f64::from(people) / eats.len() as f64).ceil() as u32;
            let Some(Seating { area_m2: area, .. }) = seating(domain, rooms[i].kind, seats).filter(|_| seats > 0)
            else {
                continue;
            };
            let room = &mut rooms[i];
            room.occupants = Some(seats);
            room.visited = true;
            // beside the seats there is the kitchen or counter
            let kitchen = KITCHEN_SHARE * room.kind.area_m2.min;
            room.size_for_people(area + kitchen);
        }
    }
}
