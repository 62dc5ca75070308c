//! Turned to something: opposite the room's first item, or to the door.

use std::rc::Rc;

use d3dgen_model::domain::{Mount, Shape};

use super::{Candidate, Find, Focus, Rule};
use crate::geom::{Box2, turn};
use crate::seats::has_no_way_past;
use crate::space::{DoorZone, WallSide};
use crate::state::{Placed, at_frame};
use crate::unit::Unit;

/// Grain of free-standing positions, mm.
const STEP: i32 = 250;
/// Positions along a wall to either side of the axis, 0.1 m apart.
const SIDEWAYS: i32 = 80;
/// How far beside the axis of those who look at it a screen may stand, m.
const NEAR_AXIS_M: f64 = 0.4;
/// Distances from which a screen is looked at, mm.
const VIEW: (i32, i32) = (1500, 6500);
/// What a meter less before a counter loses, where people queue in the way in.
const QUEUE: f64 = 1.6;
/// How far aside of the way in a counter stands that looks across it, and the floor before it, m.
const COUNTER_AWAY_M: f64 = 1.8;
const COUNTER_FRONT_M: f64 = 1.6;
/// Floor between a counter and the open front of its room, m: a robot and a person get past.
const AT_EDGE_M: f64 = 0.95;
/// Floor a person needs behind a free-standing counter, mm.
const BEHIND: i32 = 900;
/// Floor more than one must have behind a desk or counter, mm, the floor before it from which on there is some to spare, m,
/// and what it is worth. Across a counter those wait who are not yet served.
const EASE: i32 = 250;
const AT_EASE_M: f64 = 1.7;
const AT_EASE_COUNTER_M: f64 = 2.2;
const AT_EASE: f64 = 0.3;
/// What a desk or counter loses past which one does not get to its user's side.
const SHUT_IN: f64 = 2.0;
/// Depth of the floor where people queue at a counter and of that where they come in, mm, and what a counter loses where
/// these are one.
const QUEUE_DEPTH: i32 = 900;
const LANDING: i32 = 1100;
const IN_THE_WAY_IN: f64 = 4.0;
/// What a counter loses with a wall in the floor where people queue.
const FACES_WALL: f64 = 2.0;
/// How far beside a screen windows dazzle who looks at it, mm, and what it and the seat before it lose between two of them.
const DAZZLED: i32 = 2500;
pub(super) const BETWEEN_WINDOWS: f64 = 1.5;
/// Depth of the floor of those who serve at a counter, mm, and what one loses that stands with it on the straight way from the
/// entrance to another door: everybody would pass behind their backs.
const STAFF_DEPTH: i32 = 1100;
const CROSSED: f64 = 3.0;
/// What a screen loses that half of those at a table have behind their backs.
const BACKS: f64 = 8.0;
/// What a desk loses with a window right before or behind its user, which the screen mirrors.
const GLARE: f64 = 10.0;
/// A window mirrored by a screen begins this near to the axis of the desk's user, and lies this near, mm.
const MIRRORED: (i32, i32) = (500, 3500);
/// How far ahead of the wall behind one the middle of a door lies that one sees from a desk before that wall, mm.
const SIDE_VIEW: i32 = 900;

/// Returns the floor before a desk or counter from which on there is some to spare behind it, m.
fn ample(look: u8) -> f64 {
    if look == 0 { AT_EASE_COUNTER_M } else { AT_EASE_M }
}

impl<'a> Find<'_, 'a, '_> {
    /// Offers positions opposite the first item, facing it: on the wall across first, then free-standing. Who sits around a
    /// table looks to its head.
    pub(super) fn facing(&mut self, unit: &Rc<Unit<'a>>) {
        let Some(focus) = self.focus() else { return self.along_walls(unit) };
        if focus.around {
            for (turns, less) in [(1, 0.0), (3, 0.0), (0, BACKS), (2, BACKS)] {
                self.facing_side(unit, &Focus { q: (focus.q + turns) % 4, ..focus }, less);
            }
        } else {
            self.facing_side(unit, &focus, 0.0);
        }
        // who lies in bed or sits on a sofa sees no screen behind or far beside
        let screen = self.task.anchor.shape == Shape::Panel && self.task.required == 0 && !focus.around;
        let unseen = |c: &Candidate| screen && !focus.sees(&c.placed.world(&c.placed.unit.anchor().solid.rect));
        self.out.retain(|c| !unseen(c));
        if self.out.is_empty() {
            for i in 0..self.state.space.walls.len() {
                let opposite = self.state.space.walls[i].q != focus.q;
                if opposite || !screen {
                    self.along_wall(unit, i, if opposite { -1.0 } else { -2.5 });
                }
            }
            self.out.retain(|c| !unseen(c));
        }
    }

