//! A small world made by hand, in which every measure is known by reckoning.
//!
//! Two rooms of 4 m by 3 m between the center lines of walls 0.2 m thick, side by side, joined by a door 1 m wide (0.9 m
//! clear) at x = 4 from y = 1; an entrance in the north wall of the first, a window in the north wall of the second. In the
//! first room a wardrobe, a table with a cup, a clock on the wall and a lamp at the ceiling; a robot that goes to both.

use d3dgen_model::domain::{Materials, Mount};
use d3dgen_model::floorplan::{Door, DoorKind, Floorplan, PlanRoom, Swing, Wall, Window};
use d3dgen_model::placements::{Placement, Placements};
use d3dgen_model::report::{Citation, ConstraintResult, ConstraintSummary, Report, Status};
use d3dgen_model::scenario::{Poi, RobotTask, Scenario};
use d3dgen_model::scene_graph::{Connector, GraphEdge, GraphRoom, Robot, SceneGraph};
use d3dgen_model::world::World;
use d3dgen_model::{Point, Polygon, Pose, Rect, Segment, knowledge::Source};

/// Returns an object on the floor of the first room, facing east.
pub fn thing(object: &str, (x, y): (f64, f64), size_m: [f64; 3]) -> Placement {
    Placement {
        placement_id: format!("{object}_1"),
        room_id: "a_1".into(),
        object: object.into(),
        asset: "Test/Thing".into(),
        asset_choice: None,
        pose: Pose { x, y, z: 0.0, yaw_rad: 0.0 },
        size_m,
        mount: Mount::Floor,
        support: None,
        group: None,
        rule: "by hand".into(),
        locked: false,
    }
}

/// Returns the object of a kind.
pub fn object<'a>(world: &'a World, kind: &str) -> &'a Placement {
    world.placements.placements.iter().find(|p| p.object == kind).expect("the sample has it")
}

/// Returns the object of a kind, to be changed.
pub fn object_mut<'a>(world: &'a mut World, kind: &str) -> &'a mut Placement {
    world.placements.placements.iter_mut().find(|p| p.object == kind).expect("the sample has it")
}

fn rectangle(x0: f64, y0: f64, x1: f64, y1: f64) -> Polygon {
    Polygon(Rect::new(x0, y0, x1, y1).corners().to_vec())
}

fn line(x0: f64, y0: f64, x1: f64, y1: f64) -> Segment {
    Segment { start: Point::new(x0, y0), end: Point::new(x1, y1) }
}

fn room(id: &str, x0: f64) -> PlanRoom {
    PlanRoom {
        room_id: id.into(),
        room_type: "room".into(),
        name: id.into(),
        circulation: false,
        level: 0,
        polygon: rectangle(x0, 0.0, x0 + 4.0, 3.0),
        net_polygon: rectangle(x0 + 0.1, 0.1, x0 + 3.9, 2.9),
        net_area_m2: 3.8 * 2.8,
        ceiling_height_m: 2.5,
        materials: Materials { floor: "wood".into(), wall: "paint".into(), ceiling: "paint".into() },
        locked: false,
    }
}

fn wall(id: &str, line: Segment, rooms: &[&str]) -> Wall {
    let room_ids: Vec<String> = rooms.iter().map(|r| (*r).to_owned()).collect();
    Wall { wall_id: id.into(), line, thickness_m: 0.2, exterior: room_ids.len() == 1, room_ids, locked: false }
}

fn door(id: &str, line: Segment, rooms: &[&str]) -> Door {
    Door {
        door_id: id.into(),
        kind: DoorKind::Hinged,
        line,
        clear_width_m: 0.9,
        height_m: 2.0,
        wall_thickness_m: 0.2,
        room_ids: rooms.iter().map(|r| (*r).to_owned()).collect(),
        entrance: rooms.len() == 1,
        swing: Some(Swing { into_room_id: Some(rooms[0].into()), hinge_at_start: true }),
        slide: None,
        automatic: false,
        locked: false,
    }
}

fn plan() -> Floorplan {
    Floorplan {
        version: 1,
        seed: 7,
        scheme: "hand".into(),
        levels: Vec::new(),
        links: Vec::new(),
        rooms: vec![room("a_1", 0.0), room("b_1", 4.0)],
        walls: vec![
            wall("wall_1", line(0.0, 0.0, 4.0, 0.0), &["a_1"]),
            wall("wall_2", line(4.0, 0.0, 8.0, 0.0), &["b_1"]),
            wall("wall_3", line(8.0, 0.0, 8.0, 3.0), &["b_1"]),
            wall("wall_4", line(4.0, 3.0, 8.0, 3.0), &["b_1"]),
            wall("wall_5", line(0.0, 3.0, 0.5, 3.0), &["a_1"]),
            wall("wall_6", line(1.5, 3.0, 4.0, 3.0), &["a_1"]),
            wall("wall_7", line(0.0, 0.0, 0.0, 3.0), &["a_1"]),
            wall("wall_8", line(4.0, 0.0, 4.0, 1.0), &["a_1", "b_1"]),
            wall("wall_9", line(4.0, 2.0, 4.0, 3.0), &["a_1", "b_1"]),
        ],
        doors: vec![
            door("door_1", line(4.0, 1.0, 4.0, 2.0), &["a_1", "b_1"]),
            door("door_2", line(0.5, 3.0, 1.5, 3.0), &["a_1"]),
        ],
        obstacles: Vec::new(),
        windows: vec![Window {
            window_id: "window_1".into(),
            line: line(5.0, 3.0, 7.0, 3.0),
            sill_m: 0.9,
            head_m: 2.1,
            wall_thickness_m: 0.2,
            room_id: "b_1".into(),
            locked: false,
        }],
        cost: Vec::new(),
        conflicts: Vec::new(),
    }
}

