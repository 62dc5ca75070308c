//! Robot zones: floor to be cleaned, floor to serve at, floor around docks, floor to keep out of.

use d3dgen_knowledge::clearance::quarter;
use d3dgen_model::domain::{Goods, RobotUse, Shape};
use d3dgen_model::floorplan::Door;
use d3dgen_model::geometry::to_mm;
use d3dgen_model::occupancy::stops_robot;
use d3dgen_model::placements::Placement;
use d3dgen_model::scenario::{Poi, Roi, RoiKind};
use d3dgen_model::{Polygon, Rect};

use super::floor::{Floor, Room, floor_beside, floor_in_front, lane, swept};
use super::points::{at_object, served};
use super::tour::{self, Stop};

/// Depth of the floor to serve at, m, and the least side of it where something takes a part.
const SERVICE_DEPTH_M: f64 = 1.2;
const LEAST_SERVICE_DEPTH_M: f64 = 0.6;
/// Overlap that is none, m.
const TOUCH_M: f64 = 0.01;
/// Free floor beside a dock that belongs to it, m.
const DOCK_BESIDE_M: f64 = 0.5;
/// Floor inside the doors out of the building on which nobody waits, m.
const INSIDE_EXIT_M: f64 = 1.5;
/// What the floor says that robots stay out of.
pub(crate) const STAY_OUT: &str = "robots stay out";
/// Least side of a region, m.
const LEAST_SIDE_M: f64 = 0.3;

/// Returns all regions, room by room.
pub(crate) fn all(floor: &Floor) -> Vec<Roi> {
    let mut out = Vec::new();
    let mut docks = 0;
    for room in &floor.rooms {
        let id = &room.plan.room_id;
        let buffers: Vec<(&Placement, Rect)> = buffers(floor, room).collect();
        let mut whole = |kind, prefix: &str, note: &str| {
            let polygon = room.plan.net_polygon.clone();
            out.push(Roi::new(format!("{prefix}_{id}"), kind, id, polygon, note.into()));
        };
        if room.keep_out {
            whole(RoiKind::KeepOut, "keep_out", STAY_OUT);
        } else if room.is_for(RobotUse::CleaningHigh) {
            whole(RoiKind::CleaningZone, "cleaning_zone", "high");
        } else if room.is_for(RobotUse::CleaningLow) {
            whole(RoiKind::CleaningZone, "cleaning_zone", "low");
        }
        if room.is_for(RobotUse::Service)
            && !room.keep_out
            && let Some(&(object, kind)) = served(floor, room)
            && let side = at_object(floor, room, (object, kind)).map_or(0, |(side, _)| side)
            && let Some(polygon) = clipped(room, &service_floor(floor, room, (object, side), &buffers))
        {
            let note = if side == 0 { "in front of" } else { "beside" };
            let note = format!("{note} {}", object.placement_id);
            out.push(Roi::new(format!("service_zone_{id}"), RoiKind::ServiceZone, id, polygon, note));
        }
        for (dock, buffer) in &buffers {
            docks += 1;
            if let Some(polygon) = clipped(room, &beside_furniture(room, dock, *buffer)) {
                let note = format!("free floor of {}", dock.placement_id);
                let roi_id = format!("charging_buffer_{docks}");
                out.push(Roi::new(roi_id, RoiKind::ChargingBuffer, id, polygon, note));
            }
        }
    }
    out
}

/// Numbers the floor to be cleaned along a short tour of the storey, from the first dock or the entrance, and says how much
/// of it is free.
pub(crate) fn number(rois: &mut [Roi], floor: &Floor, pois: &[Poi]) {
    let mut zones: Vec<(&mut Roi, &Room)> = Vec::new();
    for roi in rois.iter_mut().filter(|r| r.kind == RoiKind::CleaningZone) {
        if let Some(room) = floor.rooms.iter().find(|r| r.plan.room_id == roi.room_id) {
            zones.push((roi, room));
        }
    }
    let of_kind = |kind: &str| pois.iter().find(|p| p.kind == kind);
    let start = of_kind(Poi::DOCK).or_else(|| of_kind(Poi::ENTRANCE)).map(Stop::of_poi);
    let stops =
        zones.iter().map(|(_, room)| (room.kind.goods, Stop { room: &room.plan.room_id, at: largest(room).center() }));
    let stops: Vec<(Goods, Stop)> = stops.collect();
    let order = tour::in_turn(floor.doors(), start, &stops);
    for (number, i) in order.into_iter().enumerate() {
        let (roi, room) = &mut zones[i];
        roi.order = Some(number as u32 + 1);
        // cells of a grid can have a little more than the outline
        let free = room.free_m2.min(room.plan.net_area_m2);
        roi.free_area_m2 = Some((free * 100.0).floor() / 100.0);
    }
}

/// Returns the largest straight piece of a room's net floor.
pub(crate) fn largest(room: &Room) -> Rect {
    let pieces = room.plan.net_polygon.rects().into_iter();
    pieces.max_by(|a, b| a.area().total_cmp(&b.area())).unwrap_or_else(|| room.plan.net_polygon.bounds())
}

