//! The search: units in order of constraint, the best position each, and other choices for the first ones where that
//! furnishes the room better (limited discrepancy search).

use std::collections::BTreeMap;
use std::ops::Range;
use std::rc::Rc;

use d3dgen_knowledge::Aim;
use d3dgen_model::domain::{Arrangement, Domain, Mount, Shape};
use d3dgen_model::stage::Stop;

use super::demand::{Task, is_table, storage_width_m};
use super::draft::{ASIDE, AT_WALL, DEEPEST, DEPARTURES, Departure, Draft, RESCUES, Seen};
use super::find::{Candidate, Find, Tally, Terms, leave_out_single, lines_at_exit, over, rows};
use super::nav::Nav;
use super::space::{Open, Space};
use super::state::{Placed, Rule, State};
use super::unit::{Forms, Sizes, Unit, variants};
use super::way::{self, Way};

/// Positions whose routes are looked at before a unit counts as unplaceable.
const ROUTE_TESTS: usize = 40;
/// Positions with free routes that are weighed against each other.
const WEIGHED: usize = 4;
/// Share of the units that rows of smaller or closer ones would hold from which those that keep more rules are taken.
const WORTH: f64 = 0.75;
/// Smaller numbers of units for which rows are drawn up where those for all have holes.
const FEWER: u32 = 3;
/// Furnishing lines that a room should not go without, and how many more drafts are made for them where the room is small,
/// in cells (19 m^2), so that drafts take little time.
const EARLY: usize = 4;
const MORE_DRAFTS: usize = 3;
const SMALL: usize = 7_600;
/// Other beginnings of the search where floor is closed off.
const MORE_BEGINNINGS: u64 = 3;
/// How much narrower than usual storage is too narrow, and what a draft loses with all of it missing.
const NARROW: f64 = 0.3;
const NARROWER: f64 = 3.0;
/// What a draft is worth more with the table that all who live there sit at.
const TABLE_FOR_MANY: f64 = 2.5;
/// What a draft loses without something that was asked for by name.
const ASKED: f64 = 3.0;
/// How far beside the axis of those on a sofa a screen is that they do not see well, mm.
const FAR_ASIDE: i32 = 700;
/// How far from the door hands are washed at most, mm.
const FAR_FROM_DOOR: i32 = 2500;
/// Departures tried where something has no place that the room can do without.
const LOOKS: usize = 2;
/// Units in rows or a grid, and what they are worth.
struct Rows<'a> {
    units: Vec<Placed<'a>>,
    score: f64,
    /// False when they close off floor, where that is looked at.
    open: bool,
    /// How many count that people get to.
    reached: usize,
}

/// What one room's search needs to know.
pub(crate) struct Job<'a, 's> {
    pub domain: &'a Domain,
    pub space: &'s Space,
    pub tasks: &'s [Task<'a>],
    /// Objects that stay where they are.
    pub locked: &'s [Placed<'a>],
    /// How many units of each task are among them.
    pub present: &'s [u32],
    /// Size of each object type in this room.
    pub sizes: &'s Sizes<'s>,
    /// What rules ask of the object types, by id.
    pub aims: &'s BTreeMap<&'s str, Aim>,
    pub salt: u64,
    /// Radius of the robot, mm.
    pub radius: i32,
    /// True where robots are asked for.
    pub has_robots: bool,
    /// Radius of the circle that rules want free for wheelchairs, mm.
    pub turning: Option<i32>,
    /// Width of the way to each of many desks, mm.
    pub access: Option<i32>,
    /// True where step-free access is asked for.
    pub step_free: bool,
    /// What must stay open from door to door, or for beds.
    pub way: Option<&'s Way>,
    /// The same with the width that is advised, where the room has it.
    pub wide_way: Option<&'s Way>,
    /// True for what rather stands nowhere than where clearances have to be less.
    pub in_comfort: bool,
    /// When to give up; the outcome is then of no use.
    pub stop: Stop<'s>,
}

/// How strict a pass is.
pub(crate) struct Level {
    /// Clearances, as a share of what the domain says.
    pub tightness: f64,
    /// Those of beds on wheels: other things move together before nobody can stand beside a patient.
    beds: f64,
    /// Margin around the robot, mm.
    pub margin: i32,
    /// True to look for the free floor and the width of ways that are advised too.
    pub advised: bool,
    /// True to keep ways outside of circulation too.
    pub ways: bool,
    /// What is kept free before doors and windows.
    pub open: Open,
}

impl Level {
    const fn new(tightness: f64, margin: i32) -> Self {
        let open = Open { doors: true, deep: false, windows: false };
        Self { tightness, beds: tightness, margin, advised: false, ways: true, open }
    }

