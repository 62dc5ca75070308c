//! The knowledge base of a domain: references, their sources and the constraints drawn from them.
//!
//! The shape is the paper's (`rag_data.generated.json`, arXiv 2608.11876): metadata, then references, each with sources
//! and constraints whose `value` is polymorphic.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::document::{Document, Problem, check_unique};

/// All references of one domain.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct KnowledgeBase {
    /// What this file is.
    pub metadata: Metadata,
    /// One per building type, jurisdiction and standard.
    pub references: Vec<Reference>,
}

/// What a knowledge base covers and how it came to be.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Metadata {
    /// Format version; 1.
    pub version: u32,
    /// Domain id.
    pub domain: String,
    /// How the file was made, one sentence.
    pub generated_by: String,
    /// Date of the newest change, `YYYY-MM-DD`.
    pub date: String,
    /// Licence and caveats for readers.
    #[serde(default)]
    pub notes: Vec<String>,
}

/// One source document together with the constraints drawn from it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Reference {
    /// Unique slug, for instance `hospital_de_din_18040_1`.
    pub ref_id: String,
    /// Domain or building type it speaks of.
    pub building_type: String,
    /// Where it applies: ISO 3166 code (`DE`, `US-NC`), `EU`, or `INT`.
    pub jurisdiction: String,
    /// Date it was read, `YYYY-MM-DD`.
    pub retrieved_at: String,
    /// Citable origins; the first is the standard itself.
    pub sources: Vec<Source>,
    /// Rules.
    pub constraints: Vec<Constraint>,
}

/// The citable origin of a constraint.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// Unique within the reference.
    pub source_id: String,
    /// Title of the standard, guideline or paper.
    pub title: String,
    /// Who published it.
    pub publisher: String,
    /// Edition or year, as printed.
    pub edition_or_year: String,
    /// Address; absent for practice rules.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub url: Option<String>,
    /// `regulation`, `standard`, `guideline`, `manufacturer_doc`, `paper`, `practice`, ...
    #[serde(rename = "type")]
    pub source_type: String,
}

/// One rule with its value and where it applies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Constraint {
    /// Unique in the knowledge base.
    pub constraint_id: String,
    /// What is limited, snake case (`corridor_clear_width`).
    pub name: String,
    /// One of the paper's eight topics (`room_size`, `fire_safety_evacuation`, ...).
    pub topic: String,
    /// `minimum`, `maximum`, `range`, `ratio`, `table`, `recommendation`, `rule_of_thumb`.
    pub constraint_type: String,
    /// The figure, in `unit`.
    pub value: Value,
    /// SI unit (`m`, `m^2`, `count`, `ratio`, `boolean`, ...).
    pub unit: String,
    /// How it is measured (`clear_width`, `net_floor_area`).
    pub measurement_basis: String,
    /// Which space it is about (`bedroom`, `corridor`, `accessible_route`, `robot_dock`).
    pub space_type: String,
    /// When it applies, in words; empty means always.
    #[serde(default)]
    pub conditions: Vec<String>,
    /// `high`, `medium` or `low`.
    pub confidence: String,
    /// `seen` when the figure was read in a page, `known` or `partly_seen` otherwise.
    pub verified: String,
    /// The figure as printed, where converted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub original_value: Option<String>,
    /// Clause number and remarks.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub note: String,
    /// Sources of this constraint, best first.
    pub source_ids: Vec<String>,
    /// Where the figure was checked, if not in the source itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seen_at: Option<String>,
}

/// A polymorphic constraint value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Value {
    /// Yes or no.
    Flag(bool),
    /// One figure.
    Number(f64),
    /// An interval.
    Range {
        /// Least.
        min: f64,
        /// Largest.
        max: f64,
    },
    /// A formula over named quantities, for instance `1.8 * n + 2`.
    Expression {
        /// The formula.
        expr: String,
    },
    /// A list of figures or words.
    List(Vec<serde_json::Value>),
    /// Named dimensions or a table.
    Table(BTreeMap<String, serde_json::Value>),
}

impl KnowledgeBase {
    /// Returns a knowledge base without references, for a domain that brings none.
    pub fn empty(domain: &str) -> Self {
        let metadata = Metadata {
            version: 1,
            domain: domain.into(),
            generated_by: "no knowledge.json was given".into(),
            date: "1970-01-01".into(),
            notes: Vec::new(),
        };
        Self { metadata, references: Vec::new() }
    }
}

impl Document for KnowledgeBase {
    const KIND: &'static str = "knowledge_base";

    fn check(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        check_unique("/references", self.references.iter().map(|r| r.ref_id.as_str()), &mut problems);
        let mut seen = std::collections::BTreeSet::new();
        for (i, reference) in self.references.iter().enumerate() {
            for (j, constraint) in reference.constraints.iter().enumerate() {
                let path = format!("/references/{i}/constraints/{j}");
                if !seen.insert(&constraint.constraint_id) {
                    problems.push(Problem::new(
                        format!("{path}/constraint_id"),
                        format!("`{}` is used twice; ids are unique in the file", constraint.constraint_id),
                    ));
                }
                for (k, id) in constraint.source_ids.iter().enumerate() {
                    if !reference.sources.iter().any(|s| &s.source_id == id) {
                        problems.push(Problem::new(
                            format!("{path}/source_ids/{k}"),
                            format!("`{id}` is not in the sources of `{}`", reference.ref_id),
                        ));
                    }
                }
                if constraint.source_ids.is_empty() {
                    problems
                        .push(Problem::new(format!("{path}/source_ids"), "is empty; every constraint cites a source"));
                }
            }
        }
        problems
    }
}
