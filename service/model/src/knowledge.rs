//! The knowledge base of a domain: references, their sources and the constraints drawn from them.
//!
//! The shape is the paper's (`rag_data.generated.json`, arXiv 2608.11876): metadata, then references, each with sources
//! and constraints whose `value` is polymorphic.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

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
    /// Ids of shared knowledge bases whose rules hold too (`egress`, `accessibility`, `workplace`).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub uses: Vec<String>,
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
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
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
    /// Where in the source it stands (`Art. 21`, `5.2`).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clause: Option<String>,
    /// Words of the source or of the page where it was checked, 25 at most; only where they were read.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quotation: Option<String>,
    /// First day it holds, where that is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub in_force_from: Option<String>,
    /// Last day it held; such a rule is no law for new buildings any more, and is reported as what it was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub in_force_until: Option<String>,
    /// What replaced it: the id of a constraint, or the name of a document.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub superseded_by: Option<String>,
}

/// Words of a quotation at most: enough to find the place, too few to stand for the text.
const QUOTED_WORDS: usize = 25;

impl Constraint {
    /// Returns whether it had ended on a day (`2026-11-21`).
    pub fn has_ended(&self, on: &str) -> bool {
        self.in_force_until.as_deref().is_some_and(|last| last < on)
    }
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

/// The figure as it is printed, without its unit.
impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flag(flag) => flag.fmt(f),
            Self::Number(n) => n.fmt(f),
            Self::Range { min, max } => write!(f, "{min} to {max}"),
            Self::Expression { expr } => f.write_str(expr),
            Self::List(items) => f.write_str(&serde_json::to_string(items).map_err(|_| fmt::Error)?),
            Self::Table(table) => f.write_str(&serde_json::to_string(table).map_err(|_| fmt::Error)?),
        }
    }
}

impl KnowledgeBase {
    /// Returns a knowledge base without references, for a domain that brings none.
    pub fn empty(domain: &str) -> Self {
        let metadata = Metadata {
            version: 1,
            domain: domain.into(),
            uses: Vec::new(),
            generated_by: "no knowledge.json was given".into(),
            date: "1970-01-01".into(),
            notes: Vec::new(),
        };
        Self { metadata, references: Vec::new() }
    }
}

/// Kinds of constraint.
pub const CONSTRAINT_TYPES: [&str; 7] =
    ["minimum", "maximum", "range", "ratio", "table", "recommendation", "rule_of_thumb"];

/// How sure a figure is, surest first.
pub const CONFIDENCES: [&str; 3] = ["high", "medium", "low"];

/// Jurisdiction of rules that the owner of a building sets: they hold wherever it stands, beside the law of the place.
pub const LOCAL: &str = "LOCAL";

/// Source type of rules that a person has set or changed in the database.
pub const AMENDMENT: &str = "amendment";

impl Document for KnowledgeBase {
    const KIND: &'static str = "knowledge_base";
    const VERSION_AT: &'static str = "/metadata/version";

    fn check(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        if self.metadata.version != 1 {
            let message = format!("is {}, this release reads version 1", self.metadata.version);
            problems.push(Problem::new("/metadata/version", message));
        }
        let domain = &self.metadata.domain;
        if domain.is_empty() || !domain.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_') {
            let message = format!("`{domain}` is no id of a domain: lower-case letters, digits and underscores");
            problems.push(Problem::new("/metadata/domain", message));
        }
        check_date("/metadata/date", &self.metadata.date, &mut problems);
        check_unique("/references", self.references.iter().map(|r| r.ref_id.as_str()), &mut problems);
        let mut seen = BTreeSet::new();
        for (i, reference) in self.references.iter().enumerate() {
            let path = format!("/references/{i}");
            check_reference(&path, reference, &mut problems);
            for (j, constraint) in reference.constraints.iter().enumerate() {
                let path = format!("{path}/constraints/{j}");
                if !seen.insert(&constraint.constraint_id) {
                    problems.push(Problem::new(
                        format!("{path}/constraint_id"),
                        format!("`{}` is used twice; ids are unique in the file", constraint.constraint_id),
                    ));
                }
                check_constraint(&path, constraint, reference, &mut problems);
            }
        }
        problems
    }
}

