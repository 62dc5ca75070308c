//! Regions, points, robots and people of a world.

pub(crate) mod script;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::document::{Document, Problem, check_unique};
use crate::geometry::{Point, Polygon, Pose};
use crate::levels::is_ground;
use crate::passage::RobotWay;
use crate::scene_graph::Robot;

pub use script::{
    Act, Condition, ConditionOp, Flow, GROUP_SIZES, Itinerary, RobotJob, RobotJobKind, Station, Step,
    WALKING_SPEEDS_M_S,
};

/// What happens in a world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// Format version; 1.
    pub version: u32,
    /// Seed it was made with.
    pub seed: u64,
    /// Its name among those of a world; empty for the only one.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// Hour of the day ([`crate::hours`]): `shift_change`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hour: Option<String>,
    /// Robot zones and other named areas.
    pub rois: Vec<Roi>,
    /// Named points: docks, service points, waiting bays.
    pub pois: Vec<Poi>,
    /// Robots with where they start and what they visit.
    pub robots: Vec<RobotTask>,
    /// People who fill the scene.
    pub agents: Vec<Agent>,
    /// Places at objects that people use.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stations: Vec<Station>,
    /// People who come and go.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub flows: Vec<Flow>,
    /// What is to come of it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub conditions: Vec<Condition>,
}

impl Scenario {
    /// Returns a scenario in which nothing happens.
    pub fn empty(seed: u64) -> Self {
        Self {
            version: 1,
            seed,
            name: String::new(),
            hour: None,
            rois: Vec::new(),
            pois: Vec::new(),
            robots: Vec::new(),
            agents: Vec::new(),
            stations: Vec::new(),
            flows: Vec::new(),
            conditions: Vec::new(),
        }
    }

    /// Returns the station with this id.
    pub fn station(&self, id: &str) -> Option<&Station> {
        self.stations.iter().find(|s| s.station_id == id)
    }
}

/// An area a scenario refers to by name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Roi {
    /// Unique id: `service_zone_nurse_station_1`.
    pub roi_id: String,
    /// What it is.
    pub kind: RoiKind,
    /// Room it lies in.
    pub room_id: String,
    /// Outline, counter-clockwise.
    pub polygon: Polygon,
    /// Cleaning priority (`high`, `low`), or what the area is there for, for people.
    #[serde(default)]
    pub note: String,
    /// Of floor to be cleaned: its number on a short tour of its storey, from 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub order: Option<u32>,
    /// Of floor to be cleaned: what of it nothing stands on, m^2.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub free_area_m2: Option<f64>,
    /// Of slow floor: the highest speed of a robot there, m/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_speed_m_s: Option<f64>,
}

impl Roi {
    /// Returns an area of which nothing more is known.
    pub fn new(roi_id: String, kind: RoiKind, room_id: &str, polygon: Polygon, note: String) -> Self {
        let room_id = room_id.to_owned();
        Self { roi_id, kind, room_id, polygon, note, order: None, free_area_m2: None, max_speed_m_s: None }
    }
}

/// Kind of robot zone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RoiKind {
    /// Floor to be cleaned.
    CleaningZone,
    /// Where a robot serves people.
    ServiceZone,
    /// Free floor around a dock.
    ChargingBuffer,
    /// Where robots may not go.
    KeepOut,
    /// Where robots drive slowly: before rooms people sleep in, where corridors cross, at counters.
    SpeedZone,
    /// Free floor where goods are put down and taken up, out of the way of doors and of those who pass.
    StagingArea,
}

/// A point a scenario refers to by name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Poi {
    /// Unique id: `dock_1`.
    pub poi_id: String,
    /// `dock`, `service_point`, `cleaning_point`, `entrance`, `waiting_bay`.
    pub kind: String,
    /// Room it lies in.
    pub room_id: String,
    /// Where a robot stands to use it.
    pub pose: Pose,
}

