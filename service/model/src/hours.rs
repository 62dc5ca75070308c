//! Hours of the day of a building, from `data/hours.toml`: who is there, and the words that name them.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use serde::Deserialize;

use crate::domain::{RoleKind, Words};

/// The hour of scenarios that say none.
pub const USUAL: &str = "day";

/// An hour of the day.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hour {
    /// Snake-case id: `shift_change`.
    pub id: String,
    /// Time of the day at its beginning, `HH:MM`.
    pub clock: String,
    /// Name for people, English.
    pub label: String,
    /// Words that name it in prompts, lower case.
    pub keywords: Words,
    /// Share of the people of each kind (`visitor`, `occupant`, `staff`) who are there, of a full day's; 1 where it is not said.
    #[serde(default)]
    pub people: BTreeMap<String, f64>,
    /// How much more often than on a usual day people come in; 1 where it is not said.
    #[serde(default = "usual")]
    pub arrivals: f64,
}

fn usual() -> f64 {
    1.0
}

#[derive(Deserialize)]
struct Hours {
    hours: Vec<Hour>,
}

static HOURS: LazyLock<Vec<Hour>> = LazyLock::new(|| {
    let read: Hours = toml::from_str(include_str!("../data/hours.toml")).expect("a test reads hours.toml");
    read.hours
});

/// Returns all hours, in the order of the day.
pub fn all() -> &'static [Hour] {
    &HOURS
}

/// Returns the hour with this id.
pub fn get(id: &str) -> Option<&'static Hour> {
    HOURS.iter().find(|h| h.id == id)
}

/// Returns the ids of all hours.
pub fn ids() -> Vec<&'static str> {
    HOURS.iter().map(|h| h.id.as_str()).collect()
}

impl Hour {
    /// Returns the share of the people of a kind who are there.
    pub fn share(&self, kind: RoleKind) -> f64 {
        self.people.get(kind.name()).copied().unwrap_or(1.0)
    }
}

/// Returns the hour that a text names, and the words that do: the longest of the first that is found.
pub fn named_in(text: &str) -> Option<(&'static Hour, &'static str)> {
    let text = format!(" {} ", text.to_lowercase().replace(|c: char| !c.is_alphanumeric(), " "));
    let words = |hour: &'static Hour| hour.keywords.values().flatten().map(move |word| (hour, word.as_str()));
    let spaced =
        |word: &str| if word.is_ascii() || !word.chars().any(is_unspaced) { format!(" {word} ") } else { word.into() };
    let said = HOURS.iter().flat_map(words).filter(|(_, word)| text.contains(&spaced(word)));
    // of equal length the first in the order of the day
    said.rev().max_by_key(|(_, word)| word.chars().count())
}

/// Returns true for letters of scripts that put no spaces between words.
fn is_unspaced(c: char) -> bool {
    matches!(c, '\u{3040}'..='\u{9fff}' | '\u{ac00}'..='\u{d7af}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hours_are_named_by_words_of_many_languages() {
        for (text, hour) in [
            ("A busy ward at shift change with two robots", Some("shift_change")),
            ("Station beim Schichtwechsel", Some("shift_change")),
            ("airport gate during boarding", Some("boarding")),
            ("医院换班时", Some("shift_change")),
            ("a night club", None),
            ("office with 10 desks", None),
        ] {
            assert_eq!(named_in(text).map(|(h, _)| h.id.as_str()), hour, "{text}");
        }
        assert!(get(USUAL).is_some());
        let shares = all().iter().flat_map(|h| h.people.iter());
        assert!(
            shares
                .clone()
                .all(|(kind, share)| ["visitor", "occupant", "staff"].contains(&kind.as_str()) && *share >= 0.0)
        );
    }
}
