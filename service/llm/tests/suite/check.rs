//! Holds an outcome against the `expect` of its fixture. A key that is not known here fails, so that none is skipped.

use serde_json::{Value, json};

use crate::cases::{Case, KEY, Outcome};
use crate::server::Seen;

/// # Panics
/// With the name of the fixture, where it is not as expected.
pub fn check(case: &Case, outcome: &Outcome) {
    let name = &case.name;
    for seen in &outcome.seen {
        check_request(case, seen);
    }
    // Later requests differ from the first on purpose.
    if let Some(first) = outcome.seen.first() {
        check_agrees(name, "", &case.fixture["request"]["body"], &first.body);
    }
    if let Err(error) = &outcome.answer {
        let said = format!("{error} {error:?}");
        assert!(!said.contains(KEY) && !said.contains("***"), "{name}: a key shows in {said}");
    }
    let expect = case.fixture["expect"].as_object().unwrap_or_else(|| panic!("{name} has no expect"));
    for (key, expected) in expect {
        let found = found(case, outcome, key, expected);
        assert_eq!(&found, expected, "{name}: {key}, of {:?}", outcome.answer);
    }
    if expect.is_empty() {
        check_sane(case, outcome);
    }
}

/// Returns what was found for a key of `expect`, in the form the fixture has it.
fn found(case: &Case, outcome: &Outcome, key: &str, expected: &Value) -> Value {
    let answer = outcome.answer.as_ref().ok();
    let error = outcome.answer.as_ref().err();
    match key {
        "json" | "json_after_repair" => {
            assert_eq!(outcome.seen.len(), 1, "{}: JSON has to be found in the first answer", case.name);
            json!(answer.and_then(|a| a.json.clone()))
        }
        "text" => json!(answer.map(|a| a.text.clone())),
        "grounded" => json!(answer.map(|a| a.grounded)),
        "searched" => json!(answer.map(|a| a.searched)),
        "n_notes" => json!(answer.map(|a| a.notes().len())),
        "n_citations" => json!(answer.map(|a| a.citations.len())),
        "segments" => json!(answer.map(segments)),
        "error" => json!(error.map(|e| e.category())),
        "hint" => has(error.is_some_and(|e| e.to_string().contains(expected.as_str().unwrap())), expected),
        "redacted" => {
            json!(!echoed(case).is_empty() && echoed(case).iter().all(|w| !error.unwrap().to_string().contains(w)))
        }
        "keep_partial" => json!(kept_partial(case, outcome)),
        "continue" => json!(outcome.answer.is_ok() && went_on(case, outcome)),
        "retry_after_ms" => {
            let ms = error.and_then(|e| e.retry_after_ms());
            let waited = outcome.waits.iter().all(|w| Some(w.as_millis() as u64) == ms);
            json!(ms.filter(|ms| waited && (outcome.waits.len() == 3) == (*ms <= 60_000)))
        }
        "retry_after_is_http_date" => json!(error.and_then(|e| e.retry_after_ms()).is_some()),
        "quotes" => json!(answer.map(|a| a.citations.iter().flat_map(|c| c.quotes.clone()).collect::<Vec<_>>())),
        "uris" => json!(answer.map(|a| a.citations.iter().map(|c| c.uri.clone()).collect::<Vec<_>>())),
        "queries" => json!(answer.map(|a| a.queries.clone())),
        "search_error" => json!(answer.map(|a| a.search_error.clone())),
        "finish" => json!(answer.map(|a| a.finish.clone())),
        "model" => json!(answer.map(|a| a.model.clone())),
        "models" => json!(outcome.models.as_ref().and_then(|m| m.as_ref().ok())),
        "usage" => json!(answer.map(|a| [a.usage.input, a.usage.output, a.usage.thoughts, a.usage.searches])),
        "says" => has(error.is_some_and(|e| e.to_string().contains(expected.as_str().unwrap())), expected),
        "partial" => json!(error.map(|e| match e {
            d3dgen_llm::Error::Truncated { partial, .. } => partial.as_ref().map(|a| a.text.clone()),
            _ => None,
        })),
        "retry" => has(retried(case, outcome, expected), expected),
        other => panic!("{}: expect has a key `{other}` that is not known here", case.name),
    }
}

fn has(yes: bool, expected: &Value) -> Value {
    if yes { expected.clone() } else { json!("not so") }
}

fn segments(answer: &d3dgen_llm::Answer) -> Value {
    let segment = |n: &d3dgen_llm::Note<'_>| {
        let (start, end) = (n.segment.start.unwrap(), n.segment.end.unwrap());
        assert_eq!(&answer.text[start..end], n.segment.text);
        let mut segment = json!({"endIndex": end, "text": n.segment.text});
        if start > 0 {
            segment["startIndex"] = json!(start);
        }
        segment
    };
    answer.notes().iter().map(segment).collect()
}

/// Returns the masked pieces of a key that the provider echoes.
fn echoed(case: &Case) -> Vec<String> {
    let body = case.fixture["response"]["body"].to_string();
    let words = body.split(|c: char| c.is_whitespace() || c == '"').filter(|w| w.contains("***"));
    let pieces = words.flat_map(|w| w.split('*')).map(|p| p.trim_matches('.').to_owned());
    pieces.filter(|p| p.len() >= 4).collect()
}

fn kept_partial(case: &Case, outcome: &Outcome) -> bool {
    let said = case.fixture.pointer("/response/body/candidates/0/content/parts/0/text").and_then(Value::as_str);
    format!("{:?}", outcome.answer).contains(said.expect("the fixture says something before it ends"))
}

