//! What does not belong side by side: sitting groups and desks, machines and desks, docks and everything that can go
//! elsewhere, plants and the way into a bed.

use d3dgen_model::domain::{Mount, Shape};

use super::docks::is_in_the_way;
use super::seats::{beside_beds, is_seat};
use super::state::{Placed, State};

/// Floor between a desk with its chair and a sitting group or table that is none of its, mm.
const APART: i32 = 450;
/// Floor between a chair at a desk and a machine that others use, mm.
const FROM_MACHINE: i32 = 1000;

/// Returns true for a place where something that a room can do without would be in the way of what stands there.
pub(super) fn disturbs(state: &State, p: &Placed, robot: i32) -> bool {
    // clothes have to go somewhere, a plant has not
    let stores = matches!(p.unit.anchor().object.shape, Shape::Cabinet | Shape::Shelf);
    // a lone seat at the side of a dock is better than none for those who wait
    let lone_seat = p.unit.parts.len() == 1 && is_seat(p.unit.anchor().object.shape);
    !lone_seat && is_in_the_way(state, p, robot) || crowds_desks(state, p) || !stores && beside_beds(state, p) > 0.0
}

/// Returns true for sitting groups and tables right beside desks, and for machines behind those who work there.
fn crowds_desks(state: &State, p: &Placed) -> bool {
    let sits = |shape: Shape| is_seat(shape) || matches!(shape, Shape::Sofa | Shape::Table | Shape::RoundTable);
    let shapes = || p.unit.parts.iter().filter(|part| part.mount == Mount::Floor).map(|part| part.object.shape);
    // a visitor's chair belongs to a desk
    let lounge = shapes().any(sits) && !(shapes().count() == 1 && shapes().all(is_seat)) && !shapes().any(is_desk);
    let machine = p.unit.anchor().mount == Mount::Floor && p.unit.anchor().object.shape == Shape::Appliance;
    if !lounge && !machine {
        return false;
    }
    let own = p.world(&p.unit.bbox);
    let desks = state.placed.iter().filter(|o| is_desk(o.unit.anchor().object.shape) && o.support.is_none());
    desks.flat_map(|o| o.unit.parts.iter().map(move |part| (part.object.shape, o.solid(part).rect))).any(
        |(shape, rect)| {
            let near = |least: i32| own.gap(&rect) < least;
            lounge && (is_desk(shape) || is_seat(shape)) && near(APART)
                || machine && is_seat(shape) && near(FROM_MACHINE)
        },
    )
}

fn is_desk(shape: Shape) -> bool {
    shape == Shape::Desk
}
