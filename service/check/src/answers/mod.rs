//! What became of everything that the brief asks for: each fact measured in the finished world, from its documents alone.
//!
//! A fact is honored when the world has what it says, whoever put it there. What is not there as asked is answered with what
//! is there instead, or with the reason; what no document can tell is said to be left out, never to be there.

mod places;
mod relations;
mod subjects;
mod whole;

use std::collections::BTreeSet;

use d3dgen_model::brief::{Ask, AskedCount, Brief, Fact, ObjectsAsk, RoomsAsk, Subject};
use d3dgen_model::domain::Domain;
use d3dgen_model::floorplan::{Door, DoorKind, PlanRoom};
use d3dgen_model::report::{AskAnswer, Fate};
use d3dgen_model::scene_graph::GraphRoom;
use d3dgen_model::world::World;

use self::subjects::Found;

/// Share by which a floor area or side that was asked for may be missed.
const MEASURE_MISS: f64 = 0.05;
/// Attribute of rooms that people in wheelchairs use.
const ACCESSIBLE: &str = "accessible";
/// Letters of a word from which a conflict that has it is taken to speak of the wish that has it too.
const TELLING_LETTERS: usize = 4;

/// What the answers are looked up in.
struct Asked<'a> {
    brief: &'a Brief,
    world: &'a World,
    domain: &'a Domain,
}

/// What was found of one fact, before it is written down.
struct Finding {
    fate: Fate,
    /// Ids of what answers it.
    ids: Vec<String>,
    /// Number or measure asked for.
    asked: Option<f64>,
    /// What the world has.
    measured: Option<f64>,
    unit: &'static str,
    /// Why it is not as asked; empty where it is.
    reason: String,
}

impl Finding {
    fn honored(ids: Vec<String>) -> Self {
        Self { fate: Fate::Honored, ids, asked: None, measured: None, unit: "", reason: String::new() }
    }

    fn of(fate: Fate, reason: String) -> Self {
        Self { fate, reason, ..Self::honored(Vec::new()) }
    }

    /// Returns what a yes or no comes to.
    fn when(holds: bool, ids: Vec<String>, reason: impl FnOnce() -> String) -> Self {
        if holds { Self::honored(ids) } else { Self { ids, ..Self::of(Fate::LeftOut, reason()) } }
    }

    /// Returns what a number of things comes to: fewer or more than asked are a substitute, none are left out.
    fn counted(count: AskedCount, ids: Vec<String>, what: &str) -> Self {
        let n = ids.len() as u32;
        Self { ids, ..Self::number(count, n, what) }
    }

    /// Returns what a number comes to.
    fn number(count: AskedCount, n: u32, what: &str) -> Self {
        let fate = match (count.allows(n), n) {
            (true, _) => Fate::Honored,
            (false, 0) => Fate::LeftOut,
            (false, _) => Fate::Substituted,
        };
        let reason = if fate == Fate::Honored { String::new() } else { format!("{count} {what} asked for, {n} built") };
        Self { asked: Some(f64::from(count.n)), measured: Some(f64::from(n)), ..Self::of(fate, reason) }
    }

    /// Returns what a measure comes to that may be missed by a share of it.
    fn measure(asked: f64, measured: f64, miss: f64, (unit, what): (&'static str, &str)) -> Self {
        let holds = (measured - asked).abs() <= miss * asked;
        let fate = if holds { Fate::Honored } else { Fate::Substituted };
        let reason =
            if holds { String::new() } else { format!("{what} {measured:.1} {unit}, {asked:.1} {unit} asked for") };
        Self { asked: Some(asked), measured: Some(measured), unit, ..Self::of(fate, reason) }
    }

    /// Returns the worse of two findings about the same things, with the reasons of both.
    fn and(self, other: Self) -> Self {
        let (worse, better) = if other.fate > self.fate { (other, self) } else { (self, other) };
        let reason = [worse.reason.as_str(), better.reason.as_str()].into_iter().filter(|r| !r.is_empty());
        Self {
            reason: reason.collect::<Vec<_>>().join("; "),
            ids: if worse.ids.is_empty() { better.ids } else { worse.ids },
            ..worse
        }
    }
}

/// Returns what became of each thing that a brief asks for, in the order of the brief.
pub fn answers(brief: &Brief, world: &World, domain: &Domain) -> Vec<AskAnswer> {
    let asked = Asked { brief, world, domain };
    brief.asks.iter().map(|ask| asked.answer(ask)).collect()
}

impl Asked<'_> {
    fn answer(&self, ask: &Ask) -> AskAnswer {
        let mut found = self.find(&ask.fact);
        if found.fate != Fate::Honored
            && let Some(message) = self.told_of(ask)
        {
            found.fate = Fate::Contradicted;
            found.reason = if found.reason.is_empty() { message } else { format!("{}; {message}", found.reason) };
        }
        AskAnswer {
            ask_id: ask.id.clone(),
            said: ask.said(),
            kind: ask.fact.name().to_owned(),
            fate: found.fate,
            ids: found.ids,
            asked: found.asked,
            measured: found.measured.map(|m| (m * 1000.0).round() / 1000.0),
            unit: found.unit.to_owned(),
            reason: found.reason,
        }
    }

