//! Robot fit: can each robot of the scenario start, does it reach its goals, its dock and the rooms, and is there room for
//! it on the routes that the scenario states?
//!
//! No peer measures this for a chosen robot with walls and doors drawn (SceneEval's
//! robot is 0.2 m wide and knows no doors). A robot is a disc of its turning radius, a long one ([`RobotBody::long_m`]) a
//! row of discs as wide as it is that drives along itself and turns about its middle; what is higher than 3 cm and begins
//! below its height stops it, as do doors that are lower; doors are as wide as they are clear. A point is reached when the
//! disc's center, or an end of the row, can come within 0.25 m of it. Only the storey it starts on is judged. Routes are
//! looked at every 5 cm: objects are farther away than the radius, and there is floor all around.

#[cfg(doc)]
use d3dgen_model::robot_body::RobotBody;
use d3dgen_model::{Point, Rect};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::navigability::free_floor;
use super::{round, share};
use crate::grid::Grid;
use crate::solid::{COVERING_M, Scene, Solid};

/// How near the center must come to a point, m.
const NEAR_M: f64 = 0.25;
/// Overlap of a robot on its route that is none, m, and gap between pieces of floor.
const SLACK_M: f64 = 0.005;
const EDGE_M: f64 = 0.002;
/// Distance between the places of a route that are looked at, m, and points on the rim of the disc there.
const STEP_M: f64 = 0.05;
const RIM: u32 = 24;

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
    /// Share of the legs of its round on which it touches nothing; 1 when no routes are stated.
    pub legs_share: f64,
    /// POI ids that the others lead to.
    pub touching: Vec<String>,
    /// True when it can start and reaches all goals and its dock.
    pub fits: bool,
}

/// Measures a world.
pub(crate) fn measure(scene: &Scene<'_>) -> Vec<RobotFit> {
    let scenario = &scene.world.scenario;
    let one = |task: &d3dgen_model::scenario::RobotTask| {
        let robot = &task.robot;
        let start = Point::new(task.start.x, task.start.y);
        let stops = |s: &Solid<'_>| s.z1 > COVERING_M && s.z0 < robot.height_m;
        let mut free = free_floor(scene, stops);
        let doors = scene.world.floorplan.doors.iter().zip(&scene.thresholds);
        doors.filter(|(d, _)| d.height_m < robot.height_m - 1e-6).for_each(|(_, floor)| free.paint(floor, false));
        let touching: Vec<String> = task
            .routes
            .iter()
            .filter(|r| touches(scene, &r.path, robot.radius_m, stops))
            .map(|r| r.to.clone())
            .collect();
        let legs_share = share(task.routes.len() - touching.len(), task.routes.len());
        let long = robot.body.and_then(|b| b.long_m());
        let near = NEAR_M + long.map_or(0.0, |[_, length]| length / 2.0);
        let level_of = |room: &str| scene.world.floorplan.room(room).map_or(0, |r| r.level);
        let elsewhere = |id: &str| scenario.pois.iter().any(|p| p.poi_id == id && level_of(&p.room_id) != task.level);
        let goals: Vec<&String> = task.goals.iter().chain(&task.dock).filter(|id| !elsewhere(id)).collect();
        let storey: Vec<_> =
            scene.world.floorplan.rooms.iter().zip(&scene.rooms).filter(|(r, _)| r.level == task.level).collect();
        let (clear, part) = match long {
            Some(body) => {
                let (stands, driven) = free.driven(body, start, near);
                let starts = driven.distance_to(start).is_some();
                (stands, starts.then_some(driven))
            }
            None => {
                let clear = free.eroded_by_disc(robot.radius_m);
                let part = clear.part_at(start).filter(|(_, distance)| *distance <= NEAR_M).map(|(part, _)| part);
                (clear, part)
            }
        };
        let Some(part) = part else {
            return RobotFit {
                robot_id: task.robot_id.clone(),
                radius_m: robot.radius_m,
                goals_share: 0.0,
                missed: goals.into_iter().cloned().collect(),
                rooms_share: 0.0,
                floor_share: 0.0,
                legs_share,
                touching,
                fits: false,
            };
        };
        let reached = |id: &String| {
            let poi = scenario.pois.iter().find(|p| &p.poi_id == id);
            let distance = poi.and_then(|p| part.distance_to(Point::new(p.pose.x, p.pose.y)));
            distance.is_some_and(|d| d <= near)
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
            legs_share,
            touching,
            fits: missed.is_empty(),
            missed,
        }
    };
    scenario.robots.iter().map(one).collect()
}

