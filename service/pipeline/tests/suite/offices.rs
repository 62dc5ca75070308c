//! Offices as prompts ask for them: desks and seats where they are counted, toilets by people, rooms by their asked names.

use std::collections::BTreeMap;

use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_pipeline::scene_graph::{Request, generate};
use d3dgen_plugins::Registry;
use serde::Deserialize;

/// A prompt and what it says; what is left out is not looked at.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Case {
    prompt: String,
    /// Rooms by type.
    rooms: BTreeMap<String, usize>,
    /// People that the rooms of a type are for.
    places: BTreeMap<String, Vec<u32>>,
    /// Names that rooms have.
    names: Vec<String>,
    /// Rooms in all, circulation aside.
    total: Option<usize>,
    /// People of rooms to work in, one in those that are not told.
    desks: Option<u32>,
    staff: Option<u32>,
}

fn misread(case: &Case, graph: &SceneGraph) -> Vec<String> {
    let of = |id: &str| graph.rooms.iter().filter(|r| r.room_type == id).collect::<Vec<_>>();
    let mut out: Vec<String> = Vec::new();
    for (id, count) in &case.rooms {
        let have = of(id).len();
        out.extend((have != *count).then(|| format!("{have} {id}, not {count}")));
    }
    for (id, places) in &case.places {
        let have: Vec<u32> = of(id).iter().filter_map(|r| r.occupants).collect();
        out.extend((have != *places).then(|| format!("{id} for {have:?}, not {places:?}")));
    }
    for name in &case.names {
        let known = graph.rooms.iter().any(|r| &r.name == name);
        out.extend((!known).then(|| format!("no `{name}`")));
    }
    let rooms = graph.rooms.iter().filter(|r| !r.circulation).count();
    out.extend(case.total.filter(|n| *n != rooms).map(|n| format!("{rooms} rooms, not {n}")));
    let least = |id: &str| match id {
        "office" | "executive_office" => 1,
        "shared_office" => 2,
        "team_office" | "open_office" => 3,
        _ => 0,
    };
    let own = |r: &&d3dgen_model::scene_graph::GraphRoom| least(&r.room_type) > 0;
    let desks: u32 = graph.rooms.iter().filter(own).map(|r| r.occupants.unwrap_or(least(&r.room_type))).sum();
    out.extend(case.desks.filter(|n| *n != desks).map(|n| format!("{desks} desks, not {n}")));
    let staff = graph.occupancy.staff;
    out.extend((case.staff.is_some() && staff != case.staff).then(|| format!("staff {staff:?}")));
    out
}

#[test]
fn offices_have_the_desks_and_seats_and_rooms_asked_for() {
    let registry = Registry::builtin();
    let text = include_str!("../prompts/offices.jsonl");
    let mut wrong: Vec<String> = Vec::new();
    for line in text.lines() {
        let case: Case = serde_json::from_str(line).expect("the file is JSON lines");
        let request = Request { prompt: case.prompt.clone(), seed: 1, ..Request::default() };
        let graph = generate(&request, &registry).expect("a prompt about an office");
        wrong.extend(misread(&case, &graph).into_iter().map(|what| format!("{}: {what}", case.prompt)));
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
