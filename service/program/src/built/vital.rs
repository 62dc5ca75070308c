//! Rooms that no building is without, whose list the prompt leaves open: a home has a room to live in, to cook, to wash and
//! to sleep, a place to work at has a toilet, a ward what its program calls vital. Where a number or list of rooms leaves no
//! place for them, a conflict says so, and which change would.

use d3dgen_model::domain::{Access, Adjacency, AdjacencyRelation, Domain, Occupants, Program, RoomType, Zone};

use d3dgen_knowledge::jurisdiction::rules_here;
use d3dgen_model::offer::{Wet, sleeps};
use d3dgen_model::scene_graph::{Note, SceneGraph};

use super::occupants::places_to_work;
use crate::built::planned::Planned;
use crate::reading::Reading;
use crate::subject::programs::{MOST_IN_OFFICE, is_dwelling};
use crate::tokens::words::words;
use crate::wished::wishes::Wishes;

/// Tag of objects that are made for people in wheelchairs.
const ACCESSIBLE: &str = "accessible";
/// Beds without a bathroom of their own that share one, at most.
const BEDS_TO_A_BATHROOM: u32 = 4;
/// Rooms of a place to work at from which on it has a toilet beside that for wheelchairs.
const ROOMS_FOR_TWO_TOILETS: u32 = 8;
/// Rooms of a counted number from which on one of them is a toilet for staff and visitors.
const LEAST_FOR_A_TOILET: u32 = 10;
/// Bedrooms from which on a home has a second toilet.
const BEDROOMS_FOR_TWO_TOILETS: usize = 4;
/// Bedrooms of such a home that share a bathroom, at most.
const BEDROOMS_TO_A_BATHROOM: usize = 3;

/// Returns the kinds of rooms that the building is not without, each with what can stand for it: one toilet for another.
fn classes<'a>(reading: &Reading<'a>, rooms: &[Planned]) -> Vec<Class<'a>> {
    let of = |list: &'a [Vec<String>]| list.iter().map(|ids| ids.iter().map(String::as_str).collect());
    if is_dwelling(reading.program) {
        return of(&words().dwelling.vital).map(|ids| Class { ids, by_program: false }).collect();
    }
    let works = is_worked_at(reading.program);
    let work = works.then(|| of(&words().work_vital)).into_iter().flatten();
    let large = works
        && reading.total.is_none_or(|n| n >= ROOMS_FOR_TWO_TOILETS)
        && places_to_work(reading, rooms) > words().many_desks;
    let work = work.chain(large.then(|| of(&words().many_vital)).into_iter().flatten());
    let own = reading.program.vital.iter().map(|id| {
        // a bath with a hoist is no toilet for staff and visitors
        let flush = |id: &str| {
            let kind = reading.domain.room_type(id).filter(|k| reading.wet.has_toilet(k));
            kind.map(|k| reading.wet.is_bathroom(k))
        };
        // who comes in a wheelchair cannot use any other; all others can use that one
        let narrow = |o: &str| is_step_free(reading.domain, id) && !is_step_free(reading.domain, o);
        let alike = |o: &&str| *o != id.as_str() && flush(id).is_some() && flush(o) == flush(id) && !narrow(o);
        let others = reading.program.rooms.iter().map(|e| e.room_type.as_str()).filter(alike);
        Class { ids: std::iter::once(id.as_str()).chain(others).collect(), by_program: true }
    });
    work.map(|ids| Class { ids, by_program: false }).chain(own).collect()
}

/// Returns true for rooms that cannot do without something made for wheelchairs.
fn is_step_free(domain: &Domain, id: &str) -> bool {
    let made_for = |o: &str| domain.object(o).is_some_and(|o| o.tags.iter().any(|t| t == ACCESSIBLE));
    let required = |kind: &RoomType| {
        let lines = kind.furnishing.iter().filter(|f| f.required);
        lines.flat_map(|f| domain.objects_of(&f.item)).any(made_for)
    };
    domain.room_type(id).is_some_and(required)
}

/// Kinds of rooms of which a building has one.
struct Class<'a> {
    /// The usual one first.
    ids: Vec<&'a str>,
    /// True where the program says so, false for what every such building has.
    by_program: bool,
}

impl Class<'_> {
    fn holds(&self, room: &Planned) -> bool {
        self.ids.contains(&room.room_type.as_str())
    }
}

