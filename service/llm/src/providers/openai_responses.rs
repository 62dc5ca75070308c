//! OpenAI Responses: prose with web search, or JSON. `store` is always false. Positions are characters, not bytes.

use serde_json::{Map, Value, json};

use crate::answer::{Answer, Finish, Segment, Usage};
use crate::classify::Fault;
use crate::error::Error;
use crate::providers::gemini::broken_off;
use crate::providers::http::{Http, Wire, blocked, count, done, list, refused, text, truncated};
use crate::providers::openai::{named, turns};
use crate::providers::{Config, Entry, Failure, Fix, Turn, Tweaks};
use crate::request::{Grounding, Request};
use crate::stream::Documents;
use crate::transport::Call;

const BASE_URL: &str = "https://api.openai.com/v1";

pub(super) const ENTRY: Entry = Entry {
    name: "openai_responses",
    about: "OpenAI Responses; searches with web_search",
    base_url: BASE_URL,
    key_variable: Some("OPENAI_API_KEY"),
    searches: true,
    build: |config| Http::build("openai_responses", BASE_URL, config, |config| Responses { config }),
};

struct Responses {
    config: Config,
}

impl Wire for Responses {
    fn encode(&self, request: &Request, tweaks: &Tweaks) -> Result<Call, Error> {
        let mut body = Map::new();
        body.insert("model".into(), json!(self.config.model));
        if let Some(system) = &request.system {
            body.insert("instructions".into(), json!(system));
        }
        body.insert("input".into(), turns(request).collect());
        if let Some(grounding) = &request.grounding {
            body.insert("tools".into(), json!([tool(grounding)]));
            body.insert("include".into(), json!(["web_search_call.action.sources"]));
        } else if let Some(schema) = &request.schema {
            let mut format = named(schema);
            format["type"] = json!("json_schema");
            body.insert("text".into(), json!({"format": format}));
        }
        body.insert("max_output_tokens".into(), json!(request.max_output_tokens));
        if let Some(t) = self.config.temperature.filter(|_| !tweaks.fixes.contains(&Fix::WithoutTemperature)) {
            body.insert("temperature".into(), json!(t));
        }
        if let Some(effort) = self.config.thinking.as_ref().filter(|_| !tweaks.fixes.contains(&Fix::WithoutThinking)) {
            body.insert("reasoning".into(), json!({"effort": effort}));
        }
        body.insert("store".into(), json!(false));
        let url = self.config.url(BASE_URL, "", "responses")?;
        Call::new(url, Some(Value::Object(body))).key("authorization", "Bearer ", self.config.key.as_ref())
    }

    fn decode(&self, request: &Request, _tweaks: &Tweaks, documents: Documents) -> Result<Turn, Failure> {
        let Some(response) = documents.items.first().filter(|_| !documents.streamed) else {
            return Err(broken_off(Usage::default()));
        };
        let (answer, refusal) = read(response);
        if !refusal.is_empty() {
            return Err(refused(&refusal, answer.usage));
        }
        match text(response, "status") {
            // Compatible servers may leave it out.
            "completed" | "" => done(request, &self.config.model, answer),
            "incomplete" => match response.pointer("/incomplete_details/reason").and_then(Value::as_str) {
                Some("content_filter") => Err(blocked("content_filter", answer.usage)),
                _ => Err(truncated(request, answer)),
            },
            status => {
                let fault = Fault {
                    message: format!("the response ended with status `{status}`"),
                    codes: vec!["unavailable".to_owned()],
                    ..Fault::default()
                };
                Err(fault.failure(&self.config.model, None).with_usage(answer.usage))
            }
        }
    }

    fn models_call(&self) -> Result<Call, Error> {
        let url = self.config.url(BASE_URL, "", "models")?;
        Call::new(url, None).key("authorization", "Bearer ", self.config.key.as_ref())
    }
}

fn tool(grounding: &Grounding) -> Value {
    let mut tool = json!({"type": "web_search", "search_context_size": "medium"});
    if !grounding.allowed_domains.is_empty() {
        tool["filters"] = json!({"allowed_domains": grounding.allowed_domains});
    }
    if let Some(country) = &grounding.country {
        tool["user_location"] = json!({"type": "approximate", "country": country});
    }
    tool
}

/// Reads the output; unknown items are skipped. Returns what was refused beside the answer.
fn read(response: &Value) -> (Answer, String) {
    let mut answer = Answer {
        usage: usage(response.get("usage")),
        model: text(response, "model").to_owned(),
        finish: Finish::Stop,
        ..Answer::default()
    };
    let mut refusal = String::new();
    for item in list(response, "output") {
        match text(item, "type") {
            "web_search_call" => add_search(&mut answer, item),
            "message" => {
                for content in list(item, "content") {
                    refusal.push_str(text(content, "refusal"));
                    if text(content, "type") == "output_text" {
                        add_text(&mut answer, content);
                    }
                }
            }
            _ => {}
        }
    }
    (answer, refusal)
}

/// Notes a search; opening a page found by it is none.
fn add_search(answer: &mut Answer, item: &Value) {
    let action = item.get("action").unwrap_or(&Value::Null);
    answer.searched = true;
    if text(item, "status") == "failed" {
        answer.search_error = Some("a web search failed".to_owned());
    }
    if !matches!(text(action, "type"), "search" | "") {
        return;
    }
    answer.usage.searches += 1;
    let several = list(action, "queries").filter_map(Value::as_str);
    let query = text(action, "query");
    let query = (!query.is_empty()).then_some(query);
    for query in several.chain(query) {
        if !answer.queries.iter().any(|q| q == query) {
            answer.queries.push(query.to_owned());
        }
    }
}

/// Adds a text with its citations.
fn add_text(answer: &mut Answer, content: &Value) {
    let start = answer.text.len();
    let said = text(content, "text");
    answer.text.push_str(said);
    let byte = |characters: u64| {
        let characters = usize::try_from(characters).ok()?;
        // One past the last character is a position too.
        said.char_indices().map(|(i, _)| i).chain([said.len()]).nth(characters).map(|i| start + i)
    };
    for note in list(content, "annotations").filter(|a| text(a, "type") == "url_citation") {
        if text(note, "url").is_empty() {
            continue;
        }
        let index = answer.cite(text(note, "url"), text(note, "title"));
        let range = byte(count(note.get("start_index"))).zip(byte(count(note.get("end_index"))));
        if let Some(segment) = range.and_then(|(start, end)| Segment::of(&answer.text, start, end)) {
            answer.support(index, segment);
        }
    }
}

fn usage(usage: Option<&Value>) -> Usage {
    let field = |path: &str| count(usage.and_then(|u| u.pointer(path)));
    let thoughts = field("/output_tokens_details/reasoning_tokens");
    Usage {
        input: field("/input_tokens"),
        output: field("/output_tokens").saturating_sub(thoughts),
        thoughts,
        ..Usage::default()
    }
}
