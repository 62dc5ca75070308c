//! Tells what the bytes of a document are, from its first bytes, its content type and its name, in this order.
//!
//! What it is not for: reading them, or finding out their charset.

use serde::{Deserialize, Serialize};

/// The kinds of documents that can be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// HTML or XHTML.
    Html,
    /// PDF.
    Pdf,
    /// Markdown.
    Markdown,
    /// Plain text.
    Text,
}

/// What a content type says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Declared {
    /// A kind that can be read.
    Is(Kind),
    /// Nothing: there is no content type, or it is one for any bytes.
    Unknown,
    /// Something that cannot be read.
    Unsupported,
}

/// Content types, and what they are.
const TYPES: &[(&str, Kind)] = &[
    ("text/html", Kind::Html),
    ("application/xhtml+xml", Kind::Html),
    ("application/pdf", Kind::Pdf),
    ("application/x-pdf", Kind::Pdf),
    ("text/markdown", Kind::Markdown),
    ("text/x-markdown", Kind::Markdown),
    ("text/plain", Kind::Text),
];

/// Content types that servers send when they know nothing.
const ANY: &[&str] =
    &["", "application/octet-stream", "binary/octet-stream", "application/download", "unknown/unknown"];

/// Endings of names.
const ENDINGS: &[(&str, Kind)] = &[
    ("html", Kind::Html),
    ("htm", Kind::Html),
    ("xhtml", Kind::Html),
    ("pdf", Kind::Pdf),
    ("md", Kind::Markdown),
    ("markdown", Kind::Markdown),
    ("txt", Kind::Text),
    ("text", Kind::Text),
];

/// First bytes of files that are no documents, with what they are.
const OTHERS: &[(&[u8], &str)] = &[
    (b"PK\x03\x04", "a ZIP archive or an office file; save it as PDF, HTML or text"),
    (b"PK\x05\x06", "a ZIP archive"),
    (b"\x1f\x8b", "a gzip file; unpack it"),
    (b"\x89PNG", "a picture"),
    (b"\xff\xd8\xff", "a picture"),
    (b"GIF8", "a picture"),
    (b"\x7fELF", "a program"),
    (b"MZ\x90", "a program"),
    (b"7z\xbc\xaf", "an archive"),
    (b"Rar!", "an archive"),
    (b"\xd0\xcf\x11\xe0", "an old office file; save it as PDF, HTML or text"),
    (b"{\\rtf", "an RTF file; save it as PDF, HTML or text"),
];

impl Kind {
    /// Returns what a `Content-Type` header says, its parameters aside.
    pub fn declared(content_type: Option<&str>) -> Declared {
        let essence =
            content_type.unwrap_or_default().split(';').next().unwrap_or_default().trim().to_ascii_lowercase();
        if ANY.contains(&essence.as_str()) {
            return Declared::Unknown;
        }
        TYPES.iter().find(|(t, _)| *t == essence).map_or(Declared::Unsupported, |(_, kind)| Declared::Is(*kind))
    }

    /// Returns what a document is.
    ///
    /// # Errors
    ///
    /// A sentence that says why it is none of the known kinds.
    pub fn of(bytes: &[u8], content_type: Option<&str>, name: &str) -> Result<Self, String> {
        let head = bytes.get(..1024.min(bytes.len())).unwrap_or_default();
        if head.windows(5).any(|w| w == b"%PDF-") {
            return Ok(Self::Pdf);
        }
        if let Some((_, what)) = OTHERS.iter().find(|(magic, _)| bytes.starts_with(magic)) {
            return Err(format!("is {what}"));
        }
        let declared = Self::declared(content_type);
        let ending = || {
            let path = name.split(['?', '#']).next().unwrap_or_default();
            let ending = path.rsplit_once('.').map(|(_, e)| e.to_ascii_lowercase())?;
            ENDINGS.iter().find(|(e, _)| *e == ending).map(|(_, kind)| *kind)
        };
        let kind = match declared {
            Declared::Unsupported => {
                return Err(format!("is {}, not HTML, PDF, Markdown or text", content_type.unwrap_or("unknown")));
            }
            // Servers send Markdown and raw HTML files as plain text; the name knows better.
            Declared::Is(Self::Text) => ending().filter(|k| *k != Self::Pdf).unwrap_or(Self::Text),
            Declared::Is(kind) => kind,
            Declared::Unknown => {
                ending().unwrap_or_else(|| if looks_like_html(head) { Self::Html } else { Self::Text })
            }
        };
        if kind == Self::Pdf {
            return Err("is called PDF but does not begin like one".into());
        }
        if is_binary(head) {
            return Err("is no text: it has control characters in its first bytes".into());
        }
        Ok(kind)
    }
}

fn looks_like_html(head: &[u8]) -> bool {
    let text = String::from_utf8_lossy(head).to_ascii_lowercase();
    let text = text.trim_start_matches(['\u{feff}', ' ', '\t', '\r', '\n']);
    ["<!doctype html", "<html", "<head", "<body", "<?xml"].iter().any(|s| text.starts_with(s))
}

/// Tells whether bytes are no text in any charset. UTF-16 has a zero in every second place, which is no sign of it.
fn is_binary(head: &[u8]) -> bool {
    if super::charset::utf16_of(head).is_some() {
        return false;
    }
    let strange = head.iter().filter(|b| matches!(b, 0..=8 | 14..=26 | 28..=31)).count();
    strange * 20 > head.len()
}
