//! Which rooms the building has: those the prompt names, completed from the program of its building type.

use std::collections::BTreeMap;

use d3dgen_knowledge::Applicable;
use d3dgen_model::domain::{Access, Occupants, Program, ProgramRoom, RobotUse, RoomType, Zone};

use super::occupants::head_count;
use super::{hosts, large, layout, occupants, vital, workers};
use crate::scene_graph::levels::{spread, units};
use crate::scene_graph::machines::charging::most_docks;
use crate::scene_graph::people::beds::sleeps;
use crate::scene_graph::people::seats;
use crate::scene_graph::reading::Reading;
use crate::scene_graph::subject::places::note;
use crate::scene_graph::subject::programs::is_dwelling;
use crate::scene_graph::tokens::words::words;
use crate::scene_graph::wished::wishes::{CHARGING, Wish};
use crate::scene_graph::{MAX_ROOMS, MOST_IN_OFFICE};

/// Rooms of a building planned by area alone.
const MOST_BY_AREA: usize = 60;
/// Share of a building's net area that its corridors take, before any plan is drawn.
const CIRCULATION_SHARE: f64 = 0.14;

/// The same of a home of several storeys, its stairs aside.
const HALLS_SHARE: f64 = 0.11;
/// Height of a storey as stairs are reckoned with before it is known, m, and the most of a home that they are reckoned to take.
const STOREY_M: f64 = 2.8;
const MOST_STAIRS: f64 = 0.2;

/// Toilets that a home of several storeys has where its list of rooms names fewer: one by day, one by night.
const TOILETS_GRANTED: usize = 2;

/// What rooms need beyond their least area before a building counts as too small for them, as a factor.
const TIGHT: f64 = 1.1;

/// Returns the share of the net area that goes to corridors: none where a hall takes their part.
pub(crate) fn circulation_share(reading: &Reading, rooms: &[Planned]) -> f64 {
    let hubs = &reading.domain.circulation.hub_room_types;
    if rooms.len() < 2 || rooms.iter().any(|r| hubs.contains(&r.room_type)) {
        return 0.0;
    }
    let stairs = stairs_share(reading);
    // halls of a home with stairs are short
    if stairs > 0.0 { HALLS_SHARE + stairs } else { CIRCULATION_SHARE }
}

/// Returns the share of the net area that the stairs of a home take: one flight on every storey.
fn stairs_share(reading: &Reading) -> f64 {
    let storeys = reading.storeys.levels.len();
    let rules = reading.domain.circulation.storeys.as_ref().filter(|_| storeys > 1 && is_dwelling(reading.program));
    let Some((rules, area)) = rules.zip(reading.area_m2) else { return 0.0 };
    let (width, depth) = rules.stairs.size_m(STOREY_M);
    (storeys as f64 * width * depth / area).min(MOST_STAIRS)
}

/// A room to be.
#[derive(Debug, Clone)]
pub(crate) struct Planned<'a> {
    /// Type of the domain, or a name that only the prompt knows.
    pub room_type: String,
    /// What the domain knows about it.
    pub kind: &'a RoomType,
    /// The prompt's words for a type the domain does not know.
    pub name: Option<String>,
    /// Area the prompt gives, m^2.
    pub area_m2: Option<f64>,
    /// Factor on its usual area that the prompt asks for.
    pub size: Option<f64>,
    /// Area that the people in it ask for, m^2.
    pub people_area_m2: Option<f64>,
    /// Area that the table of those who live there asks for, m^2: what a small home leaves others less for.
    pub table_area_m2: Option<f64>,
    /// Area that a proposal gives, m^2; within the range of its type.
    pub proposed_area_m2: Option<f64>,
    pub requested: bool,
    /// Index of the room it is entered from, when that is not the circulation.
    pub host: Option<usize>,
    /// People, beds or desks it is to hold.
    pub occupants: Option<u32>,
    /// Unit of a large building that it belongs to.
    pub unit: Option<String>,
    /// What the prompt calls it, where that is not the label of its type.
    pub called: Option<String>,
    /// True where its occupants only meet, wait or eat there.
    pub visited: bool,
}

impl<'a> Planned<'a> {
    /// Returns the area that it is reckoned with before it is sized, m^2: as asked for, else for its people, else the usual.
    pub(crate) fn reckoned_m2(&self) -> f64 {
        self.area_m2.or(self.people_area_m2).unwrap_or(self.kind.area_m2.target)
    }

    /// Sizes a room by the people it is for, within what its type allows; a size that the prompt gives stays.
    pub(super) fn size_for_people(&mut self, area_m2: f64) {
        let range = self.kind.area_m2;
        self.people_area_m2 = self.area_m2.is_none().then(|| area_m2.clamp(range.min, range.max));
    }

