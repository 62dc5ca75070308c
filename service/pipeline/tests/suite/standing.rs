//! How buildings stand and who comes where: gardens, neighbors, halls of small homes, baths of the main bedroom, corridors behind a
//! lock, and what gives way when there is no plan.

use d3dgen_model::floorplan::{Door, DoorKind};
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
