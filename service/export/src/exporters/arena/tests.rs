use std::collections::BTreeSet;

use d3dgen_model::floorplan::DoorKind;
use d3dgen_model::world::World;
use serde_json::Value;

use super::*;
use crate::models::NothingKept;
use crate::sample;

fn files() -> Vec<File> {
    Arena.export(&Subject::new(&sample::world(), &sample::domain(), &NothingKept)).unwrap()
}

fn level() -> Value {
    let world = sample::world();
    world_yaml::level(&world, &sample::domain(), &UsedModels::of(&world, &sample::domain(), &NothingKept).unwrap())
        .unwrap()
}

fn zones(level: &Value) -> &Vec<Value> {
    level["zones"].as_array().unwrap()
}

#[test]
fn the_bundle_has_every_file_arena_reads() {
    let paths: BTreeSet<String> = files().into_iter().map(|f| f.path).collect();
    let world = sample::world();
    let used = UsedModels::of(&world, &sample::domain(), &NothingKept).unwrap();
    let mut expected: Vec<String> =
        ["0/world.yaml", "0/map.png", "0/map.yaml", "scenarios/default/scenario.yaml"].map(str::to_owned).to_vec();
    for placement in &world.placements.placements {
        let reference = used.reference(placement).unwrap();
        let (domain, name) = reference.split_once('/').unwrap();
        let model =
            ["annotation.yaml", &format!("{name}.sdf/{name}.sdf"), &format!("{name}.glb"), &format!("{name}.usdz")]
                .map(|file| format!("assets/{domain}/Object/{name}/{file}"));
        expected.extend(model);
    }
    for path in expected {
        assert!(paths.contains(&format!("arena/worlds/sample_flat/{path}")), "{path} is missing");
    }
}

#[test]
fn the_level_holds_the_shared_schema_when_it_is_at_hand() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/formats/arena_world.schema.json");
    let Ok(schema) = std::fs::read_to_string(path) else {
        println!("notice: the shared Arena schema is not beside the repository; only the rules below were checked");
        return;
    };
    let schema: Value = serde_json::from_str(&schema).unwrap();
    let level = level();
    let validator = jsonschema::validator_for(&schema).unwrap();
    let errors: Vec<String> = validator.iter_errors(&level).map(|e| format!("{}: {e}", e.instance_path())).collect();
    assert_eq!(errors, Vec::<String>::new());
}

