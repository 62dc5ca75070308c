//! A small flat for tests: seven rooms, one of them L-shaped, with doors of every kind and something of most builds.

use d3dgen_model::Document;
use d3dgen_model::domain::{Domain, Materials, Shape};
use d3dgen_model::floorplan::{Door, DoorKind, Floorplan, PlanRoom, Slide, Swing, Wall, Window};
use d3dgen_model::geometry::{Point, Polygon, Pose, Segment};
use d3dgen_model::placements::{Placement, Placements};
use d3dgen_model::scenario::Scenario;
use d3dgen_model::world::World;
use serde_json::{Value, json};

/// Every build there is; a test compares it with the schema.
pub const ALL_SHAPES: [Shape; 38] = {
    use Shape::*;
    [
        Box,
        Cabinet,
        Shelf,
        Table,
        RoundTable,
        Desk,
        Chair,
        SwivelChair,
        Stool,
        Sofa,
        Bench,
        Bed,
        HospitalBed,
        Counter,
        Sink,
        Basin,
        Toilet,
        Bathtub,
        Shower,
        Cubicle,
        Panel,
        Trolley,
        Pole,
        Plant,
        Lamp,
        Appliance,
        Stove,
        Rug,
        Curtain,
        Dock,
        Cylinder,
        Vehicle,
        Scanner,
        Rack,
        Stairs,
        Pool,
        Track,
        Stall,
    ]
};

/// id, shape, size, mount, color, material, affordance.
type Object = (&'static str, &'static str, [f64; 3], &'static str, &'static str, &'static str, &'static str);

const OBJECTS: [Object; 29] = [
    ("double_bed", "bed", [1.6, 2.05, 0.95], "floor", "#8a6f52", "wood", "lie"),
    ("single_bed", "bed", [0.9, 2.05, 0.9], "floor", "#8a6f52", "wood", "lie"),
    ("nightstand", "cabinet", [0.45, 0.4, 0.5], "floor", "#8a6f52", "wood", "touch"),
    ("wardrobe", "cabinet", [1.8, 0.6, 2.1], "floor", "#d8d2c4", "wood", "touch"),
    ("sofa", "sofa", [2.1, 0.9, 0.8], "floor", "#6b7f8c", "fabric", "sit"),
    ("coffee_table", "table", [1.0, 0.6, 0.42], "floor", "#a98b66", "wood", "touch"),
    ("dining_table", "table", [1.6, 0.9, 0.75], "floor", "#a98b66", "wood", "touch"),
    ("chair", "chair", [0.45, 0.5, 0.88], "floor", "#c9b08c", "wood", "sit"),
    ("desk", "desk", [1.2, 0.6, 0.74], "floor", "#e3dccd", "wood", "operate"),
    ("office_chair", "swivel_chair", [0.6, 0.6, 1.0], "floor", "#333d47", "fabric", "sit"),
    ("monitor", "panel", [0.55, 0.2, 0.42], "surface", "#202020", "plastic", "see"),
    ("tv", "panel", [1.2, 0.06, 0.7], "wall", "black", "plastic", "see"),
    ("bookshelf", "shelf", [0.9, 0.3, 1.9], "floor", "#a98b66", "wood", "touch"),
    ("plant", "plant", [0.5, 0.5, 1.2], "floor", "#b5673d", "ceramic", "see"),
    ("rug", "rug", [2.0, 1.4, 0.015], "floor", "#c8b6a6", "fabric", ""),
    ("floor_lamp", "lamp", [0.4, 0.4, 1.6], "floor", "#f0e2b6", "metal", "touch"),
    ("ceiling_lamp", "lamp", [0.5, 0.5, 0.3], "ceiling", "#f0e2b6", "glass", "see"),
    ("kitchen_counter", "counter", [1.2, 0.6, 0.9], "floor", "#e8e8e4", "wood", "operate"),
    ("kitchen_sink", "sink", [0.8, 0.6, 1.1], "floor", "#dfe3e6", "metal", "operate"),
    ("stove", "stove", [0.6, 0.6, 0.9], "floor", "#c0c4c8", "metal", "operate"),
    ("refrigerator", "appliance", [0.6, 0.65, 1.85], "floor", "#e6e8ea", "metal", "operate"),
    ("toilet", "toilet", [0.38, 0.68, 0.8], "floor", "#f4f4f4", "ceramic", "sit"),
    ("washbasin", "basin", [0.6, 0.48, 0.95], "floor", "#f4f4f4", "ceramic", "operate"),
    ("bathtub", "bathtub", [1.7, 0.75, 0.58], "floor", "#f4f4f4", "ceramic", "lie"),
    ("mirror", "panel", [0.6, 0.03, 0.8], "wall", "#cfe3ea", "glass", "see"),
    ("curtain", "curtain", [1.6, 0.1, 2.2], "wall", "#d9cfc0", "fabric", "touch"),
    ("coat_rack", "pole", [0.4, 0.4, 1.7], "floor", "#5a4632", "wood", "touch"),
    ("charging_dock", "dock", [0.4, 0.3, 0.35], "floor", "#30343a", "plastic", ""),
    ("stool", "stool", [0.4, 0.4, 0.65], "floor", "#c9b08c", "wood", "sit"),
];

