//! What prompts say of homes in passing: one of the rooms counted before, beds for those who sleep there, a place to work in
//! a room, an annexe, what stands on which storey.

use d3dgen_model::world::World;

use crate::common::{count, most, worlds};

fn rooms(world: &World, room_type: &str) -> usize {
    world.scene_graph.rooms.iter().filter(|r| r.room_type == room_type).count()
}

/// Returns the types of the rooms that doors of rooms of a type lead to.
fn entered_from<'w>(world: &'w World, room_type: &'w str) -> impl Iterator<Item = &'w str> {
    let kind = move |id: &str| world.floorplan.rooms.iter().find(|r| r.room_id == id).map(|r| r.room_type.as_str());
    let doors = world.floorplan.doors.iter().filter(move |d| d.room_ids.iter().any(|id| kind(id) == Some(room_type)));
    doors.flat_map(|d| &d.room_ids).filter_map(move |id| kind(id)).filter(move |k| *k != room_type)
}

#[test]
fn a_suite_behind_the_bedrooms_is_one_of_them() {
    for (prompt, bedrooms, ensuites) in [
        ("house with four bedrooms, master suite with walk-in closet, kitchen, living room, bathroom", 4, 1),
        ("three bedrooms, master suite, kitchen, living room and a bathroom", 3, 1),
        ("house with two bedrooms and a master suite, kitchen, living room, bathroom", 3, 1),
        ("house with four bedrooms where a robot moves between all rooms, with a charging dock in the laundry", 4, 0),
    ] {
        let world = &worlds(prompt, 1)[0];
        assert_eq!((rooms(world, "bedroom"), rooms(world, "ensuite")), (bedrooms, ensuites), "{prompt}");
    }
}

#[test]
fn several_rooms_have_what_is_told_of_them_each() {
    let mut held = Vec::new();
    for prompt in [
        "house with three bedrooms with desks, kitchen, living room, bathroom",
        "maison avec trois chambres avec bureau, cuisine, séjour et salle de bains",
        "casa con tres dormitorios con escritorio, cocina, salón y baño",
    ] {
        for world in worlds(prompt, 2) {
            assert_eq!(rooms(&world, "home_office"), 0, "{prompt}");
            held.extend((0..3).map(|i| i < count(&world, "bedroom", "small_desk")));
        }
    }
    most("desks of bedrooms", 0.9, &held);
}

#[test]
fn babies_and_those_who_sleep_alone_have_their_beds() {
    let (mut cots, mut beds) = (Vec::new(), Vec::new());
    for prompt in ["two-bedroom flat for a couple with a baby", "Wohnung mit zwei Zimmern für ein Paar mit Baby"] {
        cots.extend(worlds(prompt, 3).iter().map(|w| count(w, "bedroom", "cot") == 1));
    }
    for (prompt, double, single) in [
        ("shared student house with four bedrooms, kitchen and bathroom", 0, 4),
        ("house with three bedrooms, kitchen, living room and bathroom for a family with two teenagers", 1, 2),
    ] {
        for world in worlds(prompt, 2) {
            beds.push(count(&world, "bedroom", "double_bed") == double);
            beds.push(count(&world, "bedroom", "single_bed") == single);
        }
    }
    most("cots beside parents", 0.8, &cots);
    most("beds for one", 0.9, &beds);
}

#[test]
fn single_rooms_have_a_bed_for_one_and_their_own_bathroom() {
    for world in
        worlds("Wohngemeinschaft mit vier Einzelzimmern mit eigenem Bad, Wohnküche, Raum für die Pflegekraft", 2)
    {
        assert_eq!(rooms(&world, "single_bedroom"), 4);
        assert_eq!(rooms(&world, "staff_bedroom"), 1);
        assert_eq!(count(&world, "single_bedroom", "single_bed"), 4);
        let own = entered_from(&world, "bathroom").filter(|k| *k == "single_bedroom").count();
        assert!(own == 4, "seed {}: {own} own bathrooms", world.floorplan.seed);
    }
}

#[test]
fn a_corner_to_work_in_is_no_room() {
    let mut held = Vec::new();
    for prompt in [
        "flat with two bedrooms, kitchen, living room with a home office corner, bathroom",
        "piso con dos dormitorios, cocina, salón con rincón de trabajo y baño",
    ] {
        for world in worlds(prompt, 5) {
            assert_eq!(rooms(&world, "home_office"), 0, "{prompt}");
            held.push(count(&world, "living_room", "small_desk") == 1);
        }
    }
    most("desks in living rooms", 0.7, &held);
}

