//! Where a document may come from: hostile URLs, names that lead inside, names that change, redirects.

use std::net::IpAddr;
use std::sync::Arc;

use d3dgen_research::fetch::{Code, Fetcher, Network, Options, refusal};

use crate::server::{Names, Server, code, fetcher, get, not_found, numbers, options, page, reply};

#[test]
fn only_public_addresses_are_public() {
    let refused = "0.0.0.0 0.1.2.3 10.0.0.1 100.64.0.1 100.127.255.255 127.0.0.1 127.255.0.1 169.254.169.254 172.16.0.1 \
        172.31.255.255 192.0.0.1 192.0.2.5 192.88.99.1 192.168.1.1 198.18.0.1 198.19.255.255 198.51.100.1 203.0.113.9 \
        224.0.0.1 239.255.255.255 240.0.0.1 255.255.255.255 :: ::1 ::127.0.0.1 ::8.8.8.8 ::ffff:127.0.0.1 \
        ::ffff:169.254.169.254 ::ffff:0:127.0.0.1 64:ff9b::10.0.0.1 64:ff9b::7f00:1 64:ff9b:1::1 100::1 2001::1 \
        2001:0:7f00:1:: 2001:db8::1 2002:7f00:1::1 2002:a9fe:a9fe:: 3fff::1 5f00::1 fc00::1 fd12:3456::1 fe80::1 fec0::1 \
        ff02::1 4000::1";
    for text in refused.split_whitespace() {
        let address: IpAddr = text.parse().unwrap();
        assert!(refusal(address).is_some(), "{text}");
    }
    let public = "1.1.1.1 8.8.8.8 9.255.255.255 11.0.0.0 100.63.255.255 100.128.0.0 128.0.0.1 169.253.1.1 172.15.0.1 \
        172.32.0.1 192.167.1.1 192.169.0.1 198.17.1.1 198.20.0.1 223.255.255.255 2606:4700:4700::1111 2a00:1450::1 \
        ::ffff:8.8.8.8 64:ff9b::8.8.8.8";
    for text in public.split_whitespace() {
        assert_eq!(refusal(text.parse().unwrap()), None, "{text}");
    }
}

#[test]
fn blocks_of_addresses_parse_and_contain() {
    let block: Network = "10.1.0.0/16".parse().unwrap();
    assert!(block.contains("10.1.255.1".parse().unwrap()) && !block.contains("10.2.0.0".parse().unwrap()));
    let all: Network = "0.0.0.0/0".parse().unwrap();
    assert!(all.contains("8.8.8.8".parse().unwrap()) && !all.contains("::1".parse().unwrap()));
    for wrong in ["10.0.0.0", "10.0.0.0/33", "x/8", "::/129", "/"] {
        assert!(wrong.parse::<Network>().is_err(), "{wrong}");
    }
}

#[tokio::test]
async fn hostile_urls_are_refused_before_anything_is_sent() {
    use Code::{BlockedAddress, BlockedPort, CredentialsInUrl, InvalidUrl, UnresolvedHost, UnsupportedScheme};
    let cases = [
        ("", InvalidUrl),
        ("no url", InvalidUrl),
        ("http://", InvalidUrl),
        ("http://256.1.1.1/", InvalidUrl),
        ("file:///etc/passwd", UnsupportedScheme),
        ("ftp://a.test/", UnsupportedScheme),
        ("gopher://127.0.0.1:6379/", UnsupportedScheme),
        ("data:text/html,x", UnsupportedScheme),
        ("javascript:alert(1)", UnsupportedScheme),
        ("http://user@a.test/", CredentialsInUrl),
        ("http://:secret@a.test/", CredentialsInUrl),
        ("http://a.test@127.0.0.1/", CredentialsInUrl),
        ("http://a.test:22/", BlockedPort),
        ("http://a.test:8080/", BlockedPort),
        ("http://a.test:6379/", BlockedPort),
        ("http://127.0.0.1/", BlockedAddress),
        ("https://127.1/", BlockedAddress),
        ("http://2130706433/", BlockedAddress),
        ("http://0x7f000001/", BlockedAddress),
        ("http://0x7f.0.0.1/", BlockedAddress),
        ("http://0177.0.0.1/", BlockedAddress),
        ("http://017700000001/", BlockedAddress),
        ("http://127.0.0.1./", BlockedAddress),
        ("http://%31%32%37.0.0.1/", BlockedAddress),
        ("http://①②⑦.⓪.⓪.①/", BlockedAddress),
        ("http://0/", BlockedAddress),
        ("http://169.254.169.254/latest/meta-data/", BlockedAddress),
        ("http://2852039166/", BlockedAddress),
        ("http://[::1]/", BlockedAddress),
        ("http://[::]/", BlockedAddress),
        ("http://[::ffff:127.0.0.1]/", BlockedAddress),
        ("http://[::ffff:a9fe:a9fe]/", BlockedAddress),
        ("http://[64:ff9b::a00:1]/", BlockedAddress),
        ("http://[fd00:ec2::254]/", BlockedAddress),
        ("http://inside.test/", BlockedAddress),
        ("http://INSIDE.test/", BlockedAddress),
        ("http://inside.test:443/", BlockedAddress),
        ("http://unknown.test/", UnresolvedHost),
    ];
    for (url, expected) in cases {
        // One public address beside one inside does not help.
        let names = Names::of("inside.test", &[&["93.184.216.34", "10.0.0.1"]]);
        let fetcher = Fetcher::with_resolver(Options::default(), None, Arc::new(|| 0), names);
        assert_eq!(code(fetcher.fetch(url).await), expected, "{url}");
    }
}

