//! Makes one category of error out of what providers answer. The words they use are data: `data/errors.toml`.

use std::sync::LazyLock;

use serde::Deserialize;
use serde_json::Value;

use crate::delay;
use crate::error::Error;
use crate::providers::{Failure, Fix};
use crate::transport::Response;

/// The longest text of a provider in an error, in characters.
const MAX_MESSAGE_CHARS: usize = 500;

#[derive(Deserialize)]
struct Words {
    category: Vec<Category>,
}

#[derive(Deserialize)]
struct Category {
    name: String,
    #[serde(default)]
    weak: bool,
    codes: Vec<String>,
    phrases: Vec<String>,
}

static WORDS: LazyLock<Words> =
    LazyLock::new(|| toml::from_str(include_str!("../data/errors.toml")).expect("the shipped table is well formed"));

/// What an error of any provider says, in one form.
#[derive(Debug, Default)]
pub(crate) struct Fault {
    /// HTTP status, 0 if the HTTP call succeeded.
    pub status: u16,
    /// The text for people.
    pub message: String,
    /// Code, type, status and reasons, in lower case.
    pub codes: Vec<String>,
    /// The parameter at fault.
    pub param: String,
    /// Details of Google APIs.
    pub details: Vec<Value>,
}

impl Fault {
    /// Reads the error of a response that has a status of failure.
    pub fn of_response(response: &Response) -> Self {
        let text = response.text();
        let body: Value = serde_json::from_str(&text).unwrap_or(Value::Null);
        let mut fault = Self::of_body(&body).unwrap_or_else(|| Self {
            message: match text.trim_start().starts_with('<') {
                true => "a page instead of JSON; is a proxy between, or the base URL wrong?".to_owned(),
                false => shortened(&text),
            },
            ..Self::default()
        });
        fault.status = response.status;
        fault
    }

    /// Reads an error object in any of its forms: wrapped, flat, a plain text, or in a list.
    pub fn of_body(body: &Value) -> Option<Self> {
        let body = match body {
            Value::Array(items) => items.first()?,
            other => other,
        };
        match body.get("error") {
            Some(Value::String(text)) => Some(Self { message: shortened(text), ..Self::default() }),
            Some(error @ Value::Object(_)) => Some(Self::of_error(error)),
            _ if body.get("message").or(body.get("detail")).is_some() => Some(Self::of_error(body)),
            _ => None,
        }
    }

    /// Reads the inner object of an error.
    pub fn of_error(error: &Value) -> Self {
        let text = |key: &str| match error.get(key) {
            Some(Value::String(text)) => text.clone(),
            Some(Value::Number(number)) => number.to_string(),
            Some(other) if key == "detail" => other.to_string(),
            _ => String::new(),
        };
        let details: Vec<Value> = error.get("details").and_then(Value::as_array).cloned().unwrap_or_default();
        let inner = error.pointer("/innererror/code").and_then(Value::as_str).unwrap_or_default().to_owned();
        let reasons = details.iter().filter_map(|d| d.get("reason")?.as_str()).map(str::to_owned);
        let codes = [text("code"), text("type"), text("status"), inner].into_iter().chain(reasons);
        let message = if text("message").is_empty() { text("detail") } else { text("message") };
        Self {
            status: 0,
            message: shortened(&message),
            codes: codes.map(|c| c.to_lowercase()).filter(|c| !c.is_empty()).collect(),
            param: text("param"),
            details,
        }
    }

    /// Returns the failure, with the wait that `response` asks for.
    pub fn failure(&self, model: &str, response: Option<&Response>) -> Failure {
        let wait = response.and_then(delay::of_headers).or_else(|| delay::of_details(&self.details));
        let wait = wait.or_else(|| delay::of_message(&self.message));
        let should_retry = match response.and_then(|r| r.header("x-should-retry")) {
            Some("true") => Some(true),
            Some("false") => Some(false),
            _ => matches!(self.status, 501 | 505 | 511).then_some(false),
        };
        Failure { error: self.error(model, wait), fix: self.fix(), should_retry, ..Failure::default() }
    }

    fn error(&self, model: &str, retry_after_ms: Option<u64>) -> Error {
        let message = if self.message.is_empty() { format!("status {}", self.status) } else { self.message.clone() };
        match self.category() {
            "quota_exhausted" => Error::QuotaExhausted { message },
            "too_long" => Error::TooLong { message },
            "blocked" => Error::Blocked { reason: message },
            "model_not_found" => Error::ModelNotFound { model: model.to_owned(), message },
            "auth" => Error::Auth { message },
            "rate_limited" => Error::RateLimited { retry_after_ms, hint: None, message },
            "unavailable" => {
                let status = (self.status != 0).then_some(self.status);
                Error::Unavailable { status, retry_after_ms, message }
            }
            _ => Error::BadRequest { message },
        }
    }

