//! What was asked for is measured in the world: the same fact is honored where it holds, and told where it does not.

use std::collections::BTreeMap;

use d3dgen_check::check;
use d3dgen_model::brief::{AreaAsk, SiteAsk, SiteKind};
use d3dgen_model::brief::{
    Ask, AskedCount, AskedTask, Bound, Brief, CapacityAsk, Fact, ForbiddenAsk, ObjectsAsk, OnlyAsk, OtherAsk,
    PeopleAsk, PlaceKind, PromptWords, RelationAsk, RelationKind, RobotsAsk, RoomsAsk, StoreysAsk, StyleAsk, Subject,
};
use d3dgen_model::domain::Shape;
use d3dgen_model::report::{AskAnswer, Fate};
use d3dgen_model::scene_graph::Note;
use d3dgen_model::world::World;

use crate::{SAMPLES, Sample};

const FLAT: usize = 0;
const OFFICE: usize = 1;
const WARD: usize = 2;
const WAREHOUSE: usize = 3;

/// Returns what became of one fact in a world.
fn answer(sample: &Sample, fact: Fact) -> AskAnswer {
    let ask = Ask { id: "ask_1".into(), words: Vec::new(), read_by: Default::default(), fact };
    let brief = Brief { asks: vec![ask], ..Brief::of_prompt("") };
    let world = World { brief: Some(brief), ..sample.world.clone() };
    let mut answers = check(&world, sample.domain, &sample.retrieval).asks;
    assert_eq!(answers.len(), 1, "each fact has its answer");
    answers.remove(0)
}

fn room(id: &str) -> Subject {
    Subject::known(id, &id.replace('_', " "))
}

fn rooms(id: &str, count: AskedCount) -> Fact {
    Fact::Rooms(RoomsAsk { room: room(id), count, ..RoomsAsk::default() })
}

#[test]
fn facts_are_honored_where_they_hold_and_told_where_they_do_not() {
    let exactly = AskedCount::exactly;
    let objects = |id: &str, within: Option<&str>, n| {
        Fact::Objects(ObjectsAsk {
            object: room(id),
            count: AskedCount::at_least(n),
            room: within.map(room),
            ..ObjectsAsk::default()
        })
    };
    let relation = |a: &str, relation, b: &str| Fact::Relation(RelationAsk { a: room(a), relation, b: room(b) });
    let robots =
        |kind: &str, n| Fact::Robots(RobotsAsk { kind: kind.into(), count: exactly(n), ..RobotsAsk::default() });
    let forbidden = |id: &str| Fact::Forbidden(ForbiddenAsk { room: Some(room(id)), ..ForbiddenAsk::default() });
    let beds = |n| {
        Fact::Capacity(CapacityAsk {
            of: PlaceKind::Beds,
            count: exactly(n),
            room: None,
            each_room: false,
            groups: None,
            ..CapacityAsk::default()
        })
    };
    let cases = [
        (FLAT, rooms("bedroom", exactly(2)), Fate::Honored),
        (FLAT, rooms("bedroom", exactly(3)), Fate::Substituted),
        (FLAT, rooms("bedroom", AskedCount::at_least(1)), Fate::Honored),
        (FLAT, rooms("sauna", AskedCount::at_least(1)), Fate::LeftOut),
        (FLAT, forbidden("sauna"), Fate::Honored),
        (FLAT, forbidden("kitchen"), Fate::LeftOut),
        (FLAT, Fact::Storeys(StoreysAsk { count: exactly(1), basement: false }), Fate::Honored),
        (FLAT, Fact::Storeys(StoreysAsk { count: exactly(2), basement: false }), Fate::Substituted),
        (FLAT, Fact::Area(AreaAsk { area_m2: 900.0, bound: Bound::Exactly }), Fate::Substituted),
        (FLAT, Fact::Area(AreaAsk { area_m2: 900.0, bound: Bound::AtMost }), Fate::Honored),
        (FLAT, objects("wardrobe", Some("bedroom"), 1), Fate::Honored),
        (FLAT, objects("wardrobe", Some("kitchen"), 1), Fate::Substituted),
        (FLAT, objects("piano", None, 1), Fate::LeftOut),
        (FLAT, relation("bedroom", RelationKind::NotFrom, "kitchen"), Fate::Honored),
        (FLAT, relation("sauna", RelationKind::Door, "kitchen"), Fate::LeftOut),
        (FLAT, Fact::Style(StyleAsk { word: "l_shaped".into() }), Fate::LeftOut),
        (FLAT, Fact::Site(SiteAsk { kind: SiteKind::Terraced }), Fate::LeftOut),
        (FLAT, Fact::Other(OtherAsk { wish: "a view of the sea".into() }), Fate::LeftOut),
        (FLAT, Fact::People(PeopleAsk { role: "resident".into(), count: exactly(40) }), Fate::Substituted),
        (OFFICE, Fact::People(PeopleAsk { role: "employee".into(), count: exactly(8) }), Fate::Honored),
        (WARD, rooms("patient_room", exactly(4)), Fate::Honored),
        (WARD, relation("anteroom", RelationKind::Door, "isolation_room"), Fate::Honored),
        (WARD, relation("isolation_room", RelationKind::OnlyFrom, "anteroom"), Fate::Honored),
        (WARD, beds(200), Fate::Substituted),
        (WAREHOUSE, robots("transport", 2), Fate::Honored),
        (WAREHOUSE, robots("transport", 3), Fate::Substituted),
        (WAREHOUSE, robots("cleaning", 1), Fate::Substituted),
        (WAREHOUSE, Fact::Only(OnlyAsk { rooms: Some(99), closed: false }), Fate::Substituted),
    ];
    for (sample, fact, fate) in cases {
        let found = answer(&SAMPLES[sample], fact.clone());
        assert_eq!(found.fate, fate, "{fact:?}: {found:?}");
        assert_eq!(found.reason.is_empty(), fate == Fate::Honored, "a reason for what is not as asked: {found:?}");
    }
}

