//! Rooms no domain knows: "pooja room", "Bastelraum", "salle de projection", "茶室".

use crate::tokens::text::{Kind, Span, Token};
use crate::tokens::words::{Spoken, Tag, tag_end, tag_ends_at};
use d3dgen_model::domain::GENERIC_ROOM_TYPE;

/// Returns the end and the room type of an unknown room at a token; the generic type where its name has no Latin letters.
pub(crate) fn room_at(
    tokens: &[Token],
    i: usize,
    spoken: &[&Spoken],
    language: &str,
    list_from: usize,
) -> Option<(usize, String)> {
    match (tokens[i].kind, language) {
        (Kind::Word, "de") => german(tokens, i, spoken, list_from).or_else(|| english(tokens, i, spoken, list_from)),
        (Kind::Word, "fr" | "es") => romance(tokens, i, spoken).or_else(|| english(tokens, i, spoken, list_from)),
        (Kind::Word, _) => english(tokens, i, spoken, list_from),
        (Kind::Han | Kind::Hangul, _) => eastern(tokens, i, spoken),
        _ => None,
    }
}

/// Returns true for a room type that is the words of the prompt for it, and no room of another domain.
pub(crate) fn is_name_of(tokens: &[Token], span: Span, id: &str) -> bool {
    let words = &tokens[span.start..span.end];
    let german = ["raum", "zimmer"].iter().any(|end| id.ends_with(end));
    let own = slug(words);
    (span.end > span.start + 1 || german) && (id == own || id == own.trim_end_matches('s'))
}

fn is_name(tokens: &[Token], i: usize, spoken: &[&Spoken]) -> bool {
    let token = &tokens[i];
    let tags = [
        Tag::NotNames,
        Tag::Stops,
        Tag::Starts,
        Tag::Joins,
        Tag::No,
        Tag::Near,
        Tag::Door,
        Tag::Open,
        Tag::Articles,
        Tag::Definite,
        Tag::Each,
        Tag::Total,
        Tag::Robot,
        Tag::Between,
        Tag::Apart,
        Tag::Accessible,
        Tag::Charge,
        Tag::CleanVerbs,
        Tag::DeliverVerbs,
        Tag::Inject,
        Tag::People,
        Tag::Visitors,
    ];
    token.kind == Kind::Word
        && token.text.len() >= 3
        && token.text.chars().all(|c| c.is_ascii_lowercase())
        && !spoken.iter().any(|s| {
            s.numbers.contains_key(&token.text)
                || s.tags.word(&token.text).is_some_and(|found| found.iter().any(|t| tags.contains(t)))
        })
}

fn slug(tokens: &[Token]) -> String {
    let slug: Vec<&str> = tokens.iter().map(|t| t.text.as_str()).collect();
    slug.join("_")
}

/// "X room", "X Y room", and in a list "X area", "X store"
fn english(tokens: &[Token], i: usize, spoken: &[&Spoken], list_from: usize) -> Option<(usize, String)> {
    let tagged = |k: usize, tag| tag_ends_at(spoken, tokens, k, tag, k + 1);
    for len in [2, 1] {
        let at = i + len;
        if at >= tokens.len() || !(i..at).all(|k| is_name(tokens, k, spoken)) {
            continue;
        }
        let room = tokens[at].text == "room" || tokens[at].text == "rooms";
        let space = i >= list_from && tagged(at, Tag::SpaceWords);
        // "model workshop" is a workshop
        let head = (i + 1..=at)
            .any(|k| spoken.iter().any(|s| s.heads.longest_at(tokens, k).is_some_and(|(end, ())| end == at + 1)));
        if !(room || space) || head {
            continue;
        }
        let mut words: Vec<Token> = tokens[i..=at].to_vec();
        if let Some(last) = words.last_mut() {
            last.text = last.text.trim_end_matches('s').to_owned();
        }
        return Some((at + 1, slug(&words)));
    }
    None
}

/// "Bastelraum", "Musikzimmer"
fn german(tokens: &[Token], i: usize, spoken: &[&Spoken], list_from: usize) -> Option<(usize, String)> {
    let text = &tokens[i].text;
    let singular = ["raume", "raumen"].iter().find_map(|p| text.strip_suffix(p)).map(|h| format!("{h}raum"));
    let text = singular.as_ref().unwrap_or(text);
    let text = text.strip_suffix("zimmern").map_or_else(|| text.clone(), |h| format!("{h}zimmer"));
    let ends = ["raum", "zimmer"].iter().any(|w| text.len() > w.len() + 2 && text.ends_with(w));
    (ends && i >= list_from && is_name(tokens, i, spoken) && text.is_ascii()).then_some((i + 1, text))
}

/// "salle de projection", "cuarto de juegos"
fn romance(tokens: &[Token], i: usize, spoken: &[&Spoken]) -> Option<(usize, String)> {
    let end = tag_end(spoken, tokens, i, Tag::RoomWords)?;
    let name = tokens.get(end)?;
    let known = name.kind == Kind::Word && name.text.len() >= 3 && name.text.is_ascii();
    (known && is_name(tokens, end, spoken)).then(|| (end + 1, slug(&tokens[i..=end])))
}

/// "茶室", "다도실": named on the plan in the prompt's own letters, planned as the generic room.
fn eastern(tokens: &[Token], i: usize, spoken: &[&Spoken]) -> Option<(usize, String)> {
    let kind = tokens[i].kind;
    for len in 1..=3 {
        let at = i + len;
        let span = Span { start: i, end: at };
        let plain = (span.start..span.end).all(|k| {
            tokens.get(k).is_some_and(|t| {
                t.kind == kind
                    && (k == i || !t.spaced)
                    && !spoken.iter().any(|s| {
                        s.tags.word(&t.text).is_some_and(|tags| {
                            tags.iter()
                                .any(|t| matches!(t, Tag::Stops | Tag::Joins | Tag::Counters | Tag::No | Tag::Starts))
                        })
                    })
            })
        });
        let room =
            tokens.get(at).is_some_and(|t| t.kind == kind && !t.spaced && matches!(t.text.as_str(), "室" | "실"));
        let word_ends = kind == Kind::Han || tokens.get(at + 1).is_none_or(|t| t.spaced || t.is_mark());
        let word_begins = kind == Kind::Han && (i == 0 || tokens[i - 1].is_mark() || after_counter(tokens, i, spoken))
            || kind == Kind::Hangul && tokens[i].spaced;
        if plain && room && word_ends && word_begins {
            return Some((at + 1, GENERIC_ROOM_TYPE.to_owned()));
        }
    }
    None
}

fn after_counter(tokens: &[Token], i: usize, spoken: &[&Spoken]) -> bool {
    spoken.iter().any(|s| {
        s.tag_at(tokens, i - 1, Tag::Counters).is_some()
            || s.tag_at(tokens, i - 1, Tag::Joins).is_some()
            || s.tag_at(tokens, i - 1, Tag::Starts).is_some()
    })
}
