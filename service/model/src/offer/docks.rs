//! Docks of robots: how many of them rooms have floor for, and which rooms suit one.

use crate::domain::{Domain, Furnishing, Goods, RoomType, Zone};
use crate::robot_kind::cleans;
use crate::scene_graph::Robot;

/// Depth of a dock, m.
const DOCK_DEPTH_M: f64 = 0.5;
/// What a robot takes beyond its own circle beside others, m.
const BESIDE_ROBOT_M: f64 = 0.2;
/// How many times as long as wide rooms of docks are.
const MOST_LONG: f64 = 2.0;
/// Floor of a room for each dock in it, m^2.
const DOCK_ROOM_M2: f64 = 8.0;
/// Most docks in a room that is there for something else.
const MOST_DOCKS: u32 = 3;
/// Rank from which on rooms to charge in are for staff, work and visitors.
pub const LAST_RANK: u8 = 4;

/// Returns true for rooms that are there to charge robots.
pub fn has_docks(domain: &Domain, kind: &RoomType) -> bool {
    kind.furnishing.iter().any(|f| f.required && domain.is_dock(&f.item))
}

/// Returns the largest circle that one of the robots turns in, m; 0 without any.
pub fn widest_circle_m(robots: &[Robot]) -> f64 {
    robots.iter().map(|r| 2.0 * r.planned_radius_m()).fold(0.0, f64::max)
}

/// Returns the area of a room in which so many robots of a circle charge, m^2: in one row, or in two that face each other, with
/// a lane in which each of them turns; never less than the line of its docks asks for.
pub fn docks_needed_m2(line: &Furnishing, docks: u32, circle_m: f64) -> f64 {
    let lane = circle_m + BESIDE_ROBOT_M;
    let rows = |rows: u32| {
        let (length, depth) = (f64::from(docks.div_ceil(rows)) * lane, f64::from(rows) * (DOCK_DEPTH_M + lane) + lane);
        length.max(depth / MOST_LONG) * depth.max(length / MOST_LONG)
    };
    (f64::from(docks) * line.area_per_item_m2).max(rows(1).min(rows(2)))
}

/// Returns how many of these docks a room of this area (m^2) holds by a line about them, for robots of a circle (m).
pub fn docks_held(line: &Furnishing, area_m2: f64, wanted: u32, circle_m: f64) -> u32 {
    let most = wanted.clamp(line.min.max(1), line.max.max(1));
    (1..=most).rev().find(|n| docks_needed_m2(line, *n, circle_m) <= area_m2).unwrap_or(1)
}

/// Returns how many docks a room of this area (m^2) takes that is there for something else.
pub fn most_docks(area_m2: f64) -> u32 {
    ((area_m2 / DOCK_ROOM_M2) as u32).clamp(1, MOST_DOCKS)
}

/// Returns how well a room that may have a dock suits a robot, 0 best: stores, rooms to work in, corridors, at last where
/// people wait ([`LAST_RANK`] and above); robots that clean charge where soiled things are and no other ones do. `None` for
/// rooms to sleep in.
pub fn dock_rank(kind: &RoomType, robot: &Robot) -> Option<u8> {
    let cleans = cleans(&robot.kind);
    match (kind.zone, kind.goods) {
        (Zone::Service, Goods::Soiled) if cleans => Some(0),
        // a mop room is no place for what brings mail or meals
        (Zone::Service, Goods::Soiled) => Some(LAST_RANK + 2),
        (Zone::Service, Goods::Usual) => Some(if cleans { 1 } else { 0 }),
        // a base open to the corridor, where loads are handed over, before the corridor, of whose width a dock takes
        (Zone::Day, _) => Some(2),
        (Zone::Staff, _) if kind.open_front => Some(2),
        (Zone::Circulation, _) => Some(3),
        (Zone::Service, _) => Some(LAST_RANK),
        (Zone::Staff, _) => Some(LAST_RANK + 1),
        (Zone::Public | Zone::Outdoor, _) => Some(LAST_RANK + 3),
        (Zone::Night, _) => None,
    }
}
