//! Turns the shipped builds (`domains/builds/*.toml`) into one JSON text, so that the program starts without parsing TOML.

use std::path::PathBuf;

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
    std::fs::write(out.join("builds.json"), Value::Array(builds).to_string()).expect("OUT_DIR is writable");
}
