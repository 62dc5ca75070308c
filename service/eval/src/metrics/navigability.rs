//! NAV: free floor in one piece (SceneEval v1.1, `NAV`; PhyScene's `R_walkable` is of the same kind).
//!
//! As there: boxes whose middle is no higher than 2 m are drawn on a top view, the floor is shrunk by a robot 0.2 m wide,
//! and the largest part connected by edges and corners is divided by all parts. SceneEval leaves walls and doors out
//! ("TODO: Support for doors"), so that a house is overstated; here both are drawn, for the house (rooms joined by doors as
//! wide as they are clear) and for each room by itself. Cells are 4 cm instead of a 256th of the building. Rugs and mats
//! no thicker than 3 cm are floor.

use std::collections::BTreeSet;

use d3dgen_model::Rect;
use d3dgen_model::floorplan::Floorplan;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{round, share};
use crate::grid::Grid;
use crate::kinds::Kinds;
use crate::solid::{Scene, Solid};

/// Width of the robot, m.
const ROBOT_M: f64 = 0.2;
/// Height up to which the middle of an object makes it an obstacle, m.
const OVERHEAD_M: f64 = 2.0;

/// Free floor in one piece.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Navigability {
    /// The house with its walls and doors: largest part by all free floor.
    pub house: f64,
    /// Mean over the rooms, each by itself.
    pub rooms_mean: f64,
    /// Least of a room.
    pub rooms_least: f64,
    /// The room with the least; empty when all have 1.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub least_room: String,
    /// Share of rooms reached from the entrance without walking through a bedroom or bathroom; en suites and closets may
    /// lie behind one. ProcTHOR's houses fail this for 1 room in 4, measured with their published generator.
    pub reached_in_public: f64,
    /// The other rooms.
    pub behind_private: Vec<String>,
}

/// Returns true when an object is drawn on the top view.
pub(crate) fn is_drawn(s: &Solid<'_>) -> bool {
    !s.is_covering() && (s.z0 + s.z1) / 2.0 <= OVERHEAD_M
}

/// Returns the rectangle around rectangles.
pub(crate) fn around<'a>(rects: impl Iterator<Item = &'a Rect>) -> Rect {
    rects.copied().reduce(|a, b| a.union(&b)).unwrap_or(Rect { x0: 0.0, y0: 0.0, x1: 0.0, y1: 0.0 })
}

/// Returns the floor of the house with doors, less the objects that `is_obstacle` picks.
pub(crate) fn free_floor(scene: &Scene<'_>, is_obstacle: impl Fn(&Solid<'_>) -> bool) -> Grid {
    let mut grid = Grid::over(&around(scene.floor()));
    scene.floor().for_each(|r| grid.paint(r, true));
    scene.solids.iter().filter(|s| is_obstacle(s)).for_each(|s| grid.block(s));
    grid
}

/// Measures a world.
pub(crate) fn measure(scene: &Scene<'_>) -> Navigability {
    // a robot of this width climbs no stairs: storeys count one by one
    let plan = &scene.world.floorplan;
    let parts = plan.level_numbers().into_iter().map(|level| storey(scene, level).largest_and_all());
    let (largest, all) = parts.fold((0, 0), |sum, part| (sum.0 + part.0, sum.1 + part.1));
    let house = if all == 0 { 0.0 } else { largest as f64 / all as f64 };
    let shares: Vec<f64> = scene.rooms.iter().map(|rects| room(scene, rects)).collect();
    let rooms = &scene.world.floorplan.rooms;
    let least = shares.iter().copied().enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
    let behind_private = behind_private(&scene.world.floorplan, Kinds::builtin());
    Navigability {
        house: round(house),
        rooms_mean: round(shares.iter().sum::<f64>() / shares.len().max(1) as f64),
        rooms_least: round(least.map_or(0.0, |l| l.1)),
        least_room: least.filter(|l| l.1 < 1.0).map_or_else(String::new, |(i, _)| rooms[i].room_id.clone()),
        reached_in_public: share(rooms.len() - behind_private.len(), rooms.len()),
        behind_private,
    }
}

