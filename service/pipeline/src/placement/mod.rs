//! Stage `placement`: furniture by the domain's furnishing lines, sizes and clearances, with room for a robot.
//!
//! Each room is furnished by itself and from its own random stream, so that locking things in one room leaves the
//! others as they were. `demand` says what a room should hold, `find` proposes positions, `state` and `nav` hold the
//! hard rules, `search` chooses, `assemble` writes the document. Positions are whole millimeters and headings quarter
//! turns; nothing here depends on the platform's floating-point library.
//!
//! It does not choose 3D models (`asset` names the object type) and does not move walls.

pub mod assemble;
mod clutter;
mod demand;
mod find;
mod geom;
mod locked;
mod nav;
mod proposed;
mod search;
mod space;
mod stairs;
mod state;
mod style;
#[cfg(test)]
mod tests;
mod unit;
mod way;

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_knowledge::{Aim, Limits};
use d3dgen_model::domain::{Domain, ObjectType};
use d3dgen_model::floorplan::{Floorplan, PlanRoom};
use d3dgen_model::placements::Placement;
use d3dgen_model::placements::{Placements, Unplaced};
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::seed::Stream;
use d3dgen_model::style::Clutter;

use crate::{Error, Stop};
use demand::Task;
use geom::mm;
pub use proposed::{Proposed, Refusal, Wish, propose_room};
use space::Space;
use way::Way;

/// Least radius of the disc that must find its way, m: a person, or a small robot.
const LEAST_RADIUS_M: f64 = 0.30;

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
            Err(found) => problems.extend(found),
        }
    }
    locked::settle(problems)?;
    Ok(out)
}

/// What a room is furnished with.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Wanted<'a> {
    /// What its type and the scene graph ask for.
    All,
    /// That, less the lines about objects that somebody took away.
    Without(&'a BTreeSet<String>),
    /// One object more.
    Only(&'a ObjectType),
}

/// Furnishes one room around the placements that are fixed in it.
///
/// # Errors
/// Everything that keeps the fixed placements from standing where they are.
pub(crate) fn furnish_room(
    graph: &SceneGraph,
    plan: &Floorplan,
    room: &PlanRoom,
    (domain, limits): (&Domain, &Limits),
    fixed: &[&Placement],
    wanted: Wanted<'_>,
    stop: Stop<'_>,
) -> Result<(Vec<Placement>, Vec<Unplaced>), Vec<String>> {
    let space = Space::new(plan, room);
    let kind = domain.room_type_or_generic(&room.room_type);
    let per_person_m2 = limits.rooms.get(&room.room_type).and_then(|l| l.area_per_person_advised);
    let windows = space.windows.len() as u32;
    let usual = || demand::tasks(domain, kind, graph.room(&room.room_id), room.net_area_m2, per_person_m2, windows);
    let tasks = match wanted {
        Wanted::All => usual(),
        Wanted::Without(objects) => usual().into_iter().filter(|t| !objects.contains(&t.anchor.id)).collect(),
        Wanted::Only(object) => vec![demand::one_more(object)],
    };
    let aims = aims_of(domain, limits, room);
    let mut tasks: Vec<Task> = tasks.into_iter().filter(|t| !is_unwanted(t, &aims)).collect();
    let grade = graph.style.clutter.unwrap_or(Clutter::Normal);
    if grade == Clutter::Low && !matches!(wanted, Wanted::Only(_)) {
        tasks.retain(|task| !clutter::is_spare(task, kind));
    }
    let flights = stairs::flights(plan, room, domain);
    let own = flights.iter().filter(|f| !fixed.iter().any(|p| p.placement_id == f.placement_id));
    let fixed: Vec<&Placement> = fixed.iter().copied().chain(own).collect();
    let (units, problems) = locked::placed(&fixed, domain, &space);
    if !problems.is_empty() {
        return Err(problems);
    }
    let mut stream = room_stream(graph, room);
    let salt = (stream.unit() * (1_u64 << 52) as f64) as u64;
    let sizes = pick_sizes(domain, &aims, &mut stream);
    let present = match wanted {
        Wanted::All | Wanted::Without(_) => locked::present(&fixed, &tasks, domain),
        Wanted::Only(_) => vec![0; tasks.len()],
    };
    let asked_m = way_width(graph, domain, limits);
    let way = Way::new(plan, room, asked_m);
    let advised_m = limits.corridor_width_advised.unwrap_or(0.0);
    let wide_way = Way::new(plan, room, advised_m.max(asked_m));
    let job = search::Job {
        domain,
        space: &space,
        tasks: &tasks,
        locked: &units,
        present: &present,
        sizes: &|o| sizes.get(o.id.as_str()).copied().unwrap_or(0),
        aims: &aims,
        salt,
        radius: radius(graph, &space),
        way: way.as_ref(),
        wide_way: wide_way.as_ref().or(way.as_ref()),
        stop,
    };
    let mut outcome = search::furnish(&job);
    match wanted {
        Wanted::Only(_) => {}
        Wanted::All | Wanted::Without(_) if grade == Clutter::Normal => {}
        Wanted::All | Wanted::Without(_) if grade == Clutter::Low => clutter::tidy(&mut outcome, units.len()),
        Wanted::All | Wanted::Without(_) => {
            let more = clutter::strew(&job, &room.room_type, &mut outcome);
            tasks.extend(more);
        }
    }
    let placements = assemble::placements(domain, &room.room_id, &tasks, &outcome, &fixed);
    Ok((placements, assemble::unplaced(&room.room_id, &tasks, &outcome, &present)))
}

/// Returns what keeps fixed placements from standing in a room of a plan as they do; nothing when all is well.
pub(crate) fn misfits(plan: &Floorplan, room: &PlanRoom, domain: &Domain, fixed: &[&Placement]) -> Vec<String> {
    let space = Space::new(plan, room);
    let mut problems = locked::placed(fixed, domain, &space).1;
    problems.extend(locked::shading(fixed, domain, &space));
    problems
}

/// Returns what rules ask of the object types in a room, by id.
fn aims_of<'a>(domain: &'a Domain, limits: &Limits, room: &PlanRoom) -> BTreeMap<&'a str, Aim> {
    let aim = |o: &'a ObjectType| (o.id.as_str(), limits.objects.of(&room.room_type, room.circulation, o));
    domain.objects.iter().map(aim).collect()
}

