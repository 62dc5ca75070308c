//! Splits a text into the tokens of the teacher's vocabulary: uncased BERT cleaning, then the longest pieces first.
//!
//! Not a tokenizer for transformers: it knows no special tokens and no limit of length. The crate `tokenizers` does
//! the same, but needs 40 further crates and parses 30,000 entries of JSON at each start; the tests hold this one to
//! what `tokenizers` answers (`golden_tokens.json`, made by `embedder/golden_tokens.py`).

use std::collections::HashMap;

use unicode_normalization::UnicodeNormalization;
use unicode_properties::{GeneralCategory, GeneralCategoryGroup, UnicodeGeneralCategory};

/// Longer words are unknown as a whole, in the teacher as here.
const LONGEST_WORD: usize = 100;

const UNKNOWN: &str = "[UNK]";

/// The vocabulary; tokens are numbered by their line.
pub(crate) struct WordPiece {
    whole: HashMap<&'static str, u32>,
    /// Pieces that continue a word, without their `##`.
    rest: HashMap<&'static str, u32>,
    unknown: Option<u32>,
}

impl WordPiece {
    /// Reads a vocabulary of one token a line.
    pub(crate) fn new(vocabulary: &'static str) -> Self {
        let mut whole = HashMap::with_capacity(1 << 15);
        let mut rest = HashMap::with_capacity(1 << 13);
        for (id, token) in (0..).zip(vocabulary.lines()) {
            match token.strip_prefix("##") {
                // `##` itself is a word of two signs.
                Some(piece) if !piece.is_empty() => rest.insert(piece, id),
                _ => whole.insert(token, id),
            };
        }
        let unknown = whole.get(UNKNOWN).copied();
        Self { whole, rest, unknown }
    }

    /// Calls `found` with each token of a text, in order.
    pub(crate) fn tokens(&self, text: &str, mut found: impl FnMut(u32)) {
        let mut word = String::new();
        for c in clean(text) {
            if c.is_whitespace() {
                self.pieces(&word, &mut found);
                word.clear();
            } else if is_punctuation(c) {
                self.pieces(&word, &mut found);
                word.clear();
                self.pieces(c.encode_utf8(&mut [0; 4]), &mut found);
            } else {
                word.push(c);
            }
        }
        self.pieces(&word, &mut found);
    }

    /// Splits one word, or finds it unknown: then none of its pieces counts.
    fn pieces(&self, word: &str, found: &mut impl FnMut(u32)) {
        if word.is_empty() {
            return;
        }
        if let Some(&id) = self.whole.get(word) {
            return found(id);
        }
        let mut ids = Vec::new();
        let mut left = if word.chars().count() > LONGEST_WORD { "" } else { word };
        while !left.is_empty() {
            let known = if ids.is_empty() { &self.whole } else { &self.rest };
            let ends = left.char_indices().rev().map(|(i, c)| i + c.len_utf8());
            let longest = ends.filter_map(|end| left.split_at_checked(end)).find_map(|(piece, after)| {
                let id = known.get(piece)?;
                Some((*id, after))
            });
            let Some((id, after)) = longest else {
                ids.clear();
                break;
            };
            ids.push(id);
            left = after;
        }
        if ids.is_empty() {
            ids.extend(self.unknown);
        }
        ids.into_iter().for_each(found);
    }
}

/// Yields the text without control characters and accents, in lower case, with CJK characters set apart.
fn clean(text: &str) -> impl Iterator<Item = char> {
    text.chars()
        .filter(|&c| !is_removed(c))
        .flat_map(|c| {
            let apart = is_cjk(c).then_some(' ');
            apart.into_iter().chain([if c.is_whitespace() { ' ' } else { c }]).chain(apart)
        })
        .nfd()
        .filter(|c| c.general_category() != GeneralCategory::NonspacingMark)
        .flat_map(char::to_lowercase)
}

fn is_removed(c: char) -> bool {
    match c {
        '\t' | '\n' | '\r' => false,
        '\u{fffd}' => true,
        // Unassigned characters are words, so that those of later Unicode versions are.
        _ => {
            c.general_category_group() == GeneralCategoryGroup::Other
                && c.general_category() != GeneralCategory::Unassigned
        }
    }
}

fn is_punctuation(c: char) -> bool {
    c.is_ascii_punctuation() || c.general_category_group() == GeneralCategoryGroup::Punctuation
}

fn is_cjk(c: char) -> bool {
    // The blocks of the teacher's tokenizer, with the gap it has from U+2B820 on.
    const BLOCKS: [(u32, u32); 8] = [
        (0x4E00, 0x9FFF),
        (0x3400, 0x4DBF),
        (0x20000, 0x2A6DF),
        (0x2A700, 0x2B73F),
        (0x2B740, 0x2B81F),
        (0x2B920, 0x2CEAF),
        (0xF900, 0xFAFF),
        (0x2F800, 0x2FA1F),
    ];
    BLOCKS.iter().any(|&(first, last)| (first..=last).contains(&u32::from(c)))
}

#[cfg(test)]
mod tests {
    use serde_json::Value;

    use super::*;
    use crate::embed::table::VOCABULARY;

    fn tokens(word_piece: &WordPiece, text: &str) -> Vec<&'static str> {
        let names: Vec<&str> = VOCABULARY.lines().collect();
        let mut found = Vec::new();
        word_piece.tokens(text, |id| found.push(names[id as usize]));
        found
    }

    #[test]
    fn equals_the_teachers_tokenizer() {
        let word_piece = WordPiece::new(VOCABULARY);
        let golden: Vec<Value> = serde_json::from_str(include_str!("golden_tokens.json")).unwrap();
        assert!(golden.len() > 80);
        for case in golden {
            let expected: Vec<&str> = case["tokens"].as_array().unwrap().iter().map(|t| t.as_str().unwrap()).collect();
            let text = case["text"].as_str().unwrap();
            assert_eq!(tokens(&word_piece, text), expected, "{text:?}");
        }
    }

    #[test]
    fn names_of_special_tokens_in_a_text_are_ordinary_signs() {
        let word_piece = WordPiece::new(VOCABULARY);
        assert_eq!(tokens(&word_piece, "[CLS]"), ["[", "cl", "##s", "]"]);
    }
}
