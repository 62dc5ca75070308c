//! From the constraints that apply to the figures a floorplan must keep.
//!
//! A figure is taken from the nearest jurisdiction that has one, the strictest there. Regulations and standards count,
//! and the least figures of guidelines; rules about robots and those of the building's owner are added on top wherever
//! they come from. A figure that the scene graph's own sizes cannot meet is left to the report.

use std::collections::BTreeSet;

use d3dgen_model::domain::Shape;
use d3dgen_model::knowledge::{AMENDMENT, LOCAL};

use crate::aims::ObjectAims;
use crate::conditions::Guard;
use crate::limits::{AreaLimit, Limit, Limits, RoomLimits};
use crate::measure::Measure;
use crate::query::Query;
use crate::retrieve::{Applicable, Rule, Scope};

/// Source types whose least figures a plan keeps.
const PLANNED_BY: [&str; 4] = ["regulation", "standard", "guideline", AMENDMENT];
/// Topic of the rules about robots rather than the building.
pub(crate) const ROBOT_TOPIC: &str = "robot_placement_charging_circulation";
/// Widest door that a limit may ask of an ordinary room, m: wider ones are gates with rules of their own.
const WIDEST_DOOR_M: f64 = 2.0;

/// Returns the limits that the constraints come to; what `all` have beyond these is wished for only.
pub(crate) fn draw(constraints: &[Applicable], all: &[Applicable], chain: &[String], query: &Query) -> Limits {
    // what nobody read in its source plans nothing
    let vouched = |list: &[Applicable]| list.iter().filter(|a| a.is_vouched_for()).cloned().collect::<Vec<_>>();
    let (constraints, all) = (&vouched(constraints)[..], &vouched(all)[..]);
    let usable = usable(constraints);
    let wished = self::usable(all);
    let pick = |wanted: &dyn Fn(&Applicable, &Rule) -> Option<f64>| strictest(&usable, chain, query, wanted);
    let mut limits = Limits {
        no_beds: !query.rooms.iter().any(|r| r.beds),
        corridor_width: pick(&|a, r| {
            (r.quantity.measure == Measure::CirculationWidth && is_circulation(a, query)).then_some(r.bounds.min?)
        }),
        corridor_width_advised: advised_width(&wished, query),
        corridor_width_two_way: two_way_width(&wished, query),
        circulation_share_advised: advised_share(&wished),
        entrance_width: pick(&|a, r| {
            let door = r.quantity.measure == Measure::DoorWidth && matches!(a.scope, Scope::Entrance | Scope::Doors);
            door.then_some(r.bounds.min?)
        }),
        area_per_workplace_advised: advised_figure(&wished, Measure::BuildingAreaPerWorkplace, &|_| true),
        rooms: Default::default(),
        objects: ObjectAims::draw(all),
    };
    for room in &query.rooms {
        let about = |a: &Applicable| match &a.scope {
            Scope::Rooms(types) => types.contains(&room.room_type),
            Scope::Circulation => room.circulation,
            _ => false,
        };
        let least = |measures: &[Measure], most: f64| {
            pick(&|a, r| {
                let value = r.bounds.min?;
                (about(a) && measures.contains(&r.quantity.measure) && value <= most).then_some(value)
            })
        };
        let side = room.area_max_m2.sqrt();
        let found = RoomLimits {
            area_min: least(&[Measure::RoomArea], room.area_max_m2),
            area_max: None,
            area_advised: advised_area(&usable, &about, room.area_max_m2),
            area_per_person_advised: advised_figure(&wished, Measure::AreaPerPerson, &|a| about(a) || of_desks(a)),
            dimension_min: least(&[Measure::LeastDimension, Measure::InnerRectangle], side),
            turning_circle: least(&[Measure::TurningCircle], side),
            door_width: pick(&|a, r| {
                let value = r.bounds.min?;
                let door = r.quantity.measure == Measure::DoorWidth && value <= WIDEST_DOOR_M;
                (door && (about(a) || a.scope == Scope::Doors)).then_some(value)
            }),
            door_width_advised: advised_door(&wished, &about),
            ceiling_height_min: least(&[Measure::CeilingHeight], f64::MAX),
            ceiling_heights_by_area: ceilings_by_area(constraints, &about, query),
        };
        if found != RoomLimits::default() {
            limits.rooms.insert(room.room_type.clone(), found);
        }
    }
    limits
}

