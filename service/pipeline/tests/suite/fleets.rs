//! Fleets and robots that somebody has: a dock for each, floor they stay out of, what they load, rooms too small for them.

use std::collections::BTreeSet;
use std::sync::atomic::AtomicBool;

use d3dgen_model::domain::Shape;
use d3dgen_model::robot_body::RobotBody;
use d3dgen_model::scenario::{Roi, RoiKind};
use d3dgen_model::scene_graph::RobotRule;
use d3dgen_model::storeys::LinkKind;
use d3dgen_model::world::World;
use d3dgen_pipeline::generate::{Generated, Settings, furnish_and_check, generate_world};
use d3dgen_pipeline::scene_graph::{self, Request};
use d3dgen_plugins::Registry;

use crate::common::{most, worlds};

fn made(prompt: &str, seed: u64, robot: RobotBody) -> Generated {
    let request = Request { prompt: prompt.into(), seed, robot, ..Request::default() };
    let registry = Registry::builtin();
    generate_world(&request, &registry, &Settings::default(), &mut |_| (), &AtomicBool::new(false)).unwrap()
}

fn square(side: f64, fit: bool) -> RobotBody {
    RobotBody { width_m: Some(side), length_m: Some(side), height_m: Some(1.2), fit, ..RobotBody::default() }
}

fn docks_in<'w>(world: &'w World, registry: &Registry, room_type: &str) -> Vec<&'w str> {
    let domain = registry.get(&world.scene_graph.domain).unwrap().domain();
    let here = |id: &str| world.floorplan.room(id).is_some_and(|r| r.room_type == room_type);
    let is_dock = |object: &str| domain.object(object).is_some_and(|o| o.shape == Shape::Dock);
    let docks = world.placements.placements.iter().filter(|p| is_dock(&p.object) && here(&p.room_id));
    docks.map(|p| p.placement_id.as_str()).collect()
}

#[test]
fn each_robot_has_a_dock_of_its_own_in_the_charging_room_whatever_its_size() {
    let registry = Registry::builtin();
    let prompts = [
        "hospital ward with 6 patient rooms, a nurse station and a charging room for 3 delivery robots and a cleaning robot",
        "office with 8 rooms, 3 delivery robots and a charging room",
    ];
    let (mut own, mut inside) = (Vec::new(), Vec::new());
    for (prompt, side) in prompts.into_iter().flat_map(|p| [0.5, 0.8, 1.1].map(|side| (p, side))) {
        for seed in 0..2 {
            let world = made(prompt, seed, square(side, true)).world;
            let docks: BTreeSet<_> = world.scenario.robots.iter().filter_map(|t| t.dock.as_ref()).collect();
            let robots = world.scene_graph.robots.iter().map(|r| r.count).sum::<u32>() as usize;
            let told = world.scene_graph.conflicts.iter().any(|n| n.code == "docks_missing");
            assert!(docks.len() == robots || told, "{prompt}, {side} m, seed {seed}: {docks:?} and not said");
            own.push(docks.len() == robots);
            inside.push(docks_in(&world, &registry, "robot_charging").len() >= robots);
        }
    }
    most("fleets with a dock each", 0.9, &own);
    most("fleets that all charge in their room", 0.75, &inside);
}

#[test]
fn a_robot_that_does_not_fit_leaves_a_world_that_says_so() {
    for (prompt, width, length) in
        [("A flat with 3 bedrooms", 1.2, 1.6), ("Office with 8 rooms and a cleaning robot", 1.0, 1.2)]
    {
        let robot = RobotBody { width_m: Some(width), length_m: Some(length), ..square(1.0, false) };
        let found = made(prompt, 3, robot);
        let broken: Vec<_> = found.report.rules.iter().filter(|r| !r.violations.is_empty()).collect();
        assert!(found.report.is_writable(), "{prompt}: {broken:?}");
        let graph = &found.world.scene_graph;
        let misfit = graph.robots.iter().any(|r| r.misfit);
        assert_eq!(misfit, graph.conflicts.iter().any(|n| n.code == "robot_does_not_fit"), "{prompt}");
        if misfit {
            assert!(found.report.robot_fit.iter().all(|f| !f.fits && !f.rooms.is_empty()), "{prompt}");
        }
    }
}

