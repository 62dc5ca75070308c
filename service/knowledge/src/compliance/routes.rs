//! Ways through the furnished building: corridor widths, distances to exits and between rooms.

use std::collections::BTreeSet;

use d3dgen_model::Point;
use d3dgen_model::floorplan::Door;

use super::site::{Room, Site};
use crate::compliance::reading::Reading;
use crate::measure::Measure;
use crate::retrieve::{Applicable, Rule, Scope};

/// How far a slow walker gets in a minute, m.
const METERS_A_MINUTE: f64 = 60.0;

/// Reads a width or distance.
pub(super) fn read(site: &Site, a: &Applicable, rule: &Rule) -> Vec<Reading> {
    match rule.quantity.measure {
        Measure::CirculationWidth => widths(site, a, rule),
        Measure::DeadEnd => dead_ends(site, a),
        Measure::WalkingFactor => {
            let mut ways = farthest_from_exit(site);
            ways.iter_mut().for_each(|w| w.value /= rule.quantity.base);
            ways
        }
        Measure::TravelDistance => farthest_from_exit(site),
        Measure::DistanceToCirculation => to_circulation(site, a),
        Measure::StraightDistance => straight(site),
        Measure::DistanceToRoom | Measure::WalkingMinutes => {
            let to = site.rooms.iter().filter(|r| rule.to.contains(&r.plan.room_type));
            let mut ways = room_to_room(site, site.rooms.iter().collect(), to.collect());
            if rule.quantity.measure == Measure::WalkingMinutes {
                ways.iter_mut().for_each(|w| w.value /= METERS_A_MINUTE);
            }
            ways
        }
        Measure::DistanceBetween => {
            let near = site.rooms_of(a).collect();
            let far = site.rooms.iter().filter(|r| rule.to.contains(&r.plan.room_type)).collect();
            room_to_room(site, far, near)
        }
        _ => Vec::new(),
    }
}

fn widths(site: &Site, a: &Applicable, rule: &Rule) -> Vec<Reading> {
    let asked: BTreeSet<&str> = match &a.scope {
        Scope::Rooms(types) => types.iter().map(String::as_str).collect(),
        _ => BTreeSet::new(),
    };
    let rooms = site.rooms.iter().filter(|r| r.plan.circulation || asked.contains(r.plan.room_type.as_str()));
    let rooms = rooms.filter(|r| a.guards.iter().all(|g| r.passes(g)));
    let width = |r: &Room| {
        let doors: Vec<&Door> = r.doors.iter().copied().filter(|d| is_on_way(site, r, d, rule)).collect();
        (doors.len() > 1 || rule.to.is_empty()).then(|| r.space_upright().passage(&doors))
    };
    rooms
        .filter(|r| rule.to.is_empty() || leads_to(site, r, rule))
        .filter_map(|r| Some(Reading::new(&r.plan.room_id, width(r)?)))
        .collect()
}

/// Returns true for the doors of a passage between which it must be wide: all, or those on the way to rooms of a kind.
fn is_on_way(site: &Site, room: &Room, door: &Door, rule: &Rule) -> bool {
    let plan = &site.world.floorplan;
    let beyond = door.room_ids.iter().find(|id| **id != room.plan.room_id).and_then(|id| plan.room(id));
    rule.to.is_empty()
        || beyond.is_none_or(|r| rule.to.contains(&r.room_type) || r.circulation || is_entered(site, &r.room_id))
}

fn is_entered(site: &Site, room_id: &str) -> bool {
    site.exits().any(|d| d.room_ids.iter().any(|id| id == room_id))
}

fn leads_to(site: &Site, room: &Room, rule: &Rule) -> bool {
    let ends = room.doors.iter().flat_map(|d| &d.room_ids).filter_map(|id| site.world.floorplan.room(id));
    ends.into_iter().any(|r| rule.to.contains(&r.room_type))
}

