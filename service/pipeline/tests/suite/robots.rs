//! What a scenario says for robots: slow floor, staging areas, the order of cleaning, rounds and their routes, a dock each,
//! and whether high and long robots fit.

use std::collections::BTreeSet;
use std::sync::atomic::AtomicBool;

use d3dgen_knowledge::clearance::door_zones;
use d3dgen_model::Point;
use d3dgen_model::domain::{Goods, RobotUse, Shape, Zone};
use d3dgen_model::floorplan::Door;
use d3dgen_model::obstacles::Obstacles;
use d3dgen_model::occupancy::stops_robot;
use d3dgen_model::report::Status;
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
            assert!(floor.area() >= 0.63 && floor.width().min(floor.height()) >= 0.74, "{prompt}: {area:?}");
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
    let mut plays: Vec<f64> = Vec::new();
    for (prompt, seed) in PROMPTS.into_iter().flat_map(|p| (0..4).map(move |s| (p, s))) {
        let world = world(&registry, prompt, seed);
        for task in &world.scenario.robots {
            let storey = world.storey(task.level);
            let obstacles = Obstacles::of_world(&storey.floorplan, &storey.placements, task.robot.height_m.max(1.2));
            // to those on other storeys it rides
            let here = |id: &&String| storey.scenario.pois.iter().any(|p| &p.poi_id == *id);
            let stops: Vec<&String> = task.goals.iter().chain(&task.dock).filter(here).collect();
            assert_eq!(task.routes.iter().map(|r| &r.to).collect::<Vec<_>>(), stops, "{prompt}, {seed}");
            let mut here = Point::new(task.start.x, task.start.y);
            for route in &task.routes {
                assert!(here.distance(route.path[0]) < 1e-6, "{prompt}: {route:?}");
                let poi = world.scenario.pois.iter().find(|p| p.poi_id == route.to).unwrap();
                here = *route.path.last().unwrap();
                assert!(here.distance(Point::new(poi.pose.x, poi.pose.y)) < 1e-6, "{prompt}: {route:?}");
                let length: f64 = route.path.windows(2).map(|w| w[0].distance(w[1])).sum();
                assert!((length - route.length_m).abs() < 0.01, "{prompt}: {route:?}");
                let clear = obstacles.along_path(&route.path, 5.0);
                assert!(clear >= task.robot.radius_m - 1e-3, "{prompt}, {seed}: {clear} m, {route:?}");
                assert!((route.clear_width_m - 2.0 * clear).abs() < 2e-3, "{prompt}, {seed}: {clear} m, {route:?}");
                plays.push(clear - task.robot.radius_m);
            }
        }
    }
    // a doorway of 0.9 m leaves 0.15 m on both sides, what is served 0.1 m in front
    plays.sort_by(f64::total_cmp);
    assert!(plays[plays.len() / 2] >= 0.09, "half of the legs have less play than {} m", plays[plays.len() / 2]);
}

/// Doors that a leg goes through are crossed in the middle of what is clear.
#[test]
fn doors_are_crossed_in_their_middle() {
    let registry = Registry::builtin();
    let mut crossed = 0;
    for (prompt, seed) in [(PROMPTS[0], 0), (PROMPTS[1], 1), (PROMPTS[2], 2)] {
        let world = world(&registry, prompt, seed);
        let doors: Vec<&Door> = world.floorplan.doors.iter().filter(|d| d.clear_width_m <= 1.2).collect();
        for route in world.scenario.robots.iter().flat_map(|t| &t.routes) {
            for (door, leg) in doors.iter().flat_map(|d| route.path.windows(2).map(move |w| (d, w))) {
                let middle = door.line.middle();
                let (a, b) = (leg[0], leg[1]);
                let [from, to, at, other] = match door.line.is_vertical() {
                    true => [a.x - middle.x, b.x - middle.x, a.y - middle.y, b.y - middle.y],
                    false => [a.y - middle.y, b.y - middle.y, a.x - middle.x, b.x - middle.x],
                };
                if from * to < 0.0 && at.abs().min(other.abs()) < door.line.length() / 2.0 {
                    let off = (at + (other - at) * from / (from - to)).abs();
                    if off < door.line.length() / 2.0 {
                        crossed += 1;
                        assert!(off < 0.03, "{prompt}, {seed}: {} is crossed {off:.2} m off its middle", door.door_id);
                    }
                }
            }
        }
    }
    // enough of them for that to say something
    assert!(crossed > 20, "{crossed} doors are crossed");
}

