//! Misspelled words: the nearest word of a language, where only one is near and the word is none itself.

use std::collections::{BTreeMap, BTreeSet};

/// Words shorter than this are not mended: too many others are near.
const SHORTEST: usize = 5;
/// Words from this length on may have two slips.
const LONG: usize = 9;
/// Letters at the beginning of a word of two slips that are right.
const SURE: usize = 3;
/// Words up to this length lack a letter, or have two in the wrong order: with another letter they are other words.
const SHORT: usize = 5;
/// Words up to this length are others with another consonant, or with another ending.
const MEDIUM: usize = 6;
/// Letters that words of one root end in or do not.
const ENDINGS: &str = "aeiosy";
/// Letters that people take for each other in long words.
const VOWELS: &str = "aeiouyаеиоуыэюя";

/// Shortest words that are kept: to know them, not to mend others by them.
const KEPT: usize = 2;

/// The words of a language, by what a misspelling leaves alone: their first letter and about their length.
#[derive(Debug, Clone, Default)]
pub(crate) struct Vocabulary {
    words: BTreeMap<(char, usize), BTreeSet<String>>,
    /// Words that are near others and right.
    lookalikes: BTreeSet<String>,
}

impl Vocabulary {
    pub fn new(lookalikes: &[String]) -> Self {
        Self { words: BTreeMap::new(), lookalikes: lookalikes.iter().cloned().collect() }
    }

    pub fn add(&mut self, word: &str) {
        let length = word.chars().count();
        if length >= KEPT
            && let Some(first) = word.chars().next()
        {
            self.words.entry((first, length)).or_default().insert(word.to_owned());
        }
    }

    /// Returns true for words that stand in the lexicon as they are.
    pub fn has(&self, word: &str) -> bool {
        let key = word.chars().next().map(|first| (first, word.chars().count()));
        key.and_then(|key| self.words.get(&key)).is_some_and(|words| words.contains(word))
    }

    /// Returns the word that a misspelled one was meant to be, and nothing where it is right, short, or near to several.
    pub fn mend(&self, word: &str) -> Option<&str> {
        let length = word.chars().count();
        if length < SHORTEST || self.lookalikes.contains(word) {
            return None;
        }
        let slips = if length >= LONG { 2 } else { 1 };
        let first = word.chars().next()?;
        let mut best: Option<(usize, &str, bool)> = None;
        for near in length.saturating_sub(slips).max(SHORTEST - 1)..=length + slips {
            for known in self.words.get(&(first, near)).into_iter().flatten() {
                if apart(word, known) > 2 * slips {
                    continue;
                }
                let slipped = strsim::osa_distance(word, known);
                if slipped == 0 || slipped > slips || !is_slip(word, known, slipped) {
                    continue;
                }
                match best {
                    Some((least, ..)) if slipped > least => {}
                    // "bedrooms" and "bedroom" are one answer
                    Some((least, old, alone)) if slipped == least => {
                        best = Some((least, old, alone && akin(old, known)))
                    }
                    _ => best = Some((slipped, known, true)),
                }
            }
        }
        best.filter(|b| b.2).map(|b| b.1)
    }
}

/// Returns true where a word is likely to be typed for another: not "looks" for "loos", "boten" for "boven", "direct" for "directe".
fn is_slip(word: &str, meant: &str, slips: usize) -> bool {
    let (written, right): (Vec<char>, Vec<char>) = (word.chars().collect(), meant.chars().collect());
    let same = written.iter().zip(&right).take_while(|(a, b)| a == b).count();
    let is_longer = same == written.len() || same == right.len();
    let (more, less) = (lacking(&written, &right), lacking(&right, &written));
    let consonant = |letters: &[char]| letters.iter().any(|c| !VOWELS.contains(*c));
    // one consonant for another makes another word
    let replaced = !more.is_empty() && !less.is_empty() && (consonant(&more) || consonant(&less));
    if slips > 1 {
        return same >= SURE && !is_longer && !replaced;
    }
    let doubled = || same > 0 && written.get(same) == written.get(same - 1);
    if written.len() > MEDIUM {
        return true;
    }
    // the form of one word, which the endings of a language would have told
    let form = is_longer && more.iter().chain(&less).all(|c| ENDINGS.contains(*c));
    let longer = written.len() <= SHORT && !doubled();
    !form && (more.is_empty() || less.is_empty() && !longer)
}

/// Returns the letters that one word has more of than another.
fn lacking(word: &[char], of: &[char]) -> Vec<char> {
    let mut left = of.to_vec();
    let more = word.iter().filter(|c| match left.iter().position(|l| l == *c) {
        Some(at) => {
            left.swap_remove(at);
            false
        }
        None => true,
    });
    more.copied().collect()
}

/// Returns how many kinds of letters one of two words has and the other lacks: never more than twice their distance.
fn apart(a: &str, b: &str) -> usize {
    let letters = |word: &str| word.chars().fold(0u64, |set, c| set | 1 << (u32::from(c) % 61));
    (letters(a) ^ letters(b)).count_ones() as usize
}

/// Returns true when two words are forms of one.
fn akin(a: &str, b: &str) -> bool {
    let same = a.chars().zip(b.chars()).take_while(|(x, y)| x == y).count();
    let (long, short) = (a.chars().count().max(b.chars().count()), a.chars().count().min(b.chars().count()));
    same + 1 >= short && long - same <= 3
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_near_word_is_meant_and_two_are_not() {
        let mut words = Vocabulary::new(&["bathrobe".to_owned()]);
        [
            "bedroom",
            "bedrooms",
            "bathroom",
            "garage",
            "kitchen",
            "office",
            "house",
            "loos",
            "directe",
            "audiology",
            "change",
            "restaurant",
            "spielsaal",
        ]
        .iter()
        .for_each(|w| words.add(w));
        for (written, meant) in [
            ("bedrom", Some("bedroom")),
            ("garrage", Some("garage")),
            ("kithcen", Some("kitchen")),
            ("batroom", Some("bathroom")),
            ("kitten", None),
            ("ofice", Some("office")),
            ("hosue", Some("house")),
            ("housse", Some("house")),
            ("horse", None),
            ("looks", None),
            ("direct", None),
            ("andrology", None),
            ("charge", None),
            ("resturaunt", Some("restaurant")),
            ("spinnsaal", None),
            ("garden", None),
            ("room", None),
            ("bathrobe", None),
        ] {
            assert_eq!(words.mend(written), meant, "{written}");
        }
    }
}
