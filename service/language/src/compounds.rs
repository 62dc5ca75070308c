//! Words written as one: "Vierbettzimmer", "Meisterbüro", "einundzwanzig".

use crate::chunks::{Chunk, Sense};
use crate::fold::{fold_char, is_hangul};
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

/// Classes of words for rooms, which are named by what stands before them in one word.
const ROOMS: &[&str] = &["room", "room_word"];
/// Classes that mean in a compound what they mean elsewhere: a "Billardraum" has what it is named for, a "Damendusche" is for them.
const KEPT: &[&str] = &["sex", "attribute", "object", "unbuilt", "style"];

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
        // "bereikbaar" has no bar at its end
        if length - from == HEAD && !language.vocabulary.has(&word) {
            return None;
        }
        let head = language.word(&word)?.iter().any(|e| HEADS.contains(&&*e.class));
        head.then(|| vec![(0, from), (from, length)])
    })
}

/// Makes one name of each word that is several: what its parts mean by themselves is not meant in it.
///
/// A "Büroküche" is no office, a "clubbar" no club and a "Käsetheke" a counter; a "Reifekeller" is a room as other cellars are a
/// storey. Words that begin with a number say how many, and stay as they are: "Vierbettzimmer".
pub(crate) fn as_one_name<'l>(chunks: Vec<Chunk<'l>>, tokens: &[Token]) -> Vec<Chunk<'l>> {
    let mut named: Vec<Chunk<'l>> = Vec::with_capacity(chunks.len());
    let mut word: Vec<Chunk<'l>> = Vec::new();
    for chunk in chunks {
        if word.last().is_some_and(|last| !is_one_word(last, &chunk, tokens)) {
            named.append(&mut one_name(std::mem::take(&mut word), tokens));
        }
        word.push(chunk);
    }
    named.append(&mut one_name(word, tokens));
    named
}

/// Returns true for two runs of tokens that are written as one word.
fn is_one_word(a: &Chunk, b: &Chunk, tokens: &[Token]) -> bool {
    let (last, first) = (&tokens[a.tokens.end - 1], &tokens[b.tokens.start]);
    let script = |t: &Token| match t.kind {
        TokenKind::Word => true,
        // of the scripts without letters only this one sets spaces between words
        TokenKind::Sign => t.text.chars().all(is_hangul),
        _ => false,
    };
    first.joined && first.kind == last.kind && script(first) && script(last)
}

/// Takes from the parts of one word before its head what they mean elsewhere.
fn one_name<'l>(word: Vec<Chunk<'l>>, tokens: &[Token]) -> Vec<Chunk<'l>> {
    let Some(first) = word.first().filter(|first| word.len() > 1 && !counts(first, tokens)) else { return word };
    let spaced = tokens[first.tokens.start].kind == TokenKind::Sign;
    let mut word = if spaced { without_syllables(word) } else { word };
    let is_room = |c: &Chunk| ROOMS.iter().any(|class| c.has(class));
    // behind the head of a Korean word stand particles
    let head = if spaced { word.iter().rposition(is_room) } else { word.len().checked_sub(1) };
    let Some(head) = head.filter(|head| *head > 0) else { return word };
    let is_storey = |s: &Sense| s.class == "storey" && s.value != "word";
    let (thing, storey) = (word[head].has("object"), word[head].senses.iter().any(is_storey));
    if !(thing || storey || is_room(&word[head])) {
        return word;
    }
    word[..head].iter_mut().for_each(|part| part.senses.retain(|s| KEPT.contains(&s.class)));
    let nameless = word[..head].iter().all(Chunk::is_unknown);
    if spaced && nameless && word[head].tokens.len() == 2 && word[0].tokens.end == word[head].tokens.start {
        with_longer_name(&mut word, head);
    } else if thing && nameless {
        let tokens = word[0].tokens.start;
        let before: String = word.drain(..head).map(|part| part.text).collect();
        word[0].tokens.start = tokens;
        word[0].text.insert_str(0, &before);
    } else if storey && nameless {
        let language = word[head].senses[0].language;
        word[head].senses.retain(|s| ROOMS.contains(&s.class));
        if word[head].senses.is_empty() {
            word[head].senses.push(Sense { class: "room_word", value: "room", language, exact: true });
        }
    }
    word
}

/// Gives all but the last syllable of a room to a single one before it, where that makes its name: "탕전실" is a room for "탕전", and
/// no "전실" of anything.
fn with_longer_name(word: &mut [Chunk], head: usize) {
    let [name, room] = &mut word[head - 1..=head] else { return };
    if name.tokens.len() != 1 {
        return;
    }
    let language = room.senses[0].language;
    let last = room.text.char_indices().last().map_or(0, |(at, _)| at);
    let room_text = room.text.split_off(last);
    name.text.push_str(&std::mem::replace(&mut room.text, room_text));
    (name.tokens.end, room.tokens.start) = (room.tokens.end - 1, room.tokens.end - 1);
    room.senses = vec![Sense { class: "room_word", value: "room", language, exact: true }];
}

/// Returns true for words that begin with a number, or stand right behind one: "7인실".
fn counts(first: &Chunk, tokens: &[Token]) -> bool {
    let at = first.tokens.start;
    let behind = tokens[at].joined && at > 0 && tokens[at - 1].kind == TokenKind::Number;
    behind || ["number", "quantity", "ordinal"].iter().any(|class| first.has(class))
}

/// Joins single syllables to the word that nobody knows which goes on behind them: "약재" is not about something.
fn without_syllables(word: Vec<Chunk>) -> Vec<Chunk> {
    let mut joined: Vec<Chunk> = Vec::with_capacity(word.len());
    for chunk in word.into_iter().rev() {
        match joined.last_mut() {
            Some(behind) if behind.is_unknown() && (chunk.tokens.len() == 1 || chunk.is_unknown()) => {
                behind.tokens.start = chunk.tokens.start;
                behind.text.insert_str(0, &chunk.text);
            }
            _ => joined.push(chunk),
        }
    }
    joined.reverse();
    joined
}
