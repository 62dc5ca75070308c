//! Whatever happens to the files of an index, it is noticed, made anew when needed, and answers.
#![allow(clippy::unwrap_used)] // helpers of tests are tests

use std::cell::Cell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use d3dgen_store::embed::{Embedder, StaticTable};
use d3dgen_store::index::{Document, Filter, Index, IndexSpec, Mode, Opened, Reason, Watch};
use d3dgen_store::{Error, Result};

const ROOMS: [&str; 5] = ["kitchen", "corridor", "bedroom", "office", "ward"];

fn spec() -> IndexSpec {
    IndexSpec::default().field("name", 2.0).facets(&["room"]).numbers(&["value"])
}

fn documents(count: usize) -> Vec<Document> {
    let one = |i: usize| {
        let room = ROOMS[i % ROOMS.len()];
        let text = format!("minimum width of {room} door number {i}");
        Document {
            key: format!("rule-{i:05}"),
            texts: [("name".to_owned(), text.clone())].into(),
            facets: [("room".to_owned(), vec![room.to_owned()])].into(),
            numbers: [("value".to_owned(), i as f64)].into(),
            embed_text: text,
        }
    };
    // Not in the order of keys.
    (0..count).rev().map(one).collect()
}

fn open(dir: &Path, revision: u64) -> Opened {
    let made = || Ok::<_, Error>(documents(60));
    Index::open_or_rebuild(dir, &spec(), Arc::new(StaticTable::new()), revision, made, Watch::nobody()).unwrap()
}

fn answers(index: &Index) -> Vec<String> {
    let filter = Filter::facet("room", ["ward"]).and(Filter::number("value", Some(10.0), None));
    let hits = index.search("width of the door number 14", &filter, 5, Mode::Hybrid).unwrap();
    let keys: Vec<String> = hits.into_iter().map(|hit| hit.key).collect();
    assert_eq!(keys[0], "rule-00014");
    assert_eq!(keys.len(), 5);
    keys
}

fn files_below(dir: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(dir).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() { found.extend(files_below(&path)) } else { found.push(path) }
    }
    found.sort();
    found
}

fn folders(dir: &Path) -> usize {
    std::fs::read_dir(dir).unwrap().filter(|entry| entry.as_ref().unwrap().path().is_dir()).count()
}

#[test]
fn a_whole_index_is_opened_and_not_made_again() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path().join("with space ü");
    let first = open(&dir, 1);
    assert_eq!(first.rebuilt, Some(Reason::Missing));
    let called = Cell::new(false);
    let made = || {
        called.set(true);
        Ok::<_, Error>(documents(60))
    };
    let again = Index::open_or_rebuild(&dir, &spec(), Arc::new(StaticTable::new()), 1, made, Watch::nobody()).unwrap();
    assert!(again.rebuilt.is_none() && again.unsaved.is_none() && !called.get());
    assert_eq!(answers(&first.index), answers(&again.index));
    assert_eq!((again.index.len(), again.index.revision()), (60, 1));
}

/// The table under another name.
struct Renamed(&'static str);

impl Embedder for Renamed {
    fn id(&self) -> &str {
        self.0
    }
    fn dim(&self) -> usize {
        256
    }
    fn embed(&self, texts: &[&str]) -> Result<Vec<Vec<f32>>> {
        StaticTable::new().embed(texts)
    }
}

#[test]
fn an_index_of_something_else_is_made_anew() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    open(dir, 1);
    assert_eq!(open(dir, 2).rebuilt, Some(Reason::Stale { indexed: 1 }));
    // Also backwards: a snapshot may have been restored.
    assert_eq!(open(dir, 1).rebuilt, Some(Reason::Stale { indexed: 2 }));
    let table = Arc::new(StaticTable::new());
    let made = || Ok::<_, Error>(documents(60));
    let other = Index::open_or_rebuild(dir, &spec(), Arc::new(Renamed("other")), 1, made, Watch::nobody()).unwrap();
    assert_eq!(other.rebuilt, Some(Reason::OtherEmbedder { id: table.id().to_owned() }));
    assert_eq!(open(dir, 1).rebuilt, Some(Reason::OtherEmbedder { id: "other".to_owned() }));
    let wider = spec().facets(&["country"]);
    let other = Index::open_or_rebuild(dir, &wider, table, 1, made, Watch::nobody()).unwrap();
    assert_eq!(other.rebuilt, Some(Reason::OtherSpec));
    assert_eq!(folders(dir), 1);
}