/// Returns true where a room of this type that was taken out of the graph was the last of a kind that no such building is
/// without, or the last with a toilet.
pub fn is_missed(graph: &SceneGraph, room_type: &str, domain: &Domain) -> bool {
    let building = graph.building_type.as_deref().and_then(|id| domain.building_type(id));
    let own = domain.programs.iter().find(|p| building.is_some_and(|b| b.program == p.id));
    let Some(program) = own.or(domain.programs.first()) else { return false };
    let of_all = if is_dwelling(program) {
        words().dwelling.vital.as_slice()
    } else if is_worked_at(program) {
        words().work_vital.as_slice()
    } else {
        &[]
    };
    let wet = Wet::of(domain);
    let flushes = |id: &str| domain.room_type(id).is_some_and(|k| wet.has_toilet(k));
    let is_left = |alike: &dyn Fn(&str) -> bool| graph.rooms.iter().any(|r| alike(&r.room_type));
    let class = |ids: &Vec<String>| ids.iter().any(|id| id == room_type) && !is_left(&|o| ids.iter().any(|id| id == o));
    of_all.iter().any(class)
        || program.vital.iter().any(|id| id == room_type) && !is_left(&|o| o == room_type)
        || flushes(room_type) && !is_left(&flushes)
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
    is_vital_of(reading, &classes(reading, rooms), rooms, i)
}

/// As [`is_vital`], with the classes of these rooms at hand.
fn is_vital_of(reading: &Reading, classes: &[Class], rooms: &[Planned], i: usize) -> bool {
    let id = &rooms[i].room_type;
    let main = reading.program.rooms.first().is_some_and(|e| &e.room_type == id);
    if main && rooms.iter().filter(|r| &r.room_type == id).count() == 1 {
        return true;
    }
    let last = |class: &Class| class.holds(&rooms[i]) && rooms.iter().filter(|r| class.holds(r)).count() == 1;
    let toilet = |r: &Planned| reading.wet.has_toilet(r.kind);
    classes.iter().any(last)
        || toilet(&rooms[i]) && rooms.iter().filter(|r| toilet(r)).count() == 1
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
    people.map_or(0, |n| bedrooms_for(n, reading.each_alone))
}

/// Returns how many bedrooms so many people need: two share one where they are a couple, everyone else has one.
pub(super) fn bedrooms_for(people: u32, each_alone: bool) -> usize {
    if each_alone { people as usize } else { people.saturating_sub(1).max(1) as usize }
}

/// Sees to it that the building has what none is without; what finds no place becomes a conflict.
pub(crate) fn complete<'a>(reading: &mut Reading<'a>, rooms: &mut Vec<Planned<'a>>) {
    if reading.single {
        return;
    }
    let mut missing: Vec<String> = Vec::new();
    let lives = is_dwelling(reading.program);
    for class in classes(reading, rooms) {
        // in a number of rooms the order of the program says what goes first, but for the toilet of a larger one
        let few = |n: u32| !flushes(reading, &class) || n < LEAST_FOR_A_TOILET;
        let listed = reading.closed && !reading.may_join && !(flushes(reading, &class) && joins_wet(reading, rooms));
        if class.by_program && (reading.total.is_some_and(few) || reading.total.is_none() && listed) {
            continue;
        }
        let present = rooms.iter().any(|r| class.holds(r));
        let unwanted = class.ids.iter().any(|id| reading.wishes.forbidden.iter().any(|f| f == id));
        let listed = |id: &&&str| reading.program.rooms.iter().any(|e| e.room_type == **id);
        let known = |id: &&&str| reading.domain.room_type(id).is_some();
        let Some(id) = class.ids.iter().find(listed).or_else(|| class.ids.iter().find(known)) else { continue };
        if present || unwanted {
            continue;
        }
        let kind = reading.domain.room_type_or_generic(id);
        // toilets that a list lacks are added when all rooms have their people
        let comes_later = !lives && reading.total.is_none() && flushes(reading, &class);
        if !put(reading, rooms, Planned::new(&kind.id, kind)) && !comes_later {
            missing.push(kind.label.to_lowercase());
        }
    }
    if lives {
        second_toilet(reading, rooms);
    } else {
        missing.extend(toilet(reading, rooms).filter(|_| reading.total.is_some()));
        missing.extend(bathrooms(reading, rooms));
    }
    support(reading, rooms);
    give_bedrooms(reading, rooms);
    if lives {
        second_bathroom(reading, rooms);
    }
    // a home's own list of rooms is its own affair
    let own_list = reading.closed && reading.total.is_none() && lives;
    if !missing.is_empty() && !own_list {
        missing.dedup();
        let (what, more) = (missing.join(", "), missing.len());
        let message = match reading.total {
            Some(n) => format!(
                "{n} rooms leave no place for what such a building needs: {what}; {} rooms would, or fewer of those that were named",
                n as usize + more
            ),
            None => format!(
                "the list of rooms has nothing of what such a building needs: {what}; the list was followed, add these to it"
            ),
        };
        reading.conflicts.push(Note::new("vital_room_missing", message));
    }
}

