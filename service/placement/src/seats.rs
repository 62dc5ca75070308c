//! Seats and beds: the floor that people need to sit down, get up, push a chair back and get to the side of a bed.

use d3dgen_model::domain::{Mount, Shape};

use super::geom::{Box2, mm};
use super::state::{Placed, State};
use super::unit::Part;

/// Depth from the edge of a desk or counter to what stands behind who sits at it, m.
const SEAT_DEPTH_M: f64 = 1.0;
/// Floor behind a chair at a table to push it back on, m.
const PUSH_BACK_M: f64 = 0.25;
/// Floor before the foot of a bed and beside it through which one gets to a long side, m.
const FOOT_M: f64 = 0.45;
/// What a place loses that closes one of them.
const CLOSED_SIDE: f64 = 4.0;
/// How far aside of a counter one no longer sits on its staff's side, mm.
const FROM_STAFF: i32 = 1200;

/// Width of a way past a counter to its staff's side, beside a lone seat, and how far behind the counter it goes on, mm.
const PAST: i32 = 850;
const PAST_SEAT: i32 = 650;
const PAST_BEHIND: i32 = 500;
/// Width of a way past a desk to its user's seat, before and behind its edge, mm.
const PAST_DESK: i32 = 750;

/// Returns true for what one person sits on, or several side by side.
pub(crate) fn is_seat(shape: Shape) -> bool {
    matches!(shape, Shape::Chair | Shape::SwivelChair | Shape::Stool | Shape::Bench)
}

/// Adds the floor to sit down and get up on behind counters and desks that face away from their user: seats of desks with
/// the user in front have it by the desk's own clearance.
pub(crate) fn seats_behind(parts: &[Part], tightness: f64, out: &mut Vec<Box2>) {
    let anchor = &parts[0];
    let (desk, depth) = (anchor.solid.rect, mm(SEAT_DEPTH_M * tightness));
    if !matches!(anchor.object.shape, Shape::Desk | Shape::Counter | Shape::Table) {
        return;
    }
    for seat in staffed_from(parts).filter(|seat| seat.x0 > desk.x0 - depth) {
        let back = desk.x0 - depth;
        if anchor.object.shape != Shape::Counter {
            out.push(Box2 { x0: back, x1: seat.x0, ..seat });
            continue;
        }
        // whoever serves at a counter moves along it, to both sides of the chair
        out.push(Box2 { x0: back, x1: seat.x0, ..desk });
        out.push(Box2 { x0: seat.x0, x1: desk.x0, y0: desk.y0, y1: seat.y0 });
        out.push(Box2 { x0: seat.x0, x1: desk.x0, y0: seat.y1, y1: desk.y1 });
    }
}

/// Returns the seats of those who sit behind a desk or counter that faces away from them.
fn staffed_from<'p>(parts: &'p [Part]) -> impl Iterator<Item = Box2> + 'p {
    let edge = parts[0].solid.rect.x0;
    let behind = move |p: &&Part| is_seat(p.object.shape) && p.quarter == 0 && p.solid.rect.x1 <= edge;
    parts[1..].iter().filter(behind).map(|p| p.solid.rect)
}

/// The floor over which whoever works at a desk or counter gets to the side to work at.
pub(crate) struct WayIn {
    /// Past either end of it and of what stands beside it: one of them is enough.
    ends: Vec<Box2>,
    /// From the ends on to the seat of a desk.
    on: Option<Box2>,
}

impl WayIn {
    /// Returns true for a place that closes what is left of it.
    pub fn is_shut_by(&self, p: &Placed) -> bool {
        self.on.as_ref().is_some_and(|on| stands_on(p, on))
            || !self.ends.is_empty() && self.ends.iter().all(|end| stands_on(p, end))
    }
}

/// Returns true for a place that takes some of this floor from people.
fn stands_on(p: &Placed, floor: &Box2) -> bool {
    let stands = |part: &&Part| part.mount == Mount::Floor && part.solid.stops_robot();
    // parts that stand are within the outline
    p.world(&p.unit.bbox).overlaps(floor)
        && p.unit.parts.iter().filter(stands).any(|part| p.solid(part).rect.overlaps(floor))
}

