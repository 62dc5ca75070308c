//! A room while it is being furnished: what stands where, and whether one more thing may stand there.

use std::cell::RefCell;
use std::rc::Rc;

use d3dgen_knowledge::clearance::HEAD_ROOM_M;
use d3dgen_model::domain::{Mount, Shape};

use super::docks::{approaches, berths, buffers};
use super::geom::{Box2, Solid, mm, turn};
use super::nav::Nav;
use super::pockets::Pockets;
use super::seats::ways_beside;
use super::space::{DoorZone, Open, Space, WallSide};
use super::turning::Circle;
use super::unit::{Part, Unit};
use super::way::{InTheWay, Way};

/// Height up to which things leave the sight of a screen free, mm: coffee tables.
const LOW: i32 = 500;
/// Height over the rim of a basin up to which nothing hangs but what came with it, mm: hands, taps, and the face in the mirror.
const OVER_BASIN: i32 = 1200;
/// How far from the wall behind it the head of a bed is at most, mm.
const HEAD_TO_WALL: i32 = 300;
/// How far from a wall what hangs on it may be, mm.
const AT_WALL: i32 = 5;

/// A hard rule that a position can break.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Rule {
    /// No wall, corner, window, door or surface of the wished kind.
    NoPlace,
    /// Not on the net floor or not under the ceiling.
    Outside,
    /// On floor a door needs.
    Door,
    /// Taller than the sill in front of a window.
    Window,
    /// Shares space with another object.
    Collision,
    /// Takes or lacks the free floor something needs to be used.
    Clearance,
    /// Cuts the robot off from a door, an object or part of the floor.
    Route,
}

impl Rule {
    /// Returns the id of the hard rule of finished worlds that stands behind it.
    pub fn id(self) -> &'static str {
        match self {
            Self::NoPlace => "object_back",
            Self::Outside => "object_outside",
            Self::Door => "door_blocked",
            Self::Window => "window_blocked",
            Self::Collision => "object_collision",
            Self::Clearance => "object_clearance",
            Self::Route => "free_space_split",
        }
    }

    /// Returns what the rule demands, for people.
    pub fn text(self) -> &'static str {
        match self {
            Self::NoPlace => "the room has no suitable wall, corner, window, door or surface for it",
            Self::Outside => "no wall or floor of the room is large enough",
            Self::Door => "it would stand in the floor a door needs",
            Self::Window => "it would stand in front of a window above its sill",
            Self::Collision => "other objects take the space",
            Self::Clearance => "there is not enough free floor to use it and its neighbors",
            Self::Route => "a robot could no longer reach a door, an object or part of the floor",
        }
    }
}

/// A unit at a position.
#[derive(Debug, Clone)]
pub(crate) struct Placed<'a> {
    pub unit: Rc<Unit<'a>>,
    /// Heading of the anchor and world position of the unit's origin.
    pub q: u8,
    pub at: (i32, i32),
    /// True for units of the first furnishing line: what the room is about.
    pub first_line: bool,
    /// Index of the task that asked for it.
    pub task: usize,
    /// The object it stands on: placed unit and part.
    pub support: Option<(usize, usize)>,
    /// Height of the unit's floor.
    pub z: i32,
}

impl Placed<'_> {
    /// Returns true when the other is the same unit at the same position.
    pub fn is_as(&self, other: &Self) -> bool {
        let place = |p: &Self| (p.q, p.at, p.z, p.support, p.task);
        place(self) == place(other) && (Rc::ptr_eq(&self.unit, &other.unit) || self.unit == other.unit)
    }

    /// Returns true for a bed that is no better off: under a window too, or with fewer things beside it.
    pub fn is_less_than(&self, other: &Self, state: &State) -> bool {
        self.unit.parts.len() < other.unit.parts.len() || state.lies_under_window(self)
    }

    /// Returns a rectangle of the unit in the world.
    pub fn world(&self, local: &Box2) -> Box2 {
        local.turned(self.q).shifted(self.at.0, self.at.1)
    }

    /// Returns a part's box in the world.
    pub fn solid(&self, part: &Part) -> Solid {
        Solid { rect: self.world(&part.solid.rect), z0: part.solid.z0 + self.z, z1: part.solid.z1 + self.z }
    }

    /// Returns what must be reachable for the unit to be of use: where robots stand at its docks, the free floor it asks
    /// for, or its outline.
    pub fn targets(&self) -> Vec<Box2> {
        let berths: Vec<Box2> = berths(self).collect();
        if !berths.is_empty() {
            return berths;
        }
        if self.unit.clears.is_empty() {
            return vec![self.world(&self.unit.bbox)];
        }
        self.unit.clears.iter().map(|c| self.world(c)).collect()
    }

    /// Returns true when a person or robot comes up to it on the floor.
    pub fn on_floor(&self) -> bool {
        self.support.is_none() && self.unit.parts.iter().any(|p| p.mount == Mount::Floor && p.solid.stops_robot())
    }
}

