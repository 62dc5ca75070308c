//! The loop: who does what, who goes where, one tenth of a second after the other.
//!
//! `walk` takes a step along a way, `give_way` sorts out who does not get on, `places` knows seats, beds and lines before counters,
//! `rides` stairs and lifts.

mod give_way;
mod places;
mod rides;
#[cfg(test)]
mod tests;
mod walk;

use std::collections::BTreeMap;

use d3dgen_model::Point;
use d3dgen_model::scenario::{Act, Station};
use d3dgen_model::seed::Stream;

use crate::mover::{Mover, State, Task};
use crate::routes::{Link, Router};
use crate::space::Space;

/// Time step, s; where things are noted, every so many steps.
pub const DT_S: f64 = 0.1;
const NOTED: u64 = 2;
/// How near one is to where it wants to be, m, and how near counts where somebody stands in the way.
const THERE_M: f64 = 0.12;
const NEARLY_M: f64 = 0.9;
/// The same after a while, m.
const FAR_M: f64 = 1.5;
/// How often one looks for another way before it gives up what it went for.
const MOST_TRIES: u32 = 5;
/// How far one steps back, m.
const BACK_M: f64 = 0.8;
/// How much nearer those come to each other who do not get on, m.
const SQUEEZE_M: f64 = 0.04;
/// How near counts for the record, m.
const GOAL_M: f64 = 0.5;
/// How far others are seen, m.
const SEEN_M: f64 = 3.0;
/// How near to walls one walks, below the radius, m.
const RUB_M: f64 = 0.03;
/// Time for a door, how long it stays open, and from where it is opened, m.
const OPENING_S: f64 = 0.6;
const OPEN_S: f64 = 3.0;
const HANDLE_M: f64 = 0.6;
/// Time to sit down or get up, s.
const ON_OFF_S: f64 = 1.2;
/// Time without getting on after which one looks for another way, and the way that counts as getting on, m.
pub const PATIENCE_S: f64 = 2.0;
const PROGRESS_M: f64 = 0.15;
/// Longest time that one makes way, s.
const YIELD_S: f64 = 10.0;
/// Way ahead that is kept clear for somebody, m, and how many go aside for one at most.
const LANE_M: f64 = 4.0;
const MOST_ASKED: usize = 8;
/// Distance of those who stand, m.
const APART_M: f64 = 0.55;
/// Edge of the squares that movers are sorted into, m.
const SQUARE_M: f64 = 2.0;
/// Time after the end in which those who are on their way get there, s.
const GRACE_S: f64 = 120.0;
/// How much faster the parts of a flow are not: time between two of a group, s.
const GROUP_GAP_S: f64 = 1.0;

/// Where people come in.
pub struct Source {
    pub id: String,
    pub role: String,
    pub speed: f64,
    pub level: usize,
    pub at: Point,
    pub per_min: f64,
    pub most: usize,
    pub group: [u32; 2],
    pub itineraries: Vec<Vec<Task>>,
    pub access: usize,
    pub stream: Stream,
    pub next: f64,
    pub count: u32,
    pub waiting: Vec<Mover>,
}

pub struct Engine<'e> {
    pub spaces: &'e [Space],
    pub links: &'e [Link],
    pub stations: Vec<(usize, usize, Station)>,
    pub access: Vec<Vec<Vec<bool>>>,
    pub movers: Vec<Mover>,
    pub sources: Vec<Source>,
    routers: Vec<(u64, Router)>,
    /// Who uses a station; who stands in line before it.
    users: Vec<Option<usize>>,
    lines: Vec<Vec<usize>>,
    /// By storey and door: until when it stands open.
    open_until: Vec<Vec<f64>>,
    /// Places of links that are taken: link, stop, slot.
    riders: BTreeMap<(usize, usize, usize), usize>,
    squares: Vec<BTreeMap<(i32, i32), Vec<usize>>>,
    levels: Vec<i32>,
    t: f64,
    end: f64,
}

