//! `d3dgen furnish`: plans that people bring are furnished as they are, and what they break is blamed on them.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use d3dgen_model::document::Document;
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::report::Report;
use d3dgen_tests::{files, run, run_well, workspace};

/// Plans of the readers' tests, the flags that each needs, and what it breaks by itself.
const PLANS: &[(&str, &[&str], &[&str])] = &[
    ("flat.geojson", &[], &[]),
    ("flat.svg", &[], &[]),
    ("flat.dxf", &[], &[]),
    ("flat.json", &["--domain", "residential"], &[]),
    ("flat.building.yaml", &[], &["daylight_missing"]),
    // a map has no names: its corridor is a room like any other, too narrow for one, with two rooms behind it; its largest
    // room is taken for the one to live in, and has no window
    (
        "flat_map.yaml",
        &["--domain", "residential"],
        &["daylight_missing", "private_passage", "room_dimension", "room_proportion"],
    ),
];

fn plan(name: &str) -> String {
    workspace().join("service/plans/tests/plans").join(name).display().to_string()
}

fn report(folder: &Path) -> Report {
    Report::from_json(&fs::read_to_string(folder.join("report.json")).unwrap()).unwrap()
}

/// Returns the rules that a report says are broken; each violation must be blamed on the plan.
fn given(report: &Report) -> Vec<&str> {
    let broken: Vec<_> = report.rules.iter().filter(|r| !r.violations.is_empty()).collect();
    assert!(broken.iter().flat_map(|r| &r.violations).all(|v| v.given), "{broken:#?}");
    broken.iter().map(|r| r.rule.as_str()).collect()
}

#[test]
fn plans_of_every_format_become_worlds_that_other_commands_take() {
    let home = tempfile::tempdir().unwrap();
    for (name, flags, breaks) in PLANS {
        // our own document is the one that was made of the first
        let own = home.path().join("flat.geojson/floorplan.json").display().to_string();
        let path = if *name == "flat.json" { own } else { plan(name) };
        let args = [&["furnish", path.as_str(), "--out", name, "--no-png"], *flags].concat();
        let done = run(home.path(), &args);
        let told = String::from_utf8_lossy(&done.stderr);
        let folder = home.path().join(name);
        assert_eq!(done.status.code(), Some(i32::from(!breaks.is_empty())), "{name}: {told}");
        let report = report(&folder);
        assert!(report.asks.is_empty(), "the name of a file asks for nothing: {:?}", report.asks);
        assert_eq!((given(&report).as_slice(), report.sound, report.given_plan), (*breaks, breaks.is_empty(), true));
        assert_eq!(breaks.is_empty(), !told.contains("plan as given breaks"), "{name}: {told}");
        let written = files(&folder);
        assert!(written.contains_key("world.json") && written.contains_key("plan.svg"), "{:?}", written.keys());
        assert!(written.keys().any(|k| k.ends_with("world.yaml")), "{name} has no bundle");

        let code = |args: &[&str]| run(home.path(), args).status.code();
        assert_eq!(code(&["check", name]), done.status.code());
        assert_eq!(code(&["export", name, "--no-png", "--out", "exported"]), Some(0));
        let stages = ["world", name, name, name, name, "--no-png", "--out", "again"];
        assert_eq!(code(&stages), done.status.code());
        let again = files(&home.path().join("again"));
        assert!(again["world.json"] == written["world.json"] && again["report.json"] == written["report.json"]);
    }
}

#[test]
fn the_same_plan_and_seed_give_the_same_bytes_and_the_plan_stays() {
    let home = tempfile::tempdir().unwrap();
    let path = plan("flat.geojson");
    for out in ["first", "second"] {
        run_well(home.path(), &["furnish", &path, "--seed", "3", "--no-png", "--out", out]);
    }
    let of = |out: &str| files(&home.path().join(out));
    assert!(of("first") == of("second"));
    run_well(home.path(), &["furnish", &path, "--seed", "4", "--no-png", "--out", "other"]);
    let (first, other) = (of("first"), of("other"));
    assert!(first["placements.json"] != other["placements.json"], "another seed furnishes in another way");
    let rooms = |files: &BTreeMap<String, Vec<u8>>| {
        Floorplan::from_json(std::str::from_utf8(&files["floorplan.json"]).unwrap()).unwrap().rooms
    };
    assert_eq!(rooms(&first), rooms(&other), "the seed changes nothing of the plan");
}

