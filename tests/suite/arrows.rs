//! The crates use each other only along the arrows of ARCHITECTURE.md, depend on nothing they do not use, and only the command
//! knows clock and environment.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

use d3dgen_tests::workspace;
use serde_json::Value;

/// What each crate may use. A new arrow is a decision: amend the list in ARCHITECTURE.md with it.
const ARROWS: &[(&str, &[&str])] = &[
    ("model", &[]),
    ("plugins", &["model"]),
    ("language", &[]),
    ("prompt", &["model", "plugins", "language"]),
    ("store", &[]),
    ("llm", &[]),
    ("knowledge", &["model", "store"]),
    ("mesh", &["model"]),
    ("assets", &["model", "store", "mesh"]),
    ("program", &["model", "plugins", "knowledge"]),
    ("floorplan", &["model", "knowledge"]),
    ("placement", &["model", "knowledge"]),
    ("scenario", &["model", "knowledge"]),
    ("check", &["model", "knowledge"]),
    ("crowd", &["model"]),
    (
        "pipeline",
        &["model", "plugins", "knowledge", "plans", "prompt", "program", "floorplan", "placement", "scenario", "check"],
    ),
    ("export", &["model", "mesh"]),
    ("eval", &["model"]),
    ("physics", &["mesh", "export"]),
    ("plans", &["model"]),
    ("research", &["model", "llm"]),
    ("propose", &["model", "llm", "plugins", "knowledge", "pipeline"]),
    ("dataset", &["model", "plugins", "pipeline", "export", "eval", "physics"]),
    ("proto", &["model"]),
    (
        "server",
        &[
            "model",
            "store",
            "plugins",
            "knowledge",
            "mesh",
            "assets",
            "pipeline",
            "plans",
            "export",
            "crowd",
            "research",
            "dataset",
            "proto",
        ],
    ),
    (
        "cli",
        &[
            "model",
            "store",
            "llm",
            "plugins",
            "knowledge",
            "mesh",
            "assets",
            "pipeline",
            "prompt",
            "plans",
            "export",
            "crowd",
            "eval",
            "research",
            "propose",
            "dataset",
            "physics",
            "proto",
            "server",
        ],
    ),
    ("tests", &["model", "assets", "dataset", "plugins", "knowledge", "pipeline", "export", "eval"]),
];

/// Other people's file formats and protocols, and the crates that may know them.
const OUTSIDE: &[(&str, &[&str])] = &[
    ("image", &["assets", "mesh"]),
    ("png", &["export", "mesh", "plans"]),
    ("resvg", &["export"]),
    ("pdf-writer", &["export"]),
    ("svgtypes", &["export", "plans"]),
    ("ttf-parser", &["export"]),
    ("openusd", &["assets"]),
    ("redb", &["store"]),
    ("sled", &["store"]),
    ("tantivy", &["store"]),
    ("hnsw_rs", &["store"]),
    ("fastembed", &["store"]),
    ("ort", &["store"]),
    ("roxmltree", &["assets", "plans"]),
    ("serde-saphyr", &["assets", "plans"]),
    ("reqwest", &["llm", "research"]),
    ("async-nats", &["dataset"]),
    ("object_store", &["dataset"]),
    ("parquet", &["dataset"]),
    ("tar", &["dataset"]),
    ("scraper", &["research"]),
    ("pdf-extract", &["research"]),
    ("tonic", &["proto", "server", "cli"]),
    ("prost", &["proto", "server", "cli"]),
    ("axum", &["server"]),
    ("hyper", &[]),
    ("tokio-rustls", &["server", "cli"]),
    ("clap", &["cli"]),
    ("indicatif", &["cli"]),
    ("ctrlc", &["cli"]),
];

/// Returns the packages of the workspace with the packages each uses, development aside.
fn packages() -> BTreeMap<String, (PathBuf, BTreeSet<String>)> {
    packages_with(|dependency| dependency["kind"] != "dev")
}

/// Returns the packages of the workspace with all that each uses, under the names it uses them by.
fn dependencies() -> BTreeMap<String, (PathBuf, BTreeSet<String>)> {
    packages_with(|_| true)
}

