//! Same seed, same bytes; another seed, another building.

use std::collections::BTreeSet;
use std::path::Path;

use d3dgen_model::document::Document;
use d3dgen_model::floorplan::Floorplan;
use d3dgen_tests::{files, run_well};

const WARD: &str = "hospital ward with 8 rooms in Germany, for a delivery robot";

fn assert_same(a: &Path, b: &Path) {
    let (a, b) = (files(a), files(b));
    assert!(a.len() > 10 && a.contains_key("world.json"), "{:?}", a.keys());
    assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>());
    for (name, bytes) in &a {
        assert!(&b[name] == bytes, "{name} differs between two runs");
    }
}

#[test]
fn two_runs_with_one_seed_write_the_same_bytes() {
    let home = tempfile::tempdir().unwrap();
    for out in ["first", "below/second"] {
        run_well(home.path(), &["generate", WARD, "--seed", "11", "--out", out]);
    }
    assert_same(&home.path().join("first"), &home.path().join("below/second"));
}

#[test]
fn many_worlds_at_once_are_those_made_one_by_one() {
    let home = tempfile::tempdir().unwrap();
    let many = ["generate", WARD, "--seed", "5", "--count", "3", "--no-png", "--json", "--out", "many"];
    let lines = run_well(home.path(), &many);
    let seeds: Vec<serde_json::Value> =
        lines.lines().map(|l| serde_json::from_str::<serde_json::Value>(l).unwrap()["seed"].clone()).collect();
    assert_eq!(seeds, [5, 6, 7]);
    run_well(home.path(), &["generate", WARD, "--seed", "6", "--no-png", "--out", "one"]);
    assert_same(&home.path().join("one"), &home.path().join("many/6"));
}

/// Seeds enough that some plan is passed over because it could not be furnished.
const SEEDS: &[&str] = &["0", "3", "4"];

#[test]
fn stage_by_stage_is_the_same_as_at_once() {
    let home = tempfile::tempdir().unwrap();
    let at = |args: &[&str]| run_well(home.path(), args);
    for seed in SEEDS {
        let request = ["office for 12 people in France", "--seed", seed, "--rooms", "7"];
        at(&[&["generate", "--no-png", "--out", "at_once"], request.as_slice()].concat());
        at(&[&["scene-graph", "--out", "g.json"], request.as_slice()].concat());
        at(&["floorplan", "g.json", "--out", "f.json"]);
        at(&["placement", "g.json", "f.json", "--out", "p.json"]);
        at(&["scenario", "g.json", "f.json", "p.json", "--out", "s.json"]);
        at(&["world", "g.json", "f.json", "p.json", "s.json", "--no-png", "--out", "by_stage"]);
        assert_same(&home.path().join("at_once"), &home.path().join("by_stage"));
        let at_once = ["world", "at_once", "at_once", "at_once", "at_once"];
        let world = std::fs::read_to_string(home.path().join("at_once/world.json")).unwrap();
        assert!(at(&at_once) == world, "the documents in a world's folder make another world");
    }
    let simple = at(&["scene-graph", "--simple", "--from", "g.json"]);
    for source in ["at_once", "at_once/world.json", "at_once/scene_graph.json"] {
        assert_eq!(at(&["scene-graph", "--simple", "--from", source]), simple);
    }
}

#[test]
fn an_existing_world_is_judged_and_exported_as_when_it_was_made() {
    let home = tempfile::tempdir().unwrap();
    let at = |args: &[&str]| run_well(home.path(), args);
    at(&["generate", WARD, "--no-png", "--out", "ward"]);
    let report: serde_json::Value = serde_json::from_str(&at(&["check", "ward", "--json"])).unwrap();
    let written = std::fs::read(home.path().join("ward/report.json")).unwrap();
    assert_eq!(report, serde_json::from_slice::<serde_json::Value>(&written).unwrap());
    at(&["export", "ward", "--no-png", "--out", "again"]);
    let (made, again) = (files(&home.path().join("ward")), files(&home.path().join("again")));
    assert!(again.len() > 10 && again.iter().all(|(name, bytes)| made.get(name) == Some(bytes)));
}

/// Which room lies west and south of which: the arrangement, whatever the sizes.
fn arrangement(plan: &Floorplan) -> String {
    let mut text = plan.scheme.clone();
    for a in &plan.rooms {
        for b in &plan.rooms {
            let (p, q) = (a.polygon.bounds().center(), b.polygon.bounds().center());
            text.push(if p.x + 0.5 < q.x { 'w' } else { '.' });
            text.push(if p.y + 0.5 < q.y { 's' } else { '.' });
        }
    }
    text
}

#[test]
fn other_seeds_arrange_the_rooms_otherwise() {
    let home = tempfile::tempdir().unwrap();
    for (domain, rooms) in [("residential", "6"), ("office", "8"), ("hospital", "10")] {
        let mut seen = BTreeSet::new();
        for seed in 0..8 {
            let graph = format!("{domain}_{seed}.json");
            let seed = seed.to_string();
            run_well(
                home.path(),
                &["scene-graph", "in Germany", "--domain", domain, "--rooms", rooms, "--seed", &seed, "--out", &graph],
            );
            let plan = run_well(home.path(), &["floorplan", &graph]);
            seen.insert(arrangement(&Floorplan::from_json(&plan).unwrap()));
        }
        assert!(seen.len() >= 6, "{domain}: 8 seeds give only {} arrangements", seen.len());
    }
}
