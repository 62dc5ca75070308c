//! A text as tokens that know where they stand in it.

use std::ops::Range;

use crate::fold::{fold_char, is_han, is_hangul, is_kana};

/// What a token is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TokenKind {
    /// Letters of a script that sets spaces between words, or digits after letters ("m2", "t4").
    Word,
    /// Digits, with their marks ("1,200", "0.5").
    Number,
    /// One character of a script that sets no spaces, or one syllable of Korean.
    Sign,
    /// A mark: a comma, a bracket, an arrow, an emoji.
    Mark,
}

/// A word, a number, one sign of a script without spaces, or a mark.
#[derive(Debug, Clone, PartialEq)]
pub struct Token {
    /// As it is looked up: folded, and spelled right.
    pub text: String,
    /// Where it stands in the text, in bytes.
    pub bytes: Range<usize>,
    /// Where it stands in the text, in characters.
    pub chars: Range<usize>,
    /// What it is made of.
    pub kind: TokenKind,
    /// True when nothing stands between it and the token before it.
    pub joined: bool,
    /// True when a hyphen ties it to the token before it.
    pub hyphen: bool,
    /// True when it is written with a capital letter.
    pub capital: bool,
    /// Number of the sentence it stands in.
    pub sentence: usize,
}

/// Marks that are one, in the order of what they are read as.
const MARKS: &[(&str, &str)] = &[
    (",，、､،", ","),
    (";；", ";"),
    (":：", ":"),
    (".。．｡", "."),
    ("!！", "!"),
    ("?？", "?"),
    ("(（[【「『《", "("),
    (")）]】」』》", ")"),
    ("×✕✖", "x"),
    ("–—−‐‑-~〜～", "-"),
    ("/／", "/"),
    ("&＆", "&"),
    ("+＋", "+"),
    ("→⇒", ">"),
    ("≥", "≥"),
    ("≤", "≤"),
];
/// Which of the marks are hyphens.
const HYPHENS: usize = 9;
const ENDS_SENTENCE: &[&str] = &[".", "!", "?", ";", ":", "\n"];
/// What stands behind an apostrophe in one word.
const CONTRACTED: &[&str] = &["ll", "re", "ve"];
const APOSTROPHES: &[char] = &['\'', '’', 'ʼ', '`', '´'];

/// Returns the tokens of a text.
pub(crate) fn tokens(text: &str) -> Vec<Token> {
    let letters: Vec<(usize, char)> = text.char_indices().collect();
    let mut scan = Scan { text, letters, at: 0, tokens: Vec::new(), sentence: 0 };
    while scan.at < scan.letters.len() {
        scan.step();
    }
    scan.tokens
}

struct Scan<'a> {
    text: &'a str,
    letters: Vec<(usize, char)>,
    at: usize,
    tokens: Vec<Token>,
    sentence: usize,
}

