//! The one form of JSON Schema that all providers take, and the check of answers against it.
//!
//! Providers differ in the keywords they accept, and some fail open on those they do not. So only this form is sent:
//! the root an object; every object lists all its properties as required and allows no others; what is optional may be
//! null; no references, bounds, patterns or lengths. Bounds are checked here, on the answer.
//! What it is not: a general JSON Schema library; `jsonschema` does the validation.

mod lowest;
mod normalize;

use std::fmt;
use std::sync::Arc;

use serde_json::Value;

use crate::error::Error;

pub use lowest::check_lowest_common;

/// The most problems told to a model in its one repair.
const MAX_PROBLEMS: usize = 12;
/// The longest text of one problem, in characters; it may quote the answer.
const MAX_PROBLEM_CHARS: usize = 240;

/// A schema for answers: the form that is sent and the stricter one that answers are checked against.
#[derive(Clone)]
pub struct Schema {
    name: String,
    wire: Value,
    full: Value,
    wire_validator: Arc<jsonschema::Validator>,
    full_validator: Arc<jsonschema::Validator>,
}

impl Schema {
    /// Takes a schema that is in the form already.
    ///
    /// # Errors
    /// [`Error::Config`] with every place where it is not; see [`check_lowest_common`].
    pub fn new(name: &str, schema: Value) -> Result<Self, Error> {
        Self::build(name, schema.clone(), schema)
    }

    /// Turns a schema as `schemars` makes it into the form: references are put in place, bounds are kept for the check
    /// only, what is optional becomes a union with null. An answer's null for a property that may be absent but not null
    /// is left out before the check.
    ///
    /// # Errors
    /// [`Error::Config`] if it says what the form cannot: maps, tuples, recursion, anything goes.
    pub fn from_schemars(name: &str, schema: &Value) -> Result<Self, Error> {
        let full = normalize::inline(schema).map_err(|problem| Error::config(format!("schema {name}: {problem}")))?;
        Self::build(name, normalize::lowest(&full), full)
    }

    fn build(name: &str, wire: Value, full: Value) -> Result<Self, Error> {
        if name.is_empty() || name.len() > 64 || !name.bytes().all(|b| b.is_ascii_alphanumeric() || b"_-".contains(&b))
        {
            return Err(Error::config(format!(
                "schema name `{name}` has to be 1 to 64 letters, digits, underscores or hyphens"
            )));
        }
        let problems = check_lowest_common(&wire);
        if !problems.is_empty() {
            return Err(Error::config(format!("schema {name} is not in the common form: {}", problems.join("; "))));
        }
        let compile = |schema: &Value| match jsonschema::validator_for(schema) {
            Ok(validator) => Ok(Arc::new(validator)),
            Err(e) => Err(Error::config(format!("schema {name} is no valid JSON Schema: {e}"))),
        };
        let (wire_validator, full_validator) = (compile(&wire)?, compile(&full)?);
        Ok(Self { name: name.to_owned(), wire, full, wire_validator, full_validator })
    }

    /// Returns its name: 1 to 64 letters, digits, underscores or hyphens.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the form that is sent.
    pub fn wire(&self) -> &Value {
        &self.wire
    }

    /// Checks an answer and returns it ready for its type: nulls of properties that may only be absent are left out.
    ///
    /// # Errors
    /// Every problem with its place, at most a dozen.
    pub fn check(&self, answer: Value) -> Result<Value, Vec<String>> {
        let mut problems = problems(&self.wire_validator, &answer);
        if problems.is_empty() {
            let answer = normalize::without_added_nulls(&self.full, answer);
            problems = self::problems(&self.full_validator, &answer);
            if problems.is_empty() {
                return Ok(answer);
            }
        }
        Err(problems)
    }
}

impl fmt::Debug for Schema {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Schema({})", self.name)
    }
}

/// Returns what a validator says, with places.
fn problems(validator: &jsonschema::Validator, answer: &Value) -> Vec<String> {
    let problem = |e: jsonschema::ValidationError<'_>| {
        let place = e.instance_path().to_string();
        let place = if place.is_empty() { "the answer".to_owned() } else { place };
        format!("{place}: {e}").chars().take(MAX_PROBLEM_CHARS).collect()
    };
    validator.iter_errors(answer).take(MAX_PROBLEMS).map(problem).collect()
}

#[cfg(test)]
mod tests;
