//! Writes the proto files of documents anew from `schemas/`; see `proto/documents.toml`.

#[path = "../generator/mod.rs"]
mod generator;

use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    for (file, text) in generator::contract(&workspace)? {
        std::fs::write(workspace.join("proto/d3dgen/v1").join(&file), text)?;
        eprintln!("wrote {file}");
    }
    Ok(())
}
