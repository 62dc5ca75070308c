//! Seats, beds, what is operated, and lines before counters: who has which, how one gets on and off.

use d3dgen_model::Point;
use d3dgen_model::scenario::{Act, Station};

use super::{APART_M, DT_S, Engine, FAR_M, GOAL_M, ON_OFF_S, THERE_M, before, seat};
use crate::mover::{Mover, State, Task};
use crate::routes::standing;
use crate::search::search;

/// How far from where one wants to stand another place is looked for, m, and floor before doors on which nobody stays, m.
const SPOT_M: f64 = 4.0;
const FROM_DOOR_M: f64 = 0.9;
/// Free floor of one who stands in a room with others, m2: level of service A of walkways (Fruin 1971), where nobody has to be asked
/// aside.
const FLOOR_OF_ONE_M2: f64 = 3.25;
/// Time after which one looks again whether a line has a place left, s, and how often.
const WAIT_S: f64 = 6.0;
const MOST_WAITS: u32 = 40;

impl Engine<'_> {
    pub(super) fn free(&mut self, station: usize, i: usize) {
        if self.users[station] == Some(i) {
            self.users[station] = None;
        }
        self.lines[station].retain(|k| *k != i);
    }

    /// Returns a free station of the room of a task, the nearest.
    pub(super) fn free_station(&self, i: usize, task: &Task) -> Option<usize> {
        let from = self.movers[i].at;
        let fits = |(k, (level, room, s)): &(usize, &(usize, usize, Station))| {
            *level == task.level && *room == task.room && s.act == task.act && self.users[*k].is_none()
        };
        let all = self.stations.iter().enumerate().filter(fits);
        let far = |k: usize| before(&self.stations[k].2).distance(from);
        all.map(|(k, _)| k).min_by(|a, b| far(*a).total_cmp(&far(*b)))
    }

    /// Returns how many places of a task nobody has; many where it needs none.
    pub(super) fn places_left(&self, task: &Task) -> usize {
        let of_task = |(_, (level, room, s)): &(usize, &(usize, usize, Station))| {
            *level == task.level && *room == task.room && s.act == task.act
        };
        let mut all = self.stations.iter().enumerate().filter(of_task).peekable();
        if all.peek().is_none() {
            return usize::MAX;
        }
        all.filter(|(k, _)| self.users[*k].is_none()).count()
    }

    /// Returns how many more people who come in can stand in the room of a task without being in each other's way; never none
    /// where nobody has come yet.
    pub(super) fn floor_left(&self, task: &Task) -> usize {
        let most = (self.spaces[task.level].free_floor_m2(task.room) / FLOOR_OF_ONE_M2).max(1.0) as usize;
        let stands = |t: &Task| (t.level, t.room) == (task.level, task.room) && matches!(t.act, Act::Stand | Act::Talk);
        let comes = |m: &&Mover| m.tasks.iter().skip(m.cursor).any(stands);
        let there = self.movers.iter().filter(|m| m.is_there() && m.exit.is_some());
        let coming = self.sources.iter().flat_map(|s| &s.waiting);
        most.saturating_sub(there.chain(coming).filter(comes).count())
    }

    /// Returns the counter of a room with the shortest line that has a place left.
    pub(super) fn shortest_line(&self, task: &Task) -> Option<usize> {
        let fits = |(k, (level, room, s)): &(usize, &(usize, usize, Station))| {
            *level == task.level && *room == task.room && s.act == Act::Queue && self.lines[*k].len() <= s.queue.len()
        };
        let all = self.stations.iter().enumerate().filter(fits);
        all.map(|(k, _)| k).min_by_key(|k| self.lines[*k].len())
    }

    /// Returns the place in a line, 0 for who is served.
    pub(super) fn place(&self, station: usize, k: usize) -> Point {
        let s = &self.stations[station].2;
        if k == 0 { before(s) } else { s.queue.get(k - 1).or(s.queue.last()).copied().unwrap_or(before(s)) }
    }

    pub(super) fn tail(&self, station: usize) -> Point {
        self.place(station, self.lines[station].len())
    }

    /// Returns a place to stand near a point where nobody stands or is about to: out of the way of doors where there is such.
    pub(super) fn free_spot(&self, i: usize, level: usize, room: usize, p: Point) -> Option<Point> {
        let radius = self.movers[i].radius;
        let taken: Vec<Point> = self
            .movers
            .iter()
            .enumerate()
            .filter(|(j, m)| *j != i && m.is_there() && m.level == level)
            .flat_map(|(_, m)| [m.target].into_iter().chain((!m.is_walking()).then_some(m.at)))
            .filter(|q| q.distance(p) < SPOT_M)
            .collect();
        let space = &self.spaces[level];
        let start = standing(space, room, p, radius)?;
        if taken.iter().all(|o| o.distance(p) >= APART_M) && space.node(p) == start {
            return Some(p);
        }
        let doors: Vec<Point> = space.doors.iter().filter(|d| d.rooms.contains(&room)).map(|d| d.middle).collect();
        [FROM_DOOR_M, 0.0].into_iter().find_map(|from_door| {
            let open = |n: usize| {
                let q = space.point(n);
                doors.iter().all(|d| d.distance(q) >= from_door)
                    && taken.iter().all(|o| o.distance(q) >= APART_M.max(2.0 * radius))
            };
            let (_, found) = search(space, start, radius, |n| space.belongs(n, room), open, SPOT_M);
            found.map(|n| space.point(n))
        })
    }

    pub(super) fn get_on(&mut self, i: usize, since: f64, until: f64) {
        let Some(s) = self.movers[i].station else { return self.finish(i) };
        let share = ((self.t - since) / ON_OFF_S).min(1.0);
        let (from, to) = (before(&self.stations[s].2), seat(&self.stations[s].2));
        if self.is_met(i, Point::new(from.x + share * (to.x - from.x), from.y + share * (to.y - from.y))) {
            self.movers[i].state = State::GettingOn { since: since + DT_S, until };
            return;
        }
        self.movers[i].at = Point::new(from.x + share * (to.x - from.x), from.y + share * (to.y - from.y));
        if share >= 1.0 {
            self.movers[i].state = State::On { until };
        }
    }

    pub(super) fn is_before_free(&self, i: usize) -> bool {
        let m = &self.movers[i];
        let Some(s) = m.station else { return true };
        let at = before(&self.stations[s].2);
        self.near(m.level, at, 1.0, i).into_iter().all(|k| {
            let o = &self.movers[k];
            o.is_settled() || o.at.distance(at) >= o.radius + m.radius
        })
    }

    /// Returns true when somebody is met at a place who comes nearer by that.
    pub(super) fn is_met(&self, i: usize, next: Point) -> bool {
        let m = &self.movers[i];
        let meets = |k: usize| {
            let o = &self.movers[k];
            let off = o.at.distance(next);
            off < o.radius + m.radius - 0.05 && off < o.at.distance(m.at)
        };
        self.near(m.level, next, 1.0, i).into_iter().any(meets)
    }

    pub(super) fn get_off(&mut self, i: usize, since: f64) {
        let Some(s) = self.movers[i].station else { return self.finish(i) };
        let share = ((self.t - since) / ON_OFF_S).min(1.0);
        let (to, from) = (before(&self.stations[s].2), seat(&self.stations[s].2));
        let next = Point::new(from.x + share * (to.x - from.x), from.y + share * (to.y - from.y));
        if self.is_met(i, next) {
            // somebody passes: a moment later
            self.movers[i].state = State::GettingOff { since: since + DT_S };
            return;
        }
        self.movers[i].at = next;
        if share >= 1.0 {
            self.movers[i].end_pause(self.t);
            self.finish(i);
        }
    }

    /// Returns true for a task of waiting in a line before a counter that is there.
    pub(super) fn has_line(&self, task: &Task) -> bool {
        task.act == Act::Queue
            && self
                .stations
                .iter()
                .any(|(level, room, s)| *level == task.level && *room == task.room && s.act == Act::Queue)
    }

    /// Stands aside until a line has a place left; after a while it gives that up.
    pub(super) fn wait_for_line(&mut self, i: usize) {
        if let Some(s) = self.movers[i].station.take() {
            self.free(s, i);
        }
        let (t, most) = (self.t, MOST_WAITS);
        let m = &mut self.movers[i];
        m.waited += 1;
        if m.waited > most {
            return self.give_up(i);
        }
        if !m.waits {
            m.leave(t);
            m.reach(m.at, GOAL_M);
        }
        m.waits = true;
        m.velocity = Point::new(0.0, 0.0);
        m.legs.clear();
        m.state = State::Busy { until: t + WAIT_S };
    }

    /// Takes its place in a line; where it is full by now it waits.
    pub(super) fn join(&mut self, i: usize, station: usize) {
        if self.lines[station].len() > self.stations[station].2.queue.len() {
            return self.wait_for_line(i);
        }
        self.lines[station].push(i);
        self.movers[i].state = State::InLine { station };
        self.movers[i].since = self.t;
    }

    pub(super) fn stand_in_line(&mut self, i: usize, station: usize) {
        let Some(k) = self.lines[station].iter().position(|j| *j == i) else { return self.finish(i) };
        let place = self.place(station, k);
        let off = self.movers[i].at.distance(place);
        let same = self.movers[i].target.distance(place) < 1e-9;
        if !same {
            // the line has moved up
            let level = self.movers[i].level;
            if !self.go(i, level, place) {
                return self.finish(i);
            }
            self.movers[i].state = State::InLine { station };
            return;
        }
        if off < THERE_M || off < FAR_M && self.t - self.movers[i].since > 2.5 {
            if !self.movers[i].legs.is_empty() {
                self.movers[i].legs.clear();
                self.movers[i].reach(place, GOAL_M.max(off + 0.1));
                self.movers[i].velocity = Point::new(0.0, 0.0);
            }
            if k == 0 {
                let m = &self.movers[i];
                let seconds = m.tasks.get(m.cursor).map_or(0.0, |t| t.seconds);
                let left = self.movers[i].resumes.take().map(|stand| stand.until.max(self.t + 1.0));
                self.movers[i].state = State::Busy { until: left.unwrap_or(self.t + seconds) };
            }
            return;
        }
        if self.movers[i].legs.is_empty() {
            let level = self.movers[i].level;
            if !self.go(i, level, place) {
                return self.finish(i);
            }
            self.movers[i].state = State::InLine { station };
        }
        self.follow(i);
        self.step_on(i);
        if self.t - self.movers[i].since > 8.0 {
            // it cannot get to its place: it leaves the line, and comes again
            self.wait_for_line(i);
        }
    }
}
