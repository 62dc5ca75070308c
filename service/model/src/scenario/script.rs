//! What people and robots of a scenario do: steps over places and objects, flows from the entrances, jobs of robots, and what
//! is to come of it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::geometry::{Point, Pose};
use crate::robot_kind::WORK_M_S;

/// Slowest and fastest that people walk in buildings, m/s: means are 0.9 to 1.5 by age (Bohannon & Andrews 2011), free speeds
/// 1.34 with a deviation of 0.26 (Weidmann 1993), and 0.4 to 0.8 with walking aids (Boyce et al. 1999).
pub const WALKING_SPEEDS_M_S: [f64; 2] = [0.3, 2.0];
/// Fewest and most people who walk as one group: of two to four are nearly all, six the largest seen (James 1953, Coleman &
/// James 1961, Moussaid et al. 2010).
pub const GROUP_SIZES: [u32; 2] = [1, 6];

/// What a person does at a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Act {
    /// Goes through.
    Pass,
    /// Stands.
    #[default]
    Stand,
    /// Sits on a seat.
    Sit,
    /// Lies on a bed or couch.
    Lie,
    /// Uses what is there: a machine, a counter from behind, a shelf.
    Operate,
    /// Waits in turn to be served at a counter.
    Queue,
    /// Talks to somebody.
    Talk,
}

impl Act {
    pub(crate) fn is_stand(&self) -> bool {
        *self == Self::Stand
    }

    /// Returns its name in documents.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Stand => "stand",
            Self::Sit => "sit",
            Self::Lie => "lie",
            Self::Operate => "operate",
            Self::Queue => "queue",
            Self::Talk => "talk",
        }
    }

    /// Returns the affordance that an object needs for it; `None` where no object is needed.
    pub fn affordance(self) -> Option<&'static str> {
        match self {
            Self::Sit => Some("sit"),
            Self::Lie => Some("lie"),
            Self::Operate | Self::Queue => Some("operate"),
            Self::Pass | Self::Stand | Self::Talk => None,
        }
    }
}

/// A place at an object where people do something.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Station {
    /// Unique id: `waiting_area_1_bench_2_sit_1`.
    pub station_id: String,
    /// Room it lies in.
    pub room_id: String,
    /// The object.
    pub placement_id: String,
    /// What is done there.
    pub act: Act,
    /// Free floor that it is reached from, looking at the object.
    pub before: Pose,
    /// Where the person is meanwhile: on the seat or bed, else as before.
    pub at: Pose,
    /// Where those stand who wait for it, the next one first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub queue: Vec<Point>,
}

/// A step of a person.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Step {
    /// Room it goes to.
    pub room_id: String,
    /// What it does there.
    #[serde(default, skip_serializing_if = "Act::is_stand")]
    pub act: Act,
    /// Where it stands; of a station, the floor before it.
    pub pose: Pose,
    /// How long, s.
    pub seconds: f64,
    /// Station it uses; without one, the first in the room that is free and suits the act.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub station: Option<String>,
    /// Agent it is about: the patient who is visited.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub with: Option<String>,
}

/// People who come in by an entrance, do something and leave.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Flow {
    /// Unique id: `visitor_flow_1`.
    pub flow_id: String,
    /// Role id of the domain.
    pub role: String,
    /// Arena human model, `Domain/name`.
    pub model: String,
    /// Walking speed, m/s.
    pub speed_m_s: f64,
    /// Door they come in by and leave through.
    pub door_id: String,
    /// Room behind it.
    pub room_id: String,
    /// Where they appear.
    pub pose: Pose,
    /// Groups that come in a minute.
    pub per_min: f64,
    /// Most people of it in the building at a time.
    pub most: u32,
    /// Fewest and most people of a group.
    pub group: [u32; 2],
    /// What they do: each group takes one of these, then leaves.
    pub itineraries: Vec<Itinerary>,
}

/// What people of a flow do between coming and leaving.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Itinerary {
    /// Steps in turn.
    pub steps: Vec<Step>,
}

impl Flow {
    /// Returns how many people of it come in a second.
    pub fn people_per_s(&self) -> f64 {
        self.per_min / 60.0 * f64::from(self.group[0] + self.group[1]) / 2.0
    }

    /// Returns the steps of all its itineraries.
    pub fn steps(&self) -> impl Iterator<Item = &Step> {
        self.itineraries.iter().flat_map(|i| &i.steps)
    }
}

/// A piece of work of a robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotJob {
    /// Unique within the robot: `deliver_1`.
    pub job_id: String,
    /// What it does.
    pub kind: RobotJobKind,
    /// What it carries or looks at, as the prompt says; empty where nothing does.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub what: String,
    /// Mass of what it carries, kg; 0 where nothing is known.
    #[serde(default, skip_serializing_if = "is_nothing")]
    pub load_kg: f64,
    /// POI where it begins: where it loads.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<String>,
    /// POIs it goes to, in turn.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub to: Vec<String>,
    /// Way over all of the floor to be covered, m; none for work at points.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub path: Vec<Point>,
    /// Time it stops at each point, s.
    pub seconds: f64,
    /// Ids of the words of the brief that ask for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ask_id: Option<String>,
}

impl RobotJob {
    /// Returns the least time that it takes, s: straight from point to point, with the time at each. Points that `pose` does not
    /// know are left out.
    pub fn least_seconds(&self, pose: impl Fn(&str) -> Option<Point>) -> f64 {
        let stops: Vec<Point> = self.from.iter().chain(&self.to).filter_map(|id| pose(id)).collect();
        let (way, stays) = if self.path.is_empty() { (&stops, stops.len()) } else { (&self.path, 0) };
        let length: f64 = way.windows(2).map(|w| w[0].distance(w[1])).sum();
        length / WORK_M_S + self.seconds * stays as f64
    }
}

/// Kind of a robot's work.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RobotJobKind {
    /// Takes something from one place to others.
    Deliver,
    /// Goes over all of a floor.
    Clean,
    /// Stops in each room and irradiates or sprays it.
    Disinfect,
    /// Looks at something.
    Inspect,
    /// Goes round.
    Patrol,
    /// Leads somebody to a place.
    Guide,
    /// Serves the people of rooms.
    Serve,
}

impl RobotJobKind {
    /// Returns its name in documents.
    pub fn name(self) -> &'static str {
        match self {
            Self::Deliver => "deliver",
            Self::Clean => "clean",
            Self::Disinfect => "disinfect",
            Self::Inspect => "inspect",
            Self::Patrol => "patrol",
            Self::Guide => "guide",
            Self::Serve => "serve",
        }
    }
}

/// What is to come of a scenario.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Condition {
    /// Unique id: `delivery_robot_1_at_dock_1`.
    pub condition_id: String,
    /// How it is meant.
    pub op: ConditionOp,
    /// Agent, robot, or role (then of each of its people).
    pub subject: String,
    /// Room that the subject is in.
    pub room_id: String,
    /// Of `before`: room that the subject is in only later.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub then_room_id: Option<String>,
    /// The same for people, English.
    pub text: String,
}

/// How a condition is meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ConditionOp {
    /// At some time.
    Eventually,
    /// At no time.
    Never,
    /// In the one room before in the other.
    Before,
}

fn is_nothing(v: &f64) -> bool {
    *v == 0.0
}
