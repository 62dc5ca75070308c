//! What rules measure, on small worlds whose figures anybody can work out.

use d3dgen_knowledge::compliance::evaluate;
use d3dgen_knowledge::{Query, retrieve};
use d3dgen_model::document::Document;
use d3dgen_model::knowledge::KnowledgeBase;
use d3dgen_model::report::{ConstraintResult, ConstraintSummary, Status};
use d3dgen_model::world::World;
use d3dgen_plugins::Registry;
use serde_json::{Value, json};

type Outline<'a> = &'a [(f64, f64)];
/// Room, object, middle, yaw in quarter turns, width and depth.
type Thing<'a> = (&'a str, &'a str, [f64; 2], u8, [f64; 2]);

/// A building of rooms without thickness of walls: `(id, outline)`; circulation has `corridor` or `hallway` in its id.
struct Building<'a> {
    domain: &'a str,
    country: Option<&'a str>,
    rooms: Vec<(&'a str, Outline<'a>)>,
    /// Line, and the rooms that it joins: one where it leads out.
    doors: Vec<([f64; 4], &'a [&'a str])>,
    objects: Vec<Thing<'a>>,
    persons: u32,
    wheelchair: bool,
}

impl Default for Building<'_> {
    fn default() -> Self {
        let (rooms, doors, objects) = (Vec::new(), Vec::new(), Vec::new());
        Self { domain: "office", country: Some("DE"), rooms, doors, objects, persons: 10, wheelchair: false }
    }
}

fn square(x0: f64, y0: f64, x1: f64, y1: f64) -> [(f64, f64); 4] {
    [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
}

impl Building<'_> {
    fn world(&self) -> World {
        let type_of = |id: &str| id.trim_end_matches(|c: char| c == '_' || c.is_ascii_digit()).to_owned();
        let points = |o: Outline| o.iter().map(|(x, y)| json!({"x": x, "y": y})).collect::<Vec<_>>();
        let area = |o: Outline| {
            let next = |i: usize| o[(i + 1) % o.len()];
            (0..o.len()).map(|i| o[i].0 * next(i).1 - next(i).0 * o[i].1).sum::<f64>() / 2.0
        };
        let moves = |id: &str| id.contains("corridor") || id.contains("hallway");
        let rooms: Vec<Value> = self
            .rooms
            .iter()
            .map(|(id, o)| {
                json!({"room_id": id, "room_type": type_of(id), "name": id, "circulation": moves(id),
                    "polygon": points(o), "net_polygon": points(o), "net_area_m2": area(o), "ceiling_height_m": 2.8,
                    "materials": {"floor": "Oak_Planks", "wall": "Plaster_Wall", "ceiling": "Mortar_White"}})
            })
            .collect();
        let doors: Vec<Value> = self
            .doors
            .iter()
            .enumerate()
            .map(|(n, ([x0, y0, x1, y1], rooms))| {
                json!({"door_id": format!("door_{n}"), "kind": "sliding", "height_m": 2.1, "wall_thickness_m": 0.1,
                    "line": {"start": {"x": x0, "y": y0}, "end": {"x": x1, "y": y1}},
                    "clear_width_m": (x1 - x0).hypot(y1 - y0) - 0.1, "room_ids": rooms, "entrance": rooms.len() == 1 && n == 0,
                    "slide": "beyond_start"})
            })
            .collect();
        let graph_rooms: Vec<Value> = self
            .rooms
            .iter()
            .map(|(id, o)| {
                json!({"id": id, "room_type": type_of(id), "name": id, "description": "for tests", "target_area_m2": area(o),
                    "area_range_m2": [1.0, 500.0], "wished_assets": [], "circulation": moves(id)})
            })
            .collect();
        let placed = |(n, (room, object, [x, y], turn, [width, depth])): (usize, &Thing)| {
            json!({"placement_id": format!("{object}_{n}"), "room_id": room, "object": object, "asset": "x",
                "pose": {"x": x, "y": y, "z": 0.0, "yaw_rad": f64::from(*turn) * std::f64::consts::FRAC_PI_2},
                "size_m": [width, depth, 0.8], "mount": "floor", "rule": "test"})
        };
        let placements: Vec<Value> = self.objects.iter().enumerate().map(placed).collect();
        World::from_value(json!({
            "version": 1, "name": "small", "generator": "test",
            "scene_graph": {"version": 1, "prompt": "small", "seed": 1, "domain": self.domain,
                "country_code": self.country.map(|c| &c[..2]), "division_code": self.country.filter(|c| c.len() > 2),
                "language": "en", "rooms": graph_rooms, "edges": [], "accessible": self.wheelchair,
                "wheelchair": self.wheelchair, "occupancy": {"staff": self.persons}},
            "floorplan": {"version": 1, "seed": 1, "scheme": "straight", "rooms": rooms, "walls": [], "doors": doors,
                "windows": []},
            "placements": {"version": 1, "seed": 1, "placements": placements, "unplaced": []},
            "scenario": {"version": 1, "seed": 1, "rois": [], "pois": [], "robots": [], "agents": []},
        }))
        .expect("a world")
    }

    /// Holds the building against rules.
    fn against(&self, knowledge: &KnowledgeBase) -> (Vec<ConstraintResult>, ConstraintSummary) {
        let registry = Registry::builtin();
        let domain = registry.get(self.domain).expect("a shipped domain").domain();
        let world = self.world();
        let found = retrieve(knowledge, &Query::of_graph(&world.scene_graph, domain));
        evaluate(&world, domain, &found)
    }

    /// Returns what came of one rule.
    fn measured(&self, rule: Value) -> Vec<(String, Status, Option<f64>)> {
        let (results, _) = self.against(&rules(self.domain, self.country.unwrap_or("INT"), vec![rule]));
        results.into_iter().map(|r| (r.subject, r.status, r.measured)).collect()
    }

    fn figure(&self, rule: Value) -> Option<f64> {
        self.measured(rule).first().and_then(|r| r.2)
    }
}