#[test]
fn a_plan_that_was_made_here_passes_through_with_all_its_levels() {
    let home = tempfile::tempdir().unwrap();
    let request = "office with 12 rooms on 2 floors in France";
    run_well(home.path(), &["generate", request, "--seed", "1", "--no-png", "--out", "made"]);
    run_well(home.path(), &["furnish", "made/floorplan.json", "--graph", "made", "--no-png", "--out", "kept"]);
    run_well(home.path(), &["furnish", "made/floorplan.json", "--domain", "office", "--no-png", "--out", "bare"]);
    let read = |out: &str| {
        let text = fs::read_to_string(home.path().join(out).join("floorplan.json")).unwrap();
        Floorplan::from_json(&text).unwrap()
    };
    let (made, kept, bare) = (read("made"), read("kept"), read("bare"));
    assert_eq!((made.levels.len(), made.links.is_empty()), (2, false));
    for plan in [&kept, &bare] {
        assert_eq!((&plan.levels, &plan.links), (&made.levels, &made.links));
        let outline = |p: &Floorplan| p.rooms.iter().map(|r| (r.room_id.clone(), r.level, r.polygon.clone())).collect();
        let (is, was): (Vec<_>, Vec<_>) = (outline(plan), outline(&made));
        assert_eq!(is, was);
    }
}

#[test]
fn a_building_of_two_levels_comes_in_whole() {
    let home = tempfile::tempdir().unwrap();
    let tower = plan("tower.building.yaml");
    let done = run(home.path(), &["furnish", &tower, "--domain", "office", "--no-png", "--out", "whole"]);
    let told = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.code() == Some(1) && told.contains("plan as given breaks"), "{told}");
    assert!(given(&report(&home.path().join("whole"))).contains(&"stairs_missing"), "{told}");
    let read = |out: &str| {
        let text = fs::read_to_string(home.path().join(out).join("floorplan.json")).unwrap();
        Floorplan::from_json(&text).unwrap()
    };
    let whole = read("whole");
    assert_eq!((whole.levels.len(), whole.links.len()), (2, 2), "{told}");
    assert!(whole.rooms.iter().filter(|r| r.room_type == "elevator").count() == 4);
    assert_eq!(run(home.path(), &["check", "whole"]).status.code(), Some(1));
    run(home.path(), &["furnish", &tower, "--level", "L2", "--domain", "office", "--no-png", "--out", "upper"]);
    let upper = read("upper");
    assert!(upper.levels.is_empty() && upper.rooms.iter().any(|r| r.name == "archive"));
}

#[test]
fn maps_of_worlds_made_here_come_back_with_their_rooms() {
    let home = tempfile::tempdir().unwrap();
    for (request, seed) in
        [("a house with 3 bedrooms", "2"), ("office with 10 rooms", "3"), ("ward with 6 patient rooms", "1")]
    {
        run_well(home.path(), &["generate", request, "--seed", seed, "--no-png", "--out", "made"]);
        let map = files(&home.path().join("made")).into_keys().find(|k| k.ends_with("map.yaml")).unwrap();
        let done = run(home.path(), &["furnish", &format!("made/{map}"), "--no-png", "--out", "back"]);
        let told = String::from_utf8_lossy(&done.stderr);
        assert!(matches!(done.status.code(), Some(0 | 1)) && told.contains("approximate"), "{request}: {told}");
        let read = |out: &str| {
            let text = fs::read_to_string(home.path().join(out).join("floorplan.json")).unwrap();
            Floorplan::from_json(&text).unwrap()
        };
        let (made, back) = (read("made"), read("back"));
        // what is wide open is one room on a map
        assert!(back.rooms.len().abs_diff(made.rooms.len()) <= 1, "{request}: {} rooms", back.rooms.len());
        assert!(back.doors.iter().any(|d| d.entrance), "{request}: no entrance");
        let area = |p: &Floorplan| p.rooms.iter().map(|r| r.net_area_m2).sum::<f64>();
        assert!((area(&back) / area(&made) - 1.0).abs() < 0.05, "{request}: {} of {} m2", area(&back), area(&made));
    }
}

#[test]
fn the_office_of_open_rmf_becomes_an_office_with_its_doors() {
    // of the examples beside the checkout, where they are there
    let plan = workspace().join("../shared/formats/examples/real/rmf/office.building.yaml");
    if !plan.is_file() {
        return;
    }
    let home = tempfile::tempdir().unwrap();
    let done = run(home.path(), &["furnish", &plan.display().to_string(), "--no-png", "--out", "o"]);
    assert!(matches!(done.status.code(), Some(0 | 1)), "{}", String::from_utf8_lossy(&done.stderr));
    let text = fs::read_to_string(home.path().join("o/floorplan.json")).unwrap();
    let plan = Floorplan::from_json(&text).unwrap();
    assert!((5..=7).contains(&plan.rooms.len()), "{:?}", plan.rooms.iter().map(|r| &r.name).collect::<Vec<_>>());
    let hinged = plan.doors.iter().filter(|d| d.kind != d3dgen_model::floorplan::DoorKind::Open);
    assert_eq!(hinged.count(), 3, "the doors of the plan");
    assert!(plan.doors.iter().any(|d| d.entrance) && plan.rooms.iter().any(|r| r.name == "lounge"));
    let graph = fs::read_to_string(home.path().join("o/scene_graph.json")).unwrap();
    assert!(graph.contains("\"domain\": \"office\"") && graph.contains("straightened"), "{graph}");
}

