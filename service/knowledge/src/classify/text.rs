//! Room labels as words: lower case without accents, compounds and camel case split, words that say nothing left out.

use std::collections::BTreeSet;
use std::sync::LazyLock;

use serde::Deserialize;
use unicode_normalization::UnicodeNormalization;
use unicode_normalization::char::is_combining_mark;

/// Words of `data/room_words.toml`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RoomWords {
    generic: BTreeSet<String>,
    little: BTreeSet<String>,
    joints: Vec<String>,
    endings: Vec<String>,
    spellings: Vec<(String, String)>,
}

static WORDS: LazyLock<RoomWords> = LazyLock::new(|| {
    toml::from_str(include_str!("../../data/room_words.toml"))
        .expect("data/room_words.toml is part of the crate and read by its tests")
});

/// Letters that a stem keeps at least when something is taken off its end.
const STEM: usize = 3;
/// The same in scripts whose letters are syllables or words.
const WIDE_STEM: usize = 1;

/// A label or a name of a room type.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Phrase {
    /// Its words, without those that only join others.
    pub words: Vec<String>,
    /// The same without the words for a room as such; empty when it has no other.
    pub core: Vec<String>,
}

impl Phrase {
    /// Returns a text as words.
    pub fn new(text: &str) -> Self {
        let words: Vec<String> = words(text).filter(|w| !WORDS.little.contains(w)).collect();
        let core = words.iter().filter(|w| !WORDS.generic.contains(*w)).map(|w| bare(w).to_owned()).collect();
        Self { words, core }
    }

    /// Returns true for a text that names no kind of room: `Room 101`, `Zimmer`, ``.
    pub fn says_nothing(&self) -> bool {
        self.core.is_empty()
    }

    /// Returns the words as one.
    pub fn whole(&self) -> String {
        self.words.concat()
    }

    /// Returns the words that say something as one.
    pub fn heart(&self) -> String {
        self.core.concat()
    }
}

/// Returns a word and the other forms it may have: singular, other spellings.
pub(super) fn forms(word: &str) -> Vec<String> {
    let mut out = vec![word.to_owned()];
    let least = stem_of(word);
    for ending in &WORDS.endings {
        if let Some(stem) = word.strip_suffix(ending.as_str()).filter(|s| s.chars().count() > least) {
            out.push(stem.to_owned());
        }
    }
    for (written, usual) in &WORDS.spellings {
        if word.contains(written.as_str()) {
            out.push(word.replace(written.as_str(), usual));
        }
    }
    out
}

/// Returns the word without a word for rooms at its end: `besprechungs` of `besprechungsraum`, `手术` of `手术室`.
fn bare(word: &str) -> &str {
    let least = stem_of(word);
    let ends = WORDS.generic.iter().filter(|g| g.chars().count() > WIDE_STEM || is_wide(g));
    let stems = ends.filter_map(|g| word.strip_suffix(g.as_str())).filter(|s| s.chars().count() >= least);
    let Some(stem) = stems.min_by_key(|s| s.len()) else { return word };
    let joint = WORDS.joints.iter().find_map(|j| stem.strip_suffix(j.as_str()));
    joint.filter(|s| !is_wide(s) && s.chars().count() > STEM).unwrap_or(stem)
}

/// Returns how many letters of a word are a word of their own at least.
pub(super) fn stem_of(word: &str) -> usize {
    if is_wide(word) { WIDE_STEM } else { STEM }
}

/// Returns true for scripts that write no spaces between the parts of a compound and whose letters are whole syllables.
pub(super) fn is_wide(word: &str) -> bool {
    word.chars().any(|c| matches!(c, '\u{1100}'..='\u{11ff}' | '\u{2e80}'..='\u{9fff}' | '\u{ac00}'..='\u{d7af}'))
}

/// Returns the words of a text in lower case without accents; numbers are left out, camel case is split.
fn words(text: &str) -> impl Iterator<Item = String> {
    let mut folded = String::with_capacity(text.len() + 8);
    let letters: Vec<char> = text.nfkd().filter(|c| !is_combining_mark(*c)).nfc().collect();
    for (i, &c) in letters.iter().enumerate() {
        let before = i.checked_sub(1).map(|b| letters[b]);
        let lower_follows = letters.get(i + 1).is_some_and(|n| n.is_lowercase());
        let starts = c.is_uppercase() && before.is_some_and(|b| b.is_lowercase() || b.is_uppercase() && lower_follows);
        if starts && before.is_some_and(char::is_alphabetic) {
            folded.push(' ');
        }
        match c {
            'ß' => folded.push_str("ss"),
            'æ' | 'Æ' => folded.push_str("ae"),
            'œ' | 'Œ' => folded.push_str("oe"),
            'ø' | 'Ø' => folded.push('o'),
            'ł' | 'Ł' => folded.push('l'),
            c if c.is_alphabetic() => folded.extend(c.to_lowercase()),
            _ => folded.push(' '),
        }
    }
    let parts: Vec<String> = folded.split_whitespace().map(str::to_owned).collect();
    parts.into_iter()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_words_that_say_something() {
        for (text, words, core) in [
            ("PatientRoom", "patient room", "patient"),
            ("operating_room_2", "operating room", "operating"),
            ("Besprechungsräume", "besprechungsraume", "besprechung"),
            ("salle d'attente", "salle attente", "attente"),
            ("Room 101", "room", ""),
            ("手术室", "手术室", "手术"),
            ("회의실", "회의실", "회의"),
            ("MRIRoom", "mri room", "mri"),
            ("12", "", ""),
        ] {
            let phrase = Phrase::new(text);
            assert_eq!((phrase.words.join(" ").as_str(), phrase.core.join(" ").as_str()), (words, core), "{text}");
        }
        assert!(Phrase::new("Zimmer 3").says_nothing());
    }
}
