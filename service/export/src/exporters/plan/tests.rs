use super::*;
use crate::models::NothingKept;
use crate::sample;

#[test]
fn the_picture_decodes_and_shows_the_building() {
    let files = Plan.export(&Subject::new(&sample::world(), &sample::domain(), &NothingKept)).unwrap();
    let picture = files.iter().find(|f| f.path == "plan.png").unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(&picture.bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    assert!((1600..=2400).contains(&info.width) && info.height > 800, "{} x {}", info.width, info.height);
    assert_eq!(&pixels[..4], &[255; 4], "the sheet is white and opaque");
    let dark = pixels.chunks_exact(4).filter(|p| p[0] < 90 && p[3] == 255).count();
    assert!(dark * 200 > pixels.len() / 4, "walls cover more than 0.5 % of the sheet, {dark} px are dark");
}

#[test]
fn the_drawing_has_all_its_parts() {
    let svg = svg(&sample::world(), &sample::domain());
    for id in ["floors", "robot-zones", "furniture", "walls", "windows", "doors", "entrances", "dimensions", "labels"] {
        assert!(svg.contains(&format!("<g id=\"{id}\">")), "{id} is missing");
    }
    for text in ["Living room", "Hallway", "Kitchen", "Entrance", "Charging dock", "Seed", "11.74 × 8.24 m"] {
        assert!(svg.contains(&format!("aria-label=\"{text}\"")), "{text} is not written");
    }
    assert!(!svg.contains("<text"), "type is outlines");
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
}

#[test]
fn every_build_has_a_symbol_of_its_own() {
    let (world, domain) = (sample::catalogue(), sample::domain());
    let mut seen = std::collections::BTreeMap::new();
    for shape in sample::ALL_SHAPES {
        let id = sample::shape_id(shape);
        let mut placement = world.placements.placements.iter().find(|p| p.object == id).unwrap().clone();
        placement.pose = Pose { x: 0.0, y: 0.0, z: 0.0, yaw_rad: 0.0 };
        placement.size_m = [1.0, 0.8, 0.9];
        let frame = Frame { scale: 100.0, origin: Point::new(0.0, 0.0), at: (0.0, 0.0) };
        let mut page = Page::new();
        symbols::draw(shape, 0.0, &mut pen::Pen::new(&mut page, &frame, &placement));
        let block = page.block(|_| 0.0);
        drop(block);
        let drawn = page.finish((1.0, 1.0), (1.0, 1.0), "", "");
        assert!(drawn.contains("<path"), "{shape:?} draws nothing");
        if let Some(other) = seen.insert(drawn, shape) {
            panic!("{shape:?} and {other:?} look the same");
        }
        assert!(domain.object(&id).is_some());
    }
    let schema = <Domain as d3dgen_model::Document>::schema();
    let builds = schema["$defs"]["Shape"]["oneOf"].as_array().unwrap().len();
    assert_eq!(builds, sample::ALL_SHAPES.len(), "the list of builds is complete");
}

#[test]
fn prompts_and_names_in_any_script_are_drawn() {
    for name in [
        "两居室公寓",
        "원룸 아파트",
        "二世帯住宅のキッチン",
        "Двухкомнатная квартира",
        "Phòng ngủ",
        "Δωμάτιο",
        "Łazienka",
    ] {
        let mut world = sample::world();
        world.scene_graph.prompt = name.into();
        world.floorplan.rooms[1].name = name.into();
        let svg = svg(&world, &sample::domain());
        let drawn = |label: &str| {
            let (_, path) =
                svg.split_once(&format!("aria-label=\"{label}\" d=\"")).unwrap_or_else(|| panic!("{label}"));
            path.split('"').next().unwrap_or_default().matches('M').count()
        };
        let letters = name.chars().filter(|c| !c.is_whitespace()).count();
        assert!(drawn(&format!("“{name}”")) >= letters + 2, "{name}");
        assert!(svg.matches(&format!("aria-label=\"{name}\"")).count() > 0, "{name}");
    }
    let mut world = sample::world();
    world.scene_graph.prompt = "<flat> & \"more\"".into();
    let escaped = svg(&world, &sample::domain());
    assert!(escaped.contains("“&lt;flat&gt; &amp; &quot;more&quot;”"));
    assert!(png(&escaped).is_ok());
}

#[test]
fn without_robots_nothing_is_hatched_for_them() {
    let mut world = sample::world();
    let hatched = svg(&world, &sample::domain());
    assert!(hatched.contains("id=\"robot-zones\"") && hatched.contains("aria-label=\"Cleaning zone\""));
    world.scenario.robots.clear();
    let bare = svg(&world, &sample::domain());
    assert!(!bare.contains("id=\"robot-zones\"") && !bare.contains("aria-label=\"Cleaning zone\""));
    assert!(bare.contains("aria-label=\"Charging dock\""), "a dock that stands there is shown");
}

#[test]
fn the_legend_names_the_rooms_of_the_plan() {
    let (world, domain) = (sample::world(), sample::domain());
    let svg = svg(&world, &domain);
    let kinds: std::collections::BTreeSet<_> = world.floorplan.rooms.iter().map(|r| r.room_type.as_str()).collect();
    let labels: Vec<&str> = kinds.iter().map(|k| domain.room_type_or_generic(k).label.as_str()).collect();
    let named = |label: &&&str| svg.to_lowercase().contains(&label.to_lowercase());
    assert_eq!(labels.iter().filter(named).count(), labels.len(), "{labels:?}");
    assert!(!svg.contains("Sleeping and care") && !svg.contains("Day, work, treatment"));
}

#[test]
fn the_pdf_has_the_size_of_the_sheet_and_is_the_same_each_time() {
    let (world, domain) = (sample::world(), sample::domain());
    let all = files(&world, &domain, false).unwrap();
    assert_eq!(all, files(&world, &domain, false).unwrap());
    assert_eq!(all.iter().map(|f| f.path.as_str()).collect::<Vec<_>>(), ["plan.dxf", "plan.pdf", "plan.svg"]);
    let pdf = &all[1].bytes;
    assert!(pdf.starts_with(b"%PDF-") && pdf.ends_with(b"%%EOF"), "a whole file");
    let text = String::from_utf8_lossy(pdf);
    let (_, media_box) = text.split_once("/MediaBox [0 0 ").expect("a page with a size");
    let points: Vec<f64> = media_box.split([' ', ']']).take(2).map(|v| v.parse().unwrap()).collect();
    let svg = String::from_utf8_lossy(&all[2].bytes);
    for (name, points) in ["width", "height"].iter().zip(points) {
        let (_, mm) = svg.split_once(&format!("{name}=\"")).unwrap();
        let mm: f64 = mm.split("mm").next().unwrap().parse().unwrap();
        assert!((points / 72.0 * 25.4 - mm).abs() < 0.1, "{name}: {points} pt are {mm} mm");
    }
    assert!(!text.contains("CreationDate") && !text.contains("ModDate"));
}
