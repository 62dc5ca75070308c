//! Lines of text with positions to blocks: headings, paragraphs with their words mended, lists, tables in columns.
//!
//! What it is not for: finding the lines. Plain text counts positions in characters, PDF in points.

use std::collections::BTreeSet;

use super::blocks::Block;
use super::html::{is_bullet_line, without_bullet};

/// Words set apart by a wide gap.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    pub from: f32,
    pub to: f32,
    pub text: String,
}

/// One printed line.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    pub page: Option<u32>,
    pub cells: Vec<Cell>,
    /// The size of its letters, 0 where all have one.
    pub size: f32,
    /// Whether more than the usual space is above it.
    pub gap: bool,
}

impl Line {
    /// Returns a line whose bullet or number, if one stands apart in front, is part of the text after it.
    pub fn new(page: Option<u32>, mut cells: Vec<Cell>, size: f32, gap: bool) -> Self {
        let lone = |c: &Cell| {
            let mark = c.text.trim();
            let bullet = is_bullet_line(&format!("{mark} x")) && mark.chars().count() == 1;
            let number = mark.len() <= 8 && mark.contains(['.', ')']) && item(&format!("{mark} x")).is_some();
            bullet || number || (mark.contains('.') && numbered(&format!("{mark} Xxx")).is_some())
        };
        if cells.len() > 1 && cells.first().is_some_and(lone) {
            let mark = cells.remove(0);
            if let Some(next) = cells.first_mut() {
                next.text = format!("{} {}", mark.text.trim(), next.text.trim_start());
                next.from = mark.from;
            }
        }
        Self { page, cells, size, gap }
    }

    /// Returns where it begins.
    fn from(&self) -> f32 {
        self.cells.first().map_or(0.0, |c| c.from)
    }

    pub fn text(&self) -> String {
        self.cells.iter().map(|c| c.text.as_str()).collect::<Vec<_>>().join(" ")
    }
}

/// Returns the blocks of lines, each with the page it begins on.
pub fn blocks(lines: &[Line]) -> Vec<(Option<u32>, Block)> {
    let body = body_size(lines);
    let sizes: BTreeSet<u32> = lines.iter().filter(|l| l.size > body * 1.12).map(|l| (l.size * 2.0) as u32).collect();
    let mut maker = Maker { words: words(lines), sizes, body, ..Maker::default() };
    // Lines before `prose` were found to be no table, and are not looked at again for each of them.
    let (mut at, mut prose) = (0, 0);
    while let Some(line) = lines.get(at) {
        let columned = if at < prose { &[] } else { rows_of_table(lines.get(at..).unwrap_or_default()) };
        if let Some(Table { head, rows }) = table(columned) {
            let caption = maker.caption();
            maker.flush();
            maker.out.push((line.page, Block::Table { caption, head, rows }));
            at += columned.len();
            continue;
        }
        prose = prose.max(at + columned.len());
        maker.line(line, lines.get(at + 1));
        at += 1;
    }
    maker.flush();
    maker.out
}

/// Returns the size of letters that most of the text has.
fn body_size(lines: &[Line]) -> f32 {
    let mut sizes: Vec<(f32, usize)> = lines.iter().map(|l| (l.size, l.text().len())).collect();
    sizes.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = sizes.iter().map(|s| s.1).sum::<usize>() / 2;
    let mut sum = 0;
    let middle = sizes.iter().find(|(_, n)| {
        sum += n;
        sum > half
    });
    middle.map_or(0.0, |m| m.0)
}

/// Returns the words that stand inside of lines, to know which divided words keep their hyphen.
fn words(lines: &[Line]) -> BTreeSet<String> {
    let split = |text: String| {
        let words: Vec<String> = text.split_whitespace().map(str::to_owned).collect();
        words.into_iter().rev().skip(1)
    };
    let bare = |w: String| w.trim_matches(|c: char| !c.is_alphanumeric()).to_lowercase();
    lines.iter().flat_map(|l| split(l.text())).map(bare).filter(|w| w.contains('-')).take(50_000).collect()
}

#[derive(Default)]
struct Maker {
    out: Vec<(Option<u32>, Block)>,
    paragraph: Option<(Option<u32>, String)>,
    items: Vec<(usize, String)>,
    items_page: Option<u32>,
    /// Where the last item begins.
    item_from: f32,
    /// The page of the last line, and where that line ends.
    last: (Option<u32>, f32),
    words: BTreeSet<String>,
    sizes: BTreeSet<u32>,
    body: f32,
}

impl Maker {
    fn line(&mut self, line: &Line, next: Option<&Line>) {
        let text = line.text();
        if text.trim().is_empty() {
            return self.flush();
        }
        if (line.gap && !self.goes_on(line, &text)) || self.leaves_list(line, &text) {
            self.flush();
        }
        self.last = (line.page, line.cells.last().map_or(0.0, |c| c.to));
        if let Some(level) = self.heading(line, &text, next) {
            self.flush();
            self.out.push((line.page, Block::Heading { level, text }));
            return;
        }
        if let Some(item) = item(&text) {
            self.end_paragraph();
            if self.items.is_empty() {
                self.items_page = line.page;
            }
            self.items.push((0, item.to_owned()));
            self.item_from = line.from();
        } else if let Some((_, last)) = self.items.last_mut() {
            append(last, &text, &self.words);
        } else {
            let (_, paragraph) = self.paragraph.get_or_insert_with(|| (line.page, String::new()));
            append(paragraph, &text, &self.words);
        }
    }

