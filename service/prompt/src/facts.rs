//! Facts of a brief, made of what the rules found.

use std::ops::Range;
use std::rc::Rc;

use d3dgen_language::Reading;
use d3dgen_model::brief::{
    AccessAsk, AreaAsk, AskedCount, AskedTask, Bound, CapacityAsk, Fact, ForbiddenAsk, ObjectsAsk, OnlyAsk, OtherAsk,
    PeopleAsk, PlaceKind, RelationAsk, RelationKind, RobotsAsk, RoomsAsk, SiteAsk, SiteKind, StoreysAsk, StyleAsk,
    Subject,
};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::node::Node;
use crate::subjects::Known;

/// Parents of a family with children.
const PARENTS: u32 = 2;
/// People of a family of which no more is said, at least.
const FAMILY: u32 = 3;

/// A fact with its words.
#[derive(Debug, Clone)]
pub(crate) struct Stated {
    pub tokens: Range<usize>,
    /// Words that say something of it from elsewhere: the storey of a list.
    pub also: Option<Range<usize>>,
    /// The storeys that those words name, where they do.
    pub storey: Option<Storey>,
    pub fact: Fact,
    /// True when the words only speak of a room or an object that others ask for.
    pub mention: bool,
    /// True for a room with words of its own: "an office for the boss".
    pub own: bool,
}

/// Storeys that words name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Storey {
    /// 0 at the ground.
    At(i32),
    /// The highest, of how many there are.
    Top,
    /// All of them.
    Each,
}

impl Stated {
    fn new(node: &Node, fact: Fact) -> Self {
        Self { tokens: node.tokens.clone(), also: None, storey: None, fact, mention: false, own: false }
    }
}

/// Makes facts of nodes.
pub(crate) struct Maker<'a> {
    pub reading: &'a Reading<'a>,
    pub known: Known<'a>,
    /// True where the first floor is the ground floor.
    pub first_is_ground: bool,
    pub facts: Vec<Stated>,
}

/// What a room gets from around it.
#[derive(Debug, Clone, Copy, Default)]
struct Around {
    storey: Option<Storey>,
    mention: bool,
}

impl Around {
    fn level(self) -> Option<i32> {
        match self.storey? {
            Storey::At(level) => Some(level),
            Storey::Top | Storey::Each => None,
        }
    }
}

