//! The facts of a brief, sorted by what the building of rooms asks for.

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::brief::{
    Ask, AskedCount, Bound, Brief, CapacityAsk, Fact, ObjectsAsk, PlaceKind, RelationAsk, RelationKind, RoomsAsk,
    Subject,
};
use d3dgen_model::domain::{Domain, Occupants, Program, RoomType};
use d3dgen_model::offer;
use d3dgen_model::scene_graph::{Connector, Note};
use d3dgen_model::style::StyleWord;
use d3dgen_plugins::Registry;

use super::{
    GENERIC_ROOM_TYPE, Held, Thing, What, Wish, Wishes, facts_name_a_building, is_dwelling, program_of, roles, styles,
    what_of,
};
use crate::levels::storeys::{Storeys, Wanted};
use crate::people::beds::nearest;
use crate::people::seats::Called;
use crate::subject::programs::is_office;
use crate::tokens::storey::Where;
use crate::tokens::text::{Span, capital, fold};
use crate::tokens::words::words;
use crate::wished::relations::Spread;
use crate::wished::wishes::{Apart, Pair, PerHost};

/// Factors on the usual area of rooms that the words for their size stand for.
const SIZES: [(&str, f64); 2] = [("large", 1.4), ("small", 0.75)];
/// For how many rooms are that are said to be so.
const PEOPLE: [(&str, u32); 2] = [("single", 1), ("double", 2)];
/// Attribute of rooms that people in wheelchairs use.
const ACCESSIBLE: &str = "accessible";
/// Attribute of rooms with a door to the garden.
const GARDEN_DOOR: &str = "garden_door";
/// Most storeys above the ground, as for prompts.
const MOST_LEVELS: u32 = 12;
/// Most objects of one kind that one fact asks for.
const MOST_THINGS: u32 = 200;

/// Rooms to live in that a home is told by, at most.
const MOST_LIVED_IN: u32 = 12;

/// Number up to which "several" says no number.
const FEW: u32 = 2;
/// Beginning of the ids of rooms whose names have no letters for an id.
const OWN_ROOM: &str = "own_room";

/// Returns true for a number that is told.
fn is_told(count: AskedCount) -> bool {
    matches!(count.bound, Bound::Exactly | Bound::About | Bound::AtMost)
}

/// Returns the words of a name, without accents.
fn folded(name: &str) -> Vec<String> {
    name.split(|c: char| !c.is_alphanumeric()).map(fold).filter(|w| !w.is_empty()).collect()
}

/// Returns true for a name of which every word is one of another name.
fn is_part(name: &str, of: &str) -> bool {
    let of = folded(of);
    folded(name).iter().all(|w| of.contains(w) || w.strip_suffix('s').is_some_and(|one| of.iter().any(|o| o == one)))
}

/// Language of the names of room types on plans.
const PLAN_LANGUAGE: &str = "en";

/// What a brief asks for, sorted.
#[derive(Default)]
pub(super) struct Facts<'a> {
    pub wishes: Wishes,
    pub things: Vec<Thing>,
    /// Rooms with so many beds each.
    pub beds: Vec<Held>,
    /// Rooms with so many desks each.
    pub desks: Vec<Held>,
    /// Rooms with so many seats or counters each.
    pub seats: Vec<Held>,
    /// Rooms with so many places to be treated at each.
    pub stations: Vec<Held>,
    /// Head counts of the building.
    pub heads: Vec<(What, u32)>,
    /// Types of rooms of which no fact says how many there are.
    pub open: BTreeSet<String>,
    /// What the brief calls rooms that are not called as their type is.
    pub called: Vec<Called>,
    pub children: u32,
    pub styles: Vec<styles::Said>,
    pub area_m2: Option<f64>,
    pub accessible: bool,
    /// True when the rooms listed are all there are.
    pub closed: bool,
    /// True when the brief names no building, only a room.
    pub single: bool,
    /// True when the brief names a building, of which the rooms are a part.
    pub named: bool,
    /// Places of those counted that are in rooms of their own.
    elsewhere: u32,
    /// Storeys that are counted, and whether a basement is among them or beside.
    stated: Option<(u32, bool)>,
    /// Rooms on a storey.
    on_levels: Vec<Wanted>,
    /// Names of rooms that no domain knows and that are written in letters which no id has, in their order.
    own: Vec<String>,
    /// True where the brief speaks the language that plans name rooms in.
    in_plan_language: bool,
    /// For how many those rooms are that have no other name: beds or people.
    sized: BTreeMap<String, u32>,
    registry: Option<&'a Registry>,
    domain: Option<&'a Domain>,
    program: Option<&'a Program>,
}

