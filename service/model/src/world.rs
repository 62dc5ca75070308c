//! One checked world: everything the exporters need, in one document.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::brief::Brief;
use crate::document::{Document, Problem};
use crate::floorplan::Floorplan;
use crate::placements::Placements;
use crate::report::AppliedRules;
use crate::scenario::Scenario;
use crate::scene_graph::SceneGraph;

/// Scene graph, floorplan, placements and scenario of one world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct World {
    /// Format version; 1.
    pub version: u32,
    /// Snake-case name, also the Arena world's name.
    #[schemars(regex(pattern = "^[a-z0-9_]+$"))]
    pub name: String,
    /// Name and version of the program that wrote it.
    pub generator: String,
    /// What was asked for, where it was read; the check answers each fact of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub brief: Option<Brief>,
    /// Rooms and relations.
    pub scene_graph: SceneGraph,
    /// The building.
    pub floorplan: Floorplan,
    /// What stands in it.
    pub placements: Placements,
    /// What happens in it.
    pub scenario: Scenario,
    /// Which building rules it was held against when it was made.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rules: Option<AppliedRules>,
}

impl Document for World {
    const KIND: &'static str = "world";

    fn check(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        if self.version != 1 {
            problems.push(Problem::new("/version", format!("is {}, this release reads version 1", self.version)));
        }
        let parts = [
            ("/brief", self.brief.as_ref().map(Document::check).unwrap_or_default()),
            ("/scene_graph", self.scene_graph.check()),
            ("/floorplan", self.floorplan.check()),
            ("/placements", self.placements.check()),
            ("/scenario", self.scenario.check()),
        ];
        for (path, found) in parts {
            problems.extend(found.into_iter().map(|p| Problem::new(format!("{path}{}", p.path), p.message)));
        }
        for (i, p) in self.placements.placements.iter().enumerate() {
            if self.floorplan.room(&p.room_id).is_none() {
                problems.push(Problem::new(
                    format!("/placements/placements/{i}/room_id"),
                    format!("room `{}` is not in the floorplan", p.room_id),
                ));
            }
        }
        problems
    }
}