#[test]
fn an_annexe_has_rooms_of_its_own() {
    for prompt in [
        "bungalow with granny annexe with its own bedroom, bathroom and kitchenette, plus three bedrooms, family bathroom, kitchen and living room",
        "Haus mit drei Schlafzimmern, Bad, Küche, Wohnzimmer und Einliegerwohnung mit Wohnzimmer, Schlafzimmer, Kochnische und Duschbad",
    ] {
        for world in worlds(prompt, 2) {
            let named = ["annexe_living", "bedroom", "bathroom", "living_room"].map(|k| rooms(&world, k));
            assert_eq!(named, [1, 4, 2, 1], "{prompt}");
            let seed = world.floorplan.seed;
            let annexe: Vec<&str> = entered_from(&world, "annexe_living").collect();
            for kind in ["hallway", "bedroom", "bathroom"] {
                assert!(annexe.contains(&kind), "seed {seed}: no door from the annexe to its {kind}");
            }
            assert_eq!(count(&world, "annexe_living", "compact_kitchen_unit"), 1, "seed {seed}");
        }
    }
}

#[test]
fn what_one_comes_home_with_is_on_the_ground_floor() {
    for prompt in [
        "student house with three storeys, six bedrooms, two bathrooms, kitchen and a bike store",
        "house with two storeys, four bedrooms, two bathrooms, kitchen, living room and a telescope room",
    ] {
        for world in worlds(prompt, 2) {
            let room = world
                .scene_graph
                .rooms
                .iter()
                .find(|r| ["bike_store", "telescope_room"].contains(&r.room_type.as_str()));
            assert_eq!(room.map(|r| r.level), Some(0), "{prompt}");
        }
    }
}

#[test]
fn homes_of_several_storeys_have_a_toilet_where_one_lives_by_day() {
    for prompt in [
        "maison à trois niveaux : rez-de-chaussée avec garage et buanderie, premier étage séjour et cuisine, deuxième étage trois chambres et salle de bains",
        "two-storey house: kitchen, living room downstairs, three bedrooms and bathroom upstairs",
    ] {
        for world in worlds(prompt, 2) {
            let toilets =
                world.scene_graph.rooms.iter().filter(|r| ["toilet", "bathroom"].contains(&r.room_type.as_str()));
            let mut levels: Vec<i32> = toilets.map(|r| r.level).collect();
            levels.dedup();
            assert!(levels.len() > 1, "{prompt}: {levels:?}");
        }
    }
    let only = &worlds(
        "two-storey house with only a kitchen and a living room downstairs, a bedroom and a bathroom upstairs",
        1,
    )[0];
    assert_eq!(rooms(only, "toilet"), 0);
}

#[test]
fn storeys_stand_on_those_below() {
    let (mut held, mut lines) = (Vec::new(), Vec::new());
    for prompt in [
        "Zweigeschossiges Einfamilienhaus, 150 m², für eine Familie mit drei Kindern: unten Wohnzimmer, Küche, Gäste-WC und Hauswirtschaftsraum, oben Elternschlafzimmer, drei Kinderzimmer und Bad",
        "two-storey house with living room, dining room, kitchen, 3 bedrooms, 2 bathrooms",
        "student house with three storeys, six bedrooms, three bathrooms, kitchen and living room",
    ] {
        for world in worlds(prompt, 5) {
            held.push(!world.floorplan.conflicts.iter().any(|n| n.code == "overhang"));
            let edges = |level: i32| {
                let all = world.floorplan.rooms.iter().filter(move |r| r.level == level).map(|r| r.polygon.bounds());
                all.map(|b| [b.x0, b.x1, b.y0, b.y1])
                    .reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1]), a[2].min(b[2]), a[3].max(b[3])])
            };
            let (Some(lower), Some(upper)) = (edges(0), edges(1)) else { continue };
            // facades stand over each other, or plainly apart
            lines.extend(lower.iter().zip(upper).map(|(a, b)| (a - b).abs() < 0.01 || (a - b).abs() > 0.3));
        }
    }
    most("storeys that stand on the one below", 0.8, &held);
    most("facades in line", 0.8, &lines);
}

#[test]
fn floor_to_spare_goes_to_rooms_to_live_in() {
    let mut held = Vec::new();
    for world in worlds("house of 190 m2 with three bedrooms, two bathrooms, kitchen, living room, toilet, storage", 3)
    {
        let area = |kind: &'static str| {
            let all = world.scene_graph.rooms.iter().filter(move |r| r.room_type == kind);
            all.map(|r| r.target_area_m2).fold(0.0, f64::max)
        };
        held.push(area("bathroom") < 9.0 && area("toilet") < 4.0 && area("storage") < 5.0);
        held.push(area("living_room") > 30.0);
    }
    most("rooms to live in", 1.0, &held);
}

#[test]
fn a_kitchen_kept_apart_from_the_dining_room_is_not_joined_to_it_for_serving() {
    for prompt in
        ["苏州住宅:四间卧室,客厅,餐厅,厨房用移门隔开", "house with four bedrooms, a dining room away from the kitchen"]
    {
        for world in worlds(prompt, 2) {
            let all = entered_from(&world, "dining_room").all(|kind| kind != "kitchen");
            assert!(all && rooms(&world, "dining_room") == 1, "{prompt}");
        }
    }
}
