//! Where robots charge: rooms that are there for it, as large as the docks of so many robots need, and docks in other rooms.

use d3dgen_model::domain::{Domain, Furnishing, Goods, RobotUse, RoomType, Shape, Zone};
use d3dgen_model::scene_graph::{GraphRoom, Robot};

use crate::scene_graph::built::rooms::{MOST_WISHES, is_way, tenth};
use crate::scene_graph::tokens::words::cleans;

/// Area of a room to charge robots over what its docks need: a plan that comes out a little smaller still has them all.
const DOCK_SPARE: f64 = 1.1;
/// Depth of a dock, what a robot takes beyond its own circle beside others, and how many times as long as wide rooms are, m.
const DOCK_DEPTH_M: f64 = 0.5;
const BESIDE_ROBOT_M: f64 = 0.2;
const MOST_LONG: f64 = 2.0;
/// Floor of a dock and of the robot before it, m^2.
const DOCK_FLOOR_M2: f64 = 4.0;
/// From here on rooms for staff, work and visitors.
const LAST_RANK: u8 = 4;
/// Floor of a room for each dock in it, m^2, and most docks in a room that is there for something else.
const DOCK_ROOM_M2: f64 = 8.0;
const MOST_DOCKS: u32 = 3;

/// Returns the largest circle that one of the robots turns in; 0 without any.
pub(crate) fn widest_m(robots: &[Robot]) -> f64 {
    robots.iter().map(|r| 2.0 * r.planned_radius_m()).fold(0.0, f64::max)
}

/// Returns the area of a room in which so many robots of a circle charge, m^2: in one row, or in two that face each other, with
/// a lane in which each of them turns; never less than the line of its docks asks for.
fn floor_of_docks(line: &Furnishing, docks: u32, circle_m: f64) -> f64 {
    let lane = circle_m + BESIDE_ROBOT_M;
    let rows = |rows: u32| {
        let (length, depth) = (f64::from(docks.div_ceil(rows)) * lane, f64::from(rows) * (DOCK_DEPTH_M + lane) + lane);
        length.max(depth / MOST_LONG) * depth.max(length / MOST_LONG)
    };
    (f64::from(docks) * line.area_per_item_m2).max(rows(1).min(rows(2)))
}

/// Returns how many of these docks a room of this area holds by a line about them, for robots of a circle.
pub(crate) fn docks_held(line: &Furnishing, area_m2: f64, wanted: u32, circle_m: f64) -> u32 {
    let most = wanted.clamp(line.min.max(1), line.max.max(1));
    (1..=most).rev().find(|n| floor_of_docks(line, *n, circle_m) <= area_m2).unwrap_or(1)
}

/// Makes rooms that are there to charge robots large enough for one dock a robot, as far as one such room goes; a size that
/// the prompt gives stays.
fn grow_charging(domain: &Domain, robots: &[Robot], rooms: &mut [GraphRoom]) {
    let mut left = robots.iter().map(|r| r.count).fold(0, u32::saturating_add);
    let circle = widest_m(robots);
    for room in rooms.iter_mut() {
        let kind = domain.room_type_or_generic(&room.room_type);
        let charges = kind.robot.contains(&RobotUse::Charging);
        let holds = |f: &&Furnishing| charges && f.required && domain.is_dock(&f.item);
        let Some(line) = kind.furnishing.iter().find(holds) else { continue };
        let docks = left.min(line.max);
        if docks == 0 {
            break;
        }
        left -= docks;
        let needed = tenth(floor_of_docks(line, docks, circle));
        let [least, most] = room.area_range_m2;
        if most >= kind.area_m2.max && needed > least {
            room.area_range_m2 = [needed, most.max(tenth(DOCK_SPARE * DOCK_SPARE * needed))];
            room.target_area_m2 = room.target_area_m2.max(tenth(DOCK_SPARE * needed));
        }
    }
}