impl Maker<'_> {
    /// Adds the facts of a node; returns false when it states none.
    pub fn add(&mut self, node: &Rc<Node>) -> bool {
        self.state(node, Around::default())
    }

    fn state(&mut self, node: &Node, around: Around) -> bool {
        match node.made() {
            Some("rooms") => self.rooms(node, around),
            Some("objects") => self.objects(node),
            Some("capacity") => self.capacity(node, None),
            Some("people") => self.people(node),
            Some("robots") => self.robots(node),
            Some("lies") => self.relation(node),
            Some("forbidden") => self.forbidden(node),
            Some("storeys") => self.storeys(node),
            Some("area") => self.area(node),
            Some("total_area") => node.all("area").for_each(|n| self.area(n)),
            Some("total") => self.total(node),
            Some("only") => {
                self.say(node, Fact::Only(OnlyAsk { rooms: None, closed: true }));
                node.all("item").for_each(|n| {
                    self.state(n, around);
                });
            }
            Some("on_storey") => self.on_storey(node, around),
            Some("storey_ref") => self.storey_alone(node),
            Some("does" | "does_more") => self.work_of_nobody(node),
            Some("each_group") => self.each_group(node),
            Some("each_person") => self.each_person(node),
            Some("every_room") => self.every_room(node),
            Some("fleet") => self.fleet(node),
            Some("shorthand_home") => self.shorthand(node),
            Some("style") => self.style(node),
            Some("site") => self.site(node),
            Some("access") => self.say(node, Fact::Accessible(AccessAsk::default())),
            Some("wish") => self.other(node),
            _ => return false,
        }
        true
    }

    fn say(&mut self, node: &Node, fact: Fact) {
        self.facts.push(Stated::new(node, fact));
    }

    /// States rooms and more once for each storey that is named before or behind them.
    fn on_storey(&mut self, node: &Node, around: Around) {
        let items: Vec<Rc<Node>> = node.all("item").cloned().collect();
        let levels: Vec<(Rc<Node>, Storey)> =
            node.all("level").flat_map(|l| self.storeys_named(l).into_iter().map(|s| (l.clone(), s))).collect();
        let storeys = levels.len() as u32;
        for (at, (level, storey)) in levels.into_iter().enumerate() {
            let from = self.facts.len();
            // places have no storey: "40 desks each" on two are 80
            let again = |item: &Rc<Node>| at > 0 && item.made() == Some("capacity");
            for item in items.iter().filter(|i| !again(i)) {
                self.state(item, Around { storey: Some(storey), ..around });
            }
            for stated in &mut self.facts[from..] {
                (stated.also, stated.storey) = (Some(level.tokens.clone()), Some(storey));
                if let (Fact::Capacity(capacity), Some(_)) = (&mut stated.fact, node.field("every"))
                    && capacity.room.is_none()
                {
                    capacity.count.n = capacity.count.n.saturating_mul(storeys);
                }
            }
        }
    }

    /// States a storey that nothing is said to lie on.
    fn storey_alone(&mut self, node: &Node) {
        let storey = self.storeys_named(node).first().copied();
        let wish = self.reading.written(node.tokens.clone()).to_owned();
        self.facts.push(Stated { storey, ..Stated::new(node, Fact::Other(OtherAsk { wish })) });
    }

    /// States the rooms and things of work that no robot is found for.
    fn work_of_nobody(&mut self, node: &Node) {
        for (_, part) in node.fields.iter().filter(|(name, _)| ["what", "from", "to", "at"].contains(&&**name)) {
            self.state(part, Around::default());
        }
    }

    /// Returns the storeys that words name.
    fn storeys_named(&self, level: &Node) -> Vec<Storey> {
        if level.field("each").is_some() {
            return vec![Storey::Each];
        }
        let named = level.field("named").into_iter().flat_map(|n| n.values("storey"));
        let named: Vec<Storey> = named
            .filter_map(|v| match v {
                "ground" => Some(Storey::At(0)),
                "upper" => Some(Storey::At(1)),
                "basement" => Some(Storey::At(-1)),
                "top" => Some(Storey::Top),
                _ => None,
            })
            .take(1)
            .collect();
        if !named.is_empty() {
            return named;
        }
        let from_ground = self.first_is_ground || level.field("from_one").is_some();
        let nth = level.all("nth").filter_map(|nth| {
            let n = nth.values("ordinal").find_map(|v| v.parse::<i32>().ok()).or(nth.number.map(|n| n as i32))?;
            Some(Storey::At(if from_ground && n > 0 { n - 1 } else { n }))
        });
        nth.collect()
    }

    fn subject(&self, node: &Node) -> Subject {
        self.known.any(node, self.reading)
    }

    fn rooms(&mut self, node: &Node, around: Around) {
        for suite in node.all("suite") {
            let ids = suite.values("suite").next().unwrap_or_default().to_owned();
            for id in ids.split('+') {
                let room = Subject::known(id, self.reading.written(suite.tokens.clone()));
                let count = count(node).unwrap_or_default();
                self.say(node, Fact::Rooms(RoomsAsk { room, count, level: around.level(), ..RoomsAsk::default() }));
            }
        }
        if node.field("suite").is_some() {
            return;
        }
        if self.reads_otherwise(node) {
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
        let several = count.n > 1;
        let mut ask = RoomsAsk {
            room: room.clone(),
            count,
            area_m2: node.field("area").and_then(|a| measure(a, "area")),
            sides_m: sides(node),
            level: around.level(),
            attributes: attributes(node),
            ..RoomsAsk::default()
        };
        let some = node.field("some").and_then(|n| number(n));
        let with = if some.is_none() { node.all("with").cloned().collect() } else { Vec::new() };
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
        self.facts.push(Stated { mention: around.mention, own, ..Stated::new(node, Fact::Rooms(ask)) });
        self.some_of(node, &room, count);
        if room.id.is_none() {
            self.named_for(node, &room);
        }
        each.iter().skip(1).for_each(|more| self.one_each(more, &room, count));
        for held in node.all("hold") {
            self.held(held, &room, several);
        }
        for inner in &inside {
            self.inside(inner, &room, several);
        }
        node.all("other").for_each(|n| {
            self.state(n, Around::default());
        });
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
    }

    /// States what some of several rooms are like: "20 rooms, 2 of them accessible".
    fn alike(&mut self, node: &Node, room: &Subject) {
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
    fn each_person(&mut self, node: &Node) {
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
    fn every_room(&mut self, node: &Node) {
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
        let Some(id) = leaf.values("object").find(|v| self.known.objects.contains(*v)) else { return false };
        let object = Subject::known(id, self.reading.written(leaf.tokens.clone()));
        let count = count(node).unwrap_or_default();
        self.say(
            node,
            Fact::Objects(ObjectsAsk { object, count, attributes: attributes(node), ..ObjectsAsk::default() }),
        );
        true
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
                self.state(inner, Around::default());
                if let Some(Stated { fact: Fact::Objects(objects), .. }) = self.facts.last_mut() {
                    objects.room = Some(room.clone());
                    objects.each_room = several;
                }
            }
            _ => self.held(inner, room, several),
        }
    }

    /// States the places of a room: "4 screens of 80 seats", "meeting room for ten".
    fn held(&mut self, held: &Node, room: &Subject, several: bool) {
        let count = count(held).or_else(|| number(held)).or_else(|| household(held)).unwrap_or_default();
        let of = places_of(held).unwrap_or_default();
        let fact = CapacityAsk { of, count, room: Some(room.clone()), each_room: several, ..CapacityAsk::default() };
        self.say(held, Fact::Capacity(fact));
    }

    fn objects(&mut self, node: &Node) {
        let within = node.field("in").cloned();
        let mut ask = ObjectsAsk {
            object: self.known.subject(node, "object", self.reading),
            count: count(node).or_else(|| several(node, &["object"])).unwrap_or_default(),
            room: within.as_ref().map(|n| self.subject(n)),
            each_room: within.as_ref().is_some_and(|n| n.field("each").is_some() || count(n).is_some_and(|c| c.n > 1)),
            attributes: attributes(node),
        };
        // "one-way flow" is one of nothing
        if ask.object.id.is_none() && ask.count == AskedCount::exactly(1) {
            return self.other(node);
        }
        if node.field("each_of").is_some() {
            ask.each_room = true;
        }
        if let Some(people) = node.field("hold").and_then(|held| count(held).or_else(|| number(held))) {
            self.known.size_for(&mut ask.object, people.n, &mut ask.attributes);
        }
        self.say(node, Fact::Objects(ask));
        if let Some(within) = within {
            self.state(&within, Around { mention: true, ..Around::default() });
        }
    }

    fn capacity(&mut self, node: &Node, room: Option<Subject>) {
        let groups = node.field("groups").and_then(|g| count(g)).map(|c| c.n);
        let what = node.field("what").map(|n| &**n);
        let kind = what.and_then(|w| w.values("capacity").find_map(place_kind));
        let held = node.field("of");
        let (count, of) = match held {
            // "4 groups of 12", "3 groups of 20 children"
            Some(held) => {
                let sleeps =
                    held.field("who").is_some_and(|w| ["resident", "patient"].iter().any(|v| w.is("person", Some(v))));
                let of = held.field("what").and_then(|w| w.values("capacity").find_map(place_kind));
                (
                    count(held).or_else(|| number(held)),
                    of.unwrap_or(if sleeps { PlaceKind::Beds } else { PlaceKind::Seats }),
                )
            }
            None => (count(node), kind.unwrap_or(PlaceKind::Seats)),
        };
        let all = node.field("all").and_then(|all| self::count(all));
        let Some(count) = count.or(all) else { return self.other(node) };
        // "48 children in 4 groups", "3 groups"
        if let Some(all) = all {
            let each = AskedCount { n: all.n.div_ceil(groups.unwrap_or(1).max(1)), ..all };
            let of = PlaceKind::Seats;
            return self.say(node, Fact::Capacity(CapacityAsk { of, count: each, groups, ..CapacityAsk::default() }));
        }
        if held.is_none() && what.is_some_and(|w| w.is("capacity", Some("group"))) {
            let (of, groups) = (PlaceKind::Seats, Some(count.n));
            let each = AskedCount::at_least(1);
            return self.say(node, Fact::Capacity(CapacityAsk { of, count: each, groups, ..CapacityAsk::default() }));
        }
        if what.is_some_and(|w| w.is("capacity", Some("locker"))) {
            let object = Subject::known("lockers", what.map_or("", |w| self.reading.written(w.tokens.clone())));
            return self.say(node, Fact::Objects(ObjectsAsk { object, count, ..ObjectsAsk::default() }));
        }
        let within = node.field("in").cloned();
        let room = room.or_else(|| within.as_ref().map(|n| self.subject(n)));
        let each_room =
            within.as_ref().is_some_and(|n| n.field("each").is_some() || self::count(n).is_some_and(|c| c.n > 1));
        self.say(node, Fact::Capacity(CapacityAsk { of, count, room, each_room, groups, ..CapacityAsk::default() }));
        if let Some(within) = within {
            self.state(&within, Around { mention: true, ..Around::default() });
        }
        self.some_places(node, of);
    }

    /// States that some of the places that were counted are elsewhere, or different: "davon 2 in Isolationszimmern".
    fn some_places(&mut self, node: &Node, of: PlaceKind) {
        let count = node.field("some").and_then(|n| number(n)).unwrap_or(AskedCount::exactly(1));
        if let Some(within) = node.field("part_in").cloned() {
            let room = Some(self.subject(&within));
            self.say(node, Fact::Capacity(CapacityAsk { of, count, room, among: true, ..CapacityAsk::default() }));
            self.mention(&within);
        }
        let likes: Vec<Range<usize>> = node.all("like").map(|n| n.tokens.clone()).collect();
        if let Some(end) = likes.last().map(|l| l.end) {
            let words = node.fields.iter().filter(|(name, _)| ["some", "like"].contains(&&**name));
            let start = words.map(|(_, n)| n.tokens.start).min().unwrap_or(node.tokens.start);
            let wish = self.reading.written(start..end).to_owned();
            self.facts.push(Stated { tokens: start..end, ..Stated::new(node, Fact::Other(OtherAsk { wish })) });
        }
    }

    /// States what every group has: one for each of the groups that were counted.
    fn each_group(&mut self, node: &Node) {
        if let Some(groups) = node.field("groups").cloned() {
            self.capacity(&groups, None);
        }
        let groups = self.facts.iter().rev().find_map(|f| match &f.fact {
            Fact::Capacity(c) => c.groups,
            _ => None,
        });
        let from = self.facts.len();
        node.all("item").for_each(|n| {
            self.state(n, Around::default());
        });
        for stated in &mut self.facts[from..] {
            stated.tokens.start = stated.tokens.start.min(node.tokens.start);
            if let (Fact::Rooms(rooms), Some(n)) = (&mut stated.fact, groups) {
                rooms.count = AskedCount::exactly(n);
            }
        }
    }

    fn people(&mut self, node: &Node) {
        let who = node.field("who");
        let role = who
            .and_then(|w| w.values("person").next())
            .unwrap_or(if household(node).is_some() { "resident" } else { "people" })
            .to_owned();
        if let Some(children) = node.field("children") {
            self.say(
                node,
                Fact::People(PeopleAsk { role: "resident".to_owned(), count: AskedCount::exactly(PARENTS) }),
            );
            return self.people(children);
        }
        if let Some(all) = node.field("all").and_then(|all| count(all)) {
            return self.say(node, Fact::People(PeopleAsk { role: "resident".to_owned(), count: all }));
        }
        if role == "family" {
            let role = "resident".to_owned();
            return self.say(node, Fact::People(PeopleAsk { role, count: AskedCount::at_least(FAMILY) }));
        }
        let count = count(node).or_else(|| household(node)).unwrap_or_default();
        self.say(node, Fact::People(PeopleAsk { role, count }));
    }

    /// States robots of several kinds: "2 cleaning and 3 delivery robots".
    fn fleet(&mut self, node: &Node) {
        let mut n = None;
        for (name, part) in &node.fields {
            match &**name {
                "n" => n = number(part),
                "kind" => {
                    let named = part.values("robot").next().or_else(|| part.values("task").next().map(kind_of_work));
                    let (kind, count) = (named.unwrap_or("service").to_owned(), n.take().unwrap_or_default());
                    self.say(node, Fact::Robots(RobotsAsk { kind, count, ..RobotsAsk::default() }));
                }
                _ => {}
            }
        }
    }

    fn robots(&mut self, node: &Node) {
        let kinds = node.all("robot").flat_map(|r| {
            r.values("robot").chain(r.values("task").map(kind_of_work)).map(str::to_owned).collect::<Vec<_>>()
        });
        let mut kinds: Vec<String> = kinds.collect();
        kinds.sort_by_key(|k| k == "any");
        let mut tasks: Vec<AskedTask> = node.all("does").filter_map(|d| self.task(d)).collect();
        if let Some(verb) = tasks.last().map(|t| t.verb.clone()) {
            tasks.extend(node.all("more").map(|d| self.task_of(&verb, d)));
        }
        if let Some(verb) = node.field("work_at").and_then(|_| kinds.first()).and_then(|k| work_of(k)) {
            let to = node.all("work_at").map(|n| self.subject(n)).collect();
            tasks.push(AskedTask { verb: verb.to_owned(), to, ..AskedTask::default() });
        }
        let verb = tasks.first().map(|t| t.verb.clone());
        let mut kind = kinds.into_iter().next().unwrap_or_else(|| "any".to_owned());
        if kind == "any" {
            // a robot is what it does
            kind = verb.map_or_else(|| "service".to_owned(), |v| kind_of_work(&v).to_owned());
        }
        let side = |which: &str| {
            node.all("size")
                .find(|s| s.field("which").is_some_and(|w| w.is("dimension", Some(which))))
                .and_then(|s| measure(s, "length"))
        };
        let bare = node.all("size").find(|s| s.field("which").is_none()).and_then(|s| measure(s, "length"));
        let round = side("diameter").or(side("radius").map(|r| 2.0 * r));
        let sides = sides(node);
        // "a robot vacuums the hall": a verb, no plural
        let several = || several(node, &["robot"]).filter(|_| node.field("work_at").is_none());
        let asked = count(node).or_else(several).unwrap_or_default();
        let keep_out =
            node.all("keep_out").flat_map(|k| k.all("item").map(|n| self.subject(n)).collect::<Vec<_>>()).collect();
        self.say(
            node,
            Fact::Robots(RobotsAsk {
                kind,
                count: asked,
                width_m: side("width").or(round).or(sides.map(|s| s[0])).or(bare),
                length_m: side("length").or(round).or(sides.map(|s| s[1])),
                height_m: side("height"),
                tasks,
                keep_out,
            }),
        );
        let works = node.all("does").chain(node.all("more"));
        let ends = works
            .flat_map(|d| d.all("from").chain(d.all("to")).chain(d.all("at")).cloned().collect::<Vec<_>>())
            .chain(node.all("work_at").cloned());
        let kept = node.all("keep_out").flat_map(|k| k.all("item").cloned().collect::<Vec<_>>());
        for end in ends.chain(kept).collect::<Vec<_>>() {
            self.mention(&end);
        }
    }

    fn task(&self, node: &Node) -> Option<AskedTask> {
        let verb = node.field("verb")?.values("task").next()?;
        Some(self.task_of(verb, node))
    }

    fn task_of(&self, verb: &str, node: &Node) -> AskedTask {
        let what: Vec<Range<usize>> = node.all("what").map(|w| w.tokens.clone()).collect();
        let what = what.into_iter().reduce(|a, b| a.start..b.end).map(|t| self.reading.written(t).to_owned());
        let to = node.all("to").chain(node.all("at")).map(|n| self.subject(n)).collect();
        AskedTask { verb: verb.to_owned(), what, from: node.field("from").map(|n| self.subject(n)), to }
    }

    /// States a room or an object that is only spoken of.
    fn mention(&mut self, node: &Rc<Node>) {
        let from = self.facts.len();
        self.state(node, Around { mention: true, ..Around::default() });
        self.facts[from..].iter_mut().for_each(|f| f.mention = true);
    }

    fn relation(&mut self, node: &Node) {
        let Some(kind) = node.field("relation").and_then(|r| relation_kind(r)) else { return self.other(node) };
        let denied = node.field("not").is_some();
        let kind = match (kind, denied) {
            (RelationKind::Door | RelationKind::OpenTo | RelationKind::OnlyFrom, true) => RelationKind::NotFrom,
            (RelationKind::NextTo | RelationKind::Sees | RelationKind::Faces, true) => RelationKind::AwayFrom,
            (RelationKind::AwayFrom, true) => RelationKind::NextTo,
            (kind, _) => kind,
        };
        let firsts: Vec<Rc<Node>> = node.all("a").cloned().collect();
        let seconds: Vec<Rc<Node>> = node.all("b").cloned().collect();
        let mut pairs: Vec<(Subject, Subject)> = Vec::new();
        if seconds.is_empty() {
            // "kitchen and living room next to each other"
            pairs.extend(firsts.windows(2).map(|w| (self.subject(&w[0]), self.subject(&w[1]))));
        }
        for a in &firsts {
            pairs.extend(seconds.iter().map(|b| (self.subject(a), self.subject(b))));
        }
        firsts.iter().chain(&seconds).for_each(|n| {
            // a room with a number or for the first time is asked for, else spoken of
            if n.is("rooms", Some("counted")) {
                self.state(n, Around::default());
            } else {
                self.mention(n)
            }
        });
        for (a, b) in pairs {
            let (a, b) = if kind == RelationKind::Sees && node.field("seen").is_some() { (b, a) } else { (a, b) };
            self.say(node, Fact::Relation(RelationAsk { a, relation: kind, b }));
        }
    }

    fn forbidden(&mut self, node: &Node) {
        let within = node.field("within").map(|n| self.subject(n));
        for item in node.all("item") {
            let subject = self.subject(item);
            // "no dead-end corridors" wants corridors, only none of that kind
            let some = subject.id.is_some() && ["own", "attribute"].iter().any(|f| item.field(f).is_some());
            if some {
                let wish = self.reading.written(node.tokens.clone()).to_owned();
                self.say(node, Fact::Other(OtherAsk { wish }));
                continue;
            }
            let basement = item.is("storey", Some("basement")) || item.is("storey_ref", Some("basement"));
            let (room, object) = match item.made() {
                _ if basement => (Some(subject), None),
                Some("rooms") => (Some(subject), None),
                Some("objects") => (None, Some(subject)),
                _ => (None, None),
            };
            let words = item.tokens.clone();
            let fact = match (room, object) {
                (None, None) => Fact::Other(OtherAsk { wish: self.reading.written(node.tokens.clone()).to_owned() }),
                (room, object) => Fact::Forbidden(ForbiddenAsk { room, object, within: within.clone() }),
            };
            let start = if item.tokens.start == words.start { node.tokens.start.min(words.start) } else { words.start };
            self.facts.push(Stated { tokens: start..words.end, ..Stated::new(item, fact) });
        }
    }

    fn storeys(&mut self, node: &Node) {
        let words =
            node.field("word").and_then(|w| w.values("storeys").find_map(|v| v.parse().ok())).map(AskedCount::exactly);
        let basement = node.field("basement").is_some();
        let count = count(node).or(words).unwrap_or_default();
        let count = node.field("plus").map_or(count, |p| AskedCount::exactly(1 + p.number.unwrap_or(1.0) as u32));
        self.say(node, Fact::Storeys(StoreysAsk { count, basement }));
    }

    fn area(&mut self, node: &Node) {
        match measure(node, "area") {
            Some(area_m2) => self.say(node, Fact::Area(AreaAsk { area_m2, bound: bound(node) })),
            None => self.other(node),
        }
    }

    fn total(&mut self, node: &Node) {
        let rooms = count(node).map(|c| c.n);
        self.say(node, Fact::Only(OnlyAsk { rooms, closed: false }));
        let noun = node.field("noun").map_or("", |n| self.reading.written(n.tokens.clone()));
        self.alike(node, &Subject::unknown(noun));
    }

    fn shorthand(&mut self, node: &Node) {
        // each part is a number and what it counts: rooms by id, with `+` between those that go together
        let mut number = None;
        for (name, part) in &node.fields {
            match &**name {
                "n" => number = part.number,
                "what" => {
                    let ids = part.values("shorthand").next().unwrap_or_default().to_owned();
                    // "an LDK" counts no bedrooms
                    let counted = number.is_some() || !ids.contains('+') || ids.contains('*');
                    let n = number.take().unwrap_or(1.0).clamp(0.0, 1000.0) as u32;
                    for (i, id) in ids.split('+').enumerate().skip(usize::from(!counted)) {
                        // "bedroom-1": one less than the number, "bedroom*3": so many by itself
                        let (id, less) = id.strip_suffix("-1").map_or((id, 0), |id| (id, 1));
                        let (id, times) = id.split_once('*').map_or((id, None), |(id, t)| (id, t.parse().ok()));
                        let n = times.unwrap_or(if i == 0 { n.saturating_sub(less) } else { 1 });
                        if n > 0 {
                            let room = Subject::known(id, self.reading.written(node.tokens.clone()));
                            self.say(
                                node,
                                Fact::Rooms(RoomsAsk { room, count: AskedCount::exactly(n), ..RoomsAsk::default() }),
                            );
                        }
                    }
                }
                _ => {}
            }
        }
    }

    fn style(&mut self, node: &Node) {
        let named: Vec<String> = node
            .all("word")
            .flat_map(|w| w.values("style").chain(w.values("attribute")).take(1).map(str::to_owned).collect::<Vec<_>>())
            .collect();
        for word in named {
            self.say(node, Fact::Style(StyleAsk { word }));
        }
    }

    fn site(&mut self, node: &Node) {
        let kind = node.field("word").and_then(|w| {
            w.values("site").find_map(|v| match v {
                "terraced" => Some(SiteKind::Terraced),
                "detached" => Some(SiteKind::FreeStanding),
                "semi_detached" => Some(SiteKind::SemiDetached),
                "corner" => Some(SiteKind::Corner),
                "inside" => Some(SiteKind::Inside),
                _ => None,
            })
        });
        match kind {
            Some(kind) => self.say(node, Fact::Site(SiteAsk { kind })),
            None => self.other(node),
        }
    }

    fn other(&mut self, node: &Node) {
        let wish = self.reading.written(node.tokens.clone()).to_owned();
        self.say(node, Fact::Other(OtherAsk { wish }));
        for inner in node.all("item").cloned().collect::<Vec<_>>() {
            self.state(&inner, Around::default());
        }
    }
}

