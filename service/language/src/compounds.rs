//! Words written as one: "Vierbettzimmer", "Meisterbüro", "einundzwanzig".

use crate::fold::fold_char;
use crate::lexicon::Language;
use crate::tokens::{Token, TokenKind};

/// Classes of words that another word before them tells more about.
const HEADS: &[&str] = &["room", "room_word", "object", "kind", "robot", "storey", "person", "capacity"];
/// Shortest part of a compound, in letters.
const SHORTEST: usize = 3;
/// Shortest word that stands at the end of a compound whose beginning nobody knows.
const HEAD: usize = 4;
/// Longest word that is taken apart.
const LONGEST: usize = 60;

/// Takes compounds apart that have no entry of their own; `known` says which tokens have one.
pub(crate) fn split(tokens: &mut Vec<Token>, text: &str, language: &Language, known: impl Fn(usize) -> bool) {
    if language.data.joints.is_empty() {
        return;
    }
    let mut split = Vec::with_capacity(tokens.len());
    for (i, token) in tokens.iter().enumerate() {
        let parts = if token.kind == TokenKind::Word && !known(i) { parts(token, text, language) } else { None };
        match parts {
            Some(parts) => split.extend(parts),
            None => split.push(token.clone()),
        }
    }
    *tokens = split;
}

/// A word with the place of each of its letters.
struct Letters {
    folded: Vec<char>,
    /// Number of the written character that a folded letter is of.
    written: Vec<usize>,
}

fn parts(token: &Token, text: &str, language: &Language) -> Option<Vec<Token>> {
    let written = &text[token.bytes.clone()];
    let mut letters = Letters { folded: Vec::new(), written: Vec::new() };
    for (i, c) in written.chars().enumerate() {
        let mut folded = String::new();
        fold_char(c, &mut folded);
        letters.written.extend(folded.chars().map(|_| i));
        letters.folded.extend(folded.chars());
    }
    let length = letters.folded.len();
    if !(2 * SHORTEST..=LONGEST).contains(&length) {
        return None;
    }
    let cuts = whole(&letters, language).or_else(|| tail(&letters, language))?;
    let bytes: Vec<usize> = written.char_indices().map(|c| c.0).chain([written.len()]).collect();
    let place = |at: usize| letters.written.get(at).copied().unwrap_or(bytes.len() - 1);
    let ends = cuts.iter().skip(1).map(|c| c.0).chain([length]);
    let found = cuts.iter().zip(ends).enumerate().map(|(i, ((from, word_end), to))| {
        let (first, last) = (place(*from), place(to));
        Token {
            text: letters.folded[*from..*word_end].iter().collect(),
            bytes: token.bytes.start + bytes[first]..token.bytes.start + bytes[last],
            chars: token.chars.start + first..token.chars.start + last,
            joined: i > 0 || token.joined,
            hyphen: i == 0 && token.hyphen,
            capital: i == 0 && token.capital,
            ..token.clone()
        }
    });
    Some(found.collect())
}

/// Returns the parts of a word all of whose parts are known: where each begins, and where it ends without its joint.
fn whole(letters: &Letters, language: &Language) -> Option<Vec<(usize, usize)>> {
    let length = letters.folded.len();
    // best[i]: fewest parts that the first i letters are, and where the last of them begins and ends
    let mut best: Vec<Option<(usize, usize, usize)>> = vec![None; length + 1];
    best[0] = Some((0, 0, 0));
    for end in 2..=length {
        for from in (0..=end - 2).rev() {
            let Some((parts, ..)) = best[from] else { continue };
            let Some(word_end) = part(letters, language, from, end) else { continue };
            if best[end].is_none_or(|b| b.0 > parts + 1) {
                best[end] = Some((parts + 1, from, word_end));
            }
        }
    }
    let mut cuts = Vec::new();
    let mut at = length;
    while at > 0 {
        let (_, from, word_end) = best[at]?;
        cuts.push((from, word_end));
        at = from;
    }
    cuts.reverse();
    (cuts.len() > 1).then_some(cuts)
}

/// Returns where the word from one letter to another ends without its joint, where it is one.
fn part(letters: &Letters, language: &Language, from: usize, end: usize) -> Option<usize> {
    let word: String = letters.folded[from..end].iter().collect();
    if may_be_part(language, &word) && (end - from >= SHORTEST || joins_numbers(language, &word)) {
        return Some(end);
    }
    if end == letters.folded.len() {
        return None;
    }
    language.data.joints.iter().find_map(|joint| {
        let bare = word.strip_suffix(joint.as_str())?;
        // "vijf-en-twintig": between numbers it is a word of its own
        let counts = language.word(bare)?.iter().any(|e| &*e.class == "number") && joins_numbers(language, joint);
        (!counts && bare.chars().count() >= SHORTEST && may_be_part(language, bare))
            .then(|| end - joint.chars().count())
    })
}

fn may_be_part(language: &Language, word: &str) -> bool {
    // of the small words, only those that numbers are made of
    language
        .word(word)
        .is_some_and(|entries| entries.iter().any(|e| &*e.class != "particle" || &*e.value == "number_and"))
}

fn joins_numbers(language: &Language, word: &str) -> bool {
    language.word(word).is_some_and(|entries| entries.iter().any(|e| &*e.value == "number_and"))
}

/// Returns the cut before the longest known head of a word whose beginning nobody knows.
fn tail(letters: &Letters, language: &Language) -> Option<Vec<(usize, usize)>> {
    let length = letters.folded.len();
    (SHORTEST..=length.checked_sub(HEAD)?).find_map(|from| {
        let word: String = letters.folded[from..].iter().collect();
        let head = language.word(&word)?.iter().any(|e| HEADS.contains(&&*e.class));
        head.then(|| vec![(0, from), (from, length)])
    })
}