/// A house in GeoJSON: a hall with an entrance, and a room of a size beside it.
fn house(name: &str, width: f64, depth: f64) -> String {
    let rect =
        |x0: f64, y0: f64, x1: f64, y1: f64| format!("[[{x0},{y0}],[{x1},{y0}],[{x1},{y1}],[{x0},{y1}],[{x0},{y0}]]");
    let room = |name: &str, ring: String| {
        format!(
            "{{\"type\":\"Feature\",\"properties\":{{\"name\":\"{name}\"}},\"geometry\":{{\"type\":\"Polygon\",\"coordinates\":[{ring}]}}}}"
        )
    };
    let line = |kind: &str, x0: f64, y0: f64, x1: f64, y1: f64| {
        format!(
            "{{\"type\":\"Feature\",\"properties\":{{\"kind\":\"{kind}\"}},\"geometry\":{{\"type\":\"LineString\",\"coordinates\":[[{x0},{y0}],[{x1},{y1}]]}}}}"
        )
    };
    let features = [
        room("Hall", rect(0.0, 0.0, 2.0, 4.0)),
        room(name, rect(2.1, 0.0, 2.1 + width, depth)),
        line("door", 2.05, 0.5, 2.05, 1.4),
        line("entrance", 0.5, 0.0, 1.5, 0.0),
        line("window", 2.1 + width, 0.3, 2.1 + width, 1.3),
    ];
    format!("{{\"type\":\"FeatureCollection\",\"features\":[{}]}}", features.join(","))
}

#[test]
fn what_a_room_lacks_is_the_plans_fault_only_where_the_room_is_too_small() {
    let home = tempfile::tempdir().unwrap();
    fs::write(home.path().join("closet.geojson"), house("Bedroom", 1.6, 1.9)).unwrap();
    let done = run(home.path(), &["furnish", "closet.geojson", "--no-png", "--out", "closet"]);
    assert_eq!(done.status.code(), Some(1), "{}", String::from_utf8_lossy(&done.stderr));
    let report = report(&home.path().join("closet"));
    let broken = given(&report);
    assert!(broken.contains(&"object_missing") && broken.contains(&"room_area"), "{broken:?}");
    assert!(home.path().join("closet/world.json").is_file());

    // a room larger than such rooms mostly are breaks nothing: nobody asked for less
    fs::write(home.path().join("large.geojson"), house("Bedroom", 9.0, 7.0)).unwrap();
    run_well(home.path(), &["furnish", "large.geojson", "--no-png", "--out", "large"]);

    // the same lack in a room that is large enough: its bed is taken out of the finished world's placements
    fs::write(home.path().join("room.geojson"), house("Bedroom", 3.6, 4.0)).unwrap();
    run_well(home.path(), &["furnish", "room.geojson", "--no-png", "--out", "room"]);
    let file = home.path().join("room/placements.json");
    let mut placements: serde_json::Value = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    placements["placements"] = serde_json::json!([]);
    fs::write(home.path().join("empty.json"), placements.to_string()).unwrap();
    let args = ["world", "room", "room", "empty.json", "room", "--no-png", "--out", "emptied"];
    assert_eq!(run(home.path(), &args).status.code(), Some(1));
    let emptied = self::report(&home.path().join("emptied"));
    let lack = emptied.rules.iter().find(|r| r.rule == "object_missing").unwrap();
    assert!(!lack.violations.is_empty() && lack.violations.iter().all(|v| !v.given), "{lack:?}");
    assert!(emptied.given_plan && !home.path().join("emptied/world.json").exists());
}

#[test]
fn a_plan_without_doors_is_a_world_that_says_so() {
    let home = tempfile::tempdir().unwrap();
    let mut shut: serde_json::Value = serde_json::from_str(&fs::read_to_string(plan("flat.geojson")).unwrap()).unwrap();
    let is_door = |f: &serde_json::Value| ["door", "opening", "entrance"].iter().any(|k| f["properties"]["type"] == *k);
    shut["features"].as_array_mut().unwrap().retain(|f| !is_door(f));
    fs::write(home.path().join("shut.geojson"), shut.to_string()).unwrap();
    for seed in ["0", "1", "2"] {
        let done = run(home.path(), &["furnish", "shut.geojson", "--seed", seed, "--no-png", "--out", "shut"]);
        assert_eq!(done.status.code(), Some(1), "{}", String::from_utf8_lossy(&done.stderr));
        let report = report(&home.path().join("shut"));
        let broken = given(&report);
        assert!(["no_entrance", "unreachable_zone"].iter().all(|r| broken.contains(r)), "{broken:?}");
        assert!(home.path().join("shut/world.json").is_file());
    }
}

