//! What a room should hold: its type's furnishing lines and the wishes of the scene graph, in the order of placing.

use std::collections::BTreeSet;

use d3dgen_model::domain::{Arrangement, Domain, Furnishing, Goods, Mount, ObjectType, RoomType, Shape};
use d3dgen_model::occupancy::ROBOT_HEIGHT_M;
use d3dgen_model::offer;
use d3dgen_model::offer::{asked_objects, dock_rank, docks_held, has_docks, other_bed, widest_circle_m};
use d3dgen_model::robot_kind::cleans;
use d3dgen_model::scene_graph::{GraphRoom, SceneGraph};

use super::seats::is_seat;
use super::state::Placed;
use super::unit::{Forms, Unit, variants};

/// Largest number of units of one line in one room.
const MAX_UNITS: u32 = 400;
/// Height above which furniture is for storage alone, m: wardrobes and bookcases, not chests with something on top.
const EYE_LEVEL_M: f64 = 1.5;

/// A number of equal units to place in one way.
#[derive(Debug, Clone)]
pub(crate) struct Task<'a> {
    /// Group or object id.
    pub item: &'a str,
    /// Anchor of the group, or the object.
    pub anchor: &'a ObjectType,
    pub arrangement: Arrangement,
    /// How many to place.
    pub count: u32,
    /// How many of them the room type cannot do without.
    pub required: u32,
    /// How many fewer do as well where that makes full rows.
    pub spare: u32,
    /// Furnishing line counted from 0; wishes come after the last line.
    pub line: usize,
    /// True for the first furnishing line, and for what comes in its place: the room turns to it.
    pub leads: bool,
    /// Why it is wanted, for people.
    pub rule: String,
    /// Items in whose place it comes: not wanted where one of them stands.
    pub instead_of: &'a [String],
    /// True when a required line comes in its place where it finds none.
    pub first_choice: bool,
    /// True for what somebody asked for by name, and for the bed of two.
    pub asked: bool,
    /// True for tables whose number follows from how many people are to sit at them.
    pub for_guests: bool,
    /// True for a table that comes with so many people: smaller ones are for want of floor.
    pub for_many: bool,
    /// How wide what things are stored in usually is, m: of what comes in another's place, the wider of them.
    pub usual_width_m: Option<f64>,
    /// People who are to sit at it, where it is the one table of its room.
    pub seats: Option<u32>,
}

impl Task<'_> {
    /// Returns true for what comes after everything that stands on the floor.
    pub fn is_decor(&self) -> bool {
        phase(self) >= 3
    }

    /// Returns true for what is placed with what the room cannot do without.
    fn is_needed(&self) -> bool {
        self.required > 0 || self.first_choice
    }

    /// Returns how much narrower than usual a unit is in which things are stored, as a share of that; 0 for all others.
    pub fn narrower(&self, unit: &Unit) -> f64 {
        let own = f64::from(unit.anchor().solid.rect.height()) / 1000.0;
        self.usual_width_m.map_or(0.0, |usual| (1.0 - own / usual).max(0.0))
    }

    /// Returns true for seats and what people sit at: a line of rows of them is an audience.
    pub fn is_audience(&self) -> bool {
        matches!(self.anchor.shape, Shape::Bench | Shape::Chair | Shape::Table | Shape::Desk | Shape::Sofa)
    }

    /// Returns true for rows of what people work or eat at.
    fn is_seated(&self) -> bool {
        let seated = matches!(self.anchor.shape, Shape::Desk | Shape::Table | Shape::RoundTable);
        seated && self.arrangement == Arrangement::Rows
    }

    /// Lets full rows go before the last few of a number that comes from the room's area alone, and pairs before an odd one.
    fn allow_full_rows(&mut self) {
        let few = (self.count / 7).max(self.count % 2);
        self.spare = few.min(self.count - self.required.max(1).min(self.count));
    }

    /// Looks hard for one of several tables that fill a large room only: the others stand where there is floor for them.
    fn allow_one_table(&mut self) {
        if is_table(self.anchor)
            && self.arrangement == Arrangement::Center
            && self.required == 0
            && !self.asked
            && self.count > 1
        {
            self.spare = self.count - 1;
        }
    }

    /// Returns true for a thing of which a room wants so many, whatever else they belong to: seats for visitors, a refrigerator.
    fn counts_in_groups(&self) -> bool {
        let shape = self.anchor.shape;
        self.item == self.anchor.id && (shape == Shape::Appliance || is_seat(shape))
    }

    /// Returns how many of it stand with other things already; `tasks` are those before it.
    pub fn standing(&self, tasks: &[Task], placed: &[Placed]) -> u32 {
        let before = |t: &Task| t.item == self.item && t.line < self.line;
        if self.arrangement == Arrangement::Rows && tasks.iter().any(before) {
            return placed.iter().filter(|p| p.unit.item == self.item).count() as u32;
        }
        let goes_on = tasks.iter().any(|t| t.line == self.line && t.item == self.item);
        if !self.counts_in_groups() || goes_on {
            return 0;
        }
        let groups = placed.iter().filter(|p| p.unit.group && p.unit.anchor().object.id != self.item);
        groups.flat_map(|p| &p.unit.parts[1..]).filter(|part| part.object.id == self.item).count() as u32
    }

    /// Returns how many units count: those beyond what full rows may leave out do not.
    pub fn counted(&self, units: usize) -> usize {
        units.min(self.count.saturating_sub(self.spare) as usize)
    }

    /// Returns true when all units are found in one go.
    pub fn is_batch(&self) -> bool {
        matches!(self.arrangement, Arrangement::Rows | Arrangement::Overhead | Arrangement::AtExit)
    }
}