fn check_reference(path: &str, reference: &Reference, problems: &mut Vec<Problem>) {
    check_id(&format!("{path}/ref_id"), &reference.ref_id, problems);
    check_date(&format!("{path}/retrieved_at"), &reference.retrieved_at, problems);
    if !is_jurisdiction(&reference.jurisdiction) {
        problems.push(Problem::new(
            format!("{path}/jurisdiction"),
            format!("`{}` is no ISO 3166 code (`DE`, `US-NC`), `EU`, `INT` or `LOCAL`", reference.jurisdiction),
        ));
    }
    check_unique(&format!("{path}/sources"), reference.sources.iter().map(|s| s.source_id.as_str()), problems);
    for (k, source) in reference.sources.iter().enumerate() {
        if source.url.as_ref().is_some_and(|u| !is_address(u)) {
            problems.push(Problem::new(
                format!("{path}/sources/{k}/url"),
                "is no address like https://... or urn:...; leave it out when there is none",
            ));
        }
    }
}

fn check_constraint(path: &str, constraint: &Constraint, reference: &Reference, problems: &mut Vec<Problem>) {
    let mut problem = |field: &str, message: String| problems.push(Problem::new(format!("{path}/{field}"), message));
    for (k, id) in constraint.source_ids.iter().enumerate() {
        if !reference.sources.iter().any(|s| &s.source_id == id) {
            problem(&format!("source_ids/{k}"), format!("`{id}` is not in the sources of `{}`", reference.ref_id));
        }
    }
    if constraint.source_ids.is_empty() {
        problem("source_ids", "is empty; every constraint cites a source".into());
    }
    for (field, word, known) in [
        ("constraint_type", &constraint.constraint_type, CONSTRAINT_TYPES.as_slice()),
        ("confidence", &constraint.confidence, CONFIDENCES.as_slice()),
    ] {
        if !known.contains(&word.as_str()) {
            problem(field, format!("`{word}` is none of {}", known.join(", ")));
        }
    }
    match &constraint.value {
        Value::Range { min, max } if min > max => problem("value", format!("min {min} is above max {max}")),
        Value::Expression { expr } if expr.trim().is_empty() => problem("value/expr", "is empty".into()),
        Value::List(list) if list.is_empty() => problem("value", "is an empty list".into()),
        Value::Table(table) if table.is_empty() => problem("value", "is an empty table".into()),
        _ => {}
    }
    if constraint.quotation.as_ref().is_some_and(|q| q.split_whitespace().count() > QUOTED_WORDS) {
        problem("quotation", format!("has more than {QUOTED_WORDS} words"));
    }
    let term = [("in_force_from", &constraint.in_force_from), ("in_force_until", &constraint.in_force_until)];
    for (field, date) in term.iter().filter_map(|(field, date)| Some((field, date.as_ref()?))) {
        check_date(&format!("{path}/{field}"), date, problems);
    }
    if let [(_, Some(from)), (field, Some(until))] = term
        && from > until
    {
        problems.push(Problem::new(format!("{path}/{field}"), format!("{until} is before {from}, its first day")));
    }
    check_id(&format!("{path}/constraint_id"), &constraint.constraint_id, problems);
    for (field, word) in
        [("name", &constraint.name), ("unit", &constraint.unit), ("space_type", &constraint.space_type)]
    {
        if word.trim().is_empty() {
            problems.push(Problem::new(format!("{path}/{field}"), "is empty"));
        }
    }
}

fn check_id(path: &str, id: &str, problems: &mut Vec<Problem>) {
    if id.trim().is_empty() || id.chars().any(char::is_control) || id.len() > 200 {
        problems.push(Problem::new(path, "an id has 1 to 200 bytes and no control characters"));
    }
}

fn check_date(path: &str, date: &str, problems: &mut Vec<Problem>) {
    if !is_date(date) {
        problems.push(Problem::new(path, format!("`{date}` is no date like 2026-11-21")));
    }
}

/// Returns true for an address that others can follow or look up: not one of this machine, not a program.
fn is_address(url: &str) -> bool {
    let Some((scheme, rest)) = url.split_once(':') else { return false };
    let named = scheme.starts_with(|c: char| c.is_ascii_lowercase())
        && scheme.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || matches!(b, b'+' | b'-' | b'.'));
    named && !rest.is_empty() && !matches!(scheme, "file" | "data" | "javascript")
}

