//! What was checked about a world: hard rules, and every knowledge-base constraint that applies, each with its source.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::document::{Document, Problem};
use crate::knowledge::Source;
use crate::passage::RobotWay;

/// The verdict on one world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Report {
    /// Format version; 1.
    pub version: u32,
    /// Name of the world.
    pub world: String,
    /// True when every hard rule holds.
    pub sound: bool,
    /// True when the plan was brought: what it breaks by itself is marked `given`, and the world is written all the same.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub given_plan: bool,
    /// Every hard rule with what broke it.
    pub rules: Vec<RuleResult>,
    /// Jurisdictions whose constraints were applied, nearest first.
    pub jurisdictions: Vec<String>,
    /// How the constraints fared.
    pub summary: ConstraintSummary,
    /// Every constraint that applies to something in this world.
    pub constraints: Vec<ConstraintResult>,
    /// For each robot whose body is known: whether and where it fits.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub robot_fit: Vec<RobotFit>,
    /// What became of everything that the brief asks for, in its order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub asks: Vec<AskAnswer>,
    /// Counts and measures of the world (`rooms`, `objects_per_room`, `circulation_share`, ...).
    pub figures: BTreeMap<String, f64>,
}

/// What became of one thing that was asked for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AskAnswer {
    /// Id of the ask in the brief.
    pub ask_id: String,
    /// The words that state it.
    pub said: String,
    /// Kind of fact: `rooms`, `capacity`, ...
    pub kind: String,
    /// What became of it.
    pub fate: Fate,
    /// Ids of the rooms, placements, doors or robots that answer it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ids: Vec<String>,
    /// Number or measure asked for, where it is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub asked: Option<f64>,
    /// What the world has.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measured: Option<f64>,
    /// Unit of both; empty for a number of things.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub unit: String,
    /// One sentence for people: why it is as it is, where it is not as asked.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub reason: String,
}

/// What became of something asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Fate {
    /// It is there as asked.
    Honored,
    /// Something near to it is there.
    Substituted,
    /// It is not there, or nothing here can tell whether it is.
    LeftOut,
    /// Another wish, a rule or the building's kind speaks against it.
    Contradicted,
}

/// Whether and where a robot fits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotFit {
    /// Kind of robot: `delivery`.
    pub kind: String,
    /// Radius of the disc that must find its way, m: of the circle it turns in; of a long body half its width, for that
    /// drives straight through what is narrow.
    pub radius_m: f64,
    /// Height, m.
    pub height_m: f64,
    /// True when it reaches every room and every point that it serves.
    pub fits: bool,
    /// The way to each room.
    pub rooms: Vec<RobotWay>,
    /// The way to each named point of the scenario.
    pub points: Vec<RobotWay>,
}

/// One hard rule.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RuleResult {
    /// Snake-case id: `door_blocked`.
    pub rule: String,
    /// What it demands, one sentence.
    pub title: String,
    /// How many things were checked.
    pub checked: u32,
    /// What breaks it; empty when it holds.
    pub violations: Vec<Violation>,
}

/// One thing that breaks one rule.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Violation {
    /// Rule id, or constraint id.
    pub code: String,
    /// Id of the room, door, wall or placement.
    pub subject: String,
    /// Measured value, where the rule has one.
    #[serde(default)]
    pub measured: Option<f64>,
    /// Required value.
    #[serde(default)]
    pub required: Option<f64>,
    /// Unit of both.
    #[serde(default)]
    pub unit: String,
    /// One sentence for people: `corridor is 1.1 m wide, needs 1.8 m`.
    pub message: String,
    /// True when the plan that was brought is to blame: it breaks the rule here even with nothing in it, or the room is too
    /// small for what it lacks.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub given: bool,
}

/// Counts of constraint results by status.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ConstraintSummary {
    /// Satisfied.
    pub satisfied: u32,
    /// Violated.
    pub violated: u32,
    /// Applies to nothing in this world.
    pub not_applicable: u32,
    /// Cannot be decided from geometry and objects.
    pub not_decidable: u32,
    /// Mandatory ones of the country and of its division that apply to something in this world.
    #[serde(default)]
    pub national_mandatory: u32,
    /// Those among them that were decided: satisfied or violated.
    #[serde(default)]
    pub national_decided: u32,
}

