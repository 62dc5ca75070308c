//! Words of a text as full text compares them, for English and German at once.
//!
//! Each word yields a few terms: itself in lower case without accents, its English and its German stem, and for words
//! that write umlauts as `ae`, `oe`, `ue` the same without the `e`. Documents and questions are treated alike, so it
//! does not matter which language a text is in. Numbers lose trailing zeros and decimal commas, and are set apart from
//! their units. Nothing is refused: any bytes that are a `str` give some terms or none.

use std::collections::{BTreeSet, HashMap};
use std::sync::OnceLock;

use tantivy::tokenizer::{Language, RawTokenizer, Stemmer, TextAnalyzer};
use unicode_normalization::UnicodeNormalization;
use unicode_normalization::char::is_combining_mark;

/// Longer words are cut, in characters: nobody types them, and a dump of a key would bloat the index.
const LONGEST_WORD: usize = 64;

/// How many words the memory of an analyzer holds before it forgets.
const REMEMBERED_WORDS: usize = 50_000;

/// One word with the terms that stand for it; the first is the word itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Word {
    pub(crate) terms: Vec<String>,
}

impl Word {
    pub(crate) fn text(&self) -> &str {
        self.terms.first().map_or("", String::as_str)
    }
}

/// Turns texts into terms and remembers words it has seen, because stemming costs more than looking up.
pub(crate) struct Analyzer {
    english: TextAnalyzer,
    german: TextAnalyzer,
    seen: HashMap<String, Word>,
}

impl Analyzer {
    pub(crate) fn new() -> Self {
        let stemmer = |language| TextAnalyzer::builder(RawTokenizer::default()).filter(Stemmer::new(language)).build();
        Self { english: stemmer(Language::English), german: stemmer(Language::German), seen: HashMap::new() }
    }

    /// Returns the words of a text in their order.
    pub(crate) fn words(&mut self, text: &str) -> Vec<Word> {
        split(text).into_iter().map(|word| self.word(word)).collect()
    }

    fn word(&mut self, word: String) -> Word {
        if let Some(known) = self.seen.get(&word) {
            return known.clone();
        }
        let mut terms = vec![word.clone()];
        if word.starts_with(|c: char| c.is_ascii_digit()) {
            terms = number_terms(&word);
        } else {
            let mut spellings = vec![word.clone()];
            spellings.extend(without_written_umlauts(&word));
            for spelling in spellings {
                let stems = [stem(&mut self.english, &spelling), stem(&mut self.german, &spelling)];
                for term in std::iter::once(spelling).chain(stems) {
                    if !term.is_empty() && !terms.contains(&term) {
                        terms.push(term);
                    }
                }
            }
        }
        if self.seen.len() >= REMEMBERED_WORDS {
            self.seen.clear();
        }
        self.seen.insert(word, Word { terms: terms.clone() });
        Word { terms }
    }
}

/// Whether a word says nothing about what is looked for.
pub(crate) fn is_stop_word(word: &str) -> bool {
    static WORDS: OnceLock<BTreeSet<&'static str>> = OnceLock::new();
    let all =
        include_str!("stop_words.txt").lines().filter(|line| !line.starts_with('#')).flat_map(str::split_whitespace);
    WORDS.get_or_init(|| all.collect()).contains(word)
}

fn stem(stemmer: &mut TextAnalyzer, word: &str) -> String {
    let mut stream = stemmer.token_stream(word);
    if stream.advance() { stream.token().text.clone() } else { String::new() }
}

/// Cuts a text into folded words and numbers. Letters followed by digits stay together (`m2`, `h2o`).
fn split(text: &str) -> Vec<String> {
    let mut words = Vec::new();
    let mut word = String::new();
    let mut chars = fold(text).peekable();
    while let Some(c) = chars.next() {
        let in_number = word.starts_with(|c: char| c.is_ascii_digit());
        let decimal = in_number && matches!(c, '.' | ',') && chars.peek().is_some_and(char::is_ascii_digit);
        let apart = is_ideograph(c);
        let goes_on = c.is_alphanumeric() && !apart && (c.is_ascii_digit() || !in_number);
        if decimal || goes_on {
            if word.chars().count() < LONGEST_WORD {
                word.push(c);
            }
            continue;
        }
        if !word.is_empty() {
            words.push(std::mem::take(&mut word));
        }
        if apart {
            words.push(c.to_string());
        } else if c.is_alphanumeric() {
            word.push(c);
        }
    }
    if !word.is_empty() {
        words.push(word);
    }
    words
}

