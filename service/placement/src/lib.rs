//! Stage `placement`: furniture by the domain's furnishing lines, sizes and clearances, with room for a robot.
//!
//! Each room is furnished by itself and from its own random stream, so that locking things in one room leaves the
//! others as they were. `demand` says what a room should hold, `find` proposes positions, `state` and `nav` hold the
//! hard rules, `search` chooses among drafts (`draft`), `assemble` writes the document. Positions are whole millimeters
//! and headings quarter turns; nothing here depends on the platform's floating-point library.
//!
//! It does not choose 3D models (`asset` names the object type) and does not move walls.

pub mod assemble;
mod berths;
mod clutter;
mod demand;
mod docks;
mod draft;
mod elsewhere;
mod find;
mod geom;
mod locked;
mod nav;
mod neighbors;
mod pockets;
mod proposed;
mod search;
mod seats;
mod setting;
mod space;
mod stairs;
mod state;
mod style;
#[cfg(test)]
mod tests;
mod turning;
mod unit;
mod way;

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_knowledge::Limits;
use d3dgen_model::domain::{Domain, ObjectType};
use d3dgen_model::floorplan::{Floorplan, PlanRoom};
use d3dgen_model::placements::Placement;
use d3dgen_model::placements::{Placements, Unplaced};
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::stage::{Error, Stop};
use d3dgen_model::style::Clutter;

pub use proposed::{Proposed, Refusal, Wish, propose_room};
use setting::Setting;
use space::Space;

/// Furnishes every room of a floorplan; ways through circulation stay as wide as the limits ask.
///
/// Locked placements of `pinned` stay exactly as they are and the others go around them. What a room type requires and
/// the room cannot hold is listed in `unplaced` with `required`, with the rule that stopped it.
///
/// # Errors
/// `Mismatch` when the plan and the graph have different rooms, or when locked placements do not fit the plan, the
/// domain or each other; every such placement is named.
pub fn generate(
    graph: &SceneGraph,
    plan: &Floorplan,
    domain: &Domain,
    limits: &Limits,
    pinned: Option<&Placements>,
) -> Result<Placements, Error> {
    generate_until(graph, plan, domain, limits, pinned, &mut |_| (), Stop::never())
}

/// A room that is furnished.
#[derive(Debug, Clone, Copy)]
pub struct Furnished<'a> {
    /// Its id.
    pub room_id: &'a str,
    /// What stands in it.
    pub placements: &'a [Placement],
    /// Rooms furnished, this one included.
    pub done: usize,
    /// Rooms of the plan.
    pub total: usize,
}