/// Returns a domain with the room and object types of the sample.
pub fn domain() -> Domain {
    let room_type = |id: &str, zone: &str, privacy: &str, robot: Value| {
        json!({
            "id": id, "label": id, "description": format!("A {id}."), "zone": zone, "privacy": privacy,
            "area_m2": {"min": 2.0, "target": 12.0, "max": 60.0}, "min_dimension_m": 1.0, "daylight": "preferred",
            "access": "circulation", "door_width_m": 0.9, "ceiling_height_m": 2.6,
            "materials": {"floor": "Oak_Planks", "wall": "Plaster_Wall", "ceiling": "Mortar_White"}, "robot": robot,
        })
    };
    let mut objects: Vec<Value> = OBJECTS
        .iter()
        .map(|(id, shape, size, mount, color, material, affordance)| {
            let mut object = json!({
                "id": id, "label": id.replace('_', " "), "sizes_m": [size], "mount": mount, "shape": shape, "color": color,
                "material": material, "affordances": if affordance.is_empty() { vec![] } else { vec![affordance] },
            });
            if matches!(*mount, "wall" | "ceiling") {
                object["mount_height_m"] = json!(1.2);
            }
            object
        })
        .collect();
    objects.extend(ALL_SHAPES.iter().map(|shape| {
        json!({"id": shape_id(*shape), "label": format!("any {}", shape_id(*shape)), "sizes_m": [[1.0, 1.0, 1.0]],
            "mount": "floor", "shape": shape, "color": "#b9a58c", "material": "wood"})
    }));
    let value = json!({
        "version": 1, "id": "sample", "title": "Sample", "description": "For tests.",
        "circulation": {"room_type": "hallway", "width_m": 1.2, "entrance_width_m": 1.0, "schemes": ["straight"]},
        "room_types": [
            room_type("hallway", "circulation", "public", json!(["cleaning_high"])),
            room_type("living_room", "day", "public", json!(["service", "charging"])),
            room_type("bedroom", "night", "private", json!(["cleaning_low"])),
            room_type("kitchen", "service", "shared", json!([])),
            room_type("bathroom", "service", "private", json!(["keep_out"])),
            room_type("balcony", "outdoor", "private", json!([])),
            room_type("room", "day", "private", json!([])),
        ],
        "programs": [{"id": "flat", "title": "Flat", "default_rooms": 4, "rooms": [{"room_type": "bedroom", "min": 1, "max": 3}]}],
        "objects": objects,
    });
    Domain::from_value(value).unwrap()
}

/// Returns the object id under which the sample domain knows a build in a 1 m cube.
pub fn shape_id(shape: Shape) -> String {
    format!("any_{}", serde_json::to_value(shape).unwrap().as_str().unwrap())
}

/// Returns the furnished flat.
pub fn world() -> World {
    let floorplan = floorplan();
    let placements = Placements { version: 1, seed: 7, placements: furniture(), unplaced: vec![] };
    assemble(floorplan, placements)
}

