//! Storeys in prompts, and cores that line up: `prompts/storeys.jsonl` says what a sensible person reads.

use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;

use d3dgen_model::Document;
use d3dgen_model::domain::Zone;
use d3dgen_model::floorplan::PlanRoom;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::storeys::LinkKind;
use d3dgen_model::world::World;
use d3dgen_pipeline::generate::{Settings, generate_world};
use d3dgen_pipeline::scene_graph::{Request, generate};
use d3dgen_plugins::Registry;
use serde::Deserialize;

/// A prompt and its storeys.
#[derive(Debug, Deserialize)]
struct Case {
    prompt: String,
    levels: Vec<i32>,
    /// By storey: room types with how many at least.
    #[serde(default)]
    on: BTreeMap<i32, BTreeMap<String, usize>>,
    #[serde(default)]
    elevator: Option<bool>,
    #[serde(default)]
    conflict: Option<String>,
}

fn request(prompt: &str, seed: u64) -> Request {
    Request { prompt: prompt.into(), seed, ..Request::default() }
}

fn misses(case: &Case, graph: &SceneGraph) -> Vec<String> {
    let mut out: Vec<String> = graph.check().iter().map(|p| format!("{p}")).collect();
    let levels = graph.level_numbers();
    if levels != case.levels {
        out.push(format!("levels {levels:?}, not {:?}", case.levels));
    }
    for (level, types) in &case.on {
        for (room_type, least) in types {
            let n = graph.rooms.iter().filter(|r| r.level == *level && &r.room_type == room_type).count();
            if n < *least {
                out.push(format!("level {level} has {n} {room_type}, not {least}"));
            }
        }
    }
    let elevator = graph.links.iter().any(|l| l.kind == LinkKind::Elevator);
    if case.elevator.is_some_and(|e| e != elevator) {
        out.push(format!("elevator: {elevator}"));
    }
    if let Some(code) = &case.conflict
        && !graph.conflicts.iter().any(|n| &n.code == code)
    {
        out.push(format!("no conflict {code}, but {:?}", graph.conflicts));
    }
    out
}

