//! The form of buildings: what is asked for is built, courts can be entered, wards keep their stations near the beds.

use crate::common::{most, worlds, worlds_of};
use d3dgen_knowledge::compliance::longest_way_out;
use d3dgen_knowledge::travel::Distances;
use d3dgen_model::Point;
use d3dgen_model::domain::Privacy;
use d3dgen_model::floorplan::Door;
use d3dgen_model::occupancy::Occupancy;
use d3dgen_model::world::World;
use d3dgen_pipeline::generate;
use d3dgen_plugins::Registry;

/// Prompts of buildings around courts.
const AROUND_COURTS: [&str; 4] = [
    "office with 20 rooms around a courtyard",
    "School around a central courtyard with 12 classrooms",
    "Villa with an inner courtyard, 5 bedrooms and 3 bathrooms",
    "racetrack hospital ward with 24 patient rooms and 2 nurse stations",
];

/// Returns the doors that lead outdoors and not out of the building.
fn court_doors(world: &World) -> Vec<Door> {
    let plan = &world.floorplan;
    let out = plan.ways_out();
    let outdoors = plan.doors.iter().filter(|d| d.room_ids.len() == 1);
    outdoors.filter(|d| !out.iter().any(|o| o.door_id == d.door_id)).cloned().collect()
}

/// Returns how many corners of the building turn inwards.
fn reflex_corners(world: &World) -> usize {
    let (plan, courts) = (&world.floorplan, world.floorplan.courts());
    let lines = |of: fn(&Point) -> f64| {
        let mut all: Vec<f64> = plan.rooms.iter().flat_map(|r| r.polygon.corners()).map(of).collect();
        all.sort_by(f64::total_cmp);
        all.dedup();
        all
    };
    let (xs, ys) = (lines(|p| p.x), lines(|p| p.y));
    let is_outdoors = |p: Point| {
        let built = plan.rooms.iter().any(|r| r.polygon.contains(p));
        !built && !courts.iter().any(|c| c.contains(p))
    };
    let corners = xs.iter().flat_map(|&x| ys.iter().map(move |&y| (x, y)));
    let around = corners.map(|(x, y)| {
        let quarters = [(-0.01, -0.01), (0.01, -0.01), (-0.01, 0.01), (0.01, 0.01)];
        quarters.iter().filter(|(dx, dy)| is_outdoors(Point::new(x + dx, y + dy))).count()
    });
    around.filter(|outdoors| *outdoors == 1).count()
}

/// Returns the share of the rectangle around a building that it fills.
fn filled(world: &World) -> f64 {
    let rooms = &world.floorplan.rooms;
    let around = rooms.iter().map(|r| r.polygon.bounds()).reduce(|a, b| a.union(&b)).expect("rooms");
    rooms.iter().map(|r| r.polygon.area()).sum::<f64>() / around.area()
}

fn is_told(world: &World) -> bool {
    world.floorplan.conflicts.iter().any(|c| c.code == "form_not_built")
}

#[test]
fn every_court_has_a_door_from_a_corridor_or_a_room_for_all() {
    let registry = Registry::builtin();
    for prompt in AROUND_COURTS {
        for world in worlds(prompt, 3) {
            let (plan, seed) = (&world.floorplan, world.scene_graph.seed);
            let domain = registry.get(&world.scene_graph.domain).expect("it was made in this domain").domain();
            let doors = court_doors(&world);
            for court in plan.courts() {
                let on = |d: &&Door| court.contains(d.line.middle());
                let wanted = if court.area_m2() >= 150.0 { 2 } else { 1 };
                let found = doors.iter().filter(on).count();
                assert_eq!(found, wanted, "{prompt}, seed {seed}: doors to {:.0} m2", court.area_m2());
            }
            for door in &doors {
                let room = plan.room(&door.room_ids[0]).expect("doors have rooms");
                let private = domain.room_type_or_generic(&room.room_type).privacy == Privacy::Private;
                assert!(room.circulation || !private, "{prompt}, seed {seed}: from {}", room.room_id);
            }
        }
    }
}

#[test]
fn doors_to_courts_are_no_ways_out() {
    let registry = Registry::builtin();
    for prompt in AROUND_COURTS {
        for world in worlds(prompt, 3) {
            let plugin = registry.get(&world.scene_graph.domain).expect("it was made in this domain");
            let retrieved = generate::retrieve(&world.scene_graph, plugin);
            let courts = court_doors(&world);
            let mut without = world.clone();
            without.floorplan.doors.retain(|d| !courts.iter().any(|c| c.door_id == d.door_id));
            assert!(without.floorplan.doors.len() < world.floorplan.doors.len(), "{prompt}");
            assert!(!without.floorplan.ways_out().is_empty(), "{prompt}");
            let way = |world: &World| longest_way_out(world, plugin.domain(), &retrieved, 0.0).map(|(_, way)| way);
            let (with, without) = (way(&world).unwrap_or(0.0), way(&without).unwrap_or(0.0));
            assert!((with - without).abs() < 0.2, "{prompt}: {with:.1} m, {without:.1} m without doors to courts");
        }
    }
}

