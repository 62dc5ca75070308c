//! Proposed floorplans.

use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::proposal::{Fate, Outcome};
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_pipeline::floorplan;
use d3dgen_pipeline::generate::{Stage, retrieve};
use d3dgen_plugins::Registry;
use d3dgen_propose::examples::plan_answer;
use serde_json::json;

use crate::{BUILDINGS, assert_own, only, own_world, shares, with_answer};

/// Returns a plan of the same rooms that nobody has seen.
fn another(prompt: &str, seed: u64) -> Floorplan {
    let graph = SceneGraph { seed, ..own_world(prompt).world.scene_graph };
    let registry = Registry::builtin();
    let plugin = registry.get(&graph.domain).unwrap();
    floorplan::generate(&graph, plugin.domain(), &retrieve(&graph, plugin).limits, None).unwrap()
}

#[test]
fn a_good_plan_is_kept_to_the_centimeter() {
    for prompt in BUILDINGS {
        let plan = another(prompt, 91);
        let found = with_answer(prompt, Stage::Floorplan, &json!(plan_answer(&plan)));
        let record = only(&found);
        assert_eq!(record.outcome, Outcome::Used, "{prompt}: {}", record.note);
        let (kept, like) = shares(record.counts);
        assert!(kept >= 0.8 && like >= 0.9, "{prompt}: {kept:.2} kept, {like:.2} like it, {:#?}", record.items);
    }
}

#[test]
fn a_plan_with_gaps_and_overlaps_is_mended() {
    for prompt in BUILDINGS {
        let mut answer = plan_answer(&another(prompt, 92));
        // walls of their own for each room, one room twice as large as its place, one left out
        for room in &mut answer.rooms {
            for r in &mut room.rectangles {
                (r.x_m, r.y_m) = (r.x_m + 0.06, r.y_m + 0.06);
                (r.width_m, r.depth_m) = (r.width_m - 0.12, r.depth_m - 0.12);
            }
        }
        answer.rooms[0].rectangles[0].width_m += 0.4;
        answer.rooms.remove(1);
        let found = with_answer(prompt, Stage::Floorplan, &json!(answer));
        let record = only(&found);
        let (_, like) = shares(record.counts);
        assert!(record.outcome == Outcome::Used && like >= 0.35, "{prompt}: {} {:#?}", record.note, record.items);
        assert_eq!(record.counts.added, 1, "{prompt}");
    }
}

#[test]
fn hopeless_plans_leave_the_world_without_a_model() {
    for prompt in BUILDINGS {
        let rooms: Vec<String> = own_world(prompt).world.floorplan.rooms.iter().map(|r| r.room_id.clone()).collect();
        let all = |x: f64, y: f64, w: f64, d: f64| {
            let rects = json!([{"x_m": x, "y_m": y, "width_m": w, "depth_m": d}]);
            let outline = |id: &String| json!({"room_id": id, "rectangles": rects.clone()});
            json!({"rooms": rooms.iter().map(outline).collect::<Vec<_>>()})
        };
        let strangers = json!({"rooms": [{"room_id": "ballroom_1", "rectangles": []}]});
        for answer in [
            json!({"rooms": []}),
            strangers,
            all(0.0, 0.0, 0.0, -5.0),
            all(1e300, -1e300, 1e308, 1e308),
            all(250.0, 250.0, 0.6, 0.6),
        ] {
            let found = with_answer(prompt, Stage::Floorplan, &answer);
            let record = only(&found);
            assert_eq!(record.outcome, Outcome::NotUsed, "{prompt}: {answer}");
            assert!(record.items.iter().all(|i| matches!(i.fate, Fate::Replaced | Fate::Dropped)));
            assert_own(prompt, &found);
        }
    }
}

#[test]
fn buildings_with_several_storeys_are_not_asked_about() {
    let found = with_answer("two-storey house with three bedrooms upstairs", Stage::Floorplan, &json!({"rooms": []}));
    let record = only(&found);
    assert!(record.prompt_sha256.is_empty() && record.note.contains("storeys"), "{record:?}");
}
