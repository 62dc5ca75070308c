//! Plain text to blocks: blank lines part paragraphs, divided words are mended, columns set with spaces, tabs or `|` become
//! tables.
//!
//! What it is not for: Markdown, which has its own reader.

use super::blocks::{Block, Reading};
use super::layout::{self, Cell, Line};

/// A line longer than this is one cell: columns are looked for in lines that fit a page.
const LONG_LINE: usize = 2_000;

/// Returns the blocks of a plain text.
pub fn read(text: &str) -> Reading {
    let mut lines: Vec<Line> = Vec::new();
    let mut blank = true;
    for line in text.lines() {
        if line.trim().is_empty() {
            blank = true;
            continue;
        }
        // A line of marks underlines the one above.
        let mark = line.trim().chars().next().unwrap_or(' ');
        if line.trim().len() >= 3 && "=-_~*+|:".contains(mark) && line.trim().chars().all(|c| "=-_~*+|: ".contains(c)) {
            let alone = lines.iter().rev().take(2).map(|l| l.gap).eq([true, false]) || lines.len() == 1;
            if let Some(last) = lines.last_mut()
                && !blank
                && "=-~".contains(mark)
                && (alone || last.gap)
                && last.cells.len() == 1
            {
                // Levels follow from sizes, as in print.
                last.size = if mark == '=' { 20.0 } else { 15.0 };
                blank = true;
            }
            continue;
        }
        lines.push(Line::new(None, cells(line), 10.0, blank));
        blank = false;
    }
    let blocks = layout::blocks(&lines);
    let title = blocks.iter().find_map(|(_, b)| match b {
        Block::Heading { text, .. } => Some(text.clone()),
        _ => None,
    });
    Reading { title, blocks, ..Reading::default() }
}

/// Returns the cells of a line: divided by `|`, tabs, or three spaces and more.
fn cells(line: &str) -> Vec<Cell> {
    let whole = |text: &str| vec![Cell { from: 0.0, to: text.chars().count() as f32, text: text.trim().to_owned() }];
    if line.len() > LONG_LINE {
        return whole(line);
    }
    let bars = line.matches('|').count();
    if bars >= 1 && line.trim().len() > 2 * bars {
        // Bars say which column it is, wherever they stand.
        let inner = line.trim().trim_start_matches('|').trim_end_matches('|');
        let at = |i: usize| i as f32 * 1000.0;
        let cell = |(i, text): (usize, &str)| Cell { from: at(i), to: at(i) + 500.0, text: text.trim().to_owned() };
        return inner.split('|').enumerate().map(cell).collect();
    }
    let mut cells: Vec<Cell> = Vec::new();
    let (mut column, mut spaces) = (0usize, 3usize);
    for c in line.trim_end().chars() {
        let width = if c == '\t' { 8 - column % 8 } else { 1 };
        if c == '\t' || c == ' ' {
            spaces += if c == '\t' { 3 } else { 1 };
        } else {
            match cells.last_mut() {
                Some(cell) if spaces < 3 => cell.text.extend(std::iter::repeat_n(' ', spaces)),
                _ => cells.push(Cell { from: column as f32, to: column as f32, text: String::new() }),
            }
            spaces = 0;
            if let Some(cell) = cells.last_mut() {
                cell.text.push(c);
                cell.to = column as f32 + 1.0;
            }
        }
        column += width;
    }
    cells
}
