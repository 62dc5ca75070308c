//! Places for people, vehicles and animals: counted by what stands in the rooms that are to have them.

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::brief::{Ask, AskedCount, Bound, CapacityAsk, PlaceKind};
use d3dgen_model::domain::{Domain, ObjectType, RoomType, Shape};
use d3dgen_model::measures::sleepers_in;
use d3dgen_model::offer::{places, seating, seats_across, sleeps, works_in};
use d3dgen_model::report::Fate;
use d3dgen_model::scene_graph::GraphRoom;

use super::{Asked, Finding};

/// Width of a place on a sofa, m.
const SOFA_SEAT_M: f64 = 0.65;

/// Returns what people call such places.
fn label(kind: PlaceKind) -> &'static str {
    match kind {
        PlaceKind::Seats => "seats",
        PlaceKind::Desks => "desks",
        PlaceKind::Beds => "beds",
        PlaceKind::Cars => "places for cars",
        PlaceKind::Bicycles => "places for bicycles",
        PlaceKind::Docks => "loading docks",
        PlaceKind::Animals => "places for animals",
        PlaceKind::Counters => "counters",
        PlaceKind::Treatment => "places to be treated at",
        PlaceKind::Pallets => "places for pallets",
    }
}

/// How many more seats than asked for are the number asked for all the same, as a share of it, and at least one: tables have more
/// seats than one.
const SEATS_OVER: f64 = 0.1;

impl<'a> Asked<'a> {
    pub(super) fn capacity(&self, ask: &Ask, asked: &CapacityAsk) -> Finding {
        let Some(room) = &asked.room else { return self.places_of_building(ask, asked) };
        let rooms = self.rooms_meant(ask, room);
        if rooms.is_empty() {
            return Finding::of(Fate::LeftOut, format!("there is no room `{}`", room.name));
        }
        if !asked.each_room && asked.of_rooms.is_none() {
            return self.places(asked, &rooms).unwrap_or_else(|| not_counted(asked.of));
        }
        let wanted = asked.of_rooms.unwrap_or(rooms.len() as u32) as usize;
        let mut single: Vec<(&GraphRoom, Finding)> =
            rooms.iter().filter_map(|r| Some((*r, self.places(asked, &[r])?))).collect();
        single.sort_by_key(|(_, found)| found.fate);
        let so: Vec<&GraphRoom> =
            single.iter().filter(|(_, found)| found.fate == Fate::Honored).map(|(r, _)| *r).collect();
        let Some((worst, found)) = single.get(wanted.min(single.len()).saturating_sub(1)) else {
            return not_counted(asked.of);
        };
        let have = found.measured.unwrap_or(0.0);
        if so.len() >= wanted {
            let ids = so.iter().map(|r| r.id.clone()).collect();
            return Finding { asked: found.asked, measured: found.measured, ..Finding::honored(ids) };
        }
        let what = label(asked.of);
        let reason = format!("{} of {wanted} rooms have {} {what}; {} has {have}", so.len(), asked.count, worst.name);
        let fate = if so.is_empty() && have == 0.0 { Fate::LeftOut } else { Fate::Substituted };
        let ids = single.iter().map(|(r, _)| r.id.clone()).collect();
        Finding { ids, asked: found.asked, measured: found.measured, ..Finding::of(fate, reason) }
    }

    /// Answers for places of which no room is said: those of rooms that the building has for them, and that no other wish names; else
    /// all of them.
    fn places_of_building(&self, ask: &Ask, asked: &CapacityAsk) -> Finding {
        let level = self.level_of(ask);
        let rooms = self.world.scene_graph.rooms.iter().filter(|r| level.is_none_or(|l| r.level == l));
        let all: Vec<&GraphRoom> = rooms.collect();
        let free: Vec<&GraphRoom> = all.iter().copied().filter(|r| !self.claims.is_taken(&r.id)).collect();
        let found = [self.places(asked, &free), self.places(asked, &all)].into_iter().flatten();
        let miss = |found: &Finding| (found.measured.unwrap_or(0.0) - f64::from(asked.count.n)).abs();
        let nearest = found.min_by(|a, b| a.fate.cmp(&b.fate).then(miss(a).total_cmp(&miss(b))));
        nearest.unwrap_or_else(|| not_counted(asked.of))
    }