    /// Offers positions that face one side of something, worth this much less.
    fn facing_side(&mut self, unit: &Rc<Unit<'a>>, focus: &Focus, less: f64) {
        let Focus { q: target_q, rect: target, seat, .. } = *focus;
        // all in the frame of the one that faces the target: its users look along x
        let q = (target_q + 2) % 4;
        let look = unit.look();
        let (_, axis) = turn((4 - q) % 4, seat.0, seat.1);
        let (b, r) = (unit.as_looking(&unit.bbox), unit.as_looking(&unit.reach));
        let anchor = unit.as_looking(&unit.anchor().solid.rect);
        let middle = (anchor.y0 + anchor.y1) / 2;
        let own = (q + 4 - look) % 4;
        let at = |u: i32, v: i32, task: usize| Placed { at: turn(q, u, v), ..at_frame(unit, own, 0, 0, task) };
        // whoever sits before the wall needs room for the chair, and whoever speaks from behind a lectern to stand
        let back = match (look, self.task.anchor.shape) {
            (0, Shape::Counter) => b.x0 - BEHIND,
            (0, _) => b.x0,
            _ => r.x0.min(b.x0),
        };
        for i in 0..self.state.space.walls.len() {
            let wall = &self.state.space.walls[i];
            if wall.q != q || wall.length() < b.height() {
                continue;
            }
            let most = (wall.length() - b.height()) / 2;
            for k in 0..=SIDEWAYS {
                let side = if k % 2 == 0 { k / 2 } else { -(k + 1) / 2 } * 100;
                let (low, high) = (wall.v0 - b.y0, wall.v1 - b.y1);
                let v = (axis - middle + side).clamp(low, high);
                if side.abs() <= most + 100 {
                    let placed = at(wall.u - back, v, self.index);
                    let off = f64::from((v + middle - axis).abs()) / 1000.0;
                    // a speaker's desk leaves the middle to the board
                    let aside = f64::from((v - low).min(high - v)) / 1000.0;
                    // looked at from a little aside is well enough, from the far end of the sofa it is not
                    let turned = 0.5 * off + 2.5 * (off - NEAR_AXIS_M).max(0.0);
                    let less = less + if self.is_between_windows(i, v + middle) { BETWEEN_WINDOWS } else { 0.0 };
                    self.offer(placed, i as u32, |_, _| 3.0 - less - if look == 0 { turned } else { aside });
                }
            }
        }
        // a stand has a back that nobody should see
        let backed = matches!(self.task.anchor.shape, Shape::Cabinet | Shape::Shelf);
        if self.task.anchor.mount == Mount::Floor && !unit.needs_wall && !backed {
            let wide = self.state.space.bounds.turned((4 - q) % 4);
            let t = target.turned((4 - q) % 4);
            // in front of the target means at smaller u in the frame of the one that faces it
            let mut u = t.x0 - r.x1;
            while u + b.x0 > wide.x0 {
                for side in [0, -STEP, STEP, -2 * STEP, 2 * STEP] {
                    let placed = at(u, axis - middle + side, self.index);
                    let far = f64::from(t.x0 - u) / 1000.0;
                    let off = f64::from(side.abs()) / 1000.0;
                    self.offer(placed, 90, |_, _| 1.5 - less - 2.0 * off - 0.3 * (far - 1.8).abs());
                }
                u -= STEP;
            }
        }
    }

    /// Returns how far before a unit, near its axis, the nearest wall is where what will face it finds its place, mm, and
    /// whether windows are on both sides of that; `None` without such a wall.
    pub(super) fn view(&self, p: &Placed<'a>, unit: &Rc<Unit<'a>>) -> Option<(i32, bool)> {
        let q = (p.q + p.unit.look() + 2) % 4;
        let back = (4 - q) % 4;
        let (seat, reach) = (p.world(&p.unit.anchor().solid.rect), p.world(&p.unit.reach));
        let (_, axis) = turn(back, seat.center().0, seat.center().1);
        let front = seat.turned(back).x0;
        let anchor = unit.anchor().solid.rect;
        let middle = (anchor.y0 + anchor.y1) / 2;
        let has_place = |(_, wall): &(usize, &WallSide)| {
            [0, -200, 200, -400, 400].into_iter().any(|side| {
                let v = axis - middle + side;
                let placed = at_frame(unit, q, wall.u - unit.bbox.x0, v, self.index);
                let inside = v + unit.bbox.y0 >= wall.v0 && v + unit.bbox.y1 <= wall.v1;
                inside && !placed.world(&unit.bbox).overlaps(&reach) && self.state.test(&placed, false).is_ok()
            })
        };
        let walls = self.state.space.walls.iter().enumerate();
        let seen = walls.filter(|(_, w)| w.q == q && (VIEW.0..VIEW.1).contains(&(front - w.u)));
        seen.filter(has_place).map(|(i, wall)| (front - wall.u, self.is_between_windows(i, axis))).min()
    }

