//! Fuzzes every reader: small models changed at random, each read in a process with limits, as the program does it.
//!
//!     cargo test -p d3dgen-assets --test fuzz [-- --seconds 60 [--seed 7]]
//!
//! The readers of this crate must not panic; the library that reads USD may, as long as its process is all that suffers.
//! A change that a reader does not survive is written to `target/fuzz/` with the name of its reader and its seed.

mod packing;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use d3dgen_assets::readers::{Limits, Program, Worker, run_child};
use rand_chacha::ChaCha8Rng;
use rand_core::{Rng, SeedableRng};

/// The readers with the models that are changed; the first word is the ending of the changed file.
const TARGETS: &[(&str, &[&str])] = &[
    ("usda", &["chair.usda", "rig.usda", "shelf.usda"]),
    ("usdc", &["chair.usda", "rig.usda"]),
    ("usdz", &["chair.usda"]),
    ("gltf", &["chair.gltf"]),
    ("glb", &["chair.gltf"]),
    ("obj", &["table.obj"]),
    ("mtl", &["table.mtl"]),
    ("dae", &["lamp.dae"]),
    ("stl", &["wedge.stl"]),
    ("sdf", &["cart/model.sdf"]),
];
/// A file must be answered within this time.
const TIME: Duration = Duration::from_secs(6);

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    if let Some(at) = arguments.iter().position(|a| a == "--child") {
        let memory = arguments.get(at + 1).and_then(|m| m.parse().ok()).expect("the memory stands behind --child");
        run_child(std::io::stdin(), std::io::stdout(), memory).expect("pipes of the parent");
        return;
    }
    // What `cargo test -- --list` and names of tests ask for is not meant for this one.
    if arguments.iter().any(|a| a == "--list") {
        return;
    }
    let option =
        |name: &str| arguments.iter().position(|a| a == name).and_then(|at| arguments.get(at + 1)?.parse().ok());
    let seconds: u64 = option("--seconds").unwrap_or(9);
    let seed: u64 = option("--seed").unwrap_or(1);
    let each = Duration::from_millis(seconds * 1000 / TARGETS.len() as u64);
    let failed: usize = TARGETS.iter().map(|(ending, models)| fuzz(ending, models, each, seed)).sum();
    println!("test result: {}. {} passed; {failed} failed", if failed == 0 { "ok" } else { "FAILED" }, TARGETS.len());
    std::process::exit(i32::from(failed > 0));
}

fn models() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models")
}

/// Fuzzes one reader for a time; returns 1 when it failed.
fn fuzz(ending: &str, models_of: &[&str], time: Duration, seed: u64) -> usize {
    let folder = tempfile::tempdir().expect("a temporary folder");
    copy(&models(), folder.path());
    let path = std::env::current_exe().expect("this program has a file");
    let limits = Limits { time: TIME, ..Limits::default() };
    let mut worker = Worker::new(Program { path, arguments: vec!["--child".into()], limits });
    let seeds: Vec<Vec<u8>> = models_of.iter().map(|m| packed(ending, &models().join(m))).collect();
    let (changed, read) = match ending {
        "mtl" => (folder.path().join("table.mtl"), folder.path().join("table.obj")),
        "sdf" => (folder.path().join("cart/model.sdf"), folder.path().join("cart/model.sdf")),
        _ => (folder.path().join(format!("changed.{ending}")), folder.path().join(format!("changed.{ending}"))),
    };
    let begun = Instant::now();
    let (mut count, mut accepted, mut lost, mut bad) = (0u64, 0u64, 0u64, Vec::new());
    for (index, model) in seeds.iter().enumerate() {
        std::fs::write(&changed, model).expect("the temporary folder takes files");
        let result = worker.read(&read, Some(folder.path())).expect("the child starts");
        assert!(result.is_ok(), "{ending} {index}: the model as it is: {:?}", result.err());
    }
    while begun.elapsed() < time {
        let mut random = ChaCha8Rng::seed_from_u64(seed.wrapping_mul(1_000_003).wrapping_add(count));
        let mut bytes = seeds[random.next_u32() as usize % seeds.len()].clone();
        for _ in 0..1 + random.next_u32() % 6 {
            change(&mut bytes, &seeds, &mut random);
        }
        std::fs::write(&changed, &bytes).expect("the temporary folder takes files");
        let result = worker.read(&read, Some(folder.path())).expect("the child starts");
        count += 1;
        let Err(refusal) = result else {
            accepted += 1;
            continue;
        };
        let slow = refusal.reason.starts_with("takes more than");
        let ended = slow || refusal.reason.contains("or is damaged so that its reader breaks");
        lost += u64::from(ended);
        let panicked = refusal.reason.contains("in a way that is not understood");
        // The library for USD is not ours; that its process ends is what the process is for.
        let ours = !ending.starts_with("usd");
        if ours && (ended || panicked) {
            bad.push((bytes, refusal.reason));
        }
        if bad.len() > 3 {
            break;
        }
    }
    println!("fuzz {ending:5} {count:7} changes, {accepted} read, {lost} processes lost, {} failures", bad.len());
    for (index, (bytes, reason)) in bad.iter().enumerate() {
        let kept = keep(&format!("{ending}-{seed}-{index}.{ending}"), bytes);
        println!("  {}: {reason}", kept.display());
    }
    usize::from(!bad.is_empty())
}