#[test]
fn robots_keep_away_from_every_flight_of_stairs() {
    for prompt in ["office on 3 floors, 12 offices, 2 delivery robots", "house on two floors with a vacuum robot"] {
        for world in worlds(prompt, 2) {
            let stairs = world.floorplan.links.iter().filter(|l| l.kind == LinkKind::Stairs);
            let kept = |id: &String| world.scenario.rois.iter().any(|r| r.kind == RoiKind::KeepOut && &r.room_id == id);
            let mut flights = 0;
            for id in stairs.flat_map(|l| &l.room_ids) {
                flights += 1;
                assert!(kept(id), "{prompt}: nothing keeps robots from the steps of {id}");
            }
            assert!(flights >= 2, "{prompt}: {flights} flights");
        }
    }
}

#[test]
fn robots_keep_out_and_drive_slowly_where_the_graph_says() {
    let registry = Registry::builtin();
    let prompt = "Hospital ward with 6 patient rooms, a nurse station and a medication room, for 2 delivery robots";
    let request = Request { prompt: prompt.into(), seed: 3, ..Request::default() };
    let mut graph = scene_graph::generate(&request, &registry).unwrap();
    let of_type = |kind: &str| graph.rooms.iter().find(|r| r.room_type == kind).unwrap().id.clone();
    let (kept, slow) = (of_type("medication_room"), of_type("corridor"));
    graph.robot_rules = vec![
        RobotRule { room_id: kept.clone(), keep_out: true, max_speed_m_s: None },
        RobotRule { room_id: slow.clone(), keep_out: false, max_speed_m_s: Some(0.4) },
    ];
    let settings = Settings::default();
    let found = furnish_and_check(&graph, &registry, &settings, &mut |_| (), &AtomicBool::new(false)).unwrap();
    assert!(found.report.is_writable());
    let scenario = &found.world.scenario;
    let of = |room: &str, kind: RoiKind| -> Vec<&Roi> {
        scenario.rois.iter().filter(|r| r.room_id == room && r.kind == kind).collect()
    };
    assert_eq!(of(&kept, RoiKind::KeepOut).len(), 1);
    assert!(of(&kept, RoiKind::CleaningZone).is_empty() && of(&kept, RoiKind::ServiceZone).is_empty());
    assert!(scenario.pois.iter().all(|p| p.room_id != kept), "a stop where robots stay out");
    let zones = of(&slow, RoiKind::SpeedZone);
    assert!(!zones.is_empty() && zones.iter().all(|r| r.max_speed_m_s.is_some_and(|v| v <= 0.4)), "{zones:?}");
    let floor = found.world.floorplan.room(&slow).unwrap().net_area_m2;
    assert!(zones.iter().any(|r| (r.polygon.area() - floor).abs() < 0.1), "not all of it is slow");
}

#[test]
fn every_robot_that_brings_things_loads_them_first() {
    let prompt = "Hospital ward with 8 patient rooms, clean utility and nurse station; 2 delivery robots bring linen";
    for world in worlds(prompt, 3) {
        let clean =
            |id: &String| world.scenario.pois.iter().any(|p| &p.poi_id == id && p.room_id.starts_with("clean_utility"));
        assert!(world.scenario.pois.iter().any(|p| clean(&p.poi_id)), "nowhere to load");
        for task in &world.scenario.robots {
            assert!(task.goals.iter().any(clean), "{} loads nothing: {:?}", task.robot_id, task.goals);
            assert!(task.goals.len() > 1, "{} brings nothing: {:?}", task.robot_id, task.goals);
        }
    }
}

#[test]
fn a_storey_without_floor_for_goods_is_said() {
    let prompts = [
        "hospital ward with 8 rooms in Germany, for two delivery robots",
        "Hospital with 2 storeys, 10 patient rooms each, a lift, 2 delivery robots per floor",
        "office with 8 rooms, 6 delivery robots and a charging room",
    ];
    for world in prompts.into_iter().flat_map(|p| worlds(p, 2)) {
        let staged = world.scenario.rois.iter().any(|r| r.kind == RoiKind::StagingArea);
        let said = world.scene_graph.assumptions.iter().any(|n| n.code == "no_staging_area");
        assert!(staged || said, "{}", world.scene_graph.prompt);
    }
}