/// Returns what became of facts that one brief has together.
fn answers_of(sample: &Sample, facts: &[Fact]) -> Vec<AskAnswer> {
    let ask = |(i, fact): (usize, &Fact)| Ask {
        id: format!("ask_{i}"),
        words: Vec::new(),
        read_by: Default::default(),
        fact: fact.clone(),
    };
    let brief = Brief { asks: facts.iter().enumerate().map(ask).collect(), ..Brief::of_prompt("") };
    check(&World { brief: Some(brief), ..sample.world.clone() }, sample.domain, &sample.retrieval).asks
}

#[test]
fn what_is_asked_for_by_a_name_of_its_own_is_not_counted_twice() {
    let mut pairs = 0;
    for sample in SAMPLES.iter() {
        let types = sample.world.scene_graph.rooms.iter().map(|r| r.room_type.as_str());
        let mut numbers: BTreeMap<&str, u32> = BTreeMap::new();
        types.for_each(|id| *numbers.entry(id).or_default() += 1);
        let kind_of = |of: &str| numbers.iter().filter(|(id, _)| id.ends_with(&format!("_{of}"))).collect::<Vec<_>>();
        for (id, n) in &numbers {
            let [(other, others)] = kind_of(id)[..] else { continue };
            pairs += 1;
            let own = rooms(other, AskedCount::exactly(*others));
            let fates = |n| {
                let asked = [rooms(id, AskedCount::exactly(n)), own.clone()];
                answers_of(sample, &asked).iter().map(|a| a.fate).collect::<Vec<_>>()
            };
            assert_eq!(fates(*n), [Fate::Honored, Fate::Honored], "{id} beside {other}");
            assert_eq!(fates(n + others + 1)[0], Fate::Substituted, "{id} beside {other}");
        }
    }
    assert!(pairs > 0, "no sample has rooms of a kind beside a kind of them");
}

