//! What the words of layers, classes, ids and properties say a drawn thing is (`data/words.toml`).

use std::collections::BTreeMap;
use std::sync::LazyLock;

use serde::Deserialize;
use unicode_normalization::UnicodeNormalization;
use unicode_normalization::char::is_combining_mark;

use crate::options::{LayerUse, Options};

/// What a drawn thing is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    Door,
    Passage,
    Window,
    Wall,
    Column,
    Room,
    Outline,
    /// A number or name of something else: its words count, what is drawn does not.
    Tag,
    Skip,
}

/// Most letters of a code in a room's number.
const MOST_CODE_LETTERS: usize = 2;

const ROLES: [(&str, Role); 9] = [
    ("skip", Role::Skip),
    ("tag", Role::Tag),
    ("window", Role::Window),
    ("door", Role::Door),
    ("open", Role::Passage),
    ("column", Role::Column),
    ("wall", Role::Wall),
    ("outline", Role::Outline),
    ("room", Role::Room),
];

/// Words and codes by what they say.
type Lists = BTreeMap<String, Vec<String>>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Data {
    words: Lists,
    codes: Lists,
    endings: Lists,
    storeys: Lists,
}

static DATA: LazyLock<Data> = LazyLock::new(|| {
    toml::from_str(include_str!("../data/words.toml")).expect("data/words.toml is shipped and tested")
});

/// Returns what a layer, class, group or kind is: as the user says, or by its words.
pub(crate) fn role_of(name: &str, options: &Options) -> Option<Role> {
    said_of(name, options).or_else(|| role(name))
}

/// Returns what the user says that a layer is.
pub(crate) fn said_of(name: &str, options: &Options) -> Option<Role> {
    let said = options.layers.iter().find(|(layer, _)| layer.trim().eq_ignore_ascii_case(name.trim()));
    said.map(|(_, layer_use)| match layer_use {
        LayerUse::Wall => Role::Wall,
        LayerUse::Room => Role::Room,
        LayerUse::Door => Role::Door,
        LayerUse::Window => Role::Window,
        LayerUse::Column => Role::Column,
        LayerUse::Furniture => Role::Skip,
        LayerUse::Ignore => Role::Tag,
    })
}

/// Returns what the words of a layer, class or id say, or `None`.
pub(crate) fn role(text: &str) -> Option<Role> {
    let folded = fold(&parted(text));
    let tokens: Vec<&str> = folded.split(|c: char| !c.is_alphanumeric()).filter(|t| !t.is_empty()).collect();
    let says = |word: &str, token: &&str| {
        token
            .strip_prefix(word)
            .is_some_and(|rest| rest.strip_prefix('s').unwrap_or(rest).bytes().all(|b| b.is_ascii_digit()))
    };
    let ends = |ending: &str, token: &&str| token.ends_with(ending);
    let any = |lists: &Lists, name: &str, test: &dyn Fn(&str, &&str) -> bool| {
        lists.get(name).is_some_and(|list| list.iter().any(|w| tokens.iter().any(|t| test(w, t))))
    };
    let coded = is_standard_layer(&folded);
    let named = |name: &str| {
        any(&DATA.words, name, &says) || any(&DATA.endings, name, &ends) || coded && any(&DATA.codes, name, &says)
    };
    ROLES.iter().find(|(name, _)| named(name)).map(|(_, role)| *role)
}

/// Returns a name with its words parted where a small letter meets a capital: `InnerWalls`.
fn parted(name: &str) -> String {
    let mut out = String::with_capacity(name.len() + 4);
    let mut before = ' ';
    for c in name.chars() {
        if before.is_lowercase() && c.is_uppercase() {
            out.push(' ');
        }
        out.push(c);
        before = c;
    }
    out
}

/// Returns true for a layer name in the form of the National CAD Standard: a discipline, and a group of four letters.
fn is_standard_layer(folded: &str) -> bool {
    let mut groups = folded.split('-');
    let discipline = groups.next().is_some_and(|d| (1..=2).contains(&d.len()));
    discipline && groups.next().is_some_and(|g| g.len() == 4 && g.bytes().all(|b| b.is_ascii_alphabetic()))
}

/// Returns true for the name of a point that means something to robots only: it ends in such a word (`main_door`), or has no
/// other words but figures (`patrol_D2`, `dock_1`; a `loading_dock` is a room).
pub(crate) fn is_waypoint(text: &str) -> bool {
    let folded = fold(text);
    let is = |list: &str, t: &str| {
        let known =
            |w: &String| t.strip_prefix(w.as_str()).is_some_and(|rest| rest.bytes().all(|b| b.is_ascii_digit()));
        DATA.words.get(list).is_some_and(|words| words.iter().any(known))
    };
    let tokens = folded.split(|c: char| !c.is_alphanumeric()).filter(|t| !t.is_empty());
    // figures and single letters only number things
    let names: Vec<&str> = tokens
        .filter(|t| is("waypoint", t) || is("waypoint_alone", t) || t.chars().filter(|c| c.is_alphabetic()).count() > 1)
        .collect();
    let all = !names.is_empty() && names.iter().all(|t| is("waypoint", t) || is("waypoint_alone", t));
    all || names.last().is_some_and(|t| is("waypoint", t))
}

/// Returns what the room around the car of a lift is, in a word that domains know for it.
pub(crate) fn car() -> &'static str {
    DATA.words["car"].first().expect("data/words.toml has a word for it")
}