/// Wishes for a dock in the rooms that the prompt wants one in, and for one a robot in rooms that suit one while there are
/// fewer docks than robots: first one in each room of the staff and in circulation, then several, last in rooms for visitors
/// and work.
pub(crate) fn add_docks(domain: &Domain, robots: &[Robot], docked: &[String], rooms: &mut [GraphRoom]) {
    let sum = |counts: &mut dyn Iterator<Item = u32>| counts.fold(0, u32::saturating_add);
    let Some(dock) = domain.objects.iter().rev().find(|o| o.shape == Shape::Dock) else { return };
    // the dock of a mop room is for those that clean
    let cleans = robots.iter().any(|r| cleans(&r.kind));
    let all = sum(&mut robots.iter().map(|r| r.count));
    let circle = widest_m(robots);
    let held = |room: &GraphRoom| -> u32 {
        if !cleans && domain.room_type_or_generic(&room.room_type).goods == Goods::Soiled {
            return 0;
        }
        let lines = domain.room_type_or_generic(&room.room_type).furnishing.iter();
        sum(&mut lines.filter(|f| domain.is_dock(&f.item)).map(|f| match f.required {
            true => docks_held(f, room.target_area_m2, all, circle),
            false => f.units(room.target_area_m2),
        }))
    };
    let wished = |room: &GraphRoom| room.wished_assets.iter().filter(|id| **id == dock.id).count() as u32;
    let wish = |room: &mut GraphRoom| {
        room.wished_assets.insert(0, dock.id.clone());
        room.wished_assets.truncate(MOST_WISHES);
    };
    grow_charging(domain, robots, rooms);
    let mut present = sum(&mut rooms.iter().map(held));
    for room_type in docked {
        let here = |r: &&mut GraphRoom| &r.room_type == room_type || r.circulation && is_way(domain, room_type);
        if let Some(room) = rooms.iter_mut().find(here).filter(|r| held(r) + wished(r) == 0) {
            wish(room);
            present = present.saturating_add(1);
        }
    }
    // robots live on one storey
    let home = rooms.iter().find(|r| held(r) + wished(r) > 0).map_or(0, |r| r.level);
    for robot in robots {
        let own = present.min(robot.count);
        present -= own;
        for _ in own..robot.count {
            let suits = |room: &GraphRoom| {
                let kind = domain.room_type_or_generic(&room.room_type);
                let charges = kind.robot.contains(&RobotUse::Charging)
                    && !kind.furnishing.iter().any(|f| domain.is_dock(&f.item));
                let rank = dock_rank(kind, robot)?;
                let most = most_docks(room.target_area_m2);
                // a second one where loads are handed over, before one that takes of the width of a corridor
                let crowded = wished(room) + u32::from(kind.zone == Zone::Circulation);
                (charges && wished(room) < most).then_some((room.level != home, rank >= LAST_RANK, crowded, rank))
            };
            let all = rooms.iter().enumerate().filter_map(|(i, room)| Some((suits(room)?, i)));
            let Some((_, best)) = all.min() else { return };
            wish(&mut rooms[best]);
            make_room_for_dock(&mut rooms[best], domain);
        }
    }
}

/// Lets a room open to where people pass grow by the floor of a dock: what it is there for stays.
fn make_room_for_dock(room: &mut GraphRoom, domain: &Domain) {
    let kind = domain.room_type_or_generic(&room.room_type);
    let [least, most] = room.area_range_m2;
    if kind.zone == Zone::Staff && kind.open_front && most >= kind.area_m2.max {
        room.target_area_m2 = tenth((room.target_area_m2 + DOCK_FLOOR_M2).min(most));
        let docks = room.wished_assets.iter().filter(|id| domain.is_dock(id));
        let floor = DOCK_FLOOR_M2 * docks.count() as f64;
        room.area_range_m2 = [tenth((kind.area_m2.target + floor).min(room.target_area_m2).max(least)), most];
    }
}

/// Returns how many docks a room of this area takes that is there for something else.
pub(crate) fn most_docks(area_m2: f64) -> u32 {
    ((area_m2 / DOCK_ROOM_M2) as u32).clamp(1, MOST_DOCKS)
}

/// Returns how well a room that may have a dock suits a robot, 0 best: stores, rooms to work in, corridors, at last where people wait; robots
/// that clean charge where soiled things are and no other ones do. `None` for rooms to sleep in.
pub(crate) fn dock_rank(kind: &RoomType, robot: &Robot) -> Option<u8> {
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