#[test]
fn work_places_are_desks_and_beds_are_where_people_stay() {
    let seats = |room_id: &str, n| {
        let capacity = CapacityAsk {
            of: PlaceKind::Seats,
            count: AskedCount::exactly(n),
            room: Some(room(room_id)),
            each_room: false,
            groups: None,
            ..CapacityAsk::default()
        };
        Fact::Capacity(capacity)
    };
    let office = &SAMPLES[OFFICE];
    let in_office = |shape: Shape| {
        let placements = &office.world.placements.placements;
        let of_room = |id: &str| office.world.floorplan.room(id).is_some_and(|r| r.room_type == "open_office");
        let is_so = |object: &str| office.domain.object(object).is_some_and(|o| o.shape == shape);
        placements.iter().filter(|p| of_room(&p.room_id) && is_so(&p.object)).count() as u32
    };
    let desks = in_office(Shape::Desk);
    assert!(desks > 0, "the office has an open room to work in");
    assert_eq!(answer(office, seats("open_office", desks)).fate, Fate::Honored);
    assert_eq!(answer(office, seats("open_office", 10 * desks)).fate, Fate::Substituted);
}

#[test]
fn numbers_and_measures_are_told() {
    let found = answer(&SAMPLES[FLAT], rooms("bedroom", AskedCount::exactly(3)));
    assert_eq!((found.asked, found.measured), (Some(3.0), Some(2.0)));
    assert_eq!(found.ids.len(), 2);
    let sample = &SAMPLES[FLAT];
    let kitchen = sample.world.floorplan.rooms.iter().find(|r| r.room_type == "kitchen").unwrap();
    let bounds = kitchen.net_polygon.bounds();
    let sized = |area: f64, sides: [f64; 2]| {
        Fact::Rooms(RoomsAsk {
            room: room("kitchen"),
            area_m2: Some(area),
            sides_m: Some(sides),
            ..RoomsAsk::default()
        })
    };
    let area = kitchen.net_polygon.area();
    assert_eq!(answer(sample, sized(area, [bounds.height(), bounds.width()])).fate, Fate::Honored);
    let larger = answer(sample, sized(1.2 * area, [bounds.width(), bounds.height()]));
    assert_eq!((larger.fate, larger.unit.as_str()), (Fate::Substituted, "m2"));
    let longer = answer(sample, sized(area, [1.2 * bounds.width(), bounds.height()]));
    assert!(longer.reason.contains("sides are"), "{longer:?}");
}

#[test]
fn a_robot_answers_for_where_it_is_sent() {
    let task = |to: &str| AskedTask { verb: "bring".into(), to: vec![room(to)], ..AskedTask::default() };
    let robots = |to: &str| {
        Fact::Robots(RobotsAsk {
            kind: "transport".into(),
            count: AskedCount::exactly(2),
            tasks: vec![task(to)],
            ..RobotsAsk::default()
        })
    };
    let lacking = answer(&SAMPLES[WAREHOUSE], robots("operating_room"));
    assert_eq!(lacking.fate, Fate::LeftOut, "{lacking:?}");
    assert!(lacking.reason.contains("operating room"), "{lacking:?}");
}

#[test]
fn a_conflict_that_names_the_wish_is_its_reason() {
    let sample = &SAMPLES[FLAT];
    let prompt = "flat with a helipad";
    let words = vec![PromptWords::of(prompt, 12, 19)];
    let fact = Fact::Rooms(RoomsAsk { room: Subject::unknown("helipad"), ..RoomsAsk::default() });
    let ask = Ask { id: "ask_1".into(), words, read_by: Default::default(), fact };
    let mut world =
        World { brief: Some(Brief { asks: vec![ask], ..Brief::of_prompt(prompt) }), ..sample.world.clone() };
    let note = Note::new("unread_wish", "no helipad is planned on a flat".into());
    world.scene_graph.conflicts.push(note);
    let found = check(&world, sample.domain, &sample.retrieval);
    assert_eq!(found.asks[0].fate, Fate::Contradicted);
    assert!(found.asks[0].reason.ends_with("no helipad is planned on a flat"));
    assert_eq!(found.wishes_met(), (0, 1));
}

/// Returns a brief of facts with the words of a prompt that state each.
fn worded(prompt: &str, facts: &[(&str, Fact)], unread: &[&str]) -> Brief {
    let words = |text: &str| {
        let start = prompt.find(text).map(|at| prompt[..at].chars().count() as u32).unwrap();
        PromptWords::of(prompt, start, start + text.chars().count() as u32)
    };
    let ask = |(i, (text, fact)): (usize, &(&str, Fact))| Ask {
        id: format!("ask_{i}"),
        words: vec![words(text)],
        read_by: Default::default(),
        fact: fact.clone(),
    };
    Brief {
        asks: facts.iter().enumerate().map(ask).collect(),
        not_understood: unread.iter().map(|text| words(text)).collect(),
        ..Brief::of_prompt(prompt)
    }
}

