//! Names, sizes and wished objects of the rooms.

use std::collections::BTreeMap;

use d3dgen_model::domain::{
    AreaRange, Domain, GENERIC_ROOM_TYPE, ObjectType, Privacy, Relation, RoomType, Shape, Zone,
};
use d3dgen_model::measures::MOST_ELONGATED;
use d3dgen_model::offer;
use d3dgen_model::offer::{MOST_IN_TEAM, furniture};
use d3dgen_model::scene_graph::{GraphRoom, Note};
use d3dgen_model::style::SpaceStyle;

use crate::built::growth::circulation_share;
use crate::built::planned::Planned;
use crate::named::objects::Thing;
use crate::reading::Reading;
use crate::subject::programs::{is_dwelling, is_office};
use crate::tokens::text::capital;
use crate::tokens::words::words;

/// Most objects wished for in one room.
pub(crate) const MOST_WISHES: usize = 15;
/// Share of the usual area per head that a building short of area leaves.
const CROWDED: f64 = 0.6;
/// Most area of a room that serves so many people, as a factor on what they need.
const ROOMY: f64 = 1.5;
/// Most area of a room with floor to spare, as factors: on what the people need that it is told to be for, and on its usual one. What
/// the building is there for (the floor of a shop, a hall of racks) has no such bound.
const HALF_EMPTY: f64 = 2.0;
const VAST: f64 = 3.0;
/// Largest area of a room over its usual one from which on it takes any number of people.
const OPEN_ENDED: f64 = 8.0;
/// What rooms need beyond their least area before a home is too small for its table, as a factor.
const TIGHT: f64 = 1.04;
/// Most that rooms grow in a home with floor to spare, as factors: those that serve the others, and those to sleep in.
pub(crate) const MOST_TO_SERVE: f64 = 1.35;
const MOST_TO_SLEEP: f64 = 1.75;
/// Most that usual areas are scaled towards the one asked for.
const MOST_SCALE: f64 = 100.0;
/// Share of their usual area that rooms of a compact building have.
const COMPACT: f64 = 0.8;
/// The same of a generous building.
const GENEROUS: f64 = 1.25;
/// Most of the area of a living room that a bedroom is given by the program.
const SLEPT_IN: f64 = 0.9;
/// Largest share of its usual area that a bedroom has.
const MOST_ASLEEP: f64 = 1.6;
/// Share by which the areas may miss the one asked for before that is worth a note.
const AREA_TOLERANCE: f64 = 0.1;

/// Area of a room planned by itself over the largest one of its type up to which it is as asked for: beyond, it is another room.
const MOST_ALONE: f64 = 3.0;

/// Tag of what those sleep on who stay with a patient.
const COMPANION: &str = "companion";

/// Returns the rooms as the graph states them, in the order they are planned in.
pub(crate) fn describe(reading: &mut Reading, planned: &[Planned]) -> Vec<GraphRoom> {
    let areas = target_areas(reading, planned);
    let mut named = named_objects(reading, planned);
    add_companions(reading, planned, &mut named);
    let mut total: BTreeMap<&str, u32> = BTreeMap::new();
    for room in planned {
        *total.entry(&room.room_type).or_default() += 1;
    }
    state_unknown(reading, planned);
    state_lent(reading, planned);
    let lives = is_dwelling(reading.program);
    let mut seen: BTreeMap<&str, u32> = BTreeMap::new();
    let mut alike: BTreeMap<String, [u32; 2]> = BTreeMap::new();
    planned.iter().for_each(|room| alike.entry(label(room)).or_default()[0] += 1);
    let mut rooms = Vec::new();
    for (i, room) in planned.iter().enumerate() {
        let number = seen.entry(&room.room_type).or_default();
        *number += 1;
        let label = label(room);
        // rooms with a name of their own are counted by that
        let [same, count] = alike.entry(label.clone()).or_default();
        *count += 1;
        let name = match room.called {
            Some(_) if *same > 1 => format!("{label} {count}"),
            None if total[room.room_type.as_str()] > 1 && *same > 1 => format!("{label} {count}"),
            _ => label,
        };
        rooms.push(GraphRoom {
            id: format!("{}_{number}", room.room_type),
            room_type: room.room_type.clone(),
            name,
            description: match &room.name {
                Some(words) => format!("`{words}` of the prompt. {}", room.kind.description),
                None => room.kind.description.clone(),
            },
            target_area_m2: areas[i],
            area_range_m2: kept_range(reading, room, areas[i]).unwrap_or_else(|| {
                let wide = !lives || reading.area_m2.is_some();
                area_range(room, range_of(room, reading.single), areas[i], wide)
            }),
            wished_assets: wished_assets(reading.domain, room.kind, named.get(&i).map_or(&[], Vec::as_slice)),
            sides_m: reading.single.then(|| kept_sides(room)).flatten(),
            occupants: room.occupants.filter(|n| *n > 0),
            circulation: false,
            requested: room.requested,
            entrance: false,
            locked: false,
            level: 0,
            unit: room.unit.clone(),
            garden_door: reading.wishes.garden.contains(&room.room_type),
        });
    }
    rooms
}

