use d3dgen_model::brief::{
    Ask, AskedBuilding, AskedCount, AskedPlace, AskedTask, Brief, CapacityAsk, Fact, ForbiddenAsk, ObjectsAsk, OnlyAsk,
    PeopleAsk, PlaceKind, RelationAsk, RelationKind, RobotsAsk, RoomsAsk, SiteAsk, SiteKind, StoreysAsk, Subject,
};
use d3dgen_model::scene_graph::{Connector, SceneGraph};
use d3dgen_plugins::Registry;

use crate::{Request, of_brief};

fn building(domain: &str, building_type: Option<&str>) -> AskedBuilding {
    let (domain, building_type) = (Some(domain.to_owned()), building_type.map(str::to_owned));
    AskedBuilding { domain, building_type, name: "it".into(), confidence: 1.0, words: Vec::new() }
}

fn subject(id: &str) -> Subject {
    Subject::known(id, &id.replace('_', " "))
}

fn rooms(id: &str, n: u32) -> Fact {
    Fact::Rooms(RoomsAsk { room: subject(id), count: AskedCount::exactly(n), ..RoomsAsk::default() })
}

fn graph(building: Option<AskedBuilding>, facts: Vec<Fact>) -> SceneGraph {
    let ask = |(i, fact)| Ask { id: format!("ask_{i}"), words: Vec::new(), read_by: Default::default(), fact };
    let asks = facts.into_iter().enumerate().map(ask).collect();
    let brief = Brief { building, asks, ..Brief::of_prompt("") };
    of_brief(&brief, &Request { seed: 3, ..Request::default() }, &Registry::builtin()).expect("it can be planned")
}

fn count(graph: &SceneGraph, id: &str) -> usize {
    graph.rooms.iter().filter(|r| r.room_type == id).count()
}

#[test]
fn a_list_adds_to_what_a_home_has_unless_it_is_all() {
    let home = || Some(building("residential", None));
    let open = graph(home(), vec![rooms("bedroom", 3), rooms("sauna", 1)]);
    assert_eq!((count(&open, "bedroom"), count(&open, "sauna")), (3, 1));
    assert!(count(&open, "bathroom") > 0 && count(&open, "kitchen") > 0, "a home has these");
    let only = Fact::Only(OnlyAsk { rooms: None, closed: true });
    let closed = graph(home(), vec![rooms("bedroom", 1), rooms("bathroom", 1), only]);
    let others = closed.rooms.iter().filter(|r| !r.circulation && !r.requested).count();
    assert_eq!(others, 0, "{:?}", closed.rooms.iter().map(|r| &r.id).collect::<Vec<_>>());
}

#[test]
fn what_is_ruled_out_is_not_there() {
    let no = Fact::Forbidden(ForbiddenAsk { room: Some(subject("living_room")), ..ForbiddenAsk::default() });
    let found = graph(Some(building("residential", None)), vec![rooms("bedroom", 2), no]);
    assert_eq!(count(&found, "living_room"), 0);
    assert!(found.forbidden_room_types.contains(&"living_room".to_owned()));
}

#[test]
fn beds_people_and_places_make_rooms() {
    let beds = CapacityAsk { of: PlaceKind::Beds, count: AskedCount::exactly(12), ..CapacityAsk::default() };
    let ward = graph(Some(building("hospital", Some("ward"))), vec![Fact::Capacity(beds)]);
    assert_eq!(ward.occupancy.beds, Some(12));
    let staff = Fact::People(PeopleAsk { role: "employee".into(), count: AskedCount::exactly(30) });
    let office = graph(Some(building("office", None)), vec![staff]);
    assert_eq!(office.occupancy.staff, Some(30));
    let family = Fact::People(PeopleAsk { role: "child".into(), count: AskedCount::exactly(2) });
    let home = graph(Some(building("residential", None)), vec![family]);
    assert_eq!(home.occupancy.residents, Some(2));
}

#[test]
fn rooms_stand_on_their_storeys_and_beside_each_other() {
    let upstairs =
        RoomsAsk { room: subject("bedroom"), count: AskedCount::exactly(3), level: Some(1), ..RoomsAsk::default() };
    let storeys = Fact::Storeys(StoreysAsk { count: AskedCount::exactly(2), basement: false });
    let house = graph(Some(building("residential", None)), vec![Fact::Rooms(upstairs), storeys]);
    let levels: Vec<i32> = house.rooms.iter().filter(|r| r.room_type == "bedroom").map(|r| r.level).collect();
    assert_eq!(levels, [1, 1, 1]);
    let door = RelationAsk { a: subject("kitchen"), relation: RelationKind::Door, b: subject("pantry") };
    let flat =
        graph(Some(building("residential", None)), vec![rooms("kitchen", 1), rooms("pantry", 1), Fact::Relation(door)]);
    let joined = |e: &&d3dgen_model::scene_graph::GraphEdge| {
        let ends = [e.a.as_str(), e.b.as_str()];
        ends.contains(&"kitchen_1") && ends.contains(&"pantry_1") && e.connector == Connector::Door
    };
    assert!(flat.edges.iter().any(|e| joined(&e)), "{:?}", flat.edges);
}

