//! Reading an invalid document reports every problem with its path. `documents/broken/<kind>.json` holds one for each
//! kind, `<kind>.expected` what is wrong with it.

use d3dgen_assets::annotation::Annotation;
use d3dgen_eval::Evaluation;
use d3dgen_model::document::{Document, Problem};
use d3dgen_model::domain::Domain;
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::knowledge::KnowledgeBase;
use d3dgen_model::placements::Placements;
use d3dgen_model::report::Report;
use d3dgen_model::scenario::Scenario;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::world::World;
use d3dgen_tests::{golden, workspace};

fn check<D: Document>() {
    let folder = workspace().join("tests/documents/broken");
    let text = std::fs::read_to_string(folder.join(format!("{}.json", D::KIND))).unwrap();
    let problems = match D::from_json(&text) {
        Err(d3dgen_model::Error::Invalid { kind, problems }) if kind == D::KIND => problems,
        Err(other) => panic!("{}: {other}", D::KIND),
        Ok(_) => panic!("the broken {} is taken for a good one", D::KIND),
    };
    assert!(problems.len() > 1, "{}: {problems:?}", D::KIND);
    let lines: String = problems.iter().map(|p: &Problem| format!("{p}\n")).collect();
    golden(&folder.join(format!("{}.expected", D::KIND)), &lines);
}

#[test]
fn every_problem_of_a_broken_document_is_reported() {
    check::<Domain>();
    check::<KnowledgeBase>();
    check::<SceneGraph>();
    check::<Floorplan>();
    check::<Placements>();
    check::<Scenario>();
    check::<World>();
    check::<Report>();
    check::<Annotation>();
    check::<Evaluation>();
}

#[test]
fn text_that_is_not_json_says_where() {
    let error = SceneGraph::from_json("{\"version\": 1,\n \"rooms\" [] }").unwrap_err().to_string();
    assert!(error.contains("line 2"), "{error}");
}