fn rule(name: &str, space: &str, basis: &str, kind: &str, value: f64, unit: &str) -> Value {
    json!({"constraint_id": format!("rule_{name}"), "name": name, "topic": "fire_safety_evacuation", "constraint_type": kind,
        "value": value, "unit": unit, "measurement_basis": basis, "space_type": space, "confidence": "high",
        "verified": "seen", "source_ids": ["s"]})
}

fn rules(domain: &str, place: &str, constraints: Vec<Value>) -> KnowledgeBase {
    KnowledgeBase::from_value(json!({
        "metadata": {"version": 1, "domain": domain, "generated_by": "test", "date": "2026-11-21"},
        "references": [{"ref_id": "r", "building_type": domain, "jurisdiction": place, "retrieved_at": "2026-11-21",
            "sources": [{"source_id": "s", "title": "T", "publisher": "P", "edition_or_year": "2020", "type": "regulation"}],
            "constraints": constraints}]
    }))
    .expect("a knowledge base")
}

#[test]
fn a_dock_needs_a_free_half_circle_and_no_room_has_more_than_it_is_wide() {
    let rule = || rule("dock_clearance_radius_180_approach", "robot_dock", "clear_radius", "minimum", 1.2, "m");
    let room = square(0.0, 0.0, 5.0, 12.0);
    // its back at the south wall, it looks north along the room
    let dock = ("robot_charging_1", "robot_dock", [2.0, 0.2], 1, [0.4, 0.4]);
    let free = Building { rooms: vec![("robot_charging_1", &room)], objects: vec![dock], ..Building::default() };
    assert_eq!(free.figure(rule()), Some(2.0), "the wall at its side is the nearest");
    // a table beside the straight way ahead
    let table = ("robot_charging_1", "meeting_table_4", [3.2, 1.0], 0, [0.6, 0.6]);
    let taken = Building { objects: vec![dock, table], ..free };
    let radius = taken.figure(rule()).expect("a figure");
    assert!((radius - (0.9_f64.hypot(0.3))).abs() < 0.01, "{radius}");
}

