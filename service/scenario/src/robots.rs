//! Robots with where they start and what they visit.

use d3dgen_model::domain::{Goods, Shape};
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::geometry::Rect;
use d3dgen_model::obstacles::Obstacles;
use d3dgen_model::passage::{Passages, RobotWay};
use d3dgen_model::placements::Placements;
use d3dgen_model::robot_kind::{brings, cleans};
use d3dgen_model::scenario::{DOCKS_MISSING, Poi, RobotTask, Scenario, without_dock};
use d3dgen_model::scene_graph::{Note, Robot, SceneGraph};
use d3dgen_model::{Point, Pose};

use super::floor::{Floor, looking_at};
use super::routes::Router;
use super::tour::{self, Stop};

/// Robots up to whose number each has routes around all others at their docks.
const MOST_APART: usize = 8;

/// Returns the robots of the scene graph, each with its own start, goals that it can reach, in the order of a short tour.
pub(crate) fn all(
    floor: &mut Floor,
    graph: &SceneGraph,
    (plan, placements): (&Floorplan, &Placements),
    pois: &[Poi],
) -> Vec<RobotTask> {
    let mut out: Vec<RobotTask> = Vec::new();
    let mut docks: Vec<&Poi> = pois.iter().filter(|p| p.kind == Poi::DOCK).collect();
    let all_docks = docks.clone();
    for robot in &graph.robots {
        let all = of_trade(floor, robot, pois);
        for number in 0..robot.count as usize {
            let known = out.iter().filter(|t| t.robot.kind == robot.kind).count();
            let robot_id = format!("{}_robot_{}", robot.kind, known + 1);
            let dock = own_dock(floor, graph, robot, &mut docks)
                .or_else(|| all_docks.get(number % all_docks.len().max(1)).copied());
            let Some(start) = start(floor, pois, dock, &out) else { continue };
            let mut task = RobotTask {
                goals: goals(floor, share(floor, &all, robot, number), dock),
                robot_id,
                robot: Robot { count: 1, ..robot.clone() },
                start,
                dock: dock.map(|d| d.poi_id.clone()),
                level: 0,
                ways: Vec::new(),
                jobs: Vec::new(),
                routes: Vec::new(),
                locked: false,
            };
            if robot.misfit && !keep_where_it_fits(floor, &mut task, pois) {
                continue;
            }
            if robot.body.is_some() {
                task.ways = ways(&task, (plan, placements), pois);
            }
            floor.take(Point::new(task.start.x, task.start.y), robot.radius_m);
            out.push(task);
        }
    }
    out
}

/// Leaves a robot that the building is made without the goals and the dock that it gets to from floor that it can stand on,
/// the nearest to where it would start; false where there is none.
fn keep_where_it_fits(floor: &Floor, task: &mut RobotTask, pois: &[Poi]) -> bool {
    let Some(map) = floor.occupancy.clear(task.robot.radius_m).largest() else { return false };
    let wanted = Point::new(task.start.x, task.start.y);
    let Some(start) = floor.occupancy.nearest(&map, wanted) else { return false };
    task.start = looking_at(start, wanted);
    let is_reached = |id: &String| {
        let at = pois.iter().find(|p| &p.poi_id == id).map(|p| Point::new(p.pose.x, p.pose.y));
        at.and_then(|at| floor.occupancy.frame.cell(at)).is_some_and(|(i, j)| map.get(i, j))
    };
    task.goals.retain(is_reached);
    task.dock = task.dock.take().filter(is_reached);
    true
}

/// Takes the dock that suits a robot best of those that no other one has: where the prompt puts it, else cleaning ones charge
/// where soiled things are.
fn own_dock<'p>(floor: &Floor, graph: &SceneGraph, robot: &Robot, left: &mut Vec<&'p Poi>) -> Option<&'p Poi> {
    let suits = |p: &&Poi| (floor.goods(&p.room_id) == Goods::Soiled) == cleans(&robot.kind);
    // a dock that its type of room does not come with
    let wished = |p: &&Poi| {
        let Some(room) = graph.room(&p.room_id) else { return false };
        let usual = &floor.domain.room_type_or_generic(&room.room_type).furnishing;
        let is_dock = |id: &String| floor.domain.object(id).is_some_and(|o| o.shape == Shape::Dock);
        room.wished_assets.iter().any(|id| is_dock(id) && !usual.iter().any(|f| &f.item == id))
    };
    let told = |p: &&Poi| wished(p) && suits(p);
    let at = left.iter().position(told).or_else(|| left.iter().position(wished));
    let at = at.or_else(|| left.iter().position(suits)).or((!left.is_empty()).then_some(0))?;
    Some(left.remove(at))
}

