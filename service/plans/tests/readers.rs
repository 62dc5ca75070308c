//! The same flat of three rooms in every format, and files that are none.

use std::path::{Path, PathBuf};

use d3dgen_model::document::Document;
use d3dgen_model::floorplan::Floorplan;
use d3dgen_plans::{Error, Options, Plan, Source, assemble, lay_out, read};
use d3dgen_plugins::Registry;

fn plans() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/plans")
}

/// Reads a plan whose rooms are typed by their names: the tests of the words are with the words.
fn plan_of(name: &str, bytes: &[u8], options: &Options) -> Result<(Floorplan, Vec<String>), Error> {
    let companion = |file: &str| std::fs::read(plans().join(file)).ok();
    let registry = Registry::builtin();
    let domain = registry.get("residential").expect("built in").domain();
    match read(&Source { name, bytes, companion: &companion }, options)? {
        Plan::Document(plan) => Ok((plan, Vec::new())),
        Plan::Drawing(drawing) => {
            let layout = lay_out(drawing, options)?;
            let types: Vec<String> = layout
                .rooms
                .iter()
                .map(|r| r.label.to_lowercase().replace(' ', "_").replace("hall", "hallway"))
                .collect();
            let (plan, notes) = assemble(layout, &types, domain, 0, options);
            assert_eq!(plan.check(), Vec::new(), "{name}");
            Ok((plan, notes.into_iter().map(|n| n.code).collect()))
        }
    }
}