fn keep(name: &str, bytes: &[u8]) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fuzz");
    std::fs::create_dir_all(&folder).expect("the target folder takes folders");
    let path = folder.join(name);
    std::fs::File::create(&path).and_then(|mut f| f.write_all(bytes)).expect("the target folder takes files");
    path
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).expect("the temporary folder takes folders");
    for entry in std::fs::read_dir(from).expect("the models are there").flatten() {
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &target);
        } else {
            std::fs::copy(entry.path(), target).expect("the temporary folder takes files");
        }
    }
}

/// Returns a model in the packing of its ending.
fn packed(ending: &str, path: &Path) -> Vec<u8> {
    let bytes = std::fs::read(path).expect("the models are there");
    match ending {
        "glb" => packing::glb(&bytes),
        "usdc" => binary(path),
        "usdz" => packing::zip(&[("chair.usda", &bytes)]),
        _ => bytes,
    }
}

/// Returns a layer of text as a binary one.
fn binary(path: &Path) -> Vec<u8> {
    use openusd::{ar, sdf, usdc};
    let format = sdf::LayerRegistry::find_by_id("usda").expect("the library reads text");
    let layer = format.read(&ar::DefaultResolver::new(), &ar::ResolvedPath::new(path)).expect("the models are sound");
    let mut out = std::io::Cursor::new(Vec::new());
    usdc::CrateWriter::write(layer.as_ref(), &mut out).expect("memory takes bytes");
    out.into_inner()
}

/// Changes bytes at random: cut, flipped, spliced, doubled, and numbers exchanged for those that break things.
fn change(bytes: &mut Vec<u8>, seeds: &[Vec<u8>], random: &mut ChaCha8Rng) {
    const NUMBERS: &[&str] = &[
        "0",
        "-1",
        "1e38",
        "-1e300",
        "nan",
        "inf",
        "2147483647",
        "-2147483648",
        "4294967296",
        "18446744073709551615",
        "99999999999999999999",
        "0.0000000001",
        "1e-44",
        "",
    ];
    const TOKENS: &[&str] = &[
        "(", ")", "[", "]", "{", "}", "\"", "'", "@", "<", ">", "/", "&", "\0", "\n", "\u{feff}", "../", "#", "é", ",",
        "=",
    ];
    let length = bytes.len();
    let mut pick = |below: usize| if below == 0 { 0 } else { random.next_u64() as usize % below };
    match pick(9) {
        0 => bytes.truncate(pick(length + 1)),
        1 => (0..1 + pick(8)).for_each(|_| {
            let at = pick(length);
            if let Some(byte) = bytes.get_mut(at) {
                *byte ^= 1 << pick(8);
            }
        }),
        2 => {
            let at = pick(length + 1);
            let token = TOKENS[pick(TOKENS.len())];
            bytes.splice(at..at, token.bytes());
        }
        3 => {
            let other = &seeds[pick(seeds.len())];
            let (from, at) = (pick(other.len()), pick(length + 1));
            let part = other[from..(from + pick(200)).min(other.len())].to_vec();
            bytes.splice(at..at, part);
        }
        4 => {
            let from = pick(length);
            let part = bytes[from..(from + pick(400)).min(length)].to_vec();
            (0..1 + pick(20)).for_each(|_| drop(bytes.splice(from..from, part.iter().copied())));
        }
        5 => {
            let from = pick(length);
            let to = (from + pick(60)).min(length);
            drop(bytes.drain(from..to));
        }
        _ => {
            // One of the numbers of the text.
            let digit = |b: &u8| b.is_ascii_digit();
            let from = pick(length);
            if let Some(at) = bytes.iter().skip(from).position(digit).map(|p| p + from) {
                let rest = bytes[at..].iter().take_while(|b| digit(b) || **b == b'.').count();
                let number = NUMBERS[pick(NUMBERS.len())];
                bytes.splice(at..at + rest, number.bytes());
            }
        }
    }
    bytes.truncate(1 << 20);
}