#[test]
fn corridors_that_bend_have_two_sides() {
    let rule = || {
        let mut rule = rule("corridor_width", "corridor", "clear_width", "minimum", 1.8, "m");
        rule["conditions"] = json!(["1.5 m single side"]);
        rule
    };
    // an L: east along y 0..2, then north along x 8..10
    let bend: Outline = &[(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (8.0, 10.0), (8.0, 2.0), (0.0, 2.0)];
    let (west, east) = (square(4.0, 4.0, 8.0, 8.0), square(10.0, 4.0, 14.0, 8.0));
    let on_west: ([f64; 4], &[&str]) = ([8.0, 5.0, 8.0, 6.0], &["corridor_1", "office_1"]);
    let on_east: ([f64; 4], &[&str]) = ([10.0, 6.0, 10.0, 7.0], &["corridor_1", "office_2"]);
    let out: ([f64; 4], &[&str]) = ([0.0, 0.5, 0.0, 1.5], &["corridor_1"]);
    let rooms: Vec<(&str, Outline)> = vec![("corridor_1", bend), ("office_1", &west), ("office_2", &east)];
    let both = Building { rooms: rooms.clone(), doors: vec![out, on_west, on_east], ..Building::default() };
    assert_eq!(both.figure(rule()), Some(2.0), "doors face each other in the second leg");
    let one = Building { rooms: rooms.clone(), doors: vec![out, on_west], ..Building::default() };
    assert_eq!(one.figure(rule()), None, "all doors are at one side");
    // the outer wall of the first leg and that of the second face nothing of each other
    let south = square(2.0, -4.0, 6.0, 0.0);
    let apart = Building {
        rooms: vec![("corridor_1", bend), ("office_1", &south), ("office_2", &east)],
        doors: vec![out, ([3.0, 0.0, 4.0, 0.0], &["corridor_1", "office_1"]), on_east],
        ..Building::default()
    };
    assert_eq!(apart.figure(rule()), None, "each leg has doors at one side");
}

#[test]
fn a_walk_is_never_shorter_than_the_straight_line() {
    let room = square(0.0, 0.0, 10.0, 8.0);
    let building = Building {
        rooms: vec![("office_1", &room)],
        doors: vec![([0.0, 0.5, 0.0, 1.5], &["office_1"])],
        ..Building::default()
    };
    let rule =
        rule("walking_to_straight_line_factor", "office", "walking length/straight line", "maximum", 1.5, "ratio");
    let factor = building.figure(rule).expect("a figure");
    assert!((1.0..1.15).contains(&factor), "{factor}");
}

/// A corridor with two exits, and an office behind another on it.
fn office_of_200<'a>(rooms: &'a [[(f64, f64); 4]; 3]) -> Building<'a> {
    Building {
        country: Some("US"),
        persons: 200,
        rooms: vec![("corridor_1", &rooms[0]), ("office_1", &rooms[1]), ("office_2", &rooms[2])],
        doors: vec![
            ([0.0, 0.5, 0.0, 1.5], &["corridor_1"]),
            ([30.0, 0.5, 30.0, 1.5], &["corridor_1"]),
            ([5.0, 2.0, 6.0, 2.0], &["corridor_1", "office_1"]),
            ([5.0, 8.0, 6.0, 8.0], &["office_1", "office_2"]),
        ],
        ..Building::default()
    }
}

#[test]
fn the_common_path_ends_where_one_can_choose() {
    let rooms = [square(0.0, 0.0, 30.0, 2.0), square(0.0, 2.0, 10.0, 8.0), square(0.0, 8.0, 10.0, 14.0)];
    let rule = || rule("common_path_business", "office", "walking_path", "maximum", 22.86, "m");
    let way = office_of_200(&rooms).figure(rule()).expect("evaluated though there are two exits");
    // from the corner of the far office through both doors: about 6 and 6 m and a bit aside
    assert!((12.0..15.5).contains(&way), "{way}");
    let mut single = office_of_200(&rooms);
    single.doors.remove(1);
    let to_exit = single.figure(rule()).expect("with one exit it is the way out");
    assert!(to_exit > way + 3.0, "{to_exit}");
}

