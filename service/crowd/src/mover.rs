//! Somebody who moves: what it is to do, where it is, and the record of that.

use d3dgen_model::Point;
use d3dgen_model::scenario::Act;
use d3dgen_model::trajectory::{Goal, Pause, Sample, Track};

use crate::engine::PATIENCE_S;
use crate::routes::Leg;

/// Share of its time from which on somebody begins no pause, and the share that it may have stood at the end of one.
const MOST_STOOD: f64 = 0.3;
const MOST_STOOD_AT_LAST: f64 = 0.48;

/// A piece of what somebody does.
#[derive(Debug, Clone)]
pub struct Task {
    pub level: usize,
    pub room: usize,
    pub at: Point,
    pub act: Act,
    pub seconds: f64,
    /// Index of the station that is its own.
    pub station: Option<usize>,
    /// Name of what is done, for robots: id of the job.
    pub job: Option<String>,
}

/// What somebody is doing.
#[derive(Debug, Clone, PartialEq)]
pub enum State {
    /// Not there yet.
    Coming,
    /// About to begin the next task.
    Idle,
    Walking,
    /// Opens a door.
    Opening {
        until: f64,
    },
    /// Waits for a place in a lift or on a landing.
    BeforeRide,
    Riding {
        until: f64,
        link: usize,
        from: (usize, usize),
        to: (usize, usize),
    },
    /// Stands in a line.
    InLine {
        station: usize,
    },
    /// Is served, talks, works or stands until then.
    Busy {
        until: f64,
    },
    /// Gets on or off a seat or bed, or is on it; `None`: to the end.
    GettingOn {
        since: f64,
        until: f64,
    },
    On {
        until: f64,
    },
    GettingOff {
        since: f64,
    },
    /// Makes way until then, at the end of its way.
    Yielding {
        until: f64,
        to: usize,
        arrived: bool,
    },
    Gone,
}

/// Where somebody stood before it made way, and until when it is to stand there.
#[derive(Debug, Clone)]
pub struct Stand {
    pub at: Point,
    pub until: f64,
}

/// A place that was gone to.
struct Reached {
    at: Point,
    level: usize,
    radius: f64,
    left: Option<f64>,
}

pub struct Mover {
    pub id: String,
    pub role: String,
    pub group: Option<String>,
    pub radius: f64,
    pub speed: f64,
    pub robot: bool,
    pub tasks: Vec<Task>,
    pub cursor: usize,
    pub repeats: bool,
    /// Where it leaves the building.
    pub exit: Option<(usize, Point)>,
    pub leaving: bool,
    pub begins: f64,
    /// Whose rooms it may enter.
    pub access: usize,
    pub state: State,
    pub level: usize,
    pub at: Point,
    pub velocity: Point,
    pub legs: Vec<Leg>,
    pub corner: usize,
    /// Corners up to which its way leads around somebody.
    pub careful: usize,
    /// Station that is taken, and the target of the way.
    pub station: Option<usize>,
    pub target: Point,
    /// Least distance left of the way, and since when it has not become less.
    pub left: f64,
    pub since: f64,
    pub tries: u32,
    /// Done tasks, by index; and those for which there was no way.
    pub done: Vec<usize>,
    pub missed: u32,
    /// Where it stood, and until when, before it made way.
    pub resumes: Option<Stand>,
    /// Where it was when it made way last.
    pub met: Point,
    /// The task at hand is given up.
    pub skips: bool,
    /// It stands aside until a line has a place left, and how often it looked.
    pub waits: bool,
    pub waited: u32,
    reached: Vec<Reached>,
    pub pauses: Vec<Pause>,
    samples: Vec<Sample>,
}

impl Mover {
    pub fn new(id: String, role: String, radius: f64, speed: f64, level: usize, at: Point) -> Self {
        Self {
            id,
            role,
            group: None,
            radius,
            speed,
            robot: false,
            tasks: Vec::new(),
            cursor: 0,
            repeats: true,
            exit: None,
            leaving: false,
            begins: 0.0,
            access: 0,
            state: State::Coming,
            level,
            at,
            velocity: Point::new(0.0, 0.0),
            legs: Vec::new(),
            corner: 0,
            careful: 0,
            station: None,
            target: at,
            left: f64::MAX,
            since: 0.0,
            tries: 0,
            done: Vec::new(),
            missed: 0,
            resumes: None,
            met: at,
            skips: false,
            waits: false,
            waited: 0,
            reached: Vec::new(),
            pauses: Vec::new(),
            samples: Vec::new(),
        }
    }

    /// Returns true while it is in the building.
    pub fn is_there(&self) -> bool {
        !matches!(self.state, State::Coming | State::Gone)
    }

    /// Returns true for one who is on a seat or bed: nobody walks into it there.
    pub fn is_seated(&self) -> bool {
        matches!(self.state, State::GettingOn { .. } | State::On { .. } | State::GettingOff { .. })
    }

