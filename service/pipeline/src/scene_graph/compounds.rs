//! Words for several rooms at once: "kitchen-living room", "Wohn-Essbereich", "salón comedor" are joined by openings, a
//! "master suite" is a bedroom and the bathroom entered from it. And "open kitchen": open to whatever room it serves.

use d3dgen_model::domain::{Access, Domain};
use d3dgen_model::scene_graph::Connector;

use super::mentions::{Mention, What};
use super::relations::{Relation, Said, Spread};
use super::text::{Kind, Span, Token};
use super::words::{Spoken, Tag};

/// Words for several rooms.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Compound {
    pub span: Span,
    /// Types of its rooms, no type twice.
    pub room_types: Vec<String>,
    /// True for rooms that only share a noun: "single and double rooms".
    pub mixed: bool,
}

/// Returns the compounds of a prompt whose rooms the domain knows, in order; none overlaps what is taken.
pub(super) fn find(
    tokens: &[Token],
    prompt: &str,
    domain: &Domain,
    spoken: &[&Spoken],
    taken: impl Fn(Span) -> bool,
) -> Vec<Compound> {
    let mut out: Vec<Compound> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let suite = spoken.iter().filter_map(|s| s.suites.longest_at(tokens, i)).max_by_key(|f| f.0);
        let mix = spoken.iter().filter_map(|s| s.mixes.longest_at(tokens, i)).max_by_key(|f| f.0);
        let mixed = mix.is_some();
        let found = match mix.or(suite) {
            Some((end, types)) => Some((end, types.clone())),
            None => joint(tokens, prompt, i, spoken),
        };
        let known = |t: &String| domain.room_type(t).is_some();
        match found.filter(|(end, types)| types.iter().all(known) && !taken(Span { start: i, end: *end })) {
            Some((end, room_types)) => {
                out.push(Compound { span: Span { start: i, end }, room_types, mixed });
                i = end;
            }
            None => i += 1,
        }
    }
    out
}

/// Reads rooms of the day that one phrase names: "open plan kitchen, dining and living area".
fn joint(tokens: &[Token], prompt: &str, i: usize, spoken: &[&Spoken]) -> Option<(usize, Vec<String>)> {
    let open = i > 0 && is_open(tokens, i - 1, spoken, true);
    let at = |k: usize| spoken.iter().filter_map(|s| s.joint.longest_at(tokens, k)).max_by_key(|f| f.0);
    let tagged = |k: usize, tag| spoken.iter().find_map(|s| s.tag_at(tokens, k, tag));
    let (mut end, first) = at(i)?;
    let mut types: Vec<String> = first.clone();
    let words = tokens[i].kind == Kind::Word;
    loop {
        // "living room", "Wohn-Ess-Bereich"
        if tokens.get(end).is_some_and(|t| !t.is_mark()) && at(end).is_none() {
            let noun = tagged(end, Tag::SpaceWords).or_else(|| tagged(end, Tag::RoomWords));
            end = noun.filter(|e| *e == end + 1 && words).unwrap_or(end);
        }
        let mut next = end;
        let slash = |k: usize| {
            let t = &tokens[k];
            t.mark() == Some('/') && prompt.get(t.start..).is_some_and(|p| p.starts_with(['/', '&']))
        };
        while next < tokens.len() && next < end + 3 && at(next).is_none() {
            let joins = open && (tokens[next].mark() == Some(',') || tagged(next, Tag::Joins).is_some());
            let little = open && next > end && tagged(next, Tag::Articles).or(tagged(next, Tag::Definite)).is_some();
            if !(joins || little || slash(next)) {
                break;
            }
            next += 1;
        }
        let Some((to, more)) = tokens.get(next).and_then(|_| at(next)).filter(|_| words || open) else { break };
        let fresh: Vec<String> = more.iter().filter(|t| !types.contains(t)).cloned().collect();
        if fresh.is_empty() {
            break;
        }
        types.extend(fresh);
        end = to;
    }
    // "open-plan living"
    (types.len() > 1 || open).then_some((end, types))
}

/// Returns true for a word such as "open-plan" that ends at a token (`before` a room) or begins at one (behind it).
fn is_open(tokens: &[Token], i: usize, spoken: &[&Spoken], before: bool) -> bool {
    let from = if before { i.saturating_sub(2) } else { i };
    (from..=i).any(|k| {
        spoken.iter().any(|s| s.tag_at(tokens, k, Tag::OpenPlan).is_some_and(|end| !before && k == i || end == i + 1))
    })
}

/// Returns the mentions of a compound, one a room; numbers are not yet with them.
pub(super) fn mentions(compound: &Compound) -> impl Iterator<Item = Mention> + '_ {
    compound.room_types.iter().map(|t| Mention::plain(compound.span, What::Room(t.clone())))
}

