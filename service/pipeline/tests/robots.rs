//! What a scenario says for robots: slow floor, staging areas, the order of cleaning, rounds and their routes, a dock each,
//! and whether high and long robots fit.

#![allow(clippy::unwrap_used)] // helpers of tests are tests

use std::collections::BTreeSet;
use std::sync::atomic::AtomicBool;

use d3dgen_knowledge::clearance::door_zones;
use d3dgen_model::Point;
use d3dgen_model::domain::Shape;
use d3dgen_model::occupancy::stops_robot;
use d3dgen_model::robot_body::RobotBody;
use d3dgen_model::scenario::{Roi, RoiKind};
use d3dgen_model::world::World;
use d3dgen_pipeline::Error;
use d3dgen_pipeline::generate::{Generated, Settings, generate_world};
use d3dgen_pipeline::scene_graph::Request;
use d3dgen_plugins::Registry;

const PROMPTS: [&str; 4] = [
    "hospital ward with 8 rooms in Germany, for two delivery robots",
    "office for 20 people with a reception and two meeting rooms, for a delivery robot",
    "house with 6 rooms for a delivery robot",
    "office on 2 floors, 20 people, 2 delivery robots",
];

fn made(registry: &Registry, prompt: &str, seed: u64, robot: RobotBody) -> Result<Generated, Error> {
    let request = Request { prompt: prompt.into(), seed, robot, ..Request::default() };
    generate_world(&request, registry, &Settings::default(), &mut |_| (), &AtomicBool::new(false))
}

fn world(registry: &Registry, prompt: &str, seed: u64) -> World {
    let made = made(registry, prompt, seed, RobotBody::default()).unwrap();
    let broken: Vec<_> = made.report.rules.iter().filter(|r| !r.violations.is_empty()).collect();
    assert!(made.report.is_writable(), "{prompt}, seed {seed}: {broken:?}");
    made.world
}

fn of_kind(world: &World, kind: RoiKind) -> Vec<&Roi> {
    world.scenario.rois.iter().filter(|r| r.kind == kind).collect()
}

#[test]
fn robots_know_where_to_go_slowly_and_where_to_put_things_down() {
    let registry = Registry::builtin();
    let mut staged = 0;
    for (prompt, seed) in PROMPTS.into_iter().flat_map(|p| (0..4).map(move |s| (p, s))) {
        let world = world(&registry, prompt, seed);
        let slow = of_kind(&world, RoiKind::SpeedZone);
        assert!(slow.iter().all(|r| r.max_speed_m_s.is_some_and(|v| (0.3..=0.5).contains(&v))), "{prompt}: {slow:?}");
        // before all rooms to sleep in that open on circulation
        if prompt.starts_with("hospital") {
            assert!(slow.iter().any(|r| r.note.contains("patient_room")), "{prompt}, {seed}: {slow:?}");
        }
        let areas = of_kind(&world, RoiKind::StagingArea);
        staged += usize::from(!areas.is_empty());
        for area in areas {
            let floor = area.polygon.bounds();
            assert!(floor.area() >= 0.95 && floor.width().min(floor.height()) >= 0.79, "{prompt}: {area:?}");
            let inner = floor.grown(-0.01);
            let here = world.placements.placements.iter().filter(|p| p.room_id == area.room_id && stops_robot(p));
            for p in here {
                assert!(!p.footprint().bounds().overlaps(&inner), "{prompt}, {seed}: {} on it", p.placement_id);
            }
            let doors = world.floorplan.doors_of(&area.room_id);
            assert!(!doors.flat_map(door_zones).any(|z| z.overlaps(&inner)), "{prompt}, {seed}: {area:?}");
        }
    }
    // small wards have no floor for one that nobody has to get around
    assert!(staged >= 11, "{staged} of 16 worlds have a staging area");
    let without = world(&registry, "house with 6 rooms", 0);
    assert!(of_kind(&without, RoiKind::StagingArea).is_empty() && of_kind(&without, RoiKind::SpeedZone).is_empty());
}

#[test]
fn floor_is_cleaned_in_a_stated_order() {
    let registry = Registry::builtin();
    for prompt in PROMPTS {
        let world = world(&registry, prompt, 1);
        for level in world.floorplan.level_numbers() {
            let on_level = |r: &&&Roi| world.floorplan.room(&r.room_id).unwrap().level == level;
            let zones = of_kind(&world, RoiKind::CleaningZone);
            let zones: Vec<&&Roi> = zones.iter().filter(on_level).collect();
            let numbers: BTreeSet<u32> = zones.iter().map(|r| r.order.unwrap()).collect();
            assert_eq!(numbers, (1..=zones.len() as u32).collect(), "{prompt}");
            for zone in zones {
                let free = zone.free_area_m2.unwrap();
                assert!(free > 0.0 && free < zone.polygon.area() + 0.2, "{prompt}: {zone:?}");
            }
        }
    }
}

