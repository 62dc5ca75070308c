//! Words that mean a room in a list and a thing behind another room: the "showers" of a shared flat, the "shower" of a bathroom.

use d3dgen_model::domain::Domain;
use d3dgen_model::offer::Wet;

use crate::named::mention::{Mention, What};
use crate::tokens::text::{Span, Token};
use crate::tokens::words::{Spoken, Tag, is_tagged, words};

/// Settles what the word for a shower means: a thing in "bathroom with shower", a bathroom where no other room has a toilet
/// ("bedroom, kitchen, shower") or in "shower/WC", a room of its own everywhere else. Returns the words for things.
pub(crate) fn settle(
    tokens: &[Token],
    prompt: &str,
    mentions: &mut Vec<Mention>,
    domain: &Domain,
    wet: &Wet,
    spoken: &[&Spoken],
) -> Vec<Span> {
    let d = &words().dwelling;
    if domain.room_type(&d.shower).is_none() || !mentions.iter().any(|m| m.room_type() == Some(&d.shower)) {
        return Vec::new();
    }
    let shower = |m: &Mention| m.room_type() == Some(d.shower.as_str());
    let toilet = |m: &Mention| m.room_type().and_then(|id| domain.room_type(id)).is_some_and(|k| wet.has_toilet(k));
    let tagged = |i: usize, tag| is_tagged(spoken, tokens, i, tag);
    let bracket = |i: usize| prompt.get(tokens[i].start..).is_some_and(|p| p.starts_with(['(', '[']));
    let mut things: Vec<usize> = Vec::new();
    let mut whole: Vec<usize> = Vec::new();
    for (i, m) in mentions.iter().enumerate().filter(|(_, m)| shower(m)) {
        let inside = |w: &Mention| {
            let gap = w.span.end..m.from.min(m.span.start);
            let starts = gap.clone().any(|k| tagged(k, Tag::Starts)) && !gap.clone().any(|k| tokens[k].is_mark());
            toilet(w) && w.span.end <= m.span.start && (starts || gap.start < gap.end && bracket(gap.start))
        };
        if mentions[..i].iter().any(inside) {
            things.push(i);
            // "bathroom with shower and toilet"
            let joined = |k: usize| tagged(k, Tag::Joins) || tokens[k].mark() == Some('/');
            let next = mentions.get(i + 1).filter(|n| n.span.start == m.span.end + 1 && joined(m.span.end));
            things.extend(next.filter(|n| toilet(n)).map(|_| i + 1));
            continue;
        }
        let slash = |k: usize| tokens.get(k).is_some_and(|t| t.mark() == Some('/'));
        let beside = [i.checked_sub(1), Some(i + 1)].into_iter().flatten().find(|&o| {
            let (a, b) = if o < i { (o, i) } else { (i, o) };
            let pair = mentions.get(a).zip(mentions.get(b));
            pair.is_some_and(|(a, b)| a.span.end + 1 == b.span.start && slash(a.span.end))
                && mentions.get(o).is_some_and(toilet)
        });
        if let Some(other) = beside {
            whole.push(i);
            things.push(other);
        }
    }
    let lone = !mentions.iter().any(toilet);
    for (i, m) in mentions.iter_mut().enumerate() {
        if whole.contains(&i) || lone && m.room_type() == Some(&d.shower) {
            m.what = What::Room(d.bathroom.clone());
        }
    }
    let spans = things.iter().map(|&i| mentions[i].span).collect();
    let mut at = 0;
    mentions.retain(|_| {
        at += 1;
        !things.contains(&(at - 1))
    });
    spans
}
