//! Ways for robots: through the middle of every doorway, and the routes of the scenario; what anybody who checks a world
//! drives along.

use d3dgen_model::floorplan::{Door, DoorKind};
use d3dgen_model::geometry::{Point, Segment};
use d3dgen_model::obstacles::Obstacles;
use serde_json::{Value, json};

use super::walls::Line;
use super::{Place, SimRobot, SimScene};

/// How far before and behind a door a way through it begins and ends, m; less where something stands there.
const BESIDE_M: f64 = 1.0;
const STEP_M: f64 = 0.05;
/// Radius of the disc that goes through doors where no robot is narrower, m.
const RADIUS_M: f64 = 0.25;
/// Height of a robot where no other is known, m.
const HEIGHT_M: f64 = 1.2;
/// Air around the disc, m.
const SLACK_M: f64 = 0.01;

/// A way on the floor.
#[derive(Debug, Clone, PartialEq)]
pub struct SimWay {
    /// Name: the id of the door or of the robot's leg.
    pub name: String,
    /// Corners on the floor, m.
    pub points_m: Vec<[f64; 3]>,
    /// Twice the least distance to anything, m.
    pub clear_width_m: f64,
}

impl SimWay {
    /// Returns true when the way crosses a line on the floor of a storey.
    pub(super) fn passes(&self, line: &Line, floor_m: f64) -> bool {
        self.points_m.windows(2).any(|w| {
            let [[a, left], [b, right]] = [0, 1].map(|k| line.place(Point::new(w[k][0], w[k][1])));
            let crosses = (left > 0.0) != (right > 0.0) && (w[0][2] - floor_m).abs() < 0.5;
            let at = if crosses { a + (b - a) * left / (left - right) } else { -1.0 };
            (0.0..=line.length).contains(&at)
        })
    }
}

/// Returns the radius of the disc that every way of a scene has room for, m.
pub fn way_radius_m(scene: &SimScene) -> f64 {
    let routes = scene.robots.iter().flat_map(|r| &r.routes);
    let ways = scene.doorways.iter().chain(routes);
    let narrowest = ways.map(|w| w.clear_width_m / 2.0 - SLACK_M).fold(RADIUS_M, f64::min);
    (narrowest * 100.0).floor() / 100.0
}

impl SimScene {
    /// Returns `paths.json` as the checks of simulators read it: a cylinder with its radius and height, and the ways along which
    /// it touches nothing, m.
    pub fn paths(&self) -> Value {
        let height = self.robots.iter().map(|r| r.height_m).fold(0.0, f64::max);
        let routes = self.robots.iter().flat_map(|r| &r.routes);
        let round = |v: f64| (v * 1e4).round() / 1e4;
        let paths = self.doorways.iter().chain(routes).map(|way| {
            let points: Vec<Value> = way.points_m.iter().map(|p| json!(p.map(round))).collect();
            json!({"name": way.name, "waypoints": points})
        });
        json!({
            "radius": way_radius_m(self),
            "height": if height > 0.0 { height } else { HEIGHT_M },
            "clear": 0.05,
            "paths": paths.collect::<Vec<_>>(),
        })
    }
}

/// Returns a way through every doorway.
pub(super) fn doorways(place: &Place<'_>, robots: &[SimRobot]) -> Vec<SimWay> {
    let height = robots.iter().map(|r| r.height_m).fold(HEIGHT_M, f64::max);
    let plan = &place.world.floorplan;
    let mut ways = Vec::new();
    for storey in place.storeys {
        let own = plan.storey_at(storey.level);
        let things = place.world.placements.storey(&own);
        let obstacles = Obstacles::of_world(&own, &things, height);
        ways.extend(own.doors.iter().map(|door| through(door, storey.elevation_m, &obstacles)));
    }
    ways
}

/// Returns the way through a door: to its middle from a meter before it to a meter behind it, or from where nothing stands in
/// the way.
fn through(door: &Door, floor_m: f64, obstacles: &Obstacles) -> SimWay {
    let line = Line::of(&door.line);
    let middle = line.point(line.length / 2.0, 0.0);
    let half = door.wall_thickness_m / 2.0;
    let jambs = if door.kind == DoorKind::Open { line.length } else { door.clear_width_m };
    let radius = (jambs / 2.0 - SLACK_M).min(RADIUS_M);
    let leads_out = door.room_ids.len() < 2;
    let far = |side: f64| {
        // The model takes doors that lead out for closed: what lies before them is looked at.
        let from = if leads_out { half + radius + SLACK_M } else { 0.0 };
        let free = |k: &i32| {
            let to = BESIDE_M - f64::from(*k) * STEP_M;
            let stretch = Segment {
                start: line.point(line.length / 2.0, side * from),
                end: line.point(line.length / 2.0, side * to.max(from)),
            };
            obstacles.along(stretch.start, stretch.end, BESIDE_M) >= radius + SLACK_M / 2.0
        };
        let steps = ((BESIDE_M - half) / STEP_M) as i32;
        let distance = (0..steps).find(free).map_or(half, |k| BESIDE_M - f64::from(k) * STEP_M);
        line.point(line.length / 2.0, side * distance)
    };
    let at = |p: Point| [p.x, p.y, floor_m];
    SimWay {
        name: door.door_id.clone(),
        points_m: vec![at(far(-1.0)), at(middle), at(far(1.0))],
        clear_width_m: 2.0 * (radius + SLACK_M),
    }
}
