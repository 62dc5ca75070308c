//! Docks: the floor that a charging robot and its way in take, kept out of the swing of doors.

use d3dgen_model::domain::Shape;

use super::geom::Box2;
use super::space::{DoorZone, Space};
use super::state::Placed;

/// Floor beside a dock that belongs to it, mm; as in the charging buffers of scenarios.
const BESIDE: i32 = 500;
/// What a dock loses in whose floor a leaf swings: more than any place has to offer.
const SWING: f64 = 8.0;
/// What it loses where people only pass.
const PASSAGE: f64 = 4.0;

/// Returns the floor before the docks of a unit: as deep as their clearance and as a robot needs, mm.
pub(super) fn buffers<'p>(p: &'p Placed, robot: i32) -> impl Iterator<Item = Box2> + 'p {
    let docks = p.unit.parts.iter().filter(|part| part.object.shape == Shape::Dock);
    docks.map(move |part| {
        let q = (p.q + part.quarter) % 4;
        let own = p.solid(part).rect.turned((4 - q) % 4);
        let depth = ((part.object.clearance_front_m * 1000.0).round() as i32).max(robot);
        Box2 { x0: own.x0, x1: own.x1 + depth, y0: own.y0 - BESIDE, y1: own.y1 + BESIDE }.turned(q)
    })
}

/// Returns how much a place for a unit loses by doors that open into the floor of its docks; 0 for other units.
pub(super) fn door_loss(space: &Space, p: &Placed, robot: i32) -> f64 {
    let loss = |b: &Box2, d: &DoorZone| match d.zone.overlaps(b) {
        true if d.swings_in => SWING,
        true => PASSAGE,
        false => 0.0,
    };
    buffers(p, robot).map(|b| space.doors.iter().map(|d| loss(&b, d)).fold(0.0, f64::max)).sum()
}
