//! A document of every kind in every version there has been can be read, and `migrate` brings it to the form of today.
//!
//! `documents/v<N>/<kind>.json` is a sample of version N. Those of a released version are never edited: a change of form is a new
//! version with a step in `Document::UPGRADES`, and a sample of its own. Until a version is released, `BLESS=1` makes its samples anew.

use std::fs;
use std::path::{Path, PathBuf};

use d3dgen_assets::annotation::Annotation;
use d3dgen_eval::Evaluation;
use d3dgen_model::brief::Brief;
use d3dgen_model::document::Document;
use d3dgen_model::domain::Domain;
use d3dgen_model::edits::Edits;
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::knowledge::KnowledgeBase;
use d3dgen_model::placements::Placements;
use d3dgen_model::proposal::Proposal;
use d3dgen_model::report::Report;
use d3dgen_model::scenario::Scenario;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::world::World;
use d3dgen_tests::{files, run, run_well, workspace};
use serde_json::Value;

use crate::domain_guide::block;

/// The version that is not released yet: its samples may still be made anew.
const UNRELEASED: u64 = 1;
const PROMPT: &str = "studio flat in Germany with a cleaning robot";
const EDITS: &str = r#"{"version": 1, "edits": [
    {"op": "add_room", "room_type": "storage", "area_m2": 4.0},
    {"op": "move_wall", "wall_id": "wall_1", "by_m": 0.2},
    {"op": "lock", "ids": ["bathroom_1"], "locked": true}
]}"#;
/// An answer of a language model, as it is recorded.
const ANSWER: &str = r#"{"stage": "scene_graph", "answer": {"text": "{\"rooms\": [{\"id\": \"a\", \"room_type\": \"studio_room\", \"name\": \"x\", \"area_m2\": 20.0, \"objects\": []}], \"edges\": []}", "model": "recorded"}}"#;

fn sample(kind: &str, version: u64) -> PathBuf {
    workspace().join(format!("tests/documents/v{version}/{kind}.json"))
}

/// Writes the samples of the version that is not released.
fn bless() {
    let home = tempfile::tempdir().unwrap();
    let at = |args: &[&str]| run_well(home.path(), args);
    let keep = |kind: &str, text: &str| {
        let file = sample(kind, UNRELEASED);
        fs::create_dir_all(file.parent().unwrap()).and_then(|()| fs::write(file, text)).unwrap();
    };
    fs::write(home.path().join("answers.jsonl"), ANSWER).unwrap();
    at(&[
        "generate",
        PROMPT,
        "--seed",
        "1",
        "--no-png",
        "--format",
        "plan",
        "--propose",
        "scene_graph",
        "--model",
        "replay:answers.jsonl",
        "--out",
        "flat",
    ]);
    for kind in ["world", "scene_graph", "floorplan", "placements", "scenario", "report", "brief", "proposal"] {
        keep(kind, &fs::read_to_string(home.path().join(format!("flat/{kind}.json"))).unwrap());
    }
    at(&["eval", "flat", "--json", "evaluation.json"]);
    keep("evaluation", &fs::read_to_string(home.path().join("evaluation.json")).unwrap());
    keep("asset_annotation", &at(&["assets", "show", "Office/CafeChair", "--json"]));
    keep("edits", &Edits::from_json(EDITS).unwrap().to_json());
    let guide = fs::read_to_string(workspace().join("domains/README.md")).unwrap();
    fs::create_dir(home.path().join("observatory")).unwrap();
    fs::write(home.path().join("observatory/domain.toml"), block(&guide, "toml", "version = 1")).unwrap();
    keep("domain", &at(&["domains", "show", "observatory", "--domains-dir", "observatory", "--json"]));
    keep("knowledge_base", block(&guide, "json", "{"));
}

/// Reads the samples of one kind in all its versions.
fn check<D: Document>() {
    for version in 1..=D::current_version() {
        let file = sample(D::KIND, version);
        let text =
            fs::read_to_string(&file).unwrap_or_else(|e| panic!("{}: {e}; every version has a sample", file.display()));
        let value: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(D::version_of(&value), Some(version), "{}", file.display());
        let document = D::from_value(value).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        let written = document.to_json();
        assert_eq!(D::from_json(&written).unwrap().to_json(), written, "{}", file.display());
    }
}

#[test]
fn documents_of_every_version_are_read() {
    if std::env::var_os("BLESS").is_some_and(|v| v == "1") {
        bless();
    }
    check::<World>();
    check::<SceneGraph>();
    check::<Floorplan>();
    check::<Placements>();
    check::<Scenario>();
    check::<Report>();
    check::<Brief>();
    check::<Edits>();
    check::<Proposal>();
    check::<KnowledgeBase>();
    check::<Domain>();
    check::<Annotation>();
    check::<Evaluation>();
}

fn copy(from: &Path, to: &Path) -> usize {
    fs::create_dir_all(to).unwrap();
    let all = files(from);
    all.iter().for_each(|(name, bytes)| fs::write(to.join(name), bytes).unwrap());
    all.len()
}

#[test]
fn migrate_knows_every_kind_and_leaves_what_is_current() {
    let home = tempfile::tempdir().unwrap();
    let count = copy(&workspace().join(format!("tests/documents/v{UNRELEASED}")), &home.path().join("mine"));
    fs::write(home.path().join("mine/other.json"), "{\"version\": 1, \"songs\": []}").unwrap();
    run_well(home.path(), &["knowledge", "search", "corridor", "--store", "mine/rules"]);
    let before = files(home.path());
    let said = run_well(home.path(), &["migrate", "mine"]);
    assert_eq!(said.matches("current").count(), count + 1, "{said}");
    let kinds = files(&workspace().join(format!("tests/documents/v{UNRELEASED}")));
    for kind in kinds.keys().map(|name| name.trim_end_matches(".json")).chain(["database"]) {
        assert!(said.contains(kind), "{kind} is not in {said}");
    }
    assert!(files(home.path()) == before, "what is current was changed");
}

#[test]
fn migrate_refuses_what_a_later_release_wrote_before_anything_is_changed() {
    let home = tempfile::tempdir().unwrap();
    copy(&workspace().join(format!("tests/documents/v{UNRELEASED}")), &home.path().join("mine"));
    let file = home.path().join("mine/world.json");
    let mut world: Value = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    (world["version"], world["weather"]) = (99.into(), "rain".into());
    fs::write(&file, world.to_string()).unwrap();
    let before = files(home.path());
    let output = run(home.path(), &["migrate", "mine"]);
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{told}");
    assert!(told.contains("world.json") && told.contains("is 99") && told.contains("1 problem"), "{told}");
    assert!(told.trim_end().ends_with("code: document.invalid"), "{told}");
    assert!(files(home.path()) == before);

    // the same of a database, and of a file that is no document
    run_well(home.path(), &["knowledge", "search", "corridor", "--store", "rules"]);
    let manifest = home.path().join("rules/store.json");
    let mut value: Value = serde_json::from_slice(&fs::read(&manifest).unwrap()).unwrap();
    value["format"] = 99.into();
    fs::write(&manifest, value.to_string()).unwrap();
    let told = |path: &str| String::from_utf8_lossy(&run(home.path(), &["migrate", path]).stderr).into_owned();
    assert!(told("rules").trim_end().ends_with("code: store.newer"), "{}", told("rules"));
    fs::write(home.path().join("song.json"), "{\"version\": 1, \"songs\": []}").unwrap();
    assert!(
        told("song.json").contains("song.json") && told("song.json").contains("code: input"),
        "{}",
        told("song.json")
    );
}
