//! Gemini, Interactions API. `store` is always false: otherwise the exchange is kept on the server. Positions are bytes.

use serde_json::{Map, Value, json};

use crate::answer::{Answer, Finish, Segment, Usage};
use crate::classify::Fault;
use crate::error::Error;
use crate::providers::gemini::broken_off;
use crate::providers::http::{Http, Wire, count, done, list, text, truncated};
use crate::providers::{Config, Entry, Failure, Fix, Turn, Tweaks};
use crate::request::{Request, Role};
use crate::stream::Documents;
use crate::transport::Call;

const BASE_URL: &str = "https://generativelanguage.googleapis.com";

pub(super) const ENTRY: Entry = Entry {
    name: "gemini_interactions",
    about: "Google Gemini, Interactions API; searches with google_search",
    base_url: BASE_URL,
    key_variable: Some("GEMINI_API_KEY"),
    searches: true,
    build: |config| Http::build("gemini_interactions", BASE_URL, config, |config| Interactions { config }),
};

struct Interactions {
    config: Config,
}

impl Wire for Interactions {
    fn encode(&self, request: &Request, tweaks: &Tweaks) -> Result<Call, Error> {
        let mut body = Map::new();
        body.insert("model".into(), json!(self.config.model));
        body.insert("input".into(), input(request));
        if let Some(system) = &request.system {
            body.insert("system_instruction".into(), json!(system));
        }
        let mut generation = Map::new();
        generation.insert("max_output_tokens".into(), json!(request.max_output_tokens));
        if let Some(level) = self.config.thinking.as_ref().filter(|_| !tweaks.fixes.contains(&Fix::WithoutThinking)) {
            generation.insert("thinking_level".into(), json!(level));
        }
        body.insert("generation_config".into(), Value::Object(generation));
        if request.grounding.is_some() {
            body.insert("tools".into(), json!([{"type": "google_search"}]));
        } else if let Some(schema) = &request.schema {
            let format = json!({"type": "text", "mime_type": "application/json", "schema": schema.wire()});
            body.insert("response_format".into(), format);
        }
        body.insert("store".into(), json!(false));
        let url = self.config.url(BASE_URL, "v1beta", "interactions")?;
        Call::new(url, Some(Value::Object(body))).key("x-goog-api-key", "", self.config.key.as_ref())
    }

    fn decode(&self, request: &Request, _tweaks: &Tweaks, documents: Documents) -> Result<Turn, Failure> {
        let Some(response) = documents.items.first().filter(|_| !documents.streamed) else {
            return Err(broken_off(Usage::default()));
        };
        let (answer, fault) = read(response);
        match text(response, "status") {
            "completed" => {}
            "incomplete" => return Err(truncated(request, answer)),
            status => {
                let fault = fault.unwrap_or_else(|| Fault {
                    message: format!("the interaction ended with status `{status}`"),
                    codes: vec!["unavailable".to_owned()],
                    ..Fault::default()
                });
                return Err(fault.failure(&self.config.model, None).with_usage(answer.usage));
            }
        }
        match fault {
            // An answer after a failed step is an answer.
            Some(fault) if answer.text.trim().is_empty() => {
                Err(fault.failure(&self.config.model, None).with_usage(answer.usage))
            }
            _ => done(request, &self.config.model, answer),
        }
    }

    fn models_call(&self) -> Result<Call, Error> {
        let url = self.config.url(BASE_URL, "v1beta", "models")?;
        Call::new(url, None).key("x-goog-api-key", "", self.config.key.as_ref())
    }
}

/// Writes one message as a plain text, and a conversation as its turns.
fn input(request: &Request) -> Value {
    match request.messages.as_slice() {
        [only] => json!(only.text),
        turns => {
            let role = |r: Role| if r == Role::User { "user" } else { "model" };
            turns.iter().map(|m| json!({"role": role(m.role), "content": m.text})).collect()
        }
    }
}

/// Reads the steps; unknown ones are skipped. Returns the first error of a step beside the answer.
fn read(response: &Value) -> (Answer, Option<Fault>) {
    let mut answer = Answer {
        usage: usage(response.get("usage")),
        model: text(response, "model").to_owned(),
        finish: Finish::Stop,
        ..Answer::default()
    };
    let mut fault = None;
    for step in list(response, "steps") {
        if let Some(error) = step.get("error").filter(|e| e.is_object()) {
            fault = fault.or_else(|| Some(Fault::of_error(error)));
        }
        match text(step, "type") {
            "google_search_call" => {
                let queries = step.pointer("/arguments/queries").and_then(Value::as_array).into_iter().flatten();
                answer.queries.extend(queries.filter_map(Value::as_str).map(str::to_owned));
                answer.searched = true;
            }
            "model_output" => {
                for content in list(step, "content").filter(|c| text(c, "type") == "text") {
                    add(&mut answer, content);
                }
            }
            _ => {}
        }
    }
    answer.usage.searches = answer.usage.searches.max(answer.queries.len() as u64);
    (answer, fault)
}

/// Adds a text with its citations.
fn add(answer: &mut Answer, content: &Value) {
    let start = answer.text.len();
    answer.text.push_str(text(content, "text"));
    for note in list(content, "annotations").filter(|a| text(a, "type") == "url_citation") {
        if text(note, "url").is_empty() {
            continue;
        }
        let index = answer.cite(text(note, "url"), text(note, "title"));
        let at = |name: &str| start.saturating_add(usize::try_from(count(note.get(name))).unwrap_or(usize::MAX));
        if let Some(segment) = Segment::of(&answer.text, at("start_index"), at("end_index")) {
            answer.support(index, segment);
        }
    }
}

fn usage(usage: Option<&Value>) -> Usage {
    let field = |name: &str| count(usage.and_then(|u| u.get(name)));
    let searches = usage.into_iter().flat_map(|u| list(u, "grounding_tool_count"));
    Usage {
        input: field("total_input_tokens").saturating_add(field("total_tool_use_tokens")),
        output: field("total_output_tokens"),
        thoughts: field("total_thought_tokens"),
        searches: searches.filter(|c| text(c, "type") == "google_search").map(|c| count(c.get("count"))).sum(),
        estimated: false,
    }
}