    /// Returns true for a place on a wall with windows to both sides, which dazzle who looks there.
    fn is_between_windows(&self, wall: usize, along: i32) -> bool {
        let near = |low: i32, high: i32| self.state.space.windows_of(wall).any(|w| w.v1 > low && w.v0 < high);
        near(along - DAZZLED, along) && near(along, along + DAZZLED)
    }

    /// Offers positions that face the door of the room, with the far wall or a person's width behind: a counter with its
    /// front, a desk with the person at it. A desk may also stand across, with its user's back to a side wall and the door
    /// in view.
    pub(super) fn facing_door(&mut self, unit: &Rc<Unit<'a>>) {
        let space = self.state.space;
        let Some(door) = space.doors.first() else { return self.along_walls(unit) };
        let wall = &space.walls[door.wall];
        let q = (wall.q + 2) % 4;
        let wide = space.bounds.turned((4 - q) % 4);
        let door_axis = -(door.v0 + door.v1) / 2; // the frame is turned by half a turn against the wall's
        let door_u = -wall.u;
        let look = unit.look();
        let (b, r) = (unit.as_looking(&unit.bbox), unit.as_looking(&unit.reach));
        let middle = (b.y0 + b.y1) / 2;
        let own = (q + 4 - look) % 4;
        // whoever sits or stands before the wall needs room there
        let rear = r.x0.min(b.x0);
        let backs = space.walls.iter().filter(|w| w.q == q).map(|w| w.u - rear);
        let mut us: Vec<i32> = backs.flat_map(|u| [u, u + EASE]).collect();
        us.extend((0..30).map(|k| wide.x0 + BEHIND - rear + k * STEP).take_while(|u| u + b.x1 < door_u));
        // beside the way in, or close to a wall so that one gets past
        let mut vs: Vec<i32> = (0..24).map(|k| if k % 2 == 0 { k / 2 } else { -(k + 1) / 2 } * STEP).collect();
        vs.iter_mut().for_each(|v| *v += door_axis - middle);
        vs.extend([wide.y0 - b.y0, wide.y1 - b.y1]);
        let ample = ample(look);
        // who comes to a room with no other way in stands in the corridor, and whoever sits there sees its doors from close by
        let at_edge = door.open && space.doors.len() == 1;
        for u in us {
            let behind = u + rear - wide.x0;
            for &v in &vs {
                let placed = Placed { at: turn(q, u, v), ..at_frame(unit, own, 0, 0, self.index) };
                let front = f64::from(door_u - u - b.x1) / 1000.0;
                // a desk need not stand in line with the door
                let off = f64::from((v + middle - door_axis).abs()) / if look == 0 { 1000.0 } else { 4000.0 };
                // whoever stands behind a counter that is open to a corridor sees along it from close to the opening only
                let (far, slope): (f64, f64) = match (at_edge, door.open) {
                    (true, _) => (AT_EDGE_M, 0.8),
                    (_, true) => (1.6, 0.6),
                    _ => (4.0, 0.2),
                };
                let lost = if behind == EASE && front > ample {
                    -AT_EASE
                } else if behind > 100 && behind < BEHIND {
                    1.5
                } else if door.open {
                    0.0
                } else {
                    f64::from(behind) / 4000.0
                };
                // who waits at the counter stands clear of the way in
                let aside = (v + middle - door_axis).abs() > (b.height() + door.v1 - door.v0) / 2;
                let least = match (door.open, aside) {
                    _ if look != 0 => 0.9,
                    _ if at_edge => AT_EDGE_M,
                    (true, _) => 1.6,
                    (false, true) => 1.8,
                    (false, false) => 2.6,
                };
                let near = QUEUE * (least - front).max(0.0) + slope * (front - far).max(0.0);
                let score = 2.0 - 0.6 * off - lost - near;
                let hampered =
                    |find: &Self, p: &Placed<'a>| if look == 0 { find.hampered(p) } else { find.unseated(p) };
                self.offer(placed, 80 + u32::from(behind > 100), |find, p| score - hampered(find, p));
            }
        }
        if look != 0 || !door.open {
            self.across_door(unit, (q + 1) % 4);
            self.across_door(unit, (q + 3) % 4);
        }
        if self.out.is_empty() {
            self.none(Rule::NoPlace);
            for i in 0..space.walls.len() {
                self.along_wall(unit, i, -1.5);
            }
        }
    }

