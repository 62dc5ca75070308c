//! What does not belong side by side: sitting groups and desks, machines and desks, docks and everything that can go
//! elsewhere, plants and the way into a bed.

use d3dgen_model::domain::{Mount, Shape};

use super::docks::is_in_the_way;
use super::geom::Box2;
use super::seats::{WayIn, beside_beds, is_seat, sits_with_staff, ways_to_staff};
use super::state::{Placed, State};
use super::unit::{Part, Unit};

/// Floor between people at a desk or table and a table that is none of theirs, and a sofa with legs before it, mm.
const APART: i32 = 700;
const SOFA_APART: i32 = 900;
/// Desks from which on a room has aisles, and how wide what stands beside desks leaves them, mm.
const MANY: usize = 4;
const AISLE: i32 = 700;
/// Floor between a chair at a desk or table and a machine that others use, and that of a room with many desks, mm: all of them
/// come there.
const FROM_MACHINE: i32 = 1000;
const FROM_SHARED_MACHINE: i32 = 1200;
/// Floor between a sofa and a machine that others use, mm.
const SOFA_FROM_MACHINE: i32 = 600;
/// Floor from the edge of a table at which people sit to what one can do without, mm: a chair, and room to push it back.
const BEHIND_SEATS: i32 = 900;
/// Floor between a sofa, its table or an armchair and a table at which people eat with its chairs, mm, what a place loses with
/// less and what it loses besides with none.
const FROM_SOFA: i32 = 600;
pub(crate) const AT_SOFA: f64 = 2.5;
const ON_SOFA: f64 = 2.0;
/// The same where a robot passes between them while a chair is pushed back, and what a place loses with less.
const ROBOT_PAST: i32 = 1000;
const PASSED: f64 = 1.0;
/// Floor between a counter and seats for those who wait, mm.
const FROM_COUNTER: i32 = 800;
/// Floor between a chair at a table and the swing of a door, mm.
const FROM_SWING: i32 = 250;

/// What stands in a room as one unit minds it that the room can do without: looked up once for all places of the unit.
pub(crate) struct Neighbors<'f, 'a, 's> {
    state: &'f State<'a, 's>,
    robot: i32,
    /// What the unit keeps away from, and how far, mm.
    aloof: Vec<(Box2, i32)>,
    /// Floor that it stays off.
    kept: Vec<Box2>,
    /// Ways past counters and desks that it leaves open.
    staffed: Vec<WayIn>,
    /// True for one seat alone, which is better beside the staff than nowhere.
    lone_seat: bool,
    /// True for a table with seats.
    seats_table: bool,
    /// True for what clothes and files go into: they have to go somewhere, a plant has not.
    stores: bool,
}

impl<'f, 'a, 's> Neighbors<'f, 'a, 's> {
    pub fn new(state: &'f State<'a, 's>, unit: &Unit, robot: i32) -> Self {
        let anchor = unit.anchor().object.shape;
        let lone_seat = unit.parts.len() == 1 && is_seat(anchor);
        let mut out = Self {
            state,
            robot,
            aloof: Vec::new(),
            kept: Vec::new(),
            staffed: ways_to_staff(state, lone_seat),
            lone_seat,
            seats_table: is_table(anchor) && has_seats(unit),
            stores: matches!(anchor, Shape::Cabinet | Shape::Shelf),
        };
        out.note_counters(anchor);
        out.note_desks(unit);
        out.note_machines(unit);
        out.note_seats(unit);
        out
    }

    /// Returns true for a place where the unit would be in the way of what stands there.
    pub fn are_disturbed_by(&self, p: &Placed) -> bool {
        let own = p.world(&p.unit.bbox);
        let stands = p.support.is_none();
        is_in_the_way(self.state, p, self.robot)
            || stands && self.aloof.iter().any(|(other, gap)| other.gap(&own) < *gap)
            || stands && self.kept.iter().any(|floor| floor.overlaps(&own))
            || !self.lone_seat && sits_with_staff(self.state, p)
            || self.staffed.iter().any(|way| way.is_shut_by(p))
            || self.seats_table && sits_in_swing(self.state, p)
            || !self.stores && beside_beds(self.state, p) > 0.0
    }

