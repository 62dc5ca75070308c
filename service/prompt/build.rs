//! Lists the files of `grammar/`, in the order of their names, which is the order of the steps.

use std::fmt::Write;
use std::path::PathBuf;

fn main() {
    let root = PathBuf::from(std::env::var("CARGO_MANIFEST_DIR").expect("cargo sets it")).join("grammar");
    println!("cargo::rerun-if-changed={}", root.display());
    let entries = std::fs::read_dir(&root).expect("grammar/ is part of the crate");
    let mut files: Vec<PathBuf> = entries.map(|e| e.expect("grammar/ is readable").path()).collect();
    files.retain(|f| f.extension().is_some_and(|e| e == "toml"));
    files.sort();
    let mut text = String::from("&[\n");
    for file in &files {
        let name = file.file_name().expect("it is a file").to_string_lossy();
        writeln!(text, "    ({name:?}, include_str!({:?})),", file.display().to_string()).expect("a string grows");
    }
    text.push_str("]\n");
    let out = PathBuf::from(std::env::var("OUT_DIR").expect("cargo sets it")).join("grammar.rs");
    std::fs::write(out, text).expect("OUT_DIR is writable");
}
