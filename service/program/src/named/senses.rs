//! Words for rooms that mean one thing here and another there: the control room beside a scanner is that scanner's, the
//! treatment room of a dental practice has a dental chair.

use d3dgen_model::domain::{Access, Adjacency, AdjacencyRelation, Domain, GENERIC_ROOM_TYPE, Program, Zone};
use d3dgen_model::offer;

use super::mentions::Vocabulary;
use crate::named::mention::{Mention, What};
use crate::tokens::text::Token;
use crate::tokens::words::{Spoken, Tag, is_tagged};

/// Gives every mention of a room the type that its words have in this building.
pub(crate) fn settle(
    tokens: &[Token],
    mentions: &mut Vec<Mention>,
    vocabulary: &Vocabulary,
    spoken: &[&Spoken],
    (domain, program): (&Domain, &Program),
) {
    count_guests(tokens, mentions, spoken, (domain, program));
    let mut more: Vec<(usize, Mention)> = Vec::new();
    for m in 0..mentions.len() {
        if mentions[m].room_type().is_none() {
            continue;
        }
        let senses = vocabulary.senses_at(tokens, mentions[m].span);
        // "MRI, CT and control rooms": each scanner has its own
        let each = if mentions[m].plural && mentions[m].count.is_none() {
            partnered(mentions, &senses, domain)
        } else {
            Vec::new()
        };
        if let [first, others @ ..] = each.as_slice()
            && !others.is_empty()
        {
            mentions[m].plural = false;
            more.extend(others.iter().map(|id| (m, Mention { what: What::Room(id.clone()), ..mentions[m].clone() })));
            mentions[m].what = What::Room(first.clone());
            continue;
        }
        let alone = |s: &&String| !musts(domain).any(|r| r.a == **s || r.b == **s);
        if let Some(id) = beside(mentions, m, &senses, domain).or_else(|| senses.iter().find(alone).cloned()) {
            mentions[m].what = What::Room(id);
        }
    }
    for (m, mention) in more.into_iter().rev() {
        mentions.insert(m + 1, mention);
    }
    for mention in mentions {
        let Some(id) = mention.room_type().map(str::to_owned) else { continue };
        // what the domain itself has by this name is meant
        let known = domain.room_type(&id).is_some();
        let others = vocabulary.meanings_at(tokens, mention.span).filter(|_| !known);
        let meant = std::iter::once(&id).chain(others).find_map(|id| program.means.get(id));
        // the six checkouts of a supermarket are in one sales floor
        if meant.is_some_and(|own| share_counters(domain, &id, own)) && mention.count.is_some_and(|n| n > 1) {
            (mention.count, mention.number, mention.plural) = (None, None, false);
        }
        mention.what = What::Room(meant.unwrap_or(&id).clone());
    }
}

/// Returns true for two types of rooms that are counted by the same counters: those of a checkout stand in the sales floor.
fn share_counters(domain: &Domain, a: &str, b: &str) -> bool {
    let counted = |id: &str| {
        let kind = domain.room_type(id).filter(|kind| offer::has_counters(domain, kind))?;
        kind.furnishing.first().map(|line| &line.item)
    };
    a != b && counted(a).is_some_and(|item| counted(b) == Some(item))
}

/// Takes the number of rooms of a building that is all for guests for that of the rooms they sleep in: "hotel with 20 rooms".
/// Those that the prompt names besides are some of them.
fn count_guests(
    tokens: &[Token],
    mentions: &mut [Mention],
    spoken: &[&Spoken],
    (domain, program): (&Domain, &Program),
) {
    let Some(id) = program.means.get(GENERIC_ROOM_TYPE) else { return };
    let night = |m: &Mention| {
        let kind = m.room_type().and_then(|id| domain.room_type(id));
        kind.is_some_and(|k| k.zone == Zone::Night && k.access != Access::Host)
    };
    let counts = |m: &Mention| m.what == What::Total && m.count.is_some_and(|n| n > 1) && !m.article && !m.vague;
    let Some(at) = mentions.iter().position(counts) else { return };
    // "20 rooms in total"
    let all = &mentions[at];
    let Some(n) = all.count.filter(|_| !(all.span.start..all.span.end).any(|i| tokens[i].text == "total")) else {
        return;
    };
    // "20 rooms, including 4 suites" is told of these
    let part = |m: &Mention| {
        let mut gap = all.span.end..m.from.max(all.span.end);
        gap.any(|i| is_tagged(spoken, tokens, i, Tag::PartOf))
    };
    let others = mentions.iter().filter(|m| night(m) && !part(m));
    let others = others.map(|m| m.count.unwrap_or(if m.plural { 2 } else { 1 }).max(0)).fold(0, i64::saturating_add);
    if n > others {
        (mentions[at].what, mentions[at].count) = (What::Room(id.clone()), Some(n - others));
    } else {
        (mentions[at].count, mentions[at].number) = (None, None);
    }
}

/// Returns the rules of a domain by which rooms belong beside others: of any country, as words mean the same in all.
fn musts(domain: &Domain) -> impl Iterator<Item = &Adjacency> {
    domain.adjacency.iter().filter(|r| r.relation == AdjacencyRelation::Must)
}

/// Returns the senses of a word whose rooms belong beside ones that the prompt names.
fn partnered(mentions: &[Mention], senses: &[String], domain: &Domain) -> Vec<String> {
    let named = |id: &str| mentions.iter().any(|m| m.room_type() == Some(id));
    senses.iter().filter(|s| musts(domain).any(|r| r.a == **s && named(&r.b))).cloned().collect()
}

/// Returns the sense of a word whose room belongs beside one that the prompt names: the nearest before it, else behind it.
fn beside(mentions: &[Mention], m: usize, senses: &[String], domain: &Domain) -> Option<String> {
    let other = |sense: &str, id: &str| musts(domain).any(|r| r.a == sense && r.b == id || r.b == sense && r.a == id);
    let sense_of = |at: usize| {
        let id = mentions[at].room_type()?;
        senses.iter().find(|sense| other(sense, id)).cloned()
    };
    (0..m).rev().chain(m + 1..mentions.len()).find_map(sense_of)
}
