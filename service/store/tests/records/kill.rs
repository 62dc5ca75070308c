//! `kill -9` at any moment loses nothing that was acknowledged, and leaves no batch half done.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use d3dgen_store::{Access, Backend, Batch, Error, KeyRange, Store, snapshot};

use crate::common::{Random, each, filled, part, part_input, patient, verify};

const ROUNDS: u64 = 20;

/// How many records batch `n` has.
fn size(n: u64) -> u64 {
    if n.is_multiple_of(17) { 400 } else { 3 + n % 20 }
}

fn payload(n: u64, i: u64) -> Vec<u8> {
    let length = if (n + i).is_multiple_of(97) { 70_000 } else { 100 + (n * 31 + i * 7) % 1500 };
    format!("{n}/{i} ").into_bytes().into_iter().cycle().take(length as usize).collect()
}

/// Batch `n`: new records, one that all batches overwrite, and half of what an earlier batch stored is removed.
fn batch(n: u64) -> Batch {
    let mut batch = Batch::new();
    for i in 0..size(n) {
        batch.put(if i % 2 == 0 { "even" } else { "odd" }, format!("{n:08}/{i:04}"), payload(n, i));
    }
    batch.put("even", "newest", n.to_string());
    if n > 5 {
        for i in (0..size(n - 5)).step_by(2) {
            batch.delete("even", format!("{:08}/{i:04}", n - 5));
        }
    }
    batch
}

/// Stores batches and says so, until it is killed.
#[test]
#[ignore = "a part of another test"]
fn writes_until_killed() {
    let input = part_input();
    let (backend, dir) = input.split_once(' ').unwrap();
    let store = Store::open_or_create(dir, &patient(Backend::from_name(backend).unwrap())).unwrap();
    println!("\nopen");
    loop {
        let next = store.revision().unwrap() + 1;
        assert_eq!(store.apply(batch(next)).unwrap(), next);
        println!("stored {next}");
        std::io::stdout().flush().unwrap();
    }
}

/// Starts the writer, kills it at a random moment, and returns the last batch that it acknowledged.
fn round(backend: Backend, dir: &Path, random: &mut Random, acknowledged: u64) -> u64 {
    let input = format!("{} {}", backend.name(), dir.display());
    let mut child = part("kill::writes_until_killed", &input).spawn().unwrap();
    let lines = BufReader::new(child.stdout.take().unwrap()).lines();
    // Now and then while it opens, which may be in the middle of a repair.
    let patience = if random.below(5) == 0 { None } else { Some(random.below(12)) };
    let mut lines = lines.map_while(Result::ok);
    let mut last = acknowledged;
    if let Some(batches) = patience {
        let stored = lines.by_ref().filter_map(|line| line.strip_prefix("stored ")?.parse().ok());
        for n in stored.take(batches as usize + 1) {
            last = n;
        }
    }
    std::thread::sleep(Duration::from_micros(random.below(30_000)));
    child.kill().unwrap();
    child.wait().unwrap();
    // What was said before the kill and not read yet counts as well.
    for line in lines {
        if let Some(n) = line.strip_prefix("stored ").and_then(|n| n.parse().ok()) {
            last = n;
        }
    }
    last
}

fn check(store: &Store, acknowledged: u64) -> u64 {
    assert_eq!(verify(store).unwrap(), []);
    let revision = store.revision().unwrap();
    assert!(
        revision == acknowledged || revision == acknowledged + 1,
        "{acknowledged} batches were acknowledged, {revision} are there"
    );
    let view = store.view().unwrap();
    let mut expected = 0;
    for n in 1..=revision {
        for i in 0..size(n) {
            let table = if i % 2 == 0 { "even" } else { "odd" };
            let removed = i % 2 == 0 && n + 5 <= revision;
            let found = view.get(table, &format!("{n:08}/{i:04}")).unwrap();
            assert!(found == (!removed).then(|| payload(n, i)), "record {i} of batch {n} of {revision}");
            expected += u64::from(!removed);
        }
    }
    let newest = view.get("even", "newest").unwrap();
    assert_eq!(newest, (revision > 0).then(|| revision.to_string().into_bytes()));
    let found = ["even", "odd"].map(|table| view.records(table, KeyRange::all()).map(Result::unwrap).count() as u64);
    assert_eq!(found.iter().sum::<u64>(), expected + u64::from(revision > 0), "nothing else is there");
    revision
}

