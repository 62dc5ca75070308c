//! Places for people, vehicles and animals, and the people themselves: counted by what stands in the finished world.

use std::collections::BTreeSet;

use d3dgen_model::brief::{AskedCount, CapacityAsk, PeopleAsk, PlaceKind};
use d3dgen_model::domain::{Domain, ObjectType, RoomType, Shape};
use d3dgen_model::measures::BED_FOR_TWO_M;
use d3dgen_model::offer::{seating, seats_across, sleeps, works_in};
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

impl<'a> Asked<'a> {
    pub(super) fn capacity(&self, asked: &CapacityAsk) -> Finding {
        let Some(room) = &asked.room else {
            return self.places(asked, |_| true);
        };
        let rooms = self.rooms_called(room).rooms;
        if rooms.is_empty() {
            return Finding::of(Fate::LeftOut, format!("there is no {}", room.label()));
        }
        if !asked.each_room && asked.of_rooms.is_none() {
            return self.places(asked, |id| rooms.iter().any(|r| r.id == id));
        }
        let holds = |r: &&&GraphRoom| {
            self.readings(asked.of, |id| id == r.id).iter().flatten().any(|held| asked.count.allows(held.places))
        };
        let so: Vec<String> = rooms.iter().filter(holds).map(|r| r.id.clone()).collect();
        let what = format!("{} with {} {} each", room.label(), asked.count, label(asked.of));
        let wanted = AskedCount::at_least(asked.of_rooms.unwrap_or(rooms.len() as u32));
        Finding { ids: so.clone(), ..Finding::number(wanted, so.len() as u32, &what) }
    }

    /// A number is kept when one of the ways to count such places gives it; else the first of them is told.
    fn places(&self, asked: &CapacityAsk, within: impl Fn(&str) -> bool) -> Finding {
        let Some(readings) = self.readings(asked.of, within) else {
            return Finding::of(Fate::LeftOut, format!("no document counts {}", label(asked.of)));
        };
        let kept = readings.iter().position(|held| asked.count.allows(held.places));
        let held = readings.into_iter().nth(kept.unwrap_or(0)).unwrap_or_default();
        let n = held.places;
        Finding { ids: held.ids, ..Finding::number(asked.count, n, label(asked.of)) }
    }

