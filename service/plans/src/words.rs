//! What the words of layers, classes, ids and properties say a drawn thing is (`data/words.toml`).

use std::collections::BTreeMap;
use std::sync::LazyLock;

/// What a drawn thing is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    Door,
    Passage,
    Window,
    Wall,
    Room,
    Outline,
    Skip,
}

const ROLES: [(&str, Role); 7] = [
    ("skip", Role::Skip),
    ("window", Role::Window),
    ("door", Role::Door),
    ("open", Role::Passage),
    ("wall", Role::Wall),
    ("outline", Role::Outline),
    ("room", Role::Room),
];

static WORDS: LazyLock<BTreeMap<String, Vec<String>>> = LazyLock::new(|| {
    toml::from_str(include_str!("../data/words.toml")).expect("data/words.toml is shipped and tested")
});

/// Returns what the words of a layer, class or id say, or `None`.
pub(crate) fn role(text: &str) -> Option<Role> {
    let folded = fold(text);
    let tokens: Vec<&str> = folded.split(|c: char| !c.is_alphanumeric()).filter(|t| !t.is_empty()).collect();
    let says = |word: &str, token: &&str| {
        token.strip_prefix(word).is_some_and(|rest| rest.bytes().all(|b| b.is_ascii_digit()))
    };
    let named = |name: &str| WORDS.get(name).is_some_and(|list| list.iter().any(|w| tokens.iter().any(|t| says(w, t))));
    ROLES.iter().find(|(name, _)| named(name)).map(|(_, role)| *role)
}

/// Returns true for the name of a point that means something to robots only: it ends in such a word (`main_door`), or has no
/// other words but figures (`patrol_D2`, `dock_1`; a `loading_dock` is a room).
pub(crate) fn is_waypoint(text: &str) -> bool {
    let folded = fold(text);
    let is = |list: &str, t: &str| {
        let known =
            |w: &String| t.strip_prefix(w.as_str()).is_some_and(|rest| rest.bytes().all(|b| b.is_ascii_digit()));
        WORDS.get(list).is_some_and(|words| words.iter().any(known))
    };
    let tokens = folded.split(|c: char| !c.is_alphanumeric()).filter(|t| !t.is_empty());
    // figures and single letters only number things
    let names: Vec<&str> = tokens
        .filter(|t| is("waypoint", t) || is("waypoint_alone", t) || t.chars().filter(|c| c.is_alphabetic()).count() > 1)
        .collect();
    let all = !names.is_empty() && names.iter().all(|t| is("waypoint", t) || is("waypoint_alone", t));
    all || names.last().is_some_and(|t| is("waypoint", t))
}

/// Returns lower case without the accents of the languages in `words.toml`.
fn fold(text: &str) -> String {
    text.chars()
        .flat_map(char::to_lowercase)
        .map(|c| match c {
            'ä' | 'á' | 'à' | 'â' => 'a',
            'é' | 'è' | 'ê' => 'e',
            'í' | 'î' => 'i',
            'ö' | 'ó' | 'ô' => 'o',
            'ü' | 'ú' | 'û' => 'u',
            'ñ' => 'n',
            'ç' => 'c',
            other => other,
        })
        .collect()
}

/// Returns true for words that name a room rather than give its size or number: two letters in a row, and no figure first.
pub(crate) fn is_name(text: &str) -> bool {
    let text = text.trim();
    let wide = text.chars().any(|c| c.is_alphabetic() && !c.is_ascii() && !c.is_lowercase() && !c.is_uppercase());
    let letters = text.chars().zip(text.chars().skip(1)).any(|(a, b)| a.is_alphabetic() && b.is_alphabetic());
    (wide || letters) && !text.starts_with(|c: char| c.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_classes_and_ids_say_what_is_drawn() {
        for (text, expected) in [
            ("A-DOOR", Some(Role::Door)),
            ("doors", Some(Role::Door)),
            ("Türen", Some(Role::Door)),
            ("door_12", Some(Role::Door)),
            ("window3", Some(Role::Window)),
            ("A-WALL-INTR", Some(Role::Wall)),
            ("0", None),
            ("wardrobe", None),
            ("indoor", None),
            ("Furniture", Some(Role::Skip)),
        ] {
            assert_eq!(role(text), expected, "{text}");
        }
        assert!(WORDS.values().flatten().all(|w| fold(w) == *w), "words are written folded");
        for name in ["patrol_D2", "dock_1", "tinyRobot1_charger", "main_door", "lift1", "pickup", "charger"] {
            assert!(is_waypoint(name), "{name}");
        }
        for name in ["lift_lobby", "kitchen", "hardware_2", "coe", "dock office", "loading_dock", "supplies"] {
            assert!(!is_waypoint(name), "{name}");
        }
        assert!(is_name("WC") && is_name("卧室") && !is_name("12.5 m2") && !is_name("B1"));
    }
}
