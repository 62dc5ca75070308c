//! How the rooms of a building become as many as are asked for: those that the prompt names, then the program's in its order,
//! up to a total, to what the people and the area ask for, or as usual.

use std::collections::BTreeMap;

use d3dgen_knowledge::jurisdiction::rules_here;
use d3dgen_model::domain::{Access, AdjacencyRelation, Occupants, Privacy, Program, ProgramRoom, RoomType, Zone};
use d3dgen_model::offer;

use super::occupants::head_count;
use super::planned::Planned;
use super::vital;
use crate::reading::Reading;
use crate::request::MAX_ROOMS;
use crate::subject::programs::{MOST_IN_OFFICE, is_dwelling};
use crate::tokens::words::words;
use crate::wished::wishes::{CHARGING, Wish};

/// Rooms of a building planned by area alone.
const MOST_BY_AREA: usize = 60;

/// Share of a building's net area that its corridors take, before any plan is drawn.
const CIRCULATION_SHARE: f64 = 0.14;

/// Share of the net area that the halls of a home of several storeys take, its stairs aside.
const HALLS_SHARE: f64 = 0.09;

/// Height of a storey as stairs are reckoned with before it is known, m.
const STOREY_M: f64 = 2.8;

/// Most of the net area of a home that its stairs are reckoned to take.
const MOST_STAIRS: f64 = 0.2;

/// What rooms need beyond their least area before a building counts as too small for them, as a factor; more in a home, where nobody
/// wants the smallest of all rooms for one that was not asked for.
const TIGHT: f64 = 1.1;
const TIGHT_AT_HOME: f64 = 1.25;

/// Returns the share of the net area that goes to corridors: none where a hall takes their part.
pub(crate) fn circulation_share(reading: &Reading, rooms: &[Planned]) -> f64 {
    if rooms.len() < 2 || hub_hall(reading, rooms).is_some() || way_through(reading, rooms).is_some() {
        return 0.0;
    }
    let stairs = stairs_share(reading);
    // halls of a home with stairs are short
    if stairs > 0.0 { HALLS_SHARE + stairs } else { CIRCULATION_SHARE }
}

/// Walls of a hall twice as long as wide at which rooms can lie, a fifth of them left for its own windows and ways out, m for each
/// root of its area.
const WALLS_M: f64 = 0.8 * 4.24;

/// Returns the index of the hall of the domain that all other rooms open to; none where its walls are too short for them, or where
/// another hall is larger: the pool of a gym does not hang on its training floor.
pub(crate) fn hub_hall(reading: &Reading, rooms: &[Planned]) -> Option<usize> {
    let types = &reading.domain.circulation.hub_room_types;
    let hub = types.iter().find_map(|t| rooms.iter().position(|r| &r.room_type == t))?;
    let reckoned: f64 = rooms.iter().map(Planned::reckoned_m2).sum();
    let area = rooms[hub].reckoned_m2() * reading.area_m2.map_or(1.0, |area| area / reckoned);
    let others = rooms.iter().enumerate().filter(|(i, r)| *i != hub && r.host.is_none());
    let around: f64 = others.map(|(_, r)| r.kind.min_dimension_m).sum();
    let largest = rooms.iter().all(|r| r.reckoned_m2() <= rooms[hub].reckoned_m2());
    (largest && around <= WALLS_M * area.sqrt()).then_some(hub)
}

/// Rooms that open to the one that is the way of a small home, at most: they have its walls.
const MOST_AROUND: usize = 4;

/// Returns the index of the room through which one gets to all others, in a home too small for a hall.
pub(crate) fn way_through(reading: &Reading, rooms: &[Planned]) -> Option<usize> {
    let circulation = &reading.domain.circulation;
    let least = circulation.hall_from_m2.filter(|_| is_dwelling(reading.program) && !reading.single)?;
    let area = reading.area_m2.unwrap_or_else(|| rooms.iter().map(Planned::reckoned_m2).sum());
    let is_hall = |id: &String| id == &circulation.room_type || circulation.entrance_room_types.contains(id);
    let asked =
        reading.wishes.wishes.iter().any(|w| is_hall(&w.room_type)) || rooms.iter().any(|r| is_hall(&r.room_type));
    let around = rooms.iter().filter(|r| r.host.is_none()).count();
    if area >= least || asked || reading.storeys.levels.len() > 1 || around > MOST_AROUND + 1 {
        return None;
    }
    // nobody goes from the table to the toilet next to it
    let rules = || rules_here(reading.domain, reading.country_code.as_deref());
    let bars = |id: &String| {
        let mut barred = rules().filter(|r| r.relation == AdjacencyRelation::MustNot && (&r.a == id || &r.b == id));
        barred.any(|r| rooms.iter().any(|room| room.room_type == if &r.a == id { r.b.as_str() } else { r.a.as_str() }))
    };
    let public = |r: &Planned| r.kind.zone == Zone::Day && r.kind.privacy == Privacy::Public && r.host.is_none();
    let ways = (0..rooms.len()).filter(|&i| public(&rooms[i]) && !bars(&rooms[i].room_type));
    ways.max_by(|&a, &b| rooms[a].reckoned_m2().total_cmp(&rooms[b].reckoned_m2()).then(b.cmp(&a)))
}

