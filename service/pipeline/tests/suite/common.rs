//! Worlds to look at, and how bodies lie to each other: what tests of plans as a reviewer sees them share.

use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, LazyLock, Mutex, OnceLock};

use d3dgen_model::Rect;
use d3dgen_model::placements::Placement;
use d3dgen_model::world::World;
use d3dgen_pipeline::generate::{Settings, generate_world};
use d3dgen_pipeline::scene_graph::Request;
use d3dgen_plugins::Registry;

/// Worlds by prompt and seed.
type Made = BTreeMap<(String, u64), Arc<OnceLock<World>>>;

/// Returns the worlds of a prompt with the seeds from 0. Each is made once, however many tests look at it.
pub fn worlds(prompt: &str, seeds: u64) -> Vec<World> {
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
    (0..seeds).map(world).collect()
}

/// Returns the outline of a body on the floor.
pub fn body(p: &Placement) -> Rect {
    p.footprint().bounds()
}

/// Returns the distance between two outlines, m.
pub fn gap(a: &Rect, b: &Rect) -> f64 {
    let (dx, dy) = ((a.x0 - b.x1).max(b.x0 - a.x1).max(0.0), (a.y0 - b.y1).max(b.y0 - a.y1).max(0.0));
    dx.hypot(dy)
}

/// Counts what holds among what was looked at, and says what share of it must.
pub fn most(what: &str, share: f64, held: &[bool]) {
    let good = held.iter().filter(|h| **h).count();
    assert!(!held.is_empty(), "{what}: nothing to look at");
    assert!(good as f64 >= share * held.len() as f64, "{what}: {good} of {}", held.len());
}
