//! What all documents share: a kind, a version, a schema, a check at the door, one written form.

use std::fmt;

use schemars::JsonSchema;
use serde::{Serialize, de::DeserializeOwned};
use serde_json::Value;

use crate::Error;

/// One thing wrong with a document, and where it stands.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Problem {
    /// JSON pointer into the document, for instance `/rooms/3/area_m2/min`; empty for the whole document.
    pub path: String,
    /// What is wrong and what would be right: lower case, no full stop.
    pub message: String,
}

impl Problem {
    /// Returns a problem at a JSON pointer.
    pub fn new(path: impl Into<String>, message: impl Into<String>) -> Self {
        Self { path: path.into(), message: message.into() }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let path = if self.path.is_empty() { "/" } else { &self.path };
        write!(f, "{path}: {}", self.message)
    }
}

/// A versioned JSON document with a schema in `schemas/`.
pub trait Document: Serialize + DeserializeOwned + JsonSchema {
    /// Snake-case name, also the schema's file name.
    const KIND: &'static str;

    /// Returns every rule of the document that its schema cannot express and that does not hold.
    fn check(&self) -> Vec<Problem>;

    /// Returns the JSON Schema (draft 2020-12) of the document.
    fn schema() -> Value {
        let mut schema = schemars::schema_for!(Self).to_value();
        if let Some(object) = schema.as_object_mut() {
            object.insert("$id".into(), format!("https://d3dgen.org/schemas/{}.schema.json", Self::KIND).into());
        }
        schema
    }

    /// Reads a document and reports every problem with its path.
    ///
    /// # Errors
    /// `NotJson` when the text does not parse; `Invalid` when the schema or [`Document::check`] finds problems.
    fn from_json(text: &str) -> Result<Self, Error> {
        let value: Value =
            serde_json::from_str(text).map_err(|e| Error::NotJson { kind: Self::KIND, reason: e.to_string() })?;
        Self::from_value(value)
    }

    /// Reads a document from parsed JSON (or TOML turned into JSON); as [`Document::from_json`].
    ///
    /// # Errors
    /// `Invalid` when the schema or [`Document::check`] finds problems.
    fn from_value(value: Value) -> Result<Self, Error> {
        let invalid = |problems| Error::Invalid { kind: Self::KIND, problems };
        let validator = jsonschema::validator_for(&Self::schema())
            .map_err(|e| invalid(vec![Problem::new("", format!("the schema itself is broken: {e}"))]))?;
        let problems: Vec<Problem> =
            validator.iter_errors(&value).map(|e| Problem::new(e.instance_path().to_string(), e.to_string())).collect();
        if !problems.is_empty() {
            return Err(invalid(problems));
        }
        let document: Self =
            serde_json::from_value(value).map_err(|e| invalid(vec![Problem::new("", e.to_string())]))?;
        let problems = document.check();
        if problems.is_empty() { Ok(document) } else { Err(invalid(problems)) }
    }

    /// Returns the one written form: indented JSON in field order, with a final line break.
    fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).expect("documents hold only finite numbers and string keys");
        text.push('\n');
        text
    }
}

/// Adds a problem for every id that occurs twice.
pub(crate) fn check_unique<'a>(path: &str, ids: impl Iterator<Item = &'a str>, problems: &mut Vec<Problem>) {
    let mut seen = std::collections::BTreeSet::new();
    for (i, id) in ids.enumerate() {
        if !seen.insert(id) {
            problems.push(Problem::new(format!("{path}/{i}"), format!("`{id}` is used twice; ids are unique")));
        }
    }
}
