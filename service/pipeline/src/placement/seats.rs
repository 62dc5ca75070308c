//! Seats: the floor that people need to sit down, get up and push a chair back.

use d3dgen_model::domain::Shape;

use super::geom::{Box2, mm};
use super::unit::Part;

/// Depth from the edge of a desk or counter to what stands behind who sits at it, m.
const SEAT_DEPTH_M: f64 = 1.0;
/// Floor behind a chair at a table to push it back on, m.
const PUSH_BACK_M: f64 = 0.25;

/// Returns true for what one person sits on, or several side by side.
pub(super) fn is_seat(shape: Shape) -> bool {
    matches!(shape, Shape::Chair | Shape::SwivelChair | Shape::Stool | Shape::Bench)
}

/// Adds the floor to sit down and get up on behind counters and desks that face away from their user: seats of desks with
/// the user in front have it by the desk's own clearance.
pub(super) fn seats_behind(parts: &[Part], tightness: f64, out: &mut Vec<Box2>) {
    let anchor = &parts[0];
    let (desk, depth) = (anchor.solid.rect, mm(SEAT_DEPTH_M * tightness));
    if !matches!(anchor.object.shape, Shape::Desk | Shape::Counter | Shape::Table) {
        return;
    }
    let behind = parts[1..].iter().filter(|p| is_seat(p.object.shape) && p.quarter == 0 && p.solid.rect.x1 <= desk.x0);
    out.extend(behind.map(|p| p.solid.rect).filter(|seat| seat.x0 > desk.x0 - depth).map(|seat| Box2 {
        x0: desk.x0 - depth,
        x1: seat.x0,
        ..seat
    }));
}

/// Adds the floor to push chairs back on that stand around a table.
pub(super) fn seats_around(parts: &[Part], tightness: f64, out: &mut Vec<Box2>) {
    if !matches!(parts[0].object.shape, Shape::Table | Shape::RoundTable) || !parts[0].solid.stops_robot() {
        return;
    }
    let depth = mm(PUSH_BACK_M * tightness);
    out.extend(parts[1..].iter().filter(|p| p.object.shape == Shape::Chair).map(|seat| {
        let own = seat.solid.rect.turned((4 - seat.quarter) % 4);
        Box2 { x0: own.x0 - depth, x1: own.x0, ..own }.turned(seat.quarter)
    }));
}