#[test]
fn rooms_lie_on_all_sides_of_a_court() {
    let mut closings = Vec::new();
    let mut sides = Vec::new();
    for prompt in &AROUND_COURTS[..2] {
        for world in worlds(prompt, 3) {
            let plan = &world.floorplan;
            let corridors = || plan.rooms.iter().filter(|r| r.circulation);
            let least = corridors().map(|r| r.net_area_m2).fold(f64::MAX, f64::min);
            // a leg of corridor with a door to nothing but others is a way along a facade
            closings.push(least < 12.0);
            let Some(court) = plan.courts().into_iter().next() else { continue };
            let c = court.bounds().center();
            let around = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)];
            let served = around.iter().filter(|(dx, dy)| {
                let ahead = |k: i32| Point::new(c.x + dx * 0.5 * f64::from(k), c.y + dy * 0.5 * f64::from(k));
                let met = (1..200).map(ahead).filter_map(|p| plan.rooms.iter().find(|r| r.polygon.contains(p)));
                met.into_iter().any(|r| !r.circulation)
            });
            sides.push(served.count() == 4);
        }
    }
    most("rings of corridors that a short piece closes", 1.0, &closings);
    most("courts with rooms on all sides", 0.8, &sides);
}

#[test]
fn no_window_looks_into_a_shaft() {
    let prompts =
        ["Care home for 16 residents with cleaning robots", "L-shaped office with 16 rooms", AROUND_COURTS[0]];
    for prompt in prompts {
        for world in worlds_of(prompt, 33..37) {
            let (plan, seed) = (&world.floorplan, world.scene_graph.seed);
            for court in plan.courts() {
                let around = court.bounds();
                let on = |at: Point| [-0.05, 0.05].iter().any(|by| court.contains(Point::new(at.x + by, at.y + by)));
                let windows = plan.windows.iter().filter(|w| on(w.line.middle())).count();
                let doors = plan.doors.iter().filter(|d| d.room_ids.len() == 1 && on(d.line.middle())).count();
                let width = around.width().min(around.height());
                assert!(width >= 5.0 || windows + doors == 0, "{prompt}, seed {seed}: a court {width:.1} m wide");
            }
        }
    }
}

#[test]
fn an_l_that_is_asked_for_has_one_corner_that_turns_inwards() {
    for (prompt, seeds) in [("L-shaped house with 10 rooms", 6), ("L-shaped office with 10 rooms", 4)] {
        let mut built = Vec::new();
        for world in worlds(prompt, seeds) {
            let corners = reflex_corners(&world);
            let seed = world.scene_graph.seed;
            assert!(corners == 1 || is_told(&world), "{prompt}, seed {seed}: {corners} corners without a word");
            built.push(corners == 1);
        }
        most(prompt, 0.8, &built);
    }
}

#[test]
fn wings_that_are_asked_for_lie_side_by_side() {
    for world in worlds("office with wings, 40 rooms", 3) {
        let (seed, filled) = (world.scene_graph.seed, filled(&world));
        assert!(filled < 0.85 || is_told(&world), "seed {seed}: {filled:.2} of the rectangle around it is built");
    }
}

#[test]
fn a_compact_building_has_no_notches() {
    let compact: Vec<bool> = worlds("compact flat with 2 bedrooms", 6).iter().map(|w| filled(w) > 0.97).collect();
    most("compact flats that fill the rectangle around them", 0.8, &compact);
}

#[test]
fn no_bed_of_a_ward_with_two_stations_is_far_from_both() {
    let mut near = Vec::new();
    for world in worlds(AROUND_COURTS[3], 3) {
        let plan = &world.floorplan;
        let doors = |kind: &str| -> Vec<Point> {
            let rooms = plan.rooms.iter().filter(|r| r.room_type == kind);
            rooms.flat_map(|r| plan.doors_of(&r.room_id)).map(|d| d.line.middle()).collect()
        };
        let map = Occupancy::of_world(plan, &world.placements);
        let ways = Distances::from(&map, &doors("nurse_station"));
        let beds = plan.rooms.iter().filter(|r| r.room_type == "patient_room");
        let own = beds.map(|bed| plan.doors_of(&bed.room_id).filter_map(|d| ways.at(&map, d.line.middle())));
        near.extend(own.map(|ways| ways.reduce(f64::min).is_some_and(|way| way <= 22.0)));
    }
    most("patient rooms within 22 m of a station", 0.75, &near);
}