    /// Tells whether a sentence runs over a gap that is only the end of a page.
    fn goes_on(&self, line: &Line, text: &str) -> bool {
        let above = self.paragraph.as_ref().map(|p| &p.1).or(self.items.last().map(|i| &i.1));
        let ended = above.is_none_or(|t| t.trim_end().ends_with(['.', ':', '!', '?', ';']));
        line.page.is_some() && self.last.0 != line.page && !ended && text.starts_with(char::is_lowercase)
    }

    /// Tells whether a line without a bullet is no part of the item above: it is not set in, begins like a sentence, and
    /// its first word had room in the line above.
    fn leaves_list(&self, line: &Line, text: &str) -> bool {
        let Some(last) = line.cells.last().filter(|_| !self.items.is_empty()) else { return false };
        let set_in = line.from() > self.item_from + 0.5;
        let first = text.split_whitespace().next().map_or(0, |w| w.chars().count() + 1);
        let room = (last.to - line.from()) * first as f32 / text.chars().count().max(1) as f32;
        !set_in && text.starts_with(char::is_uppercase) && self.last.1 + room <= last.to
    }

    /// Returns the level of a line that is a heading by its size, or by its number and its standing alone.
    fn heading(&self, line: &Line, text: &str, next: Option<&Line>) -> Option<u8> {
        let length = text.chars().count();
        if length > 120 || line.cells.len() > 2 || !text.contains(char::is_alphabetic) {
            return None;
        }
        let larger = line.size > self.body * 1.12 && self.body > 0.0;
        if larger {
            let above = self.sizes.iter().filter(|s| **s > (line.size * 2.0) as u32).count();
            return Some(u8::try_from(above + 1).unwrap_or(6).min(6));
        }
        let alone = self.paragraph.is_none() && self.items.is_empty();
        let ends = text.trim_end().ends_with(['.', ',', ';', ':']);
        let parted =
            next.is_none_or(|n| n.gap || n.text().starts_with(|c: char| c.is_uppercase() || c.is_ascii_digit()));
        if !alone || ends || length > 80 || !parted {
            return None;
        }
        if let Some(level) = numbered(text) {
            return Some(level);
        }
        let letters = text.chars().filter(|c| c.is_alphabetic());
        let shouted = letters.clone().count() >= 4 && letters.clone().all(char::is_uppercase);
        (shouted && next.is_some_and(|n| n.gap)).then_some(1)
    }

    /// Returns the paragraph above a table when it names the table.
    fn caption(&mut self) -> Option<String> {
        let is_caption = self.paragraph.as_ref().is_some_and(|(_, text)| {
            let word = text.split_whitespace().next().unwrap_or_default().to_lowercase();
            text.len() < 200
                && matches!(word.as_str(), "table" | "tabelle" | "tab." | "tableau" | "tabla" | "tabella" | "tabel")
        });
        if is_caption { self.paragraph.take().map(|p| p.1) } else { None }
    }

    fn end_paragraph(&mut self) {
        if let Some((page, text)) = self.paragraph.take() {
            self.out.push((page, Block::Prose(text)));
        }
    }

    fn flush(&mut self) {
        self.end_paragraph();
        if !self.items.is_empty() {
            let page = self.items_page.take();
            self.out.push((page, Block::List(std::mem::take(&mut self.items))));
        }
    }
}

/// Adds a line to a text, and mends a word that was divided at its end.
fn append(text: &mut String, line: &str, words: &BTreeSet<String>) {
    let line = line.trim();
    let trimmed = text.trim_end().len();
    text.truncate(trimmed);
    let soft = text.ends_with('\u{ad}');
    let hyphen = soft || text.ends_with(['-', '\u{2010}']);
    let before = text.chars().rev().nth(1);
    let word = line.split_whitespace().next().unwrap_or_default();
    let bare = word.trim_matches(|c: char| !c.is_alphanumeric());
    // "Wohn- und Schlafräume", "two- or three-storey" keep their hyphen and the space.
    let joins =
        !matches!(bare, "und" | "oder" | "bzw" | "and" | "or" | "to" | "bis" | "et" | "ou" | "y" | "o" | "en" | "of");
    if hyphen && joins && before.is_some_and(char::is_alphabetic) && word.starts_with(char::is_lowercase) {
        let first = text.split_whitespace().last().unwrap_or_default();
        let with_hyphen = format!("{first}{bare}").replace(['\u{2010}', '\u{ad}'], "-").to_lowercase();
        let with_hyphen = with_hyphen.trim_start_matches(|c: char| !c.is_alphanumeric());
        if soft || !words.contains(with_hyphen) {
            text.pop();
        }
        text.push_str(line);
        return;
    }
    // "DIN-\nNorm", "1,5-\nfach" are joined with their hyphen.
    if hyphen && joins && before.is_some_and(char::is_alphanumeric) && !line.starts_with(' ') {
        text.push_str(line);
        return;
    }
    if !text.is_empty() {
        text.push(' ');
    }
    text.push_str(line);
}