/// Returns what places are counted.
fn places_of(held: &Node) -> Option<PlaceKind> {
    held.values("capacity")
        .chain(held.field("what").into_iter().flat_map(|w| w.values("capacity")))
        .find_map(place_kind)
}

/// Returns the number that a node has, as it binds.
fn count(node: &Node) -> Option<AskedCount> {
    let count = node.field("count")?;
    number(count)
}

/// Returns how many rooms are asked for that men and women have their own of: `told` where the prompt says a number.
fn by_sex(sex: &Node, told: Option<AskedCount>, count: AskedCount) -> AskedCount {
    let n = told.map_or(1, |c| c.n.max(1));
    match sex.values("sex").next() {
        // "one bathroom for each sex"
        Some("per") => AskedCount { n: 2 * n, ..count },
        // "two toilets for men and women"
        Some("each") => AskedCount { n: n.max(2), ..count },
        _ => count,
    }
}

/// Returns the whole of a number that ends in a half.
fn half(node: &Node) -> Option<u32> {
    let count = node.field("count")?;
    let n = count.number.or_else(|| count.field("n").and_then(|n| n.number))?;
    (n.fract() == 0.5 && n < 100.0).then_some(n as u32)
}

/// Returns the number of a plural without one.
fn several(node: &Node, fields: &[&str]) -> Option<AskedCount> {
    let noun = fields.iter().find_map(|f| if node.head_last { node.all(f).last() } else { node.field(f) })?;
    noun.plural.then_some(AskedCount::at_least(2))
}