/// Returns true for what is asked of each workplace, whatever the room is called.
fn of_desks(a: &Applicable) -> bool {
    matches!(&a.scope, Scope::Objects(shapes) if shapes.contains(&Shape::Desk))
}

/// Returns the constraints with a figure that holds for every room they are about.
fn usable(constraints: &[Applicable]) -> Vec<(&Applicable, &Rule)> {
    let settled = |a: &&Applicable| a.unsure.is_none() && a.superseded_by.is_none();
    let settled = constraints.iter().filter(settled).filter(|a| a.guards.iter().all(Guard::is_planned));
    settled.filter_map(|a| Some((a, a.decision.as_ref().ok()?))).collect()
}

/// Returns the figure of a measure that meets most of the advice; of several such figures the least.
fn advised_figure(
    wished: &[(&Applicable, &Rule)],
    measure: Measure,
    about: &dyn Fn(&Applicable) -> bool,
) -> Option<f64> {
    let bounds = || {
        let figures = wished.iter().filter(|(a, r)| r.quantity.measure == measure && about(a));
        figures.map(|(_, r)| &r.bounds)
    };
    let met = |v: f64| bounds().filter(|b| b.min.is_none_or(|m| m <= v) && b.max.is_none_or(|m| v <= m)).count();
    let figures = bounds().flat_map(|b| b.min.into_iter().chain(b.max));
    figures.max_by(|x, y| met(*x).cmp(&met(*y)).then(y.total_cmp(x)))
}

/// Returns the clear width that all advice on the doors of a room asks for, m; gates are another matter.
fn advised_door(wished: &[(&Applicable, &Rule)], about: &dyn Fn(&Applicable) -> bool) -> Option<f64> {
    let doors = wished
        .iter()
        .filter(|(a, r)| r.quantity.measure == Measure::DoorWidth && (about(a) || a.scope == Scope::Doors));
    doors.filter_map(|(_, r)| r.bounds.min).filter(|v| *v <= WIDEST_DOOR_M).reduce(f64::max)
}

/// Returns the clear heights that rooms above an area need.
fn ceilings_by_area(constraints: &[Applicable], about: &dyn Fn(&Applicable) -> bool, query: &Query) -> Vec<AreaLimit> {
    let candidates = constraints.iter().filter(|a| a.superseded_by.is_none() && a.unsure.is_none());
    let candidates = candidates.filter(|a| about(a) && is_planned(a, query));
    let steps = candidates.filter_map(|a| {
        let rule = a.decision.as_ref().ok().filter(|r| r.quantity.measure == Measure::CeilingHeight)?;
        let &[Guard::Area(above_m2, up_to_m2)] = a.guards.as_slice() else { return None };
        let limit = Limit { value: rule.bounds.min?, constraint_id: a.constraint.constraint_id.clone() };
        Some(AreaLimit { above_m2, up_to_m2, limit })
    });
    steps.collect()
}

/// Returns the width of circulation that meets all advice.
fn advised_width(usable: &[(&Applicable, &Rule)], query: &Query) -> Option<f64> {
    let about = |a: &Applicable, r: &Rule| r.quantity.measure == Measure::CirculationWidth && is_circulation(a, query);
    usable.iter().filter(|(a, r)| about(a, r)).filter_map(|(_, r)| r.bounds.min).reduce(f64::max)
}

