//! COL: objects that are in each other (SceneEval v1.1, `COL`).
//!
//! SceneEval tests meshes, moves a touching one 5 mm away and tests again. Here objects are their boxes and count when
//! they overlap by more than 5 mm in every direction, which finds at least what meshes would. Walls are not tested, as
//! there (out of bounds finds those). A rug or mat no thicker than 3 cm may lie under other things.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::share;
use crate::solid::Scene;

/// Overlap that is contact, m.
const CONTACT_M: f64 = 0.005;

/// Objects in each other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Collisions {
    /// Share of objects that collide with another (SceneEval's COL_ob).
    pub object_share: f64,
    /// Pairs of placement ids.
    pub pairs: Vec<[String; 2]>,
}

/// Measures a world.
pub(crate) fn measure(scene: &Scene<'_>) -> Collisions {
    let mut order: Vec<usize> = (0..scene.solids.len()).collect();
    order.sort_by(|a, b| scene.solids[*a].bounds.x0.total_cmp(&scene.solids[*b].bounds.x0).then(a.cmp(b)));
    let mut hit = vec![false; order.len()];
    let mut found = Vec::new();
    for (n, &i) in order.iter().enumerate() {
        let a = &scene.solids[i];
        let reach = order[n + 1..].iter().take_while(|j| scene.solids[**j].bounds.x0 < a.bounds.x1);
        for &j in reach {
            let b = &scene.solids[j];
            if a.is_covering() == b.is_covering() && a.penetration(b) > CONTACT_M {
                (hit[i], hit[j]) = (true, true);
                found.push((i.min(j), i.max(j)));
            }
        }
    }
    found.sort_unstable();
    let id = |i: usize| scene.solids[i].placement.placement_id.clone();
    Collisions {
        object_share: if hit.is_empty() { 0.0 } else { share(hit.iter().filter(|h| **h).count(), hit.len()) },
        pairs: found.into_iter().map(|(i, j)| [id(i), id(j)]).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn a_sound_world_has_none() {
        let world = sample::world();
        assert_eq!(measure(&Scene::new(&world)), Collisions { object_share: 0.0, pairs: Vec::new() });
    }

    #[test]
    fn an_overlap_is_found_and_contact_is_none() {
        let mut world = sample::world();
        let table = sample::object(&world, "table").clone();
        let beside = |gap: f64| {
            let mut chair = sample::thing("chair", (0.0, 0.0), [0.5, 0.5, 0.9]);
            chair.pose.x = table.pose.x + table.size_m[1] / 2.0 + 0.25 + gap;
            chair.pose.y = table.pose.y;
            chair
        };
        world.placements.placements.push(beside(-0.004));
        assert_eq!(measure(&Scene::new(&world)).pairs.len(), 0, "4 mm is contact");
        *world.placements.placements.last_mut().unwrap() = beside(-0.1);
        let found = measure(&Scene::new(&world));
        assert_eq!(found.pairs, [["table_1".to_owned(), "chair_1".to_owned()]]);
        assert!((found.object_share - 2.0 / 6.0).abs() < 1e-6);
    }

    #[test]
    fn a_rug_lies_under_a_table_but_not_in_another_rug() {
        let mut world = sample::world();
        let rug = sample::thing("rug", (1.0, 1.0), [2.0, 1.5, 0.01]);
        world.placements.placements.push(rug.clone());
        assert!(measure(&Scene::new(&world)).pairs.is_empty());
        world.placements.placements.push(d3dgen_model::placements::Placement { placement_id: "rug_2".into(), ..rug });
        assert!(measure(&Scene::new(&world)).pairs.len() == 1, "1 cm of rug in rug is more than contact");
    }
}
