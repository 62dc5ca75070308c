//! Robots and people of the scenario: their sizes and speeds, and the room that circulation leaves them.
//!
//! Not where docks stand: that is in `objects`.

use d3dgen_model::Point;
use d3dgen_model::domain::Shape;
use d3dgen_model::scenario::{RobotTask, RoiKind};

use super::site::Site;
use crate::compliance::reading::Reading;
use crate::measure::Measure;
use crate::retrieve::{Applicable, Rule};

/// Reads a quantity of robots or people; nothing where the scenario has none.
pub(super) fn read(site: &Site, a: &Applicable, rule: &Rule) -> Vec<Reading> {
    match rule.quantity.measure {
        Measure::RobotRadius | Measure::RobotsApart => each_robot(site, rule),
        Measure::SideClearance => beside_robots(site, a, |spare| spare / 2.0),
        Measure::SpareWidth => beside_robots(site, a, |spare| spare),
        Measure::WalkingSpeed => {
            let agents = site.world.scenario.agents.iter();
            agents.map(|agent| Reading::new(&agent.agent_id, agent.speed_m_s)).collect()
        }
        Measure::BuildingAreaPerRobot => {
            let robots = of_kinds(site, rule).count();
            let area = (robots > 0).then(|| site.gross_area() / robots as f64);
            area.map(|v| Reading::new("building", v)).into_iter().collect()
        }
        Measure::DockReach => farthest_cleaned(site),
        _ => Vec::new(),
    }
}

/// Returns the robots of the kinds the row names.
fn of_kinds<'s>(site: &'s Site, rule: &'s Rule) -> impl Iterator<Item = &'s RobotTask> {
    site.world.scenario.robots.iter().filter(|r| rule.quantity.to.contains(&r.robot.kind))
}

/// Reads the radius of each robot of the row's kinds, or its distance to the nearest other robot at the start.
fn each_robot(site: &Site, rule: &Rule) -> Vec<Reading> {
    let robots = &site.world.scenario.robots;
    let mut out = Vec::new();
    for robot in of_kinds(site, rule) {
        let apart = |o: &RobotTask| (o.start.x - robot.start.x).hypot(o.start.y - robot.start.y);
        let others = robots.iter().filter(|o| o.robot_id != robot.robot_id);
        let value = match rule.quantity.measure {
            Measure::RobotRadius => Some(robot.robot.radius_m),
            _ => others.map(apart).reduce(f64::min),
        };
        out.extend(value.map(|v| Reading::new(&robot.robot_id, v)));
    }
    out
}

/// Reads, for each piece of circulation, what the widest robot leaves of its width.
fn beside_robots(site: &Site, a: &Applicable, figure: impl Fn(f64) -> f64) -> Vec<Reading> {
    let widest = site.world.scenario.robots.iter().map(|r| 2.0 * r.robot.radius_m).reduce(f64::max);
    let Some(widest) = widest else { return Vec::new() };
    let rooms = site.rooms_of(a).filter(|r| r.plan.circulation);
    rooms.map(|r| Reading::new(&r.plan.room_id, figure(r.space_upright().passage(&r.doors) - widest))).collect()
}

/// Reads, for each dock, how far the floor to be cleaned reaches from it.
fn farthest_cleaned(site: &Site) -> Vec<Reading> {
    let zones = site.world.scenario.rois.iter().filter(|z| z.kind == RoiKind::CleaningZone);
    let corners: Vec<Point> = zones.flat_map(|z| z.polygon.corners()).copied().collect();
    let docks = site.rooms.iter().flat_map(|r| &r.objects).filter(|o| o.is(&[Shape::Dock]));
    // any dock may be a cleaning robot's: the one that reaches farthest is its own at best
    let reach = |p: Point| corners.iter().map(|c| c.distance(p)).reduce(f64::max);
    let reaches = docks.filter_map(|o| Some((&o.placement.placement_id, reach(o.rect.center())?)));
    let nearest = reaches.min_by(|x, y| x.1.total_cmp(&y.1));
    nearest.map(|(id, v)| Reading::new(id, v)).into_iter().collect()
}
