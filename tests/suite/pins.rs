//! What is locked stays as it is when a stage runs again.

use d3dgen_model::document::Document;
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::placements::{Placement, Placements};
use d3dgen_tests::{run, run_well};

#[test]
fn locked_parts_survive_another_seed() {
    let home = tempfile::tempdir().unwrap();
    let at = |args: &[&str]| run_well(home.path(), args);
    let write = |name: &str, text: String| std::fs::write(home.path().join(name), text).unwrap();
    at(&["generate", "two-bedroom flat in Germany", "--seed", "2", "--no-png", "--out", "flat"]);

    let mut plan = Floorplan::from_json(&at(&["floorplan", "flat/scene_graph.json"])).unwrap();
    plan.rooms.iter_mut().for_each(|r| r.locked = true);
    write("plan.json", plan.to_json());
    let again = at(&["floorplan", "flat/scene_graph.json", "--seed", "77", "--pin", "plan.json"]);
    assert_eq!(Floorplan::from_json(&again).unwrap().rooms, plan.rooms);
    let free = at(&["floorplan", "flat/scene_graph.json", "--seed", "77"]);
    assert_ne!(Floorplan::from_json(&free).unwrap().walls, plan.walls);

    let mut placements =
        Placements::from_json(&std::fs::read_to_string(home.path().join("flat/placements.json")).unwrap()).unwrap();
    let bed = placements.placements.iter_mut().find(|p| p.object.contains("bed")).expect("a bedroom has a bed");
    bed.locked = true;
    let bed: Placement = bed.clone();
    write("placements.json", placements.to_json());
    let pinned =
        ["placement", "flat/scene_graph.json", "flat/floorplan.json", "--seed", "78", "--pin", "placements.json"];
    let again = Placements::from_json(&at(&pinned)).unwrap();
    assert!(again.placements.contains(&bed), "{bed:?} was moved or dropped");
    assert_ne!(again.placements.len(), 1);
    let mut without = again.placements.clone();
    without.retain(|p| p != &bed);
    assert!(without.iter().any(|p| !placements.placements.contains(p)), "another seed changes nothing else");
}

#[test]
fn one_locked_room_stays_while_the_others_are_planned_anew() {
    let home = tempfile::tempdir().unwrap();
    let at = |args: &[&str]| run_well(home.path(), args);
    at(&["generate", "two-bedroom flat in Germany", "--seed", "2", "--no-png", "--out", "flat"]);
    at(&["edit", "flat", "--do", "lock bathroom_1", "--no-png", "--out", "pinned"]);
    let read = |text: &str| Floorplan::from_json(text).unwrap();
    let pinned = read(&std::fs::read_to_string(home.path().join("pinned/floorplan.json")).unwrap());
    let again = read(&at(&["floorplan", "flat/scene_graph.json", "--seed", "5", "--pin", "pinned/floorplan.json"]));
    assert_eq!(again.room("bathroom_1"), pinned.room("bathroom_1"));
    assert!(again.rooms.iter().any(|r| pinned.rooms.iter().all(|old| old.polygon != r.polygon)), "nothing is new");
}

#[test]
fn edits_change_a_world_or_say_why_not() {
    let home = tempfile::tempdir().unwrap();
    let at = |args: &[&str]| run_well(home.path(), args);
    at(&["generate", "two-bedroom flat in Germany", "--seed", "2", "--no-png", "--out", "flat"]);
    at(&["edit", "flat", "--do", "add_room storage 4", "--do", "refurnish bedroom_1", "--no-png", "--out", "more"]);
    let plan = std::fs::read_to_string(home.path().join("more/floorplan.json")).unwrap();
    assert!(Floorplan::from_json(&plan).unwrap().room("storage_1").is_some());
    at(&["check", "more"]);

    let refused = |change: &str| {
        let output = run(home.path(), &["edit", "flat", "--do", change, "--out", "refused"]);
        assert_eq!(output.status.code(), Some(2), "{change}");
        assert!(!home.path().join("refused").exists(), "{change} left something behind");
        String::from_utf8(output.stderr).unwrap()
    };
    assert!(refused("paint bedroom_1 red").contains("`paint` is none of move_wall"));
    assert!(refused("move_wall wall_1").contains("needs WALL_ID BY_M"));
    assert!(refused("move_wall wall_999 0.5").contains("no wall `wall_999`"));
    assert!(refused("remove_room ballroom_1").contains("edit 1: the world has no room `ballroom_1`"));
}

#[test]
fn a_building_of_several_storeys_is_edited_storey_by_storey() {
    let home = tempfile::tempdir().unwrap();
    let at = |args: &[&str]| run_well(home.path(), args);
    let plan = |folder: &str| {
        let text = std::fs::read_to_string(home.path().join(folder).join("floorplan.json")).unwrap();
        Floorplan::from_json(&text).unwrap()
    };
    at(&["generate", "three floor office building", "--seed", "1", "--no-png", "--out", "office"]);
    let edits = ["--do", "add_room storage 4 corridor_2", "--do", "lock corridor_1"];
    at(&[&["edit", "office"], &edits[..], &["--no-png", "--out", "more"]].concat());
    let (before, after) = (plan("office"), plan("more"));
    let new: Vec<_> = after.rooms.iter().filter(|r| before.room(&r.room_id).is_none()).collect();
    assert_eq!(new.iter().map(|r| (r.room_type.as_str(), r.level)).collect::<Vec<_>>(), [("storage", 1)]);
    for level in [0, 2] {
        let (old, new) = (before.storey(level), after.storey(level));
        assert_eq!((old.walls, old.doors, old.windows), (new.walls, new.doors, new.windows), "storey {level}");
    }
    at(&["check", "more"]);

    let pinned = ["floorplan", "more/scene_graph.json", "--seed", "5", "--pin", "more/floorplan.json"];
    let again = Floorplan::from_json(&at(&pinned)).unwrap();
    let stay = after.links.iter().flat_map(|l| l.room_ids.iter()).map(String::as_str).chain(["corridor_1"]);
    for id in stay {
        assert_eq!(again.room(id).map(|r| &r.polygon), after.room(id).map(|r| &r.polygon), "{id}");
    }
    assert_ne!(again.walls, after.walls, "nothing is new");

    let refused = |change: &str| {
        let output = run(home.path(), &["edit", "office", "--do", "refurnish office_1", "--do", change, "--out", "no"]);
        assert_eq!(output.status.code(), Some(2), "{change}");
        assert!(!home.path().join("no").exists(), "{change} left something behind");
        String::from_utf8(output.stderr).unwrap()
    };
    assert!(refused("remove_room stairwell_2").contains("edit 2: `stairwell_2` joins the storeys"));
    assert!(refused("add_room storage 4 elevator_1").contains("edit 2: no room is entered from stairs or elevator"));
    assert!(refused("add_room storage 4 corridor_7").contains("edit 2: the world has no room `corridor_7`"));
}