/// Returns the share of the net area that the stairs of a home take: one flight on every storey.
fn stairs_share(reading: &Reading) -> f64 {
    let storeys = reading.storeys.levels.len();
    let rules = reading.domain.circulation.storeys.as_ref().filter(|_| storeys > 1 && is_dwelling(reading.program));
    let Some((rules, area)) = rules.zip(reading.area_m2) else { return 0.0 };
    let (width, depth) = rules.stairs.size_m(STOREY_M);
    (storeys as f64 * width * depth / area).min(MOST_STAIRS)
}

/// Returns true when rooms of a type may be added to those that the prompt names.
pub(crate) fn may_grow(reading: &Reading, room_type: &str) -> bool {
    Build::new(reading, reading.program).may_grow(room_type)
}

/// Returns the rooms of a unit: those it has already, and what its program adds up to a total, or as usual; a total that the
/// prompt does not give is none that rooms are made up for.
pub(crate) fn fill_unit<'a>(
    reading: &Reading<'a>,
    program: &'a Program,
    rooms: Vec<Planned<'a>>,
    total: Option<usize>,
) -> Vec<Planned<'a>> {
    let mut build = Build { rooms, ..Build::new(reading, program) };
    match total {
        Some(total) if reading.total.is_some() => build.fill_to(total),
        Some(most) => build.spend_wishes(most, usize::MAX),
        None => build.spend_wishes(MAX_ROOMS as usize, program.default_rooms as usize),
    }
    build.rooms
}

/// Rooms of a building as they become more, in the order of its program.
pub(super) struct Build<'r, 'a> {
    reading: &'r Reading<'a>,
    program: &'a Program,
    pub(super) rooms: Vec<Planned<'a>>,
    /// Zones for sleeping in which the prompt fixes the rooms.
    sleeping_is_fixed: bool,
}

impl<'r, 'a> Build<'r, 'a> {
    pub(super) fn new(reading: &'r Reading<'a>, program: &'a Program) -> Self {
        let zone = |w: &Wish| reading.domain.room_type(&w.room_type).map(|t| t.zone);
        let sleeping_is_fixed = reading.wishes.wishes.iter().any(|w| w.exact && zone(w) == Some(Zone::Night));
        Self { reading, program, rooms: Vec::new(), sleeping_is_fixed }
    }

    pub(super) fn take_wishes(&mut self) {
        let corridor = &self.reading.domain.circulation.room_type;
        for wish in self.reading.wishes.wishes.iter().filter(|w| &w.room_type != corridor) {
            for _ in 0..wish.count {
                self.push(&wish.room_type, Some(wish));
                self.bring_host(&wish.room_type);
            }
        }
        let charging = self.reading.wishes.charging_room
            || self.reading.wishes.charging && self.reading.docked.is_empty() && !self.has_dock();
        if charging && !self.is_forbidden(CHARGING) && self.count(CHARGING) == 0 {
            self.push(CHARGING, None);
            self.rooms.last_mut().expect("just pushed").requested = true;
        }
    }

    /// Gives a home whose rooms are left open, and of whose rooms to sleep in only those of children and guests are named, a
    /// bedroom for who lives there with them.
    pub(super) fn house_parents(&mut self) {
        let d = &words().dwelling;
        let open = is_dwelling(self.program) && !self.reading.closed && self.reading.total.is_none();
        let kind = self.reading.domain.room_type(&d.bedroom).filter(|k| !self.is_forbidden(&k.id));
        let own = |r: &Planned| r.kind.zone == Zone::Night && !d.of_others.contains(&r.room_type);
        let bedded = |r: &Planned| own(r) && r.kind.access != Access::Host || r.room_type == d.studio;
        if let Some(kind) = kind.filter(|_| open && self.sleeping_is_fixed && !self.rooms.iter().any(bedded)) {
            self.push(&kind.id, None);
        }
    }

