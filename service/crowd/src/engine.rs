//! The loop: who does what, who goes where, one tenth of a second after the other.

use std::collections::BTreeMap;

use d3dgen_model::Point;
use d3dgen_model::scenario::{Act, Station};
use d3dgen_model::seed::Stream;

use crate::avoid::{Other, choose};
use crate::mover::{Mover, State, Task};
use crate::routes::{Leg, Link, Router, Walker, ride_s, standing};
use crate::search::{pull, search};
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
const PATIENCE_S: f64 = 2.0;
const PROGRESS_M: f64 = 0.15;
/// Longest time that one makes way, s.
const YIELD_S: f64 = 6.0;
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
            if k % NOTED == 0 {
                let (t, levels) = (self.t, &self.levels);
                self.movers.iter_mut().filter(|m| m.is_there()).for_each(|m| m.sample(t, levels));
            }
            if k % 100 == 0 && !observe(self.t.min(self.end)) {
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
        let there = self.movers.iter().filter(|m| m.is_there() && m.id.starts_with(&self.sources[s].id)).count();
        let (t, source) = (self.t, &mut self.sources[s]);
        if source.per_min <= 0.0 || source.next > t || there + source.waiting.len() >= source.most {
            return;
        }
        let gap = -(1.0 - source.stream.unit()).ln() * 60.0 / source.per_min;
        source.next = t + gap;
        let [low, high] = source.group;
        let size = low + source.stream.below((high - low + 1) as usize) as u32;
        let Some(tasks) = source.stream.pick(&source.itineraries).cloned() else { return };
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
            Act::Queue => self.shortest_line(&task).map(|s| {
                self.movers[i].station = Some(s);
                self.tail(s)
            }),
            _ => None,
        };
        let target = target.or_else(|| self.free_spot(i, task.level, task.room, task.at)).unwrap_or(task.at);
        if !self.go(i, task.level, target) {
            self.give_up(i);
        }
    }

    /// Gives up what it goes for; who made way stays where that was.
    fn settle(&mut self, i: usize) {
        let Some((_, until)) = self.movers[i].resumes.take() else { return self.give_up(i) };
        let (at, t) = (self.movers[i].at, self.t);
        let m = &mut self.movers[i];
        m.legs.clear();
        m.velocity = Point::new(0.0, 0.0);
        m.reach(at, GOAL_M);
        m.state = State::Busy { until: until.max(t + 1.0) };
    }

    /// Leaves a task that cannot be done.
    fn give_up(&mut self, i: usize) {
        if let Some(s) = self.movers[i].station.take() {
            self.free(s, i);
        }
        self.movers[i].missed += 1;
        self.movers[i].skips = true;
        self.movers[i].legs.clear();
        self.movers[i].state = State::Busy { until: self.t + 1.0 };
    }

    fn free(&mut self, station: usize, i: usize) {
        if self.users[station] == Some(i) {
            self.users[station] = None;
        }
        self.lines[station].retain(|k| *k != i);
    }

    /// Returns a free station of the room of a task, the nearest.
    fn free_station(&self, i: usize, task: &Task) -> Option<usize> {
        let from = self.movers[i].at;
        let fits = |(k, (level, room, s)): &(usize, &(usize, usize, Station))| {
            *level == task.level && *room == task.room && s.act == task.act && self.users[*k].is_none()
        };
        let all = self.stations.iter().enumerate().filter(fits);
        let far = |k: usize| before(&self.stations[k].2).distance(from);
        all.map(|(k, _)| k).min_by(|a, b| far(*a).total_cmp(&far(*b)))
    }

    /// Returns the counter of a room with the shortest line that has a place left.
    fn shortest_line(&self, task: &Task) -> Option<usize> {
        let fits = |(k, (level, room, s)): &(usize, &(usize, usize, Station))| {
            *level == task.level && *room == task.room && s.act == Act::Queue && self.lines[*k].len() <= s.queue.len()
        };
        let all = self.stations.iter().enumerate().filter(fits);
        all.map(|(k, _)| k).min_by_key(|k| self.lines[*k].len())
    }

    /// Returns the place in a line, 0 for who is served.
    fn place(&self, station: usize, k: usize) -> Point {
        let s = &self.stations[station].2;
        if k == 0 { before(s) } else { s.queue.get(k - 1).or(s.queue.last()).copied().unwrap_or(before(s)) }
    }

    fn tail(&self, station: usize) -> Point {
        self.place(station, self.lines[station].len())
    }

    /// Returns a place to stand near a point where nobody stands or is about to.
    fn free_spot(&self, i: usize, level: usize, room: usize, p: Point) -> Option<Point> {
        let radius = self.movers[i].radius;
        let taken: Vec<Point> = self
            .movers
            .iter()
            .enumerate()
            .filter(|(j, m)| *j != i && m.is_there() && m.level == level)
            .flat_map(|(_, m)| [m.target].into_iter().chain((!m.is_walking()).then_some(m.at)))
            .filter(|q| q.distance(p) < 4.0)
            .collect();
        let space = &self.spaces[level];
        let start = standing(space, room, p, radius)?;
        let open = |n: usize| {
            let q = space.point(n);
            taken.iter().all(|o| o.distance(q) >= APART_M.max(2.0 * radius))
        };
        if taken.iter().all(|o| o.distance(p) >= APART_M) && space.node(p) == start {
            return Some(p);
        }
        let (_, found) = search(space, start, radius, |n| space.belongs(n, room), open, 4.0);
        found.map(|n| space.point(n))
    }

    /// Sets off to a place; false where there is no way.
    fn go(&mut self, i: usize, level: usize, to: Point) -> bool {
        let legs = self.route(i, level, to);
        let Some(legs) = legs else { return false };
        let m = &mut self.movers[i];
        m.leave(self.t);
        m.legs = legs;
        m.corner = 0;
        m.target = to;
        m.left = f64::MAX;
        m.since = self.t;
        m.state = State::Walking;
        true
    }

    fn route(&mut self, i: usize, level: usize, to: Point) -> Option<Vec<Leg>> {
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
    fn walk(&mut self, i: usize) {
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

    fn is_queueing(&self, i: usize) -> bool {
        let m = &self.movers[i];
        !m.leaving && m.tasks.get(m.cursor).is_some_and(|t| t.act == Act::Queue)
    }

    /// Returns true where somebody stands on the target and one waits beside it for a while already.
    fn nearly(&self, i: usize, off: f64, final_leg: bool) -> bool {
        let m = &self.movers[i];
        let on_seat = m.station.is_some() && !self.is_queueing(i);
        let reach = if on_seat { 0.4 } else { NEARLY_M };
        final_leg && (off < reach && self.t - m.since > 1.5 || !on_seat && off < FAR_M && m.tries > 1)
    }

    /// Goes on to the next corner where that is seen.
    fn follow(&mut self, i: usize) {
        let (level, at, radius) = (self.movers[i].level, self.movers[i].at, self.movers[i].radius);
        let obstacles = &self.spaces[level].obstacles;
        let Some(leg) = self.movers[i].legs.first() else { return };
        let mut corner = self.movers[i].corner;
        while corner + 1 < leg.way.len() {
            let near = at.distance(leg.way[corner]) < 0.15;
            let least = (radius + 0.02).min(self.spaces[level].clear(self.spaces[level].node(leg.way[corner])));
            let sees =
                at.distance(leg.way[corner]) < 1.5 && obstacles.along(at, leg.way[corner + 1], least) >= least - 1e-6;
            if near || sees { corner += 1 } else { break }
        }
        self.movers[i].corner = corner;
    }

    /// Opens a closed door on the way; true while it does.
    fn opens_door(&mut self, i: usize, level: usize, at: Point) -> bool {
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
    fn step_on(&mut self, i: usize) {
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

    /// Sees whether it gets on, and does something about it where not.
    fn look_after(&mut self, i: usize) {
        let left = self.movers[i].length_left();
        if self.movers[i].left == f64::MAX {
            // a new way: nothing is known of how one gets on
            self.movers[i].left = left;
        } else if left < self.movers[i].left - PROGRESS_M {
            self.movers[i].left = left;
            self.movers[i].since = self.t;
            self.movers[i].tries = 0;
            return;
        }
        if self.t - self.movers[i].since < PATIENCE_S {
            return;
        }
        self.movers[i].since = self.t;
        self.movers[i].left = f64::MAX;
        self.movers[i].tries += 1;
        let stuck = self.movers[i].tries % 4 == 3;
        if let Some(k) = self.blocker(i).filter(|_| stuck)
            && self.steps_back(i, k)
        {
            return;
        }
        if self.movers[i].tries > MOST_TRIES && !self.movers[i].leaving {
            return self.settle(i);
        }
        let Some(k) = self.blocker(i) else { return self.again(i) };
        let moves = self.movers[k].is_walking();
        let odd = self.movers[i].tries % 2 == 1;
        if !moves && self.detour(i) {
            return;
        }
        // robots make way for people, else the later one; the other one next time
        let first =
            self.movers[i].robot && !self.movers[k].robot || self.movers[i].robot == self.movers[k].robot && i > k;
        let (gives, takes) = if (first == odd || self.movers[k].is_seated()) && moves { (i, k) } else { (k, i) };
        let _ = self.yields(gives, takes) || self.yields(takes, gives) || self.detour(i);
    }

    /// Looks for the way anew.
    fn again(&mut self, i: usize) {
        let Some((level, to)) = self.movers[i].legs.last().and_then(|leg| Some((leg.level, *leg.way.last()?))) else {
            return;
        };
        if let Some(legs) = self.route(i, level, to) {
            self.movers[i].legs = legs;
            self.movers[i].corner = 0;
        }
    }

    /// Returns who is in the way.
    fn blocker(&self, i: usize) -> Option<usize> {
        let m = &self.movers[i];
        let next = m.legs.first().and_then(|leg| leg.way.get(m.corner)).copied()?;
        let far = m.at.distance(next).max(1e-6);
        let way = Point::new((next.x - m.at.x) / far, (next.y - m.at.y) / far);
        let ahead = |k: &usize| {
            let o = self.movers[*k].at;
            let (dx, dy) = (o.x - m.at.x, o.y - m.at.y);
            dx * way.x + dy * way.y > 0.0
        };
        let near = self.near(m.level, m.at, 1.3, i);
        let ahead = near.into_iter().filter(ahead);
        ahead.min_by(|a, b| self.movers[*a].at.distance(m.at).total_cmp(&self.movers[*b].at.distance(m.at)))
    }

    /// Goes around those who stand near; false where there is no way.
    fn detour(&mut self, i: usize) -> bool {
        let m = &self.movers[i];
        let (level, at, radius) = (m.level, m.at, m.radius);
        let space = &self.spaces[level];
        let Some(leg) = m.legs.first() else { return false };
        let stands: Vec<(Point, f64)> = self
            .near(level, at, 5.0, i)
            .into_iter()
            .filter(|k| !self.movers[*k].is_walking() || self.movers[*k].at.distance(at) < 1.0)
            .map(|k| (self.movers[k].at, self.movers[k].radius + radius))
            .collect();
        let open = |n: usize| {
            space.zone(n) != crate::space::NOWHERE
                && stands.iter().all(|(o, reach)| space.point(n).distance(*o) >= *reach)
        };
        // the first corner ahead that is not taken
        let ahead = (m.corner..leg.way.len()).find(|c| leg.way[*c].distance(at) > 0.8 && open(space.node(leg.way[*c])));
        let Some(corner) = ahead else { return false };
        let (start, end) = (space.node(at), space.node(leg.way[corner]));
        let start = if space.clear(start) >= radius { start } else { return false };
        let (field, found) = search(space, start, radius, open, |n| n == end, 15.0);
        let Some(found) = found else { return false };
        let mut nodes = field.back(found);
        nodes.reverse();
        // straight lines would lead through those who stand
        let mut way: Vec<Point> = nodes.iter().step_by(3).map(|n| space.point(*n)).collect();
        way.push(space.point(end));
        let leg = &mut self.movers[i].legs[0];
        way.extend(leg.way[corner..].iter().copied());
        leg.way = way;
        self.movers[i].corner = 0;
        true
    }

    /// Lets one of two make way for the other; false where there is no floor for that.
    fn yields(&mut self, gives: usize, takes: usize) -> bool {
        let other = &self.movers[takes];
        let mut way = other.way_left();
        way.truncate(6);
        let reach = self.movers[gives].radius + other.radius + 0.08;
        let is_aside = |p: Point| way.windows(2).all(|w| off_line(p, w[0], w[1]) >= reach);
        self.goes_aside(gives, takes, &is_aside)
    }

    /// Steps back a little; false where there is no floor for that.
    fn steps_back(&mut self, i: usize, from: usize) -> bool {
        let (at, other) = (self.movers[i].at, self.movers[from].at);
        self.goes_aside(i, from, &|p: Point| p.distance(at) >= BACK_M && p.distance(other) >= at.distance(other))
    }

    /// Lets somebody go to the nearest place that is aside, to wait there for another one to pass.
    fn goes_aside(&mut self, gives: usize, takes: usize, is_aside: &dyn Fn(Point) -> bool) -> bool {
        let m = &self.movers[gives];
        let until = if let State::Busy { until } = m.state { until } else { self.t };
        let stands = matches!(m.state, State::Busy { .. }) && !self.is_queueing(gives) && !m.skips;
        if !(m.state == State::Walking || stands) || m.is_seated() {
            return false;
        }
        let (level, radius, at) = (m.level, m.radius, m.at);
        let space = &self.spaces[level];
        let others: Vec<(Point, f64)> = self
            .near(level, at, 6.0, gives)
            .into_iter()
            .map(|k| (self.movers[k].at, self.movers[k].radius + radius - 0.04))
            .collect();
        let may = |n: usize| {
            space.zone(n) != crate::space::NOWHERE && others.iter().all(|(o, r)| space.point(n).distance(*o) >= *r)
        };
        let start = space.node(at);
        let start = if space.clear(start) >= radius {
            Some(start)
        } else {
            space.room_at(at).and_then(|r| standing(space, r, at, radius))
        };
        let Some(start) = start else { return false };
        let (field, found) = search(space, start, radius, may, |n| is_aside(space.point(n)), 8.0);
        let Some(found) = found else { return false };
        let mut nodes = field.back(found);
        nodes.reverse();
        let way = pull(space, &nodes, radius);
        let t = self.t;
        let m = &mut self.movers[gives];
        if stands {
            m.leave(t);
            m.resumes = Some((m.at, until));
        }
        let rest = std::mem::take(&mut m.legs);
        m.legs = vec![Leg { level, way, ride: None }];
        if let Some(last) = rest.last().filter(|_| !stands) {
            m.legs.push(last.clone());
        }
        m.corner = 0;
        m.begin_pause(t, "yield");
        m.state = State::Yielding { until: t + YIELD_S, to: takes, arrived: false };
        true
    }

    /// Goes aside, waits until the other one has passed, and goes on.
    fn make_way(&mut self, i: usize, until: f64, to: usize, arrived: bool) {
        let m = &self.movers[i];
        let end = m.legs.first().and_then(|leg| leg.way.last()).copied().unwrap_or(m.at);
        let there = arrived || m.at.distance(end) < THERE_M;
        let other = &self.movers[to];
        let passed =
            !other.is_there() || other.level != m.level || other.at.distance(m.at) > 2.0 || !other.is_walking();
        if self.t >= until || there && passed && self.t > until - YIELD_S + 1.0 {
            self.movers[i].end_pause(self.t);
            let first = 1.min(self.movers[i].legs.len());
            let rest: Vec<Leg> = self.movers[i].legs.split_off(first);
            // who stood goes back to where that was
            let back = self.movers[i].resumes.map(|(at, _)| (self.movers[i].level, at));
            let Some((level, at)) = back.or_else(|| rest.last().and_then(|leg| Some((leg.level, *leg.way.last()?))))
            else {
                return self.finish(i);
            };
            let target = self.movers[i].target;
            let went = self.go(i, level, at);
            self.movers[i].target = target;
            if !went {
                self.give_up(i);
            }
            return;
        }
        if !there {
            self.follow(i);
            self.step_on(i);
        } else {
            self.movers[i].velocity = Point::new(0.0, 0.0);
        }
        self.movers[i].state = State::Yielding { until, to, arrived: there };
    }

    /// Does at the end of the way what it went for.
    fn arrive(&mut self, i: usize) {
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
        let resumed = self.movers[i].resumes.take().map(|(_, until)| until.max(self.t + 1.0));
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
        if let Some(s) = self.movers[i].station.take() {
            self.free(s, i);
        }
        let m = &mut self.movers[i];
        m.leave(t);
        if m.cursor < m.tasks.len() && !std::mem::take(&mut m.skips) {
            m.done.push(m.cursor);
        }
        m.cursor += 1;
        m.state = State::Idle;
    }

    fn get_on(&mut self, i: usize, since: f64, until: f64) {
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

    fn is_before_free(&self, i: usize) -> bool {
        let m = &self.movers[i];
        let Some(s) = m.station else { return true };
        let at = before(&self.stations[s].2);
        self.near(m.level, at, 1.0, i).into_iter().all(|k| {
            let o = &self.movers[k];
            o.is_settled() || o.at.distance(at) >= o.radius + m.radius
        })
    }

    /// Returns true when somebody is met at a place who comes nearer by that.
    fn is_met(&self, i: usize, next: Point) -> bool {
        let m = &self.movers[i];
        let meets = |k: usize| {
            let o = &self.movers[k];
            let off = o.at.distance(next);
            !o.is_settled() && off < o.radius + m.radius - 0.05 && off < o.at.distance(m.at)
        };
        self.near(m.level, next, 1.0, i).into_iter().any(meets)
    }

    fn get_off(&mut self, i: usize, since: f64) {
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

    /// Takes its place in a line, or is served where there is none.
    fn join(&mut self, i: usize, station: usize) {
        if self.lines[station].len() > self.stations[station].2.queue.len() {
            return self.give_up(i);
        }
        self.lines[station].push(i);
        self.movers[i].state = State::InLine { station };
        self.movers[i].since = self.t;
    }

    fn stand_in_line(&mut self, i: usize, station: usize) {
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
                self.movers[i].state = State::Busy { until: self.t + seconds };
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
            // it cannot get to its place: it leaves the line
            self.finish(i);
        }
    }

    /// Returns a place at a stop of a link that nobody has taken or stands on; where it is already counts as free.
    fn slot(&self, i: usize, (link, stop): (usize, usize), here: bool) -> Option<usize> {
        let (level, slots) = &self.links[link].stops[stop];
        let is_free = |k: &usize| {
            let place = slots[*k];
            let taken = self.riders.get(&(link, stop, *k)).is_some_and(|r| *r != i);
            let near = self.near(*level, place, 2.0 * self.movers[i].radius, i);
            !taken && (near.is_empty() || here && self.movers[i].at.distance(place) < 0.05)
        };
        (0..slots.len()).find(is_free)
    }

    /// Waits for a place at both ends of stairs or a lift, and takes it.
    fn board(&mut self, i: usize) {
        let Some((link, to)) = self.movers[i].legs.first().and_then(|leg| leg.ride) else { return self.arrive(i) };
        let level = self.movers[i].level;
        let stop = |level: usize| self.links[link].stops.iter().position(|(l, _)| *l == level);
        let Some(from) = stop(level) else { return self.arrive(i) };
        let own = self.riders.iter().find(|((l, s, _), r)| **r == i && *l == link && *s == from).map(|((.., k), _)| *k);
        let Some(k) = own.or_else(|| self.slot(i, (link, from), true)) else {
            self.movers[i].velocity = Point::new(0.0, 0.0);
            return;
        };
        self.riders.insert((link, from, k), i);
        let place = self.links[link].stops[from].1[k];
        if self.movers[i].at.distance(place) < 2.0 * THERE_M || self.t - self.movers[i].since > 6.0 {
            let Some(other) = self.slot(i, (link, to), false) else { return };
            self.riders.insert((link, to, other), i);
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
            self.movers[i].target = place;
        }
        self.follow(i);
        self.step_on(i);
    }

    fn alight(&mut self, i: usize, link: usize, from: (usize, usize), to: (usize, usize)) {
        self.riders.remove(&(link, from.0, from.1));
        let (level, slots) = &self.links[link].stops[to.0];
        let m = &mut self.movers[i];
        m.leave(self.t);
        m.level = *level;
        m.at = slots[to.1];
        m.since = self.t;
        m.left = f64::MAX;
        m.legs.remove(0);
        m.corner = 0;
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

fn square(p: Point) -> (i32, i32) {
    ((p.x / SQUARE_M).floor() as i32, (p.y / SQUARE_M).floor() as i32)
}

fn before(s: &Station) -> Point {
    Point::new(s.before.x, s.before.y)
}

fn seat(s: &Station) -> Point {
    Point::new(s.at.x, s.at.y)
}

/// Returns how far a point is from a line between two, m.
fn off_line(p: Point, a: Point, b: Point) -> f64 {
    let (dx, dy) = (b.x - a.x, b.y - a.y);
    let length = dx * dx + dy * dy;
    let t = if length > 0.0 { (((p.x - a.x) * dx + (p.y - a.y) * dy) / length).clamp(0.0, 1.0) } else { 0.0 };
    p.distance(Point::new(a.x + t * dx, a.y + t * dy))
}
