use super::*;
use crate::models::NothingKept;
use crate::sample;
use crate::scene::SimWay;

fn scene() -> SimScene {
    SimScene::of(&sample::world(), &sample::domain(), &NothingKept).unwrap()
}

/// How often an element of this name begins.
fn count(xml: &str, element: &str) -> usize {
    xml.matches(&format!("<{element} ")).count()
}

#[test]
fn walls_are_few_collisions_and_ceilings_a_model_of_their_own() {
    let scene = scene();
    let xml = document(&scene, &labels(&scene));
    let (building, rest) = xml.split_once("<model name=\"ceilings\">").unwrap();
    let pieces: usize = scene.walls.iter().map(|w| w.pieces.len()).sum();
    let walls = count(building, "collision") - scene.windows.len();
    assert!(walls < pieces, "{walls} collisions of {pieces} pieces");
    assert!(count(building, "visual") > pieces && rest.contains("bedroom_1_ceiling"));
}

#[test]
fn only_doors_on_a_route_have_joints_and_controllers() {
    let mut scene = scene();
    let joints = |scene: &SimScene| {
        let xml = document(scene, &labels(scene));
        let moving = xml.matches("type=\"revolute\"").count() + xml.matches("type=\"prismatic\"").count();
        (moving, xml.matches("JointPositionController").count())
    };
    let leaves: usize = scene.doors.iter().map(|d| d.leaves.len()).sum();
    scene.robots.iter_mut().for_each(|r| r.routes.clear());
    scene.doors.iter_mut().for_each(|d| d.on_route = false);
    assert_eq!(joints(&scene), (leaves, 0), "no route: every door moves");
    scene.doors[1].on_route = true;
    let way = SimWay { name: "way".into(), points_m: vec![[0.0; 3]; 2], clear_width_m: 1.0 };
    let robot = crate::scene::SimRobot {
        id: "robot".into(),
        kind: "delivery".into(),
        radius_m: 0.3,
        height_m: 1.0,
        start_m: [0.0; 3],
        yaw_rad: 0.0,
        routes: vec![way],
    };
    scene.robots = vec![robot];
    assert_eq!(joints(&scene), (1, 1));
}

#[test]
fn what_bears_nothing_has_few_shapes_and_tops_stay_where_they_are() {
    let scene = scene();
    let mut fewer = 0;
    for (i, model) in
        scene.models.iter().enumerate().filter(|(i, _)| scene.objects.iter().any(|o| o.model == *i && o.collides))
    {
        let files = folder(model, &scene).unwrap();
        let text = files.iter().find(|f| f.path.ends_with("model.sdf")).unwrap();
        let found = count(std::str::from_utf8(&text.bytes).unwrap(), "collision");
        let made: usize = model.model.bodies.iter().map(|b| b.collisions.len()).sum();
        assert!(found > 0 && if bears_things(&scene, i) { found == made } else { found <= made }, "{}", model.id);
        fewer += made - found;
    }
    assert!(fewer > 20, "{fewer}");
}

#[test]
fn every_include_has_its_folder() {
    let files = Gazebo.export(&Subject::new(&sample::world(), &sample::domain(), &NothingKept)).unwrap();
    let world = files.iter().find(|f| f.path == "gazebo/world.sdf").unwrap();
    let text = String::from_utf8(world.bytes.clone()).unwrap();
    let uris: Vec<&str> = text.split("<uri>model://").skip(1).filter_map(|t| t.split("</uri>").next()).collect();
    assert_eq!(uris.len(), sample::world().placements.placements.len());
    for uri in uris {
        assert!(files.iter().any(|f| f.path == format!("gazebo/models/{uri}/model.config")), "{uri}");
    }
}
