//! The search: units in order of constraint, the best position each, and other choices for the first ones where that
//! furnishes the room better (limited discrepancy search).

use std::rc::Rc;

use d3dgen_model::domain::{Arrangement, Domain, ObjectType, Shape};

use super::demand::Task;
use super::find::{Candidate, Find, Tally, over, rows};
use super::nav::Nav;
use super::space::Space;
use super::state::{KeepWidth, Placed, Rule, State};
use super::unit::{Unit, variants};

/// Positions whose routes are looked at before a unit counts as unplaceable.
const ROUTE_TESTS: usize = 40;
/// Positions with free routes that are weighed against each other.
const WEIGHED: usize = 4;
/// Ranks of choice tried for the first, second, ... unit, one departure at a time.
const DEPARTURES: [(usize, usize); 5] = [(0, 1), (1, 1), (0, 2), (2, 1), (1, 2)];
/// Further departures while something required has no place.
const RESCUES: [(usize, usize); 6] = [(0, 3), (2, 2), (3, 1), (0, 4), (1, 3), (3, 2)];

/// What one room's search needs to know.
pub(super) struct Job<'a, 's> {
    pub domain: &'a Domain,
    pub space: &'s Space,
    pub tasks: &'s [Task<'a>],
    /// Objects that stay where they are.
    pub locked: &'s [Placed<'a>],
    /// How many units of each task are among them.
    pub present: &'s [u32],
    /// Size of each object type in this room.
    pub sizes: &'s dyn Fn(&ObjectType) -> usize,
    pub salt: u64,
    /// Radius of the robot, mm.
    pub radius: i32,
    pub keep_width: KeepWidth,
}

/// How strict a pass is: clearances as a share, and a margin around the robot, mm.
pub(super) const LEVELS: [(f64, i32); 5] = [(1.0, 50), (1.0, 20), (0.75, 20), (0.5, 10), (0.0, 5)];

/// A furnished room.
pub(super) struct Outcome<'a> {
    pub placed: Vec<Placed<'a>>,
    /// Tasks with how many units are missing and the rule that stopped them.
    pub missing: Vec<(usize, u32, Rule)>,
    /// Missing units the room cannot do without.
    pub required_missing: u32,
    pub score: f64,
    /// Index into [`LEVELS`].
    pub level: usize,
}