/// Returns the level of a heading with a number, "3.2 Bedrooms"; a figure with a unit is none.
fn numbered(text: &str) -> Option<u8> {
    let (number, title) = text.trim().split_once(' ')?;
    let parts: Vec<&str> = number.trim_end_matches('.').split('.').collect();
    let counted = parts.iter().all(|p| !p.is_empty() && p.len() <= 2 && p.bytes().all(|b| b.is_ascii_digit()));
    let named = title.trim_start().chars().take(3).filter(|c| c.is_alphabetic()).count() == 3;
    let titled = title.trim_start().starts_with(char::is_uppercase);
    // "12 Betten sind ..." is a sentence; a title has few words.
    let short = title.split_whitespace().count() <= 8;
    (counted && named && titled && short && parts.len() <= 5).then(|| u8::try_from(parts.len()).unwrap_or(5))
}

/// Returns the text of an item: behind a bullet, or a number or letter with a bracket or dot.
fn item(text: &str) -> Option<&str> {
    let text = text.trim_start();
    if is_bullet_line(text) {
        return Some(without_bullet(text));
    }
    let (mark, rest) = text.split_once(' ')?;
    let inner = mark.strip_prefix('(').unwrap_or(mark).strip_suffix([')', '.'])?;
    let letter = inner.len() == 1 && inner.bytes().all(|b| b.is_ascii_lowercase()) && mark.ends_with(')');
    let number = (1..=2).contains(&inner.len()) && inner.bytes().all(|b| b.is_ascii_digit());
    ((letter || number) && !rest.trim().is_empty()).then_some(rest.trim())
}

/// Returns the lines at the beginning that have columns; between them a line may fill only one, as a cell's second line.
fn rows_of_table(lines: &[Line]) -> &[Line] {
    let page = lines.first().and_then(|l| l.page);
    let mut count = 0;
    for (i, line) in lines.iter().enumerate() {
        let columns =
            line.cells.len() >= 2 && line.page == page && !is_bullet_line(line.cells.first().map_or("", |c| &c.text));
        if columns {
            count = i + 1;
        } else if count != i || line.gap || i == 0 || line.page != page {
            break;
        }
    }
    lines.get(..count).unwrap_or_default()
}

/// A table; `head` is empty when its first row is like the others.
struct Table {
    head: Vec<String>,
    rows: Vec<Vec<String>>,
}

/// Returns the table that lines with columns are.
fn table(lines: &[Line]) -> Option<Table> {
    if lines.len() < 2 {
        return None;
    }
    let columns = columns(lines)?;
    let mut rows: Vec<Vec<String>> = Vec::new();
    for line in lines {
        let mut row = vec![String::new(); columns.len()];
        for cell in &line.cells {
            let middle = (cell.from + cell.to) / 2.0;
            let distance = |c: &(f32, f32)| if middle < c.0 { c.0 - middle } else { (middle - c.1).max(0.0) };
            let near = columns.iter().enumerate().min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)));
            if let Some(slot) = near.and_then(|(i, _)| row.get_mut(i)) {
                if !slot.is_empty() {
                    slot.push(' ');
                }
                slot.push_str(cell.text.trim());
            }
        }
        let alone = line.cells.len() == 1;
        match rows.last_mut() {
            Some(last) if alone => {
                for (above, text) in last.iter_mut().zip(row).filter(|(_, t)| !t.is_empty()) {
                    append(above, &text, &BTreeSet::new());
                }
            }
            _ => rows.push(row),
        }
    }
    if rows.len() < 2 {
        return None;
    }
    let figures = |row: &[String]| row.iter().skip(1).any(|c| c.trim_start().starts_with(|c: char| c.is_ascii_digit()));
    let has_head = rows.first().is_some_and(|r| !figures(r)) && rows.iter().skip(1).any(|r| figures(r));
    let head = if has_head { rows.remove(0) } else { Vec::new() };
    Some(Table { head, rows })
}

/// Returns the columns that cells of lines share; `None` when the gaps are only wide spaces of prose.
fn columns(lines: &[Line]) -> Option<Vec<(f32, f32)>> {
    let mut spans: Vec<(f32, f32)> =
        lines.iter().filter(|l| l.cells.len() > 1).flat_map(|l| &l.cells).map(|c| (c.from, c.to)).collect();
    spans.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut columns: Vec<(f32, f32)> = Vec::new();
    for (from, to) in spans {
        match columns.last_mut() {
            Some(last) if from <= last.1 => last.1 = last.1.max(to),
            _ => columns.push((from, to)),
        }
    }
    (columns.len() >= 2 && columns.len() <= 40).then_some(columns)
}
