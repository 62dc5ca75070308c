//! Floor at fixtures and furniture that people reach from a side or with a wheelchair, and things mounted on walls.

use d3dgen_model::domain::{Mount, Shape};
use d3dgen_model::knowledge::Value;
use d3dgen_model::{Point, Rect};

use super::kitchen;
use super::site::{Object, Room, Site};
use crate::clearance::{Side, depth_beside, free_depth, quarter, turned};
use crate::compliance::site::belong_together;
use crate::freespace::FreeSpace;
use crate::measure::Measure;
use crate::retrieve::{Applicable, Rule};

/// Free floor this deep lets a person stand, m.
const STANDING_M: f64 = 0.6;
/// Distance at which floor counts as being at an object, m.
const AT_M: f64 = 0.05;
/// Depth under a basin that toes reach, m: the least that building codes ask there.
const TOES_M: f64 = 0.43;
/// Width and depth beyond which free floor does not count as room to move at a workplace, m.
const MOVING_M: [f64; 2] = [2.0, 1.5];
const SEATS: [Shape; 3] = [Shape::Chair, Shape::SwivelChair, Shape::Stool];

/// Returns a figure of an object, in the constraint's unit; `None` when the quantity is another or the other end is missing.
pub(super) fn figure(site: &Site, room: &Room, object: &Object, a: &Applicable, rule: &Rule) -> Option<f64> {
    match rule.quantity.measure {
        Measure::MountHeight => Some(object.placement.pose.z + object.placement.size_m[2] / 2.0),
        Measure::UndersideHeight => Some(object.placement.pose.z),
        Measure::CornerDistance => Some(corner_distance(room, object)),
        Measure::ObjectToDoor => to_door(site, room, object, rule),
        Measure::LandingShorter => kitchen::landings(room, object).into_iter().reduce(f64::min),
        Measure::LandingLonger => kitchen::landings(room, object).into_iter().reduce(f64::max),
        Measure::SeatedDepth => seated_depth(room, object),
        Measure::SeatSpace => {
            let deep = entry(a, "length")?;
            let seats = seats_at(room, object).count();
            let (short, long) =
                (object.rect.width().min(object.rect.height()), object.rect.width() + object.rect.height());
            let edge = 2.0 * long / seats as f64;
            (seats > 0).then_some(if short / 2.0 >= deep { edge } else { 0.0 })
        }
        Measure::ClearFloorAtObject => Some(floor_at(room, object, rule.bounds.sides?)),
        Measure::ClearInFront => {
            let deep = entry(a, "length")?;
            let across = ahead(room, object).filter(|(_, depth)| *depth >= deep - super::SLACK).map(|(width, _)| width);
            Some(across.fold(0.0, f64::max))
        }
        Measure::FreeAreaAtObject => {
            let areas = ahead(room, object).map(|(width, depth)| width.min(MOVING_M[0]) * depth.min(MOVING_M[1]));
            Some(areas.fold(0.0, f64::max))
        }
        Measure::ClearanceAround => Some(around(room, object, entry(a, "length")?)),
        Measure::AccessibleSides => {
            let free =
                |turn| depth_beside(&object.rect, turn, &room.plan.net_polygon, room.others(object)) >= STANDING_M;
            Some((0..4).filter(|turn| free(*turn)).count() as f64)
        }
        Measure::HeadToWindow => {
            let head = head(object);
            room.windows.iter().map(|w| w.line.bounds().distance_to(head)).reduce(f64::min)
        }
        Measure::BedToSideWall => to_side_wall(room, object, rule),
        Measure::BedSidePair => {
            let (wide, narrow) = (entry(a, "one_side")?, entry(a, "other_side")?);
            let side = |side| free_depth(object.placement, side, &room.plan.net_polygon, room.others(object));
            let (left, right) = (side(Side::Left), side(Side::Right));
            Some(left.min(right).min(left.max(right) - (wide - narrow)))
        }
        _ => None,
    }
}

/// Returns a figure of the constraint's table.
fn entry(a: &Applicable, key: &str) -> Option<f64> {
    match &a.constraint.value {
        Value::Table(table) => table.get(key)?.as_f64(),
        _ => None,
    }
}

/// Returns the distance of the middle of a thing on a wall from the nearest wall beside it, m.
fn corner_distance(room: &Room, object: &Object) -> f64 {
    let ahead = quarter(object.placement.pose.yaw_rad);
    let side = |turn| depth_beside(&object.rect, (ahead + turn) % 4, &room.plan.net_polygon, std::iter::empty());
    side(1).min(side(3)) + object.placement.size_m[0] / 2.0
}

fn to_door(site: &Site, room: &Room, object: &Object, rule: &Rule) -> Option<f64> {
    let plan = &site.world.floorplan;
    let leads = |id: &String| plan.room(id).is_some_and(|r| rule.to.contains(&r.room_type));
    let doors = room.doors.iter().filter(|d| d.room_ids.iter().any(leads));
    doors.map(|d| d.line.bounds().distance_to(object.rect.center())).reduce(f64::min)
}

