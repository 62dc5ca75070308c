use super::*;
use crate::models::NothingKept;
use crate::sample;

fn files() -> Vec<File> {
    Usd.export(&Subject::new(&sample::world(), &sample::domain(), &NothingKept)).unwrap()
}

fn text(name: &str) -> String {
    let file = files().into_iter().find(|f| f.path == name).unwrap_or_else(|| panic!("{name} is not written"));
    String::from_utf8(file.bytes).unwrap()
}

#[test]
fn the_stage_has_a_prim_for_every_id_and_a_joint_for_every_leaf() {
    let scene = SimScene::of(&sample::world(), &sample::domain(), &NothingKept).unwrap();
    let stage = text("usd/world.usda");
    for (id, path) in places(&scene) {
        assert!(stage.contains(&format!("\"{}\"", path.rsplit('/').next().unwrap())), "{id}");
    }
    for leaf in scene.doors.iter().flat_map(|d| &d.leaves) {
        assert!(stage.contains(&format!("Joint \"{}\"", identifier(&leaf.joint.id))), "{}", leaf.id);
    }
    assert!(stage.contains("metersPerUnit = 1") && stage.contains("upAxis = \"Z\""));
    assert!(!stage.contains("@/") && !stage.contains("@.."), "every path stays in the folder");
}

#[test]
fn every_file_that_a_layer_names_is_there() {
    let all = files();
    let layers = all.iter().filter(|f| f.path.ends_with(".usda"));
    for layer in layers {
        let folder = layer.path.rsplit_once('/').unwrap().0;
        let text = String::from_utf8(layer.bytes.clone()).unwrap();
        for named in text.split('@').skip(1).step_by(2) {
            let path = format!("{folder}/{}", named.trim_start_matches("./"));
            assert!(all.iter().any(|f| f.path == path), "{} names {named}", layer.path);
        }
    }
}

#[test]
fn what_is_fixed_and_has_no_joints_is_no_body() {
    let scene = SimScene::of(&sample::world(), &sample::domain(), &NothingKept).unwrap();
    let listed = manifest(&scene, &objects::Assets::of(&scene));
    let fixed = listed["objects"].as_array().unwrap().iter().filter(|o| o["dynamic"] == false).count();
    let stage = text("usd/world.usda");
    assert_eq!(stage.matches("delete apiSchemas = [\"PhysicsRigidBodyAPI\"").count(), fixed);
}

#[test]
fn the_graph_of_isaac_lab_names_what_is_in_the_stage() {
    let graph = text("usd/isaaclab/arena_env_graph.yaml");
    assert!(graph.contains("env_name") && graph.contains("background"));
    let scene = text("usd/isaaclab/scene_cfg.py");
    assert!(scene.contains("UsdFileCfg(usd_path=WORLD_USD)") && !scene.contains("{{"));
}

#[test]
fn every_body_of_an_asset_collides() {
    let scene = SimScene::of(&sample::world(), &sample::domain(), &NothingKept).unwrap();
    for model in objects::Assets::of(&scene).models() {
        assert!(model.bodies.iter().skip(1).all(|b| !b.collisions.is_empty()), "{}", model.name);
        assert_eq!(model.joints.len() + 1, model.bodies.len(), "{}", model.name);
    }
}

#[test]
fn doors_and_drawers_of_what_is_fixed_pass_the_building() {
    let scene = SimScene::of(&sample::world(), &sample::domain(), &NothingKept).unwrap();
    let [still, moving] = objects::Assets::of(&scene).fixed(&scene);
    assert!(!still.is_empty() && still.iter().all(|path| !moving.contains(path)));
    let stage = text("usd/world.usda");
    for path in still.iter().chain(&moving) {
        assert!(stage.contains(&format!("<{path}>")), "{path} is in no group");
    }
    assert!(stage.contains("</World/Doors/door_1/frame>") || scene.doors.is_empty());
}

#[test]
fn outlines_of_zones_say_how_far_they_reach() {
    let stage = text("usd/world.usda");
    let curves: Vec<&str> = stage.split("def BasisCurves").skip(1).collect();
    assert!(!curves.is_empty() && curves.iter().all(|c| c.split("def ").next().unwrap().contains("float3[] extent")));
}