fn fates(sample: &Sample, world: &World, brief: Brief) -> Vec<Fate> {
    let world = World { brief: Some(brief), ..world.clone() };
    check(&world, sample.domain, &sample.retrieval).asks.iter().map(|a| a.fate).collect()
}

fn named(id: &str, name: &str) -> Fact {
    Fact::Rooms(RoomsAsk { room: Subject::known(id, name), ..RoomsAsk::default() })
}

#[test]
fn a_room_answers_one_wish_unless_it_is_named_again() {
    let office = &SAMPLES[OFFICE];
    let two = [
        ("a podcast room", named("meeting_room", "podcast room")),
        ("a photo room", named("meeting_room", "photo room")),
    ];
    let asked = worded("a podcast room and a photo room", &two, &[]);
    assert_eq!(fates(office, &office.world, asked), [Fate::Honored, Fate::LeftOut], "one room for two");
    let alike =
        [("a meeting room", named("meeting_room", "room")), ("but no dust in the room", named("meeting_room", "room"))];
    let same = worded("a meeting room, but no dust in the room", &alike, &[]);
    assert_eq!(fates(office, &office.world, same), [Fate::Honored, Fate::Honored], "the same name again");
    let sums = [
        ("3 LDK", named("meeting_room", "3 LDK")),
        ("3 LDK", named("reception", "3 LDK")),
        ("with a quiet room", named("meeting_room", "quiet room")),
    ];
    let summed = fates(office, &office.world, worded("3 LDK with a quiet room", &sums, &[]));
    assert_eq!([summed[0], summed[2]], [Fate::Honored, Fate::Honored], "what is summed up is named once more");
    let again = worded("a podcast room. Lights in a photo room", &two, &[]);
    assert_eq!(fates(office, &office.world, again), [Fate::Honored, Fate::Honored], "another sentence speaks of it");
}

#[test]
fn what_was_not_read_of_a_thing_is_not_there() {
    let flat = &SAMPLES[FLAT];
    let bed = Fact::Objects(ObjectsAsk { object: Subject::known("double_bed", "bed"), ..ObjectsAsk::default() });
    let asked =
        |prompt: &str, unread: &[&str]| fates(flat, &flat.world, worded(prompt, &[("bed", bed.clone())], unread));
    assert_eq!(asked("a heated bed", &["heated"]), [Fate::Substituted]);
    assert_eq!(asked("a heated house, a bed", &["heated"]), [Fate::Honored]);
}

#[test]
fn a_room_that_nobody_knows_and_nothing_stands_in_is_only_its_name() {
    let flat = &SAMPLES[FLAT];
    let mut world = flat.world.clone();
    let kitchen = world.scene_graph.rooms.iter_mut().find(|r| r.room_type == "kitchen").unwrap();
    (kitchen.room_type, kitchen.name) = ("aviary".into(), "Aviary".into());
    let id = kitchen.id.clone();
    world.floorplan.rooms.iter_mut().find(|r| r.room_id == id).unwrap().room_type = "aviary".into();
    let aviary = Fact::Rooms(RoomsAsk { room: Subject::unknown("aviary"), ..RoomsAsk::default() });
    let asked = |world: &World| fates(flat, world, worded("an aviary", &[("aviary", aviary.clone())], &[]));
    assert_eq!(asked(&world), [Fate::Substituted], "what stands in any room makes it none");
    let thing = world.placements.placements.iter().find(|p| p.room_id == id).unwrap().object.clone();
    let thing = Fact::Objects(ObjectsAsk { object: room(&thing), ..ObjectsAsk::default() });
    let with = worded("an aviary with that", &[("aviary", aviary.clone()), ("that", thing)], &[]);
    assert_eq!(fates(flat, &world, with)[0], Fate::Honored, "with what it was asked for with it is a room");
    world.placements.placements.retain(|p| p.room_id != id);
    assert_eq!(asked(&world), [Fate::Substituted]);
}