    /// Counts the places in rooms: the number is kept when one of the ways to count them there gives it; else the first of them is told.
    /// `None` for kinds of places that nothing here counts.
    fn places(&self, asked: &CapacityAsk, rooms: &[&GraphRoom]) -> Option<Finding> {
        let readings = self.readings(asked.of, rooms)?;
        let is_seats = asked.of == PlaceKind::Seats;
        let allows = |h: &Held| asked.count.allows(h.places) || is_seats && is_one_thing_more(asked.count, h);
        let kept = readings.iter().position(allows);
        let held = readings.into_iter().nth(kept.unwrap_or(0)).unwrap_or_default();
        let n = held.places;
        let (fate, what) = (if n == 0 { Fate::LeftOut } else { Fate::Substituted }, label(asked.of));
        let found = match (kept, n) {
            (Some(_), _) => Finding::honored(held.ids),
            (None, 0) => Finding::of(fate, format!("no {what} there")),
            (None, n) => Finding::of(fate, format!("{} {what} asked for, {n} there", asked.count)).with(held.ids),
        };
        Some(Finding { asked: Some(f64::from(asked.count.n)), measured: Some(f64::from(n)), ..found })
    }

    /// Returns the places of a kind in rooms, by each of the ways in which people count them there, the narrowest first; `None` for
    /// kinds that nothing here counts.
    fn readings(&self, kind: PlaceKind, rooms: &[&GraphRoom]) -> Option<Vec<Held>> {
        let all = |each: fn(&Seat<'_>) -> u32| self.held(each, rooms);
        let of_rooms = |each: fn(&Seat<'_>) -> u32, is_meant: fn(&Domain, &RoomType) -> bool| {
            let meant = |room: &GraphRoom| {
                self.domain.room_type_or_lent(&room.room_type).is_some_and(|t| is_meant(self.domain, t))
            };
            self.held(each, &rooms.iter().copied().filter(|r| meant(r)).collect::<Vec<_>>())
        };
        let readings = match kind {
            // who works has a desk, who waits, eats or watches a seat that no work is done on
            PlaceKind::Seats => {
                let desks = of_rooms(desks, works_in);
                let seats = of_rooms(guest_seats, |domain, kind| !works_in(domain, kind));
                let sat_in = of_rooms(guest_seats, is_sat_in);
                vec![desks, seats, sat_in, self.commonest_seats(rooms), self.treated(rooms), all(seats_of)]
            }
            // the desk of a booth or a reading room is no work place of the building
            PlaceKind::Desks => vec![of_rooms(desks, works_in), all(desks)],
            // a couch that somebody is examined on is no bed of a ward
            PlaceKind::Beds => vec![of_rooms(beds, |domain, kind| sleeps(domain, kind).is_some()), all(beds)],
            PlaceKind::Cars => vec![all(|s| u32::from(s.shape == Shape::Vehicle)), self.units(rooms)],
            PlaceKind::Counters => vec![all(|s| u32::from(s.shape == Shape::Counter))],
            PlaceKind::Treatment => vec![self.treated(rooms), self.units(rooms)],
            PlaceKind::Bicycles | PlaceKind::Docks | PlaceKind::Animals | PlaceKind::Pallets => {
                let units = self.units(rooms);
                if units.places == 0 {
                    return None;
                }
                vec![units]
            }
        };
        let (some, none): (Vec<Held>, Vec<Held>) = readings.into_iter().partition(|held| held.places > 0);
        Some(if some.is_empty() { none } else { some })
    }

    /// Returns the seats of the kind that most of them are: the chairs at the tables of a café, and not the bench at its door.
    fn commonest_seats(&self, rooms: &[&GraphRoom]) -> Held {
        let held = self.held(guest_seats, rooms);
        let kind = |id: &String| {
            let placed = self.world.placements.placements.iter().find(|p| &p.placement_id == id);
            placed.map_or("", |p| p.object.as_str())
        };
        let mut kinds: BTreeMap<&str, Vec<String>> = BTreeMap::new();
        for id in &held.ids {
            kinds.entry(kind(id)).or_default().push(id.clone());
        }
        let most = kinds.into_values().max_by_key(Vec::len).unwrap_or_default();
        Held { places: most.len() as u32, most: 1, ids: most }
    }

    /// Returns the places that rooms are counted by: bays, stalls, racks.
    fn units(&self, rooms: &[&GraphRoom]) -> Held {
        let mut held = Held::default();
        for room in rooms {
            let Some(kind) = self.domain.room_type_or_lent(&room.room_type) else { continue };
            let Some((counted, anchor)) =
                places(self.domain, kind).and_then(|p| Some((p, self.domain.anchor(&p.line.item)?)))
            else {
                continue;
            };
            let of_room = self.world.placements.placements.iter().filter(|p| p.room_id == room.id);
            for placement in of_room.filter(|p| p.object == anchor.id) {
                held.places += counted.each;
                held.ids.push(placement.placement_id.clone());
            }
        }
        held
    }

    /// Returns the places that things in rooms have.
    pub(super) fn held(&self, each: fn(&Seat<'_>) -> u32, rooms: &[&GraphRoom]) -> Held {
        let rooms: BTreeSet<&str> = rooms.iter().map(|r| r.id.as_str()).collect();
        let mut held = Held::default();
        for placement in self.world.placements.placements.iter().filter(|p| rooms.contains(p.room_id.as_str())) {
            let Some(object) = self.domain.object(&placement.object) else { continue };
            let n = each(&Seat { size_m: placement.size_m, shape: object.shape, object });
            if n > 0 {
                held.places += n;
                held.most = held.most.max(n);
                held.ids.push(placement.placement_id.clone());
            }
        }
        held
    }

    /// Returns the places to lie or sit at while treated: what one lies on that is no bed to sleep in.
    fn treated(&self, rooms: &[&GraphRoom]) -> Held {
        self.held(|s| u32::from(s.shape != Shape::Bed && s.object.affordances.iter().any(|a| a == "lie")), rooms)
    }

    /// Returns for how many a room is: so many sleep there, or else have their desk; `None` where nobody does either.
    pub(super) fn people_of(&self, room: &GraphRoom) -> Option<u32> {
        let held = [self.held(sleepers, &[room]), self.held(desks, &[room])];
        held.iter().map(|h| h.places).find(|n| *n > 0)
    }
}

/// Returns true for a few seats more than a number asked for: those of a table or a bench that is not full.
fn is_one_thing_more(count: AskedCount, held: &Held) -> bool {
    let over = ((f64::from(count.n) * SEATS_OVER) as u32).max(1).max(held.most.saturating_sub(1));
    count.bound == Bound::Exactly && held.places > count.n && held.places - count.n <= over
}

fn not_counted(kind: PlaceKind) -> Finding {
    Finding::of(Fate::LeftOut, format!("no document counts {}", label(kind)))
}

/// Places that were counted.
#[derive(Default)]
pub(super) struct Held {
    pub places: u32,
    /// Places of the thing that has most.
    pub most: u32,
    /// Ids of what has them.
    pub ids: Vec<String>,
}

/// A thing that may have places.
pub(super) struct Seat<'a> {
    /// Its own width, depth and height, m.
    size_m: [f64; 3],
    shape: Shape,
    object: &'a ObjectType,
}

pub(super) fn desks(thing: &Seat<'_>) -> u32 {
    u32::from(thing.shape == Shape::Desk)
}

fn beds(thing: &Seat<'_>) -> u32 {
    u32::from(matches!(thing.shape, Shape::Bed | Shape::HospitalBed))
}

/// Returns how many sleep in a bed.
pub(super) fn sleepers(thing: &Seat<'_>) -> u32 {
    beds(thing) * sleepers_in(thing.size_m)
}

/// Returns how many sit on a thing; on a wheelchair that stands ready nobody has a place.
pub(super) fn seats_of(thing: &Seat<'_>) -> u32 {
    match thing.shape {
        _ if !thing.object.affordances.iter().any(|a| a == "sit") => 0,
        Shape::Sofa => ((thing.size_m[0] / SOFA_SEAT_M) as u32).max(1),
        other => seats_across(other, thing.size_m[0]),
    }
}

/// Returns how many sit on a thing as guests: a swivel chair is that of somebody who works.
pub(super) fn guest_seats(thing: &Seat<'_>) -> u32 {
    if thing.shape == Shape::SwivelChair { 0 } else { seats_of(thing) }
}

/// Returns true for rooms that people come to in order to sit: to eat, to meet, to wait, to watch.
pub(super) fn is_sat_in(domain: &Domain, kind: &RoomType) -> bool {
    seating(domain, kind, 1).is_some()
}