/// What lines about the whole building ask for.
#[derive(Debug)]
pub(crate) struct Household<'a> {
    domain: &'a Domain,
    /// Types of its rooms.
    room_types: Vec<&'a str>,
    /// Rooms that are to have a bed in the place of their usual one, with the line of it.
    other_beds: Vec<(&'a str, &'a Furnishing)>,
    /// True where step-free access is asked for.
    accessible: bool,
    has_robots: bool,
    /// How many of them live in each of the rooms that are there for their docks, and the largest circle that one turns in, m.
    in_each: u32,
    circle_m: f64,
    /// True when one of them cleans: the docks of rooms for soiled things are theirs.
    cleans: bool,
    /// Rooms that are there for something else, and have the dock of a robot: as many as there are robots without one.
    berths: BTreeSet<&'a str>,
    /// Most people that the graph has in one room to sleep in, or that live there.
    sharing: u32,
}

impl<'a> Household<'a> {
    pub fn new(domain: &'a Domain, graph: &'a SceneGraph) -> Self {
        let room_types = graph.rooms.iter().map(|r| r.room_type.as_str()).collect();
        let sleeps = |kind: &RoomType| {
            kind.furnishing.iter().any(|f| f.required && usual_unit(domain, &f.item).is_some_and(|u| u.beds() > 0))
        };
        let held = graph.rooms.iter().filter_map(|r| Some((domain.room_type_or_lent(&r.room_type)?, r.occupants?)));
        let robots = graph.robots.iter().map(|r| r.count).fold(0, u32::saturating_add);
        let homes = graph.rooms.iter().filter(|r| has_docks(domain, domain.room_type_or_generic(&r.room_type))).count();
        Self {
            domain,
            room_types,
            other_beds: graph
                .rooms
                .iter()
                .filter_map(|r| Some((r.room_type.as_str(), other_bed(domain, r)?)))
                .collect(),
            accessible: graph.accessible,
            has_robots: !graph.robots.is_empty(),
            in_each: robots.div_ceil(homes.max(1) as u32),
            circle_m: widest_circle_m(&graph.robots),
            cleans: graph.robots.iter().any(|r| cleans(&r.kind)),
            berths: if homes > 0 { BTreeSet::new() } else { berths(domain, graph, robots) },
            sharing: held
                .filter(|(kind, _)| sleeps(kind))
                .map(|h| h.1)
                .chain(graph.occupancy.residents)
                .max()
                .unwrap_or(0),
        }
    }

