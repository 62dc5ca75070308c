//! Docks: the floor that a charging robot and its way in take, kept out of the swing of doors and free of furniture, rugs
//! and queues.

use d3dgen_model::domain::Shape;

use super::geom::{Box2, Solid, mm};
use super::space::{DoorZone, Space};
use super::state::{Placed, State};

/// Floor beside a dock that belongs to it, mm; as in the charging buffers of scenarios.
const BESIDE: i32 = 500;
/// How far before its place at a dock a robot turns towards it, mm: the staging offset of nav2's docking server,
/// <https://docs.nav2.org/configuration/packages/configuring-docking-server.html>.
const DRIVE_UP: i32 = 700;
/// From the front of a dock to the middle of a robot before it, mm.
const BERTH: i32 = 400;
/// Floor between two robots that charge side by side, mm.
const PLAY: i32 = 50;
/// What a dock loses in whose floor a leaf swings: more than any place has to offer.
const SWING: f64 = 8.0;
/// What it loses where people only pass.
const PASSAGE: f64 = 4.0;

/// How far from the doors out of the building a dock and its floor keep, mm, and what it loses right at one: people with
/// bags come in there, and leave in a hurry.
pub(crate) const FROM_EXIT: i32 = 2000;
const EXIT: f64 = 10.0;
/// Rank of doors from which on they lead to other rooms.
const INDOORS: u8 = 2;
/// What a dock loses where two corridors meet, how far both go on from the robot there, and how wide they are at least, mm.
const CROSSING: f64 = 6.0;
const ARM: i32 = 2600;
const LEAST_ARM: i32 = 400;
/// What a place loses that takes floor of a dock, or that has something on its own.
const CROWDED: f64 = 3.0;
/// What it loses where people stand to use something.
const USED: f64 = 3.0;
/// Floor ahead of a charging robot on which people pass, mm, and what a dock loses where something stands on it.
const AHEAD: i32 = 900;
const NARROW: f64 = 1.5;
/// Height up to which something is on the floor, mm.
const LOW: i32 = 300;

/// Returns a spot before each dock of a unit where the robot it is for stands.
pub(crate) fn berths<'p>(p: &'p Placed) -> impl Iterator<Item = Box2> + 'p {
    fronts(p).map(|(q, own, _)| {
        let (x, y) = (own.x1 + BERTH, (own.y0 + own.y1) / 2);
        Box2 { x0: x, y0: y, x1: x, y1: y }.turned(q)
    })
}

/// Returns the floor before the docks of a unit: as deep as their clearance and as a robot needs, mm.
pub(crate) fn buffers<'p>(p: &'p Placed, robot: i32) -> impl Iterator<Item = Box2> + 'p {
    before(p, robot)
}

/// Returns the floor before the docks of a unit from where a robot begins to drive up to it, mm.
pub(crate) fn approaches<'p>(p: &'p Placed, robot: i32) -> impl Iterator<Item = Box2> + 'p {
    before(p, robot + DRIVE_UP)
}

/// Returns the floor before and beside the docks of a unit: as deep as their clearance, and as is given at least, mm.
fn before<'p>(p: &'p Placed, least: i32) -> impl Iterator<Item = Box2> + 'p {
    fronts(p).map(move |(q, own, clearance)| {
        let depth = clearance.max(least);
        Box2 { x0: own.x0, x1: own.x1 + depth, y0: own.y0 - BESIDE, y1: own.y1 + BESIDE }.turned(q)
    })
}

/// Returns the floor ahead of that, on which one passes a robot that charges.
fn passages<'p>(p: &'p Placed, robot: i32) -> impl Iterator<Item = Box2> + 'p {
    fronts(p).map(move |(q, own, clearance)| {
        let front = own.x1 + clearance.max(robot);
        Box2 { x0: front, x1: front + AHEAD, y0: own.y0, y1: own.y1 }.turned(q)
    })
}

/// Returns each dock's heading, its outline turned back by it, and the clearance it asks for in front, mm.
fn fronts<'p>(p: &'p Placed) -> impl Iterator<Item = (u8, Box2, i32)> + 'p {
    let docks = p.unit.parts.iter().filter(|part| part.object.shape == Shape::Dock);
    docks.map(|part| {
        let q = (p.q + part.quarter) % 4;
        (q, p.solid(part).rect.turned((4 - q) % 4), mm(part.object.clearance_front_m))
    })
}

/// Returns how much a place for a unit loses because something takes the floor of a dock that stands or of its own,
/// because people have to stand in its own, because a wall beside its dock leaves the robot no play, or because nobody
/// passes a robot that charges.
pub(crate) fn crowding(state: &State, p: &Placed, robot: i32) -> f64 {
    let others = state.docks.iter().filter(|b| takes(p, b)).count() as f64;
    let shared = |b: &Box2| state.docks.iter().any(|other| other.overlaps(b));
    let crowded = |b: &Box2| CROWDED * f64::from(is_taken(state, b) || shared(b)) + USED * f64::from(is_used(state, b));
    let walled = |berth: &Box2| !state.space.contains(&berth.grown(robot / 2));
    let corners = berths(p).filter(walled).count() as f64;
    let narrow = passages(p, robot).filter(|b| is_taken(state, b) || !state.space.contains(b)).count() as f64;
    CROWDED * (others + corners) + NARROW * narrow + buffers(p, robot).map(|b| crowded(&b)).sum::<f64>()
}