fn flat(name: &str, options: &Options) -> (Floorplan, Vec<String>) {
    let bytes = std::fs::read(plans().join(name)).expect("a plan of the tests");
    plan_of(name, &bytes, options).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Walls of the flat are 0.1 m thick; formats that draw lines do not say so.
fn thin() -> Options {
    Options { inner_wall_m: Some(0.1), outer_wall_m: Some(0.1), ..Options::default() }
}

#[test]
fn the_same_flat_is_the_same_in_every_format() {
    // name on the plan, net area in m2
    let rooms = [("Living room", 20.0), ("Bedroom", 17.5), ("Hall", 15.2)];
    for (name, typed, windows, entrance) in [
        ("flat.geojson", true, 2, true),
        ("flat.svg", true, 2, true),
        ("flat.dxf", true, 2, true),
        ("flat.building.yaml", true, 0, true),
        // its entrance is a notch in the outer wall
        ("flat_map.yaml", false, 0, true),
    ] {
        let (plan, _) = flat(name, &thin());
        assert_eq!(plan.rooms.len(), 3, "{name}");
        let find = |label: &str, area: f64| {
            let named = plan.rooms.iter().find(|r| r.name.eq_ignore_ascii_case(label));
            let near = || {
                plan.rooms.iter().min_by(|a, b| (a.net_area_m2 - area).abs().total_cmp(&(b.net_area_m2 - area).abs()))
            };
            if typed { named } else { near() }.unwrap_or_else(|| panic!("{name} has no {label}"))
        };
        for (label, area) in rooms {
            let room = find(label, area);
            let off = (room.net_area_m2 - area).abs() / area;
            assert!(off < 0.02, "{name}: {label} has {} m2, should have {area}", room.net_area_m2);
            let kind = label.to_lowercase().replace(' ', "_").replace("hall", "hallway");
            assert!(!typed || room.room_type == kind, "{name}: {label} is a {}", room.room_type);
            assert!(room.locked);
        }
        let hall = &find("Hall", 15.2).room_id;
        for (label, area) in &rooms[..2] {
            let room = &find(label, *area).room_id;
            let joins = |d: &&d3dgen_model::floorplan::Door| d.room_ids.contains(room) && d.room_ids.contains(hall);
            let doors: Vec<_> = plan.doors.iter().filter(joins).collect();
            assert_eq!(doors.len(), 1, "{name}: doors of {label}");
            assert!((doors[0].line.length() - 0.9).abs() < 0.06, "{name}: {}", doors[0].line.length());
        }
        assert_eq!(plan.doors.iter().filter(|d| d.entrance).count(), usize::from(entrance), "{name}");
        assert_eq!(plan.windows.len(), windows, "{name}");
    }
}

#[test]
fn our_own_document_is_kept_as_it_is() {
    let (mut plan, _) = flat("flat.geojson", &thin());
    plan.scheme = "straight".into();
    plan.rooms[0].locked = false;
    let (back, _) = plan_of("floorplan.json", plan.to_json().as_bytes(), &thin()).expect("our document");
    assert!(back.is_given() && back.rooms.iter().all(|r| r.locked));
    plan.rooms[0].locked = true;
    assert_eq!((back.rooms, back.walls, back.doors, back.windows), (plan.rooms, plan.walls, plan.doors, plan.windows));
}

#[test]
fn a_door_drawn_as_an_arc_swings_as_drawn() {
    let (plan, _) = flat("flat.dxf", &thin());
    let bedroom = plan.rooms.iter().find(|r| r.name == "Bedroom").expect("a bedroom");
    let door = plan.doors_of(&bedroom.room_id).next().expect("its door");
    let swing = door.swing.as_ref().expect("a leaf");
    assert_eq!((swing.into_room_id.as_ref(), swing.hinge_at_start), (Some(&bedroom.room_id), true));
}

#[test]
fn a_sill_as_high_as_the_head_gives_way() {
    // a ceiling of 2.1 m leaves the head at 1.9 m
    let text = String::from_utf8(std::fs::read(plans().join("flat.geojson")).expect("the sample")).expect("text");
    let low = text.replacen("\"Living room\"", "\"Living room\", \"height\": 2.1", 1);
    let window = "\"sill\": 0.9";
    let high = low.replace(window, "\"sill\": 1.9");
    assert!(low != text && high != low, "the sample has such a room and a window");
    let (plan, _) = plan_of("flat.geojson", high.as_bytes(), &thin()).expect("a plan");
    assert!(plan.windows.iter().all(|w| w.sill_m < w.head_m), "{:?}", plan.windows);
}

#[test]
fn a_plan_at_an_angle_is_turned_upright() {
    let svg = r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 900 900"><g transform="rotate(17 400 400)">
        <rect id="kitchen" x="100" y="100" width="400" height="300"/>
        <rect id="bedroom" x="500" y="100" width="300" height="300"/></g></svg>"#;
    let options = Options { meters_per_unit: Some(0.01), ..thin() };
    let (plan, notes) = plan_of("turned.svg", svg.as_bytes(), &options).expect("a plan");
    assert!(notes.contains(&"turned".into()) && notes.contains(&"no_door".into()), "{notes:?}");
    assert!((plan.rooms[0].net_area_m2 - 3.9 * 2.9).abs() < 0.02, "{}", plan.rooms[0].net_area_m2);
    assert!(plan.walls.iter().any(|w| w.room_ids.len() == 2), "the rooms share a wall");
}

#[test]
fn missing_doors_and_windows_are_added_when_asked() {
    let svg = r#"<svg xmlns="http://www.w3.org/2000/svg"><rect id="kitchen" width="400" height="300"/>
        <rect id="bedroom" x="400" width="300" height="300"/><rect id="hall" y="300" width="700" height="150"/></svg>"#;
    let options = Options { meters_per_unit: Some(0.01), add_doors: true, add_windows: true, ..Options::default() };
    let (plan, notes) = plan_of("bare.svg", svg.as_bytes(), &options).expect("a plan");
    assert_eq!((plan.doors.len(), plan.windows.len()), (3, 2), "{notes:?}");
    // a bedroom has to have daylight, a kitchen is better with it, a hall does without
    let lit: Vec<&str> = plan.windows.iter().map(|w| w.room_id.as_str()).collect();
    assert_eq!(lit, ["kitchen_1", "bedroom_1"]);
    let hall = plan.rooms.iter().find(|r| r.room_type == "hallway").expect("the hall");
    assert!(plan.doors.iter().all(|d| d.room_ids.contains(&hall.room_id)));
    assert!(plan.doors.iter().any(|d| d.entrance));
}

#[test]
fn geographic_coordinates_become_meters() {
    let text = r#"{"type":"Feature","properties":{"name":"kitchen"},"geometry":{"type":"Polygon","coordinates":
        [[[8.4,49.0],[8.40006,49.0],[8.40006,49.00004],[8.4,49.00004],[8.4,49.0]]]}}"#;
    let (plan, notes) = plan_of("a.geojson", text.as_bytes(), &thin()).expect("a plan");
    assert!(notes.contains(&"projected".into()));
    // 6e-5 degrees of longitude at 49 degrees north, 4e-5 of latitude
    let b = plan.rooms[0].polygon.bounds();
    assert!((b.width() - 4.39).abs() < 0.01 && (b.height() - 4.45).abs() < 0.01, "{b:?}");
}

