//! A provider on loopback: it knows from a request which stage asks, and answers in the provider's own form.

use std::collections::BTreeMap;
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::{Arc, Mutex};

use serde_json::{Value, json};

/// What is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    Infer,
    Search,
    Structure,
}

/// An answer other than a good one.
#[derive(Debug, Clone, Copy)]
pub enum Reply {
    /// The limit of tokens was hit.
    Truncated,
    /// The model declines.
    Refused,
    /// No JSON at all.
    Garbage,
    /// Too many requests, come again at once.
    Busy,
    /// The quota of the day is used up.
    Quota,
    /// Never.
    Hang,
}

type Choice = dyn Fn(Kind, &str) -> Option<Reply> + Send + Sync;

/// The server; it ends with the test program.
pub struct Server {
    port: u16,
    seen: Arc<Mutex<BTreeMap<Kind, usize>>>,
}

const FIRST: &str = "Bedrooms for one person shall offer at least 9 m² of floor area.";
const SECOND: &str = "Two wheelchairs pass each other in a corridor of 1.85 m.";

impl Server {
    pub fn start(provider: &'static str, choose: impl Fn(Kind, &str) -> Option<Reply> + Send + Sync + 'static) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = listener.local_addr().unwrap().port();
        let seen = Arc::new(Mutex::new(BTreeMap::new()));
        let (count, choose): (_, Arc<Choice>) = (Arc::clone(&seen), Arc::new(choose));
        std::thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                let (count, choose) = (Arc::clone(&count), Arc::clone(&choose));
                std::thread::spawn(move || serve(stream, provider, &count, choose.as_ref()));
            }
        });
        Self { port, seen }
    }

    pub fn url(&self) -> String {
        format!("http://127.0.0.1:{}", self.port)
    }

    pub fn count(&self, kind: Kind) -> usize {
        self.seen.lock().unwrap().get(&kind).copied().unwrap_or_default()
    }

    pub fn total(&self) -> usize {
        self.seen.lock().unwrap().values().sum()
    }
}

fn serve(mut stream: TcpStream, provider: &str, seen: &Mutex<BTreeMap<Kind, usize>>, choose: &Choice) {
    let Some(body) = request(&mut stream) else { return };
    let kind = if body.contains("<passage number") {
        Kind::Structure
    } else if body.contains("<user_request>") {
        Kind::Infer
    } else {
        Kind::Search
    };
    *seen.lock().unwrap().entry(kind).or_default() += 1;
    let (status, answer) = match choose(kind, &body) {
        Some(Reply::Hang) => {
            std::thread::sleep(std::time::Duration::from_secs(20));
            return;
        }
        Some(reply) => trouble(provider, reply),
        None => (200, good(provider, kind, &body).to_string()),
    };
    let head = format!(
        "HTTP/1.1 {status} X\r\ncontent-type: application/json\r\ncontent-length: {}\r\nconnection: close\r\n\r\n",
        answer.len()
    );
    let _ = stream.write_all(head.as_bytes()).and_then(|()| stream.write_all(answer.as_bytes()));
}

fn request(stream: &mut TcpStream) -> Option<String> {
    let mut bytes = Vec::new();
    let mut buffer = [0; 8192];
    loop {
        let read = stream.read(&mut buffer).ok().filter(|n| *n > 0)?;
        bytes.extend_from_slice(&buffer[..read]);
        let Some(at) = bytes.windows(4).position(|w| w == b"\r\n\r\n") else { continue };
        let head = String::from_utf8_lossy(&bytes[..at]).to_lowercase();
        let length = head.lines().find_map(|l| l.strip_prefix("content-length:")?.trim().parse::<usize>().ok())?;
        if bytes.len() >= at + 4 + length {
            return Some(String::from_utf8_lossy(&bytes[at + 4..]).into_owned());
        }
    }
}

/// What the model says: the kind of building, prose with two supported sentences, or claims of which some are made up.
fn said(kind: Kind, body: &str) -> String {
    match kind {
        Kind::Infer => json!({"domain": "residential", "country": "Germany", "country_code": "DE"}).to_string(),
        Kind::Search => format!("{FIRST}\n{SECOND}\nCorridors are 99 m wide, some say."),
        Kind::Structure => {
            let claim = |passage: usize, name: &str, value: f64, unit: &str, space: &str| {
                json!({"passage": passage, "name": name, "constraint_type": "minimum", "value": value, "min": null,
                    "max": null, "expression": null, "unit": unit, "per": null, "space": space, "conditions": [],
                    "quote": ""})
            };
            let claims: Vec<Value> = (1..=body.matches("<passage number").count())
                .flat_map(|i| {
                    [
                        claim(i, "floor_area", 9.0, "m²", "bedroom"),
                        claim(i, "clear_width", 1.85, "m", "corridor"),
                        claim(i, "clear_width", 99.0, "m", "corridor"),
                    ]
                })
                .collect();
            json!({"constraints": claims}).to_string()
        }
    }
}