/// States as what rooms are planned that no domain knows.
fn state_unknown(reading: &mut Reading, planned: &[Planned]) {
    let mut stated: Vec<&str> = Vec::new();
    for room in planned {
        let unknown = room.kind.id == GENERIC_ROOM_TYPE && room.room_type != GENERIC_ROOM_TYPE;
        if !unknown || stated.contains(&room.room_type.as_str()) {
            continue;
        }
        stated.push(&room.room_type);
        let words = room.name.clone().unwrap_or_else(|| room.room_type.replace('_', " "));
        let message = format!(
            "`{words}` is no room that is known; it has its name, and a table, chairs and cupboards for the rest"
        );
        reading.assumptions.push(Note::new("unknown_room", message));
    }
}

/// States of which kind of building the rooms are furnished that this kind has none of.
fn state_lent(reading: &mut Reading, planned: &[Planned]) {
    let mut stated: Vec<&str> = Vec::new();
    for room in planned {
        let Some(lender) = reading.domain.lender_of(&room.kind.id) else { continue };
        if stated.contains(&room.room_type.as_str()) {
            continue;
        }
        stated.push(&room.room_type);
        let (words, own) = (label(room).to_lowercase(), &reading.domain.id);
        let message = format!("{own} has no room called `{words}`; it was furnished and sized as that of {lender}");
        reading.assumptions.push(Note::new("room_borrowed", message));
    }
}

/// Returns the corridor, hall or lobby that connects the rooms.
pub(crate) fn circulation(reading: &Reading) -> GraphRoom {
    let kind = reading.domain.room_type_or_generic(&reading.domain.circulation.room_type);
    GraphRoom {
        id: format!("{}_1", kind.id),
        room_type: kind.id.clone(),
        name: kind.label.clone(),
        description: kind.description.clone(),
        target_area_m2: kind.area_m2.target,
        area_range_m2: [kind.area_m2.min, kind.area_m2.max],
        wished_assets: wished_assets(reading.domain, kind, &[]),
        sides_m: None,
        occupants: None,
        circulation: true,
        requested: reading.wishes.wishes.iter().any(|w| w.room_type == kind.id),
        entrance: false,
        locked: false,
        level: 0,
        unit: None,
        garden_door: false,
    }
}

/// Returns the name on the plan: the domain's label, or the prompt's own word for a room the domain does not know.
fn label(room: &Planned) -> String {
    if let Some(called) = &room.called {
        return called.clone();
    }
    if room.kind.id == room.room_type && room.room_type != GENERIC_ROOM_TYPE {
        return room.kind.label.clone();
    }
    // names in letters that no id has are as the prompt has them
    let own = room.name.as_ref().filter(|words| !words.is_ascii());
    own.map_or_else(|| capital(&room.room_type.replace('_', " ")), |words| capital(words))
}

/// Returns the sides that a room by itself is to have, where that is a room to be in.
fn kept_sides(room: &Planned) -> Option<[f64; 2]> {
    let [a, b] = room.sides_m?;
    let range = range_of(room, true);
    let stands = (range.min..=range.max).contains(&(a * b)) && a.max(b) <= MOST_ELONGATED * a.min(b);
    stands.then_some([a, b])
}

/// Returns the areas that a room can have: those of its type, and more where it is planned by itself and that is asked for.
fn range_of(room: &Planned, alone: bool) -> AreaRange {
    let range = room.kind.area_m2;
    let asked = room.area_m2.filter(|a| alone && *a <= MOST_ALONE * range.max);
    AreaRange { max: asked.map_or(range.max, |a| range.max.max((1.0 + AREA_TOLERANCE) * a)), ..range }
}

