//! How buildings stand and who comes where: gardens, neighbors, halls of small homes, baths of the main bedroom, corridors behind a
//! lock, and what gives way when there is no plan.

use d3dgen_model::floorplan::{Door, DoorKind, PlanRoom};
use d3dgen_model::world::World;

use crate::common::{most, rooms, worlds};

fn way_out<'w>(world: &'w World, room_id: &str) -> Option<&'w Door> {
    world.floorplan.doors.iter().find(|d| !d.entrance && d.room_ids == [room_id.to_owned()])
}

#[test]
fn a_house_has_a_door_from_where_one_lives_to_its_garden() {
    let mut held = Vec::new();
    for prompt in
        ["house with three bedrooms", "Family home with 4 bedrooms, 2 bathrooms and a kitchen", "Two-storey villa"]
    {
        for world in worlds(prompt, 5) {
            let lived = ["living_room", "family_room", "dining_room", "living_kitchen", "sunroom"];
            let doors = lived.iter().flat_map(|kind| rooms(&world, kind)).filter_map(|r| way_out(&world, &r.room_id));
            held.push(doors.filter(|d| d.kind == DoorKind::DoubleHinged).count() == 1);
        }
    }
    most("houses with a door to the garden", 0.85, &held);
    // what lies on another floor has none
    for world in worlds("flat with three bedrooms", 4) {
        assert!(world.floorplan.rooms.iter().all(|r| way_out(&world, &r.room_id).is_none()), "{}", world.name);
    }
}

#[test]
fn a_small_home_has_no_hall() {
    for world in
        ["studio apartment of 30 m2 with a kitchenette", "Tiny house of 24 m2"].iter().flat_map(|p| worlds(p, 4))
    {
        assert_eq!(rooms(&world, "hallway").count(), 0, "{}", world.scene_graph.prompt);
    }
    for world in worlds("one-bedroom apartment of 55 m2", 2) {
        assert_eq!(rooms(&world, "hallway").count(), 1);
    }
}

#[test]
fn of_two_bathrooms_the_main_bedroom_has_one() {
    for world in worlds("flat with three bedrooms, two bathrooms, a living room and a kitchen", 4) {
        let beds: Vec<&String> = rooms(&world, "bedroom").map(|r| &r.room_id).collect();
        let own = |d: &&Door| {
            d.room_ids.iter().any(|id| beds.contains(&id)) && d.room_ids.iter().any(|id| id.starts_with("bathroom"))
        };
        assert_eq!(world.floorplan.doors.iter().filter(own).count(), 1, "seed {}", world.scene_graph.seed);
    }
}

#[test]
fn a_flat_has_no_windows_at_its_neighbors() {
    let mut held = Vec::new();
    for prompt in ["flat with three bedrooms", "one-bedroom apartment", "studio apartment"] {
        for world in worlds(prompt, 4) {
            let upright = world.floorplan.windows.iter().filter(|w| w.line.is_vertical()).count();
            held.push(upright == 0 || upright == world.floorplan.windows.len());
        }
    }
    most("flats with windows on two sides at most", 0.9, &held);
}

#[test]
fn operating_rooms_are_not_on_the_corridor_of_visitors() {
    let mut held = Vec::new();
    for world in worlds("Surgical department with three operating rooms, recovery and a waiting area", 4) {
        let plan = &world.floorplan;
        let joined =
            |a: &str, b: &str| plan.doors.iter().any(|d| [a, b].iter().all(|x| d.room_ids.iter().any(|id| id == x)));
        let ways: Vec<_> = plan.rooms.iter().filter(|r| r.circulation).collect();
        let inner = ways.iter().find(|r| r.name == "Restricted corridor");
        let Some(inner) = inner else {
            held.push(false);
            continue;
        };
        let public = plan.rooms.iter().filter(|r| ["reception", "waiting_area"].contains(&r.room_type.as_str()));
        assert!(public.into_iter().all(|r| !joined(&r.room_id, &inner.room_id)));
        held.push(rooms(&world, "scrub_room").all(|r| joined(&r.room_id, &inner.room_id)));
    }
    most("surgeries with a restricted corridor", 0.75, &held);
}

#[test]
fn a_ward_of_double_rooms_has_one_station_at_its_corridor() {
    let world = &worlds("A ward of 24 beds in double rooms with nurse station", 1)[0];
    assert_eq!(rooms(world, "patient_room_double").count(), 12);
    assert!((1..=2).contains(&rooms(world, "nurse_station").count()));
}

#[test]
fn nobody_lives_behind_motors() {
    for world in worlds("two-bedroom flat for a cleaning robot", 3) {
        assert!(world.floorplan.doors.iter().all(|d| !d.automatic));
    }
}

/// Returns how much of the rectangle around a storey it leaves open, 0 to 1.
fn open_share(world: &World, level: i32) -> f64 {
    let here = || world.floorplan.rooms.iter().filter(|r| r.level == level);
    let around = here().map(|r| r.polygon.bounds()).reduce(|a, b| a.union(&b)).expect("it has rooms");
    1.0 - here().map(|r| r.polygon.area()).sum::<f64>() / around.area()
}

