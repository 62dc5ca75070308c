//! Ways through the furnished building: corridor widths, distances to exits and between rooms.

use std::collections::BTreeSet;

use d3dgen_model::floorplan::Door;
use d3dgen_model::{Point, Segment};

use super::site::{Room, Site};
use crate::clearance::depth_beside;
use crate::compliance::reading::Reading;
use crate::measure::Measure;
use crate::retrieve::{Applicable, Rule, Scope};

/// How far into a corridor its end is looked at, m.
const AT_END_M: f64 = 0.3;
/// How far a slow walker gets in a minute, m.
const METERS_A_MINUTE: f64 = 60.0;

/// Reads a width or distance.
pub(super) fn read(site: &Site, a: &Applicable, rule: &Rule) -> Vec<Reading> {
    match rule.quantity.measure {
        Measure::CirculationWidth => widths(site, a, rule),
        Measure::DeadEnd => dead_ends(site, a),
        Measure::WalkingFactor => walking_factor(site),
        Measure::CommonPath => common_path(site),
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

/// Returns, for each corridor of a building with two exits, how far it goes on beyond its last way out.
fn dead_ends(site: &Site, a: &Applicable) -> Vec<Reading> {
    if site.exits().count() < 2 {
        return Vec::new();
    }
    let plan = &site.world.floorplan;
    let end = |room: &Room| {
        let leads_out = |d: &&&Door| {
            let beyond = d.room_ids.iter().find(|id| **id != room.plan.room_id);
            beyond.map_or(site.is_exit(d), |id| plan.room(id).is_some_and(|r| r.circulation) || is_entered(site, id))
        };
        let ways: Vec<Point> = room.doors.iter().filter(leads_out).map(|d| d.line.middle()).collect();
        let [only] = room.plan.net_polygon.rects()[..] else { return bent_dead_end(site, room, &ways) };
        let lies_east = only.width() >= only.height();
        let (low, high) = if lies_east { (only.x0, only.x1) } else { (only.y0, only.y1) };
        let at: Vec<f64> = ways.iter().map(|p| if lies_east { p.x } else { p.y }).collect();
        let first = at.iter().copied().reduce(f64::min)?;
        let last = at.iter().copied().reduce(f64::max)?;
        Some((first - low).max(high - last).max(0.0))
    };
    site.rooms_of(a).filter_map(|r| Some(Reading::new(&r.plan.room_id, end(r)?))).collect()
}

/// Returns how far a corridor that bends or branches goes on beyond its last way out, m; `None` where it has none.
fn bent_dead_end(site: &Site, room: &Room, ways: &[Point]) -> Option<f64> {
    if ways.is_empty() {
        return None;
    }
    let outline = &room.plan.net_polygon;
    let walls: Vec<Segment> = outline.edges().collect();
    let turn = |i: usize| {
        let (a, b) = (&walls[(i + walls.len() - 1) % walls.len()], &walls[i]);
        (a.end.x - a.start.x) * (b.end.y - b.start.y) - (a.end.y - a.start.y) * (b.end.x - b.start.x)
    };
    // a wall between two outer corners that lies deeper behind than it is long is where the corridor ends
    let inward = |wall: &Segment| -> u8 {
        match (wall.is_vertical(), wall.end.x > wall.start.x, wall.end.y > wall.start.y) {
            (true, _, true) => 2,
            (true, _, false) => 0,
            (false, true, _) => 1,
            (false, false, _) => 3,
        }
    };
    let mut ends: Vec<(Point, u8)> = Vec::new();
    for (i, wall) in walls.iter().enumerate() {
        let ahead = inward(wall);
        let [dx, dy] = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]][usize::from(ahead)];
        let middle = Point::new(wall.middle().x + dx * AT_END_M, wall.middle().y + dy * AT_END_M);
        let depth =
            depth_beside(&wall.moved(dx * AT_END_M, dy * AT_END_M).bounds(), ahead, outline, std::iter::empty());
        if turn(i) > 0.0 && turn((i + 1) % walls.len()) > 0.0 && depth + AT_END_M > wall.length() {
            ends.push((middle, ahead));
        }
    }
    let distances = site.distances(ways);
    let branches = ends.len() > 2;
    let dead = |(middle, ahead): &(Point, u8)| {
        let to_way = distances.at(site.occupancy(), *middle)?;
        // where it branches, two ways lead on
        let inner = (0..walls.len()).filter(|i| branches && turn(*i) < 0.0).map(|i| walls[i].start);
        let along = |p: Point| if ahead.is_multiple_of(2) { (p.x - middle.x).abs() } else { (p.y - middle.y).abs() };
        Some(inner.map(along).fold(to_way, f64::min))
    };
    ends.iter().filter_map(dead).reduce(f64::max).or(Some(0.0))
}

