//! Damaged files: what was not stored is never handed out, and what is wrong is said.

use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use d3dgen_store::{Access, Backend, Batch, Error, KeyRange, Store};

use crate::common::{Random, each, filled, options, patient, payload, verify};

const COUNT: usize = 300;

/// The files that hold the records, largest last.
fn record_files(dir: &Path) -> Vec<PathBuf> {
    fn walk(dir: &Path, found: &mut Vec<PathBuf>) {
        for entry in fs::read_dir(dir).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() { walk(&path, found) } else { found.push(path) }
        }
    }
    let mut found = Vec::new();
    walk(dir, &mut found);
    found.retain(|p| p.strip_prefix(dir).unwrap().to_str().unwrap().starts_with("records"));
    found.sort_by_key(|p| fs::metadata(p).unwrap().len());
    found
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        if entry.path().is_dir() {
            copy(&entry.path(), &to.join(entry.file_name()));
        } else {
            fs::copy(entry.path(), to.join(entry.file_name())).unwrap();
        }
    }
}

/// What became of a store after its files were damaged.
#[derive(Debug, PartialEq)]
enum Outcome {
    Unharmed,
    Reported,
}

/// Reads everything in every way; fails when something is handed out that was not stored, or is missing unnoticed.
fn outcome(dir: &Path, access: Access) -> Outcome {
    let Ok(store) = Store::open(dir, access, &patient(Backend::Redb)) else { return Outcome::Reported };
    let problems = verify(&store);
    let mut all_there = true;
    for n in 0..COUNT {
        match store.get("things", &format!("k{n:04}")) {
            Ok(Some(found)) => assert!(found == payload(n).into_bytes(), "record {n} is not what was stored"),
            Ok(None) | Err(_) => all_there = false,
        }
    }
    if let Ok(view) = store.view() {
        for record in view.records("things", KeyRange::all()) {
            let Ok((key, found)) = record else { break };
            let n: usize = key.trim_start_matches('k').parse().expect("a key that was stored");
            assert!(found == payload(n).into_bytes(), "record {n} is not what was stored");
        }
    }
    match problems {
        Ok(problems) if problems.is_empty() => {
            assert!(all_there, "records are missing or damaged, and verify finds nothing");
            Outcome::Unharmed
        }
        _ => Outcome::Reported,
    }
}

#[test]
fn a_flipped_bit_in_a_payload_is_reported_and_the_record_not_served() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("store");
    filled(&dir, Backend::Redb, COUNT);
    let file = record_files(&dir).pop().unwrap();
    let mut bytes = fs::read(&file).unwrap();
    let mut random = Random(3);
    let spoiled = [7, 123, 299];
    for n in spoiled {
        // Every copy: the file also has pages that are no longer in use.
        let text = payload(n).into_bytes();
        let at: Vec<_> = (0..bytes.len() - text.len()).filter(|i| bytes[*i..].starts_with(&text)).collect();
        assert!(!at.is_empty());
        for start in at {
            bytes[start + random.below(text.len() as u64) as usize] ^= 1 << random.below(8);
        }
    }
    fs::write(&file, bytes).unwrap();

    let store = Store::open(&dir, Access::Write, &options(Backend::Redb)).unwrap();
    let problems = verify(&store).unwrap();
    let keys: Vec<_> = problems.iter().map(|p| p.key.as_deref().unwrap()).collect();
    assert_eq!(keys, ["k0007", "k0123", "k0299"]);
    assert!(problems[0].to_string().contains("k0007 of table things: its checksum differs"), "{}", problems[0]);
    let error = store.get("things", "k0123").err().unwrap();
    assert!(error.to_string().contains("k0123 of table things is damaged"), "{error}");
    assert_eq!(store.get("things", "k0008").unwrap(), Some(payload(8).into_bytes()));

    let view = store.view().unwrap();
    let scanned = view.scan("things", &KeyRange::all(), |_, _| Ok::<_, Error>(ControlFlow::Continue(())));
    assert!(matches!(scanned, Err(Error::Damaged { key, .. }) if key == "k0007"));
    let mut sound = 0;
    let count = |_: &str, _: &[u8]| {
        sound += 1;
        Ok::<_, Error>(ControlFlow::Continue(()))
    };
    assert_eq!(view.scan_sound("things", &KeyRange::all(), count).unwrap(), problems);
    assert_eq!(sound, COUNT - spoiled.len());
    drop(view);

    // Stored again, or removed, they are no problem any more.
    let mut batch = Batch::new();
    batch.put("things", "k0007", payload(7)).delete("things", "k0123").delete("things", "k0299");
    store.apply(batch).unwrap();
    assert_eq!(verify(&store).unwrap(), []);
}

