use d3dgen_model::geometry::Segment;
use d3dgen_plans::{OpeningKind, Options, Plan, Source, assemble, lay_out, read};

use super::*;
use crate::sample;

fn drawn() -> String {
    dxf(&sample::world(), &sample::domain(), &[])
}

/// Returns the groups of each entity of a kind on a layer.
fn entities<'a>(file: &'a str, kind: &str, layer: &str) -> Vec<BTreeMap<i32, &'a str>> {
    let lines: Vec<&str> = file.lines().collect();
    let pairs: Vec<(i32, &str)> = lines.chunks_exact(2).map(|p| (p[0].parse().unwrap(), p[1])).collect();
    let (_, pairs) = pairs.split_at(pairs.iter().position(|p| p.1 == "ENTITIES").unwrap());
    let starts: Vec<usize> = (0..pairs.len()).filter(|i| pairs[*i].0 == 0).collect();
    let groups = starts.windows(2).map(|w| &pairs[w[0]..w[1]]).filter(|e| e[0].1 == kind);
    groups.map(|e| e[1..].iter().copied().collect::<BTreeMap<_, _>>()).filter(|e| e[&8] == layer).collect()
}

#[test]
fn our_own_reader_finds_the_same_rooms_and_doors() {
    let (file, plan) = (drawn(), sample::floorplan());
    let options = Options::default();
    let source = Source { name: "plan.dxf", bytes: file.as_bytes(), companion: &|_| None };
    let Ok(Plan::Drawing(drawing)) = read(&source, &options) else { panic!("a drawing") };
    let layout = lay_out(drawing, &options).expect("a plan");
    assert_eq!(layout.rooms.len(), plan.rooms.len(), "{:?}", layout.notes);
    // the reader moves a plan to its own origin
    let corner = |polygons: Vec<&Polygon>| {
        let all = polygons.into_iter().map(Polygon::bounds).reduce(|a, b| a.union(&b)).unwrap();
        (all.x0, all.y0)
    };
    let ours = corner(plan.rooms.iter().map(|r| &r.net_polygon).collect());
    let theirs = corner(layout.rooms.iter().map(|r| &r.net_polygon).collect());
    let (dx, dy) = (theirs.0 - ours.0, theirs.1 - ours.1);
    for room in &plan.rooms {
        let at = inside(&room.net_polygon);
        let at = Point::new(at.x + dx, at.y + dy);
        let read = layout.rooms.iter().find(|r| r.net_polygon.contains(at)).unwrap();
        assert!(read.label.contains(&room.name), "{:?} is {}", read.label, room.name);
        assert!((read.net_polygon.area() - room.net_area_m2).abs() < 0.05, "{}", room.name);
    }
    let kinds = |kind: OpeningKind| layout.openings.iter().filter(|o| o.kind == kind).count();
    let of_ours = |open: bool| plan.doors.iter().filter(|d| (d.kind == DoorKind::Open) == open).count();
    assert_eq!(
        (kinds(OpeningKind::Door), kinds(OpeningKind::Passage)),
        (of_ours(false), of_ours(true)),
        "{:?}",
        layout.notes
    );
    assert_eq!(kinds(OpeningKind::Window), plan.windows.len(), "{:?}", layout.notes);
    let types: Vec<String> = layout
        .rooms
        .iter()
        .map(|r| plan.rooms.iter().find(|own| r.label.contains(&own.name)).unwrap().room_type.clone())
        .collect();
    let (read, _) = assemble(layout, &types, &sample::domain(), 0, &options);
    let theirs = corner(read.rooms.iter().map(|r| &r.net_polygon).collect());
    let (dx, dy) = (theirs.0 - ours.0, theirs.1 - ours.1);
    // the reader takes outer walls for thinner than ours, so that what lies in them is nearer to the room
    let near = |a: Segment, b: Segment| {
        let (m, n) = (a.middle(), b.middle());
        (a.length() - b.length()).abs() < 2e-3 && Point::new(m.x + dx, m.y + dy).distance(n) < 0.12
    };
    for door in &plan.doors {
        let found = read.doors.iter().find(|d| near(door.line, d.line)).unwrap_or_else(|| panic!("{}", door.door_id));
        assert_eq!(found.room_ids.len(), door.room_ids.len(), "{}", door.door_id);
        assert_eq!(found.kind == DoorKind::Open, door.kind == DoorKind::Open, "{}", door.door_id);
        if let (DoorKind::Hinged, Some(swing)) = (door.kind, &door.swing) {
            assert_eq!(found.swing.as_ref().map(|s| s.into_room_id.is_some()), Some(swing.into_room_id.is_some()));
        }
    }
    assert!(plan.windows.iter().all(|w| read.windows.iter().any(|v| near(w.line, v.line))));
}

#[test]
fn every_object_and_place_stands_at_its_pose() {
    let (file, world) = (drawn(), sample::world());
    let number = |e: &BTreeMap<i32, &str>, code: i32| e[&code].parse::<f64>().unwrap();
    let inserts = entities(&file, "INSERT", "FURNITURE");
    assert_eq!(inserts.len(), world.placements.placements.len());
    for (e, p) in inserts.iter().zip(&world.placements.placements) {
        assert_eq!(e[&2], block_of(p));
        assert!((number(e, 10) - p.pose.x).abs() < 1e-3 && (number(e, 20) - p.pose.y).abs() < 1e-3);
        assert!((number(e, 50) - p.pose.yaw_rad.to_degrees()).abs() < 0.1, "{}", p.placement_id);
    }
    let places = entities(&file, "INSERT", "ROBOT_SYMBOLS");
    assert_eq!(places.len(), world.scenario.pois.len() + world.scenario.robots.len());
}

#[test]
fn dimensions_measure_the_building_at_full_size() {
    let file = drawn();
    let number = |e: &BTreeMap<i32, &str>, code: i32| e[&code].parse::<f64>().unwrap();
    let around = outer_bounds(&sample::floorplan());
    let lengths: Vec<f64> = entities(&file, "DIMENSION", "DIMENSIONS")
        .iter()
        .map(|e| (number(e, 13) - number(e, 14)).hypot(number(e, 23) - number(e, 24)))
        .collect();
    for side in [around.width(), around.height()] {
        assert!(lengths.iter().any(|l| (l - side).abs() < 1e-3), "{lengths:?} has {side}");
    }
    assert!(lengths.len() > 10, "{lengths:?}");
    assert_eq!(file, drawn(), "the same bytes again");
    assert!(file.is_ascii() && file.ends_with("0\nEOF\n"));
}