#[test]
fn a_round_goes_from_goal_to_goal_on_free_floor_and_home() {
    let registry = Registry::builtin();
    for (prompt, seed) in PROMPTS.into_iter().flat_map(|p| (0..2).map(move |s| (p, s))) {
        let world = world(&registry, prompt, seed);
        for task in &world.scenario.robots {
            let stops: Vec<&String> = task.goals.iter().chain(&task.dock).collect();
            assert_eq!(task.routes.iter().map(|r| &r.to).collect::<Vec<_>>(), stops, "{prompt}, {seed}");
            let mut here = Point::new(task.start.x, task.start.y);
            for route in &task.routes {
                assert!(here.distance(route.path[0]) < 1e-6, "{prompt}: {route:?}");
                let poi = world.scenario.pois.iter().find(|p| p.poi_id == route.to).unwrap();
                here = *route.path.last().unwrap();
                assert!(here.distance(Point::new(poi.pose.x, poi.pose.y)) < 1e-6, "{prompt}: {route:?}");
                let length: f64 = route.path.windows(2).map(|w| w[0].distance(w[1])).sum();
                assert!((length - route.length_m).abs() < 0.01, "{prompt}: {route:?}");
                assert!(route.clear_width_m >= 2.0 * task.robot.radius_m - 0.1, "{prompt}: {route:?}");
            }
        }
    }
}

#[test]
fn a_charging_room_has_a_dock_for_every_robot() {
    let registry = Registry::builtin();
    for prompt in [
        "10 rooms, 4 delivery robots and charging room, in Germany",
        "office with 8 rooms, 3 delivery robots and a charging room",
    ] {
        for seed in 0..4 {
            let world = world(&registry, prompt, seed);
            let robots = world.scenario.robots.len();
            let domain = registry.get(&world.scene_graph.domain).unwrap().domain();
            let room = world.floorplan.rooms.iter().find(|r| r.room_type == "robot_charging").unwrap();
            let docks = world.placements.placements.iter().filter(|p| p.room_id == room.room_id);
            let docks = docks.filter(|p| domain.object(&p.object).is_some_and(|o| o.shape == Shape::Dock)).count();
            assert!(docks >= robots, "{prompt}, seed {seed}: {docks} docks in {:.1} m2", room.net_area_m2);
            let own: BTreeSet<_> = world.scenario.robots.iter().map(|t| t.dock.clone().unwrap()).collect();
            assert_eq!(own.len(), robots, "{prompt}, seed {seed}");
        }
    }
}

#[test]
fn a_robot_higher_than_the_doors_does_not_fit() {
    let registry = Registry::builtin();
    let body = RobotBody { width_m: Some(0.5), length_m: Some(0.6), height_m: Some(2.25), ..RobotBody::default() };
    let prompt = "office with 10 rooms and a delivery robot";
    let made_so = made(&registry, prompt, 0, body).unwrap();
    let fit = &made_so.report.robot_fit[0];
    assert!(!fit.fits && fit.rooms.iter().any(|w| w.clear_height_m == Some(2.1)), "{fit:?}");
    let refused = made(&registry, prompt, 0, RobotBody { fit: true, ..body }).unwrap_err().to_string();
    assert!(refused.contains("2.25 m high") && refused.contains("--robot-height"), "{refused}");
}

#[test]
fn buildings_with_stairs_are_made_for_wide_robots() {
    let registry = Registry::builtin();
    let body =
        |width, length| RobotBody { width_m: Some(width), length_m: Some(length), fit: true, ..RobotBody::default() };
    let tried = [
        ("office on 3 floors with 3 delivery robots", 0.8, 0.8, 2),
        (PROMPTS[3], 0.7, 0.9, 1),
        (PROMPTS[3], 0.7, 0.9, 4),
    ];
    for (prompt, width, length, seed) in tried {
        let found = made(&registry, prompt, seed, body(width, length)).unwrap();
        assert!(found.report.robot_fit[0].fits, "{prompt}, seed {seed}: {:?}", found.report.robot_fit);
    }
}

#[test]
fn a_long_robot_fits_where_beds_pass() {
    let registry = Registry::builtin();
    let body = RobotBody { width_m: Some(0.95), length_m: Some(2.1), fit: true, ..RobotBody::default() };
    let found = made(&registry, "hospital ward with 8 rooms", 0, body).unwrap();
    let fit = &found.report.robot_fit[0];
    assert!(fit.fits, "{fit:?}");
    // its circle does not go through the doors of the rooms that it serves
    let doors = found.world.floorplan.doors.iter();
    let to_patients = doors.filter(|d| d.room_ids.iter().any(|id| id.starts_with("patient_room")));
    let widest = to_patients.map(|d| d.clear_width_m).fold(0.0, f64::max);
    assert!(widest < 0.95_f64.hypot(2.1), "{widest}");
}
