//! A process that is killed while it rebuilds an index leaves one that opens and answers.
#![allow(clippy::unwrap_used)] // helpers of tests are tests

use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::Duration;

use d3dgen_store::Error;
use d3dgen_store::embed::StaticTable;
use d3dgen_store::index::{Document, Filter, Index, IndexSpec, Mode, Opened, Reason, Watch};

const FOLDER: &str = "D3DGEN_INDEX_KILL_FOLDER";
const ROUNDS: u64 = 20;
/// Revision that the killed process never writes.
const NEVER: u64 = u64::MAX;

fn open(dir: &Path, revision: u64) -> Opened {
    let one = |i: usize| Document {
        key: format!("{i:04}"),
        texts: [("text".to_owned(), format!("door number {i} of revision {revision}"))].into(),
        embed_text: format!("door {i}"),
        ..Document::default()
    };
    let documents = || Ok::<_, Error>((0..300).map(one));
    let spec = IndexSpec::default().field("text", 1.0);
    Index::open_or_rebuild(dir, &spec, Arc::new(StaticTable::new()), revision, documents, Watch::nobody()).unwrap()
}

/// What the child does; run by the test below only.
#[test]
#[ignore = "never ends: it is there to be killed"]
fn child_rebuilds_until_it_is_killed() {
    let Ok(dir) = std::env::var(FOLDER) else { return };
    for revision in 0.. {
        open(Path::new(&dir), revision % NEVER);
    }
}

#[test]
fn killed_while_rebuilding() {
    let dir = tempfile::tempdir().unwrap();
    let mut random = 42_u64;
    let mut kept = 0;
    for round in 0..ROUNDS {
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "child_rebuilds_until_it_is_killed", "--ignored"])
            .env(FOLDER, dir.path())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        std::thread::sleep(Duration::from_millis(60 + (random >> 33) % 300));
        assert!(child.try_wait().unwrap().is_none(), "the child ended by itself");
        child.kill().unwrap();
        child.wait().unwrap();

        let opened = open(dir.path(), NEVER);
        match opened.rebuilt {
            // The child had finished one since.
            Some(Reason::Stale { .. }) => kept += 1,
            // It was killed in its first one, and the one before is still there, if any.
            None => assert!(round > 0),
            Some(Reason::Missing) => assert_eq!(round, 0),
            Some(reason) => panic!("round {round}: {reason}"),
        }
        assert!(opened.unsaved.is_none(), "{:?}", opened.unsaved);
        let hits = opened.index.search("door number 77", &Filter::Everything, 1, Mode::Hybrid).unwrap();
        assert_eq!(hits[0].key, "0077");
        assert!(open(dir.path(), NEVER).rebuilt.is_none());
        let folders = std::fs::read_dir(dir.path()).unwrap().filter(|e| e.as_ref().unwrap().path().is_dir());
        assert_eq!(folders.count(), 1, "leftovers of a killed rebuild");
    }
    assert!(kept > 0, "the child was always killed before its first index was whole");
}