    fn category(&self) -> &str {
        if delay::is_long_quota(&self.details) || self.status == 402 {
            return "quota_exhausted";
        }
        let message = self.message.to_lowercase();
        let fits = |c: &&Category| {
            c.codes.iter().any(|w| self.codes.contains(w)) || c.phrases.iter().any(|w| message.contains(w.as_str()))
        };
        if let Some(category) = WORDS.category.iter().filter(|c| !c.weak).find(fits) {
            return &category.name;
        }
        match self.status {
            401 | 403 => "auth",
            404 | 410 if message.contains("model") => "model_not_found",
            413 => "too_long",
            429 => "rate_limited",
            408 | 409 | 425 | 500.. => "unavailable",
            300.. => "bad_request",
            _ => WORDS.category.iter().filter(|c| c.weak).find(fits).map_or("unavailable", |c| &c.name),
        }
    }

    /// Returns the change to the request that the message asks for.
    fn fix(&self) -> Option<Fix> {
        if !matches!(self.status, 400 | 422) {
            return None;
        }
        let message = self.message.to_lowercase();
        let refused = [
            "not support",
            "unsupported",
            "unrecognized",
            "unknown",
            "unexpected",
            "not permitted",
            "use '",
            "extra",
            "deprecated",
            "unavailable",
            "not allowed",
        ];
        let refused =
            refused.iter().any(|w| message.contains(w)) || self.codes.iter().any(|c| c.contains("unsupported"));
        let about = |name: &str| self.param == name || message.contains(name);
        let invalid_schema = message.contains("invalid schema") || message.contains("invalid json_schema");
        match () {
            () if message.contains("thinking") || about("reasoning_effort") => Some(Fix::WithoutThinking),
            () if refused && (about("max_tokens") || about("max_completion_tokens")) => Some(Fix::OtherTokenField),
            () if refused && about("temperature") => Some(Fix::WithoutTemperature),
            () if refused
                && (about("output_config") || about("output_format") || message.contains("structured output")) =>
            {
                Some(Fix::ForcedTool)
            }
            () if refused && !invalid_schema && about("response_format") => Some(Fix::SchemaInPrompt),
            () => None,
        }
    }
}

/// Returns a text of a provider for an error: without control characters and not too long.
pub(crate) fn shortened(text: &str) -> String {
    let clean: String = text.trim().chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    match clean.char_indices().nth(MAX_MESSAGE_CHARS) {
        Some((end, _)) => format!("{}...", &clean[..end]),
        None => clean,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn check(status: u16, body: Value, expected: &str) {
        let mut fault = Fault::of_body(&body).unwrap_or_default();
        fault.status = status;
        assert_eq!(fault.failure("m", None).error.category(), expected, "{status} {body}");
    }

    #[test]
    fn errors_of_all_shapes_have_a_category() {
        check(400, json!({"error": {"message": "Your credit balance is too low", "type": "x"}}), "quota_exhausted");
        check(400, json!({"error": {"message": "prompt is too long: 300000 tokens > 200000 maximum"}}), "too_long");
        check(
            400,
            json!({"message": "maximum context length is 2048 tokens. However, you requested 9 tokens"}),
            "too_long",
        );
        check(400, json!({"error": {"code": "content_filter", "message": "filtered"}}), "blocked");
        check(404, json!({"error": {"message": "File Not Found", "type": "not_found_error"}}), "bad_request");
        check(404, json!({"error": "model 'x' not found"}), "model_not_found");
        check(403, json!({"error": {"code": 403, "status": "PERMISSION_DENIED"}}), "auth");
        check(422, json!({"detail": [{"loc": ["body"], "msg": "x"}]}), "bad_request");
        check(302, json!(null), "bad_request");
        check(521, json!(null), "unavailable");
        check(409, json!(null), "unavailable");
        check(0, json!({"error": {"code": 8, "message": "x"}}), "rate_limited");
        check(0, json!({"error": {"code": "server_error"}}), "unavailable");
        check(0, json!({"error": {"code": "never heard of"}}), "unavailable");
        check(0, json!({"error": {"code": 3, "message": "bad"}}), "bad_request");
    }

    #[test]
    fn a_long_or_hostile_message_is_cut_and_cleaned() {
        let text = shortened(&format!("\u{1b}[31mred{}", "ä".repeat(2000)));
        assert!(text.chars().count() <= MAX_MESSAGE_CHARS + 3 && !text.contains('\u{1b}'));
    }
}