fn objects() -> Vec<Placement> {
    let north = std::f64::consts::FRAC_PI_2;
    let table = thing("table", (2.5, 1.0), [1.2, 0.6, 0.75]);
    let mut wardrobe = thing("wardrobe", (0.7, 0.4), [1.0, 0.6, 2.0]);
    wardrobe.pose.yaw_rad = north;
    let mut cup = thing("cup", (2.5, 1.0), [0.1, 0.1, 0.1]);
    (cup.mount, cup.support, cup.pose.z) = (Mount::Surface, Some("table_1".into()), 0.75);
    let mut clock = thing("clock", (2.5, 2.875), [0.3, 0.05, 0.3]);
    (clock.mount, clock.pose.z, clock.pose.yaw_rad) = (Mount::Wall, 1.8, -north);
    let mut lamp = thing("lamp", (2.0, 2.0), [0.3, 0.3, 0.3]);
    (lamp.mount, lamp.pose.z) = (Mount::Ceiling, 2.2);
    vec![table, wardrobe, cup, clock, lamp]
}

fn graph(robot: &Robot) -> SceneGraph {
    let room = |id: &str| GraphRoom {
        id: id.into(),
        room_type: "room".into(),
        name: id.into(),
        description: String::new(),
        target_area_m2: 10.0,
        area_range_m2: [8.0, 12.0],
        wished_assets: Vec::new(),
        sides_m: None,
        occupants: None,
        circulation: false,
        unit: None,
        garden_door: false,
        level: 0,
        requested: true,
        entrance: id == "a_1",
        locked: false,
    };
    SceneGraph {
        version: 1,
        prompt: "two rooms".into(),
        seed: 7,
        domain: "general".into(),
        building_type: None,
        country_code: Some("DE".into()),
        division_code: None,
        language: "en".into(),
        area_m2: None,
        occupancy: Default::default(),
        wheelchair: false,
        accessible: false,
        style: d3dgen_model::style::Style::default(),
        rooms: vec![room("a_1"), room("b_1")],
        links: Vec::new(),
        edges: vec![GraphEdge {
            a: "a_1".into(),
            b: "b_1".into(),
            connector: Connector::Door,
            required: true,
            reason: "by hand".into(),
        }],
        apart: Vec::new(),
        forbidden_room_types: Vec::new(),
        robots: vec![robot.clone()],
        robot_rules: Vec::new(),
        two_way: false,
        assumptions: Vec::new(),
        conflicts: Vec::new(),
    }
}

/// Returns the world.
pub fn world() -> World {
    let robot = Robot {
        kind: "delivery".into(),
        count: 1,
        radius_m: 0.3,
        height_m: 1.0,
        charging: false,
        body: None,
        stops: Vec::new(),
        room_types: Vec::new(),
        misfit: false,
    };
    let poi = |id: &str, room: &str, x: f64, y: f64| Poi {
        poi_id: id.into(),
        kind: "service_point".into(),
        room_id: room.into(),
        pose: Pose { x, y, z: 0.0, yaw_rad: 0.0 },
    };
    let scenario = Scenario {
        pois: vec![poi("point_a", "a_1", 3.2, 2.2), poi("point_b", "b_1", 6.0, 1.5)],
        robots: vec![RobotTask {
            robot_id: "delivery_robot_1".into(),
            robot: robot.clone(),
            level: 0,
            start: Pose { x: 3.2, y: 2.4, z: 0.0, yaw_rad: 0.0 },
            goals: vec!["point_a".into(), "point_b".into()],
            ways: Vec::new(),
            routes: Vec::new(),
            jobs: Vec::new(),
            dock: None,
            locked: false,
        }],
        ..Scenario::empty(7)
    };
    let placements = Placements { version: 1, seed: 7, placements: objects(), unplaced: Vec::new() };
    let (name, generator) = ("two_rooms".to_owned(), "by hand".to_owned());
    World {
        version: 1,
        name,
        generator,
        brief: None,
        scene_graph: graph(&robot),
        floorplan: plan(),
        placements,
        scenario,
        rules: None,
    }
}

/// Returns a report with these constraints: name, title of the source, force, outcome.
pub fn report(constraints: &[(&str, &str, bool, Status)]) -> Report {
    let result = |(name, title, mandatory, status): &(&str, &str, bool, Status)| ConstraintResult {
        constraint_id: format!("{name}_1"),
        ref_id: "ref".into(),
        name: (*name).into(),
        subject: "building".into(),
        status: *status,
        mandatory: *mandatory,
        measured: None,
        required_min: None,
        required_max: None,
        unit: "m".into(),
        note: String::new(),
        citation: Citation {
            jurisdiction: "DE".into(),
            source: Source {
                source_id: "s1".into(),
                title: (*title).into(),
                publisher: "Publisher".into(),
                edition_or_year: "2020".into(),
                url: None,
                source_type: "standard".into(),
            },
            note: String::new(),
            printed: None,
            confidence: "high".into(),
            ..Citation::default()
        },
    };
    Report {
        version: 1,
        world: "two_rooms".into(),
        sound: true,
        given_plan: false,
        rules: Vec::new(),
        jurisdictions: vec!["DE".into()],
        summary: ConstraintSummary::default(),
        constraints: constraints.iter().map(result).collect(),
        robot_fit: Vec::new(),
        asks: Vec::new(),
        figures: Default::default(),
    }
}

#[test]
fn the_sample_is_a_sound_document() {
    use d3dgen_model::Document;
    assert_eq!(world().check(), []);
    assert_eq!(World::from_json(&world().to_json()).expect("it fits its schema"), world());
}
