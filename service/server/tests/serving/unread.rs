//! Streams that their client does not read, and calls that are given up.

use std::time::Duration;

use d3dgen_proto::v1::generate_world_response::Event;
use d3dgen_proto::v1::world_service_client::WorldServiceClient;
use tokio::io::{AsyncReadExt, AsyncWriteExt};

use crate::support::{LARGE, PATIENCE, SMALL, Server, building, call_unread, framed, unread_connection};

const GENERATE: &str = "/d3dgen.v1.WorldService/GenerateWorld";

/// Makes a small world and waits for it.
async fn small_world(server: &Server) -> usize {
    let mut worlds = WorldServiceClient::new(server.channel().await).max_decoding_message_size(64 << 20);
    let mut stream = worlds.generate_world(building(SMALL, 1)).await.expect("a stream").into_inner();
    let mut news = 0;
    let mut last = None;
    while let Some(found) = stream.message().await.expect("news") {
        news += 1;
        last = found.event;
    }
    assert!(matches!(last, Some(Event::World(_))), "the last is the world");
    news
}

#[tokio::test(flavor = "multi_thread")]
async fn streams_that_nobody_reads_hold_no_thread_and_end_at_their_deadline() {
    let server = Server::start(&["limits.threads=1"]).await;
    let client = unread_connection(&server).await;
    let mut held = Vec::new();
    for n in 0..2 {
        let (answer, body) = call_unread(&client, GENERATE, "60S", framed(&building(SMALL, n))).await;
        held.push((tokio::time::timeout(PATIENCE, answer).await.expect("headers").expect("an answer"), body));
    }
    // the one thread is free again although nothing was read of either
    tokio::time::timeout(PATIENCE, small_world(&server)).await.expect("others are served");
    // what takes longer than its deadline ends at it, with the connection alive and the answer not taken
    let late = call_unread(&client, GENERATE, "1S", framed(&building(LARGE, 1))).await;
    let late = (tokio::time::timeout(PATIENCE, late.0).await.expect("headers").expect("an answer"), late.1);
    server.gauge("calls in flight", |core| &core.metrics.in_flight, 2, Duration::from_secs(5)).await;
    server.gauge("threads at work", |core| &core.metrics.threads_busy, 0, Duration::from_secs(10)).await;
    drop((late, held));
}

#[tokio::test(flavor = "multi_thread")]
async fn the_same_holds_over_grpc_web_on_http_1() {
    let server = Server::start(&["limits.threads=1"]).await;
    let mut held = Vec::new();
    for (n, (prompt, timeout)) in [(SMALL, "60S"), (SMALL, "60S"), (LARGE, "1S")].into_iter().enumerate() {
        let mut stream = tokio::net::TcpStream::connect(server.address).await.expect("a connection");
        let message = framed(&building(prompt, n as u64));
        let head = format!(
            "POST {GENERATE} HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/grpc-web+proto\r\n\
             x-grpc-web: 1\r\ngrpc-timeout: {timeout}\r\ncontent-length: {}\r\n\r\n",
            message.len()
        );
        stream.write_all(head.as_bytes()).await.expect("sent");
        stream.write_all(&message).await.expect("sent");
        held.push(stream);
    }
    tokio::time::timeout(PATIENCE, small_world(&server)).await.expect("others are served");
    server.gauge("threads at work", |core| &core.metrics.threads_busy, 0, PATIENCE).await;
    // a reader that comes late finds the end
    let mut first = held.remove(0);
    let mut text = Vec::new();
    let read = async {
        let mut piece = vec![0; 1 << 16];
        while !String::from_utf8_lossy(&text).contains("grpc-status:0") {
            let n = first.read(&mut piece).await.expect("an answer");
            assert!(n > 0, "it ended early");
            text.extend_from_slice(&piece[..n]);
        }
    };
    tokio::time::timeout(PATIENCE, read).await.expect("the whole answer");
}

#[tokio::test(flavor = "multi_thread")]
async fn calls_that_are_given_up_leave_the_queue_at_once() {
    let server = Server::start(&["limits.threads=1", "limits.calls_per_client=1000", "limits.calls=1000"]).await;
    let mut worlds = WorldServiceClient::new(server.channel().await).max_decoding_message_size(64 << 20);
    let mut long = worlds.generate_world(building(LARGE, 1)).await.expect("a stream").into_inner();
    long.message().await.expect("news").expect("it has begun");
    let mut given_up = Vec::new();
    for connection in 0..2 {
        let mut worlds = WorldServiceClient::new(server.channel().await);
        for n in 0..120 {
            given_up.push(worlds.generate_world(building(SMALL, connection * 1000 + n)).await.expect("a stream"));
        }
    }
    server.gauge("calls that wait", |core| &core.metrics.waiting, 240, Duration::from_secs(10)).await;
    drop(given_up);
    server.gauge("calls that wait", |core| &core.metrics.waiting, 0, Duration::from_secs(5)).await;
    assert!(long.message().await.expect("news").is_some(), "the one that is read goes on");
}
