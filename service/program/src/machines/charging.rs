//! Where robots charge: rooms that are there for it, as large as the docks of so many robots need, and docks in other rooms.

use d3dgen_model::domain::{Domain, Furnishing, Goods, RobotUse, Shape, Zone};
use d3dgen_model::offer::{LAST_RANK, dock_rank, docks_held, docks_needed_m2, most_docks, widest_circle_m};
use d3dgen_model::robot_kind::cleans;
use d3dgen_model::scene_graph::{GraphRoom, Robot};

use crate::built::rooms::{MOST_WISHES, tenth};

/// Area of a room to charge robots over what its docks need: a plan that comes out a little smaller still has them all.
const DOCK_SPARE: f64 = 1.1;

/// Floor of a dock and of the robot before it, m^2.
const DOCK_FLOOR_M2: f64 = 4.0;

/// Makes rooms that are there to charge robots large enough for one dock a robot, as far as one such room goes; a size that
/// the prompt gives stays.
fn grow_charging(domain: &Domain, robots: &[Robot], rooms: &mut [GraphRoom]) {
    let mut left = robots.iter().map(|r| r.count).fold(0, u32::saturating_add);
    let circle = widest_circle_m(robots);
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
        let needed = tenth(docks_needed_m2(line, docks, circle));
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
    let circle = widest_circle_m(robots);
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
        let here = |r: &&mut GraphRoom| &r.room_type == room_type || r.circulation && domain.is_way(room_type);
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