#[test]
fn dead_ends_are_found_in_corridors_that_bend() {
    let rule = || rule("dead_end_corridor", "corridor", "length", "maximum", 6.096, "m");
    let bend: Outline = &[(0.0, 0.0), (20.0, 0.0), (20.0, 10.0), (18.0, 10.0), (18.0, 2.0), (0.0, 2.0)];
    let building = |exits: [[f64; 4]; 2]| Building {
        country: Some("US"),
        persons: 200,
        rooms: vec![("corridor_1", bend)],
        doors: vec![(exits[0], &["corridor_1"]), (exits[1], &["corridor_1"])],
        ..Building::default()
    };
    let at_both_ends = building([[0.0, 0.5, 0.0, 1.5], [18.5, 10.0, 19.5, 10.0]]).figure(rule()).expect("a figure");
    assert!(at_both_ends < 1.0, "{at_both_ends}");
    let at_one_end = building([[0.0, 0.5, 0.0, 1.5], [2.0, 0.0, 3.0, 0.0]]).figure(rule()).expect("a figure");
    // 16.5 m east and 9 m north of the last exit, round the corner
    assert!((21.0..27.0).contains(&at_one_end), "{at_one_end}");
}

#[test]
fn the_door_of_a_washroom_is_none_of_a_cell() {
    let rule = || rule("toilet_cell_door_width", "toilet", "clear_opening", "minimum", 0.55, "m");
    let room = square(0.0, 0.0, 4.0, 4.0);
    let washroom = Building {
        rooms: vec![("toilet_1", &room)],
        doors: vec![([0.0, 0.5, 0.0, 1.6], &["toilet_1"])],
        objects: vec![("toilet_1", "wc_cubicle", [3.0, 3.0], 0, [0.9, 1.5])],
        ..Building::default()
    };
    assert_eq!(washroom.measured(rule()), []);
    let cell = Building { objects: Vec::new(), ..washroom };
    assert_eq!(cell.figure(rule()), Some(1.0));
}

#[test]
fn a_garage_is_no_part_of_a_dwelling() {
    let (flat, hall, garage) =
        (square(0.0, 0.0, 8.0, 10.0), square(8.0, 0.0, 10.0, 10.0), square(10.0, 0.0, 16.0, 10.0));
    let home = Building {
        domain: "residential",
        rooms: vec![("living_room_1", &flat), ("hallway_1", &hall), ("garage_1", &garage)],
        doors: vec![([8.0, 1.0, 8.0, 2.0], &["living_room_1", "hallway_1"]), ([9.0, 0.0, 9.9, 0.0], &["hallway_1"])],
        ..Building::default()
    };
    let share =
        rule("circulation_share_of_dwelling", "hallway", "circulation/net internal area", "maximum", 0.15, "ratio");
    assert_eq!(home.figure(share), Some(0.2));
    let area = rule("dwelling_area", "dwelling", "internal_area", "minimum", 40.0, "m^2");
    assert_eq!(home.figure(area), Some(100.0));
}

#[test]
fn homes_for_wheelchairs_are_another_matter_than_homes_without_steps() {
    let room = square(0.0, 0.0, 4.0, 4.0);
    let mut asked = rule("turning_circle", "bedroom", "diameter", "minimum", 1.5, "m");
    asked["conditions"] = json!(["wheelchair (R)"]);
    for (wheelchair, applies) in [(false, 0), (true, 1)] {
        let home =
            Building { domain: "residential", rooms: vec![("bedroom_1", &room)], wheelchair, ..Building::default() };
        assert_eq!(home.measured(asked.clone()).len(), applies, "wheelchair {wheelchair}");
    }
}

