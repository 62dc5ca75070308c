//! Blocks to passages: which piece of a document is cited alone, under which headings, and what it is called.
//!
//! What it is not for: any format of documents.

use std::collections::BTreeMap;

use data_encoding::HEXLOWER;
use sha2::{Digest, Sha256};

use super::blocks::{Block, Reading, tidy};
use super::{Document, Kind, Passage, PassageKind, language};

/// A paragraph longer than this is divided between sentences, so that a citation shows the rule and not a page.
const LONG_PROSE: usize = 1800;
/// A table or list longer than this is divided between rows; the head or lead-in is repeated.
const LONG_ROWS: usize = 4000;
/// A heading or title is cut here.
const LONG_HEADING: usize = 300;

/// Returns the document that a reader found.
pub fn document(name: &str, kind: Kind, reading: Reading) -> Document {
    let Reading { title, language: declared, meta, blocks, mut warnings } = reading;
    let first_heading = blocks.iter().find_map(|(_, b)| match b {
        Block::Heading { text, .. } => Some(cut(&tidy(text), LONG_HEADING)),
        _ => None,
    });
    let title = title.map(|t| cut(&tidy(&t), LONG_HEADING)).filter(|t| !t.is_empty()).or(first_heading);
    let mut maker = Maker::default();
    blocks.into_iter().for_each(|(page, block)| maker.block(page, block));
    maker.lead_in();
    let passages = maker.passages;
    if passages.is_empty() {
        warnings.push("no text was found".into());
    }
    let guessed = language::guess(passages.iter().map(|p| p.text.as_str()));
    // Templates declare English for pages in any language; many words outweigh one attribute.
    if let (Some(d), Some(g)) = (&declared, &guessed)
        && d != g
    {
        warnings.push(format!("declares the language {d}; its words are {g}"));
    }
    Document { name: name.to_owned(), kind, title, language: guessed.or(declared), meta, passages, warnings }
}

#[derive(Default)]
struct Maker {
    headings: Vec<(u8, String)>,
    /// A paragraph that ends with a colon waits for the list or table it leads into.
    waiting: Option<(Option<u32>, String)>,
    passages: Vec<Passage>,
    seen: BTreeMap<String, usize>,
    offset: usize,
}

impl Maker {
    fn block(&mut self, page: Option<u32>, block: Block) {
        match block {
            Block::Heading { level, text } => {
                self.lead_in();
                let text = cut(&tidy(&text), LONG_HEADING);
                if !text.is_empty() {
                    self.headings.retain(|(l, _)| *l < level);
                    self.headings.push((level, text));
                }
            }
            Block::Prose(text) => {
                self.lead_in();
                let text = tidy(&text);
                if text.ends_with(':') && text.len() < LONG_PROSE {
                    self.waiting = Some((page, text));
                } else {
                    divided(&text)
                        .into_iter()
                        .for_each(|part| self.add(page, PassageKind::Prose, None, part.to_owned()));
                }
            }
            Block::List(items) => self.list(page, &items),
            Block::Table { caption, head, rows } => self.table(page, caption, &head, rows),
        }
    }

    /// Lets a waiting paragraph stand alone.
    fn lead_in(&mut self) {
        if let Some((page, text)) = self.waiting.take() {
            self.add(page, PassageKind::Prose, None, text);
        }
    }

    fn list(&mut self, page: Option<u32>, items: &[(usize, String)]) {
        let lines = items.iter().filter_map(|(depth, text)| {
            let text = tidy(text);
            let indent = "  ".repeat((*depth).min(8));
            (!text.is_empty()).then(|| format!("{indent}- {text}"))
        });
        let (page, lead) = match self.waiting.take() {
            Some((lead_page, lead)) => (lead_page.or(page), lead),
            None => (page, String::new()),
        };
        for text in groups(&lead, lines) {
            self.add(page, PassageKind::List, None, text);
        }
    }

