//! The web page at the server's port: what it may load, how long it is kept, and who is answered.

use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;

use crate::support::Server;

/// Returns the whole answer to a plain GET, its body as far as it is text.
pub async fn get(server: &Server, path: &str, more: &str) -> String {
    let host = if more.contains("host:") { "" } else { "host: localhost\r\n" };
    let asked = format!("GET {path} HTTP/1.1\r\n{host}{more}connection: close\r\n\r\n");
    let mut stream = TcpStream::connect(server.address).await.expect("a connection");
    stream.write_all(asked.as_bytes()).await.expect("sent");
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).await.expect("read");
    String::from_utf8_lossy(&answer).into_owned()
}

/// Returns the value of a header.
fn header<'a>(answer: &'a str, name: &str) -> Option<&'a str> {
    let head = answer.split("\r\n\r\n").next()?;
    head.lines().find_map(|line| line.split_once(": ").filter(|(n, _)| n.eq_ignore_ascii_case(name)).map(|(_, v)| v))
}

#[tokio::test(flavor = "multi_thread")]
async fn the_page_is_served_with_a_strict_policy_and_asked_for_again_only_when_it_has_changed() {
    let server = Server::start(&[]).await;
    let index = get(&server, "/", "").await;
    assert!(index.starts_with("HTTP/1.1 200") && index.contains("<div id=\"app\">"), "{index}");
    let policy = header(&index, "content-security-policy").expect("a policy");
    assert!(policy.starts_with("default-src 'none'") && !policy.contains("unsafe"), "{policy}");
    assert_eq!(header(&index, "cache-control"), Some("no-cache"));
    assert_eq!(header(&index, "content-type"), Some("text/html; charset=utf-8"));
    let tag = header(&index, "etag").expect("an etag");
    let same = get(&server, "/", &format!("if-none-match: \"x\", {tag}\r\n")).await;
    assert!(same.starts_with("HTTP/1.1 304") && !same.contains("<div"), "{same}");
    let packed = get(&server, "/", "accept-encoding: br, gzip;q=0.9\r\n").await;
    assert_eq!(header(&packed, "content-encoding"), Some("gzip"));
    assert_ne!(header(&packed, "etag"), Some(tag), "each encoding has its own");

    let script = index.split("src=\"").nth(1).and_then(|rest| rest.split('"').next()).expect("a script");
    let asset = get(&server, script, "").await;
    assert!(asset.starts_with("HTTP/1.1 200"), "{script}");
    assert_eq!(header(&asset, "cache-control"), Some("public, max-age=31536000, immutable"));
    assert_eq!(header(&asset, "content-type"), Some("text/javascript; charset=utf-8"));
}

#[tokio::test(flavor = "multi_thread")]
async fn the_page_is_for_the_names_and_origins_of_the_server_only() {
    let server = Server::start(&[]).await;
    for more in ["host: evil.example\r\n", "origin: https://evil.example\r\n"] {
        let refused = get(&server, "/", more).await;
        assert!(refused.starts_with("HTTP/1.1 403"), "{more}: {refused}");
    }
    for path in ["/assets/nothing.js", "/assets/../Cargo.toml", "/web/dist/index.html"] {
        let nothing = get(&server, path, "").await;
        assert!(!nothing.starts_with("HTTP/1.1 200"), "{path}: {nothing}");
    }
}