    /// Returns the share of its clearances that a task's units keep.
    pub(crate) fn tightness_of(&self, task: &Task) -> f64 {
        match task.anchor.shape {
            _ if task.required == 0 => 1.0,
            Shape::HospitalBed => self.beds,
            _ => self.tightness,
        }
    }
}

/// The last pass that tries what has something else in its place, the last that is made for the seats of guests, which still keeps
/// ways, and the last for what was asked for by name.
const FIRST_CHOICES: usize = 1;
const GUESTS: usize = 3;
const ASKED_FOR: usize = 5;
const NOT_OPEN: Open = Open { doors: false, deep: false, windows: false };
const WIDE_OPEN: Open = Open { doors: true, deep: true, windows: true };

/// The passes in turn, the strictest first.
pub(crate) const LEVELS: [Level; 12] = [
    Level { advised: true, open: WIDE_OPEN, ..Level::new(1.0, 50) },
    Level { open: Open { deep: false, ..WIDE_OPEN }, ..Level::new(1.0, 50) },
    Level::new(1.0, 20),
    Level { beds: 1.0, ..Level::new(0.75, 20) },
    Level { ways: false, ..Level::new(1.0, 20) },
    Level { ways: false, beds: 1.0, ..Level::new(0.75, 20) },
    Level { ways: false, beds: 0.85, ..Level::new(0.65, 20) },
    Level { ways: false, ..Level::new(0.5, 20) },
    Level { ways: false, open: NOT_OPEN, ..Level::new(1.0, 20) },
    Level { ways: false, open: NOT_OPEN, ..Level::new(0.75, 20) },
    Level { ways: false, open: NOT_OPEN, ..Level::new(0.5, 10) },
    Level { ways: false, open: NOT_OPEN, ..Level::new(0.0, 5) },
];

/// How many of them leave all clearances whole.
const IN_COMFORT: usize = 3;

/// A furnished room.
#[derive(Clone)]
pub(crate) struct Outcome<'a> {
    pub placed: Vec<Placed<'a>>,
    /// Tasks with how many units are missing and the rule that stopped them.
    pub missing: Vec<(usize, u32, Rule)>,
    /// Missing units the room cannot do without.
    pub required_missing: u32,
    /// Floor that furniture closes off, as [`super::pockets::Pockets::area`] counts it.
    pub closed: i64,
    pub score: f64,
    /// Index into [`LEVELS`].
    pub level: usize,
}

impl Outcome<'_> {
    /// Returns what is worst about it: what is missing that must not be, then floor that is closed off.
    fn lacks(&self) -> (u32, i64) {
        (self.required_missing, self.closed)
    }

    /// Returns how many items had no place that somebody asked for.
    fn asked_for(&self, job: &Job) -> usize {
        self.missing.iter().filter(|(task, ..)| job.tasks[*task].asked).count()
    }

    /// Returns how many tables have no place that guests were to sit at.
    fn tables_short(&self, job: &Job) -> u32 {
        self.missing.iter().filter(|(task, ..)| job.tasks[*task].for_guests).map(|(_, count, _)| count).sum()
    }

    /// Returns how many items had no place for which something required comes in their place.
    fn second_choices(&self, job: &Job) -> usize {
        self.missing.iter().filter(|(task, ..)| job.tasks[*task].first_choice).count()
    }
}

/// Furnishes a room as well as the search can; where floor stays closed off, from other beginnings too.
pub(crate) fn furnish<'a>(job: &Job<'a, '_>) -> Outcome<'a> {
    let mut best = relax(job);
    for again in 1..=MORE_BEGINNINGS {
        if best.closed == 0 || job.stop.is_set() {
            break;
        }
        let other = relax(&Job { salt: job.salt.wrapping_add(again), ..*job });
        if other.lacks() < best.lacks() {
            best = other;
        }
    }
    best
}

/// Furnishes a room, relaxing clearances only while something required has no place; what is only advised goes before floor
/// is closed off too.
fn relax<'a>(job: &Job<'a, '_>) -> Outcome<'a> {
    let mut best: Option<Outcome> = None;
    let levels = if job.in_comfort { IN_COMFORT } else { LEVELS.len() };
    for level in 0..levels {
        let outcome = Pass::new(job, level).furnish();
        let advice_left = LEVELS.get(level + 1).is_some_and(|next| next.tightness >= 1.0 && next.open.doors);
        let second_choice = level < FIRST_CHOICES && outcome.second_choices(job) > 0;
        let asked_for = level < ASKED_FOR && outcome.asked_for(job) > 0;
        let seats_short = level < GUESTS && outcome.tables_short(job) > 0;
        let wished = second_choice || asked_for || seats_short;
        let done = outcome.required_missing == 0 && (outcome.closed == 0 || !advice_left) && !wished;
        let lacks = |o: &Outcome| (o.lacks(), o.asked_for(job), o.tables_short(job), o.second_choices(job));
        if best.as_ref().is_none_or(|b| lacks(&outcome) < lacks(b)) {
            best = Some(outcome);
        }
        if done || job.stop.is_set() {
            break;
        }
    }
    best.expect("there is at least one level")
}

