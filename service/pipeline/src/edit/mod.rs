//! Edits of a finished world: a wall moved, a room more or less, an object exchanged.
//!
//! Each edit is carried out as asked or refused; what it touches is repaired with the least change (`floorplan::change`
//! for rooms, `objects` for furniture), the scenario follows, and every rule is judged again. Rooms that an edit does not
//! touch keep every object to the millimeter.

mod objects;
mod openings;
mod rooms;
mod tasks;

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_knowledge::Retrieval;
use d3dgen_model::edits::Edit;
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::placements::Placements;
use d3dgen_model::report::Report;
use d3dgen_model::scenario::Scenario;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::stage::{Error, Stop};
use d3dgen_model::world::World;
use d3dgen_plugins::Plugin;

use crate::floorplan::WallMove;
use crate::generate::{finish, retrieve};
use crate::{floorplan, world};

/// A world after its edits, with its verdict.
#[derive(Debug, Clone)]
pub struct Edited {
    /// The world.
    pub world: World,
    /// Every rule and constraint.
    pub report: Report,
    /// Rooms whose walls, openings or furniture changed, in floorplan order.
    pub changed_room_ids: Vec<String>,
}

/// Applies edits in their order.
///
/// The outcome breaks no hard rule that the world kept before.
///
/// # Errors
/// With the number of the edit (from 1): `Mismatch` when it names what is not there, `Refused` when it touches what is
/// locked or asks for nothing, `Breaks` or `Infeasible` when no repair keeps the hard rules; `Cancelled`.
pub fn apply(world: &World, edits: &[Edit], plugin: &dyn Plugin, stop: Stop<'_>) -> Result<Edited, Error> {
    let mut desk = Desk::new(world, plugin, stop);
    for (i, edit) in edits.iter().enumerate() {
        desk.apply(edit).map_err(|e| numbered(i + 1, e))?;
    }
    desk.finish(world).map_err(|e| match blamed(world, edits, plugin, stop) {
        Some(number) => numbered(number, e),
        None => e,
    })
}

/// Returns the number (from 1) of the first edit that cannot be made sound; all edits together cannot.
fn blamed(world: &World, edits: &[Edit], plugin: &dyn Plugin, stop: Stop<'_>) -> Option<usize> {
    if edits.len() == 1 {
        return Some(1);
    }
    let mut desk = Desk::new(world, plugin, stop);
    let fails = |edit: &Edit| desk.apply(edit).is_err() || desk.clone().finish(world).is_err();
    edits.iter().position(fails).map(|i| i + 1)
}

fn numbered(number: usize, error: Error) -> Error {
    let at = |message: String| format!("edit {number}: {message}");
    match error {
        Error::Refused { stage, message } => Error::Refused { stage, message: at(message) },
        Error::Infeasible { stage, message } => Error::Infeasible { stage, message: at(message) },
        Error::Mismatch { stage, message } => Error::Mismatch { stage, message: at(message) },
        Error::Breaks { stage, rule, subject, message } => Error::Breaks { stage, rule, subject, message: at(message) },
        other => other,
    }
}

/// A world being edited.
#[derive(Clone)]
struct Desk<'a> {
    plugin: &'a dyn Plugin,
    stop: Stop<'a>,
    graph: SceneGraph,
    plan: Floorplan,
    placements: Placements,
    /// What robots and people do; of the next scenario, that of those that are locked.
    scenario: Scenario,
    retrieved: Retrieval,
    /// Rooms whose walls, openings or furniture changed.
    changed: BTreeSet<String>,
    /// Objects that an edit put where they are.
    held: BTreeSet<String>,
    /// Objects that an edit took away: no room gets another one.
    unwanted: BTreeSet<String>,
    /// How many objects of a kind are left in a room that an edit took one out of, by room and object.
    left: BTreeMap<[String; 2], usize>,
}