/// A room with what has been placed so far.
#[derive(Debug, Clone)]
pub(crate) struct State<'a, 's> {
    pub space: &'s Space,
    pub placed: Vec<Placed<'a>>,
    pub solids: Vec<Solid>,
    /// Room over basins that nothing else may take.
    basins: Vec<Solid>,
    pub clears: Vec<Box2>,
    /// Outlines of what takes floor: not what is flat, hangs high or flat on a wall.
    pub bodies: Vec<Box2>,
    in_the_way: InTheWay,
    /// True where robots are to live: a dock in the way is better than none.
    pub has_robots: bool,
    /// Radius of the circle that rules want free for wheelchairs, mm; none where the empty room has no place for it.
    turning: Option<i32>,
    /// Where one is free still.
    circle: Option<Circle>,
    /// Floor that belongs to docks.
    pub docks: Vec<Box2>,
    /// Where robots stand at them, and true while each of them can leave past all others.
    berths: Vec<Box2>,
    berths_open: bool,
    /// Floor at the foot of beds through which one gets to their sides.
    pub beside_beds: Vec<Box2>,
    /// Floor between screens and boards and those who look at them, and how high what stands there may be, mm.
    sights: Vec<(Box2, i32)>,
    nav: Nav,
    /// Floor that is free for a small robot.
    pub pockets: Pockets,
    /// What is kept free before doors and windows.
    pub open: Open,
    /// Memory for testing routes.
    spare: RefCell<Option<Nav>>,
    targets: Vec<Vec<Box2>>,
    /// Floor that people with bags pass over on their way to many desks, and where each of these is come to.
    access: Option<Nav>,
    spare_access: RefCell<Option<Nav>>,
    desks: Vec<Vec<Box2>>,
    /// Clear floor the robot can use, in cells.
    pub free_area: usize,
    /// What must stay open from door to door, or for beds.
    way: Option<&'s Way>,
}

impl<'a, 's> State<'a, 's> {
    /// Returns the empty room.
    pub fn new(space: &'s Space, nav: Nav, way: Option<&'s Way>, open: Open) -> Self {
        let free_area = nav.area();
        Self {
            space,
            placed: Vec::new(),
            solids: Vec::new(),
            basins: Vec::new(),
            clears: Vec::new(),
            bodies: Vec::new(),
            in_the_way: InTheWay::default(),
            has_robots: false,
            turning: None,
            circle: None,
            docks: Vec::new(),
            berths: Vec::new(),
            berths_open: true,
            beside_beds: Vec::new(),
            sights: Vec::new(),
            nav,
            pockets: Pockets::new(space),
            open,
            spare: RefCell::new(None),
            targets: Vec::new(),
            access: None,
            spare_access: RefCell::new(None),
            desks: Vec::new(),
            free_area,
            way,
        }
    }

