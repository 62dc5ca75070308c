use std::collections::BTreeMap;

use super::*;
use crate::models::NothingKept;
use crate::sample;

fn files() -> BTreeMap<String, Vec<u8>> {
    let files = Nav2.export(&Subject::new(&sample::world(), &sample::domain(), &NothingKept)).unwrap();
    files.into_iter().map(|f| (f.path, f.bytes)).collect()
}

fn pixels(bytes: &[u8]) -> (usize, usize, Vec<u8>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    (info.width as usize, info.height as usize, pixels)
}

#[test]
fn the_map_is_free_where_nothing_stands_and_the_masks_lie_on_it() {
    let (files, world) = (files(), sample::world());
    let ground = Ground::of(&world, Body::of(&world));
    let (width, height, map) = pixels(&files["nav2/0/map.png"]);
    let frame = ground.occupancy.frame;
    let at = |p: Point| {
        let (i, j) = frame.cell(p).unwrap();
        map[(height - 1 - FRAME - j) * width + FRAME + i]
    };
    for (j, i) in (0..frame.ny).flat_map(|j| (0..frame.nx).map(move |i| (j, i))) {
        let free = at(frame.center(i, j)) == FREE;
        assert_eq!(free, ground.occupancy.free.get(i, j), "{i}, {j}");
    }
    let border = (0..width).map(|i| map[i]).chain((0..height).map(|j| map[j * width]));
    assert!(border.into_iter().all(|g| g == OCCUPIED), "the map is closed");
    for mask in ["keepout_mask", "speed_mask"] {
        let (w, h, _) = pixels(&files[&format!("nav2/0/{mask}.png")]);
        assert_eq!((w, h), (width, height), "{mask}");
    }
}

#[test]
fn what_hangs_above_the_robot_leaves_the_floor_free() {
    let mut world = sample::world();
    let low = Ground::of(&world, Body { height_m: 0.3, ..Body::of(&world) }).occupancy.free.count();
    world.placements.placements.iter_mut().for_each(|p| p.pose.z += 0.4);
    let under = Ground::of(&world, Body { height_m: 0.3, ..Body::of(&world) }).occupancy.free.count();
    let high = Ground::of(&world, Body { height_m: 1.0, ..Body::of(&world) }).occupancy.free.count();
    assert!(low < under && high < under, "{low}, {under}, {high}");
}

#[test]
fn the_graph_has_ids_of_its_own_for_every_node_and_direction() {
    let files = files();
    let graph: Value = serde_json::from_slice(&files["nav2/0/route_graph.geojson"]).unwrap();
    let features = graph["features"].as_array().unwrap();
    let ids: BTreeSet<u64> = features.iter().map(|f| f["properties"]["id"].as_u64().unwrap()).collect();
    assert_eq!(ids.len(), features.len());
    let lanes: Vec<(u64, u64)> = features
        .iter()
        .filter_map(|f| Some((f["properties"]["startid"].as_u64()?, f["properties"]["endid"].as_u64()?)))
        .collect();
    assert!(!lanes.is_empty() && lanes.iter().all(|(a, b)| lanes.contains(&(*b, *a))), "there and back");
}

#[test]
fn docks_are_driven_up_to_from_free_floor() {
    let world = sample::world();
    let ground = Ground::of(&world, Body::of(&world));
    let docks = docks(&world, &ground).expect("the sample has a dock");
    for (id, dock) in docks["docks"].as_object().unwrap() {
        let [x, y, yaw] = [0, 1, 2].map(|k| dock["pose"][k].as_f64().unwrap());
        let staging = Point::new(x - STAGING_M * yaw.cos(), y - STAGING_M * yaw.sin());
        assert!(ground.clearance(staging) >= ground.radius_m(), "{id}: {staging:?}");
    }
}

#[test]
fn no_placeholder_is_left_in_the_parameters() {
    let text = String::from_utf8(files()["nav2/0/params.yaml"].clone()).unwrap();
    for word in ["ROBOT_RADIUS", "INFLATION", "FULL_SPEED", "STAGING", "START_"] {
        assert!(!text.contains(word), "{word}");
    }
}
