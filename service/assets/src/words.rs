//! Names as words: `SM_OfficeChair_01a`, `kitchen-sink.glb` and `Bürostuhl` become words that can be compared.

use std::collections::BTreeSet;
use std::sync::OnceLock;

/// Returns the words of a name in lower case without accents; parts at case changes, digits and signs.
pub fn split(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut word = String::new();
    let chars: Vec<char> = name.chars().collect();
    for (i, &c) in chars.iter().enumerate() {
        let before = i.checked_sub(1).and_then(|j| chars.get(j)).copied();
        let after = chars.get(i + 1).copied();
        let starts_word = c.is_uppercase()
            && before.is_some_and(|b| b.is_lowercase() || b.is_uppercase() && after.is_some_and(char::is_lowercase));
        let changes_class = before.is_some_and(|b| b.is_alphanumeric() && b.is_ascii_digit() != c.is_ascii_digit());
        if (!c.is_alphanumeric() || starts_word || changes_class) && !word.is_empty() {
            words.push(std::mem::take(&mut word));
        }
        if c.is_alphanumeric() {
            fold(c, &mut word);
        }
    }
    if !word.is_empty() {
        words.push(word);
    }
    words
}

/// Returns the singular of an English word where the rules of spelling tell it.
pub fn singular(word: &str) -> String {
    let n = word.len();
    let irregular = match word {
        "shelves" => Some("shelf"),
        "knives" => Some("knife"),
        "glasses" | "dresses" | "buses" => None,
        _ => None,
    };
    if let Some(found) = irregular {
        return found.to_owned();
    }
    if n > 4 && word.ends_with("ies") {
        return format!("{}y", &word[..n - 3]);
    }
    if n > 4 && ["ches", "shes", "sses", "xes"].iter().any(|end| word.ends_with(end)) {
        return word[..n - 2].to_owned();
    }
    let plural = n > 3 && word.ends_with('s') && !["ss", "us", "is"].iter().any(|end| word.ends_with(end));
    if plural { word[..n - 1].to_owned() } else { word.to_owned() }
}

/// Returns true for words that do not say what a thing is: numbers, single letters, sizes, colors, exporters' words.
pub fn is_beside_the_point(word: &str) -> bool {
    static WORDS: OnceLock<BTreeSet<&'static str>> = OnceLock::new();
    let all = || {
        let lines = include_str!("../data/beside_names.txt").lines().filter(|l| !l.starts_with('#'));
        lines.flat_map(str::split_whitespace).collect()
    };
    word.chars().count() < 2 || word.starts_with(|c: char| c.is_ascii_digit()) || WORDS.get_or_init(all).contains(word)
}

fn fold(c: char, out: &mut String) {
    match c {
        'ä' | 'Ä' | 'à' | 'á' | 'â' => out.push('a'),
        'ö' | 'Ö' | 'ó' | 'ô' => out.push('o'),
        'ü' | 'Ü' | 'ù' | 'ú' | 'û' => out.push('u'),
        'é' | 'è' | 'ê' | 'É' => out.push('e'),
        'ß' => out.push_str("ss"),
        _ => out.extend(c.to_lowercase()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_cut_into_words() {
        for (name, words) in [
            ("SM_OfficeChair_01a", vec!["sm", "office", "chair", "01", "a"]),
            ("bed-single.glb", vec!["bed", "single", "glb"]),
            ("IVStand", vec!["iv", "stand"]),
            ("bookcaseClosedWide", vec!["bookcase", "closed", "wide"]),
            ("Bürostuhl", vec!["burostuhl"]),
            ("TV_02", vec!["tv", "02"]),
            ("", vec![]),
            ("__--", vec![]),
        ] {
            assert_eq!(split(name), words, "{name}");
        }
    }

    #[test]
    fn plurals_meet_their_singulars() {
        for (plural, one) in [
            ("chairs", "chair"),
            ("shelves", "shelf"),
            ("benches", "bench"),
            ("boxes", "box"),
            ("batteries", "battery"),
            ("glass", "glass"),
            ("bus", "bus"),
        ] {
            assert_eq!(singular(plural), one);
        }
    }
}