/// Returns a world from a plan and its furniture, with the sample's scenario.
pub fn assemble(floorplan: Floorplan, placements: Placements) -> World {
    let rooms: Vec<Value> = floorplan
        .rooms
        .iter()
        .map(|r| {
            json!({"id": r.room_id, "room_type": r.room_type, "name": r.name, "description": format!("{}: for tests.", r.name),
                "target_area_m2": 10.0, "area_range_m2": [1.0, 500.0], "wished_assets": [], "circulation": r.circulation})
        })
        .collect();
    let graph = json!({
        "version": 1, "prompt": "flat with two bedrooms for a cleaning robot", "seed": 7, "domain": "sample",
        "country_code": "DE", "language": "en", "rooms": rooms, "edges": [],
    });
    let world = World {
        version: 1,
        name: "sample_flat".into(),
        generator: "d3dgen test".into(),
        brief: None,
        scene_graph: Document::from_value(graph).unwrap(),
        floorplan,
        placements,
        scenario: scenario(),
        rules: None,
    };
    assert_eq!(world.check(), vec![]);
    world
}

fn scenario() -> Scenario {
    let square = |x: f64, y: f64, w: f64, h: f64| json!([{"x": x, "y": y}, {"x": x + w, "y": y}, {"x": x + w, "y": y + h}, {"x": x, "y": y + h}]);
    let robot = json!({"kind": "cleaning", "count": 1, "radius_m": 0.2, "height_m": 0.4, "charging": true});
    let pose = |x: f64, y: f64, yaw: f64| json!({"x": x, "y": y, "z": 0.0, "yaw_rad": yaw});
    let value = json!({
        "version": 1, "seed": 7,
        "rois": [
            {"roi_id": "cleaning_zone_living_room_1", "kind": "cleaning_zone", "room_id": "living_room_1", "polygon": square(4.6, 6.3, 5.2, 1.5)},
            {"roi_id": "service_zone_kitchen_1", "kind": "service_zone", "room_id": "kitchen_1", "polygon": square(7.4, 1.0, 1.2, 1.2)},
            {"roi_id": "charging_buffer_1", "kind": "charging_buffer", "room_id": "living_room_1", "polygon": square(9.0, 3.5, 0.85, 1.1)},
            {"roi_id": "keep_out_bathroom_1", "kind": "keep_out", "room_id": "bathroom_1", "polygon": square(0.12, 0.12, 2.42, 3.22)},
        ],
        "pois": [
            {"poi_id": "dock_1", "kind": "dock", "room_id": "living_room_1", "pose": pose(9.4, 4.1, -std::f64::consts::FRAC_PI_2)},
            {"poi_id": "service_1", "kind": "service_point", "room_id": "kitchen_1", "pose": pose(8.2, 1.6, 0.0)},
        ],
        "robots": [{"robot_id": "cleaning_robot_1", "robot": robot, "start": pose(8.2, 5.2, 0.0), "goals": ["service_1"], "dock": "dock_1"}],
        "agents": [{"agent_id": "resident_1", "role": "resident", "model": "Residential/resident_1", "speed_m_s": 1.1,
            "start": pose(3.0, 4.0, 0.0), "waypoints": ["living_room_1", "kitchen_1"],
            "steps": [{"room_id": "kitchen_1", "act": "operate", "pose": pose(8.2, 1.6, 0.0), "seconds": 20.0}]}],
        "flows": [{"flow_id": "visitor_flow_1", "role": "visitor", "model": "Residential/visitor_1", "speed_m_s": 1.0,
            "door_id": "door_1", "room_id": "hallway_1", "pose": pose(0.8, 4.0, 0.0), "per_min": 0.6, "most": 2, "group": [1, 2],
            "itineraries": [{"steps": [{"room_id": "kitchen_1", "pose": pose(8.2, 1.6, 0.0), "seconds": 60.0}]}]}],
    });
    Document::from_value(value).unwrap()
}

