use d3dgen_model::domain::Shape;
use serde_json::{Value, json};

use super::*;
use crate::model3d::{Collision, JointKind};

fn object(value: Value) -> ObjectType {
    let mut object = json!({
        "id": "thing", "label": "thing", "sizes_m": [[0.8, 0.6, 1.0]], "mount": "floor", "shape": "box", "color": "#336699",
        "material": "wood"
    });
    for (key, value) in value.as_object().unwrap() {
        object[key] = value.clone();
    }
    serde_json::from_value(object).unwrap()
}

fn library(builds: Value) -> Library {
    let builds: Vec<Build> = serde_json::from_value(builds).unwrap();
    Library::from_builds(&builds).unwrap_or_else(|e| panic!("{e}"))
}

fn plain(id: &str) -> Value {
    json!({"id": id, "kind": "container",
        "parts": [{"solid": "box", "x": [0, "w"], "y": [0, "d"], "z": [0, "h"]}]})
}

/// A chest of three drawers and two mirrored doors on wheels.
fn chest() -> Library {
    library(json!([{
        "id": "thing", "kind": "cabinet", "let": {"high": "h/4"}, "choices": {"n_grips": [1, 2]},
        "parts": [
            {"solid": "box", "x": [0, "w"], "y": [0.02, "d"], "z": [0.1, "h"]},
            {"solid": "box", "x": [0, "w"], "y": [0, 0.02], "z": ["high", "2*high"], "body": "drawer"},
            {"solid": "box", "x": ["w*(i + 1)/(n + 1) - 0.01", "w*(i + 1)/(n + 1) + 0.01"], "y": [0.001, 0.01],
                "z": ["high*1.4", "high*1.5"], "tone": "metal", "body": "drawer", "repeat": {"count": "n_grips"}},
            {"solid": "box", "x": [0, "w/2"], "y": [0, 0.02], "z": [0.1, "high"], "body": "door"},
            {"solid": "cylinder", "axis": "x", "x": [0.05, 0.08], "y": [0.05, 0.15], "z": [0, 0.1], "tone": "rubber",
                "body": "wheel"}
        ],
        "joints": [
            {"body": "drawer", "kind": "prismatic", "at": [0, 0, "high"], "axis": [0, -1, 0], "limits": [0, "d/2"],
                "repeat": {"count": 3, "step": [0, 0, "high"]}},
            {"body": "door", "kind": "revolute", "at": [0, 0, 0.2], "axis": [0, 0, -1], "limits": [0, 90], "mirror": "x"},
            {"body": "wheel", "kind": "continuous", "at": [0.065, 0.1, 0.05], "axis": [1, 0, 0], "mirror": "xy"}
        ]
    }]))
}

#[test]
fn the_nearest_build_is_taken() {
    let mut builds: Vec<Value> = ["named", "thing", "listed", "box"].map(plain).into();
    builds[2]["for"] = json!(["other"]);
    let library = library(json!(builds));
    for (object_, expected) in [
        (json!({"build": "named"}), "named"),
        (json!({}), "thing"),
        (json!({"id": "other"}), "listed"),
        (json!({"id": "third"}), "box"),
    ] {
        assert_eq!(library.of(&object(object_)).unwrap().id, expected);
    }
    let error = library.of(&object(json!({"build": "nothing"}))).unwrap_err();
    assert_eq!(error, Error::NoBuild { object: "thing".into(), build: "nothing".into() });
    let own: Vec<Build> = serde_json::from_value(json!([{"id": "mine", "kind": "x", "for": ["other"],
        "parts": [{"solid": "sphere", "x": [0, "w"], "y": [0, "d"], "z": [0, "h"]}]}]))
    .unwrap();
    assert_eq!(library.with(&own).of(&object(json!({"id": "other"}))).unwrap().id, "mine");
}

#[test]
fn bounds_are_the_size_and_the_origin_is_under_the_middle() {
    for size in [[0.8, 0.6, 1.0], [0.003, 2.0, 7.0], [1.1, 0.4, 0.002]] {
        let model = generate(&library(json!([plain("thing")])), &object(json!({})), size, 0).unwrap();
        let [min, max] = model.bounds().unwrap();
        for k in 0..3 {
            let low = if k == 2 { 0.0 } else { -size[k] / 2.0 };
            assert!((min[k] - low).abs() <= 1e-6 * size[k] && (max[k] - low - size[k]).abs() <= 1e-6 * size[k]);
        }
        assert_eq!(model.triangle_count(), 12);
    }
}

