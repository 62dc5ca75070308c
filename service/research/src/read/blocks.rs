//! What every reader makes of a document before it becomes passages: headings, paragraphs, lists and tables in order.
//!
//! What it is not for: deciding where a passage begins and ends; that is `passages`.

use std::collections::BTreeMap;

/// One block of a document.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// A heading; level 1 is the outermost.
    Heading { level: u8, text: String },
    /// A paragraph.
    Prose(String),
    /// Items with their depth, 0 for the outermost.
    List(Vec<(usize, String)>),
    /// A table; `head` is empty when no row is one.
    Table { caption: Option<String>, head: Vec<String>, rows: Vec<Vec<String>> },
}

/// A document as its reader understood it.
#[derive(Debug, Default)]
pub struct Reading {
    /// What it calls itself.
    pub title: Option<String>,
    /// The language it declares, as a lower-case primary tag.
    pub language: Option<String>,
    /// Other facts about itself.
    pub meta: BTreeMap<String, String>,
    /// Blocks in reading order, each with its page where there are pages.
    pub blocks: Vec<(Option<u32>, Block)>,
    /// What was left out.
    pub warnings: Vec<String>,
}

impl Reading {
    /// Adds a block of a document without pages.
    pub fn push(&mut self, block: Block) {
        self.blocks.push((None, block));
    }
}

/// Returns a text with every run of white space as one space, without soft hyphens, zero-width characters, marks of text
/// direction and control characters: what is invisible must not split a word or hide one.
pub fn tidy(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\u{ad}' | '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{2069}' | '\u{feff}' => {}
            // Letters that are never drawn, made to carry text past readers.
            '\u{e0000}'..='\u{e007f}' => {}
            c if c.is_whitespace() => {
                if !out.is_empty() && !out.ends_with(' ') {
                    out.push(' ');
                }
            }
            c if c.is_control() => {}
            c => out.push(c),
        }
    }
    out.truncate(out.trim_end().len());
    out
}

/// Returns a declared language as its lower-case primary tag: `de-AT` is `de`.
pub fn primary_tag(text: &str) -> Option<String> {
    let tag = text.trim().split(['-', '_']).next().unwrap_or_default().to_ascii_lowercase();
    ((2..=3).contains(&tag.len()) && tag.bytes().all(|b| b.is_ascii_lowercase())).then_some(tag)
}