/// Returns the areas of offices for one and of stores in a building of a given area, whose floor to spare goes elsewhere.
fn kept_range(reading: &Reading, room: &Planned, target: f64) -> Option<[f64; 2]> {
    let small = room.kind.privacy == Privacy::Private || room.kind.zone == Zone::Service;
    let open = room.area_m2.is_none() && room.people_area_m2.is_none() && room.size.is_none();
    let kept = small && open && is_office(reading.program) && reading.area_m2.is_some();
    let range = room.kind.area_m2;
    let most = tenth((ROOMY * range.target).max(target * (1.0 + AREA_TOLERANCE)));
    kept.then(|| [range.min, range.max.min(most).max(target)])
}

/// Returns the areas allowed, net m^2: those of the type; close to the one the prompt gives, enough for the people in it.
///
/// Bedrooms do not take what a small plan has left over (`wide` says that rooms may).
fn area_range(room: &Planned, range: AreaRange, target: f64, wide: bool) -> [f64; 2] {
    let about = |low: f64, high: f64| {
        [range.min.max(tenth(target * low)).min(target), range.max.min(tenth(target * high)).max(target)]
    };
    match (room.area_m2, room.people_area_m2.or(room.size)) {
        (Some(_), _) => about(1.0 - AREA_TOLERANCE, 1.0 + AREA_TOLERANCE),
        // where the rooms share an area they give and take
        (None, Some(_)) if room.size.is_some() && wide => [range.min, range.max],
        (None, Some(_)) => about(1.0 - AREA_TOLERANCE, 1.0 + 3.0 * AREA_TOLERANCE),
        (None, None) if !wide && room.kind.zone == Zone::Night => {
            [range.min, range.max.min(tenth(target * MOST_ASLEEP))]
        }
        (None, None) => [range.min, range.max],
    }
}

