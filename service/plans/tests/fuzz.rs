//! Fuzzes every reader, and what comes after it: small plans changed at random must end in a plan or a message.
//!
//!     cargo test -p d3dgen-plans --test fuzz [-- --seconds 60 [--seed 7]]
//!
//! A change that a reader does not survive is written to `target/fuzz/` with the name of its reader and its seed.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use d3dgen_plans::{Options, Plan, Source, assemble, lay_out, read};
use d3dgen_plugins::Registry;
use rand_chacha::ChaCha8Rng;
use rand_core::{Rng, SeedableRng};

/// The plans that are changed; the ending of each says its reader.
const TARGETS: &[&str] = &[
    "flat.json",
    "flat.geojson",
    "flat.svg",
    "flat.dxf",
    "flat.building.yaml",
    "flat_map.yaml",
    "flat_map.pgm",
    "venue.zip",
];
/// A file must be answered within this time; the tests are not built for speed.
const TIME: Duration = Duration::from_secs(6);

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    if arguments.iter().any(|a| a == "--list") {
        return;
    }
    let option =
        |name: &str| arguments.iter().position(|a| a == name).and_then(|at| arguments.get(at + 1)?.parse().ok());
    let seconds: u64 = option("--seconds").unwrap_or(7);
    let seed: u64 = option("--seed").unwrap_or(1);
    let each = Duration::from_millis(seconds * 1000 / TARGETS.len() as u64);
    let failed = TARGETS.iter().filter(|name| !fuzz(name, each, seed)).count();
    println!("test result: {}. {} passed; {failed} failed", if failed == 0 { "ok" } else { "FAILED" }, TARGETS.len());
    std::process::exit(i32::from(failed > 0));
}

fn plans() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/plans")
}

/// Fuzzes one plan for a time; returns whether it stood.
fn fuzz(name: &str, time: Duration, seed: u64) -> bool {
    let registry = Registry::builtin();
    let domain = registry.get("residential").expect("built in").domain();
    let original = if name == "flat.json" {
        document(domain)
    } else {
        std::fs::read(plans().join(name)).expect("a plan of the tests")
    };
    let map = std::fs::read(plans().join("flat_map.yaml")).expect("a plan of the tests");
    let picture = std::fs::read(plans().join("flat_map.pgm")).expect("a plan of the tests");
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let (begun, mut count, mut good) = (Instant::now(), 0, 0);
    while begun.elapsed() < time {
        let bytes = changed(&original, &mut random);
        let is_picture = name.ends_with(".pgm");
        let (file, text, image) = if is_picture { ("flat_map.yaml", &map, &bytes) } else { (name, &bytes, &picture) };
        let options =
            Options { rectify: random.next_u32() % 2 == 0, add_doors: true, add_windows: true, ..Options::default() };
        let answer = Instant::now();
        let outcome = std::panic::catch_unwind(|| {
            let source = Source { name: file, bytes: text, companion: &|_| Some(image.clone()) };
            match read(&source, &options) {
                Ok(Plan::Drawing(drawing)) => lay_out(drawing, &options).is_ok_and(|layout| {
                    let types = vec!["bedroom".to_owned(); layout.rooms.len()];
                    let (plan, _) = assemble(layout, &types, domain, 0, &options);
                    let problems = d3dgen_model::document::Document::check(&plan);
                    assert!(problems.is_empty(), "{problems:?}");
                    true
                }),
                Ok(Plan::Document(_)) => true,
                Err(_) => false,
            }
        });
        let late = answer.elapsed() > TIME;
        if outcome.is_err() || late {
            let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target/fuzz");
            let file = folder.join(format!("{seed}_{name}"));
            let _ = std::fs::create_dir_all(&folder).and_then(|()| std::fs::write(&file, &bytes));
            println!("{name}: {}: {}", if late { "no answer in time" } else { "panic" }, file.display());
            return false;
        }
        good += usize::from(outcome.unwrap_or(false));
        count += 1;
    }
    println!("{name}: {count} changes, {good} of them still plans");
    true
}

/// Returns the flat as a document of ours.
fn document(domain: &d3dgen_model::domain::Domain) -> Vec<u8> {
    let bytes = std::fs::read(plans().join("flat.geojson")).expect("a plan of the tests");
    let source = Source { name: "flat.geojson", bytes: &bytes, companion: &|_| None };
    let Ok(Plan::Drawing(drawing)) = read(&source, &Options::default()) else { panic!("flat.geojson is a drawing") };
    let layout = lay_out(drawing, &Options::default()).expect("a flat");
    let types = vec!["bedroom".to_owned(); layout.rooms.len()];
    let (plan, _) = assemble(layout, &types, domain, 0, &Options::default());
    d3dgen_model::document::Document::to_json(&plan).into_bytes()
}

/// Returns the bytes with some of them exchanged, doubled, cut or made large numbers.
fn changed(original: &[u8], random: &mut ChaCha8Rng) -> Vec<u8> {
    const STRANGE: [&str; 10] = ["NaN", "1e308", "-1", "0", "99999999999", "\"", "<", "[[", "1e-9", "-"];
    let mut bytes = original.to_vec();
    for _ in 0..=random.next_u32() % 4 {
        let at = random.next_u64() as usize % bytes.len().max(1);
        let length = (random.next_u64() as usize % 40).min(bytes.len() - at);
        match random.next_u32() % 6 {
            0 => bytes[at..at + length.min(1)].fill(random.next_u32() as u8),
            1 => {
                let piece = bytes[at..at + length].to_vec();
                bytes.splice(at..at, piece);
            }
            2 => drop(bytes.drain(at..at + length)),
            3 => {
                let strange = STRANGE[random.next_u32() as usize % STRANGE.len()];
                bytes.splice(at..at, strange.bytes());
            }
            // another figure in the place of one
            4 => {
                if let Some(k) = bytes[at..].iter().position(u8::is_ascii_digit) {
                    bytes[at + k] = b'0' + (random.next_u32() % 10) as u8;
                }
            }
            _ => bytes.truncate(bytes.len() - length.min(bytes.len())),
        }
        if bytes.is_empty() {
            bytes.push(b' ');
        }
    }
    bytes
}
