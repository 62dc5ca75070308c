//! Runs of tokens, and what they stand for.

use std::ops::Range;

/// One of the things that a run of tokens stands for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sense<'l> {
    /// For instance `room`.
    pub class: &'l str,
    /// For instance `kitchen`.
    pub value: &'l str,
    /// Code of the language that says so.
    pub language: &'l str,
    /// False when the words are forms of those of the lexicon.
    pub exact: bool,
}

/// A run of tokens that is taken as one: an entry of the lexicon, a number, a mark, or a word that nobody knows.
#[derive(Debug, Clone, PartialEq)]
pub struct Chunk<'l> {
    /// Which tokens of the reading.
    pub tokens: Range<usize>,
    /// What it may stand for; empty for words that nobody knows.
    pub senses: Vec<Sense<'l>>,
    /// Its value when it is a number.
    pub number: Option<f64>,
    /// Its tokens as they are looked up, with a space between words.
    pub text: String,
}

impl<'l> Chunk<'l> {
    /// Returns true when it may stand for a value of a class.
    pub fn is(&self, class: &str, value: &str) -> bool {
        self.senses.iter().any(|s| s.class == class && s.value == value)
    }

    /// Returns true when it may stand for something of a class.
    pub fn has(&self, class: &str) -> bool {
        self.senses.iter().any(|s| s.class == class)
    }

    /// Returns the values that it may stand for in a class, the likeliest first.
    pub fn values<'a>(&'a self, class: &'a str) -> impl Iterator<Item = &'l str> + 'a {
        self.senses.iter().filter(move |s| s.class == class).map(|s| s.value)
    }

    /// Returns true for words that no language knows.
    pub fn is_unknown(&self) -> bool {
        self.senses.is_empty() && self.number.is_none()
    }
}
