//! What prompts say of a home and those who live there: how many, who sleeps where, which bathroom is for whom, which rooms
//! are on which storey, and what stands in which room.

use d3dgen_model::scene_graph::{Connector, SceneGraph};
use d3dgen_pipeline::scene_graph::{self, Request};
use d3dgen_plugins::Registry;

use crate::common::{most, worlds};

fn graph(prompt: &str) -> SceneGraph {
    let request = Request { prompt: prompt.into(), seed: 11, ..Request::default() };
    scene_graph::generate(&request, &Registry::builtin()).expect(prompt)
}

fn count(graph: &SceneGraph, room_type: &str) -> usize {
    graph.rooms.iter().filter(|r| r.room_type == room_type).count()
}

/// Returns how many rooms of a type are on a storey.
fn on(graph: &SceneGraph, level: i32, room_type: &str) -> usize {
    graph.rooms.iter().filter(|r| r.level == level && r.room_type == room_type).count()
}

/// Returns true where a room of a type has the object among the first that it is furnished with.
fn wished(graph: &SceneGraph, room_type: &str, object: &str) -> bool {
    let first = |r: &d3dgen_model::scene_graph::GraphRoom| r.wished_assets.iter().take(3).any(|o| o == object);
    graph.rooms.iter().any(|r| r.room_type == room_type && first(r))
}

#[test]
fn who_lives_there_is_told() {
    for (prompt, people) in [
        ("Student house in Leeds for six students: six single study bedrooms, a bathroom, a kitchen", 6),
        ("Dreizimmerwohnung für ein älteres Ehepaar", 2),
        ("Senioren-WG für acht Bewohner: acht Einzelzimmer, zwei Bäder, Wohnküche", 8),
        ("Appartement T4 pour un couple avec deux enfants", 4),
        ("maison pour un couple de retraités avec deux chambres", 2),
        ("casa para una pareja joven", 2),
        ("Estudio para una pareja joven: cama doble, sofá, cocina americana, mesa para cuatro personas, baño", 2),
        ("house for a family of five", 5),
        ("flat for three friends with three bedrooms", 3),
    ] {
        assert_eq!(graph(prompt).occupancy.residents, Some(people), "{prompt}");
    }
    assert_eq!(graph("house with three bedrooms").occupancy.residents, None);
    assert_eq!(graph("office for 12 people").occupancy.residents, None);
}

#[test]
fn bedrooms_say_who_sleeps_there() {
    let of = |prompt: &str| -> Vec<u32> {
        let graph = graph(prompt);
        let sleeps = ["bedroom", "single_bedroom", "kids_room"];
        let rooms = graph.rooms.iter().filter(|r| sleeps.contains(&r.room_type.as_str()));
        rooms.map(|r| r.occupants.unwrap_or(0)).collect()
    };
    assert_eq!(of("house for a couple with two children: three bedrooms, bathroom, kitchen, living room"), [2, 1, 1]);
    assert_eq!(of("student house for four: four single bedrooms, bathroom, kitchen"), [1, 1, 1, 1]);
}

#[test]
fn a_home_is_peopled_by_those_who_live_there() {
    let mut held = Vec::new();
    for (prompt, people) in [
        ("two-bedroom flat for a couple", 2),
        ("house for a family of five: four bedrooms, kitchen, living room, two bathrooms", 5),
    ] {
        held.extend(worlds(prompt, 2).iter().map(|w| w.scenario.agents.len() == people));
    }
    most("people at home", 1.0, &held);
}

#[test]
fn a_bathroom_of_a_bedroom_is_none_for_the_others() {
    for (prompt, ensuites, bathrooms) in [
        ("trois chambres dont une suite parentale avec salle d'eau, une salle de bains, séjour et cuisine", 1, 1),
        (
            "Flat with three bedrooms including a master suite with shower room, one bathroom, kitchen and living room",
            1,
            1,
        ),
        ("House with four bedrooms, one with its own bathroom, and a family bathroom, kitchen, living room", 1, 1),
        ("Piso con dormitorio principal con baño propio, dos dormitorios, un baño, cocina, salón", 1, 1),
    ] {
        let graph = graph(prompt);
        assert_eq!((count(&graph, "ensuite"), count(&graph, "bathroom")), (ensuites, bathrooms), "{prompt}");
        let bathroom = graph.rooms.iter().find(|r| r.room_type == "bathroom").expect("a bathroom");
        let hosted = graph.edges.iter().any(|e| e.reason == "host" && e.a == bathroom.id);
        assert!(!hosted, "{prompt}: the bathroom for all is entered through a bedroom");
    }
}

