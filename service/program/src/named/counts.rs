//! Which number counts which noun: the one before it, over adjectives, or the one behind it; what counts something else, or
//! says what one room holds, is left alone.

use crate::named::mention::{Mention, What};
use crate::named::taken::Taken;
use crate::tokens::numbers::{self, Number};
use crate::tokens::text::{Kind, Span, Token};
use crate::tokens::words::{Spoken, Tag, is_tagged, tag_end, tag_ends_at};

/// Gives mentions the numbers that count them.
pub(super) fn attach_numbers(
    tokens: &[Token],
    numbers: &[Number],
    spoken: &[&Spoken],
    language: &str,
    taken: &Taken,
    out: &mut [Mention],
) {
    let own = |m: &Mention| m.numbered.map(|n| n.span).or(m.number);
    let spans: Vec<Span> = out.iter().map(|m| m.span).chain(out.iter().filter_map(own)).collect();
    // "로봇 5대 충전소", "机器人5台充电区": the number is of the machines before it
    let behind = |n: &Number| {
        let counts = is_tagged(spoken, tokens, n.span.end, Tag::Counters);
        matches!(language, "zh" | "ko") && counts && taken.counted.iter().any(|s| s.end == n.span.start)
    };
    let usable: Vec<&Number> = numbers
        .iter()
        .filter(|n| !taken.spans.iter().chain(&taken.head).chain(&spans).any(|s| s.overlaps(n.span)))
        // "거실 2층", "三层": so many storeys
        .filter(|n| !is_tagged(spoken, tokens, n.span.end, Tag::Storeys) && !behind(n))
        .collect();
    let walls: Vec<Span> = spans.iter().chain(taken.counted).copied().collect();
    let mut used = vec![false; usable.len()];
    let open = |m: &&mut Mention| m.count.is_none() && m.numbered.is_none_or(|n| !n.span.contains(m.span.start));
    for m in out.iter_mut().filter(open) {
        let after = || number_after(tokens, m.span.end, &usable, spoken, language);
        // the garage of "2 car garage" is one
        let holds =
            m.span.end > m.span.start + 1 && tag_ends_at(spoken, tokens, m.span.start, Tag::Holds, m.span.start + 1);
        let before = || number_before(tokens, m.span.start, &usable, spoken, &walls).filter(|_| !holds);
        let found = if language == "ko" { after().or_else(before) } else { before().or_else(after) };
        let special = || {
            let tag = match m.what {
                What::Staff => Tag::StaffBefore,
                What::Visitors => Tag::VisitorsBefore,
                _ => return None,
            };
            let ends = tag_ends_at(spoken, tokens, m.span.start, tag, m.span.end);
            ends.then(|| usable.iter().position(|n| n.span.start == m.span.end)).flatten()
        };
        let Some(k) = special().or(found).filter(|&k| !used[k]) else {
            m.definite = (m.span.start.saturating_sub(2)..m.span.start).any(|k| {
                spoken.iter().any(|s| s.tag_at(tokens, k, Tag::Definite).is_some_and(|end| end <= m.span.start))
            });
            continue;
        };
        let number = usable[k];
        used[k] = !(number.article || number.vague);
        m.count = Some(number.value.clamp(-1e9, 1e9).trunc() as i64);
        m.number = Some(number.span);
        m.article = number.article;
        m.vague = number.vague;
        m.from = m.from.min(number.span.start);
        m.definite = number.span.start > 0 && is_tagged(spoken, tokens, number.span.start - 1, Tag::Definite);
    }
}

/// Returns the number before a noun, over adjectives and counters.
fn number_before(
    tokens: &[Token],
    start: usize,
    numbers: &[&Number],
    spoken: &[&Spoken],
    nouns: &[Span],
) -> Option<usize> {
    let mut at = start;
    for _ in 0..5 {
        if let Some(k) = numbers.iter().position(|n| n.span.end == at) {
            return Some(k);
        }
        at = at.checked_sub(1)?;
        let token = &tokens[at];
        let number = matches!(token.kind, Kind::Number(_)) && !numbers::is_name(tokens, at, spoken);
        if token.is_mark() || nouns.iter().any(|s| s.contains(at)) || number {
            return None;
        }
        let has = |tag| tag_ends_at(spoken, tokens, at, tag, at + 1);
        // "6 person meeting room", "2 car garage", "10人会议室": the number is of what one room holds
        if has(Tag::Holds) && (at == start - 1 || !has(Tag::Counters)) {
            return None;
        }
        let parts = [Tag::Stops, Tag::Starts, Tag::No, Tag::Near, Tag::Door, Tag::Joins, Tag::Each, Tag::Definite];
        let joint = matches!(token.text.as_str(), "的" | "의" | "de" | "of");
        if !joint && parts.iter().any(|&tag| has(tag)) && !has(Tag::Counters) {
            return None;
        }
    }
    None
}

/// Returns the number after a noun: "방 2개", "会议室3间", "bedrooms: 3", "bedroom x 2".
pub(crate) fn number_after(
    tokens: &[Token],
    end: usize,
    numbers: &[&Number],
    spoken: &[&Spoken],
    language: &str,
) -> Option<usize> {
    let closes = |at: usize| tokens.get(at).is_none_or(Token::is_mark);
    let number_at = |at: usize| numbers.iter().position(|n| n.span.start == at);
    let next = tokens.get(end)?;
    let counter = |at: usize| tag_end(spoken, tokens, at, Tag::Counters);
    match language {
        "ko" => {
            let particle =
                !next.spaced && matches!(next.text.as_str(), "은" | "는" | "이" | "가" | "을" | "를" | "도" | "만");
            let at = if particle { end + 1 } else { end };
            number_at(at).filter(|&k| counter(numbers[k].span.end).is_some() || closes(numbers[k].span.end))
        }
        "zh" => number_at(end).filter(|&k| {
            let after = counter(numbers[k].span.end).unwrap_or(numbers[k].span.end);
            let joined = is_tagged(spoken, tokens, after, Tag::Joins);
            // "等候区6人": so many wait there
            let holds = [Tag::People, Tag::Visitors, Tag::Staff, Tag::Desks, Tag::ServicePoints];
            let held = |at: usize| at < tokens.len() && holds.iter().any(|&t| is_tagged(spoken, tokens, at, t));
            !held(numbers[k].span.end) && !held(after) && (closes(after) || joined || tokens[after].spaced)
        }),
        _ => {
            let at = if matches!(next.text.as_str(), "x" | ":" | "," | "-") { end + 1 } else { return None };
            let listed = next.text != "," && next.text != "-";
            number_at(at).filter(|&k| closes(numbers[k].span.end) && (listed || tokens.len() > numbers[k].span.end))
        }
    }
}

/// Gives the number in "3 ensuite bedrooms" to the bedrooms.
pub(super) fn count_hosts(tokens: &[Token], spoken: &[&Spoken], out: &mut [Mention]) {
    for g in 1..out.len() {
        let (before, after) = out.split_at_mut(g);
        let (Some(guest), Some(host)) = (before.last_mut(), after.first_mut()) else { continue };
        let own = is_tagged(spoken, tokens, guest.span.start, Tag::Own) && guest.span.end == host.span.start;
        if own && guest.room_type().is_some() && host.room_type().is_some() && host.count.is_none() {
            (host.count, host.article, host.vague) = (guest.count.take(), guest.article, guest.vague);
            host.number = guest.number.take();
            host.from = guest.from;
        }
    }
}
