//! Examples of answers, made by the rules engine for the domain at hand: every domain has them, also one that is only a
//! folder of data.

use d3dgen_model::domain::{Domain, Mount};
use d3dgen_model::floorplan::{Floorplan, PlanRoom};
use d3dgen_model::placements::Placements;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_pipeline::generate::retrieve;
use d3dgen_pipeline::scene_graph::Request;
use d3dgen_pipeline::{Stop, floorplan, placement};
use d3dgen_plugins::{Plugin, Registry};
use serde_json::json;

use crate::json::{
    EdgeAnswer, FurnitureAnswer, GraphAnswer, ObjectAnswer, OutlineAnswer, PlanAnswer, RectAnswer, RoomAnswer,
};

/// Rooms of the example buildings.
const SIZES: [u32; 2] = [4, 7];
/// Most objects of a room in an example.
const MOST_OBJECTS: usize = 6;
/// Rooms of the example of furniture.
const FURNISHED: usize = 3;

/// Returns example answers for scene graphs, one a line below the request it answers.
pub fn graphs(registry: &Registry, domain: &Domain) -> String {
    let mut out = Vec::new();
    for (seed, rooms) in (1..).zip(SIZES) {
        if let Some((asked, graph)) = building(registry, domain, rooms, seed) {
            out.push(format!("Request: {asked}\n{}", json!(graph_answer(&graph))));
        }
    }
    listed(&out)
}

/// Returns example answers for floorplans.
pub fn plans(registry: &Registry, plugin: &dyn Plugin) -> String {
    let mut out = Vec::new();
    for (seed, rooms) in (1..).zip(SIZES) {
        let Some((asked, graph)) = building(registry, plugin.domain(), rooms, seed) else { continue };
        if let Some(plan) = planned(&graph, plugin) {
            out.push(format!("Request: {asked}\n{}", json!(plan_answer(&plan))));
        }
    }
    listed(&out)
}

/// Returns an example answer for furniture, below the floor of its rooms.
pub fn furniture(registry: &Registry, plugin: &dyn Plugin) -> String {
    let found = building(registry, plugin.domain(), SIZES[0], 1).and_then(|(_, graph)| {
        let plan = planned(&graph, plugin)?;
        let limits = retrieve(&graph, plugin).limits;
        let placements = placement::generate(&graph, &plan, plugin.domain(), &limits, None).ok()?;
        let rooms: Vec<&PlanRoom> = plan.rooms.iter().filter(|r| !r.circulation).take(FURNISHED).collect();
        let floors: Vec<String> = rooms.iter().map(|r| format!("{} {}", r.room_id, floor(r))).collect();
        let mut answer = furniture_answer(&placements, plugin.domain());
        answer.objects.retain(|o| rooms.iter().any(|r| r.room_id == o.room_id));
        Some(format!("Rooms: {}\n{}", floors.join("; "), json!(answer)))
    });
    listed(&found.into_iter().collect::<Vec<_>>())
}

fn listed(examples: &[String]) -> String {
    if examples.is_empty() { "(none)".to_owned() } else { examples.join("\n") }
}

/// Returns a building of a domain that nobody asked for.
fn building(registry: &Registry, domain: &Domain, rooms: u32, seed: u64) -> Option<(String, SceneGraph)> {
    let prompt = format!("{} with {rooms} rooms", domain.title);
    let id = Some(domain.id.clone());
    let request = Request { prompt: prompt.clone(), seed, domain: id, rooms: Some(rooms), ..Request::default() };
    let graph = d3dgen_pipeline::brief::rooms(&request, registry).ok()?.0;
    (graph.level_numbers().len() == 1).then_some((prompt, graph))
}

fn planned(graph: &SceneGraph, plugin: &dyn Plugin) -> Option<Floorplan> {
    let limits = retrieve(graph, plugin).limits;
    floorplan::generate_until(graph, plugin.domain(), &limits, None, Stop::never()).ok()
}

/// Returns a scene graph as an answer: what one could have proposed for it.
pub fn graph_answer(graph: &SceneGraph) -> GraphAnswer {
    let known = |id: &str| graph.room(id).is_some_and(|r| !r.circulation);
    let rooms = graph.rooms.iter().filter(|r| !r.circulation).map(|r| RoomAnswer {
        id: r.id.clone(),
        room_type: r.room_type.clone(),
        name: r.name.clone(),
        area_m2: Some(r.target_area_m2),
        objects: r.wished_assets.iter().take(MOST_OBJECTS).cloned().collect(),
    });
    let edges = graph.edges.iter().filter(|e| known(&e.a) && known(&e.b)).map(|e| EdgeAnswer {
        a: e.a.clone(),
        b: e.b.clone(),
        connector: e.connector,
    });
    GraphAnswer { rooms: rooms.collect(), edges: edges.collect() }
}

/// Returns a plan as an answer.
pub fn plan_answer(plan: &Floorplan) -> PlanAnswer {
    let rooms = plan.rooms.iter().map(|r| OutlineAnswer {
        room_id: r.room_id.clone(),
        rectangles: r
            .polygon
            .rects()
            .iter()
            .map(|b| RectAnswer {
                x_m: tidy(b.x0),
                y_m: tidy(b.y0),
                width_m: tidy(b.width()),
                depth_m: tidy(b.height()),
            })
            .collect(),
    });
    PlanAnswer { rooms: rooms.collect() }
}

/// Returns furniture as an answer: what stands on floors and hangs on walls.
pub fn furniture_answer(placements: &Placements, domain: &Domain) -> FurnitureAnswer {
    let asked = |mount: Mount| matches!(mount, Mount::Floor | Mount::Wall);
    let objects = placements
        .placements
        .iter()
        .filter(|p| asked(p.mount) && domain.object(&p.object).is_some_and(|o| asked(o.mount)))
        .map(|p| ObjectAnswer {
            room_id: p.room_id.clone(),
            object: p.object.clone(),
            x_m: tidy(p.pose.x),
            y_m: tidy(p.pose.y),
            yaw_deg: p.pose.yaw_rad.to_degrees().round().rem_euclid(360.0),
        });
    FurnitureAnswer { objects: objects.collect() }
}

/// Returns the floor of a room between its walls, in words.
pub fn floor(room: &PlanRoom) -> String {
    let rects: Vec<String> = room
        .net_polygon
        .rects()
        .iter()
        .map(|b| format!("x {:.2} to {:.2}, y {:.2} to {:.2}", b.x0, b.x1, b.y0, b.y1))
        .collect();
    rects.join(" and ")
}

/// Returns a length without the noise of its last bits.
fn tidy(meters: f64) -> f64 {
    (meters * 1000.0).round() / 1000.0
}