#[test]
fn prompts_say_which_rooms_are_on_which_storey() {
    let registry = Registry::builtin();
    let text = include_str!("../prompts/storeys.jsonl");
    let mut wrong = Vec::new();
    for line in text.lines() {
        let case: Case = serde_json::from_str(line).unwrap();
        match generate(&request(&case.prompt, 0), &registry) {
            Ok(graph) => wrong.extend(misses(&case, &graph).into_iter().map(|m| format!("{}: {m}", case.prompt))),
            Err(error) => wrong.push(format!("{}: {error}", case.prompt)),
        }
    }
    assert!(text.lines().count() >= 25);
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn every_storey_of_a_large_building_has_its_share_of_the_rooms() {
    let registry = Registry::builtin();
    for (prompt, storeys) in [
        ("hospital with 60 rooms on 3 storeys with lifts", 3),
        ("office tower with 5 storeys and 50 rooms", 5),
        ("hospital with 40 rooms on 3 storeys", 3),
        ("hospital on 3 storeys with lifts, for two delivery robots", 3),
        ("office building with 4 floors", 4),
        ("office for 150 people on 4 floors", 4),
        ("school with 60 rooms on 3 storeys", 3),
    ] {
        for seed in 0..3 {
            let graph = generate(&request(prompt, seed), &registry).unwrap();
            let link = |id: &String| graph.links.iter().any(|l| l.room_ids.contains(id));
            let on = |level: i32| {
                graph
                    .rooms
                    .iter()
                    .filter(move |r| r.level == level && !r.circulation && !link(&r.id))
                    .collect::<Vec<_>>()
            };
            let counts: Vec<usize> = graph.level_numbers().into_iter().map(|l| on(l).len()).collect();
            assert_eq!(counts.len(), storeys, "{prompt}");
            let all: usize = counts.iter().sum();
            assert!(counts.iter().all(|n| 2 * n * storeys >= all), "{prompt}, seed {seed}: {counts:?}");
            let wet = |id: &str| id.contains("toilet") || id.contains("restroom") || id.contains("bathroom");
            for level in graph.level_numbers() {
                assert!(on(level).iter().any(|r| wet(&r.room_type)), "{prompt}, seed {seed}: none on {level}");
            }
        }
    }
}

/// Returns the rooms of each type of a storey.
fn types_on(graph: &SceneGraph, level: i32) -> BTreeMap<&str, usize> {
    let mut out = BTreeMap::new();
    for room in graph.rooms.iter().filter(|r| r.level == level) {
        *out.entry(room.room_type.as_str()).or_default() += 1;
    }
    out
}

#[test]
fn what_all_share_is_on_the_ground_floor() {
    let registry = Registry::builtin();
    let hotel: &[&str] = &["reception", "lobby", "breakfast_room", "linen_room", "restroom"];
    for (prompt, needed) in [
        ("Hotel with 30 guest rooms on 3 storeys with a lift", hotel),
        ("Hotel with 60 guest rooms on 4 floors", hotel),
        ("Hotel on 4 storeys", hotel),
        ("Hospital on 3 storeys with lifts", &["reception", "waiting_area"]),
        ("School with 40 rooms on two storeys", &["entrance_hall", "canteen", "office"]),
        ("Ward with 24 patient rooms on two storeys", &["reception", "waiting_area"]),
        ("Museum on two floors with 8 galleries", &["lobby", "restroom"]),
        ("Care home with 40 residents on 2 storeys", &["kitchen", "reception", "office", "laundry"]),
    ] {
        for seed in 0..3 {
            let graph = generate(&request(prompt, seed), &registry).unwrap();
            let ground = types_on(&graph, 0);
            let missing: Vec<_> = needed.iter().filter(|t| !ground.contains_key(**t)).collect();
            assert!(missing.is_empty(), "{prompt}, seed {seed}: {missing:?} not among {ground:?}");
        }
    }
}

#[test]
fn every_storey_has_what_its_people_need_at_hand() {
    let registry = Registry::builtin();
    let ward: &[&str] = &["nurse_station", "dirty_utility", "clean_utility", "staff_room"];
    for (prompt, needed) in [
        ("Ward with 24 patient rooms on two storeys", ward),
        ("Hospital with 40 rooms on 3 storeys with lifts", ward),
        ("Hospital with 120 rooms on 4 storeys", &["nurse_station", "dirty_utility", "staff_room"]),
        ("Office tower with 5 storeys, a core and 60 rooms", &["toilet", "accessible_toilet", "kitchenette"]),
        ("Office tower with 5 storeys and a central core", &["toilet", "accessible_toilet", "kitchenette"]),
        (
            "Care home with 40 residents on 2 storeys",
            &["nurse_station", "day_room", "dining_room", "assisted_bathroom"],
        ),
        ("School with 40 rooms on two storeys", &["toilet", "accessible_toilet"]),
    ] {
        let graph = generate(&request(prompt, 1), &registry).unwrap();
        for level in graph.level_numbers() {
            let here = types_on(&graph, level);
            let missing: Vec<_> = needed.iter().filter(|t| !here.contains_key(**t)).collect();
            assert!(missing.is_empty(), "{prompt}, level {level}: {missing:?} not among {here:?}");
        }
        // nobody has all cubicles of a building on one storey
        let toilets = graph.rooms.iter().filter(|r| r.room_type == "toilet").map(|r| r.target_area_m2);
        let (least, most) = toilets.fold((f64::MAX, 0.0_f64), |(a, b), m2| (a.min(m2), b.max(m2)));
        assert!(most <= 2.0 * least, "{prompt}: toilets of {least} to {most} m2");
    }
}

#[test]
fn storeys_that_are_units_are_about_as_large() {
    let registry = Registry::builtin();
    for prompt in [
        "Hotel with 30 guest rooms on 3 storeys with a lift",
        "Hospital with 40 rooms on 3 storeys with lifts",
        "Hospital with 120 rooms on 4 storeys",
        "Office tower with 5 storeys and a central core",
        "Office tower with 5 storeys, a core and 60 rooms",
    ] {
        let graph = generate(&request(prompt, 1), &registry).unwrap();
        let area = |level: &i32| -> f64 {
            let rooms = graph.rooms.iter().filter(|r| r.level == *level && !r.circulation);
            rooms.map(|r| r.target_area_m2).sum()
        };
        let areas: Vec<f64> = graph.level_numbers().iter().map(area).collect();
        let (least, most) = areas.iter().fold((f64::MAX, 0.0_f64), |(a, b), m2| (a.min(*m2), b.max(*m2)));
        assert!(most <= 1.25 * least, "{prompt}: {areas:?}");
    }
}

#[test]
fn no_room_has_two_en_suites() {
    let registry = Registry::builtin();
    for prompt in [
        "Hospital with 40 rooms on 3 storeys with lifts",
        "Hospital with 60 rooms on 3 storeys",
        "Hospital with 20 rooms on 2 floors",
        "Ward with 24 patient rooms on two storeys",
        "Hotel with 30 guest rooms on 3 storeys with a lift",
        "hospital ward with 31 rooms on 2 storeys",
    ] {
        for seed in 0..4 {
            let graph = generate(&request(prompt, seed), &registry).unwrap();
            let bath =
                |id: &str| graph.room(id).is_some_and(|r| ["ensuite", "bathroom"].contains(&r.room_type.as_str()));
            for room in
                graph.rooms.iter().filter(|r| r.room_type.contains("patient_room") || r.room_type == "guest_room")
            {
                let beside = |e: &&d3dgen_model::scene_graph::GraphEdge| {
                    e.a == room.id && bath(&e.b) || e.b == room.id && bath(&e.a)
                };
                let own = graph.edges.iter().filter(beside).count();
                assert!(own < 2, "{prompt}, seed {seed}: {} has {own}", room.id);
            }
        }
    }
}

#[test]
fn stairs_are_two_where_a_rule_of_the_country_asks_for_them() {
    let registry = Registry::builtin();
    let of_kind = |graph: &SceneGraph, kind| graph.links.iter().filter(|l| l.kind == kind).count();
    for (prompt, stairs) in [
        ("Office tower with 5 storeys, a core and 60 rooms", 2),
        ("Hotel with 30 guest rooms on 3 storeys with a lift", 2),
        ("Hospital on 3 storeys with lifts", 2),
        ("Hospital with 40 rooms on 3 storeys with lifts", 2),
        ("School with 40 rooms on two storeys", 2),
        ("office with 24 rooms on 3 floors", 1),
        ("office in the US with 24 rooms on 3 floors", 2),
        ("two-storey house with 4 bedrooms", 1),
    ] {
        let graph = generate(&request(prompt, 1), &registry).unwrap();
        assert_eq!(of_kind(&graph, LinkKind::Stairs), stairs, "{prompt}");
    }
    // storeys of a few rooms have one, and say so
    let small = generate(&request("office in the US with 9 rooms on 3 floors", 1), &registry).unwrap();
    assert_eq!(of_kind(&small, LinkKind::Stairs), 1);
    assert!(
        small.conflicts.iter().any(|n| n.code == "one_stair" && n.message.contains("IBC")),
        "{:?}",
        small.conflicts
    );
    // "3 storeys with lifts" says nothing of three lifts
    let lifts = generate(&request("Hospital on 3 storeys with lifts", 1), &registry).unwrap();
    assert!(of_kind(&lifts, LinkKind::Elevator) < 3);
}

#[test]
fn robots_ride_to_other_storeys_or_the_world_says_that_they_do_not() {
    let registry = Registry::builtin();
    let world = |prompt: &str| {
        let settings = Settings::default();
        generate_world(&request(prompt, 1), &registry, &settings, &mut |_| {}, &AtomicBool::new(false)).expect(prompt)
    };
    let levels = |world: &World| -> Vec<i32> {
        let poi = |id: &String| world.scenario.pois.iter().find(|p| &p.poi_id == id);
        let goals = world.scenario.robots.iter().flat_map(|t| &t.goals).filter_map(poi);
        let mut out: Vec<i32> = goals.filter_map(|p| Some(world.floorplan.room(&p.room_id)?.level)).collect();
        out.sort_unstable();
        out.dedup();
        out
    };
    let told = |world: &World| world.scene_graph.conflicts.iter().any(|n| n.code == "robots_miss_storeys");
    let made = world("Office on 3 floors with an elevator and a cleaning robot");
    assert!(made.report.sound);
    assert_eq!((levels(&made.world), told(&made.world)), (vec![0, 1, 2], false));
    let made = world("Two-storey office with 12 rooms, no elevator, a cleaning robot");
    assert_eq!((levels(&made.world).len(), told(&made.world)), (1, true));
}

#[test]
fn cores_line_up_for_every_seed() {
    let registry = Registry::builtin();
    let prompts = [
        "two-storey house in Germany with 7 rooms",
        "office in the US with 21 rooms on 3 floors",
        "hospital with 20 rooms on 2 floors",
        "three floor office building without an elevator, 12 rooms",
    ];
    for prompt in prompts {
        for seed in 0..5 {
            let made = generate_world(
                &request(prompt, seed),
                &registry,
                &Settings::default(),
                &mut |_| {},
                &AtomicBool::new(false),
            )
            .unwrap();
            let broken: Vec<_> = made.report.rules.iter().flat_map(|r| &r.violations).collect();
            assert!(made.report.sound, "{prompt}, seed {seed}: {broken:?}");
            let plan = &made.world.floorplan;
            assert_eq!(plan.levels.len(), plan.level_numbers().len());
            assert!(!plan.links.is_empty());
            for link in &plan.links {
                assert_eq!(link.room_ids.len(), plan.levels.len(), "{prompt}, seed {seed}: {}", link.link_id);
                let outlines: Vec<_> = link.room_ids.iter().map(|id| plan.room(id).unwrap().polygon.bounds()).collect();
                for pair in outlines.windows(2) {
                    let (a, b) = (pair[0], pair[1]);
                    let off = [a.x0 - b.x0, a.y0 - b.y0, a.x1 - b.x1, a.y1 - b.y1].map(f64::abs);
                    assert!(off.iter().all(|o| *o < 1e-6), "{prompt}, seed {seed}: {} is {off:?} off", link.link_id);
                }
            }
        }
    }
}

#[test]
fn a_single_storey_house_is_a_home() {
    let graph = generate(&request("single-storey house with two bedrooms", 1), &Registry::builtin()).unwrap();
    assert_eq!((graph.domain.as_str(), graph.level_numbers()), ("residential", vec![0]));
}

#[test]
fn a_flat_on_a_storey_of_its_house_is_no_tower() {
    let registry = Registry::builtin();
    for prompt in [
        "A flat on the 5th floor with two bedrooms, living room, kitchen and bathroom, 70 m2",
        "Apartment on the third floor: living room, bedroom, kitchen, bathroom",
    ] {
        let graph = generate(&request(prompt, 1), &registry).unwrap();
        assert_eq!((graph.level_numbers(), graph.links.len()), (vec![0], 0), "{prompt}");
    }
}

#[test]
fn what_comes_from_the_street_is_on_the_ground_floor() {
    let registry = Registry::builtin();
    for (prompt, room_type) in [
        ("Restaurant op twee verdiepingen met keuken, bar, 80 zitplaatsen en een kantoor", "kitchen"),
        (
            "Fire station on two floors with vehicle hall for 3 engines, dormitory, kitchen, training room",
            "vehicle_bay",
        ),
        ("Primary school with 8 classrooms on two floors, canteen and kitchen", "kitchen"),
    ] {
        let graph = generate(&request(prompt, 1), &registry).unwrap();
        let mut rooms = graph.rooms.iter().filter(|r| r.room_type == room_type).peekable();
        assert!(rooms.peek().is_some() && rooms.all(|r| r.level == 0), "{prompt}");
    }
}

/// Returns the rooms of a storey that it is there for: all but stairs, corridors and small ones that serve others.
fn lived_in(world: &World, registry: &Registry, level: i32) -> usize {
    let domain = registry.get(&world.scene_graph.domain).expect("it is built in").domain();
    let used = |r: &&PlanRoom| {
        let kind = domain.room_type_or_generic(&r.room_type);
        let lived_in = matches!(kind.zone, Zone::Day | Zone::Night | Zone::Public | Zone::Staff);
        !kind.wet && (lived_in || !r.circulation && r.net_area_m2 > 12.0)
    };
    world.floorplan.rooms.iter().filter(|r| r.level == level).filter(used).count()
}

#[test]
fn every_storey_stands_on_the_one_below_and_is_there_for_something() {
    let registry = Registry::builtin();
    for (prompt, seed) in [
        ("Casa de dos plantas: abajo salón, cocina y aseo; arriba tres dormitorios y dos baños", 104),
        (
            "Two-storey house: downstairs a toilet and a store, upstairs living room, kitchen, four bedrooms and two bathrooms",
            3,
        ),
        ("Student house with 12 bedrooms, shared kitchen, 4 bathrooms on three floors", 134),
        ("Büro auf drei Geschossen für 60 Mitarbeiter, Empfang, Küche, sechs Besprechungsräume", 132),
        ("Terraced house, two storeys, three bedrooms, living room, kitchen, bathroom", 121),
        (
            "Three-storey house: on the ground floor a garage, on the first floor living room and kitchen, on the second floor four bedrooms and two bathrooms",
            5,
        ),
    ] {
        let request = request(prompt, seed);
        let made = generate_world(&request, &registry, &Settings::default(), &mut |_| (), &AtomicBool::new(false));
        let made = made.unwrap_or_else(|e| panic!("{prompt}: {e}"));
        assert!(made.report.sound, "{prompt}: {:?}", made.report.rules.iter().flat_map(|r| &r.violations).next());
        let storeys: Vec<usize> =
            made.world.floorplan.level_numbers().iter().map(|l| lived_in(&made.world, &registry, *l)).collect();
        assert!(storeys.iter().all(|n| *n > 0), "{prompt}: {storeys:?} rooms by storey");
    }
}

#[test]
fn what_is_added_to_what_was_asked_for_is_told_as_a_change() {
    let registry = Registry::builtin();
    let codes = |prompt: &str| {
        let graph = generate(&request(prompt, 3), &registry).unwrap();
        graph.conflicts.iter().map(|n| n.code.clone()).collect::<Vec<_>>()
    };
    let upstairs = "two-storey house with two bedrooms upstairs, a study upstairs, a bathroom upstairs, two kids rooms upstairs; a kitchen downstairs";
    let added = codes(upstairs);
    assert!(added.contains(&"rooms_added".into()) && added.contains(&"ground_floor_filled".into()), "{added:?}");
    let lift = codes("barrier-free house on two floors with three bedrooms");
    assert!(lift.contains(&"elevator_added".into()), "{lift:?}");
    let asked = codes("barrier-free house on two floors with three bedrooms and an elevator");
    assert!(!asked.contains(&"elevator_added".into()), "{asked:?}");
    let open = codes("office for 30 people: reception, boardroom for 12, server room, kitchenette and archive");
    assert!(open.contains(&"main_room".into()), "{open:?}");
}
