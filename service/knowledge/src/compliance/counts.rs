//! Figures of the whole building: areas, numbers of rooms and of water closets.

use d3dgen_model::domain::Shape;

use super::Reading;
use super::site::Site;
use crate::measure::Measure;
use crate::retrieve::{Applicable, Rule, Scope};

/// Meters of an inch.
const INCH_M: f64 = 0.0254;

/// Reads a quantity of the building; nothing when it has none (no bed for beds per toilet).
pub(super) fn read(site: &Site, a: &Applicable, rule: &Rule) -> Vec<Reading> {
    match rule.quantity.measure {
        Measure::RobotRadius | Measure::RobotsApart => return robots(site, rule),
        _ => {}
    }
    figure(site, a, rule).map(|v| Reading::new("building", v)).into_iter().collect()
}

fn figure(site: &Site, a: &Applicable, rule: &Rule) -> Option<f64> {
    let area = |circulation_only: bool| -> f64 {
        let rooms = site.rooms.iter().filter(|r| r.plan.circulation || !circulation_only);
        rooms.map(|r| r.plan.net_area_m2).sum()
    };
    let toilets = site.count(&[Shape::Toilet, Shape::Cubicle]);
    let per_toilet = |n: f64| (toilets > 0 && n > 0.0).then(|| n / toilets as f64);
    let each = |whole: f64, parts: f64| (parts > 0.0).then(|| whole / parts);
    let persons = f64::from(site.retrieval.persons);
    let beds = site.rooms.iter().map(|r| r.beds()).sum::<usize>() as f64;
    match rule.quantity.measure {
        Measure::BuildingArea => Some(area(false)),
        Measure::CirculationShare => (area(true) > 0.0).then(|| area(true) / area(false)),
        Measure::RoomsPresent | Measure::RoomNeededAbovePersons => match &a.scope {
            Scope::Rooms(types) => Some(site.rooms.iter().filter(|r| types.contains(&r.plan.room_type)).count() as f64),
            _ => None,
        },
        Measure::ToiletsForPersons => Some(toilets as f64),
        Measure::CirculationAllowance => {
            (area(true) > 0.0 && area(false) > area(true)).then(|| area(true) / (area(false) - area(true)))
        }
        Measure::LargestRoomArea => site.rooms_of(a).map(|r| r.plan.net_area_m2).reduce(f64::max),
        Measure::BuildingAreaPerPerson => each(area(false), persons),
        Measure::BuildingAreaPerBed => each(gross(site), beds),
        Measure::PersonsPerRoom => each(persons, site.rooms_of(a).count() as f64),
        Measure::BedsPerRoomKind => each(beds, site.rooms_of(a).count() as f64).filter(|_| beds > 0.0),
        Measure::PersonsPerObject => each(persons, picked(site, rule)),
        Measure::DocksPerRobot => each(site.count(&[Shape::Dock]) as f64, f64::from(site.retrieval.robots)),
        Measure::Exits => Some(site.exits().count() as f64),
        Measure::DesksPerArea => {
            let rooms: f64 = site.rooms_of(a).map(|r| r.plan.net_area_m2).sum();
            each(site.count(&[Shape::Desk]) as f64, rooms / rule.quantity.base)
        }
        Measure::PersonsBySingleExit => Some(persons).filter(|_| site.exits().count() == 1),
        Measure::ExitWidthPerPerson => {
            let width: f64 = site.exits().map(|d| d.clear_width_m).sum();
            let unit = if a.constraint.unit.starts_with("in ") { INCH_M } else { 1.0 };
            each(width / unit, persons)
        }
        Measure::PersonsPerToilet => per_toilet(f64::from(site.retrieval.persons)),
        Measure::BedsPerToilet => per_toilet(site.rooms.iter().map(|r| r.beds()).sum::<usize>() as f64),
        _ => None,
    }
}

/// Returns the area of the building on wall center lines, m^2.
fn gross(site: &Site) -> f64 {
    site.rooms.iter().map(|r| r.plan.polygon.signed_area().abs()).sum()
}

/// Returns how many objects of the row's kinds there are.
fn picked(site: &Site, rule: &Rule) -> f64 {
    let kinds = site.rooms.iter().flat_map(|r| &r.objects).filter_map(|o| o.kind);
    kinds.filter(|k| rule.quantity.picks(k)).count() as f64
}

/// Reads the radius of each robot of the kinds the row names, or its distance to the nearest other robot at the start.
fn robots(site: &Site, rule: &Rule) -> Vec<Reading> {
    let robots = &site.world.scenario.robots;
    let mut out = Vec::new();
    for robot in robots.iter().filter(|r| rule.quantity.to.contains(&r.robot.kind)) {
        let apart =
            |o: &d3dgen_model::scenario::RobotTask| (o.start.x - robot.start.x).hypot(o.start.y - robot.start.y);
        let others = robots.iter().filter(|o| o.robot_id != robot.robot_id);
        let value = match rule.quantity.measure {
            Measure::RobotRadius => Some(robot.robot.radius_m),
            _ => others.map(apart).reduce(f64::min),
        };
        out.extend(value.map(|v| Reading::new(&robot.robot_id, v)));
    }
    out
}