    /// Returns a room of a type that nobody said more about.
    pub(crate) fn new(room_type: &str, kind: &'a RoomType) -> Self {
        Self {
            room_type: room_type.to_owned(),
            kind,
            name: None,
            area_m2: None,
            size: None,
            people_area_m2: None,
            table_area_m2: None,
            proposed_area_m2: None,
            requested: false,
            host: None,
            occupants: None,
            unit: None,
            called: None,
            visited: false,
        }
    }
}

/// Returns the rooms of the building, circulation aside.
pub(crate) fn complete<'a>(reading: &mut Reading<'a>) -> Vec<Planned<'a>> {
    let mut build = Build::new(reading, reading.program);
    build.take_wishes();
    build.house_parents();
    match (reading.total, reading.closed) {
        (None, true) => {}
        (Some(total), _) => build.fill_to(total as usize),
        (None, false) => build.fill_usual(),
    }
    let mut rooms = build.rooms;
    hosts::equip_hosts(reading, &mut rooms);
    vital::accompany(reading, &mut rooms);
    vital::complete(reading, &mut rooms);
    large::complete(reading, &mut rooms);
    house_robots(reading, &mut rooms);
    let mut rooms = units::divide(reading, rooms);
    layout::follow(reading, &mut rooms);
    let mut rooms = finish(reading, rooms);
    spread::open_offices(reading, &mut rooms);
    spread::fill_ground(reading, &mut rooms);
    rooms
}

/// Gives rooms that are settled their people and hosts, and states which of them the prompt does not name.
pub(crate) fn finish<'a>(reading: &mut Reading<'a>, mut rooms: Vec<Planned<'a>>) -> Vec<Planned<'a>> {
    wash_on_every_storey(reading, &mut rooms);
    serve_every_storey(reading, &mut rooms);
    if reading.building_type.as_ref().is_some_and(|b| words().dwelling.shared.contains(b)) {
        // a room to sleep and work in is not to come out small
        let own = |r: &&mut Planned| r.room_type == words().dwelling.bedroom && r.area_m2.is_none();
        rooms.iter_mut().filter(own).for_each(|r| r.size = r.size.or(Some(1.0)));
    }
    occupants::make_room_for_things(reading, &mut rooms);
    occupants::hold_beds(reading, &mut rooms);
    workers::settle(reading, &mut rooms);
    occupants::hold_people(reading, &mut rooms);
    occupants::make_room_for_companions(reading, &mut rooms);
    occupants::serve_people(reading, &mut rooms);
    workers::seat_guests(reading, &mut rooms);
    occupants::seat_waiting(reading, &mut rooms);
    hosts::hang_on_hosts(reading, &mut rooms);
    hosts::share_last_bathroom(reading, &mut rooms);
    state_additions(reading, &rooms);
    rooms
}

/// Adds the room that robots live in, where the rooms are left open and none of them suits that.
fn house_robots<'a>(reading: &Reading<'a>, rooms: &mut Vec<Planned<'a>>) {
    let open = reading.total.is_none() && (!reading.closed || reading.may_join) && !reading.single;
    if !open || reading.robots.is_empty() || !reading.docked.is_empty() {
        return;
    }
    let robots: u32 = reading.robots.iter().map(|r| r.count).fold(0, u32::saturating_add);
    // rooms that are there to charge robots grow with them
    let holds = |kind: &RoomType| match kind.zone == Zone::Service && kind.robot.contains(&RobotUse::Charging) {
        true if kind.furnishing.iter().any(|f| reading.domain.is_dock(&f.item)) => robots,
        true => most_docks(kind.area_m2.target),
        false => 0,
    };
    let have: u32 = rooms.iter().map(|r| holds(r.kind)).fold(0, u32::saturating_add);
    let mut kinds = reading.program.robot_rooms.iter().filter_map(|id| reading.domain.room_type(id));
    let new = |k: &RoomType| may_add(reading, &k.id) && !rooms.iter().any(|r| r.room_type == k.id);
    let kind = kinds.find(|k| new(k) && have.saturating_add(holds(k)) >= robots);
    if let Some(kind) = kind.filter(|_| have < robots) {
        rooms.push(Planned::new(&kind.id, kind));
    }
}