/// Returns, for each straight corridor of a building with two exits, how far it goes on beyond its last way out.
fn dead_ends(site: &Site, a: &Applicable) -> Vec<Reading> {
    if site.exits().count() < 2 {
        return Vec::new();
    }
    let plan = &site.world.floorplan;
    let end = |room: &Room| {
        let [only] = room.plan.net_polygon.rects()[..] else { return None };
        let lies_east = only.width() >= only.height();
        let (low, high) = if lies_east { (only.x0, only.x1) } else { (only.y0, only.y1) };
        let leads_out = |d: &&&Door| {
            let beyond = d.room_ids.iter().find(|id| **id != room.plan.room_id);
            beyond.map_or(site.is_exit(d), |id| plan.room(id).is_some_and(|r| r.circulation) || is_entered(site, id))
        };
        let ways = room.doors.iter().filter(leads_out).map(|d| d.line.middle());
        let at: Vec<f64> = ways.map(|p| if lies_east { p.x } else { p.y }).collect();
        let first = at.iter().copied().reduce(f64::min)?;
        let last = at.iter().copied().reduce(f64::max)?;
        Some((first - low).max(high - last).max(0.0))
    };
    site.rooms_of(a).filter_map(|r| Some(Reading::new(&r.plan.room_id, end(r)?))).collect()
}

fn exits(site: &Site) -> Vec<Point> {
    site.exits().map(|d| d.line.middle()).collect()
}

/// Returns, for each room that opens on circulation, the way from its farthest point to that door.
fn to_circulation(site: &Site, a: &Applicable) -> Vec<Reading> {
    let map = site.occupancy();
    let leads = |d: &&&Door| {
        let ends = d.room_ids.iter().filter_map(|id| site.world.floorplan.room(id));
        ends.into_iter().any(|r| r.circulation)
    };
    let way = |room: &Room| {
        let doors: Vec<Point> = room.doors.iter().filter(leads).map(|d| d.line.middle()).collect();
        if doors.is_empty() { None } else { site.distances(&doors).largest_in(map, room.plan) }
    };
    site.rooms_of(a).filter_map(|r| Some(Reading::new(&r.plan.room_id, way(r)?))).collect()
}

/// Returns, for the room with the longest way out, the length of that way.
pub(super) fn farthest_from_exit(site: &Site) -> Vec<Reading> {
    let map = site.occupancy();
    let distances = site.distances(&exits(site));
    let ways = site.rooms.iter().filter_map(|r| Some((r, distances.largest_in(map, r.plan)?)));
    let longest = ways.max_by(|x, y| x.1.total_cmp(&y.1));
    longest.map(|(r, d)| Reading::new(&r.plan.room_id, d)).into_iter().collect()
}

fn straight(site: &Site) -> Vec<Reading> {
    let exits = exits(site);
    let from = |p: &Point| exits.iter().map(|e| e.distance(*p)).reduce(f64::min);
    let far = site.rooms.iter().filter_map(|r| {
        let corners = r.plan.net_polygon.corners().iter();
        Some((r, corners.filter_map(from).reduce(f64::max)?))
    });
    far.max_by(|x, y| x.1.total_cmp(&y.1)).map(|(r, d)| Reading::new(&r.plan.room_id, d)).into_iter().collect()
}

/// Returns, for the room of `from` that has the longest way to the nearest room of `to`, that way from door to door.
fn room_to_room(site: &Site, from: Vec<&Room>, to: Vec<&Room>) -> Vec<Reading> {
    let doors = |room: &Room| room.doors.iter().map(|d| d.line.middle()).collect::<Vec<_>>();
    let goals: Vec<Point> = to.iter().flat_map(|r| doors(r)).collect();
    if goals.is_empty() {
        return Vec::new();
    }
    let map = site.occupancy();
    let distances = site.distances(&goals);
    let ways = from.iter().filter_map(|r| {
        let way = doors(r).into_iter().filter_map(|p| distances.at(map, p)).reduce(f64::min)?;
        Some((r, way))
    });
    ways.max_by(|x, y| x.1.total_cmp(&y.1)).map(|(r, d)| Reading::new(&r.plan.room_id, d)).into_iter().collect()
}
