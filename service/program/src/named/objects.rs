//! Objects that a prompt names.

use d3dgen_model::domain::{Access, Domain, Zone};
use d3dgen_plugins::Registry;

use crate::named::mention::{Mention, What};
use crate::tokens::negation::is_ruled_out;
use crate::tokens::text::{Phrases, Span, Token};
use crate::tokens::words::{Spoken, Tag, is_tagged, tag_end};

/// Words from a thing to the word that gives it to every room, at most: "with a desk and chair each".
const MOST_TO_EACH: usize = 4;

/// Words for a thing, at most: "large dining table for eight".
const MOST_WORDS: usize = 5;

/// Words between a thing and the word that says where it is, at most: "armario muy grande en".
const MOST_TO_PLACE: usize = 3;

/// An object that the prompt names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Thing {
    pub object: String,
    /// Type of the room it is named with.
    pub room_type: Option<String>,
    /// True where every room of that type is to have one: "six bedrooms with desks".
    pub each: bool,
}

impl Thing {
    /// Returns a thing of one room.
    pub(crate) fn of_one(object: &str, room_type: Option<String>) -> Self {
        Self { object: object.to_owned(), room_type, each: false }
    }
}

/// Returns the objects that are named, each with the room type named before it; what is part of a room's name or of the
/// spans that are no things is none. Adds the words for them to `spans`.
pub(crate) fn named(
    tokens: &[Token],
    mentions: &[Mention],
    (domain, registry): (&Domain, &Registry),
    (languages, spoken): (&[&str], &[&Spoken]),
    not_things: &[Span],
    spans: &mut Vec<Span>,
) -> Vec<Thing> {
    let mut out: Vec<Thing> = Vec::new();
    // what stands in the entrance of a home stands in its entrance hall
    let hall = domain.circulation.entrance_room_types.first().filter(|id| domain.room_type(id).is_some());
    let room = |m: &'_ Mention| match &m.what {
        What::Entrance => hall.cloned(),
        _ => m.room_type().map(str::to_owned),
    };
    for language in languages {
        let phrases = vocabulary(domain, registry, language);
        let mut i = 0;
        while i < tokens.len() {
            let inside = mentions.iter().any(|m| m.room_type().is_some() && m.span.contains(i));
            let other = |end: usize| not_things.iter().any(|s| s.start <= i && end <= s.end);
            match phrases.longest_at(tokens, i).filter(|found| !inside && !other(found.0)) {
                Some((end, id)) => {
                    let with = mentions.iter().rev().filter(|m| m.span.end <= i).find(|m| room(m).is_some());
                    // "a nurse's room, baby changing": an item of its own is in none of the rooms before it
                    let with = with.filter(|m| !is_item(tokens, m.span.end..i, spoken));
                    let place = place_of(tokens, mentions, end, spoken).and_then(room);
                    let near = place.or_else(|| with.and_then(room));
                    spans.push(Span { start: i, end });
                    let each = with
                        .is_some_and(|m| m.room_type().is_some() && is_each(tokens, m, Span { start: i, end }, spoken));
                    match out.iter_mut().find(|o| &o.object == id) {
                        Some(known) => known.each |= each && known.room_type == near,
                        None => out.push(Thing { object: id.clone(), room_type: near, each }),
                    }
                    i = end;
                }
                None => i += 1,
            }
        }
    }
    out
}

/// Returns the words for objects that the prompt rules out: "no bath tub". A room whose word is part of one is none.
pub(crate) fn ruled_out(
    tokens: &[Token],
    mentions: &mut Vec<Mention>,
    (domain, registry): (&Domain, &Registry),
    (language, languages, spoken): (&str, &[&str], &[&Spoken]),
) -> Vec<Span> {
    let mut out: Vec<Span> = Vec::new();
    for phrases in languages.iter().map(|language| vocabulary(domain, registry, language)) {
        for start in 0..tokens.len() {
            let Some((end, _)) = phrases.longest_at(tokens, start) else { continue };
            let span = Span { start, end };
            let part = |m: &Mention| {
                m.room_type().is_some() && m.span != span && span.contains(m.span.start) && m.span.end <= end
            };
            let room = |m: &Mention| m.room_type().is_some() && m.span.overlaps(span) && !part(m);
            if is_ruled_out(tokens, spoken, language, span) && !mentions.iter().any(room) {
                mentions.retain(|m| !part(m));
                out.push(span);
            }
        }
    }
    out
}

/// Returns the place that a thing is said to be in: "a wardrobe in the entrance".
fn place_of<'m>(tokens: &[Token], mentions: &'m [Mention], end: usize, spoken: &[&Spoken]) -> Option<&'m Mention> {
    let tagged = |i: usize, tag| tag_end(spoken, tokens, i, tag);
    // "a wardrobe, in the hall", but "armario grande en la entrada"
    let from = (end..(end + MOST_TO_PLACE).min(tokens.len())).take_while(|&i| !tokens[i].is_mark());
    let start = from.into_iter().find_map(|i| tagged(i, Tag::Inside))?;
    let place = mentions.iter().find(|m| m.span.start >= start)?;
    let little = |i: usize| [Tag::Definite, Tag::Articles].iter().any(|&t| tagged(i, t).is_some());
    let plain = place.count.is_none() || place.article;
    (plain && (start..place.from.min(place.span.start)).all(little)).then_some(place)
}