/// Which building rules a world was held against.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AppliedRules {
    /// Jurisdictions whose rules were applied, nearest first.
    pub jurisdictions: Vec<String>,
    /// Mandatory rules of the country and of its division that apply to something in the world.
    pub national_mandatory: u32,
    /// Those among them that were decided.
    pub national_decided: u32,
}

impl AppliedRules {
    /// Returns a line for people: how many mandatory rules of the country were decided, or that none are known.
    pub fn line(&self, country_code: Option<&str>) -> String {
        let decided = |n: u32| format!("{} of {n} mandatory decided", self.national_decided);
        match (country_code, self.national_mandatory) {
            (None, _) => "international, no country named".to_owned(),
            (Some(code), 0) => format!("none of {code} apply here, others only"),
            (Some(code), n) => format!("{code}, {}", decided(n)),
        }
    }
}

/// One constraint evaluated on one subject.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ConstraintResult {
    /// Id in the knowledge base.
    pub constraint_id: String,
    /// Reference it belongs to.
    pub ref_id: String,
    /// What is limited.
    pub name: String,
    /// Id of the room, door or placement it was evaluated on; `building` for the whole.
    pub subject: String,
    /// Outcome.
    pub status: Status,
    /// True for regulations and standards with type minimum, maximum or range; false for advice.
    pub mandatory: bool,
    /// Measured value.
    #[serde(default)]
    pub measured: Option<f64>,
    /// Least required value.
    #[serde(default)]
    pub required_min: Option<f64>,
    /// Largest allowed value.
    #[serde(default)]
    pub required_max: Option<f64>,
    /// Unit of the figures.
    pub unit: String,
    /// Why it does not apply or cannot be decided; how it was measured otherwise.
    pub note: String,
    /// Where the rule comes from.
    pub citation: Citation,
}

/// Outcome of a constraint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// Holds.
    Satisfied,
    /// Does not hold.
    Violated,
    /// Has no subject here.
    NotApplicable,
    /// Cannot be decided from geometry and objects.
    NotDecidable,
}

/// A source as cited, with jurisdiction and clause.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Citation {
    /// Where the rule applies.
    pub jurisdiction: String,
    /// The source.
    pub source: Source,
    /// Clause and remarks.
    #[serde(default)]
    pub note: String,
    /// The figure as printed.
    #[serde(default)]
    pub printed: Option<String>,
    /// Confidence in the figure.
    pub confidence: String,
    /// Where in the source it stands.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clause: Option<String>,
    /// Words that were read there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quotation: Option<String>,
    /// Address of the page where the figure was checked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seen_at: Option<String>,
    /// Last day it held, for a rule that has ended.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub in_force_until: Option<String>,
    /// What replaced it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub superseded_by: Option<String>,
}

impl Report {
    /// Returns true when the world may be used: sound, or a brought plan is all that is wrong with it.
    pub fn is_writable(&self) -> bool {
        self.sound || self.is_given()
    }

    /// Returns which building rules the world was held against.
    pub fn applied_rules(&self) -> AppliedRules {
        AppliedRules {
            jurisdictions: self.jurisdictions.clone(),
            national_mandatory: self.summary.national_mandatory,
            national_decided: self.summary.national_decided,
        }
    }

    /// Returns how many of the things asked for are there as asked, and how many were asked for.
    pub fn wishes_met(&self) -> (usize, usize) {
        (self.asks.iter().filter(|a| a.fate == Fate::Honored).count(), self.asks.len())
    }

    /// Returns how many laws and how much advice of the knowledge base are not kept.
    pub fn missed(&self) -> (usize, usize) {
        let missed = self.constraints.iter().filter(|c| c.status == Status::Violated);
        let laws = missed.clone().filter(|c| c.mandatory).count();
        (laws, missed.count() - laws)
    }

    /// Returns true for a world that breaks rules of which a brought plan alone is to blame.
    pub fn is_given(&self) -> bool {
        let mut violations = self.rules.iter().flat_map(|r| &r.violations);
        !self.sound && self.given_plan && violations.all(|v| v.given)
    }
}

impl Document for Report {
    const KIND: &'static str = "report";

    fn check(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        if self.version != 1 {
            problems.push(Problem::new("/version", format!("is {}, this release reads version 1", self.version)));
        }
        let broken = self.rules.iter().any(|r| !r.violations.is_empty());
        if self.sound == broken {
            problems.push(Problem::new("/sound", "contradicts the rules listed below it"));
        }
        problems
    }
}
