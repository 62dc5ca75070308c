//! Turns the shipped domains into one JSON text each, with what they have in common, so that the program starts without parsing TOML.

// The same merge that reads a custom folder at run time.
#[path = "src/merge.rs"]
mod merge;

use std::path::PathBuf;

fn main() {
    let root = PathBuf::from(std::env::var("CARGO_MANIFEST_DIR").expect("cargo sets it")).join("../domains");
    let out = PathBuf::from(std::env::var("OUT_DIR").expect("cargo sets it"));
    println!("cargo::rerun-if-changed={}", root.display());
    let common = merge::common_folder(&root.join("common")).unwrap_or_else(|e| panic!("domains/common: {e}"));
    std::fs::write(out.join("common.json"), common.to_string()).expect("OUT_DIR is writable");
    for id in ["residential", "office", "hospital", "school", "warehouse", "general"] {
        let merged = merge::domain_folder(&root.join(id), &common).unwrap_or_else(|e| panic!("domain {id}: {e}"));
        std::fs::write(out.join(format!("{id}.json")), merged.table.to_string()).expect("OUT_DIR is writable");
    }
}
