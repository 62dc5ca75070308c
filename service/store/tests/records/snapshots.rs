//! Snapshots: whole or not at all, from every backend into every backend.

use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use d3dgen_store::{Access, Backend, Batch, Error, KeyRange, Record, Store, snapshot};

use crate::common::{each, filled, options, patient, payload, verify};

fn take(store: &Store, path: &Path) -> d3dgen_store::Result<snapshot::Summary> {
    snapshot::write(store, path, "a test", &mut |_| {}, &AtomicBool::new(false))
}

fn restore(path: &Path, dir: &Path, backend: Backend) -> d3dgen_store::Result<Store> {
    snapshot::restore(path, dir, &options(backend), &mut |_| {}, &AtomicBool::new(false))
}

fn contents(store: &Store) -> Vec<(String, Vec<Record>)> {
    let view = store.view().unwrap();
    let tables = view.tables().unwrap().into_iter();
    tables.map(|t| (t.clone(), view.records(&t, KeyRange::all()).map(Result::unwrap).collect())).collect()
}

/// Names in a folder, sorted.
fn names(dir: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(dir).unwrap().map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn every_backend_restores_what_every_backend_saved() {
    each(|backend, dir| {
        filled(dir, backend, 700);
        let store = Store::open(dir, Access::Write, &patient(backend)).unwrap();
        let mut batch = Batch::new();
        batch.put("other", "größe 部屋", "").put("other", "large", vec![9; 3 << 20]).delete("things", "k0300");
        store.apply(batch).unwrap();
        let file = dir.with_file_name("saved.snapshot");
        let mut seen = Vec::new();
        let summary =
            snapshot::write(&store, &file, "a test", &mut |p| seen.push((p.done, p.total)), &AtomicBool::new(false));
        let summary = summary.unwrap();
        assert_eq!((summary.records, summary.revision, summary.written_by.as_str()), (701, 15, "a test"));
        assert_eq!((seen.first(), seen.last()), (Some(&(0, 701)), Some(&(701, 701))));
        assert_eq!(snapshot::check(&file).unwrap(), summary);
        for other in Backend::ALL.iter().filter(|b| b.is_built_in()) {
            let place = dir.with_file_name(format!("restored to {}", other.name()));
            let restored = restore(&file, &place, *other).unwrap();
            assert_eq!((restored.backend(), restored.revision().unwrap()), (*other, 15));
            assert!(contents(&restored) == contents(&store));
            assert_eq!(verify(&restored).unwrap(), []);
            // And again, byte by byte the same: what is saved depends on the records alone.
            let again = dir.with_file_name(format!("again-{}.snapshot", other.name()));
            take(&restored, &again).unwrap();
            assert!(fs::read(&again).unwrap() == fs::read(&file).unwrap());
        }
    });
}

#[test]
fn nothing_is_overwritten() {
    each(|backend, dir| {
        filled(dir, backend, 3);
        let store = Store::open(dir, Access::Read, &patient(backend)).unwrap();
        let file = dir.with_file_name("saved.snapshot");
        fs::write(&file, "mine").unwrap();
        assert!(matches!(take(&store, &file), Err(Error::Exists { .. })));
        assert_eq!(fs::read(&file).unwrap(), b"mine");
        fs::remove_file(&file).unwrap();
        take(&store, &file).unwrap();
        drop(store);
        assert!(matches!(restore(&file, dir, backend), Err(Error::Exists { .. })));
        let foreign = dir.with_file_name("foreign");
        fs::create_dir(&foreign).unwrap();
        fs::write(foreign.join("thesis.tex"), "x").unwrap();
        assert!(matches!(restore(&file, &foreign, backend), Err(Error::Exists { .. })));
        assert_eq!(names(&foreign), ["thesis.tex"]);
    });
}

#[test]
fn a_damaged_snapshot_is_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("store");
    filled(&dir, Backend::Redb, 3);
    let file = folder.path().join("saved.snapshot");
    take(&Store::open(&dir, Access::Read, &options(Backend::Redb)).unwrap(), &file).unwrap();
    let whole = fs::read(&file).unwrap();
    let place = folder.path().join("restored");
    let refused = |bytes: &[u8], what: &str| {
        fs::write(&file, bytes).unwrap();
        let error = restore(&file, &place, Backend::Redb).err().unwrap_or_else(|| panic!("{what} was restored"));
        assert!(matches!(error, Error::Snapshot { .. } | Error::Newer { .. }), "{what}: {error}");
        assert!(!place.exists(), "{what}");
    };
    for length in 0..whole.len() {
        refused(&whole[..length], &format!("a snapshot cut to {length} bytes"));
    }
    for at in 0..whole.len() {
        let mut bytes = whole.clone();
        bytes[at] ^= 1 << (at % 8);
        refused(&bytes, &format!("a snapshot with byte {at} flipped"));
    }
    refused(&[&whole[..], b"\0"].concat(), "a snapshot with something behind it");
    fs::write(&file, &whole).unwrap();
    assert_eq!(restore(&file, &place, Backend::Redb).unwrap().count("things").unwrap(), 3);
}

