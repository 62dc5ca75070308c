//! Noise: answers of all providers, cut and changed at random places, end in an answer or an error, never in a panic.

use std::path::Path;

use d3dgen_llm::{Budget, Config, Grounding, Request, RetryPolicy, json_candidates};
use serde_json::Value;

use crate::cases::{client, flat_schema};
use crate::server::{Reply, Server};

/// Replies for each provider and kind of request.
const ROUNDS: usize = 60;

/// A small generator of its own, so that a failure can be told by its number.
struct Noise(u64);

impl Noise {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % n.max(1)
    }

    /// Cuts, drops, doubles or replaces bytes.
    fn bytes(&mut self, mut bytes: Vec<u8>) -> Vec<u8> {
        for _ in 0..=self.below(4) {
            let at = self.below(bytes.len() + 1);
            match self.below(5) {
                0 => bytes.truncate(at),
                1 => drop(bytes.drain(at..(at + self.below(9)).min(bytes.len()))),
                2 => bytes.insert(at, self.below(256) as u8),
                3 => bytes.insert(at, b"{}[]\",:0"[self.below(8)]),
                _ => {
                    let piece: Vec<u8> = bytes[at..(at + self.below(40)).min(bytes.len())].to_vec();
                    bytes.splice(at..at, piece);
                }
            }
        }
        bytes
    }

    /// Replaces values by others of the wrong type, and drops fields.
    fn value(&mut self, value: &mut Value) {
        if self.below(12) == 0 {
            let others = [
                Value::Null,
                Value::from(-1),
                Value::from(u64::MAX),
                Value::from(1e300),
                Value::from("m²"),
                Value::from(true),
                serde_json::json!([]),
                serde_json::json!({}),
                serde_json::json!([null, {"text": 7}]),
            ];
            *value = others[self.below(others.len())].clone();
            return;
        }
        match value {
            Value::Array(items) => items.iter_mut().for_each(|v| self.value(v)),
            Value::Object(fields) => {
                fields.retain(|_, _| self.below(25) != 0);
                fields.values_mut().for_each(|v| self.value(v));
            }
            _ => {}
        }
    }
}

/// Returns the project's own fixtures of a provider.
fn replies(provider: &str) -> Vec<Reply> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/fixtures/{provider}.json"));
    let cases: Value = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
    let responses = cases.as_array().unwrap().iter().map(|c| c["response"].clone());
    let single = responses.flat_map(|r| r.as_array().cloned().unwrap_or_else(|| vec![r]));
    single.map(|r| Reply::of_fixture(&r)).collect()
}

fn noisy(provider: &str, noise: &mut Noise) -> Vec<Reply> {
    let originals = replies(provider);
    let mutate = |_| {
        let mut reply = originals[noise.below(originals.len())].clone();
        match serde_json::from_slice::<Value>(&reply.body) {
            Ok(mut body) if noise.below(2) == 0 => {
                noise.value(&mut body);
                reply.body = body.to_string().into_bytes();
            }
            _ => reply.body = noise.bytes(reply.body),
        }
        if noise.below(6) == 0 {
            reply.status = [200, 200, 400, 404, 429, 500, 418, 206][noise.below(8)];
        }
        reply
    };
    (0..ROUNDS).map(mutate).collect()
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn noise_never_panics() {
    let mut noise = Noise(42);
    for entry in d3dgen_llm::providers::all() {
        let server = Server::start(noisy(entry.name, &mut noise)).await;
        let budget = Budget::unlimited();
        let (client, _) = client(Config::new(entry.name, "m"), &server, RetryPolicy::default(), budget);
        let mut outcomes = std::collections::BTreeSet::new();
        while server.seen().len() < ROUNDS {
            let mut request = Request::new("noise", "hello");
            match noise.below(3) {
                0 => request.schema = Some(flat_schema()),
                1 if entry.searches => request.grounding = Some(Grounding::default()),
                _ => {}
            }
            let answer = client.complete(&request).await;
            for note in answer.iter().flat_map(d3dgen_llm::Answer::notes) {
                let at = (note.segment.start, note.segment.end);
                if let (Some(start), Some(end)) = at {
                    assert_eq!(answer.as_ref().unwrap().text.get(start..end), Some(note.segment.text.as_str()));
                }
            }
            outcomes.insert(answer.map_or_else(|e| e.category(), |_| "ok"));
        }
        assert!(outcomes.len() >= 3, "{}: {outcomes:?} is too little variety to show anything", entry.name);
    }
}

#[test]
fn noise_in_json_texts_never_panics() {
    let texts = [
        "Sure:\n```json\n{\"a\": [1, /* x */ 2,], // y\n\"b\": \"ä\\\"{\"}\n```",
        "<think>{}</think>{\"a\": {\"b\": null}}",
    ];
    let mut noise = Noise(7);
    let mut found = 0;
    for round in 0..20_000 {
        let bytes = noise.bytes(texts[round % 2].as_bytes().to_vec());
        found += json_candidates(&String::from_utf8_lossy(&bytes)).len();
    }
    assert!(found > 1000, "most of the noise leaves something to be found, not {found}");
}