fn number(count: &Node) -> Option<AskedCount> {
    if count.is("quantity", Some("several")) || count.field("several").is_some() {
        return Some(AskedCount::at_least(2));
    }
    // "4 Stellplätze für Löschfahrzeuge": the number of the places is that of the vehicles
    if let Some(inner) = count.field("count") {
        return number(inner);
    }
    let n = count.number.or_else(|| count.field("n").and_then(|n| n.number));
    let n = n.or_else(|| count.values("quantity").find_map(|v| v.parse().ok()))?;
    // "ein", "une": an article, or one
    if count.rule.is_none() && n == 1.0 && count.is("particle", Some("article")) {
        return None;
    }
    if !(0.0..=f64::from(u32::MAX)).contains(&n) {
        return None;
    }
    let most = count.field("most").and_then(|m| m.number);
    let (n, bound) = most.map_or((n, bound(count)), |_| (n, Bound::AtLeast));
    Some(AskedCount { n: n.ceil() as u32, bound })
}

fn household(node: &Node) -> Option<AskedCount> {
    let who = node.field("who").map_or(node, |w| w);
    who.values("household").find_map(|v| v.parse().ok()).map(AskedCount::exactly)
}

fn bound(node: &Node) -> Bound {
    let inner = node.field("count").map(|n| &**n);
    let of = |n: &Node| {
        [("at_least", Bound::AtLeast), ("at_most", Bound::AtMost), ("about", Bound::About)]
            .into_iter()
            .find(|(name, _)| n.field(name).is_some())
            .map(|b| b.1)
    };
    of(node).or_else(|| inner.and_then(of)).unwrap_or(Bound::Exactly)
}

