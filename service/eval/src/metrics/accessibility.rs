//! ACC: free floor where objects are used (SceneEval v1.1, `ACC`).
//!
//! As there: a strip 0.2 m deep, 0.05 m off each side the object is used from and as wide as that side; the score is the
//! share of the strip that is floor free of objects, an object's score the best of its sides. SceneEval asks a language
//! model for the sides; here `data/kinds.toml` names them. A chair drawn up to a desk stands in the desk's strip, as
//! there, so 1 is not to be reached by furniture that belongs together.

use d3dgen_model::Point;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::navigability::is_drawn;
use super::round;
use crate::kinds::{Kinds, Side};
use crate::solid::{Scene, Solid};

/// Depth of the strip, m.
const DEPTH_M: f64 = 0.2;
/// Gap between object and strip, m.
const GAP_M: f64 = 0.05;
/// Points along the depth of the strip.
const ACROSS: usize = 4;
/// Distance of points along the side, m.
const STEP_M: f64 = 0.05;

/// Free floor where objects are used.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Accessibility {
    /// Mean over the objects with a side of use; absent when there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mean: Option<f64>,
    /// Objects with a side of use.
    pub objects: u32,
    /// Placement ids of those with no free floor at all on any side of use.
    pub closed: Vec<String>,
}

/// Measures a world.
pub(crate) fn measure(scene: &Scene<'_>) -> Accessibility {
    let (kinds, mut sum, mut objects, mut closed) = (Kinds::builtin(), 0.0, 0, Vec::new());
    for s in &scene.solids {
        let sides = kinds.sides(s.placement);
        let Some(best) = sides.iter().map(|side| strip(scene, s, *side)).reduce(f64::max) else { continue };
        sum += best;
        objects += 1;
        if best == 0.0 {
            closed.push(s.placement.placement_id.clone());
        }
    }
    Accessibility { mean: (objects > 0).then(|| round(sum / f64::from(objects))), objects, closed }
}

/// Returns the free share of the strip along a side.
fn strip(scene: &Scene<'_>, s: &Solid<'_>, side: Side) -> f64 {
    let [width, depth, _] = s.placement.size_m;
    let (half, length) = match side {
        Side::Front | Side::Back => (depth / 2.0, width),
        Side::Left | Side::Right => (width / 2.0, depth),
    };
    let at = |out: f64, along: f64| match side {
        Side::Front => s.at(out, along),
        Side::Back => s.at(-out, along),
        Side::Left => s.at(along, out),
        Side::Right => s.at(along, -out),
    };
    let reach = s.bounds.grown(GAP_M + DEPTH_M);
    let others: Vec<&Solid<'_>> = scene
        .solids
        .iter()
        .filter(|o| !std::ptr::eq(o.placement, s.placement) && is_drawn(o) && o.bounds.overlaps(&reach))
        .collect();
    let floor: Vec<_> = scene.floor().filter(|r| r.overlaps(&reach)).collect();
    let free = |p: Point| {
        let inside = |r: &&d3dgen_model::Rect| r.x0 <= p.x && p.x <= r.x1 && r.y0 <= p.y && p.y <= r.y1;
        floor.iter().any(inside) && !others.iter().any(|o| o.covers(p, 0.0))
    };
    let count = (length / STEP_M).ceil().max(1.0) as usize;
    let points = (0..ACROSS).flat_map(|i| (0..count).map(move |j| (i, j)));
    let hits = points.filter(|(i, j)| {
        let out = half + GAP_M + DEPTH_M * (*i as f64 + 0.5) / ACROSS as f64;
        free(at(out, length * ((*j as f64 + 0.5) / count as f64 - 0.5)))
    });
    hits.count() as f64 / (ACROSS * count) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn free_standing_furniture_is_accessible() {
        let world = sample::world();
        let found = measure(&Scene::new(&world));
        assert_eq!((found.mean, found.objects), (Some(1.0), 2), "table and wardrobe");
    }

    #[test]
    fn half_a_front_counts_half_and_a_closed_one_is_named() {
        let mut world = sample::world();
        // the wardrobe is 1 m wide at the south wall, its front at y = 0.7 looking north
        let wardrobe = sample::object(&world, "wardrobe").clone();
        let mut bin = sample::thing("bin", (wardrobe.pose.x + 0.25, 0.85), [0.5, 0.3, 0.3]);
        bin.pose.yaw_rad = wardrobe.pose.yaw_rad;
        world.placements.placements.push(bin);
        let found = measure(&Scene::new(&world));
        assert_eq!((found.mean, found.closed.len()), (Some(0.75), 0), "{found:?}");
        let bin = world.placements.placements.last_mut().unwrap();
        (bin.pose.x, bin.size_m[0]) = (wardrobe.pose.x, 1.2);
        let found = measure(&Scene::new(&world));
        assert_eq!((found.mean, found.closed), (Some(0.5), vec!["wardrobe_1".to_owned()]));
    }
}