/// Returns true for rooms that the prompt does not rule out.
pub(super) fn may_add(reading: &Reading, room_type: &str) -> bool {
    !reading.wishes.forbidden.iter().any(|f| f == room_type)
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

/// Sees to it that there are as many toilets and bathrooms as storeys, where the prompt leaves the rooms open.
fn wash_on_every_storey<'a>(reading: &Reading<'a>, rooms: &mut Vec<Planned<'a>>) {
    let storeys = reading.storeys.above_ground();
    // where people work, a list of rooms that says nothing of that does not mean that one goes to another storey; nor does
    // anybody go up to the bedrooms for a toilet, unless the list says that it is all
    let works = workers::is_office(reading.program) && !reading.only;
    let lives = is_dwelling(reading.program) && !reading.only && !reading.single;
    let open = !reading.closed || works || lives && reading.total.is_none();
    let Some(rules) = reading.domain.circulation.storeys.as_ref().filter(|_| storeys > 1 && open) else {
        return;
    };
    let storeys = if reading.closed && lives { storeys.min(TOILETS_GRANTED) } else { storeys };
    let kinds = rules.each_level_room_types.iter().filter_map(|id| reading.domain.room_type(id));
    let wet: Vec<&RoomType> =
        kinds.filter(|k| k.wet && !reading.wishes.forbidden.contains(&k.id) && k.access != Access::Host).collect();
    let usual = wet.iter().copied().find(|k| words().dwelling.toilets.contains(&k.id));
    let Some(kind) = usual.or(wet.first().copied()) else { return };
    if rooms.iter().any(|r| r.unit.is_some()) {
        return wash_in_units(reading, rooms, kind);
    }
    for _ in rooms.iter().filter(|r| is_washed_in(reading, r)).count()..storeys {
        if reading.total.is_none() {
            rooms.push(Planned::new(&kind.id, kind));
            continue;
        }
        let Some(spare) = spare_for_toilet(reading, rooms, None).filter(|s| *s > storeys) else { return };
        rooms[spare] = Planned::new(&kind.id, kind);
    }
}

/// Returns true for toilets and bathrooms that all use.
fn is_washed_in(reading: &Reading, room: &Planned) -> bool {
    room.kind.access != Access::Host && reading.wet.has_toilet(room.kind)
}

/// Returns the room that gives way to a toilet where their number is fixed: what comes last in the program, or in that of a unit.
/// No bathroom is left without its bedroom.
fn spare_for_toilet(reading: &Reading, rooms: &[Planned], unit: Option<&String>) -> Option<usize> {
    let entered = |r: &Planned| {
        let guest =
            |g: &Planned| g.kind.access == Access::Host && g.unit == r.unit && g.kind.hosts.contains(&r.room_type);
        rooms.iter().any(guest)
    };
    let spare = |r: &Planned| {
        !r.requested
            && !is_washed_in(reading, r)
            && r.kind.access != Access::Host
            && !entered(r)
            && r.unit.as_ref() == unit
    };
    rooms.iter().rposition(spare)
}

/// Gives each unit whose people have no toilets of their own one: who sleeps there may have, who works or learns there has not.
fn wash_in_units<'a>(reading: &Reading<'a>, rooms: &mut Vec<Planned<'a>>, kind: &'a RoomType) {
    let mut units: Vec<String> = Vec::new();
    for unit in rooms.iter().filter_map(|r| r.unit.as_ref()) {
        if !units.contains(unit) {
            units.push(unit.clone());
        }
    }
    for unit in units {
        let own = || rooms.iter().filter(|r| r.unit.as_ref() == Some(&unit));
        let count = |test: &dyn Fn(&Planned) -> bool| own().filter(|r| test(r)).count();
        let asleep = count(&|r| r.kind.zone == Zone::Night && r.kind.access != Access::Host);
        let bathed = count(&|r| r.kind.access == Access::Host && reading.wet.has_toilet(r.kind));
        let awake =
            count(&|r| matches!(r.kind.zone, Zone::Public | Zone::Day | Zone::Staff) && r.kind.access != Access::Host);
        if own().any(|r| is_washed_in(reading, r)) || awake == 0 && bathed >= asleep {
            continue;
        }
        let toilet = Planned { unit: Some(unit.clone()), ..Planned::new(&kind.id, kind) };
        match (reading.total, spare_for_toilet(reading, rooms, Some(&unit))) {
            (None, _) => rooms.push(toilet),
            (Some(_), Some(spare)) => rooms[spare] = toilet,
            (Some(_), None) => {}
        }
    }
}