/// Returns the id that a name is written as where its letters have a place in ids: `Abstellraum für Räder` is
/// `abstellraum_fur_rader`.
fn slug_of(name: &str) -> Option<String> {
    let plain = |word: String| word.chars().filter(char::is_ascii_alphanumeric).collect::<String>();
    let words: Vec<String> = folded(name).into_iter().map(plain).filter(|w| !w.is_empty()).collect();
    let slug = words.join("_");
    let told = name.chars().filter(|c| c.is_alphabetic()).count();
    let kept = slug.chars().filter(char::is_ascii_alphabetic).count();
    (kept > 0 && kept >= told).then_some(slug)
}

/// Returns for how many rooms are that no lexicon has and of which that is said, by what they are called.
fn sized_rooms(brief: &Brief) -> BTreeMap<String, u32> {
    let held = |a: &Ask| match &a.fact {
        Fact::Capacity(CapacityAsk { of, count, room, each_room, .. }) => {
            let room = room.as_ref().filter(|r| r.id.is_none())?;
            // a "prayer room for 20" has its name for something else, a "4-bed room" and the rooms of 15 children each have not
            let by_size = *each_room || room.name.contains(&count.n.to_string());
            let sized = match of {
                PlaceKind::Beds => true,
                PlaceKind::Seats | PlaceKind::Desks => by_size,
                _ => false,
            };
            sized.then(|| (room.name.clone(), count.n))
        }
        // "pokoje dwuosobowe"
        Fact::Rooms(rooms) if rooms.room.id.is_none() => {
            let of = |(word, n): &(&str, u32)| rooms.attributes.iter().any(|a| a == word).then_some(*n);
            PEOPLE.iter().find_map(of).map(|n| (rooms.room.name.clone(), n))
        }
        _ => None,
    };
    brief.asks.iter().filter_map(held).collect()
}

/// Returns the names of rooms that no domain knows and that make no id.
fn own_names(brief: &Brief) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    let rooms =
        brief.asks.iter().filter_map(|a| if let Fact::Rooms(rooms) = &a.fact { Some(&rooms.room) } else { None });
    for room in rooms.filter(|r| r.id.is_none() && slug_of(&r.name).is_none()) {
        if !names.contains(&room.name) {
            names.push(room.name.clone());
        }
    }
    names
}

