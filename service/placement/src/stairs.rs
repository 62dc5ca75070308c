//! The flights of a stairwell: they fill it from wall to wall, all but the landing at its door.

use std::f64::consts::{FRAC_PI_2, PI};

use d3dgen_model::domain::{Domain, Mount};
use d3dgen_model::floorplan::{Floorplan, PlanRoom};
use d3dgen_model::geometry::to_mm;
use d3dgen_model::placements::Placement;
use d3dgen_model::storeys::LinkKind;
use d3dgen_model::{Pose, Rect};

use super::assemble::asset;

/// Thickest wall around a stairwell, m.
const WALL_M: f64 = 0.35;

/// Returns the rectangle between the walls of a room: where a wall is thicker along a part of a side, clear of that part.
fn clear(room: &PlanRoom) -> Rect {
    let axes = room.polygon.bounds();
    let corners = room.net_polygon.corners();
    let inside = |axis: f64, sign: f64, of: fn(&d3dgen_model::Point) -> f64| {
        let depth = corners.iter().map(|p| sign * (of(p) - axis)).filter(|d| *d < WALL_M).fold(0.0, f64::max);
        to_mm(axis + sign * depth)
    };
    Rect {
        x0: inside(axes.x0, 1.0, |p| p.x),
        y0: inside(axes.y0, 1.0, |p| p.y),
        x1: inside(axes.x1, -1.0, |p| p.x),
        y1: inside(axes.y1, -1.0, |p| p.y),
    }
}

/// Returns the flights that go up from a room, or `None` where none do: other rooms, and the highest storey.
pub(crate) fn flights(plan: &Floorplan, room: &PlanRoom, domain: &Domain) -> Option<Placement> {
    let rules = &domain.circulation.storeys.as_ref()?.stairs;
    let link = plan.link_of(&room.room_id).filter(|l| l.kind == LinkKind::Stairs)?;
    let goes_up = link.room_ids.last() != Some(&room.room_id);
    let height = plan.levels.iter().find(|l| l.level == room.level).filter(|_| goes_up)?.height_m;
    let object = domain.object(&rules.object)?;
    let door = plan.doors_of(&room.room_id).next()?;
    let net = clear(room);
    let (middle, center) = (door.line.middle(), net.center());
    let landing = rules.floor_before_m();
    // the front of the flights looks at the door
    let (rect, yaw_rad) = match (door.line.is_vertical(), middle.x < center.x, middle.y < center.y) {
        (true, true, _) => (Rect { x0: net.x0 + landing, ..net }, PI),
        (true, false, _) => (Rect { x1: net.x1 - landing, ..net }, 0.0),
        (false, _, true) => (Rect { y0: net.y0 + landing, ..net }, -FRAC_PI_2),
        (false, _, false) => (Rect { y1: net.y1 - landing, ..net }, FRAC_PI_2),
    };
    let (width, depth) =
        if door.line.is_vertical() { (rect.height(), rect.width()) } else { (rect.width(), rect.height()) };
    let center = rect.center();
    Some(Placement {
        placement_id: format!("{}_{}_1", room.room_id, object.id),
        room_id: room.room_id.clone(),
        object: object.id.clone(),
        asset: asset(domain, object),
        asset_choice: None,
        pose: Pose { x: to_mm(center.x), y: to_mm(center.y), z: 0.0, yaw_rad },
        size_m: [to_mm(width), to_mm(depth), to_mm(height)],
        mount: Mount::Floor,
        support: None,
        group: None,
        rule: format!("the flights of a stairwell ({})", rules.source),
        locked: false,
    })
}
