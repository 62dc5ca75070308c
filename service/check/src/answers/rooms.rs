//! Rooms: as many as asked for, of the type, on the storey, with the floor and the qualities.

use std::collections::BTreeSet;

use d3dgen_model::brief::{Ask, AskedCount, Fact, RoomsAsk, Subject};
use d3dgen_model::domain::{Mount, Shape, tags};
use d3dgen_model::floorplan::{Door, DoorKind, PlanRoom};
use d3dgen_model::offer::Wet;
use d3dgen_model::report::Fate;
use d3dgen_model::scene_graph::GraphRoom;

use super::claims::Likeness;
use super::subjects::AT_WINDOW;
use super::{Asked, Finding, MEASURE_MISS, ids_of, listed, names_of};

/// Attribute of rooms that people in wheelchairs use.
pub(super) const ACCESSIBLE: &str = "accessible";
/// Code of what a graph says of rooms whose type only a part of their name told.
const ROOM_LIKELY: &str = "room_likely";
/// How much smaller the smallest of equally large rooms is than the largest, at most, as a share of the largest.
const EQUAL_SIZES: f64 = 0.1;
/// Attributes that say for how many a room is: so many sleep there, or else have their desk.
const FOR_SO_MANY: [(&str, u32); 2] = [("single", 1), ("double", 2)];

