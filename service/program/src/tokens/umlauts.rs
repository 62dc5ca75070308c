//! German as it is written without umlauts: "Buero mit zwoelf Raeumen" is read as "Büro mit zwölf Räumen".

use std::collections::HashSet;

use d3dgen_plugins::Registry;

use super::text::{Kind, Phrases, Token, fold};
use super::words::words;

/// Letters of the end of a compound that tells its spelling ("Teekueche"), at least.
const LEAST_ENDING: usize = 4;
/// Letters of a word that has other forms, at least; shorter ones are compared whole ("fuer").
const LEAST_STEM: usize = 4;

/// The words that a spelling is looked up in.
struct Lexicon {
    german: Phrases<()>,
    whole: HashSet<String>,
    /// Words of the other languages: "queue" is none of German.
    others: HashSet<String>,
}

/// Spells words as the vocabularies do where that makes German words of them.
pub(crate) fn restore(tokens: &mut [Token], registry: &Registry) {
    let spelled = |t: &Token| (t.kind == Kind::Word).then(|| plain(&t.text)).flatten();
    if !tokens.iter().any(|t| spelled(t).is_some()) {
        return;
    }
    let lexicon = registry.digest("umlauts", || lexicon(registry));
    for token in tokens {
        let known = |w: &String| {
            let form = w.len() >= LEAST_STEM && lexicon.german.word(w).is_some();
            lexicon.whole.contains(w) || form || lexicon.german.ending(w, LEAST_ENDING).is_some()
        };
        if let Some(word) = spelled(token).filter(known).filter(|_| !lexicon.others.contains(&token.text)) {
            token.text = word;
        }
    }
}

/// Returns a word with plain letters in place of "ae", "oe" and "ue"; `None` for one that has none of these.
pub(crate) fn plain(word: &str) -> Option<String> {
    let mut out = String::with_capacity(word.len());
    let mut before = ' ';
    for c in word.chars() {
        // "neue", "Bauer" and "quer" have no umlaut
        let of = out.chars().rev().nth(1);
        let umlaut = c == 'e'
            && matches!(before, 'a' | 'o' | 'u')
            && !(before == 'u' && matches!(of, Some('a' | 'e' | 'o' | 'q')));
        if !umlaut {
            out.push(c);
        }
        before = if umlaut { ' ' } else { c };
    }
    (out != word).then_some(out)
}

fn lexicon(registry: &Registry) -> Lexicon {
    let mut lexicon = Lexicon { german: Phrases::new("de"), whole: HashSet::new(), others: HashSet::new() };
    let mut put = |language: &str, phrase: &str| {
        for word in phrase.split(|c: char| !c.is_alphanumeric()).filter(|w| !w.is_empty()) {
            if language == "de" {
                lexicon.german.insert(word, ());
                lexicon.whole.insert(fold(word));
            } else if matches!(language, "en" | "fr" | "es") {
                lexicon.others.insert(fold(word));
            }
        }
    };
    for domain in registry.iter().map(|p| p.domain()) {
        let rooms = domain.room_types.iter().map(|r| &r.keywords);
        let buildings = domain.building_types.iter().map(|b| &b.keywords);
        for keywords in rooms.chain(buildings).chain([&domain.keywords]) {
            keywords.iter().for_each(|(language, list)| list.iter().for_each(|p| put(language, p)));
        }
    }
    for (language, spoken) in &words().languages {
        let own = &spoken.words;
        own.phrases.values().flatten().for_each(|p| put(language, p));
        [&own.numbers, &own.multipliers, &own.quantities]
            .into_iter()
            .flat_map(|m| m.keys())
            .for_each(|p| put(language, p));
    }
    lexicon
}

#[cfg(test)]
mod tests {
    use super::super::text::tokens;
    use super::*;

    #[test]
    fn words_of_german_get_their_letters_and_others_stay() {
        let registry = Registry::builtin();
        for (text, words) in [
            ("Buero mit zwoelf Raeumen", "buro mit zwolf raumen"),
            ("Wohnung fuer fuenf, Kueche und Baeder", "wohnung fur funf , kuche und bader"),
            ("Bueroraeume und Teekueche", "buroraume und teekuche"),
            ("a blue museum with a queue", "a blue museum with a queue"),
            ("neue Mauer, quer", "neue mauer , quer"),
        ] {
            let mut list = tokens(text);
            restore(&mut list, &registry);
            assert_eq!(list.iter().map(|t| t.text.as_str()).collect::<Vec<_>>().join(" "), words);
        }
    }
}