/// Damages the index in one way after the other; each must be noticed, made good, and answer as before.
#[track_caller]
fn check_damage(dir: &Path, damage: impl Fn(&Path)) {
    let expected = answers(&open(dir, 1).index);
    let files: Vec<PathBuf> =
        files_below(dir).into_iter().filter(|f| f.file_name().is_some_and(|n| n != "build.lock")).collect();
    assert!(files.len() > 5, "{files:?}");
    for file in 0..files.len() {
        // Names change with each rebuild, their order does not matter: every file has its turn or another one's.
        let files: Vec<PathBuf> =
            files_below(dir).into_iter().filter(|f| f.file_name().is_some_and(|n| n != "build.lock")).collect();
        let file = &files[file];
        damage(file);
        let opened = open(dir, 1);
        let named = matches!(&opened.rebuilt, Some(Reason::Damaged { .. } | Reason::Missing));
        assert!(named, "{}: {:?}", file.display(), opened.rebuilt);
        assert_eq!(answers(&opened.index), expected);
        assert!(open(dir, 1).rebuilt.is_none());
    }
}

#[test]
fn flipped_bits_are_noticed_in_every_file() {
    let dir = tempfile::tempdir().unwrap();
    for place in [0.0, 0.33, 0.77, 1.0] {
        check_damage(dir.path(), |file| {
            let mut content = std::fs::read(file).unwrap();
            let at = ((content.len() - 1) as f64 * place) as usize;
            content[at] ^= 1 << (at % 8);
            std::fs::write(file, content).unwrap();
        });
    }
}

#[test]
fn short_long_missing_and_foreign_files_are_noticed() {
    let dir = tempfile::tempdir().unwrap();
    check_damage(dir.path(), |file| {
        let content = std::fs::read(file).unwrap();
        std::fs::write(file, &content[..content.len() / 2]).unwrap();
    });
    check_damage(dir.path(), |file| std::fs::write(file, []).unwrap());
    check_damage(dir.path(), |file| {
        let mut content = std::fs::read(file).unwrap();
        content.push(b' ');
        std::fs::write(file, content).unwrap();
    });
    check_damage(dir.path(), |file| std::fs::remove_file(file).unwrap());
}

#[test]
fn files_that_changed_places_are_noticed() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    open(dir, 1);
    let by_name: BTreeMap<_, _> =
        files_below(dir).into_iter().map(|f| (f.extension().map(|e| e.to_owned()), f)).collect();
    let [a, b] = ["f32", "postcard"].map(|end| by_name[&Some(end.into())].clone());
    let (content_a, content_b) = (std::fs::read(&a).unwrap(), std::fs::read(&b).unwrap());
    std::fs::write(&a, content_b).unwrap();
    std::fs::write(&b, content_a).unwrap();
    assert!(matches!(open(dir, 1).rebuilt, Some(Reason::Damaged { .. })));
    // The files of an index of other documents, put in the place of this one's.
    let other = tempfile::tempdir().unwrap();
    let made = || Ok::<_, Error>(documents(50));
    let table = Arc::new(StaticTable::new());
    Index::open_or_rebuild(other.path(), &spec(), table, 1, made, Watch::nobody()).unwrap();
    let vectors = |dir: &Path| files_below(dir).into_iter().find(|f| f.ends_with("vectors.f32")).unwrap();
    std::fs::copy(vectors(other.path()), vectors(dir)).unwrap();
    assert!(matches!(open(dir, 1).rebuilt, Some(Reason::Damaged { .. })));
    answers(&open(dir, 1).index);
}