/// Returns a measure in m or m2.
fn measure(node: &Node, class: &str) -> Option<f64> {
    if let Some(inner) = node.field(class).filter(|_| node.field("unit").is_none()) {
        return measure(inner, class);
    }
    let n = node.field("n")?;
    let n = n.number.or_else(|| n.field("n").and_then(|n| n.number))?;
    let unit = node.field("unit").and_then(|u| u.values(class).find_map(|v| v.parse::<f64>().ok())).unwrap_or(1.0);
    let value = n * unit;
    let (least, most) = if class == "area" { (0.5, 1e6) } else { (0.05, 500.0) };
    (least..=most).contains(&value).then_some(value)
}

fn sides(node: &Node) -> Option<[f64; 2]> {
    let sides = node.field("sides")?;
    let unit = sides.field("unit").and_then(|u| u.values("length").find_map(|v| v.parse::<f64>().ok())).unwrap_or(1.0);
    let side = |name: &str| {
        let node = sides.field(name)?;
        node.number.map(|n| n * unit).or_else(|| measure(node, "length")).filter(|s| (0.5..=500.0).contains(s))
    };
    Some([side("first")?, side("second")?])
}

fn attributes(node: &Node) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for attribute in node.all("attribute") {
        let value = attribute.values("attribute").next().map(str::to_owned);
        found.extend(value.into_iter().filter(|v| !found.contains(v)).collect::<Vec<_>>());
    }
    found
}

