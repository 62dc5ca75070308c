//! The cache: replay without a server, ages, damage, and a process killed while it writes.

use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::Duration;

use d3dgen_research::fetch::{Cache, Code, Entry, Fetcher, Mode, Options};
use d3dgen_research::read::Kind;

use crate::server::{Names, Server, code, not_found, options, page, reply};

fn at(time_s: u64, options: Options, folder: &Path) -> Fetcher {
    let names = Names::of("site.test", &[&["127.0.0.1"]]);
    Fetcher::with_resolver(options, Some(Cache::open(folder).unwrap()), Arc::new(move || time_s), names)
}

fn server() -> Server {
    Server::start(|a| match a.path.as_str() {
        "/old" => reply(301, &[("Location", "/page")], b""),
        "/page" => page("<p>A door is 0.9 m wide."),
        _ => not_found(),
    })
}

#[tokio::test]
async fn documents_are_replayed_without_a_network() {
    let (folder, server) = (tempfile::tempdir().unwrap(), server());
    let url = server.url("/old#part");
    let online = options(server.port);
    let first = at(1_795_271_460, online.clone(), folder.path()).fetch(&url).await.unwrap();
    assert!(!first.from_cache);
    assert_eq!(first.entry.fetched_at, "2026-11-21T14:31:00Z");
    assert_eq!((first.entry.url.clone(), first.entry.final_url.clone()), (server.url("/old"), server.url("/page")));
    let asked = server.paths().len();

    let offline = Options { mode: Mode::Offline, ..online.clone() };
    let again = at(1_999_999_999, offline.clone(), folder.path()).fetch(&url).await.unwrap();
    assert!(again.from_cache);
    assert_eq!((again.entry, again.bytes), (first.entry.clone(), first.bytes.clone()));
    assert_eq!(code(at(0, offline, folder.path()).fetch(&server.url("/other")).await), Code::NotInCache);
    assert_eq!(Cache::open(folder.path()).unwrap().entries().unwrap(), [first.entry]);

    let aged = |max_s| Options { mode: Mode::Online { max_age: Some(Duration::from_secs(max_s)) }, ..online.clone() };
    assert!(at(1_795_271_560, online.clone(), folder.path()).fetch(&url).await.unwrap().from_cache);
    assert!(at(1_795_271_560, aged(100), folder.path()).fetch(&url).await.unwrap().from_cache);
    assert_eq!(server.paths().len(), asked, "nothing was asked again");
    let fresh = at(1_795_271_560, aged(99), folder.path()).fetch(&url).await.unwrap();
    assert!(!fresh.from_cache && fresh.entry.fetched_at_s == 1_795_271_560);
}

#[tokio::test]
async fn damage_is_noticed_and_mended_online() {
    let (folder, server) = (tempfile::tempdir().unwrap(), server());
    let url = server.url("/page");
    let online = options(server.port);
    let offline = Options { mode: Mode::Offline, ..online.clone() };
    let first = at(1, online.clone(), folder.path()).fetch(&url).await.unwrap();
    let body = folder.path().join("bodies").join(&first.entry.sha256);
    let entry = std::fs::read_dir(folder.path().join("entries")).unwrap().next().unwrap().unwrap().path();
    let good = std::fs::read_to_string(&entry).unwrap();
    let outside = good.replace(&first.entry.sha256, "../../../etc/passwd");
    let damages: [(&Path, Option<&str>); 6] = [
        (&body, Some("<p>A door is 9 m wide.")),
        (&body, Some("")),
        (&body, None),
        (&entry, Some("{\"version\": 1")),
        (&entry, Some(&outside)),
        (&entry, Some("")),
    ];
    for (path, content) in damages {
        match content {
            Some(text) => std::fs::write(path, text).unwrap(),
            None => std::fs::remove_file(path).unwrap(),
        }
        assert_eq!(code(at(2, offline.clone(), folder.path()).fetch(&url).await), Code::DamagedCache, "{content:?}");
        let mended = at(3, online.clone(), folder.path()).fetch(&url).await.unwrap();
        assert!(!mended.from_cache && mended.bytes == first.bytes);
        assert!(at(4, offline.clone(), folder.path()).fetch(&url).await.unwrap().from_cache);
    }
}

/// Writes documents without end into the folder that its environment names.
#[test]
#[ignore = "runs in the process that the next test starts and kills"]
fn the_writer_that_is_killed() {
    let Some(folder) = std::env::var_os("D3DGEN_TEST_CACHE") else { return };
    let cache = Cache::open(Path::new(&folder)).unwrap();
    for round in 0u64.. {
        let (url, body) = document(round);
        cache.keep(&Entry::new(&url, &url, round, None, Kind::Text, body.as_bytes()), body.as_bytes()).unwrap();
    }
}

fn document(round: u64) -> (String, String) {
    (format!("http://site.test/{}", round % 7), format!("{round} ").repeat(20_000))
}

#[tokio::test]
async fn a_killed_writer_leaves_no_half_file() {
    let folder = tempfile::tempdir().unwrap();
    let mut kept = 0;
    for round in 0..8u64 {
        let mut writer = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "cache::the_writer_that_is_killed", "--ignored"])
            .env("D3DGEN_TEST_CACHE", folder.path())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(Duration::from_millis(120 + 37 * round));
        writer.kill().unwrap();
        writer.wait().unwrap();
        let offline = Options { mode: Mode::Offline, ..Options::default() };
        kept = 0;
        for n in 0..7 {
            let url = document(n).0;
            match at(0, offline.clone(), folder.path()).fetch(&url).await {
                Ok(found) => {
                    let (_, expected) = document(found.entry.fetched_at_s);
                    assert_eq!(found.bytes, expected.as_bytes(), "round {round}, {url}");
                    kept += 1;
                }
                Err(error) => assert_eq!(code::<()>(Err(error)), Code::NotInCache, "round {round}, {url}"),
            }
        }
    }
    assert!(kept > 0, "the writer wrote nothing in any round");
}
