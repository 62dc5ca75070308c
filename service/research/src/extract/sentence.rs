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

/// Returns how many tokens the mark of a list item takes: "-", "•", "3.", "b)"; 0 where a line begins without one.
pub fn marker(line: &[Token]) -> usize {
    let Some(first) = line.first() else { return 0 };
    let closes = |t: &Token| t.glued && matches!(t.text.as_str(), "." | ")");
    match line.get(1) {
        Some(next) if is_bullet(first) && !next.glued => 1,
        Some(next) if closes(next) && line.get(2).is_some_and(|t| !t.glued && !t.new_line) => {
            let letter = first.kind == Kind::Word && first.text.chars().count() == 1;
            let small = first.number().is_some_and(|n| n.fract() == 0.0 && n < 100.0);
            2 * usize::from(letter || small)
        }
        _ => 0,
    }
}

fn is_bullet(token: &Token) -> bool {
    matches!(token.text.as_str(), "-" | "–" | "—" | "•" | "*" | "·" | "▪" | "‣" | "◦" | "+")
}

fn ends(tokens: &[Token], i: usize, lexicon: &Lexicon) -> bool {
    let (Some(token), Some(next)) = (tokens.get(i), tokens.get(i + 1)) else { return true };
    let marked = next.new_line && marker(tokens.get(i + 1..).unwrap_or_default()) > 0;
    if next.paragraph || marked || next.new_line && (next.kind == Kind::Symbol || next.capital) && !token.is(",") {
        return true;
    }
    match token.text.as_str() {
        "!" | "?" | "。" | "；" | ";" => true,
        "." if !next.glued => {
            let mark = i == 1 || i.checked_sub(1).and_then(|k| tokens.get(k)).is_some_and(|t| t.new_line);
            if mark && i.checked_sub(1).is_some_and(|k| marker(tokens.get(k..).unwrap_or_default()) == 2) {
                return false; // "1. Corridors"
            }
            let short = i.checked_sub(1).is_some_and(|k| lexicon.cues.get("abbreviations").is_at(tokens, k));
            let is_unit = i.checked_sub(2).and_then(|k| tokens.get(k)).is_some_and(|t| t.number().is_some());
            (next.capital || next.number().is_some()) && (!short || is_unit && next.capital)
        }
        _ => false,
    }
}
