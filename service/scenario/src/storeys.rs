//! The scenario of a building with several storeys: each is filled by itself. Robots live where their dock is and ride to the
//! other storeys where an elevator is wide enough for them; what they do not get to is said.

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::domain::{Domain, Shape};
use d3dgen_model::floorplan::{Floorplan, PlanRoom};
use d3dgen_model::placements::Placements;
use d3dgen_model::scenario::{Poi, RobotTask, Roi, RoiKind, Scenario};
use d3dgen_model::scene_graph::{Note, SceneGraph};
use d3dgen_model::storeys::LinkKind;
use d3dgen_model::world::World;

use super::one_storey;
use super::regions::STAY_OUT;

/// Code of the conflict that says which storeys robots do not get to.
pub(crate) const STOREYS_MISSED: &str = "robots_miss_storeys";

/// Returns the storeys of a furnished building as robots and people on them see them.
pub(crate) fn seen(graph: &SceneGraph, plan: &Floorplan, placements: &Placements) -> Vec<(i32, World)> {
    World {
        version: 1,
        name: String::new(),
        generator: String::new(),
        brief: None,
        scene_graph: graph.clone(),
        floorplan: plan.clone(),
        placements: placements.clone(),
        scenario: Scenario::empty(graph.seed),
        rules: None,
    }
    .storeys()
}

/// Fills all storeys of a building with all but people.
pub(crate) fn generate(graph: &SceneGraph, plan: &Floorplan, storeys: &[(i32, World)], domain: &Domain) -> Scenario {
    let mut out = Scenario::empty(graph.seed);
    let has_dock = |world: &World| {
        let mut objects = world.placements.placements.iter().filter_map(|p| domain.object(&p.object));
        objects.any(|o| o.shape == Shape::Dock)
    };
    let docked = storeys.iter().find(|(_, world)| has_dock(world)).map_or(0, |s| s.0);
    let mut away: Vec<RobotTask> = Vec::new();
    for &(level, ref world) in storeys {
        let mut storey = one_storey(&world.scene_graph, &world.floorplan, &world.placements, domain, level == docked);
        storey.rois.extend(flights_down(plan, level));
        let robots = add(&mut out, storey, level);
        if level == docked { &mut out.robots } else { &mut away }.extend(robots);
    }
    let kind_of: BTreeMap<&str, &str> = plan.rooms.iter().map(|r| (r.room_id.as_str(), r.room_type.as_str())).collect();
    for task in &mut out.robots {
        let own = away.iter().filter(|other| other.robot_id == task.robot_id && rides(plan, task, other.level));
        for other in own.collect::<Vec<_>>() {
            visit(task, other, &out.pois, &kind_of);
        }
    }
    out
}

/// Adds the goals that a robot would have on another storey if it lived there: where it serves or cleans.
fn visit(task: &mut RobotTask, other: &RobotTask, pois: &[Poi], kind_of: &BTreeMap<&str, &str>) {
    let works = |id: &&String| {
        let poi = pois.iter().find(|p| &p.poi_id == *id);
        poi.is_some_and(|p| is_work(task, p) && is_allowed(task, kind_of.get(p.room_id.as_str()).copied()))
    };
    let goals: Vec<String> = other.goals.iter().filter(works).cloned().collect();
    task.ways.extend(other.ways.iter().filter(|way| goals.contains(&way.to)).cloned());
    task.goals.extend(goals);
}

/// Returns true for a point that a robot of this trade works at.
fn is_work(task: &RobotTask, poi: &Poi) -> bool {
    poi.kind == Poi::SERVICE_POINT || poi.kind == format!("{}_point", task.robot.kind)
}

/// Returns true for rooms of a type that the prompt does not keep a robot from.
fn is_allowed(task: &RobotTask, room_type: Option<&str>) -> bool {
    let only = &task.robot.room_types;
    only.is_empty() || room_type.is_some_and(|t| only.iter().any(|o| o == t))
}

/// Returns true where an elevator takes a robot from its storey to another: its doors on both are wide enough.
fn rides(plan: &Floorplan, task: &RobotTask, level: i32) -> bool {
    let enters = |ids: &[String], level: i32| {
        let stop = ids.iter().find(|id| plan.room(id).is_some_and(|r| r.level == level));
        let fits = |id: &String| plan.doors_of(id).any(|d| d.clear_width_m >= 2.0 * task.robot.radius_m);
        stop.is_some_and(fits)
    };
    let mut lifts = plan.links.iter().filter(|l| l.kind == LinkKind::Elevator);
    lifts.any(|l| enters(&l.room_ids, task.level) && enters(&l.room_ids, level))
}

