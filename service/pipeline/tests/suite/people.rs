//! Who is in a building at an hour, where they go, and what robots do.

use std::collections::BTreeSet;

use d3dgen_model::domain::{Domain, RoleKind, VISITORS_NEVER};
use d3dgen_model::hours;
use d3dgen_model::scenario::{Scenario, Step};
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::world::World;
use d3dgen_pipeline::scenario::{self, Wishes};
use d3dgen_plugins::Registry;

use super::common::worlds;

/// A world of each kind.
const KINDS: &[&str] = &[
    "hospital ward with 6 patient rooms",
    "outpatient clinic with 4 exam rooms",
    "operating unit with 2 operating rooms",
    "office for 12 people with a reception",
    "primary school with 3 classrooms",
    "two-bedroom flat for a couple",
    "small warehouse with an office",
    "supermarket",
    "hotel with 6 guest rooms",
    "police station",
    "laboratory",
];

fn domain_of(world: &World) -> Domain {
    let registry = Registry::builtin();
    registry.get(&world.scene_graph.domain).unwrap().domain().clone()
}

fn at(world: &World, domain: &Domain, hour: &str) -> Scenario {
    let graph = SceneGraph { seed: world.placements.seed, ..world.scene_graph.clone() };
    let wishes = Wishes { hour: Some(hour), ..Wishes::default() };
    scenario::generate_as(&graph, &world.floorplan, &world.placements, domain, &wishes).unwrap()
}

/// Everybody with a role and the steps of it.
fn steps(scenario: &Scenario) -> Vec<(&str, &str, Vec<&Step>)> {
    let agents = scenario.agents.iter().map(|a| (a.agent_id.as_str(), a.role.as_str(), a.steps.iter().collect()));
    let flows = scenario.flows.iter().map(|f| (f.flow_id.as_str(), f.role.as_str(), f.steps().collect()));
    agents.chain(flows).collect()
}

#[test]
fn no_visitor_goes_where_staff_is_or_dirt_or_what_is_restricted() {
    for prompt in KINDS {
        for world in worlds(prompt, 1) {
            let domain = domain_of(&world);
            for hour in hours::all() {
                let scenario = at(&world, &domain, &hour.id);
                let visitors: BTreeSet<&str> =
                    domain.roles.iter().filter(|r| r.kind == RoleKind::Visitor).map(|r| r.id.as_str()).collect();
                for (name, _, steps) in steps(&scenario).into_iter().filter(|(_, role, _)| visitors.contains(role)) {
                    for step in steps {
                        let room = world.floorplan.room(&step.room_id).unwrap();
                        let tags = domain.tags_of(domain.room_type_or_generic(&room.room_type));
                        let closed = VISITORS_NEVER.iter().find(|tag| tags.contains(*tag));
                        assert_eq!(closed, None, "{prompt} at {}: {name} goes to {}", hour.id, step.room_id);
                    }
                }
            }
        }
    }
}

#[test]
fn each_patient_is_visited_by_a_nurse_within_its_round() {
    for prompt in ["hospital ward with 8 patient rooms", "care home for 10 residents", "ICU with 4 beds"] {
        for world in worlds(prompt, 2) {
            let domain = domain_of(&world);
            for hour in ["day", "shift_change", "morning_round", "night", "lunch"] {
                let scenario = at(&world, &domain, hour);
                let patients: BTreeSet<&str> =
                    scenario.agents.iter().filter(|a| a.role == "patient").map(|a| a.agent_id.as_str()).collect();
                let nurses = scenario.agents.iter().filter(|a| a.role == "nurse");
                let visited: BTreeSet<&str> = nurses.flat_map(|a| &a.steps).filter_map(|s| s.with.as_deref()).collect();
                assert!(!patients.is_empty(), "{prompt} at {hour} has no patient");
                let missed: Vec<&&str> = patients.difference(&visited).collect();
                assert!(missed.is_empty(), "{prompt} at {hour}: nobody visits {missed:?}");
            }
        }
    }
}

#[test]
fn more_people_are_there_when_there_are_more_beds_and_seats() {
    let people = |prompt: &str| worlds(prompt, 1)[0].scenario.agents.len();
    assert!(people("hospital ward with 16 patient rooms") > people("hospital ward with 4 patient rooms"));
    assert!(people("office for 40 people") > people("office for 6 people"));
}

#[test]
fn the_prompt_names_the_hour_and_the_work_of_robots() {
    for (prompt, hour) in [
        ("hospital ward with 4 patient rooms at shift change", "shift_change"),
        ("primary school with 2 classrooms at break time", "school_break"),
        ("office for 8 people", "day"),
    ] {
        for world in worlds(prompt, 1) {
            assert_eq!(world.scenario.hour.as_deref(), Some(hour), "{prompt}");
        }
    }
    for world in worlds("hospital ward with 4 patient rooms, for a delivery robot and a cleaning robot", 1) {
        let jobs: BTreeSet<&str> = world.scenario.robots.iter().flat_map(|r| &r.jobs).map(|j| j.kind.name()).collect();
        assert_eq!(jobs, BTreeSet::from(["clean", "deliver"]));
        let lanes = world.scenario.robots.iter().flat_map(|r| &r.jobs).find(|j| j.kind.name() == "clean").unwrap();
        assert!(lanes.path.len() > 20, "a way over all of the floor");
    }
}