    /// Returns the rule that forbids a unit's parts at a position, routes not looked at.
    ///
    /// `at_window` lets curtains and blinds hang in front of windows.
    pub fn test(&self, p: &Placed, at_window: bool) -> Result<(), Rule> {
        let space = self.space;
        if let Some((i, k)) = p.support {
            let host = &self.placed[i];
            let foot = p.world(&p.unit.bbox);
            if host.unit.parts[k].taken().any(|t| host.world(&t).overlaps(&foot)) {
                return Err(Rule::Collision);
            }
        }
        if p.support.is_none() && !space.bounds.contains(&p.world(&p.unit.bbox)) {
            return Err(Rule::Outside);
        }
        // most of what there is stands elsewhere in the room
        let extent = p.world(&p.unit.extent);
        let solids: Vec<&Solid> = self.solids.iter().filter(|s| s.rect.overlaps(&extent)).collect();
        let clears: Vec<&Box2> = self.clears.iter().filter(|c| c.overlaps(&extent)).collect();
        for part in &p.unit.parts {
            let solid = p.solid(part);
            if p.support.is_none() && !space.contains(&solid.rect) || solid.z1 > space.ceiling {
                return Err(Rule::Outside);
            }
            let aside = part.hangs_aside() || part.stands_aside();
            if aside && !self.has_wall_behind(&solid.rect, (p.q + part.quarter) % 4) {
                return Err(Rule::NoPlace);
            }
            if solid.is_flat() && solid.z0 == 0 {
                // floor covering may lie anywhere, but not on other floor covering
                if solids.iter().any(|s| s.is_flat() && s.overlaps(&solid)) {
                    return Err(Rule::Collision);
                }
                // nobody wants to step over the edge of a rug in a door
                let alone = p.unit.parts.len() == 1;
                if (alone || part.optional) && self.lies_in_door(&solid) {
                    return Err(Rule::Door);
                }
                continue;
            }
            if solids.iter().any(|s| !(s.is_flat() && s.z0 == 0) && s.overlaps(&solid)) {
                return Err(Rule::Collision);
            }
            if self.closes_basin(part, &solid) {
                return Err(Rule::Collision);
            }
            // a kettle on a counter stands in the light as a tall counter does
            if !at_window && space.windows.iter().any(|w| w.is_taken_by(&solid, self.open)) {
                return Err(Rule::Window);
            }
            if part.mount == Mount::Surface || p.support.is_some() {
                continue;
            }
            if space.doors.iter().any(|d| solid.z0 < d.height && d.kept(self.open).overlaps(&solid.rect)) {
                return Err(Rule::Door);
            }
            if takes_floor(part, &solid) && space.lanes(self.open).iter().any(|lane| lane.overlaps(&solid.rect)) {
                return Err(Rule::Door);
            }
            if takes_floor(part, &solid) && clears.iter().any(|c| c.overlaps(&solid.rect)) {
                return Err(Rule::Clearance);
            }
        }
        // a robot that charges stands in the way as furniture does, and where many work its floor is all free
        let lanes = space.lanes(self.open);
        let crowded = |b: &Box2| lanes.iter().chain(&self.bodies).any(|taken| taken.overlaps(b));
        if !lanes.is_empty() && buffers(p, self.nav.gap()).any(|b| crowded(&b)) {
            return Err(Rule::Door);
        }
        if p.support.is_none() {
            self.test_clears(p)?;
        }
        Ok(())
    }

    /// Returns true for a cabinet, a screen or a dispenser over the basin of something else, whichever of them comes later:
    /// nobody gets to the tap below it, or dries hands over it.
    fn closes_basin(&self, part: &Part, solid: &Solid) -> bool {
        match part.object.shape {
            Shape::Basin => self.solids.iter().any(|s| s.overlaps(&over_basin(solid))),
            _ => part.mount == Mount::Wall && self.basins.iter().any(|b| b.overlaps(solid)),
        }
    }

    /// Returns true where a wall that faces `q` carries all of what hangs there.
    fn has_wall_behind(&self, rect: &Box2, q: u8) -> bool {
        let own = rect.turned((4 - q) % 4);
        let carries = |w: &WallSide| (own.x0 - w.u).abs() <= AT_WALL && own.y0 >= w.v0 && own.y1 <= w.v1;
        self.space.walls.iter().any(|w| w.q == q && carries(w))
    }

    /// Returns true for floor covering that lies on the floor a door needs.
    fn lies_in_door(&self, solid: &Solid) -> bool {
        let covers = solid.is_flat() && solid.z0 == 0;
        covers && self.space.doors.iter().any(|d| d.zone.overlaps(&solid.rect))
    }

