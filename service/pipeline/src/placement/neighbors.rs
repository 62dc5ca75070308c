//! What does not belong side by side: sitting groups and desks, machines and desks, docks and everything that can go
//! elsewhere, plants and the way into a bed.

use d3dgen_model::domain::{Mount, Shape};

use super::docks::is_in_the_way;
use super::geom::Box2;
use super::seats::{beside_beds, is_seat, shuts_in_staff, sits_with_staff};
use super::state::{Placed, State};

/// Floor between people at a desk or table and a table that is none of theirs, and a sofa with legs before it, mm.
const APART: i32 = 700;
const SOFA_APART: i32 = 900;
/// Desks from which on a room has aisles, and how wide what stands beside desks leaves them, mm.
const MANY: usize = 4;
const AISLE: i32 = 700;
/// Floor between a chair at a desk or table and a machine that others use, mm.
const FROM_MACHINE: i32 = 1000;
/// Floor between a sofa and a machine that others use, mm.
const SOFA_FROM_MACHINE: i32 = 600;
/// Floor from the edge of a table at which people sit to what one can do without, mm: a chair, and room to push it back.
const BEHIND_SEATS: i32 = 900;
/// Floor between a counter and seats for those who wait, mm.
const FROM_COUNTER: i32 = 800;
/// Floor between a chair at a table and the swing of a door, mm.
const FROM_SWING: i32 = 250;

/// Returns true for a place where something that a room can do without would be in the way of what stands there.
pub(super) fn disturbs(state: &State, p: &Placed, robot: i32) -> bool {
    // clothes have to go somewhere, a plant has not
    let stores = matches!(p.unit.anchor().object.shape, Shape::Cabinet | Shape::Shelf);
    // a lone seat beside the staff is better than none for those who wait
    let lone_seat = p.unit.parts.len() == 1 && is_seat(p.unit.anchor().object.shape);
    is_in_the_way(state, p, robot)
        || !lone_seat && sits_with_staff(state, p)
        || sits_at_counter(state, p)
        || crowds_desks(state, p)
        || has_machine_beside_sofa(state, p)
        || shuts_in_staff(state, p)
        || sits_in_swing(state, p)
        || stands_behind_seats(state, p)
        || !stores && beside_beds(state, p) > 0.0
}

/// Returns true for seats of those who wait right beside a counter at which others are served.
fn sits_at_counter(state: &State, p: &Placed) -> bool {
    let seat = p.unit.anchor().object.shape;
    if !is_seat(seat) && seat != Shape::Sofa {
        return false;
    }
    let own = p.world(&p.unit.bbox);
    let counters = state.placed.iter().filter(|o| o.unit.anchor().object.shape == Shape::Counter);
    let served = |o: &&Placed| o.unit.parts[1..].iter().any(|part| is_seat(part.object.shape));
    counters.filter(served).any(|o| o.solid(o.unit.anchor()).rect.gap(&own) < FROM_COUNTER)
}

/// Returns true for seats at a table so near to the swing of a door that nobody can push back a chair.
fn sits_in_swing(state: &State, p: &Placed) -> bool {
    let at_table = is_table(p.unit.anchor().object.shape);
    let seats = p.unit.parts.iter().filter(|part| at_table && is_seat(part.object.shape));
    let near = |seat: &Box2| state.space.doors.iter().any(|door| door.swings_in && door.zone.gap(seat) < FROM_SWING);
    seats.map(|part| p.solid(part).rect).any(|seat| near(&seat))
}

/// Returns true for what narrows the floor on which those who sit at a table push their chairs back.
fn stands_behind_seats(state: &State, p: &Placed) -> bool {
    let anchor = p.unit.anchor().object.shape;
    if !p.on_floor() || is_seat(anchor) || is_table(anchor) {
        return false;
    }
    let own = p.world(&p.unit.bbox);
    state.placed.iter().filter(|o| is_table(o.unit.anchor().object.shape)).any(|o| {
        let table = o.solid(o.unit.anchor()).rect;
        let seats = o.unit.parts.iter().filter(|part| is_seat(part.object.shape)).map(|part| o.solid(part).rect);
        seats.map(|seat| behind(&table, seat.center())).any(|floor| floor.overlaps(&own))
    })
}

/// Returns the floor on the side of a table on which somebody sits.
fn behind(table: &Box2, (x, y): (i32, i32)) -> Box2 {
    if x > table.x1 {
        Box2 { x0: table.x1, x1: table.x1 + BEHIND_SEATS, ..*table }
    } else if x < table.x0 {
        Box2 { x0: table.x0 - BEHIND_SEATS, x1: table.x0, ..*table }
    } else if y > table.y1 {
        Box2 { y0: table.y1, y1: table.y1 + BEHIND_SEATS, ..*table }
    } else {
        Box2 { y0: table.y0 - BEHIND_SEATS, y1: table.y0, ..*table }
    }
}

/// Returns true for sitting groups and tables right beside people at desks and tables, for machines behind those who work
/// there, and for all that narrows the aisles between many desks.
fn crowds_desks(state: &State, p: &Placed) -> bool {
    let shapes = || p.unit.parts.iter().filter(|part| part.mount == Mount::Floor).map(|part| part.object.shape);
    if shapes().next().is_none() || shapes().any(is_desk) {
        return false;
    }
    // a visitor's chair belongs to a desk
    let lone_seat = shapes().count() == 1 && shapes().all(is_seat);
    let lounge = !lone_seat && shapes().any(|shape| is_seat(shape) || is_table(shape) || shape == Shape::Sofa);
    let apart = if shapes().any(|shape| shape == Shape::Sofa) { SOFA_APART } else { APART };
    let machine = p.unit.anchor().object.shape == Shape::Appliance;
    let standing = || state.placed.iter().filter(|o| o.support.is_none());
    let many = standing().filter(|o| is_desk(o.unit.anchor().object.shape)).count() >= MANY;
    if !lounge && !machine && !many {
        return false;
    }
    let own = p.world(&p.unit.bbox);
    standing().any(|o| {
        let at_desk = is_desk(o.unit.anchor().object.shape);
        let at_table =
            is_table(o.unit.anchor().object.shape) && o.unit.parts.iter().any(|part| is_seat(part.object.shape));
        (at_desk || at_table)
            && o.unit.parts.iter().any(|part| {
                let (shape, gap) = (part.object.shape, own.gap(&o.solid(part).rect));
                let seat = is_seat(shape);
                lounge && (seat || is_desk(shape)) && gap < apart
                    || machine && seat && gap < FROM_MACHINE
                    || many && at_desk && (seat || is_desk(shape)) && gap < AISLE
            })
    })
}

/// Returns true for a machine right beside a sofa, and for a sofa right beside a machine.
fn has_machine_beside_sofa(state: &State, p: &Placed) -> bool {
    let other = match p.unit.anchor().object.shape {
        Shape::Appliance if p.support.is_none() => Shape::Sofa,
        Shape::Sofa => Shape::Appliance,
        _ => return false,
    };
    let own = p.world(&p.unit.bbox);
    let standing = state.placed.iter().filter(|o| o.on_floor() && o.unit.anchor().object.shape == other);
    standing.map(|o| o.world(&o.unit.bbox)).any(|rect| rect.gap(&own) < SOFA_FROM_MACHINE)
}

fn is_table(shape: Shape) -> bool {
    matches!(shape, Shape::Table | Shape::RoundTable)
}

fn is_desk(shape: Shape) -> bool {
    shape == Shape::Desk
}
