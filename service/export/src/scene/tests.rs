use std::f64::consts::FRAC_PI_2;

use d3dgen_model::floorplan::FixedObstacle;

use super::*;
use crate::models::NothingKept;
use crate::sample;

fn scene(world: &World) -> SimScene {
    SimScene::of(world, &sample::domain(), &NothingKept).unwrap()
}

/// Turns everything of a plan about the origin.
fn turned(mut world: World, by: f64) -> World {
    let (sin, cos) = by.sin_cos();
    let turn = |p: &mut Point| *p = Point::new(cos * p.x - sin * p.y, sin * p.x + cos * p.y);
    let plan = &mut world.floorplan;
    for room in &mut plan.rooms {
        room.polygon.0.iter_mut().chain(&mut room.net_polygon.0).for_each(turn);
    }
    let lines = plan.walls.iter_mut().map(|w| &mut w.line).chain(plan.doors.iter_mut().map(|d| &mut d.line));
    lines.chain(plan.windows.iter_mut().map(|w| &mut w.line)).flat_map(|l| [&mut l.start, &mut l.end]).for_each(turn);
    for p in &mut world.placements.placements {
        let mut at = Point::new(p.pose.x, p.pose.y);
        turn(&mut at);
        (p.pose.x, p.pose.y, p.pose.yaw_rad) = (at.x, at.y, p.pose.yaw_rad + by);
    }
    world
}

fn outline_and_z(shape: &SimShape) -> (Polygon, [f64; 2]) {
    match shape {
        SimShape::Box(b) => (Polygon(b.outline().to_vec()), [b.center_m[2] - b.half_m[2], b.center_m[2] + b.half_m[2]]),
        SimShape::Prism { outline, z_m } => (Polygon(outline.clone()), *z_m),
    }
}

fn volume(shape: &SimShape) -> f64 {
    let (outline, [low, high]) = outline_and_z(shape);
    outline.signed_area() * (high - low)
}

/// How many pieces of walls hold a point.
fn holding(scene: &SimScene, p: Point, z: f64) -> usize {
    let shapes = scene.walls.iter().flat_map(|w| &w.pieces).map(|p| outline_and_z(&p.shape));
    shapes.filter(|(outline, [low, high])| *low < z && z < *high && outline.contains(p)).count()
}

#[test]
fn walls_are_cut_at_doors_and_windows_whatever_way_they_run() {
    for by in [0.0, 0.4, 2.0] {
        let world = turned(sample::world(), by);
        let scene = scene(&world);
        for door in &world.floorplan.doors {
            let line = walls::Line::of(&door.line);
            for k in 1..20 {
                let p = line.point(line.length * f64::from(k) / 20.0, 0.01);
                assert_eq!(holding(&scene, p, 1.0), 0, "{} is open at {p:?}", door.door_id);
                assert_eq!(holding(&scene, p, door.height_m + 0.1), 1, "{} has a lintel", door.door_id);
            }
        }
        for window in &world.floorplan.windows {
            let p = window.line.middle();
            let at = |z| holding(&scene, p, z);
            assert_eq!([at(0.5), at(1.5), at(2.4)], [1, 0, 1], "{} at {by}", window.window_id);
        }
    }
}

#[test]
fn turning_a_world_turns_its_scene() {
    let plain = scene(&sample::world());
    let turned = scene(&turned(sample::world(), 0.7));
    let sizes = |scene: &SimScene| -> Vec<(WallPart, i64)> {
        let pieces = scene.walls.iter().flat_map(|w| &w.pieces);
        pieces.map(|p| (p.part, (volume(&p.shape) * 1e6).round() as i64)).collect()
    };
    assert_eq!(sizes(&plain), sizes(&turned), "no wall depends on the way it runs");
    for (a, b) in plain.doors.iter().flat_map(|d| &d.leaves).zip(turned.doors.iter().flat_map(|d| &d.leaves)) {
        assert_eq!((a.joint.hinge, a.mass_kg > 0.0), (b.joint.hinge, true));
        assert!((a.joint.limits[1] - b.joint.limits[1]).abs() < 1e-9, "{}", a.id);
        let [x, y, z] = a.joint.axis;
        let (sin, cos) = 0.7_f64.sin_cos();
        let expected = [cos * x - sin * y, sin * x + cos * y, z];
        assert!((0..3).all(|k| (b.joint.axis[k] - expected[k]).abs() < 1e-9), "{} {:?}", b.id, b.joint.axis);
    }
}