    /// Returns true when one of the rooms is furnished with a dock anyway.
    fn has_dock(&self) -> bool {
        self.rooms.iter().any(|r| r.kind.furnishing.iter().any(|f| self.reading.domain.is_dock(&f.item)))
    }

    /// Adds the room through which one enters the last one, where a program of the domain has them together (an isolation
    /// room and its anteroom).
    fn bring_host(&mut self, room_type: &str) {
        let kind = self.reading.domain.room_type_or_generic(room_type);
        let mut entries =
            self.reading.domain.programs.iter().flat_map(|p| &p.rooms).filter(|e| e.room_type == room_type);
        let host = entries.find_map(|e| e.with.iter().find(|w| kind.hosts.contains(w)));
        // one that serves a number of rooms is not enough for more, whether it is named or not
        let shares = |id: &str| self.reading.domain.room_type(id).is_some_and(|h| h.guests.is_some());
        let named = |id: &str| !shares(id) && self.reading.wishes.wishes.iter().any(|w| w.room_type == id);
        let is_full = |host: &str| {
            let each = self.reading.domain.room_type(host).and_then(|h| h.guests).unwrap_or(1) as usize;
            // those that the prompt names come behind
            let told: u32 = self.reading.wishes.wishes.iter().filter(|w| w.room_type == host).map(|w| w.count).sum();
            let brought = self.rooms.iter().filter(|r| r.room_type == host && !r.requested).count();
            self.count(room_type) > each * (told as usize + brought)
        };
        let may_come = !self.reading.closed || self.reading.may_join;
        if let Some(host) = host.filter(|h| may_come && !named(h) && !self.is_forbidden(h) && is_full(h)) {
            self.push(host, None);
        }
    }

    fn push(&mut self, room_type: &str, wish: Option<&Wish>) {
        let kind = self.reading.domain.room_type_or_generic(room_type);
        self.rooms.push(Planned {
            name: wish.filter(|_| kind.id != room_type).map(|w| w.name.clone()),
            area_m2: wish.and_then(|w| w.area_m2),
            sides_m: wish.and_then(|w| w.sides_m),
            size: wish.and_then(|w| w.size),
            requested: wish.is_some(),
            ..Planned::new(room_type, kind)
        });
    }

    fn count(&self, room_type: &str) -> usize {
        self.rooms.iter().filter(|r| r.room_type == room_type).count()
    }

    fn is_forbidden(&self, room_type: &str) -> bool {
        self.reading.wishes.forbidden.iter().any(|f| f == room_type)
    }

    /// Returns true when the program may add rooms of a type to those the prompt names.
    fn may_grow(&self, room_type: &str) -> bool {
        let wishes = &self.reading.wishes;
        let exact = wishes.wishes.iter().any(|w| w.exact && w.room_type == room_type);
        let zone = self.reading.domain.room_type(room_type).map(|t| t.zone);
        let night = zone == Some(Zone::Night);
        let essential = words().dwelling.essential.iter().flatten().any(|e| e == room_type);
        let lived_in = (night || zone == Some(Zone::Day)) && !essential;
        // no kitchenette beside a kitchen that was asked for
        let met = |set: &&Vec<String>| {
            set.iter().any(|s| s == room_type)
                && wishes.wishes.iter().any(|w| w.room_type != room_type && set.contains(&w.room_type))
        };
        let fixed = words().alike.iter().any(|set| met(&set))
            || exact
            || night && self.sleeping_is_fixed
            || lived_in && self.reading.habitable_fixed;
        !fixed && !self.is_forbidden(room_type)
    }

    /// Adds one room of an entry with those that come with it; returns false when there is no place for it.
    ///
    /// A room that one enters through one of those (an isolation room through its anteroom) comes with all or not at all.
    fn add(&mut self, entry: &ProgramRoom, limit: usize) -> bool {
        let kind = self.reading.domain.room_type_or_generic(&entry.room_type);
        let entered = entry.with.iter().filter(|w| kind.hosts.contains(w));
        // beds beyond the first ones have their bathroom or are not there
        let bathroom = |w: &&String| {
            let kind = self.reading.domain.room_type_or_generic(w);
            let hosts = self.rooms.iter().filter(|r| kind.hosts.contains(&r.room_type)).count();
            self.reading.wet.is_bathroom(kind) && self.may_grow(w) && self.count(w) <= hosts
        };
        let bathed = self.count(&entry.room_type) > 0 && !is_dwelling(self.program);
        let baths = if bathed { entry.with.iter().filter(bathroom).count() } else { 0 };
        let whole = 1 + baths + if entered.clone().all(|w| self.may_grow(w)) { entered.count() } else { limit };
        if !self.may_grow(&entry.room_type) || self.rooms.len() + whole > limit {
            return false;
        }
        self.push(&entry.room_type, None);
        for with in &entry.with {
            if self.rooms.len() < limit && self.may_grow(with) && !self.waits_for_host(with) {
                self.push(with, None);
            }
        }
        true
    }

