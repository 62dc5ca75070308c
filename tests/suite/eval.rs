//! `d3dgen eval` and `d3dgen bench paper`: what they print, write and refuse.

use std::fs;

use d3dgen_eval::Evaluation;
use d3dgen_model::document::Document;
use d3dgen_tests::{run, run_well};

#[test]
fn worlds_at_any_depth_are_measured_and_broken_ones_are_named() {
    let home = tempfile::tempdir().unwrap();
    let prompt = "two-bedroom flat in Germany, for a cleaning robot";
    run_well(home.path(), &["generate", prompt, "--count", "2", "--no-png", "--format", "plan", "--out", "all/flats"]);
    let table = run_well(home.path(), &["eval", "all", "--json", "e.json", "--html", "e.html"]);
    assert!(table.contains("residential") && table.contains("different plans of one prompt"), "{table}");
    let read = || Evaluation::from_json(&fs::read_to_string(home.path().join("e.json")).unwrap()).unwrap();
    let first = read();
    let all = &first.groups.last().unwrap().figures;
    assert_eq!((first.worlds.len(), first.worlds[0].path.as_str()), (2, "flats/0"));
    for (name, value) in
        [("room_count_fidelity", 1.0), ("adjacency", 1.0), ("col", 0.0), ("oob", 0.0), ("robots", 1.0), ("sound", 1.0)]
    {
        assert_eq!(all[name], value, "{name}");
    }
    let page = fs::read_to_string(home.path().join("e.html")).unwrap();
    assert_eq!(page.matches("<svg").count(), 2);

    // how long they took is no part of a world: they are made once more
    assert!(!all.contains_key("time_ms"), "{all:?}");
    run_well(home.path(), &["eval", "all", "--time", "--json", "e.json"]);
    let timed = read();
    assert!(timed.groups.last().unwrap().figures["time_ms"] > 0.0);
    for world in &timed.worlds {
        let stages: Vec<&str> = world.stage_ms.keys().map(String::as_str).collect();
        assert_eq!(stages, ["floorplan", "placement", "scenario", "world"], "{}", world.path);
    }

    // the first world breaks, the second is still measured
    let broken = home.path().join("all/flats/0/world.json");
    let text = fs::read_to_string(&broken).unwrap();
    let mut world: serde_json::Value = serde_json::from_str(&text).unwrap();
    *world.pointer_mut("/placements/placements/0/size_m/0").unwrap() = (-1.0).into();
    fs::write(&broken, world.to_string()).unwrap();
    let output = run(home.path(), &["eval", "all", "--json", "e.json", "--threads", "1"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("flats/0/world.json") && said.contains("/placements/placements/0/size_m"), "{said}");
    assert_eq!((read().worlds.len(), read().broken.len()), (1, 1));
}

#[test]
fn folders_without_worlds_are_refused() {
    let home = tempfile::tempdir().unwrap();
    fs::create_dir(home.path().join("empty")).unwrap();
    for folder in ["empty", "missing"] {
        let output = run(home.path(), &["eval", folder]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(folder), "{said}");
    }
    fs::write(home.path().join("empty/thesis.tex"), "x").unwrap();
    let output = run(home.path(), &["bench", "paper", "--each", "1", "--out", "empty"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("is not empty"));
}

#[test]
fn the_benchmark_is_printed_beside_the_paper_and_kept() {
    let home = tempfile::tempdir().unwrap();
    let table = run_well(home.path(), &["bench", "paper", "--each", "1", "--out", "paper", "--threads", "2"]);
    assert!(
        table.contains("objects paper") && table.contains("a room paper") && table.contains("median ms"),
        "{table}"
    );
    let text = fs::read_to_string(home.path().join("paper/evaluation.json")).unwrap();
    let kept = Evaluation::from_json(&text).unwrap();
    assert_eq!(kept.worlds.len(), 9);
    assert!(kept.worlds.iter().all(|w| w.fidelity.exact && w.sound == Some(true) && w.stage_ms.len() == 5), "{text}");
    for world in &kept.worlds {
        assert!(home.path().join("paper").join(&world.path).join("world.json").is_file(), "{}", world.path);
    }
    // measured again from the files, the worlds are the same but for the time and the number in the prompt
    run_well(home.path(), &["eval", "paper", "--json", "again.json"]);
    let mut again = Evaluation::from_json(&fs::read_to_string(home.path().join("again.json")).unwrap()).unwrap();
    for (world, first) in again.worlds.iter_mut().zip(&kept.worlds) {
        world.stage_ms.clone_from(&first.stage_ms);
    }
    assert_eq!(again.worlds, kept.worlds);
}
