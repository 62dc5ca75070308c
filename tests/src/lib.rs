//! What the tests across crates and their helper commands share.
//!
//! The tests themselves are one binary, `suite/main.rs`; the times of the stages are in `benches/stages.rs`.

use std::path::{Path, PathBuf};

use d3dgen_model::document::Document;
use d3dgen_model::domain::Domain;
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::knowledge::KnowledgeBase;
use d3dgen_model::placements::Placements;
use d3dgen_model::report::Report;
use d3dgen_model::scenario::Scenario;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::world::World;

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
        entry::<SceneGraph>(),
        entry::<Floorplan>(),
        entry::<Placements>(),
        entry::<Scenario>(),
        entry::<World>(),
        entry::<Report>(),
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
