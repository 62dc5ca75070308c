//! What a question says: its words, which of them carry it, and the conditions hidden in it.

use std::collections::BTreeSet;

use super::filters::{Filters, Range};
use crate::catalog::Catalog;
use crate::words;

/// A question, read.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Question {
    /// What is searched with: the question without its conditions.
    pub text: String,
    /// Its telling words, singular.
    pub words: Vec<String>,
    /// How many of them stand before what it is for, where or with what: those name the thing.
    pub head: usize,
    /// Conditions found in it.
    pub filters: Filters,
    /// Room types that it names.
    pub room_types: BTreeSet<String>,
    /// Colors that it names.
    pub colors: BTreeSet<String>,
    /// Materials that it names.
    pub materials: BTreeSet<String>,
}

/// Words after which a question says what the thing is for or where it is.
const AFTER_HEAD: &[&str] = &[
    "for", "with", "in", "on", "at", "to", "that", "which", "who", "where", "of", "from", "by", "near", "under",
    "over", "beside", "when", "without", "into", "fur", "mit", "im", "zum", "zur", "auf", "aus", "am", "bei", "um",
    "wo", "das", "der", "die", "neben", "unter", "uber", "ohne",
];
/// Words that carry nothing.
const EMPTY: &[&str] = &[
    "a",
    "an",
    "the",
    "and",
    "or",
    "i",
    "we",
    "you",
    "need",
    "want",
    "find",
    "show",
    "me",
    "some",
    "something",
    "thing",
    "please",
    "is",
    "are",
    "be",
    "can",
    "it",
    "its",
    "my",
    "our",
    "your",
    "their",
    "this",
    "these",
    "those",
    "one",
    "where",
    "ein",
    "eine",
    "einen",
    "einem",
    "einer",
    "und",
    "oder",
    "ich",
    "wir",
    "man",
    "etwas",
    "suche",
    "brauche",
    "den",
    "dem",
    "des",
    "sich",
    "ist",
    "sind",
    "kann",
    "zu",
    "what",
    "how",
    "do",
    "does",
    "not",
    "no",
    "as",
    "used",
    "using",
    "use",
    "place",
    "piece",
    "device",
    "object",
    "item",
];
const COLORS: &[(&str, &str)] = &[
    ("black", "black"),
    ("white", "white"),
    ("gray", "gray"),
    ("grey", "gray"),
    ("red", "red"),
    ("green", "green"),
    ("blue", "blue"),
    ("yellow", "yellow"),
    ("brown", "brown"),
    ("beige", "beige"),
    ("orange", "orange"),
    ("schwarz", "black"),
    ("weiss", "white"),
    ("grau", "gray"),
    ("rot", "red"),
    ("grun", "green"),
    ("blau", "blue"),
    ("gelb", "yellow"),
    ("braun", "brown"),
    ("purple", "purple"),
    ("pink", "pink"),
];
const MATERIALS: &[(&str, &str)] = &[
    ("wooden", "wood"),
    ("wood", "wood"),
    ("metal", "metal"),
    ("steel", "metal"),
    ("leather", "leather"),
    ("plastic", "plastic"),
    ("glass", "glass"),
    ("fabric", "fabric"),
    ("ceramic", "ceramic"),
    ("holz", "wood"),
    ("metall", "metal"),
    ("leder", "leather"),
];

impl Question {
    /// Reads a question.
    pub fn read(text: &str, catalog: &Catalog) -> Self {
        let (text, filters) = conditions(text);
        let mut question = Self { filters, ..Self::plain(&text) };
        let named = |list: &[(&str, &str)]| -> BTreeSet<String> {
            let found = list.iter().filter(|(word, _)| question.words.iter().any(|w| stem_is(w, word)));
            found.map(|(_, kept)| (*kept).to_owned()).collect()
        };
        (question.colors, question.materials) = (named(COLORS), named(MATERIALS));
        let have: BTreeSet<&str> = question.words.iter().map(String::as_str).collect();
        let named = |words: &[String]| !words.is_empty() && words.iter().all(|w| have.contains(w.as_str()));
        let rooms = catalog.room_types().filter(|(_, words)| named(words)).map(|(room, _)| room.to_owned());
        question.room_types = rooms.collect();
        question
    }

    /// Reads a text that has no conditions.
    pub fn plain(text: &str) -> Self {
        let mut question = Self { text: text.trim().to_owned(), ..Self::default() };
        let mut head = None;
        for word in words::split(text) {
            if AFTER_HEAD.contains(&word.as_str()) {
                if !question.words.is_empty() {
                    head = head.or(Some(question.words.len()));
                }
                continue;
            }
            if !EMPTY.contains(&word.as_str()) {
                question.words.push(words::singular(&word));
            }
        }
        question.head = head.unwrap_or(question.words.len());
        question
    }
}

