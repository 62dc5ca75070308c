//! Who stays overnight with a patient: "parents should be able to stay overnight", "rooming-in", "Eltern übernachten". No
//! room of their own, but a bed in the patient's.

use crate::tokens::text::{Span, Token};
use crate::tokens::words::{Spoken, Tag, tag_end};

/// Words between those who stay and their staying, at most: "parents should be able to".
const MOST_BETWEEN: usize = 6;

/// Returns the words that say so.
pub(crate) fn read(tokens: &[Token], spoken: &[&Spoken]) -> Option<Span> {
    let tagged = |i: usize, tag| tag_end(spoken, tokens, i, tag);
    let alone = (0..tokens.len()).find_map(|start| Some(Span { start, end: tagged(start, Tag::RoomingIn)? }));
    let near = |start: usize| {
        let (first, other) = match (tagged(start, Tag::Companions), tagged(start, Tag::Overnight)) {
            (Some(end), _) => (end, Tag::Overnight),
            (None, Some(end)) => (end, Tag::Companions),
            (None, None) => return None,
        };
        let mut at = (first..tokens.len().min(first + MOST_BETWEEN)).take_while(|&i| !tokens[i].is_mark());
        let end = at.find_map(|i| tagged(i, other))?;
        Some(Span { start, end })
    };
    alone.or_else(|| (0..tokens.len()).find_map(near))
}