/// Returns the plan: 10 x 8 m with a balcony.
pub fn floorplan() -> Floorplan {
    type Outline = &'static [(f64, f64)];
    let rooms: [(&str, &str, Outline); 7] = [
        ("hallway_1", "Hallway", &[(0., 3.4), (6.5, 3.4), (6.5, 4.7), (0., 4.7)]),
        ("living_room_1", "Living room", &[(6.5, 3.4), (10., 3.4), (10., 8.), (4.5, 8.), (4.5, 4.7), (6.5, 4.7)]),
        ("bedroom_1", "Bedroom 1", &[(0., 4.7), (4.5, 4.7), (4.5, 8.), (0., 8.)]),
        ("kitchen_1", "Kitchen", &[(6.5, 0.), (10., 0.), (10., 3.4), (6.5, 3.4)]),
        ("bedroom_2", "Bedroom 2", &[(2.6, 0.), (6.5, 0.), (6.5, 3.4), (2.6, 3.4)]),
        ("bathroom_1", "Bathroom", &[(0., 0.), (2.6, 0.), (2.6, 3.4), (0., 3.4)]),
        ("balcony_1", "Balcony", &[(10., 4.7), (11.5, 4.7), (11.5, 8.), (10., 8.)]),
    ];
    let outlines: Vec<(String, Polygon)> = rooms
        .iter()
        .map(|(id, _, corners)| ((*id).to_owned(), Polygon(corners.iter().map(|&(x, y)| Point::new(x, y)).collect())))
        .collect();
    let doors = doors();
    let windows = windows();
    let cuts: Vec<Segment> = doors.iter().map(|d| d.line).chain(windows.iter().map(|w| w.line)).collect();
    let walls = walls(&outlines, &cuts);
    let rooms = rooms
        .iter()
        .zip(&outlines)
        .map(|((id, name, _), (_, polygon))| {
            let net_polygon = inset(polygon, &outlines);
            PlanRoom {
                room_id: (*id).to_owned(),
                room_type: id.trim_end_matches(|c: char| c == '_' || c.is_ascii_digit()).to_owned(),
                name: (*name).to_owned(),
                circulation: id.starts_with("hallway"),
                polygon: polygon.clone(),
                net_area_m2: net_polygon.area(),
                net_polygon,
                ceiling_height_m: 2.6,
                materials: Materials {
                    floor: "Oak_Planks".into(),
                    wall: "Plaster_Wall".into(),
                    ceiling: "Mortar_White".into(),
                },
                locked: false,
                level: 0,
            }
        })
        .collect();
    Floorplan {
        version: 1,
        seed: 7,
        scheme: "straight".into(),
        rooms,
        walls,
        doors,
        windows,
        obstacles: Vec::new(),
        cost: vec![],
        conflicts: vec![],
        levels: vec![],
        links: vec![],
    }
}

fn segment(x0: f64, y0: f64, x1: f64, y1: f64) -> Segment {
    Segment { start: Point::new(x0, y0), end: Point::new(x1, y1) }
}

fn doors() -> Vec<Door> {
    let door = |id: &str, kind, line: Segment, rooms: &[&str], swing: Option<(&str, bool)>| Door {
        door_id: id.into(),
        kind,
        line,
        clear_width_m: line.length() - 0.1,
        height_m: 2.05,
        wall_thickness_m: if rooms.len() == 1 || rooms.contains(&"balcony_1") { 0.24 } else { 0.12 },
        room_ids: rooms.iter().map(|r| (*r).to_owned()).collect(),
        entrance: rooms.len() == 1,
        swing: swing.map(|(room, hinge_at_start)| Swing { into_room_id: Some(room.into()), hinge_at_start }),
        slide: (kind == Sliding).then_some(Slide::BeyondStart),
        automatic: false,
        locked: false,
    };
    use DoorKind::*;
    vec![
        door("door_1", DoubleHinged, segment(0., 3.5, 0., 4.6), &["hallway_1"], Some(("hallway_1", true))),
        door("door_2", Hinged, segment(0.4, 4.7, 1.3, 4.7), &["hallway_1", "bedroom_1"], Some(("bedroom_1", true))),
        door("door_3", Hinged, segment(1.5, 3.4, 2.4, 3.4), &["hallway_1", "bathroom_1"], Some(("bathroom_1", false))),
        door("door_4", Hinged, segment(5.4, 3.4, 6.3, 3.4), &["hallway_1", "bedroom_2"], Some(("bedroom_2", false))),
        door("door_5", Open, segment(6.5, 3.5, 6.5, 4.6), &["hallway_1", "living_room_1"], None),
        door("door_6", Sliding, segment(7.0, 3.4, 8.0, 3.4), &["living_room_1", "kitchen_1"], None),
        door(
            "door_7",
            Hinged,
            segment(10., 5.4, 10., 6.3),
            &["living_room_1", "balcony_1"],
            Some(("balcony_1", false)),
        ),
    ]
}