/// Furnishes a room as well as the search can, relaxing clearances only while something required has no place.
pub(super) fn furnish<'a>(job: &Job<'a, '_>) -> Outcome<'a> {
    let mut best: Option<Outcome> = None;
    for level in 0..LEVELS.len() {
        let pass = Pass::new(job, level);
        let mut local = pass.run((usize::MAX, 0));
        for (n, departure) in DEPARTURES.into_iter().chain(RESCUES).enumerate() {
            if n >= DEPARTURES.len() && local.required_missing == 0 {
                break;
            }
            let other = pass.run(departure);
            if (other.required_missing, -other.score) < (local.required_missing, -local.score) {
                local = other;
            }
        }
        let better = best.as_ref().is_none_or(|b| local.required_missing < b.required_missing);
        if better {
            best = Some(local);
        }
        if best.as_ref().is_some_and(|b| b.required_missing == 0) {
            break;
        }
    }
    best.expect("there is at least one level")
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
        let (tightness, margin) = LEVELS[level];
        let forms = job.tasks.iter().map(|task| {
            let tightness = if task.required > 0 { tightness } else { 1.0 };
            let free = matches!(task.arrangement, Arrangement::Center | Arrangement::Rows);
            variants(job.domain, task.item, job.sizes, tightness)
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
        let mut start = State::new(job.space, Nav::new(job.space, job.radius + margin), job.keep_width);
        start.add(job.locked.to_vec());
        Self { job, level, forms, start }
    }

    /// Furnishes the room once; the unit counted `departure.0` takes its choice of rank `departure.1`.
    fn run(&self, departure: (usize, usize)) -> Outcome<'a> {
        let mut state = self.start.clone();
        let mut out =
            Outcome { placed: Vec::new(), missing: Vec::new(), required_missing: 0, score: 0.0, level: self.level };
        let mut step = 0;
        for (index, task) in self.job.tasks.iter().enumerate() {
            let present = self.job.present[index];
            let count = task.count.saturating_sub(present);
            if count == 0 {
                continue;
            }
            let mut tally = Tally::default();
            let mut placed = 0;
            let rank = |step: &mut usize| {
                *step += 1;
                if *step - 1 == departure.0 { departure.1 } else { 0 }
            };
            if task.is_batch() && !self.lines_walls(task) {
                if let Some((units, score)) = self.batch(&state, index, count, rank(&mut step), &mut tally) {
                    placed = units.len() as u32;
                    out.score += score;
                    state.add(units);
                }
            } else {
                while placed < count {
                    let Some((unit, score)) = self.single(&state, index, rank(&mut step), &mut tally) else { break };
                    out.score += score + if task.required > 0 { 2.0 } else { 1.0 };
                    state.add(vec![unit]);
                    placed += 1;
                }
            }
            if placed < count {
                let rule = Self::decisive(&tally);
                out.missing.push((index, count - placed, rule));
                out.required_missing += task.required.saturating_sub(present + placed);
                out.score -= 1.5;
            }
        }
        let empty = self.start.free_area.max(1) as f64;
        out.score += 3.0 * state.free_area as f64 / empty;
        out.placed = state.placed;
        out
    }

    /// Returns true for rows that stand along walls: beds have their heads there.
    fn lines_walls(&self, task: &Task) -> bool {
        task.arrangement == Arrangement::Rows && matches!(task.anchor.shape, Shape::Bed | Shape::HospitalBed)
    }

    /// Returns the rule that stopped the positions that came farthest.
    fn decisive(tally: &Tally) -> Rule {
        use Rule::{Clearance, Collision, Door, NoPlace, Outside, Route, Window};
        [Route, Clearance, Collision, Window, Door, Outside]
            .into_iter()
            .find(|r| tally[*r as usize] > 0)
            .unwrap_or(NoPlace)
    }

    fn batch(
        &self,
        state: &State<'a, 's>,
        index: usize,
        count: u32,
        rank: usize,
        tally: &mut Tally,
    ) -> Option<(Vec<Placed<'a>>, f64)> {
        let task = Task { count, ..self.job.tasks[index].clone() };
        let aisle = 2 * (self.job.radius + LEVELS[self.level].1) + 50;
        let mut best: Option<(Vec<Placed>, f64)> = None;
        for forms in &self.forms[index] {
            let unit = &forms[0];
            let batches = if task.arrangement == Arrangement::Overhead {
                over(state, &task, index, unit, tally)
            } else {
                rows(state, &task, index, unit, self.job.salt, aisle, tally)
            };
            for batch in batches.into_iter().skip(rank) {
                let mut kept: Vec<Placed> = Vec::new();
                for mut p in batch.placed {
                    p.first_line = task.line == 0;
                    kept.push(p);
                    if state.route(&kept).is_err() {
                        tally[Rule::Route as usize] += 1;
                        kept.pop();
                    }
                }
                let score = batch.score + kept.len() as f64;
                if !kept.is_empty() && best.as_ref().is_none_or(|b| (kept.len(), score) > (b.0.len(), b.1)) {
                    best = Some((kept, score));
                }
            }
            if best.as_ref().is_some_and(|b| b.0.len() as u32 >= count) {
                break;
            }
        }
        best
    }

    fn single(&self, state: &State<'a, 's>, index: usize, rank: usize, tally: &mut Tally) -> Option<(Placed<'a>, f64)> {
        let task = &self.job.tasks[index];
        let aisle = 2 * (self.job.radius + LEVELS[self.level].1) + 50;
        for forms in &self.forms[index] {
            let mut candidates: Vec<Candidate> = Vec::new();
            for unit in forms {
                candidates.extend(Find::new(state, task, index, self.job.salt, aisle, tally).run(unit));
            }
            candidates.sort_by(|a, b| b.score.total_cmp(&a.score));
            if let Some((mut placed, score)) = choose(state, &candidates, rank, tally) {
                placed.first_line = task.line == 0;
                return Some((placed, score));
            }
        }
        None
    }
}

/// Returns the best candidate that leaves robots their room, free floor counted; `rank` skips that many classes.
fn choose<'a>(
    state: &State<'a, '_>,
    candidates: &[Candidate<'a>],
    rank: usize,
    tally: &mut Tally,
) -> Option<(Placed<'a>, f64)> {
    let mut passed: Vec<(f64, u32, &Candidate)> = Vec::new();
    let mut seen: Vec<u32> = Vec::new();
    for candidate in candidates.iter().take(ROUTE_TESTS) {
        match state.route(std::slice::from_ref(&candidate.placed)) {
            Ok(routes) => {
                let lost = routes.map_or(0.0, |r| 1.0 - r.area as f64 / state.free_area.max(1) as f64);
                passed.push((candidate.score - 3.0 * lost, candidate.class, candidate));
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
