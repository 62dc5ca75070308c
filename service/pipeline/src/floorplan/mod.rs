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

mod assemble;
mod compose;
mod core;
mod cost;
mod doors;
mod genome;
mod lattice;
mod outline;
mod realize;
mod search;
mod spec;
mod storeys;
#[cfg(test)]
mod tests;
mod windows;

use d3dgen_knowledge::Limits;
use d3dgen_model::domain::{Domain, Scheme};
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::seed::Stream;

use crate::{Error, Stop};
use assemble::{Turn, assemble, turned};
use search::search;
use spec::Brief;

/// Longest net length over width of a room: a hard rule.
pub(crate) const PROPORTION_LIMIT: f64 = 2.5;
/// Plans tried before the stage gives up.
const ATTEMPTS: u64 = 8;

/// Plans a scene graph under the limits of the knowledge base.
///
/// Every required `door` and `open` edge is realized, every room has its area range, least dimension and daylight, and
/// no room is added or dropped. With `pinned`, a plan whose rooms are all locked is returned as it is.
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
    if let Some(plan) = pinned {
        match plan.rooms.iter().filter(|r| r.locked).count() {
            0 => {}
            n if n == plan.rooms.len() => return kept(graph, plan),
            n => {
                return Err(Error::Refused {
                    stage: "floorplan",
                    message: format!(
                        "{n} of {} rooms are locked; this release keeps a plan whole or plans anew: lock all rooms or none",
                        plan.rooms.len()
                    ),
                });
            }
        }
    }
    if graph.level_numbers().len() > 1 {
        return storeys::generate(graph, domain, limits, stop);
    }
    let mut brief = Brief::new(graph, domain, limits)?;
    let mut rng = Stream::new(graph.seed, "floorplan");
    brief.vary(&mut rng);
    let mut last = String::from("no layout was found");
    for _ in 0..ATTEMPTS {
        let schemes = schemes(&brief, domain, &mut rng);
        let turn = Turn { flip_x: rng.chance(0.5), flip_y: rng.chance(0.5), swap: rng.chance(0.3) };
        let found = search(&brief, &schemes, &mut rng, stop);
        stop.check()?;
        let Some(found) = found else { break };
        if found.score.hard > 1e-9 {
            last = format!("the best layout misses hard rules by {:.2} (sizes, doors or daylight)", found.score.hard);
            continue;
        }
        let name = format!("{:?}", found.scheme).to_lowercase();
        match assemble(&brief, &turned(&found.layout.boxes, turn), &found.score, graph.seed, &name, &mut rng) {
            Ok(plan) => return Ok(plan),
            Err(reason) => last = reason,
        }
    }
    Err(Error::Infeasible { stage: "floorplan", message: last })
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

/// Returns the schemes that suit the domain and the number of rooms, the seed's choice first.
fn schemes(brief: &Brief, domain: &Domain, rng: &mut Stream) -> Vec<Scheme> {
    // a storey with one core is one body, whatever its size
    let most = if brief.core.is_some() { compose::LARGE - 1 } else { usize::MAX };
    let rooms = brief.rooms.len().min(most);
    if brief.hub {
        return vec![Scheme::Straight];
    }
    let suits = |s: &Scheme| match s {
        Scheme::Straight => rooms < compose::LARGE,
        Scheme::Capped => (4..compose::LARGE).contains(&rooms),
        Scheme::Angle => (8..=50).contains(&rooms),
        Scheme::Racetrack => (14..=50).contains(&rooms),
        Scheme::Comb => rooms >= compose::LARGE,
    };
    let mut list: Vec<Scheme> = domain.circulation.schemes.iter().copied().filter(suits).collect();
    rng.shuffle(&mut list);
    for fallback in [Scheme::Straight, Scheme::Comb] {
        if suits(&fallback) && !list.contains(&fallback) {
            list.push(fallback);
        }
    }
    list
}
