//! Rooms of the built-in domains furnished by themselves: what the hard rules and good sense ask of them.

use d3dgen_knowledge::Limits;
use d3dgen_knowledge::clearance::{is_shallow, quarter};
use d3dgen_knowledge::freespace::FreeSpace;
use d3dgen_model::domain::{Domain, Materials, Mount, Relation, Shape};
use d3dgen_model::floorplan::{Door, DoorKind, FixedObstacle, Floorplan, ObstacleKind, PlanRoom, Swing, Window};
use d3dgen_model::occupancy::stops_robot;
use d3dgen_model::placements::{Placement, Placements};
use d3dgen_model::scene_graph::{GraphRoom, Occupancy, SceneGraph};
use d3dgen_model::{Point, Polygon, Rect, Segment};
use d3dgen_plugins::Registry;

use super::unit::{Forms, variants};

const OUTER_M: f64 = 0.24;

/// One room of `width` x `depth` m with doors in its south wall and windows (from, to, sill) in its north wall.
struct Site<'s> {
    room_type: &'s str,
    width: f64,
    depth: f64,
    doors: Vec<f64>,
    windows: Vec<(f64, f64, f64)>,
    circulation: bool,
    /// Whether door leaves swing into the room.
    leaf_inside: bool,
    columns: Vec<FixedObstacle>,
}

impl<'s> Site<'s> {
    fn new(room_type: &'s str, width: f64, depth: f64) -> Self {
        Self {
            room_type,
            width,
            depth,
            doors: vec![width / 2.0],
            windows: Vec::new(),
            circulation: false,
            leaf_inside: true,
            columns: Vec::new(),
        }
    }

    fn id(&self) -> String {
        format!("{}_1", self.room_type)
    }

    fn plan(&self, domain: &Domain) -> Floorplan {
        let kind = domain.room_type(self.room_type).expect("the domain has the room type");
        let line = |x0: f64, x1: f64, y: f64| Segment { start: Point::new(x0, y), end: Point::new(x1, y) };
        let net = Rect::new(0.0, 0.0, self.width, self.depth);
        let material = || "Concrete_Smooth".to_owned();
        let room = PlanRoom {
            room_id: self.id(),
            room_type: self.room_type.into(),
            name: self.room_type.into(),
            circulation: self.circulation,
            polygon: Polygon(net.grown(OUTER_M / 2.0).corners().to_vec()),
            net_polygon: Polygon(net.corners().to_vec()),
            net_area_m2: net.area(),
            ceiling_height_m: kind.ceiling_height_m,
            materials: Materials { floor: material(), wall: material(), ceiling: material() },
            locked: false,
            level: 0,
        };
        let door = |(i, x): (usize, &f64)| Door {
            door_id: format!("door_{i}"),
            kind: DoorKind::Hinged,
            line: line(x - 0.5, x + 0.5, -OUTER_M / 2.0),
            clear_width_m: 0.9,
            height_m: 2.1,
            wall_thickness_m: OUTER_M,
            room_ids: vec![self.id()],
            entrance: i == 0,
            swing: Some(Swing { into_room_id: self.leaf_inside.then(|| self.id()), hinge_at_start: true }),
            slide: None,
            automatic: false,
            locked: false,
        };
        let window = |(i, w): (usize, &(f64, f64, f64))| Window {
            window_id: format!("window_{i}"),
            line: line(w.0, w.1, self.depth + OUTER_M / 2.0),
            sill_m: w.2,
            head_m: 2.2,
            wall_thickness_m: OUTER_M,
            room_id: self.id(),
            locked: false,
        };
        Floorplan {
            version: 1,
            seed: 0,
            scheme: "straight".into(),
            rooms: vec![room],
            walls: Vec::new(),
            doors: self.doors.iter().enumerate().map(door).collect(),
            windows: self.windows.iter().enumerate().map(window).collect(),
            obstacles: self.columns.clone(),
            cost: Vec::new(),
            conflicts: Vec::new(),
            levels: Vec::new(),
            links: Vec::new(),
        }
    }