/// Returns forms of a table for so many: the smallest with seats enough first, then those with fewer.
fn seated<'a>(mut forms: Vec<Unit<'a>>, people: Option<u32>) -> Vec<Unit<'a>> {
    let Some(people) = people else { return forms };
    forms.sort_by_key(|unit| match unit.seats() {
        seats if seats >= people => (0, seats),
        seats => (1, people - seats),
    });
    forms.into_iter().map(|unit| unit.with_seats(people)).collect()
}

/// One level of strictness with the units built for it.
struct Pass<'j, 'a, 's> {
    job: &'j Job<'a, 's>,
    level: usize,
    /// Forms of each task's unit, mirrored ones beside them.
    forms: Vec<Vec<Vec<Rc<Unit<'a>>>>>,
    start: State<'a, 's>,
}

impl<'j, 'a, 's> Pass<'j, 'a, 's> {
    fn new(job: &'j Job<'a, 's>, level: usize) -> Self {
        let Level { margin, advised, ways, open, .. } = LEVELS[level];
        let forms = job.tasks.iter().map(|task| {
            let tightness = LEVELS[level].tightness_of(task);
            let free = matches!(task.arrangement, Arrangement::Center | Arrangement::Rows);
            let (sizes, aims, ceiling) = (job.sizes, job.aims, job.space.ceiling);
            let (lawful, robot) = (task.required == 0 && !task.asked && !task.first_choice, 2 * job.radius);
            let forms = Forms { sizes, aims, tightness, advised, lawful, ceiling, robot };
            seated(variants(job.domain, task.item, &forms), task.seats)
                .into_iter()
                .map(|unit| if free { unit.free_standing() } else { unit })
                .map(|unit| {
                    unit.mirrored().into_iter().fold(vec![Rc::new(unit)], |mut all, m| {
                        all.push(Rc::new(m));
                        all
                    })
                })
                .collect()
        });
        let forms = forms.collect();
        let mut start = State::new(
            job.space,
            Nav::new(job.space, job.radius + margin),
            if advised { job.wide_way } else { job.way }.filter(|way| ways || way.kind == way::Kind::Circulation),
            open,
        );
        start.has_robots = job.has_robots;
        start.keep_circle(job.turning);
        if let Some(width) = job.access.filter(|_| open.doors) {
            start.keep_access(width);
        }
        start.add(job.locked.to_vec());
        Self { job, level, forms, start }
    }