impl Scan<'_> {
    fn get(&self, at: usize) -> Option<char> {
        self.letters.get(at).map(|l| l.1)
    }

    fn byte(&self, at: usize) -> usize {
        self.letters.get(at).map_or(self.text.len(), |l| l.0)
    }

    fn step(&mut self) {
        let Some(c) = self.get(self.at) else { return };
        if c == '\n' {
            self.end_sentence();
            self.at += 1;
        } else if c.is_whitespace() || is_format(c) {
            self.at += 1;
        } else if is_sign(c) {
            self.push(self.at + 1, TokenKind::Sign, None);
        } else if is_digit(c) {
            let end = self.number_end();
            // "1930s" is a word
            let years = self.get(end) == Some('s') && !self.get(end + 1).is_some_and(char::is_alphanumeric);
            let kind = if years { TokenKind::Word } else { TokenKind::Number };
            self.push(end + usize::from(years), kind, None);
        } else if c.is_alphabetic() || is_wide_unit(c) {
            self.word();
        } else {
            self.mark(c);
        }
    }

    /// Takes digits with the marks between them: "1,200.5", "1 200" with a thin or a fixed space.
    fn number_end(&self) -> usize {
        let digit = |at: usize| self.get(at).is_some_and(is_digit);
        let mut end = self.at;
        loop {
            while digit(end) {
                end += 1;
            }
            let between = matches!(self.get(end), Some('.' | ',' | '\'' | '’' | '\u{a0}' | '\u{202f}' | '．' | '，'));
            // a comma between figures and a list without spaces look alike: "1,2,3"
            if !between || !digit(end + 1) {
                return end;
            }
            end += 1;
        }
    }

    fn word(&mut self) {
        let mut end = self.at;
        while let Some(c) = self.get(end) {
            let letter = c.is_alphabetic() && !is_sign(c) || is_wide_unit(c) || is_joiner(c);
            if letter || (end > self.at && is_digit(c)) || matches!(c, '²' | '³') {
                end += 1;
            } else if APOSTROPHES.contains(&c) && end > self.at && self.get(end + 1).is_some_and(char::is_alphabetic) {
                // "women's", "don't" are one word, "d'angle" and "dell'ingresso" are two
                let after: String = (end + 1..).map_while(|i| self.get(i).filter(|c| c.is_alphabetic())).collect();
                if after.chars().count() > 1 && !CONTRACTED.contains(&after.as_str()) {
                    self.push(end, TokenKind::Word, None);
                    self.at += 1;
                    return;
                }
                end += 1;
            } else {
                break;
            }
        }
        self.push(end.max(self.at + 1), TokenKind::Word, None);
    }

    fn mark(&mut self, c: char) {
        let known = MARKS.iter().find(|(written, _)| written.contains(c)).map(|(_, read)| *read);
        let before = self.at.checked_sub(1).and_then(|i| self.get(i));
        let after = self.get(self.at + 1);
        match known {
            // "3-bed", "L-shaped" are two words with nothing between; "2-3", "a - b" have a mark
            Some("-") if before.is_some_and(char::is_alphanumeric) && after.is_some_and(char::is_alphabetic) => {
                self.at += 1;
                return;
            }
            Some("-") if before.is_some_and(char::is_alphabetic) && after.is_some_and(char::is_alphanumeric) => {
                self.at += 1;
                return;
            }
            // "elders' lounge": whose it is
            None if APOSTROPHES.contains(&c) && before.is_some_and(char::is_alphabetic) => {
                self.at += 1;
                return;
            }
            Some(".") if c == '.' && !self.dot_ends_sentence() => {
                self.at += 1;
                return;
            }
            _ => {}
        }
        let read = known.map(str::to_owned);
        self.push(self.at + 1, TokenKind::Mark, read);
        if known.is_some_and(|m| ENDS_SENTENCE.contains(&m)) {
            self.end_sentence();
        }
    }

    /// Returns false for the dot of an abbreviation ("sq. m", "ca. 50").
    fn dot_ends_sentence(&self) -> bool {
        let next = (self.at + 1..self.letters.len()).find_map(|i| self.get(i).filter(|c| !c.is_whitespace()));
        let Some(next) = next else { return true };
        let spaced = self.get(self.at + 1).is_some_and(char::is_whitespace);
        let short = self.tokens.last().is_some_and(|t| t.kind == TokenKind::Word && t.chars.len() <= 3);
        if !spaced { !(next.is_alphanumeric() && short) } else { !(short && (next.is_lowercase() || is_digit(next))) }
    }

    fn end_sentence(&mut self) {
        if self.tokens.last().is_some_and(|t| t.sentence == self.sentence) {
            self.sentence += 1;
        }
    }

    fn push(&mut self, end: usize, kind: TokenKind, read: Option<String>) {
        let (from, to) = (self.byte(self.at), self.byte(end));
        let written = &self.text[from..to];
        let text = read.unwrap_or_else(|| {
            let mut folded = String::with_capacity(written.len());
            let spoken = written.chars().filter(|c| !APOSTROPHES.contains(c) && !is_joiner(*c));
            spoken.for_each(|c| fold_char(c, &mut folded));
            folded
        });
        let joined = self.tokens.last().is_some_and(|t| t.bytes.end == from);
        let tied = self.tokens.last().is_some_and(|t| {
            t.bytes.end < from && self.text[t.bytes.end..from].chars().all(|c| MARKS[HYPHENS].0.contains(c))
        });
        let hyphen = tied && kind != TokenKind::Mark;
        let capital = written.starts_with(char::is_uppercase);
        self.tokens.push(Token {
            text,
            bytes: from..to,
            chars: self.at..end,
            kind,
            joined,
            hyphen,
            capital,
            sentence: self.sentence,
        });
        self.at = end;
    }
}

fn is_digit(c: char) -> bool {
    c.is_ascii_digit() || matches!(c, '０'..='９')
}

fn is_sign(c: char) -> bool {
    is_kana(c) || is_hangul(c) || is_han(c)
}

/// Units that are one letter: "㎡".
fn is_wide_unit(c: char) -> bool {
    matches!(c, '\u{3380}'..='\u{33df}')
}

/// Accents that stand for themselves after their letter.
fn is_joiner(c: char) -> bool {
    matches!(c, '\u{300}'..='\u{36f}')
}

/// Marks that nobody sees: of direction, of width zero.
fn is_format(c: char) -> bool {
    matches!(c, '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{ad}')
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(text: &str, expected: &[&str]) {
        let found = tokens(text);
        assert_eq!(found.iter().map(|t| t.text.as_str()).collect::<Vec<_>>(), expected, "{text}");
        for token in &found {
            assert_eq!(text[token.bytes.clone()].chars().count(), token.chars.len());
        }
    }

    #[test]
    fn words_numbers_signs_and_marks() {
        check("two 4-bed rooms, 28m²", &["two", "4", "bed", "rooms", ",", "28", "m2"]);
        check("2LDK, T4 1,200.5 m2", &["2", "ldk", ",", "t4", "1,200.5", "m2"]);
        check("salle d'attente, women's WC", &["salle", "d", "attente", ",", "womens", "wc"]);
        check("elders' lounge", &["elders", "lounge"]);
        check("ca. 50 sq. m. Flur", &["ca", "50", "sq", "m", ".", "flur"]);
        check("三室一厅，90平米", &["三", "室", "一", "厅", ",", "90", "平", "米"]);
        check("3 x 4 – 2-3", &["3", "x", "4", "-", "2", "-", "3"]);
        check("", &[]);
    }

    #[test]
    fn sentences_are_numbered() {
        let found = tokens("A flat. Ground floor: hall; a WC");
        assert_eq!(found.iter().map(|t| t.sentence).collect::<Vec<_>>(), [0, 0, 0, 1, 1, 1, 2, 2, 3, 3]);
    }
}
