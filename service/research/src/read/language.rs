//! Guesses the language of a text by its most common small words, which are data: `languages.toml`.
//!
//! What it is not for: short texts; under twenty words nothing is said.

use std::collections::BTreeMap;
use std::sync::LazyLock;

/// How much text is looked at; more does not change the answer.
const ENOUGH_BYTES: usize = 60_000;

static WORDS: LazyLock<BTreeMap<String, Vec<String>>> =
    LazyLock::new(|| toml::from_str(include_str!("languages.toml")).expect("languages.toml is checked by a test"));

/// Returns the language of texts as its two letters, if one is clear.
pub fn guess<'a>(texts: impl Iterator<Item = &'a str>) -> Option<String> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    let (mut bytes, mut total) = (0, 0usize);
    for text in texts {
        if bytes > ENOUGH_BYTES {
            break;
        }
        bytes += text.len();
        for word in text.split(|c: char| !c.is_alphabetic()).filter(|w| !w.is_empty()).take(ENOUGH_BYTES / 4) {
            total += 1;
            let word = word.to_lowercase();
            for (language, words) in WORDS.iter() {
                if words.binary_search(&word).is_ok() {
                    *counts.entry(language).or_default() += 1;
                }
            }
        }
    }
    let mut ranked: Vec<(usize, &str)> = counts.into_iter().map(|(l, n)| (n, l)).collect();
    ranked.sort_by(|a, b| b.cmp(a));
    let (best, language) = *ranked.first()?;
    let second = ranked.get(1).map_or(0, |r| r.0);
    (total >= 20 && best * 12 >= total && best * 2 > second * 3).then(|| language.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_sorted_for_searching() {
        assert!(WORDS.len() >= 6);
        for (language, words) in WORDS.iter() {
            assert!(words.is_sorted() && words.len() >= 30, "{language}");
        }
    }

    #[test]
    fn languages_are_told_apart_and_short_texts_are_not_judged() {
        let cases = [
            (
                "Every bedroom shall have a window that can be opened, and the area of the glass is not less than one \
              tenth of the floor.",
                Some("en"),
            ),
            (
                "Jeder Aufenthaltsraum muss ein Fenster haben, das sich öffnen lässt, und die Fläche des Glases darf nicht \
              kleiner als ein Zehntel des Bodens sein.",
                Some("de"),
            ),
            (
                "Chaque chambre doit avoir une fenêtre qui peut être ouverte, et la surface du verre ne doit pas être \
              inférieure à un dixième du sol.",
                Some("fr"),
            ),
            (
                "Cada dormitorio debe tener una ventana que se pueda abrir, y la superficie del vidrio no será menor que \
              la décima parte del suelo de la habitación.",
                Some("es"),
            ),
            (
                "Ogni camera deve avere una finestra che si possa aprire, e la superficie del vetro non deve essere \
              inferiore a un decimo del pavimento della stanza.",
                Some("it"),
            ),
            (
                "Elke slaapkamer moet een raam hebben dat open kan, en de oppervlakte van het glas is niet kleiner dan een \
              tiende van de vloer van de kamer.",
                Some("nl"),
            ),
            ("Corridor 1.5 m", None),
            ("A1 B2 C3 D4 E5 F6 A1 B2 C3 D4 E5 F6 A1 B2 C3 D4 E5 F6 A1 B2 C3 D4 E5 F6", None),
        ];
        for (text, expected) in cases {
            assert_eq!(guess([text].into_iter()).as_deref(), expected, "{text}");
        }
    }
}
