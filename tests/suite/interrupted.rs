//! A run that is stopped leaves whole worlds or none, and the next run is not troubled by what it left.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use d3dgen_model::document::Document;
use d3dgen_model::world::World;
use d3dgen_tests::{command, files, run_well};

const MANY: &[&str] = &["generate", "hotel with 8 rooms in total", "--no-png", "--out", "many", "--count", "200"];

/// Starts many worlds and returns when the first ones are there.
fn start(home: &Path) -> Child {
    let mut start = command();
    let child = start.args(MANY).current_dir(home).stderr(Stdio::null()).spawn().unwrap();
    let begun = Instant::now();
    while !home.join("many/1/report.json").exists() {
        assert!(begun.elapsed() < Duration::from_secs(120), "no world in two minutes");
        sleep(Duration::from_millis(5));
    }
    child
}

/// Sends a signal and waits for the end.
fn stop(mut child: Child, signal: &str) -> ExitStatus {
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    child.wait().unwrap()
}

/// Returns the entries of the folder, after a look that each one with a number is a whole world.
fn whole(folder: &Path) -> BTreeSet<String> {
    let names = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
    let names: BTreeSet<String> = names.collect();
    for name in names.iter().filter(|n| n.bytes().all(|b| b.is_ascii_digit())) {
        let found = files(&folder.join(name));
        World::from_json(std::str::from_utf8(&found["world.json"]).unwrap()).unwrap();
        let wanted = ["report.json", "plan.svg", "scenario.json"];
        assert!(wanted.iter().all(|f| found.contains_key(*f)) && found.len() > 20, "{name}: {:?}", found.keys());
    }
    names
}

#[test]
fn ctrl_c_ends_with_130_and_cleans_up() {
    let home = tempfile::tempdir().unwrap();
    let status = stop(start(home.path()), "-INT");
    assert_eq!(status.code(), Some(130));
    let left = whole(&home.path().join("many"));
    assert!(left.contains("1") && left.len() < 200, "{}", left.len());
    assert!(left.iter().all(|n| n.bytes().all(|b| b.is_ascii_digit())), "{left:?}");
}

#[test]
fn a_killed_run_leaves_whole_worlds_and_can_be_repeated() {
    let home = tempfile::tempdir().unwrap();
    let status = stop(start(home.path()), "-KILL");
    assert_eq!(status.code(), None);
    whole(&home.path().join("many"));
    let again: Vec<&str> = MANY[..MANY.len() - 1].iter().copied().chain(["3"]).collect();
    run_well(home.path(), &again);
    assert!(whole(&home.path().join("many")).contains("2"));
}
