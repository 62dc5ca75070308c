//! Rooms of places to work at that are named by whose they are or what is done there: "Notarbüros", "Dreierbüro", "cuarto de
//! plóter", "salle de traceur". One part of the name says that it is a room, the other what for; no such name is known as a
//! whole, and none of them is a room of a home.

use d3dgen_model::domain::{Domain, RoomType};
use d3dgen_model::offer;
use d3dgen_model::offer::works_in;

use crate::tokens::numbers;
use crate::tokens::text::{Kind, Phrases, Span, Token, fold};
use crate::tokens::words::{Spoken, Tag};

/// Letters of the part of a compound that says whose the room is, at least.
const LEAST_OF_OWNER: usize = 3;
/// Desks of a room that is called by their number, at most.
const MOST_DESKS: f64 = 20.0;

/// An office that one word of German names.
pub(crate) struct Office<'t> {
    /// The word for it, as the domain may know it: "buro".
    pub head: &'t str,
    /// Desks in it, where the word says so: "Dreierbüro".
    pub desks: Option<u32>,
    pub plural: bool,
}

/// Reads a German compound that ends in a word for an office: "Teamleiterbüro", "Zweierbüros".
pub(crate) fn office<'t>(token: &'t Token, spoken: &[&Spoken]) -> Option<Office<'t>> {
    let german = spoken.iter().find(|s| s.language() == "de")?;
    let text = token.text.as_str();
    let mut heads: Vec<String> =
        german.words.phrases.get(&Tag::OfficeWords).into_iter().flatten().map(|w| fold(w)).collect();
    heads.sort_by_key(|w| std::cmp::Reverse(w.len()));
    let at = heads.iter().find_map(|h| text.strip_suffix(h.as_str()).map(str::len))?;
    if token.kind != Kind::Word || at < LEAST_OF_OWNER && !text[..at].chars().all(|c| c.is_ascii_digit()) {
        return None;
    }
    let (owner, head) = text.split_at(at);
    if owner.is_empty() {
        return None;
    }
    Some(Office { head, desks: number(owner, german), plural: head.ends_with('s') })
}

/// Returns how many have their desk in a "Vierer-", "Vier-" or "4er-" office.
fn number(owner: &str, german: &Spoken) -> Option<u32> {
    let stems = [owner.strip_suffix("er"), owner.strip_suffix("mann"), owner.strip_suffix("personen"), Some(owner)];
    let read = |stem: &str| stem.parse::<f64>().ok().or_else(|| numbers::in_one_word(stem, german));
    let n = stems.into_iter().flatten().filter(|s| !s.is_empty()).find_map(read)?;
    (n.fract() == 0.0 && (1.0..=MOST_DESKS).contains(&n)).then_some(n as u32)
}

/// Space of the knowledge base that offices of all kinds are, as a part of its name.
const OFFICE_SPACE: &str = "office";

/// Returns the domain's office with so many desks, the smallest that holds them: no workshop and no laboratory.
pub(crate) fn with_desks(domain: &Domain, desks: u32) -> Option<&RoomType> {
    let fits = |k: &&RoomType| offer::desks(domain, k).is_some_and(|[low, high]| (low..=high).contains(&desks));
    let most = |k: &&RoomType| offer::desks(domain, k).map_or(0, |d| d[1]);
    let office = |k: &&RoomType| works_in(domain, k) || k.spaces.iter().any(|s| s.contains(OFFICE_SPACE));
    domain.room_types.iter().filter(office).filter(fits).min_by_key(most)
}

/// Returns true where a word is only the noun of "cuarto de …", "sala de …": by itself it names no room of another kind of
/// building.
pub(super) fn is_bare_noun(tokens: &[Token], span: Span, spoken: &[&Spoken]) -> bool {
    if span.end != span.start + 1 {
        return false;
    }
    let word = tokens[span.start].text.as_str();
    spoken.iter().filter(|s| matches!(s.language(), "es" | "fr")).any(|s| {
        let heads = s.words.phrases.get(&Tag::RoomWords).into_iter().flatten();
        heads.filter_map(|p| p.split_whitespace().next()).any(|h| {
            let head = fold(h);
            word == head || word.strip_suffix('s') == Some(head.as_str())
        })
    })
}

/// Returns the rooms that serve what an unknown room is for, by a word of its name: "plotter", "Vertrags-".
pub(crate) fn matters<'s>(tokens: &[Token], span: Span, spoken: &'s [&Spoken]) -> Vec<&'s String> {
    let ends = ["raumen", "raume", "raum", "zimmern", "zimmer"];
    let mut out = Vec::new();
    for (k, token) in tokens.iter().enumerate().take(span.end).skip(span.start) {
        for s in spoken {
            let whole = s.matters.longest_at(tokens, k).filter(|f| f.0 <= span.end).map(|f| f.1);
            // "Vertragsraum": the first part, with the letter that joins it
            let part = ends.iter().find_map(|e| token.text.strip_suffix(e)).filter(|p| p.len() >= LEAST_OF_OWNER);
            let of_part = |p: &str| joined(p).into_iter().find_map(|p| s.matters.word(p));
            let found = whole.or_else(|| part.filter(|_| s.language() == "de").and_then(of_part));
            out.extend(found.into_iter().flatten());
        }
    }
    out
}

/// Returns the first part of a German compound as it is and without what joins it to the second.
fn joined(part: &str) -> Vec<&str> {
    let joints = ["s", "en", "n", "es", "er"];
    std::iter::once(part).chain(joints.iter().filter_map(|j| part.strip_suffix(j))).collect()
}

/// Returns the part of an unknown room's name that is a word for a room itself: "local archives", "cuarto de archivo".
pub(super) fn known_part<T: Clone>(tokens: &[Token], span: Span, rooms: &[Phrases<T>]) -> Option<T> {
    (span.start + 1..span.end)
        .find_map(|k| rooms.iter().find_map(|p| p.longest_at(tokens, k)).filter(|f| f.0 == span.end))
        .map(|f| f.1.clone())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tokens::text::tokens;
    use crate::tokens::words::words;

    #[test]
    fn german_offices_are_read_by_their_last_part_and_their_number() {
        let german = [&words().languages["de"]];
        let cases = [
            ("Zweierbüros", Some((Some(2), true))),
            ("Dreierbüro", Some((Some(3), false))),
            ("Vierbüro", Some((Some(4), false))),
            ("Teamleiterbüro", Some((None, false))),
            ("Notarbüros", Some((None, true))),
            ("Büro", None),
            ("Werkstatt", None),
        ];
        for (text, wanted) in cases {
            let all = tokens(text);
            let read = office(&all[0], &german).map(|o| (o.desks, o.plural));
            assert_eq!(read, wanted, "{text}");
        }
    }

    #[test]
    fn what_a_room_is_for_says_which_room_it_is() {
        let cases = [
            ("es", "cuarto de plóter", "copy_room"),
            ("fr", "salle de traceur", "copy_room"),
            ("de", "Vertragsraum", "meeting_room"),
            ("en", "plotter room", "copy_room"),
        ];
        for (language, text, wanted) in cases {
            let (all, spoken) = (tokens(text), [&words().languages[language]]);
            let span = Span { start: 0, end: all.len() };
            assert!(matters(&all, span, &spoken).iter().any(|id| *id == wanted), "{text}");
        }
        let spanish = [&words().languages["es"]];
        assert!(is_bare_noun(&tokens("cuarto"), Span { start: 0, end: 1 }, &spanish));
        assert!(!is_bare_noun(&tokens("taller"), Span { start: 0, end: 1 }, &spanish));
    }
}
