//! The lines of `documents.jsonl`, `passages.jsonl` and `constraints.jsonl`: what a person may read, edit and hand back.

use d3dgen_model::knowledge::{CONFIDENCES, CONSTRAINT_TYPES, Value, is_date, is_jurisdiction};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One file or page that was read.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DocumentRecord {
    /// Joins the stage files; made of the name and the address or content.
    pub document_id: String,
    /// File below the given folder, or address, as it was read.
    pub source: String,
    /// Address of the document, where known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub url: Option<String>,
    /// SHA-256 of the bytes, lower-case hexadecimal; empty for what only a model's provider quoted.
    #[serde(default)]
    pub sha256: String,
    /// As the document, its sidecar or a flag says; null when nothing says it. The same holds for the fields below.
    pub title: Option<String>,
    /// Who published it.
    pub publisher: Option<String>,
    /// Edition or year.
    pub edition: Option<String>,
    /// ISO 3166 code, `EU` or `INT`.
    pub jurisdiction: Option<String>,
    /// One of the seven kinds in `data/source_types.toml`.
    pub source_type: Option<String>,
    /// ISO 639-1; empty when not known.
    #[serde(default)]
    pub language: String,
    /// `YYYY-MM-DD`.
    pub retrieved_at: String,
    /// True when only what a model's provider quoted of it was seen, not the page.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub quoted_only: bool,
    /// What could not be read, in words.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
}

/// A paragraph, list or table of a document.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PassageRecord {
    /// Unique in the document.
    pub passage_id: String,
    /// The document's.
    pub document_id: String,
    /// Headings above it, outermost first.
    #[serde(default)]
    pub heading: Vec<String>,
    /// `prose`, `list`, `table` or `quote`.
    pub kind: String,
    /// Page of a PDF, from 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub page: Option<u32>,
    /// One of the eight topics, when the passage was searched for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub topic: Option<String>,
    /// The words.
    pub text: String,
}

/// A place in a document that says so.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Evidence {
    /// The document's id.
    pub document_id: String,
    /// File or address it was read from.
    pub source: String,
    /// The passage's id.
    pub passage_id: String,
    /// Page of a PDF, from 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub page: Option<u32>,
    /// Bytes of the sentence or table row in the passage's text, from and to.
    pub span: [usize; 2],
    /// The sentence or table row.
    pub quote: String,
    /// The figure as printed.
    pub printed: String,
}

/// A rule as one place says it, with its figure as printed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConstraintRecord {
    /// What is limited, snake case.
    pub name: String,
    /// `minimum`, `maximum`, `range`, `ratio`, `table`, `recommendation` or `rule_of_thumb`.
    pub constraint_type: String,
    /// In `unit`.
    pub value: Value,
    /// Printed unit.
    pub unit: String,
    /// What the figure is given for (`per_bed`), empty for the whole.
    #[serde(default)]
    pub basis: String,
    /// Space or object it is about; empty when the text does not say.
    #[serde(default)]
    pub space: String,
    /// When it applies, in the words of the text.
    #[serde(default)]
    pub conditions: Vec<String>,
    /// `high`, `medium` or `low`.
    pub confidence: String,
    /// Topic, where the finder knew it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub topic: Option<String>,
    /// `rules`, or the model that found it.
    pub found_by: String,
    /// Where it says so.
    pub evidence: Evidence,
}

/// A line of a stage file.
pub trait Record: Serialize + for<'a> Deserialize<'a> {
    /// Name of the file.
    const FILE: &'static str;

    /// Returns what is wrong with it, each with the field's name.
    fn problems(&self) -> Vec<String>;
}

impl Record for DocumentRecord {
    const FILE: &'static str = "documents.jsonl";

    fn problems(&self) -> Vec<String> {
        let mut problems = Vec::new();
        if self.document_id.trim().is_empty() {
            problems.push("document_id is empty".into());
        }
        if !is_date(&self.retrieved_at) {
            problems.push(format!("retrieved_at `{}` is no date like 2026-11-21", self.retrieved_at));
        }
        if let Some(code) = self.jurisdiction.as_ref().filter(|c| !is_jurisdiction(c)) {
            problems.push(format!("jurisdiction `{code}` is no ISO 3166 code (`DE`, `US-NC`), `EU` or `INT`"));
        }
        if let Some(kind) = &self.source_type
            && !crate::synthesis::source_types().any(|t| t == kind)
        {
            let known: Vec<&str> = crate::synthesis::source_types().collect();
            problems.push(format!("source_type `{kind}` is none of {}", known.join(", ")));
        }
        problems
    }
}

impl Record for PassageRecord {
    const FILE: &'static str = "passages.jsonl";

    fn problems(&self) -> Vec<String> {
        let mut problems = Vec::new();
        if self.passage_id.trim().is_empty() {
            problems.push("passage_id is empty".into());
        }
        problems.extend(self.topic.as_deref().and_then(unknown_topic));
        problems
    }
}

impl Record for ConstraintRecord {
    const FILE: &'static str = "constraints.jsonl";

    fn problems(&self) -> Vec<String> {
        let mut problems = Vec::new();
        for (field, word, known) in [
            ("constraint_type", &self.constraint_type, CONSTRAINT_TYPES.as_slice()),
            ("confidence", &self.confidence, CONFIDENCES.as_slice()),
        ] {
            if !known.contains(&word.as_str()) {
                problems.push(format!("{field} `{word}` is none of {}", known.join(", ")));
            }
        }
        for (field, word) in [("name", &self.name), ("unit", &self.unit)] {
            if word.trim().is_empty() {
                problems.push(format!("{field} is empty"));
            }
        }
        match &self.value {
            Value::Range { min, max } if min > max => problems.push(format!("value: min {min} is above max {max}")),
            Value::Expression { expr } if expr.trim().is_empty() => problems.push("value: expr is empty".into()),
            _ => {}
        }
        problems.extend(self.topic.as_deref().and_then(unknown_topic));
        problems
    }
}

fn unknown_topic(topic: &str) -> Option<String> {
    let known: Vec<&str> = crate::synthesis::topics().map(|t| t.id.as_str()).collect();
    (!known.contains(&topic)).then(|| format!("topic `{topic}` is none of {}", known.join(", ")))
}