    fn test_clears(&self, p: &Placed) -> Result<(), Rule> {
        let free = |c: &Box2| self.space.contains(c) && !self.bodies.iter().any(|b| b.overlaps(c));
        if p.unit.clears.iter().all(|c| free(&p.world(c))) { Ok(()) } else { Err(Rule::Clearance) }
    }

    /// Tests a unit as [`State::test`]; what stands on it, hangs over it or on the wall beside it and is no essential part of it
    /// is left away where it would stand in the light, meet something that hangs there or have no wall.
    pub fn fit(&self, p: Placed<'a>, at_window: bool) -> Result<Placed<'a>, Rule> {
        match self.test(&p, at_window) {
            Ok(()) => Ok(p),
            Err(rule @ (Rule::Window | Rule::Collision | Rule::Door | Rule::NoPlace | Rule::Outside)) => {
                let in_the_way = |part: &Part| {
                    let solid = p.solid(part);
                    self.space.windows.iter().any(|w| w.is_taken_by(&solid, self.open))
                        || part.mount == Mount::Ceiling
                            && (!self.space.contains(&solid.rect) || self.solids.iter().any(|s| s.overlaps(&solid)))
                        || part.mount == Mount::Floor && self.lies_in_door(&solid)
                        || part.mount == Mount::Wall && self.hangs_badly(&solid, (p.q + part.quarter) % 4)
                };
                let lesser = Placed { unit: Rc::new(p.unit.cleared(in_the_way).ok_or(rule)?), ..p.clone() };
                self.test(&lesser, at_window).map(|()| lesser)
            }
            Err(rule) => Err(rule),
        }
    }

    /// Returns true for what would hang beside its unit without a wall, in a door or in something else.
    fn hangs_badly(&self, solid: &Solid, q: u8) -> bool {
        let in_door = |d: &DoorZone| solid.z0 < d.height && d.kept(self.open).overlaps(&solid.rect);
        !self.has_wall_behind(&solid.rect, q)
            || self.space.doors.iter().any(in_door)
            || self.solids.iter().any(|s| s.overlaps(solid))
    }

    /// Returns true for a bed with its head under a window.
    pub fn lies_under_window(&self, p: &Placed) -> bool {
        let anchor = p.unit.anchor();
        if anchor.object.shape != Shape::Bed {
            return false;
        }
        let own = p.world(&anchor.solid.rect).turned((4 - p.q) % 4);
        let behind = |w: &WallSide| w.q == p.q && (own.x0 - w.u).abs() <= HEAD_TO_WALL;
        self.space.windows.iter().any(|w| behind(&self.space.walls[w.wall]) && w.v0 < own.y1 && own.y0 < w.v1)
    }

    /// Returns how many cells of floor stay reachable once the units stand there, or the rule they break.
    pub fn route(&self, units: &[Placed]) -> Result<usize, Rule> {
        if let Some(way) = self.way {
            let more = in_the_way(units);
            let mut there = self.in_the_way.clone();
            there.extend(&more);
            if !more.is_empty() && !way.stays_open(&there) {
                return Err(Rule::Route);
            }
        }
        let obstacles: Vec<Box2> = units.iter().flat_map(obstacles).collect();
        if obstacles.is_empty() {
            let reached = units.iter().filter(|u| needs_reach(u)).all(|u| self.nav.reaches(&u.targets()));
            return if reached { Ok(self.free_area) } else { Err(Rule::Route) };
        }
        let mut spare = self.spare.borrow_mut();
        let nav = match spare.as_mut() {
            Some(nav) => {
                nav.clone_from(&self.nav);
                nav
            }
            None => spare.insert(self.nav.clone()),
        };
        obstacles.iter().for_each(|o| nav.block(o));
        let reached = nav.settle()
            // what stands there for good may be out of reach already
            && self.targets.iter().all(|t| nav.reaches(t) || !self.nav.reaches(t))
            && units.iter().filter(|u| needs_reach(u)).all(|u| nav.reaches(&u.targets()));
        let berths: Vec<Box2> = self.berths.iter().copied().chain(units.iter().flat_map(berths)).collect();
        let open = !self.berths_open || nav.passes_parked(&berths);
        let area = nav.area();
        drop(spare);
        if reached && open && self.leaves_access(units) { Ok(area) } else { Err(Rule::Route) }
    }

    /// Keeps a way of this width to each of many desks, mm, as far as rows leave one.
    pub fn keep_access(&mut self, width: i32) {
        self.access = Some(Nav::new(self.space, width / 2));
    }

    /// Returns true when units leave the way to all desks that have one.
    fn leaves_access(&self, units: &[Placed]) -> bool {
        let Some(access) = self.access.as_ref().filter(|_| !self.desks.is_empty()) else { return true };
        let mut spare = self.spare_access.borrow_mut();
        let after = match spare.as_mut() {
            Some(nav) => {
                nav.clone_from(access);
                nav
            }
            None => spare.insert(access.clone()),
        };
        units.iter().flat_map(narrows).for_each(|o| after.block(&o));
        after.settle();
        self.desks.iter().all(|desk| after.reaches(desk) || !access.reaches(desk))
    }

    /// Returns to how many of the desks among these units there is no way, once they stand there.
    pub fn without_access(&self, units: &[Placed]) -> usize {
        let Some(access) = &self.access else { return 0 };
        let mut after = access.clone();
        units.iter().flat_map(narrows).for_each(|o| after.block(&o));
        after.settle();
        units.iter().filter(|p| is_desk(p) && !after.reaches(&p.targets())).count()
    }

    /// Returns true when units would close off floor that is open without them, for however small a robot.
    pub fn is_closed_by(&self, units: &[Placed]) -> bool {
        self.pockets.is_closed_by(&Pockets::boxes(units))
    }

    /// Keeps the floor between a unit and what it faces from what one can do without.
    pub fn watch(&mut self, unit: &Placed) {
        let Some(focus) = self.placed.iter().find(|p| p.first_line && p.task != unit.task) else { return };
        let back = (4 - unit.q) % 4;
        let own = unit.world(&unit.unit.anchor().solid.rect).turned(back);
        let seen_from = focus.world(&focus.unit.anchor().solid.rect).turned(back);
        if own.x1 < seen_from.x0 {
            let below = unit.solid(unit.unit.anchor()).z0.max(LOW);
            self.sights.push((Box2 { x0: own.x1, x1: seen_from.x0, ..own }.turned(unit.q), below));
        }
    }

    /// Returns true for what would stand between a screen or board and those who look at it.
    pub fn hides(&self, p: &Placed) -> bool {
        let parts = || p.unit.parts.iter().filter(|part| part.mount == Mount::Floor).map(|part| p.solid(part));
        let between = |(floor, below): &(Box2, i32)| parts().any(|s| s.z1 > *below && s.rect.overlaps(floor));
        p.support.is_none() && self.sights.iter().any(between)
    }

    /// Keeps a circle of this radius free for wheelchairs, mm, where the room has a place for it.
    pub fn keep_circle(&mut self, radius: Option<i32>) {
        self.circle = radius.and_then(|radius| self.find_circle(&[], radius));
        self.turning = radius.filter(|_| self.circle.is_some());
    }

    fn find_circle(&self, more: &[Box2], radius: i32) -> Option<Circle> {
        Circle::find(&self.space.bounds, self.space.holes(), &[&self.bodies, more], radius)
    }

    /// Returns true when the circle is taken that wheelchairs are to turn on.
    pub fn lacks_circle(&self) -> bool {
        self.turning.is_some() && self.circle.is_none()
    }

    /// Returns true when a unit takes the last place for wheelchairs to turn on.
    pub fn fills_circle(&self, p: &Placed) -> bool {
        let (Some(circle), Some(radius)) = (self.circle, self.turning) else { return false };
        let own: Vec<Box2> = bodies(p).collect();
        own.iter().any(|body| !circle.is_clear_of(body)) && self.find_circle(&own, radius).is_none()
    }

    /// Puts units down that were tested.
    pub fn add(&mut self, units: Vec<Placed<'a>>) {
        for p in units {
            for part in &p.unit.parts {
                let solid = p.solid(part);
                self.solids.push(solid);
                self.basins.extend((part.object.shape == Shape::Basin).then(|| over_basin(&solid)));
            }
            obstacles(&p).for_each(|o| self.nav.block(&o));
            if let Some(access) = &mut self.access {
                narrows(&p).for_each(|o| access.block(&o));
                self.desks.extend(is_desk(&p).then(|| p.targets()));
            }
            self.pockets.add(&p);
            self.bodies.extend(bodies(&p));
            self.in_the_way.extend(&in_the_way(std::slice::from_ref(&p)));
            self.docks.extend(approaches(&p, self.nav.gap()));
            self.berths.extend(berths(&p));
            self.beside_beds.extend(ways_beside(&p).into_iter().flatten());
            if p.support.is_none() {
                self.clears.extend(p.unit.clears.iter().map(|c| p.world(c)));
            }
            if needs_reach(&p) {
                self.targets.push(p.targets());
            }
            self.placed.push(p);
        }
        self.nav.settle();
        if let Some(access) = &mut self.access {
            access.settle();
        }
        self.free_area = self.nav.area();
        self.berths_open = self.nav.passes_parked(&self.berths);
        if self.circle.is_some_and(|circle| self.bodies.iter().any(|body| !circle.is_clear_of(body))) {
            self.circle = self.turning.and_then(|radius| self.find_circle(&[], radius));
        }
    }
}

/// Returns the room over a basin that hands, taps and faces need.
fn over_basin(basin: &Solid) -> Solid {
    Solid { z0: basin.z1, z1: basin.z1 + OVER_BASIN, ..*basin }
}

/// Returns what robots drive around; what stands on a top takes no more floor than what carries it.
fn obstacles(p: &Placed) -> impl Iterator<Item = Box2> {
    let parts = p.unit.parts.iter().filter(|part| part.mount != Mount::Surface && p.support.is_none());
    parts.map(|part| p.solid(part)).filter(Solid::stops_robot).map(|s| s.rect)
}

/// Returns what people walk around: furniture, and robots at their docks.
fn narrows<'p>(p: &'p Placed) -> impl Iterator<Item = Box2> + 'p {
    obstacles(p).chain(p.unit.parked.iter().map(|b| p.world(b)))
}

