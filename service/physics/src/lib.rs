//! What a physics engine makes of a world: things that do not stay where they were put, and shapes that begin inside each other.
//!
//! The bodies are those of the exporters for simulators ([`SimScene`]): building, doors and what is fixed stand still; what can be
//! moved falls, slides and tips as its mass, friction and collision shapes have it. The thresholds are those that MolmoSpaces
//! publishes for its scenes (arXiv 2602.11337): one second to settle and three that are watched, 5 cm, and 1 cm of overlap at the
//! start. Drawers and doors of furniture are closed and do not move here; the exporters' own worlds have their joints.
//!
//! The engine is Rapier, which makes the same of the same world on every machine (its feature `enhanced-determinism`).

mod bodies;

use std::collections::BTreeMap;

use d3dgen_export::scene::{Mobility, SimScene};
use rapier3d::prelude::{PhysicsWorld, Vector};

/// Earth's gravity, m/s2.
const GRAVITY_M_S2: f64 = 9.81;
/// Step of the engine, s.
const STEP_S: f64 = 1.0 / 120.0;
/// Time that bodies have to settle, s.
const SETTLE_S: f64 = 1.0;
/// Time that they are watched then, s.
const WATCHED_S: f64 = 3.0;
/// Way of a body that stays, m.
const STAYS_M: f64 = 0.05;
/// Overlap at the start that is contact, m.
const CONTACT_M: f64 = 0.01;

/// Owner of walls, floors and doors in an overlap.
pub const BUILDING: &str = "building";

/// What became of a world's bodies.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Settled {
    /// Things that can be moved.
    pub bodies: usize,
    /// Those that do not stay, by id.
    pub moved: Vec<Moved>,
    /// Pairs that begin in each other, deepest first.
    pub overlaps: Vec<Overlap>,
}

/// A thing that does not stay.
#[derive(Debug, Clone, PartialEq)]
pub struct Moved {
    /// Id of the thing.
    pub id: String,
    /// Distance between where it was put and where it ends, m.
    pub way_m: f64,
}

/// Two things whose shapes begin in each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Overlap {
    /// Ids of the things; [`BUILDING`] for walls, floors and doors.
    pub ids: [String; 2],
    /// Depth, m.
    pub depth_m: f64,
}

impl Settled {
    /// Returns the share of movable things that stay, 0 to 1; 1 where nothing can be moved.
    pub fn share_at_rest(&self) -> f64 {
        if self.bodies == 0 { 1.0 } else { 1.0 - self.moved.len() as f64 / self.bodies as f64 }
    }

    /// Returns the deepest overlap at the start, m; 0 where there is none.
    pub fn deepest_m(&self) -> f64 {
        self.overlaps.first().map_or(0.0, |o| o.depth_m)
    }
}

/// Steps a scene for four seconds and tells what became of its bodies.
///
/// ```
/// use d3dgen_export::{Subject, models::NothingKept};
/// use d3dgen_pipeline::{scene_graph::Request, task::{self, Terms}};
/// use d3dgen_plugins::Registry;
/// use std::sync::atomic::AtomicBool;
///
/// let registry = Registry::builtin();
/// let request = Request { prompt: "studio flat".into(), seed: 1, ..Request::default() };
/// let made = task::make(&request, &registry, Terms::default(), &AtomicBool::new(false))?.expect("a world");
/// let domain = registry.get(&made.world.scene_graph.domain).expect("its domain").domain();
/// let settled = d3dgen_physics::settle(Subject::new(&made.world, domain, &NothingKept).scene().expect("a scene"));
/// assert!(settled.bodies > 0 && settled.share_at_rest() > 0.9);
/// # Ok::<(), d3dgen_pipeline::Error>(())
/// ```
pub fn settle(scene: &SimScene) -> Settled {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::new(0.0, 0.0, -GRAVITY_M_S2);
    world.integration_parameters.dt = STEP_S;
    bodies::building(&mut world, scene);
    let things =
        (0..scene.objects.len()).filter_map(|i| Some((bodies::thing(&mut world, scene, i)?, &scene.objects[i])));
    let free: Vec<_> = things.filter(|(_, object)| object.mobility != Mobility::Fixed).collect();
    world.step();
    let overlaps = overlaps(&world, scene);
    for _ in 1..((SETTLE_S + WATCHED_S) / STEP_S) as usize {
        world.step();
    }
    let moved = free.iter().filter_map(|(body, object)| {
        let at = world.bodies.get(*body)?.translation();
        let way_m = at.distance(Vector::from_array(object.at_m));
        // where the engine lost a body, its way is no number
        (way_m > STAYS_M || way_m.is_nan()).then(|| Moved { id: object.id.clone(), way_m })
    });
    Settled { bodies: free.len(), moved: moved.collect(), overlaps }
}

/// Returns the pairs that are deeper in each other than a contact.
fn overlaps(world: &PhysicsWorld, scene: &SimScene) -> Vec<Overlap> {
    let owner = |collider| {
        let body = world.colliders.get(collider).and_then(|c| world.bodies.get(c.parent()?));
        let thing = body.and_then(|body| bodies::thing_of(body, scene));
        thing.map_or_else(|| BUILDING.to_owned(), |thing| thing.id.clone())
    };
    let mut deepest: BTreeMap<[String; 2], f64> = BTreeMap::new();
    for pair in world.contact_pairs() {
        let depth = pair.find_deepest_contact().map_or(0.0, |(_, contact)| -contact.dist);
        if depth <= CONTACT_M {
            continue;
        }
        let mut ids = [owner(pair.collider1), owner(pair.collider2)];
        ids.sort();
        let found = deepest.entry(ids).or_default();
        *found = found.max(depth);
    }
    let mut all: Vec<Overlap> = deepest.into_iter().map(|(ids, depth_m)| Overlap { ids, depth_m }).collect();
    all.sort_by(|a, b| b.depth_m.total_cmp(&a.depth_m).then_with(|| a.ids.cmp(&b.ids)));
    all
}

#[cfg(test)]
mod tests;