    fn standing(&self) -> impl Iterator<Item = &'f Placed<'a>> + use<'f, 'a, 's> {
        let state = self.state;
        state.placed.iter().filter(|o| o.support.is_none())
    }

    /// Seats of those who wait keep away from a counter at which others are served.
    fn note_counters(&mut self, anchor: Shape) {
        if is_seat(anchor) || anchor == Shape::Sofa {
            let counters = self.state.placed.iter().filter(|o| o.unit.anchor().object.shape == Shape::Counter);
            let served = counters.filter(|o| has_seats(&o.unit));
            self.aloof.extend(served.map(|o| (o.solid(o.unit.anchor()).rect, FROM_COUNTER)));
        }
    }

    /// Sitting groups and tables keep away from people at desks and tables, machines from those who work there, and all that
    /// stands from the aisles between many desks.
    fn note_desks(&mut self, unit: &Unit) {
        let shapes = || unit.parts.iter().filter(|part| part.mount == Mount::Floor).map(|part| part.object.shape);
        if shapes().next().is_none() || shapes().any(is_desk) {
            return;
        }
        // a visitor's chair belongs to a desk
        let alone = shapes().count() == 1 && shapes().all(is_seat);
        let lounge = !alone && shapes().any(|shape| is_seat(shape) || is_table(shape) || shape == Shape::Sofa);
        let apart = if shapes().any(|shape| shape == Shape::Sofa) { SOFA_APART } else { APART };
        let machine = unit.anchor().object.shape == Shape::Appliance;
        let many = self.standing().filter(|o| is_desk(o.unit.anchor().object.shape)).count() >= MANY;
        if !lounge && !machine && !many {
            return;
        }
        for o in self.standing() {
            let at_desk = is_desk(o.unit.anchor().object.shape);
            let at_table = is_table(o.unit.anchor().object.shape) && o.unit.parts.iter().any(part_is_seat);
            if !at_desk && !at_table {
                continue;
            }
            for part in &o.unit.parts {
                let (seat, desk) = (part_is_seat(part), is_desk(part.object.shape));
                let gap = [
                    (lounge && (seat || desk), apart),
                    (machine && seat, if many { FROM_SHARED_MACHINE } else { FROM_MACHINE }),
                    (many && at_desk && (seat || desk), AISLE),
                ];
                if let Some(gap) = gap.iter().filter(|(minds, _)| *minds).map(|(_, gap)| *gap).max() {
                    self.aloof.push((o.solid(part).rect, gap));
                }
            }
        }
    }

    /// Machines and sofas keep away from each other.
    fn note_machines(&mut self, unit: &Unit) {
        let other = match unit.anchor().object.shape {
            Shape::Appliance => Shape::Sofa,
            Shape::Sofa => Shape::Appliance,
            _ => return,
        };
        let standing = self.standing().filter(|o| o.on_floor() && o.unit.anchor().object.shape == other);
        self.aloof.extend(standing.map(|o| (o.world(&o.unit.bbox), SOFA_FROM_MACHINE)));
    }

    /// All but tables and seats stays off the floor on which those who sit at a table push their chairs back.
    fn note_seats(&mut self, unit: &Unit) {
        let anchor = unit.anchor().object.shape;
        let on_floor = unit.parts.iter().any(|part| part.mount == Mount::Floor && part.solid.stops_robot());
        if !on_floor || is_seat(anchor) || is_table(anchor) {
            return;
        }
        for o in self.state.placed.iter().filter(|o| is_table(o.unit.anchor().object.shape)) {
            let table = o.solid(o.unit.anchor()).rect;
            let seats = o.unit.parts.iter().filter(|part| part_is_seat(part)).map(|part| o.solid(part).rect);
            self.kept.extend(seats.map(|seat| behind(&table, seat.center())));
        }
    }
}

/// Returns what the place of a table with its chairs loses that is squeezed in beside a sofa, its table or an armchair.
pub(crate) fn beside_sofas(state: &State, p: &Placed) -> f64 {
    if !is_table(p.unit.anchor().object.shape) || !has_seats(&p.unit) {
        return 0.0;
    }
    let stands = |part: &&Part| part.mount == Mount::Floor && part.solid.stops_robot();
    let rects = |o: &Placed| o.unit.parts.iter().filter(stands).map(|part| o.solid(part).rect).collect::<Vec<_>>();
    let own = rects(p);
    let sofas = state.placed.iter().filter(|o| o.unit.anchor().object.shape == Shape::Sofa);
    let gaps = sofas.flat_map(rects).flat_map(|sofa| own.iter().map(move |r| r.gap(&sofa)).collect::<Vec<_>>());
    match gaps.min().unwrap_or(ROBOT_PAST) {
        // a robot passes behind those who eat
        gap if gap >= FROM_SOFA && state.has_robots => {
            PASSED * f64::from((ROBOT_PAST - gap).max(0)) / f64::from(ROBOT_PAST - FROM_SOFA)
        }
        gap if gap >= FROM_SOFA => 0.0,
        gap => AT_SOFA + ON_SOFA * f64::from(FROM_SOFA - gap) / f64::from(FROM_SOFA),
    }
}

/// Returns true for seats at a table so near to the swing of a door that nobody can push back a chair.
fn sits_in_swing(state: &State, p: &Placed) -> bool {
    let near = |seat: &Box2| state.space.doors.iter().any(|door| door.swings_in && door.zone.gap(seat) < FROM_SWING);
    p.unit.parts.iter().filter(|part| part_is_seat(part)).map(|part| p.solid(part).rect).any(|seat| near(&seat))
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

/// Returns true for what comes with seats beside or around it.
fn has_seats(unit: &Unit) -> bool {
    unit.parts[1..].iter().any(part_is_seat)
}

fn part_is_seat(part: &Part) -> bool {
    is_seat(part.object.shape)
}

fn is_table(shape: Shape) -> bool {
    matches!(shape, Shape::Table | Shape::RoundTable)
}

fn is_desk(shape: Shape) -> bool {
    shape == Shape::Desk
}