    fn find(&self, fact: &Fact) -> Finding {
        match fact {
            Fact::Rooms(rooms) => self.rooms(rooms),
            Fact::Objects(objects) => self.objects(objects),
            Fact::Capacity(capacity) => self.capacity(capacity),
            Fact::Relation(relation) => self.relation(relation),
            Fact::Storeys(storeys) => self.storeys(storeys),
            Fact::Area(area) => self.area(area),
            Fact::Robots(robots) => self.robots(robots),
            Fact::People(people) => self.people(people),
            Fact::Style(style) => self.style(style),
            Fact::Accessible(access) => self.accessible(access),
            Fact::Forbidden(forbidden) => self.forbidden(forbidden),
            Fact::Only(only) => self.only(only),
            Fact::Site(site) => self.site(site),
            Fact::Other(other) => Finding::of(Fate::LeftOut, format!("nothing here builds `{}`", other.wish)),
        }
    }

    /// Returns the conflict or assumption of the world that has one of the words of a wish.
    fn told_of(&self, ask: &Ask) -> Option<String> {
        let words: Vec<String> = ask.words.iter().map(|w| w.text.to_lowercase()).collect();
        let telling = |w: &&str| w.chars().count() >= TELLING_LETTERS && w.chars().any(char::is_alphabetic);
        let words: Vec<&str> = words.iter().flat_map(|w| w.split_whitespace()).filter(telling).collect();
        let graph = &self.world.scene_graph;
        let said = graph.conflicts.iter().chain(&self.world.floorplan.conflicts);
        said.map(|n| &n.message).find(|m| words.iter().any(|w| m.to_lowercase().contains(w))).cloned()
    }

    fn rooms(&self, asked: &RoomsAsk) -> Finding {
        if asked.among {
            return self.some_rooms(asked);
        }
        let found = self.rooms_called(&asked.room);
        let there = self.meant(asked, &found.rooms);
        let ids = || there.iter().map(|r| r.id.clone()).collect::<Vec<_>>();
        let mut out = Finding::counted(asked.count, ids(), &asked.room.label());
        if there.len() < found.rooms.len() && out.fate != Fate::Honored {
            out.reason =
                format!("{} of {} {} lie on the storey asked for", there.len(), found.rooms.len(), asked.room.label());
        }
        if there.is_empty() {
            return out;
        }
        let plans: Vec<&PlanRoom> = there.iter().filter_map(|r| self.world.floorplan.room(&r.id)).collect();
        if let Some(area) = asked.area_m2 {
            let farthest =
                plans.iter().map(|p| p.net_polygon.area()).max_by(|a, b| (a - area).abs().total_cmp(&(b - area).abs()));
            out = out.and(Finding::measure(area, farthest.unwrap_or(0.0), MEASURE_MISS, ("m2", "the floor is")));
        }
        if let Some(sides) = asked.sides_m {
            out = out.and(sides_of(&plans, sides));
        }
        for attribute in &asked.attributes {
            out = out.and(self.attribute(attribute, &there));
        }
        match &asked.each {
            Some(each) => out.and(self.one_each(&there, each)),
            None => out,
        }
    }