/// Returns true for `YYYY-MM-DD`.
pub fn is_date(text: &str) -> bool {
    let parts: Vec<&str> = text.split('-').collect();
    let number = |part: &str, len: usize| (part.len() == len).then(|| part.parse::<u32>().ok()).flatten();
    match parts.as_slice() {
        [year, month, day] => {
            number(year, 4).is_some()
                && number(month, 2).is_some_and(|m| (1..=12).contains(&m))
                && number(day, 2).is_some_and(|d| (1..=31).contains(&d))
        }
        _ => false,
    }
}

/// Returns true for an ISO 3166-1 or 3166-2 code, `EU`, `INT` and `LOCAL`.
pub fn is_jurisdiction(code: &str) -> bool {
    let upper = |part: &str| part.bytes().all(|b| b.is_ascii_uppercase());
    let (country, division) = code.split_once('-').map_or((code, None), |(c, d)| (c, Some(d)));
    let division_fits = division
        .is_none_or(|d| (1..=3).contains(&d.len()) && d.bytes().all(|b| b.is_ascii_uppercase() || b.is_ascii_digit()));
    matches!(code, "INT" | LOCAL) || country.len() == 2 && upper(country) && division_fits
}

/// A rule as somebody states it, in printed units.
#[derive(Debug, Clone, PartialEq)]
pub struct Statement {
    /// What is limited, snake case.
    pub name: String,
    /// `minimum`, `maximum`, ...
    pub constraint_type: String,
    /// The figure, in `unit`.
    pub value: Value,
    /// Unit as printed.
    pub unit: String,
    /// Space it is about, as the knowledge base calls it where it can be known.
    pub space: String,
    /// When it holds, in words.
    pub conditions: Vec<String>,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> serde_json::Value {
        serde_json::json!({
            "metadata": {"version": 1, "domain": "office", "generated_by": "test", "date": "2026-11-21"},
            "references": [{
                "ref_id": "r", "building_type": "office", "jurisdiction": "DE", "retrieved_at": "2026-11-21",
                "sources": [{"source_id": "s1", "title": "T", "publisher": "P", "edition_or_year": "2020",
                    "url": "https://example.org", "type": "standard"}],
                "constraints": [{
                    "constraint_id": "c", "name": "corridor_width", "topic": "room_size", "constraint_type": "minimum",
                    "value": 1.5, "unit": "m", "measurement_basis": "clear_width", "space_type": "corridor",
                    "confidence": "high", "verified": "seen", "source_ids": ["s1"]
                }]
            }]
        })
    }

    #[test]
    fn every_problem_is_named_with_its_place() {
        assert!(KnowledgeBase::from_value(sample()).is_ok());
        let cases: &[(&str, serde_json::Value)] = &[
            ("/metadata/version", 2.into()),
            ("/metadata/domain", "my/office".into()),
            ("/metadata/date", "yesterday".into()),
            ("/references/0/ref_id", "".into()),
            ("/references/0/jurisdiction", "Germany".into()),
            ("/references/0/retrieved_at", "2026-13-01".into()),
            ("/references/0/sources/0/url", "file:///etc/passwd".into()),
            ("/references/0/constraints/0/constraint_type", "least".into()),
            ("/references/0/constraints/0/confidence", "sure".into()),
            ("/references/0/constraints/0/value", serde_json::json!({"min": 2.0, "max": 1.0})),
            ("/references/0/constraints/0/source_ids", serde_json::json!([])),
            ("/references/0/constraints/0/unit", " ".into()),
        ];
        for (path, wrong) in cases {
            let mut document = sample();
            *document.pointer_mut(path).expect("the sample has the field") = wrong.clone();
            match KnowledgeBase::from_value(document) {
                Err(crate::Error::Invalid { problems, .. }) => {
                    assert!(problems.iter().any(|p| p.path.starts_with(path)), "{path}: {problems:?}");
                }
                other => panic!("{path} = {wrong}: {other:?}"),
            }
        }
    }

    #[test]
    fn places_have_codes() {
        for code in ["DE", "US-NC", "AT-1", "EU", "INT", "LOCAL", "AE-DU"] {
            assert!(is_jurisdiction(code), "{code}");
        }
        for code in ["", "de", "D", "DEU", "DE-", "DE-ABCD", "DE_BY", "INTL"] {
            assert!(!is_jurisdiction(code), "{code}");
        }
    }
}