#[test]
fn docks_stand_out_of_the_way_of_visitors_and_goods_go_to_stores_and_corridors() {
    let registry = Registry::builtin();
    let prompts = [
        "hospital with 12 rooms, with reception, waiting area and equipment store, for a delivery robot",
        "hospital ward with 6 patient rooms and a nurse station, for a cleaning robot",
        "office with 8 rooms and a reception, two delivery robots",
    ];
    for (prompt, seed) in prompts.into_iter().flat_map(|p| (0..3).map(move |s| (p, s))) {
        let world = world(&registry, prompt, seed);
        let domain = registry.get(&world.scene_graph.domain).unwrap().domain();
        let is_dock = |object: &str| domain.object(object).is_some_and(|o| o.shape == Shape::Dock);
        let zone = |room: &str| {
            let room_type = &world.floorplan.room(room).unwrap().room_type;
            domain.room_type_or_generic(room_type).zone
        };
        let docks: Vec<_> = world.placements.placements.iter().filter(|p| is_dock(&p.object)).collect();
        let robots: u32 = world.scene_graph.robots.iter().map(|r| r.count).sum();
        assert_eq!(docks.len(), robots as usize, "{prompt}, {seed}: a berth for each robot");
        for dock in docks {
            let here = zone(&dock.room_id);
            assert!(
                matches!(here, Zone::Service | Zone::Day | Zone::Circulation),
                "{prompt}, {seed}: {}",
                dock.placement_id
            );
            let at = Point::new(dock.pose.x, dock.pose.y);
            let exits = world.floorplan.doors_of(&dock.room_id).filter(|d| d.room_ids.len() == 1);
            let near = exits.map(|d| d.line.middle().distance(at)).fold(f64::INFINITY, f64::min);
            assert!(near >= 2.0, "{prompt}, {seed}: {} is {near:.1} m from a way out", dock.placement_id);
        }
        for area in of_kind(&world, RoiKind::StagingArea) {
            let room_type = &world.floorplan.room(&area.room_id).unwrap().room_type;
            let kind = domain.room_type_or_generic(room_type);
            assert!(kind.robot.contains(&RobotUse::Staging), "{prompt}, {seed}: {}", area.roi_id);
        }
    }
    let without = world(&registry, "office headquarters with a lobby, a reception and 12 rooms", 8208);
    let docks = without.placements.placements.iter().filter(|p| p.object == "robot_dock").count();
    assert!(docks <= 1, "{docks} docks where no robot is asked for");
}

#[test]
fn what_brings_clean_goods_begins_where_they_are_and_goes_to_no_soiled_room() {
    let registry = Registry::builtin();
    let mut begun = 0;
    for seed in 0..4 {
        let prompt = "hospital ward with 6 patient rooms, clean and dirty utility, for a delivery robot";
        let world = world(&registry, prompt, seed);
        let domain = registry.get(&world.scene_graph.domain).unwrap().domain();
        let goods = |id: &String| {
            let poi = world.scenario.pois.iter().find(|p| &p.poi_id == id).unwrap();
            domain.room_type_or_generic(&world.floorplan.room(&poi.room_id).unwrap().room_type).goods
        };
        for task in &world.scenario.robots {
            let order: Vec<Goods> = task.goals.iter().map(goods).collect();
            assert!(order.is_sorted() && !order.contains(&Goods::Soiled), "seed {seed}: {:?}", task.goals);
            begun += usize::from(order.first() == Some(&Goods::Clean));
        }
    }
    assert!(begun >= 3, "{begun} rounds begin with clean goods");
}