/// Returns the rooms from which one gets out of the building without a room, or without an exit.
fn ways_out_without<'s>(site: &'s Site, room: Option<&str>, exit: Option<&str>) -> BTreeSet<&'s str> {
    let open = |id: &&str| Some(*id) != room;
    let mut reached: BTreeSet<&str> = BTreeSet::new();
    let out = site.exits().filter(|d| Some(d.door_id.as_str()) != exit);
    let mut next: Vec<&str> = out.flat_map(|d| &d.room_ids).map(String::as_str).filter(open).collect();
    while let Some(id) = next.pop() {
        if reached.insert(id) {
            let doors = site.world.floorplan.doors_of(id).flat_map(|d| &d.room_ids).map(String::as_str);
            next.extend(doors.filter(open));
        }
    }
    reached
}

/// Returns, for the room with the longest way to where people can choose between two ways out, that way.
///
/// People can choose in a room that no other room and no exit alone cuts off from outside.
fn common_path(site: &Site) -> Vec<Reading> {
    if site.exits().count() < 2 {
        return farthest_from_exit(site);
    }
    let mut choice: BTreeSet<&str> = ways_out_without(site, None, None);
    for exit in site.exits() {
        let without = ways_out_without(site, None, Some(&exit.door_id));
        choice.retain(|id| without.contains(id));
    }
    for room in &site.rooms {
        let own = room.plan.room_id.as_str();
        let without = ways_out_without(site, Some(own), None);
        choice.retain(|id| *id == own || without.contains(id));
    }
    if choice.is_empty() {
        return farthest_from_exit(site);
    }
    let joins = |d: &&Door| {
        let inside = d.room_ids.iter().filter(|id| choice.contains(id.as_str())).count();
        inside == 1 && d.room_ids.len() == 2
    };
    let goals: Vec<Point> = site.world.floorplan.doors.iter().filter(joins).map(|d| d.line.middle()).collect();
    let (map, distances) = (site.occupancy(), site.distances(&goals));
    let others = site.rooms.iter().filter(|r| !choice.contains(r.plan.room_id.as_str()));
    let ways = others.filter_map(|r| Some((r, distances.largest_in(map, r.plan)?)));
    let longest = ways.max_by(|x, y| x.1.total_cmp(&y.1));
    vec![longest.map_or_else(|| Reading::new("building", 0.0), |(r, way)| Reading::new(&r.plan.room_id, way))]
}

/// Returns, for the room with the longest way out, that way over the straight line between its ends.
fn walking_factor(site: &Site) -> Vec<Reading> {
    let (map, exits) = (site.occupancy(), exits(site));
    let distances = site.distances(&exits);
    let ways = site.rooms.iter().filter_map(|r| Some((r, distances.farthest_in(map, r.plan)?)));
    let Some((room, (from, _))) = ways.max_by(|x, y| x.1.1.total_cmp(&y.1.1)) else { return Vec::new() };
    let to_each = exits.iter().filter_map(|e| Some((*e, site.distances(&[*e]).at(map, from)?)));
    let Some((exit, way)) = to_each.min_by(|x, y| x.1.total_cmp(&y.1)) else { return Vec::new() };
    let straight = exit.distance(from);
    // no way is shorter than the straight line; steps of ten centimeters and rounded diagonals are
    let factor = (straight > 0.0).then(|| (way / straight).max(1.0));
    factor.map(|f| Reading::new(&room.plan.room_id, f)).into_iter().collect()
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
