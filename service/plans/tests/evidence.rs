//! Drawings as other people's programs write them: what is a room in them, what stands in one, and what is said of the rest.

use std::io::Write;

use d3dgen_model::Polygon;
use d3dgen_plans::{LayerUse, Layout, Options, Plan, SolidKind, Source, lay_out, read};

fn laid(name: &str, bytes: &[u8], options: &Options) -> Result<Layout, d3dgen_plans::Error> {
    let source = Source { name, bytes, companion: &|_| None };
    match read(&source, options)? {
        Plan::Drawing(drawing) => lay_out(drawing, options),
        Plan::Document(_) => panic!("{name} is a drawing"),
    }
}

fn note_of<'l>(layout: &'l Layout, code: &str) -> &'l str {
    layout.notes.iter().find(|n| n.code == code).map_or("", |n| n.message.as_str())
}

fn areas(layout: &Layout) -> Vec<f64> {
    let mut out: Vec<f64> = layout.rooms.iter().map(|r| (r.net_polygon.area() * 10.0).round() / 10.0).collect();
    out.sort_by(f64::total_cmp);
    out
}

/// A DXF in meters of these entities.
fn dxf(entities: &[String]) -> Vec<u8> {
    format!(
        "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n6\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{}0\nENDSEC\n0\nEOF\n",
        entities.concat()
    )
    .into_bytes()
}

fn outline(layer: &str, corners: &[(f64, f64)]) -> String {
    let corners: String = corners.iter().map(|(x, y)| format!("10\n{x}\n20\n{y}\n")).collect();
    format!("0\nLWPOLYLINE\n8\n{layer}\n90\n4\n70\n1\n{corners}")
}