/// Adds to a list of rooms those that serve them: who lists the rooms of a clinic that patients are treated in takes its
/// reception for granted.
fn support<'a>(reading: &Reading<'a>, rooms: &mut Vec<Planned<'a>>) {
    let (domain, program) = (reading.domain, reading.program);
    let listed = reading.wishes.wishes.iter().any(|w| w.listed);
    let joins = listed && (!reading.closed || reading.may_join) && !reading.only;
    if !joins || reading.total.is_some() || reading.area_m2.is_some() {
        return;
    }
    let none = |id: &String| reading.wishes.forbidden.contains(id);
    for any in &program.support {
        let kind = domain.room_type(&any.room_type);
        let served = any.room_types().any(|id| none(id) || rooms.iter().any(|r| &r.room_type == id));
        if let Some(kind) = kind.filter(|_| !served) {
            put(reading, rooms, Planned::new(&kind.id, kind));
        }
    }
    let treats = |r: &&Planned| r.kind.zone == Zone::Day;
    let many = program.staff_toilet_from > 0 && rooms.iter().filter(treats).count() as u32 >= program.staff_toilet_from;
    let kind = domain.room_type(&words().dwelling.toilet).filter(|k| !none(&k.id) && many);
    let toilets = rooms.iter().filter(|r| r.kind.access != Access::Host && reading.wet.has_toilet(r.kind)).count();
    let named = reading.wishes.wishes.iter().filter_map(|w| domain.room_type(&w.room_type).zip(Some(w)));
    let named = named.filter(|(k, w)| reading.wet.has_toilet(k) && w.exact && w.count > 1).count() > 0;
    if let Some(kind) = kind.filter(|_| toilets < 2 && !named) {
        put(reading, rooms, Planned::new(&kind.id, kind));
    }
}

/// Returns true for what the program calls vital to go to the toilet in.
fn flushes(reading: &Reading, class: &Class) -> bool {
    let first = class.ids.first().and_then(|id| reading.domain.room_type(id));
    first.is_some_and(|k| reading.wet.has_toilet(k) && !reading.wet.is_bathroom(k))
}

/// Returns true where toilets and bathrooms join the rooms that the prompt lists: those who sleep in them are washed
/// whatever it says of the other rooms, unless it wants these and nothing else.
fn joins_wet(reading: &Reading, rooms: &[Planned]) -> bool {
    let sleeps = || rooms.iter().any(|r| sleeps_in(reading.domain, r));
    let joins = reading.named_first && !reading.only && !reading.program.vital.is_empty();
    joins && !is_dwelling(reading.program) && sleeps()
}

/// Gives the people of a home the bedrooms they need.
fn give_bedrooms<'a>(reading: &mut Reading<'a>, rooms: &mut Vec<Planned<'a>>) {
    let needed = bedrooms_needed(reading);
    let bedroom = reading.domain.room_type(&words().dwelling.bedroom);
    let Some(kind) = bedroom.filter(|_| bedrooms(reading, rooms) < needed) else { return };
    let fixed = reading.wishes.wishes.iter().any(|w| w.exact && w.room_type == kind.id);
    let mut full = fixed;
    while !full && bedrooms(reading, rooms) < needed {
        full = !put(reading, rooms, Planned::new(&kind.id, kind));
    }
    let beds: u32 = rooms.iter().filter_map(|r| Some(sleeps(reading.domain, r.kind)?[1])).sum();
    if full && reading.residents.is_some_and(|n| n > beds) {
        let (people, have) = (reading.residents.unwrap_or(0), bedrooms(reading, rooms));
        let message = format!(
            "{people} people are to live there, and {have} bedrooms have {beds} beds; the rooms asked for were planned, {needed} bedrooms would have enough"
        );
        reading.conflicts.push(Note::new("too_few_bedrooms", message));
    }
}