    fn table(&mut self, page: Option<u32>, caption: Option<String>, head: &[String], rows: Vec<Vec<String>>) {
        let cell = |text: &String| tidy(&text.replace('|', "/"));
        let width = rows.iter().map(Vec::len).chain([head.len()]).max().unwrap_or_default();
        let rows = rows.iter().map(|row| row.iter().map(cell).collect::<Vec<_>>());
        let rows: Vec<Vec<String>> = rows.filter(|r| r.iter().any(|c| !c.is_empty())).collect();
        let caption = caption.map(|c| cut(&tidy(&c), LONG_HEADING)).filter(|c| !c.is_empty());
        if head.iter().all(|h| h.trim().is_empty()) {
            // Without a head each row is a statement of its own: "Corridor width: 1.5 m".
            let items: Vec<(usize, String)> = rows.iter().map(|r| (0, statement(r))).collect();
            if let Some(caption) = caption {
                self.lead_in();
                self.waiting = Some((page, format!("{}:", caption.trim_end_matches(':'))));
            }
            return self.list(page, &items);
        }
        // "as follows:" before a table stays the heading of its rows.
        let caption = match (self.waiting.take(), caption) {
            (Some((_, lead)), None) => Some(cut(&lead, LONG_HEADING)),
            (Some((page, lead)), caption) => {
                self.add(page, PassageKind::Prose, None, lead);
                caption
            }
            (None, caption) => caption,
        };
        let line = |cells: &[String]| {
            let cells = cells.iter().map(String::as_str).chain(std::iter::repeat(""));
            cells.take(width).collect::<Vec<_>>().join(" | ").trim_end().to_owned()
        };
        let head: Vec<String> = head.iter().map(cell).collect();
        for text in groups(&line(&head), rows.iter().map(|r| line(r))) {
            self.add(page, PassageKind::Table, caption.as_deref(), text);
        }
    }

    fn add(&mut self, page: Option<u32>, kind: PassageKind, caption: Option<&str>, text: String) {
        if text.is_empty() {
            return;
        }
        let heading: Vec<String> =
            self.headings.iter().map(|(_, h)| h.clone()).chain(caption.map(str::to_owned)).collect();
        let mut hash = Sha256::new();
        heading.iter().for_each(|h| hash.update(format!("{h}\n")));
        hash.update(format!("\n{text}"));
        let hash = HEXLOWER.encode(&hash.finalize()[..6]);
        let count = self.seen.entry(hash.clone()).or_default();
        *count += 1;
        let id = if *count == 1 { format!("p-{hash}") } else { format!("p-{hash}-{count}") };
        let offset = self.offset;
        self.offset += text.len() + 2;
        self.passages.push(Passage { id, heading, text, kind, page, offset });
    }
}

/// Returns a row without a head as one statement: its first cell, a colon, the others.
fn statement(row: &[String]) -> String {
    let mut cells = row.iter().filter(|c| !c.is_empty());
    let first = cells.next().cloned().unwrap_or_default();
    let rest = cells.map(String::as_str).collect::<Vec<_>>().join(", ");
    if rest.is_empty() { first } else { format!("{}: {rest}", first.trim_end_matches(':')) }
}

/// Returns lines in groups that are not too long, each under the same first line.
fn groups(first: &str, lines: impl Iterator<Item = String>) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    let mut fresh = true;
    for line in lines {
        if out.last().is_some_and(|t| t.len() + line.len() > LONG_ROWS && !fresh) {
            fresh = true;
        }
        if fresh {
            out.push(first.to_owned());
            fresh = false;
        }
        if let Some(text) = out.last_mut() {
            if !text.is_empty() {
                text.push('\n');
            }
            text.push_str(&line);
        }
    }
    out
}

/// Returns a long paragraph in parts that end with a sentence where one ends, else with a word.
fn divided(text: &str) -> Vec<&str> {
    let mut parts = Vec::new();
    let mut rest = text;
    while rest.len() > LONG_PROSE {
        let window = rest.floor_char_boundary(LONG_PROSE);
        let head = rest.get(..window).unwrap_or(rest);
        let ends = [". ", "! ", "? ", "; ", " "].iter();
        let end = ends.filter_map(|mark| head.rfind(mark).map(|at| at + mark.len())).find(|at| *at > LONG_PROSE / 3);
        let (part, after) = rest.split_at(end.unwrap_or(window));
        parts.push(part.trim());
        rest = after.trim_start();
    }
    parts.push(rest);
    parts
}

fn cut(text: &str, limit: usize) -> String {
    text.get(..text.floor_char_boundary(limit)).unwrap_or(text).trim_end().to_owned()
}
