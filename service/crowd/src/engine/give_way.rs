//! Right of way: who does not get on goes around those who stand, else asks those in its way aside, or goes aside itself where
//! that is shorter. Who is asked and has no floor of its own asks those behind it in turn.

use d3dgen_model::Point;

use super::{BACK_M, Engine, LANE_M, MOST_ASKED, MOST_TRIES, PATIENCE_S, PROGRESS_M, THERE_M, YIELD_S};
use crate::mover::{Stand, State};
use crate::routes::{Leg, standing};
use crate::search::{pull, search};
use crate::space::NOWHERE;

/// Who walks within this of the direction of another one goes the same way (cosine).
const SAME_WAY: f64 = 0.5;
/// How far ahead somebody is in the way, m.
const AHEAD_M: f64 = 1.3;
/// How far others are looked at who may be asked aside, m; and how far somebody goes aside at most.
const AROUND_M: f64 = 6.0;
const ASIDE_M: f64 = 8.0;
/// Room beside a way that is kept clear, m: as one passes with ease, and with shoulders turned.
const BESIDE_M: [f64; 2] = [0.06, -0.05];
/// How far the way of another one leads past before one goes on, m.
const PAST_M: f64 = 0.6;

/// Somebody goes aside.
struct Aside {
    who: usize,
    way: Vec<Point>,
}

/// Who goes aside so that somebody gets on.
#[derive(Default)]
struct Plan {
    asides: Vec<Aside>,
    /// Ways that are kept clear, with the radius of who takes them.
    lanes: Vec<(Vec<Point>, f64)>,
    /// Room beside them, m.
    beside: f64,
    /// Who stays where it is.
    stays: Vec<usize>,
}

impl Plan {
    fn length(&self) -> f64 {
        self.asides.iter().map(|a| length(&a.way)).sum()
    }

    fn asks(&self, who: usize) -> bool {
        self.asides.iter().any(|a| a.who == who)
    }
}