    /// Returns how many people have a bed.
    fn sleepers(&self) -> u32 {
        let each = |item: &str| usual_unit(self.domain, item).map_or(0, |u| u.beds());
        let usual = |kind: &str| {
            let lines = self.domain.room_type_or_generic(kind).furnishing.iter().filter(|f| f.required);
            lines.map(|f| f.min * each(&f.item)).sum::<u32>()
        };
        let all = self.room_types.iter().map(|kind| usual(kind)).sum::<u32>();
        let (less, more) = self
            .other_beds
            .iter()
            .fold((0, 0), |(less, more), (kind, line)| (less + usual(kind), more + each(&line.item)));
        (all + more).saturating_sub(less).max(self.sharing)
    }

    /// Returns true for a line that the building asks for, in a room for so many people.
    fn wants(&self, kind: &RoomType, line: &Furnishing, people: Option<u32>) -> bool {
        let dock = || self.domain.is_dock(&line.item);
        // docks stand where there are robots, or in rooms that are there for them
        // few lines ask who sleeps there, and to know takes time
        let robots = if kind.goods == Goods::Soiled { self.cleans } else { self.has_robots };
        (line.required || robots || !dock())
            && line.is_for(self.room_types.iter().copied(), self.accessible)
            && (line.sleepers == 0 || people.unwrap_or(0) >= line.sleepers || self.sleepers() >= line.sleepers)
    }
}

/// Returns the rooms in which robots live that no room is there for: those that somebody asked a dock for, then those that suit one
/// best, one robot in each.
fn berths<'a>(domain: &Domain, graph: &'a SceneGraph, robots: u32) -> BTreeSet<&'a str> {
    let Some(robot) = graph.robots.first() else { return BTreeSet::new() };
    let asked = |room: &GraphRoom| room.wished_assets.iter().any(|id| domain.is_dock(id));
    let rank = |room: &GraphRoom| {
        let kind = domain.room_type_or_generic(&room.room_type);
        let holds = kind.furnishing.iter().any(|f| !f.required && domain.is_dock(&f.item));
        let kept_out = graph.keeps_robots_out(&room.id);
        holds.then(|| (!asked(room), kept_out, dock_rank(kind, robot).unwrap_or(u8::MAX)))
    };
    let mut rooms: Vec<_> = graph.rooms.iter().filter_map(|r| Some((rank(r)?, r.id.as_str()))).collect();
    rooms.sort_by_key(|r| r.0);
    let wished = graph.rooms.iter().filter(|r| asked(r)).count();
    let listed = rooms.iter().filter(|r| !r.0.0).count();
    // those wished for where no line speaks of them come by themselves
    let left = (robots as usize).saturating_sub(wished - listed);
    rooms.into_iter().take(left.max(listed)).map(|r| r.1).collect()
}

/// Returns the tasks of a room, most constrained first.
pub(crate) fn tasks<'a>(
    domain: &'a Domain,
    kind: &'a RoomType,
    graph: Option<&'a GraphRoom>,
    area_m2: f64,
    per_person_m2: Option<f64>,
    windows: u32,
    household: &Household,
) -> Vec<Task<'a>> {
    let order = Order {
        domain,
        kind,
        graph,
        area_m2,
        windows,
        household,
        occupied: occupied_line(domain, kind, graph, household),
        named: graph.map_or_else(Vec::new, |room| asked_objects(domain, kind, room)),
        bed: graph.and_then(|g| other_bed(domain, g)),
    };
    let lines = kind.furnishing.iter().enumerate().filter(|(_, f)| order.wants(f));
    let mut out: Vec<Task> = lines.flat_map(|(line, f)| order.tasks_of(line, f)).collect();
    out.extend(order.wished());
    if order.occupied.is_none() {
        if let Some(each) = per_person_m2 {
            thin_out(domain, &mut out, (area_m2 / each).floor().max(1.0) as u32);
        }
        out.iter_mut().filter(|t| t.is_seated()).for_each(Task::allow_full_rows);
    }
    spare_for_rows(&mut out);
    out.iter_mut().for_each(Task::allow_one_table);
    turn_to_audience(&mut out);
    sort(&mut out, kind, household.has_robots);
    out
}

/// What a room is asked to hold.
struct Order<'a, 'h> {
    domain: &'a Domain,
    kind: &'a RoomType,
    graph: Option<&'a GraphRoom>,
    area_m2: f64,
    windows: u32,
    household: &'h Household<'h>,
    /// The line whose number follows from who is there, and that number.
    occupied: Option<(usize, u32)>,
    /// Objects that come before what the room's type begins with.
    named: Vec<&'a String>,
    /// The line of a bed that is asked for: it comes in the place of the usual one.
    bed: Option<&'a Furnishing>,
}

