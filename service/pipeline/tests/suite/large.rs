//! Large buildings as their users know them: units with what they need at hand, forms that prompts ask for, ways out.

use std::collections::BTreeMap;

use crate::common::{most, worlds};
use d3dgen_knowledge::compliance::longest_way_out;
use d3dgen_model::document::Document;
use d3dgen_model::floorplan::DoorKind;
use d3dgen_model::report::Status;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::world::World;
use d3dgen_model::{Point, Polygon};
use d3dgen_pipeline::generate;
use d3dgen_pipeline::scene_graph::{self, Request};
use d3dgen_pipeline::world::check;
use d3dgen_plugins::Registry;

fn graph(prompt: &str) -> SceneGraph {
    let request = Request { prompt: prompt.into(), ..Request::default() };
    scene_graph::generate(&request, &Registry::builtin()).expect(prompt)
}

/// Returns rooms of each type by unit.
fn units(graph: &SceneGraph) -> BTreeMap<&str, BTreeMap<&str, usize>> {
    let mut out: BTreeMap<&str, BTreeMap<&str, usize>> = BTreeMap::new();
    for room in graph.rooms.iter().filter(|r| !r.circulation) {
        let unit = room.unit.as_deref().unwrap_or("none");
        *out.entry(unit).or_default().entry(&room.room_type).or_default() += 1;
    }
    out
}

fn middle(world: &World, id: &str) -> Point {
    world.floorplan.room(id).expect(id).polygon.bounds().center()
}

#[test]
fn every_unit_of_a_hospital_has_what_it_needs_at_hand() {
    for (prompt, rooms) in [("hospital with 100 rooms", 100), ("Krankenhausstation mit 60 Räumen", 60)] {
        let graph = graph(prompt);
        let counted = graph.rooms.iter().filter(|r| !r.circulation).count();
        assert_eq!(counted, rooms, "{prompt}");
        let units = units(&graph);
        assert!(units.len() >= 2 && !units.contains_key("none"), "{prompt}: {:?}", units.keys());
        for (unit, has) in units.iter().filter(|(_, has)| has.contains_key("patient_room")) {
            for needed in ["nurse_station", "clean_utility", "dirty_utility"] {
                assert!(has.contains_key(needed), "{prompt}: {unit} has no {needed}: {has:?}");
            }
        }
        let json = serde_json::to_string(&graph).unwrap();
        assert!(SceneGraph::from_json(&json).is_ok(), "{prompt}");
    }
}

#[test]
fn rooms_that_a_prompt_counts_are_dealt_out_and_not_added_to() {
    let graph = graph("hospital ward with 40 patient rooms and 70 rooms in total");
    let of = |kind: &str| graph.rooms.iter().filter(|r| r.room_type == kind).count();
    assert_eq!(graph.rooms.iter().filter(|r| !r.circulation).count(), 70);
    assert_eq!(of("patient_room"), 40);
    let units = units(&graph);
    let beds: Vec<usize> = units.values().map(|has| has.get("patient_room").copied().unwrap_or(0)).collect();
    assert!(beds.iter().all(|n| (8..=20).contains(n)), "{beds:?}");
    assert!(of("nurse_station") >= 2);
}

#[test]
fn patients_are_near_a_station() {
    for world in worlds("hospital with 100 rooms", 3) {
        let plan = &world.floorplan;
        let of = |kind: &'static str| plan.rooms.iter().filter(move |r| r.room_type == kind);
        let far: Vec<bool> = of("patient_room")
            .map(|room| {
                let p = middle(&world, &room.room_id);
                of("nurse_station").any(|s| p.distance(middle(&world, &s.room_id)) < 25.0)
            })
            .collect();
        most("patient rooms within 25 m of a station", 0.85, &far);
    }
}

#[test]
fn wards_of_twenty_rooms_spend_little_on_corridors() {
    for prompt in ["hospital ward with 20 patient rooms", "office with 30 rooms in Germany"] {
        for world in worlds(prompt, 4) {
            let area = |circulation: Option<bool>| -> f64 {
                let rooms = world.floorplan.rooms.iter();
                rooms.filter(|r| circulation.is_none_or(|c| r.circulation == c)).map(|r| r.net_area_m2).sum()
            };
            let share = area(Some(true)) / area(None);
            assert!(share < 0.32, "{prompt}, seed {}: {share:.2} of the floor is corridor", world.scene_graph.seed);
        }
    }
}

#[test]
fn forms_that_prompts_ask_for_are_built_or_missed_aloud() {
    // in how many worlds, and in how many of them at least
    let cases = [
        ("L-shaped office with 10 rooms", "angle", 4, 4),
        ("office with 14 rooms, two wings", "comb", 2, 2),
        ("Büro mit 30 Räumen mit zentralem Kern", "racetrack", 2, 2),
        ("racetrack ward with 24 patient rooms", "racetrack", 2, 2),
        ("office with 20 rooms around a courtyard", "courtyard", 2, 2),
    ];
    for (prompt, scheme, seeds, least) in cases {
        let mut built = 0;
        for world in worlds(prompt, seeds) {
            let plan = &world.floorplan;
            let told = plan.conflicts.iter().any(|c| c.code == "form_not_built");
            assert!(plan.scheme == scheme || told, "{prompt}: {} without a word", plan.scheme);
            built += u32::from(plan.scheme == scheme);
        }
        assert!(built >= least, "{prompt}: {built} of {seeds} are built as {scheme}");
    }
}

