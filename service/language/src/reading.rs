//! A text, read: its tokens, its languages, and the best way to take the tokens for entries of the lexicon.

use std::ops::Range;

use crate::chunks::{Chunk, Sense};
use crate::compounds::{as_one_name, split};
use crate::detect::{Detected, detect};
use crate::fold::fold;
use crate::lexicon::{ANY, Language, Lexicon, Match};
use crate::numbers;
use crate::tokens::{Token, TokenKind, tokens};

/// What each chunk costs, in letters: one long entry is better than two short ones.
const CHUNK: f64 = 0.3;
/// What a token that nobody knows costs, in letters.
const UNKNOWN: f64 = 0.2;
/// Worth of a word in another language than its sentence, by whether the text has sentences in that language.
const FOREIGN: (f64, f64) = (0.9, 0.6);
/// Worth of a word that is not written as in the lexicon.
const INFLECTED: f64 = 0.95;
/// Shortest word that is understood amid another language, in letters.
const FOREIGN_LETTERS: usize = 4;
/// Shortest sign that is: "机" is a desk in one language, and any machine in the other.
const FOREIGN_SIGNS: usize = 2;
/// Shortest word with accents that may be misspelled, in letters.
const MARKED_LETTERS: usize = 7;

/// A word that was read as another one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Misspelling {
    /// Where it stands in the text, in bytes.
    pub bytes: Range<usize>,
    /// What it was read as.
    pub meant: String,
}

/// A text, read with a lexicon.
#[derive(Debug, Clone)]
pub struct Reading<'l> {
    text: String,
    tokens: Vec<Token>,
    chunks: Vec<Chunk<'l>>,
    languages: Vec<&'l str>,
    sentences: Vec<(&'l str, bool)>,
    inflected: Vec<&'l Language>,
    unread: Option<String>,
    misspellings: Vec<Misspelling>,
}

impl<'l> Reading<'l> {
    /// Returns the text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns its tokens.
    pub fn tokens(&self) -> &[Token] {
        &self.tokens
    }

    /// Returns the runs of tokens, one after the other; every token is in one.
    pub fn chunks(&self) -> &[Chunk<'l>] {
        &self.chunks
    }

    /// Returns the codes of the languages that it is written in, the most frequent first.
    pub fn languages(&self) -> &[&'l str] {
        &self.languages
    }

    /// Returns true where names of several words have their noun last, by the language of a token.
    pub fn head_last(&self, token: usize) -> bool {
        self.tokens.get(token).and_then(|t| self.sentences.get(t.sentence)).is_none_or(|s| s.1)
    }

    /// Returns true where an owner stands before what it owns, by the language of a token.
    pub fn owner_first(&self, token: usize) -> bool {
        let language = self.tokens.get(token).and_then(|t| self.inflected.get(t.sentence));
        language.is_some_and(|l| l.data.owner_first)
    }

    /// Returns true where words for how things lie stand behind what they refer to, by the language of a token.
    pub fn has_postpositions(&self, token: usize) -> bool {
        let language = self.tokens.get(token).and_then(|t| self.inflected.get(t.sentence));
        language.is_some_and(|l| l.data.postpositions)
    }

    /// Returns true where the noun of a run of tokens stands for more than one, as far as its form tells.
    pub fn is_plural(&self, tokens: Range<usize>) -> bool {
        let noun = if self.head_last(tokens.start) { tokens.end.checked_sub(1) } else { Some(tokens.start) };
        let noun = noun.and_then(|at| self.tokens.get(at)).filter(|t| t.kind == TokenKind::Word);
        noun.is_some_and(|t| self.inflected.get(t.sentence).is_some_and(|l| l.is_plural(&t.text)))
    }

    /// Returns the name of the language that it is written in when that one is not read, in English.
    pub fn unread(&self) -> Option<&str> {
        self.unread.as_deref()
    }

    /// Returns the words that were read as others.
    pub fn misspellings(&self) -> &[Misspelling] {
        &self.misspellings
    }

    /// Returns the words of a run of tokens as they are written.
    pub fn written(&self, tokens: Range<usize>) -> &str {
        let place = self.tokens.get(tokens.start).zip(tokens.end.checked_sub(1).and_then(|e| self.tokens.get(e)));
        place.and_then(|(first, last)| self.text.get(first.bytes.start..last.bytes.end)).unwrap_or_default()
    }
}