#[test]
fn a_damaged_record_is_not_saved() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("store");
    filled(&dir, Backend::Redb, 30);
    let records = dir.join("records-2.redb");
    let text = payload(7).into_bytes();
    let mut bytes = fs::read(&records).unwrap();
    let found: Vec<_> = (0..bytes.len() - text.len()).filter(|i| bytes[*i..].starts_with(&text)).collect();
    for at in found {
        bytes[at] ^= 1;
    }
    fs::write(&records, bytes).unwrap();
    let store = Store::open(&dir, Access::Read, &options(Backend::Redb)).unwrap();
    let file = folder.path().join("saved.snapshot");
    assert!(matches!(take(&store, &file), Err(Error::Damaged { key, .. }) if key == "k0007"));
    assert_eq!(names(folder.path()), ["store"], "nothing half written stays");
}

#[test]
fn cancelled_halfway_nothing_is_left() {
    each(|backend, dir| {
        filled(dir, backend, 1000);
        let store = Store::open(dir, Access::Read, &patient(backend)).unwrap();
        let file = dir.with_file_name("saved.snapshot");
        let cancelled = AtomicBool::new(false);
        let mut cancel = |p: d3dgen_store::Progress| cancelled.store(p.done > 500, Ordering::Relaxed);
        assert!(matches!(snapshot::write(&store, &file, "", &mut cancel, &cancelled), Err(Error::Cancelled)));
        assert!(!file.exists());
        take(&store, &file).unwrap();
        let place = dir.with_file_name("restored");
        cancelled.store(false, Ordering::Relaxed);
        let options = options(backend);
        let stopped = snapshot::restore(&file, &place, &options, &mut cancel, &cancelled);
        assert!(matches!(stopped, Err(Error::Cancelled)));
        assert!(matches!(Store::open(&place, Access::Read, &options), Err(Error::NotFound { .. })));
        assert_eq!(restore(&file, &place, backend).unwrap().count("things").unwrap(), 1000);
    });
}

#[test]
fn a_snapshot_fits_itself_however_busy_the_store_is() {
    each(|backend, dir| {
        let store = Store::create(dir, &options(backend)).unwrap();
        let write = |n: u32| {
            let mut batch = Batch::new();
            for i in 0..300 {
                batch.put(if i % 2 == 0 { "even" } else { "odd" }, format!("k{i}"), n.to_string());
            }
            store.apply(batch).unwrap();
        };
        write(1);
        let done = AtomicBool::new(false);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                let mut n = 1;
                while !done.load(Ordering::Relaxed) {
                    n += 1;
                    write(n);
                    std::thread::yield_now();
                }
            });
            let reader = scope.spawn(|| {
                while !done.load(Ordering::Relaxed) {
                    store.get("even", "k2").unwrap().unwrap();
                }
            });
            let mut revisions = Vec::new();
            for n in 0..4 {
                let file = dir.with_file_name(format!("{n}.snapshot"));
                revisions.push(take(&store, &file).unwrap().revision);
                let restored = restore(&file, &dir.with_file_name(format!("restored-{n}")), backend).unwrap();
                for (_, records) in contents(&restored) {
                    assert_eq!(records.len(), 150);
                    let expected = restored.revision().unwrap().to_string().into_bytes();
                    assert!(records.iter().all(|(_, payload)| *payload == expected));
                }
            }
            done.store(true, Ordering::Relaxed);
            reader.join().unwrap();
            assert!(revisions.is_sorted());
        });
    });
}