/// Returns the docks of a room with the floor that belongs to each.
pub(crate) fn buffers<'r>(floor: &'r Floor, room: &'r Room) -> impl Iterator<Item = (&'r Placement, Rect)> {
    let docks = room.objects.iter().filter(|(_, kind)| kind.shape == Shape::Dock);
    docks.map(|(dock, kind)| {
        let depth = kind.clearance_front_m.max(2.0 * floor.radius);
        (*dock, floor_in_front(dock, depth, DOCK_BESIDE_M))
    })
}

/// Returns the floor before a dock without what furniture takes beside the lane in which its robot comes.
fn beside_furniture(room: &Room, dock: &Placement, buffer: Rect) -> Rect {
    let own = dock.footprint().bounds().grown(-TOUCH_M);
    let across = quarter(dock.pose.yaw_rad) % 2 == 1;
    let keeps_lane = |r: &Rect| match across {
        true => r.x0 <= own.x0 && own.x1 <= r.x1 && r.y0 == buffer.y0 && r.y1 == buffer.y1,
        false => r.y0 <= own.y0 && own.y1 <= r.y1 && r.x0 == buffer.x0 && r.x1 == buffer.x1,
    };
    let standing = room.objects.iter().map(|(p, _)| *p).filter(|p| stops_robot(p) && p.support.is_none());
    let bodies = standing.filter(|p| p.placement_id != dock.placement_id).map(|p| p.footprint().bounds());
    bodies.fold(buffer, |left, body| {
        if body.overlaps(&left.grown(-TOUCH_M)) {
            beside(left, &body)
                .into_iter()
                .filter(keeps_lane)
                .max_by(|a, b| a.area().total_cmp(&b.area()))
                .unwrap_or(left)
        } else {
            left
        }
    })
}

/// Returns what of a rectangle lies west, east, south and north of another.
fn beside(whole: Rect, taken: &Rect) -> [Rect; 4] {
    [
        Rect { x1: taken.x0, ..whole },
        Rect { x0: taken.x1, ..whole },
        Rect { y1: taken.y0, ..whole },
        Rect { y0: taken.y1, ..whole },
    ]
}

/// Returns the floor where robots serve at an object, so many quarters left of its front, without what stands there, the
/// floor of docks, the swing of doors and the way in from outside, where enough is left.
fn service_floor(floor: &Floor, room: &Room, (object, side): (&Placement, u8), buffers: &[(&Placement, Rect)]) -> Rect {
    let together =
        |p: &Placement| p.placement_id == object.placement_id || p.group.is_some() && p.group == object.group;
    let standing = room.objects.iter().map(|(p, _)| *p).filter(|p| stops_robot(p) && p.support.is_none());
    let bodies = standing.filter(|p| !together(p)).map(|p| p.footprint().bounds());
    let swings = floor.plan.doors.iter().filter_map(|d| swept(d, &room.plan.room_id));
    let own = object.footprint().bounds().grown(TOUCH_M);
    let is_wide =
        |r: &Rect| r.width() >= LEAST_SERVICE_DEPTH_M - TOUCH_M && r.height() >= LEAST_SERVICE_DEPTH_M - TOUCH_M;
    let mut left = floor_beside(object, quarter(object.pose.yaw_rad) + side, SERVICE_DEPTH_M, 0.0);
    let exits = floor.plan.doors_of(&room.plan.room_id).filter(|d| d.room_ids.len() == 1).map(inside);
    for taken in bodies.chain(buffers.iter().map(|(_, r)| *r)).chain(swings).chain(exits) {
        if !taken.overlaps(&left.grown(-TOUCH_M)) {
            continue;
        }
        // what is left still lies before the object
        let parts = beside(left, &taken).into_iter().filter(|r| is_wide(r) && r.overlaps(&own));
        left = parts.max_by(|a, b| a.area().total_cmp(&b.area())).unwrap_or(left);
    }
    left
}

/// Returns the floor inside a door out of the building, with as much outside.
fn inside(door: &Door) -> Rect {
    lane(door, INSIDE_EXIT_M + door.wall_thickness_m / 2.0)
}

/// Returns the largest part of a rectangle that lies on one straight piece of the room's net floor.
pub(crate) fn clipped(room: &Room, r: &Rect) -> Option<Polygon> {
    let parts = room.plan.net_polygon.rects().into_iter().map(|n| Rect {
        x0: to_mm(n.x0.max(r.x0)),
        y0: to_mm(n.y0.max(r.y0)),
        x1: to_mm(n.x1.min(r.x1)),
        y1: to_mm(n.y1.min(r.y1)),
    });
    let parts = parts.filter(|p| p.width() >= LEAST_SIDE_M && p.height() >= LEAST_SIDE_M);
    parts.max_by(|a, b| a.area().total_cmp(&b.area())).map(|p| Polygon(p.corners().to_vec()))
}
