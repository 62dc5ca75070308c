//! What a client does not put up with: silence, endless bodies, broken connections, redirects, noise in headers.

use std::io::Write;
use std::time::Duration;

use d3dgen_llm::{Budget, Config, Error, Request, RetryPolicy, Secret, providers};

use crate::cases::{KEY, client};
use crate::server::{Reply, Server};

/// Returns a reply that every provider would take for an answer.
fn long_reply(bytes: usize) -> Reply {
    let text = "a".repeat(bytes);
    let body = serde_json::json!({
        "candidates": [{"content": {"parts": [{"text": text}]}, "finishReason": "STOP"}],
        "status": "completed",
        "steps": [{"type": "model_output", "content": [{"type": "text", "text": text}]}],
        "choices": [{"message": {"content": text}, "finish_reason": "stop"}],
        "output": [{"type": "message", "content": [{"type": "output_text", "text": text}]}],
        "content": [{"type": "text", "text": text}],
        "stop_reason": "end_turn",
        "message": {"content": text},
        "done": true,
        "done_reason": "stop",
    });
    Reply::json(200, &body)
}

/// Asks once under limits and returns what came of it, with the number of requests.
async fn ask(provider: &str, reply: Reply, limit_bytes: u64, timeout: Duration) -> (Result<String, Error>, usize) {
    let server = Server::start(vec![reply]).await;
    let mut config = Config::new(provider, "some-model");
    config.response_limit_bytes = limit_bytes;
    let policy = RetryPolicy { max_tries: 2, ..RetryPolicy::default() };
    let (client, _) = client(config, &server, policy, Budget::unlimited());
    let mut request = Request::new("limits", "hello");
    request.timeout = timeout;
    let answer = client.complete(&request).await;
    (answer.map(|a| a.text), server.seen().len())
}

fn names() -> impl Iterator<Item = &'static str> {
    providers::all().iter().map(|e| e.name)
}

#[tokio::test]
async fn a_large_body_is_read_up_to_the_limit() {
    let minute = Duration::from_secs(60);
    for name in names() {
        let (answer, _) = ask(name, long_reply(50_000), 8 << 20, minute).await;
        assert_eq!(answer.map(|t| t.len()), Ok(50_000), "{name}");
        let (answer, requests) = ask(name, long_reply(50_000), 100_000, minute).await;
        assert_eq!((answer, requests), (Err(Error::TooLarge { limit_bytes: 100_000 }), 1), "{name}");
    }
}

