//! Stage `scenario`: robot zones, points, robots with work and people who fill the scene.
//!
//! Everything stands on floor that the largest robot asked for (a disc of 0.30 m at least) can reach from the rest of the
//! building. Which rooms are cleaned, served or off limits, and who walks where, is the domain's data.

mod conditions;
mod floor;
mod jobs;
mod kept;
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

use d3dgen_model::brief::Brief;
use d3dgen_model::domain::Domain;
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::hours::{self, Hour};
use d3dgen_model::placements::Placements;
use d3dgen_model::scenario::{DOCKS_MISSING, Scenario};
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::stage::Error;

use floor::Floor;

/// What is wished of a scenario.
#[derive(Debug, Clone, Copy, Default)]
pub struct Wishes<'w> {
    /// Its name among those of a world.
    pub name: &'w str,
    /// Hour of the day ([`hours`]); the one that the brief names, else a usual one, where it is not said.
    pub hour: Option<&'w str>,
    /// What was asked for: robots' tasks, the hour.
    pub brief: Option<&'w Brief>,
    /// Scenario whose locked robots and people go on doing what they do there.
    pub kept: Option<&'w Scenario>,
}

/// Fills a furnished building with regions, points, robots and people of a usual hour.
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
    generate_as(graph, plan, placements, domain, &Wishes::default())
}

/// Fills a furnished building as [`generate`] does, as somebody wishes.
///
/// # Errors
/// `Mismatch` when the placements or the graph speak of rooms that the plan does not have, or the hour is none.
pub fn generate_as(
    graph: &SceneGraph,
    plan: &Floorplan,
    placements: &Placements,
    domain: &Domain,
    wishes: &Wishes,
) -> Result<Scenario, Error> {
    fits(graph, plan, placements)?;
    let hour = hour(wishes)?;
    let seen = if plan.has_storeys() { storeys::seen(graph, plan, placements) } else { Vec::new() };
    let mut scenario = match plan.has_storeys() {
        true => storeys::generate(graph, plan, &seen, domain),
        false => one_storey(graph, plan, placements, domain, true),
    };
    let parts: Vec<(i32, &Floorplan, &Placements)> = match seen.as_slice() {
        [] => vec![(0, plan, placements)],
        seen => seen.iter().map(|(level, world)| (*level, &world.floorplan, &world.placements)).collect(),
    };
    let building = people::PeopleBuilding::new(&parts, graph, domain);
    people::fill(&mut scenario, graph, plan, &building, hour);
    scenario.name = wishes.name.to_owned();
    scenario.hour = Some(hour.id.clone());
    jobs::add(&mut scenario, &building, wishes.brief);
    if let Some(kept) = wishes.kept {
        let graphs: Vec<&SceneGraph> = match seen.as_slice() {
            [] => vec![graph],
            seen => seen.iter().map(|(_, world)| &world.scene_graph).collect(),
        };
        let storeys: Vec<kept::Storey> = parts
            .iter()
            .zip(graphs)
            .map(|(&(level, plan, placements), graph)| kept::Storey { level, graph, plan, placements })
            .collect();
        kept::keep(&mut scenario, kept, &storeys, domain);
        people::keep_steps(&mut scenario, kept, &building);
    }
    conditions::add(&mut scenario, plan, domain);
    Ok(scenario)
}

/// Returns the hour that is wished, that the brief names, or the usual one.
fn hour(wishes: &Wishes) -> Result<&'static Hour, Error> {
    let said = || wishes.brief.and_then(|b| hours::named_in(&b.prompt)).map(|(hour, _)| hour);
    let wished = match wishes.hour {
        Some(id) => Some(hours::get(id).ok_or_else(|| {
            let message = format!("`{id}` is no hour; there are {}", hours::ids().join(", "));
            Error::Mismatch { stage: "scenario", message }
        })?),
        None => said(),
    };
    Ok(wished.or_else(|| hours::get(hours::USUAL)).expect("a test reads the usual hour"))
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
    let mut scenario = Scenario { rois, pois, ..Scenario::empty(graph.seed) };
    scenario.robots = robots::all(&mut floor, graph, (plan, placements), &scenario.pois);
    if lived_in {
        robots::add_routes(&floor, &mut scenario);
    }
    // goods stand beside the routes, wherever these lead
    let staged = staging::all(&floor, graph, &scenario);
    scenario.rois.extend(staged);
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