#[test]
fn a_room_that_a_part_of_its_name_told_is_a_substitute() {
    let flat = &SAMPLES[FLAT];
    let cookery = [("flambé room", named("kitchen", "flambé room"))];
    let mut world = flat.world.clone();
    let asked = |world: &World| fates(flat, world, worded("a flambé room", &cookery, &[]));
    assert_eq!(asked(&world), [Fate::Honored]);
    let message = "furnished by a part of them: `flambé room` (kitchen)".to_owned();
    world.scene_graph.assumptions.push(Note::new("room_likely", message));
    assert_eq!(asked(&world), [Fate::Substituted]);
}

#[test]
fn a_lock_with_nothing_behind_it_is_not_what_was_asked_for() {
    let anteroom = || rooms("anteroom", AskedCount::exactly(1));
    assert_eq!(answer(&SAMPLES[WARD], anteroom()).fate, Fate::Honored);
    // the isolation room opens to the corridor instead
    let mut world = SAMPLES[WARD].world.clone();
    let corridor = world.scene_graph.rooms.iter().find(|r| r.circulation).expect("a ward has a corridor").id.clone();
    let is = |id: &String, kind: &str| world.floorplan.room(id).is_some_and(|r| r.room_type == kind);
    let between = |ids: &[String]| ["anteroom", "isolation_room"].iter().all(|k| ids.iter().any(|id| is(id, k)));
    let door = world.floorplan.doors.iter().position(|d| between(&d.room_ids)).expect("a door between the two");
    let lock = world.floorplan.doors[door].room_ids.iter().position(|id| is(id, "anteroom")).expect("one of the two");
    world.floorplan.doors[door].room_ids[lock] = corridor;
    let brief = Brief {
        asks: vec![Ask { id: "ask_1".into(), words: Vec::new(), read_by: Default::default(), fact: anteroom() }],
        ..Brief::of_prompt("")
    };
    world.brief = Some(brief);
    let found = check(&world, SAMPLES[WARD].domain, &SAMPLES[WARD].retrieval).asks.remove(0);
    assert_eq!(found.fate, Fate::Substituted, "{found:?}");
    assert!(found.reason.contains("nothing lies behind"), "{found:?}");
}

#[test]
fn each_of_several_rooms_has_what_they_are_asked_for_with() {
    let flat = &SAMPLES[FLAT];
    let is_wardrobe = |object: &str| object.ends_with("wardrobe");
    let wardrobe =
        Fact::Objects(ObjectsAsk { object: room("wardrobe"), room: Some(room("bedroom")), ..ObjectsAsk::default() });
    let facts = [("two bedrooms", rooms("bedroom", AskedCount::exactly(2))), ("wardrobe", wardrobe)];
    let asked = |world: &World| fates(flat, world, worded("two bedrooms with wardrobe", &facts, &[]))[1];
    let mut world = flat.world.clone();
    let bedrooms: Vec<String> =
        world.scene_graph.rooms.iter().filter(|r| r.room_type == "bedroom").map(|r| r.id.clone()).collect();
    let have = |world: &World, id: &String| {
        world.placements.placements.iter().any(|p| &p.room_id == id && is_wardrobe(&p.object))
    };
    assert!(bedrooms.len() == 2 && bedrooms.iter().all(|id| have(&world, id)), "the sample has a wardrobe in each");
    assert_eq!(asked(&world), Fate::Honored);
    world.placements.placements.retain(|p| p.room_id != bedrooms[1] || !is_wardrobe(&p.object));
    assert_eq!(asked(&world), Fate::Substituted, "one for two bedrooms");
}

#[test]
fn people_are_counted_by_what_the_building_has_for_them() {
    let flat = &SAMPLES[FLAT];
    let mut world = flat.world.clone();
    world.scene_graph.occupancy.residents = Some(2);
    let two = Fact::People(PeopleAsk { role: "resident".into(), count: AskedCount::exactly(2) });
    let brief = worded("for two", &[("two", two)], &[]);
    let world = World { brief: Some(brief), ..world };
    let found = &check(&world, flat.domain, &flat.retrieval).asks[0];
    let seats = world.placements.placements.iter().filter(|p| p.object.contains("chair")).count() as f64;
    assert_eq!(found.fate, Fate::Honored);
    assert!(found.measured.unwrap() <= 4.0 && found.measured.unwrap() < seats, "beds of two bedrooms: {found:?}");
}

