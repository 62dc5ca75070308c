//! Turns the bytes of a document (HTML, PDF, Markdown, plain text) into passages: what a reader sees, in order, with the
//! headings above it.
//!
//! What it is not for: getting the bytes (`fetch`) and finding rules in them (`extract`). Nothing that a document says is
//! followed: no link, no style sheet, no script, no include.

mod charset;
mod kind;

pub use kind::{Declared, Kind};

use serde::{Deserialize, Serialize};

/// What a passage is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PassageKind {
    /// One paragraph, or a part of a long one that ends with a sentence.
    Prose,
    /// Lines of cells with ` | ` between them; the first line is the head.
    Table,
    /// The sentence that leads in, if there is one, then one line an item, each beginning with `- `.
    List,
}

/// A piece of a document that can be understood and cited alone.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Passage {
    /// Made of what the passage says, so it stays when other parts of the document change; unique in its document.
    pub id: String,
    /// The headings above it, outermost first; a table's caption is the last.
    pub heading: Vec<String>,
    /// What it says.
    pub text: String,
    /// What it is made of.
    pub kind: PassageKind,
    /// The page it begins on, counting from 1, where the document has pages.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub page: Option<u32>,
    /// Where it begins, in bytes of [`Document::text`].
    pub offset: usize,
}

/// A document as read.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Document {
    /// The file or address it was read from, as the caller named it.
    pub name: String,
    /// What its bytes were read as.
    pub kind: Kind,
    /// Its own title (`<title>`, front matter, PDF information, first heading); `None` when it has none.
    pub title: Option<String>,
    /// The language: as declared by the document, else guessed from its words (`en`, `de`, `fr`, `es`, `it`, `nl`); `None`
    /// when there is too little text to say.
    pub language: Option<String>,
    /// Other facts that the document states about itself: `author`, `publisher`, `date`, `description`, `canonical`, and
    /// the keys of a Markdown file's front matter. Claims, not checked.
    pub meta: std::collections::BTreeMap<String, String>,
    /// What it says, in reading order.
    pub passages: Vec<Passage>,
    /// What was left out, or may have been read wrongly.
    pub warnings: Vec<String>,
}

impl Document {
    /// Returns the text of all passages with a blank line between them, which [`Passage::offset`] counts in.
    pub fn text(&self) -> String {
        self.passages.iter().map(|p| p.text.as_str()).collect::<Vec<_>>().join("\n\n")
    }
}
