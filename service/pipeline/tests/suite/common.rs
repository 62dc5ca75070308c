//! Worlds to look at, and how bodies lie to each other: what tests of plans as a reviewer sees them share.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, LazyLock, Mutex, OnceLock};

use d3dgen_model::Rect;
use d3dgen_model::floorplan::PlanRoom;
use d3dgen_model::placements::Placement;
use d3dgen_model::world::World;
use d3dgen_pipeline::generate::{Settings, generate_world};
use d3dgen_pipeline::scene_graph::Request;
use d3dgen_plugins::Registry;

/// Worlds by prompt and seed.
type Made = BTreeMap<(String, u64), Arc<OnceLock<World>>>;

/// Returns the worlds of a prompt with the seeds from 0.
pub fn worlds(prompt: &str, seeds: u64) -> Vec<World> {
    worlds_of(prompt, 0..seeds)
}

/// Returns the worlds of a prompt with some seeds. Each is made once, however many tests look at it.
pub fn worlds_of(prompt: &str, seeds: Range<u64>) -> Vec<World> {
    static MADE: LazyLock<Mutex<Made>> = LazyLock::new(Mutex::default);
    let registry = Registry::builtin();
    let world = |seed| {
        let kept = MADE.lock().unwrap().entry((prompt.to_owned(), seed)).or_default().clone();
        let make = || {
            let request = Request { prompt: prompt.into(), seed, ..Request::default() };
            let made = generate_world(&request, &registry, &Settings::default(), &mut |_| (), &AtomicBool::new(false));
            made.expect(prompt).world
        };
        kept.get_or_init(make).clone()
    };
    seeds.map(world).collect()
}

/// Returns the outline of a body on the floor.
pub fn body(p: &Placement) -> Rect {
    p.footprint().bounds()
}

/// Returns the distance between two outlines, m.
pub fn gap(a: &Rect, b: &Rect) -> f64 {
    a.distance(b)
}

/// Returns the rooms of a type.
pub fn rooms<'w>(world: &'w World, room_type: &str) -> impl Iterator<Item = &'w PlanRoom> {
    world.floorplan.rooms.iter().filter(move |r| r.room_type == room_type)
}

/// Returns what is in a room.
pub fn in_room<'w>(world: &'w World, room_id: &str) -> impl Iterator<Item = &'w Placement> {
    world.placements.placements.iter().filter(move |p| p.room_id == room_id)
}

/// Returns the objects of a kind in a room.
pub fn named<'w>(world: &'w World, room: &PlanRoom, object: &str) -> Vec<&'w Placement> {
    in_room(world, &room.room_id).filter(|p| p.object == object).collect()
}

/// Returns how many objects of a kind are in rooms of a type.
pub fn count(world: &World, room_type: &str, object: &str) -> usize {
    rooms(world, room_type).map(|room| named(world, room, object).len()).sum()
}

/// Returns where a point lies in a body's own frame, m: ahead of its middle, and to its left.
pub fn seen_from(p: &Placement, x: f64, y: f64) -> (f64, f64) {
    let (sin, cos) = p.pose.yaw_rad.sin_cos();
    let (dx, dy) = (x - p.pose.x, y - p.pose.y);
    (dx * cos + dy * sin, dy * cos - dx * sin)
}

/// Counts what holds among what was looked at, and says what share of it must.
pub fn most(what: &str, share: f64, held: &[bool]) {
    let good = held.iter().filter(|h| **h).count();
    assert!(!held.is_empty(), "{what}: nothing to look at");
    assert!(good as f64 >= share * held.len() as f64, "{what}: {good} of {}", held.len());
}