#[test]
fn what_cannot_be_kept_is_answered_from_memory() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("file");
    std::fs::write(&file, "").unwrap();
    let opened = open(&file.join("index"), 1);
    assert!(matches!(opened.unsaved, Some(Error::Io { .. })), "{:?}", opened.unsaved);
    assert_eq!(opened.rebuilt, Some(Reason::Missing));
    answers(&opened.index);
}

#[cfg(unix)]
#[test]
fn an_index_that_may_only_be_read_is_read() {
    use std::os::unix::fs::PermissionsExt;
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    open(dir, 1);
    let mode = |mode| std::fs::set_permissions(dir, std::fs::Permissions::from_mode(mode)).unwrap();
    mode(0o555);
    let opened = open(dir, 1);
    assert!(opened.rebuilt.is_none() && opened.unsaved.is_none());
    answers(&opened.index);
    // A user whom permissions do not bind writes all the same.
    let bound = std::fs::write(dir.join("probe"), "").is_err();
    assert_eq!(open(dir, 2).unsaved.is_some(), bound);
    mode(0o755);
}

#[test]
fn a_cancelled_rebuild_leaves_the_old_index() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    open(dir, 1);
    let before = files_below(dir);
    for patience in 0..12 {
        let asked = AtomicUsize::new(0);
        let cancel = || asked.fetch_add(1, Ordering::Relaxed) >= patience;
        let watch = Watch { progress: &|_| (), cancel: &cancel };
        let made = || Ok::<_, Error>(documents(60));
        let opened = Index::open_or_rebuild(dir, &spec(), Arc::new(StaticTable::new()), 2, made, watch);
        match opened {
            Err(Error::Cancelled) => assert_eq!(files_below(dir), before),
            // It was never asked again: there is little to do.
            Ok(opened) => return assert!(opened.rebuilt.is_some() && patience > 4),
            Err(other) => panic!("{other}"),
        }
    }
}

#[test]
fn errors_of_the_source_are_passed_on() {
    let dir = tempfile::tempdir().unwrap();
    let failing = || Err::<Vec<Document>, _>(Error::NotFound { dir: "records".into() });
    let made = Index::open_or_rebuild(dir.path(), &spec(), Arc::new(StaticTable::new()), 1, failing, Watch::nobody());
    assert!(matches!(made, Err(Error::NotFound { .. })));
    assert_eq!(open(dir.path(), 1).rebuilt, Some(Reason::Missing));
}

#[test]
fn leftovers_are_removed_and_open_indexes_stay_readable() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let first = open(dir, 1);
    let left = dir.join("files-killed/text");
    std::fs::create_dir_all(&left).unwrap();
    std::fs::write(left.join("half"), "x").unwrap();
    std::fs::write(dir.join(".unfinished-manifest"), "{").unwrap();
    assert!(open(dir, 1).rebuilt.is_none());
    assert_eq!(folders(dir), 1);
    open(dir, 2);
    assert_eq!(folders(dir), 1);
    assert!(!dir.join(".unfinished-manifest").exists());
    answers(&first.index);
    std::fs::remove_dir_all(dir).unwrap();
    answers(&first.index);
}

#[test]
fn several_rebuild_and_read_at_once() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    // Locks belong to open files, so threads meet here as processes do.
    std::thread::scope(|scope| {
        for worker in 0..4 {
            scope.spawn(move || {
                for round in 0..6 {
                    let opened = open(dir, (round + worker) % 3);
                    assert!(opened.unsaved.is_none(), "{:?}", opened.unsaved);
                    assert!(!matches!(opened.rebuilt, Some(Reason::Damaged { .. })), "{:?}", opened.rebuilt);
                    answers(&opened.index);
                }
            });
        }
    });
    assert_eq!(folders(dir), 1);
}
