//! Writes `schemas/*.schema.json` anew from the types of `d3dgen-model`.

use std::io;

fn main() -> io::Result<()> {
    for (path, text) in d3dgen_tests::schemas() {
        std::fs::write(&path, text)?;
        eprintln!("wrote {}", path.display());
    }
    Ok(())
}
