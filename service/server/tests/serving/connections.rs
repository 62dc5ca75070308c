//! Connections that say nothing, names that are not the server's, pages of others.

use std::time::Duration;

use d3dgen_proto::v1::ListDomainsRequest;
use d3dgen_proto::v1::domain_service_client::DomainServiceClient;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;

use crate::support::{PATIENCE, Server};

/// Sends a request over HTTP/1.1 and returns the status of the answer.
async fn status(server: &Server, request: &str) -> u16 {
    answer(server, request).await.split(' ').nth(1).and_then(|s| s.parse().ok()).unwrap_or_default()
}

/// Sends a request over HTTP/1.1 and returns the answer.
async fn answer(server: &Server, request: &str) -> String {
    let asked = async {
        let mut stream = TcpStream::connect(server.address).await.expect("a connection");
        stream.write_all(request.as_bytes()).await.expect("sent");
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).await.expect("an answer");
        String::from_utf8_lossy(&bytes).into_owned()
    };
    tokio::time::timeout(Duration::from_secs(5), asked).await.expect("an answer in time")
}

#[tokio::test(flavor = "multi_thread")]
async fn silent_connections_shut_nobody_out() {
    let server = Server::start(&["limits.connections=64", "limits.connections_per_address=32"]).await;
    let mut silent = Vec::new();
    for _ in 0..80 {
        silent.push(TcpStream::connect(server.address).await.expect("a connection"));
    }
    let healthz = "GET /healthz HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n";
    assert_eq!(status(&server, healthz).await, 200);
    let mut domains = DomainServiceClient::new(server.channel().await);
    domains.list_domains(ListDomainsRequest::default()).await.expect("a list");

    // connections that have spoken keep their place; health is answered beside them all
    let mut spoken = Vec::new();
    for _ in 0..40 {
        let mut stream = TcpStream::connect(server.address).await.expect("a connection");
        stream.write_all(b"GET /healthz HTTP/1.1\r\nhost: localhost\r\n").await.expect("sent");
        spoken.push(stream);
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
    assert_eq!(status(&server, healthz).await, 200);
    let metrics = "GET /metrics HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n";
    assert_eq!(status(&server, metrics).await, 429);
    drop((silent, spoken));
    let begun = std::time::Instant::now();
    while status(&server, metrics).await != 200 {
        assert!(begun.elapsed() < PATIENCE, "places are given back");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_connection_that_says_nothing_is_closed() {
    let server = Server::start(&[]).await;
    let mut silent = TcpStream::connect(server.address).await.expect("a connection");
    silent.write_all(b"P").await.expect("sent");
    let read = tokio::time::timeout(Duration::from_secs(15), silent.read(&mut [0; 16])).await.expect("an end");
    assert!(matches!(read, Ok(0) | Err(_)), "{read:?}");
}

#[tokio::test(flavor = "multi_thread")]
async fn names_and_pages_of_others_are_refused() {
    let server = Server::start(&["cors_origins=[\"https://studio.example\"]", "hosts=[\"worlds.example\"]"]).await;
    let call = |host: &str, more: &str| {
        format!(
            "POST /d3dgen.v1.AssetService/RemoveAssets HTTP/1.1\r\nhost: {host}\r\n{more}\
             content-type: application/grpc-web+proto\r\ncontent-length: 5\r\nconnection: close\r\n\r\n\0\0\0\0\0"
        )
    };
    let own = format!("origin: http://{}\r\n", server.address);
    for (host, more, refused) in [
        ("localhost", "", false),
        (server.address.to_string().as_str(), own.as_str(), false),
        ("worlds.example", "", false),
        ("localhost", "origin: https://studio.example\r\n", false),
        ("evil.org", "", true),
        ("evil.org", "origin: http://evil.org\r\n", true), // by a name that was made to mean loopback
        ("localhost", "origin: https://evil.org\r\n", true),
        ("localhost", "origin: null\r\n", true),
    ] {
        let said = answer(&server, &call(host, more)).await;
        let is_refused = said.replace(' ', "").contains("grpc-status:7");
        assert_eq!(is_refused, refused, "{host} {more:?}: {said}");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn health_tells_of_each_part() {
    let mut server = Server::start(&[]).await;
    let get = |path: &str| format!("GET {path} HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n");
    let begun = std::time::Instant::now();
    while status(&server, &get("/readyz")).await != 200 {
        assert!(begun.elapsed() < PATIENCE, "ready once the indexes are there");
        tokio::time::sleep(Duration::from_millis(100)).await;
    }
    assert_eq!(status(&server, &get("/livez")).await, 200);
    let mut health = tonic_health::pb::health_client::HealthClient::new(server.channel().await);
    for name in ["", "store", "index", "lanes", "d3dgen.v1.WorldService"] {
        let asked = tonic_health::pb::HealthCheckRequest { service: name.into() };
        assert_eq!(health.check(asked).await.expect("health").into_inner().status, 1, "{name}");
    }
    // an open watch does not hold up a stop
    let asked = tonic_health::pb::HealthCheckRequest { service: String::new() };
    let mut watch = health.watch(asked).await.expect("a watch").into_inner();
    watch.message().await.expect("news");
    server.stop();
    tokio::time::timeout(Duration::from_secs(5), &mut server.ended).await.expect("it stops").expect("well");
}