/// Returns what to say where robots never get to storeys that have work for them.
pub(crate) fn missed(graph: &SceneGraph, scenario: &Scenario) -> Option<Note> {
    let level_of: BTreeMap<&str, i32> = graph.rooms.iter().map(|r| (r.id.as_str(), r.level)).collect();
    let type_of: BTreeMap<&str, &str> = graph.rooms.iter().map(|r| (r.id.as_str(), r.room_type.as_str())).collect();
    let mut levels: BTreeSet<i32> = BTreeSet::new();
    let mut robots: BTreeSet<&str> = BTreeSet::new();
    for task in &scenario.robots {
        let works = |p: &&Poi| {
            task.robot.stops.is_empty()
                && is_work(task, p)
                && is_allowed(task, type_of.get(p.room_id.as_str()).copied())
        };
        let visited: BTreeSet<&String> =
            scenario.robots.iter().filter(|t| t.robot.kind == task.robot.kind).flat_map(|t| &t.goals).collect();
        let storeys = |pois: &mut dyn Iterator<Item = &Poi>| -> BTreeSet<i32> {
            pois.filter_map(|p| level_of.get(p.room_id.as_str()).copied()).collect()
        };
        let own = storeys(&mut scenario.pois.iter().filter(|p| visited.contains(&p.poi_id)));
        let all = storeys(&mut scenario.pois.iter().filter(works));
        if all.difference(&own).next().is_some() {
            levels.extend(all.difference(&own));
            robots.insert(&task.robot.kind);
        }
    }
    let first = levels.iter().next()?;
    let list = levels.iter().skip(1).fold(first.to_string(), |list, level| format!("{list}, {level}"));
    let lift = graph.links.iter().any(|l| l.kind == LinkKind::Elevator);
    let why = if lift { "no elevator is wide enough for them" } else { "there is no elevator" };
    let kinds: Vec<&str> = robots.into_iter().collect();
    let message =
        format!("{} robots never get to level {list}, where there is work for them: {why}", kinds.join(" and "));
    Some(Note { code: STOREYS_MISSED.into(), message })
}

/// Returns the stairwells of a storey off the ground, which are no floor of it: nothing but a region keeps robots from the steps.
fn flights_down(plan: &Floorplan, level: i32) -> Vec<Roi> {
    let off_ground = plan.rooms.iter().filter(|r| level != 0 && r.level == level);
    let stairs = off_ground.filter(|r| plan.link_of(&r.room_id).is_some_and(|link| link.kind == LinkKind::Stairs));
    let region = |room: &PlanRoom| {
        let (id, note) = (format!("keep_out_{}", room.room_id), STAY_OUT.to_owned());
        Roi::new(id, RoiKind::KeepOut, &room.room_id, room.net_polygon.clone(), note)
    };
    stairs.map(region).collect()
}

/// Adds a storey's scenario; what has a name that is taken gets the storey's number behind it. Returns the robots as they would
/// work there.
fn add(out: &mut Scenario, mut storey: Scenario, level: i32) -> Vec<RobotTask> {
    let tag = if level < 0 { format!("_basement_{}", -level) } else { format!("_level_{level}") };
    let free = |taken: &BTreeSet<String>, id: &mut String| {
        if taken.contains(id) {
            id.push_str(&tag);
        }
    };
    let pois: BTreeSet<String> = out.pois.iter().map(|p| p.poi_id.clone()).collect();
    for robot in &mut storey.robots {
        let ways = robot.ways.iter_mut().map(|w| &mut w.to);
        let ends = robot.routes.iter_mut().flat_map(|r| [&mut r.from, &mut r.to]).filter(|id| !id.is_empty());
        robot.goals.iter_mut().chain(&mut robot.dock).chain(ways).chain(ends).for_each(|goal| free(&pois, goal));
        robot.level = level;
    }
    storey.pois.iter_mut().for_each(|p| free(&pois, &mut p.poi_id));
    let rois: BTreeSet<String> = out.rois.iter().map(|r| r.roi_id.clone()).collect();
    storey.rois.iter_mut().for_each(|r| free(&rois, &mut r.roi_id));
    out.rois.extend(storey.rois);
    out.pois.extend(storey.pois);
    storey.robots
}