#[test]
fn corners_are_closed_and_no_place_is_in_two_walls() {
    let scene = scene(&sample::world());
    // Along the walls of the outer corners and the junctions, at the middle of their height where no window is.
    let (mut once, mut gaps) = (0, Vec::new());
    for i in -5..400 {
        for j in -5..320 {
            let p = Point::new(f64::from(i) * 0.025 + 0.0123, f64::from(j) * 0.025 + 0.0123);
            match holding(&scene, p, 0.2) {
                0 => gaps.push(p),
                1 => once += 1,
                n => panic!("{p:?} is in {n} walls"),
            }
        }
    }
    assert!(once > 1000);
    for corner in [(-0.1, -0.1), (0.1, 0.1), (10.1, -0.1), (-0.1, 8.1)] {
        assert_eq!(holding(&scene, Point::new(corner.0, corner.1), 1.0), 1, "the corner at {corner:?} is closed");
    }
}

#[test]
fn leaves_fill_their_openings_closed_and_leave_them_open() {
    let world = sample::world();
    let scene = scene(&world);
    assert_eq!(scene.doors.iter().map(|d| d.leaves.len()).collect::<Vec<_>>(), [2, 1, 1, 1, 0, 1, 1]);
    for (door, plan) in scene.doors.iter().zip(&world.floorplan.doors) {
        let line = walls::Line::of(&plan.line);
        let clear = d3dgen_model::obstacles::clear_opening(plan);
        let [a, b] = [clear.start, clear.end].map(|p| line.place(p)[0]);
        for leaf in &door.leaves {
            for corner in opened(leaf) {
                let [along, left] = line.place(corner);
                let in_wall = left.abs() < plan.wall_thickness_m / 2.0 + 1e-6;
                let in_way = along > a + 0.01 && along < b - 0.01;
                assert!(!(in_wall && in_way), "{} stands in the way at {along:.3} of {a:.3}-{b:.3}", leaf.id);
            }
            for p in leaf.closed.outline() {
                assert_eq!(holding(&scene, p, 1.0), 0, "{} closed is in no wall", leaf.id);
            }
            if !leaf.joint.hinge {
                for p in opened(leaf) {
                    assert_eq!(holding(&scene, p, 1.0), 0, "{} open is in its pocket", leaf.id);
                }
            }
        }
    }
}

/// The outline of a leaf at its limit.
fn opened(leaf: &SimLeaf) -> Vec<Point> {
    let joint = &leaf.joint;
    let move_one = |p: Point| match joint.hinge {
        true => {
            assert!((joint.limits[1] - FRAC_PI_2).abs() < 1e-9);
            let (dx, dy, s) = (p.x - joint.origin_m[0], p.y - joint.origin_m[1], joint.axis[2]);
            Point::new(joint.origin_m[0] - s * dy, joint.origin_m[1] + s * dx)
        }
        false => Point::new(p.x + joint.axis[0] * joint.limits[1], p.y + joint.axis[1] * joint.limits[1]),
    };
    leaf.closed.outline().into_iter().map(move_one).collect()
}