fn windows() -> Vec<Window> {
    let window = |n: usize, line: Segment, room: &str| Window {
        window_id: format!("window_{n}"),
        line,
        sill_m: 0.9,
        head_m: 2.2,
        wall_thickness_m: 0.24,
        room_id: room.into(),
        locked: false,
    };
    vec![
        window(1, segment(1.5, 8., 3.3, 8.), "bedroom_1"),
        window(2, segment(5.6, 8., 8.4, 8.), "living_room_1"),
        window(3, segment(3.6, 0., 5.2, 0.), "bedroom_2"),
        window(4, segment(7.6, 0., 9., 0.), "kitchen_1"),
        window(5, segment(0., 1.2, 0., 2.0), "bathroom_1"),
    ]
}

/// Walls between every two different neighbors of the cells that all corners span, less the openings.
fn walls(rooms: &[(String, Polygon)], openings: &[Segment]) -> Vec<Wall> {
    let owner = |p: Point| rooms.iter().find(|(_, polygon)| polygon.contains(p)).map(|(id, _)| id.clone());
    let coordinate = |p: &Point, vertical: bool| if vertical { (p.x, p.y) } else { (p.y, p.x) };
    let point = |across: f64, along: f64, vertical: bool| {
        if vertical { Point::new(across, along) } else { Point::new(along, across) }
    };
    let mut walls: Vec<Wall> = Vec::new();
    for vertical in [true, false] {
        let corners = rooms.iter().flat_map(|(_, p)| p.corners()).map(|p| coordinate(p, vertical));
        let ends = openings.iter().flat_map(|s| [s.start, s.end]).map(|p| coordinate(&p, vertical));
        let mut across: Vec<f64> = corners.clone().map(|c| c.0).collect();
        let mut along: Vec<f64> = corners.chain(ends).map(|c| c.1).collect();
        for list in [&mut across, &mut along] {
            list.sort_by(f64::total_cmp);
            list.dedup();
        }
        for a in across {
            for pair in along.windows(2) {
                let middle = point(a, (pair[0] + pair[1]) / 2.0, vertical);
                let side = |s: f64| owner(point(a + s, (pair[0] + pair[1]) / 2.0, vertical));
                let (left, right) = (side(-0.01), side(0.01));
                let open =
                    openings.iter().any(|s| s.start.distance(middle) + middle.distance(s.end) < s.length() + 1e-6);
                if left == right || open {
                    continue;
                }
                let exterior = left.is_none()
                    || right.is_none()
                    || [&left, &right].iter().any(|r| r.as_deref() == Some("balcony_1"));
                let room_ids: Vec<String> = left.into_iter().chain(right).collect();
                let line = Segment { start: point(a, pair[0], vertical), end: point(a, pair[1], vertical) };
                match walls.last_mut() {
                    Some(last) if last.room_ids == room_ids && last.line.end == line.start => last.line.end = line.end,
                    _ => walls.push(Wall {
                        wall_id: format!("wall_{}", walls.len() + 1),
                        line,
                        thickness_m: if exterior { 0.24 } else { 0.12 },
                        room_ids,
                        exterior,
                        locked: false,
                    }),
                }
            }
        }
    }
    walls
}

/// Moves every edge inwards by half the thickness of its wall.
fn inset(polygon: &Polygon, rooms: &[(String, Polygon)]) -> Polygon {
    let edges: Vec<Segment> = polygon.edges().collect();
    let shifted: Vec<(bool, f64)> = edges
        .iter()
        .map(|e| {
            let (m, vertical) = (e.middle(), e.is_vertical());
            let inward = if vertical { (e.start.y - e.end.y).signum() } else { (e.end.x - e.start.x).signum() };
            let beyond = |s: f64| if vertical { Point::new(m.x + s, m.y) } else { Point::new(m.x, m.y + s) };
            let outside = !rooms.iter().any(|(_, p)| p.contains(beyond(-inward * 0.01)));
            let half = if outside { 0.12 } else { 0.06 };
            (vertical, if vertical { m.x } else { m.y } + inward * half)
        })
        .collect();
    let n = edges.len();
    let corner = |i: usize| {
        let (a, b) = (shifted[(i + n - 1) % n], shifted[i]);
        if a.0 { Point::new(a.1, b.1) } else { Point::new(b.1, a.1) }
    };
    Polygon((0..n).map(corner).collect())
}