    /// Furnishes the room: several drafts of what stands on the floor, the best one with everything else.
    fn furnish(&self) -> Outcome<'a> {
        let tasks = self.job.tasks;
        let floor = tasks.iter().position(|t| t.is_decor()).unwrap_or(tasks.len());
        let empty = self.start.free_area;
        let mut best = self.blank();
        // what drafts that depart later begin with
        let mut begun: Vec<(usize, Draft)> = Vec::new();
        for index in 0..floor {
            if best.steps.len() > begun.last().map_or(0, |(_, draft)| draft.steps.len()) && best.steps.len() <= DEEPEST
            {
                begun.push((index, best.clone()));
            }
            self.run(&mut best, index..index + 1, None, false);
        }
        let mut seen = Seen::default();
        seen.note(&best, None);
        let mut best_of = None;
        let hopeless = best.outcome.required_missing > 0 && self.hopeless();
        for (n, departure) in DEPARTURES.into_iter().chain(RESCUES).enumerate() {
            let looks = match best.outcome.missing.is_empty() {
                _ if best.docks_taken() > 0
                    || best.state.lacks_circle()
                    || best.eats_at_sofa()
                    || self.washes_far_in(&best)
                    || self.looks_aside(&best) =>
                {
                    DEPARTURES.len() + RESCUES.len()
                }
                // everything has found its place
                true => 0,
                false if best.outcome.asked_for(self.job) > 0 => DEPARTURES.len() + RESCUES.len(),
                false if self.lacks_table_for_many(&best) => DEPARTURES.len() + RESCUES.len(),
                false if empty < SMALL && self.lacks_something_early(&best) => DEPARTURES.len() + MORE_DRAFTS,
                false => LOOKS,
            };
            if self.job.stop.is_set()
                || hopeless
                || departure.step >= best.steps.len()
                || n >= looks && best.outcome.required_missing == 0
            {
                continue;
            }
            let begun = begun.iter().rfind(|(_, draft)| draft.steps.len() <= departure.step).cloned();
            let begun = begun.unwrap_or_else(|| (0, self.blank()));
            let Some(other) = self.draft(begun, floor, Some(departure), false, &mut seen) else { continue };
            if other.cost(empty) < best.cost(empty) {
                (best, best_of) = (other, Some(departure));
            }
        }
        self.improve((&mut best, &mut best_of), &AT_WALL, floor, &mut seen, |draft| self.crowds_out(draft));
        self.improve((&mut best, &mut best_of), &ASIDE, floor, &mut seen, |draft| self.bed_crowds_out_wardrobe(draft));
        // once more with an eye on every corner, where floor is closed off; few rooms need it
        let mut closed = best.state.pockets.area();
        // what stands there for good may close off floor by itself
        let open = if closed > 0 { self.start.pockets.area() } else { 0 };
        let mut seen = Seen::default();
        for departure in [best_of].into_iter().chain(DEPARTURES.into_iter().chain(RESCUES).map(Some)) {
            let too_late = departure.is_some_and(|d| d.step >= best.steps.len());
            if closed <= open || self.job.stop.is_set() || too_late {
                break;
            }
            let begun = (0, self.blank());
            let Some(other) = self.draft(begun, floor, departure, true, &mut seen) else { continue };
            let lacks = other.outcome.required_missing > best.outcome.required_missing;
            let still = other.state.pockets.area();
            if !lacks && still < closed {
                (best, closed) = (other, still);
            }
        }
        self.run(&mut best, floor..tasks.len(), None, true);
        best.outcome.closed = (closed - open).max(0);
        Outcome { placed: best.state.placed, ..best.outcome }
    }

    /// Tries departures from the first task on for as long as the best draft lacks something; keeps what is better.
    fn improve(
        &self,
        (best, best_of): (&mut Draft<'a, 's>, &mut Option<Departure>),
        departures: &[Departure],
        floor: usize,
        seen: &mut Seen<'a>,
        lacks: impl Fn(&Draft<'a, 's>) -> bool,
    ) {
        let empty = self.start.free_area;
        for &departure in departures {
            if self.job.stop.is_set() || !lacks(best) {
                break;
            }
            let Some(other) = self.draft((0, self.blank()), floor, Some(departure), false, seen) else { continue };
            if other.cost(empty) < best.cost(empty) {
                (*best, *best_of) = (other, Some(departure));
            }
        }
    }

    /// Goes on with a draft from one of the tasks up to `floor`, with one departure; `None` where that leads to what was seen.
    fn draft(
        &self,
        (from, mut draft): (usize, Draft<'a, 's>),
        floor: usize,
        departure: Option<Departure>,
        whole: bool,
        seen: &mut Seen<'a>,
    ) -> Option<Draft<'a, 's>> {
        for index in from..floor {
            let before = draft.steps.len();
            self.run(&mut draft, index..index + 1, departure, whole);
            let departed = departure.map(|d| d.step).filter(|step| (before..draft.steps.len()).contains(step));
            if departed.is_some_and(|step| draft.chosen(step).is_some_and(|chosen| seen.has(step, chosen))) {
                return None;
            }
        }
        seen.note(&draft, departure);
        Some(draft)
    }

    fn blank(&self) -> Draft<'a, 's> {
        let (missing, level) = (Vec::new(), self.level);
        let outcome = Outcome { placed: Vec::new(), missing, required_missing: 0, closed: 0, score: 0.0, level };
        Draft { state: self.start.clone(), outcome, steps: Vec::new() }
    }

    /// Returns true when something of the first lines has no place, nor what may come in its place.
    fn lacks_something_early(&self, draft: &Draft) -> bool {
        let tasks = self.job.tasks;
        let placed = || draft.state.placed.iter().filter_map(|p| tasks.get(p.task));
        let has_other =
            |item: &str| placed().any(|task| task.item == item || task.instead_of.iter().any(|of| of == item));
        let mut missing = draft.outcome.missing.iter().map(|(task, ..)| &tasks[*task]);
        missing.any(|task| task.line < EARLY && !has_other(task.item))
    }

    /// Returns true where the table for all who live there has no place.
    fn lacks_table_for_many(&self, draft: &Draft) -> bool {
        let tasks = self.job.tasks;
        draft.outcome.missing.iter().any(|(task, ..)| tasks[*task].for_many)
    }

    /// Returns true where a sofa leaves too little floor for the table or for what was asked for by name.
    fn crowds_out(&self, draft: &Draft) -> bool {
        self.lacks_table_for_many(draft) || draft.eats_at_sofa() || draft.outcome.asked_for(self.job) > 0
    }

    /// Returns true where a basin that belongs to the door is far from it.
    fn washes_far_in(&self, draft: &Draft) -> bool {
        let Some(door) = self.job.space.doors.first() else { return false };
        let belongs = |p: &&Placed| {
            let task = self.job.tasks.get(p.task);
            let by_door = task.is_some_and(|t| t.arrangement == Arrangement::BesideDoor);
            by_door && p.unit.anchor().object.shape == Shape::Basin
        };
        let far = |p: &Placed| p.world(&p.unit.bbox).gap(&door.zone) > FAR_FROM_DOOR;
        draft.state.placed.iter().filter(belongs).any(far)
    }

    /// Returns true where what those on the sofa or in bed look at is far beside them.
    fn looks_aside(&self, draft: &Draft) -> bool {
        let placed = &draft.state.placed;
        let Some(first) = placed.iter().find(|p| p.first_line && p.unit.anchor().object.shape == Shape::Sofa) else {
            return false;
        };
        let along = |p: &Placed| p.world(&p.unit.anchor().solid.rect).turned((4 - first.q) % 4).center().1;
        let faces = |p: &&Placed| {
            let task = self.job.tasks.get(p.task);
            p.support.is_none() && task.is_some_and(|t| t.arrangement == Arrangement::Facing)
        };
        placed.iter().filter(faces).any(|p| (along(p) - along(first)).abs() > FAR_ASIDE)
    }

    /// Returns true where a bed came first and what clothes go into has no place, or is narrower than it usually is.
    fn bed_crowds_out_wardrobe(&self, draft: &Draft) -> bool {
        let tasks = self.job.tasks;
        let first = draft.steps.first().and_then(|start| draft.state.placed.get(*start));
        let narrow = |p: &Placed| tasks.get(p.task).is_some_and(|task| task.narrower(&p.unit) > NARROW);
        let no_place = |index: usize| tasks[index].first_choice && storage_width_m(tasks[index].anchor).is_some();
        first.is_some_and(|p| p.unit.anchor().object.shape == Shape::Bed)
            && (draft.state.placed.iter().any(narrow) || draft.outcome.missing.iter().any(|m| no_place(m.0)))
    }

    /// Returns true when something required finds no place even in the empty room, so that no order helps.
    fn hopeless(&self) -> bool {
        let tasks = self.job.tasks.iter().enumerate();
        tasks.filter(|(index, task)| task.required > self.job.present[*index] && !task.is_decor()).any(
            |(index, task)| {
                let mut tally = Tally::default();
                if task.is_batch() && !self.lines_walls(task) {
                    self.batch(&self.start, index, task.required, (0, false), &mut tally).is_none()
                } else {
                    task.arrangement != Arrangement::OnSurface
                        && self.single(&self.start, index, None, None, &mut tally).is_none()
                }
            },
        )
    }

    /// Places some of the tasks, with one departure. With `whole` nothing closes off floor, not even from a small robot,
    /// unless it is required and has no other place.
    fn run(&self, draft: &mut Draft<'a, 's>, tasks: Range<usize>, departure: Option<Departure>, whole: bool) {
        for index in tasks {
            let task = &self.job.tasks[index];
            let present = self.job.present[index];
            let present = present + task.standing(&self.job.tasks[..index], &draft.state.placed);
            let count = task.count.saturating_sub(present);
            let replaced = |item: &String| draft.state.placed.iter().any(|p| p.unit.item == item);
            let given_up = task.first_choice && !task.asked && self.level > FIRST_CHOICES;
            if count == 0 || given_up || self.job.stop.is_set() || task.instead_of.iter().any(replaced) {
                continue;
            }
            let mut tally = Tally::default();
            let mut placed = 0;
            let step = |steps: &mut Vec<usize>, state: &State| {
                steps.push(state.placed.len());
                departure.filter(|d| d.step == steps.len() - 1)
            };
            let Draft { state, outcome, steps } = draft;
            if task.is_batch() && !self.lines_walls(task) {
                let rank = step(steps, state).map_or(0, |d| d.rank);
                if let Some((units, score)) = self.batch(state, index, count, (rank, whole), &mut tally) {
                    placed = units.len() as u32;
                    outcome.score += score;
                    state.add(units);
                }
            }
            if !task.is_batch() || self.lines_walls(task) || placed > 0 && self.is_sat_around(index) {
                while placed < count && !self.job.stop.is_set() {
                    let open = whole.then_some(task.required > present + placed);
                    let Some((mut unit, score)) = self.single(state, index, step(steps, state), open, &mut tally)
                    else {
                        break;
                    };
                    unit.first_line = task.leads;
                    if task.arrangement == Arrangement::Facing {
                        state.watch(&unit);
                    }
                    outcome.score += score + if task.required > 0 { 2.0 } else { 1.0 };
                    outcome.score += if task.for_many { TABLE_FOR_MANY } else { 0.0 };
                    outcome.score -= NARROWER * task.narrower(&unit.unit);
                    state.add(vec![unit]);
                    placed += 1;
                }
            }
            if placed + task.spare < count {
                outcome.missing.push((index, count - placed, Self::decisive(&tally)));
                outcome.required_missing += task.required.saturating_sub(present + placed);
                // what a room's list names first matters most, and what somebody asked for by name
                outcome.score -= 1.0 + 3.0 / (1.0 + task.line as f64) + if task.asked { ASKED } else { 0.0 };
            }
        }
    }

    /// Returns true for rows that stand along walls: beds have their heads there.
    fn lines_walls(&self, task: &Task) -> bool {
        task.arrangement == Arrangement::Rows && matches!(task.anchor.shape, Shape::Bed | Shape::HospitalBed)
    }

    /// Returns true for rows of tables with seats around them: where the rows leave floor, more stand by themselves.
    fn is_sat_around(&self, index: usize) -> bool {
        let task = &self.job.tasks[index];
        let first = self.forms[index].first().and_then(|forms| forms.first());
        is_table(task.anchor)
            && task.arrangement == Arrangement::Rows
            && first.is_some_and(|u| u.seats() > 0 && u.look() == 0)
    }

    /// Returns the rule that stopped most positions.
    fn decisive(tally: &Tally) -> Rule {
        use Rule::{Clearance, Collision, Door, NoPlace, Outside, Route, Window};
        let rules = [NoPlace, Outside, Door, Window, Collision, Clearance, Route];
        rules.into_iter().max_by_key(|r| tally[*r as usize]).unwrap_or(NoPlace)
    }

    fn batch(
        &self,
        state: &State<'a, 's>,
        index: usize,
        count: u32,
        (rank, whole): (usize, bool),
        tally: &mut Tally,
    ) -> Option<(Vec<Placed<'a>>, f64)> {
        let task = Task { count, ..self.job.tasks[index].clone() };
        let depth = self.stage(&task);
        let terms = |stage: i32| Terms {
            salt: self.job.salt,
            robot: self.aisle(),
            one_way: self.job.tasks.iter().any(|t| t.arrangement == Arrangement::Facing),
            stage,
        };
        // a stage one can walk around, a bare one, none: the first that leaves room for those who must sit
        let mut stages = vec![depth + self.aisle(), depth, 0];
        stages.retain(|stage| depth > 0 || *stage == 0);
        let mut best = None;
        let mut at = 0;
        for stage in stages {
            at = stage;
            best = self.best_batch(state, &task, index, (rank, whole), &terms(stage), tally);
            if best.as_ref().is_some_and(|b| b.0.len() as u32 >= task.required.max(1)) {
                break;
            }
        }
        // rows out of which units had to go have holes: as many or more in rows drawn up for that number have none; desks in
        // pairs are drawn up so as it is
        let held = best.as_ref().map_or(0, |b| b.0.len() as u32);
        let short = count.saturating_sub(held + task.spare);
        let pairs = task.anchor.shape == Shape::Desk && !terms(at).one_way;
        if held > 1 && short > 0 && task.arrangement == Arrangement::Rows && !pairs {
            let fewer = (held..count).rev().step_by(short.div_ceil(FEWER) as usize).chain([held]);
            let drawn_up = |n: u32, tally: &mut Tally| {
                let task = Task { count: n, spare: 0, ..task.clone() };
                self.best_batch(state, &task, index, (rank, whole), &terms(at), tally)
            };
            let mut whole_rows = fewer.filter_map(|n| drawn_up(n, tally).filter(|b| b.0.len() as u32 >= n));
            best = whole_rows.next().or(best);
        }
        best
    }

    /// Returns the depth of what faces the rows a room begins with, mm.
    fn stage(&self, task: &Task) -> i32 {
        if task.line > 0 || task.arrangement != Arrangement::Rows || !task.is_audience() {
            return 0;
        }
        let facing = self.job.tasks.iter().zip(&self.forms).filter(|(t, _)| t.arrangement == Arrangement::Facing);
        let depths = facing.filter_map(|(_, forms)| forms.first()?.first()).map(|u| u.as_looking(&u.reach).width());
        depths.max().unwrap_or(0)
    }

    /// Returns true for a dock in a room that is to have more of them.
    fn is_one_of_several_docks(&self, task: &Task) -> bool {
        let docks = self.job.tasks.iter().filter(|t| t.anchor.shape == Shape::Dock);
        task.anchor.shape == Shape::Dock && docks.map(|t| t.count).sum::<u32>() > 1
    }

    /// Returns what stands on the floor and faces the only unit of the line a room begins with.
    fn across(&self, task: &Task) -> Option<Rc<Unit<'a>>> {
        if task.line > 0 || task.count > 1 {
            return None;
        }
        let faces = |t: &Task| t.arrangement == Arrangement::Facing && t.anchor.mount == Mount::Floor;
        let (_, forms) = self.job.tasks.iter().zip(&self.forms).find(|(t, _)| faces(t))?;
        forms.first()?.first().cloned()
    }

    /// Returns the narrowest gap a robot passes, mm.
    fn aisle(&self) -> i32 {
        2 * (self.job.radius + LEVELS[self.level].margin) + 50
    }

    fn best_batch(
        &self,
        state: &State<'a, 's>,
        task: &Task,
        index: usize,
        (rank, whole): (usize, bool),
        terms: &Terms,
        tally: &mut Tally,
    ) -> Option<(Vec<Placed<'a>>, f64)> {
        // the best of each form that one could have; forms come in the order of what they keep of the rules
        let mut found: Vec<Rows> = Vec::new();
        for forms in self.forms[index].iter().take_while(|_| !self.job.stop.is_set()) {
            let mut best: Option<Rows> = None;
            let unit = &forms[0];
            let batches = match task.arrangement {
                Arrangement::Overhead => over(state, task, index, unit, tally),
                Arrangement::AtExit => lines_at_exit(state, task, index, unit, terms, tally),
                _ => rows(state, task, index, unit, terms, tally),
            };
            let counted = |placed: &[Placed]| task.counted(placed.len());
            let rank_of = |r: &Rows| (r.units.len() >= task.required as usize, r.open, r.reached, r.score);
            let most = batches.iter().skip(rank).map(|b| counted(&b.placed)).max().unwrap_or(0);
            for batch in batches.into_iter().skip(rank).take_while(|_| !self.job.stop.is_set()) {
                let mut units: Vec<Placed> = Vec::new();
                keep_passable(state, &batch.placed, &mut units, tally);
                if batch.in_pairs {
                    leave_out_single(state.space, task, &mut units);
                }
                if units.is_empty() {
                    continue;
                }
                units.iter_mut().for_each(|p| p.first_line = task.leads);
                let score = batch.score + units.len() as f64;
                let reached = counted(&units).saturating_sub(state.without_access(&units));
                let rows = Rows { score, open: !whole || !state.is_closed_by(&units), reached, units };
                let no_better = rows.reached >= most && rows.open;
                if best.as_ref().is_none_or(|b| rank_of(&rows) > rank_of(b)) {
                    best = Some(rows);
                }
                if no_better {
                    break; // the others hold no more and look no better
                }
            }
            let all = best.as_ref().is_some_and(|b| b.open && b.units.len() as u32 + task.spare >= task.count);
            found.extend(best);
            if all {
                break;
            }
        }
        let most = found.iter().map(|f| f.units.len()).max()?;
        let least = (task.required as usize).max((most as f64 * WORTH).ceil() as usize).min(most);
        found.retain(|f| f.units.len() >= least);
        let first = found.iter().position(|f| f.open).unwrap_or(0);
        let Rows { units, score, .. } = found.into_iter().nth(first)?;
        Some((units, score))
    }

    /// Returns the best place for one unit of a task; `whole` as [`choose`] has it.
    fn single(
        &self,
        state: &State<'a, 's>,
        index: usize,
        departure: Option<Departure>,
        whole: Option<bool>,
        tally: &mut Tally,
    ) -> Option<(Placed<'a>, f64)> {
        let (task, forms) = (&self.job.tasks[index], &self.forms[index]);
        // what cannot do without a corner is rather smaller than away from one
        if task.required > 0 && task.arrangement == Arrangement::Corner && forms.len() > 1 {
            let found = self.single_of(state, index, departure, (whole, true), tally);
            if found.is_some() {
                return found;
            }
        }
        self.single_of(state, index, departure, (whole, false), tally)
    }

    /// Returns the best place for one unit of a task; with `in_corner` in a corner only.
    fn single_of(
        &self,
        state: &State<'a, 's>,
        index: usize,
        departure: Option<Departure>,
        (whole, in_corner): (Option<bool>, bool),
        tally: &mut Tally,
    ) -> Option<(Placed<'a>, f64)> {
        let (task, aisle) = (&self.job.tasks[index], self.aisle());
        let (rank, aside, at_wall) = departure.map_or((0, 0, false), |d| (d.rank, d.aside, d.at_wall));
        // a form that closes off floor stands only where none leaves it open, and a bed under a window only where the same bed
        // with less of the floor that is advised finds no other wall
        let mut closing = None;
        let mut lit: Option<(Placed<'a>, f64)> = None;
        for forms in self.forms[index].iter().take_while(|_| !self.job.stop.is_set()) {
            let mut candidates: Vec<Candidate> = Vec::new();
            for unit in forms {
                let mut find = Find::new(state, task, index, self.job.salt, aisle, tally);
                (find.across, find.aside, find.at_wall) = (self.across(task), aside, at_wall);
                find.banked = self.is_one_of_several_docks(task);
                candidates.extend(find.run(unit));
            }
            candidates.retain(|c| c.in_corner || !in_corner);
            candidates.sort_by(|a, b| b.score.total_cmp(&a.score));
            // a bed has its head under a window where no other wall takes it
            let (under, clear): (Vec<Candidate>, Vec<Candidate>) =
                candidates.drain(..).partition(|c| state.lies_under_window(&c.placed));
            let open = choose(state, &clear, rank, whole.map(|_| false), tally)
                .or_else(|| choose(state, &under, rank, whole.map(|_| false), tally));
            candidates = [clear, under].concat();
            match open {
                // who comes in a wheelchair needs that floor more
                Some(found) if lit.is_none() && !self.job.step_free && state.lies_under_window(&found.0) => {
                    lit = Some(found);
                }
                Some(found) if lit.as_ref().is_some_and(|l| found.0.is_less_than(&l.0, state)) => return lit,
                Some(found) => return Some(found),
                None => {}
            }
            if whole == Some(true) && closing.is_none() {
                closing = choose(state, &candidates, rank, whole, tally);
            }
        }
        lit.or(closing)
    }
}