/// Returns the width of circulation in which two of the robots pass each other: that of the rules about robots which asks for
/// the most, for all others are about one.
fn two_way_width(usable: &[(&Applicable, &Rule)], query: &Query) -> Option<f64> {
    let robots: Vec<_> = usable.iter().filter(|(a, _)| a.constraint.topic == ROBOT_TOPIC).copied().collect();
    advised_width(&robots, query).filter(|_| !query.robots.is_empty())
}

/// Returns the largest share of circulation that all advice allows.
fn advised_share(wished: &[(&Applicable, &Rule)]) -> Option<f64> {
    let shares = wished.iter().filter(|(_, r)| r.quantity.measure == Measure::CirculationShare);
    shares.filter_map(|(_, r)| r.bounds.max).reduce(f64::min)
}

/// Returns true for constraints on circulation, whether they call it so or by the room type it has here.
fn is_circulation(a: &Applicable, query: &Query) -> bool {
    match &a.scope {
        Scope::Circulation => true,
        Scope::Rooms(types) => query.rooms.iter().any(|r| r.circulation && types.contains(&r.room_type)),
        _ => false,
    }
}

/// Returns the areas that meet all advice; least figures go before largest ones.
fn advised_area(usable: &[(&Applicable, &Rule)], about: &dyn Fn(&Applicable) -> bool, most: f64) -> Option<[f64; 2]> {
    let bounds =
        || usable.iter().filter(|(a, r)| r.quantity.measure == Measure::RoomArea && about(a)).map(|(_, r)| &r.bounds);
    let least = bounds().filter_map(|b| b.min).filter(|v| *v <= most).reduce(f64::max);
    let largest = bounds().filter_map(|b| b.max).filter(|v| least.is_none_or(|l| *v >= l)).reduce(f64::min);
    (least.is_some() || largest.is_some()).then(|| [least.unwrap_or(0.0), largest.unwrap_or(most).min(most)])
}

/// Returns the strictest least figure of the nearest jurisdiction, or of the rules about robots and of the owner when
/// that is stricter.
fn strictest(
    usable: &[(&Applicable, &Rule)],
    chain: &[String],
    query: &Query,
    wanted: &dyn Fn(&Applicable, &Rule) -> Option<f64>,
) -> Option<Limit> {
    let candidates: Vec<(&Applicable, f64)> =
        usable.iter().filter(|(a, _)| is_planned(a, query)).filter_map(|(a, r)| Some((*a, wanted(a, r)?))).collect();
    let on_top = |a: &Applicable| robot_rule(a, query) || a.citation.jurisdiction == LOCAL;
    let places: BTreeSet<&str> =
        candidates.iter().filter(|(a, _)| !on_top(a)).map(|(a, _)| a.citation.jurisdiction.as_str()).collect();
    let nearest = chain.iter().find(|c| places.contains(c.as_str()));
    candidates
        .iter()
        .filter(|(a, _)| on_top(a) || Some(&a.citation.jurisdiction) == nearest)
        .max_by(|(a, x), (b, y)| {
            x.total_cmp(y).then_with(|| b.constraint.constraint_id.cmp(&a.constraint.constraint_id))
        })
        .map(|(a, value)| Limit { value: *value, constraint_id: a.constraint.constraint_id.clone() })
}

fn is_planned(a: &Applicable, query: &Query) -> bool {
    let kind = a.constraint.constraint_type.as_str();
    let binding = PLANNED_BY.contains(&a.citation.source.source_type.as_str())
        && (a.mandatory || kind == "minimum" || kind == "table");
    binding || robot_rule(a, query)
}

/// Returns true for the rules of papers about robots that were asked for (two-way traffic).
fn robot_rule(a: &Applicable, query: &Query) -> bool {
    !query.robots.is_empty()
        && a.constraint.topic == ROBOT_TOPIC
        && a.constraint.constraint_type == "minimum"
        && a.citation.source.source_type == "paper"
}