    fn furnished(&self, domain: &Domain, seed: u64) -> Placements {
        let area = self.width * self.depth;
        let room = GraphRoom {
            id: self.id(),
            room_type: self.room_type.into(),
            name: self.room_type.into(),
            description: String::new(),
            target_area_m2: area,
            area_range_m2: [area, area],
            wished_assets: Vec::new(),
            sides_m: None,
            occupants: None,
            circulation: self.circulation,
            requested: true,
            entrance: false,
            locked: false,
            unit: None,
            garden_door: false,
            level: 0,
        };
        let graph = SceneGraph {
            version: 1,
            prompt: String::new(),
            seed,
            domain: domain.id.clone(),
            building_type: None,
            country_code: None,
            division_code: None,
            wheelchair: false,
            language: "en".into(),
            area_m2: None,
            occupancy: Occupancy::default(),
            accessible: false,
            style: d3dgen_model::style::Style::default(),
            rooms: vec![room],
            edges: Vec::new(),
            apart: Vec::new(),
            links: Vec::new(),
            forbidden_room_types: Vec::new(),
            robots: Vec::new(),
            robot_rules: Vec::new(),
            two_way: false,
            assumptions: Vec::new(),
            conflicts: Vec::new(),
        };
        super::generate(&graph, &self.plan(domain), domain, &Limits::default(), None).expect("nothing is locked")
    }
}

fn with_domain(id: &str, look: impl FnOnce(&Domain)) {
    let registry = Registry::builtin();
    look(registry.get(id).expect("the domain is built in").domain());
}

fn of<'p>(placements: &'p Placements, object: &str) -> Vec<&'p Placement> {
    placements.placements.iter().filter(|p| p.object == object).collect()
}

#[test]
fn nothing_stands_in_a_column_and_ways_lead_around_it() {
    with_domain("office", |domain| {
        let column = |x: f64, y: f64, k: u32| FixedObstacle {
            obstacle_id: format!("obstacle_{k}"),
            kind: ObstacleKind::Column,
            outline: Polygon(
                (0..8)
                    .map(|i| f64::from(i) * std::f64::consts::FRAC_PI_4)
                    .map(|a| Point::new(x + 0.3 * a.cos(), y + 0.3 * a.sin()))
                    .collect(),
            ),
            room_id: "meeting_room_1".into(),
            locked: true,
        };
        let columns = vec![column(3.0, 2.5, 1), column(5.0, 2.5, 2)];
        let site = Site { columns: columns.clone(), ..Site::new("meeting_room", 8.0, 5.0) };
        for seed in 0..3 {
            let found = site.furnished(domain, seed);
            assert!(!found.placements.is_empty());
            for p in found.placements.iter().filter(|p| stops_robot(p)) {
                let rect = p.footprint().bounds();
                let shared: f64 =
                    columns.iter().flat_map(|c| c.outline.cover(0.05)).map(|r| r.common_area(&rect)).sum();
                assert!(shared < 0.001, "seed {seed}: {} shares {shared:.3} m2 with a column", p.object);
            }
        }
    });
}

#[test]
fn corridors_keep_their_width_and_are_not_bare() {
    for (id, depth) in [("office", 1.5), ("hospital", 2.4), ("school", 2.0), ("office", 2.2), ("general", 1.8)] {
        with_domain(id, |domain| {
            let doors = vec![1.0, 6.0, 11.0];
            let site = Site { doors, circulation: true, ..Site::new("corridor", 12.0, depth) };
            let plan = site.plan(domain);
            for seed in 0..4 {
                let found = site.furnished(domain, seed);
                let narrows = |p: &&Placement| stops_robot(p) && !is_shallow(p);
                let taken: Vec<Rect> =
                    found.placements.iter().filter(narrows).map(|p| p.footprint().bounds()).collect();
                let space = FreeSpace::new(&plan.rooms[0].net_polygon, &taken);
                let width = space.passage(&plan.doors.iter().collect::<Vec<_>>());
                assert!(width >= domain.circulation.width_m - 1e-6, "{id} {seed}: {width:.2} m are left");
                assert!(found.placements.len() >= 4, "{id} {seed}: {} things", found.placements.len());
            }
        });
    }
}

#[test]
fn nothing_stands_in_the_light_of_windows() {
    let rooms = [("residential", "kitchen", 3.2, 3.4), ("residential", "living_room", 5.0, 4.6)];
    for (id, room_type, width, depth) in rooms.into_iter().chain([("general", "guest_room", 4.0, 5.0)]) {
        with_domain(id, |domain| {
            let site = Site { windows: vec![(0.6, width - 0.6, 0.9)], ..Site::new(room_type, width, depth) };
            for seed in 0..6 {
                let found = site.furnished(domain, seed);
                let curtain = |p: &&Placement| domain.object(&p.object).is_some_and(|o| o.shape == Shape::Curtain);
                for p in found.placements.iter().filter(|p| !curtain(p)) {
                    let r = p.footprint().bounds();
                    let before = r.y1 > depth - 0.25 && r.x0 < width - 0.6 - 1e-6 && r.x1 > 0.6 + 1e-6;
                    let lit = p.top_m() <= 0.9 + 1e-6 || p.pose.z >= 2.2 - 1e-6;
                    assert!(!before || lit, "{room_type} {seed}: {} reaches {:.2} m", p.placement_id, p.top_m());
                }
                assert!(!found.unplaced.iter().any(|u| u.required), "{room_type} {seed}: {:?}", found.unplaced);
            }
        });
    }
}