/// Returns how far from each other the middles of robots that charge side by side are at least, mm.
pub(crate) fn beside_berth(robot: i32) -> i32 {
    robot + PLAY
}

/// Returns true for a dock whose robot would touch one that charges beside it, or that one of the two could not leave while
/// the other charges.
pub(crate) fn touches_robot(state: &State, p: &Placed, robot: i32) -> bool {
    if fronts(p).next().is_none() {
        return false;
    }
    let stands = || state.placed.iter().flat_map(berths);
    let touches = berths(p).any(|own| stands().any(|other| other.gap(&own) < beside_berth(robot)));
    let shut = |own: &Placed, other: &Placed| {
        leaving(own, robot, 2).any(|way| leaving(other, robot, 1).any(|parked| parked.overlaps(&way)))
    };
    touches || state.placed.iter().any(|other| shut(p, other) || shut(other, p))
}

/// Returns the floor before each dock of a unit that is so many robots deep: where one stands, and where it drives off.
fn leaving(p: &Placed, robot: i32, deep: i32) -> impl Iterator<Item = Box2> {
    let docks: Vec<(u8, Box2, i32)> = fronts(p).collect();
    docks.into_iter().map(move |(q, own, _)| {
        let middle = (own.y0 + own.y1) / 2;
        let side = robot / 2;
        Box2 { x0: own.x1, x1: own.x1 + deep * robot, y0: middle - side, y1: middle + side }.turned(q)
    })
}

/// Returns true for a place that takes floor of a dock, or for a dock whose floor is taken or used where no robot needs it;
/// docks share theirs.
pub(crate) fn is_in_the_way(state: &State, p: &Placed, robot: i32) -> bool {
    if fronts(p).next().is_some() {
        return !state.has_robots && buffers(p, robot).any(|b| is_taken(state, &b) || is_used(state, &b));
    }
    state.docks.iter().any(|b| takes(p, b))
}

/// Returns true for a place that takes some of this floor.
fn takes(p: &Placed, floor: &Box2) -> bool {
    p.unit.parts.iter().map(|part| p.solid(part)).any(|s| is_on_floor(&s) && s.rect.overlaps(floor))
}

/// Returns true where something stands or lies on this floor.
fn is_taken(state: &State, floor: &Box2) -> bool {
    state.solids.iter().any(|s| is_on_floor(s) && s.rect.overlaps(floor))
}

/// Returns true where people have to stand on this floor to use something.
fn is_used(state: &State, floor: &Box2) -> bool {
    state.clears.iter().any(|c| c.overlaps(floor))
}

/// Returns true for what a wheel or a foot meets: furniture, rugs.
fn is_on_floor(s: &Solid) -> bool {
    s.z0 < LOW
}

/// Returns true for a spot in a room with a corner from which one sees far both along and across it: two ways meet there.
fn is_crossing(space: &Space, spot: &Box2) -> bool {
    let (x, y) = spot.center();
    let arm = |dx: i32, dy: i32| {
        let along = Box2::new(x, y, x + dx * ARM, y + dy * ARM);
        let side = LEAST_ARM / 2;
        let [sx, sy] = [dy.abs() * side, dx.abs() * side];
        space.contains(&Box2 { x0: along.x0 - sx, x1: along.x1 + sx, y0: along.y0 - sy, y1: along.y1 + sy })
    };
    let cornered = space.floor_rects().len() > 1;
    cornered && (arm(1, 0) || arm(-1, 0)) && (arm(0, 1) || arm(0, -1))
}

/// Returns how much a place for a unit loses by doors that open into the floor of its docks, by those out of the building
/// near it, and by ways that meet there; 0 for other units.
pub(crate) fn door_loss(space: &Space, p: &Placed, robot: i32) -> f64 {
    let loss = |b: &Box2, d: &DoorZone| match d.zone.overlaps(b) {
        true if d.swings_in => SWING,
        true => PASSAGE,
        false => 0.0,
    };
    let exit = |b: &Box2, d: &DoorZone| {
        let gap = space.walls[d.wall].strip(d.v0, d.v1, 0, 1).gap(b);
        EXIT * f64::from((FROM_EXIT - gap).max(0)) / f64::from(FROM_EXIT)
    };
    let exits = || space.doors.iter().filter(|d| d.rank < INDOORS);
    let of = |b: &Box2| {
        space.doors.iter().map(|d| loss(b, d)).fold(0.0, f64::max) + exits().map(|d| exit(b, d)).fold(0.0, f64::max)
    };
    let crossings = berths(p).filter(|b| is_crossing(space, b)).count() as f64;
    CROSSING * crossings + buffers(p, robot).map(|b| of(&b)).sum::<f64>()
}
