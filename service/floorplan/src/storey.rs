//! One storey of several changed or planned anew, while the others stay to the millimeter.
//!
//! A storey of a finished plan is a plan of its own in the building's frame (`model::storeys`), so what changes plans of
//! one storey (`adjust`) changes it too. Stairs and shafts stay where they are: they must line up with those above and
//! below. What the storey beside it supports is known, so that no change juts out without need.

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_knowledge::Limits;
use d3dgen_model::domain::{Domain, Storeys};
use d3dgen_model::floorplan::{CostTerm, Floorplan};
use d3dgen_model::geometry::to_mm;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::seed::Stream;
use d3dgen_model::stage::{Error, Stop};

use super::adjust::{self, WallMove};
use super::assemble::costs;
use super::board::{Board, cells};
use super::core::{Below, Core, merged};
use super::cost::Judge;
use super::party::Party;
use super::spec::Brief;
use super::storeys::{height, overhang_note, raise_stairwells};
use crate::numbers::highest;

/// A building of several storeys whose plan stands.
struct Building<'a> {
    graph: &'a SceneGraph,
    domain: &'a Domain,
    limits: &'a Limits,
    rules: &'a Storeys,
}

/// Changes a plan of several storeys: only those storeys that the graph has other rooms on, and that of a wall to move.
///
/// # Errors
/// As [`super::change`]; `Mismatch` when graph and plan have other storeys, `Infeasible` for a room too high for its storey.
pub(crate) fn change(
    graph: &SceneGraph,
    domain: &Domain,
    limits: &Limits,
    plan: &Floorplan,
    moved: Option<&WallMove>,
    stop: Stop<'_>,
) -> Result<Floorplan, Error> {
    let building = Building::new(graph, domain, limits, plan)?;
    let mut out = plan.clone();
    for level in plan.level_numbers() {
        let storey = plan.storey(level);
        let moved = moved.filter(|m| storey.walls.iter().any(|w| w.wall_id == m.wall_id));
        if moved.is_none() && same_rooms(graph, &storey) {
            continue;
        }
        let brief = building.brief(&out, level)?;
        let mut rng = Stream::new(plan.seed, &format!("floorplan/change/level/{level}"));
        let changed = adjust::change(&brief, &storey, moved, &mut rng, stop).map_err(|e| on_level(level, e))?;
        building.put(&mut out, level, &storey, changed)?;
    }
    if let Some(moved) = moved.filter(|m| !plan.walls.iter().any(|w| w.wall_id == m.wall_id)) {
        return Err(mismatch(format!("the plan has no wall `{}`", moved.wall_id)));
    }
    building.sum_up(&mut out)?;
    Ok(out)
}

/// Plans the rooms of all storeys that are not locked anew, around those that are and around stairs and shafts.
///
/// # Errors
/// As [`super::generate`] with pins; `Mismatch` when graph and plan have other storeys.
pub(crate) fn replan(
    graph: &SceneGraph,
    domain: &Domain,
    limits: &Limits,
    plan: &Floorplan,
    stop: Stop<'_>,
) -> Result<Floorplan, Error> {
    let building = Building::new(graph, domain, limits, plan)?;
    let mut out = plan.clone();
    out.seed = graph.seed;
    for level in plan.level_numbers() {
        let storey = plan.storey(level);
        if same_rooms(graph, &storey) && storey.rooms.iter().all(|r| r.locked) {
            continue;
        }
        let brief = building.brief(&out, level)?;
        let mut rng = Stream::new(graph.seed, &format!("floorplan/level/{level}"));
        let made = adjust::replan(&brief, &storey, graph.seed, &mut rng, stop).map_err(|e| on_level(level, e))?;
        building.put(&mut out, level, &storey, made)?;
    }
    building.sum_up(&mut out)?;
    Ok(out)
}

impl<'a> Building<'a> {
    fn new(graph: &'a SceneGraph, domain: &'a Domain, limits: &'a Limits, plan: &Floorplan) -> Result<Self, Error> {
        let (wanted, standing) = (graph.level_numbers(), plan.level_numbers());
        if wanted != standing || plan.levels.iter().map(|l| l.level).ne(standing.iter().copied()) {
            return Err(mismatch(format!(
                "the plan has storeys {}, the scene graph {}; rooms can change within storeys, not storeys themselves",
                list(&standing),
                list(&wanted)
            )));
        }
        let rules = domain.circulation.storeys.as_ref().ok_or_else(|| {
            mismatch(format!("domain `{}` says nothing of stairs; its buildings have one storey", domain.id))
        })?;
        Ok(Self { graph, domain, limits, rules })
    }