#[test]
fn pupils_look_at_the_board_and_the_teacher_at_them() {
    with_domain("school", |domain| {
        let windows = vec![(0.6, 2.6, 0.9), (3.0, 5.0, 0.9), (5.4, 7.4, 0.9)];
        let site = Site { doors: vec![7.0], windows, ..Site::new("classroom", 8.0, 7.2) };
        for seed in 0..6 {
            let found = site.furnished(domain, seed);
            let pupils = of(&found, "pupil_chair");
            assert!(pupils.len() >= 16, "{seed}: {} chairs", pupils.len());
            let gaze = quarter(pupils[0].pose.yaw_rad);
            assert!(pupils.iter().all(|p| quarter(p.pose.yaw_rad) == gaze), "{seed}: pupils look different ways");
            let ahead = |p: &Placement| match gaze {
                0 => p.pose.x,
                1 => p.pose.y,
                2 => -p.pose.x,
                _ => -p.pose.y,
            };
            let first = pupils.iter().map(|p| ahead(p)).fold(f64::MIN, f64::max);
            for object in ["blackboard", "teacher_desk"] {
                let shown = of(&found, object);
                assert_eq!(shown.len(), 1, "{seed}: {object}");
                assert!(ahead(shown[0]) > first + 1.0, "{seed}: {object} is not before the first row");
            }
            let board = quarter(of(&found, "blackboard")[0].pose.yaw_rad);
            let teacher = of(&found, "task_chair").iter().any(|p| quarter(p.pose.yaw_rad) == (gaze + 2) % 4);
            assert_eq!(board, (gaze + 2) % 4, "{seed}: the board hangs in their backs");
            assert!(teacher, "{seed}: the teacher looks at the wall");
        }
    });
}

#[test]
fn curtains_and_blinds_are_no_more_than_windows() {
    with_domain("office", |domain| {
        let site = Site { windows: vec![(1.0, 2.5, 0.9)], ..Site::new("meeting_room", 4.4, 5.0) };
        let found = site.furnished(domain, 1);
        assert_eq!(of(&found, "blind").len(), 1);
        assert!(found.unplaced.iter().all(|u| u.item != "blind"));
    });
}

#[test]
fn what_hangs_from_a_ceiling_meets_it_at_any_height() {
    let registry = Registry::builtin();
    for (id, room_type) in [("office", "meeting_room"), ("residential", "living_room"), ("hospital", "operating_room")]
    {
        let domain = registry.get(id).expect("the domain is built in").domain();
        let mut hung = 0;
        for (seed, height) in [(0, 2.4), (1, 2.75), (2, 3.6)] {
            let mut higher = domain.clone();
            higher.room_types.iter_mut().for_each(|r| r.ceiling_height_m = height);
            let found = Site::new(room_type, 6.0, 6.4).furnished(&higher, seed);
            for p in found.placements.iter().filter(|p| p.mount == Mount::Ceiling) {
                assert!((p.top_m() - height).abs() < 1e-6, "{}: {:.2} of {height} m", p.placement_id, p.top_m());
                hung += 1;
            }
        }
        assert!(hung > 0, "{id}: nothing hangs in any {room_type}");
    }
}

#[test]
fn a_crowded_top_is_cleared_of_what_is_not_needed() {
    with_domain("residential", |domain| {
        let unit = variants(domain, "vanity_set", &Forms::plain(2500)).swap_remove(0);
        assert_eq!(unit.parts.len(), 4);
        let bare = unit.cleared(|_| true).expect("cup and bottle are optional");
        let left: Vec<&str> = bare.parts.iter().map(|p| p.object.id.as_str()).collect();
        assert_eq!(left, ["vanity", "mirror_cabinet"]);
        assert!(bare.cleared(|_| true).is_none());
        assert!(unit.cleared(|_| false).is_none());
    });
}

#[test]
fn users_look_over_their_tables_and_ahead_of_their_sofas() {
    let look = |domain: &Domain, item: &str| variants(domain, item, &Forms::plain(2500))[0].look();
    with_domain("school", |domain| {
        assert_eq!((look(domain, "pupil_place"), look(domain, "teacher_place")), (2, 2));
        assert_eq!(look(domain, "blackboard"), 0);
    });
    with_domain("office", |domain| {
        assert_eq!((look(domain, "training_place"), look(domain, "meeting_set_4")), (0, 0));
    });
}

