//! Rooms that are some of those counted before them: "10 single rooms, two of which are isolation rooms" are ten.

use d3dgen_model::domain::{Domain, Zone};

use crate::named::mention::Mention;
use crate::tokens::numbers::Number;
use crate::tokens::text::{Kind, Token};
use crate::tokens::words::{Spoken, Tag, is_tagged};

/// Words between some rooms and what they are, at most: "are", "are negative pressure".
const MOST_BETWEEN: usize = 4;
/// Letters of the words between a number and the rooms that it takes some of, at most: "of the", "der", "de las".
const MOST_LETTERS: usize = 3;

/// Takes rooms to sleep in that are a part of a number from that number.
pub(crate) fn settle(
    tokens: &[Token],
    numbers: &[Number],
    spoken: &[&Spoken],
    mentions: &mut [Mention],
    domain: &Domain,
) {
    let sleeps =
        |m: &Mention| m.room_type().and_then(|id| domain.room_type(id)).is_some_and(|kind| kind.zone == Zone::Night);
    let tagged = |i: usize, tag| is_tagged(spoken, tokens, i, tag);
    let exact = |end: usize| numbers.iter().find(|n| n.span.end == end && !n.article && !n.vague && n.value >= 1.0);
    for k in 1..mentions.len() {
        let (before, part) = (&mentions[k - 1], &mentions[k]);
        if !(sleeps(before) && sleeps(part) && before.what != part.what) {
            continue;
        }
        let between = before.span.end..part.span.start;
        if let Some(at) = between.clone().find(|&i| tagged(i, Tag::PartOf)) {
            // "two of which are isolation rooms": the number stands before these words
            let told = exact(at).filter(|n| part.count.is_none() && n.span.start >= before.span.end);
            let some = told.map(|n| n.value as i64).or(part.count);
            if let Some((all, some)) = before.count.zip(some).filter(|(all, some)| *some > 0 && all > some) {
                mentions[k - 1].count = Some(all - some);
                mentions[k].count = Some(some);
            }
            continue;
        }
        // "8 single rooms and 4 double rooms, two of the single rooms are isolation rooms"
        let joins = between.clone().any(|i| tokens[i].is_mark() || tagged(i, Tag::Joins) || tagged(i, Tag::Starts));
        let of = |n: &&Number| {
            let words = n.span.end..before.span.start;
            let short = |i: usize| tokens[i].kind == Kind::Word && tokens[i].text.chars().count() <= MOST_LETTERS;
            (1..=2).contains(&words.len()) && words.clone().all(|i| short(i) && !tagged(i, Tag::Joins))
        };
        let some = numbers.iter().filter(|n| !n.vague && n.value >= 1.0).find(of).map(|n| n.value as i64);
        let Some(some) = some.filter(|_| !joins && (1..=MOST_BETWEEN).contains(&between.len())) else { continue };
        let whole = (0..k - 1)
            .rev()
            .find(|&w| mentions[w].what == mentions[k - 1].what && mentions[w].count.is_some_and(|all| all > some));
        if let Some(whole) = whole {
            mentions[whole].count = mentions[whole].count.map(|all| all - some);
            mentions[k - 1].count = None;
            mentions[k - 1].definite = true;
            mentions[k].count = Some(some);
        }
    }
}
