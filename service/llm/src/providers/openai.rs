//! OpenAI chat completions and the servers that speak it: vLLM, llama.cpp, Ollama's `/v1`, and others.
//!
//! Compatible servers leave out fields and write errors their own way, so every field is optional here. It does not
//! search; `openai_responses.rs` does. Ollama's `/v1` cuts long prompts without a word: use `ollama.rs` for it.

use serde_json::{Map, Value, json};

use crate::answer::{Answer, Finish, Usage};
use crate::error::Error;
use crate::providers::gemini::broken_off;
use crate::providers::http::{Http, Wire, blocked, count, done, list, refused, text, truncated};
use crate::providers::{Config, Entry, Failure, Fix, Structured, TokenField, Turn, Tweaks};
use crate::request::{Request, Role};
use crate::schema::Schema;
use crate::stream::Documents;
use crate::transport::Call;

const BASE_URL: &str = "https://api.openai.com/v1";

pub(super) const ENTRY: Entry = Entry {
    name: "openai",
    about: "OpenAI chat completions and compatible servers (vLLM, llama.cpp, Ollama /v1); does not search",
    base_url: BASE_URL,
    key_variable: Some("OPENAI_API_KEY"),
    searches: false,
    build: |config| Http::build("openai", BASE_URL, config, |config| Chat { config }),
};

struct Chat {
    config: Config,
}

impl Chat {
    /// Returns the name of the field that limits tokens: OpenAI's own models refuse the old name, others only know it.
    fn token_field(&self, tweaks: &Tweaks) -> &'static str {
        let own = self.config.base_url.as_deref().unwrap_or(BASE_URL).contains("//api.openai.com");
        let wanted = match self.config.token_field {
            Some(field) => field == TokenField::MaxCompletionTokens,
            None => own,
        };
        let other = tweaks.fixes.contains(&Fix::OtherTokenField);
        if wanted != other { "max_completion_tokens" } else { "max_tokens" }
    }
}

impl Wire for Chat {
    fn encode(&self, request: &Request, tweaks: &Tweaks) -> Result<Call, Error> {
        if request.grounding.is_some() {
            return Err(Error::config("chat completions cannot search the web; use provider openai_responses"));
        }
        let in_prompt = self.config.structured == Structured::Prompt || tweaks.fixes.contains(&Fix::SchemaInPrompt);
        let mut system = request.system.clone().unwrap_or_default();
        let mut body = Map::new();
        body.insert("model".into(), json!(self.config.model));
        match &request.schema {
            Some(schema) if in_prompt => {
                system = format!("{system}\n\n{}{}", include_str!("../prompts/schema.txt"), schema.wire());
            }
            Some(schema) => {
                body.insert("response_format".into(), json!({"type": "json_schema", "json_schema": named(schema)}));
            }
            None => {}
        }
        let system = (!system.is_empty()).then(|| json!({"role": "system", "content": system.trim()}));
        body.insert("messages".into(), system.into_iter().chain(turns(request)).collect());
        body.insert(self.token_field(tweaks).into(), json!(request.max_output_tokens));
        if let Some(t) = self.config.temperature.filter(|_| !tweaks.fixes.contains(&Fix::WithoutTemperature)) {
            body.insert("temperature".into(), json!(t));
        }
        if let Some(seed) = self.config.seed {
            body.insert("seed".into(), json!(seed));
        }
        if let Some(effort) = self.config.thinking.as_ref().filter(|_| !tweaks.fixes.contains(&Fix::WithoutThinking)) {
            body.insert("reasoning_effort".into(), json!(effort));
        }
        let url = self.config.url(BASE_URL, "", "chat/completions")?;
        Call::new(url, Some(Value::Object(body))).key("authorization", "Bearer ", self.config.key.as_ref())
    }

    fn decode(&self, request: &Request, _tweaks: &Tweaks, documents: Documents) -> Result<Turn, Failure> {
        let mut answer = Answer::default();
        let (mut refusal, mut finish) = (String::new(), None);
        for piece in &documents.items {
            if let Some(usage) = piece.get("usage").filter(|u| u.is_object()) {
                answer.usage = self::usage(usage);
            }
            if !text(piece, "model").is_empty() {
                answer.model = text(piece, "model").to_owned();
            }
            let Some(choice) = piece.pointer("/choices/0") else { continue };
            let message = choice.get("message").or_else(|| choice.get("delta")).unwrap_or(&Value::Null);
            answer.text.push_str(&content(message));
            refusal.push_str(text(message, "refusal"));
            finish = choice.get("finish_reason").and_then(Value::as_str).or(finish);
        }
        if !refusal.is_empty() {
            return Err(refused(&refusal, answer.usage));
        }
        answer.finish = match finish {
            Some("stop" | "eos" | "end_turn") => Finish::Stop,
            Some("length" | "max_tokens") => return Err(truncated(request, answer)),
            Some("content_filter") => return Err(blocked("content_filter", answer.usage)),
            Some(other) => Finish::Other(other.to_owned()),
            None if documents.streamed => return Err(broken_off(answer.usage)),
            None => Finish::Unknown,
        };
        done(request, &self.config.model, answer)
    }

    fn models_call(&self) -> Result<Call, Error> {
        let url = self.config.url(BASE_URL, "", "models")?;
        Call::new(url, None).key("authorization", "Bearer ", self.config.key.as_ref())
    }
}

/// Returns the schema under its name, strict.
pub(super) fn named(schema: &Schema) -> Value {
    json!({"name": schema.name(), "strict": true, "schema": schema.wire()})
}

/// Returns the conversation.
pub(super) fn turns(request: &Request) -> impl Iterator<Item = Value> {
    let role = |r: Role| if r == Role::User { "user" } else { "assistant" };
    request.messages.iter().map(move |m| json!({"role": role(m.role), "content": m.text}))
}

/// Returns what is said; thoughts stand in a field of their own and are left out.
fn content(message: &Value) -> String {
    match message.get("content") {
        Some(Value::String(text)) => text.clone(),
        Some(Value::Array(_)) => list(message, "content").map(|p| text(p, "text")).collect(),
        _ => String::new(),
    }
}

/// Reads usage; thoughts are part of the completion and counted apart.
fn usage(usage: &Value) -> Usage {
    let thoughts = count(usage.pointer("/completion_tokens_details/reasoning_tokens"));
    Usage {
        input: count(usage.get("prompt_tokens")),
        output: count(usage.get("completion_tokens")).saturating_sub(thoughts),
        thoughts,
        ..Usage::default()
    }
}