/// Returns target areas, net m^2: the usual ones, scaled together towards the area asked for.
fn target_areas(reading: &mut Reading, planned: &[Planned]) -> Vec<f64> {
    let mut areas = Vec::with_capacity(planned.len());
    let scale = space_scale(reading);
    for room in planned {
        let range = range_of(room, reading.single);
        let usual = room.people_area_m2.unwrap_or(range.target);
        let wished = room.area_m2.unwrap_or(usual);
        let styled = match (room.area_m2, room.people_area_m2, room.proposed_area_m2) {
            (Some(asked), _, _) => asked,
            (None, None, Some(proposed)) => proposed,
            _ => usual * room.size.unwrap_or(scale),
        };
        let area = styled.clamp(range.min, range.max);
        if (wished.clamp(range.min, range.max) - wished).abs() > 0.05 {
            let message = format!(
                "{} of {wished:.1} m2 is outside the range {}-{} m2 of its type; {area:.1} m2 was planned",
                label(room),
                range.min,
                range.max
            );
            reading.conflicts.push(Note::new("area_out_of_range", message));
        }
        areas.push(area);
    }
    let Some(total) = reading.area_m2 else { return areas.into_iter().map(tenth).collect() };
    let for_rooms = 1.0 - circulation_share(reading, planned);
    let budget = total * for_rooms;
    // floor to spare goes to rooms that take any number of people, and only without them to all the others
    let takes_all = |room: &Planned| {
        room.kind.zone != Zone::Service && room.kind.area_m2.max >= OPEN_ENDED * room.kind.area_m2.target
    };
    let works = is_office(reading.program);
    let lives = is_dwelling(reading.program);
    let main: Vec<bool> = planned.iter().map(|room| lives || is_main(reading, planned, room)).collect();
    // people eat together before bedrooms are as large as usual
    let seated = |room: &Planned| room.table_area_m2.filter(|_| room.area_m2.is_none());
    let least: f64 = planned.iter().map(|r| r.area_m2.or(seated(r)).unwrap_or(0.0).max(r.kind.area_m2.min)).sum();
    let keeps_table = TIGHT * least <= budget;
    let at = |scale: f64, roomy: usize| -> Vec<f64> {
        let sized = planned.iter().zip(&areas).zip(&main).map(|((room, area), is_main)| {
            let mut range = room.kind.area_m2;
            if reading.accessible {
                // rooms have the floor for a wheelchair whatever is left for the others
                range.min = range.min.max(room.kind.step_free_m2.min(range.max));
            }
            if let Some(table) = seated(room).filter(|_| keeps_table) {
                range.min = range.min.max(table);
            }
            let serves = room.kind.zone == Zone::Service;
            let small = serves || room.kind.privacy == Privacy::Private;
            let kept = !takes_all(room) && (roomy < 1 || roomy < 2 && works && small);
            match (room.area_m2, room.people_area_m2) {
                (Some(_), _) => *area,
                (_, Some(people)) => {
                    // what serves so many people is no larger in a building with floor to spare, nor is a table for them
                    let at_table = room.visited && room.kind.zone != Zone::Public;
                    let most = if serves || kept || at_table {
                        range.max.min(ROOMY * people.max(range.min))
                    } else if *is_main && room.occupants.is_none() {
                        range.max
                    } else {
                        range.max.min(HALF_EMPTY * people.max(range.min))
                    };
                    // who is told to have a desk there has it
                    let desks = works && room.occupants.is_some_and(|n| n <= MOST_IN_TEAM) && !room.visited;
                    let least = if desks { 1.0 } else { CROWDED } * people;
                    (area * scale).clamp(range.min.max(least).min(most), most.max(range.min))
                }
                _ => {
                    // in a large home one lives in larger rooms; what serves them does not grow with it
                    let most = match lives {
                        true => most_of(room.kind.zone),
                        false if *is_main => MOST_SCALE,
                        false => VAST,
                    };
                    let most = if kept { most.min(ROOMY) } else { most };
                    (area * scale.min(most)).clamp(range.min, range.max)
                }
            }
        });
        sized.collect()
    };
    let sum_at = |scale: f64, roomy: usize| at(scale, roomy).iter().sum::<f64>();
    // rooms for one and stores come last
    let roomy = (0..2).find(|&roomy| sum_at(MOST_SCALE, roomy) >= budget).unwrap_or(2);
    if roomy > 0 {
        let needed = sum_at(1.0, 0) / for_rooms;
        let message = format!(
            "{total:.0} m2 are more than these rooms need (about {needed:.0} m2); they were planned larger than usual"
        );
        reading.assumptions.push(Note::new("more_area_than_needed", message));
    }
    let (mut low, mut high) = (0.01, MOST_SCALE);
    for _ in 0..48 {
        let middle = 0.5 * (low + high);
        if sum_at(middle, roomy) < budget { low = middle } else { high = middle }
    }
    let mut scaled = at(high, roomy);
    if lives {
        live_in_the_largest(planned, &mut scaled);
    }
    let sum: f64 = scaled.iter().sum();
    if (sum - budget).abs() > AREA_TOLERANCE * budget {
        let reachable = sum / for_rooms;
        let change = if sum > budget {
            format!("{reachable:.0} m2 would do, or {} rooms fewer", rooms_too_many(planned, budget))
        } else {
            format!("at most {reachable:.0} m2, or more rooms, would do")
        };
        let message = format!(
            "{total:.0} m2 were asked for; the rooms can have about {reachable:.0} m2 within the ranges of their types; {change}"
        );
        reading.conflicts.push(Note::new("area_not_reachable", message));
    }
    scaled.into_iter().map(tenth).collect()
}

/// Returns true for the room that a building is there for: a hall that others open to, the first room of its program, or where none of
/// these is there the largest.
fn is_main(reading: &Reading, planned: &[Planned], room: &Planned) -> bool {
    let hubs = &reading.domain.circulation.hub_room_types;
    let first = reading.program.rooms.first().map(|entry| &entry.room_type);
    let named = |id: &String| hubs.contains(id) || first == Some(id);
    if planned.iter().any(|r| named(&r.room_type)) {
        return named(&room.room_type);
    }
    let most = planned.iter().map(|r| r.kind.area_m2.max).fold(0.0, f64::max);
    room.kind.area_m2.max >= most
}