#[test]
fn walls_that_lean_are_straightened_and_floors_part_rooms() {
    let (plan, notes) = flat("leaning.building.yaml", &Options { level: Some("L1".into()), ..thin() });
    assert!(notes.contains(&"straightened".into()) && !notes.contains(&"rectified".into()), "{notes:?}");
    let names: Vec<&str> = plan.rooms.iter().map(|r| r.name.as_str()).collect();
    assert_eq!(names, ["meeting room", "lounge", "room_3"], "names of things for robots are no names of rooms");
    let id = |name: &str| plan.rooms.iter().find(|r| r.name == name).map(|r| r.room_id.clone()).expect("a room");
    let (meeting, lounge, hall) = (id("meeting room"), id("lounge"), id("room_3"));
    let joins =
        |a: &String, b: &String| plan.doors.iter().filter(|d| d.room_ids.contains(a) && d.room_ids.contains(b)).count();
    assert_eq!((joins(&meeting, &hall), joins(&lounge, &hall), joins(&meeting, &lounge)), (1, 1, 0));
    assert_eq!(plan.doors.iter().filter(|d| d.entrance).count(), 1);
    assert!((plan.rooms.iter().map(|r| r.net_area_m2).sum::<f64>() - 57.0).abs() < 4.0, "{:?}", plan.rooms);
}

#[test]
fn a_level_is_chosen_by_its_name_and_the_note_says_how() {
    let bytes = std::fs::read(plans().join("leaning.building.yaml")).expect("a plan of the tests");
    let options = Options { level: Some("l2".into()), ..thin() };
    let (plan, _) = plan_of("leaning.building.yaml", &bytes, &options).expect("a plan");
    assert_eq!(plan.rooms.iter().map(|r| r.name.as_str()).collect::<Vec<_>>(), ["archive"]);
    let Ok(Plan::Drawing(drawing)) =
        read(&Source { name: "leaning.building.yaml", bytes: &bytes, companion: &|_| None }, &thin())
    else {
        panic!("a drawing")
    };
    let layout = lay_out(drawing, &thin()).expect("a plan");
    let note = layout.notes.iter().find(|n| n.code == "levels").expect("a note");
    assert!(
        note.message.contains("`L1` is 0, `L2` is 1") && note.message.contains("--level \"L2\""),
        "{}",
        note.message
    );
    assert_eq!(layout.titles, ["small office"]);
}

