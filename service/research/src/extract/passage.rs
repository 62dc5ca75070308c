//! Sentences in their place: under a heading, behind a sentence that leads in, after one that names the space.
//!
//! What it is not for: deciding what a sentence says; that is `classify` and `subject`.

use super::classify::{Memo, Sentence};
use super::lexicon::Lexicon;
use super::mention::Finder;
use super::sentence::{marker, sentences};
use super::subject::UNNAMED;
use super::token::{Token, tokens};
use super::{Constraint, Finding, si, unit, value};

/// A longer lead-in is cut to its end: what it says of the list stands there.
const MAX_LEAD: usize = 60;
/// No real sentence has more figures, and nonsense must not cost more than its length.
const MAX_FIGURES: usize = 24;
/// A longer line above a table is no caption, in bytes.
const MAX_CAPTION: usize = 160;

/// What a sentence inherits.
#[derive(Debug, Default)]
struct Context {
    /// The sentence or heading that leads in to list items.
    lead: Vec<Token>,
    /// The space spoken of last.
    about: String,
    /// The quantity limited last.
    measured: String,
}

/// Returns the constraints of sentences, headings and lists.
pub fn extract(lexicon: &Lexicon, text: &str, lang: &str) -> Vec<Finding> {
    let tokens = tokens(text, lang);
    let mut findings = Vec::new();
    let mut context = Context::default();
    for (from, to) in sentences(&tokens, lexicon) {
        let own = tokens.get(from..to).unwrap_or_default();
        let new_line = from == 0 || own.first().is_some_and(|t| t.new_line);
        let mark = if new_line { marker(own) } else { 0 };
        let item = own.get(mark..).unwrap_or_default();
        let stands_alone = tokens.get(to).is_none_or(|t| t.new_line);
        let leads = stands_alone && item.last().is_some_and(|t| !matches!(t.text.as_str(), "." | "!" | "?"));
        if new_line && mark == 0 {
            context.lead.clear();
        }
        let mut read = context.lead.clone();
        let shift = read.len();
        read.extend_from_slice(item);
        let part = Part { lexicon, text, lang, tokens: &read, shift };
        let found = part.findings(&mut context);
        if found.is_empty() && leads && mark == 0 {
            context.lead = item.get(item.len().saturating_sub(MAX_LEAD)..).unwrap_or_default().to_vec();
        }
        findings.extend(found);
    }
    findings
}

/// Returns the last line of a text when it can be the caption of a table, else nothing.
pub fn caption(lexicon: &Lexicon, text: &str, lang: &str) -> String {
    let line = text.lines().rev().find(|l| !l.trim().is_empty()).unwrap_or_default().trim();
    let line = line.trim_start_matches(['#', '*', ' ']).trim_end_matches(['*', ':', '.', ' ']);
    if line.len() > MAX_CAPTION {
        return String::new();
    }
    let all = tokens(line, lang);
    let has_figures = !Finder { lexicon, text: line, lang, tokens: &all }.mentions().is_empty();
    if has_figures { String::new() } else { line.to_owned() }
}

/// A sentence behind its lead-in, which is `shift` tokens long.
struct Part<'a> {
    lexicon: &'a Lexicon,
    text: &'a str,
    lang: &'a str,
    tokens: &'a [Token],
    shift: usize,
}

impl Part<'_> {
    fn findings(&self, context: &mut Context) -> Vec<Finding> {
        let (lexicon, text, lang, tokens) = (self.lexicon, self.text, self.lang, self.tokens);
        let mut mentions = Finder { lexicon, text, lang, tokens }.mentions();
        mentions.truncate(MAX_FIGURES);
        let sentence = Sentence { lexicon, text, lang, tokens, mentions: &mentions, memo: Memo::default() };
        if mentions.is_empty() {
            context.about = sentence.topic();
            return Vec::new();
        }
        let conditions = sentence.conditions();
        let mut findings = Vec::new();
        for (i, verdict) in sentence.verdicts().into_iter().enumerate() {
            let (Some((constraint_type, confidence)), Some(mention)) = (verdict, mentions.get(i)) else { continue };
            if mention.from < self.shift {
                continue; // said of the list as a whole, and found when the lead-in was read
            }
            let (named, name) = (sentence.space(i), sentence.name(i));
            // "It should preferably be 1.8 m": neither a space nor a quantity.
            let elliptic = named.is_empty() && name == UNNAMED && !context.measured.is_empty();
            let constraint = Constraint {
                name: if elliptic { context.measured.clone() } else { name },
                constraint_type,
                value: value(mention),
                unit: unit(lexicon, mention),
                space: if named.is_empty() { context.about.clone() } else { named },
                conditions: conditions.clone(),
                confidence,
            };
            findings.push(Finding {
                si: si(lexicon, mention),
                evidence: self.place(self.shift, tokens.len()),
                printed: self.place(mention.from, mention.to),
                constraint,
            });
        }
        if let Some(last) = findings.last().filter(|f| !f.constraint.space.is_empty()) {
            context.about.clone_from(&last.constraint.space);
            context.measured.clone_from(&last.constraint.name);
        }
        findings
    }

    /// Returns the bytes of tokens `a..b`.
    fn place(&self, a: usize, b: usize) -> std::ops::Range<usize> {
        let start = self.tokens.get(a).map_or(0, |t| t.start);
        start..b.checked_sub(1).and_then(|k| self.tokens.get(k)).map_or(start, |t| t.end)
    }
}
