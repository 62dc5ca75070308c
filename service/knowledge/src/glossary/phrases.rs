//! Finding known phrases in a question: plurals, compounds, and languages that write no spaces.

use std::collections::{BTreeMap, BTreeSet};

use unicode_normalization::UnicodeNormalization;
use unicode_normalization::char::is_combining_mark;

/// Shortest stem that an ending is taken from, in letters.
const SHORTEST_STEM: usize = 3;
/// Shortest part of a compound, in letters.
const SHORTEST_PART: usize = 3;
/// Shortest last part of a compound whose first one is not known.
const SHORTEST_HEAD: usize = 5;
/// What may stand between the parts of a compound.
const JOINTS: [&str; 6] = ["", "s", "n", "en", "es", "e"];
/// Endings of plurals and cases, the longest first.
const ENDINGS: [&str; 6] = ["en", "es", "n", "e", "s", "x"];

/// A word, or one character of a language that writes no spaces or hangs its particles on words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Token {
    /// As it was written, but for case and accents.
    text: String,
    /// The same without its ending.
    stem: String,
    /// False inside a word.
    begins: bool,
}

/// Phrases with what they mean, by their first token.
#[derive(Debug, Default)]
pub(super) struct Phrases {
    by_first: BTreeMap<String, Vec<Phrase>>,
    filler: BTreeSet<Vec<String>>,
}

/// The stems of a phrase and what it means.
#[derive(Debug)]
struct Phrase {
    stems: Vec<String>,
    meaning: BTreeSet<usize>,
}

/// What was read in a question.
#[derive(Debug, Default)]
pub(super) struct Read {
    /// The meanings of each phrase.
    pub terms: Vec<BTreeSet<usize>>,
    /// Words that mean nothing.
    pub unread: Vec<String>,
}

impl Phrases {
    pub fn add(&mut self, phrase: &str, meaning: usize) {
        let stems: Vec<String> = tokens(phrase).into_iter().map(|t| t.stem).collect();
        let Some(first) = stems.first() else { return };
        let list = self.by_first.entry(first.clone()).or_default();
        match list.iter_mut().find(|p| p.stems == stems) {
            Some(known) => {
                known.meaning.insert(meaning);
            }
            None => list.push(Phrase { stems, meaning: [meaning].into() }),
        }
    }

    pub fn add_filler(&mut self, word: &str) {
        self.filler.insert(tokens(word).into_iter().map(|t| t.text).collect());
    }

    /// Reads the longest phrase at each place. Words that say nothing are passed over, other unknown ones are kept.
    pub fn read(&self, tokens: &[Token]) -> Read {
        let mut read = Read::default();
        let mut at = 0;
        while let Some(token) = tokens.get(at) {
            let rest = tokens.get(at..).unwrap_or_default();
            if let Some((length, meaning)) = self.at(rest) {
                read.terms.push(meaning.clone());
                at += length;
                continue;
            }
            if let Some(length) = (1..=4).rev().find(|&n| self.is_filler(rest, n)) {
                at += length;
                continue;
            }
            let parts = self.parts(&token.text);
            if parts.is_empty() {
                // the rest of a word of single characters belongs to it
                match read.unread.last_mut() {
                    Some(word) if !token.begins && at > 0 => word.push_str(&token.text),
                    _ => read.unread.push(token.text.clone()),
                }
            }
            read.terms.extend(parts);
            at += 1;
        }
        read
    }

    /// Returns the longest phrase at the beginning with its length.
    fn at(&self, tokens: &[Token]) -> Option<(usize, &BTreeSet<usize>)> {
        let first = tokens.first()?;
        let fits = |phrase: &[String]| {
            let same = phrase.len() <= tokens.len() && phrase.iter().zip(tokens).all(|(p, t)| *p == t.stem);
            // one syllable of Korean is a word of its own only where a word begins
            same && !(phrase.len() == 1 && is_syllable(&first.text) && !first.begins)
        };
        let list = self.by_first.get(&first.stem)?;
        list.iter().filter(|p| fits(&p.stems)).max_by_key(|p| p.stems.len()).map(|p| (p.stems.len(), &p.meaning))
    }

    fn is_filler(&self, tokens: &[Token], length: usize) -> bool {
        tokens
            .get(..length)
            .is_some_and(|t| self.filler.contains(&t.iter().map(|t| t.text.clone()).collect::<Vec<_>>()))
    }

    fn single(&self, word: &str) -> Option<&BTreeSet<usize>> {
        let list = self.by_first.get(&stem(word))?;
        list.iter().find(|p| p.stems.len() == 1).map(|p| &p.meaning)
    }

    /// Returns the meanings of the parts of a compound; of its last part alone where the first is not known.
    fn parts(&self, word: &str) -> Vec<BTreeSet<usize>> {
        let cuts: Vec<usize> = word.char_indices().map(|(at, _)| at).skip(SHORTEST_PART).collect();
        let mut tail = None;
        for at in cuts {
            let (first, last) = word.split_at(at);
            if last.chars().count() < SHORTEST_PART {
                break;
            }
            let Some(meaning) = self.single(last) else { continue };
            let known = JOINTS.iter().find_map(|joint| {
                let first = first.strip_suffix(joint).filter(|f| f.chars().count() >= SHORTEST_PART)?;
                self.single(first).map(|m| vec![m.clone()]).or_else(|| Some(self.parts(first)).filter(|p| p.len() > 1))
            });
            if let Some(mut parts) = known {
                parts.push(meaning.clone());
                return parts;
            }
            if tail.is_none() && last.chars().count() >= SHORTEST_HEAD {
                tail = Some(meaning.clone());
            }
        }
        tail.into_iter().collect()
    }
}

/// Cuts a text into words without case and accents; Chinese and Korean into characters.
pub(super) fn tokens(text: &str) -> Vec<Token> {
    let bare: String = text.nfkd().filter(|c| !is_combining_mark(*c)).collect();
    let mut found: Vec<Token> = Vec::new();
    let mut word = String::new();
    let mut begins = true;
    fn end(word: &mut String, begins: bool, found: &mut Vec<Token>) {
        if !word.is_empty() {
            found.push(Token { stem: stem(word), text: std::mem::take(word), begins });
        }
    }
    for c in bare.nfc().flat_map(char::to_lowercase) {
        if is_dense(c) {
            end(&mut word, true, &mut found);
            found.push(Token { text: c.to_string(), stem: c.to_string(), begins });
            begins = false;
        } else if c.is_alphanumeric() {
            match c {
                'ß' => word.push_str("ss"),
                c => word.push(c),
            }
        } else {
            end(&mut word, true, &mut found);
            begins = true;
        }
    }
    end(&mut word, true, &mut found);
    found
}

/// Returns a word without the endings of plurals and cases.
fn stem(word: &str) -> String {
    let mut stem = word;
    while let Some(shorter) = ENDINGS
        .iter()
        .find_map(|ending| stem.strip_suffix(ending))
        .filter(|s| s.chars().count() >= SHORTEST_STEM && !s.starts_with(|c: char| c.is_ascii_digit()))
    {
        stem = shorter;
    }
    stem.to_owned()
}

/// Returns whether a character is a token by itself.
fn is_dense(c: char) -> bool {
    matches!(u32::from(c), 0x2E80..=0x2FDF | 0x3040..=0x30FF | 0x3400..=0x4DBF | 0x4E00..=0x9FFF | 0xAC00..=0xD7AF | 0xF900..=0xFAFF | 0x20000..=0x2FA1F)
}

fn is_syllable(text: &str) -> bool {
    text.starts_with(|c| matches!(u32::from(c), 0xAC00..=0xD7AF))
}