    /// Returns the rooms of a name that are meant on the storey asked for. Where their number is not the one asked for, those that
    /// the brief asks for by a name of their own do not count (the four-bed room among "6 patient rooms"), and at last only those
    /// of the very type.
    fn meant<'r>(&self, asked: &RoomsAsk, called: &[&'r GraphRoom]) -> Vec<&'r GraphRoom> {
        let on_level = |r: &&GraphRoom| asked.level.is_none_or(|level| r.level == level);
        let all: Vec<&GraphRoom> = called.iter().copied().filter(on_level).collect();
        let others = self.named_elsewhere(&asked.room);
        let narrower = all.iter().copied().filter(|r| !others.contains(r.room_type.as_str())).collect::<Vec<_>>();
        let exact = all.iter().copied().filter(|r| asked.room.id.as_ref() == Some(&r.room_type)).collect::<Vec<_>>();
        let kept = |rooms: &Vec<&GraphRoom>| asked.count.allows(rooms.len() as u32);
        if kept(&all) {
            return all;
        }
        // "5 inbound docks ... 3 outbound docks" are eight
        let (before, after) = self.asked_beside(asked);
        if before + after > 0 && all.len() as u32 == before + asked.count.n + after {
            return all.into_iter().skip(before as usize).take(asked.count.n as usize).collect();
        }
        [narrower, exact].into_iter().find(kept).unwrap_or(all)
    }

    /// Returns how many of the same rooms on the same storey other facts ask for, before this one and after it.
    fn asked_beside(&self, asked: &RoomsAsk) -> (u32, u32) {
        let rooms =
            self.brief.asks.iter().filter_map(|a| if let Fact::Rooms(rooms) = &a.fact { Some(rooms) } else { None });
        let same =
            |r: &&RoomsAsk| r.room.id.is_some() && r.room.id == asked.room.id && r.level == asked.level && !r.among;
        let all: Vec<&RoomsAsk> = rooms.filter(same).collect();
        let at = all.iter().position(|r| std::ptr::eq(*r, asked)).unwrap_or(all.len());
        let sum = |rooms: &[&RoomsAsk]| rooms.iter().map(|r| r.count.n).sum();
        (sum(&all[..at]), sum(all.get(at + 1..).unwrap_or_default()))
    }

    /// Answers for some of the rooms that another fact asks for: so many of them are to be as it says.
    fn some_rooms(&self, asked: &RoomsAsk) -> Finding {
        let called = self.rooms_called(&asked.room).rooms;
        let all: Vec<&GraphRoom> = self.world.scene_graph.rooms.iter().filter(|r| r.requested).collect();
        let among = if called.is_empty() { all } else { called };
        let is_so = |r: &&&GraphRoom| asked.attributes.iter().all(|a| self.has_itself(a, r));
        let so: Vec<String> = among.iter().filter(is_so).map(|r| r.id.clone()).collect();
        let words: Vec<String> = asked.attributes.iter().map(|a| a.replace('_', " ")).collect();
        let what = format!("{} that are {}", asked.room.label(), words.join(" and "));
        Finding::counted(asked.count, so, &what)
    }

    /// Returns whether one room is as an attribute says by itself: what holds for the whole building makes no difference among its
    /// rooms.
    fn has_itself(&self, attribute: &str, room: &GraphRoom) -> bool {
        let typed = room.room_type.split('_').any(|part| part == attribute);
        let whole = attribute == ACCESSIBLE && !self.world.scene_graph.accessible;
        typed || !whole && self.attribute(attribute, &[room]).fate == Fate::Honored
    }

    /// Returns the types of rooms that the brief speaks of beside one.
    fn named_elsewhere(&self, room: &Subject) -> BTreeSet<&str> {
        let named = self.brief.asks.iter().filter_map(|ask| match &ask.fact {
            Fact::Rooms(rooms) => Some(&rooms.room),
            Fact::Objects(objects) => objects.room.as_ref(),
            Fact::Capacity(capacity) => capacity.room.as_ref(),
            _ => None,
        });
        named.filter_map(|subject| subject.id.as_deref()).filter(|id| room.id.as_deref() != Some(id)).collect()
    }

    /// Returns whether each of these rooms has a door to a room of its own of another kind.
    fn one_each(&self, rooms: &[&GraphRoom], each: &Subject) -> Finding {
        let wanted = self.rooms_called(each);
        let has = |room: &&&GraphRoom| {
            self.doors_between(&room.id, |other| wanted.rooms.iter().any(|w| w.id == other)).next().is_some()
        };
        let n = rooms.iter().filter(has).count();
        let what = format!("{} with {} of their own", label_of(rooms), each.label());
        Finding::number(AskedCount::at_least(rooms.len() as u32), n as u32, &what)
    }

    /// Returns whether rooms are as an attribute says; those that no document tells are left out, and said to be.
    fn attribute(&self, attribute: &str, rooms: &[&GraphRoom]) -> Finding {
        let plan = &self.world.floorplan;
        let has_window = |r: &&GraphRoom| plan.windows.iter().any(|w| w.room_id == r.id);
        let outdoors = |d: &Door| d.room_ids.len() == 1;
        let wet = |id: &str| plan.room(id).is_some_and(|p| self.domain.room_type_or_generic(&p.room_type).wet);
        let area = |r: &&GraphRoom| plan.room(&r.id).map_or(0.0, |p| p.net_polygon.area());
        let usual = |r: &&GraphRoom| self.domain.room_type_or_generic(&r.room_type).area_m2.target;
        let all = |holds: &dyn Fn(&&GraphRoom) -> bool| {
            let missing: Vec<String> = rooms.iter().filter(|r| !holds(r)).map(|r| r.name.clone()).collect();
            let reason = || format!("not {}: {}", attribute.replace('_', " "), missing.join(", "));
            Finding::when(missing.is_empty(), Vec::new(), reason)
        };
        match attribute {
            "with_window" => all(&has_window),
            "windowless" => all(&|r| !has_window(r)),
            ACCESSIBLE => all(&|_| self.world.scene_graph.accessible),
            "open" => all(&|r| {
                plan.doors_of(&r.id).any(|d| d.kind == DoorKind::Open)
                    || self.domain.room_type_or_generic(&r.room_type).open_front
            }),
            "separate" | "closed" => all(&|r| plan.doors_of(&r.id).all(|d| d.kind != DoorKind::Open)),
            "large" => all(&|r| area(r) >= usual(r)),
            "small" => all(&|r| area(r) <= usual(r)),
            "garden_door" | "outdoor_door" => all(&|r| plan.doors_of(&r.id).any(outdoors)),
            "own_bathroom" => all(&|r| self.doors_between(&r.id, wet).next().is_some()),
            "own_entrance" => all(&|r| plan.doors_of(&r.id).any(outdoors)),
            other => self.named_so(other, rooms),
        }
    }

    /// Returns whether rooms are of a type that has the attribute in its name: `double` of `patient_room_double`.
    fn named_so(&self, attribute: &str, rooms: &[&GraphRoom]) -> Finding {
        let named = |r: &&GraphRoom| r.room_type.split('_').any(|part| part == attribute);
        let reason = || format!("no document tells whether rooms are `{}`", attribute.replace('_', " "));
        Finding::when(rooms.iter().all(named), Vec::new(), reason)
    }

    fn objects(&self, asked: &ObjectsAsk) -> Finding {
        let found = self.objects_called(&asked.object);
        let label = asked.object.label();
        let Some(room) = &asked.room else {
            return Finding::counted(asked.count, found.ids(), &label).and(self.object_attributes(asked, &found));
        };
        let rooms = self.rooms_called(room);
        let within = |id: &str| rooms.rooms.iter().any(|r| r.id == id);
        let inside = Found {
            placements: found.placements.iter().copied().filter(|p| within(&p.room_id)).collect(),
            ..Found::default()
        };
        let what = format!("{label} in {}", room.label());
        if rooms.rooms.is_empty() {
            return Finding::of(Fate::LeftOut, format!("there is no {}", room.label()));
        }
        let counted = if asked.each_room {
            let held = |r: &&GraphRoom| {
                asked.count.allows(inside.placements.iter().filter(|p| p.room_id == r.id).count() as u32)
            };
            let n = rooms.rooms.iter().filter(|r| held(r)).count() as u32;
            let each = format!("{} with {} {label} each", room.label(), asked.count);
            Finding { ids: inside.ids(), ..Finding::number(AskedCount::at_least(rooms.rooms.len() as u32), n, &each) }
        } else {
            Finding::counted(asked.count, inside.ids(), &what)
        };
        if counted.fate == Fate::LeftOut && !found.placements.is_empty() {
            let reason = format!("it stands elsewhere: {}", found.placements[0].room_id);
            return Finding { fate: Fate::Substituted, reason, ids: found.ids(), ..counted };
        }
        counted.and(self.object_attributes(asked, &inside))
    }

    /// Returns whether objects are as asked: by the words of their type, or else by their size among those the type comes in.
    fn object_attributes(&self, asked: &ObjectsAsk, found: &Found) -> Finding {
        let missing = asked.attributes.iter().filter(|a| !found.placements.iter().any(|p| self.is_so(a, p)));
        let missing: Vec<&str> = missing.map(String::as_str).collect();
        if missing.is_empty() || found.placements.is_empty() {
            return Finding::honored(Vec::new());
        }
        Finding::of(Fate::Substituted, format!("none that is known to be {}", missing.join(", ")))
    }
}

/// Returns whether rooms have sides of these lengths, in either order.
fn sides_of(rooms: &[&PlanRoom], sides: [f64; 2]) -> Finding {
    let near = |a: f64, b: f64| (a - b).abs() <= MEASURE_MISS * b;
    let fits = |p: &&PlanRoom| {
        let b = p.net_polygon.bounds();
        let (w, h) = (b.width(), b.height());
        near(w, sides[0]) && near(h, sides[1]) || near(w, sides[1]) && near(h, sides[0])
    };
    let wrong = rooms.iter().find(|p| !fits(p)).map(|p| p.net_polygon.bounds());
    match wrong {
        None => Finding::honored(Vec::new()),
        Some(b) => {
            let [long, short] = sides;
            let reason = format!("sides are {:.2} x {:.2} m, {long} x {short} m asked for", b.width(), b.height());
            Finding::of(Fate::Substituted, reason)
        }
    }
}

fn label_of(rooms: &[&GraphRoom]) -> String {
    rooms.first().map_or_else(String::new, |r| r.room_type.replace('_', " "))
}
