//! Corridors and what lies along them: rooms on both sides, numbers in the order in which one finds them, toilets on every
//! storey, theatres behind a lobby.

use d3dgen_model::world::World;

use crate::common::{most, worlds};

/// Returns the share of the long walls of a building's corridors that are outer walls; both sides of a stretch count.
fn idle(world: &World) -> f64 {
    let is_corridor =
        |id: &str| world.floorplan.room(id).is_some_and(|r| matches!(r.room_type.as_str(), "corridor" | "hallway"));
    let (mut idle, mut all) = (0.0, 0.0);
    for wall in &world.floorplan.walls {
        if wall.room_ids.iter().any(|id| is_corridor(id)) {
            all += wall.line.length();
            idle += if wall.exterior { wall.line.length() } else { 0.0 };
        }
    }
    idle / f64::max(all, 1.0)
}

#[test]
fn corridors_of_offices_have_rooms_on_both_sides() {
    let prompts = [
        "Law firm in London: reception, 6 partner offices, library, boardroom for 14",
        "coworking space in Lisbon with hot desks for 30, four phone booths and a cafe",
        "open-plan office for 40 people with a meeting room, kitchenette and server room in Cologne",
        "headquarters office with 10 rooms in Paris",
    ];
    let mut held = Vec::new();
    for prompt in prompts {
        held.extend(worlds(prompt, 6).iter().map(|world| idle(world) < 0.4));
    }
    most("corridors with rooms on both sides", 0.75, &held);
}

#[test]
fn numbers_of_patient_rooms_run_along_the_corridor() {
    let mut held = Vec::new();
    for prompt in ["ward with 12 single patient rooms in Barcelona", "hospital ward with 10 patient rooms in Germany"] {
        for world in worlds(prompt, 4) {
            let mut rooms: Vec<(u32, d3dgen_model::Point)> = Vec::new();
            for room in world.floorplan.rooms.iter().filter(|r| r.room_type == "patient_room") {
                let number =
                    world.scene_graph.room(&room.room_id).and_then(|r| r.name.rsplit(' ').next()?.parse().ok());
                rooms.push((number.unwrap(), room.polygon.bounds().center()));
            }
            rooms.sort_by_key(|(number, _)| *number);
            assert!(rooms.len() >= 8, "{prompt}: {}", rooms.len());
            let mean = |ways: Vec<f64>| ways.iter().sum::<f64>() / ways.len() as f64;
            let next = mean(rooms.windows(2).map(|w| w[0].1.distance(w[1].1)).collect());
            let any = mean(rooms.iter().flat_map(|a| rooms.iter().map(move |b| a.1.distance(b.1))).collect());
            held.push(next < 0.8 * any);
        }
    }
    most("wards where one number leads to the next", 0.9, &held);
}

#[test]
fn every_storey_of_an_office_has_a_toilet() {
    for world in worlds("office building with 3 storeys for 40 people in Frankfurt", 2) {
        for level in &world.floorplan.levels {
            let toilets =
                world.floorplan.rooms.iter().filter(|r| r.level == level.level && r.room_type.ends_with("toilet"));
            assert!(toilets.count() > 0, "level {}", level.level);
        }
    }
}

#[test]
fn theatres_do_not_open_to_the_public_corridor() {
    for world in worlds("surgical department with 3 operating theatres and recovery in Chicago", 3) {
        let is = |id: &String, kind: &str| world.floorplan.room(id).is_some_and(|r| r.room_type == kind);
        let theatres = world.floorplan.doors.iter().filter(|d| d.room_ids.iter().any(|id| is(id, "operating_room")));
        let mut seen = 0;
        for door in theatres {
            seen += 1;
            assert!(!door.room_ids.iter().any(|id| is(id, "corridor")), "{}", door.door_id);
        }
        assert!(seen >= 3, "{seen}");
    }
}