/// Returns what to say where there are fewer docks than robots.
pub(crate) fn dock_shortage(robots: &[RobotTask]) -> Option<Note> {
    let without = without_dock(robots);
    let what = |t: &&RobotTask| match &t.dock {
        Some(dock) => format!("{} shares {dock}", t.robot_id),
        None => format!("{} has none", t.robot_id),
    };
    let named: Vec<String> = without.iter().map(what).collect();
    let (all, lacking, named) = (robots.len(), named.len(), named.join(", "));
    let message = || format!("{lacking} of {all} robots have no dock of their own, for want of floor: {named}");
    (lacking > 0).then(|| Note { code: DOCKS_MISSING.into(), message: message() })
}

/// Looks for the routes of all robots, each around the others where these start: as the largest of them goes, where a smaller
/// one needs no other way.
pub(crate) fn add_routes(floor: &Floor, scenario: &mut Scenario) {
    let Scenario { robots, pois, .. } = scenario;
    let parked: Vec<Rect> = robots
        .iter()
        .map(|task| {
            let (x, y, radius) = (task.start.x, task.start.y, task.robot.radius_m);
            Rect::new(x - radius, y - radius, x + radius, y + radius)
        })
        .collect();
    // a fleet has aisles of its own
    let apart = robots.len() <= MOST_APART;
    let others = |i: usize| -> Vec<Rect> {
        let others = parked.iter().enumerate().filter(|(k, _)| apart && *k != i);
        others.map(|(_, rect)| *rect).collect()
    };
    let count = if apart { robots.len() } else { 1 };
    let in_use: Vec<Obstacles> = (0..count).map(|i| floor.obstacles_in_use(&others(i))).collect();
    let mut routers: Vec<(usize, Router)> = Vec::new();
    for (i, task) in robots.iter_mut().enumerate() {
        let own = i.min(count.saturating_sub(1));
        let mut round = |radius: f64| {
            let at = routers.iter().position(|(k, r)| *k == own && r.radius() == radius).unwrap_or(routers.len());
            if at == routers.len() {
                routers.push((own, Router::new(floor, radius, &in_use[own])));
            }
            routers[at].1.round(task, pois)
        };
        let radius = task.robot.radius_m;
        let mut legs = round(floor.radius.max(radius));
        if radius < floor.radius && legs.iter().any(Option::is_none) {
            for (leg, narrow) in legs.iter_mut().zip(round(radius)) {
                *leg = leg.take().or(narrow);
            }
        }
        task.routes = legs.into_iter().flatten().collect();
    }
}

/// Returns the widest ways to a robot's goals and dock.
pub(crate) fn ways(task: &RobotTask, (plan, placements): (&Floorplan, &Placements), pois: &[Poi]) -> Vec<RobotWay> {
    let robot = &task.robot;
    let start = Point::new(task.start.x, task.start.y);
    let passages = Passages::new(plan, placements, robot, start);
    let goals = task.goals.iter().chain(&task.dock).filter_map(|id| pois.iter().find(|p| &p.poi_id == id));
    goals.map(|p| passages.to_point(&p.poi_id, Point::new(p.pose.x, p.pose.y), robot.radius_m)).collect()
}

/// Returns where a robot starts: its dock, else a bay, else the spot nearest to the entrance that is still free.
fn start(floor: &Floor, pois: &[Poi], dock: Option<&Poi>, others: &[RobotTask]) -> Option<Pose> {
    let bays = pois.iter().filter(|p| p.kind == Poi::WAITING_BAY);
    let apart = |p: &Pose| {
        others.iter().all(|o| Point::new(o.start.x, o.start.y).distance(Point::new(p.x, p.y)) >= 2.0 * floor.radius)
    };
    let known = dock.into_iter().chain(bays).map(|p| p.pose).find(apart);
    known.or_else(|| {
        let from = pois.iter().find(|p| p.kind == Poi::ENTRANCE).map(|p| Point::new(p.pose.x, p.pose.y));
        let from = from.or_else(|| floor.rooms.first().map(|r| r.plan.net_polygon.bounds().center()))?;
        let spots = floor.rooms.iter().filter_map(|r| floor.spot_near(r, from));
        let nearest = spots.min_by(|a, b| a.distance(from).total_cmp(&b.distance(from)))?;
        Some(looking_at(nearest, from))
    })
}

