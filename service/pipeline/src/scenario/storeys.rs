//! The scenario of a building with several storeys: each is filled by itself, and the robots work where their dock is.

use std::collections::BTreeSet;

use d3dgen_model::domain::{Domain, Shape};
use d3dgen_model::floorplan::{Floorplan, PlanRoom};
use d3dgen_model::placements::Placements;
use d3dgen_model::scenario::{Roi, RoiKind, Scenario};
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::storeys::LinkKind;
use d3dgen_model::world::World;

use super::one_storey;
use super::regions::STAY_OUT;

/// Fills all storeys of a building.
pub(super) fn generate(graph: &SceneGraph, plan: &Floorplan, placements: &Placements, domain: &Domain) -> Scenario {
    let empty = Scenario {
        version: 1,
        seed: graph.seed,
        rois: Vec::new(),
        pois: Vec::new(),
        robots: Vec::new(),
        agents: Vec::new(),
    };
    let mut out = empty.clone();
    let storeys = World {
        version: 1,
        name: String::new(),
        generator: String::new(),
        scene_graph: graph.clone(),
        floorplan: plan.clone(),
        placements: placements.clone(),
        scenario: empty,
    }
    .storeys();
    let has_dock = |world: &World| {
        let mut objects = world.placements.placements.iter().filter_map(|p| domain.object(&p.object));
        objects.any(|o| o.shape == Shape::Dock)
    };
    let docked = storeys.iter().find(|(_, world)| has_dock(world)).map_or(0, |s| s.0);
    // those who live there are all over the house: one storey after the other has one more of them
    let count = storeys.len() as u32;
    for (at, (level, mut world)) in storeys.into_iter().enumerate() {
        let share = |n: u32| n / count + u32::from((at as u32) < n % count);
        world.scene_graph.occupancy.residents = graph.occupancy.residents.map(share);
        let mut storey = one_storey(&world.scene_graph, &world.floorplan, &world.placements, domain, level == docked);
        storey.rois.extend(flights_down(plan, level));
        add(&mut out, storey, level, level == docked);
    }
    out
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

/// Adds a storey's scenario; what has a name that is taken gets the storey's number behind it.
fn add(out: &mut Scenario, mut storey: Scenario, level: i32, robots: bool) {
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
    let agents: BTreeSet<String> = out.agents.iter().map(|a| a.agent_id.clone()).collect();
    for agent in &mut storey.agents {
        free(&agents, &mut agent.agent_id);
        agent.level = level;
    }
    out.rois.extend(storey.rois);
    out.pois.extend(storey.pois);
    out.agents.extend(storey.agents);
    if robots {
        out.robots.extend(storey.robots);
    }
}