impl<'a> Facts<'a> {
    pub(super) fn of(brief: &Brief, domain: &'a Domain, registry: &'a Registry) -> Self {
        let building_type = brief.building.as_ref().and_then(|b| b.building_type.as_deref());
        let program = Some(program_of(domain, building_type));
        let lives = program.is_some_and(is_dwelling);
        let named = facts_name_a_building(brief);
        let mut out = Self { named, single: !named, registry: Some(registry), program, ..Self::default() };
        out.own = own_names(brief);
        out.domain = Some(domain);
        out.in_plan_language = brief.languages.first().is_some_and(|l| l == PLAN_LANGUAGE);
        out.sized = sized_rooms(brief);
        let apart = brief.asks.iter().filter_map(|a| if let Fact::Capacity(c) = &a.fact { Some(c) } else { None });
        out.elsewhere = apart.filter(|c| c.among).map(|c| c.count.n).sum();
        // how many there are of a room is known before what is said of it
        for ask in &brief.asks {
            if let Fact::Rooms(rooms) = &ask.fact {
                out.rooms(rooms);
            }
        }
        for ask in &brief.asks {
            match &ask.fact {
                Fact::Objects(objects) => out.objects(objects),
                Fact::Capacity(capacity) => out.capacity(capacity),
                Fact::Relation(relation) => out.relation(relation),
                // who sees people has a room for it
                Fact::People(people) if domain.room_type(&people.role).is_some() => {
                    out.wish(&people.role, &people.role.replace('_', " "), people.count, is_told(people.count));
                }
                Fact::People(people) => {
                    if lives && roles().children.contains(&people.role) {
                        out.children += people.count.n;
                    }
                    // a hotel for families is not for one
                    if lives || people.count.bound != Bound::AtLeast {
                        out.head(what_of(people, lives), people.count.n);
                    }
                }
                Fact::Storeys(storeys) => {
                    // the cellar of a flat is a room of the house
                    let within = |id: &str| words().dwelling.within_a_storey.iter().any(|w| w == id);
                    let basement = storeys.basement && !building_type.is_some_and(within);
                    out.stated = Some((storeys.count.n, basement));
                }
                Fact::Area(area) => out.area_m2 = Some(area.area_m2),
                Fact::Style(style) => {
                    let at = Span { start: 0, end: 0 };
                    out.styles.extend(StyleWord::of(&style.word).map(|word| styles::Said { span: at, word }));
                }
                Fact::Accessible(_) => out.accessible = true,
                Fact::Forbidden(forbidden) => {
                    let room = forbidden.room.as_ref().map(|room| out.type_of(room));
                    out.wishes.forbidden.extend(room);
                }
                Fact::Only(only) => {
                    out.closed |= only.closed;
                    if let Some(n) = only.rooms {
                        out.total(n, brief, lives);
                    }
                }
                // whoever answers the asks tells of these
                Fact::Rooms(_) | Fact::Robots(_) | Fact::Site(_) | Fact::Other(_) => {}
            }
        }
        let wanted: Vec<String> = out.wishes.wishes.iter().map(|w| w.room_type.clone()).collect();
        out.wishes.forbidden.retain(|id| !wanted.contains(id));
        out
    }

    /// Plans a number of rooms in all: those that guests sleep in where the building is for guests, those to live in where people
    /// count these, else whatever such a building has.
    fn total(&mut self, n: u32, brief: &Brief, lives: bool) {
        let asleep = |id: &str| self.domain.and_then(|d| offer::sleeps(d, d.room_type(id)?)).is_some();
        let named: u32 = self.wishes.wishes.iter().filter(|w| asleep(&w.room_type)).map(|w| w.count).sum();
        if let Some(id) = self.program.and_then(|p| p.means.get(GENERIC_ROOM_TYPE)).cloned() {
            if n > named {
                self.wish(&id, &id.replace('_', " "), AskedCount::exactly(n - named), true);
            }
            return;
        }
        let of_home = brief.languages.first().is_some_and(|l| !roles().all_rooms_counted_in.contains(l));
        let bedroom = &words().dwelling.bedroom;
        if lives && of_home && !self.closed && named == 0 && (2..=MOST_LIVED_IN).contains(&n) {
            return self.wish(bedroom, &bedroom.replace('_', " "), AskedCount::exactly(n - 1), true);
        }
        self.heads.push((What::Total, n));
    }

    /// Returns the room type that a subject is planned as: the domain's, that of another domain, or one of its own name.
    pub(super) fn type_of(&self, subject: &Subject) -> String {
        if let Some(id) = &subject.id {
            // the pharmacy of a ward is its room for medicine
            let meant = self.program.and_then(|p| p.means.get(id));
            return meant.or_else(|| self.own_bedroom(id)).unwrap_or(id).clone();
        }
        if let Some(kind) = self.sized.get(&subject.name).and_then(|n| self.kind_for(*n)) {
            return kind.id.clone();
        }
        let numbered = || {
            let at = self.own.iter().position(|name| *name == subject.name)?;
            Some(format!("{OWN_ROOM}_{}", 1 + at))
        };
        slug_of(&subject.name).or_else(numbered).unwrap_or_else(|| GENERIC_ROOM_TYPE.to_owned())
    }