#[test]
fn levels_are_lined_up_and_joined_by_their_lifts() {
    let bytes = std::fs::read(plans().join("tower.building.yaml")).expect("a plan of the tests");
    let source = Source { name: "tower.building.yaml", bytes: &bytes, companion: &|_| None };
    let Ok(Plan::Drawing(drawing)) = read(&source, &thin()) else { panic!("a drawing") };
    let layout = lay_out(drawing, &thin()).expect("a plan");
    let types: Vec<String> =
        layout.rooms.iter().map(|r| r.kind.clone().unwrap_or_else(|| r.label.replace(' ', "_"))).collect();
    let registry = Registry::builtin();
    let domain = registry.get("office").expect("built in").domain();
    let (plan, notes) = assemble(layout, &types, domain, 0, &thin());
    assert_eq!(plan.check(), Vec::new());
    let levels: Vec<_> = plan.levels.iter().map(|l| (l.level, l.elevation_m)).collect();
    assert_eq!(levels, [(0, 0.0), (1, 4.0)]);
    assert_eq!(plan.levels[0].height_m, 4.0);
    let outlines: Vec<_> = [0, 1]
        .map(|level| {
            let rooms = plan.rooms.iter().filter(|r| r.level == level);
            rooms.flat_map(|r| &r.polygon.0).fold([f64::MAX, f64::MAX, f64::MIN, f64::MIN], |b, p| {
                [b[0].min(p.x), b[1].min(p.y), b[2].max(p.x), b[3].max(p.y)]
            })
        })
        .into();
    let off = outlines[0].iter().zip(&outlines[1]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 0.05, "{outlines:?}");
    // both lifts stop on both storeys, at the same place
    assert_eq!(plan.links.len(), 2, "{notes:?}");
    for link in &plan.links {
        let rooms: Vec<_> = link.room_ids.iter().map(|id| plan.room(id).expect("a room of the plan")).collect();
        assert_eq!(rooms.iter().map(|r| r.level).collect::<Vec<_>>(), [0, 1]);
        let [a, b] = [rooms[0], rooms[1]].map(|r| r.polygon.bounds().center());
        assert!(a.distance(b) < 0.05 && plan.doors_of(&rooms[1].room_id).count() == 1, "{link:?}");
    }
    let codes: Vec<&str> = notes.iter().map(|n| n.code.as_str()).collect();
    assert!(codes.contains(&"lined_up") && codes.contains(&"levels"), "{codes:?}");
    let left_out: Vec<_> = notes.iter().filter(|n| n.code == "lift_left_out").collect();
    assert!(!left_out.is_empty() && left_out.iter().all(|n| n.message.contains("slanted")), "{left_out:?}");
}

#[test]
fn storeys_are_joined_by_stairs_above_each_other() {
    let rect = |level: &str, name: &str, [x0, y0, x1, y1]: [f64; 4]| {
        format!(
            r#"{{"type":"Feature","properties":{{"name":"{name}","level":"{level}"}},"geometry":{{"type":"Polygon","coordinates":[[[{x0},{y0}],[{x1},{y0}],[{x1},{y1}],[{x0},{y1}],[{x0},{y0}]]]}}}}"#
        )
    };
    let upper = |stairs: [f64; 4]| {
        let features = [
            rect("EG", "Hall", [0.0, 0.0, 6.0, 4.0]),
            rect("EG", "Stair", [6.0, 0.0, 9.0, 5.0]),
            rect("OG", "Hall", [0.0, 0.0, 6.0, 4.0]),
            rect("OG", "Stair", stairs),
        ];
        let text = format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, features.join(","));
        plan_of("p.geojson", text.as_bytes(), &Options::default()).expect("a plan")
    };
    let (plan, notes) = upper([6.0, 0.0, 9.0, 5.0]);
    assert_eq!(plan.links.len(), 1, "{notes:?}");
    let stairs: Vec<_> = plan.links[0].room_ids.iter().map(|id| plan.room(id).expect("a room")).collect();
    assert!(stairs.iter().all(|r| r.room_type == "stairwell"));
    assert_eq!(stairs[0].ceiling_height_m, plan.levels[0].height_m);
    assert!(!notes.contains(&"not_linked".into()));
    let (plan, notes) = upper([0.0, 4.0, 3.0, 9.0]);
    assert!(plan.links.is_empty() && notes.contains(&"not_linked".into()));
    assert!(plan.rooms.iter().any(|r| r.room_type == "stair"), "what joins nothing stays what it is");
    let alone = Options { level: Some("OG".into()), ..Options::default() };
    let text = format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, rect("OG", "Hall", [0.0, 0.0, 6.0, 4.0]));
    let (plan, _) = plan_of("p.geojson", text.as_bytes(), &alone).expect("a plan");
    assert!(plan.levels.is_empty() && plan.rooms[0].level == 0);
}