    /// Returns true for one who sits or lies.
    pub fn is_settled(&self) -> bool {
        matches!(self.state, State::On { .. })
    }

    /// Returns true for one who is on its way.
    pub fn is_walking(&self) -> bool {
        matches!(self.state, State::Walking | State::Opening { .. } | State::Yielding { arrived: false, .. })
    }

    /// Returns the way that is left on this storey.
    pub fn way_left(&self) -> Vec<Point> {
        let ahead = self.legs.first().map(|leg| &leg.way[self.corner.min(leg.way.len())..]);
        std::iter::once(self.at).chain(ahead.unwrap_or_default().iter().copied()).collect()
    }

    /// Returns the length of that, m.
    pub fn length_left(&self) -> f64 {
        self.way_left().windows(2).map(|w| w[0].distance(w[1])).sum()
    }

    /// Notes where it is.
    pub fn sample(&mut self, t: f64, levels: &[i32]) {
        let milli = |v: f64| (v * 1000.0).round() / 1000.0;
        let at = Point::new(milli(self.at.x), milli(self.at.y));
        let t = milli(t);
        if self.samples.last().is_none_or(|s| s.t < t) {
            self.samples.push(Sample { t, at, level: levels[self.level] });
        }
    }

    /// Returns where it was noted to be.
    #[cfg(test)]
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// Notes that it got to where it wanted.
    pub fn reach(&mut self, at: Point, radius: f64) {
        self.reached.push(Reached { at, level: self.level, radius, left: None });
    }

    /// Notes that it goes on.
    pub fn leave(&mut self, t: f64) {
        if let Some(last) = self.reached.last_mut().filter(|r| r.left.is_none()) {
            last.left = Some(t);
        }
    }

    /// Returns true while it stands on purpose.
    pub fn is_paused(&self) -> bool {
        self.pauses.last().is_some_and(|p| p.to == f64::MAX)
    }

    /// Returns true where it may stand on purpose for so many seconds more: who stands most of its time is in a crowd, and what
    /// it does there is no choice. Seats and beds are left out.
    pub fn may_stand(&self, t: f64, seconds: f64) -> bool {
        let stood = self.pauses.iter().filter(|p| !matches!(p.kind, "seat" | "bed"));
        let stood: f64 = stood.map(|p| p.to.min(t) - p.from).sum();
        let there = t - self.samples.first().map_or(t, |s| s.t);
        stood <= MOST_STOOD * there.max(1.0) && stood + seconds <= MOST_STOOD_AT_LAST * (there + seconds)
    }

    /// Notes that it stands behind somebody, for as long as it may.
    pub fn wait_behind(&mut self, t: f64) {
        match (self.is_paused(), self.may_stand(t, PATIENCE_S)) {
            (false, true) => self.begin_pause(t, "queue"),
            (true, false) => self.end_pause(t),
            _ => {}
        }
    }

    pub fn begin_pause(&mut self, t: f64, kind: &'static str) {
        self.end_pause(t);
        self.pauses.push(Pause { from: (t * 1000.0).round() / 1000.0, to: f64::MAX, kind });
    }

    pub fn end_pause(&mut self, t: f64) {
        if let Some(last) = self.pauses.last_mut().filter(|p| p.to == f64::MAX) {
            last.to = (t * 1000.0).round() / 1000.0;
        }
    }

    /// Returns its record.
    pub fn track(mut self, levels: &[i32]) -> Option<Track> {
        let end = self.samples.last()?.t;
        self.pauses.iter_mut().filter(|p| p.to > end).for_each(|p| p.to = end);
        self.pauses.retain(|p| p.from < p.to);
        let mut now = self.samples[0].t;
        let mut goals = Vec::new();
        for reached in &self.reached {
            let level = levels[reached.level];
            let first = self
                .samples
                .iter()
                .find(|s| s.t >= now - 1e-9 && s.level == level && s.at.distance(reached.at) <= reached.radius);
            let Some(first) = first else { continue };
            let left = reached.left.unwrap_or(end).min(end);
            let wait = ((left - first.t).max(0.0) * 1000.0).round() / 1000.0;
            now = first.t + wait;
            let round = |v: f64| (v * 1000.0).round() / 1000.0;
            goals.push(Goal {
                x: round(reached.at.x),
                y: round(reached.at.y),
                radius: reached.radius,
                wait,
                level: level.to_string(),
            });
        }
        Some(Track {
            id: self.id,
            role: self.role,
            radius: self.radius,
            level: self.samples[0].level.to_string(),
            max_speed: (self.speed * 1.3 * 100.0).round() / 100.0,
            desired_speed: self.speed,
            group: self.group,
            goals,
            pauses: self.pauses,
            samples: self.samples,
        })
    }
}