/// Lower case, without accents, ligatures and superscripts: `Türbreite` is `turbreite`, `m²` is `m2`.
fn fold(text: &str) -> impl Iterator<Item = char> {
    text.nfkd().filter(|&c| !is_combining_mark(c)).flat_map(char::to_lowercase).flat_map(|c| {
        let pair = match c {
            'ß' => ['s', 's'],
            'æ' => ['a', 'e'],
            'œ' => ['o', 'e'],
            'ø' => ['o', '\0'],
            'ł' => ['l', '\0'],
            _ => [c, '\0'],
        };
        pair.into_iter().filter(|&c| c != '\0')
    })
}

/// Chinese and Japanese characters; they are words of their own, as there are no spaces between words.
fn is_ideograph(c: char) -> bool {
    matches!(u32::from(c), 0x2E80..=0x2FDF | 0x3040..=0x30FF | 0x3400..=0x4DBF | 0x4E00..=0x9FFF | 0xF900..=0xFAFF | 0x20000..=0x2FA1F)
}

/// Returns what a number may mean: `2.50` is 2.5, and `1,200` is 1.2 in German and 1200 in English.
fn number_terms(word: &str) -> Vec<String> {
    let parts: Vec<&str> = word.split(['.', ',']).collect();
    let [whole, decimals] = parts[..] else { return vec![word.to_owned()] };
    let decimals_left = decimals.trim_end_matches('0');
    let whole_left = whole.trim_start_matches('0');
    let whole_left = if whole_left.is_empty() { "0" } else { whole_left };
    let number = if decimals_left.is_empty() { whole_left.to_owned() } else { format!("{whole_left}.{decimals_left}") };
    let mut terms = vec![number];
    if decimals.len() == 3 && whole_left != "0" {
        terms.push(format!("{whole_left}{decimals}"));
    }
    terms
}

/// Returns `turbreite` for `tuerbreite`, but nothing for `neue` or `quer`, where `ue` is no umlaut.
fn without_written_umlauts(word: &str) -> Option<String> {
    let letters: Vec<char> = word.chars().collect();
    let mut short = String::with_capacity(word.len());
    for (i, &c) in letters.iter().enumerate() {
        let before = |back: usize| i.checked_sub(back).and_then(|j| letters.get(j)).copied().unwrap_or(' ');
        let umlaut =
            c == 'e' && matches!(before(1), 'a' | 'o' | 'u') && !matches!(before(2), 'a' | 'e' | 'i' | 'o' | 'q');
        if !umlaut {
            short.push(c);
        }
    }
    (short.len() < word.len() && letters.len() >= 4).then_some(short)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(text: &str, expected: &[&str]) {
        assert_eq!(split(text), expected, "{text:?}");
    }

    #[test]
    fn texts_are_cut_into_words() {
        check("min_corridor_width: 1.5m", &["min", "corridor", "width", "1.5", "m"]);
        check("Türbreite ≥ 0,90 m², Straße", &["turbreite", "0,90", "m2", "strasse"]);
        check("DIN 18040-2:2011, § 4.3.2.", &["din", "18040", "2", "2011", "4.3.2"]);
        check("IV-Ständer / 1200mm H2O", &["iv", "stander", "1200", "mm", "h2o"]);
        check("病房 ward", &["病", "房", "ward"]);
        check("Ænigma ﬁre ½ İ", &["aenigma", "fire", "1", "2", "i"]);
        check("\u{0}\u{ffff}\u{202e}  '\"*?+-()[]{}^~\\", &[]);
        assert_eq!(split(&"x".repeat(9000))[0].len(), LONGEST_WORD);
    }

    #[test]
    fn forms_of_a_word_meet_in_a_term() {
        let mut analyzer = Analyzer::new();
        let groups: [&[&str]; 6] = [
            &["corridor", "Corridors"],
            &["Tür", "Türen", "Tueren", "tur"],
            &["Breite", "breiten"],
            &["1.5", "1,50", "01.5"],
            &["opening", "openings", "opened"],
            &["Straße", "strasse"],
        ];
        for group in groups {
            let terms = |word: &str, a: &mut Analyzer| a.words(word)[0].terms.iter().cloned().collect::<BTreeSet<_>>();
            let first = terms(group[0], &mut analyzer);
            for word in group {
                assert!(!first.is_disjoint(&terms(word, &mut analyzer)), "{} and {word}", group[0]);
            }
        }
        let terms = |number: &str| number_terms(number);
        assert_eq!(terms("1,200"), ["1.2", "1200"]);
        assert_eq!(terms("2.00"), ["2"]);
        assert_eq!(without_written_umlauts("neue"), None);
        assert_eq!(without_written_umlauts("quer"), None);
    }

    #[test]
    fn stop_words_are_written_as_terms() {
        let mut analyzer = Analyzer::new();
        for word in
            include_str!("stop_words.txt").lines().filter(|l| !l.starts_with('#')).flat_map(str::split_whitespace)
        {
            assert_eq!(analyzer.words(word)[0].text(), word);
            assert!(is_stop_word(word));
        }
        assert!(!is_stop_word("corridor"));
    }
}
