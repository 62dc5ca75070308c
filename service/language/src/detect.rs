//! Which language a text is written in, sentence by sentence.

use crate::data::Unread;
use crate::lexicon::{ANY, Lexicon, Match};
use crate::tokens::{Token, TokenKind};

/// A sentence is in another language than the text when that one explains this much more of it.
const OTHER: f64 = 1.4;
/// Share of a text that its language must explain, where another one explains as much.
const ENOUGH: f64 = 0.5;
/// Worth of a letter that only one language writes, in letters.
const TELLING: f64 = 2.0;
/// Weight of the small words that build sentences: a language borrows rooms, not these.
const SMALL: f64 = 2.5;
/// What English is ahead by where nothing decides, in letters: lists of words that all languages share.
const FIRST: f64 = 0.01;

/// The languages of a text.
#[derive(Debug, Clone, Default)]
pub(crate) struct Detected {
    /// Index of the language of each sentence.
    pub sentences: Vec<usize>,
    /// Name of the language that the text is in when nobody reads it.
    pub unread: Option<String>,
}

/// Returns the languages of a text.
pub(crate) fn detect(lexicon: &Lexicon, text: &str, tokens: &[Token], matches: &[Match]) -> Detected {
    let sentences = tokens.last().map_or(0, |t| t.sentence + 1);
    let worth = worth(lexicon, text, tokens, matches);
    let mut scores = vec![vec![0.0; lexicon.languages.len()]; sentences];
    for (token, worth) in tokens.iter().zip(&worth) {
        worth.iter().enumerate().for_each(|(l, w)| scores[token.sentence][l] += w);
    }
    let mut total = vec![0.0; lexicon.languages.len()];
    scores.iter().for_each(|s| s.iter().enumerate().for_each(|(l, w)| total[l] += w));
    let spoken: Vec<usize> = (0..total.len()).filter(|l| lexicon.languages[*l].data.code != ANY).collect();
    let best = |of: &[f64]| {
        let first = |l: usize| if lexicon.languages[l].data.code == "en" { FIRST } else { 0.0 };
        spoken.iter().copied().max_by(|a, b| (of[*a] + first(*a)).total_cmp(&(of[*b] + first(*b))))
    };
    let main = best(&total).unwrap_or(0);
    let of = |score: &Vec<f64>| best(score).filter(|b| score[*b] > score[main] * OTHER + 3.0).unwrap_or(main);
    let sentences = scores.iter().map(of).collect();
    let explained =
        |l: usize| tokens.iter().zip(&worth).filter(|(_, w)| w[l] > 0.0).map(|(t, _)| letters(t)).sum::<f64>();
    let unread = unread(&lexicon.unread, text, tokens, explained(main));
    Detected { sentences, unread }
}

/// Returns how much each token says for each language: fewer languages that know it, more.
fn worth(lexicon: &Lexicon, text: &str, tokens: &[Token], matches: &[Match]) -> Vec<Vec<f64>> {
    let mut covered = vec![vec![0.0f64; lexicon.languages.len()]; tokens.len()];
    for found in matches {
        let small = lexicon.languages[found.language].is_small(found.node);
        let weight = if small { SMALL } else { 1.0 };
        covered[found.from..found.to].iter_mut().for_each(|t| t[found.language] = t[found.language].max(weight));
    }
    let mut worth = Vec::with_capacity(tokens.len());
    for (token, covered) in tokens.iter().zip(covered) {
        let known = covered.iter().filter(|c| **c > 0.0).count().max(1) as f64;
        let written = &text[token.bytes.clone()];
        let telling = |l: usize| {
            let letters = &lexicon.languages[l].data.letters;
            written
                .chars()
                .filter(|c| {
                    letters.iter().any(|(from, to)| (*from..=*to).contains(&c.to_lowercase().next().unwrap_or(*c)))
                })
                .count()
        };
        let of = |(l, covered): (usize, &f64)| {
            let own = covered * letters(token) / known;
            own + TELLING * telling(l) as f64
        };
        worth.push(covered.iter().enumerate().map(of).collect());
    }
    worth
}

fn letters(token: &Token) -> f64 {
    match token.kind {
        TokenKind::Word => token.chars.len() as f64,
        TokenKind::Sign => 2.0,
        TokenKind::Number | TokenKind::Mark => 0.0,
    }
}

fn unread(known: &Unread, text: &str, tokens: &[Token], explained: f64) -> Option<String> {
    let all: f64 = tokens.iter().map(letters).sum();
    let script = known.scripts.iter().find(|(_, (from, to))| {
        let (inside, letters) = text
            .chars()
            .filter(|c| c.is_alphabetic())
            .fold((0, 0), |(i, n), c| (i + usize::from((*from..=*to).contains(&c)), n + 1));
        2 * inside > letters
    });
    if let Some((name, _)) = script {
        return Some(name.clone());
    }
    let score = |words: &Vec<String>| tokens.iter().filter(|t| words.contains(&t.text)).map(letters).sum::<f64>();
    let (name, most) =
        known.words.iter().map(|(name, words)| (name, score(words))).max_by(|a, b| a.1.total_cmp(&b.1))?;
    (explained < ENOUGH * all && most > 0.0 && most >= 0.6 * explained).then(|| name.clone())
}
