//! What is recorded of a provider is what a replay says, without a network.

use std::sync::{Arc, Mutex};

use d3dgen_llm::providers::{Recorder, Replay, build};
use d3dgen_llm::{Budget, Client, Config, Grounding, Request, RetryPolicy, Secret};
use serde_json::json;

use crate::cases::{KEY, flat_schema};
use crate::server::{Reply, Server};

fn policy() -> RetryPolicy {
    RetryPolicy { base_delay: std::time::Duration::ZERO, ..RetryPolicy::default() }
}

fn replay(recording: &str) -> Client {
    Client::new(Box::new(Replay::new(recording).unwrap()), policy(), Budget::unlimited())
}

#[tokio::test]
async fn a_replay_says_what_was_recorded() {
    let text =
        |text: &str| json!({"content": [{"type": "text", "text": text}], "stop_reason": "end_turn", "model": "c-1"});
    let source = json!([{"url": "https://a.test/", "title": "A", "cited_text": "quote"}]);
    let server = Server::start(vec![
        Reply::new(529, "{}"),
        Reply::json(200, &text("no JSON")),
        Reply::json(200, &text(r#"{"kind": "home", "area_m2": 1}"#)),
        Reply::json(
            200,
            &json!({"content": [{"type": "server_tool_use", "name": "web_search"}], "stop_reason": "pause_turn"}),
        ),
        Reply::json(
            200,
            &json!({"content": [{"type": "text", "text": "prose", "citations": source}], "stop_reason": "end_turn"}),
        ),
        Reply::json(401, &json!({"error": {"type": "authentication_error", "message": "no"}})),
    ])
    .await;
    let mut config = Config::new("anthropic", "c");
    (config.base_url, config.key) = (Some(server.url.clone()), Some(Secret::new(KEY)));
    let recording = Arc::new(Mutex::new(String::new()));
    let sink = Arc::clone(&recording);
    let write = move |line: &str| *sink.lock().unwrap() += &format!("{line}\n");
    let recorder = Recorder::new(build(config).unwrap(), write);
    let live = Client::new(Box::new(recorder), policy(), Budget::unlimited());

    let requests = [
        Request::new("infer", "which?").with_schema(flat_schema()),
        Request::new("notes", "what?").with_grounding(Grounding::default()),
        Request::new("more", "and?"),
    ];
    let mut said = Vec::new();
    for request in &requests {
        said.push(live.complete(request).await);
    }
    assert!(said[0].is_ok() && said[1].as_ref().unwrap().grounded && said[2].is_err(), "{said:?}");

    let recording = recording.lock().unwrap().clone();
    assert!(!recording.contains(KEY) && recording.lines().count() == 5, "the 529 passes by itself: {recording}");
    let offline = replay(&recording);
    // In another order, and again: a replay goes by what is asked.
    for (i, again) in [(2, false), (1, false), (0, false), (0, true)] {
        let answer = offline.complete(&requests[i]).await;
        match (&answer, &said[i]) {
            (Ok(a), Ok(b)) => assert_eq!((&a.text, &a.json, &a.citations), (&b.text, &b.json, &b.citations), "{again}"),
            (Err(a), Err(b)) => assert_eq!(a, b),
            _ => panic!("{answer:?} is not {:?}", said[i]),
        }
    }
    let error = offline.complete(&Request::new("infer", "something else")).await.unwrap_err();
    assert_eq!(error.category(), "not_recorded");
}

#[tokio::test]
async fn a_recording_written_by_hand_goes_by_stage() {
    let client = replay(
        r#"
{"stage": "notes", "answer": {"text": "first", "model": "by-hand"}}
{"stage": "infer", "answer": {"text": "{\"kind\": \"work\", \"area_m2\": null}"}}
{"stage": "notes", "failure": {"error": "blocked", "reason": "recitation"}}
"#,
    );
    assert_eq!(client.provider().model(), "by-hand");
    let infer = client.complete(&Request::new("infer", "x").with_schema(flat_schema())).await.unwrap();
    assert_eq!(infer.json, Some(json!({"kind": "work", "area_m2": null})));
    assert_eq!(client.complete(&Request::new("notes", "x")).await.unwrap().text, "first");
    assert_eq!(client.complete(&Request::new("notes", "x")).await.unwrap_err().category(), "blocked");
    assert_eq!(client.complete(&Request::new("notes", "x")).await.unwrap_err().category(), "not_recorded");
    assert_eq!(client.budget().table().len(), 2);
}

#[test]
fn a_broken_recording_is_refused_with_its_line() {
    for (recording, says) in [
        ("{\"stage\": \"x\", \"answer\": {}}\nnonsense", "line 2"),
        ("\n{\"stage\": \"x\"}", "line 2 of the recording needs"),
        ("{\"stage\": \"x\", \"answr\": {}}", "answr"),
    ] {
        let error = Replay::new(recording).err().unwrap().to_string();
        assert!(error.contains(says), "{error}");
    }
}
