//! Counts, areas, spacing and materials: the measures of the paper (arXiv 2608.11876) on its generated worlds.
//!
//! The paper counts objects, doors and walls and takes floor areas by the shoelace formula. It names object spacing and
//! material diversity without a formula; here spacing is the mean distance from an object on the floor to the nearest
//! other one in its room, center to center, and diversity is the Shannon entropy (base 2) of the surface materials of
//! floors, walls and ceilings over the rooms.

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::Polygon;
use d3dgen_model::domain::Mount;
use d3dgen_model::floorplan::{DoorKind, Floorplan};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::round;
use crate::solid::Scene;

/// Difference between areas that are the same but for rounding, m^2.
const SAME_M2: f64 = 0.01;

/// Counts, areas, spacing and materials of a world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Layout {
    /// Rooms, circulation not counted.
    pub rooms: u32,
    /// Corridors and halls that were added.
    pub circulation_rooms: u32,
    /// Rooms and circulation that are no rectangles.
    pub rooms_not_rectangular: u32,
    /// Storeys whose outline is no rectangle.
    pub outlines_not_rectangular: u32,
    /// Doors with a leaf.
    pub doors: u32,
    /// Open passages.
    pub passages: u32,
    /// Windows.
    pub windows: u32,
    /// Straight pieces of wall.
    pub walls: u32,
    /// Net floor between the wall faces, by the shoelace formula, m^2.
    pub floor_area_m2: f64,
    /// Floor up to the wall center lines, by the shoelace formula, m^2.
    pub gross_area_m2: f64,
    /// Share of the net floor that is circulation.
    pub circulation_share: f64,
    /// Objects.
    pub objects: u32,
    /// Kinds of object.
    pub object_types: u32,
    /// Objects by room, circulation counted as rooms too.
    pub objects_per_room: f64,
    /// Objects by net floor area, 1/m^2.
    pub objects_per_m2: f64,
    /// Mean distance from an object on the floor to the nearest other in its room, m; absent when no room has two.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub object_spacing_m: Option<f64>,
    /// Different surface materials.
    pub materials: u32,
    /// Entropy of the surface materials over the rooms, bit.
    pub material_diversity_bit: f64,
    /// Net floor area of each room in order of the plan, m^2.
    pub room_areas_m2: Vec<f64>,
    /// Longer by shorter side of the rectangle around each room, in order of the plan.
    pub room_proportions: Vec<f64>,
    /// Doors and passages of each room, in order of the plan.
    pub room_doors: Vec<u32>,
    /// Objects of each room, in order of the plan.
    pub room_objects: Vec<u32>,
}

/// Measures a world.
pub(crate) fn measure(scene: &Scene<'_>) -> Layout {
    let (plan, placements) = (&scene.world.floorplan, &scene.world.placements.placements);
    let areas: Vec<f64> = plan.rooms.iter().map(|r| r.net_polygon.signed_area()).collect();
    let floor: f64 = areas.iter().sum();
    let circulation = plan.rooms.iter().filter(|r| r.circulation).count();
    let of_circulation: f64 = plan.rooms.iter().zip(&areas).filter(|(r, _)| r.circulation).map(|(_, a)| a).sum();
    let passages = plan.doors.iter().filter(|d| d.kind == DoorKind::Open).count();
    let types: BTreeSet<&str> = placements.iter().map(|p| p.object.as_str()).collect();
    let mut materials: BTreeMap<&str, usize> = BTreeMap::new();
    for room in &plan.rooms {
        for material in [&room.materials.floor, &room.materials.wall, &room.materials.ceiling] {
            *materials.entry(material).or_default() += 1;
        }
    }
    let proportion = |b: d3dgen_model::Rect| b.width().max(b.height()) / b.width().min(b.height()).max(1e-9);
    let per = |whole: f64| if whole > 0.0 { placements.len() as f64 / whole } else { 0.0 };
    Layout {
        rooms: (plan.rooms.len() - circulation) as u32,
        circulation_rooms: circulation as u32,
        rooms_not_rectangular: plan.rooms.iter().filter(|r| r.polygon.corners().len() > 4).count() as u32,
        outlines_not_rectangular: plan.level_numbers().into_iter().filter(|l| !fills_its_bounds(plan, *l)).count()
            as u32,
        doors: (plan.doors.len() - passages) as u32,
        passages: passages as u32,
        windows: plan.windows.len() as u32,
        walls: plan.walls.len() as u32,
        floor_area_m2: round(floor),
        gross_area_m2: round(plan.rooms.iter().map(|r| r.polygon.signed_area()).sum()),
        circulation_share: round(if floor > 0.0 { of_circulation / floor } else { 0.0 }),
        objects: placements.len() as u32,
        object_types: types.len() as u32,
        objects_per_room: round(per(plan.rooms.len() as f64)),
        objects_per_m2: round(per(floor)),
        object_spacing_m: spacing(scene).map(round),
        materials: materials.len() as u32,
        material_diversity_bit: round(entropy(materials.into_values())),
        room_areas_m2: areas.into_iter().map(round).collect(),
        room_proportions: plan.rooms.iter().map(|r| round(proportion(r.net_polygon.bounds()))).collect(),
        room_doors: plan.rooms.iter().map(|r| plan.doors_of(&r.room_id).count() as u32).collect(),
        room_objects: plan
            .rooms
            .iter()
            .map(|r| placements.iter().filter(|p| p.room_id == r.room_id).count() as u32)
            .collect(),
    }
}