impl Poi {
    /// Kind of the place where a robot charges.
    pub const DOCK: &'static str = "dock";
    /// Kind of the place where a robot serves the people of a room.
    pub const SERVICE_POINT: &'static str = "service_point";
    /// Kind of the place from which a robot cleans a room.
    pub const CLEANING_POINT: &'static str = "cleaning_point";
    /// Kind of the place inside the main entrance.
    pub const ENTRANCE: &'static str = "entrance";
    /// Kind of the place where a robot waits.
    pub const WAITING_BAY: &'static str = "waiting_bay";
}

/// A robot and its work.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotTask {
    /// Unique id: `delivery_robot_1`.
    pub robot_id: String,
    /// The robot.
    pub robot: Robot,
    /// Where it starts.
    pub start: Pose,
    /// POI ids in the order it visits them: those of its storey, then those it rides to.
    pub goals: Vec<String>,
    /// The way to each goal, where the robot's body is known.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ways: Vec<RobotWay>,
    /// Its round on the storey that it starts on: to its first goal, from there to the next, at last to its dock.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub routes: Vec<Route>,
    /// What it does, in turn.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub jobs: Vec<RobotJob>,
    /// POI id of its dock.
    #[serde(default)]
    pub dock: Option<String>,
    /// Storey it starts on.
    #[serde(default, skip_serializing_if = "is_ground")]
    pub level: i32,
    /// True keeps its jobs when the scenario is made anew: a person set them.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub locked: bool,
}

/// A leg of a robot's round on the free floor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Route {
    /// POI id it begins at; empty for where the robot starts.
    pub from: String,
    /// POI id it ends at.
    pub to: String,
    /// Length, m.
    pub length_m: f64,
    /// Twice the least distance of its middle line to anything, at its ends too, m.
    pub clear_width_m: f64,
    /// Corners from start to end; the middle of the robot drives straight between them.
    pub path: Vec<Point>,
}

/// A person.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Agent {
    /// Unique id: `nurse_1`.
    pub agent_id: String,
    /// Role id of the domain.
    pub role: String,
    /// Arena human model, `Domain/name`.
    pub model: String,
    /// Walking speed, m/s.
    pub speed_m_s: f64,
    /// Where the person starts.
    pub start: Pose,
    /// Room ids visited in turn.
    pub waypoints: Vec<String>,
    /// What the person does, in turn; without steps it walks between the rooms.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub steps: Vec<Step>,
    /// Station on which the person is at the beginning: a patient in bed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub on: Option<String>,
    /// Group of people who belong together.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub group: Option<String>,
    /// True for a person who is to be observed.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub spotlight: bool,
    /// True when the person leaves the building after its steps; else it begins anew.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub leaves: bool,
    /// When the person comes in, s from the beginning.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub begins_s: f64,
    /// Storey of the start and the rooms.
    #[serde(default, skip_serializing_if = "is_ground")]
    pub level: i32,
    /// True keeps its steps when the scenario is made anew: a person set them.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub locked: bool,
}

impl Document for Scenario {
    const KIND: &'static str = "scenario";