/// Returns true for what rules advise against and the room can do without.
fn is_unwanted(task: &Task, aims: &BTreeMap<&str, Aim>) -> bool {
    task.required == 0 && aims.get(task.anchor.id.as_str()).is_some_and(|a| a.unwanted)
}

/// Returns the random numbers of a room.
fn room_stream(graph: &SceneGraph, room: &PlanRoom) -> Stream {
    Stream::new(graph.seed, &format!("placement/{}", room.room_id))
}

/// Returns the width that ways through circulation keep, m.
fn way_width(graph: &SceneGraph, domain: &Domain, limits: &Limits) -> f64 {
    let robot_m = graph.robots.iter().map(|r| r.radius_m).fold(LEAST_RADIUS_M, f64::max);
    let asked_m = limits.corridor_width.as_ref().map_or(0.0, |l| l.value).max(domain.circulation.width_m);
    asked_m.max(2.0 * robot_m)
}

/// Picks one size for each object type of a room, of those that keep most rules the most common one most often.
fn pick_sizes<'a>(domain: &'a Domain, aims: &BTreeMap<&str, Aim>, stream: &mut Stream) -> BTreeMap<&'a str, usize> {
    let mut pick = |o: &ObjectType| {
        let breaches = aims.get(o.id.as_str()).map_or(&[][..], |a| &a.breaches);
        let least = breaches.iter().min().copied().unwrap_or(0);
        let best: Vec<usize> = (0..o.sizes_m.len()).filter(|i| breaches.get(*i).is_none_or(|b| *b == least)).collect();
        let at = if stream.chance(0.5) { 0 } else { stream.below(best.len()) };
        best.get(at).copied().unwrap_or(0)
    };
    domain.objects.iter().map(|o| (o.id.as_str(), pick(o))).collect()
}

/// Returns the radius of the disc that must reach everything, mm: the largest robot's where the doors let it in.
fn radius(graph: &SceneGraph, space: &Space) -> i32 {
    let least = mm(LEAST_RADIUS_M);
    let robot = graph.robots.iter().map(|r| mm(r.radius_m)).fold(least, i32::max);
    let doors = space.doors.iter().map(|d| d.clear_width / 2).max().unwrap_or(robot);
    robot.min(doors).max(least)
}