/// Lets the living room of a home be larger than its bedrooms: it gets what they have more of it, as far as both may change.
fn live_in_the_largest(planned: &[Planned], areas: &mut [f64]) {
    let of = |zone: Zone| (0..planned.len()).filter(move |&i| planned[i].kind.zone == zone);
    let open = |i: &usize| planned[*i].area_m2.is_none();
    let Some(day) = of(Zone::Day).max_by(|&a, &b| areas[a].total_cmp(&areas[b])).filter(open) else { return };
    for bed in of(Zone::Night).filter(open) {
        let most = (SLEPT_IN * areas[day]).max(planned[bed].kind.area_m2.min);
        let spare = (areas[bed] - most).max(0.0).min((planned[day].kind.area_m2.max - areas[day]).max(0.0));
        areas[bed] -= spare;
        areas[day] += spare;
    }
}

/// Returns how much larger than usual rooms of a zone become in a home with floor to spare, as a factor.
fn most_of(zone: Zone) -> f64 {
    match zone {
        Zone::Service | Zone::Circulation => MOST_TO_SERVE,
        Zone::Night => MOST_TO_SLEEP,
        _ => MOST_SCALE,
    }
}

/// Returns how many rooms must go, the largest first, before the others fit an area, net m^2.
fn rooms_too_many(planned: &[Planned], area: f64) -> usize {
    let mut least: Vec<f64> = planned.iter().map(|r| r.area_m2.unwrap_or(r.kind.area_m2.min)).collect();
    least.sort_by(f64::total_cmp);
    let fitting = least.iter().scan(0.0, |sum, a| {
        *sum += a;
        Some(*sum)
    });
    planned.len() - fitting.take_while(|sum| *sum <= area).count()
}

/// Returns the factor that the style asks for; the area that the prompt gives wins over the style.
fn space_scale(reading: &mut Reading) -> f64 {
    let (word, scale) = match reading.style.space {
        None => return 1.0,
        Some(SpaceStyle::Compact) => ("compact", COMPACT),
        Some(SpaceStyle::Generous) => ("generous", GENEROUS),
    };
    if let Some(area) = reading.area_m2 {
        let message = format!("{area:.0} m2 are asked for; rooms share them, so that {word} changes nothing");
        reading.assumptions.push(Note::new("style_without_effect", message));
        return 1.0;
    }
    let percent = 100.0 * scale;
    let message = format!("{word}: rooms have {percent:.0} % of their usual area, within the ranges of their types");
    reading.assumptions.push(Note::new("style_space", message));
    scale
}

/// Rounds to 0.1 m^2; ranges of the domains have no finer steps that could be left.
pub(crate) fn tenth(area: f64) -> f64 {
    (area * 10.0).round() / 10.0
}

/// Returns the objects that the prompt names, by index of the room they belong in.
fn named_objects(reading: &mut Reading, planned: &[Planned]) -> BTreeMap<usize, Vec<String>> {
    let mut out: BTreeMap<usize, Vec<String>> = BTreeMap::new();
    // who shares a home works in the own room
    let shared = reading.building_type.as_ref().is_some_and(|b| words().dwelling.shared.contains(b));
    if shared && reading.domain.object(&words().dwelling.own_desk).is_some() {
        let own = (0..planned.len()).filter(|&i| planned[i].room_type == words().dwelling.bedroom);
        own.for_each(|i| out.entry(i).or_default().push(words().dwelling.own_desk.clone()));
    }
    beds_of_one(reading, planned).into_iter().for_each(|i| {
        out.entry(i).or_default().push(words().dwelling.own_bed.clone());
    });
    for Thing { object, room_type, each } in std::mem::take(&mut reading.objects) {
        if each {
            let all = (0..planned.len()).filter(|&i| room_type.as_deref() == Some(&planned[i].room_type));
            for i in all {
                let own = out.entry(i).or_default();
                if !own.contains(&object) {
                    own.push(object.clone());
                }
            }
            continue;
        }
        let usual = |r: &Planned| furniture(reading.domain, r.kind).any(|o| o == object);
        let with = planned.iter().position(|r| room_type.as_deref() == Some(&r.room_type));
        // "two bedrooms and a dining table": nobody eats there where another room is for that
        let eats = |r: &Planned| sets_table(reading.domain, r.kind, &object, planned);
        let with = with.filter(|&i| usual(&planned[i]) || !planned.iter().any(eats));
        // a sofa of another size
        let alike = |r: &Planned| {
            let shape = reading.domain.object(&object).map(|o| o.shape).filter(|s| *s == Shape::Sofa);
            let of = |id: &&str| shape.is_some() && reading.domain.object(id).map(|o| o.shape) == shape;
            furniture(reading.domain, r.kind).find(of).map(str::to_owned)
        };
        // what nobody furnishes a room with stands there all the same, but the sofa of a studio is its small one
        let other = |i: usize| if usual(&planned[i]) { None } else { alike(&planned[i]) };
        match with.or_else(|| planned.iter().position(eats)).or_else(|| planned.iter().position(usual)) {
            Some(i) => {
                let own = other(i);
                out.entry(i).or_default().push(own.unwrap_or(object));
            }
            None if planned.iter().any(|r| alike(r).is_some()) => {
                let found = planned.iter().enumerate().find_map(|(i, r)| Some((i, alike(r)?)));
                found.into_iter().for_each(|(i, other)| out.entry(i).or_default().push(other));
            }
            None => {
                let message = format!("no room was found for the object {object}; it was left out");
                reading.conflicts.push(Note::new("object_without_room", message));
            }
        }
    }
    out
}

