//! Proposals of a language model through the command: recordings answer, so there is no network.

use std::path::Path;

use d3dgen_model::document::Document;
use d3dgen_model::proposal::{Outcome, Proposal};
use d3dgen_tests::{files, run, run_well};
use serde_json::{Value, json};

const FLAT: &str = "two-bedroom flat in Germany";
const STAGES: &str = "scene_graph,floorplan,placement";

fn read(home: &Path, file: &str) -> Value {
    serde_json::from_str(&std::fs::read_to_string(home.join(file)).unwrap()).unwrap()
}

fn record(home: &Path, folder: &str) -> Proposal {
    Proposal::from_json(&std::fs::read_to_string(home.join(folder).join("proposal.json")).unwrap()).unwrap()
}

fn line(stage: &str, answer: &Value) -> String {
    json!({"stage": stage, "answer": {"text": answer.to_string(), "model": "recorded"}}).to_string() + "\n"
}

/// Returns answers out of the documents of a world: what a very good model could have said.
fn answers(home: &Path, folder: &str) -> String {
    let list = |doc: &Value, key: &str| doc[key].as_array().unwrap().clone();
    let graph = read(home, &format!("{folder}/scene_graph.json"));
    let rooms: Vec<Value> = list(&graph, "rooms")
        .iter()
        .filter(|r| r["circulation"] != json!(true))
        .map(|r| {
            json!({"id": r["id"], "room_type": r["room_type"], "name": "x", "area_m2": r["target_area_m2"],
                   "objects": []})
        })
        .collect();
    let plan = read(home, &format!("{folder}/floorplan.json"));
    let outlines: Vec<Value> = list(&plan, "rooms")
        .iter()
        .map(|r| {
            let of =
                |k: &str| r["polygon"].as_array().unwrap().iter().map(|p| p[k].as_f64().unwrap()).collect::<Vec<_>>();
            let (xs, ys) = (of("x"), of("y"));
            let low = |v: &[f64]| v.iter().copied().fold(f64::MAX, f64::min);
            let high = |v: &[f64]| v.iter().copied().fold(f64::MIN, f64::max);
            json!({"room_id": r["room_id"], "rectangles": [{"x_m": low(&xs), "y_m": low(&ys),
                   "width_m": high(&xs) - low(&xs), "depth_m": high(&ys) - low(&ys)}]})
        })
        .collect();
    let placements = read(home, &format!("{folder}/placements.json"));
    let objects: Vec<Value> = list(&placements, "placements")
        .iter()
        .filter(|p| p["mount"] == json!("floor"))
        .map(|p| {
            let yaw = p["pose"]["yaw_rad"].as_f64().unwrap().to_degrees().round();
            json!({"room_id": p["room_id"], "object": p["object"], "x_m": p["pose"]["x"], "y_m": p["pose"]["y"],
                   "yaw_deg": yaw})
        })
        .collect();
    line("scene_graph", &json!({"rooms": rooms, "edges": []}))
        + &line("floorplan", &json!({"rooms": outlines}))
        + &line("placement", &json!({"objects": objects}))
}

#[test]
fn a_recording_makes_the_same_world_each_time() {
    let home = tempfile::tempdir().unwrap();
    let at = |args: &[&str]| run_well(home.path(), args);
    // the rooms of one seed, proposed for another
    at(&["generate", FLAT, "--seed", "5", "--no-png", "--out", "other"]);
    std::fs::write(home.path().join("answers.jsonl"), answers(home.path(), "other")).unwrap();
    for out in ["first", "second"] {
        let args =
            ["generate", FLAT, "--seed", "2", "--no-png", "--propose", STAGES, "--model", "replay:answers.jsonl"];
        at(&[args.as_slice(), &["--out", out]].concat());
    }
    let [first, second] = ["first", "second"].map(|out| files(&home.path().join(out)));
    assert!(first == second, "two runs differ");
    let record = record(home.path(), "first");
    assert_eq!((record.provider.as_str(), record.model.as_str(), record.seed), ("replay", "recorded", 2));
    assert_eq!(record.stages.iter().map(|s| s.stage.as_str()).collect::<Vec<_>>().join(","), STAGES);
    let plan = &record.stages[1];
    assert!(plan.outcome == Outcome::Used && plan.counts.kept * 2 >= plan.counts.proposed(), "{plan:#?}");
    assert!(plan.constraint_ids.len() > 3, "the question quotes building rules");
    at(&["check", "first"]);
    // the documents can be fed back as those of any world
    at(&["world", "first", "first", "first", "first", "--no-png", "--out", "again"]);
    at(&["generate", FLAT, "--no-png", "--out", "first"]);
    assert!(!home.path().join("first/proposal.json").exists(), "a world without a model has no record");
}

#[test]
fn without_a_usable_answer_the_world_is_the_one_without_a_model() {
    let home = tempfile::tempdir().unwrap();
    let at = |args: &[&str]| run_well(home.path(), args);
    at(&["generate", FLAT, "--no-png", "--out", "own"]);
    std::fs::write(home.path().join("lies.jsonl"), line("scene_graph", &json!("no")).repeat(2)).unwrap();
    let models: [&[&str]; 2] =
        [&["--model", "replay:lies.jsonl"], &["--model", "openai:any", "--base-url", "http://127.0.0.1:9/v1"]];
    for (model, out) in models.iter().zip(["lies", "no_net"]) {
        let args = [&["generate", FLAT, "--no-png", "--propose", STAGES, "--out", out], *model].concat();
        let output = run(home.path(), &args);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success() && said.contains("as without a model"), "{said}");
        assert!(record(home.path(), out).stages.iter().all(|s| s.outcome == Outcome::Failed));
        let mut made = files(&home.path().join(out));
        made.remove("proposal.json").unwrap();
        assert!(made == files(&home.path().join("own")), "{out} differs from the world without a model");
    }
}

#[test]
fn many_worlds_with_one_recording() {
    let home = tempfile::tempdir().unwrap();
    let at = |args: &[&str]| run_well(home.path(), args);
    at(&["generate", FLAT, "--no-png", "--out", "other"]);
    std::fs::write(home.path().join("answers.jsonl"), answers(home.path(), "other").repeat(2)).unwrap();
    let lines = at(&[
        "generate",
        FLAT,
        "--count",
        "2",
        "--json",
        "--no-png",
        "--propose",
        "floorplan",
        "--model",
        "replay:answers.jsonl",
        "--out",
        "many",
    ]);
    let first: Value = serde_json::from_str(lines.lines().next().unwrap()).unwrap();
    assert!(first["proposals"]["floorplan"].as_str().unwrap().contains("kept"), "{first}");
    assert!(home.path().join("many/1/proposal.json").exists());
}
