//! Whether and where the robots fit whose bodies are known: the widest way to every room and point.
//!
//! Other storeys are reached by an elevator, whose cabin and door are as wide as its shaft's room and door; robots take no
//! stairs.

use d3dgen_model::Point;
use d3dgen_model::domain::{Domain, RobotUse, RoomType};
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::passage::{Passages, RobotWay};
use d3dgen_model::report::RobotFit;
use d3dgen_model::robot_kind::brings;
use d3dgen_model::scenario::Poi;
use d3dgen_model::scene_graph::Robot;
use d3dgen_model::storeys::LinkKind;
use d3dgen_model::world::World;

/// Measures the fit of every robot whose body is known.
pub(crate) fn measure(world: &World, storeys: &[(i32, World)], domain: &Domain) -> Vec<RobotFit> {
    let known = world.scene_graph.robots.iter().filter(|r| r.body.is_some());
    known.map(|robot| one(world, storeys, domain, robot)).collect()
}

fn one(world: &World, storeys: &[(i32, World)], domain: &Domain, robot: &Robot) -> RobotFit {
    let task = world.scenario.robots.iter().find(|t| t.robot.kind == robot.kind);
    let home = task.map_or(0, |t| t.level);
    let only = [(home, world)];
    // robots come out of shafts, which are no floor of the storeys above the ground as people see them
    let above: Vec<(i32, World)> = storeys.iter().map(|(level, _)| (*level, world.storey(*level))).collect();
    let parts: Vec<(i32, &World)> = above.iter().map(|(level, w)| (*level, w)).collect();
    let parts = if parts.is_empty() { &only[..] } else { &parts[..] };
    let start = task.map(|t| Point::new(t.start.x, t.start.y));
    let ground = parts.iter().find(|p| p.0 == home).and_then(|p| ways(p.1, robot, start.or_else(|| entry(p.1))));
    let (mut rooms, mut points) = (Vec::new(), Vec::new());
    for (level, part) in parts {
        let ride = (*level != home).then(|| ride(world, ground.as_ref(), *level, home, robot));
        let upstairs = ride.as_ref().and_then(|r| ways(part, robot, r.exit));
        let passages = if ride.is_none() { ground.as_ref() } else { upstairs.as_ref() };
        let before = ride.map(|r| r.way);
        let judge = |to: &str, way: Option<RobotWay>| {
            let way = way.unwrap_or_else(|| RobotWay::none(to));
            match &before {
                // a door that is too low is what there is to say
                Some(_) if way.clear_height_m.is_some() => way,
                // no wider than the way to the elevator
                Some(first) if first.clear_width_m <= way.clear_width_m || !first.reachable => {
                    RobotWay { to: to.to_owned(), reachable: first.reachable && way.reachable, ..first.clone() }
                }
                _ => way,
            }
        };
        let r = robot.radius_m;
        rooms.extend(part.floorplan.rooms.iter().map(|room| {
            let id = room.room_id.as_str();
            judge(id, passages.map(|p| p.to_room(id, r)))
        }));
        points.extend(part.scenario.pois.iter().filter(|p| part.floorplan.room(&p.room_id).is_some()).map(|poi| {
            let at = Point::new(poi.pose.x, poi.pose.y);
            judge(&poi.poi_id, passages.map(|p| p.to_point(&poi.poi_id, at, r)))
        }));
    }
    let own = uses(&robot.kind);
    let served = |id: &str| {
        let kind = world.floorplan.room(id).map(|r| domain.room_type_or_generic(&r.room_type));
        let kept_out = world.scene_graph.keeps_robots_out(id);
        let used = |k: &RoomType| k.robot.iter().any(|u| own.contains(u)) && !k.robot.contains(&RobotUse::KeepOut);
        !kept_out && kind.is_some_and(used)
    };
    let missed = rooms.iter().any(|w| served(&w.to) && !w.reachable) || points.iter().any(|w| !w.reachable);
    RobotFit {
        kind: robot.kind.clone(),
        radius_m: robot.radius_m,
        height_m: robot.height_m,
        fits: !missed,
        rooms,
        points,
    }
}

/// Returns which rooms a kind of robot goes into: where there is something to bring, or the floor of all.
fn uses(kind: &str) -> &'static [RobotUse] {
    match brings(kind) {
        true => &[RobotUse::Service, RobotUse::Charging],
        false => &[RobotUse::CleaningHigh, RobotUse::CleaningLow, RobotUse::Charging],
    }
}

fn ways<'w>(world: &'w World, robot: &Robot, from: Option<Point>) -> Option<Passages<'w>> {
    Some(Passages::new(&world.floorplan, &world.placements, robot, from?))
}

/// Returns the middle of the floor inside the entrance, or of the first room.
fn entry(world: &World) -> Option<Point> {
    let poi = world.scenario.pois.iter().find(|p| p.kind == Poi::ENTRANCE).map(|p| Point::new(p.pose.x, p.pose.y));
    poi.or_else(|| world.floorplan.rooms.first().map(|r| r.net_polygon.bounds().center()))
}

/// The way from the storey where a robot lives to another.
struct Ride {
    way: RobotWay,
    /// Where it leaves the elevator.
    exit: Option<Point>,
}

fn ride(world: &World, ground: Option<&Passages>, level: i32, home: i32, robot: &Robot) -> Ride {
    let on = |plan: &Floorplan, ids: &[String], level: i32| {
        let mut rooms = ids.iter().filter_map(|id| plan.room(id));
        rooms.find(|r| r.level == level).map(|r| (r.room_id.clone(), r.net_polygon.bounds().center()))
    };
    let plan = &world.floorplan;
    let elevators = plan.links.iter().filter(|l| l.kind == LinkKind::Elevator);
    let mut stops = elevators.filter_map(|l| Some((on(plan, &l.room_ids, home)?, on(plan, &l.room_ids, level)?.1)));
    match (stops.next(), ground) {
        (Some(((id, _), exit)), Some(passages)) => {
            Ride { way: passages.to_room(&id, robot.radius_m), exit: Some(exit) }
        }
        _ => {
            let stairs = plan.links.iter().find_map(|l| on(plan, &l.room_ids, home)).map_or(String::new(), |s| s.0);
            Ride { way: RobotWay { narrowest: stairs, ..RobotWay::none("") }, exit: None }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_brings_nothing_is_judged_by_the_floor_that_is_cleaned() {
        for (kind, service) in [("cleaning", false), ("disinfection", false), ("delivery", true), ("guide", true)] {
            assert_eq!(uses(kind).contains(&RobotUse::Service), service, "{kind}");
            assert_eq!(uses(kind).contains(&RobotUse::CleaningHigh), !service, "{kind}");
        }
    }
}