/// Gives a family in a home of so many rooms a second bathroom rather than a room to dine in.
fn second_bathroom<'a>(reading: &Reading<'a>, rooms: &mut Vec<Planned<'a>>) {
    let toilets = rooms.iter().filter(|r| reading.wet.has_toilet(r.kind)).count();
    let named = reading.wishes.wishes.iter().any(|w| {
        let kind = reading.domain.room_type(&w.room_type);
        w.exact && kind.is_some_and(|k| reading.wet.has_toilet(k))
    });
    let few = toilets == 1 && bedrooms(reading, rooms) >= BEDROOMS_FOR_TWO_TOILETS && !named;
    let kind = reading.domain.room_type(&words().dwelling.bathroom);
    let kind = kind.filter(|k| few && reading.total.is_some() && !reading.wishes.forbidden.contains(&k.id));
    if let Some(kind) = kind {
        put(reading, rooms, Planned::new(&kind.id, kind));
    }
}

/// Gives a home of many bedrooms a second toilet and bathrooms enough, where its rooms are left open.
fn second_toilet<'a>(reading: &mut Reading<'a>, rooms: &mut Vec<Planned<'a>>) {
    let toilets = rooms.iter().filter(|r| reading.wet.has_toilet(r.kind)).count();
    let kind = reading.domain.room_type(&words().dwelling.toilet);
    let named = reading.wishes.wishes.iter().any(|w| {
        let kind = reading.domain.room_type(&w.room_type);
        w.exact && w.listed && kind.is_some_and(|k| reading.wet.has_toilet(k))
    });
    let open = reading.total.is_none() && !reading.closed && !named;
    let few = bedrooms(reading, rooms) >= BEDROOMS_FOR_TWO_TOILETS && toilets < 2;
    // toilets that one enters through a bedroom are none for visitors
    let shared = |r: &Planned| reading.wet.has_toilet(r.kind) && r.kind.access != Access::Host;
    let joins = !reading.only && (!reading.closed || reading.may_join);
    let private = toilets > 0 && bedrooms(reading, rooms) >= BEDROOMS_FOR_TWO_TOILETS && !rooms.iter().any(shared);
    let kind = kind.filter(|k| !reading.wishes.forbidden.contains(&k.id));
    if let Some(kind) = kind.filter(|_| open && few || private && reading.total.is_none() && joins) {
        rooms.push(Planned::new(&kind.id, kind));
    } else if private {
        let message = "all toilets are entered through bedrooms; the rooms asked for were planned, one more for visitors would help";
        reading.assumptions.push(Note::new("no_visitor_toilet", message.into()));
    }
    let asleep = bedrooms(reading, rooms);
    let showers = |r: &Planned| r.room_type == words().dwelling.shower;
    let bathing = rooms.iter().filter(|r| reading.wet.is_bathroom(r.kind) || showers(r)).count();
    let needed = if asleep >= BEDROOMS_FOR_TWO_TOILETS { asleep.div_ceil(BEDROOMS_TO_A_BATHROOM) } else { 0 };
    let kind = reading.domain.room_type(&words().dwelling.bathroom);
    if let Some(kind) = kind.filter(|k| open && !reading.wishes.forbidden.contains(&k.id)) {
        rooms.extend((bathing..needed).map(|_| Planned::new(&kind.id, kind)));
    }
}

/// Gives a building whose program has a toilet one at least; returns what found no place.
fn toilet<'a>(reading: &Reading<'a>, rooms: &mut Vec<Planned<'a>>) -> Option<String> {
    let domain = reading.domain;
    if rooms.iter().any(|r| reading.wet.has_toilet(r.kind)) {
        return None;
    }
    let mut kinds = reading.program.rooms.iter().filter_map(|e| domain.room_type(&e.room_type));
    let kind = kinds.find(|k| reading.wet.has_toilet(k) && k.access != Access::Host)?;
    if reading.wishes.forbidden.contains(&kind.id) {
        return None;
    }
    let mut added = put(reading, rooms, Planned::new(&kind.id, kind));
    if let Some(i) = least_vital(reading, rooms).filter(|_| !added && rooms.iter().any(|r| sleeps_in(domain, r))) {
        rooms[i] = Planned::new(&kind.id, kind);
        added = true;
    }
    (!added).then(|| kind.label.to_lowercase())
}

