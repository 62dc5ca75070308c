//! The README shows what its command makes.

use d3dgen_tests::{run_well, workspace};

/// Returns the words of a command line, those in quotes as one.
fn words(line: &str) -> Vec<String> {
    let mut out = Vec::new();
    for (k, part) in line.split('"').enumerate() {
        if k % 2 == 1 {
            out.push(part.to_owned());
        } else {
            out.extend(part.split_whitespace().map(str::to_owned));
        }
    }
    out
}

/// `BLESS=1` puts the picture that the command makes in place of the one that is shown.
#[test]
fn the_first_picture_is_what_the_first_command_makes() {
    let readme = std::fs::read_to_string(workspace().join("README.md")).unwrap();
    let command = readme.lines().find(|l| l.starts_with("cargo run --release -- generate")).expect("a first command");
    let (_, image) = readme.split_once("![").and_then(|(_, rest)| rest.split_once("](")).expect("a first picture");
    let shown = workspace().join(image.split(')').next().unwrap());
    let home = tempfile::tempdir().unwrap();
    let arguments = words(command.trim_start_matches("cargo run --release --"));
    run_well(home.path(), &arguments.iter().map(String::as_str).collect::<Vec<_>>());
    let out = arguments.iter().position(|a| a == "--out").map(|at| &arguments[at + 1]).expect("it names a folder");
    let made = std::fs::read(home.path().join(out).join("plan.png")).unwrap();
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&shown, &made).unwrap();
    }
    let there = std::fs::read(&shown).unwrap();
    assert!(made == there, "{} is not what `{command}` makes; BLESS=1 writes it anew", shown.display());
}
