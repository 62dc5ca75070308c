//! HTML tables to rows of cells: spans are filled, heads of several rows are joined, tables that only place things on a
//! page are read as the text they are.
//!
//! What it is not for: what a cell means; that is for `extract`, which needs the head's unit and the row's label.

use scraper::ElementRef;

use super::style::Look;
use super::{HEADINGS, Walker, holds};
use crate::read::blocks::Block;

/// A table has no more cells than this after its spans are filled.
const MAX_CELLS: usize = 200_000;
const MAX_COLUMNS: usize = 200;
const MAX_SPAN: usize = 500;

struct Row {
    cells: Vec<String>,
    /// Which cells are heads, by `<th>`.
    heads: Vec<bool>,
    in_head: bool,
    /// The row is one cell across all columns.
    is_band: bool,
}

impl Walker {
    pub(super) fn table(&mut self, table: ElementRef<'_>, look: Look, depth: usize) {
        let role = table.value().attr("role").unwrap_or_default();
        let placing = matches!(role, "presentation" | "none") || holds(table, HEADINGS) || holds(table, &["table"]);
        if placing {
            self.children(table, look, depth);
            return self.flush();
        }
        let mut caption = None;
        let mut rows = Vec::new();
        for part in table.child_elements() {
            let Some(look) = self.look(part, look, depth + 1) else { continue };
            match part.value().name() {
                "caption" => caption = Some(self.plain(part, look, depth + 1)),
                "tr" => self.row(part, look, depth + 1, false, &mut rows),
                group @ ("thead" | "tbody" | "tfoot") => {
                    for row in part.child_elements().filter(|e| e.value().name() == "tr") {
                        if let Some(look) = self.look(row, look, depth + 2) {
                            self.row(row, look, depth + 2, group == "thead", &mut rows);
                        }
                    }
                }
                _ => {}
            }
        }
        let rows = filled(rows);
        if rows.iter().map(|r| r.cells.len()).max().unwrap_or_default() < 2 {
            let texts = caption.into_iter().chain(rows.into_iter().flat_map(|r| r.cells));
            texts.for_each(|text| self.reading.push(Block::Prose(text)));
            return;
        }
        let Parts { title, head, rows } = divided(rows);
        let caption = caption.filter(|c| !c.is_empty()).or(title);
        self.reading.push(Block::Table { caption, head, rows });
    }

    fn row(&mut self, row: ElementRef<'_>, look: Look, depth: usize, in_head: bool, rows: &mut Vec<Vec<Cell>>) {
        let mut cells = Vec::new();
        for cell in row.child_elements().filter(|e| matches!(e.value().name(), "td" | "th")) {
            // A hidden cell still takes its place, so that the others stay under their heads.
            let text = match self.look(cell, look, depth + 1) {
                Some(look) => self.plain(cell, look, depth + 1),
                None => String::new(),
            };
            let span = |name: &str| cell.value().attr(name).and_then(|v| v.trim().parse::<usize>().ok()).unwrap_or(1);
            cells.push(Cell {
                text,
                is_head: cell.value().name() == "th",
                columns: span("colspan").clamp(1, MAX_COLUMNS),
                rows: span("rowspan").clamp(1, MAX_SPAN),
                in_head,
            });
        }
        rows.push(cells);
    }
}

struct Cell {
    text: String,
    is_head: bool,
    columns: usize,
    rows: usize,
    in_head: bool,
}