fn rect(layer: &str, x0: f64, y0: f64, x1: f64, y1: f64) -> String {
    outline(layer, &[(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
}

fn line(layer: &str, x0: f64, y0: f64, x1: f64, y1: f64) -> String {
    format!("0\nLINE\n8\n{layer}\n10\n{x0}\n20\n{y0}\n11\n{x1}\n21\n{y1}\n")
}

fn text(at: (f64, f64), words: &str) -> String {
    format!("0\nTEXT\n8\nTexts\n10\n{}\n20\n{}\n40\n0.25\n1\n{words}\n", at.0, at.1)
}

fn circle(layer: &str, x: f64, y: f64, radius: f64) -> String {
    format!("0\nCIRCLE\n8\n{layer}\n10\n{x}\n20\n{y}\n40\n{radius}\n")
}

#[test]
fn shapes_on_layers_that_nothing_is_known_of_are_no_rooms_where_walls_are() {
    let walls = [rect("Walls", 0.0, 0.0, 4.0, 3.0), rect("Walls", 4.1, 0.0, 8.0, 3.0)];
    let names = [text((1.0, 1.0), "Kitchen"), text((5.0, 1.0), "Bedroom")];
    let plain = laid("a.dxf", &dxf(&[&walls[..], &names[..]].concat()), &Options::default()).expect("rooms");
    for (layer, code) in [("Furnitures", "left_out"), ("Einrichtung", "left_out"), ("XYZ-12", "not_understood")] {
        for shape in [
            rect(layer, 1.0, 2.0, 2.0, 2.8),
            outline(layer, &[(1.0, 2.0), (1.6, 2.1), (1.5, 2.7), (0.9, 2.6)]),
            // as large as a room, with words in it
            rect(layer, 4.5, 0.5, 7.5, 2.5),
        ] {
            let all = [&walls[..], &names[..], &[shape]].concat();
            let layout = laid("a.dxf", &dxf(&all), &Options::default()).expect("rooms");
            assert_eq!(areas(&layout), areas(&plain), "{layer}");
            assert!(note_of(&layout, code).contains(layer), "{:?}", layout.notes);
        }
    }
}

#[test]
fn layers_of_rooms_come_before_walls_and_a_room_in_a_room_is_none() {
    let all = [
        rect("A-AREA", 0.0, 0.0, 4.0, 3.0),
        rect("A-AREA", 4.0, 0.0, 8.0, 3.0),
        rect("A-AREA", 1.0, 1.0, 2.0, 2.5),
        rect("A-AREA", 6.0, 1.0, 6.4, 1.4),
        rect("A-WALL", 0.0, 0.0, 8.0, 3.0),
    ];
    let layout = laid("a.dxf", &dxf(&all), &Options::default()).expect("rooms");
    assert_eq!(layout.rooms.len(), 2);
    assert!(note_of(&layout, "not_understood").contains("`A-AREA` as LWPOLYLINE (2)"), "{:?}", layout.notes);
}

#[test]
fn columns_of_every_kind_stand_in_the_hall() {
    let block = "0\nBLOCK\n8\n0\n2\nSTUETZE_40\n70\n0\n10\n0\n20\n0\n3\nSTUETZE_40\n0\nLWPOLYLINE\n8\n0\n90\n4\n70\n1\n10\n-0.2\n20\n-0.2\n10\n0.2\n20\n-0.2\n10\n0.2\n20\n0.2\n10\n-0.2\n20\n0.2\n0\nENDBLK\n8\n0\n";
    let insert = "0\nINSERT\n8\nPlan\n2\nSTUETZE_40\n10\n16\n20\n6\n".to_owned();
    let hatch = "0\nHATCH\n8\nS-COLS\n10\n0\n20\n0\n30\n0\n2\nSOLID\n70\n1\n71\n0\n91\n1\n92\n2\n72\n0\n73\n1\n93\n4\n10\n3\n20\n3\n10\n3.4\n20\n3\n10\n3.4\n20\n3.4\n10\n3\n20\n3.4\n97\n0\n75\n0\n76\n1\n98\n0\n".to_owned();
    let entities = [
        rect("WALL", 0.0, 0.0, 20.0, 12.0),
        circle("COLUMN", 7.0, 6.0, 0.3),
        insert,
        hatch,
        rect("S-COLS", 3.0, 3.0, 3.4, 3.4),
        rect("WALL", 10.0, 6.0, 10.5, 6.5),
        circle("Deko", 5.0, 9.0, 0.5),
    ];
    let file = String::from_utf8(dxf(&entities)).expect("text");
    let file = file.replacen(
        "0\nSECTION\n2\nENTITIES",
        &format!("0\nSECTION\n2\nBLOCKS\n{block}0\nENDSEC\n0\nSECTION\n2\nENTITIES"),
        1,
    );
    let layout = laid("hall.dxf", file.as_bytes(), &Options::default()).expect("a hall");
    assert_eq!(layout.rooms.len(), 1, "{:?}", layout.notes);
    // the hatch and the outline around it are one column
    let mut columns: Vec<f64> = layout.obstacles.iter().map(|o| (o.outline.area() * 100.0).round() / 100.0).collect();
    columns.sort_by(f64::total_cmp);
    assert_eq!(columns, [0.16, 0.16, 0.25, 0.28], "{:?}", layout.notes);
    assert!(layout.obstacles.iter().all(|o| o.kind == SolidKind::Column && o.room == 0));
    assert!(note_of(&layout, "not_understood").contains("layer `Deko` as CIRCLE (1)"), "{:?}", layout.notes);
}

#[test]
fn walls_that_stand_free_or_end_in_a_room_stay() {
    let entities = [
        line("Mauern", 0.0, 0.0, 8.0, 0.0),
        line("Mauern", 8.0, 0.0, 8.0, 6.0),
        line("Mauern", 8.0, 6.0, 0.0, 6.0),
        line("Mauern", 0.0, 6.0, 0.0, 0.0),
        // one that ends in the room, and one by its faces
        line("Mauern", 4.0, 0.0, 4.0, 2.5),
        rect("Mauern", 2.0, 4.0, 5.0, 4.2),
    ];
    let layout = laid("a.dxf", &dxf(&entities), &Options::default()).expect("a room");
    assert_eq!(layout.rooms.len(), 1, "{:?}", layout.notes);
    let walls: Vec<&Polygon> =
        layout.obstacles.iter().filter(|o| o.kind == SolidKind::Wall).map(|o| &o.outline).collect();
    assert_eq!(walls.len(), 2, "{:?}", layout.obstacles);
    let longest = |p: &&Polygon| p.bounds().width().max(p.bounds().height());
    assert!(
        walls.iter().any(|p| (longest(p) - 3.0).abs() < 0.02) && walls.iter().any(|p| (longest(p) - 2.38).abs() < 0.02)
    );
}

#[test]
fn a_drawing_without_known_layers_names_them_and_hears_what_they_are() {
    let layer = "A-210 G - Existing Structure";
    let sides = [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)];
    let lines = (0..4).map(|k| line(layer, sides[k].0, sides[k].1, sides[(k + 1) % 4].0, sides[(k + 1) % 4].1));
    let entities: Vec<String> = lines.chain([text((1.0, 1.0), "Office"), circle("Deko", 2.0, 2.0, 0.3)]).collect();
    let refused =
        laid("a.dxf", &dxf(&entities), &Options::default()).expect_err("nothing says what is a wall").to_string();
    for says in
        [&format!("`{layer}` (4 LINE)"), "`Texts` (1 TEXT)", "`Deko` (1 CIRCLE)", &format!("--layer \"{layer}=wall\"")]
    {
        assert!(refused.contains(says), "{says} is not in: {refused}");
    }
    let said = |list: &[(&str, LayerUse)]| Options {
        layers: list.iter().map(|(name, layer_use)| ((*name).to_owned(), *layer_use)).collect(),
        ..Options::default()
    };
    let walls = said(&[(layer, LayerUse::Wall), ("Deko", LayerUse::Column)]);
    let layout = laid("a.dxf", &dxf(&entities), &walls).expect("a room");
    assert_eq!((layout.rooms.len(), layout.rooms[0].label.as_str(), layout.obstacles.len()), (1, "Office", 1));
    let room = [rect("Zeug", 0.0, 0.0, 5.0, 4.0), rect("Walls", 0.0, 0.0, 5.0, 9.0)];
    let layout =
        laid("a.dxf", &dxf(&room), &said(&[("zeug", LayerUse::Room), ("Walls", LayerUse::Ignore)])).expect("a room");
    assert_eq!(areas(&layout).len(), 1);
    assert!(
        note_of(&layout, "left_out").is_empty() && note_of(&layout, "not_understood").is_empty(),
        "{:?}",
        layout.notes
    );
}

#[test]
fn furniture_in_blocks_and_labels_in_other_languages() {
    let block = "0\nBLOCK\n8\n0\n2\nLETTO-160\n70\n0\n10\n0\n20\n0\n3\nLETTO-160\n0\nLINE\n8\n0\n10\n0\n20\n0\n11\n1.6\n21\n0\n0\nLINE\n8\n0\n10\n1.6\n20\n0\n11\n1.6\n21\n2\n0\nENDBLK\n8\n0\n";
    let entities = [
        line("PARETI", 0.0, 0.0, 8.0, 0.0),
        line("PARETI", 8.0, 0.0, 8.0, 4.0),
        line("PARETI", 8.0, 4.0, 0.0, 4.0),
        line("PARETI", 0.0, 4.0, 0.0, 0.0),
        line("PARETI", 4.0, 0.0, 4.0, 4.0),
        "0\nINSERT\n8\nARREDI\n2\nLETTO-160\n10\n1\n20\n1\n".into(),
        "0\nINSERT\n8\n0\n2\nLETTO-160\n10\n5\n20\n1\n".into(),
        text((2.0, 3.0), "Camera"),
        text((6.0, 3.0), "Soggiorno"),
    ];
    let file = String::from_utf8(dxf(&entities)).expect("text");
    let file = file.replacen(
        "0\nSECTION\n2\nENTITIES",
        &format!("0\nSECTION\n2\nBLOCKS\n{block}0\nENDSEC\n0\nSECTION\n2\nENTITIES"),
        1,
    );
    let layout = laid("casa.dxf", file.as_bytes(), &Options::default()).expect("two rooms");
    let names: Vec<&str> = layout.rooms.iter().map(|r| r.label.as_str()).collect();
    assert_eq!(names, ["Camera", "Soggiorno"], "{:?}", layout.notes);
    assert!(layout.obstacles.is_empty(), "a bed is no wall: {:?}", layout.obstacles);
    assert!(note_of(&layout, "left_out").contains("block `LETTO-160`"), "{:?}", layout.notes);
}

fn svg(body: &str) -> Vec<u8> {
    format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" width="8000mm" height="6000mm" viewBox="0 0 8 6">{body}</svg>"#
    )
    .into_bytes()
}

#[test]
fn symbols_beside_named_rooms_of_an_svg_are_left_out() {
    let rooms = r#"<rect id="kitchen" width="4" height="3"/><rect id="bedroom" x="4" width="4" height="3"/>"#;
    for symbol in [
        r#"<path id="path9087" d="M1 1 L1.5 1.2 L1.4 1.7 L0.9 1.5 Z"/>"#,
        // crosses itself
        r#"<path d="M1 4 L3 5 L3 4 L1 5 Z"/>"#,
        // one that has a name and lies in a room
        r#"<g transform="rotate(30 5 1)"><polygon id="sofa" points="5,1 6.5,1 6.5,1.6 5,1.6"/></g>"#,
        r#"<circle cx="1" cy="1" r="0.6"/>"#,
        r#"<rect x="0.5" y="0.5" width="0.6" height="0.6"/>"#,
    ] {
        let layout = laid("a.svg", &svg(&format!("{rooms}{symbol}")), &Options::default());
        let layout = layout.unwrap_or_else(|e| panic!("{symbol}: {e}"));
        assert_eq!(layout.rooms.len(), 2, "{symbol}: {:?}", layout.notes);
        assert!(note_of(&layout, "not_understood").contains('<'), "{symbol}: {:?}", layout.notes);
    }
}

#[test]
fn groups_of_inkscape_with_transforms_and_layers_in_german() {
    let body = r#"<g inkscape:groupmode="layer" inkscape:label="Wände" transform="translate(0 6) scale(1 -1)">
        <path d="M0 0H8V4H0Z"/><path d="M5 0V4"/></g>
        <g inkscape:groupmode="layer" inkscape:label="Möblierung"><rect x="1" y="3" width="2" height="1.6"/></g>
        <g inkscape:groupmode="layer" inkscape:label="Stützen"><circle cx="2" cy="5" r="0.2"/></g>
        <text x="1" y="4.5">Wohnzimmer</text><text x="6" y="4.5">Küche</text>"#;
    let layout = laid("plan.svg", &svg(body), &Options::default()).expect("two rooms");
    let names: Vec<&str> = layout.rooms.iter().map(|r| r.label.as_str()).collect();
    assert_eq!((names.len(), layout.obstacles.len()), (2, 1), "{names:?} {:?}", layout.notes);
    assert!(names.contains(&"Küche") && note_of(&layout, "left_out").contains("Möblierung"), "{:?}", layout.notes);
    // what the user says of a layer beats its words
    let options = Options { layers: vec![("Möblierung".into(), LayerUse::Room)], ..Options::default() };
    let layout = laid("plan.svg", &svg(body), &options).expect("one room");
    assert_eq!(layout.rooms.len(), 1, "{:?}", layout.notes);
}

#[test]
fn doors_drawn_to_the_end_of_a_wall_keep_off_the_corner() {
    let rmf = "levels:\n  L1:\n    vertices: [[0,0,0,\"\"],[8,0,0,\"\"],[8,4,0,\"\"],[0,4,0,\"\"],[4,0,0,\"\"],[4,4,0,\"\"],[4,1,0,\"\"],[2,2,0,\"pantry\"],[6,2,0,\"lounge\"],[7,3,0,\"meeting_room\"]]\n    walls: [[0,4,{}],[4,1,{}],[1,2,{}],[2,5,{}],[5,3,{}],[3,0,{}],[6,5,{}]]\n    doors: [[4,6,{name: [1,inner],type: [1,hinged]}]]\n    models: [{model_name: OpenRobotics/OfficeDesk, name: a, x: 1, y: 1},{model_name: OpenRobotics/OfficeDesk, name: b, x: 2, y: 1}]\ncoordinate_system: cartesian_meters\n";
    let layout = laid("small.building.yaml", rmf.as_bytes(), &Options::default()).expect("two rooms");
    assert!(!note_of(&layout, "doors_moved").is_empty(), "{:?}", layout.notes);
    let models = note_of(&layout, "left_out");
    assert!(models.contains("model `OfficeDesk` (2)"), "{models}");
    assert!(note_of(&layout, "several_names").contains("meeting room"), "{:?}", layout.notes);
}

const LEVEL: &str = r#"{"type":"FeatureCollection","features":[{"id":"l0","type":"Feature","feature_type":"level","geometry":{"type":"Polygon","coordinates":[[[0,0],[9,0],[9,4],[0,4],[0,0]]]},"properties":{"ordinal":0,"name":{"en":"Ground"}}}]}"#;
const UNITS: &str = r#"{"type":"FeatureCollection","features":[
    {"id":"u1","type":"Feature","feature_type":"unit","geometry":{"type":"Polygon","coordinates":[[[0,0],[5,0],[5,4],[0,4],[0,0]]]},"properties":{"category":"conferenceroom","name":null,"level_id":"l0"}},
    {"id":"u2","type":"Feature","feature_type":"unit","geometry":{"type":"Polygon","coordinates":[[[5,0],[9,0],[9,4],[5,4],[5,0]]]},"properties":{"category":"unspecified","name":null,"level_id":"l0"}},
    {"id":"u3","type":"Feature","feature_type":"unit","geometry":{"type":"Polygon","coordinates":[[[2,1.8],[2.4,1.8],[2.4,2.2],[2,2.2],[2,1.8]]]},"properties":{"category":"column","name":null,"level_id":"l0"}}]}"#;