/// A hall of 20 m by 12 m with two round columns, as a DXF whose walls are on a layer of the office's own naming.
fn hall() -> String {
    let mut text = String::from("0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n6\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n");
    text += "0\nLWPOLYLINE\n8\nG-17\n90\n4\n70\n1\n10\n0\n20\n0\n10\n20\n20\n0\n10\n20\n20\n12\n10\n0\n20\n12\n";
    for x in [7, 13] {
        text += &format!("0\nCIRCLE\n8\nSTUETZEN\n10\n{x}\n20\n6\n40\n0.3\n");
    }
    text + "0\nENDSEC\n0\nEOF\n"
}

#[test]
fn columns_are_obstacles_of_the_world_and_layers_are_what_the_user_says() {
    let home = tempfile::tempdir().unwrap();
    fs::write(home.path().join("hall.dxf"), hall()).unwrap();
    let flags = ["--layer", "G-17=wall", "--domain", "office", "--add-doors", "--no-png", "--out", "hall"];
    let done = run(home.path(), &[&["furnish", "hall.dxf"], &flags[..]].concat());
    assert!(matches!(done.status.code(), Some(0 | 1)), "{}", String::from_utf8_lossy(&done.stderr));
    let read = |name: &str| fs::read_to_string(home.path().join("hall").join(name)).unwrap();
    let plan = Floorplan::from_json(&read("floorplan.json")).unwrap();
    assert_eq!(plan.obstacles.len(), 2);
    let placements: serde_json::Value = serde_json::from_str(&read("placements.json")).unwrap();
    assert!(!placements["placements"].as_array().unwrap().is_empty());
    given(&report(&home.path().join("hall")));
    assert_eq!(run(home.path(), &["check", "hall"]).status.code(), done.status.code());
    let map = files(&home.path().join("hall")).into_iter().find(|(name, _)| name.ends_with("world.yaml")).unwrap().1;
    // the four walls of the hall, and the faces of two columns
    assert!(String::from_utf8(map).unwrap().matches("start:").count() > 4 + 2 * 12);
}

#[test]
fn plans_that_cannot_be_read_are_refused_with_the_place() {
    let home = tempfile::tempdir().unwrap();
    let put = |name: &str, text: &str| fs::write(home.path().join(name), text).unwrap();
    put(
        "open.geojson",
        "{\"type\":\"FeatureCollection\",\"features\":[{\"type\":\"Feature\",\"properties\":{},\"geometry\":null}]}",
    );
    put("torn.geojson", "{\"type\":\"FeatureCollection\",\"features\":[");
    put("note.txt", "a plan in words");
    fs::create_dir(home.path().join("empty")).unwrap();
    let flat = plan("flat.geojson");
    for (args, words) in [
        (vec!["missing.svg"], vec!["missing.svg"]),
        (vec!["torn.geojson"], vec!["torn.geojson"]),
        (vec!["open.geojson"], vec!["open.geojson", "room"]),
        (vec!["note.txt"], vec!["note.txt", "geojson", "dxf"]),
        (vec!["note.txt", "--plan-format", "dwg"], vec!["dwg", "geojson"]),
        (vec![&flat, "--domain", "spaceship"], vec!["spaceship", "residential"]),
        (vec![&flat, "--room-type", "Attic=bedroom"], vec!["Attic"]),
        (vec![&flat, "--room-type", "Hall=hallwey"], vec!["hallwey", "residential", "hallway"]),
        (vec![&flat, "--country", "XQ"], vec!["XQ"]),
        (vec![&flat, "--robot", "dancing"], vec!["dancing", "delivery"]),
        (vec![&flat, "--robot-radius", "9"], vec!["9"]),
        (vec![&flat, "--inner-wall", "-1"], vec!["wall"]),
        (vec![&flat, "--layer", "A-XREF=roof"], vec!["roof", "furniture"]),
        (vec!["empty"], vec!["empty", "manifest.json"]),
    ] {
        let done = run(home.path(), &[&["furnish", "--out", "o"], args.as_slice()].concat());
        let told = String::from_utf8_lossy(&done.stderr);
        assert_eq!(done.status.code(), Some(2), "{args:?}: {told}");
        assert!(words.iter().all(|w| told.contains(w)), "{args:?}: {told}");
        assert!(!home.path().join("o").exists(), "{args:?} leaves something behind");
    }
}