#[tokio::test]
async fn an_unpacked_body_counts() {
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    packed.write_all(&long_reply(200_000).body).unwrap();
    let packed = packed.finish().unwrap();
    assert!(packed.len() < 2000);
    let reply = Reply::new(200, packed).header("content-encoding", "gzip").header("content-type", "application/json");
    let (answer, _) = ask("openai", reply.clone(), 8 << 20, Duration::from_secs(60)).await;
    assert_eq!(answer.map(|t| t.len()), Ok(200_000));
    let (answer, _) = ask("openai", reply, 10_000, Duration::from_secs(60)).await;
    assert_eq!(answer, Err(Error::TooLarge { limit_bytes: 10_000 }));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn silence_and_stalls_end_in_time() {
    let check = async |name: &str| {
        let mut silent = long_reply(10);
        silent.silent = Duration::from_secs(600);
        let (answer, requests) = ask(name, silent, 8 << 20, Duration::from_millis(150)).await;
        let timeout = |before_first_byte| Err(Error::Timeout { after_ms: 150, before_first_byte });
        assert_eq!((answer, requests), (timeout(true), 2), "{name}: nothing was said, so it is tried again");

        // Long enough that a slow machine gets to the first byte.
        let mut stalling = long_reply(1000);
        stalling.stall = Duration::from_secs(600);
        let (answer, requests) = ask(name, stalling, 8 << 20, Duration::from_secs(4)).await;
        let Err(Error::Timeout { before_first_byte: false, .. }) = answer else { panic!("{name}: {answer:?}") };
        assert_eq!(requests, 1, "{name}: tokens were used, so it is not tried again");
    };
    let tasks: Vec<_> = names().map(|name| tokio::spawn(check(name))).collect();
    for task in tasks {
        task.await.unwrap();
    }
}

#[tokio::test]
async fn a_broken_connection_is_tried_again() {
    for name in names() {
        let mut broken = long_reply(1000);
        broken.broken_off = true;
        let (answer, requests) = ask(name, broken, 8 << 20, Duration::from_secs(60)).await;
        assert!(matches!(answer, Err(Error::Unavailable { .. })), "{name}: {answer:?}");
        assert_eq!(requests, 2, "{name}");
    }
}

#[tokio::test]
async fn nobody_listening_is_unavailable() {
    let server = Server::start(vec![Reply::new(200, "")]).await;
    let url = server.url.clone();
    drop(server);
    for name in names() {
        let mut config = Config::new(name, "some-model");
        config.base_url = Some(url.clone());
        let policy = RetryPolicy { max_tries: 1, ..RetryPolicy::default() };
        let client = d3dgen_llm::Client::new(providers::build(config).unwrap(), policy, Budget::unlimited());
        let error = client.complete(&Request::new("x", "hello")).await.unwrap_err();
        let Error::Unavailable { status: None, message, .. } = error else { panic!("{name}: {error:?}") };
        assert!(message.starts_with("cannot connect"), "{name}: {message}");
    }
}

#[tokio::test]
async fn redirects_are_not_followed() {
    let elsewhere = Server::start(vec![long_reply(5)]).await;
    for status in [301, 302, 303, 307, 308] {
        let reply = Reply::new(status, "").header("location", &elsewhere.url);
        let (answer, requests) = ask("openai", reply, 8 << 20, Duration::from_secs(60)).await;
        assert!(matches!(answer, Err(Error::BadRequest { .. })), "{status}: {answer:?}");
        assert_eq!(requests, 1);
    }
    assert!(elsewhere.seen().is_empty());
}

#[tokio::test]
async fn a_key_is_in_a_header_and_nowhere_else() {
    for entry in providers::all() {
        let server = Server::start(vec![long_reply(5)]).await;
        let (client, _) = client(Config::new(entry.name, "m"), &server, RetryPolicy::default(), Budget::unlimited());
        client.complete(&Request::new("x", "hello")).await.unwrap();
        let seen = server.seen();
        let lines: Vec<&str> = seen[0].head.lines().filter(|l| l.contains(KEY)).collect();
        assert_eq!((seen[0].method.as_str(), lines.len()), ("POST", 1), "{}", entry.name);
        assert!(!seen[0].path.contains(KEY) && !seen[0].body.to_string().contains(KEY), "{}", entry.name);
    }
    let mut config = Config::new("openai", "m");
    (config.base_url, config.key) = (Some("http://127.0.0.1:1".to_owned()), Some(Secret::new("two\nlines")));
    let error = providers::build(config).err().unwrap();
    assert!(error.to_string().contains("line breaks") && !error.to_string().contains("two"), "{error}");
}

#[tokio::test]
async fn a_model_name_cannot_change_the_path() {
    for name in ["../../secret", "m?key=1", "m#x", "m x", "", "m%2e"] {
        assert!(providers::build(Config::new("gemini", name)).is_err(), "{name}");
    }
}

#[tokio::test]
async fn what_a_provider_cannot_do_is_said() {
    for (provider, says) in [("openai", "openai_responses"), ("ollama", "name documents")] {
        let (answer, requests) = {
            let server = Server::start(vec![long_reply(5)]).await;
            let policy = RetryPolicy::default();
            let (client, _) = client(Config::new(provider, "m"), &server, policy, Budget::unlimited());
            let request = Request::new("x", "hello").with_grounding(d3dgen_llm::Grounding::default());
            (client.complete(&request).await, server.seen().len())
        };
        assert!(answer.unwrap_err().to_string().contains(says), "{provider}");
        assert_eq!(requests, 0);
    }
    let long = Request::new("x", "word ".repeat(100_000));
    let mut config = Config::new("ollama", "m");
    config.context_tokens = Some(4096);
    let server = Server::start(vec![long_reply(5)]).await;
    let (client, _) = client(config, &server, RetryPolicy::default(), Budget::unlimited());
    assert_eq!(client.complete(&long).await.unwrap_err().category(), "too_long");
    assert!(server.seen().is_empty(), "a prompt that the server would cut is not sent");
}