/// Returns true when a disc of this radius (m) that goes from corner to corner meets an object or what is no floor.
fn touches(scene: &Scene<'_>, path: &[Point], radius: f64, stops: impl Fn(&Solid<'_>) -> bool) -> bool {
    let inner = radius - SLACK_M;
    path.windows(2).any(|leg| {
        let (a, b) = (leg[0], leg[1]);
        let around = Rect::new(a.x.min(b.x), a.y.min(b.y), a.x.max(b.x), a.y.max(b.y)).grown(radius + SLACK_M);
        let solids: Vec<&Solid<'_>> =
            scene.solids.iter().filter(|s| stops(s) && s.bounds.grown(SLACK_M).overlaps(&around)).collect();
        let floor: Vec<&Rect> = scene.floor().filter(|r| r.grown(SLACK_M).overlaps(&around)).collect();
        // rectangles of floor that meet at an edge leave no gap
        let has_floor = |p: Point| {
            let inside = |r: &&Rect| {
                r.x0 - EDGE_M <= p.x && p.x <= r.x1 + EDGE_M && r.y0 - EDGE_M <= p.y && p.y <= r.y1 + EDGE_M
            };
            floor.iter().any(inside)
        };
        let count = (a.distance(b) / STEP_M).ceil().max(1.0);
        (0..=count as u32).map(|k| f64::from(k) / count).any(|t| {
            let at = Point::new(a.x + t * (b.x - a.x), a.y + t * (b.y - a.y));
            let rim = |k: u32| {
                let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(RIM)).sin_cos();
                Point::new(at.x + inner * cos, at.y + inner * sin)
            };
            solids.iter().any(|s| s.distance(at) < inner) || !(0..RIM).all(|k| has_floor(rim(k)))
        })
    })
}

#[cfg(test)]
mod tests {
    use d3dgen_model::robot_body::RobotBody;
    use d3dgen_model::scenario::Route;

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
    fn doors_lower_than_a_robot_stop_it() {
        let mut world = sample::world();
        world.scenario.robots[0].robot.height_m = world.floorplan.doors[0].height_m + 0.1;
        let found = measure(&Scene::new(&world));
        assert_eq!((found[0].fits, &found[0].missed[..]), (false, &["point_b".to_owned()][..]), "{found:?}");
    }

    #[test]
    fn a_long_robot_goes_through_doors_that_its_circle_does_not() {
        let mut world = sample::world();
        let robot = &mut world.scenario.robots[0].robot;
        let body = RobotBody { width_m: Some(0.6), length_m: Some(1.4), ..RobotBody::default() };
        (robot.body, robot.radius_m) = (Some(body), 0.3);
        let found = measure(&Scene::new(&world));
        assert!(found[0].fits, "{found:?}");
        // too wide for the door, however it turns
        world.scenario.robots[0].robot.body = Some(RobotBody { width_m: Some(0.96), length_m: Some(1.8), ..body });
        let found = measure(&Scene::new(&world));
        assert!(!found[0].fits && found[0].rooms_share < 1.0, "{found:?}");
    }

    #[test]
    fn routes_that_touch_something_are_told() {
        let mut world = sample::world();
        let path = vec![Point::new(3.2, 2.4), Point::new(3.2, 2.2)];
        let route = Route { from: String::new(), to: "point_a".into(), length_m: 0.2, clear_width_m: 0.6, path };
        world.scenario.robots[0].routes = vec![route];
        let found = measure(&Scene::new(&world));
        assert_eq!((found[0].legs_share, found[0].touching.len()), (1.0, 0), "{found:?}");
        world.placements.placements.push(sample::thing("post", (3.2 + 0.3 + 0.09, 2.3), [0.2, 0.2, 1.0]));
        let found = measure(&Scene::new(&world));
        assert_eq!((found[0].legs_share, &found[0].touching[..]), (0.0, &["point_a".to_owned()][..]), "1 cm too near");
        world.placements.placements.pop();
        // through the wall
        world.scenario.robots[0].routes[0].path[1] = Point::new(3.2, -1.0);
        assert_eq!(measure(&Scene::new(&world))[0].legs_share, 0.0);
    }

    #[test]
    fn a_robot_that_stands_in_furniture_cannot_start() {
        let mut world = sample::world();
        world.placements.placements.push(sample::thing("block", (3.2, 2.4), [1.4, 1.4, 1.0]));
        let found = measure(&Scene::new(&world));
        assert_eq!((found[0].fits, found[0].floor_share), (false, 0.0));
    }
}