/// Returns the bedrooms in which one person sleeps: of those who share a home all, of a family those of the children.
fn beds_of_one(reading: &Reading, planned: &[Planned]) -> Vec<usize> {
    let d = &words().dwelling;
    let rooms: Vec<usize> = (0..planned.len()).filter(|&i| planned[i].room_type == d.bedroom).collect();
    if reading.domain.object(&d.own_bed).is_none() {
        return Vec::new();
    }
    let shared = reading.building_type.as_ref().is_some_and(|b| d.shared.contains(b));
    if shared {
        // where more live than there are rooms, couples do
        let alone = reading.residents.is_none_or(|n| n as usize <= rooms.len());
        return if alone { rooms } else { Vec::new() };
    }
    let others = planned.iter().filter(|r| r.kind.zone == Zone::Night && r.room_type != d.bedroom);
    let others = others.filter(|r| offer::sleeps(reading.domain, r.kind).is_some_and(|[least, _]| least == 1)).count();
    let children = (reading.children as usize).saturating_sub(others);
    // parents first; guests may sleep in what is left
    let from = rooms.len().checked_sub(children).filter(|left| *left > 0 && children > 0);
    from.map_or(Vec::new(), |_| rooms[1..=children].to_vec())
}

/// Returns true for a room in which people sit around this table, in a home of these rooms.
fn sets_table(domain: &Domain, kind: &RoomType, object: &str, planned: &[Planned]) -> bool {
    kind.furnishing.iter().any(|line| {
        domain
            .group(&line.item)
            .is_some_and(|g| g.anchor == object && g.members.iter().any(|m| m.relation == Relation::Around))
            && !planned.iter().any(|r| line.unless_rooms.contains(&r.room_type))
    })
}

/// Wishes for a bed for those who stay with a patient in every room that patients have to themselves.
fn add_companions(reading: &mut Reading, planned: &[Planned], named: &mut BTreeMap<usize, Vec<String>>) {
    let is_for = |o: &&ObjectType| o.tags.iter().any(|t| t == COMPANION);
    let Some(object) = reading.domain.objects.iter().find(is_for).filter(|_| reading.stays) else { return };
    let patients = |r: &Planned| r.kind.privacy == Privacy::Private && offer::sleeps(reading.domain, r.kind).is_some();
    let rooms: Vec<usize> = (0..planned.len()).filter(|&i| patients(&planned[i])).collect();
    if rooms.is_empty() {
        let message = "no room was found for those who stay overnight with patients; they were left out".into();
        return reading.conflicts.push(Note::new("object_without_room", message));
    }
    rooms.into_iter().for_each(|i| named.entry(i).or_default().push(object.id.clone()));
    let message = format!("those who stay overnight with patients have a {} in each room", object.label.to_lowercase());
    reading.assumptions.push(Note::new("companions", message));
}

/// Returns the objects wished for in a room, most important first: those named, then those of its type.
pub fn wished_assets(domain: &Domain, kind: &RoomType, named: &[String]) -> Vec<String> {
    // what is named several times is to be there so often
    let mut out: Vec<String> = named.to_vec();
    for object in furniture(domain, kind) {
        if out.len() < MOST_WISHES && !out.iter().any(|o| o == object) {
            out.push(object.to_owned());
        }
    }
    out
}