/// Tells whether a word is another with a German or English ending.
fn stem_is(word: &str, stem: &str) -> bool {
    word.strip_prefix(stem).is_some_and(|rest| matches!(rest, "" | "e" | "er" | "es" | "en" | "em"))
}

/// Takes conditions as people type them (`height<1.0`, `mount=wall`) out of a question.
fn conditions(text: &str) -> (String, Filters) {
    let mut filters = Filters::default();
    let mut kept: Vec<&str> = Vec::new();
    for word in text.split_whitespace() {
        let is_condition = word.find(['<', '>', '=']).is_some_and(|at| at > 0);
        if !is_condition || filters.add(word).is_err() {
            kept.push(word);
        }
    }
    let text = measures(&kept, &mut filters);
    (text, filters)
}

/// Takes `under 80 cm wide`, `at least 1.2 m high`, `narrower than 60 cm` out of a question.
fn measures(words: &[&str], filters: &mut Filters) -> String {
    let mut kept: Vec<&str> = Vec::new();
    let mut at = 0;
    while at < words.len() {
        if let Some((used, name, range)) = measure(&words[at..]) {
            filters.numbers.entry(name.to_owned()).or_insert(range);
            at += used;
        } else {
            kept.push(words[at]);
            at += 1;
        }
    }
    kept.join(" ")
}

/// Reads a limit at the beginning of some words: how many words it has, of what, and the limit.
fn measure(words: &[&str]) -> Option<(usize, &'static str, Range)> {
    let lower: Vec<String> = words.iter().take(7).map(|w| w.to_lowercase()).collect();
    let word = |i: usize| lower.get(i).map(|w| w.trim_end_matches([',', '.', ';']));
    let (mut at, most, mut name) = match (word(0)?, word(1), word(2)) {
        ("under" | "below" | "unter" | "maximal" | "hochstens" | "höchstens", ..) => (1, true, None),
        ("at", Some("most"), _) | ("less" | "no" | "not", Some("than" | "more"), _) => (2, true, None),
        ("over" | "above" | "mindestens", ..) => (1, false, None),
        ("at", Some("least"), _) | ("more", Some("than"), _) => (2, false, None),
        ("narrower" | "schmaler", Some("than" | "als"), _) => (2, true, Some("width")),
        ("wider" | "breiter", Some("than" | "als"), _) => (2, false, Some("width")),
        ("lower" | "shorter" | "niedriger", Some("than" | "als"), _) => (2, true, Some("height")),
        ("higher" | "taller" | "höher", Some("than" | "als"), _) => (2, false, Some("height")),
        _ => return None,
    };
    if word(at) == Some("than") {
        at += 1;
    }
    let figure = word(at)?.replace(',', ".");
    let digits = figure.trim_end_matches(|c: char| c.is_alphabetic());
    let value: f64 = digits.parse().ok().filter(|v: &f64| v.is_finite())?;
    let mut unit = &figure[digits.len()..];
    at += 1;
    if unit.is_empty() {
        unit = word(at)?;
        at += 1;
    }
    let factor = match unit {
        "m" | "meter" | "meters" | "metres" => 1.0,
        "cm" | "centimeters" | "zentimeter" => 0.01,
        "mm" => 0.001,
        _ => return None,
    };
    let said = match word(at) {
        Some("wide" | "breit" | "width") => Some("width"),
        Some("deep" | "tief" | "depth") => Some("depth"),
        Some("high" | "tall" | "hoch" | "height") => Some("height"),
        _ => None,
    };
    if said.is_some() {
        at += 1;
        name = said;
    }
    let limit = Some(value * factor);
    let range = if most { Range { min: None, max: limit } } else { Range { min: limit, max: None } };
    Some((at, name?, range))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn questions_are_read() {
        let q =
            Question::read("a red wooden shelf for the living room under 80 cm wide mount=floor", sample::catalog());
        assert_eq!(q.words, ["red", "wooden", "shelf", "living", "room"]);
        assert_eq!(q.head, 3);
        assert_eq!(q.filters.numbers["width"], Range { min: None, max: Some(0.8) });
        assert!(q.filters.facets["mount"].contains("floor"));
        assert!(q.room_types.contains("living_room"), "{:?}", q.room_types);
        assert_eq!((q.colors.len(), q.materials.len()), (1, 1));
        let q = Question::read("Schrank niedriger als 1,2 m", sample::catalog());
        assert_eq!((q.text.as_str(), q.filters.numbers["height"].max), ("Schrank", Some(1.2)));
        for odd in ["", "   ", "under", "under 5", "<", "a<b", "lower than", "=x", "😀 ≤ ∞"] {
            Question::read(odd, sample::catalog());
        }
    }
}