#[test]
fn rooms_that_are_listed_are_those_that_a_flat_is_counted_by() {
    for (prompt, bedrooms) in [
        ("Dreizimmerwohnung: Wohnzimmer, getrennte Küche, Schlafzimmer, ein Gästezimmer, Bad", 1),
        ("3-Zimmer-Wohnung, 78 m², Schlafzimmer, Kinderzimmer, Wohnzimmer, Küche, Bad, Balkon", 1),
        (
            "Vierzimmerwohnung für ein Paar mit einem Kind: Wohnzimmer, Schlafzimmer, Kinderzimmer, Arbeitszimmer, Küche, Bad",
            1,
        ),
        ("Dreizimmerwohnung mit Balkon", 2),
    ] {
        assert_eq!(count(&graph(prompt), "bedroom"), bedrooms, "{prompt}");
    }
}

#[test]
fn rooms_are_on_the_storey_that_is_told_without_its_noun() {
    let house = graph(
        "Casa adosada de tres plantas: en la planta baja garaje, aseo, cocina y salón comedor; en la primera tres \
         dormitorios y un baño; en la segunda dormitorio principal con baño propio, despacho y terraza.",
    );
    assert_eq!((on(&house, 1, "bedroom"), on(&house, 1, "bathroom")), (3, 1));
    assert_eq!((on(&house, 2, "bedroom"), on(&house, 2, "ensuite"), on(&house, 2, "home_office")), (1, 1, 1));
    let house = graph(
        "Reihenhaus mit drei Geschossen: im Erdgeschoss Küche, Wohnzimmer und Gäste-WC, im Obergeschoss drei Schlafzimmer \
         und Bad, im Dachgeschoss Arbeitszimmer und Gästezimmer mit Duschbad",
    );
    assert_eq!((on(&house, 1, "bedroom"), on(&house, 2, "guest_room"), on(&house, 2, "home_office")), (3, 1, 1));
    // the top is above what is called upper, however many storeys there are said to be
    let house = graph(
        "Einfamilienhaus: im Erdgeschoss Küche, Wohnzimmer und WC, im Obergeschoss zwei Schlafzimmer und Bad, im \
         Dachgeschoss ein Arbeitszimmer",
    );
    assert_eq!((on(&house, 1, "bedroom"), on(&house, 2, "home_office")), (2, 1));
    let house = graph(
        "Vivienda de tres plantas: abajo garaje y trastero, en la primera cocina y salón, en la segunda tres habitaciones \
         y un baño",
    );
    assert_eq!((on(&house, 0, "garage"), on(&house, 1, "kitchen")), (1, 1));
    // what carries the storeys above may be a second one
    assert!(on(&house, 0, "storage") >= 1);
    assert_eq!(on(&house, 2, "bedroom"), 3);
    // rooms that are numbered are no storeys
    let flat = graph("two-bedroom flat: on the first bedroom wall a picture, kitchen, living room, bathroom");
    assert!(flat.rooms.iter().all(|r| r.level == 0));
}

#[test]
fn a_studio_is_one_room_with_a_bed() {
    for prompt in [
        "Estudio de 38 m² para una pareja joven: zona de dormir con cama doble, sofá, cocina americana, baño con ducha",
        "Studio of 35 sqm for one person: sleeping area with double bed, sofa, kitchenette, shower room",
        "Studio de 30 m² avec coin nuit, canapé, kitchenette et salle d'eau",
        "Einzimmerwohnung 40 m² mit Schlafbereich, Sofa, Küchenzeile und Bad",
    ] {
        let graph = graph(prompt);
        assert_eq!(
            (count(&graph, "studio"), count(&graph, "living_room"), count(&graph, "bedroom")),
            (1, 0, 0),
            "{prompt}"
        );
        assert!(graph.conflicts.is_empty(), "{prompt}: {:?}", graph.conflicts);
    }
    let flat = graph("flat with a living room, a sleeping area, a kitchen and a bathroom");
    assert_eq!((count(&flat, "bedroom"), count(&flat, "living_room")), (1, 1));
}

