//! The document of an evaluation: what was measured of each world, and of all together.

use std::collections::BTreeMap;

use d3dgen_model::{Document, document::Problem};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::figures::Figure;
use crate::metrics::adjacency::Adjacency;
use crate::metrics::collision::Collisions;
use crate::metrics::compliance::{Compliance, SourceTally};
use crate::metrics::distance::Distance;
use crate::metrics::diversity::{Diversity, Signature};
use crate::metrics::fidelity::Fidelity;
use crate::metrics::layout::Layout;
use crate::metrics::navigability::Navigability;
use crate::metrics::openings::Openings;
use crate::metrics::robots::RobotFit;
use crate::metrics::{accessibility::Accessibility, bounds::OutOfBounds, support::Support};

/// What was measured of a set of worlds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Evaluation {
    /// Format version; 1.
    pub version: u32,
    /// Every world, by path.
    pub worlds: Vec<WorldMeasures>,
    /// Means by domain and number of rooms; the last one is of all worlds.
    pub groups: Vec<Group>,
    /// How the constraints of each source fared in all worlds.
    pub sources: Vec<SourceTally>,
    /// How different the worlds of one prompt are.
    pub prompts: Vec<Diversity>,
    /// How far the layouts of two sets lie apart.
    pub distances: Vec<Distance>,
    /// Files that could not be read; everything else is measured all the same.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub broken: Vec<BrokenFile>,
}

impl Evaluation {
    /// Returns those of some figures that any group has.
    pub fn measured<'f>(&self, figures: impl IntoIterator<Item = &'f Figure>) -> Vec<&'f Figure> {
        figures.into_iter().filter(|f| self.groups.iter().any(|g| g.figures.contains_key(f.name))).collect()
    }

    /// Returns the means of the groups as headings and rows of a table, `-` where a group has none.
    pub fn group_table<'f>(&self, figures: &[&'f Figure]) -> (Vec<&'f str>, Vec<Vec<String>>) {
        let header = ["domain", "rooms", "worlds"].into_iter().chain(figures.iter().map(|f| f.title));
        let row = |g: &Group| {
            let fixed = [g.domain.clone(), g.rooms.map_or_else(String::new, |r| r.to_string()), g.worlds.to_string()];
            let mean = |f: &&Figure| g.figures.get(f.name).map_or_else(|| "-".into(), |v| f.form.text(*v));
            fixed.into_iter().chain(figures.iter().map(mean)).collect()
        };
        (header.collect(), self.groups.iter().map(row).collect())
    }
}

/// A file that could not be read.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BrokenFile {
    /// Path below the folder that was measured.
    pub path: String,
    /// Every problem, with its place in the file.
    pub message: String,
}

/// Means of a set of worlds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Group {
    /// Domain id; `all` for all worlds.
    pub domain: String,
    /// Number of rooms, circulation not counted; absent for all worlds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rooms: Option<u32>,
    /// How many worlds.
    pub worlds: u32,
    /// Means by name of the figure (`docs/eval.md` explains each); one that no world has is absent.
    pub figures: BTreeMap<String, f64>,
}

/// What was measured of one world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WorldMeasures {
    /// Folder of the world below the folder that was measured.
    pub path: String,
    /// Name of the world.
    pub name: String,
    /// What was asked for.
    pub prompt: String,
    /// Seed.
    pub seed: u64,
    /// Domain id.
    pub domain: String,
    /// Country whose rules apply.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub country_code: Option<String>,
    /// Verdict of the world's own report, where there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sound: Option<bool>,
    /// Counts, areas, spacing and materials.
    pub layout: Layout,
    /// Rooms asked for against rooms built.
    pub fidelity: Fidelity,
    /// Connections asked for against connections built.
    pub adjacency: Adjacency,
    /// Objects in each other.
    pub collisions: Collisions,
    /// Objects off the floor plan.
    pub out_of_bounds: OutOfBounds,
    /// Objects on nothing.
    pub support: Support,
    /// Free floor in one piece.
    pub navigability: Navigability,
    /// Free floor where objects are used.
    pub accessibility: Accessibility,
    /// Free floor at doors and windows.
    pub openings: Openings,
    /// Constraints, where there is a report.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub compliance: Option<Compliance>,
    /// Each robot of the scenario.
    pub robots: Vec<RobotFit>,
    /// What tells this plan from others.
    pub signature: Signature,
    /// Time of each stage, ms, where whoever made the world measured it.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub stage_ms: BTreeMap<String, f64>,
}

impl Document for Evaluation {
    const KIND: &'static str = "evaluation";

    fn check(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        if self.version != 1 {
            problems.push(Problem::new("/version", format!("is {}, this release reads version 1", self.version)));
        }
        for (i, pair) in self.worlds.windows(2).enumerate() {
            if pair[0].path >= pair[1].path {
                problems.push(Problem::new(
                    format!("/worlds/{}/path", i + 1),
                    format!(
                        "`{}` does not come after `{}`; worlds stand by path, each once",
                        pair[1].path, pair[0].path
                    ),
                ));
            }
        }
        problems
    }
}
