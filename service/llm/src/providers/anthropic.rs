//! Anthropic Messages: prose with web search, or JSON by output format, for older models by a tool that has to be called.
//! Citations hang on blocks of text and quote their source.

use serde_json::{Map, Value, json};

use crate::answer::{Answer, Finish, Segment, Usage};
use crate::error::Error;
use crate::providers::gemini::broken_off;
use crate::providers::http::{Http, Wire, count, done, list, refused, text, truncated};
use crate::providers::openai::turns;
use crate::providers::{Config, Entry, Failure, Fix, Structured, Turn, Tweaks};
use crate::request::{Grounding, Request};
use crate::stream::Documents;
use crate::transport::Call;

const BASE_URL: &str = "https://api.anthropic.com";

pub(super) const ENTRY: Entry = Entry {
    name: "anthropic",
    about: "Anthropic Messages; searches with web_search",
    base_url: BASE_URL,
    key_variable: Some("ANTHROPIC_API_KEY"),
    searches: true,
    build: |config| {
        if config.thinking.is_some() {
            return Err(Error::config("provider anthropic takes no level of thinking here; leave `thinking` out"));
        }
        Http::build("anthropic", BASE_URL, config, |config| Messages { config })
    },
};

struct Messages {
    config: Config,
}

impl Wire for Messages {
    fn encode(&self, request: &Request, tweaks: &Tweaks) -> Result<Call, Error> {
        let mut body = Map::new();
        body.insert("model".into(), json!(self.config.model));
        body.insert("max_tokens".into(), json!(request.max_output_tokens));
        if let Some(system) = &request.system {
            body.insert("system".into(), json!(system));
        }
        let paused = (!tweaks.resume.is_empty()).then(|| json!({"role": "assistant", "content": tweaks.resume}));
        body.insert("messages".into(), turns(request).chain(paused).collect());
        if let Some(t) = self.config.temperature.filter(|_| !tweaks.fixes.contains(&Fix::WithoutTemperature)) {
            body.insert("temperature".into(), json!(t));
        }
        let by_tool = self.config.structured == Structured::Tool || tweaks.fixes.contains(&Fix::ForcedTool);
        if let Some(grounding) = &request.grounding {
            body.insert("tools".into(), json!([self.search_tool(grounding)]));
        } else if let Some(schema) = &request.schema {
            if by_tool {
                let about = "Returns the result";
                let tool = json!({"name": schema.name(), "description": about, "input_schema": schema.wire()});
                body.insert("tools".into(), json!([tool]));
                body.insert("tool_choice".into(), json!({"type": "tool", "name": schema.name()}));
            } else {
                let format = json!({"type": "json_schema", "schema": schema.wire()});
                body.insert("output_config".into(), json!({"format": format}));
            }
        }
        let url = self.config.url(BASE_URL, "v1", "messages")?;
        Call::new(url, Some(Value::Object(body))).header("anthropic-version", "2023-06-01").key(
            "x-api-key",
            "",
            self.config.key.as_ref(),
        )
    }

    fn decode(&self, request: &Request, tweaks: &Tweaks, documents: Documents) -> Result<Turn, Failure> {
        let Some(response) = documents.items.first().filter(|_| !documents.streamed) else {
            return Err(broken_off(Usage::default()));
        };
        let blocks: Vec<Value> = tweaks.resume.iter().chain(list(response, "content")).cloned().collect();
        let usage = usage(response.get("usage"));
        let stop = response.get("stop_reason").and_then(Value::as_str);
        if stop == Some("pause_turn") {
            return Ok(Turn::Paused { resume: blocks, usage });
        }
        let tool = request.schema.as_ref().map_or("", |s| s.name());
        let mut answer = read(&blocks, tool);
        answer.usage = usage;
        answer.model = text(response, "model").to_owned();
        answer.finish = match stop {
            Some("end_turn" | "stop_sequence" | "tool_use") => Finish::Stop,
            Some("max_tokens" | "model_context_window_exceeded") => return Err(truncated(request, answer)),
            Some("refusal") => return Err(refused(&answer.text, usage)),
            Some(other) => Finish::Other(other.to_owned()),
            None => Finish::Unknown,
        };
        done(request, &self.config.model, answer)
    }

    fn models_call(&self) -> Result<Call, Error> {
        let url = self.config.url(BASE_URL, "v1", "models")?;
        let call = Call::new(url, None).header("anthropic-version", "2023-06-01");
        call.key("x-api-key", "", self.config.key.as_ref())
    }
}

impl Messages {
    fn search_tool(&self, grounding: &Grounding) -> Value {
        let mut tool =
            json!({"type": self.config.web_search_tool, "name": "web_search", "max_uses": grounding.max_searches});
        if !grounding.allowed_domains.is_empty() {
            tool["allowed_domains"] = json!(grounding.allowed_domains);
        }
        if let Some(country) = &grounding.country {
            tool["user_location"] = json!({"type": "approximate", "country": country});
        }
        tool
    }
}

/// Reads the blocks; unknown ones are skipped.
fn read(blocks: &[Value], tool: &str) -> Answer {
    let mut answer = Answer::default();
    let mut apart = false;
    for block in blocks {
        match text(block, "type") {
            "text" => {
                // Text before and after a search are two paragraphs; blocks that follow each other are one.
                if std::mem::take(&mut apart) && !answer.text.is_empty() && !answer.text.ends_with('\n') {
                    answer.text.push('\n');
                }
                add(&mut answer, block);
            }
            "tool_use" if text(block, "name") == tool => answer.json = block.get("input").cloned(),
            "server_tool_use" if text(block, "name") == "web_search" => {
                apart = true;
                answer.searched = true;
                let query = block.pointer("/input/query").and_then(Value::as_str);
                answer.queries.extend(query.map(str::to_owned));
            }
            "web_search_tool_result" => {
                apart = true;
                // A list of results, or an object that says what went wrong.
                let code = block.pointer("/content/error_code").and_then(Value::as_str);
                answer.search_error = code.map(crate::classify::shortened).or(answer.search_error);
            }
            _ => apart = true,
        }
    }
    answer
}

/// Adds a text with its citations.
fn add(answer: &mut Answer, block: &Value) {
    let start = answer.text.len();
    answer.text.push_str(text(block, "text"));
    let segment = Segment::of(&answer.text, start, answer.text.len());
    for citation in list(block, "citations").filter(|c| !text(c, "url").is_empty()) {
        let index = answer.cite(text(citation, "url"), text(citation, "title"));
        if let Some(segment) = &segment {
            answer.support(index, segment.clone());
        }
        let quote = text(citation, "cited_text");
        if let Some(source) = answer.citations.get_mut(index).filter(|s| !s.quotes.iter().any(|q| q == quote)) {
            source.quotes.extend((!quote.is_empty()).then(|| quote.to_owned()));
        }
    }
}

fn usage(usage: Option<&Value>) -> Usage {
    let field = |path: &str| count(usage.and_then(|u| u.pointer(path)));
    let cached = field("/cache_creation_input_tokens").saturating_add(field("/cache_read_input_tokens"));
    Usage {
        input: field("/input_tokens").saturating_add(cached),
        output: field("/output_tokens"),
        searches: field("/server_tool_use/web_search_requests"),
        ..Usage::default()
    }
}
