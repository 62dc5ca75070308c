//! The schemas in `schemas/` are those of the types.

use d3dgen_tests::{schemas, workspace};

#[test]
fn schema_files_are_fresh_and_complete() {
    let wanted = schemas();
    for (path, text) in &wanted {
        let found = std::fs::read_to_string(path).unwrap_or_default();
        assert!(&found == text, "{} is stale; run `cargo run -p d3dgen-tests --bin update-schemas`", path.display());
    }
    let files = std::fs::read_dir(workspace().join("schemas")).unwrap();
    let names: Vec<_> =
        files.map(|f| f.unwrap().path()).filter(|p| p.extension().is_some_and(|e| e == "json")).collect();
    assert_eq!(names.len(), wanted.len(), "a schema file belongs to no document: {names:?}");
}
