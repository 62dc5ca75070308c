//! Pages to the lines of one text: without what is printed on every page, columns of prose one after the other.
//!
//! What it is not for: paragraphs and tables (`layout`).

use std::collections::BTreeMap;

use super::wire::{Page, Printed};
use crate::read::layout::{Cell, Line};

/// Lines so near to a page's edge, as a part of its height, may be its header or footer.
const EDGE: f32 = 0.12;
/// With fewer lines on a page, the usual distance of lines is that of the whole file.
const FEW_LINES: usize = 12;
/// A repeated line stands on so many pages at least.
const REPEATED: usize = 3;

/// Returns the lines of all pages.
pub fn lines(pages: Vec<Page>) -> Vec<Line> {
    let repeated = repeated(&pages);
    let common = leading(pages.iter().flat_map(|p| steps(&p.lines)).collect());
    let mut out: Vec<Line> = Vec::new();
    for page in pages {
        let height = page.height;
        let printed = page.lines.into_iter();
        let kept: Vec<Printed> = printed
            .filter(|l| !(at_edge(l, height) && (repeated.contains_key(&shape(l)) || is_page_number(l))))
            .collect();
        let steps = steps(&kept);
        // A page of few lines may have nothing but gaps.
        let leading = if steps.len() < FEW_LINES { common } else { leading(steps) };
        let columns = columns(&kept);
        let mut last: Option<(f32, f32)> = None;
        for line in in_order(kept, columns) {
            let gap = last.is_none_or(|(y, size)| {
                let step = line.y - y;
                // A larger letter needs more space; one that begins above is in the next column.
                step < 0.0 || step > 1.35 * leading * (line.size.max(size) / line.size.min(size).max(0.1)).min(1.5)
            });
            last = Some((line.y, line.size));
            let cells = line.cells.into_iter().map(|(from, to, text)| Cell { from, to, text }).collect();
            out.push(Line::new(Some(page.number), cells, line.size, gap));
        }
    }
    out
}

fn text(line: &Printed) -> String {
    line.cells.iter().map(|c| c.2.as_str()).collect::<Vec<_>>().join(" ")
}

fn at_edge(line: &Printed, height: f32) -> bool {
    height > 0.0 && (line.y < EDGE * height || line.y > (1.0 - EDGE) * height)
}

/// Returns a line with its figures as one mark: the page number changes, the rest of a footer stays.
fn shape(line: &Printed) -> String {
    let mut out = String::new();
    for c in text(line).chars().filter(|c| !c.is_whitespace()) {
        let c = if c.is_ascii_digit() { '#' } else { c };
        if !(c == '#' && out.ends_with('#')) {
            out.extend(c.to_lowercase());
        }
    }
    out
}

/// Returns the shapes of lines that stand at the edge of many pages.
fn repeated(pages: &[Page]) -> BTreeMap<String, usize> {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for page in pages {
        let mut shapes: Vec<String> = page.lines.iter().filter(|l| at_edge(l, page.height)).map(shape).collect();
        shapes.sort();
        shapes.dedup();
        shapes.into_iter().for_each(|s| *counts.entry(s).or_default() += 1);
    }
    let least = REPEATED.max(pages.len() / 3).min(pages.len().max(2));
    counts.retain(|_, n| *n >= least);
    counts
}

/// Tells whether a line is only the number of its page: "12", "- 12 -", "Page 3 of 8", "Seite 3".
fn is_page_number(line: &Printed) -> bool {
    let text = text(line).to_lowercase();
    let mut words = text.split(|c: char| !c.is_alphanumeric()).filter(|w| !w.is_empty());
    let known = |w: &str| {
        w.bytes().all(|b| b.is_ascii_digit()) && w.len() <= 4
            || matches!(
                w,
                "page" | "seite" | "s" | "p" | "of" | "von" | "página" | "pagina" | "de" | "di" | "van" | "sur"
            )
    };
    text.contains(|c: char| c.is_ascii_digit()) && words.all(known)
}

/// Returns the distances between lines.
fn steps(lines: &[Printed]) -> Vec<f32> {
    let pairs = lines.iter().zip(lines.iter().skip(1));
    pairs.map(|(a, b)| b.y - a.y).filter(|s| *s > 1.0).collect()
}

/// Returns the usual one of distances between lines.
fn leading(mut steps: Vec<f32>) -> f32 {
    steps.sort_by(f32::total_cmp);
    // The lower half: paragraphs and headings only widen it.
    steps.get(steps.len() / 3).copied().unwrap_or(14.0)
}

/// Returns where the gap between two columns of prose is, if the page has them.
fn columns(lines: &[Printed]) -> Option<f32> {
    let double: Vec<&Printed> = lines.iter().filter(|l| l.cells.len() == 2).collect();
    if double.len() < 8 || double.len() * 2 < lines.len() {
        return None;
    }
    let letters: usize = double.iter().flat_map(|l| &l.cells).map(|c| c.2.len()).sum();
    if letters / (double.len() * 2) < 22 {
        return None;
    }
    // All left cells end before all right cells begin.
    let left = double.iter().filter_map(|l| l.cells.first()).map(|c| c.1).fold(0.0, f32::max);
    let right = double.iter().filter_map(|l| l.cells.get(1)).map(|c| c.0).fold(f32::MAX, f32::min);
    (left < right).then_some((left + right) / 2.0)
}

/// Returns the lines in reading order: with columns, the left one first, up to a line that spans both.
fn in_order(lines: Vec<Printed>, columns: Option<f32>) -> Vec<Printed> {
    let Some(middle) = columns else { return lines };
    let (mut out, mut right) = (Vec::new(), Vec::new());
    for line in lines {
        if line.cells.iter().any(|c| c.0 < middle && c.1 > middle) {
            out.append(&mut right);
            out.push(line);
            continue;
        }
        let (y, size) = (line.y, line.size);
        let (a, b): (Vec<_>, Vec<_>) = line.cells.into_iter().partition(|c| c.0 < middle);
        for (cells, column) in [(a, &mut out), (b, &mut right)] {
            if !cells.is_empty() {
                column.push(Printed { y, size, cells });
            }
        }
    }
    out.append(&mut right);
    out
}
