//! Clutter: tidy, ordinary and lived-in rooms have the same furniture and more and more small things on it, and all of
//! them are sound.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::AtomicBool;

use d3dgen_model::domain::Mount;
use d3dgen_model::placements::Placement;
use d3dgen_model::style::{Clutter, Style};
use d3dgen_model::world::World;
use d3dgen_pipeline::generate::{Settings, generate_world};
use d3dgen_pipeline::scene_graph::Request;
use d3dgen_plugins::Registry;

/// Least objects on a square meter of a whole cluttered building; a warehouse is mostly aisles.
const CASES: [(&str, f64); 9] = [
    ("two-bedroom flat in Germany", 2.0),
    ("office for 12 people with two meeting rooms", 1.7),
    ("hospital ward with 8 rooms in Germany", 2.0),
    ("outpatient clinic with 8 rooms", 2.0),
    ("primary school with four classrooms", 2.0),
    ("hotel with 9 rooms in total", 2.0),
    ("clothing shop", 1.75),
    ("restaurant", 2.0),
    ("warehouse with a loading dock, an office and charging for two robots", 0.5),
];

fn world(prompt: &str, seed: u64, clutter: Option<Clutter>) -> World {
    let style = Style { clutter, ..Style::default() };
    let request = Request { prompt: prompt.into(), seed, style, ..Request::default() };
    let registry = Registry::builtin();
    let made = generate_world(&request, &registry, &Settings::default(), &mut |_| (), &AtomicBool::new(false)).unwrap();
    let broken: Vec<_> = made.report.rules.iter().flat_map(|r| &r.violations).collect();
    assert!(made.report.is_writable(), "{prompt}, seed {seed}, {clutter:?}: {broken:?}");
    made.world
}

fn per_m2(world: &World) -> f64 {
    let area: f64 = world.floorplan.rooms.iter().map(|r| r.net_area_m2).sum();
    world.placements.placements.len() as f64 / area
}

/// Returns what takes floor, wall or ceiling, without names.
fn furniture(world: &World) -> Vec<(String, String)> {
    let fixed = world.placements.placements.iter().filter(|p| p.mount != Mount::Surface);
    fixed.map(|p| (p.object.clone(), format!("{:?}", p.pose))).collect()
}

#[test]
fn high_clutter_fills_tops_and_moves_nothing() {
    for (prompt, least) in CASES {
        for seed in [1, 2] {
            let [tidy, usual, lived_in] =
                [Clutter::Low, Clutter::Normal, Clutter::High].map(|grade| world(prompt, seed, Some(grade)));
            let densities = [&tidy, &usual, &lived_in].map(per_m2);
            assert!(
                densities[0] < densities[1] && densities[1] < densities[2] && densities[2] >= least,
                "{prompt}, seed {seed}: {densities:.2?}"
            );
            assert_eq!(furniture(&usual), furniture(&lived_in), "{prompt}, seed {seed}");
            let same = |w: &World| serde_json::to_string(&w.placements).unwrap();
            assert_eq!(same(&world(prompt, seed, None)), same(&usual), "{prompt}, seed {seed}: normal is the default");
        }
    }
}

#[test]
fn small_things_stand_in_order() {
    let world = world("lived-in house with 3 bedrooms, kitchen, living room, study and two bathrooms", 4, None);
    assert_eq!(world.scene_graph.style.clutter, Some(Clutter::High), "the prompt says lived-in");
    let all: BTreeMap<&str, &Placement> =
        world.placements.placements.iter().map(|p| (p.placement_id.as_str(), p)).collect();
    let small: Vec<&&Placement> = all.values().filter(|p| p.rule.starts_with("clutter ")).collect();
    let patterns: BTreeSet<&str> = small.iter().filter_map(|p| p.rule.rsplit(' ').next()).collect();
    for pattern in ["row", "stack", "by_seat", "middle"] {
        assert!(patterns.contains(pattern), "{patterns:?}");
    }
    for thing in &small {
        let base = all[thing.support.as_deref().expect("stands on something")];
        assert_eq!(base.room_id, thing.room_id);
        assert!((thing.pose.z - base.top_m()).abs() < 1e-6, "{}", thing.placement_id);
        // headings are those of the furniture: nothing lies askew
        let turn = (thing.pose.yaw_rad - base.pose.yaw_rad).rem_euclid(std::f64::consts::FRAC_PI_2);
        let askew = (1e-6..=std::f64::consts::FRAC_PI_2 - 1e-6).contains(&turn);
        assert!(!askew, "{}", thing.placement_id);
    }
    // things of one row stand in one line, shown by the books
    let mut rows: BTreeMap<&str, Vec<&Placement>> = BTreeMap::new();
    for thing in small.iter().filter(|p| p.object == "standing_book" && p.rule.ends_with("row")) {
        rows.entry(thing.support.as_deref().unwrap_or_default()).or_default().push(thing);
    }
    let (_, books) = rows.iter().max_by_key(|(_, list)| list.len()).expect("there are books");
    assert!(books.len() >= 5, "{} books", books.len());
    let along = |p: &Placement| {
        let depth = p.pose.x * p.pose.yaw_rad.cos() + p.pose.y * p.pose.yaw_rad.sin();
        (depth * 1000.0).round() as i64
    };
    assert!(books.iter().all(|b| along(b) == along(books[0])), "the backs of books are in line");
}

#[test]
fn a_cluttered_building_is_the_same_twice() {
    let [a, b] = [0, 1].map(|_| world("messy 10-room office", 5, None));
    assert_eq!(serde_json::to_string(&a).unwrap(), serde_json::to_string(&b).unwrap());
}
