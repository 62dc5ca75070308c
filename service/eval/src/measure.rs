//! All measures of one world.

use std::collections::BTreeMap;

use d3dgen_model::report::Report;
use d3dgen_model::world::World;

use crate::evaluation::WorldMeasures;
use crate::metrics::{
    accessibility, adjacency, bounds, collision, compliance, diversity, fidelity, layout, navigability, openings,
    robots, support,
};
use crate::solid::Scene;
use crate::storeys::side_by_side;

/// What whoever made a world knows of it beside its documents.
#[derive(Debug, Clone, Default)]
pub struct Known {
    /// Number of rooms in the prompt.
    pub rooms_asked: Option<u32>,
    /// Time of each stage, ms.
    pub stage_ms: BTreeMap<String, f64>,
}

/// Measures a world that has passed [`d3dgen_model::Document::check`]; `path` is how it is called in the results.
pub fn measure(world: &World, report: Option<&Report>, path: &str, known: &Known) -> WorldMeasures {
    let laid_out = side_by_side(world);
    let scene = Scene::new(&laid_out);
    let graph = &world.scene_graph;
    WorldMeasures {
        path: path.to_owned(),
        name: world.name.clone(),
        prompt: graph.prompt.clone(),
        seed: graph.seed,
        domain: graph.domain.clone(),
        country_code: graph.country_code.clone(),
        sound: report.map(|r| r.sound),
        layout: layout::measure(&scene),
        fidelity: fidelity::measure(world, known.rooms_asked),
        adjacency: adjacency::measure(world),
        collisions: collision::measure(&scene),
        out_of_bounds: bounds::measure(&scene),
        support: support::measure(&scene),
        navigability: navigability::measure(&scene),
        accessibility: accessibility::measure(&scene),
        openings: openings::measure(&scene),
        compliance: report.map(compliance::measure),
        robots: robots::measure(&scene),
        signature: diversity::signature(world),
        stage_ms: known.stage_ms.clone(),
    }
}
