//! Regions, points, robots and people of a world.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::document::{Document, Problem, check_unique};
use crate::geometry::{Polygon, Pose};
use crate::passage::RobotWay;
use crate::scene_graph::Robot;
use crate::storeys::is_ground;

/// What happens in a world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// Format version; 1.
    pub version: u32,
    /// Seed it was made with.
    pub seed: u64,
    /// Robot zones and other named areas.
    pub rois: Vec<Roi>,
    /// Named points: docks, service points, waiting bays.
    pub pois: Vec<Poi>,
    /// Robots with where they start and what they visit.
    pub robots: Vec<RobotTask>,
    /// People who fill the scene.
    pub agents: Vec<Agent>,
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
    /// Cleaning priority (`high`, `low`) or speed limit, for people.
    #[serde(default)]
    pub note: String,
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
}

/// A point a scenario refers to by name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Poi {
    /// Unique id: `dock_1`.
    pub poi_id: String,
    /// `dock`, `service_point`, `entrance`, `waiting_bay`.
    pub kind: String,
    /// Room it lies in.
    pub room_id: String,
    /// Where a robot stands to use it.
    pub pose: Pose,
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
    /// POI ids in the order it visits them.
    pub goals: Vec<String>,
    /// The way to each goal, where the robot's body is known.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ways: Vec<RobotWay>,
    /// POI id of its dock.
    #[serde(default)]
    pub dock: Option<String>,
    /// Storey it starts on.
    #[serde(default, skip_serializing_if = "is_ground")]
    pub level: i32,
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
    /// Storey of the start and the rooms.
    #[serde(default, skip_serializing_if = "is_ground")]
    pub level: i32,
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
        check_unique("/agents", self.agents.iter().map(|a| a.agent_id.as_str()), &mut problems);
        for (i, robot) in self.robots.iter().enumerate() {
            for (j, goal) in robot.goals.iter().chain(&robot.dock).enumerate() {
                if !self.pois.iter().any(|p| &p.poi_id == goal) {
                    problems
                        .push(Problem::new(format!("/robots/{i}/goals/{j}"), format!("poi `{goal}` is not in pois")));
                }
            }
        }
        problems
    }
}