/// Returns an object of the sample domain at a place, turned by quarter turns (0: its front looks east).
pub fn place(room: &str, object: &str, n: usize, at: (f64, f64, f64), quarters: u8, on: Option<&str>) -> Placement {
    let entry = OBJECTS.iter().find(|o| o.0 == object).unwrap();
    Placement {
        placement_id: format!("{room}_{object}_{n}"),
        room_id: room.into(),
        object: object.into(),
        asset: format!("Sample/{}", object.split('_').map(capital).collect::<Vec<_>>().join("_")),
        asset_choice: None,
        pose: Pose { x: at.0, y: at.1, z: at.2, yaw_rad: f64::from(quarters) * std::f64::consts::FRAC_PI_2 },
        size_m: entry.2,
        mount: serde_json::from_value(json!(entry.3)).unwrap(),
        support: on.map(str::to_owned),
        group: None,
        rule: "sample".into(),
        locked: false,
    }
}

fn capital(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map(|c| c.to_uppercase().collect::<String>() + letters.as_str()).unwrap_or_default()
}

fn furniture() -> Vec<Placement> {
    let (east, north, west, south) = (0, 1, 2, 3);
    vec![
        place("hallway_1", "coat_rack", 1, (3.4, 4.4, 0.), south, None),
        place("living_room_1", "rug", 1, (7.0, 6.6, 0.), south, None),
        place("living_room_1", "sofa", 1, (7.0, 7.4, 0.), south, None),
        place("living_room_1", "coffee_table", 1, (7.0, 6.4, 0.), south, None),
        place("living_room_1", "floor_lamp", 1, (8.45, 7.6, 0.), south, None),
        place("living_room_1", "bookshelf", 1, (4.71, 6.4, 0.), east, None),
        place("living_room_1", "plant", 1, (4.9, 7.55, 0.), south, None),
        place("living_room_1", "ceiling_lamp", 1, (7.0, 6.4, 2.3), south, None),
        place("living_room_1", "tv", 1, (5.4, 4.79, 1.2), north, None),
        place("living_room_1", "charging_dock", 1, (9.4, 3.62, 0.), north, None),
        place("bedroom_1", "double_bed", 1, (3.41, 6.2, 0.), west, None),
        place("bedroom_1", "nightstand", 1, (4.24, 5.12, 0.), west, None),
        place("bedroom_1", "nightstand", 2, (4.24, 7.28, 0.), west, None),
        place("bedroom_1", "wardrobe", 1, (0.43, 6.9, 0.), east, None),
        place("bedroom_1", "curtain", 1, (2.4, 7.83, 0.1), south, None),
        place("kitchen_1", "refrigerator", 1, (9.55, 2.95, 0.), west, None),
        place("kitchen_1", "kitchen_counter", 1, (9.58, 2.02, 0.), west, None),
        place("kitchen_1", "stove", 1, (9.58, 1.11, 0.), west, None),
        place("kitchen_1", "kitchen_sink", 1, (9.18, 0.42, 0.), north, None),
        place("kitchen_1", "dining_table", 1, (7.01, 1.0, 0.), east, None),
        place("kitchen_1", "chair", 1, (7.72, 0.65, 0.), west, None),
        place("kitchen_1", "chair", 2, (7.72, 1.4, 0.), west, None),
        place("kitchen_1", "stool", 1, (7.01, 2.05, 0.), south, None),
        place("bedroom_2", "single_bed", 1, (3.12, 1.16, 0.), north, None),
        place("bedroom_2", "desk", 1, (5.8, 0.43, 0.), north, None),
        place("bedroom_2", "monitor", 1, (5.8, 0.3, 0.74), north, Some("bedroom_2_desk_1")),
        place("bedroom_2", "office_chair", 1, (5.8, 1.1, 0.), south, None),
        place("bathroom_1", "bathtub", 1, (1.32, 0.5, 0.), north, None),
        place("bathroom_1", "toilet", 1, (0.47, 2.7, 0.), east, None),
        place("bathroom_1", "washbasin", 1, (2.3, 1.6, 0.), west, None),
        place("bathroom_1", "mirror", 1, (2.52, 1.6, 1.1), west, None),
    ]
}