    fn check(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        if self.version != 1 {
            problems.push(Problem::new("/version", format!("is {}, this release reads version 1", self.version)));
        }
        check_unique("/rois", self.rois.iter().map(|r| r.roi_id.as_str()), &mut problems);
        check_unique("/pois", self.pois.iter().map(|p| p.poi_id.as_str()), &mut problems);
        check_unique("/stations", self.stations.iter().map(|s| s.station_id.as_str()), &mut problems);
        check_unique("/flows", self.flows.iter().map(|f| f.flow_id.as_str()), &mut problems);
        check_unique("/conditions", self.conditions.iter().map(|c| c.condition_id.as_str()), &mut problems);
        check_unique("/agents", self.agents.iter().map(|a| a.agent_id.as_str()), &mut problems);
        for (i, robot) in self.robots.iter().enumerate() {
            for (j, goal) in robot.goals.iter().chain(&robot.dock).enumerate() {
                if !self.pois.iter().any(|p| &p.poi_id == goal) {
                    problems
                        .push(Problem::new(format!("/robots/{i}/goals/{j}"), format!("poi `{goal}` is not in pois")));
                }
            }
            for (j, route) in robot.routes.iter().enumerate() {
                let ends = [&route.from, &route.to].into_iter().filter(|id| !id.is_empty());
                for end in ends.filter(|id| !self.pois.iter().any(|p| &p.poi_id == *id)) {
                    let message = format!("poi `{end}` is not in pois");
                    problems.push(Problem::new(format!("/robots/{i}/routes/{j}"), message));
                }
            }
            for (j, job) in robot.jobs.iter().enumerate() {
                let ends = job.from.iter().chain(&job.to);
                for end in ends.filter(|id| !self.pois.iter().any(|p| &p.poi_id == *id)) {
                    let message = format!("poi `{end}` is not in pois");
                    problems.push(Problem::new(format!("/robots/{i}/jobs/{j}"), message));
                }
            }
        }
        self.check_people(&mut problems);
        problems
    }
}

impl Scenario {
    /// Checks that steps name stations, and what is known of people is possible.
    fn check_people(&self, problems: &mut Vec<Problem>) {
        let known: std::collections::BTreeSet<&str> = self.stations.iter().map(|s| s.station_id.as_str()).collect();
        let agents = self.agents.iter().enumerate();
        let agents = agents.map(|(i, a)| (format!("/agents/{i}"), a.steps.iter().collect::<Vec<_>>(), a.on.as_ref()));
        let flows = self.flows.iter().enumerate();
        let flows = flows.map(|(i, f)| (format!("/flows/{i}"), f.steps().collect(), None));
        for (path, steps, on) in agents.chain(flows) {
            let named = steps.iter().filter_map(|s| s.station.as_ref()).chain(on);
            for id in named.filter(|id| !known.contains(id.as_str())) {
                problems.push(Problem::new(path.as_str(), format!("station `{id}` is not in stations")));
            }
            if steps.iter().any(|s| !s.seconds.is_finite() || s.seconds < 0.0) {
                problems.push(Problem::new(path.as_str(), "has a step of a time that is none; give seconds from 0"));
            }
        }
        for (i, flow) in self.flows.iter().enumerate() {
            let comes = flow.per_min.is_finite() && flow.per_min >= 0.0;
            if !comes || !(1..=flow.group[1]).contains(&flow.group[0]) {
                let message = "needs per_min from 0 and a group of 1 or more, the fewest first";
                problems.push(Problem::new(format!("/flows/{i}"), message));
            }
        }
        if let Some(hour) = self.hour.as_ref().filter(|h| crate::hours::get(h).is_none()) {
            let message = format!("`{hour}` is none of {}", crate::hours::ids().join(", "));
            problems.push(Problem::new("/hour", message));
        }
    }
}

/// Radius of the disc that a person takes who walks among others, m: shoulders turn where it is tight (the usual value of
/// pedestrian models).
pub const PERSON_RADIUS_M: f64 = 0.2;

/// Code of the conflict that says which robots have no dock of their own.
pub const DOCKS_MISSING: &str = "docks_missing";

/// Returns the robots that charge and have no dock, and those whose dock is another's already.
pub fn without_dock(robots: &[RobotTask]) -> Vec<&RobotTask> {
    let planned: Vec<&RobotTask> = robots.iter().filter(|t| !t.robot.misfit).collect();
    let is_taken = |i: usize| planned[..i].iter().any(|other| other.dock == planned[i].dock);
    let lacks = |i: &usize| match planned[*i].dock {
        Some(_) => is_taken(*i),
        None => planned[*i].robot.charging,
    };
    (0..planned.len()).filter(lacks).map(|i| planned[i]).collect()
}

fn is_zero(v: &f64) -> bool {
    *v == 0.0
}
