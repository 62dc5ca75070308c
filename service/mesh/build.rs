//! Turns the shipped builds (`domains/builds/*.toml`) into lines of JSON, each behind its id and objects, so that the
//! program parses only what a world uses.

use std::path::{Path, PathBuf};

use serde_json::{Map, Value};

fn main() {
    let folder =
        PathBuf::from(std::env::var("CARGO_MANIFEST_DIR").expect("cargo sets it")).join("../../domains/builds");
    let out = PathBuf::from(std::env::var("OUT_DIR").expect("cargo sets it"));
    println!("cargo::rerun-if-changed={}", folder.display());
    let mut files: Vec<PathBuf> = std::fs::read_dir(&folder)
        .expect("domains/builds is part of the source")
        .filter_map(Result::ok)
        .map(|e| e.path())
        .filter(|p| p.extension().is_some_and(|x| x == "toml"))
        .collect();
    files.sort();
    let mut builds = Vec::new();
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        let table: Map<String, Value> = toml::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        for (key, value) in table {
            match (key.as_str(), value) {
                ("builds", Value::Array(list)) => builds.extend(list),
                _ => panic!("{}: `{key}` is unknown; the file holds [[builds]]", file.display()),
            }
        }
    }
    let line = |build: &Value| {
        let objects = build["for"].as_array().into_iter().flatten().filter_map(Value::as_str).collect::<Vec<_>>();
        let id = build["id"].as_str().unwrap_or_else(|| panic!("a build has no id: {build}"));
        format!("{id}\t{}\t{build}\n", objects.join(" "))
    };
    finishes(&out);
    std::fs::write(out.join("builds.txt"), builds.iter().map(line).collect::<String>()).expect("OUT_DIR is writable");
}

/// Turns the finishes (`domains/finishes/finishes.toml`) into JSON.
fn finishes(out: &Path) {
    let root = PathBuf::from(std::env::var("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    let file = root.join("../../domains/finishes/finishes.toml");
    println!("cargo::rerun-if-changed={}", file.display());
    let text = std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    let mut table: Map<String, Value> = toml::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    let list = table.remove("finishes").unwrap_or_else(|| panic!("{}: holds no [[finishes]]", file.display()));
    std::fs::write(out.join("finishes.json"), list.to_string()).expect("OUT_DIR is writable");
}
