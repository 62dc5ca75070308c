//! Stage `floorplan`: rooms become polygons, walls, doors and windows.
//!
//! The search works on a discrete description (`genome`): rooms in bands along a corridor or hub, small rooms cut out of
//! the corridor side of larger ones, large rooms that close a corridor's end, wings at right angles. Widths follow from
//! areas (`realize`), so a band has no leftovers; what is left to chance is order, sides, depths and scheme. Annealing
//! (`search`) over these choices is cheap because a candidate is a handful of integer boxes (`cost`). Only sound
//! candidates become documents (`outline`, `doors`, `windows`, `assemble`).
//!
//! Related: bands and corridors after Marson and Musse 2010, stochastic search over program and topology after Merrell,
//! Schkufza and Koltun 2010.

mod adjust;
mod align;
mod assemble;
mod board;
mod candidate;
mod changes;
mod compose;
mod core;
mod cost;
mod doors;
mod genome;
mod hall;
mod holes;
mod insert;
mod lattice;
mod locked;
mod measures;
mod mirror;
mod numbers;
mod order;
mod outline;
mod party;
mod proposed;
mod realize;
mod revise;
mod search;
mod spec;
mod storey;
mod storeys;
mod symmetric;
#[cfg(test)]
mod tests;
mod twins;
mod windows;

use std::collections::BTreeMap;

use d3dgen_knowledge::Limits;
use d3dgen_model::domain::{Domain, Scheme};
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::seed::Stream;
use d3dgen_model::stage::{Error, Stop};
use d3dgen_model::style::Symmetry;

pub use adjust::WallMove;
use assemble::{Turn, assemble, turned};
use cost::Judge;
pub use numbers::highest;
use party::Party;
pub use proposed::{Follow, MOST_SKETCHED, Sketch, propose};
use search::search;
use spec::Brief;

/// Share by which a plan may miss the area that is asked for.
pub const AREA_MISS: f64 = 0.1;
/// Attempts after which a plan that misses it more is taken all the same.
const AREA_ATTEMPTS: u64 = 5;
/// Attempts at a plan that is alike on both sides by construction.
const MIRRORED_ATTEMPTS: u64 = 4;
/// Plans tried before the stage gives up.
const ATTEMPTS: u64 = 8;
/// Rooms up to which a building is tried as a bar.
const LONGEST_BAR: usize = 30;
/// Rooms of a unit from which on it is a wing of its own.
const LEAST_IN_UNIT: usize = 5;

/// Plans a scene graph under the limits of the knowledge base.
///
/// Every required `door` and `open` edge is realized, every room has its area range, least dimension and daylight, and
/// no room is added or dropped. Of `pinned`, locked rooms (and rooms with a locked wall, door or window) stay as they are
/// and the others are planned anew around them; when all rooms are locked, the plan is returned as it is.
///
/// # Errors
/// `Mismatch` when the graph names rooms it does not have; `Infeasible` when no plan satisfies all hard rules, with the
/// rules that clash.
pub fn generate(
    graph: &SceneGraph,
    domain: &Domain,
    limits: &Limits,
    pinned: Option<&Floorplan>,
) -> Result<Floorplan, Error> {
    generate_until(graph, domain, limits, pinned, Stop::never())
}