/// Work of robots, and the kind of robot that does it.
const WORK: &[(&str, &str)] = &[
    ("bring", "delivery"),
    ("clean", "cleaning"),
    ("disinfect", "disinfection"),
    ("serve", "service"),
    ("inspect", "inspection"),
    ("feed", "feeding"),
];

fn kind_of_work(verb: &str) -> &str {
    WORK.iter().find(|w| w.0 == verb).map_or(verb, |w| w.1)
}

fn work_of(kind: &str) -> Option<&'static str> {
    WORK.iter().find(|w| w.1 == kind).map(|w| w.0)
}

fn place_kind(value: &str) -> Option<PlaceKind> {
    from_name(match value {
        "seat" => "seats",
        "bed" => "beds",
        "desk" => "desks",
        "car" => "cars",
        "bike" => "bicycles",
        "animal" => "animals",
        "pallet" => "pallets",
        "place" => "treatment",
        other => other,
    })
}

fn relation_kind(node: &Node) -> Option<RelationKind> {
    let name = if node.senses.is_empty() { node.text.to_string() } else { node.values("relation").next()?.to_owned() };
    from_name(match name.as_str() {
        "near" | "around" | "together" => "next_to",
        "open" => "open_to",
        "apart" => "away_from",
        "sight" => "sees",
        other => other,
    })
}

