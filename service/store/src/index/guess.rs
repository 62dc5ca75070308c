//! What a word of a question may mean when no document has it: a word with one letter wrong, or the parts of a German
//! compound. Only words that occur are guessed.

use std::collections::BTreeMap;
use std::io;
use std::sync::OnceLock;

use tantivy::termdict::TermDictionary;

use super::analyze::Word;

/// Shorter words have too many neighbors to guess which was meant.
const SHORTEST_FUZZY: usize = 5;
/// Shortest part of a compound, and what may stand between parts.
const SHORTEST_PART: usize = 3;
const JOINTS: [&str; 5] = ["", "s", "n", "en", "es"];
/// Most words that one is replaced with; the more frequent ones.
const GUESSES_MOST: usize = 6;

/// The words of all fields that a guess may end in, by their length in bytes, with how many documents have each.
#[derive(Default)]
pub(crate) struct Vocabulary {
    by_length: Vec<BTreeMap<String, u32>>,
}

impl Vocabulary {
    /// Reads the dictionaries through; numbers and codes are left out, nobody means them by a word.
    pub(crate) fn new(dictionaries: &[&TermDictionary]) -> io::Result<Self> {
        let mut vocabulary = Self::default();
        for dictionary in dictionaries {
            let mut terms = dictionary.stream()?;
            while terms.advance() {
                let Ok(term) = std::str::from_utf8(terms.key()) else { continue };
                if !term.chars().all(char::is_alphabetic) {
                    continue;
                }
                if vocabulary.by_length.len() <= term.len() {
                    vocabulary.by_length.resize_with(term.len() + 1, BTreeMap::new);
                }
                if let Some(words) = vocabulary.by_length.get_mut(term.len()) {
                    *words.entry(term.to_owned()).or_default() += terms.value().doc_freq;
                }
            }
        }
        Ok(vocabulary)
    }

    /// Returns the most frequent words one slip away. The first letter may be wrong too, so all words of about this
    /// length are looked at.
    fn similar(&self, text: &str) -> Vec<String> {
        let wanted: Vec<char> = text.chars().collect();
        // One letter is at most four bytes.
        let lengths = text.len().saturating_sub(4)..(text.len() + 5).min(self.by_length.len());
        let words = self.by_length.get(lengths).unwrap_or_default().iter().flatten();
        let mut found: Vec<(&String, &u32)> = words.filter(|(term, _)| one_slip(&wanted, term)).collect();
        found.sort_by(|a, b| b.1.cmp(a.1).then_with(|| a.0.cmp(b.0)));
        found.into_iter().take(GUESSES_MOST).map(|(term, _)| term.clone()).collect()
    }
}

/// Looks words up in the dictionaries of all fields.
pub(crate) struct Guesser<'a> {
    dictionaries: Vec<&'a TermDictionary>,
    vocabulary: &'a OnceLock<Vocabulary>,
}

impl<'a> Guesser<'a> {
    /// `vocabulary` is filled when the first word has to be guessed: most questions need none.
    pub(crate) fn new(dictionaries: Vec<&'a TermDictionary>, vocabulary: &'a OnceLock<Vocabulary>) -> Self {
        Self { dictionaries, vocabulary }
    }

    pub(crate) fn occurs(&self, term: &str) -> io::Result<bool> {
        for dictionary in &self.dictionaries {
            if dictionary.get(term)?.is_some() {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Returns terms that occur and may be meant by a word that does not.
    pub(crate) fn guess(&self, word: &Word) -> io::Result<Vec<String>> {
        let text = word.text();
        if text.chars().count() < SHORTEST_FUZZY || !text.chars().all(char::is_alphabetic) {
            return Ok(Vec::new());
        }
        let vocabulary = match self.vocabulary.get() {
            Some(vocabulary) => vocabulary,
            None => {
                let read = Vocabulary::new(&self.dictionaries)?;
                self.vocabulary.get_or_init(|| read)
            }
        };
        let similar = vocabulary.similar(text);
        if similar.is_empty() { self.parts(text) } else { Ok(similar) }
    }

    /// Returns the two parts of a compound that both occur; of several ways to cut, the one with the longest first part.
    fn parts(&self, text: &str) -> io::Result<Vec<String>> {
        let cuts: Vec<usize> = text.char_indices().map(|(at, _)| at).collect();
        for at in cuts.into_iter().rev() {
            let (first, second) = text.split_at(at);
            if second.chars().count() < SHORTEST_PART || first.chars().count() < SHORTEST_PART {
                continue;
            }
            if !self.occurs(second)? {
                continue;
            }
            for joint in JOINTS {
                if let Some(first) = first.strip_suffix(joint)
                    && first.chars().count() >= SHORTEST_PART
                    && self.occurs(first)?
                {
                    return Ok(vec![first.to_owned(), second.to_owned()]);
                }
            }
        }
        Ok(Vec::new())
    }
}

/// Whether a word becomes the term by one letter added, left out, replaced, or swapped with the next.
fn one_slip(word: &[char], term: &str) -> bool {
    let term: Vec<char> = term.chars().collect();
    let same = word.iter().zip(&term).take_while(|(a, b)| a == b).count();
    let (a, b) = (word.get(same..).unwrap_or_default(), term.get(same..).unwrap_or_default());
    match (a, b) {
        ([], []) => false,
        ([], [_]) | ([_], []) => true,
        ([x, a_rest @ ..], [y, b_rest @ ..]) => {
            let swapped = || match (a_rest, b_rest) {
                ([x2, a_rest @ ..], [y2, b_rest @ ..]) => x == y2 && y == x2 && a_rest == b_rest,
                _ => false,
            };
            a_rest == b_rest || a_rest == b || a == b_rest || swapped()
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_is_one_letter() {
        let slip = |a: &str, b: &str| one_slip(&a.chars().collect::<Vec<_>>(), b);
        for near in ["coridor", "corridors", "corrjdor", "corrdior", "ocrridor", "orridor", "corrido"] {
            assert!(slip(near, "corridor") && slip("corridor", near), "{near}");
        }
        for far in ["corridor", "coridoor", "crridors", "rocridro", ""] {
            assert!(!slip(far, "corridor"), "{far}");
        }
    }
}