impl<'e> Engine<'e> {
    pub fn new(spaces: &'e [Space], links: &'e [Link], stations: Vec<(usize, usize, Station)>, end: f64) -> Self {
        let open_until = spaces.iter().map(|s| vec![0.0; s.doors.len()]).collect();
        let levels = spaces.iter().map(|s| s.level).collect();
        Self {
            spaces,
            links,
            users: vec![None; stations.len()],
            lines: vec![Vec::new(); stations.len()],
            stations,
            access: Vec::new(),
            movers: Vec::new(),
            sources: Vec::new(),
            routers: Vec::new(),
            open_until,
            riders: BTreeMap::new(),
            squares: Vec::new(),
            levels,
            t: 0.0,
            end,
        }
    }

    /// Marks a station as used from the beginning.
    pub fn take(&mut self, station: usize, by: usize) {
        self.users[station] = Some(by);
    }

    /// Runs to the end; `observe` is told the time now and then and stops it by `false`.
    pub fn run(&mut self, observe: &mut dyn FnMut(f64) -> bool) -> bool {
        let steps = (self.end / DT_S).round() as u64;
        let grace = (GRACE_S / DT_S) as u64;
        for k in 0..=steps + grace {
            self.t = k as f64 * DT_S;
            let over = k > steps;
            if over {
                // who is on its way gets there, the others are done
                self.movers
                    .iter_mut()
                    .filter(|m| !m.is_walking() || m.state == State::Idle)
                    .for_each(|m| m.state = State::Gone);
                if self.movers.iter().all(|m| !m.is_there()) {
                    break;
                }
            } else {
                self.come();
            }
            self.sort();
            for i in 0..self.movers.len() {
                if self.movers[i].is_there() {
                    self.act(i, over);
                }
            }
            if k.is_multiple_of(NOTED) {
                let (t, levels) = (self.t, &self.levels);
                self.movers.iter_mut().filter(|m| m.is_there()).for_each(|m| m.sample(t, levels));
            }
            if k.is_multiple_of(100) && !observe(self.t.min(self.end)) {
                return false;
            }
        }
        true
    }

    /// Lets those in whose time has come, where nobody stands in the way.
    fn come(&mut self) {
        for i in 0..self.movers.len() {
            if self.movers[i].state == State::Coming && self.movers[i].begins <= self.t {
                let (level, at, radius) = (self.movers[i].level, self.movers[i].at, self.movers[i].radius);
                if self.is_open(level, at, radius, Some(i)) {
                    self.movers[i].state = State::Idle;
                }
            }
        }
        for s in 0..self.sources.len() {
            self.draw(s);
            let source = &self.sources[s];
            let (level, at) = (source.level, source.at);
            let ready = source.waiting.first().is_some_and(|m| m.begins <= self.t);
            if ready && self.is_open(level, at, 0.3, None) {
                let mut mover = self.sources[s].waiting.remove(0);
                mover.state = State::Idle;
                mover.since = self.t;
                self.movers.push(mover);
            }
        }
    }

    /// Draws the next group of a source.
    fn draw(&mut self, s: usize) {
        let open = self.open_itineraries(s);
        let there = self.movers.iter().filter(|m| m.is_there() && m.id.starts_with(&self.sources[s].id)).count();
        let (t, source) = (self.t, &mut self.sources[s]);
        if source.per_min <= 0.0 || source.next > t || there + source.waiting.len() >= source.most {
            return;
        }
        let gap = -(1.0 - source.stream.unit()).ln() * 60.0 / source.per_min;
        source.next = t + gap;
        let [low, high] = source.group;
        let size = low + source.stream.below((high - low + 1) as usize) as u32;
        // where there is no place for what they would come for, nobody comes
        let Some((itinerary, places)) = source.stream.pick(&open).copied() else { return };
        let tasks = source.itineraries[itinerary].clone();
        let size = size.min(u32::try_from(places).unwrap_or(u32::MAX));
        let group = (size > 1).then(|| format!("{}_group_{}", source.id, source.count + 1));
        for k in 0..size {
            source.count += 1;
            let id = format!("{}_{}", source.id, source.count);
            let mut mover = Mover::new(
                id,
                source.role.clone(),
                d3dgen_model::scenario::PERSON_RADIUS_M,
                source.speed,
                source.level,
                source.at,
            );
            mover.group.clone_from(&group);
            mover.tasks.clone_from(&tasks);
            mover.repeats = false;
            mover.exit = Some((source.level, source.at));
            mover.access = source.access;
            mover.begins = t + f64::from(k) * GROUP_GAP_S;
            source.waiting.push(mover);
        }
    }

