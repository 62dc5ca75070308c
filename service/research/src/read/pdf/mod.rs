//! PDF files, read in a process of their own: the library that reads them may fail, loop or take all memory on a bad file,
//! and must not take the caller with it.
//!
//! What it is not for: pictures of text (nothing is recognized), forms, and text that is only colored like its background:
//! the library does not say colors. Text outside of the page, and text too small to read, is left out.

mod child;
mod clean;
mod glyphs;
mod parent;
mod wire;

pub use child::run as run_child;
pub use parent::{Fault, Limits, Program};

use super::blocks::Reading;
use super::layout;

/// Returns the blocks of a PDF file.
pub(super) fn read(bytes: &[u8], program: &Program) -> Result<Reading, Fault> {
    let file = parent::ask(bytes, program)?;
    let mut reading = Reading { title: file.title, warnings: file.warnings, ..Reading::default() };
    for (key, value) in file.meta {
        reading.meta.insert(key, value);
    }
    if file.pages.iter().all(|p| p.lines.is_empty()) && !file.pages.is_empty() {
        reading.warnings.push("the pages have no text; if they are scanned, recognize their text first".into());
    }
    reading.blocks = layout::blocks(&clean::lines(file.pages));
    Ok(reading)
}
