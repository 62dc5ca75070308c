//! Rooms that are only compared: "fewer bedrooms than bathrooms" wishes for none of them, but says how many there may be.

use d3dgen_model::scene_graph::Note;

use super::wishes::{Wish, Wishes};
use crate::named::mention::Mention;
use crate::tokens::text::{Span, Token};
use crate::tokens::words::{Spoken, Tag, tag_end};

/// Words from "fewer" to the first rooms, and from these to the others, at most: "than there are".
const MOST_BETWEEN: usize = 4;

/// Rooms of which there are to be fewer than of others, by their types.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Comparison {
    fewer: String,
    more: String,
}

/// Takes rooms that are compared from the mentions; returns the comparisons and their words.
pub(crate) fn read(tokens: &[Token], mentions: &mut Vec<Mention>, spoken: &[&Spoken]) -> (Vec<Comparison>, Vec<Span>) {
    let tagged = |i: usize, tag| tag_end(spoken, tokens, i, tag);
    let (mut out, mut spans) = (Vec::new(), Vec::new());
    for start in 0..tokens.len() {
        let (end, fewer) = match (tagged(start, Tag::Fewer), tagged(start, Tag::More)) {
            (Some(end), _) => (end, true),
            (None, Some(end)) => (end, false),
            (None, None) => continue,
        };
        let Some(a) = mentions.iter().position(|m| m.span.start >= end) else { continue };
        let Some(b) = mentions.get(a + 1) else { continue };
        let gap = mentions[a].span.end..b.span.start;
        let near = mentions[a].span.start - end <= MOST_BETWEEN && gap.len() <= MOST_BETWEEN;
        let than = gap.clone().any(|i| tagged(i, Tag::Than).is_some()) && !gap.into_iter().any(|i| tokens[i].is_mark());
        let (Some(first), Some(second)) = (mentions[a].room_type(), b.room_type()) else { continue };
        if !near || !than || first == second {
            continue;
        }
        let (first, second) = (first.to_owned(), second.to_owned());
        let (fewer, more) = if fewer { (first, second) } else { (second, first) };
        spans.push(Span { start, end: b.span.end });
        out.push(Comparison { fewer, more });
        mentions.drain(a..=a + 1);
    }
    (out, spans)
}

/// Counts what is only compared by what the prompt counts, and says where its numbers contradict it.
pub(crate) fn settle(
    comparisons: &[Comparison],
    wishes: &mut Wishes,
    assumptions: &mut Vec<Note>,
    conflicts: &mut Vec<Note>,
) {
    for Comparison { fewer, more } in comparisons {
        let count = |id: &String| wishes.wishes.iter().find(|w| &w.room_type == id).map(|w| w.count);
        let names = [fewer, more].map(|id| id.replace('_', " "));
        let [less, most] = &names;
        let (id, n) = match (count(fewer), count(more)) {
            (Some(few), Some(many)) if few >= many => {
                let message = format!(
                    "the prompt asks for fewer rooms of type {less} than of type {most}, but for {few} and {many}; these were planned"
                );
                conflicts.push(Note::new("contradicting_counts", message));
                continue;
            }
            (Some(_), Some(_)) => continue,
            (Some(few), None) => (more, few + 1),
            (None, Some(many)) if many > 1 => (fewer, many - 1),
            (None, _) => {
                let message = format!("how many rooms of type {less} are fewer than of type {most} was not planned");
                conflicts.push(Note::new("unread_wish", message));
                continue;
            }
        };
        let name = id.replace('_', " ");
        assumptions
            .push(Note::new("compared_count", format!("{n} rooms of type {name} were taken, by those of the other")));
        wishes.wishes.push(Wish { count: n, exact: true, listed: true, ..Wish::one(id, &name) });
    }
}
