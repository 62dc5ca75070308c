//! People who share a home and have a room each: "shared flat for six", "4er-WG", "everyone has their own bedroom".

use crate::named::mention::{Mention, What};
use crate::tokens::numbers::{self, Number};
use crate::tokens::text::{Kind, Span, Token};
use crate::tokens::words::{Spoken, Tag, is_tagged, tag_end};

/// Words from those who have something to the word that it is their own, at most: "each of the tenants has his own".
const MOST_TO_OWN: usize = 6;
/// Words from that word to the room, at most: "own large room".
const MOST_TO_ROOM: usize = 3;
/// Most people who share a home.
const MOST: f64 = 60.0;

/// Returns the words that give everyone a room to sleep in, the word for the room among them; `sleeps` tells types of such
/// rooms.
pub(crate) fn each_has_a_room(
    tokens: &[Token],
    mentions: &[Mention],
    spoken: &[&Spoken],
    sleeps: impl Fn(&str) -> bool,
) -> Option<Span> {
    let tagged = |i: usize, tag| is_tagged(spoken, tokens, i, tag);
    let room = |i: usize| {
        let at = mentions.iter().find(|m| m.span.start == i);
        tagged(i, Tag::Total) || at.is_some_and(|m| m.what == What::Total || m.room_type().is_some_and(&sleeps))
    };
    // "six bedrooms, each with own bathroom": it is the rooms that have something
    let of_rooms = |i: usize| {
        let before = mentions.iter().rev().find(|m| m.span.end <= i);
        before.is_some_and(|m| m.room_type().is_some() && m.span.end + 2 > i)
    };
    (0..tokens.len()).find_map(|i| {
        if let Some(end) = tag_end(spoken, tokens, i, Tag::SingleRooms) {
            return Some(Span { start: i, end });
        }
        let goes_on = |from: usize, most: usize| {
            (from..(from + most).min(tokens.len())).take_while(|&k| !tokens[k].ends_sentence())
        };
        if !tagged(i, Tag::Everyone) || of_rooms(i) {
            return None;
        }
        let inside =
            |k: usize| mentions.iter().any(|m| m.room_type().is_some() && m.span.start < k && m.span.contains(k));
        let owned = goes_on(i + 1, MOST_TO_OWN).take_while(|&k| !inside(k)).filter(|&k| tagged(k, Tag::Own));
        let at = owned.filter_map(|k| goes_on(k + 1, MOST_TO_ROOM).find(|&r| room(r))).next()?;
        let end = mentions.iter().find(|m| m.span.start == at).map_or(at + 1, |m| m.span.end);
        Some(Span { start: i, end })
    })
}

/// Returns how many share a home by the number at its name: "4er-WG", "Vierer-WG", "WG für 4", "colocation à 4".
pub(crate) fn residents(tokens: &[Token], numbers: &[Number], head: Span, spoken: &[&Spoken]) -> Option<u32> {
    let sane = |n: f64| (n.fract() == 0.0 && (2.0..=MOST).contains(&n)).then_some(n as u32);
    let before = head.start.checked_sub(1).map(|k| &tokens[k]).filter(|t| t.kind == Kind::Word);
    let of_many = before.and_then(|t| t.text.strip_suffix("er")).and_then(|n| {
        let digits = n.parse::<f64>().ok();
        digits.or_else(|| spoken.iter().find_map(|s| numbers::in_one_word(n, s)))
    });
    let of_many = of_many.and_then(sane);
    let for_many = || {
        let little = |k: usize| [Tag::Stops, Tag::PlaceBefore].iter().any(|&t| is_tagged(spoken, tokens, k, t));
        let at = head.end + usize::from(head.end < tokens.len() && little(head.end));
        let number = numbers.iter().find(|n| n.span.start == at && at > head.end && !n.article && !n.vague)?;
        tokens.get(number.span.end).is_none_or(Token::is_mark).then(|| sane(number.value)).flatten()
    };
    of_many.or_else(for_many)
}