const OPENINGS: &str = r#"{"type":"FeatureCollection","features":[{"id":"o1","type":"Feature","feature_type":"opening","geometry":{"type":"LineString","coordinates":[[5,1],[5,2]]},"properties":{"category":"pedestrian","door":null,"level_id":"l0"}}]}"#;
const FIXTURES: &str = r#"{"type":"FeatureCollection","features":[{"id":"f1","type":"Feature","feature_type":"fixture","geometry":{"type":"Polygon","coordinates":[[[1,1],[2,1],[2,2],[1,2],[1,1]]]},"properties":{"category":"desk","level_id":"l0"}}]}"#;
const ANCHORS: &str = r#"{"type":"FeatureCollection","features":[{"id":"a1","type":"Feature","feature_type":"anchor","geometry":{"type":"Point","coordinates":[6,1]},"properties":{"unit_id":"u2"}}]}"#;
const OCCUPANTS: &str = r#"{"type":"FeatureCollection","features":[{"id":"c1","type":"Feature","feature_type":"occupant","geometry":null,"properties":{"name":{"en":"Bakery"},"anchor_id":"a1"}}]}"#;

#[test]
fn a_venue_of_imdf_is_read_as_zip_and_by_its_files() {
    let files = [
        ("level", LEVEL),
        ("unit", UNITS),
        ("opening", OPENINGS),
        ("fixture", FIXTURES),
        ("anchor", ANCHORS),
        ("occupant", OCCUPANTS),
    ];
    let options = Options { meters_per_unit: Some(1.0), ..Options::default() };
    let mut zipped = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, text) in files {
        zipped.start_file(format!("venue/{name}.geojson"), zip::write::SimpleFileOptions::default()).expect("a file");
        zipped.write_all(text.as_bytes()).expect("written");
    }
    let zipped = zipped.finish().expect("a zip").into_inner();
    let from_zip = laid("venue.zip", &zipped, &options).expect("a venue");
    let companion = |name: &str| {
        files.iter().find(|(kind, _)| name == format!("{kind}.geojson")).map(|(_, text)| text.as_bytes().to_vec())
    };
    let source = Source { name: "manifest.json", bytes: b"{\"version\":\"1.0.0\"}", companion: &companion };
    let Ok(Plan::Drawing(drawing)) = read(&source, &options) else { panic!("no drawing") };
    let from_folder = lay_out(drawing, &options).expect("a venue");
    for layout in [from_zip, from_folder] {
        let rooms: Vec<(&str, Option<&str>)> =
            layout.rooms.iter().map(|r| (r.label.as_str(), r.kind.as_deref())).collect();
        assert_eq!(rooms.len(), 2, "{rooms:?}");
        assert!(rooms[0].1 == Some("meeting room") && rooms[1].0 == "Bakery", "{rooms:?}");
        assert_eq!((layout.openings.len(), layout.obstacles.len()), (1, 1), "{:?}", layout.notes);
        assert!(note_of(&layout, "left_out").contains("fixture"), "{:?}", layout.notes);
    }
    let refused = laid("other.zip", &zip_of_nothing(), &options).expect_err("no venue").to_string();
    assert!(refused.contains("unit.geojson"), "{refused}");
}