#[test]
fn a_court_is_no_floor() {
    let (plan, notes) = flat("court.geojson", &thin());
    assert!(notes.contains(&"room_in_pieces".into()), "{notes:?}");
    let corridors: Vec<_> = plan.rooms.iter().filter(|r| r.name.starts_with("Corridor")).collect();
    assert_eq!(corridors.len(), 2);
    let area: f64 = corridors.iter().map(|r| r.net_area_m2).sum();
    assert!((area - 91.0).abs() < 2.0, "the ring has 96 m2 with its walls, the floor {area}");
    let middle = d3dgen_model::Point::new(7.0, 7.0);
    assert!(plan.rooms.iter().all(|r| !r.polygon.contains(middle)));
    let ids: Vec<&String> = corridors.iter().map(|r| &r.room_id).collect();
    assert!(plan.doors.iter().filter(|d| ids.iter().all(|id| d.room_ids.contains(id))).count() == 2);
}

#[test]
fn walls_drawn_by_their_faces_and_doors_with_their_leaf_make_rooms() {
    let options = Options { meters_per_unit: Some(0.01), ..Options::default() };
    let options_of = |name: &str| if name.ends_with(".svg") { options.clone() } else { thin() };
    for (name, kitchen, bedroom) in [("filled.svg", 11.52, 11.52), ("blocks.dxf", 11.31, 11.31)] {
        let (plan, notes) = flat(name, &options_of(name));
        let area = |label: &str| plan.rooms.iter().find(|r| r.name == label).map_or(0.0, |r| r.net_area_m2);
        assert!((area("Kitchen") - kitchen).abs() < 0.1, "{name}: {:?}", plan.rooms);
        assert!((area("Bedroom") - bedroom).abs() < 0.1, "{name}: {:?}", plan.rooms);
        assert_eq!((plan.rooms.len(), plan.doors.len()), (2, 1), "{name}: {notes:?} {:?}", plan.doors);
        let door = &plan.doors[0];
        assert!(door.room_ids.len() == 2 && (door.line.length() - 0.9).abs() < 0.01, "{name}: {door:?}");
        let kitchen = plan.rooms.iter().find(|r| r.name == "Kitchen").map(|r| &r.room_id);
        assert_eq!(door.swing.as_ref().and_then(|s| s.into_room_id.as_ref()), kitchen, "{name}");
    }
}

/// A map in cells of 5 cm: walls and things are boxes of west, south, east and north in cells.
fn map_of(width: usize, height: usize, boxes: &[[usize; 4]]) -> Vec<u8> {
    let mut gray = vec![254_u8; width * height];
    for [x0, y0, x1, y1] in boxes {
        for y in *y0..*y1 {
            gray[(height - 1 - y) * width + x0..(height - 1 - y) * width + x1].fill(0);
        }
    }
    [format!("P5\n{width} {height}\n255\n").into_bytes(), gray].concat()
}

#[test]
fn furniture_on_a_map_is_no_wall() {
    let walls = [
        [0, 0, 240, 6],
        [0, 154, 240, 160],
        [0, 0, 6, 160],
        [234, 0, 240, 160],
        // a corridor along the north, 1.3 m wide, with doors to two rooms and one outdoors
        [6, 126, 40, 128],
        [60, 126, 150, 128],
        [170, 126, 234, 128],
        [119, 6, 121, 126],
    ];
    let things = [
        [40, 40, 60, 70],    // a table
        [62, 50, 70, 58],    // a chair
        [6, 80, 46, 118],    // a bed at the wall
        [90, 6, 119, 18],    // shelves in a corner
        [121, 60, 140, 100], // a desk at the wall between the rooms
        [200, 6, 234, 20],
    ];
    let yaml = "image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nfree_thresh: 0.25\n";
    let read_map = |boxes: &[[usize; 4]]| {
        let mut bytes = map_of(240, 160, boxes);
        // the entrance is a notch in the outer wall
        let from = bytes.len() - 240 * 160;
        (128 + 4..150 - 2).for_each(|y: usize| bytes[from + (159 - y) * 240 + 2..from + (159 - y) * 240 + 6].fill(254));
        let source = Source { name: "map.yaml", bytes: yaml.as_bytes(), companion: &|_| Some(bytes.clone()) };
        let Ok(Plan::Drawing(drawing)) = read(&source, &thin()) else { panic!("a drawing") };
        lay_out(drawing, &thin()).expect("a plan")
    };
    let bare = read_map(&walls);
    let full = read_map(&[&walls[..], &things[..]].concat());
    for layout in [&bare, &full] {
        let mut areas: Vec<f64> = layout.rooms.iter().map(|r| r.net_polygon.area()).collect();
        areas.sort_by(f64::total_cmp);
        let expected = [14.8, 33.9, 33.9];
        assert!(areas.len() == 3 && areas.iter().zip(expected).all(|(a, e)| (a - e).abs() < 0.5), "{areas:?}");
        let joined: Vec<usize> = layout.openings.iter().map(|o| o.rooms.len()).collect();
        assert_eq!(joined.iter().filter(|n| **n == 2).count(), 2, "{:?}", layout.openings);
        assert_eq!(joined.iter().filter(|n| **n == 1).count(), 1, "{:?}", layout.openings);
    }
    assert!(full.notes.iter().any(|n| n.code == "traced" && n.message.contains("approximate")));
}

