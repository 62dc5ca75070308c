//! Worlds for the tests of this stage: the default program of a domain, built by the other stages.

use d3dgen_knowledge::{Query, Retrieval};
use d3dgen_model::domain::{Access, Domain, RoomType};
use d3dgen_model::scene_graph::{Connector, GraphEdge, GraphRoom, Occupancy, Robot, SceneGraph};
use d3dgen_model::world::World;
use d3dgen_plugins::Registry;

use crate::{floorplan, placement, scenario, world};

/// Returns the scene graph of a domain's program as the first stage would make it, without a prompt.
pub(crate) fn graph(domain: &Domain, program: usize, count: u32, seed: u64) -> SceneGraph {
    let program = &domain.programs[program];
    let count = if count == 0 { program.default_rooms } else { count };
    let mut kinds: Vec<&str> = Vec::new();
    for round in 0_u32..20 {
        for entry in &program.rooms {
            let wanted = if round == 0 { entry.min } else { u32::from(entry.min + round <= entry.max) };
            for _ in 0..wanted {
                if (kinds.len() as u32) < count || round == 0 {
                    kinds.push(&entry.room_type);
                    kinds.extend(entry.with.iter().map(String::as_str));
                }
            }
        }
    }
    let mut rooms: Vec<GraphRoom> = Vec::new();
    for kind in kinds {
        let number = rooms.iter().filter(|r| r.room_type == kind).count() + 1;
        rooms.push(room(domain.room_type_or_generic(kind), number));
    }
    let is_hub = |r: &GraphRoom| domain.circulation.hub_room_types.contains(&r.room_type);
    let hub = match rooms.iter().find(|r| is_hub(r)) {
        Some(hub) => hub.id.clone(),
        None => {
            let mut hall = room(domain.room_type_or_generic(&domain.circulation.room_type), 1);
            hall.circulation = true;
            rooms.push(hall);
            rooms[rooms.len() - 1].id.clone()
        }
    };
    let entered =
        domain.circulation.entrance_room_types.iter().find_map(|t| rooms.iter().position(|r| &r.room_type == t));
    let entered = entered.or_else(|| rooms.iter().position(|r| r.id == hub)).unwrap_or(0);
    rooms[entered].entrance = true;
    let edges = edges(domain, &rooms, &hub);
    SceneGraph {
        version: 1,
        prompt: String::new(),
        seed,
        domain: domain.id.clone(),
        building_type: None,
        country_code: None,
        language: "en".into(),
        area_m2: None,
        occupancy: Occupancy::default(),
        accessible: false,
        rooms,
        edges,
        apart: Vec::new(),
        forbidden_room_types: Vec::new(),
        robots: Vec::new(),
        assumptions: Vec::new(),
        conflicts: Vec::new(),
    }
}

fn room(kind: &RoomType, number: usize) -> GraphRoom {
    GraphRoom {
        id: format!("{}_{number}", kind.id),
        room_type: kind.id.clone(),
        name: format!("{} {number}", kind.label),
        description: kind.description.clone(),
        target_area_m2: kind.area_m2.target,
        area_range_m2: [kind.area_m2.min, kind.area_m2.max],
        wished_assets: Vec::new(),
        occupants: None,
        circulation: false,
        requested: false,
        entrance: false,
        locked: false,
    }
}

fn edges(domain: &Domain, rooms: &[GraphRoom], hub: &str) -> Vec<GraphEdge> {
    let mut edges: Vec<GraphEdge> = Vec::new();
    for room in rooms.iter().filter(|r| r.id != hub) {
        let kind = domain.room_type_or_generic(&room.room_type);
        let taken = |id: &String| edges.iter().any(|e| &e.b == id && e.a.starts_with(&room.room_type));
        let host = rooms.iter().filter(|r| kind.hosts.contains(&r.room_type)).find(|r| !taken(&r.id));
        let to = match host.filter(|_| kind.access == Access::Host) {
            Some(host) => host.id.clone(),
            None => hub.to_owned(),
        };
        let connector = if kind.open_front { Connector::Open } else { Connector::Door };
        edges.push(GraphEdge { a: room.id.clone(), b: to, connector, required: true, reason: "circulation".into() });
    }
    edges
}

/// Returns a robot of a kind, 0.25 m in radius.
pub(crate) fn robot(kind: &str, count: u32) -> Robot {
    Robot { kind: kind.into(), count, radius_m: 0.25, height_m: 1.2, charging: true }
}

/// Builds and checks the world of a scene graph.
pub(crate) fn build(graph: &SceneGraph, registry: &Registry) -> Result<(World, Retrieval), crate::Error> {
    let plugin = registry.get(&graph.domain).expect("the domain is built in");
    let retrieval = d3dgen_knowledge::retrieve(plugin.knowledge(), &Query::of_graph(graph, plugin.domain()));
    let plan = floorplan::generate(graph, plugin.domain(), &retrieval.limits, None)?;
    let placements = placement::generate(graph, &plan, plugin.domain(), None)?;
    let scenario = scenario::generate(graph, &plan, &placements, plugin.domain())?;
    Ok((world::assemble("test", graph.clone(), plan, placements, scenario), retrieval))
}
