//! The same client against a server that is not ours: the fake of the shared reference material, where it is.

use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::time::Duration;

use d3dgen_llm::providers::{BoxFuture, build};
use d3dgen_llm::{Budget, Client, Config, Request, RetryPolicy, Schema, Secret};
use serde_json::json;

use crate::cases::KEY;

/// The process; it ends when dropped.
struct Fake(Child);

impl Drop for Fake {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn start(script: &str) -> Option<(Fake, String)> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/llm/tools/fake_llm.py");
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    if !file.is_file() {
        return None;
    }
    let mut command = Command::new("python3");
    command.arg(file).arg(port.to_string()).args(["--script", script]).stderr(Stdio::null());
    command.spawn().ok().map(|child| (Fake(child), format!("http://127.0.0.1:{port}")))
}

#[tokio::test]
async fn a_script_of_failures_ends_in_the_answer() {
    let Some((_fake, url)) = start("gemini/11_429_retryinfo,gemini/18_502_html,gemini/01_classify_ok") else {
        println!("skipped: there is no shared fake server, or no python3");
        return;
    };
    for _ in 0..600 {
        if tokio::net::TcpStream::connect(url.trim_start_matches("http://")).await.is_ok() {
            break;
        }
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
    let mut config = Config::new("gemini", "gemini-3.8-flash");
    (config.base_url, config.key) = (Some(url), Some(Secret::new(KEY)));
    let sleep = Arc::new(|_| -> BoxFuture<'static, ()> { Box::pin(async {}) });
    let client = Client::new(build(config).unwrap(), RetryPolicy::default(), Budget::unlimited()).with_sleep(sleep);
    let word = json!({"type": ["string", "null"]});
    let schema = json!({
        "type": "object",
        "properties": {"domain": word, "country": word, "country_code": word},
        "required": ["domain", "country", "country_code"],
        "additionalProperties": false,
    });
    let request = Request::new("infer", "a flat").with_schema(Schema::new("domain_country", schema).unwrap());
    let answer = client.complete(&request).await.unwrap();
    assert_eq!(answer.json.unwrap()["domain"], "residential");
    assert_eq!((answer.tries, answer.usage.input, answer.usage.thoughts), (3, 212, 61));
    let record = client.budget().records().pop().unwrap();
    assert!(record.waited_ms >= 33_117, "the wait that RetryInfo asks for counts: {record:?}");
}
