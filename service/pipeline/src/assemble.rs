//! From the documents of the stages to one world.

use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::placements::Placements;
use d3dgen_model::scenario::Scenario;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::world::World;

use d3dgen_scenario::with_shortages;

/// Puts the documents together under a name (`^[a-z0-9_]+$`), with what the robots lack told in the scene graph.
pub fn assemble(
    name: &str,
    scene_graph: SceneGraph,
    floorplan: Floorplan,
    placements: Placements,
    scenario: Scenario,
) -> World {
    let scene_graph = with_shortages(scene_graph, &scenario);
    World {
        version: 1,
        name: name.to_owned(),
        generator: concat!("d3dgen ", env!("CARGO_PKG_VERSION")).to_owned(),
        brief: None,
        scene_graph,
        floorplan,
        placements,
        scenario,
        rules: None,
    }
}
