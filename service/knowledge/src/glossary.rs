//! Questions about rules in the languages of prompts: which spaces and quantities they name, and how well a rule fits them.
//!
//! Words for rooms come from domains, all others from `data/words.toml`. Rules themselves are written in English; nothing
//! here looks at an index.

mod phrases;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::LazyLock;

use d3dgen_model::domain::{Domain, Words};
use d3dgen_model::knowledge::Constraint;
use serde::Deserialize;

use phrases::{Phrases, tokens};

/// Languages that questions are read in, in English.
pub const LANGUAGES: &str = "English, German, French, Spanish, Chinese and Korean";

/// Space of rules for rooms of every kind.
const ANY_ROOM: &str = "all_rooms";
/// What a mark counts against a space or a quantity.
const MARK_WEIGHT: f64 = 0.35;
/// Least share of what is asked that an answer fulfills.
const FLOOR: f64 = 0.5;

static SHIPPED: LazyLock<File> = LazyLock::new(|| {
    toml::from_str(include_str!("../data/words.toml"))
        .expect("data/words.toml is part of the crate and read by its tests")
});

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    term: Vec<Row>,
    filler: Words,
}

#[derive(Deserialize)]
struct Row {
    #[serde(flatten)]
    term: Term,
    #[serde(flatten)]
    words: Words,
}

/// What a term is to a question.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Kind {
    /// What it is about.
    Space,
    /// What of it is asked.
    Quantity,
    /// What narrows it down.
    Mark,
}

/// Something that rules speak of.
#[derive(Debug, Clone, Deserialize)]
struct Term {
    kind: Kind,
    #[serde(default)]
    spaces: BTreeSet<String>,
    #[serde(default)]
    wider: BTreeSet<String>,
    #[serde(default)]
    names: BTreeSet<String>,
    #[serde(default)]
    units: BTreeSet<String>,
}

/// The words of the languages of prompts for what rules speak of.
#[derive(Debug)]
pub struct Glossary {
    terms: Vec<Term>,
    phrases: Phrases,
}

impl Glossary {
    /// Returns the shipped words with those that domains have for their rooms.
    pub fn of<'a>(domains: impl IntoIterator<Item = &'a Domain>) -> Self {
        let mut glossary = Self { terms: Vec::new(), phrases: Phrases::default() };
        for word in SHIPPED.filler.values().flatten() {
            glossary.phrases.add_filler(word);
        }
        for row in &SHIPPED.term {
            glossary.add(row.term.clone(), &row.words);
        }
        for room in domains.into_iter().flat_map(|d| &d.room_types) {
            // the first of its spaces is its own, others are what it is one of
            let (own, wider) = room.spaces.split_at(room.spaces.len().min(1));
            let term = Term {
                kind: Kind::Space,
                spaces: own.iter().cloned().chain([room.id.clone()]).collect(),
                wider: wider.iter().cloned().collect(),
                names: BTreeSet::new(),
                units: BTreeSet::new(),
            };
            glossary.add(term, &room.keywords);
        }
        glossary
    }

    fn add(&mut self, term: Term, words: &Words) {
        let at = self.terms.len();
        self.terms.push(term);
        for phrase in words.values().flatten() {
            self.phrases.add(phrase, at);
        }
    }

    /// Returns what a question asks for.
    pub fn read(&self, text: &str) -> Question<'_> {
        let read = self.phrases.read(&tokens(text));
        let mut asked: Vec<Asked<'_>> = Vec::new();
        for places in read.terms {
            let terms: Vec<&Term> = places.iter().filter_map(|&at| self.terms.get(at)).collect();
            let kind = match terms.iter().any(|t| t.kind == Kind::Space) {
                true => Kind::Space,
                false if terms.iter().any(|t| t.kind == Kind::Quantity) => Kind::Quantity,
                false => Kind::Mark,
            };
            asked.push(Asked { kind, terms });
        }
        Question { asked, unread: read.unread }
    }
}

/// A phrase of a question with all it may mean.
#[derive(Debug)]
struct Asked<'a> {
    kind: Kind,
    terms: Vec<&'a Term>,
}

/// A question that was read.
#[derive(Debug)]
pub struct Question<'a> {
    asked: Vec<Asked<'a>>,
    /// Words that mean nothing here, as they were written but for case and accents: names of standards, other languages.
    pub unread: Vec<String>,
}

