//! Where people and robots of a simulated world were, and when: `trajectory.json`, format `crowd/1`.
//!
//! It is a record, not a document that stages read. Meters, seconds, the frame of the world.

use serde::ser::SerializeSeq;
use serde::{Serialize, Serializer};

use crate::geometry::Point;

/// All that moved.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trajectory {
    /// `crowd/1`.
    pub format: &'static str,
    /// World it is of.
    pub world: String,
    /// Seed of the simulation.
    pub seed: u64,
    /// Hour of the day of the scenario.
    pub hour: Option<String>,
    /// People.
    pub agents: Vec<Track>,
    /// Robots.
    pub robots: Vec<Track>,
}

/// One person or robot.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Track {
    /// Unique id.
    pub id: String,
    /// Role, or the robot's kind.
    pub role: String,
    /// Radius, m.
    pub radius: f64,
    /// Storey it begins on.
    pub level: String,
    /// Highest speed, m/s.
    pub max_speed: f64,
    /// Speed it walks at where nobody is in the way, m/s.
    pub desired_speed: f64,
    /// Group it belongs to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub group: Option<String>,
    /// Where it went, in turn.
    pub goals: Vec<Goal>,
    /// When it stood, sat or lay on purpose.
    pub pauses: Vec<Pause>,
    /// Where it was.
    pub samples: Vec<Sample>,
}

/// A place that somebody went to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Goal {
    /// East, m.
    pub x: f64,
    /// North, m.
    pub y: f64,
    /// How near counts as there, m.
    pub radius: f64,
    /// Time it stayed, s.
    pub wait: f64,
    /// Storey.
    pub level: String,
}

/// A time of standing on purpose (`queue`, `door`, `lift`, `stairs`, `yield`, `work`), or of sitting or lying (`seat`, `bed`).
#[derive(Debug, Clone, PartialEq)]
pub struct Pause {
    /// Begin, s.
    pub from: f64,
    /// End, s.
    pub to: f64,
    /// What it is.
    pub kind: &'static str,
}

impl Serialize for Pause {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut seq = serializer.serialize_seq(Some(3))?;
        seq.serialize_element(&self.from)?;
        seq.serialize_element(&self.to)?;
        seq.serialize_element(self.kind)?;
        seq.end()
    }
}

/// Where somebody was at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Time, s.
    pub t: f64,
    /// Place, m.
    pub at: Point,
    /// Storey.
    pub level: i32,
}

impl Serialize for Sample {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut seq = serializer.serialize_seq(Some(4))?;
        seq.serialize_element(&self.t)?;
        seq.serialize_element(&self.at.x)?;
        seq.serialize_element(&self.at.y)?;
        seq.serialize_element(&self.level.to_string())?;
        seq.end()
    }
}

impl Track {
    /// Returns where it is at a time, by the samples around; `None` before the first and after the last.
    pub fn at(&self, t: f64) -> Option<Sample> {
        let next = self.samples.partition_point(|s| s.t < t);
        let after = self.samples.get(next)?;
        if next == 0 || after.t == t {
            return (after.t - t < 1e-6).then_some(*after);
        }
        let before = self.samples[next - 1];
        if before.level != after.level {
            return Some(Sample { t, ..before });
        }
        let share = (t - before.t) / (after.t - before.t);
        let at = Point::new(
            before.at.x + share * (after.at.x - before.at.x),
            before.at.y + share * (after.at.y - before.at.y),
        );
        Some(Sample { t, at, level: after.level })
    }

    /// Returns the kind of the pause that a time lies in.
    pub fn pause_at(&self, t: f64) -> Option<&'static str> {
        self.pauses.iter().find(|p| p.from <= t && t <= p.to).map(|p| p.kind)
    }
}
