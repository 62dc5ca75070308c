//! The graph of rooms that are settled: their sizes, storeys, doors and docks.

use d3dgen_knowledge::Query;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_plugins::Registry;

use super::built::planned::Planned;
use super::built::{edges, hosts, locks, program, ring, rooms, toilets, workers};
use super::levels::deal;
use super::machines::{charging, robot_rules, robots};
use super::people::homes;
use super::reading::Reading;
use super::request::Request;
use super::subject::places;
use super::subject::programs::is_dwelling;

/// How often toilets are looked for on the storeys that the rooms were dealt to.
const ROUNDS: usize = 3;

/// Returns the graph of rooms, with those that building rules ask for beside them.
pub(crate) fn settle<'a>(
    request: &Request,
    registry: &'a Registry,
    reading: &mut Reading<'a>,
    planned: &mut Vec<Planned<'a>>,
) -> SceneGraph {
    let mut draft = assemble(request, reading.clone(), planned);
    if let Some(plugin) = registry.get(&draft.domain) {
        let missing = d3dgen_knowledge::missing_rooms(plugin.knowledge(), &Query::of_graph(&draft, plugin.domain()));
        if program::follow_rules(reading, planned, &missing) {
            draft = assemble(request, reading.clone(), planned);
        }
    }
    // what is added moves others to other storeys
    for _ in 0..ROUNDS {
        let shared = hosts::share_bath_of_storey(reading, planned, &draft);
        if !toilets::complete(reading, planned, &draft) && !shared {
            break;
        }
        draft = assemble(request, reading.clone(), planned);
    }
    draft
}

/// Describes and connects the rooms.
fn assemble(request: &Request, mut reading: Reading, planned: &[Planned]) -> SceneGraph {
    let mut rooms = rooms::describe(&mut reading, planned);
    reading.occupancy.residents = homes::house(&reading, planned, &mut rooms);
    let levels = deal::levels(&mut reading);
    let (mut web, links) = if levels.len() > 1 {
        let areas: Vec<f64> = rooms.iter().map(|r| r.target_area_m2).collect();
        let dealt = deal::deal(&mut reading, planned, &areas, &levels);
        rooms.iter_mut().zip(dealt).for_each(|(room, level)| room.level = level);
        workers::name_toilets(reading.domain, &mut rooms);
        deal::even_out(planned, &mut rooms, &levels, is_dwelling(reading.program));
        let (all, web, links) = deal::connect(&mut reading, planned, rooms, &levels);
        rooms = all;
        (web, links)
    } else {
        (edges::connect(&mut reading, planned, &mut rooms), Vec::new())
    };
    ring::close(&reading, &links, &mut rooms, &mut web.edges);
    locks::lock(&mut reading, &mut rooms, &mut web.edges);
    charging::add_docks(reading.domain, &reading.robots, &reading.docked, &mut rooms);
    robots::send(&reading.errands, &rooms, &mut reading.robots);
    let robot_rules = robot_rules::of_rooms(&reading.robot_rules, &rooms);
    edges::state_unmet(&mut reading, &rooms, &web.edges);
    let place = reading.country_code.take();
    SceneGraph {
        version: 1,
        prompt: request.prompt.clone(),
        seed: request.seed,
        domain: reading.domain.id.clone(),
        building_type: reading.building_type,
        country_code: place.as_deref().map(places::country_of).map(str::to_owned),
        division_code: place.filter(|code| places::country_of(code) != code.as_str()),
        language: reading.language.into(),
        area_m2: reading.area_m2,
        occupancy: reading.occupancy,
        accessible: reading.accessible,
        wheelchair: reading.wheelchair,
        style: reading.style,
        rooms,
        edges: web.edges,
        apart: web.apart,
        links,
        forbidden_room_types: reading.wishes.forbidden,
        robots: reading.robots,
        robot_rules,
        two_way: reading.two_way,
        assumptions: reading.assumptions,
        conflicts: reading.conflicts,
    }
}