impl Question<'_> {
    /// Returns whether it names a space or a quantity.
    pub fn is_understood(&self) -> bool {
        self.asked.iter().any(|a| a.kind != Kind::Mark)
    }

    /// Returns the words under which rules are written that may answer it.
    pub fn in_words_of_rules(&self) -> String {
        let mut words: Vec<&str> = Vec::new();
        for term in self.asked.iter().flat_map(|a| &a.terms) {
            let of_term = term.spaces.iter().chain(&term.names).flat_map(|name| name.split('_'));
            for word in of_term {
                if !words.contains(&word) {
                    words.push(word);
                }
            }
        }
        words.extend(self.unread.iter().map(String::as_str));
        words.join(" ")
    }

    /// Returns which share of what is asked a rule answers, 0 to 1; none below what is an answer at all.
    pub fn fit(&self, c: &Constraint) -> Option<f64> {
        let said = Said::of(c);
        let (mut got, mut whole) = (0.0, 0.0);
        let mut best: BTreeMap<u8, f64> = BTreeMap::new();
        for asked in &self.asked {
            let fits = asked.terms.iter().map(|t| t.fit(c, &said)).fold(0.0, f64::max);
            let weight = if asked.kind == Kind::Mark { MARK_WEIGHT } else { 1.0 };
            got += weight * fits;
            whole += weight;
            let of_kind = best.entry(asked.kind as u8).or_default();
            *of_kind = of_kind.max(fits);
        }
        // a rule on another space is no answer, nor one on another quantity where no space is named
        let kind = if best.contains_key(&(Kind::Space as u8)) { Kind::Space } else { Kind::Quantity };
        let on_subject = best.get(&(kind as u8)).is_some_and(|fits| *fits > 0.0);
        let share = if whole > 0.0 { got / whole } else { 0.0 };
        (on_subject && share >= FLOOR).then_some(share)
    }
}

/// The words of a rule, each place of them by itself.
struct Said {
    name: BTreeSet<String>,
    rest: BTreeSet<String>,
    space: BTreeSet<String>,
}

impl Said {
    fn of(c: &Constraint) -> Self {
        let words = |text: &str| {
            text.split(|l: char| !l.is_alphanumeric()).filter(|w| !w.is_empty()).map(str::to_lowercase).collect()
        };
        let rest: BTreeSet<String> = words(&format!("{} {}", c.measurement_basis, c.conditions.join(" ")));
        Self { name: words(&c.name), rest, space: words(&c.space_type) }
    }
}

impl Term {
    /// Returns how well a rule fits, 0 to 1.
    fn fit(&self, c: &Constraint, said: &Said) -> f64 {
        let named = |words: &BTreeSet<String>, text: &str| {
            self.names.iter().any(|n| if n.contains('_') { text.contains(n.as_str()) } else { words.contains(n) })
        };
        let mut fits: f64 = 0.0;
        if self.spaces.contains(&c.space_type) || named(&said.name, &c.name) {
            fits = 1.0;
        } else if self.units.contains(&c.unit) {
            fits = 0.8;
        } else if named(&said.rest, &c.measurement_basis) {
            fits = 0.7;
        } else if self.kind == Kind::Mark && self.names.iter().any(|n| said.space.contains(n)) {
            fits = 1.0;
        }
        if fits == 0.0 && self.kind == Kind::Space {
            let part_of = |space: &String| space.split('_').all(|w| said.space.contains(w));
            if self.spaces.iter().any(part_of) || self.names.iter().any(|n| said.space.contains(n)) {
                fits = 0.7;
            } else if self.wider.contains(&c.space_type) {
                fits = 0.5;
            } else if c.space_type == ANY_ROOM {
                fits = 0.4;
            }
        }
        fits
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_language_has_words_for_every_term() {
        for row in &SHIPPED.term {
            let languages: Vec<&str> = row.words.keys().map(String::as_str).collect();
            assert_eq!(languages, ["de", "en", "es", "fr", "ko", "zh"], "{:?}", row.term);
        }
    }

    #[test]
    fn a_question_means_the_same_in_every_language() {
        let glossary = Glossary::of([]);
        let meaning = |text: &str| {
            let question = glossary.read(text);
            assert!(question.unread.is_empty(), "{text}: {:?}", question.unread);
            let kinds = question.asked.iter().map(|a| a.terms.iter().map(|t| format!("{t:?}")).collect::<Vec<_>>());
            kinds.collect::<BTreeSet<_>>()
        };
        for same in [
            ["corridor width", "Breite des Flurs", "largeur du couloir", "anchura del pasillo"],
            ["slope of the ramp", "Neigung der Rampe", "pente de la rampe", "pendiente de la rampa"],
        ] {
            let first = meaning(same[0]);
            for text in same {
                assert_eq!(meaning(text), first, "{text}");
            }
        }
        assert_eq!(meaning("走廊宽度"), meaning("복도 폭"));
        assert_eq!(meaning("Flurbreite"), meaning("Breite von Fluren"));
        assert_eq!(meaning("Treppen-Breite"), meaning("계단 너비"));
    }

    #[test]
    fn what_is_in_no_language_is_left_unread() {
        let glossary = Glossary::of([]);
        for text in ["bredden på trappen", "szerokość korytarza", "qwertz"] {
            let question = glossary.read(text);
            assert!(!question.is_understood(), "{text}: {question:?}");
            assert!(!question.unread.is_empty(), "{text}");
        }
    }
}