#[test]
fn a_separate_kitchen_has_a_door() {
    for prompt in [
        "maison avec salon, salle à manger, cuisine fermée, deux chambres et une salle de bains",
        "house with a separate kitchen, dining room, living room, two bedrooms, bathroom",
        "casa con salón, comedor, cocina independiente, dos dormitorios y un baño",
        "Haus mit Wohnzimmer, Esszimmer, geschlossener Küche, zwei Schlafzimmern und Bad",
    ] {
        let graph = graph(prompt);
        let open = |id: &str| graph.edges.iter().any(|e| e.connector == Connector::Open && (e.a == id || e.b == id));
        assert!(!open("kitchen_1"), "{prompt}");
    }
}

#[test]
fn near_the_front_door_is_no_entrance() {
    for (prompt, room_type) in [
        ("Student house: four single bedrooms, bathroom, kitchen, a bike store near the front door", "bike_store"),
        ("Flat with two bedrooms, living room, kitchen, a bathroom near the entrance", "bathroom"),
        ("Wohnung mit zwei Schlafzimmern, Küche, Wohnzimmer, Bad, Abstellraum neben der Haustür", "storage"),
    ] {
        let graph = graph(prompt);
        let entrance = graph.rooms.iter().find(|r| r.entrance).expect("an entrance");
        assert_ne!(entrance.room_type, room_type, "{prompt}");
        let near = graph.edges.iter().any(|e| {
            e.connector == Connector::Near && e.reason == "prompt" && e.b == entrance.id && e.a.starts_with(room_type)
        });
        assert!(near, "{prompt}");
    }
}

#[test]
fn things_stand_where_the_prompt_says() {
    for (prompt, room_type, object) in [
        ("Piso con un dormitorio, cocina, salón, baño y un armario grande en la entrada", "entry", "wardrobe"),
        (
            "Appartement avec deux chambres, séjour, cuisine, salle de bains, une entrée avec placard",
            "entry",
            "wardrobe",
        ),
        ("Two-bedroom flat, kitchen, bathroom, living room with fireplace", "living_room", "fireplace"),
        ("Haus mit zwei Schlafzimmern, Küche, Bad und Wohnzimmer mit Kaminofen", "living_room", "wood_stove"),
        ("maison avec deux chambres, cuisine, salle de bains, grand salon avec poêle", "living_room", "wood_stove"),
        ("Wohnung mit Wohnzimmer mit Essplatz, Küche, Schlafzimmer und Bad", "living_room", "dining_table_4"),
        (
            "appartement avec séjour, deux chambres, cuisine et salle de bains. Le père travaille dans un coin bureau du séjour.",
            "living_room",
            "small_desk",
        ),
        (
            "Two-bedroom house with kitchen, living room, bathroom and laundry. A robot vacuum; its dock should be in the laundry room.",
            "laundry",
            "robot_dock",
        ),
        (
            "Two-bedroom house with kitchen, living room, bathroom. One delivery robot waits at the entrance.",
            "hallway",
            "robot_dock",
        ),
    ] {
        let graph = graph(prompt);
        assert!(wished(&graph, room_type, object), "{prompt}: {:?}", graph.conflicts);
        assert!(!graph.conflicts.iter().any(|n| n.code == "unread_wish"), "{prompt}: {:?}", graph.conflicts);
    }
    let flat = graph("Appartement avec deux chambres, séjour, cuisine, salle de bains, une entrée avec placard");
    assert_eq!(count(&flat, "storage"), 0);
}

#[test]
fn each_robot_does_its_own_work() {
    let graph = graph(
        "Senioren-WG für vier Bewohner: vier Einzelzimmer, zwei Bäder, Wohnküche, Flur. Ein Serviceroboter bringt das Essen, \
         ein Wischroboter reinigt die Flure.",
    );
    let of = |kind: &str| graph.robots.iter().find(|r| r.kind == kind).map(|r| r.room_types.len());
    assert_eq!((of("service"), of("cleaning")), (Some(0), Some(1)));
    assert!(graph.accessible, "seniors live there");
}

#[test]
fn the_only_bathroom_opens_to_the_hall() {
    let graph = graph("Flat: two bedrooms with one bathroom, kitchen, living room");
    let hosted = graph.edges.iter().any(|e| e.reason == "host" && e.a.starts_with("bathroom"));
    assert!(!hosted);
}