    /// Returns true when there are enough rooms of a type for all that they may be entered from: the prompt names en suites
    /// before their rooms come.
    fn waits_for_host(&self, room_type: &str) -> bool {
        let kind = self.reading.domain.room_type_or_generic(room_type);
        let hosts = self.rooms.iter().filter(|r| kind.hosts.contains(&r.room_type)).count();
        kind.access == Access::Host && self.count(room_type) >= hosts
    }

    /// Returns the program in the order in which this building needs it.
    fn entries(&self) -> Vec<&'a ProgramRoom> {
        let all = &self.program.rooms;
        let sooner = |e: &ProgramRoom| e.accessible_after.filter(|_| self.reading.accessible);
        let mut out: Vec<&ProgramRoom> = all.iter().filter(|e| sooner(e).is_none()).collect();
        for entry in all {
            if let Some(after) = sooner(entry) {
                out.insert(out.len().min(after as usize), entry);
            }
        }
        out
    }

    /// Walks through the program as it grows: `min` of every entry, then one more of each below its `max`, again and
    /// again. `visit` returns false to stop.
    fn walk(&mut self, mut visit: impl FnMut(&mut Self, &'a ProgramRoom) -> bool) {
        let entries = self.entries();
        let rounds = entries.iter().map(|e| e.max.saturating_sub(e.min)).max().unwrap_or(0);
        for round in 0..=rounds {
            for &entry in &entries {
                let n = if round == 0 { entry.min } else { u32::from(entry.min + round <= entry.max) };
                for _ in 0..n {
                    if !visit(self, entry) {
                        return;
                    }
                }
            }
        }
    }

    /// Fills up to a total; rooms the prompt names count first, a program's own come in its order.
    pub(super) fn fill_to(&mut self, total: usize) {
        self.spend_wishes(total, usize::MAX);
        // a program shorter than the count goes on with what it has
        while self.rooms.len() < total {
            let before = self.rooms.len();
            for entry in &self.program.rooms {
                if entry.max > 1 {
                    self.add(entry, total);
                }
            }
            if self.rooms.len() == before {
                let growing = self.reading.wishes.wishes.iter().find(|w| !w.exact).map(|w| w.room_type.clone());
                let kind = growing.unwrap_or_else(|| self.program.rooms[0].room_type.clone());
                self.push(&kind, None);
            }
        }
    }

    /// Walks the program up to `limit` rooms in all or `usual` rooms of the program; a program's room that the prompt
    /// names already is that room.
    fn spend_wishes(&mut self, limit: usize, usual: usize) {
        let mut named: BTreeMap<String, usize> = BTreeMap::new();
        for room in &self.rooms {
            *named.entry(room.room_type.clone()).or_default() += 1;
        }
        let mut spent = 0;
        self.walk(|build, entry| {
            if build.rooms.len() >= limit || spent >= usual {
                return false;
            }
            match named.get_mut(&entry.room_type).filter(|n| **n > 0) {
                Some(left) => {
                    *left -= 1;
                    spent += 1 + entry.with.len();
                }
                None => {
                    let before = build.rooms.len();
                    build.add(entry, limit);
                    spent += (build.rooms.len() - before).max(1);
                }
            }
            true
        });
    }

    /// Fills with the rooms such a building usually has, as many as the area and the people ask for.
    pub(super) fn fill_usual(&mut self) {
        let program = self.program;
        let most = MAX_ROOMS as usize;
        self.spend_wishes(most, program.default_rooms as usize);
        self.fit_people(most);
        self.keep_to_beds();
        if let Some(area) = self.reading.area_m2 {
            self.fit_area(area * (1.0 - circulation_share(self.reading, &self.rooms)));
        }
    }

    /// Adds rooms that a head count asks for.
    fn fit_people(&mut self, limit: usize) {
        for entry in &self.program.rooms {
            let present = self.count(&entry.room_type);
            let Some(people) = head_count(self.reading, entry.occupants).filter(|_| present > 0) else { continue };
            let kind = self.reading.domain.room_type_or_generic(&entry.room_type);
            // who sits in an open office that the prompt names needs no office of their own
            let seated = entry.occupants_per_room.is_some_and(|n| n <= MOST_IN_OFFICE)
                && self
                    .rooms
                    .iter()
                    .any(|r| r.requested && offer::most_desks(self.reading.domain, r.kind) > offer::MOST_IN_TEAM);
            if seated {
                continue;
            }
            let by_count = entry.occupants_per_room.map_or(0, |per| people.div_ceil(per.max(1)) as usize);
            let by_area = entry
                .area_per_occupant_m2
                .map_or(0, |per| (per * f64::from(people) / kind.area_m2.max).ceil() as usize);
            // each storey has its share of those who work there
            let storeys = self.reading.storeys.above_ground();
            let shares = entry.area_per_occupant_m2.map_or(0, |per| {
                let most = (per * f64::from(people) / kind.area_m2.min) as usize;
                if storeys > 1 { most.min(storeys) } else { 0 }
            });
            for _ in present..by_count.max(by_area).max(shares) {
                self.add(entry, limit);
            }
        }
        if let Some(people) = self.reading.residents {
            // two share a bedroom, everyone else has one
            let wanted = vital::bedrooms_for(people, self.reading.each_alone);
            let sleeping =
                |e: &&ProgramRoom| self.reading.domain.room_type_or_generic(&e.room_type).zone == Zone::Night;
            if let Some(entry) = self.program.rooms.iter().find(sleeping) {
                for _ in self.count(&entry.room_type) + self.count(&words().dwelling.studio)..wanted {
                    self.add(entry, limit);
                }
            }
        }
    }

    /// Takes beds of the rooms that the program adds for some of those that the prompt counts: an intensive care unit of ten
    /// beds has its isolation room among them.
    fn keep_to_beds(&mut self) {
        let single =
            |e: &&ProgramRoom| e.occupants == Occupants::Beds && e.occupants_per_room == Some(1) && e.with.is_empty();
        let Some(entry) = self.program.rooms.iter().find(single) else { return };
        let Some(beds) = head_count(self.reading, Occupants::Beds) else { return };
        let sleeps = |r: &Planned| offer::sleeps(self.reading.domain, r.kind).map_or(0, |[low, _]| low as usize);
        let added = |r: &Planned| !r.requested && r.room_type != entry.room_type && sleeps(r) > 0;
        let others: usize = self.rooms.iter().filter(|r| added(r)).map(sleeps).sum();
        let all: usize = self.rooms.iter().map(sleeps).sum();
        for _ in 0..all.saturating_sub(beds as usize).min(others) {
            let last = self.rooms.iter().rposition(|r| r.room_type == entry.room_type && !r.requested);
            let Some(last) = last else { return };
            self.rooms.remove(last);
        }
    }

    /// Returns the least area of all rooms together, net m^2: who uses a wheelchair needs more of some.
    fn least_m2(&self) -> f64 {
        let step_free = |k: &RoomType| if self.reading.accessible { k.step_free_m2.min(k.area_m2.max) } else { 0.0 };
        self.rooms.iter().map(|r| r.area_m2.unwrap_or_else(|| r.kind.area_m2.min.max(step_free(r.kind)))).sum()
    }

    /// Drops or adds rooms until the usual sizes fit an area, net m^2.
    fn fit_area(&mut self, area: f64) {
        let sum = |build: &Self, size: fn(&RoomType) -> f64| {
            build.rooms.iter().map(|r| r.area_m2.unwrap_or_else(|| size(r.kind))).sum::<f64>()
        };
        let tight = if is_dwelling(self.program) { TIGHT_AT_HOME } else { TIGHT };
        while tight * self.least_m2() > area {
            // what comes last in the program goes first
            let spare = |&i: &usize| !self.rooms[i].requested && !vital::is_vital(self.reading, &self.rooms, i);
            let Some(last) = (0..self.rooms.len()).rev().find(spare) else { break };
            if self.rooms.len() <= 1 {
                break;
            }
            self.rooms.remove(last);
        }
        let roomy = sum(self, |k| k.area_m2.target.max(0.75 * k.area_m2.max));
        if roomy >= area {
            return;
        }
        let mut seen: BTreeMap<&str, u32> = BTreeMap::new();
        let counted: BTreeMap<String, u32> = self.rooms.iter().fold(BTreeMap::new(), |mut map, r| {
            *map.entry(r.room_type.clone()).or_default() += 1;
            map
        });
        self.walk(|build, entry| {
            let n = seen.entry(&entry.room_type).or_default();
            *n += 1;
            if *n > counted.get(&entry.room_type).copied().unwrap_or(0) {
                build.add(entry, MOST_BY_AREA);
            }
            build.rooms.len() < MOST_BY_AREA && sum(build, |k| k.area_m2.target) < area
        });
    }
}