/// Sees to it that who works on a storey has a place for tea there, where the prompt leaves the rooms open.
fn serve_every_storey<'a>(reading: &Reading<'a>, rooms: &mut Vec<Planned<'a>>) {
    let storeys = reading.storeys.above_ground();
    let open = storeys > 1 && !reading.closed && reading.total.is_none() && workers::is_office(reading.program);
    let Some(rules) = reading.domain.circulation.storeys.as_ref().filter(|_| open) else { return };
    let served =
        |id: &&String| reading.program.rooms.iter().any(|e| &e.room_type == *id && e.area_per_person_m2.is_some());
    let kinds = rules.each_level_room_types.iter().filter(served).filter_map(|id| reading.domain.room_type(id));
    for kind in kinds.filter(|k| !reading.wet.has_toilet(k) && may_grow(reading, &k.id)) {
        let have = rooms.iter().filter(|r| r.room_type == kind.id).count();
        rooms.extend((have..storeys).filter(|_| have > 0).map(|_| Planned::new(&kind.id, kind)));
    }
}

/// Adds rooms that a building rule asks for; returns true when something was added or said.
pub(crate) fn follow_rules<'a>(
    reading: &mut Reading<'a>,
    rooms: &mut Vec<Planned<'a>>,
    missing: &[Applicable],
) -> bool {
    let mut changed = false;
    // a room by itself is no building
    for rule in missing.iter().filter(|_| !reading.single) {
        let space = &rule.constraint.space_type;
        let speaks = |t: &&RoomType| &t.id == space || t.spaces.contains(space);
        let Some(kind) = reading.domain.room_types.iter().find(speaks) else { continue };
        let what = format!("{} by {}", kind.label.to_lowercase(), rule.constraint.constraint_id);
        changed = true;
        if reading.total.is_some() || reading.closed || reading.wishes.forbidden.contains(&kind.id) {
            let message = format!("the building needs a {what}; the prompt's own list of rooms was followed");
            reading.conflicts.push(note("rule_asks_for_room", message));
            continue;
        }
        reading.assumptions.push(note("room_by_rule", format!("added a {what}")));
        rooms.push(Planned::new(&kind.id, kind));
    }
    changed
}

struct Build<'r, 'a> {
    reading: &'r Reading<'a>,
    program: &'a Program,
    rooms: Vec<Planned<'a>>,
    /// Zones for sleeping in which the prompt fixes the rooms.
    sleeping_is_fixed: bool,
}

impl<'r, 'a> Build<'r, 'a> {
    fn new(reading: &'r Reading<'a>, program: &'a Program) -> Self {
        let zone = |w: &Wish| reading.domain.room_type(&w.room_type).map(|t| t.zone);
        let sleeping_is_fixed = reading.wishes.wishes.iter().any(|w| w.exact && zone(w) == Some(Zone::Night));
        Self { reading, program, rooms: Vec::new(), sleeping_is_fixed }
    }

    fn take_wishes(&mut self) {
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
    fn house_parents(&mut self) {
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
    fn fill_to(&mut self, total: usize) {
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
    fn fill_usual(&mut self) {
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
                    .any(|r| r.requested && seats::most_desks(self.reading.domain, r.kind) > seats::MOST_IN_TEAM);
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
        let sleeps = |r: &Planned| sleeps(self.reading.domain, r.kind).map_or(0, |[low, _]| low as usize);
        let added = |r: &Planned| !r.requested && r.room_type != entry.room_type && sleeps(r) > 0;
        let others: usize = self.rooms.iter().filter(|r| added(r)).map(sleeps).sum();
        let all: usize = self.rooms.iter().map(sleeps).sum();
        for _ in 0..all.saturating_sub(beds as usize).min(others) {
            let last = self.rooms.iter().rposition(|r| r.room_type == entry.room_type && !r.requested);
            let Some(last) = last else { return };
            self.rooms.remove(last);
        }
    }

    /// Drops or adds rooms until the usual sizes fit an area, net m^2.
    fn fit_area(&mut self, area: f64) {
        let sum = |build: &Self, size: fn(&RoomType) -> f64| {
            build.rooms.iter().map(|r| r.area_m2.unwrap_or_else(|| size(r.kind))).sum::<f64>()
        };
        while sum(self, |k| TIGHT * k.area_m2.min) > area {
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

/// States which rooms the prompt does not name.
fn state_additions(reading: &mut Reading, rooms: &[Planned]) {
    let mut added: Vec<(&str, u32)> = Vec::new();
    for room in rooms.iter().filter(|r| !r.requested) {
        match added.iter_mut().find(|a| a.0 == room.kind.label) {
            Some(known) => known.1 += 1,
            None => added.push((&room.kind.label, 1)),
        }
    }
    if added.is_empty() {
        return;
    }
    let list: Vec<String> = added.iter().map(|(label, n)| format!("{n} {}", label.to_lowercase())).collect();
    let message = format!("rooms added from program {}: {}", reading.program.id, list.join(", "));
    reading.assumptions.push(note("rooms_added", message));
}