#[test]
fn an_office_is_not_both_too_large_and_too_small() {
    let registry = Registry::builtin();
    let shipped = registry.get("office").expect("a shipped domain").knowledge();
    for side in [2.9, 3.2, 3.6] {
        let room = square(0.0, 0.0, side, side);
        let office = Building {
            rooms: vec![("private_office_1", &room)],
            objects: vec![("private_office_1", "desk", [1.0, 1.0], 0, [1.6, 0.8])],
            ..Building::default()
        };
        let (results, _) = office.against(shipped);
        let broken = results.iter().filter(|r| r.status == Status::Violated && r.unit == "m^2");
        let ways: std::collections::BTreeSet<bool> =
            broken.filter(|r| r.citation.source.title.contains("A1.2")).map(|r| r.measured < r.required_min).collect();
        assert!(ways.len() < 2, "{side} m: {ways:?}");
    }
}

#[test]
fn worlds_without_robots_break_none_of_their_rules() {
    let registry = Registry::builtin();
    let room = square(0.0, 0.0, 5.0, 5.0);
    for domain in ["office", "hospital", "residential"] {
        let building = Building { domain, rooms: vec![("storage_1", &room)], ..Building::default() };
        let (results, _) = building.against(registry.get(domain).expect("a shipped domain").knowledge());
        let about_robots = results.iter().filter(|r| {
            let title = &r.citation.source.title;
            title.contains("Nav2") || title.contains("ISO 1385") || title.contains("manual") || title.contains("RMF")
        });
        assert_eq!(about_robots.map(|r| &r.constraint_id).collect::<Vec<_>>(), Vec::<&String>::new(), "{domain}");
    }
}

#[test]
fn reports_count_what_the_law_of_the_country_says() {
    let room = square(0.0, 0.0, 4.0, 4.0);
    let office = |country| Building { country, rooms: vec![("office_1", &room)], ..Building::default() };
    let knowledge = rules(
        "office",
        "DE",
        vec![
            rule("office_area", "office", "net_floor_area", "minimum", 8.0, "m^2"),
            rule("office_light", "office", "illuminance", "minimum", 500.0, "lx"),
        ],
    );
    for (country, counts) in [(Some("DE"), (2, 1)), (Some("DE-BY"), (2, 1)), (Some("PL"), (0, 0)), (None, (0, 0))] {
        let (_, summary) = office(country).against(&knowledge);
        assert_eq!((summary.national_mandatory, summary.national_decided), counts, "{country:?}");
    }
}

#[test]
fn countries_that_had_no_law_of_their_own_have_some_that_is_decided() {
    let registry = Registry::builtin();
    let knowledge = registry.get("office").expect("a shipped domain").knowledge();
    let rooms = [square(0.0, 0.0, 30.0, 2.0), square(0.0, 2.0, 30.0, 8.0), square(0.0, 8.0, 30.0, 14.0)];
    for country in ["BR", "ES", "IT", "KR", "PL"] {
        let office = Building { country: Some(country), ..office_of_200(&rooms) };
        let (results, summary) = office.against(knowledge);
        assert!(summary.national_decided >= 1, "{country}: {summary:?}");
        let own = |r: &&ConstraintResult| r.citation.jurisdiction == country && r.mandatory;
        for result in results.iter().filter(own) {
            assert!(result.citation.seen_at.is_some() && result.citation.clause.is_some(), "{result:?}");
        }
    }
}

#[test]
fn pages_that_nothing_vouches_for_steer_no_plan() {
    let registry = Registry::builtin();
    let domain = registry.get("office").expect("a shipped domain").domain();
    let room = square(0.0, 0.0, 4.0, 2.0);
    let world = Building { rooms: vec![("corridor_1", &room)], ..Building::default() }.world();
    for (source_type, verified, steers) in
        [("regulation", "seen", true), ("web_page", "seen", false), ("regulation", "partly_seen", false)]
    {
        let mut asked = rule("corridor_width", "corridor", "clear_width", "minimum", 2.6, "m");
        asked["verified"] = json!(verified);
        let mut knowledge = rules("office", "DE", vec![asked]);
        knowledge.references[0].sources[0].source_type = source_type.into();
        let found = retrieve(&knowledge, &Query::of_graph(&world.scene_graph, domain));
        let told = (found.limits.corridor_width.is_some(), found.limits.corridor_width_advised.is_some());
        assert_eq!(told, (steers, steers), "{source_type}, {verified}");
    }
}
