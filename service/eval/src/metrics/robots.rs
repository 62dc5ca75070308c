//! Robot fit: can each robot of the scenario start, and does it reach its goals, its dock and the rooms?
//!
//! No peer measures this for a chosen robot with walls and doors drawn (SceneEval's
//! robot is 0.2 m wide and knows no doors). A robot is a disc of its turning radius; what is higher than 3 cm and begins
//! below its height stops it; doors are as wide as they are clear. A point is reached when the disc's center can come
//! within 0.25 m of it. Only the storey it starts on is judged.

use d3dgen_model::Point;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::navigability::free_floor;
use super::{round, share};
use crate::grid::Grid;
use crate::solid::{COVERING_M, Scene};

/// How near the center must come to a point, m.
const NEAR_M: f64 = 0.25;

/// How a robot fits into its world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotFit {
    /// Id in the scenario.
    pub robot_id: String,
    /// Radius of the disc, m.
    pub radius_m: f64,
    /// Share of goals and dock that it reaches from where it starts; 0 when it cannot start.
    pub goals_share: f64,
    /// POI ids of the others.
    pub missed: Vec<String>,
    /// Share of rooms that it can enter.
    pub rooms_share: f64,
    /// Share of the free floor for its radius that it reaches.
    pub floor_share: f64,
    /// True when it can start and reaches all goals and its dock.
    pub fits: bool,
}

/// Measures a world.
pub(crate) fn measure(scene: &Scene<'_>) -> Vec<RobotFit> {
    let scenario = &scene.world.scenario;
    let one = |task: &d3dgen_model::scenario::RobotTask| {
        let robot = &task.robot;
        let clear = free_floor(scene, |s| s.z1 > COVERING_M && s.z0 < robot.height_m).eroded_by_disc(robot.radius_m);
        let start = Point::new(task.start.x, task.start.y);
        let level_of = |room: &str| scene.world.floorplan.room(room).map_or(0, |r| r.level);
        let elsewhere = |id: &str| scenario.pois.iter().any(|p| p.poi_id == id && level_of(&p.room_id) != task.level);
        let goals: Vec<&String> = task.goals.iter().chain(&task.dock).filter(|id| !elsewhere(id)).collect();
        let storey: Vec<_> =
            scene.world.floorplan.rooms.iter().zip(&scene.rooms).filter(|(r, _)| r.level == task.level).collect();
        let Some((part, _)) = clear.part_at(start).filter(|(_, distance)| *distance <= NEAR_M) else {
            return RobotFit {
                robot_id: task.robot_id.clone(),
                radius_m: robot.radius_m,
                goals_share: 0.0,
                missed: goals.into_iter().cloned().collect(),
                rooms_share: 0.0,
                floor_share: 0.0,
                fits: false,
            };
        };
        let reached = |id: &String| {
            let poi = scenario.pois.iter().find(|p| &p.poi_id == id);
            let distance = poi.and_then(|p| part.distance_to(Point::new(p.pose.x, p.pose.y)));
            distance.is_some_and(|d| d <= NEAR_M)
        };
        let missed: Vec<String> = goals.iter().filter(|id| !reached(id)).map(|id| (*id).clone()).collect();
        let cells = |grid: &Grid| storey.iter().map(|(_, rects)| grid.count_in(rects)).sum::<usize>();
        let entered = storey.iter().filter(|(_, rects)| part.count_in(rects) > 0).count();
        RobotFit {
            robot_id: task.robot_id.clone(),
            radius_m: robot.radius_m,
            goals_share: share(goals.len() - missed.len(), goals.len()),
            rooms_share: share(entered, storey.len()),
            floor_share: round(cells(&part) as f64 / cells(&clear).max(1) as f64),
            fits: missed.is_empty(),
            missed,
        }
    };
    scenario.robots.iter().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn a_robot_fits_where_doors_are_wide_enough() {
        let mut world = sample::world();
        let found = measure(&Scene::new(&world));
        assert_eq!((found[0].fits, found[0].goals_share, found[0].rooms_share), (true, 1.0, 1.0));
        assert_eq!(found[0].floor_share, 1.0);
        world.scenario.robots[0].robot.radius_m = 0.5; // the door is 0.9 m clear
        let found = measure(&Scene::new(&world));
        assert_eq!((found[0].fits, found[0].goals_share, found[0].rooms_share), (false, 0.5, 0.5), "{found:?}");
        assert_eq!(found[0].missed, ["point_b"]);
    }

    #[test]
    fn low_robots_pass_under_what_hangs() {
        let mut world = sample::world();
        let mut bar = sample::thing("bar", (4.0, 1.5), [1.0, 0.2, 0.1]);
        bar.pose.z = 0.8;
        world.placements.placements.push(bar);
        assert!(!measure(&Scene::new(&world))[0].fits, "the robot is 1 m high");
        world.scenario.robots[0].robot.height_m = 0.5;
        assert!(measure(&Scene::new(&world))[0].fits);
    }

    #[test]
    fn a_robot_that_stands_in_furniture_cannot_start() {
        let mut world = sample::world();
        world.placements.placements.push(sample::thing("block", (3.2, 2.4), [1.4, 1.4, 1.0]));
        let found = measure(&Scene::new(&world));
        assert_eq!((found[0].fits, found[0].floor_share), (false, 0.0));
    }
}
