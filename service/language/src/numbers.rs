//! Numbers of several words: "two hundred and ten", "三十二", "einundzwanzig", "1.5 million".

use crate::chunks::Chunk;
use crate::tokens::{Token, TokenKind};

/// Returns the value of digits, read with the mark that a language sets before decimals.
pub(crate) fn digits(text: &str, decimal: char) -> Option<f64> {
    let marks: Vec<(usize, char)> = text.char_indices().filter(|(_, c)| !c.is_ascii_digit()).collect();
    let Some((last, mark)) = marks.last().copied() else { return text.parse().ok() };
    let behind = text.len() - last - mark.len_utf8();
    let all_same = marks.iter().all(|m| m.1 == mark);
    let grouped = behind == 3 && all_same && (marks.len() > 1 || mark != decimal || !matches!(mark, '.' | ','));
    // "1.200,5": the last mark is the decimal one; "1,5" is no thousands in any language
    let is_decimal = matches!(mark, '.' | ',')
        && !grouped
        && (marks.len() == 1 || !marks[..marks.len() - 1].iter().any(|m| m.1 == mark));
    let mut plain = String::with_capacity(text.len());
    for (i, c) in text.char_indices() {
        match c {
            _ if c.is_ascii_digit() => plain.push(c),
            _ if is_decimal && i == last => plain.push('.'),
            _ => {}
        }
    }
    plain.parse().ok()
}

/// Part of a number of several words.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Part {
    Digits(f64),
    Word(f64),
    Times(f64),
    And,
}

/// Gives numbers their value, and joins those of several words.
pub(crate) fn join<'l>(chunks: Vec<Chunk<'l>>, tokens: &[Token], decimal: impl Fn(usize) -> char) -> Vec<Chunk<'l>> {
    let mut joined: Vec<Chunk<'l>> = Vec::with_capacity(chunks.len());
    let mut at = 0;
    while at < chunks.len() {
        let parts: Vec<Part> = chunks[at..].iter().map_while(|c| part(c, tokens, &decimal)).take(12).collect();
        match value(&parts, &chunks[at..], tokens) {
            Some((number, count)) => {
                joined.push(merged(&chunks[at..at + count], number));
                at += count;
            }
            None => {
                joined.push(chunks[at].clone());
                at += 1;
            }
        }
    }
    joined
}

fn part(chunk: &Chunk, tokens: &[Token], decimal: &impl Fn(usize) -> char) -> Option<Part> {
    let first = chunk.tokens.start;
    if chunk.tokens.len() == 1 && tokens[first].kind == TokenKind::Number {
        return digits(&chunk.text, decimal(first)).map(Part::Digits);
    }
    let value = |class| chunk.values(class).find_map(|v| v.parse::<f64>().ok());
    if let Some(n) = value("number") {
        return Some(Part::Word(n));
    }
    if let Some(n) = value("quantity") {
        // "a dozen": a number of its own
        return Some(Part::Digits(n));
    }
    if let Some(n) = value("multiplier") {
        return Some(Part::Times(n));
    }
    chunk.is("particle", "number_and").then_some(Part::And)
}

/// Returns the value of the number that begins here, and how many chunks it takes.
fn value(parts: &[Part], chunks: &[Chunk], tokens: &[Token]) -> Option<(f64, usize)> {
    // whole thousands, hundreds so far, and what a multiplier may still follow
    let (mut total, mut hundreds, mut pending): (f64, f64, Option<f64>) = (0.0, 0.0, None);
    let mut taken = 0;
    let mut at = 0;
    while let Some(part) = parts.get(at) {
        let ones_first = reversed(parts, at, chunks, tokens);
        match part {
            Part::Digits(n) if at == 0 => pending = Some(*n),
            Part::Word(one)
                if let Some(tens) = ones_first
                    && pending.is_none() =>
            {
                pending = Some(one + tens);
                at += 2;
            }
            Part::Word(n) => match pending {
                None if fits(total + hundreds, *n) => pending = Some(*n),
                Some(old) if matches!(parts[0], Part::Word(_) | Part::Times(_)) && fits(old, *n) => {
                    pending = Some(old + n)
                }
                _ => break,
            },
            Part::Times(m) if at == 0 && chunks[0].has("room") => break,
            Part::Times(m) => {
                let before = pending.take();
                if *m >= 1000.0 {
                    total += (hundreds + before.unwrap_or(if hundreds == 0.0 { 1.0 } else { 0.0 })) * m;
                    hundreds = 0.0;
                } else {
                    hundreds += before.unwrap_or(1.0) * m;
                }
            }
            Part::And if at > 0 && at + 1 < parts.len() && matches!(parts[at + 1], Part::Word(_)) => {
                at += 1;
                continue;
            }
            _ => break,
        }
        at += 1;
        taken = at;
    }
    (taken > 0).then(|| (total + hundreds + pending.unwrap_or(0.0), taken))
}

/// Returns the tens of "einundzwanzig": ones and tens in one word.
fn reversed(parts: &[Part], at: usize, chunks: &[Chunk], tokens: &[Token]) -> Option<f64> {
    let [Part::Word(one), Part::And, Part::Word(tens), ..] = parts[at..] else { return None };
    let glued = chunks[at + 1..=at + 2].iter().all(|c| tokens[c.tokens.start].joined);
    (glued && one < 10.0 && tens >= 20.0 && tens % 10.0 == 0.0).then_some(tens)
}

/// Returns true when the ones or tens of a number are still free: "twenty" takes "four", "one" does not take "two".
fn fits(so_far: f64, n: f64) -> bool {
    if so_far == 0.0 {
        return true;
    }
    n > 0.0
        && if n < 10.0 {
            so_far % 10.0 == 0.0 && so_far >= 20.0
        } else {
            n < 100.0 && so_far % 100.0 == 0.0 || (n < 20.0 && matches!(so_far % 100.0, 60.0 | 80.0))
        }
}

fn merged<'l>(chunks: &[Chunk<'l>], number: f64) -> Chunk<'l> {
    let first = &chunks[0];
    let last = chunks.last().unwrap_or(first);
    let senses = if chunks.len() == 1 { first.senses.clone() } else { Vec::new() };
    let text = chunks.iter().map(|c| c.text.as_str()).collect::<Vec<_>>().join(" ");
    Chunk { tokens: first.tokens.start..last.tokens.end, senses, number: Some(number), text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_of_thousands_and_decimals() {
        for (text, decimal, number) in [
            ("12", '.', 12.0),
            ("1,200", '.', 1200.0),
            ("1.200", ',', 1200.0),
            ("1.5", ',', 1.5),
            ("1,5", '.', 1.5),
            ("1.200,5", ',', 1200.5),
            ("1,200.5", '.', 1200.5),
            ("1'200", '.', 1200.0),
            ("1\u{a0}200", ',', 1200.0),
            ("1.250.000", ',', 1_250_000.0),
        ] {
            assert_eq!(digits(text, decimal), Some(number), "{text}");
        }
    }
}
