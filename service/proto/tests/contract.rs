//! The proto files of documents are those of the schemas.

#[path = "../generator/mod.rs"]
mod generator;

use std::path::Path;

#[test]
fn proto_files_of_documents_are_fresh() {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    for (file, wanted) in generator::contract(&workspace).unwrap() {
        let found = std::fs::read_to_string(workspace.join("proto/d3dgen/v1").join(&file)).unwrap_or_default();
        assert!(found == wanted, "{file} is stale; run `cargo run -p d3dgen-proto --example update_contract`");
    }
}
