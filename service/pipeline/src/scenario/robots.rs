//! Robots with where they start and what they visit.

use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::passage::{Passages, RobotWay};
use d3dgen_model::placements::Placements;
use d3dgen_model::scenario::{Poi, RobotTask};
use d3dgen_model::scene_graph::{Robot, SceneGraph};
use d3dgen_model::seed::Stream;
use d3dgen_model::{Point, Pose};

use super::floor::{Floor, looking_at};

/// Returns the robots of the scene graph, each with its own start and goals that it can reach.
pub(super) fn all(
    floor: &mut Floor,
    graph: &SceneGraph,
    (plan, placements): (&Floorplan, &Placements),
    pois: &[Poi],
) -> Vec<RobotTask> {
    let mut out: Vec<RobotTask> = Vec::new();
    for robot in &graph.robots {
        for number in 0..robot.count as usize {
            let known = out.iter().filter(|t| t.robot.kind == robot.kind).count();
            let robot_id = format!("{}_robot_{}", robot.kind, known + 1);
            let docks: Vec<&Poi> = pois.iter().filter(|p| p.kind == "dock").collect();
            let dock = docks.get(number % docks.len().max(1)).copied();
            let Some(start) = start(floor, pois, dock, &out) else { continue };
            floor.take(Point::new(start.x, start.y), robot.radius_m);
            out.push(RobotTask {
                goals: goals(graph, robot, number, pois),
                robot_id,
                robot: Robot { count: 1, ..robot.clone() },
                start,
                dock: dock.map(|d| d.poi_id.clone()),
                level: 0,
                ways: Vec::new(),
            });
            if let Some(task) = out.last_mut().filter(|t| t.robot.body.is_some()) {
                task.ways = ways(task, (plan, placements), pois);
            }
        }
    }
    out
}

/// Returns the widest ways to a robot's goals and dock.
fn ways(task: &RobotTask, (plan, placements): (&Floorplan, &Placements), pois: &[Poi]) -> Vec<RobotWay> {
    let robot = &task.robot;
    let start = Point::new(task.start.x, task.start.y);
    let passages = Passages::new(plan, placements, robot, start);
    let goals = task.goals.iter().chain(&task.dock).filter_map(|id| pois.iter().find(|p| &p.poi_id == id));
    goals.map(|p| passages.to_point(&p.poi_id, Point::new(p.pose.x, p.pose.y), robot.radius_m)).collect()
}

/// Returns where a robot starts: its dock, else a bay, else the spot nearest to the entrance that is still free.
fn start(floor: &Floor, pois: &[Poi], dock: Option<&Poi>, others: &[RobotTask]) -> Option<Pose> {
    let bays = pois.iter().filter(|p| p.kind == "waiting_bay");
    let apart = |p: &Pose| {
        others.iter().all(|o| Point::new(o.start.x, o.start.y).distance(Point::new(p.x, p.y)) >= 2.0 * floor.radius)
    };
    let known = dock.into_iter().chain(bays).map(|p| p.pose).find(apart);
    known.or_else(|| {
        let from = pois.iter().find(|p| p.kind == "entrance").map(|p| Point::new(p.pose.x, p.pose.y));
        let from = from.or_else(|| floor.rooms.first().map(|r| r.plan.net_polygon.bounds().center()))?;
        let spots = floor.rooms.iter().filter_map(|r| floor.spot_near(r, from));
        let nearest = spots.min_by(|a, b| a.distance(from).total_cmp(&b.distance(from)))?;
        Some(looking_at(nearest, from))
    })
}

/// Returns the points one of several equal robots visits: its share of those of its trade, in an order of its own; all
/// where there are fewer than robots.
fn goals(graph: &SceneGraph, robot: &Robot, number: usize, pois: &[Poi]) -> Vec<String> {
    let own = format!("{}_point", robot.kind);
    let mut of_trade: Vec<&Poi> = pois.iter().filter(|p| p.kind == own).collect();
    if of_trade.is_empty() {
        of_trade = pois.iter().filter(|p| p.kind == "service_point").collect();
    }
    if of_trade.is_empty() {
        of_trade = pois.iter().filter(|p| p.kind == "entrance" || p.kind == "waiting_bay").collect();
    }
    Stream::new(graph.seed, &format!("scenario/{}", robot.kind)).shuffle(&mut of_trade);
    let (first, step) = if of_trade.len() < robot.count as usize { (0, 1) } else { (number, robot.count as usize) };
    of_trade.iter().skip(first).step_by(step).map(|p| p.poi_id.clone()).collect()
}