fn good(provider: &str, kind: Kind, body: &str) -> Value {
    let text = said(kind, body);
    let grounded = kind == Kind::Search;
    let (a, b) = ("https://standards.test/bedrooms?utm_source=openai", "https://access.test/corridors");
    let second = FIRST.len() + 1;
    match provider {
        "gemini" => {
            let mut candidate =
                json!({"content": {"role": "model", "parts": [{"text": text}]}, "finishReason": "STOP"});
            if grounded {
                let support = |start: usize, end: usize, chunk: usize| json!({"segment": {"startIndex": start, "endIndex": end}, "groundingChunkIndices": [chunk]});
                candidate["groundingMetadata"] = json!({
                    "webSearchQueries": ["q"],
                    "groundingChunks": [{"web": {"uri": a, "title": "standards.test"}}, {"web": {"uri": b, "title": "access.test"}}],
                    "groundingSupports": [support(0, FIRST.len(), 0), support(second, second + SECOND.len(), 1)],
                });
            }
            json!({"candidates": [candidate], "usageMetadata": {"promptTokenCount": 100, "candidatesTokenCount": 50}})
        }
        "gemini_interactions" => {
            let note = |url: &str, start: usize, end: usize| json!({"type": "url_citation", "url": url, "title": "t", "start_index": start, "end_index": end});
            let notes = if grounded {
                vec![note(a, 0, FIRST.len()), note(b, second, second + SECOND.len())]
            } else {
                Vec::new()
            };
            let mut steps = vec![
                json!({"type": "model_output", "content": [{"type": "text", "text": text, "annotations": notes}]}),
            ];
            if grounded {
                steps.insert(0, json!({"type": "google_search_call", "arguments": {"queries": ["q"]}}));
            }
            json!({"id": "1", "status": "completed", "steps": steps, "usage": {"total_input_tokens": 100, "total_output_tokens": 50}})
        }
        "openai_responses" => {
            let count = |s: &str| s.chars().count();
            let note = |url: &str, start: usize, end: usize| json!({"type": "url_citation", "url": url, "title": "t", "start_index": start, "end_index": end});
            let first = count(FIRST);
            let notes = if grounded {
                vec![note(a, 0, first), note(b, first + 1, first + 1 + count(SECOND))]
            } else {
                Vec::new()
            };
            let mut output = vec![json!({"type": "message", "role": "assistant", "status": "completed",
                "content": [{"type": "output_text", "text": text, "annotations": notes}]})];
            if grounded {
                output.insert(0, json!({"type": "web_search_call", "status": "completed", "action": {"type": "search", "query": "q"}}));
            }
            json!({"id": "r", "status": "completed", "output": output, "usage": {"input_tokens": 100, "output_tokens": 50}})
        }
        "anthropic" => {
            let cite = |text: &str, url: &str| json!({"type": "text", "text": text, "citations": [{"type": "web_search_result_location", "url": url, "title": "t", "cited_text": text}]});
            let content = if grounded {
                vec![
                    json!({"type": "server_tool_use", "id": "s", "name": "web_search", "input": {"query": "q"}}),
                    cite(FIRST, a),
                    cite(SECOND, b),
                ]
            } else {
                vec![json!({"type": "text", "text": text})]
            };
            json!({"type": "message", "role": "assistant", "content": content, "stop_reason": "end_turn",
                "usage": {"input_tokens": 100, "output_tokens": 50}})
        }
        "ollama" => json!({"model": "m", "message": {"role": "assistant", "content": text}, "done": true,
            "done_reason": "stop", "prompt_eval_count": 900, "eval_count": 50}),
        _ => {
            json!({"choices": [{"index": 0, "message": {"role": "assistant", "content": text}, "finish_reason": "stop"}],
            "usage": {"prompt_tokens": 100, "completion_tokens": 50}})
        }
    }
}

fn trouble(provider: &str, reply: Reply) -> (u16, String) {
    let gemini = provider.starts_with("gemini");
    let answer = match reply {
        Reply::Garbage => return (200, "<html>not what you expect</html>".to_owned()),
        Reply::Busy if gemini => json!({"error": {"code": 429, "status": "RESOURCE_EXHAUSTED", "message": "slow down",
            "details": [{"@type": "type.googleapis.com/google.rpc.RetryInfo", "retryDelay": "0.2s"}]}}),
        Reply::Quota if gemini => json!({"error": {"code": 429, "status": "RESOURCE_EXHAUSTED", "message": "used up",
            "details": [{"@type": "type.googleapis.com/google.rpc.QuotaFailure",
                "violations": [{"quotaId": "GenerateRequestsPerDayPerProject"}]}]}}),
        Reply::Busy | Reply::Quota | Reply::Hang => {
            json!({"error": {"message": "used up", "code": "insufficient_quota"}})
        }
        Reply::Truncated if gemini => {
            return (
                200,
                json!({"candidates": [{"content": {"parts": [{"text": "Bedrooms for"}]},
            "finishReason": "MAX_TOKENS"}]})
                .to_string(),
            );
        }
        Reply::Refused if gemini => return (200, json!({"promptFeedback": {"blockReason": "SAFETY"}}).to_string()),
        Reply::Truncated => {
            return (
                200,
                json!({"id": "r", "status": "incomplete",
            "incomplete_details": {"reason": "max_output_tokens"}, "output": []})
                .to_string(),
            );
        }
        Reply::Refused => {
            return (
                200,
                json!({"id": "r", "status": "completed", "output": [{"type": "message",
            "content": [{"type": "refusal", "refusal": "I cannot help with that"}]}]})
                .to_string(),
            );
        }
    };
    (429, answer.to_string())
}