impl<'a> Order<'a, '_> {
    fn is_named(&self, object: &ObjectType) -> bool {
        self.named.iter().any(|id| **id == object.id)
    }

    /// Returns true for a line that the building or somebody asks for.
    fn wants(&self, f: &Furnishing) -> bool {
        // who eats there, whoever sleeps in the building
        let guests = self.graph.and_then(|g| g.occupants).filter(|_| self.occupied.is_none());
        // what is asked for by name comes whoever lives there
        let called = || self.domain.anchor(&f.item).is_some_and(|a| self.is_named(a));
        let given_up = self.bed.is_some_and(|b| b.instead_of.contains(&f.item));
        let berth = || self.graph.is_some_and(|g| self.household.berths.contains(g.id.as_str()));
        if !f.required && self.domain.is_dock(&f.item) && !berth() {
            return false;
        }
        (self.household.wants(self.kind, f, guests) || f.sleepers > 0 && called()) && !given_up
    }

    /// Returns true where each robot has a dock of its own: in a room that is there for it.
    fn are_berths(&self, f: &Furnishing, anchor: &ObjectType) -> bool {
        f.required && anchor.shape == Shape::Dock && self.household.in_each > 0
    }

    /// Returns true for what somebody asked for. A table that is asked for may be the larger one that suits the people and the
    /// room; the same table at a wall comes where it finds no place in the middle.
    fn is_asked(&self, line: usize, f: &Furnishing, anchor: &ObjectType) -> bool {
        let anchor_of = |o: &Furnishing| self.domain.anchor(&o.item);
        let larger = |o: &Furnishing| {
            let named = anchor_of(o).is_some_and(|a| self.is_named(a));
            named && o.instead_of.contains(&f.item) && f.units(self.area_m2) > 0
        };
        let same = |o: &Furnishing| f.instead_of.contains(&o.item) && anchor_of(o).is_some_and(|a| a.id == anchor.id);
        let lines = &self.kind.furnishing;
        match is_table(anchor) {
            true => self.is_named(anchor) && !lines[..line].iter().any(same) || lines.iter().any(larger),
            false => self.is_named(anchor),
        }
    }

    /// Returns how many units of a line the room is to have, and how many of them it cannot do without.
    fn count_of(&self, line: usize, f: &Furnishing, anchor: &ObjectType) -> (u32, u32) {
        let lines = &self.kind.furnishing;
        let mut count = f.units(self.area_m2).min(MAX_UNITS);
        let mut required = if f.required { f.min } else { 0 };
        if self.bed.is_some_and(|b| std::ptr::eq(b, f)) {
            required = 1;
        }
        if self.are_berths(f, anchor) {
            count = docks_held(f, self.area_m2, self.household.in_each, self.household.circle_m);
        }
        let in_rows = f.arrangement == Arrangement::Rows;
        // what finds no wall of the same stands in rows
        let goes_on = |of: usize| line > of && in_rows && lines.get(of).is_some_and(|o| o.item == f.item);
        let both_work = |of: usize| [&f.item, &lines[of].item].iter().all(|item| works(self.domain, item));
        match self.occupied {
            Some((steered, units)) if steered == line || goes_on(steered) => {
                count = units.max(f.min);
                required = required.min(count);
            }
            // a room has as many desks as people
            Some((steered, _)) if !f.required && !in_rows && both_work(steered) => count = 0,
            _ => {}
        }
        if f.arrangement == Arrangement::AtWindow {
            count = count.min(self.windows);
            required = required.min(self.windows);
        }
        let asked = self.is_asked(line, f, anchor);
        (count.max(u32::from(asked && f.max > 0)), required)
    }

    /// Returns the tasks of a furnishing line: none, one, or two where the room can do without some of the units.
    fn tasks_of(&self, line: usize, f: &'a Furnishing) -> Vec<Task<'a>> {
        let Some(anchor) = self.domain.anchor(&f.item) else { return Vec::new() };
        let (count, required) = self.count_of(line, f, anchor);
        if count == 0 {
            return Vec::new();
        }
        let lines = &self.kind.furnishing;
        let asked = self.is_asked(line, f, anchor);
        let in_its_place = || lines.iter().any(|other| other.required && other.instead_of.contains(&f.item));
        let steered = self.occupied.is_some_and(|o| o.0 == line);
        let whole = Task {
            item: &f.item,
            anchor,
            arrangement: f.arrangement,
            count,
            required,
            spare: 0,
            line,
            leads: line == 0 || f.instead_of.contains(&lines[0].item),
            rule: format!("furnishing line {} ({}): {}", line + 1, f.item, f.arrangement.name()),
            instead_of: &f.instead_of,
            first_choice: asked || in_its_place(),
            asked: asked || f.sleepers > 0 && anchor.shape == Shape::Bed || self.are_berths(f, anchor) && count > 1,
            for_guests: is_table(anchor) && steered,
            for_many: is_table(anchor) && f.sleepers > 0,
            usual_width_m: usual_width_m(self.domain, f),
            seats: if self.occupied.is_none() { at_table(self.domain, f, self.graph) } else { None },
        };
        if whole.is_batch() || required == 0 || required == count || steered {
            return vec![whole];
        }
        // what the room cannot do without comes before the rest of the same line
        vec![Task { count: required, ..whole.clone() }, Task { count: count - required, required: 0, ..whole }]
    }

    /// Returns the tasks of what the graph wishes for beyond the lines of the room's type.
    fn wished(&self) -> impl Iterator<Item = Task<'a>> {
        let wishes = wishes(self.domain, self.kind, self.graph).into_iter().enumerate();
        wishes.map(move |(i, (object, count))| {
            let arrangement = natural(object);
            Task {
                item: &object.id,
                anchor: object,
                arrangement,
                count,
                required: 0,
                spare: 0,
                line: self.kind.furnishing.len() + i,
                leads: false,
                rule: format!("wished for in the scene graph ({}): {}", object.id, arrangement.name()),
                instead_of: &[],
                first_choice: self.is_named(object),
                asked: self.is_named(object),
                for_guests: false,
                for_many: false,
                usual_width_m: storage_width_m(object),
                seats: None,
            }
        })
    }
}