fn is_desk(p: &Placed) -> bool {
    p.unit.anchor().object.shape == Shape::Desk
}

/// Returns the outlines of what takes floor from people passing by or using something.
fn bodies(p: &Placed) -> impl Iterator<Item = Box2> {
    p.unit.parts.iter().map(|part| (part, p.solid(part))).filter(|(part, s)| takes_floor(part, s)).map(|(_, s)| s.rect)
}

/// Returns what units put in the way: what takes floor, what stands out from a wall below people's heads, robots at their
/// docks. What came with a bed goes with it.
fn in_the_way(units: &[Placed]) -> InTheWay {
    let mut out = InTheWay::default();
    for p in units {
        let stands_out =
            |part: &Part, s: &Solid| part.mount == Mount::Wall && !part.is_shallow() && s.z0 < mm(HEAD_ROOM_M);
        let with_bed = p.unit.parts.iter().any(|part| part.object.shape == Shape::HospitalBed);
        for (part, s) in p.unit.parts.iter().map(|part| (part, p.solid(part))) {
            if !takes_floor(part, &s) && !stands_out(part, &s) {
                continue;
            }
            out.narrowing.push(s.rect);
            if part.object.shape == Shape::HospitalBed {
                out.beds.push(s.rect);
            } else if !with_bed {
                out.fixed.push(s.rect);
            }
        }
        out.parked.extend(p.unit.parked.iter().map(|b| p.world(b)));
    }
    out
}

pub(crate) fn takes_floor(part: &Part, solid: &Solid) -> bool {
    solid.stops_robot() && part.mount != Mount::Surface && !part.is_shallow()
}

/// Returns true when a robot must be able to come up to the unit.
fn needs_reach(p: &Placed) -> bool {
    p.on_floor() || (p.support.is_none() && !p.unit.clears.is_empty())
}

/// Returns a unit at a position of an object frame turned by `q`: `(u, v)` are world coordinates turned back by `q`.
pub(crate) fn at_frame<'a>(unit: &Rc<Unit<'a>>, q: u8, u: i32, v: i32, task: usize) -> Placed<'a> {
    Placed { unit: Rc::clone(unit), q, at: turn(q, u, v), first_line: false, task, support: None, z: 0 }
}
