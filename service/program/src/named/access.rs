//! Words that wish for access without steps, as in "wheelchair users".

use crate::tokens::numbers::Number;
use crate::tokens::text::{Span, Token};
use crate::tokens::words::{Spoken, Tag, tag_end};

/// Returns the words that wish for access, as in "wheelchair users": all but the things of lists, as in "with a bed, two
/// wheelchairs and a desk".
pub(crate) fn wishes(tokens: &[Token], numbers: &[Number], spoken: &[&Spoken]) -> Vec<Span> {
    let tagged = |i: usize, tag| tag_end(spoken, tokens, i, tag);
    let parted = |i: usize, tags: &[Tag]| {
        tokens.get(i).is_none_or(Token::is_mark) || tags.iter().any(|&t| tagged(i, t).is_some())
    };
    let listed = |i: usize| {
        let opens = |k: usize| [Tag::Starts, Tag::Joins].iter().any(|&t| tagged(k, t) == Some(i));
        i == 0 || tokens[i - 1].is_mark() || (i.saturating_sub(3)..i).any(opens)
    };
    let is_thing = |start: usize, end: usize| {
        let number = numbers.iter().find(|n| n.span.end == start);
        let before = number.map_or_else(|| listed(start), |n| !n.article || listed(n.span.start));
        before && parted(end, &[Tag::Joins, Tag::Stops])
    };
    (0..tokens.len())
        .filter_map(|start| tagged(start, Tag::Accessible).map(|end| Span { start, end }))
        .filter(|s| !is_thing(s.start, s.end))
        .collect()
}
