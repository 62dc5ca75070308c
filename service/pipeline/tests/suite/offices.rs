//! Offices as prompts ask for them: desks and seats where they are counted, toilets by people, rooms by their asked names.

use std::collections::BTreeMap;

use d3dgen_model::scene_graph::{GraphRoom, SceneGraph};
use d3dgen_model::storeys::LinkKind;
use d3dgen_model::world::World;
use d3dgen_pipeline::scene_graph::{Request, generate};
use d3dgen_plugins::Registry;
use serde::Deserialize;

use crate::common::worlds;

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
    let own = |r: &&GraphRoom| least(&r.room_type) > 0;
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

/// Returns the net area of each storey's rooms, corridors and stairs aside, and that of the storey.
fn storeys(world: &World) -> Vec<[f64; 2]> {
    let area = |level: i32, all: bool| -> f64 {
        let here = world.scene_graph.rooms.iter().filter(|r| r.level == level && (all || !r.circulation));
        here.filter_map(|r| world.floorplan.room(&r.id)).map(|r| r.net_polygon.area()).sum()
    };
    world.floorplan.levels.iter().map(|l| [area(l.level, false), area(l.level, true)]).collect()
}

#[test]
fn an_open_office_is_shared_out_to_storeys_of_one_size() {
    let prompt = "Dreigeschossiger Hauptsitz in Stuttgart mit 90 Arbeitsplätzen: Erdgeschoss Empfang, Cafeteria und Schulungsraum, 1. OG Großraumbüro, 2. OG Geschäftsführung mit Vorstandszimmer, Aufzug, zwei Treppenhäuser";
    for world in worlds(prompt, 2) {
        let graph = &world.scene_graph;
        let open = graph.rooms.iter().filter(|r| r.room_type == "open_office").collect::<Vec<_>>();
        let desks: Vec<u32> = open.iter().filter_map(|r| r.occupants).collect();
        assert_eq!(desks.iter().sum::<u32>(), 90, "{desks:?}");
        assert_eq!(open.len(), 3, "one a storey");
        assert!(graph.conflicts.iter().any(|n| n.code == "open_office_shared_out"));
        let sizes = storeys(&world);
        let [least, most] = [f64::min, f64::max].map(|f| sizes.iter().map(|s| s[1]).reduce(f).unwrap());
        assert!(most < 1.4 * least, "{sizes:?}");
        let stairs = graph.links.iter().filter(|l| l.kind == LinkKind::Stairs).count();
        assert_eq!(stairs, 2, "two staircases were asked for");
        let private = |id: &str| graph.room(id).is_some_and(|r| r.room_type == "executive_office");
        let boardroom = &graph.rooms.iter().find(|r| r.room_type == "conference_room").unwrap().id;
        let through = |d: &&d3dgen_model::floorplan::Door| d.room_ids.contains(boardroom);
        let doors: Vec<_> = world.floorplan.doors.iter().filter(through).collect();
        assert!(doors.iter().any(|d| !d.room_ids.iter().any(|id| private(id))), "only through somebody's office");
    }
}

#[test]
fn two_stairs_of_a_bar_stand_at_its_ends_with_little_corridor() {
    let prompt =
        "Zweigeschossiges Bürogebäude mit zwei Treppenhäusern, Empfang, 16 Einzelbüros, Besprechungsraum, Archiv";
    for world in worlds(prompt, 2) {
        let stairs: Vec<_> = world.scene_graph.rooms.iter().filter(|r| r.room_type == "stairwell").collect();
        assert_eq!(stairs.len(), 4, "two on either storey");
        let middle = |id: &str| world.floorplan.room(id).unwrap().net_polygon.bounds().center();
        for level in [0, 1] {
            let here: Vec<_> = stairs.iter().filter(|r| r.level == level).map(|r| middle(&r.id)).collect();
            assert!(here[0].distance(here[1]) > 12.0, "far apart");
        }
        for [rooms, all] in storeys(&world) {
            assert!(rooms > 0.56 * all, "{rooms:.0} of {all:.0} m2 are rooms");
        }
    }
}

#[test]
fn full_rooms_have_a_way_out_of_their_own() {
    let prompt = "Call centre in Lille on one level, 60 desks, four supervisor offices, a training room, a break room, lockers and toilets";
    for world in worlds(prompt, 3) {
        let open = &world.scene_graph.rooms.iter().find(|r| r.room_type == "open_office").unwrap().id;
        let outside: Vec<_> = world.floorplan.doors.iter().filter(|d| d.room_ids.len() == 1).collect();
        assert!(outside.len() > 1, "one way out for 60 people");
        assert!(outside.iter().any(|d| d.room_ids.contains(open)), "no way out of the room of 60");
    }
}