#[test]
fn robots_have_their_kind_number_body_and_way() {
    let robots = RobotsAsk {
        kind: "delivery".into(),
        count: AskedCount::exactly(2),
        width_m: Some(0.6),
        length_m: Some(0.8),
        keep_out: vec![subject("pharmacy")],
        ..RobotsAsk::default()
    };
    let facts = vec![rooms("pharmacy", 1), rooms("patient_room", 4), Fact::Robots(robots)];
    let ward = graph(Some(building("hospital", Some("ward"))), facts);
    let robot = &ward.robots[0];
    assert_eq!((robot.kind.as_str(), robot.count, robot.radius_m), ("delivery", 2, 0.5));
    let shut: Vec<&str> = ward.robot_rules.iter().filter(|r| r.keep_out).map(|r| r.room_id.as_str()).collect();
    let kept: Vec<&str> =
        ward.rooms.iter().filter(|r| r.requested && r.room_type != "patient_room").map(|r| r.id.as_str()).collect();
    assert_eq!(shut, kept, "the room that such a building has for medicine");
    let task = AskedTask { from: Some(subject("kitchen")), to: vec![subject("study")], ..AskedTask::default() };
    let sent = RobotsAsk { kind: "delivery".into(), tasks: vec![task], ..RobotsAsk::default() };
    let home =
        graph(Some(building("residential", None)), vec![rooms("kitchen", 1), rooms("study", 1), Fact::Robots(sent)]);
    assert_eq!(home.robots[0].stops, ["kitchen_1", "study_1"]);
}

#[test]
fn things_stand_in_the_room_they_are_asked_for() {
    let desks = ObjectsAsk {
        object: subject("desk"),
        count: AskedCount::exactly(2),
        room: Some(subject("living_room")),
        ..ObjectsAsk::default()
    };
    let home = graph(Some(building("residential", None)), vec![rooms("living_room", 1), Fact::Objects(desks)]);
    let living = home.rooms.iter().find(|r| r.room_type == "living_room").expect("it is asked for");
    assert_eq!(living.wished_assets.iter().filter(|o| *o == "desk").count(), 2, "{:?}", living.wished_assets);
}

#[test]
fn a_kind_of_building_nobody_knows_is_refused_with_the_nearest() {
    let barn = AskedBuilding {
        domain: None,
        building_type: None,
        name: "cow barn".into(),
        confidence: 1.0,
        words: Vec::new(),
    };
    let stable = AskedBuilding { name: "warehouse".into(), ..building("warehouse", None) };
    let brief = Brief { building: Some(barn), other_buildings: vec![stable], ..Brief::of_prompt("") };
    let refused = of_brief(&brief, &Request::default(), &Registry::builtin()).expect_err("no domain has barns");
    let message = refused.to_string();
    assert!(message.contains("cow barn") && message.contains("warehouse"), "{message}");
    let general = Request { domain: Some("general".into()), ..Request::default() };
    assert!(of_brief(&brief, &general, &Registry::builtin()).is_ok(), "the request may name a domain");
}

#[test]
fn the_place_says_whose_rules_apply() {
    let place = AskedPlace { country_code: "PL".into(), division_code: None, city: None, words: Vec::new() };
    let brief = Brief { building: Some(building("residential", None)), place: Some(place), ..Brief::of_prompt("") };
    let found = of_brief(&brief, &Request::default(), &Registry::builtin()).expect("it can be planned");
    assert_eq!(found.country_code.as_deref(), Some("PL"));
}

#[test]
fn beds_in_rooms_without_a_number_make_as_many_rooms_as_that_takes() {
    let open = |id: &str, n: u32| {
        Fact::Rooms(RoomsAsk { room: subject(id), count: AskedCount::at_least(n), ..RoomsAsk::default() })
    };
    let beds = |n: u32, room: Option<Subject>| {
        Fact::Capacity(CapacityAsk {
            of: PlaceKind::Beds,
            count: AskedCount::exactly(n),
            room,
            each_room: false,
            groups: None,
            ..CapacityAsk::default()
        })
    };
    // "24 beds, mostly double rooms" and "12 beds in double rooms"
    let ward = || Some(building("hospital", Some("ward")));
    let apart = graph(ward(), vec![beds(24, None), open("patient_room_double", 2)]);
    assert_eq!(count(&apart, "patient_room_double"), 12);
    let inside = graph(ward(), vec![open("patient_room_double", 1), beds(12, Some(subject("patient_room_double")))]);
    assert_eq!(count(&inside, "patient_room_double"), 6);
}

