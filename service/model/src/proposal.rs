//! What a language model proposed for a world and what became of it: the record beside a world that had such help.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::document::{Document, Problem};

/// The proposals of one world, stage by stage.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Proposal {
    /// Format version; 1.
    pub version: u32,
    /// Name of the world.
    pub world: String,
    /// Seed of the world.
    pub seed: u64,
    /// Name of the provider that was asked.
    pub provider: String,
    /// Name of the model that was asked for.
    pub model: String,
    /// The stages for which proposals were asked, in their order.
    pub stages: Vec<StageProposal>,
}

/// The proposal of one stage.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StageProposal {
    /// `scene_graph`, `floorplan` or `placement`.
    pub stage: String,
    /// What became of the whole.
    pub outcome: Outcome,
    /// Why, one sentence for people.
    pub note: String,
    /// Category of the trouble, where there was no usable answer (`invalid_answer`, `rate_limited`, `budget`, ...).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// SHA-256 of all that was asked, in hexadecimal digits; empty when nothing was asked.
    pub prompt_sha256: String,
    /// Constraints of the knowledge base that the question quoted.
    #[serde(default)]
    pub constraint_ids: Vec<String>,
    /// The model that answered, as the provider names it; empty without an answer.
    #[serde(default)]
    pub answered_by: String,
    /// Tokens of all that was asked and answered, retries included.
    pub usage: TokenUsage,
    /// How many proposed things had which fate.
    pub counts: FateCounts,
    /// Every proposed thing, and every thing that was added to it, in the order of the answer.
    pub items: Vec<ProposedItem>,
}

/// What became of a stage's proposal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// The world has it, repaired where `items` say so.
    Used,
    /// Nothing of it could be used, or no repair of it was sound: the stage is as without a model.
    NotUsed,
    /// There was no usable answer: the stage is as without a model.
    Failed,
}

/// Tokens used.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TokenUsage {
    /// Of prompts.
    pub input: u64,
    /// Of answers, thoughts included.
    pub output: u64,
    /// How often the provider was asked.
    pub tries: u32,
}

/// How many things had which fate.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FateCounts {
    /// As proposed.
    pub kept: u32,
    /// Near to what was proposed.
    pub moved: u32,
    /// There, as the rules engine has it.
    pub replaced: u32,
    /// Not there.
    pub dropped: u32,
    /// There without having been proposed.
    pub added: u32,
}

/// One thing of a proposal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProposedItem {
    /// What it is.
    pub kind: ItemKind,
    /// How the answer names it, shortened; for what was added the id in the world.
    pub proposed: String,
    /// What became of it.
    pub fate: Fate,
    /// Id in the world's documents, where it is there; `a - b` for an edge.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub id: Option<String>,
    /// Where it was proposed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<Spot>,
    /// Where it is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to: Option<Spot>,
    /// Id of the rule, constraint or adjacency source that decided, where there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rule: Option<String>,
    /// Why, one sentence for people; empty for what was kept.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub reason: String,
}

/// What a proposed thing is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ItemKind {
    /// A room: of the scene graph, or its outline.
    Room,
    /// A connection of two rooms.
    Edge,
    /// An object: wished for in a room, or at its place.
    Object,
}

/// What became of a proposed thing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Fate {
    /// As proposed, to the rounding of the lattice.
    Kept,
    /// Near to what was proposed.
    Moved,
    /// There, as the rules engine has it.
    Replaced,
    /// Not there.
    Dropped,
    /// There without having been proposed.
    Added,
}

/// A place on the plan.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Spot {
    /// Center east of the origin, m.
    pub x_m: f64,
    /// Center north of the origin, m.
    pub y_m: f64,
    /// Heading of an object, rad.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub yaw_rad: Option<f64>,
    /// Extent of a room along x, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub width_m: Option<f64>,
    /// Extent of a room along y, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub depth_m: Option<f64>,
}

impl FateCounts {
    /// Returns the counts of items.
    pub fn of(items: &[ProposedItem]) -> Self {
        let mut out = Self::default();
        for item in items {
            *match item.fate {
                Fate::Kept => &mut out.kept,
                Fate::Moved => &mut out.moved,
                Fate::Replaced => &mut out.replaced,
                Fate::Dropped => &mut out.dropped,
                Fate::Added => &mut out.added,
            } += 1;
        }
        out
    }

    /// Returns how many things were proposed.
    pub fn proposed(&self) -> u32 {
        self.kept + self.moved + self.replaced + self.dropped
    }
}

impl Document for Proposal {
    const KIND: &'static str = "proposal";

    fn check(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        if self.version != 1 {
            problems.push(Problem::new("/version", format!("is {}, this release reads version 1", self.version)));
        }
        for (i, stage) in self.stages.iter().enumerate() {
            if stage.counts != FateCounts::of(&stage.items) {
                problems.push(Problem::new(format!("/stages/{i}/counts"), "are not those of the items below"));
            }
            let failed = stage.outcome == Outcome::Failed;
            if failed != stage.error.is_some() {
                problems.push(Problem::new(
                    format!("/stages/{i}/error"),
                    "names the trouble of a stage that failed, and only of such a stage",
                ));
            }
        }
        problems
    }
}