/// Returns true when the rooms of a storey fill the rectangle around them.
fn fills_its_bounds(plan: &Floorplan, level: i32) -> bool {
    let polygons = || plan.rooms.iter().filter(|r| r.level == level).map(|r| &r.polygon);
    let bounds = polygons().map(Polygon::bounds).reduce(|a, b| a.union(&b));
    let filled: f64 = polygons().map(|p| p.signed_area()).sum();
    bounds.is_none_or(|b| (b.area() - filled).abs() < SAME_M2)
}

fn spacing(scene: &Scene<'_>) -> Option<f64> {
    let mut rooms: BTreeMap<&str, Vec<_>> = BTreeMap::new();
    for s in scene.solids.iter().filter(|s| s.placement.mount == Mount::Floor && !s.is_covering()) {
        rooms.entry(&s.placement.room_id).or_default().push(s.center);
    }
    let mut nearest = Vec::new();
    for centers in rooms.values().filter(|c| c.len() > 1) {
        for (i, a) in centers.iter().enumerate() {
            let others = centers.iter().enumerate().filter(|(j, _)| *j != i);
            nearest.push(others.map(|(_, b)| a.distance(*b)).fold(f64::INFINITY, f64::min));
        }
    }
    (!nearest.is_empty()).then(|| nearest.iter().sum::<f64>() / nearest.len() as f64)
}

/// Returns Shannon's entropy of counts, bit.
fn entropy(counts: impl Iterator<Item = usize>) -> f64 {
    let counts: Vec<f64> = counts.map(|c| c as f64).collect();
    let all: f64 = counts.iter().sum();
    counts.iter().map(|c| c / all).map(|p| -p * p.log2()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn two_rooms_by_reckoning() {
        let world = sample::world();
        let found = measure(&Scene::new(&world));
        // two rooms of 4 m by 3 m between center lines, walls of 0.2 m: 3.8 m by 2.8 m each
        assert_eq!((found.rooms, found.doors, found.passages, found.windows), (2, 2, 0, 1));
        assert!((found.gross_area_m2 - 24.0).abs() < 1e-9 && (found.floor_area_m2 - 2.0 * 3.8 * 2.8).abs() < 1e-9);
        assert_eq!((found.objects, found.objects_per_room), (5, 2.5));
        assert!((found.room_proportions[0] - 3.8 / 2.8).abs() < 1e-6);
        // table and wardrobe stand in the first room: one distance, both ways
        assert!((found.object_spacing_m.unwrap() - 1.8f64.hypot(0.6)).abs() < 1e-6, "{found:?}");
        // six surfaces: wood twice, paint four times
        assert_eq!(found.materials, 2);
        let (third, two_thirds) = (1.0f64 / 3.0, 2.0f64 / 3.0);
        let bits = -third * third.log2() - two_thirds * two_thirds.log2();
        assert!((found.material_diversity_bit - bits).abs() < 1e-6);
    }

    #[test]
    fn lone_objects_have_no_spacing() {
        let mut world = sample::world();
        world.placements.placements.retain(|p| p.object == "table");
        assert_eq!(measure(&Scene::new(&world)).object_spacing_m, None);
    }
}