#[tokio::test]
async fn a_long_url_is_refused() {
    let fetcher = Fetcher::new(Options::default(), None, Arc::new(|| 0));
    assert_eq!(code(fetcher.fetch(&format!("http://a.test/{}", "x".repeat(9000))).await), Code::InvalidUrl);
}

#[tokio::test]
async fn the_connection_goes_to_the_checked_address() {
    let server = Server::start(|a| if a.path == "/robots.txt" { not_found() } else { page("<p>x") });
    // Every second answer leads elsewhere, where the same server listens; only the first address is allowed.
    for changes in 1..4 {
        let mut answers: Vec<&[&str]> = vec![&["127.0.0.2"]; changes];
        answers.push(&["127.0.0.1"]);
        let options = Options { allow_addresses: vec!["127.0.0.2/32".parse().unwrap()], ..options(server.port) };
        let names = Names::of("site.test", &answers);
        let fetcher = Fetcher::with_resolver(options, None, Arc::new(|| 0), names);
        let result = fetcher.fetch(&server.url("/")).await;
        // Three lookups: the check, robots.txt, the page.
        if changes < 3 {
            assert_eq!(code(result), Code::BlockedAddress, "{changes}");
        } else {
            result.unwrap();
        }
    }
    let asked = server.asked.lock().unwrap();
    assert!(asked.len() >= 3 && asked.iter().all(|a| a.at == IpAddr::from([127, 0, 0, 2])), "{asked:?}");
}

#[tokio::test]
async fn every_spelling_of_a_name_leads_to_the_checked_address() {
    let server = Server::start(|a| if a.path == "/robots.txt" { not_found() } else { page("<p>x") });
    for (spelled, resolved) in
        [("SITE.test", "site.test"), ("site.test.", "site.test."), ("bücher.test", "xn--bcher-kva.test")]
    {
        let names = Names::of(resolved, &[&["127.0.0.3"]]);
        let fetcher = Fetcher::with_resolver(options(server.port), None, Arc::new(|| 0), names);
        let found = fetcher.fetch(&format!("http://{spelled}:{}/", server.port)).await;
        assert_eq!(found.unwrap().bytes, b"<p>x", "{spelled}");
    }
    let asked = server.asked.lock().unwrap();
    assert!(asked.iter().all(|a| a.at == IpAddr::from([127, 0, 0, 3])), "{asked:?}");
}

#[tokio::test]
async fn loopback_is_reached_only_when_allowed() {
    let server = Server::start(|a| if a.path == "/robots.txt" { not_found() } else { page("<p>x") });
    let closed = Options { ports: vec![server.port], ..Options::default() };
    assert_eq!(code(fetcher(closed.clone(), None).fetch(&server.url("/")).await), Code::BlockedAddress);
    let literal = format!("http://{}/", numbers(&server));
    assert_eq!(code(fetcher(closed, None).fetch(&literal).await), Code::BlockedAddress);
    assert!(server.paths().is_empty());
    let open = fetcher(options(server.port), None);
    assert_eq!(open.fetch(&literal).await.unwrap().bytes, b"<p>x");
    assert!(server.asked.lock().unwrap().iter().all(|a| a.host == numbers(&server).to_string()));
}

#[tokio::test]
async fn redirects_are_followed_with_care() {
    let server = Server::start(|a| {
        let to = |location: &str| reply(302, &[("Location", location)], b"");
        match a.path.as_str() {
            "/good" => to("/middle?x=1"),
            "/middle?x=1" => to("page#part"),
            "/page" => page("<p>found"),
            "/cloud" => to("http://169.254.169.254/latest/meta-data/"),
            "/odd" => to("http://2852039166/"),
            "/self" => to("/self"),
            "/file" => to("file:///etc/passwd"),
            "/port" => to("http://site.test:25/"),
            "/name" => to("http://elsewhere.test:80/"),
            "/nowhere" => reply(301, &[], b""),
            "/gone" => reply(410, &[], b""),
            "/error" => reply(500, &[], b"<p>x"),
            "/forbidden" => reply(403, &[], b"<p>x"),
            _ => not_found(),
        }
    });
    let found = get(&server, "/good#a").await.unwrap();
    assert_eq!((found.entry.url, found.entry.final_url), (server.url("/good"), server.url("/page")));
    assert_eq!(found.bytes, b"<p>found");
    let cases = [
        ("/cloud", Code::BlockedAddress),
        ("/odd", Code::BlockedPort),
        ("/self", Code::BadRedirect),
        ("/file", Code::UnsupportedScheme),
        ("/port", Code::BlockedPort),
        ("/nowhere", Code::BadRedirect),
        ("/missing", Code::CitationUnresolved),
        ("/gone", Code::CitationUnresolved),
        ("/error", Code::HttpStatus),
        ("/forbidden", Code::HttpStatus),
    ];
    for (path, expected) in cases {
        let mut ports = options(server.port);
        if path == "/cloud" {
            ports.ports.push(80);
        }
        assert_eq!(code(fetcher(ports, None).fetch(&server.url(path)).await), expected, "{path}");
    }
    assert_eq!(server.paths().iter().filter(|p| *p == "/self").count(), 6, "the first and five redirects");
}