impl<'a> Asked<'a> {
    pub(super) fn rooms(&self, at: usize, ask: &Ask, asked: &RoomsAsk) -> Finding {
        if asked.among {
            return self.some_rooms(ask, asked);
        }
        let there = self.claims.rooms(at);
        let n = there.len() as u32;
        let mut out = Finding::number(asked.count, n, || self.number_reason(ask, asked, n)).with(ids_of(there));
        if there.is_empty() {
            return out;
        }
        out = out.and(self.other_kind(asked, there)).and(self.likely_kind(asked, there));
        out = out.and(self.unknown_rooms(there)).and(self.blind_locks(there));
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
            out = out.and(self.attribute(attribute, there));
        }
        match &asked.each {
            Some(each) => out.and(self.one_each(ask, there, each)),
            None => out,
        }
    }

    /// Returns why there are not as many rooms as asked for: how many there are, and how many more on other storeys.
    fn number_reason(&self, ask: &Ask, asked: &RoomsAsk, n: u32) -> String {
        let level = asked.level.or_else(|| self.level_of(ask));
        let elsewhere = self.rooms_called(&asked.room).into_iter().filter(|r| level.is_some_and(|l| l != r.level));
        let elsewhere: Vec<&GraphRoom> = elsewhere.filter(|r| !self.claims.is_taken(&r.id)).collect();
        let storey = level.map_or_else(String::new, |l| format!(" on {}", storey_name(l)));
        let built = match n {
            0 => format!("no such room was built{storey}"),
            n => format!("{} asked for{storey}, {n} built", asked.count),
        };
        match elsewhere.first() {
            Some(other) => format!("{built}; {} on {}", names_of(&elsewhere), storey_name(other.level)),
            None => built,
        }
    }

    /// Returns which rooms are furnished as rooms of another kind than the one asked for, whatever they are called.
    fn other_kind(&self, asked: &RoomsAsk, there: &[&GraphRoom]) -> Finding {
        let is_other =
            |r: &&&GraphRoom| matches!(self.kinds.likeness(&asked.room, r), None | Some(Likeness::NamedOnly));
        let kinds: BTreeSet<&str> = there
            .iter()
            .filter(is_other)
            .map(|r| self.domain.room_type_or_generic(&r.room_type).label.as_str())
            .collect();
        let reason = || {
            let kinds: Vec<&str> = kinds.iter().copied().collect();
            format!("it was planned and furnished as {}", listed(&kinds).to_lowercase())
        };
        Finding::when(kinds.is_empty(), Vec::new(), reason).or_near()
    }

    /// Returns which rooms are of a type that only a part of their name told, as the graph says: a "viewing gallery" furnished as one
    /// for exhibitions.
    fn likely_kind(&self, asked: &RoomsAsk, there: &[&GraphRoom]) -> Finding {
        let mark = format!("`{}` (", asked.room.name);
        let mut notes = self.world.scene_graph.assumptions.iter().filter(|note| note.code == ROOM_LIKELY);
        let guessed = notes.any(|note| note.message.contains(&mark));
        let reason = || {
            let kind = there.first().map(|r| self.domain.room_type_or_generic(&r.room_type).label.to_lowercase());
            format!(
                "no such room is known here; by a part of its name it was furnished as {}",
                kind.unwrap_or_default()
            )
        };
        Finding::when(!guessed, Vec::new(), reason).or_near()
    }

    /// Returns which rooms are of a kind that nobody knows: nothing but their name, or with what stands in any room, where nothing
    /// that was asked for stands in them.
    fn unknown_rooms(&self, there: &[&GraphRoom]) -> Finding {
        let stands = |r: &GraphRoom| {
            let mut placements = self.world.placements.placements.iter().filter(|p| p.room_id == r.id);
            placements.any(|p| p.mount == Mount::Floor)
        };
        let of_any_room = |r: &GraphRoom| !self.is_furnished_as_asked(r);
        let is_unknown = |r: &&GraphRoom| self.domain.room_type_or_lent(&r.room_type).is_none() && of_any_room(r);
        let unknown: Vec<&GraphRoom> = there.iter().copied().filter(is_unknown).collect();
        let reason = || match unknown.iter().any(|r| stands(r)) {
            true => {
                format!("no such room is known here: {} has its name, and what stands in any room", names_of(&unknown))
            }
            false => {
                format!("no such room is known here: {} has its name and its light, and is empty", names_of(&unknown))
            }
        };
        Finding::when(unknown.is_empty(), Vec::new(), reason).or_near()
    }

    /// Returns true for a room in which something stands that the brief asks for.
    fn is_furnished_as_asked(&self, room: &GraphRoom) -> bool {
        let things = self.brief.asks.iter().filter_map(|ask| match &ask.fact {
            Fact::Objects(objects) => Some(&objects.object),
            _ => None,
        });
        things.into_iter().any(|object| self.objects_called(object).iter().any(|p| p.room_id == room.id))
    }

    /// Returns which locks are only called so: no room is entered through them alone.
    fn blind_locks(&self, there: &[&GraphRoom]) -> Finding {
        let tagged =
            |r: &GraphRoom| self.domain.room_type_or_generic(&r.room_type).tags.iter().any(|t| t == tags::LOCK);
        let is_way = |id: &str| self.world.scene_graph.room(id).is_some_and(|r| r.circulation);
        let behind = |r: &GraphRoom, id: &str| r.id != id && !is_way(id) && !self.beyond(id).any(is_way);
        let leads = |r: &GraphRoom| self.beyond(&r.id).any(|id| behind(r, id));
        let is_blind = |r: &&GraphRoom| tagged(r) && !leads(r);
        let blind: Vec<&GraphRoom> = there.iter().copied().filter(|r| is_blind(r)).collect();
        let reason = || format!("nothing lies behind {}: no room is entered through it alone", names_of(&blind));
        Finding::when(blind.is_empty(), Vec::new(), reason).or_near()
    }

    /// Returns the rooms that the doors of one lead to.
    fn beyond<'s>(&'s self, room_id: &'s str) -> impl Iterator<Item = &'s str> {
        let doors = self.world.floorplan.doors.iter().filter(move |d| d.room_ids.iter().any(|id| id == room_id));
        doors.flat_map(|d| d.room_ids.iter().map(String::as_str)).filter(move |id| *id != room_id)
    }

    /// Answers for some of the rooms that another fact asks for: so many of them are to be as it says.
    fn some_rooms(&self, ask: &Ask, asked: &RoomsAsk) -> Finding {
        let meant = self.rooms_meant(ask, &asked.room);
        let requested = || self.world.scene_graph.rooms.iter().filter(|r| r.requested).collect();
        let among: Vec<&GraphRoom> = if meant.is_empty() { requested() } else { meant };
        let is_so = |r: &&&GraphRoom| asked.attributes.iter().all(|a| self.has_itself(a, r));
        let so: Vec<&GraphRoom> = among.iter().filter(is_so).copied().collect();
        let words: Vec<String> = asked.attributes.iter().map(|a| a.replace('_', " ")).collect();
        let reason = || match so.len() {
            0 => format!("none of {} is known to be so: {}", names_of(&among), words.join(", ")),
            n => format!("{} asked for, {n} there: {}", asked.count, names_of(&so)),
        };
        Finding::number(asked.count, so.len() as u32, reason).with(ids_of(&so))
    }

    /// Returns whether one room is as an attribute says by itself: what holds for the whole building makes no difference among its
    /// rooms.
    fn has_itself(&self, attribute: &str, room: &'a GraphRoom) -> bool {
        let typed = room.room_type.split('_').any(|part| part == attribute);
        let whole = attribute == ACCESSIBLE && !self.world.scene_graph.accessible;
        typed || !whole && self.attribute(attribute, &[room]).fate == Fate::Honored
    }

    /// Returns the types of rooms that the brief speaks of beside one.
    pub(super) fn named_elsewhere(&self, room: &Subject) -> BTreeSet<&str> {
        let named = self.brief.asks.iter().filter_map(|ask| match &ask.fact {
            Fact::Rooms(rooms) => Some(&rooms.room),
            Fact::Objects(objects) => objects.room.as_ref(),
            Fact::Capacity(capacity) => capacity.room.as_ref(),
            _ => None,
        });
        named.filter_map(|subject| subject.id.as_deref()).filter(|id| room.id.as_deref() != Some(id)).collect()
    }

    /// Returns the rooms of a name that others come with; of bathrooms all, whichever type they are.
    fn guests_meant(&self, ask: &Ask, each: &Subject) -> Vec<&'a GraphRoom> {
        let mut rooms = self.rooms_meant(ask, each);
        let wet = Wet::of(self.domain);
        let is_bathroom = |id: &str| self.domain.room_type_or_lent(id).is_some_and(|kind| wet.is_bathroom(kind));
        if each.id.as_deref().is_some_and(is_bathroom) {
            rooms.extend(self.world.scene_graph.rooms.iter().filter(|r| is_bathroom(&r.room_type)));
        }
        rooms
    }

    /// Returns whether each of these rooms has a door to a room of its own of another kind.
    fn one_each(&self, ask: &Ask, rooms: &[&'a GraphRoom], each: &Subject) -> Finding {
        let wanted = self.guests_meant(ask, each);
        let mut given: BTreeSet<&str> = BTreeSet::new();
        let mut lacking: Vec<&GraphRoom> = Vec::new();
        for room in rooms {
            let own = wanted.iter().find(|w| {
                !given.contains(w.id.as_str()) && self.doors_between(&room.id, |other| w.id == other).next().is_some()
            });
            match own {
                Some(own) => {
                    given.insert(&own.id);
                }
                None => lacking.push(room),
            }
        }
        let reason = || format!("no `{}` of its own: {}", each.name, names_of(&lacking));
        Finding::number(AskedCount::at_least(rooms.len() as u32), given.len() as u32, reason)
    }

    /// Returns whether rooms are as an attribute says; those that no document tells are left out, and said to be.
    fn attribute(&self, attribute: &str, rooms: &[&'a GraphRoom]) -> Finding {
        let plan = &self.world.floorplan;
        let has_window = |r: &&GraphRoom| plan.windows.iter().any(|w| w.room_id == r.id);
        let outdoors = |d: &Door| d.room_ids.len() == 1;
        let wet = |id: &str| plan.room(id).is_some_and(|p| self.domain.room_type_or_generic(&p.room_type).wet);
        let area = |r: &&GraphRoom| plan.room(&r.id).map_or(0.0, |p| p.net_polygon.area());
        let usual = |r: &&GraphRoom| self.domain.room_type_or_generic(&r.room_type).area_m2.target;
        let all = |holds: &dyn Fn(&&'a GraphRoom) -> bool| {
            let missing: Vec<&GraphRoom> = rooms.iter().filter(|r| !holds(r)).copied().collect();
            let reason = || format!("not {}: {}", attribute.replace('_', " "), names_of(&missing));
            Finding::when(missing.is_empty(), Vec::new(), reason).or_near()
        };
        match attribute {
            "with_window" | AT_WINDOW => all(&has_window),
            "windowless" => all(&|r| !has_window(r)),
            ACCESSIBLE => all(&|r| self.is_accessible(r)),
            "open" => all(&|r| {
                plan.doors_of(&r.id).any(|d| d.kind == DoorKind::Open)
                    || self.domain.room_type_or_generic(&r.room_type).open_front
            }),
            "separate" | "closed" => all(&|r| plan.doors_of(&r.id).all(|d| d.kind != DoorKind::Open)),
            "large" => all(&|r| area(r) >= usual(r)),
            "small" => all(&|r| area(r) <= usual(r)),
            "garden_door" | "outdoor_door" => all(&|r| plan.doors_of(&r.id).any(|d| outdoors(d) && !d.entrance)),
            "equal_size" => {
                let areas: Vec<f64> = rooms.iter().map(area).collect();
                let (least, most) = areas.iter().fold((f64::MAX, 0.0_f64), |(l, m), a| (l.min(*a), m.max(*a)));
                let reason = || format!("not equally large: {least:.1} to {most:.1} m2");
                Finding::when(most - least <= EQUAL_SIZES * most, Vec::new(), reason)
            }
            "own_bathroom" => all(&|r| self.doors_between(&r.id, wet).next().is_some()),
            "own_entrance" => all(&|r| plan.doors_of(&r.id).any(outdoors)),
            other => self.other_attribute(other, rooms),
        }
    }

    /// Returns whether rooms are as a word says that is no quality of plans: for so many people, with a thing of that name, or of a
    /// type that has the word in its name.
    fn other_attribute(&self, attribute: &str, rooms: &[&GraphRoom]) -> Finding {
        let named = |r: &&GraphRoom| r.room_type.split('_').any(|part| part == attribute);
        let things = self.objects_called(&Subject::unknown(attribute));
        let holds = |r: &&GraphRoom| things.iter().any(|p| p.room_id == r.id);
        let many = FOR_SO_MANY.iter().find(|(word, _)| *word == attribute).map(|(_, n)| *n);
        let peopled = |r: &&GraphRoom| many.is_some() && self.people_of(r) == many;
        let missing: Vec<&GraphRoom> =
            rooms.iter().filter(|r| !named(r) && !holds(r) && !peopled(r)).copied().collect();
        let word = attribute.replace('_', " ");
        let reason = || match many.zip(missing.first().and_then(|r| self.people_of(r))) {
            Some((_, n)) => format!("not {word}: {} is for {n}", names_of(&missing[..1])),
            None => format!("no document tells whether it is {word}: {}", names_of(&missing)),
        };
        Finding::when(missing.is_empty(), Vec::new(), reason)
    }

    /// Returns whether somebody in a wheelchair uses a room: its own toilet is made for that, and its floor is large enough.
    pub(super) fn is_accessible(&self, room: &GraphRoom) -> bool {
        let kind = self.domain.room_type_or_generic(&room.room_type);
        if room.room_type.split('_').any(|part| part == ACCESSIBLE) {
            return true;
        }
        let placements = || self.world.placements.placements.iter().filter(|p| p.room_id == room.id);
        let is_toilet = |object: &str| {
            self.domain.object(object).is_some_and(|o| matches!(o.shape, Shape::Toilet | Shape::Cubicle))
        };
        let mut toilets = placements().filter(|p| is_toilet(&p.object)).peekable();
        let own = toilets.peek().is_none() || toilets.any(|p| self.is_so(ACCESSIBLE, p));
        let area = self.world.floorplan.room(&room.id).map_or(0.0, |p| p.net_polygon.area());
        self.world.scene_graph.accessible && own && area >= kind.step_free_m2 * (1.0 - MEASURE_MISS)
    }
}

/// Returns what people call a storey.
pub(super) fn storey_name(level: i32) -> String {
    match level {
        0 => "the ground floor".to_owned(),
        n if n < 0 => format!("basement level {}", -n),
        n => format!("level {n} above the ground"),
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