/// Gives all rooms of a compound the number of the first, and takes a room out that is one of those before it: "three
/// bedrooms including a master suite".
pub(super) fn settle(tokens: &[Token], compounds: &[Compound], spoken: &[&Spoken], mentions: &mut Vec<Mention>) {
    for compound in compounds {
        let Some(first) = mentions.iter().position(|m| m.span == compound.span) else { continue };
        let head = mentions[first].clone();
        if compound.mixed {
            share(mentions, compound, &head);
            continue;
        }
        let before = mentions[..first].iter().rev().find(|m| m.what == head.what && m.count.is_some_and(|n| n > 1));
        let part = before.is_some_and(|m| {
            (m.span.end..compound.span.start).any(|k| spoken.iter().any(|s| s.tag_at(tokens, k, Tag::PartOf).is_some()))
        });
        let single = head.count.is_none() && !head.plural;
        for m in mentions.iter_mut().filter(|m| m.span == compound.span) {
            m.from = head.from;
            if single {
                (m.count, m.article) = (Some(1), true);
            } else {
                (m.count, m.article, m.vague) = (head.count, head.article, head.vague);
            }
        }
        if part {
            mentions.remove(first);
        }
    }
    // "Wohnküche, Wohnzimmer": what one word names beside the kitchen may be named by itself
    for compound in compounds.iter().filter(|c| !c.mixed && c.span.end == c.span.start + 1) {
        let own = |m: &Mention| m.span == compound.span;
        let elsewhere = |what: &What| mentions.iter().any(|m| !own(m) && &m.what == what);
        let spare: Vec<What> = mentions.iter().filter(|m| own(m)).skip(1).map(|m| m.what.clone()).collect();
        let spare: Vec<What> = spare.into_iter().filter(|w| elsewhere(w)).collect();
        mentions.retain(|m| !(own(m) && spare.contains(&m.what)));
    }
}

/// Shares the number of "12 single and double rooms" out to them; without one their beds say how many there are.
fn share(mentions: &mut [Mention], compound: &Compound, head: &Mention) {
    let kinds = compound.room_types.len() as i64;
    let told = head.count.filter(|n| !head.article && *n >= kinds);
    for (k, m) in mentions.iter_mut().filter(|m| m.span == compound.span).enumerate() {
        let k = k as i64;
        m.from = head.from;
        m.count = told.map(|n| n / kinds + i64::from(k < n % kinds));
        (m.plural, m.article, m.vague) = (true, false, head.vague);
    }
}

/// Joins the rooms of each compound: an en suite to the room it is entered from, others by openings.
pub(super) fn relate(compounds: &[Compound], mentions: &[Mention], domain: &Domain, said: &mut Said) {
    for compound in compounds.iter().filter(|c| !c.mixed) {
        let all: Vec<usize> = (0..mentions.len()).filter(|&m| mentions[m].span == compound.span).collect();
        for pair in all.windows(2) {
            let kind = mentions[pair[1]].room_type().and_then(|id| domain.room_type(id));
            let belongs = kind.is_some_and(|k| k.access == Access::Host);
            let (subject, object) = if belongs { (pair[1], pair[0]) } else { (pair[0], pair[1]) };
            let connector = if belongs { Connector::Door } else { Connector::Open };
            said.relations.push(Relation { subject, object, connector, spread: Spread::Each, apart: false, belongs });
        }
    }
}

/// Opens rooms of the day to each other that "living area with open kitchen" puts one into the other.
pub(super) fn open_belongings(
    tokens: &[Token],
    mentions: &[Mention],
    domain: &Domain,
    spoken: &[&Spoken],
    said: &mut Said,
) {
    let types = |m: usize| mentions[m].room_type();
    for r in said.relations.iter_mut().filter(|r| r.belongs) {
        let (Some(a), Some(b)) = (types(r.subject), types(r.object)) else { continue };
        let joins = domain.layouts.open_joins.iter().any(|j| j.iter().any(|t| t == a) && j.iter().any(|t| t == b));
        if a != b && joins && is_called_open(tokens, &mentions[r.subject], spoken) {
            (r.belongs, r.connector) = (false, Connector::Open);
        }
    }
}

/// Returns true for "open kitchen", "cuisine ouverte".
fn is_called_open(tokens: &[Token], m: &Mention, spoken: &[&Spoken]) -> bool {
    let before = m.span.start.checked_sub(1).is_some_and(|i| is_open(tokens, i, spoken, true));
    // "cuisine ouverte", but "kitchen open study"
    let noun = |i: usize| spoken.iter().any(|s| s.joint.longest_at(tokens, i).is_some());
    before
        || tokens.get(m.span.end).is_some_and(|t| !t.is_mark())
            && is_open(tokens, m.span.end, spoken, false)
            && !noun(m.span.end + 1)
}

/// Returns the types of rooms that an open layout of the domain joins to one, best first.
pub(super) fn opens_to<'d>(domain: &'d Domain, id: &'d String) -> impl Iterator<Item = &'d String> {
    domain.layouts.open_joins.iter().filter(move |join| join.contains(id)).flatten().filter(move |other| *other != id)
}

/// Returns the types of rooms that the prompt calls open and that an open layout of the domain joins to others.
pub(super) fn open_rooms(tokens: &[Token], mentions: &[Mention], domain: &Domain, spoken: &[&Spoken]) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    for m in mentions {
        let Some(id) = m.room_type().filter(|id| domain.layouts.open_joins.iter().flatten().any(|j| j == id)) else {
            continue;
        };
        if is_called_open(tokens, m, spoken) && !out.iter().any(|o| o == id) {
            out.push(id.to_owned());
        }
    }
    out
}