impl<'a> Desk<'a> {
    fn new(world: &World, plugin: &'a dyn Plugin, stop: Stop<'a>) -> Self {
        Self {
            plugin,
            stop,
            // what an attempt after the first made goes on under its seed
            graph: SceneGraph { seed: world.floorplan.seed, ..world.scene_graph.clone() },
            plan: world.floorplan.clone(),
            placements: world.placements.clone(),
            scenario: world.scenario.clone(),
            retrieved: retrieve(&world.scene_graph, plugin),
            changed: BTreeSet::new(),
            held: BTreeSet::new(),
            unwanted: BTreeSet::new(),
            left: BTreeMap::new(),
        }
    }

    fn apply(&mut self, edit: &Edit) -> Result<(), Error> {
        match edit {
            Edit::MoveWall { wall_id, by_m } => {
                let moved = WallMove { wall_id: wall_id.clone(), by_m: *by_m };
                self.change_plan(Some(&moved))
            }
            Edit::MoveOpening { opening_id, by_m } => {
                let before = self.plan.clone();
                let rooms = openings::slide(&mut self.plan, opening_id, *by_m)?;
                self.settle_all(&before, rooms)
            }
            Edit::AddRoom { room_type, area_m2, entered_from } => {
                let room =
                    rooms::add(&mut self.graph, self.plugin.domain(), room_type, *area_m2, entered_from.as_deref())?;
                self.retrieved = retrieve(&self.graph, self.plugin);
                self.change_plan(None)?;
                self.changed.insert(room);
                Ok(())
            }
            Edit::RemoveRoom { room_id } => {
                rooms::remove(&mut self.graph, self.plugin.domain(), room_id)?;
                self.retrieved = retrieve(&self.graph, self.plugin);
                self.change_plan(None)
            }
            Edit::SwapObject { placement_id, object, asset } => {
                self.swap(placement_id, object.as_deref(), asset.as_deref())
            }
            Edit::MoveObject { placement_id, x, y, yaw_rad } => self.shift(placement_id, *x, *y, *yaw_rad),
            Edit::AddObject { room_id, object } => self.add(room_id, object),
            Edit::RemoveObject { placement_id } => self.remove(placement_id),
            Edit::Refurnish { room_id } => self.refurnish(room_id),
            Edit::ChangeJob { robot_id, job_id, from, to, load_kg, seconds } => {
                let change = tasks::JobChange { from: from.as_deref(), to, load_kg: *load_kg, seconds: *seconds };
                tasks::change_job(&mut self.scenario, robot_id, job_id, &change)
            }
            Edit::ChangeSteps { agent_id, steps } => tasks::change_steps(&mut self.scenario, agent_id, steps),
            Edit::Lock { ids, locked, contents } => self.lock(ids, *locked, *contents),
        }
    }

    /// Plans the changed graph, and puts the furniture of the rooms that changed right.
    fn change_plan(&mut self, moved: Option<&WallMove>) -> Result<(), Error> {
        let plan =
            floorplan::change(&self.graph, self.plugin.domain(), &self.retrieved.limits, &self.plan, moved, self.stop)?;
        let before = std::mem::replace(&mut self.plan, plan);
        self.placements.placements.retain(|p| self.plan.room(&p.room_id).is_some());
        self.placements.unplaced.retain(|u| self.plan.room(&u.room_id).is_some());
        let touched: Vec<String> =
            self.plan.rooms.iter().map(|r| r.room_id.clone()).filter(|id| differs(&before, &self.plan, id)).collect();
        self.settle_all(&before, touched)
    }

    fn settle_all(&mut self, before: &Floorplan, room_ids: Vec<String>) -> Result<(), Error> {
        for room_id in room_ids {
            self.settle(before, &room_id)?;
        }
        Ok(())
    }

    /// Puts the world together and judges it.
    fn finish(mut self, before: &World) -> Result<Edited, Error> {
        let mut found = self.assembled(before)?;
        let allowed =
            if found.1.sound { 0 } else { broken(&world::check(before, self.plugin.domain(), &self.retrieved)) };
        let breaks = first_broken(&found.1);
        if broken(&found.1) > allowed {
            // What was kept is in the way: the rooms that changed are furnished from their locked objects up.
            for room_id in self.changed.clone() {
                if self.plan.room(&room_id).is_some() {
                    self.refurnish(&room_id)?;
                }
            }
            found = self.assembled(before)?;
        }
        // what a room does not do without would be there again
        let comes_back = self.left.iter().any(|([room, object], left)| self.count(room, object) > *left);
        if comes_back || broken(&found.1) > allowed {
            let first = first_broken(&found.1).or(breaks);
            return Err(first.unwrap_or_else(|| infeasible("it would break what the room is furnished with".into())));
        }
        let changed = self.plan.rooms.iter().map(|r| &r.room_id).filter(|id| self.changed.contains(*id));
        let changed_room_ids = changed.cloned().collect();
        Ok(Edited { world: found.0, report: found.1, changed_room_ids })
    }

