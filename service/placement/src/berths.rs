//! A dock for every robot: where the rooms that were to have them hold fewer, others do, around what stands in them.

use d3dgen_knowledge::Limits;
use d3dgen_knowledge::clearance::{Side, door_zones, free_depth, is_shallow, quarter};
use d3dgen_model::domain::{Domain, ObjectType, RobotUse, Shape};
use d3dgen_model::floorplan::{Floorplan, PlanRoom};
use d3dgen_model::measures::LEAST_RADIUS_M;
use d3dgen_model::occupancy::stops_robot;
use d3dgen_model::offer::{dock_rank, most_docks};
use d3dgen_model::placements::{Placement, Placements};
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::stage::{Error, Stop};
use d3dgen_model::{Point, Rect};

use super::docks::FROM_EXIT;
use super::locked::placed;
use super::pockets::Pockets;
use super::space::Space;
use super::{Wanted, insert, one_more};

/// Floor beside a dock that belongs to it, m, as in the charging buffers of scenarios.
const BESIDE_M: f64 = 0.5;

/// Adds docks until there is one for each robot, or no room that suits has a place.
///
/// # Errors
/// `Cancelled`.
pub(crate) fn add_missing(
    graph: &SceneGraph,
    plan: &Floorplan,
    (domain, limits): (&Domain, &Limits),
    out: &mut Placements,
    stop: Stop<'_>,
) -> Result<(), Error> {
    let robots: u32 = graph.robots.iter().map(|r| r.count).sum();
    let Some(robot) = graph.robots.first() else { return Ok(()) };
    let Some(usual) = domain.objects.iter().rev().find(|o| o.shape == Shape::Dock) else { return Ok(()) };
    let docks = domain.objects.iter().filter(|o| o.shape == Shape::Dock);
    let docks: Vec<&str> = docks.map(|o| o.id.as_str()).collect();
    let standing =
        |out: &Placements| out.placements.iter().filter(|p| docks.contains(&p.object.as_str())).count() as u32;
    let first = out.placements.iter().find(|p| docks.contains(&p.object.as_str()));
    // like those that stand already
    let dock = first.and_then(|p| domain.object(&p.object)).unwrap_or(usual);
    let home = first.and_then(|p| plan.room(&p.room_id)).map_or(0, |r| r.level);
    let suits = |room: &&PlanRoom| {
        let kind = domain.room_type_or_generic(&room.room_type);
        let kept_out = kind.robot.contains(&RobotUse::KeepOut) || graph.keeps_robots_out(&room.room_id);
        let charges = kind.robot.contains(&RobotUse::Charging) && !kept_out;
        dock_rank(kind, robot).filter(|_| charges && room.level == home)
    };
    let most = |room: &PlanRoom| {
        let kind = domain.room_type_or_generic(&room.room_type);
        let line = kind.furnishing.iter().find(|f| f.required && domain.is_dock(&f.item));
        line.map_or(most_docks(room.net_area_m2), |line| line.max)
    };
    let mut rooms: Vec<(u8, &PlanRoom)> = plan.rooms.iter().filter_map(|r| Some((suits(&r)?, r))).collect();
    rooms.sort_by_key(|r| r.0);
    let storey = &plan.storey_at(home);
    while standing(out) < robots {
        let place = |whole: bool| {
            rooms.iter().enumerate().find_map(|(at, (_, room))| {
                let here: Vec<&Placement> = out.placements.iter().filter(|p| p.room_id == room.room_id).collect();
                let own = here.iter().filter(|p| docks.contains(&p.object.as_str())).count();
                if own >= most(room) as usize {
                    return None;
                }
                let more = one_more(graph, storey, room, (domain, limits), &here, Wanted::IfFree(dock), stop)?;
                let stands = is_free(graph, storey, room, (&more, dock), &here)
                    && (!whole || !is_crowded(&more, dock, &here))
                    && !closes_floor(&Space::new(storey, room), domain, &more, &here);
                stands.then_some((at, more))
            })
        };
        // rather farther off than with a chair on the floor beside the robot
        let found = place(true).map(|(_, more)| (0, more)).or_else(|| place(false));
        stop.check()?;
        let Some((at, more)) = found else { break };
        // those before it have no place for another one either
        rooms.drain(..at);
        let wished = out.unplaced.iter().position(|u| docks.contains(&u.item.as_str()) && !u.required);
        wished.map(|i| out.unplaced.remove(i));
        insert(out, more);
    }
    Ok(())
}

/// Returns true when a dock has its whole clearance, is in the way of no door and away from the ways out.
fn is_free(
    graph: &SceneGraph,
    plan: &Floorplan,
    room: &PlanRoom,
    (p, dock): (&Placement, &ObjectType),
    here: &[&Placement],
) -> bool {
    let own = p.footprint().bounds();
    let others = here.iter().filter(|o| stops_robot(o) && !is_shallow(o)).map(|o| o.footprint().bounds());
    let robot = graph.robots.iter().map(|r| r.planned_radius_m()).fold(LEAST_RADIUS_M, f64::max);
    let depth = free_depth(p, Side::Front, &room.net_polygon, others);
    let ways_out = plan.ways_out();
    let at = Point::new(p.pose.x, p.pose.y);
    depth >= dock.clearance_front_m.max(2.0 * robot)
        && plan.doors_of(&room.room_id).all(|door| {
            let near = ways_out.iter().any(|d| d.door_id == door.door_id)
                && door.line.middle().distance(at) < f64::from(FROM_EXIT) / 1000.0;
            !near && !door_zones(door).iter().any(|zone| zone.overlaps(&own))
        })
}

/// Returns true when something stands on the floor beside the robot before a dock.
fn is_crowded(p: &Placement, dock: &ObjectType, here: &[&Placement]) -> bool {
    let depth = dock.clearance_front_m.max(2.0 * LEAST_RADIUS_M);
    let r = p.footprint().bounds();
    let floor = match quarter(p.pose.yaw_rad) {
        0 => Rect { x0: r.x1, x1: r.x1 + depth, y0: r.y0 - BESIDE_M, y1: r.y1 + BESIDE_M },
        1 => Rect { y0: r.y1, y1: r.y1 + depth, x0: r.x0 - BESIDE_M, x1: r.x1 + BESIDE_M },
        2 => Rect { x0: r.x0 - depth, x1: r.x0, y0: r.y0 - BESIDE_M, y1: r.y1 + BESIDE_M },
        _ => Rect { y0: r.y0 - depth, y1: r.y0, x0: r.x0 - BESIDE_M, x1: r.x1 + BESIDE_M },
    };
    let floor = floor.grown(-0.01);
    here.iter().filter(|o| stops_robot(o) && !is_shallow(o)).any(|o| o.footprint().bounds().overlaps(&floor))
}

/// Returns true when a dock closes off floor of its room that is open without it.
fn closes_floor(space: &Space, domain: &Domain, dock: &Placement, here: &[&Placement]) -> bool {
    let mut pockets = Pockets::new(space);
    placed(here, domain, space).0.iter().for_each(|unit| pockets.add(unit));
    pockets.is_closed_by(&Pockets::boxes(&placed(&[dock], domain, space).0))
}
