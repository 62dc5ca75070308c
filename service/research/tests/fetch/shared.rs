//! The exchanges of ../shared/llm/fixtures/web, where they are: each is served, fetched and read as its `expect` says.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use d3dgen_research::Error;
use d3dgen_research::extract::Extractor;
use d3dgen_research::fetch::{Fetched, Fetcher, Options, Robots};
use d3dgen_research::read;
use serde_json::Value;

use crate::server::{Names, Server, not_found, options, page, reply};

fn fixtures() -> Vec<(PathBuf, Value)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/llm/fixtures/web");
    let Ok(files) = std::fs::read_dir(folder) else { return Vec::new() };
    let paths = files.map(|f| f.unwrap().path()).filter(|p| p.extension().is_some_and(|e| e == "json"));
    let mut all: Vec<_> =
        paths.map(|p| (p.clone(), serde_json::from_str(&std::fs::read_to_string(p).unwrap()).unwrap())).collect();
    all.sort_by(|a, b| a.0.cmp(&b.0));
    all
}

/// Serves an exchange, and a page where it redirects to; the server fails where the fixture is about robots.txt itself.
fn serve(fixture: &Value) -> (Server, Options) {
    let answer = fixture["response"].clone();
    let path = fixture["request"]["path"].as_str().unwrap().to_owned();
    let server = Server::start(move |asked| {
        if asked.path != path {
            return if asked.path == "/robots.txt" { not_found() } else { page("<p>found</p>") };
        }
        let headers: Vec<(String, String)> = answer["headers"]
            .as_object()
            .unwrap()
            .iter()
            .filter(|(k, _)| *k != "x-fixture-repeat")
            .map(|(k, v)| (k.clone(), v.as_str().unwrap().to_owned()))
            .collect();
        let headers: Vec<(&str, &str)> = headers.iter().map(|(k, v)| (k.as_str(), v.as_str())).collect();
        let repeat = answer["headers"]["x-fixture-repeat"].as_str().map_or(1, |n| n.parse().unwrap());
        let status = u16::try_from(answer["status"].as_u64().unwrap()).unwrap();
        reply(status, &headers, answer["body_text"].as_str().unwrap_or_default().repeat(repeat).as_bytes())
    });
    let options = options(server.port);
    (server, options)
}

async fn fetched(fixture: &Value) -> Result<Fetched, Error> {
    fetched_at(fixture, fixture["request"]["path"].as_str().unwrap()).await
}

async fn fetched_at(fixture: &Value, path: &str) -> Result<Fetched, Error> {
    let (server, options) = serve(fixture);
    let host = fixture["request"]["headers"]["host"].as_str().unwrap();
    let names = Names::of(host, &[&["127.0.0.1"]]);
    // The fixtures' own redirects name the usual ports.
    let options = Options { ports: vec![server.port, 80, 443], ..options };
    Fetcher::with_resolver(options, None, Arc::new(|| 0), names)
        .fetch(&format!("http://{host}:{}{path}", server.port))
        .await
}

#[tokio::test]
async fn the_shared_exchanges_are_handled_as_they_expect() {
    let fixtures = fixtures();
    if fixtures.is_empty() {
        return eprintln!("skipped: no ../shared beside the project");
    }
    for (path, fixture) in fixtures {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let expect = fixture["expect"].as_object().unwrap();
        if expect.contains_key("disallow") {
            let status = fixture["response"]["status"].as_u64().unwrap();
            let body = fixture["response"]["body_text"].as_str().unwrap();
            let robots =
                if status == 200 { Robots::parse(body.as_bytes(), "d3dgen-research") } else { Robots::disallow_all() };
            let paths = |key: &str| expect.get(key).and_then(Value::as_array).cloned().unwrap_or_default();
            paths("disallow").iter().for_each(|p| assert!(!robots.allows(p.as_str().unwrap()), "{name}: {p}"));
            paths("allow").iter().for_each(|p| assert!(robots.allows(p.as_str().unwrap()), "{name}: {p}"));
            if status != 200 {
                // And as a fetcher sees it.
                let answer = fetched_at(&fixture, "/bedrooms").await;
                assert!(
                    matches!(&answer, Err(Error::Fetch { code, .. }) if code.as_str() == "robots"),
                    "{name}: {answer:?}"
                );
            }
            continue;
        }
        let result = fetched(&fixture).await;
        if let Some(code) = expect.get("error") {
            let Err(Error::Fetch { code: found, .. }) = result else { panic!("{name}: {result:?}") };
            assert_eq!(found.as_str(), code, "{name}");
        } else if expect.contains_key("final") {
            // The target needs https and a name of the world; that it was asked for is all that can be seen here.
            let Err(Error::Fetch { code, reason, .. }) = result else { panic!("{name}: {result:?}") };
            let location = fixture["response"]["headers"]["location"].as_str().unwrap();
            assert_eq!(Some(location), expect["final"].as_str());
            assert!(
                code.as_str() == "unresolved_host" && reason.contains("example-standards.test"),
                "{name}: {reason}"
            );
        } else {
            check_figures(&name, &result.unwrap(), &fixture["expect"]);
        }
    }
}

fn check_figures(name: &str, found: &Fetched, expect: &Value) {
    let entry = &found.entry;
    let document =
        read::read(&found.bytes, entry.content_type.as_deref(), &entry.final_url, &read::Options::default()).unwrap();
    let text = document.text();
    for word in expect["must_not_contain"].as_array().into_iter().flatten() {
        assert!(!text.contains(word.as_str().unwrap()), "{name}: {text}");
    }
    let extractor = Extractor::shared();
    let found: Vec<Value> = document
        .passages
        .iter()
        .flat_map(|p| extractor.extract(&p.text, document.language.as_deref().unwrap_or("en")))
        .map(|f| serde_json::to_value(f.constraint).unwrap())
        .collect();
    let with = |value: f64| found.iter().find(|c| c["value"].as_f64() == Some(value));
    for figure in expect["figures"].as_array().unwrap() {
        let value = figure[1].as_f64().unwrap();
        let unit = with(value).unwrap_or_else(|| panic!("{name}: no {figure} in {found:?}"))["unit"].clone();
        assert_eq!(unit, figure[2], "{name}: {found:?}");
    }
    for value in expect["not"].as_array().into_iter().flatten() {
        assert!(with(value.as_f64().unwrap()).is_none(), "{name}: {value} in {found:?}");
    }
}
