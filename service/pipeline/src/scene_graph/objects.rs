//! Objects that a prompt names.

use d3dgen_model::domain::Domain;
use d3dgen_plugins::Registry;

use super::mentions::Mention;
use super::text::{Phrases, Span, Token};
use super::words::{Spoken, Tag};

/// Returns the objects that are named, each with the room type named before it; what is part of a room's name or of the
/// spans that are no things is none. Adds the words for them to `spans`.
pub(super) fn named(
    tokens: &[Token],
    mentions: &[Mention],
    (domain, registry): (&Domain, &Registry),
    (languages, spoken): (&[&str], &[&Spoken]),
    not_things: &[Span],
    spans: &mut Vec<Span>,
) -> Vec<(String, Option<String>)> {
    let words = |language: &str| {
        let mut phrases: Phrases<String> = Phrases::new(language);
        for object in &domain.objects {
            object.keywords.get(language).into_iter().flatten().for_each(|p| phrases.insert(p, object.id.clone()));
            if language == "en" {
                phrases.insert(&object.label, object.id.clone());
            }
        }
        phrases
    };
    let mut out: Vec<(String, Option<String>)> = Vec::new();
    for language in languages {
        let phrases = registry.digest(&format!("{language}: objects of {}", domain.id), || words(language));
        let mut i = 0;
        while i < tokens.len() {
            let inside = mentions.iter().any(|m| m.room_type().is_some() && m.span.contains(i));
            let other = |end: usize| not_things.iter().any(|s| s.start <= i && end <= s.end);
            match phrases.longest_at(tokens, i).filter(|found| !inside && !other(found.0)) {
                Some((end, id)) => {
                    let with = mentions.iter().rev().filter(|m| m.span.end <= i).find(|m| m.room_type().is_some());
                    // "a nurse's room, baby changing": an item of its own is in none of the rooms before it
                    let with = with.filter(|m| !is_item(tokens, m.span.end..i, spoken));
                    let near = with.and_then(|m| m.room_type()).map(str::to_owned);
                    spans.push(Span { start: i, end });
                    if !out.iter().any(|o| &o.0 == id) {
                        out.push((id.clone(), near));
                    }
                    i = end;
                }
                None => i += 1,
            }
        }
    }
    out
}

/// Returns true for a thing behind a comma, where nothing before says that it is in a room: "with", a colon, a bracket.
fn is_item(tokens: &[Token], gap: std::ops::Range<usize>, spoken: &[&Spoken]) -> bool {
    let opens = |i: usize| {
        let holds = [Tag::Starts, Tag::Inside, Tag::Each];
        let tagged = |tag: &Tag| spoken.iter().any(|s| s.tag_at(tokens, i, *tag).is_some());
        matches!(tokens[i].mark(), Some(':' | '(')) || holds.iter().any(tagged)
    };
    gap.clone().any(|i| tokens[i].mark() == Some(',')) && !gap.into_iter().any(opens)
}
