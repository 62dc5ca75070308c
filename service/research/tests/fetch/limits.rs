//! Servers that send too much, too slowly, or something else than they say.

use std::io::Write;
use std::time::{Duration, Instant};

use d3dgen_research::fetch::{Code, Options};

use crate::server::{Part, Server, code, fetcher, get, not_found, options, page, reply};

const HTML: (&str, &str) = ("Content-Type", "text/html");

fn endless(head: &str, part: &[u8], count: usize, pause: Duration) -> Vec<Part> {
    let mut parts = vec![(head.as_bytes().to_vec(), Duration::ZERO)];
    parts.extend((0..count).map(|_| (part.to_vec(), pause)));
    parts
}

fn gzip(bytes: usize) -> Vec<u8> {
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    let zeros = vec![b' '; 1 << 20];
    (0..bytes >> 20).for_each(|_| packed.write_all(&zeros).unwrap());
    packed.finish().unwrap()
}

#[tokio::test]
async fn size_is_counted_as_it_comes_out() {
    let (bomb, small) = (gzip(40 << 20), gzip(1 << 19));
    assert!(bomb.len() < 1 << 20);
    let server = Server::start(move |a| match a.path.as_str() {
        "/bomb" => reply(200, &[HTML, ("Content-Encoding", "gzip")], &bomb),
        "/packed" => reply(200, &[HTML, ("Content-Encoding", "gzip")], &small),
        "/declared" => vec![(
            b"HTTP/1.1 200 OK\r\nContent-Type: text/html\r\nContent-Length: 99999999\r\n\r\n".to_vec(),
            Duration::ZERO,
        )],
        "/until_close" => {
            endless("HTTP/1.1 200 OK\r\nContent-Type: text/html\r\n\r\n", &[b'a'; 65536], 64, Duration::ZERO)
        }
        "/chunked" => {
            let chunk = [b"10000\r\n".as_slice(), &[b'a'; 65536], b"\r\n"].concat();
            endless(
                "HTTP/1.1 200 OK\r\nContent-Type: text/html\r\nTransfer-Encoding: chunked\r\n\r\n",
                &chunk,
                64,
                Duration::ZERO,
            )
        }
        // Says 10 bytes and sends more: what comes after the tenth is no part of the document.
        "/lying" => endless(
            "HTTP/1.1 200 OK\r\nContent-Type: text/html\r\nContent-Length: 10\r\n\r\n",
            &[b'a'; 65536],
            64,
            Duration::ZERO,
        ),
        "/headers" => {
            endless("HTTP/1.1 200 OK\r\n", &b"X-Filler: aaaaaaaaaaaaaaaaaaaaaaaa\r\n".repeat(1000), 200, Duration::ZERO)
        }
        _ => not_found(),
    });
    for (path, expected) in [
        ("/bomb", Code::TooLarge),
        ("/declared", Code::TooLarge),
        ("/until_close", Code::TooLarge),
        ("/chunked", Code::TooLarge),
        ("/headers", Code::Incomplete),
    ] {
        assert_eq!(code(get(&server, path).await), expected, "{path}");
    }
    assert_eq!(get(&server, "/packed").await.unwrap().bytes.len(), 0, "empty: less than a whole part was packed");
    assert_eq!(get(&server, "/lying").await.unwrap().bytes, b"aaaaaaaaaa");
}

#[tokio::test]
async fn slow_servers_are_given_up() {
    let slow = Duration::from_millis(40);
    let server = Server::start(move |a| match a.path.as_str() {
        "/head" => endless("HTTP/1.1 200 OK\r\nX-Slow: ", b"a", 1000, slow),
        "/body" => endless("HTTP/1.1 200 OK\r\nContent-Type: text/html\r\n\r\n", b"a", 1000, slow),
        "/silent" => vec![(Vec::new(), Duration::from_secs(40))],
        "/pause" => endless("HTTP/1.1 200 OK\r\nContent-Type: text/html\r\n\r\n", b"a", 2, Duration::from_secs(40)),
        _ => not_found(),
    });
    let options = Options {
        read_timeout: Duration::from_millis(1500),
        total_timeout: Duration::from_millis(3000),
        ..options(server.port)
    };
    for path in ["/head", "/body", "/silent", "/pause"] {
        let start = Instant::now();
        assert_eq!(code(fetcher(options.clone(), None).fetch(&server.url(path)).await), Code::Timeout, "{path}");
        assert!(start.elapsed() < Duration::from_secs(20), "{path} took {:?}", start.elapsed());
    }
}

#[tokio::test]
async fn broken_answers_are_named() {
    let server = Server::start(|a| match a.path.as_str() {
        "/short" => vec![(
            b"HTTP/1.1 200 OK\r\nContent-Type: text/html\r\nContent-Length: 50\r\n\r\nabc".to_vec(),
            Duration::ZERO,
        )],
        "/gzip" => reply(200, &[HTML, ("Content-Encoding", "gzip")], b"no gzip at all"),
        "/noise" => vec![(b"hello\r\n\r\n".to_vec(), Duration::ZERO)],
        "/nothing" => Vec::new(),
        _ => not_found(),
    });
    for path in ["/short", "/gzip", "/noise", "/nothing"] {
        assert_eq!(code(get(&server, path).await), Code::Incomplete, "{path}");
    }
}

#[tokio::test]
async fn only_documents_are_taken() {
    let server = Server::start(|a| {
        let typed = |kind: &str, body: &[u8]| reply(200, &[("Content-Type", kind)], body);
        match a.path.as_str() {
            "/x.zip" => typed("application/zip", b"PK\x03\x04"),
            "/hidden.html" => typed("text/html", b"PK\x03\x04"),
            "/a.json" => typed("application/json", b"{}"),
            "/a.png" => typed("image/png", b"\x89PNG"),
            "/binary" => typed("application/octet-stream", &[0; 100]),
            "/a.pdf" => typed("application/octet-stream", b"%PDF-1.4"),
            "/a.md" => typed("text/plain; charset=utf-8", b"# a"),
            "/typeless" => reply(200, &[], b"<!doctype html><p>x"),
            "/page" => page("x"),
            _ => not_found(),
        }
    });
    for path in ["/x.zip", "/hidden.html", "/a.json", "/a.png", "/binary"] {
        assert_eq!(code(get(&server, path).await), Code::UnsupportedType, "{path}");
    }
    for (path, kind) in [("/a.pdf", "pdf"), ("/a.md", "markdown"), ("/typeless", "html"), ("/page", "html")] {
        let found = get(&server, path).await.unwrap();
        assert_eq!(serde_json::to_value(found.entry.kind).unwrap(), kind, "{path}");
    }
}