fn zip_of_nothing() -> Vec<u8> {
    let mut zipped = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    zipped.start_file("note.txt", zip::write::SimpleFileOptions::default()).expect("a file");
    zipped.finish().expect("a zip").into_inner()
}

/// A map of 5 cm cells, `.` free, `#` wall, `?` never seen, with a rectangle of each in cells from the south west.
fn map(width: usize, height: usize, boxes: &[(u8, [usize; 4])]) -> Vec<u8> {
    let mut gray = vec![254_u8; width * height];
    for (shade, [x0, y0, x1, y1]) in boxes {
        for y in *y0..*y1 {
            gray[(height - 1 - y) * width + x0..(height - 1 - y) * width + x1].fill(*shade);
        }
    }
    [format!("P5\n{width} {height}\n255\n").into_bytes(), gray].concat()
}

fn traced(yaml: &str, picture: Vec<u8>) -> Layout {
    let yaml = format!("image: m.pgm\nresolution: 0.05\nfree_thresh: 0.196\noccupied_thresh: 0.65\n{yaml}");
    let source = Source { name: "m.yaml", bytes: yaml.as_bytes(), companion: &|_| Some(picture.clone()) };
    let Plan::Drawing(drawing) = read(&source, &Options::default()).expect("a map") else { panic!("no drawing") };
    lay_out(drawing, &Options::default()).expect("a layout")
}