#[test]
fn zones_have_the_keys_and_names_arena_demands() {
    let level = level();
    let mut names = BTreeSet::new();
    let mut add = |name: &Value| {
        let name = name.as_str().unwrap().to_owned();
        assert!(name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_'), "{name}");
        assert!(names.insert(name.clone()), "{name} is used twice");
    };
    for zone in zones(&level) {
        add(&zone["name"]);
        for key in ["description", "material", "corners", "walls", "doors", "elevators", "entities", "ceiling_height"] {
            assert!(!zone[key].is_null(), "{} lacks {key}", zone["name"]);
        }
        assert_eq!(zone["material"][1], serde_json::json!({}));
        for door in zone["doors"].as_array().unwrap() {
            add(&door["name"]);
            assert_eq!(door["kind"], "sliding");
        }
        for thing in zone["entities"]["static"].as_array().unwrap() {
            add(&thing["name"]);
        }
    }
    assert_eq!(names.len(), 7 + 6 + sample::world().placements.placements.len());
}

#[test]
fn every_wall_and_door_is_listed_once_and_walls_run_through_windows() {
    let (level, world) = (level(), sample::world());
    let length = |list: &str| -> f64 {
        let of = |w: &Value, end: &str, axis: &str| w[end][axis].as_f64().unwrap();
        zones(&level)
            .iter()
            .flat_map(|z| z[list].as_array().unwrap())
            .map(|w| (of(w, "start", "x") - of(w, "end", "x")).hypot(of(w, "start", "y") - of(w, "end", "y")))
            .sum()
    };
    let windows: f64 = world.floorplan.windows.iter().map(|w| w.line.length()).sum();
    let walls: f64 = world.floorplan.walls.iter().map(|w| w.line.length()).sum();
    assert!((length("walls") - walls - windows).abs() < 1e-6);
    let doors: f64 = world.floorplan.doors.iter().filter(|d| d.kind != DoorKind::Open).map(|d| d.line.length()).sum();
    assert!((length("doors") - doors).abs() < 1e-6);
}

#[test]
fn the_box_of_a_model_covers_the_footprint_of_its_placement() {
    let (level, world) = (level(), sample::world());
    let mut seen = 0;
    for thing in zones(&level).iter().flat_map(|z| z["entities"]["static"].as_array().unwrap()) {
        let p = world.placements.placements.iter().find(|p| thing["name"] == p.placement_id.as_str()).unwrap();
        let number = |v: &Value| v.as_f64().unwrap();
        let q = &thing["pose"]["orientation"];
        let yaw = 2.0 * number(&q["z"]).atan2(number(&q["w"]));
        let (sin, cos) = yaw.sin_cos();
        let at = |x: f64, y: f64| {
            let position = &thing["pose"]["position"];
            (number(&position["x"]) + cos * x - sin * y, number(&position["y"]) + sin * x + cos * y)
        };
        let range = |axis: usize| [number(&thing["bbox"][axis][0]), number(&thing["bbox"][axis][1])];
        let ([x0, x1], [y0, y1]) = (range(0), range(1));
        // The model's front edge (-y) is the footprint's forward edge, corner by corner.
        let model = [at(x0, y1), at(x0, y0), at(x1, y0), at(x1, y1)];
        let footprint = p.footprint();
        let back_right_first = [3, 2, 1, 0].map(|i| footprint.corners()[i]);
        let mirrored = [0, 1, 2, 3].map(|i| footprint.corners()[i]);
        let close = |corners: [d3dgen_model::Point; 4]| {
            model.iter().zip(corners).all(|(m, c)| (m.0 - c.x).abs() < 1e-3 && (m.1 - c.y).abs() < 1e-3)
        };
        assert!(close(mirrored) || close(back_right_first), "{}: {model:?} {footprint:?}", p.placement_id);
        let front = ((model[1].0 + model[2].0) / 2.0 - p.pose.x, (model[1].1 + model[2].1) / 2.0 - p.pose.y);
        let (fy, fx) = p.pose.yaw_rad.sin_cos();
        assert!(front.0 * fx + front.1 * fy > 0.0, "{} looks the wrong way", p.placement_id);
        assert_eq!(range(2), [0.0, p.size_m[2]]);
        seen += 1;
    }
    assert_eq!(seen, world.placements.placements.len());
}

#[test]
fn an_asset_in_two_sizes_becomes_two_models() {
    let mut world = sample::world();
    let chair = world.placements.placements.iter_mut().find(|p| p.object == "chair").unwrap();
    chair.size_m[0] = 0.5;
    let files = Arena.export(&Subject::new(&world, &sample::domain(), &NothingKept)).unwrap();
    let chairs: Vec<&str> =
        files.iter().map(|f| f.path.as_str()).filter(|p| p.contains("/Chair") && p.ends_with(".usdz")).collect();
    assert_eq!(chairs.len(), 2, "{chairs:?}");
    let text =
        files.iter().find(|f| f.path.ends_with("world.yaml")).map(|f| String::from_utf8_lossy(&f.bytes)).unwrap();
    assert!(text.contains("model: Sample/Chair_500x500x880\n") && text.contains("model: Sample/Chair_450x500x880\n"));
}

#[test]
fn an_asset_reference_cannot_leave_the_asset_folder() {
    for asset in ["Chair", "../../x/Chair", "Sample/../Chair", "Sample/..", "Sample/a b", "/Chair"] {
        let mut world = sample::world();
        world.placements.placements[0].asset = asset.into();
        let error = Arena.export(&Subject::new(&world, &sample::domain(), &NothingKept)).unwrap_err();
        assert!(error.to_string().contains(asset), "{error}");
    }
}

#[test]
fn a_world_name_cannot_leave_the_output_folder() {
    for name in ["", "../x", "A", "a/b"] {
        let world = World { name: name.into(), ..sample::world() };
        assert!(Arena.export(&Subject::new(&world, &sample::domain(), &NothingKept)).is_err(), "{name}");
    }
}

#[test]
fn the_map_is_free_in_rooms_and_doors_and_black_outside() {
    let world = sample::world();
    let bytes = map::png(&world.floorplan).unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    let yaml = map::yaml(&world.floorplan);
    let origin = |i: usize| yaml["origin"][i].as_f64().unwrap();
    let at = |x: f64, y: f64| {
        let column = ((x - origin(0)) / 0.05).floor() as usize;
        let row = info.height as usize - 1 - ((y - origin(1)) / 0.05).floor() as usize;
        pixels[row * info.width as usize + column]
    };
    assert_eq!((info.width, info.height), (240, 170));
    assert_eq!([origin(0), origin(1)], [-0.25, -0.25]);
    for (x, y, free) in [
        (1.0, 4.0, true),   // hallway
        (0.9, 4.7, true),   // the door of bedroom 1
        (3.0, 4.7, false),  // the wall beside it
        (0.0, 4.0, true),   // the entrance
        (-0.2, 4.0, false), // outside of it
        (2.0, 8.0, false),  // a window is no passage
        (11.0, 1.0, false), // outside
        (6.5, 4.0, true),   // the open passage
    ] {
        assert_eq!(at(x, y) == 255, free, "({x}, {y})");
    }
}

#[test]
fn the_scenario_uses_portable_keys_only() {
    let scenario = scenario::scenario(&sample::world());
    let keys: Vec<&String> = scenario.as_object().unwrap().keys().collect();
    assert_eq!(keys, ["static", "dynamic", "robots", "regions"]);
    assert_eq!(scenario["robots"][0]["phases"].as_array().unwrap().len(), 2, "a service point, then the dock");
    assert_eq!(scenario["dynamic"][0]["waypoints"][1], "kitchen_1");
    assert_eq!(scenario["regions"]["kitchen_1_sink"]["ref"], "kitchen_1");
    let strip = &scenario["regions"]["visitor_flow_1"]["polygon"];
    assert_eq!(strip[0], serde_json::json!({"x": 0.12, "y": 3.5}), "the strip lies inside the entrance");
}
