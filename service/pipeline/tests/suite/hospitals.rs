//! What nurses and architects object to in hospitals and clinics: what was read for the building, ways in, what a station
//! sees, where a robot charges.

use d3dgen_model::floorplan::{Door, DoorKind};
use d3dgen_model::world::World;

use crate::common::{most, worlds};

/// Returns how many rooms of a type a world has.
fn count(world: &World, kind: &str) -> usize {
    world.floorplan.rooms.iter().filter(|r| r.room_type == kind).count()
}

/// Returns the doors to outdoors of rooms of a type.
fn ways_in<'w>(world: &'w World, kind: &str) -> Vec<&'w Door> {
    let of = |id: &str| world.floorplan.room(id).is_some_and(|r| r.room_type == kind);
    world.floorplan.doors.iter().filter(|d| matches!(&d.room_ids[..], [room] if of(room))).collect()
}

#[test]
fn ambulances_have_a_way_in_of_their_own() {
    for prompt in
        ["emergency department with 6 treatment rooms", "servicio de urgencias con triaje y 8 boxes en Sevilla"]
    {
        for world in worlds(prompt, 3) {
            assert_eq!(count(&world, "ambulance_entrance"), 1, "{prompt}");
            let doors = ways_in(&world, "ambulance_entrance");
            assert!(matches!(&doors[..], [door] if !door.entrance), "{prompt}: {doors:?}");
            let main: Vec<&Door> = world.floorplan.doors.iter().filter(|d| d.entrance).collect();
            assert!(matches!(&main[..], [door] if door.kind != DoorKind::Sliding), "{prompt}: {main:?}");
        }
    }
}

#[test]
fn kinds_of_health_buildings_are_read_as_such() {
    let cases = [
        ("hospital pharmacy with 3 rooms", "pharmacy", 1),
        ("hospital pharmacy and outpatient department in Dublin", "pharmacy", 1),
        ("blood donation centre with 8 donor chairs in Dublin", "infusion_bay", 1),
        ("stroke unit with 8 monitored beds, Germany", "icu_room", 8),
        ("surgical department with 3 operating theatres", "operating_room", 3),
    ];
    for (prompt, kind, least) in cases {
        let world = worlds(prompt, 1).remove(0);
        assert!(count(&world, kind) >= least, "{prompt}: {} x {kind}", count(&world, kind));
    }
    let both = worlds("hospital pharmacy and outpatient department in Dublin", 1).remove(0);
    assert!(count(&both, "exam_room") >= 1);
}

#[test]
fn an_infectious_patient_has_a_toilet_of_the_own_room() {
    for world in worlds("infectious diseases ward with 4 isolation rooms", 2) {
        assert_eq!(count(&world, "isolation_room"), 4);
        assert_eq!(count(&world, "ensuite"), 4);
    }
}

#[test]
fn small_wards_have_a_dock_for_their_robot() {
    let mut held = Vec::new();
    for world in worlds("hospital ward with 8 rooms in Germany, for a delivery robot", 8) {
        held.push(world.placements.placements.iter().any(|p| p.object == "robot_dock"));
    }
    most("wards with a dock", 0.9, &held);
}
