//! Which kind of building a request is about, and where it stands: the first of the paper's four stages.

use d3dgen_llm::{Request, Schema, fill};
use d3dgen_model::knowledge::is_jurisdiction;
use serde_json::{Value, json};

use super::prompts::{fenced, prompts};
use crate::Error;

/// Longest request that is read, in characters.
const MAX_REQUEST: usize = 4_000;

/// Returns the question.
///
/// # Errors
/// `Problems` for a request that is empty or very long; `Model` when there are no domains to choose from.
pub fn request(text: &str, domains: &[String]) -> Result<Request, Error> {
    let text = text.trim();
    if text.is_empty() || text.chars().count() > MAX_REQUEST {
        let message = format!("the request has {} characters; it needs 1 to {MAX_REQUEST}", text.chars().count());
        return Err(Error::Problems(vec![message]));
    }
    let or_null = json!({"type": ["string", "null"]});
    let schema = json!({
        "type": "object",
        "properties": {"domain": {"type": "string", "enum": domains}, "country": or_null, "country_code": or_null},
        "required": ["domain", "country", "country_code"],
        "additionalProperties": false,
    });
    let schema =
        Schema::new("request", schema).map_err(|e| Error::Model { stage: "infer".into(), source: Box::new(e) })?;
    let prompt = &prompts().infer;
    Ok(Request::new("infer", fill(&prompt.user, &[("request", &fenced(text))]))
        .with_system(prompt.system.trim())
        .with_schema(schema))
}

/// Returns domain and country of an answer; a country code that is none counts as not named.
pub fn read(answer: &Value) -> (Option<String>, Option<String>) {
    let word =
        |key: &str| answer.get(key).and_then(Value::as_str).map(|w| w.trim().to_owned()).filter(|w| !w.is_empty());
    let country = word("country_code").map(|c| c.to_uppercase()).filter(|c| is_jurisdiction(c));
    (word("domain"), country)
}