#[test]
fn a_free_wall_of_a_map_stays_and_floor_never_scanned_is_told() {
    let walls = [
        (205_u8, [0, 0, 220, 140]),
        (0, [10, 10, 210, 130]),
        (254, [12, 12, 208, 128]),
        // walls that stand free, and something too short to be one
        (0, [100, 50, 102, 90]),
        (0, [70, 105, 130, 107]),
        (0, [40, 60, 44, 80]),
        // floor behind a counter that nobody scanned
        (205, [150, 60, 170, 80]),
    ];
    let layout = traced("origin: [0.0, 0.0, 0.0]\nnegate: 0\n", map(220, 140, &walls));
    assert_eq!(layout.rooms.len(), 1, "{:?}", layout.notes);
    let walls: Vec<_> = layout.obstacles.iter().filter(|o| o.kind == SolidKind::Wall).collect();
    assert_eq!(walls.len(), 2, "{:?}", layout.obstacles);
    let mut sides: Vec<(f64, f64)> = walls
        .iter()
        .map(|w| w.outline.bounds())
        .map(|b| (b.width().max(b.height()), b.width().min(b.height())))
        .collect();
    sides.sort_by(|a, b| a.0.total_cmp(&b.0));
    let near = |(long, short): (f64, f64), length: f64| (long - length).abs() < 0.06 && (short - 0.1).abs() < 0.06;
    assert!(near(sides[0], 2.0) && near(sides[1], 3.0), "{sides:?}");
    assert!(note_of(&layout, "unscanned").contains("1.0 m2"), "{:?}", layout.notes);
}