    /// Offers positions for a desk or counter whose user has the back to a side wall, looks along `q` and has the door
    /// ahead.
    fn across_door(&mut self, unit: &Rc<Unit<'a>>, q: u8) {
        let space = self.state.space;
        let back = (4 - q) % 4;
        let door = space.doors[0].zone.turned(back).center();
        let wide = space.bounds.turned(back);
        let (b, r) = (unit.as_looking(&unit.bbox), unit.as_looking(&unit.reach));
        let own = (q + 4 - unit.look()) % 4;
        for wall in space.walls.iter().filter(|w| w.q == q && w.u + SIDE_VIEW < door.0) {
            let close = wall.u - r.x0.min(b.x0);
            let (low, high) = (wall.v0 - b.y0, wall.v1 - b.y1);
            let steps = || (low..=high).step_by(STEP as usize).chain((low <= high).then_some(high));
            for (u, v) in [close, close + EASE].into_iter().flat_map(|u| steps().map(move |v| (u, v))) {
                let placed = Placed { at: turn(q, u, v), ..at_frame(unit, own, 0, 0, self.index) };
                let away = f64::from((v + (b.y0 + b.y1) / 2 - door.1).abs()) / 1000.0;
                let front = f64::from(wide.x1 - u - b.x1) / 1000.0;
                let eased = match u > close {
                    true if front > ample(unit.look()) => AT_EASE,
                    true => -AT_EASE,
                    false => 0.0,
                };
                let score = |find: &Self, p: &Placed<'a>| match unit.look() {
                    // whoever comes in finds the counter before the way on, and room to stand there
                    0 => {
                        2.2 - 0.3 * (away - COUNTER_AWAY_M).abs()
                            - QUEUE * (COUNTER_FRONT_M - front).max(0.0)
                            - find.hampered(p)
                            + eased
                    }
                    _ => 1.6 + (0.15 * away).min(0.6) - find.unseated(p) + eased,
                };
                self.offer(placed, 82 + u32::from(q), score);
            }
        }
    }

    /// Returns what a desk loses past which its user does not get to the seat, and by windows right before or behind.
    fn unseated(&self, p: &Placed<'a>) -> f64 {
        let space = self.state.space;
        let q = (p.q + p.unit.look()) % 4;
        let back = (4 - q) % 4;
        let (x, y) = p.world(&p.unit.anchor().solid.rect).turned(back).center();
        let mirrored = space.windows.iter().filter(|w| space.walls[w.wall].q % 2 == q % 2).any(|w| {
            let window = w.zone.turned(back);
            let aside = (window.y0 - y).max(y - window.y1);
            aside < MIRRORED.0 && (window.center().0 - x).abs() < MIRRORED.1
        });
        SHUT_IN * f64::from(has_no_way_past(self.state, p)) + GLARE * f64::from(mirrored)
    }

    /// Returns what a counter loses past which one gets on neither side, and before which people queue where others come
    /// in.
    fn hampered(&self, p: &Placed<'a>) -> f64 {
        let space = self.state.space;
        let own = p.world(&p.unit.anchor().solid.rect).turned((4 - p.q) % 4);
        let queue = Box2 { x0: own.x1, x1: own.x1 + QUEUE_DEPTH, ..own }.turned(p.q);
        let queues = space.doors.iter().filter(|door| door.rank == 0 && !door.open).any(|door| {
            let landing = space.walls[door.wall].strip(door.v0, door.v1, 0, LANDING);
            landing.overlaps(&queue)
        });
        let walled = !space.contains(&queue);
        let crossed = space.doors.first().filter(|door| door.rank == 0).is_some_and(|entrance| {
            let staff = Box2 { x0: own.x0 - STAFF_DEPTH, ..own }.turned(p.q);
            let middle = |d: &DoorZone| space.walls[d.wall].strip(d.v0, d.v1, 0, 0).center();
            space.doors[1..].iter().any(|door| staff.meets(middle(entrance), middle(door)))
        });
        SHUT_IN * f64::from(has_no_way_past(self.state, p))
            + IN_THE_WAY_IN * f64::from(queues)
            + FACES_WALL * f64::from(walled)
            + CROSSED * f64::from(crossed)
    }
}