    /// Returns the task of a storey of the plan, with what supports it.
    fn brief(&self, plan: &Floorplan, level: i32) -> Result<Brief, Error> {
        let mut brief = Brief::new(&self.graph.storey(level), self.domain, self.limits)?;
        let at = plan.levels.iter().position(|l| l.level == level);
        let at = at.ok_or_else(|| mismatch(format!("`levels` of the plan lack storey {level}")))?;
        let needed = height(&brief, self.rules);
        let top = at + 1 == plan.levels.len();
        if needed > plan.levels[at].height_m + 1e-6 && !top {
            return Err(self.too_high(&brief, plan, at));
        }
        let tallest = plan.levels.iter().map(|l| l.height_m).fold(0.0, f64::max);
        let core = Core::new(&mut brief, self.graph, self.domain, tallest);
        let mut core = core.ok_or_else(|| mismatch(format!("level {level} has no stairs in `links`")))?;
        core.below = match supporting(&plan.level_numbers(), level) {
            Some(next) => Some(outline(plan, next)?),
            None => None,
        };
        brief.core = Some(core);
        brief.party = brief.attached.and_then(|a| Party::of_plan(a, plan));
        raise_stairwells(&mut brief, self.graph, (!top).then(|| plan.levels[at].height_m - 0.01));
        Ok(brief)
    }

    /// Says which room does not fit under the floor above.
    fn too_high(&self, brief: &Brief, plan: &Floorplan, at: usize) -> Error {
        let (level, height_m) = (plan.levels[at].level, plan.levels[at].height_m);
        let clear_m = to_mm(height_m - self.rules.slab_m);
        let room = brief.rooms.iter().find(|r| r.ceiling_height > clear_m + 1e-6);
        let room = room.map_or("a room".into(), |r| format!("`{}` ({:.2} m)", r.id, r.ceiling_height));
        Error::Infeasible {
            stage: "floorplan",
            message: format!("{room} is higher than storey {level} allows, {clear_m:.2} m; choose the highest storey"),
        }
    }

    /// Puts a changed storey in the place of the old one. What is new gets ids that no storey has.
    fn put(&self, plan: &mut Floorplan, level: i32, old: &Floorplan, mut new: Floorplan) -> Result<(), Error> {
        let ids = |plan: &Floorplan| -> [Vec<String>; 3] {
            [
                plan.walls.iter().map(|w| w.wall_id.clone()).collect(),
                plan.doors.iter().map(|d| d.door_id.clone()).collect(),
                plan.windows.iter().map(|w| w.window_id.clone()).collect(),
            ]
        };
        let (known, [walls, doors, windows]) = (ids(old), ids(plan));
        name_new(&mut new.walls, |w| &mut w.wall_id, "wall", &known[0], &walls);
        name_new(&mut new.doors, |d| &mut d.door_id, "door", &known[1], &doors);
        name_new(&mut new.windows, |w| &mut w.window_id, "window", &known[2], &windows);
        new.rooms.iter_mut().for_each(|r| r.level = level);
        splice(&mut plan.walls, |w| w.wall_id.as_str(), &known[0], new.walls);
        splice(&mut plan.doors, |d| d.door_id.as_str(), &known[1], new.doors);
        splice(&mut plan.windows, |w| w.window_id.as_str(), &known[2], new.windows);
        plan.rooms.retain(|r| r.level != level);
        plan.rooms.extend(new.rooms);
        let order: BTreeMap<&str, usize> =
            self.graph.rooms.iter().enumerate().map(|(i, r)| (r.id.as_str(), i)).collect();
        plan.rooms.sort_by_key(|r| order.get(r.room_id.as_str()).copied());
        for conflict in new.conflicts {
            if !plan.conflicts.contains(&conflict) {
                plan.conflicts.push(conflict);
            }
        }
        let needed = height(&Brief::new(&self.graph.storey(level), self.domain, self.limits)?, self.rules);
        if let Some(top) = plan.levels.last_mut().filter(|top| top.level == level) {
            top.height_m = top.height_m.max(needed);
        }
        Ok(())
    }