#[test]
fn a_stand_for_a_thing_is_not_the_thing() {
    let flat = &SAMPLES[FLAT];
    let mut world = flat.world.clone();
    assert!(world.placements.placements.iter().any(|p| p.object == "tv_stand"), "the flat has one");
    let none =
        Fact::Forbidden(ForbiddenAsk { object: Some(Subject::known("tv", "television")), ..ForbiddenAsk::default() });
    let asked = |world: &World| fates(flat, world, worded("no television", &[("television", none.clone())], &[]))[0];
    assert_eq!(asked(&world), Fate::LeftOut);
    world.placements.placements.retain(|p| p.object != "tv");
    assert_eq!(asked(&world), Fate::Honored);
}

#[test]
fn a_conflict_about_another_thing_is_no_reason() {
    let flat = &SAMPLES[FLAT];
    let brief = worded("flat with a music room", &[("music room", named("music_room", "music room"))], &[]);
    let mut world = World { brief: Some(brief), ..flat.world.clone() };
    let note = |m: &str| Note::new("object_without_room", m.into());
    world.scene_graph.conflicts = vec![note("no room was found for the object wood_stove; it was left out")];
    let found = check(&world, flat.domain, &flat.retrieval).asks.remove(0);
    assert_eq!(found.fate, Fate::LeftOut, "{found:?}");
    assert!(!found.reason.contains("stove"), "{found:?}");
}

#[test]
fn a_robot_rests_where_it_was_said_and_stays_out_where_it_was_said() {
    let warehouse = &SAMPLES[WAREHOUSE];
    let scenario = &warehouse.world.scenario;
    let dock = scenario.robots.iter().find_map(|t| t.dock.clone()).unwrap();
    let room_of = |id: &str| {
        let poi = scenario.pois.iter().find(|p| p.poi_id == id).unwrap();
        warehouse.world.scene_graph.room(&poi.room_id).unwrap().room_type.clone()
    };
    let goal = room_of(&scenario.robots[0].goals[0]);
    let resting = |at: &str| AskedTask { verb: "wait".into(), to: vec![room(at)], ..AskedTask::default() };
    let robots = |tasks: Vec<AskedTask>, keep_out: Vec<Subject>| {
        Fact::Robots(RobotsAsk {
            kind: "transport".into(),
            count: AskedCount::exactly(2),
            tasks,
            keep_out,
            ..RobotsAsk::default()
        })
    };
    assert_eq!(answer(warehouse, robots(vec![resting(&room_of(&dock))], Vec::new())).fate, Fate::Honored);
    assert_eq!(answer(warehouse, robots(vec![resting("break_room")], Vec::new())).fate, Fate::Substituted);
    assert_eq!(
        answer(warehouse, robots(Vec::new(), vec![room(&goal)])).fate,
        Fate::LeftOut,
        "it drives through {goal}"
    );
}

#[test]
fn how_a_building_stands_is_answered_by_its_kind() {
    let sample = &SAMPLES[FLAT];
    let fate = |kind: &str, asked: SiteKind| {
        let mut world = sample.world.clone();
        world.scene_graph.building_type = Some(kind.into());
        let brief = worded("", &[("", Fact::Site(SiteAsk { kind: asked }))], &[]);
        fates(sample, &world, brief)[0]
    };
    assert_eq!(fate("terraced_house", SiteKind::Terraced), Fate::Honored);
    assert_eq!(fate("house", SiteKind::Terraced), Fate::LeftOut);
    assert_eq!(fate("house", SiteKind::FreeStanding), Fate::Honored);
    assert_eq!(fate("flat", SiteKind::FreeStanding), Fate::LeftOut);
    assert_eq!(fate("terraced_house", SiteKind::SemiDetached), Fate::LeftOut);
    assert_eq!(fate("flat", SiteKind::Inside), Fate::Honored);
}