#[test]
fn what_stands_between_neighbors_fills_its_plot() {
    let mut held = Vec::new();
    for prompt in ["Terraced house, two floors, three bedrooms, 110 m2", "flat with two bedrooms and a study"] {
        for world in worlds(prompt, 5) {
            let levels = world.floorplan.level_numbers();
            held.push(levels.iter().all(|level| open_share(&world, *level) <= 0.06));
        }
    }
    most("storeys between neighbors without a notch", 0.8, &held);
}

#[test]
fn lorries_come_to_one_side_of_a_warehouse() {
    let mut held = Vec::new();
    for prompt in
        ["Warehouse of 1500 m2 with five loading docks and an office", "Lagerhalle mit drei Laderampen, 900 m2"]
    {
        for world in worlds(prompt, 4) {
            let docks: Vec<&String> = rooms(&world, "loading_dock").map(|r| &r.room_id).collect();
            let gates = world.floorplan.doors.iter().filter(|d| matches!(&d.room_ids[..], [id] if docks.contains(&id)));
            let sides: Vec<(bool, f64)> = gates.map(|d| (d.line.is_vertical(), d.line.span().0)).collect();
            assert!(docks.len() >= 3 && sides.len() >= docks.len(), "{prompt}: {} gates", sides.len());
            held.push(sides.iter().all(|s| s.0 == sides[0].0 && (s.1 - sides[0].1).abs() < 6.0));
        }
    }
    most("warehouses with their gates in one row", 0.85, &held);
}

#[test]
fn where_no_bed_rolls_corridors_are_for_people() {
    let width = |world: &World| {
        let straight = world.floorplan.rooms.iter().filter(|r| r.circulation && r.net_polygon.corners().len() == 4);
        straight.map(|r| r.net_polygon.bounds()).map(|b| b.width().min(b.height())).fold(0.0, f64::max)
    };
    for prompt in ["Dental practice with four treatment rooms", "Physiotherapiepraxis mit fünf Behandlungsräumen"] {
        for world in worlds(prompt, 3) {
            let floor = |rooms: &mut dyn Iterator<Item = &PlanRoom>| rooms.map(|r| r.net_area_m2).sum::<f64>();
            let plan = &world.floorplan.rooms;
            let share = floor(&mut plan.iter().filter(|r| r.circulation)) / floor(&mut plan.iter());
            assert!(width(&world) < 2.2 && share < 0.2, "{prompt}: {:.2} m, {share}", width(&world));
        }
    }
    let wards: Vec<f64> = worlds("Ward with three single rooms", 4).iter().map(width).collect();
    assert!(wards.iter().all(|w| *w == 0.0 || *w >= 2.4) && wards.iter().any(|w| *w > 0.0), "{wards:?}");
}

#[test]
fn nobody_goes_through_a_bedroom_to_the_bath_of_their_storey() {
    for prompt in [
        "House on two storeys with a living room, a kitchen, three bedrooms, two bathrooms and a guest toilet",
        "Casa su due piani con quattro camere, due bagni e un bagno di servizio",
    ] {
        for world in worlds(prompt, 4) {
            let plan = &world.floorplan;
            let opens = |id: &str| {
                let doors = || plan.doors_of(id).flat_map(|d| &d.room_ids).filter(|other| *other != id);
                doors().any(|other| plan.room(other).is_some_and(|r| r.circulation))
            };
            for level in plan.level_numbers() {
                let here = |kind: &'static str| rooms(&world, kind).filter(move |r| r.level == level);
                let served = ["bathroom", "shower_room"].iter().flat_map(|kind| here(kind)).any(|r| opens(&r.room_id));
                assert!(served || here("bedroom").count() < 2, "{prompt}: level {level}");
            }
        }
    }
}

#[test]
fn one_robot_has_one_dock() {
    for prompt in [
        "flat with two living rooms and three bedrooms for a robot vacuum",
        "Villa mit Wohnzimmer, Familienzimmer und Saugroboter",
    ] {
        for world in worlds(prompt, 3) {
            let docks = world.placements.placements.iter().filter(|p| p.object.contains("dock")).count();
            assert_eq!(docks, 1, "{prompt}");
        }
    }
}

#[test]
fn what_belongs_to_a_private_room_is_beside_it_and_locks_are_before_theirs() {
    let joined = |world: &World, a: &str, b: &str| {
        let ids = |kind: &str| rooms(world, kind).map(|r| r.room_id.clone()).collect::<Vec<_>>();
        let (a, b) = (ids(a), ids(b));
        let of = |d: &Door, all: &[String]| d.room_ids.iter().any(|id| all.contains(id));
        world.floorplan.doors.iter().any(|d| of(d, &a) && of(d, &b))
    };
    // worlds are sound, or they are none
    for world in worlds("Veterinary clinic with two exam rooms, a surgery with a preparation room, and reception", 2) {
        assert!(joined(&world, "theatre_preparation_room", "corridor"), "{}", world.scene_graph.prompt);
    }
    for world in worlds("Psychiatric ward with eight single rooms and a seclusion room with an anteroom", 2) {
        assert!(joined(&world, "seclusion_room", "anteroom") && joined(&world, "anteroom", "corridor"));
        assert!(!joined(&world, "seclusion_room", "corridor"));
    }
}