impl Lexicon {
    /// Reads a text. Every text can be read, in time that grows with its length.
    pub fn read(&self, text: &str) -> Reading<'_> {
        let mut tokens = tokens(text);
        let mut matches = self.matches(&tokens);
        let detected = detect(self, text, &tokens, &matches);
        let misspellings = self.mend(&mut tokens, text, &matches, &detected);
        let before = tokens.len();
        self.take_apart(&mut tokens, text, &detected, if misspellings.is_empty() { Some(&matches) } else { None });
        if tokens.len() != before || !misspellings.is_empty() {
            matches = self.matches(&tokens);
        }
        let chunks = as_one_name(self.chunks(&tokens, &matches, &detected), &tokens);
        let language = |t: usize| self.languages.get(detected.sentences.get(tokens[t].sentence).copied().unwrap_or(0));
        let chunks = numbers::join(chunks, &tokens, |t| language(t).map_or('.', |l| l.data.decimal));
        let sentences = detected
            .sentences
            .iter()
            .map(|l| (self.languages[*l].data.code.as_str(), self.languages[*l].data.head_last));
        let sentences: Vec<(&str, bool)> = sentences.collect();
        let languages = by_share(&sentences, &tokens);
        let inflected = detected.sentences.iter().map(|l| &self.languages[*l]).collect();
        let (text, unread) = (text.to_owned(), detected.unread);
        Reading { text, tokens, chunks, languages, sentences, inflected, unread, misspellings }
    }

    /// Spells words right that nobody knows.
    fn mend(&self, tokens: &mut [Token], text: &str, matches: &[Match], detected: &Detected) -> Vec<Misspelling> {
        let known = known(tokens.len(), matches);
        let mut mended = Vec::new();
        // texts in a language that nobody reads are full of words that look like others
        if detected.unread.is_some() {
            return mended;
        }
        let mut asked: std::collections::BTreeMap<String, Option<String>> = std::collections::BTreeMap::new();
        for (token, known) in tokens.iter_mut().zip(known) {
            if known || token.kind != TokenKind::Word {
                continue;
            }
            let language = &self.languages[detected.sentences[token.sentence]];
            // "Käse" is no "Kasse": a short word that sets its marks is spelled with care
            let short = token.chars.len() < MARKED_LETTERS;
            if short && fold(&text[token.bytes.clone()]) != text[token.bytes.clone()].to_lowercase() {
                continue;
            }
            // a compound is taken apart, not mended
            let meant = asked
                .entry(token.text.clone())
                .or_insert_with_key(|word| language.vocabulary.mend(word).map(str::to_owned));
            if let Some(meant) = meant {
                token.text.clone_from(meant);
                mended.push(Misspelling { bytes: token.bytes.clone(), meant: meant.clone() });
            }
        }
        mended
    }

    fn take_apart(&self, tokens: &mut Vec<Token>, text: &str, detected: &Detected, matches: Option<&[Match]>) {
        let again;
        let matches = match matches {
            Some(matches) => matches,
            None => {
                again = self.matches(tokens);
                &again
            }
        };
        let known = known(tokens.len(), matches);
        let mut languages = detected.sentences.clone();
        languages.sort_unstable();
        languages.dedup();
        if let [language] = languages[..] {
            split(tokens, text, &self.languages[language], |i| known[i]);
            return;
        }
        let mut all = Vec::with_capacity(tokens.len());
        for (i, token) in tokens.drain(..).enumerate() {
            let language = &self.languages[detected.sentences[token.sentence]];
            let mut one = vec![token];
            split(&mut one, text, language, |_| known[i]);
            all.append(&mut one);
        }
        *tokens = all;
    }

    /// Takes the tokens for entries in the way that explains most of them.
    fn chunks(&self, tokens: &[Token], matches: &[Match], detected: &Detected) -> Vec<Chunk<'_>> {
        let mut starting: Vec<Vec<(f64, &Match)>> = vec![Vec::new(); tokens.len()];
        for found in matches {
            if let Some(worth) = self.worth(found, tokens, detected) {
                starting[found.from].push((worth, found));
            }
        }
        // best[i]: worth of the tokens before i, and where the last chunk of them begins
        let mut best: Vec<Option<(f64, usize)>> = vec![None; tokens.len() + 1];
        best[0] = Some((0.0, 0));
        for from in 0..tokens.len() {
            let Some((so_far, _)) = best[from] else { continue };
            let mut offer = |to: usize, worth: f64| {
                if best[to].is_none_or(|b| worth > b.0) {
                    best[to] = Some((worth, from));
                }
            };
            offer(from + 1, so_far - UNKNOWN);
            starting[from].iter().for_each(|(worth, found)| offer(found.to, so_far + worth - CHUNK));
        }
        let mut chunks = Vec::new();
        let mut to = tokens.len();
        while to > 0 {
            let from = best[to].map_or(to - 1, |b| b.1);
            let mut here: Vec<&(f64, &Match)> = starting[from].iter().filter(|(_, m)| m.to == to).collect();
            here.sort_by(|a, b| b.0.total_cmp(&a.0));
            let most = here.first().map_or(0.0, |h| h.0);
            // a sense of another language only where the own one has none
            let own = here.iter().take_while(|h| h.0 >= most * INFLECTED - 1e-9);
            let senses = own.flat_map(|(_, found)| self.senses(found, tokens)).collect();
            chunks.push(Chunk { tokens: from..to, senses, number: None, text: text_of(&tokens[from..to]) });
            to = from;
        }
        chunks.reverse();
        join_unknown(chunks, tokens)
    }

    /// Returns how much a match explains, in letters; nothing when its language does not count here.
    fn worth(&self, found: &Match, tokens: &[Token], detected: &Detected) -> Option<f64> {
        let run = &tokens[found.from..found.to];
        // no phrase goes over the end of a sentence
        let sentence = run.first()?.sentence;
        if run.last()?.sentence != sentence {
            return None;
        }
        // "4-bed rooms": what a hyphen ties to a number goes with it before it goes with what follows
        let torn = run[0].hyphen && found.from > 0 && tokens[found.from - 1].kind == TokenKind::Number;
        if torn && run[1..].iter().any(|t| !t.hyphen) {
            return None;
        }
        let letters: usize = run.iter().map(|t| t.text.chars().count()).sum();
        let language = &self.languages[found.language];
        let own = detected.sentences[sentence] == found.language || language.data.code == ANY;
        let weight = match () {
            () if own => 1.0,
            () if letters < FOREIGN_LETTERS && run[0].kind == TokenKind::Word => return None,
            () if letters < FOREIGN_SIGNS => return None,
            () if !self.senses(found, tokens).any(|s| self.travels.iter().any(|c| c == s.class)) => return None,
            () if detected.sentences.contains(&found.language) => FOREIGN.0,
            () => FOREIGN.1,
        };
        let form = if found.exact { 1.0 } else { INFLECTED };
        Some(letters as f64 * weight * form)
    }

    fn senses<'l>(&'l self, found: &Match, tokens: &[Token]) -> impl Iterator<Item = Sense<'l>> + use<'l> {
        let language = &self.languages[found.language];
        let code = language.data.code.as_str();
        let entries = language.entries(found.node, &tokens[found.from..found.to]);
        entries.into_iter().map(move |(e, exact)| Sense { class: &e.class, value: &e.value, language: code, exact })
    }
}