/// Furnishes as [`generate`] does, until the caller asks to stop; `observe` hears of each room.
///
/// # Errors
/// As [`generate`]; `Cancelled`.
pub fn generate_until(
    graph: &SceneGraph,
    plan: &Floorplan,
    domain: &Domain,
    limits: &Limits,
    pinned: Option<&Placements>,
    observe: &mut dyn FnMut(Furnished<'_>),
    stop: Stop<'_>,
) -> Result<Placements, Error> {
    let mut problems = locked::strays(pinned, plan);
    for room in plan.rooms.iter().filter(|r| graph.room(&r.room_id).is_none()) {
        problems.push(format!("room `{}` of the floorplan is not in the scene graph", room.room_id));
    }
    let mut out = Placements { version: 1, seed: graph.seed, placements: Vec::new(), unplaced: Vec::new() };
    let levels = plan.level_numbers();
    let storeys: BTreeMap<i32, Floorplan> =
        levels.iter().filter(|_| levels.len() > 1).map(|&level| (level, plan.storey(level))).collect();
    for (at, room) in plan.rooms.iter().enumerate() {
        let storey = storeys.get(&room.level).unwrap_or(plan);
        let fixed = locked::of_room(pinned, &room.room_id);
        let furnished = furnish_room(graph, storey, room, (domain, limits), &fixed, Wanted::All, stop);
        stop.check()?;
        match furnished {
            Ok((placements, unplaced)) => {
                let (done, total) = (at + 1, plan.rooms.len());
                observe(Furnished { room_id: &room.room_id, placements: &placements, done, total });
                out.placements.extend(placements);
                out.unplaced.extend(unplaced);
            }
            Err(found) => problems.extend(found.into_iter().map(|problem| format!("locked {problem}"))),
        }
    }
    locked::settle(problems)?;
    elsewhere::place(graph, plan, (domain, limits), &mut out, stop)?;
    berths::add_missing(graph, plan, (domain, limits), &mut out, stop)?;
    Ok(out)
}

/// What a room is furnished with.
#[derive(Debug, Clone, Copy)]
pub enum Wanted<'a> {
    /// What its type and the scene graph ask for.
    All,
    /// That, less the lines about objects that somebody took away.
    Without(&'a BTreeSet<String>),
    /// One object more.
    Only(&'a ObjectType),
    /// One object more, where it keeps all of its clearances.
    IfFree(&'a ObjectType),
}

impl Wanted<'_> {
    /// Returns true for one object beside what stands there.
    fn is_one_more(self) -> bool {
        matches!(self, Wanted::Only(_) | Wanted::IfFree(_))
    }
}

/// Furnishes one room around the placements that are fixed in it.
///
/// # Errors
/// Everything that keeps the fixed placements from standing where they are.
pub fn furnish_room(
    graph: &SceneGraph,
    plan: &Floorplan,
    room: &PlanRoom,
    (domain, limits): (&Domain, &Limits),
    fixed: &[&Placement],
    wanted: Wanted<'_>,
    stop: Stop<'_>,
) -> Result<(Vec<Placement>, Vec<Unplaced>), Vec<String>> {
    let mut setting = Setting::new(graph, plan, room, (domain, limits), wanted);
    let flights = stairs::flights(plan, room, domain);
    let own = flights.iter().filter(|f| !fixed.iter().any(|p| p.placement_id == f.placement_id));
    let fixed: Vec<&Placement> = fixed.iter().copied().chain(own).collect();
    let (units, problems) = locked::placed(&fixed, domain, &setting.space);
    if !problems.is_empty() {
        return Err(problems);
    }
    let present = if wanted.is_one_more() {
        vec![0; setting.tasks.len()]
    } else {
        locked::present(&fixed, &setting.tasks, domain)
    };
    let job = search::Job {
        domain,
        space: &setting.space,
        tasks: &setting.tasks,
        locked: &units,
        present: &present,
        sizes: &|o| setting.size(o),
        aims: &setting.aims,
        salt: setting.salt,
        radius: setting.radius,
        has_robots: !graph.robots.is_empty(),
        turning: setting.turning,
        access: setting.access,
        step_free: graph.accessible,
        in_comfort: matches!(wanted, Wanted::IfFree(_)),
        way: setting.way.as_ref(),
        wide_way: setting.wide_way.as_ref(),
        stop,
    };
    let mut outcome = search::furnish(&job);
    let mut more = Vec::new();
    match graph.style.clutter.filter(|_| !wanted.is_one_more()) {
        None | Some(Clutter::Normal) => {}
        Some(Clutter::Low) => clutter::tidy(&mut outcome, units.len()),
        Some(Clutter::High) => more = clutter::strew(&job, &room.room_type, &mut outcome),
    }
    setting.tasks.extend(more);
    let tasks = &setting.tasks;
    let placements = assemble::placements(domain, &room.room_id, tasks, &outcome, &fixed);
    Ok((placements, assemble::unplaced(&room.room_id, tasks, &outcome, &present)))
}

/// Returns the one thing more that a room has a place for around what stands in it, if any.
fn one_more(
    graph: &SceneGraph,
    plan: &Floorplan,
    room: &PlanRoom,
    rules: (&Domain, &Limits),
    here: &[&Placement],
    wanted: Wanted<'_>,
    stop: Stop<'_>,
) -> Option<Placement> {
    let made = furnish_room(graph, plan, room, rules, here, wanted, stop).ok()?.0;
    made.into_iter().find(|p| !here.iter().any(|h| h.placement_id == p.placement_id))
}

/// Adds a placement behind those of its room.
fn insert(out: &mut Placements, more: Placement) {
    let behind = out.placements.iter().rposition(|p| p.room_id == more.room_id).map_or(0, |i| i + 1);
    out.placements.insert(behind, more);
}

/// Returns how many things stand before doors and windows where one would rather have none; no hard rule forbids them.
pub fn before_openings(plan: &Floorplan, placements: &Placements, domain: &Domain) -> usize {
    let in_room = |room: &PlanRoom| {
        let things: Vec<&Placement> = placements.placements.iter().filter(|p| p.room_id == room.room_id).collect();
        locked::before_openings(&things, domain, &Space::new(plan, room))
    };
    plan.rooms.iter().map(in_room).sum()
}

/// Returns what keeps fixed placements from standing in a room of a plan as they do; nothing when all is well.
pub fn misfits(plan: &Floorplan, room: &PlanRoom, domain: &Domain, fixed: &[&Placement]) -> Vec<String> {
    let space = Space::new(plan, room);
    let mut problems = locked::placed(fixed, domain, &space).1;
    problems.extend(locked::shading(fixed, domain, &space));
    problems
}
