//! Gemini, `generateContent`: grounded prose or JSON, never both in one call (older models refuse it, newer ones drop
//! the search without a word). Positions of segments are UTF-8 bytes.

use serde_json::{Map, Value, json};

use crate::answer::{Answer, Finish, Segment, Usage};
use crate::classify::Fault;
use crate::error::Error;
use crate::providers::http::{Http, Wire, blocked, count, done, list, text, truncated};
use crate::providers::{Config, Entry, Failure, Fix, Turn, Tweaks};
use crate::request::{Request, Role};
use crate::stream::Documents;
use crate::transport::Call;

const BASE_URL: &str = "https://generativelanguage.googleapis.com";

/// Reasons to end that mean a filter stepped in; `SAFETY` and `PROHIBITED` also in longer names.
const BLOCKED: &[&str] = &["SAFETY", "RECITATION", "BLOCKLIST", "PROHIBITED", "SPII", "LANGUAGE"];

pub(super) const ENTRY: Entry = Entry {
    name: "gemini",
    about: "Google Gemini, generateContent; searches with google_search",
    base_url: BASE_URL,
    key_variable: Some("GEMINI_API_KEY"),
    searches: true,
    build: |config| Http::build("gemini", BASE_URL, config, |config| Gemini { config }),
};

struct Gemini {
    config: Config,
}

impl Wire for Gemini {
    fn encode(&self, request: &Request, tweaks: &Tweaks) -> Result<Call, Error> {
        let model = self.config.model_in_path()?;
        let tail = match self.config.stream {
            true => format!("models/{model}:streamGenerateContent?alt=sse"),
            false => format!("models/{model}:generateContent"),
        };
        let turn = |m: &crate::request::Message| {
            let role = if m.role == Role::User { "user" } else { "model" };
            json!({"role": role, "parts": [{"text": m.text}]})
        };
        let mut body = Map::new();
        if let Some(system) = &request.system {
            body.insert("systemInstruction".into(), json!({"parts": [{"text": system}]}));
        }
        body.insert("contents".into(), request.messages.iter().map(turn).collect());
        let mut generation = Map::new();
        generation.insert("maxOutputTokens".into(), json!(request.max_output_tokens));
        if let Some(level) = self.config.thinking.as_ref().filter(|_| !tweaks.fixes.contains(&Fix::WithoutThinking)) {
            generation.insert("thinkingConfig".into(), json!({"thinkingLevel": level}));
        }
        if let Some(t) = self.config.temperature.filter(|_| !tweaks.fixes.contains(&Fix::WithoutTemperature)) {
            generation.insert("temperature".into(), json!(t));
        }
        if request.grounding.is_some() {
            body.insert("tools".into(), json!([{"google_search": {}}]));
        } else if let Some(schema) = &request.schema {
            generation.insert("responseMimeType".into(), json!("application/json"));
            generation.insert("responseJsonSchema".into(), schema.wire().clone());
        }
        body.insert("generationConfig".into(), Value::Object(generation));
        let url = self.config.url(BASE_URL, "v1beta", &tail)?;
        Call::new(url, Some(Value::Object(body))).key("x-goog-api-key", "", self.config.key.as_ref())
    }

    fn decode(&self, request: &Request, _tweaks: &Tweaks, documents: Documents) -> Result<Turn, Failure> {
        let response = Merged::of(&documents);
        let usage = usage(response.usage);
        if let Some(reason) = response.block_reason {
            return Err(blocked(reason, usage));
        }
        let mut answer = Answer { text: response.text(), usage, model: response.model.to_owned(), ..Answer::default() };
        if let Some(grounding) = response.grounding {
            ground(&mut answer, grounding, &response.starts());
            answer.usage.searches = answer.queries.len() as u64;
        }
        answer.finish = match response.finish {
            Some("STOP") => Finish::Stop,
            Some("MAX_TOKENS") => return Err(truncated(request, answer)),
            Some(reason) if BLOCKED.iter().any(|b| reason.contains(b)) => return Err(blocked(reason, answer.usage)),
            Some(reason) => Finish::Other(reason.to_owned()),
            None if documents.streamed => return Err(broken_off(answer.usage)),
            None => Finish::Unknown,
        };
        done(request, &self.config.model, answer)
    }

    fn amend(&self, request: &Request, fault: &Fault, failure: &mut Failure) {
        if let Error::RateLimited { hint, .. } = &mut failure.error
            && request.grounding.is_some()
            && !fault.details.iter().any(|d| d.get("retryDelay").is_some() || d.get("violations").is_some())
        {
            *hint = Some("no limit is named, so the key may have no search quota; try without grounding".to_owned());
        }
    }

    fn models_call(&self) -> Result<Call, Error> {
        let url = self.config.url(BASE_URL, "v1beta", "models")?;
        Call::new(url, None).key("x-goog-api-key", "", self.config.key.as_ref())
    }
}