/// Returns where the robot can be on a storey.
fn storey(scene: &Scene<'_>, level: i32) -> Grid {
    let plan = &scene.world.floorplan;
    let here = |id: &String| plan.room(id).is_some_and(|r| r.level == level);
    let rooms = plan.rooms.iter().zip(&scene.rooms).filter(|(r, _)| r.level == level).flat_map(|(_, rects)| rects);
    let doors = plan.doors.iter().zip(&scene.thresholds).filter(|(d, _)| d.room_ids.iter().any(here));
    let floor: Vec<Rect> = rooms.chain(doors.map(|(_, rect)| rect)).copied().collect();
    let bounds = around(floor.iter());
    let mut grid = Grid::over(&bounds);
    floor.iter().for_each(|r| grid.paint(r, true));
    scene.solids.iter().filter(|s| is_drawn(s) && s.bounds.overlaps(&bounds)).for_each(|s| grid.block(s));
    grid.eroded_by_square(ROBOT_M)
}

fn room(scene: &Scene<'_>, rects: &[Rect]) -> f64 {
    let bounds = around(rects.iter());
    let mut grid = Grid::over(&bounds);
    rects.iter().for_each(|r| grid.paint(r, true));
    scene.solids.iter().filter(|s| is_drawn(s) && s.bounds.overlaps(&bounds)).for_each(|s| grid.block(s));
    grid.eroded_by_square(ROBOT_M).largest_share()
}

/// Returns the rooms that one cannot reach from an entrance but through a private room.
fn behind_private(plan: &Floorplan, kinds: &Kinds) -> Vec<String> {
    let private = |id: &str| plan.room(id).is_some_and(|r| kinds.is_private(&r.room_type));
    let mut reached: BTreeSet<&str> =
        plan.ways_out().into_iter().flat_map(|d| &d.room_ids).map(String::as_str).collect();
    let mut ahead: Vec<&str> = reached.iter().copied().collect();
    while let Some(room) = ahead.pop() {
        if private(room) {
            continue;
        }
        let doors = plan.doors_of(room).flat_map(|d| &d.room_ids);
        let stairs = plan.link_of(room).into_iter().flat_map(|l| &l.room_ids);
        for next in doors.chain(stairs) {
            if reached.insert(next) {
                ahead.push(next);
            }
        }
    }
    let hidden = plan.rooms.iter().filter(|r| !reached.contains(r.room_id.as_str()));
    hidden.filter(|r| !kinds.may_lie_behind(&r.room_type)).map(|r| r.room_id.clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn a_sound_world_is_one_piece() {
        let world = sample::world();
        let found = measure(&Scene::new(&world));
        assert_eq!((found.house, found.rooms_least, found.least_room.as_str()), (1.0, 1.0, ""));
        assert_eq!((found.reached_in_public, found.behind_private.len()), (1.0, 0));
    }

    #[test]
    fn a_blocked_door_parts_the_house_but_not_the_rooms() {
        let mut world = sample::world();
        // the door between the rooms runs from y = 1 to 2 at x = 4
        world.placements.placements.push(sample::thing("crate", (4.3, 1.5), [1.0, 0.3, 1.0]));
        let found = measure(&Scene::new(&world));
        assert!(found.rooms_least == 1.0 && found.house < 0.7, "{found:?}");
    }

    #[test]
    fn a_row_across_a_room_parts_it() {
        let mut world = sample::world();
        // the second room is 3.8 m by 2.8 m from x = 4.1; the row is 0.4 m deep with its middle at x = 5.3
        let mut row = sample::thing("shelf", (5.3, 1.5), [2.8, 0.4, 1.8]);
        row.room_id = "b_1".into();
        world.placements.placements.push(row);
        let found = measure(&Scene::new(&world));
        assert_eq!(found.least_room, "b_1");
        // left of it 1.0 m, right of it 2.4 m, each less the robot: 0.8 against 2.2, with a cell or so for the grid
        assert!((found.rooms_least - 2.2 / 3.0).abs() < 0.03, "{found:?}");
    }

    #[test]
    fn rugs_and_what_hangs_high_are_no_obstacles() {
        let mut world = sample::world();
        let mut beam = sample::thing("beam", (5.3, 1.5), [2.8, 0.4, 0.2]);
        beam.pose.z = 2.1;
        world.placements.placements.push(beam);
        world.placements.placements.push(sample::thing("rug", (6.0, 1.5), [2.8, 2.0, 0.02]));
        assert_eq!(measure(&Scene::new(&world)).house, 1.0);
    }

    #[test]
    fn a_room_behind_a_bedroom_is_named() {
        let mut world = sample::world();
        world.floorplan.rooms[0].room_type = "bedroom".into();
        let found = measure(&Scene::new(&world));
        assert_eq!((found.behind_private, found.reached_in_public), (vec!["b_1".to_owned()], 0.5));
        world.floorplan.rooms[1].room_type = "bathroom".into();
        assert!(measure(&Scene::new(&world)).behind_private.is_empty(), "an en suite may");
    }
}
