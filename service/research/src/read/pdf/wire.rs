//! What the process that reads a PDF file tells the one that started it.
//!
//! What it is not for: other programs; both sides are always the same release.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// Stands before the answer, which the library's own prints may come before; the length in bytes and a line end follow.
pub const MARK: &str = "\u{1}d3dgen-pdf-answer ";

/// The answer.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Answer {
    /// What the file says.
    File(File),
    /// Why it cannot be read.
    Failed(String),
}

/// A file as its pages show it.
#[derive(Debug, Default, Serialize, Deserialize)]
pub struct File {
    pub title: Option<String>,
    pub meta: BTreeMap<String, String>,
    pub pages: Vec<Page>,
    pub warnings: Vec<String>,
}

/// A page; positions are in points from its upper left corner.
#[derive(Debug, Default, Serialize, Deserialize)]
pub struct Page {
    pub number: u32,
    pub height: f32,
    pub lines: Vec<Printed>,
}

/// A printed line.
#[derive(Debug, Serialize, Deserialize)]
pub struct Printed {
    /// Where its letters stand.
    pub y: f32,
    pub size: f32,
    /// From, to and text of the words between wide gaps.
    pub cells: Vec<(f32, f32, String)>,
}
