//! Constraints of sentences and tables: find the figures, tell limits from conditions and reports, name what is limited.

mod classify;
mod formula;
mod lexicon;
mod mention;
mod passage;
mod sentence;
mod subject;
mod table;
mod token;

use std::ops::Range;

use d3dgen_model::knowledge::{Statement, Value};
use serde::Serialize;

use lexicon::Lexicon;
use mention::{Figure, Mention};

/// On which side of the figure things may be, or how binding it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ConstraintType {
    /// Not below.
    Minimum,
    /// Not above.
    Maximum,
    /// From and to.
    Range,
    /// So many for so many, or a share.
    Ratio,
    /// Advised.
    Recommendation,
    /// Usual.
    RuleOfThumb,
}

impl ConstraintType {
    /// Returns the word for it in knowledge bases.
    pub fn name(self) -> &'static str {
        match self {
            Self::Minimum => "minimum",
            Self::Maximum => "maximum",
            Self::Range => "range",
            Self::Ratio => "ratio",
            Self::Recommendation => "recommendation",
            Self::RuleOfThumb => "rule_of_thumb",
        }
    }
}

/// How plainly the sentence says it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Confidence {
    /// Guessed from form.
    Low,
    /// Carried over, or said by duty alone.
    Medium,
    /// A comparator stands at the figure.
    High,
}

impl Confidence {
    /// Returns the word for it in knowledge bases.
    pub fn name(self) -> &'static str {
        match self {
            Self::Low => "low",
            Self::Medium => "medium",
            Self::High => "high",
        }
    }
}

/// A rule with its figure as printed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Constraint {
    /// What is limited, snake case.
    pub name: String,
    /// Kind of limit.
    pub constraint_type: ConstraintType,
    /// The figure, in `unit`.
    pub value: Value,
    /// The printed unit in one spelling (`m^2`, `ft`, `count`, `ratio`), with its basis (`m^2/person`).
    pub unit: String,
    /// Which space or object it is about; empty when the text does not say.
    pub space: String,
    /// When it holds, in the words of the text.
    pub conditions: Vec<String>,
    /// How plainly it is said.
    pub confidence: Confidence,
}

/// A constraint and where it stands.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// The rule.
    pub constraint: Constraint,
    /// Bytes of the sentence or table row.
    pub evidence: Range<usize>,
    /// Bytes of the figure.
    pub printed: Range<usize>,
    /// The figure's ends in SI units, for comparing; a ratio's quotient; the figures of a formula.
    pub si: Vec<f64>,
}

impl Finding {
    /// Returns what is said, for the rules of a building's owner.
    pub fn statement(&self) -> Statement {
        let c = &self.constraint;
        Statement {
            name: c.name.clone(),
            constraint_type: c.constraint_type.name().to_owned(),
            value: c.value.clone(),
            unit: c.unit.clone(),
            space: c.space.clone(),
            conditions: c.conditions.clone(),
        }
    }
}

/// Languages that a text is read in when nobody says which it is in.
const LANGUAGES: [&str; 2] = ["en", "de"];

/// Reads text with the shipped vocabulary.
#[derive(Debug)]
pub struct Extractor {
    lexicon: &'static Lexicon,
}

impl Extractor {
    /// Returns the extractor.
    pub fn shared() -> Self {
        Self { lexicon: Lexicon::shared() }
    }

    /// Returns the constraints of a text in its order; `lang` is an ISO 639-1 code or empty.
    ///
    /// The text may be a sentence or a passage of several with headings, lists and tables: a list item is read with the
    /// sentence that leads in, a table with its caption, and a sentence that names no space with the space before it.
    pub fn extract(&self, text: &str, lang: &str) -> Vec<Finding> {
        let lang = lang.get(..2).unwrap_or_default().to_lowercase();
        let mut findings = Vec::new();
        let mut caption = String::new();
        for (range, is_table) in table::split(text) {
            let Some(part) = text.get(range.clone()) else { continue };
            let found = if is_table {
                table::extract(self.lexicon, part, &caption, &lang)
            } else {
                caption = passage::caption(self.lexicon, part, &lang);
                passage::extract(self.lexicon, part, &lang)
            };
            findings.extend(found.into_iter().map(|f| Finding {
                evidence: f.evidence.start + range.start..f.evidence.end + range.start,
                printed: f.printed.start + range.start..f.printed.end + range.start,
                ..f
            }));
        }
        findings
    }

    /// Returns the constraints of a text as [`Self::extract`] does; without a language, those of the reading that names most
    /// spaces, then most constraints, the first language of equals.
    pub fn extract_best(&self, text: &str, lang: Option<&str>) -> Vec<Finding> {
        let languages = lang.map_or(LANGUAGES.to_vec(), |lang| vec![lang]);
        let readings = languages.into_iter().map(|lang| self.extract(text, lang));
        let named =
            |found: &Vec<Finding>| (found.iter().filter(|f| !f.constraint.space.is_empty()).count(), found.len());
        readings.rev().max_by_key(named).unwrap_or_default()
    }
}

/// Returns the value in the form of the knowledge base.
fn value(mention: &Mention) -> Value {
    match &mention.figure {
        Figure::Number(n) => Value::Number(*n),
        Figure::Range(min, max) => Value::Range { min: *min, max: *max },
        Figure::Per(a, b) => Value::Expression { expr: format!("{a} per {b}") },
        Figure::Ratio(expr) | Figure::Formula(expr) => Value::Expression { expr: expr.clone() },
    }
}

fn unit(lexicon: &Lexicon, mention: &Mention) -> String {
    let plain = match (&mention.figure, mention.unit.and_then(|u| lexicon.units.get(u))) {
        (Figure::Ratio(_), _) => return "ratio".into(),
        (Figure::Formula(_), None) if mention.thing.is_none() => return "ratio".into(),
        (_, Some(unit)) => unit.id.as_str(),
        (_, None) => "count",
    };
    mention.basis.as_ref().map_or_else(|| plain.to_owned(), |basis| format!("{plain}/{basis}"))
}

fn si(lexicon: &Lexicon, mention: &Mention) -> Vec<f64> {
    let factor = mention.unit.and_then(|u| lexicon.units.get(u)).map_or(1.0, |u| u.factor);
    match &mention.figure {
        Figure::Number(n) => vec![n * factor],
        Figure::Range(a, b) => vec![a * factor, b * factor],
        Figure::Per(a, b) => vec![a / b],
        Figure::Ratio(expr) => {
            let parts: Vec<f64> = expr.split([':', '/']).filter_map(|p| p.parse().ok()).collect();
            if let [a, b] = parts.as_slice() { vec![a / b] } else { Vec::new() }
        }
        Figure::Formula(expr) => expr.split(' ').filter_map(|p| p.parse().ok()).collect(),
    }
}

#[cfg(test)]
mod tests;
