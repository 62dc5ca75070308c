//! A step along a way: corners, doors, and what the others leave.

use d3dgen_model::Point;
use d3dgen_model::scenario::Act;

use super::{DT_S, Engine, FAR_M, HANDLE_M, NEARLY_M, OPEN_S, OPENING_S, RUB_M, SEEN_M, SQUEEZE_M, THERE_M};
use crate::avoid::{Other, choose};
use crate::mover::State;
use crate::routes::{Leg, Router, Walker};

impl Engine<'_> {
    /// Sets off to a place; false where there is no way.
    pub(super) fn go(&mut self, i: usize, level: usize, to: Point) -> bool {
        let legs = self.route(i, level, to);
        let Some(legs) = legs else { return false };
        let m = &mut self.movers[i];
        m.waits = false;
        m.leave(self.t);
        m.legs = legs;
        m.corner = 0;
        m.careful = 0;
        m.target = to;
        m.left = f64::MAX;
        m.since = self.t;
        m.state = State::Walking;
        true
    }

    pub(super) fn route(&mut self, i: usize, level: usize, to: Point) -> Option<Vec<Leg>> {
        let m = &self.movers[i];
        let key = (m.radius * 1000.0) as u64;
        let at = self.routers.iter().position(|(k, _)| *k == key).unwrap_or_else(|| {
            self.routers.push((key, Router::new(self.spaces, self.links, m.radius)));
            self.routers.len() - 1
        });
        let walker = Walker { allowed: &self.access[m.access], stairs: !m.robot };
        self.routers[at].1.route((self.spaces, self.links), &walker, (m.level, m.at), (level, to))
    }

    /// A step along the way.
    pub(super) fn walk(&mut self, i: usize) {
        let (level, at) = (self.movers[i].level, self.movers[i].at);
        let Some(leg) = self.movers[i].legs.first() else { return self.arrive(i) };
        let (way_end, rides) = (leg.way.last().copied().unwrap_or(at), leg.ride.is_some());
        let final_leg = self.movers[i].legs.len() == 1;
        let left = self.movers[i].length_left();
        let target_off = at.distance(way_end);
        // a line is joined at its end, which moves
        if let Some(s) = self.movers[i].station.filter(|_| final_leg && self.is_queueing(i))
            && target_off < 2.0
        {
            return self.join(i, s);
        }
        if target_off < THERE_M && left < 2.0 * THERE_M || self.nearly(i, target_off, final_leg) {
            return if rides { self.movers[i].state = State::BeforeRide } else { self.arrive(i) };
        }
        if rides && target_off < 1.5 && left < 1.8 {
            self.movers[i].state = State::BeforeRide;
            return;
        }
        if self.opens_door(i, level, at) {
            return;
        }
        self.follow(i);
        self.step_on(i);
        self.look_after(i);
    }

    pub(super) fn is_queueing(&self, i: usize) -> bool {
        let m = &self.movers[i];
        !m.leaving && m.tasks.get(m.cursor).is_some_and(|t| t.act == Act::Queue)
    }

    /// Returns true where somebody stands on the target and one waits beside it for a while already.
    pub(super) fn nearly(&self, i: usize, off: f64, final_leg: bool) -> bool {
        let m = &self.movers[i];
        let on_seat = m.station.is_some() && !self.is_queueing(i);
        let reach = if on_seat { 0.4 } else { NEARLY_M };
        final_leg && (off < reach && self.t - m.since > 1.5 || !on_seat && off < FAR_M && m.tries > 1)
    }

    /// Goes on to the next corner where that is seen.
    pub(super) fn follow(&mut self, i: usize) {
        let (level, at, radius) = (self.movers[i].level, self.movers[i].at, self.movers[i].radius);
        let obstacles = &self.spaces[level].obstacles;
        let Some(leg) = self.movers[i].legs.first() else { return };
        let mut corner = self.movers[i].corner;
        while corner + 1 < leg.way.len() {
            let near = at.distance(leg.way[corner]) < 0.15;
            let least = (radius + 0.02).min(self.spaces[level].clear(self.spaces[level].node(leg.way[corner])));
            let sees =
                at.distance(leg.way[corner]) < 1.5 && obstacles.along(at, leg.way[corner + 1], least) >= least - 1e-6;
            // around those who stand there is no short cut
            if near || sees && corner >= self.movers[i].careful { corner += 1 } else { break }
        }
        self.movers[i].corner = corner;
    }

    /// Opens a closed door on the way; true while it does.
    pub(super) fn opens_door(&mut self, i: usize, level: usize, at: Point) -> bool {
        let m = &self.movers[i];
        let Some(next) = m.legs.first().and_then(|leg| leg.way.get(m.corner)).copied() else { return false };
        let far = at.distance(next).max(1e-6);
        let way = Point::new((next.x - at.x) / far, (next.y - at.y) / far);
        let before = |d: &crate::space::Opening| {
            let (dx, dy) = (d.middle.x - at.x, d.middle.y - at.y);
            let near = dx.hypot(dy);
            d.by_hand && near < HANDLE_M && near > 0.2 && dx * way.x + dy * way.y > 0.7 * near
        };
        let Some(door) = self.spaces[level].doors.iter().position(before) else { return false };
        let open = self.open_until[level][door] > self.t;
        self.open_until[level][door] = self.t + OPENING_S + OPEN_S;
        if !open {
            self.movers[i].begin_pause(self.t, "door");
            self.movers[i].velocity = Point::new(0.0, 0.0);
            self.movers[i].state = State::Opening { until: self.t + OPENING_S };
        }
        !open
    }

    /// Moves by what the others leave.
    pub(super) fn step_on(&mut self, i: usize) {
        let m = &self.movers[i];
        let (level, at, radius) = (m.level, m.at, m.radius);
        let Some(next) = m.legs.first().and_then(|leg| leg.way.get(m.corner)).copied() else { return };
        let far = at.distance(next);
        if far < 1e-6 {
            return;
        }
        let last = m.legs[0].way.len() == m.corner + 1;
        let speed = if last { m.speed.min(far / DT_S) } else { m.speed };
        let wanted = Point::new((next.x - at.x) / far * speed, (next.y - at.y) / far * speed);
        let others: Vec<Other> = self
            .near(level, at, SEEN_M, i)
            .into_iter()
            .map(|k| {
                let o = &self.movers[k];
                let squeezes = o.is_seated() || m.tries > 0;
                let reach = radius + o.radius - if squeezes { SQUEEZE_M } else { 0.0 };
                Other { offset: Point::new(o.at.x - at.x, o.at.y - at.y), velocity: o.velocity, reach }
            })
            .collect();
        let space = &self.spaces[level];
        let least = radius - RUB_M;
        let here = space.obstacles.distance(at, least);
        let mut is_free = |v: Point| {
            let p = Point::new(at.x + v.x * DT_S, at.y + v.y * DT_S);
            space.is_clear(p, least) || here < least && space.is_clear(p, here)
        };
        let v = choose(wanted, &others, DT_S, &mut is_free);
        let m = &mut self.movers[i];
        m.velocity = v;
        m.at = Point::new(at.x + v.x * DT_S, at.y + v.y * DT_S);
    }
}
