//! robots.txt: what it says, and what its absence and failure mean.

use std::time::{Duration, Instant};

use d3dgen_research::fetch::{Code, Robots};

use crate::server::{Server, code, fetcher, get, options, page, reply};

#[test]
fn files_are_read_as_the_rfc_says() {
    let cases: &[(&str, &[&str], &[&str])] = &[
        ("", &["/", "/a"], &[]),
        ("User-agent: *\nDisallow:\n", &["/a"], &[]),
        ("User-agent: *\nDisallow: /\n", &["/robots.txt"], &["/", "/a"]),
        ("User-agent: *\nDisallow: /private/\nCrawl-delay: 5\n", &["/bedrooms", "/private"], &["/private/x"]),
        ("User-agent: *\nDisallow: /a\nAllow: /a/b\n", &["/a/b", "/a/bc"], &["/a", "/ab", "/a/c"]),
        ("User-agent: *\nAllow: /p\nDisallow: /p\n", &["/p"], &[]),
        ("User-agent: *\nDisallow: /*.pdf$\n", &["/a.pdf?x", "/pdf"], &["/a.pdf", "/b/c.pdf"]),
        ("User-agent: *\nDisallow: /a*b*c$\n", &["/ab", "/abcd"], &["/abc", "/axbxc", "/abcxc"]),
        ("User-agent: *\nDisallow: /*?\n", &["/a"], &["/a?b=1"]),
        ("User-agent: other\nDisallow: /\n", &["/a"], &[]),
        ("User-agent: D3DGEN-research\nDisallow: /a\n\nUser-agent: *\nDisallow: /\n", &["/b"], &["/a"]),
        (
            "user-agent: x\nuser-agent: d3dgen-research/1.0\ndisallow: /a # why\n\nUser-agent: d3dgen-research\nDisallow: /b",
            &["/c"],
            &["/a", "/b"],
        ),
        ("Disallow: /\nUser-agent: *\nDisallow: /a\n", &["/b"], &["/a"]),
        ("\u{feff}User-agent: *\r\nDisallow: /a\r\nSitemap: http://x.test/\r\n", &["/b"], &["/a"]),
        (
            "User-agent: *\nDisallow: /%7Euser/\nDisallow: /ä\n",
            &["/x"],
            &["/~user/", "/%7euser/a", "/%C3%A4", "/%c3%a4b"],
        ),
        ("<html>no such thing</html>", &["/a"], &[]),
    ];
    for (file, allowed, forbidden) in cases {
        let robots = Robots::parse(file.as_bytes(), "d3dgen-research");
        allowed.iter().for_each(|p| assert!(robots.allows(p), "{p} of {file:?}"));
        forbidden.iter().for_each(|p| assert!(!robots.allows(p), "{p} of {file:?}"));
    }
    let delay = |file: &str| Robots::parse(file.as_bytes(), "d3dgen-research").crawl_delay();
    assert_eq!(delay("User-agent: *\nCrawl-delay: 2.5\n"), Some(Duration::from_millis(2500)));
    assert_eq!(delay("User-agent: *\nCrawl-delay: -1\nCrawl-delay: NaN\nCrawl-delay: 1e300\n"), None);
}

#[test]
fn a_huge_hostile_file_is_read_in_time() {
    let start = Instant::now();
    let rule = format!("Disallow: /{}\n", "*a".repeat(400));
    let file = "User-agent: *\n".to_owned() + &rule.repeat(2000) + "Disallow: /z";
    let robots = Robots::parse(file.as_bytes(), "d3dgen-research");
    assert!(robots.allows(&format!("/{}", "a".repeat(300))));
    assert!(robots.allows("/z"), "what comes after 500 KiB is not read");
    assert!(start.elapsed() < Duration::from_secs(20), "{:?}", start.elapsed());
}

#[tokio::test]
async fn absence_allows_and_failure_forbids() {
    let cases: [(u16, Option<Code>); 7] = [
        (404, None),
        (403, None),
        (410, None),
        (500, Some(Code::Robots)),
        (503, Some(Code::Robots)),
        (204, Some(Code::Robots)),
        // A redirect without a target.
        (301, Some(Code::Robots)),
    ];
    for (status, expected) in cases {
        let server =
            Server::start(move |a| if a.path == "/robots.txt" { reply(status, &[], b"") } else { page("<p>x") });
        let result = get(&server, "/a").await;
        match expected {
            None => assert_eq!(result.unwrap().bytes, b"<p>x", "{status}"),
            Some(expected) => assert_eq!(code(result), expected, "{status}"),
        }
    }
    let closing = Server::start(|a| if a.path == "/robots.txt" { Vec::new() } else { page("<p>x") });
    assert_eq!(code(get(&closing, "/a").await), Code::Robots);
    assert_eq!(closing.paths(), ["/robots.txt"], "the page was not asked for");
}

#[tokio::test]
async fn it_is_asked_once_and_its_delay_is_kept() {
    let server = Server::start(|a| match a.path.as_str() {
        "/robots.txt" => reply(302, &[("Location", "/moved.txt")], b""),
        "/moved.txt" => reply(200, &[], b"User-agent: *\nDisallow: /no\nCrawl-delay: 100\n"),
        _ => page("<p>x"),
    });
    let fetcher = fetcher(options(server.port), None);
    let start = Instant::now();
    fetcher.fetch(&server.url("/a")).await.unwrap();
    assert_eq!(code(fetcher.fetch(&server.url("/no/b")).await), Code::Robots);
    fetcher.fetch(&server.url("/b")).await.unwrap();
    assert_eq!(server.paths(), ["/robots.txt", "/moved.txt", "/a", "/b"]);
    // Twice the most that the options allow a file to ask for.
    assert!(start.elapsed() >= Duration::from_millis(600), "{:?}", start.elapsed());
    assert!(start.elapsed() < Duration::from_secs(30));
}
