//! A loopback server that plays a script of replies and remembers what was asked. It knows no provider.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use serde_json::Value;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::task::JoinHandle;

/// One reply.
#[derive(Clone, Debug)]
pub struct Reply {
    pub status: u16,
    pub headers: Vec<(String, String)>,
    pub body: Vec<u8>,
    /// Waits before the first byte.
    pub silent: Duration,
    /// Sends the head and half of the body, then waits this long.
    pub stall: Duration,
    /// Closes the connection after half of the body.
    pub broken_off: bool,
}

impl Reply {
    pub fn new(status: u16, body: impl Into<Vec<u8>>) -> Self {
        let body = body.into();
        let (silent, stall) = (Duration::ZERO, Duration::ZERO);
        Self { status, headers: Vec::new(), body, silent, stall, broken_off: false }
    }

    pub fn json(status: u16, body: &Value) -> Self {
        Self::new(status, body.to_string()).header("content-type", "application/json")
    }

    pub fn header(mut self, name: &str, value: &str) -> Self {
        self.headers.push((name.to_owned(), value.to_owned()));
        self
    }

    /// Reads the `response` of a fixture.
    pub fn of_fixture(response: &Value) -> Self {
        let body = match response.get("body_text").and_then(Value::as_str) {
            Some(text) => text.to_owned(),
            None => response["body"].to_string(),
        };
        let mut reply = Self::new(response["status"].as_u64().unwrap() as u16, body);
        for (name, value) in response["headers"].as_object().into_iter().flatten() {
            match (name.as_str(), value.as_str().unwrap()) {
                ("x-fixture-repeat", times) => reply.body = reply.body.repeat(times.parse().unwrap()),
                (name, value) => reply = reply.header(name, value),
            }
        }
        reply
    }
}

/// One request that arrived.
#[derive(Clone, Debug)]
pub struct Seen {
    pub method: String,
    pub path: String,
    /// As it arrived, names in lower case.
    pub head: String,
    pub body: Value,
}

/// The server; it ends when dropped.
pub struct Server {
    pub url: String,
    seen: Arc<Mutex<Vec<Seen>>>,
    task: JoinHandle<()>,
}

impl Server {
    /// Plays the replies in order; the last one repeats.
    pub async fn start(replies: Vec<Reply>) -> Self {
        assert!(!replies.is_empty());
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let url = format!("http://{}", listener.local_addr().unwrap());
        let seen = Arc::new(Mutex::new(Vec::new()));
        let log = Arc::clone(&seen);
        let task = tokio::spawn(async move {
            while let Ok((stream, _)) = listener.accept().await {
                tokio::spawn(serve(stream, replies.clone(), Arc::clone(&log)));
            }
        });
        Self { url, seen, task }
    }

    pub fn seen(&self) -> Vec<Seen> {
        self.seen.lock().unwrap().clone()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.task.abort();
    }
}

async fn serve(mut stream: TcpStream, replies: Vec<Reply>, log: Arc<Mutex<Vec<Seen>>>) -> Option<()> {
    let mut data = Vec::new();
    let head_end = loop {
        if let Some(end) = data.windows(4).position(|w| w == b"\r\n\r\n") {
            break end + 4;
        }
        if stream.read_buf(&mut data).await.ok()? == 0 {
            return None;
        }
    };
    let head = String::from_utf8_lossy(&data[..head_end]).into_owned();
    let length = head.lines().find_map(|l| l.to_lowercase().strip_prefix("content-length:")?.trim().parse().ok());
    while data.len() < head_end + length.unwrap_or(0) {
        if stream.read_buf(&mut data).await.ok()? == 0 {
            return None;
        }
    }
    let mut first = head.split_whitespace();
    let seen = Seen {
        method: first.next()?.to_owned(),
        path: first.next()?.to_owned(),
        head: head.clone(),
        body: serde_json::from_slice(&data[head_end..]).unwrap_or(Value::Null),
    };
    let reply = {
        let mut log = log.lock().unwrap();
        log.push(seen);
        replies[(log.len() - 1).min(replies.len() - 1)].clone()
    };
    play(&mut stream, &reply).await
}

async fn play(stream: &mut TcpStream, reply: &Reply) -> Option<()> {
    tokio::time::sleep(reply.silent).await;
    let mut head =
        format!("HTTP/1.1 {} X\r\nconnection: close\r\ncontent-length: {}\r\n", reply.status, reply.body.len());
    if !reply.headers.iter().any(|(n, _)| n == "date") {
        // The day that fixtures are set in.
        head.push_str("date: Fri, 20 Nov 2026 10:00:00 GMT\r\n");
    }
    for (name, value) in &reply.headers {
        head.push_str(&format!("{name}: {value}\r\n"));
    }
    head.push_str("\r\n");
    stream.write_all(head.as_bytes()).await.ok()?;
    let half = reply.body.len() / 2;
    stream.write_all(&reply.body[..half]).await.ok()?;
    if reply.broken_off {
        return stream.shutdown().await.ok();
    }
    if !reply.stall.is_zero() {
        stream.flush().await.ok()?;
        tokio::time::sleep(reply.stall).await;
    }
    stream.write_all(&reply.body[half..]).await.ok()?;
    stream.shutdown().await.ok()
}