#[test]
fn whatever_carries_things_in_a_group_has_a_top() {
    for plugin in Registry::builtin().iter() {
        let domain = plugin.domain();
        for group in &domain.groups {
            let carries = group.members.iter().any(|m| m.relation == Relation::On);
            let top = domain.object(&group.anchor).is_some_and(|o| domain.holds_things(o));
            assert!(top || !carries, "{}: `{}` of `{}` has no surface", domain.id, group.anchor, group.id);
        }
    }
}

#[test]
fn the_same_seed_furnishes_alike_and_others_differ() {
    with_domain("residential", |domain| {
        let site = Site { windows: vec![(1.0, 2.5, 0.9)], ..Site::new("bedroom", 4.0, 4.2) };
        let first = site.furnished(domain, 5);
        assert_eq!(first, site.furnished(domain, 5));
        assert!((6..10).any(|seed| site.furnished(domain, seed).placements != first.placements));
    });
}

#[test]
fn both_beds_of_a_double_room_find_their_place() {
    with_domain("hospital", |domain| {
        let windows = vec![(0.4, 1.7, 0.9), (2.5, 3.8, 0.9)];
        let site = Site { doors: vec![3.4], windows, ..Site::new("patient_room_double", 4.25, 6.4) };
        for seed in 0..12 {
            let found = site.furnished(domain, seed);
            assert_eq!(of(&found, "hospital_bed").len(), 2, "{seed}: {:?}", found.unplaced);
        }
    });
}

#[test]
fn curtains_hang_beside_beds_and_not_over_them() {
    with_domain("hospital", |domain| {
        let windows = vec![(0.4, 1.7, 0.9), (2.5, 3.8, 0.9)];
        let site = Site { doors: vec![3.4], windows, ..Site::new("patient_room_double", 4.25, 6.4) };
        for seed in 0..4 {
            let found = site.furnished(domain, seed);
            let (beds, tracks) = (of(&found, "hospital_bed"), of(&found, "curtain_track"));
            assert!(tracks.len() >= 2, "{seed}: {} curtains", tracks.len());
            for (bed, track) in beds.iter().flat_map(|bed| tracks.iter().map(move |track| (bed, track))) {
                assert!(
                    !bed.footprint().bounds().overlaps(&track.footprint().bounds()),
                    "{seed}: {} over a bed",
                    track.placement_id
                );
            }
        }
    });
}

#[test]
fn a_kitchen_turns_the_corner_with_its_sink_at_the_wall_and_floor_on_both_sides_of_its_hob() {
    with_domain("residential", |domain| {
        let site = Site { doors: vec![3.6], windows: vec![(0.6, 2.0, 1.0)], ..Site::new("kitchen", 4.2, 2.7) };
        for seed in 0..6 {
            let found = site.furnished(domain, seed);
            let (sinks, hobs) = (of(&found, "sink_unit"), of(&found, "hob"));
            let (sink, hob) = (sinks[0], hobs[0]);
            let r = sink.footprint().bounds();
            let gap = [r.x0, r.y0, site.width - r.x1, site.depth - r.y1].into_iter().fold(f64::MAX, f64::min);
            assert!(gap.abs() < 0.01, "{seed}: the sink is {gap:.2} m from the nearest wall");
            assert!(quarter(sink.pose.yaw_rad) % 2 != quarter(hob.pose.yaw_rad) % 2, "{seed}: no corner");
            let beside = |p: &&Placement| p.footprint().bounds().grown(0.02).overlaps(&hob.footprint().bounds());
            let worktop = found.placements.iter().filter(beside).filter(|p| p.object.ends_with("base_cabinet"));
            assert!(worktop.count() >= 2, "{seed}: no worktop on both sides of the hob");
        }
    });
}

/// Every room type of every domain, at its least and its usual area, holds what makes it that room.
#[test]
fn every_room_type_holds_what_it_needs() {
    let mut problems = Vec::new();
    for plugin in Registry::builtin().iter() {
        let domain = plugin.domain();
        for kind in &domain.room_types {
            let (least, usual) = (kind.area_m2.min, kind.area_m2.target);
            for (area, stretch, leaf_inside) in [(least, 1.0, false), (least, 1.5, false), (usual, 1.2, true)] {
                let side = (area / stretch).sqrt().max(kind.min_dimension_m);
                let width = area / side;
                let id = kind.id.as_str();
                let site = Site { doors: vec![0.9], leaf_inside, ..Site::new(id, side.max(1.4), width.max(1.0)) };
                let found = site.furnished(domain, 3);
                for u in found.unplaced.iter().filter(|u| u.required) {
                    problems.push(format!("{} {id} {side:.2} x {width:.2}: {} {}", domain.id, u.item, u.reason));
                }
            }
        }
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}