/// Gives beds that have no bathroom of their own one that few of them share; returns what found no place.
fn bathrooms<'a>(reading: &Reading<'a>, rooms: &mut Vec<Planned<'a>>) -> Option<String> {
    let domain = reading.domain;
    let own = |k: &&RoomType| k.access == Access::Host && reading.wet.is_bathroom(k);
    let bathed: Vec<&RoomType> = domain.room_types.iter().filter(own).collect();
    let mut beds: Vec<u32> = rooms
        .iter()
        .filter(|r| bathed.iter().any(|k| k.hosts.contains(&r.room_type)) && usually_bathes(reading, &r.room_type))
        .map(|r| r.occupants.or_else(|| sleeps(domain, r.kind).map(|s| s[0])).unwrap_or(1))
        .collect();
    beds.sort_unstable();
    let served = rooms.iter().filter(|r| own(&r.kind)).count();
    let unserved: u32 = beds.iter().take(beds.len().saturating_sub(served)).sum();
    let shared = |rooms: &[Planned]| {
        rooms.iter().filter(|r| r.kind.access != Access::Host && reading.wet.is_bathroom(r.kind)).count() as u32
    };
    let needed = unserved.div_ceil(BEDS_TO_A_BATHROOM);
    let named = names_bathrooms(reading);
    let fits = |k: &&RoomType| k.access != Access::Host && k.zone == Zone::Service && reading.wet.is_bathroom(k);
    let kind = domain.room_types.iter().filter(fits).min_by(|a, b| a.area_m2.target.total_cmp(&b.area_m2.target))?;
    let listed = reading.closed && !reading.may_join && !joins_wet(reading, rooms);
    if named || reading.wishes.forbidden.contains(&kind.id) || listed {
        return None;
    }
    let plain: Vec<usize> = (0..rooms.len())
        .filter(|&i| {
            reading.wet.has_toilet(rooms[i].kind) && !reading.wet.is_bathroom(rooms[i].kind) && !rooms[i].requested
        })
        .collect();
    while shared(rooms) < needed {
        // the toilet becomes a bathroom before there is none, or where all but a few beds have their own; what comes last of
        // what such a building needs goes before that
        let toilet = plain.iter().copied().find(|&i| !reading.wet.is_bathroom(rooms[i].kind));
        let toilet = toilet.filter(|_| reading.total.is_some());
        if !(toilet.is_some() && served > 0) && put(reading, rooms, Planned::new(&kind.id, kind)) {
            continue;
        }
        match toilet.or_else(|| least_vital(reading, rooms)) {
            Some(i) => rooms[i] = Planned::new(&kind.id, kind),
            None => return (shared(rooms) == 0).then(|| kind.label.to_lowercase()),
        }
    }
    None
}

/// Returns the room that comes last of what the building needs, none of which the prompt names: patients without a toilet
/// are worse off than without it. The first of all stays.
fn least_vital(reading: &Reading, rooms: &[Planned]) -> Option<usize> {
    reading.total?;
    let of = |id: &String| {
        let last = rooms.iter().rposition(|r| &r.room_type == id)?;
        Some(last).filter(|&i| !rooms[i].requested && !reading.wet.has_toilet(rooms[i].kind))
    };
    reading.program.vital.iter().skip(1).rev().find_map(of)
}

/// Returns true where the prompt names the bathrooms; one that such a building has beside them anyway, as a bath with a
/// hoist, is none for all patients.
fn names_bathrooms(reading: &Reading) -> bool {
    let beside = |id: &str| reading.program.rooms.iter().any(|e| e.room_type == id);
    let bathes = |id: &str| reading.domain.room_type(id).is_some_and(|k| reading.wet.is_bathroom(k));
    reading.wishes.wishes.iter().any(|w| bathes(&w.room_type) && !beside(&w.room_type))
}

/// Returns true where a program of the domain gives rooms of a type a bathroom: the rooms of a ward, not the bays of an
/// intensive care unit.
fn usually_bathes(reading: &Reading, room_type: &str) -> bool {
    let bathes = |e: &d3dgen_model::domain::ProgramRoom| {
        e.with.iter().any(|w| reading.domain.room_type(w).is_some_and(|k| reading.wet.is_bathroom(k)))
    };
    reading.domain.programs.iter().flat_map(|p| &p.rooms).any(|e| e.room_type == room_type && bathes(e))
}

