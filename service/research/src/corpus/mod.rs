//! What was found, put together: documents merged by address, equal rules merged by their figure in SI units.
//!
//! [`record`] has the lines of the stage files, [`Corpus`] the merged form. What it is not for: deciding what a knowledge
//! base says (`synthesis` does) and getting or reading documents.

mod address;
mod merge;
pub mod record;
mod si;

use std::collections::BTreeSet;

use d3dgen_model::document::{Document, Problem};
use d3dgen_model::knowledge::{CONFIDENCES, CONSTRAINT_TYPES, Value, is_date};
use d3dgen_model::plausible::doubt;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use address::canonical_url;
pub use merge::{document_id_of_url, merge};
use record::Evidence;
pub use si::{SiFigure, si};

/// Everything that was found, each document and each rule once.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Corpus {
    /// Format version; 1.
    pub version: u32,
    /// Domain id the rules are for.
    pub domain: String,
    /// Date of the run, `YYYY-MM-DD`.
    pub date: String,
    /// How the rules were found, one sentence.
    pub generated_by: String,
    /// By id.
    pub documents: Vec<CorpusDocument>,
    /// By id.
    pub constraints: Vec<CorpusConstraint>,
}

/// A document with all its copies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CorpusDocument {
    /// Unique; made of its name and its address or content, so that it does not depend on other documents.
    pub document_id: String,
    /// Address without what only says where a reader came from; absent for files whose address is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub url: Option<String>,
    /// Files and addresses it was read from.
    pub read_from: Vec<String>,
    /// As the document or its sidecar says; absent when nothing says it. The same holds for the fields below.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub title: Option<String>,
    /// Who published it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub publisher: Option<String>,
    /// Edition or year.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub edition: Option<String>,
    /// ISO 3166 code, `EU` or `INT`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub jurisdiction: Option<String>,
    /// One of the seven kinds in `data/source_types.toml`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source_type: Option<String>,
    /// ISO 639-1; empty when not known.
    #[serde(default)]
    pub language: String,
    /// `YYYY-MM-DD`.
    pub retrieved_at: String,
    /// True when only what a model's provider quoted of it was seen, not the page.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub quoted_only: bool,
}

/// A rule with everything that says so.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CorpusConstraint {
    /// Unique; made of what the rule says, so that it does not depend on other rules.
    pub constraint_id: String,
    /// Where its documents apply; absent when none says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub jurisdiction: Option<String>,
    /// What is limited, snake case.
    pub name: String,
    /// `minimum`, `maximum`, `range`, `ratio`, `table`, `recommendation` or `rule_of_thumb`.
    pub constraint_type: String,
    /// In `unit`.
    pub value: Value,
    /// SI unit.
    pub unit: String,
    /// What the figure is given for (`per_bed`), empty for the whole.
    #[serde(default)]
    pub basis: String,
    /// Space or object as found; empty when the text does not say.
    pub space: String,
    /// When it applies, in the words of the text.
    #[serde(default)]
    pub conditions: Vec<String>,
    /// The surest of its evidence: `high`, `medium` or `low`.
    pub confidence: String,
    /// Topic, where the finder knew it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub topic: Option<String>,
    /// The figure with its printed unit, where that is not the SI one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub original_value: Option<String>,
    /// `rules`, and the models that found it.
    pub found_by: Vec<String>,
    /// Every place that says so.
    pub evidence: Vec<Evidence>,
}

impl Corpus {
    /// Returns the corpus without rules that cannot mean what they say, and these: id and why.
    pub fn without_doubtful(&self) -> (Self, Vec<(String, String)>) {
        let (mut kept, mut apart) = (self.clone(), Vec::new());
        kept.constraints.retain(|c| match doubt(&[&c.name, &c.basis, &c.space], &c.unit, &c.value) {
            None => true,
            Some(reason) => {
                apart.push((c.constraint_id.clone(), reason));
                false
            }
        });
        (kept, apart)
    }
}

impl Document for Corpus {
    const KIND: &'static str = "research_corpus";

    fn check(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        if self.version != 1 {
            problems.push(Problem::new("/version", format!("is {}, this release reads version 1", self.version)));
        }
        if !is_date(&self.date) {
            problems.push(Problem::new("/date", format!("`{}` is no date like 2026-11-21", self.date)));
        }
        let mut documents = BTreeSet::new();
        for (i, document) in self.documents.iter().enumerate() {
            if !documents.insert(document.document_id.as_str()) {
                let message = format!("`{}` is used twice; ids are unique", document.document_id);
                problems.push(Problem::new(format!("/documents/{i}/document_id"), message));
            }
        }
        let mut constraints = BTreeSet::new();
        for (i, constraint) in self.constraints.iter().enumerate() {
            let path = format!("/constraints/{i}");
            if !constraints.insert(constraint.constraint_id.as_str()) {
                let message = format!("`{}` is used twice; ids are unique", constraint.constraint_id);
                problems.push(Problem::new(format!("{path}/constraint_id"), message));
            }
            check_constraint(&path, constraint, &documents, &mut problems);
        }
        problems
    }
}

fn check_constraint(
    path: &str,
    constraint: &CorpusConstraint,
    documents: &BTreeSet<&str>,
    problems: &mut Vec<Problem>,
) {
    let mut problem = |field: &str, message: String| problems.push(Problem::new(format!("{path}/{field}"), message));
    for (field, word, known) in [
        ("constraint_type", &constraint.constraint_type, CONSTRAINT_TYPES.as_slice()),
        ("confidence", &constraint.confidence, CONFIDENCES.as_slice()),
    ] {
        if !known.contains(&word.as_str()) {
            problem(field, format!("`{word}` is none of {}", known.join(", ")));
        }
    }
    if constraint.evidence.is_empty() {
        problem("evidence", "is empty; every rule has a place that says so".into());
    }
    for (k, evidence) in constraint.evidence.iter().enumerate() {
        if !documents.contains(evidence.document_id.as_str()) {
            let message = format!("`{}` is not among the documents", evidence.document_id);
            problem(&format!("evidence/{k}/document_id"), message);
        }
    }
}
