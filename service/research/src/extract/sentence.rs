//! Where sentences end, and which lines are tables.

use super::lexicon::Lexicon;
use super::token::{Kind, Token};

/// A sentence is cut here: no real one is longer, and nonsense must not cost more than its length.
const MAX_TOKENS: usize = 160;

/// Returns the sentences as ranges of tokens.
pub fn sentences(tokens: &[Token], lexicon: &Lexicon) -> Vec<(usize, usize)> {
    let mut out = Vec::new();
    let mut from = 0;
    for i in 0..tokens.len() {
        if i + 1 == tokens.len() || ends(tokens, i, lexicon) || i + 1 - from >= MAX_TOKENS {
            out.push((from, i + 1));
            from = i + 1;
        }
    }
    out
}

fn ends(tokens: &[Token], i: usize, lexicon: &Lexicon) -> bool {
    let (Some(token), Some(next)) = (tokens.get(i), tokens.get(i + 1)) else { return true };
    if next.new_line && (next.kind == Kind::Symbol || next.capital) && !token.is(",") {
        return true;
    }
    match token.text.as_str() {
        "!" | "?" | "。" | "；" | ";" => true,
        "." if !next.glued => {
            let short = i.checked_sub(1).is_some_and(|k| lexicon.cues.get("abbreviations").is_at(tokens, k));
            let is_unit = i.checked_sub(2).and_then(|k| tokens.get(k)).is_some_and(|t| t.number().is_some());
            (next.capital || next.number().is_some()) && (!short || is_unit && next.capital)
        }
        _ => false,
    }
}