fn seats_at<'a>(room: &'a Room, object: &'a Object) -> impl Iterator<Item = &'a Object<'a>> {
    room.objects.iter().filter(|o| o.is(&SEATS) && belong_together(o, object))
}

/// Returns the free floor behind the edges of a table that have seats, m.
fn seated_depth(room: &Room, object: &Object) -> Option<f64> {
    let sits = |turn: u8| {
        let own = turned(&object.rect, turn);
        let beyond = |r: Rect| r.center().x > own.x1 && r.center().y > own.y0 && r.center().y < own.y1;
        seats_at(room, object).any(|s| beyond(turned(&s.rect, turn)))
    };
    let free = |turn| depth_beside(&object.rect, turn, &room.plan.net_polygon, room.others(object));
    (0..4).filter(|turn| sits(*turn)).map(free).reduce(f64::min)
}

/// Returns the floor of a room without these objects; rails and dispensers on walls take none of what is asked there.
fn floor_without(room: &Room, left_out: impl Fn(&Object) -> bool) -> FreeSpace {
    let on_wall = |o: &Object| o.placement.mount == Mount::Wall && !o.is(&[Shape::Basin, Shape::Sink]);
    let taken = room.objects.iter().filter(|o| o.blocks && !on_wall(o) && !left_out(o)).map(|o| o.rect);
    FreeSpace::new(&room.plan.net_polygon, &taken.collect::<Vec<Rect>>())
}

/// Returns width and depth of each free piece of floor that begins at the front of an object.
fn ahead(room: &Room, object: &Object) -> impl Iterator<Item = (f64, f64)> {
    let heading = quarter(object.placement.pose.yaw_rad);
    let own = turned(&object.rect, heading);
    // the object stays, and what was placed with it (a desk's chair) makes room
    let stays = |o: &Object| o.placement == object.placement || !belong_together(o, object);
    let floor = floor_without(room, |o| !stays(o));
    floor.rects.into_iter().filter_map(move |r| {
        let r = turned(&r, heading);
        let overlap = r.y1.min(own.y1) - r.y0.max(own.y0);
        let at_front = r.x0 <= own.x1 + AT_M && r.x1 > own.x1;
        (at_front && overlap >= (own.y1 - own.y0) / 2.0).then_some((r.y1 - r.y0, r.x1 - own.x1))
    })
}

/// Returns the width of the free floor at the front of an object that is as long as asked, along or away from it, m.
///
/// Knees and toes fit under a basin on a wall.
fn floor_at(room: &Room, object: &Object, [_, long]: [f64; 2]) -> f64 {
    let under = if object.placement.mount == Mount::Wall { object.placement.size_m[1].min(TOES_M) } else { 0.0 };
    let fits = |(across, deep): (f64, f64)| {
        let along = if across >= long - super::SLACK { deep } else { 0.0 };
        let away = if deep + under >= long - super::SLACK { across } else { 0.0 };
        along.max(away)
    };
    ahead(room, object).map(fits).fold(0.0, f64::max)
}

/// Returns the width of the floor with nothing but this object on it, as deep from the wall behind it as asked, m.
fn around(room: &Room, object: &Object, deep: f64) -> f64 {
    let heading = quarter(object.placement.pose.yaw_rad);
    let own = turned(&object.rect, heading);
    let free = floor_without(room, |o| o.placement == object.placement);
    let pieces = free.rects.iter().map(|r| turned(r, heading));
    let holds = |r: &Rect| r.grown(AT_M).contains(&own) && r.x1 - r.x0 >= deep - super::SLACK;
    pieces.filter(holds).map(|r| r.y1 - r.y0).fold(0.0, f64::max)
}

/// Returns the middle of the back edge of a bed, where the head lies.
fn head(object: &Object) -> Point {
    let (middle, half) = (object.rect.center(), object.placement.size_m[1] / 2.0);
    let (sin, cos) = object.placement.pose.yaw_rad.sin_cos();
    Point::new(middle.x - cos * half, middle.y - sin * half)
}

/// Returns the distance from the long side of a bed to the wall beside it, where no other bed stands between, m.
fn to_side_wall(room: &Room, object: &Object, rule: &Rule) -> Option<f64> {
    let heading = quarter(object.placement.pose.yaw_rad);
    let outline = &room.plan.net_polygon;
    let beds = || {
        let alike = |o: &&Object| o.placement != object.placement && o.kind.is_some_and(|k| rule.quantity.picks(k));
        room.objects.iter().filter(alike).map(|o| o.rect)
    };
    let side = |turn: u8| {
        let ahead = (heading + turn) % 4;
        let to_wall = depth_beside(&object.rect, ahead, outline, std::iter::empty());
        (depth_beside(&object.rect, ahead, outline, beds()) >= to_wall - AT_M).then_some(to_wall)
    };
    [side(1), side(3)].into_iter().flatten().reduce(f64::min)
}
