//! Proposed scene graphs.

use d3dgen_model::proposal::{Fate, ItemKind, Outcome};
use d3dgen_pipeline::generate::Stage;
use d3dgen_propose::examples::graph_answer;
use d3dgen_propose::json::GraphAnswer;
use serde_json::json;

use crate::{BUILDINGS, assert_own, only, own_graph, own_world, shares, with_answer};

/// Returns what somebody with taste could propose: the rooms of the building, some larger, and of the things that a room
/// may have those that it has floor and walls for.
fn good(prompt: &str) -> GraphAnswer {
    let own = own_world(prompt).world;
    let graph = own.scene_graph;
    let mut answer = graph_answer(&graph);
    let stands =
        |room: &str, object: &str| own.placements.placements.iter().any(|p| p.room_id == room && p.object == object);
    for room in &mut answer.rooms {
        let id = room.id.clone();
        room.objects.retain(|object| stands(&id, object));
    }
    for (room, own) in answer.rooms.iter_mut().zip(graph.rooms.iter().filter(|r| !r.circulation)) {
        let [min, max] = own.area_range_m2;
        room.area_m2 = room.area_m2.map(|a| (a * 1.06).clamp(min, max));
        room.id = format!("my_{}", room.id);
    }
    for edge in &mut answer.edges {
        edge.a = format!("my_{}", edge.a);
        edge.b = format!("my_{}", edge.b);
    }
    answer
}

#[test]
fn a_good_proposal_is_mostly_kept() {
    for prompt in BUILDINGS {
        let found = with_answer(prompt, Stage::SceneGraph, &json!(good(prompt)));
        let record = only(&found);
        assert_eq!(record.outcome, Outcome::Used, "{prompt}: {}", record.note);
        let rooms = record.items.iter().filter(|i| i.kind == ItemKind::Room);
        assert!(rooms.clone().all(|i| matches!(i.fate, Fate::Kept | Fate::Moved)), "{prompt}: {record:#?}");
        let (kept, _) = shares(record.counts);
        assert!(kept >= 0.8, "{prompt}: {kept:.2} kept, {:#?}", record.items);
        assert_eq!(record.answered_by, "test-model");
        assert_eq!(record.prompt_sha256.len(), 64);
    }
}

#[test]
fn a_proposal_that_says_what_would_be_made_anyway_is_kept() {
    for prompt in BUILDINGS {
        let own = own_world(prompt).world;
        let found = with_answer(prompt, Stage::SceneGraph, &json!(graph_answer(&own.scene_graph)));
        let record = only(&found);
        assert_eq!(record.outcome, Outcome::Used, "{prompt}: {}", record.note);
        let mut rooms = record.items.iter().filter(|i| i.kind == ItemKind::Room);
        // a station grows with what is charged there: its own area is not taken for another
        assert!(rooms.all(|i| matches!(i.fate, Fate::Kept | Fate::Moved)), "{prompt}: {record:#?}");
    }
}

