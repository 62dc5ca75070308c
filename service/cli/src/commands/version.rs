//! `d3dgen version`: this release and what it reads.

use crate::error::Error;
use crate::input::write_text;

pub fn run() -> Result<(), Error> {
    let formats: Vec<&str> = d3dgen_export::exporters::all().iter().map(|e| e.name()).collect();
    write_text(
        None,
        &format!("d3dgen {}\ndocuments: version 1\nformats: {}\n", env!("CARGO_PKG_VERSION"), formats.join(", ")),
    )
}