/// Plans as [`generate`] does, until the caller asks to stop.
///
/// # Errors
/// As [`generate`]; `Cancelled`.
pub fn generate_until(
    graph: &SceneGraph,
    domain: &Domain,
    limits: &Limits,
    pinned: Option<&Floorplan>,
    stop: Stop<'_>,
) -> Result<Floorplan, Error> {
    if let Some(plan) = pinned.filter(|p| has_locks(p)) {
        if plan.rooms.iter().all(|r| r.locked) {
            return kept(graph, plan);
        }
        if plan.levels.len() > 1 || graph.has_storeys() {
            return storey::replan(graph, domain, limits, plan, stop);
        }
        let mut brief = Brief::new(graph, domain, limits)?;
        brief.party = brief.attached.and_then(|a| Party::of_plan(a, plan));
        return adjust::replan(&brief, plan, graph.seed, &mut Stream::new(graph.seed, "floorplan"), stop);
    }
    if graph.has_storeys() {
        return storeys::generate(graph, domain, limits, stop);
    }
    let mut brief = Brief::new(graph, domain, limits)?;
    let mut rng = Stream::new(graph.seed, "floorplan");
    brief.vary(&mut rng);
    brief.widen(&mut rng);
    brief.party = brief.attached.map(Party::of);
    let mut last = String::from("no layout was found");
    let form = brief.form;
    // the nearest to the area that is asked for
    let mut best: Option<(f64, Floorplan)> = None;
    for attempt in 0..ATTEMPTS {
        if best.is_some() && attempt >= AREA_ATTEMPTS {
            break;
        }
        // when a form was tried in vain often enough, any is better than no plan
        if attempt == ATTEMPTS / 2 {
            brief.take_any_form();
            if best.is_none() {
                brief.stand_free();
            }
        }
        brief.mirrored &= attempt < MIRRORED_ATTEMPTS;
        let sought = locked::joined(&brief);
        let sought = sought.as_ref().unwrap_or(&brief);
        let schemes = schemes(sought, domain, &mut rng);
        let turn = Turn { flip_x: rng.chance(0.5), flip_y: rng.chance(0.5), swap: rng.chance(0.3) };
        let found = search(sought, &schemes, &mut rng, stop);
        stop.check()?;
        let Some(found) = found else { continue };
        if found.score.hard > 1e-9 {
            last = format!("the best layout misses hard rules by {:.2} (sizes, doors or daylight)", found.score.hard);
            continue;
        }
        let name = format!("{:?}", found.scheme).to_lowercase();
        let mut boxes = turned(&found.layout.boxes, turn);
        numbers::along_corridor(graph, sought, &mut boxes);
        if let Some(cut) = Judge::new(sought).cut(&boxes).1 {
            locked::part(&brief, &mut boxes, cut);
        }
        let symmetry = mirror::share(sought, &found.layout.boxes);
        brief.tell_form(form, |f| found.has_form(f));
        brief.tell_symmetry(symmetry);
        match assemble(&brief.turned(turn.swap), &boxes, &found.score, graph.seed, &name, None, &mut rng) {
            Ok(plan) => {
                let miss = brief.area.map_or(0.0, |area| (net_area_m2(&plan) - area).abs() / area);
                if miss <= AREA_MISS {
                    return Ok(plan);
                }
                // another way to lay it out may have less corridor
                if best.as_ref().is_none_or(|(least, _)| miss < *least) {
                    best = Some((miss, plan));
                }
            }
            Err(reason) => last = reason,
        }
    }
    best.map(|(_, plan)| plan).ok_or(Error::Infeasible { stage: "floorplan", message: last })
}

/// Returns the net floor area of a plan, corridors and all storeys with it, m^2.
pub fn net_area_m2(plan: &Floorplan) -> f64 {
    plan.rooms.iter().map(|r| r.net_polygon.area()).sum()
}

/// Changes a plan to the rooms of a graph, and moves a wall, with as little else changed as the hard rules allow.
///
/// Locked rooms stay as they are. Doors, windows and ids stay where their walls do. Of several storeys only that which the
/// change is on changes; stairs and shafts stay.
///
/// # Errors
/// `Mismatch` and `Refused` when the change names what is not there or is locked; `Infeasible` when no sound plan was
/// found beside it; `Cancelled`.
pub fn change(
    graph: &SceneGraph,
    domain: &Domain,
    limits: &Limits,
    plan: &Floorplan,
    moved: Option<&WallMove>,
    stop: Stop<'_>,
) -> Result<Floorplan, Error> {
    if plan.levels.len() > 1 || graph.has_storeys() {
        return storey::change(graph, domain, limits, plan, moved, stop);
    }
    let mut brief = Brief::new(graph, domain, limits)?;
    brief.party = brief.attached.and_then(|a| Party::of_plan(a, plan));
    adjust::change(&brief, plan, moved, &mut Stream::new(plan.seed, "floorplan/change"), stop)
}

/// Refuses a graph of several storeys.
fn one_storey_graph(graph: &SceneGraph) -> Result<(), Error> {
    let storeys = graph.level_numbers().len();
    if storeys < 2 {
        return Ok(());
    }
    Err(Error::Refused {
        stage: "floorplan",
        message: format!("the building has {storeys} storeys; only plans of one storey can be sketched"),
    })
}

fn has_locks(plan: &Floorplan) -> bool {
    plan.rooms.iter().any(|r| r.locked)
        || plan.walls.iter().any(|w| w.locked)
        || plan.doors.iter().any(|d| d.locked)
        || plan.windows.iter().any(|w| w.locked)
}