/// Returns true for what people sit at to eat or talk.
pub(crate) fn is_table(object: &ObjectType) -> bool {
    matches!(object.shape, Shape::Table | Shape::RoundTable)
}

/// Lets what finds no wall be missing where a later line has it in rows.
fn spare_for_rows(tasks: &mut [Task]) {
    for k in 0..tasks.len() {
        let (item, line) = (tasks[k].item, tasks[k].line);
        let later = |t: &Task| t.item == item && t.line > line && t.arrangement == Arrangement::Rows;
        if tasks.iter().any(later) {
            tasks[k].spare = tasks[k].count - tasks[k].required.max(1).min(tasks[k].count);
        }
    }
}

/// Sorts tasks by what comes first in a room.
fn sort(tasks: &mut [Task], kind: &RoomType, has_robots: bool) {
    // a household eats before its vacuum robot does
    let table = |t: &Task| kind.furnishing.get(t.line).is_some_and(|f| !f.unless_rooms.is_empty());
    // where robots live a dock comes before what it stands beside, for it needs more floor
    let dock = |t: &Task| has_robots && t.required == 0 && t.anchor.shape == Shape::Dock;
    // corners are few: what cannot do without one comes before what only wants a wall
    let corner = |t: &Task| t.is_needed() && t.arrangement == Arrangement::Corner;
    // where one eats the table comes before a desk that is asked for too
    let sleeps = tasks.iter().any(|t| t.anchor.shape == Shape::Bed);
    let eats = !sleeps && tasks.iter().any(table);
    let waits = |t: &Task| eats && t.required == 0 && t.anchor.shape == Shape::Desk;
    tasks.sort_by_key(|t| {
        let phase = if waits(t) { phase(t).max(2) } else { phase(t) };
        (phase, !table(t), !dock(t), !corner(t), t.line)
    });
}

/// Returns how wide what things are stored in usually is, m; `None` for all else.
pub(crate) fn storage_width_m(object: &ObjectType) -> Option<f64> {
    let stores = object.mount == Mount::Floor && matches!(object.shape, Shape::Cabinet | Shape::Shelf);
    object.sizes_m.first().filter(|size| stores && size[2] > EYE_LEVEL_M).map(|size| size[0])
}