    /// Returns how many objects of a kind stand in a room.
    fn count(&self, room_id: &str, object: &str) -> usize {
        self.placements.placements.iter().filter(|p| p.room_id == room_id && p.object == object).count()
    }

    fn assembled(&self, before: &World) -> Result<(World, Report), Error> {
        let graph = SceneGraph { seed: before.scene_graph.seed, ..self.graph.clone() };
        let made = (self.plan.clone(), self.placements.clone());
        finish(
            &before.name,
            graph,
            made,
            self.plugin.domain(),
            &self.retrieved,
            before.brief.clone(),
            Some(&self.scenario),
        )
    }

    fn lock(&mut self, ids: &[String], locked: bool, contents: bool) -> Result<(), Error> {
        for id in ids {
            let mut known = false;
            let mut set = |own: &str, flag: &mut bool| {
                if own == id {
                    *flag = locked;
                    known = true;
                }
            };
            self.graph.rooms.iter_mut().for_each(|r| set(&r.id, &mut r.locked));
            self.plan.rooms.iter_mut().for_each(|r| set(&r.room_id, &mut r.locked));
            self.plan.walls.iter_mut().for_each(|w| set(&w.wall_id, &mut w.locked));
            self.plan.doors.iter_mut().for_each(|d| set(&d.door_id, &mut d.locked));
            self.plan.windows.iter_mut().for_each(|w| set(&w.window_id, &mut w.locked));
            self.placements.placements.iter_mut().for_each(|p| set(&p.placement_id, &mut p.locked));
            self.scenario.robots.iter_mut().for_each(|r| set(&r.robot_id, &mut r.locked));
            self.scenario.agents.iter_mut().for_each(|a| set(&a.agent_id, &mut a.locked));
            if contents {
                self.placements.placements.iter_mut().filter(|p| &p.room_id == id).for_each(|p| p.locked = locked);
            }
            if !known {
                return Err(mismatch(format!(
                    "the world has no room, wall, door, window, object, robot or person `{id}`"
                )));
            }
        }
        Ok(())
    }
}

/// Returns true when a room's outline or openings are not what they were.
fn differs(before: &Floorplan, after: &Floorplan, room_id: &str) -> bool {
    let outline = |plan: &Floorplan| plan.room(room_id).map(|r| r.net_polygon.clone());
    let doors = |plan: &Floorplan| {
        plan.doors_of(room_id).map(|d| (d.line, d.kind, d.swing.clone(), d.room_ids.clone())).collect::<Vec<_>>()
    };
    let windows = |plan: &Floorplan| {
        plan.windows.iter().filter(|w| w.room_id == room_id).map(|w| (w.line, w.sill_m)).collect::<Vec<_>>()
    };
    outline(before) != outline(after) || doors(before) != doors(after) || windows(before) != windows(after)
}

/// Returns what to say of the first hard rule that a world breaks.
fn first_broken(report: &Report) -> Option<Error> {
    report.rules.iter().find_map(|r| {
        let first = r.violations.first()?;
        let message = format!("it would break {}: {}", r.rule, first.message);
        Some(Error::Breaks { stage: "edit", rule: r.rule.clone(), subject: first.subject.clone(), message })
    })
}

fn broken(report: &Report) -> usize {
    report.rules.iter().filter(|r| !r.violations.is_empty()).count()
}

fn mismatch(message: String) -> Error {
    Error::Mismatch { stage: "edit", message }
}

fn refused(message: String) -> Error {
    Error::Refused { stage: "edit", message }
}

fn infeasible(message: String) -> Error {
    Error::Infeasible { stage: "edit", message }
}
