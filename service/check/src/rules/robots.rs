//! Rules about robots, docks and what the scenario says.

use d3dgen_knowledge::clearance::{Side, door_zones, free_depth, is_shallow};
use d3dgen_model::domain::Shape;
use d3dgen_model::measures::LEAST_RADIUS_M;
use d3dgen_model::obstacles::Obstacles;
use d3dgen_model::occupancy::{Bitmap, ROBOT_HEIGHT_M};
use d3dgen_model::scenario::{RobotTask, Roi, RoiKind, Route};
use d3dgen_model::{Point, Pose, Rect, TOLERANCE_M};

use super::Findings;
use crate::context::{Context, Object, Room};
use d3dgen_model::scenario::{DOCKS_MISSING, without_dock};

/// A region may reach beyond its room by rounding, m^2.
const REGION_SLACK_M2: f64 = 0.01;
/// How much wider than it is a route may be called, m.
const WIDTH_M: f64 = 0.01;
/// Radius of a person standing, m.
const PERSON_RADIUS_M: f64 = 0.25;

fn is_dock(object: &Object) -> bool {
    object.kind.is_some_and(|k| k.shape == Shape::Dock)
}

pub fn docks(c: &Context, out: &mut Findings) {
    for dock in c.objects.iter().filter(|o| is_dock(o)) {
        out.look();
        let p = dock.placement;
        let Some(room) = c.room(&p.room_id) else { continue };
        for door in &room.doors {
            if door_zones(door).iter().any(|zone| dock.outline.area_in(zone) > 1e-6) {
                out.add(&p.placement_id, format!("stands in the way of `{}`", door.door_id));
            }
        }
        let others = c
            .objects_in(&p.room_id)
            .filter(|o| o.blocks && !is_shallow(o.placement) && o.placement.placement_id != p.placement_id);
        let depth = free_depth(p, Side::Front, &room.plan.net_polygon, others.map(|o| o.rect));
        // the whole clearance for robots that were asked for, a robot's width for docks that only stand there
        let wanted = dock.kind.map_or(0.0, |k| k.clearance_front_m);
        let needed =
            wanted.max(2.0 * c.radius).min(if c.graph().robots.is_empty() { 2.0 * c.radius } else { f64::MAX });
        if depth < needed - 0.01 {
            let message = format!("has {depth:.2} m free in front, needs {needed:.2} m");
            out.add_figure(&p.placement_id, message, depth, needed, "m");
        }
    }
}

/// Each robot that charges has a dock of its own, or the world says how many have none.
pub fn dock_missing(c: &Context, out: &mut Findings) {
    let charging = c.graph().robots.iter().filter(|r| r.charging && !r.misfit);
    let wanted = charging.map(|r| r.count).sum::<u32>() > 0;
    out.look();
    if wanted && !c.objects.iter().any(is_dock) {
        out.add("building", "robots that charge were asked for and the building has no dock");
    }
    if c.graph().conflicts.iter().any(|n| n.code == DOCKS_MISSING) {
        return;
    }
    for task in without_dock(&c.world.scenario.robots) {
        out.look();
        out.add(&task.robot_id, "has no dock of its own");
    }
}

fn point(pose: &Pose) -> Point {
    Point::new(pose.x, pose.y)
}

pub fn tasks(c: &Context, out: &mut Findings) {
    for task in &c.world.scenario.robots {
        out.look();
        let radius = task.robot.radius_m.max(LEAST_RADIUS_M);
        let map = c.clear(radius);
        let frame = &c.occupancy().frame;
        let mut seed = Bitmap::new(frame.nx, frame.ny);
        match frame.cell(point(&task.start)) {
            Some((i, j)) if map.get(i, j) => seed.set(i, j),
            _ => {
                out.add(&task.robot_id, "starts where it does not fit");
                continue;
            }
        }
        let reached = map.flood(&seed);
        for goal in task.goals.iter().chain(&task.dock) {
            let Some(poi) = c.world.scenario.pois.iter().find(|p| &p.poi_id == goal) else {
                out.add(&task.robot_id, format!("its goal `{goal}` is not a point of the scenario"));
                continue;
            };
            if !c.is_clear(&reached, point(&poi.pose)) {
                out.add(format!("{}|{goal}", task.robot_id), "the robot cannot get there from its start");
            }
        }
        let obstacles = Obstacles::of_world(c.plan(), &c.world.placements, task.robot.height_m.max(ROBOT_HEIGHT_M));
        task.routes.iter().for_each(|route| is_driven(&obstacles, task, route, out));
    }
}