    /// Returns the places of a kind in rooms, by each of the ways in which people count them, the narrowest first; `None` for
    /// kinds that nothing here counts.
    fn readings(&self, kind: PlaceKind, within: impl Fn(&str) -> bool) -> Option<Vec<Held>> {
        let all = |each: fn(&Seat<'_>) -> u32| self.held(each, |room| within(&room.id));
        let of_rooms = |each: fn(&Seat<'_>) -> u32, is_meant: fn(&Domain, &RoomType) -> bool| {
            let meant = |room: &GraphRoom| {
                self.domain.room_type_or_lent(&room.room_type).is_some_and(|t| is_meant(self.domain, t))
            };
            self.held(each, |room| within(&room.id) && meant(room))
        };
        let readings = match kind {
            // who works has a desk, who waits, eats or watches a seat that no work is done on
            PlaceKind::Seats => {
                let desks = of_rooms(desks, works_in);
                let seats = of_rooms(guest_seats, |domain, kind| !works_in(domain, kind));
                let treated = self.treated(|room| within(&room.id));
                vec![desks, seats, of_rooms(guest_seats, is_sat_in), treated, all(seats_of)]
            }
            PlaceKind::Desks => vec![all(desks)],
            // a couch that somebody is examined on is no bed of a ward
            PlaceKind::Beds => vec![of_rooms(beds, |domain, kind| sleeps(domain, kind).is_some()), all(beds)],
            PlaceKind::Cars => vec![all(|s| u32::from(s.shape == Shape::Vehicle))],
            PlaceKind::Counters => vec![all(|s| u32::from(s.shape == Shape::Counter))],
            PlaceKind::Treatment => vec![self.treated(|room| within(&room.id))],
            PlaceKind::Bicycles | PlaceKind::Docks | PlaceKind::Animals | PlaceKind::Pallets => return None,
        };
        let (some, none): (Vec<Held>, Vec<Held>) = readings.into_iter().partition(|held| held.places > 0);
        Some(if some.is_empty() { none } else { some })
    }

    /// Returns the places that things in rooms have.
    fn held(&self, each: fn(&Seat<'_>) -> u32, within: impl Fn(&GraphRoom) -> bool) -> Held {
        let graph = &self.world.scene_graph;
        let rooms: BTreeSet<&str> = graph.rooms.iter().filter(|r| within(r)).map(|r| r.id.as_str()).collect();
        let mut held = Held::default();
        for placement in self.world.placements.placements.iter().filter(|p| rooms.contains(p.room_id.as_str())) {
            let Some(object) = self.domain.object(&placement.object) else { continue };
            let n = each(&Seat { width_m: placement.size_m[0], shape: object.shape, object });
            if n > 0 {
                held.places += n;
                held.ids.push(placement.placement_id.clone());
            }
        }
        held
    }

    /// Returns the places to lie or sit at while treated: what one lies on that is no bed to sleep in.
    fn treated(&self, within: impl Fn(&GraphRoom) -> bool) -> Held {
        self.held(|s| u32::from(s.shape != Shape::Bed && s.object.affordances.iter().any(|a| a == "lie")), within)
    }

    /// Returns whether the building is for so many people: counted so by the scene graph, with a place for each to sleep,
    /// work or sit at.
    pub(super) fn people(&self, asked: &PeopleAsk) -> Finding {
        let occupancy = &self.world.scene_graph.occupancy;
        let counted = [occupancy.staff, occupancy.beds, occupancy.desks, occupancy.visitors, occupancy.residents];
        let everywhere = |each| self.held(each, |_| true).places;
        let places = [everywhere(sleepers), everywhere(desks), everywhere(seats_of)];
        let most = places.into_iter().max().unwrap_or(0);
        let what = format!("places for {}", asked.role.replace('_', " "));
        let found = Finding::number(AskedCount::at_least(asked.count.n), most, &what);
        if found.fate == Fate::Honored || !counted.contains(&Some(asked.count.n)) {
            return found;
        }
        Finding { fate: Fate::Substituted, ..found }
    }
}

/// Places that were counted.
#[derive(Default)]
struct Held {
    places: u32,
    /// Ids of what has them.
    ids: Vec<String>,
}

/// A thing that may have places.
struct Seat<'a> {
    /// Its own width, m.
    width_m: f64,
    shape: Shape,
    object: &'a ObjectType,
}

fn desks(thing: &Seat<'_>) -> u32 {
    u32::from(thing.shape == Shape::Desk)
}

fn beds(thing: &Seat<'_>) -> u32 {
    u32::from(matches!(thing.shape, Shape::Bed | Shape::HospitalBed))
}

/// Returns how many sleep in a bed.
fn sleepers(thing: &Seat<'_>) -> u32 {
    beds(thing) * if thing.width_m >= BED_FOR_TWO_M { 2 } else { 1 }
}

/// Returns how many sit on a thing; on a wheelchair that stands ready nobody has a place.
fn seats_of(thing: &Seat<'_>) -> u32 {
    match thing.shape {
        _ if !thing.object.affordances.iter().any(|a| a == "sit") => 0,
        Shape::Sofa => ((thing.width_m / SOFA_SEAT_M) as u32).max(1),
        other => seats_across(other, thing.width_m),
    }
}

/// Returns how many sit on a thing as guests: a swivel chair is that of somebody who works.
fn guest_seats(thing: &Seat<'_>) -> u32 {
    if thing.shape == Shape::SwivelChair { 0 } else { seats_of(thing) }
}

/// Returns true for rooms that people come to in order to sit: to eat, to meet, to wait, to watch.
fn is_sat_in(domain: &Domain, kind: &RoomType) -> bool {
    seating(domain, kind, 1).is_some()
}