/// Returns the points that robots of a trade visit, along a short tour of the storey.
fn of_trade<'p>(floor: &Floor, robot: &Robot, pois: &'p [Poi]) -> Vec<&'p Poi> {
    let own = format!("{}_point", robot.kind);
    if !robot.stops.is_empty() {
        // one point a room: where it serves, else any
        let in_room = |id: &String| {
            let rank = |p: &&Poi| {
                [own.as_str(), Poi::ENTRANCE, Poi::SERVICE_POINT].iter().position(|k| *k == p.kind).unwrap_or(3)
            };
            pois.iter().filter(|p| &p.room_id == id && p.kind != Poi::DOCK).min_by_key(rank)
        };
        let found: Vec<&Poi> = robot.stops.iter().filter_map(in_room).collect();
        return toured(floor, found, pois.iter().find(|p| p.kind == Poi::DOCK));
    }
    let of_kinds = |kinds: &[&str]| pois.iter().filter(|p| kinds.contains(&p.kind.as_str())).collect::<Vec<&Poi>>();
    let known = [&[own.as_str()][..], &[Poi::SERVICE_POINT], &[Poi::ENTRANCE, Poi::WAITING_BAY]];
    let mut all: Vec<Vec<&Poi>> = known.into_iter().map(of_kinds).collect();
    // what brings clean things goes to none of the soiled ones, where it has anything else to do
    let soiled = |p: &&Poi| floor.goods(&p.room_id) == Goods::Soiled;
    if brings(&robot.kind) && robot.room_types.is_empty() {
        all.iter_mut().filter(|found| !found.iter().all(soiled)).for_each(|found| found.retain(|p| !soiled(p)));
    }
    // what the prompt keeps to some rooms visits these, where they have a point of any kind
    let kept = |p: &&Poi| robot.room_types.iter().any(|t| t == floor.room_type(&p.room_id));
    let only = all.iter().map(|found| found.iter().copied().filter(kept).collect::<Vec<&Poi>>());
    let found = only.chain(all.iter().cloned()).find(|found| !found.is_empty()).unwrap_or_default();
    toured(floor, found, pois.iter().find(|p| p.kind == Poi::DOCK))
}

/// Returns the part of a tour that one of several equal robots visits; all where there are too few points for them: one that brings
/// things needs two. Each of those loads where the clean ones are.
fn share<'p>(floor: &Floor, all: &[&'p Poi], robot: &Robot, number: usize) -> Vec<&'p Poi> {
    let loads = |p: &&&'p Poi| floor.goods(&p.room_id) == Goods::Clean && brings(&robot.kind);
    let (mut own, rest): (Vec<&'p Poi>, Vec<&'p Poi>) = all.iter().partition(loads);
    let robots = robot.count as usize;
    let least = if brings(&robot.kind) && own.is_empty() { 2 } else { 1 };
    match rest.len() < least * robots {
        true => own.extend(rest),
        false => own.extend(&rest[number * rest.len() / robots..(number + 1) * rest.len() / robots]),
    }
    own
}

/// Returns the ids of goals along a short tour from a robot's dock.
fn goals(floor: &Floor, own: Vec<&Poi>, dock: Option<&Poi>) -> Vec<String> {
    toured(floor, own, dock).into_iter().map(|p| p.poi_id.clone()).collect()
}

fn toured<'p>(floor: &Floor, points: Vec<&'p Poi>, from: Option<&Poi>) -> Vec<&'p Poi> {
    let stops: Vec<(Goods, Stop)> = points.iter().map(|p| (floor.goods(&p.room_id), Stop::of_poi(p))).collect();
    tour::in_turn(floor.doors(), from.map(Stop::of_poi), &stops).into_iter().map(|i| points[i]).collect()
}