    /// Returns the itineraries of a source for which there are places left, by index, with for how many people.
    fn open_itineraries(&self, s: usize) -> Vec<(usize, usize)> {
        let source = &self.sources[s];
        if source.next > self.t {
            return Vec::new();
        }
        let left = |task: &Task| match task.act {
            Act::Sit | Act::Lie => self.places_left(task).saturating_sub(source.waiting.len()),
            Act::Stand | Act::Talk => self.floor_left(task),
            _ => usize::MAX,
        };
        let places = |tasks: &Vec<Task>| tasks.iter().map(left).min().unwrap_or(usize::MAX);
        let all = source.itineraries.iter().map(places).enumerate();
        all.filter(|(_, places)| *places >= source.group[0] as usize).collect()
    }

    fn is_open(&self, level: usize, at: Point, radius: f64, but: Option<usize>) -> bool {
        self.movers
            .iter()
            .enumerate()
            .all(|(j, m)| Some(j) == but || !m.is_there() || m.level != level || m.at.distance(at) >= m.radius + radius)
    }

    fn sort(&mut self) {
        self.squares = vec![BTreeMap::new(); self.spaces.len()];
        for (i, m) in self.movers.iter().enumerate().filter(|(_, m)| m.is_there()) {
            self.squares[m.level].entry(square(m.at)).or_default().push(i);
        }
    }

    /// Returns who is near a point.
    fn near(&self, level: usize, at: Point, reach: f64, but: usize) -> Vec<usize> {
        let (i, j) = square(at);
        let n = (reach / SQUARE_M).ceil() as i32;
        let mut out = Vec::new();
        for dj in -n..=n {
            for di in -n..=n {
                let here = self.squares[level].get(&(i + di, j + dj)).into_iter().flatten();
                out.extend(here.copied().filter(|k| {
                    *k != but
                        && self.movers[*k].level == level
                        && self.movers[*k].is_there()
                        && self.movers[*k].at.distance(at) <= reach
                }));
            }
        }
        out
    }

    /// One step of one of them.
    fn act(&mut self, i: usize, over: bool) {
        match self.movers[i].state.clone() {
            State::Coming | State::Gone => {}
            State::Idle => {
                if over {
                    self.movers[i].state = State::Gone;
                } else {
                    self.next_task(i);
                }
            }
            State::Walking => self.walk(i),
            State::Opening { until } => {
                if self.t >= until {
                    self.movers[i].end_pause(self.t);
                    self.movers[i].state = State::Walking;
                }
            }
            State::BeforeRide => self.board(i),
            State::Riding { until, link, from, to } => {
                if self.t >= until {
                    self.alight(i, link, from, to);
                }
            }
            State::InLine { station } => self.stand_in_line(i, station),
            State::Busy { until } => {
                if self.t >= until {
                    self.finish(i);
                }
            }
            State::GettingOn { since, until } => self.get_on(i, since, until),
            State::On { until } => {
                if self.t >= until && self.is_before_free(i) {
                    self.movers[i].state = State::GettingOff { since: self.t };
                }
            }
            State::GettingOff { since } => self.get_off(i, since),
            State::Yielding { until, to, arrived } => self.make_way(i, until, to, arrived),
        }
    }

