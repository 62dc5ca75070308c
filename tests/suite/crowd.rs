//! People of a scenario by the hour, and the crowd that they make.

use d3dgen_model::document::Document;
use d3dgen_model::scenario::Scenario;
use d3dgen_tests::{files, run_well};

const WARD: &str = "hospital ward with 6 patient rooms in Germany, for a delivery robot";

#[test]
fn scenarios_of_one_world_differ_by_the_hour_and_are_repeatable() {
    let home = tempfile::tempdir().unwrap();
    let at = |args: &[&str]| run_well(home.path(), args);
    at(&["generate", WARD, "--seed", "3", "--no-png", "--format", "tasks", "--out", "ward"]);
    let read = |name: &str| std::fs::read_to_string(home.path().join("ward/scenarios").join(name)).unwrap();
    for (name, time) in [("handover", "shift_change"), ("again", "shift_change"), ("dark", "night")] {
        at(&["scenario", "ward", "--scenario", name, "--time", time]);
    }
    let handover = Scenario::from_json(&read("handover.json")).unwrap();
    assert_eq!(handover.hour.as_deref(), Some("shift_change"));
    assert_eq!(read("handover.json").replace("handover", "again"), read("again.json"));
    let staff = |s: &Scenario| s.agents.iter().filter(|a| a.role == "nurse").count();
    let night = Scenario::from_json(&read("dark.json")).unwrap();
    assert!(staff(&handover) > staff(&night), "two shifts meet: {} and {}", staff(&handover), staff(&night));
    assert!(night.flows.iter().all(|f| f.role != "visitor"), "nobody visits at night");
    at(&["simulate", "ward", "--scenario", "dark", "--seconds", "30", "--no-film", "--out", "run"]);
}

#[test]
fn a_simulation_is_repeatable_and_its_robot_does_its_work() {
    let home = tempfile::tempdir().unwrap();
    let at = |args: &[&str]| run_well(home.path(), args);
    at(&["generate", WARD, "--seed", "3", "--no-png", "--format", "tasks", "--out", "ward"]);
    for out in ["one", "two"] {
        at(&["simulate", "ward", "--time", "morning_round", "--seconds", "300", "--out", out]);
    }
    let (one, two) = (files(&home.path().join("one")), files(&home.path().join("two")));
    assert_eq!(one.keys().collect::<Vec<_>>(), two.keys().collect::<Vec<_>>());
    assert!(one.keys().any(|name| name == "crowd.png"), "{:?}", one.keys());
    for (name, bytes) in &one {
        assert!(&two[name] == bytes, "{name} differs between two runs");
    }
    let metrics: serde_json::Value = serde_json::from_slice(&one["metrics.json"]).unwrap();
    let robots = metrics["robots"].as_object().unwrap();
    assert_eq!(robots.len(), 1);
    assert!(robots.values().all(|r| r["tasks_done"].as_u64() > Some(2) && r["tasks_missed"] == 0), "{robots:?}");
    let walked = metrics["agents"].as_object().unwrap();
    assert!(walked.values().any(|a| a["path_length_m"].as_f64() > Some(50.0)), "somebody makes rounds");
}