#[test]
fn each_group_has_the_room_that_the_building_is_for() {
    let groups = CapacityAsk {
        of: PlaceKind::Seats,
        count: AskedCount::exactly(20),
        room: None,
        each_room: false,
        groups: Some(3),
        ..CapacityAsk::default()
    };
    let found =
        graph(Some(building("school", Some("kindergarten"))), vec![Fact::Capacity(groups), rooms("kitchen", 1)]);
    assert_eq!(count(&found, "group_room"), 3);
}

#[test]
fn a_room_that_nobody_knows_has_the_name_it_was_given() {
    let own = |name: &str| Fact::Rooms(RoomsAsk { room: Subject::unknown(name), ..RoomsAsk::default() });
    let names = ["dog wash room", "пекарня", "세탁물실"];
    let found = graph(Some(building("office", None)), names.iter().map(|n| own(n)).collect());
    for name in names {
        let called = |r: &&d3dgen_model::scene_graph::GraphRoom| r.name.to_lowercase() == name;
        assert_eq!(found.rooms.iter().filter(called).count(), 1, "{name}: {:?}", found.rooms);
    }
}

#[test]
fn a_kind_of_building_that_nobody_knows_is_its_list_of_rooms_or_is_refused() {
    let unknown = || {
        let named = building("residential", None);
        Some(AskedBuilding { domain: None, name: "planetarium".into(), ..named })
    };
    let listed = graph(unknown(), vec![rooms("kitchen", 1), rooms("holding_cell", 20)]);
    assert_eq!((listed.domain.as_str(), count(&listed, "holding_cell")), ("general", 20));
    assert!(listed.assumptions.iter().any(|n| n.code == "unknown_building"), "{:?}", listed.assumptions);
    let brief = Brief { building: unknown(), ..Brief::of_prompt("planetarium") };
    let refusal = of_brief(&brief, &Request::default(), &Registry::builtin()).map(|_| ()).unwrap_err().to_string();
    assert!(refusal.contains("`planetarium`") && refusal.contains("the nearest are"), "{refusal}");
    assert_eq!(
        refusal.split("the nearest are ").nth(1).map(|r| r.split(';').next().unwrap_or("").split(", ").count()),
        Some(3)
    );
}

#[test]
fn what_the_reader_of_words_left_out_comes_from_the_brief() {
    let prompt = "house with 2 bedrooms, kitchen, a flumbarium";
    let request = Request { prompt: prompt.into(), seed: 3, ..Request::default() };
    let registry = Registry::builtin();
    let without = crate::generate(&request, &registry).expect("it can be planned");
    let lost = |g: &SceneGraph| g.conflicts.iter().any(|n| n.message.contains("flumbarium"));
    assert!(lost(&without));
    let at = prompt.find("flumbarium").expect("it is there") as u32;
    let words = vec![d3dgen_model::brief::PromptWords::of(prompt, at, at + 10)];
    let fact = Fact::Rooms(RoomsAsk { room: Subject::unknown("flumbarium"), ..RoomsAsk::default() });
    let ask = Ask { id: "ask_1".into(), words, read_by: Default::default(), fact };
    let brief = Brief { asks: vec![ask], ..Brief::of_prompt(prompt) };
    let with = crate::generate_with(&brief, &request, &registry).expect("it can be planned");
    assert!(!lost(&with) && with.rooms.iter().any(|r| r.name == "Flumbarium"), "{:?}", with.conflicts);
    assert_eq!(count(&with, "bedroom"), 2);
}

#[test]
fn tills_stand_in_the_room_that_has_many_of_them() {
    let tills =
        ObjectsAsk { object: subject("checkout_counter"), count: AskedCount::exactly(5), ..ObjectsAsk::default() };
    let shop = graph(Some(building("general", Some("supermarket"))), vec![Fact::Objects(tills)]);
    let held: Vec<u32> = shop.rooms.iter().filter_map(|r| r.occupants).filter(|n| *n == 5).collect();
    assert_eq!(held, [5], "{:?}", shop.rooms.iter().map(|r| (&r.id, r.occupants)).collect::<Vec<_>>());
}

#[test]
fn how_a_house_stands_and_where_its_garden_door_is_reach_the_plan() {
    let kitchen = RoomsAsk { room: subject("kitchen"), attributes: vec!["garden_door".into()], ..RoomsAsk::default() };
    let terraced = Fact::Site(SiteAsk { kind: SiteKind::Terraced });
    let house = graph(Some(building("residential", Some("house"))), vec![Fact::Rooms(kitchen), terraced]);
    assert_eq!(house.building_type.as_deref(), Some("terraced_house"));
    let doors: Vec<&str> = house.rooms.iter().filter(|r| r.garden_door).map(|r| r.room_type.as_str()).collect();
    assert_eq!(doors, ["kitchen"]);
}