/// Returns how wide what a line stores things in should be, m: a narrow wardrobe in the place of a wide one is narrow.
fn usual_width_m(domain: &Domain, line: &Furnishing) -> Option<f64> {
    let own = storage_width_m(domain.anchor(&line.item)?)?;
    let instead = line.instead_of.iter().filter_map(|item| storage_width_m(domain.anchor(item)?));
    Some(instead.fold(own, f64::max))
}

/// Returns true for rooms that people have desks in.
pub(crate) fn has_desks(domain: &Domain, kind: &RoomType) -> bool {
    let desk = |item: &str| domain.anchor(item).is_some_and(|o| o.shape == Shape::Desk);
    kind.furnishing.iter().any(|f| f.min > 0 && desk(&f.item))
}

/// Takes desks away that the room has no need of, the last line's first, until no more people work there than are advised.
fn thin_out(domain: &Domain, tasks: &mut Vec<Task>, people: u32) {
    let desks = |t: &Task| usual_unit(domain, t.item).map_or(0, |u| u.desks());
    let each: Vec<u32> = tasks.iter().map(desks).collect();
    let mut over = tasks.iter().zip(&each).map(|(t, n)| t.count * n).sum::<u32>().saturating_sub(people);
    for (task, n) in tasks.iter_mut().zip(&each).rev().filter(|(_, n)| **n > 0) {
        let gone = (over / n).min(task.count - task.required.max(1).min(task.count));
        task.count -= gone;
        over -= gone * n;
    }
}

/// Lets a screen or board face the rows of seats a room begins with, where no line says what faces them.
///
/// People at desks and tables look at their work and at each other.
fn turn_to_audience(tasks: &mut [Task]) {
    let seats = |t: &Task| matches!(t.anchor.shape, Shape::Bench | Shape::Chair | Shape::Sofa);
    let audience = tasks.iter().any(|t| t.line == 0 && t.arrangement == Arrangement::Rows && seats(t));
    if !audience || tasks.iter().any(|t| t.arrangement == Arrangement::Facing) {
        return;
    }
    let shown = |t: &&mut Task| {
        t.anchor.shape == Shape::Panel
            && t.arrangement == Arrangement::Wall
            && t.anchor.affordances.iter().any(|a| a == "see")
    };
    if let Some(task) = tasks.iter_mut().find(shown) {
        task.arrangement = Arrangement::Facing;
    }
}

/// Returns the line that beds, desks or seats for the room's occupants belong to, and how many units they need.
fn occupied_line(
    domain: &Domain,
    kind: &RoomType,
    graph: Option<&GraphRoom>,
    household: &Household,
) -> Option<(usize, u32)> {
    let people = graph?.occupants.filter(|n| *n > 0)?;
    let capacity = |measure: fn(&Unit) -> u32| {
        kind.furnishing.iter().enumerate().filter(|(_, f)| household.wants(kind, f, None)).find_map(|(line, f)| {
            let unit = usual_unit(domain, &f.item)?;
            let each = measure(&unit);
            (each > 0 && f.max > 0).then_some((line, each))
        })
    };
    // treatment chairs are no seats of a waiting room
    let counted = || offer::places(domain, kind).map(|places| (0, places.each));
    let counter = || offer::counters(domain, kind).map(|(line, _)| (line, 1));
    // not the chairs for visitors beside what the room is for
    let seats = || {
        let many = |f: &Furnishing| {
            f.max > 1 && (f.required || is_shape(domain, &f.item, &[Shape::Bench, Shape::Table, Shape::RoundTable]))
        };
        kind.furnishing.iter().enumerate().filter(|(_, f)| household.wants(kind, f, None) && many(f)).find_map(
            |(line, f)| {
                let each = usual_unit(domain, &f.item)?.places();
                (each > 0).then_some((line, each))
            },
        )
    };
    // what the room begins with is what it is for: its pupils, not the desk of their teacher
    let lead = || {
        let unit = usual_unit(domain, &kind.furnishing.first().filter(|f| f.required && f.max > 1)?.item)?;
        let each = if unit.work_places() > 0 { unit.work_places() } else { unit.places() };
        (each > 0).then_some((0, each))
    };
    let (line, each) = capacity(|u| u.beds())
        .or_else(counted)
        .or_else(counter)
        .or_else(lead)
        .or_else(|| capacity(|u| u.work_places()))
        .or_else(seats)?;
    let units = people.div_ceil(each).min(MAX_UNITS);
    Some((line, units))
}

