use std::collections::BTreeSet;

use d3dgen_mesh::picture::studio::{Effort, Studio};
use d3dgen_model::floorplan::DoorKind;

use super::*;
use crate::models::NothingKept;
use crate::render::{Wish, pictures, shots};
use crate::sample;

fn seen() -> (SimScene, World3d) {
    let scene = SimScene::of(&sample::world(), &sample::domain(), &NothingKept).unwrap();
    let world = world3d(&scene).unwrap();
    (scene, world)
}

fn wish() -> Wish {
    Wish {
        size_px: [32, 24],
        effort: Effort { samples: 1, threads: 2 },
        eye_m: 1.6,
        night: false,
        rooms: None,
        overview: true,
    }
}

#[test]
fn every_room_wall_door_window_and_thing_is_a_node_by_its_id() {
    let (scene, world) = seen();
    let names: Vec<&str> = world.nodes.iter().map(|n| n.name.as_str()).collect();
    let distinct: BTreeSet<&&str> = names.iter().collect();
    assert_eq!(distinct.len(), names.len(), "no two nodes have one name");
    let ids = (scene.rooms.iter().map(|r| &r.id))
        .chain(scene.walls.iter().map(|w| &w.id))
        .chain(scene.doors.iter().map(|d| &d.id))
        .chain(scene.windows.iter().map(|w| &w.id))
        .chain(scene.objects.iter().map(|o| &o.id));
    for id in ids {
        assert!(names.contains(&id.as_str()), "{id} is not seen");
    }
    assert!(world.nodes.iter().enumerate().all(|(i, n)| n.parent.is_none_or(|p| p < i)), "parents come first");
}

#[test]
fn leaves_move_and_things_of_one_model_share_their_meshes() {
    let (scene, world) = seen();
    for door in scene.doors.iter().filter(|d| d.kind != DoorKind::Open) {
        let moves = world.nodes.iter().filter(|n| n.motion.as_ref().is_some_and(|m| m.name == door.id));
        assert_eq!(moves.count(), door.leaves.len(), "{}", door.id);
    }
    let bodies: usize = scene.models.iter().map(|m| m.model.bodies.len()).sum();
    let of_things = world.meshes.iter().filter(|m| scene.models.iter().any(|s| m.name.starts_with(&s.model.name)));
    assert!(of_things.count() <= bodies, "a mesh a body of a model, not one a thing");
}

#[test]
fn walls_wear_the_surface_of_the_room_before_them() {
    let (scene, world) = seen();
    for room in &scene.rooms {
        let name = &room.materials.wall;
        assert!(world.materials.iter().any(|m| &m.name == name), "{name} of {} is nowhere", room.id);
        let floor = world.materials.iter().find(|m| m.name == room.materials.floor).unwrap();
        assert!(floor.finish.is_some() || floor.opacity < 1.0, "{} has no pictures", floor.name);
    }
}

#[test]
fn the_eye_stands_in_the_room_and_sees_it() {
    let (scene, world) = seen();
    let studio = Studio::new(&world, &[], &|_| 0.0);
    let all = shots(&scene, &studio, &wish()).unwrap();
    assert_eq!(all.iter().filter(|s| s.name.starts_with("overview")).count(), scene.storeys.len());
    for room in scene.rooms.iter().filter(|r| !r.ceiling.is_empty()) {
        let shot = all.iter().find(|s| s.name == format!("room_{}", room.id)).unwrap();
        let [x, y, z] = shot.camera.eye;
        assert!(room.net.contains(Point::new(x, y)), "{}: the eye is at {x} {y}", room.id);
        assert!(z < room.floor_m + room.ceiling_m);
    }
    let missing = Wish { rooms: Some(vec!["no_such_room".into()]), ..wish() };
    assert!(shots(&scene, &studio, &missing).unwrap_err().to_string().contains("no_such_room"));
}

#[test]
fn pictures_are_the_same_every_time() {
    let (scene, world) = seen();
    let take = || {
        let mut files = Vec::new();
        let only = Wish { rooms: Some(vec![scene.rooms[0].room_id.clone()]), ..wish() };
        pictures(&scene, &world, &only, &mut |file, all| {
            assert_eq!(all, 1 + scene.storeys.len());
            files.push(file);
            Ok::<(), Error>(())
        })
        .unwrap();
        files
    };
    assert_eq!(take(), take());
}
