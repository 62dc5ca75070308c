//! Stairs and lifts: a place at both ends, then the time that the way between takes.

use d3dgen_model::Point;

use super::{Engine, NEARLY_M, THERE_M};
use crate::mover::State;
use crate::routes::ride_s;

impl Engine<'_> {
    /// Returns a place at a stop of a link that nobody has taken or stands on; where it is already counts as free.
    pub(super) fn slot(&self, i: usize, (link, stop): (usize, usize), here: bool) -> Option<usize> {
        let (level, slots) = &self.links[link].stops[stop];
        let space = &self.spaces[*level];
        let is_free = |k: &usize| {
            let place = slots[*k];
            if space.clear(space.node(place)) < self.movers[i].radius {
                return false;
            }
            let taken = self.riders.get(&(link, stop, *k)).is_some_and(|r| *r != i);
            let near = self.near(*level, place, 2.0 * self.movers[i].radius, i);
            !taken && (near.is_empty() || here && self.movers[i].at.distance(place) < 0.05)
        };
        (0..slots.len()).find(is_free)
    }

    /// Waits for a place at both ends of stairs or a lift, and takes it.
    pub(super) fn board(&mut self, i: usize) {
        let Some((link, to)) = self.movers[i].legs.first().and_then(|leg| leg.ride) else { return self.arrive(i) };
        let level = self.movers[i].level;
        let stop = |level: usize| self.links[link].stops.iter().position(|(l, _)| *l == level);
        let Some(from) = stop(level) else { return self.arrive(i) };
        let own = |stop: usize| {
            self.riders.iter().find(|((l, s, _), r)| **r == i && *l == link && *s == stop).map(|((.., k), _)| *k)
        };
        // both places or none: nobody waits for what another one has who waits for this
        let both =
            own(from).zip(own(to)).or_else(|| self.slot(i, (link, from), true).zip(self.slot(i, (link, to), false)));
        let Some((k, other)) = both else {
            let t = self.t;
            let m = &mut self.movers[i];
            m.velocity = Point::new(0.0, 0.0);
            if !m.is_paused() {
                m.begin_pause(t, "lift");
            }
            return;
        };
        if own(from).is_none() {
            self.movers[i].since = self.t;
            self.movers[i].end_pause(self.t);
        }
        self.riders.insert((link, from, k), i);
        self.riders.insert((link, to, other), i);
        let place = self.links[link].stops[from].1[k];
        if self.movers[i].at.distance(place) < 2.0 * THERE_M || self.t - self.movers[i].since > 6.0 {
            self.movers[i].velocity = Point::new(0.0, 0.0);
            self.movers[i].reach(place, NEARLY_M + 0.6);
            let until = self.t + ride_s(self.links, link, from, to);
            self.movers[i].state = State::Riding { until, link, from: (from, k), to: (to, other) };
            return;
        }
        if self.movers[i].target.distance(place) > 1e-9 || self.movers[i].legs[0].way.last() != Some(&place) {
            let at = self.movers[i].at;
            if let Some(mut way) = self.route(i, level, place).and_then(|mut legs| legs.pop()).map(|leg| leg.way) {
                way.push(place);
                self.movers[i].legs[0].way = way;
            } else {
                self.movers[i].legs[0].way = vec![at, place];
            }
            self.movers[i].corner = 0;
            self.movers[i].careful = 0;
            self.movers[i].target = place;
        }
        self.follow(i);
        self.step_on(i);
    }

    pub(super) fn alight(&mut self, i: usize, link: usize, from: (usize, usize), to: (usize, usize)) {
        let (level, slots) = &self.links[link].stops[to.0];
        let (level, radius) = (*level, self.movers[i].radius);
        if self.near(level, slots[to.1], 2.0 * radius, i).into_iter().any(|k| !self.movers[k].is_settled()) {
            // somebody stands there: a moment later, or beside it
            if let Some(other) = self.slot(i, (link, to.0), false) {
                self.riders.remove(&(link, to.0, to.1));
                self.riders.insert((link, to.0, other), i);
                self.movers[i].state = State::Riding { until: self.t, link, from, to: (to.0, other) };
            }
            return;
        }
        self.riders.remove(&(link, from.0, from.1));
        let m = &mut self.movers[i];
        m.leave(self.t);
        m.level = level;
        m.at = slots[to.1];
        m.since = self.t;
        m.left = f64::MAX;
        m.legs.remove(0);
        m.corner = 0;
        m.careful = 0;
        m.state = State::Walking;
        self.riders.remove(&(link, to.0, to.1));
        let end = m.legs.last().and_then(|leg| Some((leg.level, *leg.way.last()?)));
        if let Some((level, at)) = end {
            let went = self.go(i, level, at);
            if !went {
                self.give_up(i);
            }
        }
        let end = self.movers[i].legs.last().and_then(|leg| leg.way.last()).copied();
        self.movers[i].target = end.unwrap_or(self.movers[i].at);
    }
}
