//! Worlds that stand, and what is wrong with ones that do not.

use std::sync::LazyLock;
use std::sync::atomic::AtomicBool;

use d3dgen_export::Subject;
use d3dgen_export::models::NothingKept;
use d3dgen_export::scene::{SimScene, SimShape};
use d3dgen_pipeline::scene_graph::Request;
use d3dgen_pipeline::task::{self, Terms};
use d3dgen_plugins::Registry;

use super::*;

static REGISTRY: LazyLock<Registry> = LazyLock::new(Registry::builtin);

fn made(prompt: &str, seed: u64) -> Option<SimScene> {
    let registry = &*REGISTRY;
    let request = Request { prompt: prompt.into(), seed, ..Request::default() };
    let made = task::make(&request, registry, Terms::default(), &AtomicBool::new(false)).unwrap().ok()?;
    let domain = registry.get(&made.world.scene_graph.domain).unwrap().domain();
    Some(Subject::new(&made.world, domain, &NothingKept).scene().unwrap().clone())
}

fn scene(prompt: &str, seed: u64) -> SimScene {
    made(prompt, seed).unwrap_or_else(|| panic!("{prompt} has no world"))
}

#[test]
fn worlds_of_every_kind_of_building_stand() {
    let kinds: Vec<String> =
        REGISTRY.iter().flat_map(|p| &p.domain().building_types).map(|kind| kind.id.replace('_', " ")).collect();
    assert!(kinds.len() > 100, "{} kinds", kinds.len());
    // a word that no prompt stands alone with makes no world
    let scenes: Vec<(&String, SimScene)> = kinds.iter().filter_map(|kind| Some((kind, made(kind, 5)?))).collect();
    assert!(scenes.len() * 20 > kinds.len() * 19, "{} of {} kinds have a world", scenes.len(), kinds.len());
    for (kind, scene) in scenes {
        let settled = settle(&scene);
        assert!(settled.bodies > 0, "{kind} has nothing that can be moved");
        assert_eq!((&settled.moved, &settled.overlaps), (&Vec::new(), &Vec::new()), "{kind}");
    }
}

#[test]
fn the_same_scene_comes_to_the_same() {
    let scene = scene("studio flat", 2);
    assert_eq!(settle(&scene), settle(&scene));
}

#[test]
fn what_hangs_in_the_air_falls_and_what_is_in_a_wall_is_told() {
    let mut scene = scene("flat with two bedrooms", 5);
    let chair = scene.objects.iter().position(|o| o.mobility != Mobility::Fixed && o.class.contains("chair")).unwrap();
    scene.objects[chair].at_m[2] += 0.5;
    let settled = settle(&scene);
    let fallen = settled.moved.iter().find(|m| m.id == scene.objects[chair].id).expect("it falls");
    // onto the floor, or the table that it is drawn up to
    assert!(fallen.way_m > 0.1, "{fallen:?}");
    assert!(settled.share_at_rest() < 1.0);

    let (x, y) = (scene.walls[0].pieces[0].shape.clone(), scene.objects[chair].at_m[2] - 0.5);
    let SimShape::Box(wall) = x else { panic!("walls along x and y are boxes") };
    scene.objects[chair].at_m = [wall.center_m[0], wall.center_m[1], y];
    let settled = settle(&scene);
    let overlap = settled.overlaps.iter().find(|o| o.ids.contains(&scene.objects[chair].id)).expect("it is told");
    assert!(overlap.depth_m > CONTACT_M && overlap.ids.contains(&"building".to_owned()));
}