#[test]
fn a_map_at_an_angle_is_turned() {
    let (width, height) = (260_usize, 200_usize);
    let boxes = [
        [20, 20, 240, 24],
        [20, 176, 240, 180],
        [20, 20, 24, 180],
        [236, 20, 240, 180],
        [128, 24, 131, 80],
        [128, 100, 131, 176],
    ];
    // the same walls turned by nine degrees about the middle
    let (sin, cos) = 9.0_f64.to_radians().sin_cos();
    let mut gray = vec![0_u8; width * height];
    for y in 0..height {
        for x in 0..width {
            let (dx, dy) = (x as f64 - 130.0, y as f64 - 100.0);
            let (u, v) = (130.0 + dx * cos + dy * sin, 100.0 - dx * sin + dy * cos);
            let inside = (20.0..240.0).contains(&u) && (20.0..180.0).contains(&v);
            let wall = boxes
                .iter()
                .any(|b| (b[0] as f64..b[2] as f64).contains(&u) && (b[1] as f64..b[3] as f64).contains(&v));
            gray[(height - 1 - y) * width + x] = if inside && !wall { 254 } else { 0 };
        }
    }
    let bytes = [format!("P5\n{width} {height}\n255\n").into_bytes(), gray].concat();
    let yaml = "image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nfree_thresh: 0.25\n";
    let source = Source { name: "map.yaml", bytes: yaml.as_bytes(), companion: &|_| Some(bytes.clone()) };
    let Ok(Plan::Drawing(drawing)) = read(&source, &thin()) else { panic!("a drawing") };
    let layout = lay_out(drawing, &thin()).expect("a plan");
    let areas: Vec<f64> = layout.rooms.iter().map(|r| r.net_polygon.area()).collect();
    assert!(areas.len() == 2 && areas.iter().all(|a| (a - 39.6).abs() < 2.0), "{areas:?}");
    assert_eq!(layout.openings.iter().filter(|o| o.rooms.len() == 2).count(), 1);
    assert!(layout.notes.iter().any(|n| n.code == "turned"));
}

#[test]
fn layers_of_the_cad_standard_are_understood_and_others_named() {
    // the flat with its walls, windows and door on layers of other names
    let text = String::from_utf8(std::fs::read(plans().join("flat.dxf")).expect("the sample")).expect("text");
    let on = |window: &str| text.replace("A-GLAZ-WINDOW", window);
    for window in ["A-GLAZ", "A-WALL-GLAZ", "A-WIND-FULL"] {
        let (plan, notes) = plan_of("flat.dxf", on(window).as_bytes(), &thin()).expect("a plan");
        assert_eq!((plan.windows.len(), notes.contains(&"not_understood".into())), (2, false), "{window}");
    }
    let (plan, notes) = plan_of("flat.dxf", on("A-XYZW").as_bytes(), &thin()).expect("a plan");
    assert_eq!((plan.windows.len(), notes.contains(&"not_understood".into())), (0, true));
}