/// Returns how far apart two pieces of corridor are open to each other; `None` where they are so at one place only.
fn ring_m(world: &World) -> Option<f64> {
    let plan = &world.floorplan;
    let corridor = |id: &String| plan.room(id).is_some_and(|r| r.circulation);
    let between = plan.doors.iter().filter(|d| d.room_ids.len() == 2 && d.room_ids.iter().all(corridor));
    let open: Vec<Point> = between.filter(|d| d.kind == DoorKind::Open).map(|d| d.line.middle()).collect();
    let apart = |a: &Point| open.iter().map(|b| a.distance(*b)).fold(0.0, f64::max);
    open.iter().map(apart).reduce(f64::max).filter(|m| *m > 0.0)
}

/// Returns the floor of no room with rooms all around, m^2, counted in squares of 25 cm.
fn court_m2(world: &World) -> f64 {
    let rooms: Vec<&Polygon> = world.floorplan.rooms.iter().map(|r| &r.polygon).collect();
    let corners = rooms.iter().flat_map(|p| p.0.iter().copied());
    let all = Polygon(corners.collect()).bounds().grown(0.5);
    let (columns, rows) = ((4.0 * all.width()) as usize, (4.0 * all.height()) as usize);
    let at = |n: usize, from: f64| from + 0.25 * n as f64 + 0.13;
    let built = |i: usize, j: usize| rooms.iter().any(|p| p.contains(Point::new(at(i, all.x0), at(j, all.y0))));
    let mut free: Vec<Vec<bool>> = (0..columns).map(|i| (0..rows).map(|j| !built(i, j)).collect()).collect();
    let mut reached = vec![(0, 0)];
    while let Some((i, j)) = reached.pop() {
        if i < columns && j < rows && std::mem::take(&mut free[i][j]) {
            reached.extend([(i + 1, j), (i.wrapping_sub(1), j), (i, j + 1), (i, j.wrapping_sub(1))]);
        }
    }
    free.iter().flatten().filter(|f| **f).count() as f64 / 16.0
}

#[test]
fn one_walks_all_the_way_round_a_racetrack() {
    for prompt in
        ["racetrack hospital ward with 20 patient rooms and a nurse station", "Büro mit 30 Räumen mit Ringflur"]
    {
        for world in worlds(prompt, 4) {
            let round = ring_m(&world).unwrap_or(0.0);
            assert!(round > 2.0, "{prompt}, seed {}: no ring", world.scene_graph.seed);
        }
    }
}

#[test]
fn courtyards_that_are_asked_for_have_the_building_all_around() {
    let prompts = [
        "office with 20 rooms around a courtyard",
        "School around a central courtyard with 12 classrooms",
        "Villa with an inner courtyard, 5 bedrooms and 3 bathrooms",
    ];
    for prompt in prompts {
        for world in worlds(prompt, 3) {
            let seed = world.scene_graph.seed;
            assert!(court_m2(&world) >= 25.0, "{prompt}, seed {seed}: {} m2 of court", court_m2(&world));
            assert!(ring_m(&world).is_some(), "{prompt}, seed {seed}: one cannot walk around the court");
        }
    }
}

#[test]
fn far_ends_of_corridors_have_exits() {
    for world in worlds("office with 120 rooms in the United Kingdom", 2) {
        let exits = world.floorplan.doors.iter().filter(|d| d.room_ids.len() == 1).count();
        assert!(exits >= 4, "{exits} exits");
    }
}

#[test]
fn ways_out_that_are_longer_than_allowed_are_told() {
    let registry = Registry::builtin();
    for (prompt, seeds) in
        [("office with 120 rooms in the United Kingdom", 2), ("office with 300 rooms on 2 storeys", 1)]
    {
        for world in worlds(prompt, seeds) {
            let plugin = registry.get(&world.scene_graph.domain).expect("it was made in this domain");
            let (domain, retrieved) = (plugin.domain(), generate::retrieve(&world.scene_graph, plugin));
            let most = domain.circulation.way_out_m.expect("offices have a usual limit");
            let far = longest_way_out(&world, domain, &retrieved, 0.0).is_some_and(|(_, way)| way > most);
            let report = check(&world, domain, &retrieved);
            let mut laws =
                report.constraints.iter().filter(|c| c.mandatory && c.name.contains("travel_distance")).peekable();
            let known = laws.peek().is_some();
            let too_far = if known { laws.any(|c| c.status == Status::Violated) } else { far };
            let told = world.scene_graph.conflicts.iter().any(|c| c.code == "way_out_too_long");
            assert_eq!(told, too_far, "{prompt}, seed {}", world.scene_graph.seed);
        }
    }
}

#[test]
fn a_robot_finds_all_its_ways_around_a_hall_with_many_doors() {
    for world in worlds("house in Germany with 100 rooms, for a cleaning robot", 1) {
        for task in &world.scenario.robots {
            let wanted: Vec<&String> = task.goals.iter().chain(&task.dock).collect();
            let found: Vec<&String> = task.routes.iter().map(|r| &r.to).collect();
            assert!(wanted.len() > 60, "{} stops", wanted.len());
            assert_eq!(found, wanted, "{}", task.robot_id);
        }
    }
}