#[test]
fn bodies_follow_the_copies_of_their_joints() {
    let model = generate(&chest(), &object(json!({})), [0.8, 0.6, 1.0], 0).unwrap();
    let names: Vec<&str> = model.bodies.iter().map(|b| b.name.as_str()).collect();
    let expected =
        ["base", "drawer_0", "drawer_1", "drawer_2", "door_0", "door_1", "wheel_0", "wheel_1", "wheel_2", "wheel_3"];
    assert_eq!(names, expected);
    let joint = |child: &str| {
        model.joints.iter().find(|j| model.bodies[j.child].name == child).unwrap_or_else(|| panic!("no {child}"))
    };
    assert_eq!(joint("drawer_2").kind, JointKind::Prismatic);
    assert!((joint("drawer_2").origin[2] - 0.75).abs() < 1e-9);
    assert_eq!(joint("drawer_0").limits, Some([0.0, 0.3]));
    assert_eq!((joint("door_0").axis, joint("door_1").axis), ([0.0, 0.0, -1.0], [0.0, 0.0, 1.0]), "both open outward");
    assert_eq!((joint("door_0").origin[0], joint("door_1").origin[0]), (-0.4, 0.4));
    assert!((joint("door_1").limits.unwrap()[1] - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    assert_eq!(joint("wheel_3").limits, None);
    let wheel = |i: usize| model.bodies[6 + i].collisions.clone();
    let Collision::Cylinder { center, radius, axis: 0, .. } = wheel(3)[0] else { panic!("{:?}", wheel(3)) };
    assert!((radius - 0.05).abs() < 1e-9 && center[0] > 0.0 && center[1] > 0.0, "the last wheel is at the back right");
    // One front and one grip in every drawer, two grips with another seed.
    assert_eq!(model.bodies[2].collisions.len(), 2);
    let other = (1..9).map(|seed| generate(&chest(), &object(json!({})), [0.8, 0.6, 1.0], seed).unwrap());
    let grips: std::collections::BTreeSet<usize> = other.map(|m| m.bodies[3].collisions.len() - 1).collect();
    assert_eq!(grips, [1, 2].into());
}

#[test]
fn a_joint_left_out_leaves_its_parts_with_the_parent() {
    let library = library(json!([{
        "id": "thing", "kind": "x",
        "parts": [
            {"solid": "box", "x": [0, "w"], "y": [0, "d"], "z": [0, "h/2"]},
            {"solid": "box", "x": [0, "w"], "y": [0, "d"], "z": ["h/2", "h"], "body": "lid"}
        ],
        "joints": [{"body": "lid", "kind": "continuous", "at": [0, 0, 0], "axis": [0, 0, 1], "when": "h - 2"}]
    }]));
    let count = |h: f64| generate(&library, &object(json!({})), [1.0, 1.0, h], 0).unwrap().bodies.len();
    assert_eq!((count(3.0), count(1.0)), (2, 1));
}

#[test]
fn same_inputs_same_model() {
    let library = Library::shipped();
    for shape in Shape::all() {
        let object = object(json!({"shape": shape.name()}));
        if library.get(shape.name()).is_some() {
            let make = |seed| generate(library, &object, [0.8, 0.6, 1.0], seed).unwrap();
            assert_eq!(make(7), make(7), "{shape:?}");
        }
    }
}

#[test]
fn errors_name_build_part_and_field() {
    let cases = [
        (json!({"solid": "box", "x": [0, "w"], "y": [0, "d"], "z": ["h", "h - 0.1"]}), "part 1 (p), z: runs from 1"),
        (json!({"solid": "box", "x": [0, "1/(w - w)"], "y": [0, "d"], "z": [0, "h"]}), "part 1 (p), x/1: `1/(w - w)`"),
        (
            json!({"solid": "box", "x": [0, "w*2"], "y": [0, "d"], "z": [0, "h"]}),
            "parts: the parts span x 0.0000 to 1.6",
        ),
        (json!({"solid": "shell", "x": [0, "w"], "y": [0, "d"], "z": [0, "h"], "wall": "w"}), "part 1 (p): walls of"),
        (json!({"solid": "tube", "path": [[0, 0, 0], ["w*0", 0, 0]], "radius": 0.01}), "part 1 (p): the path has"),
        (
            json!({"solid": "box", "x": [0, "w"], "y": [0, "d"], "z": [0, "h"], "repeat": {"count": 5000}}),
            "repeat/count",
        ),
        (
            json!({"solid": "cushion", "x": [0, "w"], "y": [0, "d"], "z": [0, "h"], "repeat": {"count": 400}}),
            "triangles",
        ),
    ];
    for (part, expected) in cases {
        let mut build = plain("thing");
        let mut part = part;
        part["id"] = json!("p");
        build["parts"].as_array_mut().unwrap().push(part);
        let error = generate(&library(json!([build])), &object(json!({})), [0.8, 0.6, 1.0], 0).unwrap_err().to_string();
        assert!(error.starts_with("build `thing` at 0.8 x 0.6 x 1 m, ") && error.contains(expected), "{error}");
    }
    let error = generate(&library(json!([plain("thing")])), &object(json!({})), [0.8, f64::NAN, 1.0], 0).unwrap_err();
    assert!(matches!(error, Error::Size { .. }));
    let twice: Vec<Build> = serde_json::from_value(json!([plain("thing"), plain("thing")])).unwrap();
    assert!(Library::from_builds(&twice).unwrap_err().to_string().contains("/builds/1/id"));
}

#[test]
fn shipped_builds_have_no_problem() {
    let builds: Vec<Build> = Library::shipped().builds().cloned().collect();
    let problems: Vec<String> = Library::problems(&builds)
        .iter()
        .map(|p| {
            format!(
                "{} {p}",
                p.path.split('/').nth(2).and_then(|i| builds.get(i.parse::<usize>().ok()?)).map_or("", |b| &b.id)
            )
        })
        .collect();
    assert_eq!(problems, Vec::<String>::new());
}

#[test]
fn a_shipped_build_at_an_odd_size_has_a_stand_in_and_an_own_one_has_not() {
    let shipped = Library::shipped();
    let odd = [0.002, 20.0, 0.002];
    for shape in Shape::all() {
        let object = object(json!({"shape": shape.name()}));
        let model = generate(shipped, &object, odd, 0).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(model.bounds().map(|[min, max]| (max[1] - min[1]).round()), Some(20.0));
    }
    let narrow = json!([{"id": "thing", "kind": "x",
        "parts": [{"solid": "box", "x": [0.1, "w - 0.1"], "y": [0, "d"], "z": [0, "h"]}]}]);
    let own = shipped.with(&serde_json::from_value::<Vec<Build>>(narrow).unwrap());
    assert!(matches!(generate(&own, &object(json!({})), odd, 0), Err(Error::Build { .. })));
}