#[test]
fn nothing_acknowledged_is_lost_in_twenty_kills() {
    each(|backend, dir| {
        let mut random = Random(2026);
        let mut acknowledged = 0;
        for number in 0..ROUNDS {
            acknowledged = round(backend, dir, &mut random, acknowledged);
            if !dir.join("store.json").exists() {
                assert_eq!(acknowledged, 0, "a store that was never finished has acknowledged nothing");
                continue;
            }
            // Readers repair as well as writers do.
            let access = if number % 2 == 0 { Access::Read } else { Access::Write };
            match Store::open(dir, access, &patient(backend)) {
                Ok(store) => acknowledged = check(&store, acknowledged),
                Err(error) => {
                    assert!(acknowledged == 0 && error.to_string().contains("interrupted"), "{error}");
                }
            }
        }
        assert!(acknowledged > ROUNDS, "{backend:?} stored only {acknowledged} batches in all");
    });
}

/// Saves a store and restores it elsewhere.
#[test]
#[ignore = "a part of another test"]
fn saves_and_restores() {
    let input = part_input();
    let (backend, home) = input.split_once(' ').unwrap();
    let (home, options) = (Path::new(home), patient(Backend::from_name(backend).unwrap()));
    println!("\nopen");
    let go_on = AtomicBool::new(false);
    let (file, restored) = (home.join("saved.snapshot"), home.join("restored"));
    if !file.exists() {
        let store = Store::open(home.join("store"), Access::Read, &options).unwrap();
        snapshot::write(&store, &file, "a test", &mut |_| {}, &go_on).unwrap();
    }
    snapshot::restore(&file, &restored, &options, &mut |_| {}, &go_on).unwrap();
}

#[test]
fn what_is_saved_or_restored_when_killed_is_whole_or_not_there() {
    each(|backend, dir| {
        filled(dir, backend, 3000);
        let home = dir.parent().unwrap();
        let (file, restored) = (home.join("saved.snapshot"), home.join("restored"));
        let mut random = Random(8);
        let mut whole = 0;
        for _ in 0..12 {
            let mut child = part("kill::saves_and_restores", &format!("{} {}", backend.name(), home.display()));
            let mut child = child.stderr(std::process::Stdio::null()).spawn().unwrap();
            let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map_while(Result::ok);
            assert!(lines.any(|line| line == "open"));
            std::thread::sleep(Duration::from_micros(random.below(150_000)));
            child.kill().unwrap();
            child.wait().unwrap();
            if file.exists() {
                assert_eq!(snapshot::check(&file).unwrap().records, 3000);
            }
            match Store::open(&restored, Access::Read, &patient(backend)) {
                Ok(store) => {
                    assert_eq!((store.count("things").unwrap(), verify(&store).unwrap()), (3000, vec![]));
                    drop(store);
                    std::fs::remove_dir_all(&restored).unwrap();
                    whole += 1;
                }
                Err(Error::NotFound { .. }) => {}
                Err(error) => assert!(error.to_string().contains("interrupted"), "{error}"),
            }
            if random.below(2) == 0 {
                let _ = std::fs::remove_file(&file);
            }
        }
        // What was interrupted is in nobody's way.
        let mut last = part("kill::saves_and_restores", &format!("{} {}", backend.name(), home.display()));
        assert!(last.output().unwrap().status.success(), "{whole} of 12 were whole");
        assert_eq!(Store::open(&restored, Access::Read, &patient(backend)).unwrap().count("things").unwrap(), 3000);
    });
}
