//! Facts of a brief, made of what the rules found.

mod robots;
mod rooms;
mod values;

use std::ops::Range;
use std::rc::Rc;

use d3dgen_language::Reading;
use d3dgen_model::brief::{
    AccessAsk, AreaAsk, AskedCount, CapacityAsk, Fact, ForbiddenAsk, ObjectsAsk, OnlyAsk, OtherAsk, PeopleAsk,
    PlaceKind, RelationAsk, RelationKind, RoomsAsk, SiteAsk, SiteKind, StoreysAsk, StyleAsk, Subject,
};

use self::values::{attributes, bound, count, household, measure, number, place_kind, relation_kind, several};
use crate::node::Node;
use crate::reader::is_same;
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
    /// True for rooms that the name of a home counts, "3-Zimmer-Wohnung": those that it names elsewhere are among them.
    pub counted: bool,
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
        let tokens = node.tokens.clone();
        Self { tokens, also: None, storey: None, fact, mention: false, own: false, counted: false }
    }
}

/// Makes facts of nodes.
pub(crate) struct Maker<'a> {
    pub reading: &'a Reading<'a>,
    pub known: Known<'a>,
    /// True where the first floor is the ground floor.
    pub first_is_ground: bool,
    pub facts: Vec<Stated>,
    /// Words of facts that others state: more work of robots that were named before.
    pub spoken_of: Vec<Range<usize>>,
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
            Some("lies") => self.relation(node, around),
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
            Some("does" | "does_more") => self.more_work(node),
            Some("kept_out") => self.more_kept_out(node),
            Some("each_group") => self.each_group(node),
            Some("each_person") => self.each_person(node),
            Some("every_room") => self.every_room(node),
            Some("some_room") => self.some_room(node),
            Some("fleet") => self.fleet(node),
            Some("shorthand_home") => self.shorthand(node),
            Some("style") => self.style(node),
            Some("site") => self.site(node),
            Some("access") => self.say(node, Fact::Accessible(AccessAsk::default())),
            Some("wish" | "hours") => self.other(node),
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
        let wish = || Fact::Other(OtherAsk { wish: self.reading.written(node.tokens.clone()).to_owned() });
        let so_high =
            |level: i32| StoreysAsk { count: AskedCount::at_least(1 + level.max(0) as u32), basement: level < 0 };
        let fact = match storey {
            Some(Storey::At(level)) => Fact::Storeys(so_high(level)),
            _ => wish(),
        };
        self.facts.push(Stated { storey, ..Stated::new(node, fact) });
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

    fn objects(&mut self, node: &Node) {
        let within = node.field("in").cloned();
        let mut ask = ObjectsAsk {
            object: self.known.object(node, self.reading),
            count: count(node).or_else(|| several(node, &["object"])).unwrap_or_default(),
            room: within.as_ref().map(|n| self.subject(n)),
            each_room: within.as_ref().is_some_and(|n| n.field("each").is_some() || count(n).is_some_and(|c| c.n > 1)),
            attributes: attributes(node),
        };
        // "one-way flow" is one of nothing
        if ask.object.id.is_none() && ask.count == AskedCount::exactly(1) {
            return self.other(node);
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
        let bare = node.field("bare").map(|_| AskedCount::default());
        let Some(count) = count.or(all).or(bare) else { return self.other(node) };
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
        let within = node.field("in").cloned();
        let named = node.field("room").map(|_| self.known.subject(node, "room", self.reading));
        let room = room.or_else(|| within.as_ref().map(|n| self.subject(n))).or_else(|| named.clone());
        let each_room =
            within.as_ref().is_some_and(|n| n.field("each").is_some() || self::count(n).is_some_and(|c| c.n > 1));
        self.say(node, Fact::Capacity(CapacityAsk { of, count, room, each_room, groups, ..CapacityAsk::default() }));
        if let Some(within) = within {
            self.state(&within, Around { mention: true, ..Around::default() });
        }
        if let Some(room) = named {
            let asked = Fact::Rooms(RoomsAsk { room, ..RoomsAsk::default() });
            self.facts.push(Stated { mention: true, ..Stated::new(node, asked) });
        }
        self.some_places(node, of);
    }

    /// States that some of the places that were counted are elsewhere, or different: "davon 2 in Isolationszimmern".
    fn some_places(&mut self, node: &Node, of: PlaceKind) {
        let count = node.field("some").and_then(|n| number(n)).unwrap_or(AskedCount::exactly(1));
        if let Some(within) = node.field("part_in").cloned() {
            let room = Some(self.subject(&within));
            self.say(node, Fact::Capacity(CapacityAsk { of, count, room, among: true, ..CapacityAsk::default() }));
            self.mention(&within, Around::default());
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

    /// States a room or an object that is only spoken of.
    fn mention(&mut self, node: &Rc<Node>, around: Around) {
        let from = self.facts.len();
        self.state(node, Around { mention: true, ..around });
        self.facts[from..].iter_mut().for_each(|f| f.mention = true);
    }

    fn relation(&mut self, node: &Node, around: Around) {
        let Some(word) = node.field("relation").cloned() else { return self.other(node) };
        let Some(kind) = relation_kind(&word) else { return self.other(node) };
        // "the desk visible from the ward": the ward sees it
        let seen = word.values("relation").next() == Some("seen");
        let denied = node.field("not").is_some();
        let kind = match (kind, denied) {
            (RelationKind::Door | RelationKind::OpenTo | RelationKind::OnlyFrom, true) => RelationKind::NotFrom,
            (RelationKind::NextTo | RelationKind::Sees | RelationKind::Faces, true) => RelationKind::AwayFrom,
            (RelationKind::AwayFrom, true) => RelationKind::NextTo,
            (kind, _) => kind,
        };
        let firsts: Vec<Rc<Node>> = node.all("a").cloned().collect();
        let (there, seconds): (Vec<Rc<Node>>, Vec<Rc<Node>>) =
            node.all("b").cloned().partition(|n| n.is("particle", Some("there")));
        let mut pairs: Vec<(Subject, Subject)> = Vec::new();
        if !there.is_empty() || node.field("there").is_some() {
            let Some(first) = firsts.first().map(|a| self.subject(a)) else { return self.other(node) };
            let Some(before) = self.spoken_of_before(&first) else { return self.other(node) };
            pairs.push((first, before));
        } else if seconds.is_empty() {
            // "kitchen and living room next to each other"
            pairs.extend(firsts.windows(2).map(|w| (self.subject(&w[0]), self.subject(&w[1]))));
        }
        for a in &firsts {
            pairs.extend(seconds.iter().map(|b| (self.subject(a), self.subject(b))));
        }
        firsts.iter().chain(&seconds).for_each(|n| {
            // a room with a number or for the first time is asked for, else spoken of
            if n.is("rooms", Some("counted")) {
                self.state(n, around);
            } else {
                self.mention(n, around)
            }
        });
        for (a, b) in pairs {
            let (a, b) = if seen { (b, a) } else { (a, b) };
            self.say(node, Fact::Relation(RelationAsk { a: a.clone(), relation: kind, b: b.clone() }));
            if let Some(relation) = node.field("again").and_then(|r| relation_kind(r)) {
                let b = node.field("again_b").map_or(b, |n| self.subject(n));
                self.say(node, Fact::Relation(RelationAsk { a, relation, b }));
            }
        }
    }

    /// Returns the room that "there" or "beside it" means, said of a room: the one that it was said to lie at just before, else the
    /// one that was named last.
    fn spoken_of_before(&self, of: &Subject) -> Option<Subject> {
        let related = self.facts.last().and_then(|f| match &f.fact {
            Fact::Relation(r) if is_same(&r.a, of) => Some(&r.b),
            _ => None,
        });
        let named = self.facts.iter().rev().find_map(|f| match &f.fact {
            Fact::Rooms(rooms) if !is_same(&rooms.room, of) => Some(&rooms.room),
            _ => None,
        });
        related.or(named).cloned()
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
        if node.field("one_hold").is_some() {
            return self.rooms_of_places(node);
        }
        let rooms = count(node).map(|c| c.n);
        self.say(node, Fact::Only(OnlyAsk { rooms, closed: false }));
        let noun = node.field("noun").map_or("", |n| self.reading.written(n.tokens.clone()));
        self.alike(node, &Subject::unknown(noun));
    }

    fn shorthand(&mut self, node: &Node) {
        let area_m2 = node.field("area").and_then(|a| measure(a, "area"));
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
                    // "un bureau de cinq pièces": rooms of any kind, where nobody lives
                    let lives = |id: &str| self.known.rooms.is_empty() || self.known.rooms.contains(id);
                    if counted && ids.split_once("-1").is_some_and(|(id, _)| !lives(id)) {
                        self.say(node, Fact::Only(OnlyAsk { rooms: Some(n), closed: false }));
                        continue;
                    }
                    for (i, id) in ids.split('+').enumerate().skip(usize::from(!counted)) {
                        // "bedroom-1": one less than the number, "bedroom*3": so many by itself
                        let (id, less) = id.strip_suffix("-1").map_or((id, 0), |id| (id, 1));
                        let (id, times) = id.split_once('*').map_or((id, None), |(id, t)| (id, t.parse().ok()));
                        let n = times.unwrap_or(if i == 0 { n.saturating_sub(less) } else { 1 });
                        if n > 0 {
                            let room = Subject::known(id, self.reading.written(node.tokens.clone()));
                            let count = AskedCount::exactly(n);
                            let rooms = Fact::Rooms(RoomsAsk { room, count, area_m2, ..RoomsAsk::default() });
                            self.facts.push(Stated { counted: true, ..Stated::new(node, rooms) });
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