    /// Returns the types of rooms that robots are sent to by a name: the room's own, or those that have such objects.
    pub(super) fn rooms_at(&self, subject: &Subject) -> Vec<String> {
        let Some(domain) = self.domain else { return Vec::new() };
        let id = self.type_of(subject);
        if domain.room_type(&id).is_some() || self.wishes.wishes.iter().any(|w| w.room_type == id) {
            return vec![id];
        }
        let object = subject.id.as_deref().and_then(|id| domain.object(id));
        let hosts = |shape| domain.room_types.iter().filter(move |k| offer::has_shape(domain, k, &[shape]));
        object.into_iter().flat_map(|o| hosts(o.shape)).map(|k| k.id.clone()).collect()
    }

    /// Returns the room that the brief is about, where it asks for that one and names no building.
    pub(super) fn only_room(&self) -> Option<&Wish> {
        let [room] = &self.wishes.wishes[..] else { return None };
        let alone = self.single && room.count == 1 && self.heads.is_empty() && self.stated.is_none();
        (alone && self.wishes.per_host.is_empty() && self.wishes.forbidden.is_empty()).then_some(room)
    }

    /// Returns the room that one sleeps in there, for one that people sleep in elsewhere: a hotel has no patient rooms.
    fn own_bedroom(&self, id: &str) -> Option<&String> {
        let program = self.program?;
        let at_home = is_dwelling(program).then_some(&words().dwelling.bedroom);
        let own = program.means.get(GENERIC_ROOM_TYPE).or(at_home)?;
        let known = self.domain?.room_type(id).is_some();
        let sleeps = |d: &Domain| d.room_type(id).is_some_and(|k| offer::sleeps(d, k).is_some());
        (!known && self.registry?.iter().any(|p| sleeps(p.domain()))).then_some(own)
    }

