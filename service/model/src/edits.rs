//! Changes to a finished world, in the words of somebody who looks at its plan.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::document::{Document, Problem};

/// Most changes of one document.
pub const MAX_EDITS: usize = 1000;

/// Changes, applied in their order: all of them or none.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Edits {
    /// Format version; 1.
    pub version: u32,
    /// The changes.
    pub edits: Vec<Edit>,
}

/// One change. What it touches is repaired with as little else changed as the rules allow.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "op", rename_all = "snake_case", deny_unknown_fields)]
pub enum Edit {
    /// Moves the whole wall between two rooms, or between a room and outdoors.
    MoveWall {
        /// Id of any piece of the wall.
        wall_id: String,
        /// How far to the east (a wall that runs north-south) or north, m; negative to the west or south. Steps of 5 cm.
        by_m: f64,
    },
    /// Moves a door or a window along its wall.
    MoveOpening {
        /// Its id.
        opening_id: String,
        /// How far to the east, or to the north in a wall that runs north-south, m; negative to the west or south.
        by_m: f64,
    },
    /// Adds a room of a type of the domain.
    AddRoom {
        /// Room type id.
        room_type: String,
        /// Net floor area to aim for, m^2; the usual one of the type when absent.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        area_m2: Option<f64>,
        /// Id of the room it is entered from; the corridor or hall when absent.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        entered_from: Option<String>,
    },
    /// Takes a room out; a neighbor or the outdoors takes its place.
    RemoveRoom {
        /// Its id.
        room_id: String,
    },
    /// Puts another object, or another model of the same object, where one stands.
    SwapObject {
        /// What stands there now.
        placement_id: String,
        /// Object id of the domain's catalog; the same object when absent.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        object: Option<String>,
        /// Model reference to take, of the database of assets; any that fits when absent, and not the present one.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        asset: Option<String>,
    },
    /// Moves an object, and with it what stands on it.
    MoveObject {
        /// Its id.
        placement_id: String,
        /// New center, m.
        x: f64,
        /// New center, m.
        y: f64,
        /// New heading of its front, rad, a multiple of a quarter turn; the present one when absent.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        yaw_rad: Option<f64>,
    },
    /// Adds an object to a room, at the best free place.
    AddObject {
        /// The room.
        room_id: String,
        /// Object id of the domain's catalog.
        object: String,
    },
    /// Takes an object away, and what stands on it.
    RemoveObject {
        /// Its id.
        placement_id: String,
    },
    /// Furnishes a room anew; what is locked in it stays.
    Refurnish {
        /// The room.
        room_id: String,
    },
    /// Changes a job of a robot: where it goes, in which turn, what it carries. Its routes follow; later changes leave it.
    ChangeJob {
        /// The robot.
        robot_id: String,
        /// Its job.
        job_id: String,
        /// Point where it loads; as it is when absent.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        from: Option<String>,
        /// Points it goes to, in turn; as they are when there are none.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        to: Vec<String>,
        /// Mass of what it carries, kg; as it is when absent.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        load_kg: Option<f64>,
        /// Time it stops at each point, s; as it is when absent.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        seconds: Option<f64>,
    },
    /// Puts the steps of a person in another turn; those that are not named are left out. Later changes leave them.
    ChangeSteps {
        /// The person.
        agent_id: String,
        /// The steps that stay, in their new turn.
        steps: Vec<StepKept>,
    },
    /// Pins parts, so that later changes leave them as they are, or frees them.
    Lock {
        /// Ids of rooms, walls, doors, windows, placements, or of robots and people, which keep what they do.
        ids: Vec<String>,
        /// True to pin.
        locked: bool,
        /// True to pin or free what stands in the rooms named, too.
        #[serde(default)]
        contents: bool,
    },
}

/// A step of a person that stays.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StepKept {
    /// Its number so far, from 1.
    pub number: u32,
    /// How long it takes, s; as it is when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
}

/// Longest time of a step or a stop, s: a day.
const LONGEST_S: f64 = 86_400.0;
/// Largest mass that a robot is given to carry, kg.
const HEAVIEST_KG: f64 = 10_000.0;

impl Document for Edits {
    const KIND: &'static str = "edits";

    fn check(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        if self.version != 1 {
            problems.push(Problem::new("/version", format!("is {}, this release reads version 1", self.version)));
        }
        if self.edits.is_empty() || self.edits.len() > MAX_EDITS {
            problems.push(Problem::new("/edits", format!("has {} changes, needs 1 to {MAX_EDITS}", self.edits.len())));
        }
        for (i, edit) in self.edits.iter().enumerate() {
            let mut number = |field: &str, value: f64, low: f64, high: f64| {
                if !(low..=high).contains(&value) {
                    problems.push(Problem::new(
                        format!("/edits/{i}/{field}"),
                        format!("{value} is outside {low} to {high}"),
                    ));
                }
            };
            match edit {
                Edit::MoveWall { by_m, .. } | Edit::MoveOpening { by_m, .. } => number("by_m", *by_m, -100.0, 100.0),
                Edit::AddRoom { area_m2: Some(area), .. } => number("area_m2", *area, 0.5, 100_000.0),
                Edit::MoveObject { x, y, yaw_rad, .. } => {
                    number("x", *x, -100_000.0, 100_000.0);
                    number("y", *y, -100_000.0, 100_000.0);
                    let quarters = yaw_rad.unwrap_or(0.0) / std::f64::consts::FRAC_PI_2;
                    if (quarters - quarters.round()).abs() > 1e-3 {
                        problems.push(Problem::new(
                            format!("/edits/{i}/yaw_rad"),
                            "is not a multiple of a quarter turn (1.5708 rad)",
                        ));
                    }
                }
                Edit::ChangeJob { load_kg, seconds, .. } => {
                    number("load_kg", load_kg.unwrap_or(0.0), 0.0, HEAVIEST_KG);
                    number("seconds", seconds.unwrap_or(0.0), 0.0, LONGEST_S);
                }
                Edit::ChangeSteps { steps, .. } => {
                    for (k, step) in steps.iter().enumerate() {
                        number(&format!("steps/{k}/seconds"), step.seconds.unwrap_or(0.0), 0.0, LONGEST_S);
                    }
                }
                _ => {}
            }
        }
        problems
    }
}
