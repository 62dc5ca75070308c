//! Conversions of small messages: what is refused, and where.

use d3dgen_model::knowledge::Value;
use d3dgen_model::scene_graph::SceneGraph;

use super::*;

type Spoil = Box<dyn Fn(&mut v1::SceneGraph)>;

fn room() -> v1::GraphRoom {
    v1::GraphRoom {
        room_id: "hall".into(),
        room_type: "hall".into(),
        target_area_m2: 10.0,
        area_range_m2: Some(v1::AreaLimits { min_m2: 8.0, max_m2: 12.0 }),
        ..Default::default()
    }
}

fn graph() -> v1::SceneGraph {
    v1::SceneGraph { version: 1, domain_id: "office".into(), rooms: vec![room()], ..Default::default() }
}

fn problems(message: &v1::SceneGraph) -> Vec<(String, String)> {
    match from_proto::<SceneGraph>(message) {
        Ok(_) => Vec::new(),
        Err(Error::Invalid { problems, .. } | Error::Contract { problems, .. }) => {
            problems.into_iter().map(|p| (p.path, p.message)).collect()
        }
    }
}

#[test]
fn absence_stays_absence() {
    let read: SceneGraph = from_proto(&graph()).unwrap();
    assert_eq!(read.country_code, None);
    assert_eq!(read.occupancy.staff, None);
    assert_eq!(to_proto(&read).unwrap().country_code, None);
    let message = v1::SceneGraph { country_code: Some(String::new()), ..graph() };
    let read: SceneGraph = from_proto(&message).unwrap();
    assert_eq!(to_proto(&read).unwrap().country_code, Some(String::new()));
}

#[test]
fn problems_have_the_path_of_the_message() {
    let cases: Vec<(&str, Spoil)> = vec![
        ("version", Box::new(|g| g.version = 7)),
        ("rooms[0].area_range_m2", Box::new(|g| g.rooms[0].area_range_m2 = None)),
        ("rooms[0].room_id", Box::new(|g| g.rooms[0].room_id = "No Id".into())),
        ("rooms[0].target_area_m2", Box::new(|g| g.rooms[0].target_area_m2 = 99.0)),
        ("rooms[0].target_area_m2", Box::new(|g| g.rooms[0].target_area_m2 = f64::NAN)),
        (
            "apart[0].b_room_id",
            Box::new(|g| {
                g.apart.push(v1::RoomPair { a_room_id: "hall".into(), b_room_id: "attic".into() });
            }),
        ),
        (
            "edges[0].connector",
            Box::new(|g| {
                let (a, b) = ("hall".to_owned(), "hall".to_owned());
                g.edges.push(v1::GraphEdge { a_room_id: a, b_room_id: b, connector: 99, ..Default::default() });
            }),
        ),
    ];
    for (wanted, spoil) in cases {
        let mut message = graph();
        spoil(&mut message);
        let found = problems(&message);
        assert!(found.iter().any(|(path, _)| path == wanted), "{wanted}: {found:?}");
    }
}

#[test]
fn values_of_constraints_keep_their_kind() {
    let cases = [
        serde_json::json!(true),
        serde_json::json!(0.9),
        serde_json::json!({"min": 0.75, "max": 0.85}),
        serde_json::json!({"expr": "2.5*N_robots + 4"}),
        serde_json::json!([1, 2.5, "about 3"]),
        serde_json::json!({"<=60": 0.75, ">220": "5 mm per person", "deep": {"backs_out": true, "list": [1, []]}}),
    ];
    for case in cases {
        let value: Value = serde_json::from_value(case.clone()).unwrap();
        let message: v1::ConstraintValue = to_message(&value).unwrap();
        assert_eq!(from_message::<Value, _>(&message).unwrap(), value, "{case}");
    }
}

#[test]
fn what_the_contract_does_not_know_is_named() {
    let json =
        serde_json::json!({"a": "x", "b": "y", "connector": "tunnel", "required": true, "reason": "", "color": 3});
    let Err(Error::Contract { problems, .. }) = to_message::<v1::GraphEdge>(&json) else { panic!("it has a color") };
    let paths: Vec<&str> = problems.iter().map(|p| p.path.as_str()).collect();
    assert_eq!(paths, ["/connector", "/color"]);
}

#[test]
fn masks_change_what_they_name() {
    let mut target = v1::Placement {
        placement_id: "chair_1".into(),
        pose: Some(v1::Pose { x_m: 1.0, y_m: 2.0, z_m: 0.0, yaw_rad: 0.0 }),
        support_placement_id: Some("desk_1".into()),
        ..Default::default()
    };
    let source = v1::Placement {
        pose: Some(v1::Pose { x_m: 5.0, y_m: 6.0, z_m: 0.0, yaw_rad: 1.0 }),
        locked: true,
        ..Default::default()
    };
    let paths = ["pose.x_m", "locked", "support_placement_id"].map(str::to_owned);
    apply_mask(&mut target, &source, &paths, &["placement_id"]).unwrap();
    assert_eq!(target.pose, Some(v1::Pose { x_m: 5.0, y_m: 2.0, z_m: 0.0, yaw_rad: 0.0 }));
    assert!(target.locked);
    assert_eq!(target.support_placement_id, None);
    assert_eq!(target.placement_id, "chair_1");
    for wrong in ["placement_id", "pose.q", "rule.x", ""] {
        let before = target.clone();
        assert!(apply_mask(&mut target, &source, &[wrong.to_owned()], &["placement_id"]).is_err(), "{wrong}");
        assert_eq!(target, before);
    }
}