/// Returns whether the second request sent back what the first answer said.
fn went_on(case: &Case, outcome: &Outcome) -> bool {
    let [_, second, ..] = outcome.seen.as_slice() else { return false };
    let last = second.body["messages"].as_array().and_then(|m| m.last());
    last.is_some_and(|m| m["role"] == "assistant" && m["content"] == case.fixture["response"]["body"]["content"])
}

fn retried(case: &Case, outcome: &Outcome, expected: &Value) -> bool {
    let bodies: Vec<&Value> = outcome.seen.iter().map(|s| &s.body).collect();
    match (expected, bodies.as_slice()) {
        (Value::Bool(true), seen) => seen.len() == 4 && outcome.waits.len() == 3,
        (Value::Bool(false), seen) => seen.len() == 1,
        (Value::String(how), [first, second]) if how.contains("doubled") => {
            (limit(first), limit(second)) == (case.request.max_output_tokens, 2 * case.request.max_output_tokens)
        }
        (Value::String(how), [first, second]) => {
            let (with, field) = how.split_once(' ').unwrap();
            let (before, after) = (first.to_string().contains(field), second.to_string().contains(field));
            (before, after) == (with == "without", with == "with")
        }
        // What to do with a prompt that is too long is up to the caller, who is told so.
        (Value::String(how), [_]) => outcome.answer.as_ref().unwrap_err().to_string().contains(how),
        _ => false,
    }
}

fn limit(body: &Value) -> u32 {
    let places = [
        "/generationConfig/maxOutputTokens",
        "/generation_config/max_output_tokens",
        "/max_tokens",
        "/max_completion_tokens",
        "/max_output_tokens",
        "/options/num_predict",
    ];
    places.iter().find_map(|p| body.pointer(p)?.as_u64()).unwrap() as u32
}

/// Checks what is sent, whatever comes back.
fn check_request(case: &Case, seen: &Seen) {
    let name = &case.name;
    let asked = &case.fixture["request"];
    let head = seen.head.to_lowercase();
    assert!(!seen.path.contains("key"), "{name}: {}", seen.path);
    assert!(head.contains(&KEY.to_lowercase()), "{name}: the key belongs into a header");
    let key_headers = ["x-goog-api-key", "x-api-key", "authorization", "anthropic-version"];
    for header in asked["headers"].as_object().into_iter().flatten().map(|h| h.0) {
        assert!(
            !key_headers.contains(&header.as_str()) || head.contains(&format!("\r\n{header}: ")),
            "{name}: {header}"
        );
    }
    let known = [
        "generateContent",
        "streamGenerateContent?alt=sse",
        "interactions",
        "completions",
        "responses",
        "messages",
        "chat",
        "models",
    ];
    let path = asked["path"].as_str().unwrap_or_default();
    if known.iter().any(|k| path.ends_with(k)) {
        assert_eq!(seen.path, path, "{name}");
    }
}

/// Checks that what the fixture shows of the request is sent alike; what it leaves out is free.
fn check_agrees(name: &str, place: &str, shown: &Value, sent: &Value) {
    match (shown, sent) {
        (Value::Object(shown), Value::Object(sent)) => {
            // Only described for the model, or not sent in this form on purpose.
            let free = ["description", "keep_alive", "responseSchema", "responseMimeType", "stream", "stream_options"];
            for (key, value) in shown.iter().filter(|(k, _)| !free.contains(&k.as_str())) {
                match sent.get(key) {
                    Some(found) => check_agrees(name, &format!("{place}/{key}"), value, found),
                    // A schema that is not in the common form is not sent.
                    None => {
                        let second_name = key == "max_completion_tokens" && shown.contains_key("max_tokens");
                        let left_out = second_name || key == "response_format" || key == "schema";
                        assert!(left_out, "{name}: {place}/{key} is not sent");
                    }
                }
            }
        }
        (Value::Array(shown), Value::Array(sent)) if !shown.is_empty() => {
            assert_eq!(shown.len(), sent.len(), "{name}: {place}");
            for (i, (shown, sent)) in shown.iter().zip(sent).enumerate() {
                check_agrees(name, &format!("{place}/{i}"), shown, sent);
            }
        }
        (Value::Number(shown), Value::Number(sent)) => assert_eq!(shown.as_f64(), sent.as_f64(), "{name}: {place}"),
        // A single message may be written as a text, and a fixture may only hint at what is sent.
        (Value::String(_), Value::Array(_) | Value::Object(_))
        | (Value::Null, _)
        | (Value::Array(_), Value::Array(_)) => {}
        _ => assert_eq!(shown, sent, "{name}: {place}"),
    }
}

/// Checks a recorded exchange without expectation: it is an answer, or an error that the status and the body call for.
fn check_sane(case: &Case, outcome: &Outcome) {
    let name = &case.name;
    let response = &case.fixture["response"];
    if let Some(models) = &outcome.models {
        let listed = response["body"].get("data").is_some();
        assert_eq!(models.as_ref().is_ok_and(|m| !m.is_empty()), listed, "{name}: {models:?}");
        return;
    }
    let category = outcome.answer.as_ref().err().map(|e| e.category());
    let body =
        response.get("body_text").map_or_else(|| response["body"].to_string(), |t| t.as_str().unwrap().to_owned());
    let expected = match response["status"].as_u64() {
        Some(200) if body.contains("\"length\"") || body.contains("\"max_tokens\"") => Some("truncated"),
        Some(200) => None,
        Some(400) if body.contains("exceed") => Some("too_long"),
        Some(400 | 404) => Some("bad_request"),
        other => panic!("{name}: status {other:?} needs an expectation"),
    };
    assert_eq!(category, expected, "{name}: {:?}", outcome.answer);
    if let Ok(answer) = &outcome.answer {
        assert!(!answer.text.is_empty() && answer.usage.tokens() > 0, "{name}");
        assert_eq!(answer.json.is_some(), case.request.schema.is_some(), "{name}");
    }
}
