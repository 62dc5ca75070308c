//! What the tests across crates and their helper commands share.
//!
//! The tests themselves are one binary, `suite/main.rs`; the times of the stages are in `benches/stages.rs`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use d3dgen_assets::annotation::Annotation;
use d3dgen_dataset::spec::Spec;
use d3dgen_eval::Evaluation;
use d3dgen_model::brief::Brief;
use d3dgen_model::document::Document;
use d3dgen_model::domain::Domain;
use d3dgen_model::edits::Edits;
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::knowledge::KnowledgeBase;
use d3dgen_model::placements::Placements;
use d3dgen_model::proposal::Proposal;
use d3dgen_model::report::Report;
use d3dgen_model::scenario::Scenario;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::world::World;
use sha2::{Digest, Sha256};

/// Returns the folder with the workspace's `Cargo.toml`.
pub fn workspace() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the crate lies in the workspace")
}

/// Returns where the schema of each document belongs, and its text.
pub fn schemas() -> Vec<(PathBuf, String)> {
    fn entry<D: Document>() -> (PathBuf, String) {
        let mut text = serde_json::to_string_pretty(&D::schema()).expect("a schema has string keys only");
        text.push('\n');
        (workspace().join("schemas").join(format!("{}.schema.json", D::KIND)), text)
    }
    vec![
        entry::<Domain>(),
        entry::<KnowledgeBase>(),
        entry::<Brief>(),
        entry::<SceneGraph>(),
        entry::<Floorplan>(),
        entry::<Placements>(),
        entry::<Scenario>(),
        entry::<World>(),
        entry::<Report>(),
        entry::<Proposal>(),
        entry::<Edits>(),
        entry::<Annotation>(),
        entry::<Evaluation>(),
        entry::<Spec>(),
    ]
}

/// Compares a text with a file of expected text; with `BLESS=1` in the environment the file is written instead.
///
/// # Panics
/// When they differ, with the first line that does.
pub fn golden(file: &Path, found: &str) {
    if std::env::var_os("BLESS").is_some_and(|v| v == "1") {
        let folder = file.parent().expect("a file lies in a folder");
        std::fs::create_dir_all(folder).and_then(|()| std::fs::write(file, found)).expect("goldens can be written");
        return;
    }
    let name = file.strip_prefix(workspace()).unwrap_or(file).display();
    let expected = std::fs::read_to_string(file).unwrap_or_default();
    if expected != found {
        let mut lines = expected.lines().chain([""]).zip(found.lines().chain([""])).enumerate();
        let (number, (was, is)) = lines.find(|(_, (a, b))| a != b).unwrap_or((0, ("", "")));
        panic!(
            "{name} differs in line {}:\n  expected {was}\n  found    {is}\nread the change, then bless it: BLESS=1 cargo test -p d3dgen-tests",
            number + 1
        );
    }
}

/// Returns the `d3dgen` program, built when it is stale.
///
/// # Panics
/// When it does not build.
pub fn program() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(|| {
        // Cargo builds a package's programs for its own tests only, so it is asked for this one.
        // For the workspace with all features, as the tests beside it are built: the crates below are then compiled once.
        let args = ["build", "-q", "--offline", "--workspace", "--bin", "d3dgen", "--all-features"];
        let format = ["--message-format", "json"];
        let built =
            Command::new(env!("CARGO")).args(args).args(format).current_dir(workspace()).output().expect("cargo runs");
        assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
        let messages = String::from_utf8_lossy(&built.stdout).into_owned();
        let mut program = messages.lines().filter_map(|line| {
            let message: serde_json::Value = serde_json::from_str(line).ok()?;
            message["executable"].as_str().map(PathBuf::from)
        });
        program.next_back().expect("cargo names the program it built")
    })
}

/// Returns the program without the knowledge database of whoever runs the tests; `--store` names another one.
///
/// # Panics
/// When it does not build.
pub fn command() -> Command {
    let mut command = Command::new(program());
    command.env("D3DGEN_STORE", "");
    command
}

/// Runs `d3dgen` in a folder.
///
/// # Panics
/// When it cannot be started.
pub fn run(folder: &Path, args: &[&str]) -> Output {
    command().args(args).current_dir(folder).output().expect("the program starts")
}

/// Runs `d3dgen` and returns its standard output.
///
/// # Panics
/// When it fails, with what it said.
pub fn run_well(folder: &Path, args: &[&str]) -> String {
    let output = run(folder, args);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "d3dgen {}: {said}", args.join(" "));
    String::from_utf8(output.stdout).expect("the program writes UTF-8")
}

/// Returns every file below a folder by relative path, with its bytes.
///
/// # Panics
/// When the folder cannot be read.
pub fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    fn walk(base: &Path, folder: &Path, found: &mut BTreeMap<String, Vec<u8>>) {
        for entry in std::fs::read_dir(folder).expect("a folder of ours") {
            let path = entry.expect("a folder of ours").path();
            if path.is_dir() {
                walk(base, &path, found);
            } else {
                let name = path.strip_prefix(base).expect("it lies below").to_string_lossy().into_owned();
                found.insert(name, std::fs::read(&path).expect("a file of ours"));
            }
        }
    }
    let mut found = BTreeMap::new();
    walk(folder, folder, &mut found);
    found
}

/// Returns the SHA-256 of bytes, hexadecimal.
pub fn digest(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect()
}