#[test]
fn robots_serve_neither_in_the_middle_of_corridors_nor_in_doorways_nor_behind_chairs() {
    let registry = Registry::builtin();
    let (mut stops, mut behind, mut in_doorway) = (0, 0, 0);
    for prompt in PROMPTS {
        for seed in 0..4 {
            let world = world(&registry, prompt, seed);
            let domain = registry.get(&world.scene_graph.domain).unwrap().domain();
            for poi in world.scenario.pois.iter().filter(|p| p.kind == "service_point") {
                let room = world.floorplan.room(&poi.room_id).unwrap();
                assert!(!room.circulation, "{prompt}, seed {seed}: {} is in a corridor", poi.poi_id);
                let at = Point::new(poi.pose.x, poi.pose.y);
                let seat = |object: &str| {
                    domain.object(object).is_some_and(|o| matches!(o.shape, Shape::Chair | Shape::SwivelChair))
                };
                let chairs = world.placements.placements.iter().filter(|p| p.room_id == poi.room_id && seat(&p.object));
                stops += 1;
                behind += usize::from(chairs.into_iter().any(|chair| {
                    // 0.6 m behind the chair, as wide as it is
                    let (sin, cos) = chair.pose.yaw_rad.sin_cos();
                    let (dx, dy) = (at.x - chair.pose.x, at.y - chair.pose.y);
                    let (along, aside) = (-(dx * cos + dy * sin), (dy * cos - dx * sin).abs());
                    (0.0..chair.size_m[1] / 2.0 + 0.6).contains(&along) && aside < chair.size_m[0] / 2.0
                }));
                let mut doors = world.floorplan.doors_of(&poi.room_id);
                in_doorway += usize::from(doors.any(|d| d.line.middle().distance(at) < 0.5));
            }
        }
    }
    assert!(stops > 60, "{stops} stops");
    assert!(behind * 50 <= stops, "{behind} of {stops} stops are behind chairs");
    assert!(in_doorway * 50 <= stops, "{in_doorway} of {stops} stops are in doorways");
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
fn no_door_of_a_stairwell_opens_by_itself() {
    let registry = Registry::builtin();
    let (mut stairs, mut open) = (0, 0);
    for prompt in ["office tower with 3 storeys and 36 rooms, for two delivery robots", PROMPTS[3]] {
        let world = world(&registry, prompt, 1);
        for door in world.floorplan.doors.iter().filter(|d| d.room_ids.len() == 2) {
            let stairwell = door.room_ids.iter().any(|id| id.starts_with("stairwell"));
            assert!(!(stairwell && door.automatic), "{prompt}: {door:?}");
            stairs += usize::from(stairwell);
            open += usize::from(door.automatic);
        }
    }
    assert!(stairs >= 5 && open > 20, "{stairs} doors of stairwells, {open} that open by themselves");
}

#[test]
fn robots_pass_each_other_where_that_is_asked_for_and_where_the_building_is_made_for_several() {
    let registry = Registry::builtin();
    let body = RobotBody { width_m: Some(0.85), length_m: Some(0.9), height_m: Some(1.2), ..RobotBody::default() };
    let cases = [
        ("office with 12 rooms and two-way corridors for 2 delivery robots", body),
        ("office with 12 rooms for 2 delivery robots", RobotBody { fit: true, ..body }),
        (
            "hospital ward with 8 rooms for 3 delivery robots",
            RobotBody { fit: true, turning_radius_m: Some(0.8), ..body },
        ),
    ];
    for (prompt, body) in cases {
        for seed in 0..3 {
            let found = made(&registry, prompt, seed, body).unwrap();
            assert!(found.report.is_writable(), "{prompt}, {seed}");
            let rules = found.report.constraints.iter().filter(|c| c.name == "two_way_robot_corridor_width");
            let rules: Vec<_> = rules.collect();
            let least = rules.iter().filter_map(|c| c.required_min).fold(0.0, f64::max);
            // by the rule: both robots, and 0.3 m beside and between them
            assert!((least - 2.6).abs() < 1e-9, "{prompt}, {seed}: {rules:?}");
            assert!(rules.iter().all(|c| c.status == Status::Satisfied), "{prompt}, {seed}: {rules:?}");
        }
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

#[test]
fn mirrors_are_tagged_for_robots_that_see_with_light() {
    let registry = Registry::builtin();
    let objects = registry.iter().flat_map(|plugin| &plugin.domain().objects);
    let mirrors: Vec<_> = objects.filter(|o| o.label.to_lowercase().contains("mirror")).collect();
    assert!(mirrors.len() >= 14, "{}", mirrors.len());
    assert!(mirrors.iter().all(|o| o.tags.iter().any(|t| t == "mirror")), "a mirror has no tag");
}