#[test]
fn a_yaw_that_is_no_number_is_zero() {
    let walls = [(205_u8, [0, 0, 120, 100]), (0, [10, 10, 110, 90]), (254, [12, 12, 108, 88])];
    for yaw in ["-nan", "nan", ".nan"] {
        let layout = traced(&format!("origin: [-1.0, -2.0, {yaw}]\nnegate: 0\n"), map(120, 100, &walls));
        assert_eq!(layout.rooms.len(), 1);
        assert!(note_of(&layout, "yaw_assumed").contains('0'), "{:?}", layout.notes);
    }
}

#[test]
fn files_of_building_programs_are_named_with_the_way_round() {
    for (name, bytes, says) in [
        ("model.ifc", &b"ISO-10303-21;\nHEADER;"[..], ["IFC", "DXF"]),
        ("house.dwg", b"AC1032\0\0", ["DWG", "ASCII DXF"]),
        ("plan.pdf", b"%PDF-1.7", ["PDF", "SVG"]),
        ("plan.png", b"\x89PNG\r\n", ["picture", "map.yaml"]),
    ] {
        let source = Source { name, bytes, companion: &|_| None };
        let refused = read(&source, &Options::default()).expect_err("no plan").to_string();
        assert!(says.iter().all(|s| refused.contains(s)), "{refused}");
    }
}