/// Returns the way to where one works at a desk or counter; `past` is its width at the ends of a counter. `None` where
/// nobody works behind it.
fn way_in(desk: &Placed, past: i32) -> Option<WayIn> {
    let (unit, look) = (&desk.unit, desk.unit.look());
    let (wide, behind) = if look == 0 { (past, PAST_BEHIND) } else { (PAST_DESK, PAST_DESK) };
    if look == 0 {
        staffed_from(&unit.parts).next()?;
    }
    let q = (desk.q + look) % 4;
    let in_view = |part: &Part| desk.world(&part.solid.rect).turned((4 - q) % 4);
    let anchor = in_view(unit.anchor());
    let stands = |part: &&Part| part.mount == Mount::Floor && part.solid.stops_robot();
    let beside = |rect: &Box2| rect.x0 < anchor.x1 && rect.x1 > anchor.x0;
    let own = unit.parts.iter().filter(stands).map(in_view).filter(beside).fold(anchor, |own, part| own.union(&part));
    let end = |y0| Box2 { x0: anchor.x0 - behind, x1: anchor.x1, y0, y1: y0 + wide }.turned(q);
    let on = Box2 { x0: anchor.x0 - behind, x1: anchor.x0, ..own }.turned(q);
    Some(WayIn { ends: vec![end(own.y0 - wide), end(own.y1)], on: (look != 0).then_some(on) })
}

/// Returns true for a desk or counter past which one gets to its user's side nowhere.
pub(crate) fn has_no_way_past(state: &State, desk: &Placed) -> bool {
    way_in(desk, PAST).is_some_and(|way| !way.ends.iter().any(|end| is_way(state, end)))
}

/// Returns true when one gets over this floor.
fn is_way(state: &State, way: &Box2) -> bool {
    state.space.contains(way) && !state.solids.iter().any(|s| s.stops_robot() && s.rect.overlaps(way))
}

/// Returns the ways past counters and desks that are open as things stand; a `lone_seat` for those who wait may leave less.
pub(crate) fn ways_to_staff(state: &State, lone_seat: bool) -> Vec<WayIn> {
    let wide = if lone_seat { PAST_SEAT } else { PAST };
    let mut ways: Vec<WayIn> = state.placed.iter().filter_map(|desk| way_in(desk, wide)).collect();
    ways.iter_mut().for_each(|way| way.ends.retain(|end| is_way(state, end)));
    ways
}

/// Returns the floor at the foot of a bed through which one gets to its long sides.
pub(crate) fn ways_beside(bed: &Placed) -> Option<[Box2; 2]> {
    let anchor = bed.unit.anchor();
    if anchor.object.shape != Shape::Bed {
        return None;
    }
    let own = bed.world(&anchor.solid.rect).turned((4 - bed.q) % 4);
    let wide = mm(FOOT_M);
    let way = |y0| Box2 { x0: own.x1, x1: own.x1 + wide, y0, y1: y0 + wide }.turned(bed.q);
    Some([way(own.y0 - wide), way(own.y1)])
}

/// Returns how much a place loses that closes the way to a long side of a bed.
pub(crate) fn beside_beds(state: &State, p: &Placed) -> f64 {
    CLOSED_SIDE * state.beside_beds.iter().filter(|way| stands_on(p, way)).count() as f64
}

/// Returns true for a place for visitors to sit that lies on the staff's side of a counter.
pub(crate) fn sits_with_staff(state: &State, p: &Placed) -> bool {
    let seat = p.unit.anchor().object.shape;
    if !is_seat(seat) && seat != Shape::Sofa {
        return false;
    }
    let staffed =
        |c: &&Placed| c.unit.anchor().object.shape == Shape::Counter && staffed_from(&c.unit.parts).next().is_some();
    let behind = |c: &Placed| {
        let back = (4 - c.q) % 4;
        let [own, counter] = [p, c].map(|placed| placed.world(&placed.unit.anchor().solid.rect).turned(back));
        let aside = (own.y0 - counter.y1).max(counter.y0 - own.y1);
        own.center().0 < counter.x0 && aside < FROM_STAFF
    };
    state.placed.iter().filter(staffed).any(behind)
}

/// Adds the floor to push chairs back on that stand around a table.
pub(crate) fn seats_around(parts: &[Part], tightness: f64, out: &mut Vec<Box2>) {
    if !matches!(parts[0].object.shape, Shape::Table | Shape::RoundTable) || !parts[0].solid.stops_robot() {
        return;
    }
    let depth = mm(PUSH_BACK_M * tightness);
    let chair = |p: &&Part| matches!(p.object.shape, Shape::Chair | Shape::SwivelChair);
    out.extend(parts[1..].iter().filter(chair).map(|seat| {
        let own = seat.solid.rect.turned((4 - seat.quarter) % 4);
        Box2 { x0: own.x0 - depth, x1: own.x0, ..own }.turned(seat.quarter)
    }));
}
