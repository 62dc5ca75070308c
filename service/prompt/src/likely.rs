//! Rooms that no lexicon has: which type of room a part of their name tells of.
//!
//! A lexicon says what a room is called; here stand parts of names, in `likely.toml`: what is done in a room, or kept there. A name
//! that tells nothing stays what it is, a room of its own name.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use d3dgen_language::fold;
use serde::Deserialize;

/// Letters of a part from which on it may stand anywhere in a word: "Vereinswerkstatt".
const WITHIN_A_WORD: usize = 5;
/// Letters of a part up to which it is a whole word: "vet", "art".
const WHOLE_WORD: usize = 3;
/// The language whose words travel.
const TRAVELS: &str = "en";

/// What parts of names tell of, from `likely.toml`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct LikelyData {
    /// Types whose own words say so little that another part of the name decides.
    vague: Vec<String>,
    likely: Vec<Likely>,
}

/// Types of rooms, and the parts of names that tell of them.
#[derive(Debug, Deserialize)]
struct Likely {
    rooms: Vec<String>,
    /// Parts of names by language, folded.
    #[serde(flatten)]
    parts: BTreeMap<String, Vec<String>>,
}

fn data() -> &'static LikelyData {
    static DATA: LazyLock<LikelyData> = LazyLock::new(|| {
        let mut data: LikelyData = toml::from_str(include_str!("likely.toml")).expect("a test reads likely.toml");
        let parts = data.likely.iter_mut().flat_map(|l| l.parts.values_mut()).flatten();
        parts.for_each(|part| *part = fold(part));
        data
    });
    &DATA
}

/// Returns the type of room that a part of a name tells of: the first of its types that the building knows, else the first.
///
/// `id` is what a lexicon made of the name; it stays where its words say what the room is. `languages` are those of the text.
pub(crate) fn room_called(
    name: &str,
    id: Option<&str>,
    languages: &[&str],
    knows: impl Fn(&str) -> bool,
) -> Option<&'static str> {
    if id.is_some_and(|id| !data().vague.iter().any(|v| v == id)) {
        return None;
    }
    let name = fold(name);
    let words: Vec<&str> = name.split(|c: char| !c.is_alphanumeric()).filter(|w| !w.is_empty()).collect();
    // "Waschraum" as a whole is what the lexicon has it for
    if id.is_some() && words.len() < 2 {
        return None;
    }
    let spoken = |l: &&String| *l == TRAVELS || languages.contains(&l.as_str());
    let told = |likely: &&Likely| {
        let parts = likely.parts.iter().filter(|(l, _)| spoken(l)).flat_map(|(_, parts)| parts);
        parts.into_iter().any(|part| tells(&words, part))
    };
    let rooms = &data().likely.iter().find(told)?.rooms;
    let found = rooms.iter().find(|room| knows(room)).or(rooms.first()).map(String::as_str)?;
    (id != Some(found)).then_some(found)
}

/// Returns true where a name of these words has a part.
fn tells(words: &[&str], part: &str) -> bool {
    let letters = part.chars().count();
    if part.contains(' ') {
        let wanted: Vec<&str> = part.split(' ').collect();
        return words.windows(wanted.len()).any(|w| {
            let (last, others) = (w[w.len() - 1], &w[..w.len() - 1]);
            others == &wanted[..wanted.len() - 1] && last.starts_with(wanted[wanted.len() - 1])
        });
    }
    let spaced = part.chars().all(|c| c.is_ascii() || ('\u{400}'..'\u{530}').contains(&c));
    match letters {
        _ if !spaced => words.iter().any(|word| word.contains(part)),
        0..=WHOLE_WORD => words.contains(&part),
        n if n >= WITHIN_A_WORD => words.iter().any(|word| word.contains(part)),
        _ => words.iter().any(|word| word.starts_with(part)),
    }
}

#[cfg(test)]
mod tests {
    use d3dgen_plugins::Registry;

    use super::*;

    #[test]
    fn every_type_that_a_name_may_tell_of_is_one_of_a_domain() {
        let registry = Registry::builtin();
        let known = |id: &String| registry.iter().any(|p| p.domain().room_type(id).is_some());
        for id in data().likely.iter().flat_map(|l| &l.rooms).chain(&data().vague) {
            assert!(known(id), "`{id}` of likely.toml is no room type");
        }
    }

    #[test]
    fn a_part_of_a_name_tells_what_a_room_is() {
        let cases = [
            ("committal hall", "en", Some("ceremony_hall")),
            ("flower workroom", "en", Some("flower_workroom")),
            ("dog-wash room", "en", Some("grooming_room")),
            ("luthier's room", "en", Some("workshop")),
            ("Glasbläserei", "de", Some("workshop")),
            ("Vereinsraum", "de", Some("lounge")),
            ("salle de sérigraphie", "fr", Some("print_hall")),
            ("sala de despiece", "es", Some("butchery")),
            ("introligatornią", "pl", Some("bindery")),
            ("гончарная", "ru", Some("throwing_room")),
            ("花の準備室", "ja", Some("flower_workroom")),
            ("上釉室", "zh", Some("glazing_room")),
            ("flumbarium", "en", None),
            // a carat is no cat, a starter no art
            ("carat room", "en", None),
            ("starter room", "en", None),
        ];
        for (name, language, wanted) in cases {
            assert_eq!(room_called(name, None, &[language], |_| false), wanted, "{name}");
        }
        // what a lexicon knows stays; a hall says too little
        assert_eq!(room_called("wrestling kitchen", Some("kitchen"), &["en"], |_| false), None);
        assert_eq!(room_called("wrestling hall", Some("event_room"), &["en"], |_| false), Some("mat_hall"));
        assert_eq!(room_called("games corner", None, &["en"], |id| id == "game_room"), Some("game_room"));
    }
}