    /// Adds up what the storeys cost as they are now, and says which jut out.
    fn sum_up(&self, plan: &mut Floorplan) -> Result<(), Error> {
        let mut sum: Vec<CostTerm> = Vec::new();
        plan.conflicts.retain(|n| n.code != overhang_note(0, 0.0).code);
        for level in plan.level_numbers() {
            let brief = self.brief(plan, level)?;
            let board = Board::read(&brief, &plan.storey(level)).map_err(refused)?;
            let score = Judge::new(&brief).score(&board.layout());
            for CostTerm { term, cost } in costs(&brief, &score) {
                match sum.iter_mut().find(|c| c.term == term) {
                    Some(known) => known.cost = to_mm(known.cost + cost),
                    None => sum.push(CostTerm { term, cost }),
                }
            }
            if score.overhang > super::storeys::OVERHANG_SHARE {
                plan.conflicts.push(overhang_note(level, score.overhang));
            }
        }
        plan.cost = sum;
        Ok(())
    }
}

/// Returns the storey that carries another, or that a cellar lies under; `None` for the ground floor.
fn supporting(numbers: &[i32], level: i32) -> Option<i32> {
    if level > 0 {
        numbers.iter().rev().find(|l| **l < level).copied()
    } else {
        numbers.iter().find(|l| **l > level && level < 0).copied()
    }
}

/// Returns the outline of a storey in the building's frame.
fn outline(plan: &Floorplan, level: i32) -> Result<Below, Error> {
    let mut boxes = Vec::new();
    for (i, room) in plan.rooms.iter().enumerate().filter(|(_, r)| r.level == level) {
        boxes.extend(cells(room).map_err(refused)?.into_iter().map(|c| (i, c)));
    }
    Ok(Below { outline: merged(&boxes), ..Below::default() })
}

/// Returns true when a storey has exactly the rooms that the graph has on it.
fn same_rooms(graph: &SceneGraph, storey: &Floorplan) -> bool {
    let level = storey.rooms.first().map_or(0, |r| r.level);
    let wanted: BTreeSet<&str> = graph.rooms.iter().filter(|r| r.level == level).map(|r| r.id.as_str()).collect();
    let standing: BTreeSet<&str> = storey.rooms.iter().map(|r| r.room_id.as_str()).collect();
    wanted == standing
}

/// Gives parts that the old storey did not have ids that no part of the building has.
fn name_new<T>(new: &mut [T], id: fn(&mut T) -> &mut String, kind: &str, known: &[String], all: &[String]) {
    let mut next = 1 + highest(all.iter().map(String::as_str));
    for part in new {
        let id = id(part);
        if !known.contains(id) {
            *id = format!("{kind}_{next}");
            next += 1;
        }
    }
}

/// Puts the new parts of a storey where its old ones were.
fn splice<T>(all: &mut Vec<T>, id: fn(&T) -> &str, old: &[String], new: Vec<T>) {
    let is_old = |part: &T| old.iter().any(|o| o == id(part));
    let at = all.iter().position(is_old).unwrap_or(all.len());
    all.retain(|part| !is_old(part));
    let at = at.min(all.len());
    all.splice(at..at, new);
}

/// Says on which storey a change came to nothing.
fn on_level(level: i32, error: Error) -> Error {
    let at = |message: String| format!("level {level}: {message}");
    match error {
        Error::Refused { stage, message } => Error::Refused { stage, message: at(message) },
        Error::Infeasible { stage, message } => Error::Infeasible { stage, message: at(message) },
        Error::Mismatch { stage, message } => Error::Mismatch { stage, message: at(message) },
        other => other,
    }
}

fn list(levels: &[i32]) -> String {
    levels.iter().map(i32::to_string).collect::<Vec<_>>().join(", ")
}

fn mismatch(message: String) -> Error {
    Error::Mismatch { stage: "floorplan", message }
}

fn refused(message: String) -> Error {
    Error::Refused { stage: "floorplan", message }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn storeys_rest_on_the_one_below_and_cellars_hang_from_the_one_above() {
        let numbers = [-2, -1, 0, 1, 2];
        let carried: Vec<Option<i32>> = numbers.iter().map(|l| supporting(&numbers, *l)).collect();
        assert_eq!(carried, [Some(-1), Some(0), None, Some(0), Some(1)]);
    }

    #[test]
    fn new_parts_get_ids_of_their_own_in_the_old_place() {
        let known = ["wall_3".to_owned(), "wall_4".to_owned()];
        let mut all: Vec<String> = ["wall_1", "wall_3", "wall_4", "wall_7"].map(str::to_owned).to_vec();
        let mut new: Vec<String> = ["wall_4", "wall_5"].map(str::to_owned).to_vec();
        name_new(&mut new, |w| w, "wall", &known, &all);
        assert_eq!(new, ["wall_4", "wall_8"]);
        splice(&mut all, |w| w.as_str(), &known, new);
        assert_eq!(all, ["wall_1", "wall_4", "wall_8", "wall_7"]);
    }
}