    /// Returns the room of the building that so many have a bed or a desk in: a "4-bed room", "pokoje 2-osobowe".
    fn kind_for(&self, n: u32) -> Option<&'a RoomType> {
        let (domain, program) = (self.domain?, self.program?);
        if program.rooms.iter().any(|e| e.occupants == Occupants::Beds) || is_dwelling(program) {
            return nearest(domain, program, n);
        }
        let desks = |k: &RoomType| offer::desks(domain, k).filter(|_| offer::works_in(domain, k));
        let fits = |k: &&RoomType| desks(k).is_some_and(|[least, most]| (least..=most).contains(&n));
        let tightest = |k: &&RoomType| desks(k).map_or(u32::MAX, |d| d[1]);
        if is_office(program) {
            return domain.room_types.iter().filter(fits).min_by_key(tightest);
        }
        // the rooms of a kindergarten for so many are those that it is for
        self.main_room()
    }

    /// Counts people, beds or desks of the building; those of several groups together.
    fn head(&mut self, what: What, n: u32) {
        match self.heads.iter_mut().find(|(of, _)| *of == what) {
            Some((_, all)) => *all = all.saturating_add(n),
            None => self.heads.push((what, n)),
        }
    }

    /// Notes what the brief calls a room, where that is another word than its type has on a plan.
    fn call(&mut self, id: &str, asked: &RoomsAsk) {
        let name = asked.room.name.trim();
        let own = asked.room.id.is_none();
        let one = asked.count.n == 1;
        let kind = self.domain.and_then(|d| d.room_type_or_lent(id)).filter(|_| !own);
        let plain = |k: &RoomType| !self.in_plan_language || !one || [&k.label, &k.id].iter().any(|l| is_part(name, l));
        if name.is_empty() || kind.is_some_and(plain) || self.called.iter().any(|c| c.name == capital(name)) {
            return;
        }
        let at = Span { start: 0, end: 0 };
        self.called.push(Called { span: at, room_type: id.to_owned(), name: capital(name), count: asked.count.n });
    }

    /// Returns the beds of each room of a type, where the brief says so.
    pub(super) fn beds_of(&self, room_type: &str) -> Option<u32> {
        self.beds.iter().find(|h| h.room_type == room_type).map(|h| h.beds)
    }

    fn rooms(&mut self, asked: &RoomsAsk) {
        if asked.among {
            self.accessible |= asked.attributes.iter().any(|a| a == ACCESSIBLE);
            return;
        }
        let id = self.type_of(&asked.room);
        let area = asked.area_m2.or_else(|| asked.sides_m.map(|s| s[0] * s[1]));
        let size = SIZES.iter().find(|(word, _)| asked.attributes.iter().any(|a| a == word)).map(|s| s.1);
        let exact = is_told(asked.count) || asked.count.n == 1;
        self.wish(&id, &asked.room.name, asked.count, exact);
        if !is_told(asked.count) && asked.count.n <= FEW && asked.each.is_none() {
            self.open.insert(id.clone());
        }
        self.call(&id, asked);
        if let Some(wish) = self.wishes.wishes.iter_mut().find(|w| w.room_type == id) {
            (wish.area_m2, wish.size) = (wish.area_m2.or(area), wish.size.or(size));
            wish.sides_m = wish.sides_m.or(asked.sides_m);
        }
        if let Some(level) = asked.level {
            self.on_levels.push(Wanted { room_type: id.clone(), count: asked.count.n, at: Where::Level(level) });
        }
        for attribute in &asked.attributes {
            match attribute.as_str() {
                "open" => self.wishes.open.push(id.clone()),
                "separate" | "closed" => self.wishes.closed.push(id.clone()),
                GARDEN_DOOR => self.wishes.garden.push(id.clone()),
                ACCESSIBLE => self.accessible = true,
                _ => {}
            }
        }
        if let Some(each) = &asked.each {
            self.each(&id, each, asked.count);
        }
    }

    /// Wishes for a room that comes with each of others.
    fn each(&mut self, host: &str, guest: &Subject, hosts: AskedCount) {
        let guest_type = self.type_of(guest);
        let pair = Pair {
            a: guest_type.clone(),
            b: host.to_owned(),
            connector: Connector::Door,
            spread: Spread::Each,
            belongs: true,
            which: [None, None],
        };
        self.wishes.pairs.push(pair);
        if hosts.bound == Bound::Exactly {
            self.wish(&guest_type, &guest.name, hosts, true);
        } else {
            self.wishes.per_host.push(PerHost { guest: guest_type, host: Some(host.to_owned()) });
        }
    }

    /// Adds rooms of a type to those wished for.
    fn wish(&mut self, id: &str, name: &str, count: AskedCount, exact: bool) {
        self.open.remove(id);
        match self.wishes.wishes.iter_mut().find(|w| w.room_type == id) {
            Some(wish) => {
                wish.count = wish.count.saturating_add(count.n);
                wish.exact |= exact;
            }
            None => {
                let wish = Wish { count: count.n.max(1), exact, listed: true, ..Wish::one(id, name) };
                self.wishes.wishes.push(wish);
            }
        }
    }

    fn objects(&mut self, asked: &ObjectsAsk) {
        let Some(object) = asked.object.id.clone() else { return };
        if self.stations(&object, asked) {
            return;
        }
        // the till of a museum is its ticket desk
        if let Some(id) = self.counter_elsewhere(&object).filter(|_| asked.room.is_none()) {
            return self.wish(&id, &asked.object.name, AskedCount::exactly(1), true);
        }
        let room_type = asked.room.as_ref().map(|room| self.type_of(room));
        let times = if asked.each_room { 1 } else { asked.count.n.clamp(1, MOST_THINGS) };
        let thing = Thing { object, room_type, each: asked.each_room };
        self.things.extend(std::iter::repeat_n(thing, times as usize));
    }

    /// Returns the room that the building has in the place of the one that goes by an object of another trade.
    fn counter_elsewhere(&self, object: &str) -> Option<String> {
        let (domain, program) = (self.domain?, self.program?);
        let goes_by = |kind: &&RoomType| {
            let line = kind.furnishing.first().filter(|line| line.required);
            object.starts_with(&kind.id) && line.and_then(|l| domain.anchor(&l.item)).is_some_and(|o| o.id == object)
        };
        domain.room_types.iter().filter(goes_by).find_map(|kind| program.means.get(&kind.id)).cloned()
    }

    /// Gives so many of what one room has many of to that room: the tills of a checkout, the pumps of a forecourt. Returns false for
    /// all other objects.
    fn stations(&mut self, object: &str, asked: &ObjectsAsk) -> bool {
        let (Some(domain), n) = (self.domain, asked.count.n) else { return false };
        if !is_told(asked.count) || n < 2 || asked.each_room {
            return false;
        }
        let meant = asked.room.as_ref().map(|room| self.type_of(room));
        let has_many = |kind: &&RoomType| {
            let line = kind.furnishing.first().filter(|line| line.required && line.max > 1);
            let counted = offer::has_counters(domain, kind) || !kind.places.is_empty();
            let here = meant.as_ref().is_none_or(|id| *id == kind.id);
            here && counted && line.and_then(|line| domain.anchor(&line.item)).is_some_and(|o| o.id == object)
        };
        let wished = self.wishes.wishes.iter().filter_map(|w| domain.room_type(&w.room_type)).find(has_many);
        let program = self.program.iter().flat_map(|p| &p.rooms);
        let usual = || program.filter_map(|e| domain.room_type(&e.room_type)).find(has_many);
        let Some(kind) = wished.or_else(usual) else { return false };
        if wished.is_none() {
            self.wish(&kind.id, &kind.label, AskedCount::exactly(1), true);
        }
        let count = self.wishes.wishes.iter().find(|w| w.room_type == kind.id).map_or(1, |w| w.count.max(1));
        let held = Held { room_type: kind.id.clone(), count, beds: n.div_ceil(count) };
        let counters = offer::has_counters(domain, kind);
        self.hold(if counters { PlaceKind::Counters } else { PlaceKind::Treatment }, held);
        true
    }

    fn capacity(&mut self, asked: &CapacityAsk) {
        let whole = |of| match of {
            PlaceKind::Beds => Some(What::Beds),
            PlaceKind::Desks => Some(What::Desks),
            PlaceKind::Seats => Some(What::Visitors),
            _ => None,
        };
        let told = asked.count.bound != Bound::AtLeast;
        if let (Some(room), Some(n)) = (&asked.room, asked.of_rooms) {
            let held = Held { room_type: self.type_of(room), count: n, beds: asked.count.n };
            return self.hold(asked.of, held);
        }
        let all = if told { asked.count.n.saturating_mul(asked.groups.unwrap_or(1)) } else { 0 };
        let Some(room) = &asked.room else {
            if let Some(groups) = asked.groups.filter(|_| asked.of == PlaceKind::Seats) {
                self.house_groups(groups, told.then_some(asked.count.n));
            }
            if asked.of == PlaceKind::Treatment || asked.of == PlaceKind::Seats && self.is_for_treatment() {
                return self.treat(asked.count.n.saturating_sub(self.elsewhere));
            }
            if let Some(what) = whole(asked.of).filter(|_| all > 0) {
                self.head(what, all);
            }
            return;
        };
        let room_type = self.type_of(room);
        // "12 beds in double rooms": as many rooms as that takes
        if asked.of == PlaceKind::Beds
            && !asked.each_room
            && self.open.contains(&room_type)
            && self.sleeps(&room_type, asked.count.n)
        {
            return self.head(What::Beds, all);
        }
        let rooms = self.wishes.wishes.iter().find(|w| w.room_type == room_type).map_or(1, |w| w.count);
        let each = if asked.each_room { asked.count.n } else { asked.count.n.div_ceil(rooms.max(1)) };
        self.hold(asked.of, Held { room_type, count: rooms, beds: each });
    }

    /// Gives rooms so many places each.
    fn hold(&mut self, of: PlaceKind, held: Held) {
        match of {
            PlaceKind::Beds => self.beds.push(held),
            PlaceKind::Desks => {
                self.head(What::Desks, held.beds.saturating_mul(held.count));
                self.desks.push(held);
            }
            PlaceKind::Seats | PlaceKind::Counters => self.seats.push(held),
            PlaceKind::Treatment => self.stations.push(held),
            PlaceKind::Cars | PlaceKind::Bicycles | PlaceKind::Docks | PlaceKind::Animals | PlaceKind::Pallets => {}
        }
    }

    /// Gives each group the room that the building is for: a kindergarten of three groups has three group rooms.
    fn house_groups(&mut self, groups: u32, each: Option<u32>) {
        let Some(kind) = self.main_room() else { return };
        if !self.wishes.wishes.iter().any(|w| w.room_type == kind.id) {
            self.wish(&kind.id, &kind.label, AskedCount::exactly(groups), true);
        }
        self.seats.extend(each.map(|beds| Held { room_type: kind.id.clone(), count: groups, beds }));
    }

    /// Returns true where the room that the building is for has places to be treated at.
    fn is_for_treatment(&self) -> bool {
        self.main_room().zip(self.domain).is_some_and(|(kind, domain)| offer::places(domain, kind).is_some())
    }

    /// Gives so many places to be treated at to the room that the building is for.
    fn treat(&mut self, places: u32) {
        let Some(kind) = self.main_room() else { return };
        let rooms = self.wishes.wishes.iter().find(|w| w.room_type == kind.id).map_or(1, |w| w.count);
        let beds = places.div_ceil(rooms.max(1));
        self.stations.push(Held { room_type: kind.id.clone(), count: rooms, beds });
    }

    /// Returns the room that the building is for, where nobody lives.
    fn main_room(&self) -> Option<&'a RoomType> {
        let entry = self.program.filter(|p| !is_dwelling(p))?.rooms.first()?;
        self.domain?.room_type(&entry.room_type)
    }

    /// Returns true for rooms to sleep in that hold fewer than so many.
    fn sleeps(&self, room_type: &str, beds: u32) -> bool {
        let held = self.domain.and_then(|d| offer::sleeps(d, d.room_type(room_type)?));
        held.is_some_and(|[_, most]| most < beds)
    }

    fn relation(&mut self, asked: &RelationAsk) {
        let (a, b) = (self.type_of(&asked.a), self.type_of(&asked.b));
        let wished = |id: &String| self.wishes.wishes.iter().any(|w| &w.room_type == id);
        let is_room = |subject: &Subject, id: &String| {
            let known = self.registry.is_some_and(|r| r.iter().any(|p| p.domain().room_type(id).is_some()));
            subject.id.is_some() && known || wished(id)
        };
        if !is_room(&asked.a, &a) || !is_room(&asked.b, &b) || a == b {
            return;
        }
        let connector = match asked.relation {
            RelationKind::AwayFrom | RelationKind::NotFrom => {
                self.wishes.apart.push(Apart { rooms: [a, b], which: [None, None] });
                return;
            }
            RelationKind::Door | RelationKind::OnlyFrom => Connector::Door,
            RelationKind::OpenTo => Connector::Open,
            RelationKind::NextTo | RelationKind::Between => Connector::Wall,
            RelationKind::Sees | RelationKind::Faces => Connector::Near,
            RelationKind::Above => return,
        };
        let belongs = asked.relation == RelationKind::OnlyFrom;
        self.wishes.pairs.push(Pair { a, b, connector, spread: Spread::Each, belongs, which: [None, None] });
    }

    /// Returns the storeys of the building, from the lowest.
    pub(super) fn storeys(&self, conflicts: &mut Vec<Note>) -> Storeys {
        let levels = || self.on_levels.iter().filter_map(|w| if let Where::Level(n) = w.at { Some(n) } else { None });
        let (stated, basement) = self.stated.unwrap_or((0, false));
        if stated > MOST_LEVELS {
            let message = format!("{stated} storeys were asked for; one world has 1 to {MOST_LEVELS}");
            conflicts.push(Note::new("impossible_storeys", message));
        }
        let stated = if stated > MOST_LEVELS { 0 } else { stated as i32 };
        let top = levels().max().unwrap_or(0).max(stated - 1).max(0);
        let lowest = levels().min().unwrap_or(0).min(if basement { -1 } else { 0 });
        let several = top > 0 || lowest < 0;
        Storeys {
            levels: if several { (lowest..=top).collect() } else { vec![0] },
            wanted: if several { self.on_levels.clone() } else { Vec::new() },
            bare_basement: basement && !levels().any(|l| l < 0),
            ..Storeys::default()
        }
    }
}
