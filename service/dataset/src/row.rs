//! What the index says of a world, and what is listed of a task that came to none.

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::report::{Fate, Report, Status};
use d3dgen_model::scene_graph::{Robot, SceneGraph};
use d3dgen_model::world::World;
use d3dgen_pipeline::task;
use serde::{Deserialize, Serialize};

use crate::tasks::Task;

/// What is known of a world, as its `json` member states it; the index has it as columns.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Row {
    /// Id of the task, the same in every data set that asks for this world.
    pub task: String,
    /// The whole sentence.
    pub prompt: String,
    /// Seed.
    pub seed: u64,
    /// Which way of furnishing the plan, from 0.
    pub placement_variant: u32,
    /// Which scenario of the furnished plan, from 0.
    pub scenario_variant: u32,
    /// Name and version of the program.
    pub generator: String,
    /// SHA-256 of the snapshot.
    pub snapshot_sha256: String,
    /// SHA-256 over the files of the world, this one aside.
    pub content_sha256: String,
    /// Value of each slot of the prompt.
    pub slots: BTreeMap<String, String>,
    /// Domain.
    pub domain: String,
    /// Kind of building in the domain.
    pub kind: Option<String>,
    /// Country whose rules apply.
    pub country: Option<String>,
    /// Language of the prompt.
    pub language: String,
    /// Rooms, circulation aside.
    pub rooms: u32,
    /// Types of the rooms, each once.
    pub room_types: Vec<String>,
    /// Models that stand in it, each once.
    pub assets: Vec<String>,
    /// Kinds of its robots.
    pub robots: Vec<String>,
    /// Width of the body of each robot, m; of the disc that must find its way where no more is known.
    pub robot_widths_m: Vec<f64>,
    /// Clear width of the narrowest place on the way to any room, m, where robots were looked for a way.
    pub clear_width_m: Option<f64>,
    /// Hard rules that hold.
    pub rules_held: Vec<String>,
    /// Constraints that are not kept, by id, each once.
    pub violated: Vec<String>,
    /// Attempts it took.
    pub attempts: u32,
    /// Figures of the report, and measures of `d3dgen eval` that the spec asks for.
    pub figures: BTreeMap<String, f64>,
    /// Path that each file has in the folder of a world, by extension.
    pub paths: BTreeMap<String, String>,
    /// Shared models: path in the folder of a world, and name in the shards of models.
    pub models: BTreeMap<String, String>,
}

impl Row {
    /// Returns what the task and the scene graph say.
    pub fn of(task: &Task<'_>, graph: &SceneGraph) -> Self {
        let types: BTreeSet<&str> = graph.rooms.iter().map(|r| r.room_type.as_str()).collect();
        Self {
            task: task.id.to_string(),
            prompt: graph.prompt.clone(),
            seed: task.seed,
            placement_variant: task.placement,
            scenario_variant: task.scenario,
            generator: concat!("d3dgen ", env!("CARGO_PKG_VERSION")).to_owned(),
            slots: task.prompt.slots.clone(),
            domain: graph.domain.clone(),
            kind: graph.building_type.clone(),
            country: graph.country_code.clone(),
            language: graph.language.clone(),
            rooms: graph.rooms.iter().filter(|r| !r.circulation).count() as u32,
            room_types: types.into_iter().map(str::to_owned).collect(),
            ..Self::default()
        }
    }

    /// Adds what the finished world and its report say.
    pub fn of_world(task: &Task<'_>, world: &World, report: &Report, attempts: u32) -> Self {
        let held = report.rules.iter().filter(|r| r.violations.is_empty());
        let broken = report.constraints.iter().filter(|c| c.status == Status::Violated);
        let violated: BTreeSet<String> = broken.map(|c| c.constraint_id.clone()).collect();
        let assets: BTreeSet<String> = world.placements.placements.iter().map(|p| p.asset.clone()).collect();
        let mut figures = report.figures.clone();
        let s = &report.summary;
        let honored = report.asks.iter().filter(|a| a.fate == Fate::Honored).count() as u32;
        let counts = [
            ("constraints_satisfied", s.satisfied),
            ("constraints_violated", s.violated),
            ("mandatory_decided", s.national_decided),
            ("asks", report.asks.len() as u32),
            ("asks_honored", honored),
            ("people", world.scenario.agents.len() as u32),
        ];
        figures.extend(counts.map(|(name, n)| (name.to_owned(), f64::from(n))));
        let ways = report.robot_fit.iter().flat_map(|fit| &fit.rooms).map(|way| way.clear_width_m);
        let robots = &world.scenario.robots;
        Self {
            assets: assets.into_iter().collect(),
            robots: robots.iter().map(|r| r.robot.kind.clone()).collect(),
            robot_widths_m: robots.iter().map(|r| width_m(&r.robot)).collect(),
            clear_width_m: ways.min_by(f64::total_cmp),
            rules_held: held.map(|r| r.rule.clone()).collect(),
            violated: violated.into_iter().collect(),
            attempts,
            figures,
            ..Self::of(task, &world.scene_graph)
        }
    }
}

fn width_m(robot: &Robot) -> f64 {
    robot.body.and_then(|b| b.width_m).unwrap_or(2.0 * robot.radius_m)
}

/// Why a task came to no world.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Why {
    /// The request cannot be honored in any form, or contradicts itself.
    Refused,
    /// No plan, or no furniture, was found.
    Infeasible,
    /// What was found breaks a hard rule.
    Unsound,
    /// The world is sound and a filter of the spec takes it out.
    Filtered,
    /// The program has a fault here.
    Crashed,
}

impl From<task::Why> for Why {
    fn from(why: task::Why) -> Self {
        match why {
            task::Why::Refused => Self::Refused,
            task::Why::Infeasible => Self::Infeasible,
            task::Why::Crashed => Self::Crashed,
        }
    }
}

impl Why {
    /// Returns its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Refused => "refused",
            Self::Infeasible => "infeasible",
            Self::Unsound => "unsound",
            Self::Filtered => "filtered",
            Self::Crashed => "crashed",
        }
    }
}

/// A task that came to no world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Failure {
    /// Id of the task.
    pub task: String,
    /// The whole sentence.
    pub prompt: String,
    /// Seed.
    pub seed: u64,
    /// Which way of furnishing the plan, from 0.
    pub placement_variant: u32,
    /// Which scenario of the furnished plan, from 0.
    pub scenario_variant: u32,
    /// Why.
    pub why: Why,
    /// One sentence for people.
    pub reason: String,
}

impl Failure {
    /// Returns that a task came to nothing.
    pub fn of(task: &Task<'_>, why: Why, reason: impl Into<String>) -> Self {
        Self {
            task: task.id.to_string(),
            prompt: task.prompt.request.prompt.clone(),
            seed: task.seed,
            placement_variant: task.placement,
            scenario_variant: task.scenario,
            why,
            reason: reason.into(),
        }
    }
}
