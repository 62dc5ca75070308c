//! Objects that a prompt names.

use d3dgen_model::domain::Domain;
use d3dgen_plugins::Registry;

use super::mentions::Mention;
use super::text::{Phrases, Span, Token};

/// Returns the objects that are named, each with the room type named before it; what is part of a room's name or of the
/// spans that are no things is none. Adds the words for them to `spans`.
pub(super) fn named(
    tokens: &[Token],
    mentions: &[Mention],
    domain: &Domain,
    registry: &Registry,
    languages: &[&str],
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
                    let with = mentions.iter().rev().filter(|m| m.span.end <= i).find_map(|m| m.room_type());
                    let near = with.map(str::to_owned);
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