#[test]
fn ids_are_unique_and_names() {
    let scene = scene(&sample::world());
    let mut all: Vec<&str> = scene.rooms.iter().map(|r| r.id.as_str()).collect();
    all.extend(scene.walls.iter().map(|w| w.id.as_str()));
    all.extend(scene.doors.iter().map(|d| d.id.as_str()));
    all.extend(scene.doors.iter().flat_map(|d| &d.leaves).map(|l| l.id.as_str()));
    all.extend(scene.windows.iter().map(|w| w.id.as_str()));
    all.extend(scene.objects.iter().map(|o| o.id.as_str()));
    all.extend(scene.lights.iter().map(|l| l.id.as_str()));
    let distinct: BTreeSet<&str> = all.iter().copied().collect();
    assert_eq!(distinct.len(), all.len());
    assert!(all.iter().all(|id| id.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')));
    assert_eq!(scene.objects.len(), sample::world().placements.placements.len());
}

#[test]
fn chairs_move_what_hangs_is_fixed_and_lamps_give_light() {
    let scene = scene(&sample::world());
    let of = |class: &str| scene.objects.iter().find(|o| o.class == class).unwrap();
    let mobility = ["chair", "wardrobe", "tv", "toilet", "stool"].map(|class| of(class).mobility);
    use Mobility::*;
    assert_eq!(mobility, [Movable, Fixed, Fixed, Fixed, Movable]);
    assert!(scene.objects.iter().all(|o| o.mass_kg > 0.0 && o.friction > 0.0));
    assert_eq!(of("monitor").support.as_deref(), Some("bedroom_2_desk_1"));
    assert_eq!(scene.lights.len(), 2, "the floor lamp and the ceiling lamp");
}

#[test]
fn columns_at_an_angle_are_convex_pieces_from_floor_to_ceiling() {
    let mut world = sample::world();
    let outline = [(6.0, 5.5), (6.4, 5.6), (6.3, 6.0), (6.15, 5.75), (5.9, 5.9)];
    world.floorplan.obstacles.push(FixedObstacle {
        obstacle_id: "column_1".into(),
        kind: d3dgen_model::floorplan::ObstacleKind::Column,
        outline: Polygon(outline.map(|(x, y)| Point::new(x, y)).to_vec()),
        room_id: "living_room_1".into(),
        locked: false,
    });
    let scene = scene(&world);
    let column = scene.walls.iter().find(|w| w.id == "column_1").unwrap();
    let sum: f64 = column.pieces.iter().map(|p| volume(&p.shape)).sum();
    let expected = world.floorplan.obstacles[0].outline.area();
    assert!(column.pieces.len() > 1 && (sum / expected - 2.65).abs() < 0.01, "{} of {expected}", sum / expected);
}

#[test]
fn what_rests_on_nothing_is_fixed_and_rugs_do_not_collide() {
    let monitor = |lift: f64| {
        let mut world = sample::world();
        let on = world.placements.placements.iter_mut().find(|p| p.object == "monitor").unwrap();
        on.pose.z += lift;
        let scene = scene(&world);
        scene.objects.iter().find(|o| o.class == "monitor").unwrap().mobility
    };
    assert_eq!([monitor(0.0), monitor(0.02), monitor(-0.01)], [Mobility::Movable, Mobility::Fixed, Mobility::Fixed]);
    let scene = scene(&sample::world());
    let without: Vec<&str> = scene.objects.iter().filter(|o| !o.collides).map(|o| o.class.as_str()).collect();
    assert_eq!(without, ["rug"]);
    assert!(scene.objects.iter().all(|o| o.collides || o.mobility == Mobility::Fixed));
}

#[test]
fn lamps_are_warm_or_cool_and_a_window_is_a_box_around_its_frame() {
    let scene = scene(&sample::world());
    let white = |kelvin: f64| SimLight { kelvin, ..scene.lights[0].clone() }.white();
    let ([_, _, warm], [_, _, cool]) = (white(2700.0), white(6500.0));
    assert!(warm < 0.75 && cool > 0.95, "{warm} {cool}");
    let window = &scene.windows[0];
    let (volume, whole) = (|b: &SimBox| b.half_m.iter().product::<f64>(), window.whole());
    let top = |b: &SimBox| b.center_m[2] + b.half_m[2];
    assert!(
        window.frame.iter().chain([&window.glass]).all(|b| volume(b) < volume(&whole) && top(b) < top(&whole) + 1e-9)
    );
    assert!(window.frame.iter().any(|b| (top(b) - top(&whole)).abs() < 1e-9));
}