#[test]
fn numbers_are_no_names() {
    let rect = |name: &str, [x0, y0, x1, y1]: [f64; 4]| {
        format!(
            r#"{{"type":"Feature","properties":{{"name":"{name}"}},"geometry":{{"type":"Polygon","coordinates":[[[{x0},{y0}],[{x1},{y0}],[{x1},{y1}],[{x0},{y1}],[{x0},{y0}]]]}}}}"#
        )
    };
    let door = |x: f64, y: f64| {
        format!(
            r#"{{"type":"Feature","properties":{{"kind":"door"}},"geometry":{{"type":"Point","coordinates":[{x},{y}]}}}}"#
        )
    };
    let plan = |corridor: &str| {
        let mut features = vec![rect(corridor, [0.0, 4.0, 12.0, 5.5]), door(0.0, 4.75)];
        for (i, x) in [0.0, 4.0, 8.0].into_iter().enumerate() {
            features.push(rect(&format!("1.0{}", i + 1), [x, 0.0, x + 4.0, 4.0]));
            features.push(door(x + 2.0, 4.0));
        }
        format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, features.join(","))
    };
    for (corridor, hub) in [("", true), ("1.10", true), ("R 4", true), ("Foundry", false)] {
        let text = plan(corridor);
        let source = Source { name: "p.geojson", bytes: text.as_bytes(), companion: &|_| None };
        let Ok(Plan::Drawing(drawing)) = read(&source, &thin()) else { panic!("{corridor}") };
        let layout = lay_out(drawing, &thin()).expect("a layout");
        let hubs: Vec<(&str, bool)> = layout.rooms.iter().map(|r| (r.label.as_str(), r.hub)).collect();
        assert_eq!(hubs, [(corridor, hub), ("1.01", false), ("1.02", false), ("1.03", false)]);
    }
}