/// Returns the value of an enum of the documents by its name there.
fn from_name<T: DeserializeOwned>(name: &str) -> Option<T> {
    serde_json::from_value(serde_json::Value::String(name.to_owned())).ok()
}

/// Returns a fact in one line, as the examples of rules and `--explain` have it.
pub(crate) fn shown(fact: &Fact) -> String {
    match fact {
        Fact::Rooms(asked) => shown_rooms(asked),
        Fact::Objects(o) => {
            let attributes: String = o.attributes.iter().map(|a| format!(" {a}")).collect();
            let room = shown_within(o.room.as_ref(), o.each_room);
            format!("objects {} {}{attributes}{room}", shown_count(&o.count), shown_subject(&o.object))
        }
        Fact::Capacity(c) => {
            let groups = c.groups.map_or(String::new(), |g| format!(" in {g} groups"));
            let room = shown_within(c.room.as_ref(), c.each_room);
            let room = c
                .of_rooms
                .map_or(room.clone(), |n| room.replace(" in ", &format!(" in {n} of ")).replace("of each ", "of "));
            let among = if c.among { "of " } else { "" };
            format!("capacity {} {among}{}{room}{groups}", shown_count(&c.count), named(&c.of))
        }
        Fact::Relation(r) => {
            format!("relation {} {} {}", shown_subject(&r.a), named(&r.relation), shown_subject(&r.b))
        }
        Fact::Storeys(s) => {
            format!("storeys {}{}", shown_count(&s.count), if s.basement { " and a basement" } else { "" })
        }
        Fact::Area(a) if a.bound == Bound::Exactly => format!("area {}", a.area_m2),
        Fact::Area(a) => format!("area {} {}", a.area_m2, named(&a.bound)),
        Fact::Robots(asked) => shown_robots(asked),
        Fact::People(p) => format!("people {} {}", shown_count(&p.count), p.role),
        Fact::Style(s) => format!("style {}", s.word),
        Fact::Accessible(a) => {
            format!("accessible{}", a.room.as_ref().map_or(String::new(), |r| format!(" {}", shown_subject(r))))
        }
        Fact::Forbidden(f) => {
            let what = f.room.iter().chain(&f.object).map(shown_subject).collect::<Vec<_>>().join(" ");
            format!("forbidden {what}{}", shown_within(f.within.as_ref(), false))
        }
        Fact::Only(o) => match (o.rooms, o.closed) {
            (Some(n), false) => format!("rooms in total {n}"),
            _ => "only these".to_owned(),
        },
        Fact::Site(s) => format!("site {}", named(&s.kind)),
        Fact::Other(o) => format!("other '{}'", o.wish),
    }
}