/// Adds what comes with rooms that the prompt names, where it leaves the rooms open: the en suite of a patient room, the room
/// to scrub beside an operating room.
pub(crate) fn accompany<'a>(reading: &Reading<'a>, rooms: &mut Vec<Planned<'a>>) {
    let domain = reading.domain;
    let listed = reading.closed && !reading.may_join;
    if reading.total.is_some() {
        return accompany_counted(reading, rooms);
    }
    if reading.single || is_dwelling(reading.program) || listed && !joins_wet(reading, rooms) {
        return;
    }
    let wet = |id: &str| domain.room_type(id).is_some_and(|k| reading.wet.is_bathroom(k));
    // a ward with two bathrooms has no others
    let bathed = names_bathrooms(reading);
    let mut kinds: Vec<String> = Vec::new();
    for room in rooms.iter().filter(|r| r.requested && !kinds.contains(&r.room_type)).collect::<Vec<_>>() {
        kinds.push(room.room_type.clone());
    }
    for id in kinds {
        for guest in guests(reading, &id) {
            // "single and double rooms, each with its own bathroom" tells the number of none of them
            let each = reading.wishes.pairs.iter().any(|p| p.belongs && p.a == guest.id);
            let unwanted = reading.wishes.forbidden.contains(&guest.id)
                || listed && !wet(&guest.id)
                || !each && reading.wishes.wishes.iter().any(|w| w.room_type == guest.id)
                || bathed && !each && wet(&guest.id);
            if unwanted {
                continue;
            }
            let own = guest.access == Access::Host;
            let hosts = rooms.iter().filter(|r| guest.hosts.contains(&r.room_type)).count();
            let have = rooms.iter().filter(|r| r.room_type == guest.id).count();
            // one room to scrub serves two operating rooms
            let shares = |r: &Adjacency| r.relation == AdjacencyRelation::Must && r.a == guest.id && r.b == id;
            let served = rooms.iter().filter(|r| r.room_type == id).count();
            let wanted = match (own, rules_here(domain, reading.country_code.as_deref()).any(shares)) {
                (true, _) => hosts,
                (false, true) => served.div_ceil(2),
                (false, false) => 1,
            };
            rooms.extend((have..wanted).map(|_| Planned::new(&guest.id, guest)));
        }
    }
}

/// Exchanges rooms of a fixed number that nobody named for those without which named ones are no use: the control room of a
/// scanner, the room to scrub beside an operating room.
fn accompany_counted<'a>(reading: &Reading<'a>, rooms: &mut Vec<Planned<'a>>) {
    let domain = reading.domain;
    let mut kinds: Vec<String> = Vec::new();
    for room in rooms.iter().filter(|r| r.requested) {
        if !kinds.contains(&room.room_type) {
            kinds.push(room.room_type.clone());
        }
    }
    for id in kinds.into_iter().filter(|_| !reading.single && !is_dwelling(reading.program)) {
        let must = |k: &RoomType| {
            let mut rules = rules_here(domain, reading.country_code.as_deref());
            rules.any(|r| r.relation == AdjacencyRelation::Must && r.a == k.id && r.b == id)
        };
        for guest in guests(reading, &id).into_iter().filter(|k| k.access != Access::Host && must(k)) {
            let there = rooms.iter().any(|r| r.room_type == guest.id);
            if !there && !reading.wishes.forbidden.contains(&guest.id) {
                // as those that the prompt names: units keep it
                put(reading, rooms, Planned { requested: true, ..Planned::new(&guest.id, guest) });
            }
        }
    }
}

