//! Robots that a prompt names: kind, number, charging.

use super::numbers::Number;
use super::text::{Span, Token};
use super::words::{Spoken, Tag};

/// Robots of one kind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Wanted {
    pub kind: &'static str,
    pub count: u32,
}

/// What the prompt says about robots.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Robots {
    pub wanted: Vec<Wanted>,
    pub spans: Vec<Span>,
    /// True when the kind was not said.
    pub kind_assumed: bool,
    /// True when robots are named at all.
    pub named: bool,
}

const KINDS: [(Tag, &str); 4] =
    [(Tag::Clean, "cleaning"), (Tag::Deliver, "delivery"), (Tag::Serve, "service"), (Tag::Transport, "transport")];
const VERBS: [(Tag, &str); 4] = [
    (Tag::CleanVerbs, "cleaning"),
    (Tag::DeliverVerbs, "delivery"),
    (Tag::ServeVerbs, "service"),
    (Tag::TransportVerbs, "transport"),
];

/// Finds the robots of a prompt.
pub(super) fn read(tokens: &[Token], numbers: &[Number], spoken: &[&Spoken]) -> Robots {
    let mut out = Robots::default();
    let mut loose: Vec<(usize, u32)> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        // the longest phrase of any language decides: "robot docking" is no kind of robot
        let found = spoken.iter().filter_map(|s| s.tags.longest_at(tokens, i)).max_by_key(|f| f.0);
        let Some((end, tags)) = found else {
            i += 1;
            continue;
        };
        let count = count_of(tokens, (i, end), numbers, spoken);
        if let Some((_, kind)) = KINDS.iter().find(|(tag, _)| tags.contains(tag)) {
            let kind = if *kind == "delivery" && serves(tokens, i, spoken) { "service" } else { kind };
            out.spans.push(Span { start: i, end });
            add(&mut out.wanted, kind, count);
        } else if tags.contains(&Tag::Robot) {
            out.spans.push(Span { start: i, end });
            loose.push((i, count));
        } else if tags.contains(&Tag::ChargePlace) && robot_inside(tokens, i, end, spoken) {
            loose.push((i, 1));
        }
        i = end.max(i + 1);
    }
    out.named = !out.wanted.is_empty() || !loose.is_empty();
    for (at, count) in loose {
        let kinds = verbs(tokens, at, spoken);
        match (kinds.as_slice(), out.wanted.as_mut_slice()) {
            // "AMR charging area for 4 robots": the same robots again
            (_, [one]) if !kinds.iter().any(|k| k != &one.kind) => one.count = one.count.max(count),
            (_, [_, ..]) if kinds.is_empty() => {}
            ([], _) => {
                out.kind_assumed = true;
                add(&mut out.wanted, "service", count);
            }
            (kinds, _) => kinds.iter().for_each(|kind| add(&mut out.wanted, kind, count)),
        }
    }
    out
}

fn add(wanted: &mut Vec<Wanted>, kind: &'static str, count: u32) {
    match wanted.iter_mut().find(|w| w.kind == kind) {
        Some(known) => known.count = known.count.max(count),
        None => wanted.push(Wanted { kind, count }),
    }
}

/// Returns the number before a robot, or behind it with a counter: "机器人三台", "로봇 2대".
fn count_of(tokens: &[Token], (start, end): (usize, usize), numbers: &[Number], spoken: &[&Spoken]) -> u32 {
    let counter = |i: usize| spoken.iter().any(|s| s.tag_at(tokens, i, Tag::Counters).is_some());
    let near = numbers.iter().rev().find(|n| {
        n.span.end <= start && start - n.span.end <= 2 && !tokens[n.span.end..start].iter().any(Token::is_mark)
    });
    let near = near.or_else(|| numbers.iter().find(|n| n.span.start == end && counter(n.span.end)));
    near.map_or(1, |n| n.value.clamp(1.0, 100.0) as u32)
}

fn robot_inside(tokens: &[Token], start: usize, end: usize, spoken: &[&Spoken]) -> bool {
    (start..end).any(|i| spoken.iter().any(|s| s.tag_at(tokens, i, Tag::Robot).is_some()))
        || (start..end).any(|i| tokens[i].text.contains("robot"))
}

fn sentence(tokens: &[Token], at: usize) -> std::ops::Range<usize> {
    let start = (0..at).rev().find(|&i| tokens[i].ends_sentence()).map_or(0, |i| i + 1);
    let end = (at..tokens.len()).find(|&i| tokens[i].ends_sentence()).unwrap_or(tokens.len());
    start..end
}

/// Returns true when a delivery robot brings things to guests at tables.
fn serves(tokens: &[Token], at: usize, spoken: &[&Spoken]) -> bool {
    let range = at..sentence(tokens, at).end.min(at + 12);
    range.into_iter().any(|i| spoken.iter().any(|s| s.tag_at(tokens, i, Tag::TableWords).is_some()))
}

fn verbs(tokens: &[Token], at: usize, spoken: &[&Spoken]) -> Vec<&'static str> {
    let range = sentence(tokens, at);
    let from = range.start.max(at.saturating_sub(8));
    let mut kinds = Vec::new();
    for i in from..range.end.min(at + 12) {
        for (tag, kind) in VERBS {
            let here = spoken.iter().any(|s| s.tag_at(tokens, i, tag).is_some());
            if here && !kinds.contains(&kind) {
                kinds.push(kind);
            }
        }
    }
    kinds
}
