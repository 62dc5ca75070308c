//! Diversity between seeds of one prompt: how many of the plans are different.
//!
//! A plan's adjacency is its set of connections by room type; its geometry is the outline of every room with its type,
//! rounded to 5 cm, moved to the origin, and the same however the plan is turned or mirrored. Two plans with equal
//! adjacency and geometry count as one. Object layout does not count.

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::world::World;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use twox_hash::XxHash3_64;

use super::share;
use crate::evaluation::WorldMeasures;

/// Coordinates nearer than this are the same, m.
const LATTICE_M: f64 = 0.05;

/// What tells a plan from others: equal hashes, equal plans.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Signature {
    /// Hash of the connections, 16 hexadecimal digits.
    pub adjacency: String,
    /// Hash of the outlines, 16 hexadecimal digits.
    pub geometry: String,
}

/// How different the worlds of one prompt are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Diversity {
    /// The prompt.
    pub prompt: String,
    /// Domain id.
    pub domain: String,
    /// How many worlds it has; prompts with one are not listed.
    pub worlds: u32,
    /// Share of different adjacencies.
    pub adjacencies: f64,
    /// Share of different geometries.
    pub geometries: f64,
    /// Share of different plans, adjacency and geometry together.
    pub plans: f64,
}

/// Returns the signature of a plan.
pub(crate) fn signature(world: &World) -> Signature {
    let plan = &world.floorplan;
    let kind = |id: &String| plan.room(id).map_or("outside", |r| r.room_type.as_str());
    let mut links: Vec<Vec<&str>> = plan
        .doors
        .iter()
        .map(|d| {
            let mut ends: Vec<&str> = d.room_ids.iter().map(kind).collect();
            ends.sort_unstable();
            ends
        })
        .collect();
    links.sort_unstable();
    let geometry = (0..8).map(|symmetry| outlines(world, symmetry)).min().unwrap_or_default();
    let hash = |text: String| format!("{:016x}", XxHash3_64::oneshot(text.as_bytes()));
    Signature { adjacency: hash(format!("{links:?}")), geometry: hash(format!("{geometry:?}")) }
}

type Outline = (Vec<(i64, i64)>, String);

/// Returns the outlines under one of the eight symmetries of the square, in an order that depends on them alone.
fn outlines(world: &World, symmetry: u8) -> Vec<Outline> {
    let at = |v: f64| (v / LATTICE_M).round() as i64;
    let turn = |(x, y): (i64, i64)| {
        let (x, y) = if symmetry & 4 == 0 { (x, y) } else { (y, x) };
        (if symmetry & 1 == 0 { x } else { -x }, if symmetry & 2 == 0 { y } else { -y })
    };
    let rooms = &world.floorplan.rooms;
    let corners = |i: usize| rooms[i].polygon.corners().iter().map(move |p| turn((at(p.x), at(p.y))));
    let all = || (0..rooms.len()).flat_map(corners);
    let (x0, y0) = (all().map(|p| p.0).min().unwrap_or(0), all().map(|p| p.1).min().unwrap_or(0));
    let mut out: Vec<Outline> = (0..rooms.len())
        .map(|i| {
            let mut points: Vec<_> = corners(i).map(|(x, y)| (x - x0, y - y0)).collect();
            points.sort_unstable(); // a rectilinear outline is known by its corners
            (points, rooms[i].room_type.clone())
        })
        .collect();
    out.sort_unstable();
    out
}

/// Returns the diversity of each prompt with two worlds or more, by domain and prompt.
pub(crate) fn together(worlds: &[WorldMeasures]) -> Vec<Diversity> {
    let mut prompts: BTreeMap<(&str, &str), Vec<&Signature>> = BTreeMap::new();
    for world in worlds {
        prompts.entry((&world.domain, &world.prompt)).or_default().push(&world.signature);
    }
    let prompts = prompts.into_iter().filter(|(_, s)| s.len() > 1);
    prompts
        .map(|((domain, prompt), s)| {
            let count = |key: &dyn Fn(&Signature) -> (String, String)| {
                let distinct: BTreeSet<_> = s.iter().map(|s| key(s)).collect();
                share(distinct.len(), s.len())
            };
            Diversity {
                prompt: prompt.to_owned(),
                domain: domain.to_owned(),
                worlds: s.len() as u32,
                adjacencies: count(&|s| (s.adjacency.clone(), String::new())),
                geometries: count(&|s| (s.geometry.clone(), String::new())),
                plans: count(&|s| (s.adjacency.clone(), s.geometry.clone())),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::measure;
    use crate::sample;

    /// Changes every point of the plan.
    fn moved(change: impl Fn(&mut d3dgen_model::Point)) -> World {
        let mut world = sample::world();
        world.floorplan.rooms.iter_mut().flat_map(|r| &mut r.polygon.0).for_each(change);
        world
    }

    #[test]
    fn turned_mirrored_and_moved_plans_are_the_same() {
        let first = signature(&sample::world());
        assert_eq!(signature(&moved(|p| p.x = -p.x)), first);
        assert_eq!(signature(&moved(|p| (p.x, p.y) = (p.y + 10.0, p.x - 3.0))), first);
        assert_eq!(signature(&moved(|p| p.x += 0.01)), first, "1 cm is nothing");
        assert_ne!(signature(&moved(|p| p.x *= 1.1)).geometry, first.geometry);
    }

    #[test]
    fn another_door_is_another_adjacency() {
        let mut world = sample::world();
        let first = signature(&world);
        world.floorplan.doors.pop();
        let second = signature(&world);
        assert!(second.adjacency != first.adjacency && second.geometry == first.geometry);
    }

    #[test]
    fn the_share_of_different_plans() {
        let worlds: Vec<_> = [1.0, 1.0, 1.1, 1.2]
            .iter()
            .map(|k| measure(&moved(|p| p.x *= k), None, "w", &Default::default()))
            .collect();
        let found = together(&worlds);
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].worlds, found[0].adjacencies, found[0].geometries, found[0].plans), (4, 0.25, 0.75, 0.75));
        assert!(together(&worlds[..1]).is_empty());
    }
}
