//! Stage `scenario`: robot zones, points, robots with work and people who fill the scene.
//!
//! Everything stands on floor that the largest robot asked for (a disc of 0.30 m at least) can reach from the rest of the
//! building. Which rooms are cleaned, served or off limits, and who walks where, is the domain's data.

mod floor;
mod lattice;
mod people;
mod points;
mod regions;
mod robots;
mod routes;
mod speed;
mod staging;
mod storeys;
mod tour;

use d3dgen_model::domain::Domain;
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::placements::Placements;
use d3dgen_model::scenario::{DOCKS_MISSING, Scenario};
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::stage::Error;

use floor::Floor;

/// Fills a furnished building with regions, points, robots and people.
///
/// Robots come from the scene graph; without any there are still points and people.
///
/// # Errors
/// `Mismatch` when the placements or the graph speak of rooms that the plan does not have.
pub fn generate(
    graph: &SceneGraph,
    plan: &Floorplan,
    placements: &Placements,
    domain: &Domain,
) -> Result<Scenario, Error> {
    fits(graph, plan, placements)?;
    if plan.has_storeys() {
        return Ok(storeys::generate(graph, plan, placements, domain));
    }
    Ok(one_storey(graph, plan, placements, domain, true))
}

/// Fills one storey. Where no robots were asked for, nothing is said of how they drive and where they put things down;
/// where they live on another one, their routes here are not looked for.
fn one_storey(
    graph: &SceneGraph,
    plan: &Floorplan,
    placements: &Placements,
    domain: &Domain,
    lived_in: bool,
) -> Scenario {
    let mut floor = Floor::new(graph, plan, placements, domain);
    let mut rois = regions::all(&floor);
    if !graph.robots.is_empty() {
        rois.extend(speed::all(&floor));
    }
    let pois = points::all(&floor, graph);
    regions::number(&mut rois, &floor, &pois);
    let mut scenario = Scenario { version: 1, seed: graph.seed, rois, pois, robots: Vec::new(), agents: Vec::new() };
    scenario.robots = robots::all(&mut floor, graph, (plan, placements), &scenario.pois);
    if lived_in {
        robots::add_routes(&floor, &mut scenario);
    }
    // goods stand beside the routes, wherever these lead
    let staged = staging::all(&floor, graph, &scenario);
    scenario.rois.extend(staged);
    scenario.agents = people::all(&mut floor, graph);
    scenario
}

/// Returns the graph with what its robots lack in a scenario: docks of their own, ways to other storeys, floor to put goods down.
pub fn with_shortages(mut graph: SceneGraph, scenario: &Scenario) -> SceneGraph {
    graph.conflicts.retain(|n| n.code != DOCKS_MISSING);
    graph.conflicts.extend(robots::dock_shortage(&scenario.robots));
    graph.conflicts.retain(|n| n.code != storeys::STOREYS_MISSED);
    graph.conflicts.extend(storeys::missed(&graph, scenario));
    graph.assumptions.retain(|n| n.code != staging::NO_STAGING);
    let unstaged = staging::staging_shortage(&graph, &scenario.rois);
    graph.assumptions.extend(unstaged);
    graph
}

fn fits(graph: &SceneGraph, plan: &Floorplan, placements: &Placements) -> Result<(), Error> {
    let rooms = graph.rooms.iter().map(|r| &r.id).chain(placements.placements.iter().map(|p| &p.room_id));
    let mut strangers: Vec<&str> = rooms.filter(|id| plan.room(id).is_none()).map(String::as_str).collect();
    strangers.sort_unstable();
    strangers.dedup();
    if strangers.is_empty() {
        return Ok(());
    }
    Err(Error::Mismatch { stage: "scenario", message: format!("the floorplan has no room {}", strangers.join(", ")) })
}
