//! Tables with `|` between cells: a row names the space, a column head the quantity, its unit and its side.

use std::ops::Range;

use super::classify::{Memo, Sentence};
use super::lexicon::{Bound, Lexicon};
use super::mention::{Figure, Finder, Mention};
use super::token::{Kind, tokens};
use super::{Confidence, Constraint, ConstraintType, Finding, si, unit, value};

/// A longer cell is prose and not a figure with its name, in bytes.
const MAX_CELL: usize = 240;

/// Returns the parts of a text, each with whether it is a table: lines in a row with `|` in them.
pub fn split(text: &str) -> Vec<(Range<usize>, bool)> {
    let mut parts: Vec<(Range<usize>, bool)> = Vec::new();
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        let is_row = line.matches('|').count() >= 1;
        let range = at..at + line.len();
        at = range.end;
        match parts.last_mut() {
            Some((last, kind)) if *kind == is_row => last.end = range.end,
            _ => parts.push((range, is_row)),
        }
    }
    parts
}

/// Returns the constraints of a table; the caption may name the quantity and the side.
pub fn extract(lexicon: &Lexicon, text: &str, caption: &str, lang: &str) -> Vec<Finding> {
    let mut rows: Vec<(Range<usize>, Vec<Range<usize>>)> = Vec::new();
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        let cells = cells(line, at);
        if cells.iter().any(|c| text.get(c.clone()).is_some_and(|t| t.contains(char::is_alphanumeric))) {
            rows.push((at..at + line.trim_end().len(), cells));
        }
        at += line.len();
    }
    let Some(((_, head), body)) = rows.split_first() else { return Vec::new() };
    let mut findings = Vec::new();
    for (line, row) in body {
        let Some(label) = row.first().and_then(|c| text.get(c.clone())) else { continue };
        for (column, cell) in row.iter().enumerate().skip(1) {
            let title = head.get(column).and_then(|c| text.get(c.clone())).unwrap_or_default();
            let printed = text.get(cell.clone()).unwrap_or_default();
            if label.len().max(title.len()).max(printed.len()) > MAX_CELL {
                continue;
            }
            let head = format!("{caption} {}", title.trim());
            findings.extend(read(lexicon, lang, label, head.trim(), printed).into_iter().map(|c| Finding {
                evidence: line.clone(),
                printed: trimmed(text, cell),
                ..c
            }));
        }
    }
    findings
}

/// Returns the range without blanks at its ends.
fn trimmed(text: &str, range: &Range<usize>) -> Range<usize> {
    let piece = text.get(range.clone()).unwrap_or_default();
    let start = range.start + piece.len() - piece.trim_start().len();
    start..start + piece.trim().len()
}

fn cells(line: &str, offset: usize) -> Vec<Range<usize>> {
    let mut out = Vec::new();
    let mut at = offset;
    let inner = line.trim_end();
    for (i, cell) in inner.split('|').enumerate() {
        let range = at..at + cell.len();
        at = range.end + 1;
        if !(i == 0 && cell.trim().is_empty()) {
            out.push(range);
        }
    }
    out
}