fn shown_rooms(r: &RoomsAsk) -> String {
    let among = if r.among { "of " } else { "" };
    let mut line = format!("rooms {} {among}{}", shown_count(&r.count), shown_subject(&r.room));
    r.area_m2.iter().for_each(|a| line += &format!(" {a} m2"));
    r.sides_m.iter().for_each(|s| line += &format!(" {} x {} m", s[0], s[1]));
    r.level.iter().for_each(|l| line += &format!(" level {l}"));
    r.attributes.iter().for_each(|a| line += &format!(" {a}"));
    r.each.iter().for_each(|e| line += &format!(" each {}", shown_subject(e)));
    line
}

fn shown_robots(r: &RobotsAsk) -> String {
    let mut line = format!("robots {} {}", shown_count(&r.count), r.kind);
    r.width_m.iter().for_each(|w| line += &format!(" {w} m wide"));
    r.length_m.iter().for_each(|w| line += &format!(" {w} m long"));
    for task in &r.tasks {
        line += &format!(" {}", task.verb);
        task.what.iter().for_each(|w| line += &format!(" '{w}'"));
        task.from.iter().for_each(|f| line += &format!(" from {}", shown_subject(f)));
        task.to.iter().for_each(|t| line += &format!(" to {}", shown_subject(t)));
    }
    r.keep_out.iter().for_each(|k| line += &format!(" not in {}", shown_subject(k)));
    line
}

fn shown_within(room: Option<&Subject>, each: bool) -> String {
    room.map_or(String::new(), |r| format!(" in {}{}", if each { "each " } else { "" }, shown_subject(r)))
}

fn shown_subject(subject: &Subject) -> String {
    subject.id.clone().unwrap_or_else(|| format!("'{}'", subject.name))
}

fn shown_count(count: &AskedCount) -> String {
    match count.bound {
        Bound::Exactly => count.n.to_string(),
        Bound::AtLeast => format!("{}+", count.n),
        Bound::AtMost => format!("{}-", count.n),
        Bound::About => format!("~{}", count.n),
    }
}

/// Returns the name that documents have for a value of an enum.
fn named<T: Serialize>(value: &T) -> String {
    serde_json::to_value(value).ok().and_then(|v| v.as_str().map(str::to_owned)).unwrap_or_default()
}
