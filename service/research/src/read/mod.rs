//! Turns the bytes of a document (HTML, PDF, Markdown, plain text) into passages: what a reader sees, in order, with the
//! headings above it.
//!
//! What it is not for: getting the bytes (`fetch`) and finding rules in them (`extract`). Nothing that a document says is
//! followed: no link, no style sheet, no script, no include.

mod blocks;
mod charset;
mod html;
mod kind;
mod language;
mod layout;
mod markdown;
mod passages;
pub mod pdf;
mod text;

pub use kind::{Declared, Kind};

use serde::{Deserialize, Serialize};

use crate::Error;
use blocks::Reading;

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

/// How documents are read.
#[derive(Debug, Clone)]
pub struct Options {
    /// The program that reads PDF files in a process of its own; without it PDF files are refused.
    pub pdf: Option<pdf::Program>,
    /// The most bytes that a document may have.
    pub max_bytes: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { pdf: None, max_bytes: 64 << 20 }
    }
}

/// Returns what a document says. `content_type` is the header it came with, if any; `name` (file name or URL) appears in
/// errors, and its ending helps to tell what the bytes are.
///
/// # Errors
///
/// [`Error::Read`] when the bytes are no document of a known kind, are too many, or cannot be read.
pub fn read(bytes: &[u8], content_type: Option<&str>, name: &str, options: &Options) -> Result<Document, Error> {
    let fail = |code: &'static str, reason: String| Error::Read { name: name.to_owned(), code, reason };
    if bytes.len() > options.max_bytes {
        let reason = format!("has {} bytes, the limit is {}", bytes.len(), options.max_bytes);
        return Err(fail("too_large", reason));
    }
    let kind = Kind::of(bytes, content_type, name).map_err(|reason| fail("unsupported_type", reason))?;
    let reading = match kind {
        Kind::Pdf => {
            let Some(program) = &options.pdf else {
                return Err(fail("pdf_unavailable", "PDF files need the program that reads them; none is set".into()));
            };
            pdf::read(bytes, program).map_err(|fault| fail(fault.code(), fault.to_string()))?
        }
        Kind::Html => with_text(bytes, content_type, kind, html::read),
        Kind::Markdown => with_text(bytes, content_type, kind, markdown::read),
        Kind::Text => with_text(bytes, content_type, kind, text::read),
    };
    Ok(passages::document(name, kind, reading))
}

fn with_text(bytes: &[u8], content_type: Option<&str>, kind: Kind, read: impl Fn(&str) -> Reading) -> Reading {
    let decoded = charset::decode(bytes, content_type, kind == Kind::Html);
    let mut reading = read(&decoded.text);
    reading.warnings.splice(0..0, decoded.warnings);
    reading
}
