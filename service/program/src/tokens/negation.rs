//! What a prompt rules out by the word before it ("no ICU", "without any robots"), in Korean by that behind it.

use super::text::{Span, Token};
use super::words::{Spoken, Tag, tag_end};

/// Words of a phrase that rules out, at most: "do not include".
const MOST_WORDS: usize = 4;

/// Returns true for words that the prompt says the building is to be without.
pub(crate) fn is_ruled_out(tokens: &[Token], spoken: &[&Spoken], language: &str, span: Span) -> bool {
    let end = |i: usize, tag| tag_end(spoken, tokens, i, tag);
    if language == "ko" {
        return end(span.end, Tag::No).is_some();
    }
    // "without an ICU"
    let article = |i: &usize| [Tag::Articles, Tag::Definite].iter().any(|&tag| end(*i, tag) == Some(span.start));
    let from = span.start.checked_sub(1).filter(article).unwrap_or(span.start);
    (from.saturating_sub(MOST_WORDS)..from).any(|i| end(i, Tag::No) == Some(from))
}