impl Engine<'_> {
    /// Sees whether it gets on, and does something about it where not.
    pub(super) fn look_after(&mut self, i: usize) {
        let left = self.movers[i].length_left();
        if self.movers[i].left == f64::MAX {
            // a new way: nothing is known of how one gets on
            self.movers[i].left = left;
        } else if left < self.movers[i].left - PROGRESS_M {
            self.movers[i].left = left;
            let t = self.t;
            let m = &mut self.movers[i];
            m.end_pause(t);
            m.since = t;
            m.tries = 0;
            return;
        }
        if self.t - self.movers[i].since < PATIENCE_S {
            return;
        }
        self.movers[i].since = self.t;
        self.movers[i].left = f64::MAX;
        let blocker = self.blocker(i);
        let behind = |k: usize| {
            let in_front = self.movers[k].state == State::Walking && self.goes_the_same_way(i, k);
            // of two who each find the other in front one does not wait
            in_front && !(i < k && self.blocker(k) == Some(i))
        };
        if blocker.is_some_and(behind) {
            // those behind wait for the one in front, who sorts it out
            return self.movers[i].wait_behind(self.t);
        }
        self.movers[i].tries += 1;
        if self.movers[i].tries > MOST_TRIES && !self.movers[i].leaving {
            return self.settle(i);
        }
        match blocker {
            None => self.again(i),
            Some(k) if !self.movers[k].is_walking() && self.detour(i) => {}
            Some(k) if self.settles_with(i, k) || self.detour(i) || self.steps_back(i, k) => {}
            // nobody has floor to give, such as a line before a counter: until it moves up
            Some(_) => self.movers[i].wait_behind(self.t),
        }
    }

    /// Looks for the way anew.
    fn again(&mut self, i: usize) {
        let Some((level, to)) = self.movers[i].legs.last().and_then(|leg| Some((leg.level, *leg.way.last()?))) else {
            return;
        };
        if let Some(legs) = self.route(i, level, to) {
            self.movers[i].legs = legs;
            self.movers[i].corner = 0;
            self.movers[i].careful = 0;
        }
    }

    /// Returns the direction that somebody walks in, as a vector of length 1.
    fn heading(&self, i: usize) -> Option<Point> {
        let m = &self.movers[i];
        let next = m.legs.first().and_then(|leg| leg.way.get(m.corner)).copied()?;
        let far = m.at.distance(next).max(1e-6);
        Some(Point::new((next.x - m.at.x) / far, (next.y - m.at.y) / far))
    }

    fn goes_the_same_way(&self, i: usize, k: usize) -> bool {
        let both = self.heading(i).zip(self.heading(k));
        both.is_some_and(|(a, b)| a.x * b.x + a.y * b.y > SAME_WAY)
    }

    /// Returns who is in the way.
    fn blocker(&self, i: usize) -> Option<usize> {
        let (m, way) = (&self.movers[i], self.heading(i)?);
        let ahead = |k: &usize| {
            let o = self.movers[*k].at;
            let (dx, dy) = (o.x - m.at.x, o.y - m.at.y);
            dx * way.x + dy * way.y > 0.0
        };
        let near = self.near(m.level, m.at, AHEAD_M, i);
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
            space.zone(n) != NOWHERE && stands.iter().all(|(o, reach)| space.point(n).distance(*o) >= *reach)
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
        let m = &mut self.movers[i];
        m.careful = way.len();
        way.extend(m.legs[0].way[corner..].iter().copied());
        m.legs[0].way = way;
        m.corner = 0;
        true
    }

    /// Lets those go aside who are in the way of somebody, or lets it go aside for the one that it meets: what is shorter, and of
    /// what is as long robots before people. False where there is no floor for either.
    fn settles_with(&mut self, i: usize, k: usize) -> bool {
        let asked = self.plan(&[i], &self.in_lane(i));
        let goes = if self.movers[k].is_walking() { self.plan(&[k], &[i]) } else { None };
        let dear = |plan: &Option<Plan>, who: usize| {
            let robot = if self.movers[who].robot { 0.5 } else { 1.0 };
            plan.as_ref().map_or(f64::MAX, |p| robot * p.length())
        };
        let (plan, takes) = if dear(&goes, i) < dear(&asked, k) { (goes, k) } else { (asked, i) };
        let Some(plan) = plan else { return false };
        if plan.asides.is_empty() {
            return false;
        }
        for aside in plan.asides {
            self.sets_aside(aside, takes);
        }
        true
    }

    /// Returns the way of somebody that is kept clear for it.
    fn lane(&self, i: usize) -> Vec<Point> {
        let mut left = LANE_M;
        let way = self.movers[i].way_left();
        let mut out = vec![self.movers[i].at];
        for w in way.windows(2) {
            let far = w[0].distance(w[1]);
            if far > left {
                let k = left / far;
                out.push(Point::new(w[0].x + k * (w[1].x - w[0].x), w[0].y + k * (w[1].y - w[0].y)));
                break;
            }
            left -= far;
            out.push(w[1]);
        }
        out
    }

    /// Returns those in the way of somebody who can be asked aside, the nearest first.
    fn in_lane(&self, i: usize) -> Vec<usize> {
        let (m, lane) = (&self.movers[i], self.lane(i));
        let mut out = self.near(m.level, m.at, AHEAD_M, i);
        out.retain(|k| off(self.movers[*k].at, &lane) < m.radius + self.movers[*k].radius + BESIDE_M[1]);
        out.retain(|k| self.can_go_aside(*k));
        out.sort_by(|a, b| self.movers[*a].at.distance(m.at).total_cmp(&self.movers[*b].at.distance(m.at)));
        out
    }

    /// Returns who goes aside where so that some keep their way while others give it; `None` where that cannot be.
    fn plan(&self, keep: &[usize], give: &[usize]) -> Option<Plan> {
        let lanes: Vec<(Vec<Point>, f64)> = keep.iter().map(|k| (self.lane(*k), self.movers[*k].radius)).collect();
        BESIDE_M.into_iter().find_map(|beside| {
            let mut plan = Plan { asides: Vec::new(), lanes: lanes.clone(), beside, stays: keep.to_vec() };
            give.iter().all(|k| plan.asks(*k) || self.asks_aside(*k, &mut plan)).then_some(plan)
        })
    }

    /// Adds that somebody goes aside, and those whom it asks in turn; false, and the plan is as before, where it cannot.
    fn asks_aside(&self, who: usize, plan: &mut Plan) -> bool {
        if plan.asides.len() >= MOST_ASKED || !self.can_go_aside(who) {
            return false;
        }
        let (asides, lanes) = (plan.asides.len(), plan.lanes.len());
        for asks in [false, true] {
            let Some(way) = self.way_aside(who, plan, asks) else { continue };
            let (level, radius) = (self.movers[who].level, self.movers[who].radius);
            let mut met = self.near(level, self.movers[who].at, AROUND_M, who);
            met.retain(|k| off(self.movers[*k].at, &way) < radius + self.movers[*k].radius + BESIDE_M[1]);
            met.retain(|k| !plan.asks(*k) && !plan.stays.contains(k) && !self.movers[*k].is_settled());
            plan.asides.push(Aside { who, way: way.clone() });
            plan.lanes.push((way, radius));
            if met.into_iter().all(|k| plan.asks(k) || self.asks_aside(k, plan)) {
                return true;
            }
            plan.asides.truncate(asides);
            plan.lanes.truncate(lanes);
        }
        false
    }

    /// Returns the way to the nearest floor beside all ways that are kept clear: around others, or through those who can be asked.
    fn way_aside(&self, who: usize, plan: &Plan, asks: bool) -> Option<Vec<Point>> {
        let m = &self.movers[who];
        let (radius, space) = (m.radius, &self.spaces[m.level]);
        let near = self.near(m.level, m.at, AROUND_M, who).into_iter().filter(|k| !plan.asks(*k));
        let near = near.filter(|k| !asks || plan.stays.contains(k) || !self.can_go_aside(*k));
        let fixed: Vec<(Point, f64)> =
            near.map(|k| (self.movers[k].at, self.movers[k].radius + radius + BESIDE_M[1])).collect();
        let start = space.node(m.at);
        let start = match space.clear(start) >= radius {
            true => start,
            false => standing(space, space.room_at(m.at)?, m.at, radius)?,
        };
        let may = |n: usize| {
            space.zone(n) != NOWHERE
                && fixed.iter().all(|(o, reach)| n == start || space.point(n).distance(*o) >= *reach)
        };
        let is_aside = |n: usize| {
            let p = space.point(n);
            plan.lanes.iter().all(|(lane, r)| off(p, lane) >= r + radius + plan.beside)
        };
        let (field, found) = search(space, start, radius, may, is_aside, ASIDE_M);
        let mut nodes = field.back(found?);
        nodes.reverse();
        Some(pull(space, &nodes, radius))
    }

    /// Returns true for one who can be asked to step aside: who walks or stands, and does not get on or off something.
    fn can_go_aside(&self, k: usize) -> bool {
        let m = &self.movers[k];
        match m.state {
            State::Walking | State::InLine { .. } => true,
            State::Busy { .. } => !m.skips,
            State::Yielding { arrived, .. } => arrived,
            _ => false,
        }
    }

    /// Sends somebody aside, to wait there for another one to pass.
    fn sets_aside(&mut self, aside: Aside, takes: usize) {
        let (t, way) = (self.t, aside.way);
        let m = &mut self.movers[aside.who];
        let first = Leg { level: m.level, way, ride: None };
        m.met = m.at;
        m.corner = 0;
        m.careful = 0;
        match m.state {
            State::Busy { until } => {
                m.leave(t);
                // who waits for a line looks for a place anew
                m.resumes = (!m.waits).then_some(Stand { at: m.at, until });
                m.legs = vec![first];
            }
            State::InLine { .. } => {
                m.leave(t);
                m.legs = vec![first];
            }
            State::Yielding { .. } => {
                m.end_pause(t);
                m.legs.truncate(2);
                m.legs.splice(..m.legs.len().min(1), [first]);
            }
            _ => {
                let last = m.legs.pop();
                m.legs = std::iter::once(first).chain(last).collect();
            }
        }
        if m.may_stand(t, YIELD_S) {
            m.begin_pause(t, "yield");
        }
        m.state = State::Yielding { until: t + YIELD_S, to: takes, arrived: false };
    }

    /// Steps back a little; false where there is no floor for that.
    fn steps_back(&mut self, i: usize, from: usize) -> bool {
        let m = &self.movers[i];
        let other = self.movers[from].at;
        let (at, space, radius) = (m.at, &self.spaces[m.level], m.radius);
        let fixed: Vec<(Point, f64)> = self
            .near(m.level, at, AROUND_M, i)
            .into_iter()
            .map(|k| (self.movers[k].at, self.movers[k].radius + radius + BESIDE_M[1]))
            .collect();
        let start = space.node(at);
        if space.clear(start) < radius {
            return false;
        }
        let may = |n: usize| {
            space.zone(n) != NOWHERE
                && fixed.iter().all(|(o, reach)| n == start || space.point(n).distance(*o) >= *reach)
        };
        let is_back = |n: usize| {
            let p = space.point(n);
            p.distance(at) >= BACK_M && p.distance(other) >= at.distance(other)
        };
        let (field, found) = search(space, start, radius, may, is_back, ASIDE_M);
        let Some(found) = found else { return false };
        let mut nodes = field.back(found);
        nodes.reverse();
        let way = pull(space, &nodes, radius);
        self.sets_aside(Aside { who: i, way }, from);
        true
    }

    /// Goes aside, waits until the other one has passed, and goes on.
    pub(super) fn make_way(&mut self, i: usize, until: f64, to: usize, arrived: bool) {
        let m = &self.movers[i];
        let end = m.legs.first().and_then(|leg| leg.way.last()).copied().unwrap_or(m.at);
        let there = arrived || m.at.distance(end) < THERE_M;
        if self.t >= until || there && self.has_passed(to, i) && self.t > until - YIELD_S + 1.0 {
            return self.goes_on(i);
        }
        if there {
            self.movers[i].velocity = Point::new(0.0, 0.0);
        } else {
            self.follow(i);
            self.step_on(i);
        }
        self.movers[i].state = State::Yielding { until, to, arrived: there };
    }

    /// Returns true when one that was made way for is past, or does not walk any more.
    fn has_passed(&self, other: usize, i: usize) -> bool {
        let (m, o) = (&self.movers[i], &self.movers[other]);
        if !o.is_there() || o.level != m.level || !o.is_walking() || o.at.distance(m.met) > 2.0 * LANE_M {
            return true;
        }
        let lane = self.lane(other);
        let reach = m.radius + o.radius + PAST_M;
        off(m.at, &lane) >= reach.min(PAST_M + m.radius) && off(m.met, &lane) >= reach
    }

    /// Goes on after it made way: to its place in a line, back to where it stood, or on its way.
    fn goes_on(&mut self, i: usize) {
        let t = self.t;
        self.movers[i].end_pause(t);
        let line = self.movers[i].station.filter(|s| self.lines[*s].contains(&i));
        if let Some(station) = line {
            let m = &mut self.movers[i];
            m.legs.clear();
            // its place is gone to anew
            m.target = Point::new(f64::MAX, f64::MAX);
            m.since = t;
            m.state = State::InLine { station };
            return;
        }
        if std::mem::take(&mut self.movers[i].waits) {
            self.movers[i].state = State::Idle;
            return;
        }
        let m = &self.movers[i];
        let rest = m.legs.get(1).and_then(|leg| Some((leg.level, *leg.way.last()?)));
        let back = m.resumes.as_ref().map(|stand| (m.level, stand.at));
        let Some((level, at)) = back.or(rest) else { return self.finish(i) };
        let target = m.target;
        let went = self.go(i, level, at);
        self.movers[i].target = target;
        if !went {
            self.give_up(i);
        }
    }

    /// Gives up what it goes for; who made way stays where that was.
    fn settle(&mut self, i: usize) {
        let t = self.t;
        self.movers[i].end_pause(t);
        let Some(stand) = self.movers[i].resumes.take() else { return self.give_up(i) };
        let m = &mut self.movers[i];
        m.legs.clear();
        m.velocity = Point::new(0.0, 0.0);
        m.reach(m.at, super::GOAL_M);
        m.state = State::Busy { until: stand.until.max(t + 1.0) };
    }
}

fn length(way: &[Point]) -> f64 {
    way.windows(2).map(|w| w[0].distance(w[1])).sum()
}

/// Returns how far a point is from a way, m.
fn off(p: Point, way: &[Point]) -> f64 {
    let lines = way.windows(2).map(|w| off_line(p, w[0], w[1]));
    lines.chain(way.iter().map(|q| q.distance(p))).fold(f64::MAX, f64::min)
}

/// Returns how far a point is from a line between two, m.
fn off_line(p: Point, a: Point, b: Point) -> f64 {
    let (dx, dy) = (b.x - a.x, b.y - a.y);
    let length = dx * dx + dy * dy;
    let t = if length > 0.0 { (((p.x - a.x) * dx + (p.y - a.y) * dy) / length).clamp(0.0, 1.0) } else { 0.0 };
    p.distance(Point::new(a.x + t * dx, a.y + t * dy))
}