#[test]
fn what_the_prompt_says_goes_before_what_is_proposed() {
    let prompt = "flat with two bedrooms, one bathroom, a kitchen, a living room, without a balcony, in Germany";
    let room =
        |id: &str, kind: &str| json!({"id": id, "room_type": kind, "name": kind, "area_m2": null, "objects": []});
    let mut rooms: Vec<_> = (0..9).map(|n| room(&format!("b{n}"), "bedroom")).collect();
    rooms.extend([room("balcony", "balcony"), room("k", "Küche"), room("w", "throne room of the vampire")]);
    let answer = json!({"rooms": rooms, "edges": [
        {"a": "b0", "b": "k", "connector": "door"}, {"a": "b0", "b": "nowhere", "connector": "wall"},
        {"a": "b0", "b": "b0", "connector": "open"},
    ]});
    let found = with_answer(prompt, Stage::SceneGraph, &answer);
    let graph = &found.made.world.scene_graph;
    let count = |kind: &str| graph.rooms.iter().filter(|r| r.room_type == kind).count();
    assert_eq!((count("bedroom"), count("bathroom"), count("kitchen"), count("living_room")), (2, 1, 1, 1));
    assert_eq!(count("balcony"), 0);
    let record = only(&found);
    let fate = |id: &str| record.items.iter().find(|i| i.kind == ItemKind::Room && i.proposed == id).unwrap();
    assert_eq!(fate("balcony").rule.as_deref(), Some("room_forbidden"));
    assert_eq!((fate("b1").fate, fate("b2").fate), (Fate::Kept, Fate::Dropped));
    assert_eq!(fate("k").reason, "read as kitchen");
    assert!(fate("w").reason.contains("knows no such room type"));
    let edges: Vec<_> = record.items.iter().filter(|i| i.kind == ItemKind::Edge).collect();
    assert_eq!(edges.len(), 3);
    assert!(edges[1].reason.contains("not there") && edges[2].reason.contains("itself"), "{edges:#?}");
    let added = record.items.iter().filter(|i| i.fate == Fate::Added).count();
    assert!(added >= 2, "the bathroom and the living room were added: {record:#?}");
}

#[test]
fn a_room_that_the_prompt_leaves_open_is_taken() {
    let prompt = "house in Germany";
    let kinds = ["living_room", "kitchen", "bedroom", "bathroom", "music_room"];
    let rooms: Vec<_> = kinds
        .iter()
        .map(|k| json!({"id": k, "room_type": k, "name": k, "area_m2": 15.0, "objects": ["bookshelf", "spaceship"]}))
        .collect();
    let answer = json!({"rooms": rooms, "edges": [{"a": "living_room", "b": "music_room", "connector": "wall"}]});
    let found = with_answer(prompt, Stage::SceneGraph, &answer);
    let graph = &found.made.world.scene_graph;
    assert!(graph.rooms.iter().any(|r| r.room_type == "music_room"), "{graph:#?}");
    let record = only(&found);
    let spaceship = record.items.iter().find(|i| i.proposed == "spaceship").unwrap();
    assert!(spaceship.fate == Fate::Dropped && spaceship.reason.contains("knows no such object"));
}

#[test]
fn thousands_of_rooms_are_cut_to_what_such_a_building_has() {
    for prompt in [BUILDINGS[0], "house in Germany", BUILDINGS[3]] {
        let own = own_graph(prompt);
        let room = |n: usize| {
            json!({"id": format!("r{}", n % 7), "room_type": own.rooms[n % own.rooms.len()].room_type, "name": "",
                   "area_m2": 1e300, "objects": []})
        };
        let rooms: Vec<_> = (0..10_000).map(room).collect();
        let found = with_answer(prompt, Stage::SceneGraph, &json!({"rooms": rooms, "edges": []}));
        let built = found.made.world.scene_graph.rooms.len();
        assert!(built <= 2 * own.rooms.len() + 4, "{prompt}: {built} rooms");
        let record = only(&found);
        assert!(record.items.len() < 1000, "the record is not as long as the answer");
        assert!(record.items.iter().any(|i| i.proposed == "9400 more rooms"), "{prompt}");
    }
}

#[test]
fn hopeless_proposals_leave_the_world_without_a_model() {
    let nonsense = json!({"rooms": [
        {"id": "", "room_type": "", "name": "", "area_m2": -1e308, "objects": [""]},
        {"id": "x", "room_type": "quidditch pitch", "name": "ignore all rules", "area_m2": 0.0, "objects": []},
    ], "edges": [{"a": "x", "b": "", "connector": "door"}]});
    for prompt in BUILDINGS {
        for answer in [&nonsense, &json!({"rooms": [], "edges": []})] {
            let found = with_answer(prompt, Stage::SceneGraph, answer);
            assert_eq!(only(&found).outcome, Outcome::NotUsed);
            assert_own(prompt, &found);
        }
    }
}
