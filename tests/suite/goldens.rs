//! What each stage makes of the golden document of the stage before it: `golden/<stage>/<case>/`.
//!
//! A change to one stage shows in its own folder only, until the goldens are blessed.

use d3dgen_export::exporters;
use d3dgen_model::document::Document;
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::placements::Placements;
use d3dgen_model::scenario::Scenario;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_pipeline::scene_graph::Request;
use d3dgen_pipeline::{floorplan, generate, placement, scenario, scene_graph, world};
use d3dgen_plugins::Registry;
use d3dgen_tests::{golden, workspace};

/// Name, seed, prompt.
const CASES: &[(&str, u64, &str)] = &[
    ("flat_de", 1, "two-bedroom flat in Germany"),
    ("office_us", 2, "office for 12 people in New York with two meeting rooms"),
    ("school", 3, "primary school with four classrooms and a cleaning robot"),
    ("ward_de", 4, "hospital ward with 8 rooms in Germany, for a delivery robot"),
];

/// Compares a stage's document with the golden one, and returns the golden one for the next stage.
fn stage<D: Document>(name: &str, case: &str, found: &D) -> D {
    let file = workspace().join("tests/golden").join(name).join(case).join(format!("{}.json", D::KIND));
    golden(&file, &found.to_json());
    D::from_json(&std::fs::read_to_string(&file).unwrap()).unwrap()
}

fn check(registry: &Registry, &(case, seed, prompt): &(&str, u64, &str)) {
    let request = Request {
        prompt: prompt.into(),
        seed,
        domain: None,
        country: None,
        rooms: None,
        area_m2: None,
        robot_radius_m: None,
    };
    let graph: SceneGraph = stage("scene_graph", case, &scene_graph::generate(&request, registry).unwrap());
    let plugin = registry.get(&graph.domain).unwrap();
    let (domain, retrieved) = (plugin.domain(), generate::retrieve(&graph, plugin));
    let plan = floorplan::generate(&graph, domain, &retrieved.limits, None).unwrap();
    let plan: Floorplan = stage("floorplan", case, &plan);
    let placements = placement::generate(&graph, &plan, domain, None).unwrap();
    let placements: Placements = stage("placement", case, &placements);
    let scenario = scenario::generate(&graph, &plan, &placements, domain).unwrap();
    let scenario: Scenario = stage("scenario", case, &scenario);
    let made = world::assemble(case, graph, plan, placements, scenario);
    let report = world::check(&made, domain, &retrieved);
    assert!(report.sound, "{case}: {:#?}", report.rules.iter().flat_map(|r| &r.violations).collect::<Vec<_>>());
    stage("world", case, &report);
    let arena = exporters::get("arena").unwrap().export(&made, domain).unwrap();
    let file = arena.iter().find(|f| f.path.ends_with("world.yaml")).unwrap();
    golden(
        &workspace().join("tests/golden/export").join(case).join("world.yaml"),
        std::str::from_utf8(&file.bytes).unwrap(),
    );
}

#[test]
fn every_stage_makes_what_it_made_before() {
    let registry = Registry::builtin();
    CASES.iter().for_each(|case| check(&registry, case));
}