/// What a word in the name of a storey says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum StoreyWord {
    Below,
    Ground,
    Above,
    Top,
}

/// Returns what a word in the name of a storey says, as [`parts`] returns it.
pub(crate) fn storey_word(word: &str) -> Option<StoreyWord> {
    let lists = [
        ("below", StoreyWord::Below),
        ("ground", StoreyWord::Ground),
        ("above", StoreyWord::Above),
        ("top", StoreyWord::Top),
    ];
    let says = |name: &str| DATA.storeys.get(name).is_some_and(|list| list.iter().any(|w| w == word));
    lists.into_iter().find(|(name, _)| says(name)).map(|(_, said)| said)
}

/// Returns the words and figures of a name, folded and parted from one another: `1.OG` is `1`, `og`.
pub(crate) fn parts(name: &str) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    let mut before = None;
    for c in fold(name).chars() {
        let kind = c.is_alphanumeric().then(|| c.is_ascii_digit());
        match (kind, out.last_mut()) {
            (Some(_), Some(last)) if kind == before => last.push(c),
            (Some(_), _) => out.push(c.to_string()),
            (None, _) => {}
        }
        before = kind;
    }
    out
}

/// Returns lower case without accents.
fn fold(text: &str) -> String {
    // the marks of Japanese make other letters
    let is_accent = |c: &char| is_combining_mark(*c) && !matches!(c, '\u{3099}' | '\u{309a}');
    let plain = text.chars().flat_map(char::to_lowercase).nfd().filter(|c| !is_accent(c));
    let plain = plain.nfc().map(|c| match c {
        'ø' => 'o',
        'ł' => 'l',
        'ı' => 'i',
        other => other,
    });
    plain.collect::<String>().replace('ß', "ss").replace('æ', "ae")
}

/// Returns true for words that name a room rather than give its size or number: two letters in a row, and no figure first.
pub(crate) fn is_name(text: &str) -> bool {
    let text = text.trim();
    let wide = text.chars().any(|c| c.is_alphabetic() && !c.is_ascii() && !c.is_lowercase() && !c.is_uppercase());
    let letters = text.chars().zip(text.chars().skip(1)).any(|(a, b)| a.is_alphabetic() && b.is_alphabetic());
    (wide || letters) && !text.starts_with(|c: char| c.is_ascii_digit())
}

/// Returns true for a label that numbers a room and does not name it: figures, codes of two letters at most and words for any
/// room (`1.02`, `B 12`, `EG.04`, `Raum 3`).
pub(crate) fn is_number(text: &str) -> bool {
    let folded = fold(text);
    let counts = |t: &str| t.bytes().any(|b| b.is_ascii_digit());
    let numbers = |t: &str| {
        let code = t.bytes().all(|b| b.is_ascii_alphanumeric())
            && t.bytes().filter(u8::is_ascii_alphabetic).count() <= MOST_CODE_LETTERS;
        code || role(t) == Some(Role::Room)
    };
    let mut tokens = folded.split(|c: char| !c.is_alphanumeric()).filter(|t| !t.is_empty());
    counts(&folded) && tokens.all(numbers)
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
            ("Furnitures", Some(Role::Skip)),
            ("InnerWalls", Some(Role::Wall)),
            ("Außenwände", Some(Role::Wall)),
            ("Innentüren", Some(Role::Door)),
            ("Стены", Some(Role::Wall)),
            ("ściany", Some(Role::Wall)),
            ("Stützen", Some(Role::Column)),
            ("S-COLS", Some(Role::Column)),
            ("COLUMN", Some(Role::Column)),
            ("Möblierung", Some(Role::Skip)),
            ("Natur", None),
            ("A-GLAZ", Some(Role::Window)),
            ("A-WALL-GLAZ", Some(Role::Window)),
            ("A-WIND-E", Some(Role::Window)),
            ("A-OPNG", Some(Role::Passage)),
            ("I-FURN", Some(Role::Skip)),
            ("A-DOOR-IDEN", Some(Role::Tag)),
            ("A-FLOR-STRS", None),
            // codes count in such names only
            ("wind lobby", None),
            ("roof terrace", None),
        ] {
            assert_eq!(role(text), expected, "{text}");
        }
        assert!(
            [&DATA.words, &DATA.codes, &DATA.endings, &DATA.storeys]
                .into_iter()
                .flat_map(Lists::values)
                .flatten()
                .all(|w| fold(w) == *w),
            "words are written folded"
        );
        for name in ["patrol_D2", "dock_1", "tinyRobot1_charger", "main_door", "lift1", "pickup", "charger"] {
            assert!(is_waypoint(name), "{name}");
        }
        for name in ["lift_lobby", "kitchen", "hardware_2", "coe", "dock office", "loading_dock", "supplies"] {
            assert!(!is_waypoint(name), "{name}");
        }
        for (text, numbers) in [
            ("1.02", true),
            ("B 12", true),
            ("EG.04", true),
            ("OG2-13a", true),
            ("Raum 3", true),
            ("Room 101", true),
            ("Kitchen 2", false),
            ("WC", false),
            ("卧室 1", false),
            ("", false),
        ] {
            assert_eq!(is_number(text), numbers, "{text}");
        }
        assert!(is_name("WC") && is_name("卧室") && !is_name("12.5 m2") && !is_name("B1"));
    }
}