fn packages_with(counts: impl Fn(&Value) -> bool) -> BTreeMap<String, (PathBuf, BTreeSet<String>)> {
    let args = ["metadata", "--format-version", "1", "--no-deps", "--offline"];
    let output = Command::new(env!("CARGO")).args(args).current_dir(workspace()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    let text = |v: &Value| v.as_str().unwrap_or_default().to_owned();
    let package = |p: &Value| {
        let used = p["dependencies"].as_array().unwrap().iter().filter(|d| counts(d));
        let folder = Path::new(p["manifest_path"].as_str().unwrap()).parent().unwrap().to_path_buf();
        let called = |d: &Value| text(if d["rename"].is_string() { &d["rename"] } else { &d["name"] });
        (text(&p["name"]).replace("d3dgen-", ""), (folder, used.map(called).collect()))
    };
    metadata["packages"].as_array().unwrap().iter().map(package).collect()
}

#[test]
fn crates_use_each_other_along_the_arrows_only() {
    let packages = packages();
    assert_eq!(packages.keys().map(String::as_str).collect::<BTreeSet<_>>(), ARROWS.iter().map(|a| a.0).collect());
    for (name, allowed) in ARROWS {
        let used: BTreeSet<&str> = packages[*name].1.iter().filter_map(|u| u.strip_prefix("d3dgen-")).collect();
        for used in &used {
            assert!(allowed.contains(used), "{name} uses {used}; the arrows allow only {allowed:?}");
        }
        for arrow in *allowed {
            assert!(used.contains(arrow), "{name} does not use {arrow}: no such arrow");
        }
    }
}

#[test]
fn the_map_shows_these_arrows_and_no_others() {
    let map = std::fs::read_to_string(workspace().join("ARCHITECTURE.md")).unwrap();
    let (_, after) = map.split_once("Arrows between crates").expect("the map has its arrows");
    let block = after.split("```").nth(1).expect("a block of arrows");
    let names = |side: &str| -> Vec<String> {
        side.trim_matches(['{', '}', ' ']).split(',').map(|n| n.trim().to_owned()).filter(|n| !n.is_empty()).collect()
    };
    let mut shown: BTreeSet<(String, String)> = BTreeSet::new();
    // several stand on a line, with space between
    for arrow in block.lines().flat_map(|l| l.split("   ")).map(str::trim).filter(|a| !a.is_empty()) {
        let (used, by) = arrow.split_once("<-").unwrap_or_else(|| panic!("`{arrow}` is no arrow"));
        for by in names(by) {
            assert!(names(used).into_iter().all(|used| shown.insert((by.clone(), used))), "`{arrow}` says it again");
        }
    }
    // the tests are no part of the program
    let arrows = ARROWS.iter().filter(|(by, _)| *by != "tests");
    let there = arrows.flat_map(|(by, used)| used.iter().map(|used| ((*by).to_owned(), (*used).to_owned()))).collect();
    assert_eq!(shown, there);
}

#[test]
fn formats_and_protocols_stay_where_they_belong() {
    for (name, (_, used)) in packages() {
        for (outside, homes) in OUTSIDE {
            assert!(!used.contains(*outside) || homes.contains(&name.as_str()), "{name} uses {outside}");
        }
    }
}

#[test]
fn only_the_command_reads_clock_and_environment() {
    const FORBIDDEN: &[&str] = &["std::env", "env::var", "SystemTime", "Instant::now", "std::net", "thread_rng"];
    // Crates that speak to the network know addresses, and measure how long an answer took; the date stays outside.
    const NETWORK: &[&str] = &["llm", "research", "server"];
    fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                sources(&path, found);
            } else if path.extension().is_some_and(|e| e == "rs") && path.file_name().is_some_and(|n| n != "tests.rs") {
                found.push(path);
            }
        }
    }
    for (name, (folder, _)) in packages() {
        if name == "cli" || name == "tests" {
            continue;
        }
        let mut files = Vec::new();
        sources(&folder.join("src"), &mut files);
        assert!(!files.is_empty(), "{name} has no sources");
        for file in files {
            let text = std::fs::read_to_string(&file).unwrap();
            let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
            for word in FORBIDDEN {
                if NETWORK.contains(&name.as_str()) && matches!(*word, "Instant::now" | "std::net") {
                    continue;
                }
                assert!(!code.contains(word), "{} uses {word}", file.display());
            }
        }
    }
}

/// Adds all that a folder's Rust files say.
fn add_code_below(folder: &Path, code: &mut String) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            add_code_below(&path, code);
        } else if path.extension().is_some_and(|e| e == "rs") {
            code.push_str(&std::fs::read_to_string(&path).unwrap());
        }
    }
}

#[test]
fn nothing_is_depended_on_that_no_code_names() {
    let mut named = BTreeSet::new();
    for (name, (folder, used)) in dependencies() {
        let mut code = String::new();
        add_code_below(&folder, &mut code);
        let is_letter = |c: char| c.is_alphanumeric() || c == '_';
        let words: BTreeSet<&str> = code.split(|c| !is_letter(c)).collect();
        for crate_name in used {
            assert!(
                words.contains(crate_name.replace('-', "_").as_str()),
                "{name} names {crate_name} nowhere in its code"
            );
            named.insert(crate_name);
        }
    }
    let manifest = std::fs::read_to_string(workspace().join("Cargo.toml")).unwrap();
    let listed = manifest.split("[workspace.dependencies]").nth(1).unwrap().split("\n[").next().unwrap();
    for line in listed.lines().filter(|l| l.contains('=')) {
        let crate_name = line.split(['=', '.']).next().unwrap().trim();
        assert!(named.contains(crate_name), "the workspace lists {crate_name}, which no crate of it uses");
    }
}