    /// Begins the next task, or leaves.
    fn next_task(&mut self, i: usize) {
        let m = &self.movers[i];
        if m.cursor >= m.tasks.len() {
            if m.repeats && !m.tasks.is_empty() && m.missed < 3 * m.tasks.len() as u32 {
                self.movers[i].cursor = 0;
            } else if let (Some((level, at)), false) = (m.exit, m.leaving) {
                self.movers[i].leaving = true;
                if !self.go(i, level, at) {
                    self.movers[i].state = State::Gone;
                }
                return;
            } else {
                self.movers[i].state = if m.leaving { State::Gone } else { State::Busy { until: self.end } };
                return;
            }
        }
        self.movers[i].tries = 0;
        let task = self.movers[i].tasks[self.movers[i].cursor].clone();
        let target = match task.act {
            Act::Sit | Act::Lie | Act::Operate => {
                let station = task
                    .station
                    .filter(|s| self.users[*s].is_none_or(|u| u == i))
                    .or_else(|| self.free_station(i, &task));
                if let Some(s) = station {
                    self.users[s] = Some(i);
                    self.movers[i].station = Some(s);
                }
                station.map(|s| before(&self.stations[s].2))
            }
            Act::Queue => {
                let line = self.shortest_line(&task);
                if line.is_none() && self.movers[i].waits {
                    return self.wait_for_line(i);
                }
                self.movers[i].station = line;
                line.map(|s| self.tail(s))
            }
            _ => None,
        };
        let target = target.or_else(|| self.free_spot(i, task.level, task.room, task.at)).unwrap_or(task.at);
        if !self.go(i, task.level, target) {
            self.give_up(i);
        }
    }

    /// Leaves a task that cannot be done.
    fn give_up(&mut self, i: usize) {
        if let Some(s) = self.movers[i].station.take() {
            self.free(s, i);
        }
        let t = self.t;
        let m = &mut self.movers[i];
        m.waits = false;
        m.missed += 1;
        m.skips = true;
        m.legs.clear();
        m.state = State::Busy { until: t + 1.0 };
    }

    /// Does at the end of the way what it went for.
    fn arrive(&mut self, i: usize) {
        let t = self.t;
        self.movers[i].end_pause(t);
        self.movers[i].velocity = Point::new(0.0, 0.0);
        let target = self.movers[i].legs.last().and_then(|leg| leg.way.last()).copied().unwrap_or(self.movers[i].at);
        let off = self.movers[i].at.distance(target);
        self.movers[i].reach(target, if off > GOAL_M - 0.05 { off + 0.1 } else { GOAL_M });
        if self.movers[i].leaving {
            let (t, levels) = (self.t, &self.levels);
            self.movers[i].sample(t, levels);
            self.movers[i].state = State::Gone;
            return;
        }
        let m = &self.movers[i];
        let Some(task) = m.tasks.get(m.cursor) else {
            self.movers[i].state = State::Idle;
            return;
        };
        let task = task.clone();
        let resumed = self.movers[i].resumes.take().map(|stand| stand.until.max(self.t + 1.0));
        if resumed.is_none() && self.movers[i].station.is_none() && self.has_line(&task) {
            return self.wait_for_line(i);
        }
        let until = resumed.unwrap_or(self.t + task.seconds);
        let m = &self.movers[i];
        let lies_or_sits = matches!(task.act, Act::Sit | Act::Lie);
        let kind = if task.act == Act::Lie { "bed" } else { "seat" };
        if lies_or_sits && m.station.is_some() {
            self.movers[i].begin_pause(self.t, kind);
            self.movers[i].state = State::GettingOn { since: self.t, until };
        } else {
            self.movers[i].state = State::Busy { until };
        }
    }

    /// A task is done: on to the next.
    fn finish(&mut self, i: usize) {
        let t = self.t;
        if self.movers[i].waits && !self.movers[i].skips {
            // it looks again whether there is a place
            self.movers[i].state = State::Idle;
            return;
        }
        if let Some(s) = self.movers[i].station.take() {
            self.free(s, i);
        }
        let m = &mut self.movers[i];
        m.leave(t);
        if m.cursor < m.tasks.len() && !std::mem::take(&mut m.skips) {
            m.done.push(m.cursor);
        }
        m.cursor += 1;
        m.waited = 0;
        m.state = State::Idle;
    }
}

fn square(p: Point) -> (i32, i32) {
    ((p.x / SQUARE_M).floor() as i32, (p.y / SQUARE_M).floor() as i32)
}

fn before(s: &Station) -> Point {
    Point::new(s.before.x, s.before.y)
}

fn seat(s: &Station) -> Point {
    Point::new(s.at.x, s.at.y)
}