/// A route touches nothing, and says how wide it is.
fn is_driven(obstacles: &Obstacles, task: &RobotTask, route: &Route, out: &mut Findings) {
    let (name, radius) = (format!("{}|{}", task.robot_id, route.to), task.robot.radius_m);
    if route.path.len() < 2 {
        out.add(name, "its route there has no corners");
        return;
    }
    let clear = obstacles.along_path(&route.path, radius.max(route.clear_width_m / 2.0) + WIDTH_M);
    if clear < radius - TOLERANCE_M {
        let message = format!("its route there passes {clear:.3} m from something, needs {radius:.3} m");
        out.add_figure(name, message, clear, radius, "m");
    } else if route.clear_width_m > 2.0 * clear + WIDTH_M {
        let message = format!("its route there is {:.2} m wide and says {:.2} m", 2.0 * clear, route.clear_width_m);
        out.add_figure(name, message, route.clear_width_m, 2.0 * clear, "m");
    }
}

pub fn poses(c: &Context, out: &mut Findings) {
    let scenario = &c.world.scenario;
    for poi in &scenario.pois {
        out.look();
        let inside = c.room(&poi.room_id).is_some_and(|r| r.plan.net_polygon.contains(point(&poi.pose)));
        if !inside {
            out.add(&poi.poi_id, format!("is not in `{}`", poi.room_id));
        } else if !c.is_clear(&c.clear(LEAST_RADIUS_M), point(&poi.pose)) {
            out.add(&poi.poi_id, "nobody can stand there");
        }
    }
    for agent in &scenario.agents {
        out.look();
        if !c.is_clear(&c.clear(PERSON_RADIUS_M), point(&agent.start)) {
            out.add(&agent.agent_id, "starts where nobody can stand");
        }
        for room in agent.waypoints.iter().filter(|id| c.room(id).is_none()) {
            out.add(&agent.agent_id, format!("walks to `{room}`, which is not in the plan"));
        }
    }
}

pub fn regions(c: &Context, out: &mut Findings) {
    for roi in &c.world.scenario.rois {
        out.look();
        let Some(room) = c.room(&roi.room_id) else {
            out.add(&roi.roi_id, format!("its room `{}` is not in the plan", roi.room_id));
            continue;
        };
        let pieces = roi.polygon.rects();
        let inside: f64 = pieces.iter().flat_map(|p| room.rects.iter().map(move |r| p.common_area(r))).sum();
        let outside = roi.polygon.area() - inside;
        if outside > REGION_SLACK_M2 || roi.polygon.signed_area() <= 0.0 {
            out.add_figure(
                &roi.roi_id,
                format!("{outside:.2} m2 lie outside its room"),
                outside,
                REGION_SLACK_M2,
                "m^2",
            );
        }
        match roi.kind {
            RoiKind::StagingArea => staging(c, roi, room, out),
            RoiKind::SpeedZone if !roi.max_speed_m_s.is_some_and(|v| v > 0.0) => {
                out.add(&roi.roi_id, "says no speed; give it max_speed_m_s");
            }
            _ => {}
        }
    }
}

/// Goods are put down where nothing stands and no door opens.
fn staging(c: &Context, roi: &Roi, room: &Room, out: &mut Findings) {
    let pieces = roi.polygon.rects();
    let takes = |r: &Rect| pieces.iter().any(|p| p.common_area(r) > REGION_SLACK_M2);
    let stands = |o: &Object| pieces.iter().any(|p| o.outline.area_in(p) > REGION_SLACK_M2);
    let taken = c.objects_in(&roi.room_id).find(|o| o.blocks && stands(o));
    if let Some(object) = taken {
        out.add(&roi.roi_id, format!("`{}` stands on it", object.placement.placement_id));
    }
    if let Some(door) = room.doors.iter().find(|d| door_zones(d).iter().any(takes)) {
        out.add(&roi.roi_id, format!("lies in the way of `{}`", door.door_id));
    }
}
