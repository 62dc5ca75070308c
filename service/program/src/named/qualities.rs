//! What a prompt says of single rooms: how large they are ("big kitchen"), what their name says stands in them ("eat-in
//! kitchen").

use d3dgen_model::domain::Domain;

use crate::named::mention::Mention;
use crate::tokens::text::{Span, Token};
use crate::tokens::words::Spoken;

/// Words between a number and the room that it counts which may say how large it is, at most.
const MOST_BEFORE: usize = 4;

/// Returns the factor on the usual area of a room that the words beside it ask for.
pub(crate) fn size(tokens: &[Token], mention: &Mention, spoken: &[&Spoken], behind: bool) -> Option<f64> {
    let at = |k: usize| spoken.iter().filter_map(|s| s.sizes.longest_at(tokens, k)).max_by_key(|f| f.0);
    let number_end = mention.number.filter(|n| n.end <= mention.span.start).map_or(0, |n| n.end);
    let from = number_end.max(mention.span.start.saturating_sub(MOST_BEFORE));
    let clear = |k: usize| !(k..mention.span.start).any(|i| tokens[i].is_mark());
    let words = |end: usize| mention.span.start - end;
    // "large sunny kitchen", but not "large house with kitchen"
    let before = (from..mention.span.start)
        .find_map(|k| at(k).filter(|f| clear(k) && f.0 <= mention.span.start && words(f.0) <= 1));
    // "cuisine spacieuse"
    let after = || at(mention.span.end).filter(|_| behind && mention.span.end < tokens.len());
    let own = || (mention.span.start..mention.span.end).find_map(at);
    before.or_else(after).or_else(own).map(|f| *f.1)
}

/// A place in a room that the prompt names: "home office corner".
pub(crate) struct Nook {
    pub span: Span,
    pub object: String,
    /// Room types it may be in, the usual one first.
    pub room_types: Vec<String>,
}

/// Returns the places in rooms that a prompt names and the domain can furnish.
pub(crate) fn nooks(tokens: &[Token], spoken: &[&Spoken], domain: &Domain, taken: impl Fn(usize) -> bool) -> Vec<Nook> {
    let mut out: Vec<Nook> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let found = spoken.iter().filter_map(|s| s.nooks.longest_at(tokens, i)).max_by_key(|f| f.0);
        let Some((end, words)) = found.filter(|_| !taken(i)) else {
            i += 1;
            continue;
        };
        if let [object, room_types @ ..] = words.as_slice()
            && domain.object(object).is_some()
        {
            let room_types = room_types.iter().filter(|id| domain.room_type(id).is_some()).cloned().collect();
            out.push(Nook { span: Span { start: i, end }, object: object.clone(), room_types });
        }
        i = end;
    }
    out
}

/// Returns the objects that the names of rooms say stand in them, each with the type of its room, and their words.
pub(crate) fn furnished(
    tokens: &[Token],
    spoken: &[&Spoken],
    free: impl Fn(usize) -> bool,
) -> Vec<(String, String, Span)> {
    let mut out = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let found = spoken.iter().filter_map(|s| s.furnished.longest_at(tokens, i)).max_by_key(|f| f.0);
        match found.filter(|_| free(i)) {
            Some((end, pair)) => {
                if let [room, object] = pair.as_slice() {
                    out.push((object.clone(), room.clone(), Span { start: i, end }));
                }
                i = end;
            }
            None => i += 1,
        }
    }
    out
}