/// Returns true where the words for an object end at a token.
pub(crate) fn ends_at(
    tokens: &[Token],
    end: usize,
    (domain, registry): (&Domain, &Registry),
    languages: &[&str],
) -> bool {
    let from = end.saturating_sub(MOST_WORDS);
    languages.iter().any(|language| {
        let phrases = vocabulary(domain, registry, language);
        (from..end).any(|i| phrases.longest_at(tokens, i).is_some_and(|f| f.0 == end))
    })
}

/// Returns the words for objects of a domain in one language.
fn vocabulary(domain: &Domain, registry: &Registry, language: &str) -> std::sync::Arc<Phrases<String>> {
    let words = || {
        let mut phrases: Phrases<String> = Phrases::new(language);
        for object in &domain.objects {
            object.keywords.get(language).into_iter().flatten().for_each(|p| phrases.insert(p, object.id.clone()));
            if language == "en" {
                phrases.insert(&object.label, object.id.clone());
            }
        }
        phrases
    };
    registry.digest(&format!("{language}: objects of {}", domain.id), words)
}

/// Takes words for a room that name a thing behind a room to sleep in or an entrance for that thing: the "bureau" of "chambres avec bureau".
/// Returns these words.
pub(crate) fn of_bedrooms(
    tokens: &[Token],
    mentions: &mut Vec<Mention>,
    (domain, registry): (&Domain, &Registry),
    (languages, spoken): (&[&str], &[&Spoken]),
) -> Vec<Span> {
    let sleeps = |m: &Mention| {
        let kind = m.room_type().and_then(|id| domain.room_type(id));
        // "une entrée avec placard" has no storage room
        let hall = m.what == What::Entrance || kind.is_some_and(|k| k.zone == Zone::Circulation);
        hall || kind.is_some_and(|k| k.zone == Zone::Night && k.access != Access::Host)
    };
    let tagged = |i: usize, tag| is_tagged(spoken, tokens, i, tag);
    let is_thing = |span: Span| {
        let whole =
            |l: &&str| vocabulary(domain, registry, l).longest_at(tokens, span.start).is_some_and(|f| f.0 == span.end);
        languages.iter().any(whole)
    };
    let mut things = Vec::new();
    for k in 1..mentions.len() {
        let (host, m) = (&mentions[k - 1], &mentions[k]);
        let gap = host.span.end..m.from.min(m.span.start);
        let of_host = gap.clone().any(|i| tagged(i, Tag::Starts)) && !gap.clone().any(|i| tokens[i].is_mark());
        // "a big wardrobe in the entrance": what is a room elsewhere is a thing at home
        let strange = m.room_type().is_some_and(|id| domain.room_type(id).is_none());
        if m.room_type().is_some() && (sleeps(host) && of_host || strange) && is_thing(m.span) {
            things.push(k);
        }
    }
    let spans = things.iter().map(|&k| mentions[k].span).collect();
    things.into_iter().rev().for_each(|k| drop(mentions.remove(k)));
    spans
}

/// Returns true for a thing that every one of several rooms is to have: "six bedrooms with desks", "with a desk each".
fn is_each(tokens: &[Token], room: &Mention, thing: Span, spoken: &[&Spoken]) -> bool {
    let tagged = |i: usize, tag| is_tagged(spoken, tokens, i, tag);
    let several = room.plural || room.count.is_some_and(|n| n > 1 && !room.article);
    let gap = room.span.end..thing.start;
    let apart = gap.clone().any(|i| tokens[i].ends_sentence());
    let told = || {
        gap.clone().any(|i| tagged(i, Tag::Each)) || {
            let behind = thing.end..tokens.len().min(thing.end + MOST_TO_EACH);
            behind.take_while(|&i| !tokens[i].is_mark()).any(|i| tagged(i, Tag::Each))
        }
    };
    // "one with a desk", "three bedrooms, a dining table"
    let of_one = gap.clone().any(|i| tagged(i, Tag::OneOfThem));
    let with = || gap.clone().any(|i| tagged(i, Tag::Starts)) && !gap.clone().any(|i| tokens[i].is_mark());
    several && !apart && !of_one && (with() || told())
}

/// Returns true for a thing behind a comma, where nothing before says that it is in a room: "with", a colon, a bracket.
fn is_item(tokens: &[Token], gap: std::ops::Range<usize>, spoken: &[&Spoken]) -> bool {
    let opens = |i: usize| {
        let holds = [Tag::Starts, Tag::Inside, Tag::Each];
        let tagged = |tag: &Tag| is_tagged(spoken, tokens, i, *tag);
        matches!(tokens[i].mark(), Some(':' | '(')) || holds.iter().any(tagged)
    };
    gap.clone().any(|i| tokens[i].mark() == Some(',')) && !gap.into_iter().any(opens)
}
