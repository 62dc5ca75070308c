//! What is locked stays as it is when a stage runs again.

use d3dgen_model::document::Document;
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::placements::{Placement, Placements};
use d3dgen_tests::run_well;

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