#[test]
fn every_storey_where_people_work_has_toilets() {
    let prompt = "Two-storey office in Leeds: downstairs reception, two consultation rooms, upstairs open office for 24 people, manager's office, meeting room for 8";
    for world in worlds(prompt, 2) {
        for level in [0, 1] {
            let here = |r: &&GraphRoom| r.level == level && r.room_type.contains("toilet");
            assert!(world.scene_graph.rooms.iter().any(|r| here(&r)), "no toilet on level {level}");
        }
    }
}

#[test]
fn who_sits_back_to_back_has_floor_to_get_up_on() {
    let (mut backs, mut desks) = (0, 0);
    for prompt in
        ["office with 8 rooms and a team office", "office with 10 rooms in Canada", "two team offices, each for 5"]
    {
        for world in worlds(prompt, 5) {
            let here: Vec<_> = world.placements.placements.iter().filter(|p| p.object == "desk").collect();
            desks += here.len();
            for (i, a) in here.iter().enumerate() {
                for b in &here[i + 1..] {
                    let (sin, cos) = a.pose.yaw_rad.sin_cos();
                    let (dx, dy) = (b.pose.x - a.pose.x, b.pose.y - a.pose.y);
                    // ahead of a desk is who works at it
                    let (ahead, aside) = (dx * cos + dy * sin, (dy * cos - dx * sin).abs());
                    let facing = (a.pose.yaw_rad - b.pose.yaw_rad).cos() < -0.99;
                    let between = ahead - (a.size_m[1] + b.size_m[1]) / 2.0;
                    if a.room_id == b.room_id && facing && aside < 1.0 && (0.1..3.0).contains(&between) {
                        backs += 1;
                        assert!(
                            between >= 1.79,
                            "{prompt}: {between:.2} m between {} and {}",
                            a.placement_id,
                            b.placement_id
                        );
                    }
                }
            }
        }
    }
    assert!(backs >= 10 && desks > 100, "{backs} pairs of {desks} desks sit back to back");
}

#[test]
fn who_serves_at_a_counter_has_room_behind_it() {
    let prompt = "Tax office on one level: service hall with 6 counters, waiting area for 30, six two-person offices, archive, staff room, toilets";
    let mut free: Vec<bool> = Vec::new();
    for world in worlds(prompt, 3) {
        for p in world.placements.placements.iter().filter(|p| p.object == "teller_counter") {
            let room = world.floorplan.room(&p.room_id).expect("a counter stands in a room");
            let back = p.size_m[1].min(p.size_m[0]) / 2.0 + 1.1;
            let (sin, cos) = p.pose.yaw_rad.sin_cos();
            let behind = d3dgen_model::Point::new(p.pose.x - back * cos, p.pose.y - back * sin);
            free.push(room.net_polygon.contains(behind));
        }
    }
    crate::common::most("1.1 m behind counters", 0.95, &free);
}

#[test]
fn those_who_work_behind_a_public_hall_do_not_cross_it() {
    let prompts = [
        "Agence bancaire de plain-pied : hall d'accueil avec trois guichets, quatre bureaux de conseillers, bureau du directeur, salle de pause, sanitaires",
        "Law firm on one floor: client waiting area with reception, six private offices, library, conference room, break room, toilets",
    ];
    let registry = Registry::builtin();
    for prompt in prompts {
        let request = Request { prompt: prompt.into(), seed: 1, ..Request::default() };
        let graph = generate(&request, &registry).expect("a prompt about an office");
        let corridor = &graph.rooms.iter().find(|r| r.circulation).expect("rooms at a corridor").id;
        for id in ["lobby", "counter_hall", "banking_hall", "waiting_area", "reception"] {
            for room in graph.rooms.iter().filter(|r| r.room_type == id) {
                let own = |e: &&d3dgen_model::scene_graph::GraphEdge| {
                    e.required && (e.a == room.id && &e.b == corridor || e.b == room.id && &e.a == corridor)
                };
                assert!(graph.edges.iter().any(|e| own(&e)), "{prompt}: {} lies behind another room", room.id);
            }
        }
    }
}