/// Returns a hall with one object of every build, six to a row, turned in all four directions.
pub fn catalogue() -> World {
    let sizes: [(Shape, [f64; 3]); 38] = [
        (Shape::Box, [0.8, 0.5, 0.5]),
        (Shape::Cabinet, [1.2, 0.45, 1.8]),
        (Shape::Shelf, [1.2, 0.4, 1.8]),
        (Shape::Table, [1.6, 0.9, 0.75]),
        (Shape::RoundTable, [1.1, 1.1, 0.75]),
        (Shape::Desk, [1.6, 0.8, 0.74]),
        (Shape::Chair, [0.45, 0.5, 0.88]),
        (Shape::SwivelChair, [0.62, 0.62, 1.0]),
        (Shape::Stool, [0.4, 0.4, 0.6]),
        (Shape::Sofa, [2.1, 0.9, 0.8]),
        (Shape::Bench, [1.8, 0.55, 0.8]),
        (Shape::Bed, [1.6, 2.05, 0.95]),
        (Shape::HospitalBed, [1.0, 2.15, 1.0]),
        (Shape::Counter, [2.4, 0.9, 1.1]),
        (Shape::Sink, [1.2, 0.6, 1.1]),
        (Shape::Basin, [0.6, 0.5, 0.95]),
        (Shape::Toilet, [0.38, 0.7, 0.8]),
        (Shape::Bathtub, [1.7, 0.75, 0.58]),
        (Shape::Shower, [0.9, 0.9, 2.1]),
        (Shape::Cubicle, [0.9, 1.55, 2.0]),
        (Shape::Panel, [1.4, 0.5, 1.5]),
        (Shape::Trolley, [0.5, 0.8, 0.95]),
        (Shape::Pole, [0.6, 0.6, 1.9]),
        (Shape::Plant, [0.6, 0.6, 1.4]),
        (Shape::Lamp, [0.45, 0.45, 1.6]),
        (Shape::Appliance, [0.6, 0.62, 0.85]),
        (Shape::Stove, [0.6, 0.6, 0.9]),
        (Shape::Rug, [2.0, 1.4, 0.01]),
        (Shape::Curtain, [1.8, 0.12, 2.2]),
        (Shape::Dock, [0.5, 0.4, 0.35]),
        (Shape::Cylinder, [0.5, 0.5, 0.7]),
        (Shape::Vehicle, [1.2, 2.4, 2.1]),
        (Shape::Scanner, [1.9, 2.3, 1.9]),
        (Shape::Rack, [2.7, 1.1, 4.0]),
        (Shape::Stairs, [1.0, 2.6, 2.6]),
        (Shape::Pool, [2.0, 2.4, 0.3]),
        (Shape::Track, [2.4, 2.6, 0.25]),
        (Shape::Stall, [1.25, 2.4, 1.2]),
    ];
    let (width, depth) = (18.0, 21.0);
    let hall =
        Polygon(vec![Point::new(0., 0.), Point::new(width, 0.), Point::new(width, depth), Point::new(0., depth)]);
    let mut floorplan = floorplan();
    let outlines = [("living_room_1".to_owned(), hall.clone())];
    floorplan.rooms.retain(|r| r.room_id == "living_room_1");
    floorplan.rooms[0].net_polygon = inset(&hall, &outlines);
    floorplan.rooms[0].net_area_m2 = floorplan.rooms[0].net_polygon.area();
    floorplan.rooms[0].polygon = hall;
    floorplan.windows.clear();
    floorplan.doors.retain(|d| d.entrance);
    floorplan.doors[0].room_ids = vec!["living_room_1".into()];
    floorplan.walls = walls(&outlines, &[floorplan.doors[0].line]);
    let placements = sizes
        .iter()
        .enumerate()
        .map(|(i, (shape, size_m))| Placement {
            placement_id: format!("{}_{i}", shape_id(*shape)),
            object: shape_id(*shape),
            asset: format!("Sample/{shape:?}"),
            pose: Pose {
                x: 1.8 + 2.85 * (i % 6) as f64,
                y: depth - 1.8 - 2.85 * (i / 6) as f64,
                z: 0.0,
                yaw_rad: (i % 4) as f64 * std::f64::consts::FRAC_PI_2,
            },
            size_m: *size_m,
            ..place("living_room_1", "chair", i, (0., 0., 0.), 0, None)
        })
        .collect();
    let mut world = assemble(floorplan, Placements { version: 1, seed: 7, placements, unplaced: vec![] });
    world.scenario.rois.clear();
    world.scenario.pois.clear();
    world.scenario.robots.clear();
    world.scene_graph.rooms.retain(|r| r.id == "living_room_1");
    world
}
