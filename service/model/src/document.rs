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

/// A step from one version of a kind of document to the next, on parsed JSON; it writes the new version too.
pub type Upgrade = fn(&mut Value) -> Result<(), Problem>;

/// A versioned JSON document with a schema in `schemas/`.
pub trait Document: Serialize + DeserializeOwned + JsonSchema {
    /// Snake-case name, also the schema's file name.
    const KIND: &'static str;
    /// JSON pointer of the version.
    const VERSION_AT: &'static str = "/version";
    /// The step from each earlier version to the next, from version 1 on. `tests/documents/` has samples of all versions.
    const UPGRADES: &'static [Upgrade] = &[];

    /// Returns every rule of the document that its schema cannot express and that does not hold.
    fn check(&self) -> Vec<Problem>;

    /// Returns the version that this release writes.
    fn current_version() -> u64 {
        1 + Self::UPGRADES.len() as u64
    }

    /// Returns the version that a document says it has.
    fn version_of(value: &Value) -> Option<u64> {
        value.pointer(Self::VERSION_AT).and_then(Value::as_u64)
    }

    /// Brings a document of an earlier version to the one of this release; any other stays as it is.
    ///
    /// # Errors
    /// `Invalid` when a step cannot make sense of it.
    fn upgrade(value: &mut Value) -> Result<(), Error> {
        let first = Self::version_of(value).and_then(|found| usize::try_from(found).ok()?.checked_sub(1));
        for step in first.and_then(|first| Self::UPGRADES.get(first..)).unwrap_or_default() {
            step(value).map_err(|problem| Error::Invalid { kind: Self::KIND, problems: vec![problem] })?;
        }
        Ok(())
    }

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

    /// Reads a document of this version or an earlier one from parsed JSON (or TOML turned into JSON); as
    /// [`Document::from_json`].
    ///
    /// # Errors
    /// `Invalid` when the schema or [`Document::check`] finds problems; of a later version that does not fit, only the version.
    fn from_value(mut value: Value) -> Result<Self, Error> {
        Self::upgrade(&mut value)?;
        let invalid = |problems| Error::Invalid { kind: Self::KIND, problems };
        let validator = jsonschema::validator_for(&Self::schema())
            .map_err(|e| invalid(vec![Problem::new("", format!("the schema itself is broken: {e}"))]))?;
        let problems: Vec<Problem> =
            validator.iter_errors(&value).map(|e| Problem::new(e.instance_path().to_string(), e.to_string())).collect();
        if !problems.is_empty() {
            return Err(invalid(later::<Self>(&value).map_or(problems, |later| vec![later])));
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

/// Returns the one thing to say of a document that a later release wrote.
fn later<D: Document>(value: &Value) -> Option<Problem> {
    let (found, current) = (D::version_of(value)?, D::current_version());
    let message = || {
        format!(
            "is {found}, this release reads version {current}: read it with the release that wrote it, or a later one"
        )
    };
    (found > current).then(|| Problem::new(D::VERSION_AT, message()))
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

#[cfg(test)]
mod tests {
    use serde::Deserialize;
    use serde_json::json;

    use super::*;

    /// A kind of document in its third version: `width` became `width_m`, then `name` came in.
    #[derive(Debug, Serialize, Deserialize, JsonSchema, PartialEq)]
    #[serde(deny_unknown_fields)]
    struct Plank {
        version: u32,
        width_m: f64,
        name: String,
    }

    impl Document for Plank {
        const KIND: &'static str = "plank";
        const UPGRADES: &'static [Upgrade] = &[in_meters, named];

        fn check(&self) -> Vec<Problem> {
            Vec::new()
        }
    }

    fn in_meters(value: &mut Value) -> Result<(), Problem> {
        let width = value["width"].as_f64().ok_or_else(|| Problem::new("/width", "is no number"))?;
        *value = json!({"version": 2, "width_m": width / 100.0});
        Ok(())
    }

    fn named(value: &mut Value) -> Result<(), Problem> {
        (value["version"], value["name"]) = (3.into(), "plank".into());
        Ok(())
    }

    #[test]
    fn a_document_of_any_earlier_version_is_read() {
        let today = Plank { version: 3, width_m: 0.2, name: "plank".into() };
        for old in [json!({"version": 1, "width": 20}), json!({"version": 2, "width_m": 0.2}), json!(today)] {
            assert_eq!(Plank::from_value(old.clone()).unwrap(), today, "{old}");
        }
    }

    #[test]
    fn what_cannot_be_upgraded_says_where() {
        let told = |value| Plank::from_value(value).unwrap_err().to_string();
        assert!(told(json!({"version": 1, "width": "wide"})).contains("/width: is no number"));
        let later = told(json!({"version": 4, "widths_m": [0.2]}));
        assert!(
            later.contains("1 problem") && later.contains("/version: is 4, this release reads version 3"),
            "{later}"
        );
        // neither a step nor a version of its own: the schema says what is wrong
        for odd in [json!({"version": 0}), json!({"version": -1}), json!({"version": "1"}), json!({}), json!([])] {
            assert!(!told(odd.clone()).contains("release"), "{odd}");
        }
    }
}
