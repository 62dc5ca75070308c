//! Rooms, and what is said of them: their places, what is in them, what some of them are like.

use std::rc::Rc;

use d3dgen_model::brief::{
    AskedCount, CapacityAsk, Fact, ObjectsAsk, PlaceKind, RelationAsk, RelationKind, RoomsAsk, StyleAsk, Subject,
};

use super::values::{attributes, by_sex, count, half, household, measure, number, places_of, several, sides};
use super::{Around, Maker, Stated};
use crate::node::Node;

impl Maker<'_> {
    pub(super) fn rooms(&mut self, node: &Node, around: Around) {
        for suite in node.all("suite") {
            let ids = suite.values("suite").next().unwrap_or_default().to_owned();
            for id in ids.split('+') {
                let room = Subject::known(id, self.reading.written(suite.tokens.clone()));
                let count = count(node).unwrap_or_default();
                self.say(node, Fact::Rooms(RoomsAsk { room, count, level: around.level(), ..RoomsAsk::default() }));
            }
        }
        if let Some(suite) = node.field("suite") {
            return self.inside_suite(node, suite);
        }
        if self.reads_otherwise(node) || self.reads_as_stations(node) {
            return;
        }
        let mut room = self.known.subject(node, "room", self.reading);
        if let Some(kind) = node.field("kind") {
            room.id = self.known.main_room(kind);
        }
        let asked = count(node);
        let count = asked.or_else(|| several(node, &["room", "own"])).unwrap_or_default();
        // "1.5 baths": one bathroom, and half of one
        let half = half(node).and_then(|n| Some((n, room.id.as_deref().and_then(|id| self.known.half_of(id))?)));
        let count = half.as_ref().map_or(count, |(n, _)| AskedCount { n: *n, ..count });
        if let Some((n, id)) = half {
            let room = Subject::known(&id, &room.name);
            self.say(node, Fact::Rooms(RoomsAsk { room, count: AskedCount::exactly(1), ..RoomsAsk::default() }));
            if n == 0 {
                return;
            }
        }
        let count = self.without_part(node, &room, count);
        let several = count.n > 1;
        let mut ask = RoomsAsk {
            room: room.clone(),
            count,
            area_m2: node.field("area").and_then(|a| measure(a, "area")),
            sides_m: sides(node),
            level: self.level_of(node, around),
            attributes: attributes(node),
            ..RoomsAsk::default()
        };
        let with = if node.field("some").is_none() { node.all("with").cloned().collect() } else { Vec::new() };
        let (mut each, inside): (Vec<Rc<Node>>, Vec<Rc<Node>>) =
            with.into_iter().partition(|n| several && n.is("rooms", Some("bare")));
        each.extend(node.all("with_each").filter(|n| self::count(n).is_none_or(|c| c.n == 1)).cloned());
        ask.each = each.first().map(|n| self.subject(n));
        // "a bedroom for each of the four children"
        if let Some(all) = node.field("each_of").and_then(|people| self::count(people)) {
            ask.count = all;
        }
        let whose =
            node.all("own").filter(|o| !o.is_unknown() && (o.is("person", None) || o.is("attribute", None))).count();
        if whose > 1 && asked.is_none() && node.field("room").is_some() {
            ask.count = AskedCount::at_least(whose as u32);
        }
        if let Some(sex) = node.field("sex") {
            ask.count = by_sex(sex, asked, ask.count);
        }
        let own = node.field("own").is_some();
        let every = node.field("every").is_some();
        let mention = around.mention || every;
        self.facts.push(Stated { mention, own, ..Stated::new(node, Fact::Rooms(ask)) });
        self.some_of(node, &room, count);
        if room.id.is_none() {
            self.named_for(node, &room);
        }
        each.iter().skip(1).for_each(|more| self.one_each(more, &room, count));
        for held in node.all("hold") {
            self.held(held, &room, several);
        }
        for inner in &inside {
            self.inside(inner, &room, several || every);
        }
        node.all("other").for_each(|n| {
            self.state(n, Around::default());
        });
    }

    /// States what the rooms of a suite have in them, each in the room that such things stand in.
    fn inside_suite(&mut self, node: &Node, suite: &Node) {
        let ids = suite.values("suite").next().unwrap_or_default();
        let name = self.reading.written(suite.tokens.clone());
        for inner in node.all("with").chain(node.all("hold")) {
            let stands = |id: &&str| {
                inner.field("object").is_some_and(|o| self.known.thing_of(&Subject::known(id, name), o).is_some())
            };
            let Some(id) = ids.split('+').find(stands).or(ids.split('+').next()) else { continue };
            self.inside(inner, &Subject::known(id, name), false);
        }
    }

    /// States what a room that no lexicon has is named for: the machine of a "washing machine room".
    fn named_for(&mut self, node: &Node, room: &Subject) {
        for own in node.all("own") {
            let Some(id) = own.values("object").find(|id| self.known.objects.contains(*id)) else { continue };
            let object = Subject::known(id, self.reading.written(own.tokens.clone()));
            let asked = ObjectsAsk { object, room: Some(room.clone()), ..ObjectsAsk::default() };
            self.say(own, Fact::Objects(asked));
        }
    }

    /// States what is said of some of several rooms: their places, what they are like, a room that they come with.
    fn some_of(&mut self, node: &Node, room: &Subject, count: AskedCount) {
        let one = AskedCount::exactly(1);
        let some = node.field("some").map(|n| number(n).unwrap_or(one));
        for held in node.all("some_hold") {
            self.held_by(held, room, some.unwrap_or(one).n);
        }
        // "two rooms, one each for 10 and 20 people", "10人用と20人用の会議室": as many as there are numbers
        let told = node.all("one_hold").count() as u32;
        if told > count.n
            && let Some(rooms) = self.facts.iter_mut().rev().find_map(|f| match &mut f.fact {
                Fact::Rooms(rooms) if rooms.room == *room => Some(rooms),
                _ => None,
            })
        {
            rooms.count = AskedCount::exactly(told);
        }
        // "180, 110 and 64 seats": what is counted stands behind the last one
        let of = node.all("one_hold").last().and_then(|n| places_of(n)).unwrap_or_default();
        for held in node.all("one_hold") {
            self.held_by(held, room, 1);
            if let Some(Stated { fact: Fact::Capacity(capacity), .. }) = self.facts.last_mut() {
                capacity.of = of;
            }
        }
        if let (Some(count), Some(with)) = (some, node.field("with").cloned()) {
            self.one_each(&with, room, count);
        }
        for with in
            node.all("with_each").filter(|n| self::count(n).is_some_and(|c| c.n > 1)).cloned().collect::<Vec<_>>()
        {
            let each = self::count(&with).unwrap_or(one);
            self.one_each(&with, room, AskedCount { n: each.n.saturating_mul(count.n), ..count });
        }
        self.alike(node, room);
        let area_m2 = node.field("some_area").and_then(|a| measure(a, "area"));
        if area_m2.is_some() {
            let count = some.unwrap_or(one);
            self.say(
                node,
                Fact::Rooms(RoomsAsk { room: room.clone(), count, area_m2, among: true, ..RoomsAsk::default() }),
            );
        }
        node.all("some_with").for_each(|thing| self.in_some(thing, room, some.unwrap_or(one).n));
    }

    /// States things that stand in so many of several rooms: "3 bedrooms, one with a bunk bed".
    fn in_some(&mut self, thing: &Rc<Node>, room: &Subject, rooms: u32) {
        let at = self.facts.len();
        self.state(thing, Around::default());
        if let Some(Stated { fact: Fact::Objects(objects), .. }) = self.facts.get_mut(at) {
            objects.room.get_or_insert_with(|| room.clone());
            objects.count.n = objects.count.n.saturating_mul(rooms);
        }
    }

    /// States what some of the rooms are instead, and returns how many are left: "four bedrooms, one of them a study".
    fn without_part(&mut self, node: &Node, room: &Subject, count: AskedCount) -> AskedCount {
        let Some(part) = node.field("part").cloned() else { return count };
        self.state(&part, Around::default());
        let within = self.subject(&part);
        for inner in node.all("part_with") {
            self.inside(inner, &within, false);
        }
        let of_part = node.field("some").and_then(|n| number(n)).or_else(|| self::count(&part)).map_or(1, |c| c.n);
        let other = self.subject(&part);
        // "três quartos, um deles suíte": a suite has a bedroom, which is one of them
        let suites = part.all("suite").flat_map(|s| s.values("suite")).flat_map(|ids| ids.split('+'));
        let same =
            room.id.is_some() && (other.id == room.id || suites.into_iter().any(|id| Some(id) == room.id.as_deref()));
        AskedCount { n: if same { count.n } else { count.n.saturating_sub(of_part).max(1) }, ..count }
    }

    /// States rooms that are told by their places alone: "cinema with two halls, 120 and 60 seats".
    pub(super) fn rooms_of_places(&mut self, node: &Node) {
        let name = node.field("noun").map_or("", |n| self.reading.written(n.tokens.clone())).to_owned();
        let room = Subject { id: self.known.of_kind().map(str::to_owned), name };
        let count = count(node).unwrap_or_default();
        self.say(node, Fact::Rooms(RoomsAsk { room: room.clone(), count, ..RoomsAsk::default() }));
        self.some_of(node, &room, count);
    }

    /// Returns the storey of rooms: the one said amid their words, or around them.
    fn level_of(&self, node: &Node, around: Around) -> Option<i32> {
        let own = node.field("level").and_then(|level| self.storeys_named(level).first().copied());
        Around { storey: around.storey.or(own), ..around }.level()
    }

    /// States what some of several rooms are like: "20 rooms, 2 of them accessible".
    pub(super) fn alike(&mut self, node: &Node, room: &Subject) {
        let attributes: Vec<String> = node.all("like").map(|n| self.word_of(n)).collect();
        if attributes.is_empty() {
            return;
        }
        let count = node.field("some").and_then(|n| number(n)).unwrap_or(AskedCount::exactly(1));
        let ask = RoomsAsk { room: room.clone(), count, attributes, among: true, ..RoomsAsk::default() };
        self.say(node, Fact::Rooms(ask));
    }

    /// Returns the attribute that a word stands for, or the word itself.
    fn word_of(&self, node: &Node) -> String {
        let own = || self.reading.written(node.tokens.clone()).to_lowercase().replace(' ', "_");
        node.values("attribute").next().map_or_else(own, str::to_owned)
    }

    /// States the places of so many of several rooms.
    fn held_by(&mut self, held: &Node, room: &Subject, rooms: u32) {
        self.held(held, room, rooms > 1);
        if let Some(Stated { fact: Fact::Capacity(capacity), .. }) = self.facts.last_mut() {
            capacity.of_rooms = Some(rooms);
        }
    }

    /// States one more room that comes with each of others.
    fn one_each(&mut self, guest: &Rc<Node>, host: &Subject, count: AskedCount) {
        let room = self.subject(guest);
        self.say(guest, Fact::Rooms(RoomsAsk { room: room.clone(), count, ..RoomsAsk::default() }));
        self.say(guest, Fact::Relation(RelationAsk { a: room, relation: RelationKind::Door, b: host.clone() }));
    }

    /// States a room for each of so many people.
    pub(super) fn each_person(&mut self, node: &Node) {
        let people: Vec<Rc<Node>> = node.all("people").cloned().collect();
        let all = people.iter().find_map(|p| count(p));
        for part in people.iter().chain(node.all("item")) {
            let from = self.facts.len();
            self.state(part, Around::default());
            for stated in &mut self.facts[from..] {
                if let (Fact::Rooms(rooms), Some(all)) = (&mut stated.fact, all) {
                    rooms.count = all;
                }
            }
        }
    }

    /// States what every room has: each of the several that were named last.
    pub(super) fn every_room(&mut self, node: &Node) {
        let several = |f: &Stated| matches!(&f.fact, Fact::Rooms(r) if r.count.n > 1);
        let Some(at) = self.facts.iter().rposition(several) else { return self.other(node) };
        let mut with: Vec<Rc<Node>> = node.all("with").cloned().collect();
        let own = with.first().map(|n| self.subject(n));
        let stated = &mut self.facts[at];
        let Fact::Rooms(hosts) = &mut stated.fact else { return };
        let (host, count) = (hosts.room.clone(), hosts.count);
        if hosts.each.is_none() {
            hosts.each = own;
            stated.also = Some(node.tokens.clone());
            with.remove(0);
        }
        with.iter().for_each(|more| self.one_each(more, &host, count));
    }

    /// States what one of the rooms has: of the several that were named last.
    pub(super) fn some_room(&mut self, node: &Node) {
        let several = |f: &Stated| match &f.fact {
            Fact::Rooms(rooms) if rooms.count.n > 1 => Some(rooms.room.clone()),
            _ => None,
        };
        let Some(room) = self.facts.iter().rev().find_map(several) else { return self.other(node) };
        let rooms = node.field("some").and_then(|n| number(n)).map_or(1, |count| count.n);
        node.all("some_with").for_each(|thing| self.in_some(thing, &room, rooms));
    }

    /// States what a word is that names a room of other buildings, and an object or a manner of this one: "open plan" in a home.
    fn reads_otherwise(&mut self, node: &Node) -> bool {
        let Some(leaf) = node.field("room").cloned() else { return false };
        if self.known.rooms.is_empty() || leaf.values("room").any(|v| self.known.rooms.contains(v)) {
            return false;
        }
        if let Some(word) = leaf.values("attribute").next() {
            self.say(node, Fact::Style(StyleAsk { word: word.to_owned() }));
            return true;
        }
        false
    }

    /// States several of what one room has many of: "4 tills" are no four rooms to pay in.
    fn reads_as_stations(&mut self, node: &Node) -> bool {
        let Some(leaf) = node.field("room").cloned() else { return false };
        if count(node).is_none_or(|c| c.n < 2) {
            return false;
        }
        let Some(id) = self.known.station_of(&leaf) else { return false };
        self.object_of(node, &leaf, &id);
        true
    }

    /// States the object that a word names.
    fn object_of(&mut self, node: &Node, leaf: &Node, id: &str) {
        let object = Subject::known(id, self.reading.written(leaf.tokens.clone()));
        let count = count(node).unwrap_or_default();
        self.say(
            node,
            Fact::Objects(ObjectsAsk { object, count, attributes: attributes(node), ..ObjectsAsk::default() }),
        );
    }

    /// States what a room has in it or beside it: "bedroom with a desk", "pharmacy with a clean room".
    fn inside(&mut self, inner: &Rc<Node>, room: &Subject, several: bool) {
        match inner.made() {
            Some("rooms") => {
                self.state(inner, Around::default());
                let relation = RelationAsk { a: self.subject(inner), relation: RelationKind::Door, b: room.clone() };
                self.say(inner, Fact::Relation(relation));
            }
            Some("objects") => {
                let at = self.facts.len();
                self.state(inner, Around::default());
                if let Some(Stated { fact: Fact::Objects(objects), .. }) = self.facts.get_mut(at)
                    && objects.room.is_none()
                {
                    (objects.room, objects.each_room) = (Some(room.clone()), several);
                }
            }
            _ => self.held(inner, room, several),
        }
    }

    /// States the places of a room, or the things in it that are counted like places: "4 screens of 80 seats", "meeting room for ten".
    pub(super) fn held(&mut self, held: &Node, room: &Subject, several: bool) {
        let count = count(held).or_else(|| number(held)).or_else(|| household(held)).unwrap_or_default();
        let of = places_of(held).unwrap_or_default();
        if of == PlaceKind::Bicycles
            && let Some(id) = held.field("what").and_then(|what| self.known.thing_of(room, what))
        {
            let object = Subject::known(&id, self.reading.written(held.tokens.clone()));
            let asked =
                ObjectsAsk { object, count, room: Some(room.clone()), each_room: several, ..ObjectsAsk::default() };
            return self.say(held, Fact::Objects(asked));
        }
        let fact = CapacityAsk { of, count, room: Some(room.clone()), each_room: several, ..CapacityAsk::default() };
        self.say(held, Fact::Capacity(fact));
    }
}