/// The failure of a stream without its end.
pub(super) fn broken_off(usage: Usage) -> Failure {
    let message = "the stream ended before the answer did".to_owned();
    Failure::from(Error::Unavailable { status: Some(200), retry_after_ms: None, message }).with_usage(usage)
}

/// One response, put together from the pieces of a stream.
#[derive(Default)]
struct Merged<'a> {
    parts: Vec<&'a Value>,
    finish: Option<&'a str>,
    grounding: Option<&'a Value>,
    usage: Option<&'a Value>,
    block_reason: Option<&'a str>,
    model: &'a str,
}

impl<'a> Merged<'a> {
    fn of(documents: &'a Documents) -> Self {
        let mut merged = Self::default();
        for piece in &documents.items {
            let candidate = piece.pointer("/candidates/0");
            let text_at = |path: &str| piece.pointer(path).and_then(Value::as_str).filter(|t| !t.is_empty());
            merged.parts.extend(candidate.and_then(|c| c.pointer("/content/parts")?.as_array()).into_iter().flatten());
            merged.finish = text_at("/candidates/0/finishReason").or(merged.finish);
            merged.grounding = candidate.and_then(|c| c.get("groundingMetadata")).or(merged.grounding);
            merged.usage = piece.get("usageMetadata").or(merged.usage);
            merged.block_reason = text_at("/promptFeedback/blockReason").or(merged.block_reason);
            merged.model = text_at("/modelVersion").unwrap_or(merged.model);
        }
        merged
    }

    /// Returns what each part adds to the text: nothing for thoughts.
    fn pieces(&self) -> impl Iterator<Item = &'a str> {
        self.parts.iter().map(|p| if p.get("thought") == Some(&Value::Bool(true)) { "" } else { text(p, "text") })
    }

    fn text(&self) -> String {
        self.pieces().collect()
    }

    /// Returns where each part starts in the text, in bytes.
    fn starts(&self) -> Vec<usize> {
        let mut end = 0;
        let mut start = |piece: &str| {
            let start = end;
            end += piece.len();
            start
        };
        self.pieces().map(&mut start).collect()
    }
}

fn usage(metadata: Option<&Value>) -> Usage {
    let field = |name: &str| count(metadata.and_then(|m| m.get(name)));
    Usage {
        input: field("promptTokenCount").saturating_add(field("toolUsePromptTokenCount")),
        output: field("candidatesTokenCount"),
        thoughts: field("thoughtsTokenCount"),
        ..Usage::default()
    }
}

/// Adds sources and the passages that rest on them. Indices and positions are the provider's, so none is trusted.
fn ground(answer: &mut Answer, metadata: &Value, part_starts: &[usize]) {
    answer.queries = list(metadata, "webSearchQueries").filter_map(Value::as_str).map(str::to_owned).collect();
    answer.searched = !answer.queries.is_empty() || list(metadata, "groundingChunks").next().is_some();
    let entry = metadata.pointer("/searchEntryPoint/renderedContent").and_then(Value::as_str);
    answer.search_entry_point = entry.map(str::to_owned);
    let mut indices = Vec::new();
    for chunk in list(metadata, "groundingChunks") {
        let source = chunk.get("web").or_else(|| chunk.get("retrievedContext")).unwrap_or(&Value::Null);
        // A chunk without an address keeps its place: supports count all of them.
        let uri = text(source, "uri").to_owned();
        indices.push((!uri.is_empty()).then(|| answer.cite(&uri, text(source, "title"))));
    }
    for support in list(metadata, "groundingSupports") {
        let Some(segment) = segment(&answer.text, support.get("segment"), part_starts) else { continue };
        for index in list(support, "groundingChunkIndices").filter_map(Value::as_u64) {
            if let Some(Some(index)) = usize::try_from(index).ok().and_then(|i| indices.get(i)) {
                answer.support(*index, segment.clone());
            }
        }
    }
}

/// Returns the passage of a support: where it says, counted in its part or in the whole text, or where its words are.
fn segment(answer: &str, segment: Option<&Value>, part_starts: &[usize]) -> Option<Segment> {
    let segment = segment?;
    let words = text(segment, "text");
    let position = |name: &str| usize::try_from(count(segment.get(name))).unwrap_or(usize::MAX);
    let (start, end) = (position("startIndex"), position("endIndex"));
    let part_start = part_starts.get(position("partIndex")).copied().unwrap_or_default();
    let places = [part_start, 0].map(|base| Segment::of(answer, start.saturating_add(base), end.saturating_add(base)));
    let mut places = places.into_iter().flatten();
    if words.is_empty() {
        return places.next();
    }
    let found = places.find(|p| p.text == words);
    let elsewhere = || answer.find(words).and_then(|at| Segment::of(answer, at, at + words.len()));
    found.or_else(elsewhere).or_else(|| Some(Segment { start: None, end: None, text: words.to_owned() }))
}