#[test]
fn what_is_no_building_is_refused_with_its_place() {
    let rooms = |shapes: &str| format!(r#"<svg xmlns="http://www.w3.org/2000/svg">{shapes}</svg>"#);
    let slanted = rooms(r#"<polygon id="attic" points="0,0 500,0 500,300 100,400"/>"#);
    let bow = rooms(r#"<polygon id="bow" points="0,0 400,300 400,0 0,300"/>"#);
    let twice =
        rooms(r#"<rect id="a_room" width="400" height="300"/><rect id="b_room" x="200" width="400" height="300"/>"#);
    let tiny =
        rooms(r#"<rect id="shaft" width="15" height="500"/><rect id="kitchen" x="15" width="400" height="500"/>"#);
    let options = Options { meters_per_unit: Some(0.01), ..Options::default() };
    for (text, says) in [
        (&slanted, ["attic", "degrees", "--rectify"]),
        (&bow, ["bow", "crosses itself", "(0.000"]),
        (&twice, ["b room", "on top of", "a room"]),
        (&tiny, ["shaft", "no floor", "0.15 m"]),
    ] {
        let message = plan_of("x.svg", text.as_bytes(), &options).expect_err("no building").to_string();
        assert!(says.iter().all(|s| message.contains(s)), "{message}");
    }
    let (_, notes) = plan_of("x.svg", slanted.as_bytes(), &Options { rectify: true, ..options }).expect("steps");
    assert!(notes.contains(&"rectified".into()));
    let message = plan_of("x.svg", twice.as_bytes(), &Options::default()).expect_err("no unit").to_string();
    assert!(message.contains("--meters-per-unit"), "{message}");
}

#[test]
fn what_cannot_be_read_is_named_by_its_place() {
    let feature = |name: &str, x: &str| {
        format!(
            r#"{{"type":"Feature","properties":{{"name":"{name}"}},"geometry":{{"type":"Polygon","coordinates":[[[0,0],[{x},0],[5,4],[0,4],[0,0]]]}}}}"#
        )
    };
    let collection = |x: &str| {
        format!(r#"{{"type":"FeatureCollection","features":[{},{}]}}"#, feature("Hall", "5"), feature("Bath", x))
    };
    for (name, text, says) in [
        ("p.geojson", collection("\"a\""), "geojson: feature 1 `Bath`: invalid type"),
        ("p.geojson", collection("1e308"), "room `Bath`: the point (1e308, 0e0) m"),
        ("p.geojson", "{\"type\":\n[".into(), "geojson: line 2 column 1: EOF"),
        ("p.building.yaml", "levels:\n  L1:\n    walls: 3\n".into(), "rmf: line 3 column 12: expected"),
        // a drawing in meters
        ("p.svg", r#"<svg><rect id="hall" width="8" height="9"/></svg>"#.into(), "--meters-per-unit 1 would make"),
    ] {
        let message = plan_of(name, text.as_bytes(), &Options::default()).expect_err("no plan").to_string();
        assert!(message.contains(says) && message.len() < 300, "{message}");
    }
}

#[test]
fn hostile_files_end_in_a_message() {
    let bomb = {
        let mut text = String::from("<!DOCTYPE svg [<!ENTITY a0 \"ha\">");
        (1..30).for_each(|k| text += &format!("<!ENTITY a{k} \"&a{0};&a{0};&a{0};&a{0};\">", k - 1));
        text + "]><svg xmlns=\"http://www.w3.org/2000/svg\"><title>&a29;</title></svg>"
    };
    let deep = format!("<svg>{}{}</svg>", "<g>".repeat(100_000), "</g>".repeat(100_000));
    let many = format!("<svg><path d=\"M0 0{}z\"/></svg>", " L1 1 L2 0".repeat(300_000));
    let nested =
        format!("{{\"type\":\"FeatureCollection\",\"features\":{}{}}}", "[".repeat(50_000), "]".repeat(50_000));
    let far = r#"{"type":"Polygon","coordinates":[[[0,0],[1e300,0],[1e300,1e300],[0,1]]]}"#;
    let wide = r#"{"type":"Polygon","coordinates":[[[0,0],[90000,0],[90000,80000],[0,80000]]]}"#;
    let yaml_bomb = {
        let mut text = String::from("levels:\n  a0: &a0 [x, x, x, x]\n");
        (1..20).for_each(|k| text += &format!("  a{k}: &a{k} [*a{0}, *a{0}, *a{0}, *a{0}]\n", k - 1));
        text
    };
    let huge_map = "image: huge.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n";
    for (name, text) in [
        ("bomb.svg", bomb.as_str()),
        ("deep.svg", &deep),
        ("many.svg", &many),
        ("nested.geojson", &nested),
        ("far.geojson", far),
        ("wide.geojson", wide),
        ("bomb.building.yaml", &yaml_bomb),
        ("map.yaml", huge_map),
        ("empty.dxf", ""),
        ("odd.dxf", "0\nSECTION\n2\nENTITIES\n0\nLINE\n10\nNaN\n20\n1\n11\n2\n21\n3\n0\nEOF\n"),
        ("binary.dxf", "AutoCAD Binary DXF\r\n\u{1a}\u{0}"),
        ("what.txt", "a plan"),
    ] {
        let companion = |_: &str| Some(b"P5\n4000000000 4000000000\n255\n".to_vec());
        let source = Source { name, bytes: text.as_bytes(), companion: &companion };
        let options = Options { meters_per_unit: name.ends_with(".svg").then_some(0.01), ..Options::default() };
        let outcome = read(&source, &options).and_then(|plan| match plan {
            Plan::Drawing(drawing) => lay_out(drawing, &options).map(|_| ()),
            Plan::Document(_) => Ok(()),
        });
        let message = outcome.expect_err(name).to_string();
        assert!(!message.is_empty() && message.len() < 600, "{name}: {message}");
    }
}

#[test]
fn truncated_files_never_panic() {
    for name in ["flat.geojson", "flat.svg", "flat.dxf", "flat.building.yaml", "flat_map.yaml"] {
        let bytes = std::fs::read(plans().join(name)).expect("a plan of the tests");
        let mut broken = 0;
        for end in (0..bytes.len()).step_by(bytes.len() / 60 + 1) {
            broken += usize::from(plan_of(name, &bytes[..end], &thin()).is_err());
        }
        assert!(broken > 10, "{name}: only {broken} of its beginnings are refused");
    }
}
