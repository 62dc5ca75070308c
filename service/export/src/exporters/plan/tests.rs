use super::*;
use crate::models::NothingKept;
use crate::sample;

#[test]
fn the_picture_decodes_and_shows_the_building() {
    let files = Plan.export(&sample::world(), &sample::domain(), &NothingKept).unwrap();
    assert_eq!(files[0].path, "plan.png");
    let mut reader = png::Decoder::new(std::io::Cursor::new(&files[0].bytes)).read_info().unwrap();
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
fn a_prompt_in_another_script_is_left_out() {
    let mut world = sample::world();
    world.scene_graph.prompt = "两居室公寓".into();
    let foreign = svg(&world, &sample::domain());
    assert!(!foreign.contains("aria-label=\"“"));
    world.scene_graph.prompt = "<flat> & \"more\"".into();
    let escaped = svg(&world, &sample::domain());
    assert!(escaped.contains("“&lt;flat&gt; &amp; &quot;more&quot;”"));
    assert!(png(&escaped).is_ok());
}