/// Returns the rows with every cell repeated where it spans.
fn filled(rows: Vec<Vec<Cell>>) -> Vec<Row> {
    let mut out: Vec<Row> = Vec::new();
    // What still hangs down into the next rows: rows left, text, whether it is a head.
    let mut hanging: Vec<Option<(usize, String, bool)>> = Vec::new();
    let mut total = 0;
    for row in rows {
        let in_head = row.iter().any(|c| c.in_head);
        let is_band = row.len() == 1 && row.iter().all(|c| c.columns > 1);
        let (mut cells, mut heads) = (Vec::new(), Vec::new());
        let mut given = row.into_iter();
        loop {
            let column = cells.len();
            if let Some((left, text, head)) = hanging.get_mut(column).and_then(Option::take) {
                if left > 1 {
                    hanging.get_mut(column).into_iter().for_each(|h| *h = Some((left - 1, text.clone(), head)));
                }
                cells.push(text);
                heads.push(head);
            } else if let Some(cell) = given.next() {
                for _ in 0..cell.columns {
                    if hanging.len() <= cells.len() {
                        hanging.resize(cells.len() + 1, None);
                    }
                    if cell.rows > 1 {
                        let down = Some((cell.rows - 1, cell.text.clone(), cell.is_head));
                        hanging.get_mut(cells.len()).into_iter().for_each(|h| h.clone_from(&down));
                    }
                    cells.push(cell.text.clone());
                    heads.push(cell.is_head);
                }
            } else {
                break;
            }
            if cells.len() > MAX_COLUMNS {
                break;
            }
        }
        total += cells.len();
        if total > MAX_CELLS {
            break;
        }
        if cells.iter().any(|c| !c.is_empty()) {
            out.push(Row { cells, heads, in_head, is_band });
        }
    }
    out
}

/// A table in its parts.
struct Parts {
    /// What stands across all columns above the head, or above the first rows.
    title: Option<String>,
    /// The rows of the head joined; empty when the table has none.
    head: Vec<String>,
    /// The rows below; what stood across all columns above some of them is in their first cells.
    rows: Vec<Vec<String>>,
}

fn divided(rows: Vec<Row>) -> Parts {
    let width = rows.iter().map(|r| r.cells.len()).max().unwrap_or_default();
    let mut count = head_rows(&rows);
    let no_marks = rows.iter().all(|r| r.heads.iter().all(|h| !*h));
    // Without any mark, a first row of words above rows of figures is the head.
    if count == 0 && no_marks && rows.len() > 1 {
        let figures = |r: &Row| r.cells.iter().skip(1).any(|c| starts_with_figure(c));
        let first_is_words =
            rows.first().is_some_and(|r| !figures(r) && !r.is_band && r.cells.iter().all(|c| !c.is_empty()));
        count = usize::from(first_is_words && (width > 2 || rows.iter().skip(1).all(figures)));
    }
    if count == rows.len() {
        count = 0;
    }
    let mut head = vec![String::new(); if count == 0 { 0 } else { width }];
    let titles = rows.iter().take(count).filter(|r| r.is_band).filter_map(|r| r.cells.first());
    let title = titles.map(String::as_str).collect::<Vec<_>>().join(", ");
    for row in rows.iter().take(count).filter(|r| !r.is_band) {
        for (title, cell) in head.iter_mut().zip(&row.cells) {
            if !cell.is_empty() && title != cell {
                title.push_str(if title.is_empty() { "" } else { " " });
                title.push_str(cell);
            }
        }
    }
    let mut band = String::new();
    let mut body = Vec::new();
    for row in rows.into_iter().skip(count) {
        if row.is_band {
            band = row.cells.into_iter().next().unwrap_or_default();
            continue;
        }
        let mut cells = row.cells;
        if let Some(label) = cells.first_mut().filter(|_| !band.is_empty()) {
            *label = format!("{band}, {label}");
        }
        body.push(cells);
    }
    Parts { title: Some(title).filter(|t| !t.is_empty()), head, rows: body }
}

/// Returns how many rows are marked as the head. A row of one head cell across the table belongs to it only above the
/// others; below them it parts the rows.
fn head_rows(rows: &[Row]) -> usize {
    let mut named = false;
    let is_head = |r: &&Row| {
        let heads = r.heads.iter().all(|h| *h) && r.cells.len() > 1;
        let is_head = r.in_head || (heads && !(r.is_band && named));
        named |= is_head && !r.is_band;
        is_head
    };
    rows.iter().take_while(is_head).count()
}

fn starts_with_figure(text: &str) -> bool {
    let text = text.trim_start_matches(|c: char| !c.is_alphanumeric());
    text.starts_with(|c: char| c.is_ascii_digit())
}
