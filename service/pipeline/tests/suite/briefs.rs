//! What a prompt says in words that only the brief reads, in the finished world.

use d3dgen_model::world::World;

use crate::common::{count, worlds};

fn world(prompt: &str) -> World {
    worlds(prompt, 1).remove(0)
}

#[test]
fn the_door_to_the_garden_is_in_the_room_that_is_to_have_it() {
    for prompt in [
        "detached house with a kitchen with a garden door, living room, two bedrooms and a bathroom",
        "Haus mit Küche mit Gartentür, Wohnzimmer, zwei Schlafzimmern und Bad",
        "casa indipendente con cucina con porta sul giardino, soggiorno, due camere e un bagno",
    ] {
        let world = world(prompt);
        let plan = &world.floorplan;
        let room = |id: &str| plan.room(id).map(|r| r.room_type.as_str());
        let doors = plan.doors.iter().filter(|d| d.room_ids.len() == 1 && !d.entrance);
        let kitchens = doors.filter(|d| room(&d.room_ids[0]).is_some_and(|t| t.contains("kitchen"))).count();
        assert_eq!(kitchens, 1, "{prompt}");
    }
}

#[test]
fn tills_are_no_rooms() {
    for (prompt, tills) in [
        ("Supermarkt met 5 kassa's, magazijn en kantoor", 5),
        ("Supérette avec 3 caisses, boucherie et réserve", 3),
        ("supermarket with 4 tills, a stock room and an office", 4),
    ] {
        let world = world(prompt);
        let stand = world.placements.placements.iter().filter(|p| p.object == "checkout_counter").count();
        assert_eq!(stand, tills, "{prompt}");
        let rooms = world.scene_graph.rooms.iter().filter(|r| r.room_type == "checkout").count();
        assert!(rooms <= 1, "{prompt}: {rooms} rooms to pay in");
    }
}

#[test]
fn halls_have_the_seats_that_are_told_of_each() {
    for prompt in [
        "cinema with two screens, 120 and 60 seats, a foyer and toilets",
        "кинотеатр с двумя залами на 120 и 60 мест, фойе и туалеты",
        "영화관, 상영관 2개 각각 120석과 60석, 로비, 화장실",
    ] {
        let halls: Vec<Option<u32>> = world(prompt)
            .scene_graph
            .rooms
            .iter()
            .filter(|r| r.room_type == "auditorium")
            .map(|r| r.occupants)
            .collect();
        assert_eq!(halls, [Some(120), Some(60)], "{prompt}");
    }
}

#[test]
fn a_house_with_an_odd_room_is_a_house() {
    let world =
        world("semi-detached house on two floors with a music room, kitchen, living room, 3 bedrooms and a bathroom");
    assert_eq!(world.scene_graph.domain, "residential");
    assert_eq!(count(&world, "bedroom", "double_bed") + count(&world, "bedroom", "single_bed"), 3);
}