/// Reads a cell as the sentence "row, column: figure unit".
fn read(lexicon: &Lexicon, lang: &str, label: &str, title: &str, cell: &str) -> Vec<Finding> {
    if !tokens(cell, lang).iter().any(|t| matches!(t.kind, Kind::Number(_))) {
        return Vec::new();
    }
    let cell = cell.trim();
    let own = unit_in(lexicon, cell, lang).is_some();
    let printed_unit = [title, label].iter().find_map(|t| unit_in(lexicon, t, lang)).filter(|_| !own);
    let counted = || thing_in(lexicon, title, lang).filter(|_| !own);
    let spelled = printed_unit.map(|u| u + &basis_in(lexicon, title, lang)).or_else(counted).unwrap_or_default();
    // Column heads name the things counted where there is no unit.
    let text = format!("{} {}: {cell} {spelled}", label.trim(), title.trim());
    let all = tokens(&text, lang);
    let mentions = Finder { lexicon, text: &text, lang, tokens: &all }.mentions();
    let head_end = label.trim().len() + title.trim().len() + 2;
    let first = mentions.iter().position(|m| all.get(m.from).is_some_and(|t| t.start >= head_end));
    let sentence = Sentence { lexicon, text: &text, lang, tokens: &all, mentions: &mentions, memo: Memo::default() };
    // "up to 100 persons" in the label says when; "minimum width" there is the rule itself.
    let numbered = tokens(label, lang).iter().any(|t| t.number().is_some());
    let from = if numbered { label.trim().len() } else { 0 };
    let bound = all.iter().enumerate().filter(|(_, t)| t.start >= from).find_map(|(k, t)| {
        let known = lexicon.before.at(&all, k).or_else(|| lexicon.prefixes.part(t, false).map(|p| (k + 1, p)));
        known.and_then(|(_, c)| lexicon.comparators.get(c)).map(|c| c.bound)
    });
    let constraint_type = |figure: &Figure| match (figure, bound) {
        (Figure::Range(..), _) => ConstraintType::Range,
        (_, Some(Bound::Min)) => ConstraintType::Minimum,
        (_, Some(Bound::Max)) => ConstraintType::Maximum,
        (Figure::Ratio(_) | Figure::Per(..), None) => ConstraintType::Ratio,
        _ if lexicon.cues.get("duty").any(&all) => ConstraintType::Minimum,
        _ => ConstraintType::Recommendation,
    };
    let found = |(index, mention): (usize, &Mention)| {
        let constraint = Constraint {
            name: sentence.name(index),
            constraint_type: constraint_type(&mention.figure),
            value: value(mention),
            unit: unit(lexicon, mention),
            space: sentence.space(index),
            conditions: if numbered { vec![label.trim().to_owned()] } else { Vec::new() },
            confidence: if bound.is_some() { Confidence::High } else { Confidence::Medium },
        };
        Finding { si: si(lexicon, mention), constraint, evidence: 0..0, printed: 0..0 }
    };
    // The cell's first figure, and the others where it gives both sides: "0.9 m × 1.5 m".
    let of_cell =
        mentions.iter().enumerate().filter(|(k, m)| first.is_some_and(|f| *k == f || *k > f && m.side.is_some()));
    of_cell.map(found).collect()
}

/// Returns the name of a thing that a head says is counted.
fn thing_in(lexicon: &Lexicon, title: &str, lang: &str) -> Option<String> {
    let all = tokens(title, lang);
    (0..all.len()).find_map(|k| {
        let (end, _) = lexicon.thing.at(&all, k)?;
        title.get(all.get(k)?.start..all.get(end.checked_sub(1)?)?.end).map(str::to_owned)
    })
}

/// Returns "per person" when a head gives its figures per something.
fn basis_in(lexicon: &Lexicon, title: &str, lang: &str) -> String {
    let all = tokens(title, lang);
    let found = (0..all.len()).find_map(|k| {
        let at = lexicon.cues.get("plain_per").at(&all, k)?.0;
        let end = lexicon.basis.at(&all, at)?.0;
        title.get(all.get(k)?.start..all.get(end.checked_sub(1)?)?.end)
    });
    found.map(|f| format!(" {f}")).unwrap_or_default()
}

/// Returns the unit that stands in brackets, behind a figure, or at the end of a head ("Width in m").
fn unit_in(lexicon: &Lexicon, text: &str, lang: &str) -> Option<String> {
    let all = tokens(text, lang);
    let mut found = None;
    for (k, token) in all.iter().enumerate() {
        let figure = token.number().is_some();
        let opens = matches!(token.text.as_str(), "(" | "[" | "," | "/") || token.is("in") && k > 0;
        if k == 0 {
            // The head begins with its unit: "Lux", "m² per person".
            let per = |end: usize| {
                let next = all.iter().position(|t| t.start >= end);
                next.is_some_and(|j| {
                    lexicon.cues.get("plain_per").is_at(&all, j)
                        || lexicon.before.is_at(&all, j)
                        || all.get(j).is_some_and(|t| t.is("("))
                })
            };
            found = lexicon.unit_at(text, token.start, lang).filter(|u| u.1 >= text.trim_end().len() || per(u.1));
        }
        let ends_head = found.is_none()
            && !lexicon.before.is_at(&all, k)
            && !lexicon.cues.get("stops").is_at(&all, k)
            && !figure
            && k > 0;
        if ends_head {
            found = lexicon.unit_at(text, token.start, lang).filter(|u| u.1 >= text.trim_end().len());
        }
        if figure || opens {
            let abbreviated = |end: usize| text.get(end..).is_some_and(|rest| rest.starts_with('.')) && !figure;
            let unit = lexicon.unit_at(text, token.end, lang).filter(|u| u.1 > token.end && !abbreviated(u.1));
            found = found.or(unit);
        }
    }
    found.and_then(|(unit, _)| lexicon.units.get(unit)).map(|u| u.id.clone())
}
