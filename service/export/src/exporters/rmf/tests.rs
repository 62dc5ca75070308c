use d3dgen_plans::{Options, Plan, Source, lay_out, read};

use super::*;
use crate::models::NothingKept;
use crate::sample;

fn file(path: &str) -> String {
    let files = Rmf.export(&Subject::new(&sample::world(), &sample::domain(), &NothingKept)).unwrap();
    let file = files.into_iter().find(|f| f.path.ends_with(path)).expect("it is written");
    String::from_utf8(file.bytes).unwrap()
}

#[test]
fn our_own_reader_finds_the_same_rooms_and_doors() {
    let (text, plan) = (file(".building.yaml"), sample::floorplan());
    let options = Options::default();
    let source = Source { name: "flat.building.yaml", bytes: text.as_bytes(), companion: &|_| None };
    let Ok(Plan::Drawing(drawing)) = read(&source, &options) else { panic!("a drawing") };
    let layout = lay_out(drawing, &options).expect("a plan");
    assert_eq!(layout.rooms.len(), plan.rooms.len(), "{:?}", layout.notes);
    let joined = layout.openings.iter().filter(|o| o.rooms.len() == 2).count();
    let inner = plan.doors.iter().filter(|d| d.room_ids.len() == 2 && d.kind != DoorKind::Open).count();
    assert!(joined >= inner, "{joined} of {inner}: {:?}", layout.notes);
}

#[test]
fn chargers_have_their_robots_and_lanes_go_through_one_door() {
    let graph = file("nav_graphs/0.yaml");
    for (word, least) in [("is_charger: true", 1), ("door_name:", 4), ("dock_name:", 1), ("undock_name:", 1)] {
        assert!(graph.matches(word).count() >= least, "{word} in {graph}");
    }
    let building = file(".building.yaml");
    let world = sample::world();
    for task in &world.scenario.robots {
        assert!(building.contains(&format!("- {}", task.robot_id)), "{} is spawned", task.robot_id);
    }
}