/// Returns a locked plan unchanged when it is a plan of this graph.
fn kept(graph: &SceneGraph, plan: &Floorplan) -> Result<Floorplan, Error> {
    let strangers: Vec<&str> = plan
        .rooms
        .iter()
        .map(|r| r.room_id.as_str())
        .filter(|id| graph.room(id).is_none())
        .chain(graph.rooms.iter().map(|r| r.id.as_str()).filter(|id| plan.room(id).is_none()))
        .collect();
    if strangers.is_empty() {
        return Ok(plan.clone());
    }
    Err(Error::Mismatch {
        stage: "floorplan",
        message: format!("the locked plan and the scene graph differ in these rooms: {}", strangers.join(", ")),
    })
}

/// Rooms up to which a corridor with a room at its end is short enough for one way out.
const MOST_CAPPED: usize = 10;

/// Share of the building from which on one room leaves too little for the far arm of a corridor that turns.
const DOMINANT: f64 = 0.45;

/// Returns true for several units in one body, each large enough for a wing; single rooms that came from another storey's unit
/// make none.
fn has_units(brief: &Brief) -> bool {
    let mut rooms: BTreeMap<usize, usize> = BTreeMap::new();
    let own = brief.rooms.iter().filter(|r| !r.circulation).filter_map(|r| r.unit);
    own.for_each(|unit| *rooms.entry(unit).or_default() += 1);
    rooms.values().filter(|n| **n >= LEAST_IN_UNIT).count() > 1
}

/// Returns the schemes that suit the domain and the number of rooms, the seed's choice first.
fn schemes(brief: &Brief, domain: &Domain, rng: &mut Stream) -> Vec<Scheme> {
    // a storey with one core is one body, whatever its size
    let most = if brief.core.is_some() { compose::LARGE - 1 } else { usize::MAX };
    let rooms = brief.rooms.len().min(most);
    // en suites and the like make no corridor longer
    let along = brief.rooms.iter().filter(|r| r.host.is_none()).count().min(most);
    if brief.hub || brief.core.as_ref().is_some_and(|c| c.gable) {
        return vec![Scheme::Straight];
    }
    let units = has_units(brief);
    let locks = brief.rooms.iter().any(|r| r.locked);
    let suits = |s: &Scheme| match s {
        _ if units && *s != Scheme::Comb => false,
        Scheme::Straight => along <= LONGEST_BAR,
        Scheme::Capped => rooms >= 3 && along <= LONGEST_BAR,
        // no axis mirrors an angle
        // one of its arms would look at the neighbors
        Scheme::Angle if brief.party.is_some() => false,
        // a lock parts a straight corridor
        _ if locks && !matches!(s, Scheme::Straight | Scheme::Capped) => false,
        Scheme::Angle => rooms >= 8 && along <= Scheme::MOST_WHOLE && brief.symmetry != Some(Symmetry::Symmetric),
        // corridors make a ring where the scene graph has the piece that closes it
        Scheme::Racetrack => brief.ring.is_some() && rooms >= 14 && along <= Scheme::MOST_WHOLE,
        // nobody builds around a court unasked
        Scheme::Courtyard => false,
        Scheme::Comb => along > Scheme::MOST_WHOLE || units,
    };
    let mut list: Vec<Scheme> = domain.circulation.schemes.iter().copied().filter(suits).collect();
    rng.shuffle(&mut list);
    let areas = || brief.rooms.iter().map(|r| r.area_target);
    if areas().fold(0.0, f64::max) > DOMINANT * areas().sum::<f64>() {
        list.sort_by_key(|s| *s == Scheme::Angle);
    }
    if brief.second_exit && !brief.upper && rooms > MOST_CAPPED {
        list.sort_by_key(|s| *s == Scheme::Capped);
    }
    if let Some(form) = brief.form.filter(|_| !locks) {
        let (asked, [least, most]) = Scheme::of(form);
        let closes = !asked.is_ring() || brief.ring.is_some();
        if (least..=most).contains(&rooms) && closes {
            return vec![asked];
        }
    }
    // a scene graph that has the piece which closes a ring is one of a ring
    if list.contains(&Scheme::Racetrack) {
        return vec![Scheme::Racetrack];
    }
    for fallback in [Scheme::Straight, Scheme::Comb] {
        if suits(&fallback) && !list.contains(&fallback) {
            list.push(fallback);
        }
    }
    list
}