fn works(domain: &Domain, item: &str) -> bool {
    usual_unit(domain, item).is_some_and(|u| u.work_places() > 0)
}

fn is_shape(domain: &Domain, item: &str, shapes: &[Shape]) -> bool {
    domain.anchor(item).is_some_and(|o| shapes.contains(&o.shape))
}

/// Returns how many people a room is for who sit at its one table.
fn at_table(domain: &Domain, f: &Furnishing, graph: Option<&GraphRoom>) -> Option<u32> {
    let people = graph?.occupants.filter(|n| *n > 0)?;
    let table = f.max == 1 && f.arrangement == Arrangement::Center;
    (table && usual_unit(domain, &f.item)?.seats() > 1).then_some(people)
}

/// Returns a group or object as it is where nothing is in the way.
fn usual_unit<'a>(domain: &'a Domain, item: &'a str) -> Option<Unit<'a>> {
    variants(domain, item, &Forms::plain(i32::MAX / 2)).into_iter().next()
}

/// Returns the task of one object that somebody wants in a room, whatever its type asks for.
pub(crate) fn one_more(object: &ObjectType) -> Task<'_> {
    let arrangement = natural(object);
    let rule = format!("added by an edit ({}): {}", object.id, arrangement.name());
    let item = &object.id;
    Task {
        item,
        anchor: object,
        arrangement,
        count: 1,
        required: 1,
        spare: 0,
        line: 0,
        leads: false,
        rule,
        instead_of: &[],
        first_choice: false,
        asked: false,
        for_guests: false,
        for_many: false,
        usual_width_m: storage_width_m(object),
        seats: None,
    }
}

/// Returns what the graph wishes for beyond the lines of the room's type, and how many.
fn wishes<'a>(domain: &'a Domain, kind: &RoomType, graph: Option<&GraphRoom>) -> Vec<(&'a ObjectType, u32)> {
    let mut out: Vec<(&ObjectType, u32)> = Vec::new();
    for id in graph.map_or(&[][..], |g| &g.wished_assets) {
        let covered = kind.furnishing.iter().any(|f| {
            &f.item == id
                || domain.group(&f.item).is_some_and(|g| &g.anchor == id || g.members.iter().any(|m| &m.object == id))
        });
        if let Some(object) = domain.object(id)
            && !covered
        {
            match out.iter_mut().find(|(o, _)| o.id == object.id) {
                Some((_, count)) => *count += 1,
                None => out.push((object, 1)),
            }
        }
    }
    out
}

/// Returns where a thing goes that no furnishing line speaks of.
fn natural(object: &ObjectType) -> Arrangement {
    match object.mount {
        Mount::Floor | Mount::Wall => Arrangement::Wall,
        Mount::Ceiling => Arrangement::Overhead,
        Mount::Surface => Arrangement::OnSurface,
    }
}

fn phase(task: &Task) -> u8 {
    use Arrangement::{AtWindow, Center, Facing, OnSurface, Overhead, Rows};
    let last = matches!(task.arrangement, OnSurface | Overhead | AtWindow);
    match (task.is_needed(), task.arrangement) {
        _ if last => 4,
        // what faces the first line comes after it
        (true, Rows | Center | Facing) => 1,
        // a screen finds its wall before others take it
        (false, Facing) => 1,
        (true, _) => 0,
        // what faces the first line comes after it
        (false, _) if task.leads && takes_floor(task.anchor) => 1,
        (false, _) if takes_floor(task.anchor) => 2,
        (false, _) => 3,
    }
}

/// Returns true for what stands on the floor or hangs so low and deep that one needs the floor before it.
fn takes_floor(object: &ObjectType) -> bool {
    let low = object.mount_height_m.is_none_or(|z| z < ROBOT_HEIGHT_M);
    let depth = object.sizes_m.first().map_or(0.0, |s| s[1]);
    object.mount == Mount::Floor
        || (object.mount == Mount::Wall && low && (depth > 0.15 || object.clearance_front_m > 0.3))
}