/// Adds as many of the units as leave robots their room: all at once, else each half by itself.
fn keep_passable<'a>(state: &State<'a, '_>, units: &[Placed<'a>], kept: &mut Vec<Placed<'a>>, tally: &mut Tally) {
    let before = kept.len();
    kept.extend_from_slice(units);
    if units.is_empty() || state.route(kept).is_ok() {
        return;
    }
    kept.truncate(before);
    if let [_] = units {
        tally[Rule::Route as usize] += 1;
        return;
    }
    let (first, second) = units.split_at(units.len() / 2);
    keep_passable(state, first, kept, tally);
    keep_passable(state, second, kept, tally);
}

/// Returns the best candidate that leaves robots their room, free floor counted; `rank` skips that many classes.
///
/// With `whole` it closes off no floor from a small robot either; `Some(true)` takes one that does before none.
fn choose<'a>(
    state: &State<'a, '_>,
    candidates: &[Candidate<'a>],
    rank: usize,
    whole: Option<bool>,
    tally: &mut Tally,
) -> Option<(Placed<'a>, f64)> {
    let mut passed: Vec<(f64, u32, &Candidate)> = Vec::new();
    let mut closing: Vec<(f64, u32, &Candidate)> = Vec::new();
    let mut seen: Vec<u32> = Vec::new();
    for candidate in candidates.iter().take(ROUTE_TESTS) {
        if rank == 0 && passed.iter().any(|p| p.0 >= candidate.score) {
            break; // the others are worse, however little floor they take
        }
        let unit = std::slice::from_ref(&candidate.placed);
        match state.route(unit) {
            Ok(area) => {
                let lost = 1.0 - area as f64 / state.free_area.max(1) as f64;
                let entry = (candidate.score - 3.0 * lost, candidate.class, candidate);
                if whole.is_some() && state.is_closed_by(unit) {
                    closing.push(entry);
                    continue;
                }
                passed.push(entry);
                if !seen.contains(&candidate.class) {
                    seen.push(candidate.class);
                }
                if passed.len() >= WEIGHED && seen.len() > rank {
                    break;
                }
            }
            Err(rule) => tally[rule as usize] += 1,
        }
    }
    if passed.is_empty() {
        tally[Rule::Route as usize] += closing.len() as u32;
        if whole == Some(true) {
            passed = closing;
        }
    }
    passed.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut classes: Vec<u32> = Vec::new();
    let mut last = None;
    for (score, class, candidate) in passed {
        if !classes.contains(&class) {
            classes.push(class);
            last = Some((candidate.placed.clone(), score));
            if classes.len() > rank {
                break;
            }
        }
    }
    last
}