fn known(tokens: usize, matches: &[Match]) -> Vec<bool> {
    let mut known = vec![false; tokens];
    matches.iter().for_each(|m| known[m.from..m.to].iter_mut().for_each(|k| *k = true));
    known
}

/// Joins signs that nobody knows to one word.
fn join_unknown<'l>(chunks: Vec<Chunk<'l>>, tokens: &[Token]) -> Vec<Chunk<'l>> {
    let mut joined: Vec<Chunk<'l>> = Vec::with_capacity(chunks.len());
    for chunk in chunks {
        let sign = |c: &Chunk| c.senses.is_empty() && tokens[c.tokens.start].kind == TokenKind::Sign;
        // "세탁물": the sign of a number that a longer unknown word begins with counts nothing
        let numeral = |c: &Chunk| {
            c.tokens.len() == 1
                && tokens[c.tokens.start].kind == TokenKind::Sign
                && c.has("number")
                && is_spaced(&c.text)
        };
        let mut chunk = chunk;
        // "로봇이": nor does the syllable of a number that ends a word
        if numeral(&chunk) && tokens[chunk.tokens.start].joined && joined.last().is_some_and(|l| is_word(l, tokens)) {
            chunk.senses.retain(|s| s.class != "number");
        }
        match joined.last_mut() {
            Some(last) if numeral(last) && sign(&chunk) && tokens[chunk.tokens.start].joined => {
                last.senses.clear();
                last.tokens.end = chunk.tokens.end;
                last.text.push_str(&chunk.text);
            }
            Some(last) if sign(last) && sign(&chunk) && tokens[chunk.tokens.start].joined => {
                last.tokens.end = chunk.tokens.end;
                last.text.push_str(&chunk.text);
            }
            _ => joined.push(chunk),
        }
    }
    joined
}

/// Returns true for what is no number, and no mark.
fn is_word(chunk: &Chunk, tokens: &[Token]) -> bool {
    let counts = chunk.has("number") || chunk.has("multiplier") || chunk.number.is_some();
    tokens[chunk.tokens.start].kind == TokenKind::Sign && !counts
}

/// Returns true for signs of scripts that write spaces between words.
fn is_spaced(text: &str) -> bool {
    text.chars().all(|c| ('\u{ac00}'..='\u{d7a3}').contains(&c))
}

fn text_of(tokens: &[Token]) -> String {
    let mut text = String::new();
    for token in tokens {
        if !text.is_empty() && token.kind != TokenKind::Sign {
            text.push(' ');
        }
        text.push_str(&token.text);
    }
    text
}

fn by_share<'l>(sentences: &[(&'l str, bool)], tokens: &[Token]) -> Vec<&'l str> {
    let mut share: Vec<(&str, usize)> = Vec::new();
    for token in tokens.iter().filter(|t| matches!(t.kind, TokenKind::Word | TokenKind::Sign)) {
        let Some((language, _)) = sentences.get(token.sentence) else { continue };
        match share.iter_mut().find(|s| s.0 == *language) {
            Some(of) => of.1 += 1,
            None => share.push((language, 1)),
        }
    }
    share.sort_by_key(|s| std::cmp::Reverse(s.1));
    share.into_iter().map(|s| s.0).collect()
}