#[test]
fn flipped_bits_anywhere_are_noticed_or_do_not_matter() {
    each(|backend, dir| {
        filled(dir, backend, COUNT);
        let mut random = Random(11);
        let mut reported = 0;
        for round in 0..60 {
            let damaged = dir.with_file_name(format!("damaged-{round}"));
            copy(dir, &damaged);
            let files = record_files(&damaged);
            let file = &files[if round % 4 == 0 { random.below(files.len() as u64) as usize } else { files.len() - 1 }];
            let mut bytes = fs::read(file).unwrap();
            // Where something is written; much of a file is empty.
            let used: Vec<_> = (0..bytes.len()).filter(|i| bytes[*i] != 0).collect();
            for _ in 0..=random.below(3) {
                let at = used[random.below(used.len() as u64) as usize];
                bytes[at] ^= 1 << random.below(8);
            }
            fs::write(file, bytes).unwrap();
            let access = if round % 2 == 0 { Access::Read } else { Access::Write };
            reported += usize::from(outcome(&damaged, access) == Outcome::Reported);
            fs::remove_dir_all(&damaged).unwrap();
        }
        assert!(reported > 10, "{backend:?}: only {reported} of 60 damaged stores were noticed");
    });
}

#[test]
fn a_cut_file_is_noticed() {
    each(|backend, dir| {
        filled(dir, backend, COUNT);
        let whole = fs::metadata(record_files(dir).last().unwrap()).unwrap().len();
        for (round, part) in [0, 1, 500, 4096, whole / 3, whole / 2, whole * 9 / 10].into_iter().enumerate() {
            let damaged = dir.with_file_name(format!("cut-{round}"));
            copy(dir, &damaged);
            let file = record_files(&damaged).pop().unwrap();
            fs::OpenOptions::new().write(true).open(&file).unwrap().set_len(part).unwrap();
            for access in [Access::Read, Access::Write] {
                let found = outcome(&damaged, access);
                assert!(part >= whole / 3 || found == Outcome::Reported, "{backend:?} cut to {part} of {whole} bytes");
            }
        }
    });
}

#[test]
fn foreign_bytes_are_no_records() {
    each(|backend, dir| {
        filled(dir, backend, 5);
        let mut random = Random(5);
        for file in record_files(dir) {
            let length = fs::metadata(&file).unwrap().len();
            fs::write(&file, (0..length).map(|_| random.below(256) as u8).collect::<Vec<_>>()).unwrap();
        }
        for access in [Access::Read, Access::Write] {
            let error = Store::open(dir, access, &patient(backend)).expect_err("rubbish is no store");
            assert!(error.to_string().contains(dir.to_str().unwrap()), "{error}");
        }
    });
}

#[test]
fn missing_records_are_noticed() {
    each(|backend, dir| {
        filled(dir, backend, 5);
        let records = dir.join(format!("records-2.{}", backend.name()));
        if records.is_dir() {
            fs::remove_dir_all(&records).unwrap()
        } else {
            fs::remove_file(&records).unwrap()
        }
        for access in [Access::Read, Access::Write] {
            let error = Store::open(dir, access, &options(backend)).err().unwrap();
            assert!(error.to_string().contains("records-2"), "{error}");
        }
        assert!(!records.exists(), "no empty records are put in their place");
    });
}

#[test]
fn verify_reports_its_progress_and_can_be_cancelled() {
    each(|backend, dir| {
        filled(dir, backend, 1000);
        let store = Store::open(dir, Access::Read, &patient(backend)).unwrap();
        let mut seen = Vec::new();
        store.verify(&mut |p| seen.push((p.done, p.total)), &AtomicBool::new(false)).unwrap();
        assert_eq!((seen.first(), seen.last()), (Some(&(0, 1000)), Some(&(1000, 1000))));
        assert!(seen.len() > 3 && seen.is_sorted());
        let cancelled = AtomicBool::new(false);
        let cancel = &mut |_| cancelled.store(true, std::sync::atomic::Ordering::Relaxed);
        assert!(matches!(store.verify(cancel, &cancelled), Err(Error::Cancelled)));
    });
}