/// Returns what comes with every room of a type: by the program, else by another one of the domain; rooms to sleep in have
/// nothing where those of the program have nothing.
pub(crate) fn guests<'a>(reading: &Reading<'a>, id: &str) -> Vec<&'a RoomType> {
    let (domain, program) = (reading.domain, reading.program);
    let night = |id: &str| domain.room_type(id).is_some_and(|k| k.zone == Zone::Night);
    let mut sleeping = program.rooms.iter().filter(|e| night(&e.room_type)).peekable();
    let with = |p: &'a Program| {
        let mut own = p.rooms.iter().filter(|e| e.room_type == id).peekable();
        own.peek()?;
        own.find(|e| !e.with.is_empty()).map(|e| &e.with)
    };
    let known = program.rooms.iter().any(|e| e.room_type == id);
    let bare = night(id) && !known && sleeping.peek().is_some() && sleeping.all(|e| e.with.is_empty());
    let found = match (known, bare) {
        (true, _) => with(program),
        (false, true) => None,
        (false, false) => domain.programs.iter().find_map(with),
    };
    let mut out: Vec<&RoomType> = found.into_iter().flatten().filter_map(|w| domain.room_type(w)).collect();
    // rooms of a kind that no program has live like those that it has
    if out.is_empty() && !known && !bare && night(id) {
        let usual = program.rooms.iter().filter(|e| night(&e.room_type)).flat_map(|e| &e.with);
        out.extend(usual.filter_map(|w| domain.room_type(w)).find(|k| k.hosts.iter().any(|h| h == id)));
    }
    // what one enters a room through comes before it
    out.retain(|k| !domain.room_type_or_generic(id).hosts.contains(&k.id));
    out
}

/// Adds a room, where the number of rooms is fixed in place of one that can be spared; returns false where none can.
pub(super) fn put<'a>(reading: &Reading<'a>, rooms: &mut Vec<Planned<'a>>, room: Planned<'a>) -> bool {
    let joins_list = if is_dwelling(reading.program) {
        reading.may_join
    } else {
        reading.named_first && !reading.only && is_worked_at(reading.program)
            || reading.may_join && !reading.program.vital.is_empty()
    };
    let wet = reading.wet.has_toilet(room.kind);
    match (reading.total, reading.closed) {
        (None, true) if !(joins_list || wet && joins_wet(reading, rooms)) => false,
        (None, _) => {
            rooms.push(room);
            true
        }
        (Some(_), _) => {
            // what one enters another room through stays, as that does
            let through = |i: usize| {
                let larger =
                    |r: &Planned| r.kind.access == Access::Host && r.kind.area_m2.target > rooms[i].kind.area_m2.target;
                rooms.iter().any(|r| larger(r) && r.kind.hosts.contains(&rooms[i].room_type))
            };
            let stays = |i: usize| rooms[i].kind.access == Access::Host || through(i);
            let classes = classes(reading, rooms);
            let spares = (0..rooms.len()).rev().filter(|&i| {
                let alike = rooms[i].room_type == room.room_type;
                !rooms[i].requested && !stays(i) && !alike && !is_vital_of(reading, &classes, rooms, i)
            });
            let hangs_on = |guest: &Planned, i: usize| {
                guest.kind.access == Access::Host && guest.kind.hosts.contains(&rooms[i].room_type)
            };
            let lives = is_dwelling(reading.program);
            // a bedroom goes after all others, and rather its bathroom than the bedroom without it
            let entered = |i: usize| rooms.iter().any(|r| hangs_on(r, i));
            let spare = spares.min_by_key(|&i| !lives && entered(i)).map(|i| {
                let hosts = rooms.iter().filter(|r| r.room_type == rooms[i].room_type).count();
                let guests = rooms.iter().filter(|r| hangs_on(r, i)).count();
                let guest = rooms.iter().rposition(|r| !r.requested && hangs_on(r, i));
                guest.filter(|_| guests >= hosts).unwrap_or(i)
            });
            if let Some(i) = spare {
                rooms[i] = room;
            }
            spare.is_some()
        }
    }
}

/// Rules out every room of a kind that the prompt wants none of, not only the type that its word means: an office without
/// toilets has none for wheelchairs either, a ward without bathrooms no en suites.
pub(crate) fn rule_out(domain: &Domain, wet: &Wet, wishes: &mut Wishes) {
    let none = |id: &String| wishes.forbidden.contains(id);
    let (toilets, bathrooms) = (words().dwelling.toilets.iter().any(none), none(&words().dwelling.bathroom));
    let alike = |k: &&RoomType| {
        let bath = wet.is_bathroom(k);
        wet.has_toilet(k) && (toilets && !bath || bathrooms && bath && k.access == Access::Host)
    };
    let wished = |id: &String| wishes.wishes.iter().any(|w| &w.room_type == id);
    let more: Vec<String> = domain.room_types.iter().filter(alike).map(|k| k.id.clone()).collect();
    let more: Vec<String> = more.into_iter().filter(|id| !wished(id) && !none(id)).collect();
    wishes.forbidden.extend(more);
}
