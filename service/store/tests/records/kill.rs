//! `kill -9` at any moment loses nothing that was acknowledged, and leaves no batch half done.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::time::Duration;

use d3dgen_store::{Access, Backend, Batch, KeyRange, Store};

use crate::common::{Random, each, part, part_input, patient, verify};

const ROUNDS: u64 = 20;

/// How many records batch `n` has.
fn size(n: u64) -> u64 {
    if n % 17 == 0 { 400 } else { 3 + n % 20 }
}

fn payload(n: u64, i: u64) -> Vec<u8> {
    let length = if (n + i) % 97 == 0 { 70_000 } else { 100 + (n * 31 + i * 7) % 1500 };
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
