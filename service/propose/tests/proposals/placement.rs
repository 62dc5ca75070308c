//! Proposed furniture.

use d3dgen_model::proposal::{Fate, Outcome};
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_pipeline::generate::{Stage, retrieve};
use d3dgen_pipeline::placement;
use d3dgen_plugins::Registry;
use d3dgen_propose::examples::furniture_answer;
use d3dgen_propose::json::FurnitureAnswer;
use serde_json::json;

use crate::{BUILDINGS, assert_own, only, own_world, shares, with_answer};

/// Returns furniture for the building that nobody has seen.
fn another(prompt: &str, seed: u64) -> FurnitureAnswer {
    let own = own_world(prompt).world;
    let graph = SceneGraph { seed, ..own.scene_graph };
    let registry = Registry::builtin();
    let plugin = registry.get(&graph.domain).unwrap();
    let limits = retrieve(&graph, plugin).limits;
    let placements = placement::generate(&graph, &own.floorplan, plugin.domain(), &limits, None).unwrap();
    furniture_answer(&placements, plugin.domain())
}

#[test]
fn good_furniture_stands_where_it_is_proposed() {
    for prompt in BUILDINGS {
        let answer = another(prompt, 501);
        let found = with_answer(prompt, Stage::Placement, &json!(answer));
        let record = only(&found);
        assert_eq!(record.outcome, Outcome::Used, "{prompt}: {}", record.note);
        let (kept, like) = shares(record.counts);
        println!("{prompt}: {kept:.2} kept, {like:.2} like it of {}", answer.objects.len());
        assert!(kept >= 0.45 && like >= 0.75, "{prompt}: {kept:.2} kept, {like:.2} like it, {:#?}", record.items);
    }
}

#[test]
fn half_good_furniture_is_moved_and_completed() {
    for prompt in BUILDINGS {
        let mut answer = another(prompt, 502);
        let all = answer.objects.len();
        for (n, object) in answer.objects.iter_mut().enumerate() {
            match n % 4 {
                0 => (object.x_m, object.y_m) = (object.x_m + 0.35, object.y_m - 0.2),
                1 => object.yaw_deg += 17.0,
                2 => (object.x_m, object.y_m) = (-4.0e5, 12.0),
                _ => {}
            }
        }
        let found = with_answer(prompt, Stage::Placement, &json!(answer));
        let record = only(&found);
        assert_eq!(record.outcome, Outcome::Used, "{prompt}: {}", record.note);
        assert!(record.counts.moved > 0 && record.counts.proposed() == all as u32, "{prompt}: {:?}", record.counts);
        let placed = &found.made.world.placements;
        assert!(placed.placements.iter().all(|p| !p.locked), "nothing is locked by a proposal");
        assert!(placed.unplaced.iter().all(|u| !u.required), "{prompt}: {:?}", placed.unplaced);
    }
}

#[test]
fn hopeless_furniture_leaves_the_world_without_a_model() {
    for prompt in BUILDINGS {
        let own = own_world(prompt).world;
        let (room, object) = (&own.floorplan.rooms[0].room_id, &own.placements.placements[0].object);
        let thing = |room: &str, object: &str, x: f64| json!({"room_id": room, "object": object, "x_m": x, "y_m": 0.0, "yaw_deg": 1e300});
        for objects in [
            json!([]),
            json!([thing("ballroom_1", object, 1.0), thing(room, "black_hole", 1.0)]),
            json!([thing(room, object, 1e300), thing(room, object, -1e9)]),
            json!((0..5000).map(|n| thing(room, "black_hole", f64::from(n))).collect::<Vec<_>>()),
        ] {
            let found = with_answer(prompt, Stage::Placement, &json!({"objects": objects}));
            let record = only(&found);
            assert_eq!(record.outcome, Outcome::NotUsed, "{prompt}: {}", record.note);
            assert!(record.items.iter().all(|i| matches!(i.fate, Fate::Replaced | Fate::Dropped)));
            assert_own(prompt, &found);
        }
    }
}

#[test]
fn a_pile_of_the_same_thing_is_spread_or_left_out() {
    for prompt in BUILDINGS {
        let own = own_world(prompt).world;
        let mut objects = Vec::new();
        for room in own.floorplan.rooms.iter().filter(|r| !r.circulation) {
            let middle = room.net_polygon.bounds().center();
            for p in own.placements.placements.iter().filter(|p| p.room_id == room.room_id) {
                objects.push(json!({"room_id": room.room_id, "object": p.object,
                                    "x_m": middle.x, "y_m": middle.y, "yaw_deg": 0.0}));
            }
        }
        let found = with_answer(prompt, Stage::Placement, &json!({"objects": objects}));
        assert!(found.made.report.sound, "{prompt}");
        println!("{prompt}: {:?}", only(&found).counts);
    }
}
