//! OOB: objects off the floor plan (SceneEval v1.1, `OOB`; PhyScene's `R_out` asks the same of boxes).
//!
//! SceneEval samples an object's surface and asks for floor straight below; less than 0.99 is out of bounds. Here the
//! share of the box above floor is exact: floor is the net floor of the rooms and the openings of doors, so an object in
//! a wall is out of bounds too, and so is the part of one below the floor or above its room's ceiling.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::share;
use crate::solid::{Scene, Solid};

/// Least share that must be within.
const LEAST: f64 = 0.99;

/// Objects off the floor plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OutOfBounds {
    /// Share of objects that are out of bounds.
    pub object_share: f64,
    /// Their placement ids.
    pub objects: Vec<String>,
}

/// Measures a world.
pub(crate) fn measure(scene: &Scene<'_>) -> OutOfBounds {
    let out: Vec<String> =
        scene.solids.iter().filter(|s| within(scene, s) < LEAST).map(|s| s.placement.placement_id.clone()).collect();
    let object_share = if scene.solids.is_empty() { 0.0 } else { share(out.len(), scene.solids.len()) };
    OutOfBounds { object_share, objects: out }
}

/// Returns the share of a box that is above floor, and between floor and ceiling.
fn within(scene: &Scene<'_>, s: &Solid<'_>) -> f64 {
    let [width, depth, height] = s.placement.size_m;
    // what only touches adds nothing, so bounds that meet are not looked at
    let area: f64 = scene.floor().filter(|r| r.overlaps(&s.bounds)).map(|r| s.area_inside(r)).sum();
    let upright = s.z1.min(scene.ceiling(&s.placement.room_id)) - s.z0.max(0.0);
    area / (width * depth) * upright.max(0.0) / height
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn a_sound_world_keeps_its_objects_within() {
        let world = sample::world();
        assert_eq!(measure(&Scene::new(&world)), OutOfBounds { object_share: 0.0, objects: Vec::new() });
    }

    #[test]
    fn planted_objects_are_out() {
        let size = [1.0, 1.0, 1.0];
        // in the garden; a tenth in the wall; below the floor; through the ceiling at 2.5 m
        for (at, z) in [((-3.0, 1.0), 0.0), ((0.5, 1.0), 0.0), ((2.0, 1.0), -0.1), ((2.0, 1.0), 1.6)] {
            let mut world = sample::world();
            let mut planted = sample::thing("crate", at, size);
            planted.pose.z = z;
            world.placements.placements.push(planted);
            let found = measure(&Scene::new(&world));
            assert_eq!(found.objects, ["crate_1"], "{at:?} {z}");
            assert!((found.object_share - 1.0 / 6.0).abs() < 1e-6);
        }
    }

    #[test]
    fn an_object_in_a_doorway_is_above_floor() {
        let world = sample::world();
        let stool = sample::thing("stool", (4.0, 1.5), [0.3, 0.3, 0.4]);
        assert!((within(&Scene::new(&world), &Solid::new(&stool)) - 1.0).abs() < 1e-6);
    }
}
