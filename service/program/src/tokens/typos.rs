//! Words that are misspelled by one letter: "4 bedrom house with a garrage" has bedrooms and a garage.
//!
//! A false reading is worse than none. Only words are read so that nothing knows, that begin with the letter of the word they
//! are read as, and are one edit away from that word alone; never a name, and never one that people use for something else
//! (`lookalikes.toml`: "closer" is no closet).

use std::collections::BTreeMap;
use std::sync::LazyLock;

use d3dgen_model::domain::Domain;
use d3dgen_plugins::Registry;

use super::text::{Kind, Phrases, Token, fold};
use super::words::{Spoken, Tag, tag_ends_at};
use crate::named::styles;
use crate::subject::places;

/// Letters of a word of a room's or building's name that misspellings are looked for of, at least.
const LEAST_ROOM: usize = 6;
/// The same of the name of an object.
const LEAST_OBJECT: usize = 8;
/// Letters of the name of a building that may have lost one: "hous".
const SHORT: usize = 5;
/// Letters of the end of a compound that tells that it is a word ("Lagerzimmer").
const LEAST_ENDING: usize = 4;

/// A word that was read as another.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Typo {
    /// Token.
    pub at: usize,
    pub read: String,
}

/// What words are looked up in.
struct Speller {
    known: Vec<Phrases<()>>,
    /// Words that are looked for, with those they are a form of.
    forms: BTreeMap<String, Form>,
}

#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Form {
    /// Which of the languages it is of: the prompt's own comes first.
    language: usize,
    /// True for what no keyword says so: "bathrooms".
    derived: bool,
    /// The word as a keyword has it.
    word: String,
    /// True for words that are too short to be misspelled otherwise than by a letter that is missing.
    short: bool,
}

/// Spells misspelled words right, and returns them.
pub(crate) fn mend(tokens: &mut [Token], languages: &[&str], spoken: &[&Spoken], registry: &Registry) -> Vec<Typo> {
    let speller = registry.digest(&format!("spelling: {languages:?}"), || Speller::new(languages, registry));
    let mut out = Vec::new();
    for at in 0..tokens.len() {
        if is_name(tokens, at, languages, spoken) || speller.knows(&tokens[at].text) {
            continue;
        }
        let Some((form, word)) = speller.meant(&tokens[at].text) else { continue };
        // words of a place or of style are none of a room
        if places::names(tokens, at) || styles::said(tokens, languages).iter().any(|s| s.span.contains(at)) {
            continue;
        }
        out.push(Typo { at, read: word.to_owned() });
        tokens[at].text = form.to_owned();
    }
    out
}

/// Returns true for what is no plain word: a number, a sign, or what is written like a name.
fn is_name(tokens: &[Token], at: usize, languages: &[&str], spoken: &[&Spoken]) -> bool {
    let token = &tokens[at];
    let plain = token.kind == Kind::Word && token.text.bytes().all(|b| b.is_ascii_lowercase());
    // in German all nouns have a capital
    let starts = at == 0 || tokens[at - 1].is_mark();
    let behind = |tag| at > 0 && tag_ends_at(spoken, tokens, at - 1, tag, at);
    let named = if languages.contains(&"de") { behind(Tag::PlaceBefore) } else { !starts };
    !plain || token.capital && named
}

impl Speller {
    fn new(languages: &[&str], registry: &Registry) -> Self {
        let mut known: Vec<Phrases<()>> = Vec::new();
        let mut forms = BTreeMap::new();
        for (n, language) in languages.iter().enumerate() {
            let mut phrases = Phrases::new(language);
            let mut know = |text: &str| words(text).for_each(|w| phrases.insert(w, ()));
            registry.iter().for_each(|p| keywords(p.domain(), language, |text, _| know(text)));
            lexicon(language).iter().for_each(|text| know(text));
            known.push(phrases);
            registry
                .iter()
                .for_each(|p| keywords(p.domain(), language, |text, of| add(&mut forms, (n, *language), text, of)));
        }
        Self { known, forms }
    }

    fn knows(&self, word: &str) -> bool {
        self.known.iter().any(|p| p.word(word).is_some() || p.ending(word, LEAST_ENDING).is_some())
    }

    /// Returns the only word that is meant, in the form that is meant, and as a keyword has it.
    fn meant(&self, word: &str) -> Option<(&str, &str)> {
        let first = word.get(..1)?;
        let near = |form: &str| strsim::osa_distance(form, word) == 1;
        let alike = self.forms.range(first.to_owned()..).take_while(|(form, _)| form.starts_with(first));
        let lost = |form: &str| form.len() == word.len() + 1;
        let mut found: Vec<(&Form, &str)> = alike
            .filter(|(form, of)| form.len().abs_diff(word.len()) <= 1 && (!of.short || lost(form)) && near(form))
            .map(|(form, of)| (of, form.as_str()))
            .collect();
        // a letter that is doubled, or is not, is the commonest mistake: "garrage" is no garbage
        let doubled = |form: &str| undoubled(form) == undoubled(word);
        if found.iter().any(|(_, form)| doubled(form)) {
            found.retain(|(_, form)| doubled(form));
        }
        found.sort();
        let (of, form) = *found.first()?;
        let mut own = found.iter().filter(|(other, _)| other.language == of.language);
        own.all(|(other, _)| is_form(&other.word, &of.word)).then_some((form, &of.word))
    }
}

/// Returns a word with one letter for every two that are the same.
fn undoubled(word: &str) -> String {
    let mut letters: Vec<char> = word.chars().collect();
    letters.dedup();
    letters.into_iter().collect()
}

/// Returns true for a word and its plural, in any order.
fn is_form(a: &str, b: &str) -> bool {
    let (a, b) = (fold(a), fold(b));
    let (short, long) = if a.len() < b.len() { (a, b) } else { (b, a) };
    long.strip_prefix(&short).is_some_and(|ending| ["", "s", "es", "n", "en", "e"].contains(&ending))
}

/// What a keyword is of.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Of {
    Room,
    Object,
}

/// Hands over all keywords of a domain in a language.
fn keywords(domain: &Domain, language: &str, mut put: impl FnMut(&str, Of)) {
    let rooms = domain.room_types.iter().map(|r| &r.keywords);
    let buildings = domain.building_types.iter().map(|b| &b.keywords);
    let all = rooms.chain(buildings).chain([&domain.keywords]).map(|words| (words, Of::Room));
    for (words, of) in all.chain(domain.objects.iter().map(|o| (&o.keywords, Of::Object))) {
        words.get(language).into_iter().flatten().for_each(|text| put(text, of));
    }
}

/// Adds the words of a keyword that misspellings are looked for of.
fn add(forms: &mut BTreeMap<String, Form>, (n, language): (usize, &str), text: &str, of: Of) {
    let alone = words(text).count() == 1;
    for word in words(text) {
        let folded = fold(word);
        let letters = folded.len();
        let least = if of == Of::Object { LEAST_OBJECT } else { LEAST_ROOM };
        let short = letters == SHORT && alone && of == Of::Room;
        if !folded.bytes().all(|b| b.is_ascii_lowercase()) || !(short || letters >= least && (alone || of == Of::Room))
        {
            continue;
        }
        let mut put = |form: String, derived| {
            let new = Form { language: n, derived, word: word.to_owned(), short };
            forms.entry(form).and_modify(|old| *old = old.clone().min(new.clone())).or_insert(new);
        };
        if !short {
            plurals(language).iter().for_each(|ending| put(format!("{folded}{ending}"), true));
        }
        put(folded, false);
    }
}

/// Endings of the plural of most words of a language.
fn plurals(language: &str) -> &'static [&'static str] {
    match language {
        "en" => &["s"],
        "de" => &["n", "en", "e"],
        "fr" => &["s"],
        "es" => &["s", "es"],
        _ => &[],
    }
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_alphanumeric()).filter(|w| !w.is_empty())
}

/// Returns all that `words.toml` and `lookalikes.toml` say in a language.
fn lexicon(language: &str) -> &'static [String] {
    static ALL: LazyLock<BTreeMap<String, Vec<String>>> = LazyLock::new(|| {
        let table = |text| toml::from_str::<toml::Table>(text).expect("a test reads the words");
        let mut all: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for file in [table(include_str!("words.toml")), table(include_str!("lookalikes.toml"))] {
            for (language, value) in file {
                texts(&value, all.entry(language).or_default());
            }
        }
        all
    });
    ALL.get(language).map_or(&[], Vec::as_slice)
}

fn texts(value: &toml::Value, out: &mut Vec<String>) {
    match value {
        toml::Value::String(text) => out.push(text.clone()),
        toml::Value::Array(list) => list.iter().for_each(|v| texts(v, out)),
        toml::Value::Table(table) => {
            for (word, value) in table {
                out.push(word.clone());
                texts(value, out);
            }
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::super::text::tokens;
    use super::super::words::words as all_words;
    use super::*;

    fn mended(prompt: &str, languages: &[&str]) -> Vec<String> {
        let registry = Registry::builtin();
        let spoken: Vec<&Spoken> = languages.iter().filter_map(|l| all_words().languages.get(*l)).collect();
        let mut tokens = tokens(prompt);
        mend(&mut tokens, languages, &spoken, &registry).into_iter().map(|t| tokens[t.at].text.clone()).collect()
    }

    #[test]
    fn reads_words_that_are_one_letter_off() {
        let prompt = "4 bedrom hous wit 2 bathroms, a garrage, a kithcen and a balcany";
        assert_eq!(mended(prompt, &["en"]), ["bedroom", "house", "bathrooms", "garage", "kitchen", "balcony"]);
        assert_eq!(mended("Wohnung mit zwei Schlafzimern, Balkoon", &["de", "en"]), ["schlafzimmern", "balkon"]);
        assert_eq!(mended("appartement avec deux chambes et une cuisne", &["fr", "en"]), ["chambres", "cuisine"]);
        assert_eq!(mended("casa con tres dormitorois y una cosina", &["es", "en"]), ["dormitorios", "cocina"]);
    }

    #[test]
    fn leaves_words_names_and_places_alone() {
        let none: [&str; 0] = [];
        for prompt in [
            "the closest clinic, closer to the officer, with a served batch and no batteries",
            "house of Mr Garrage, by Kitchem and Sons",
            "flat without stairs in Sydney, no bath, 3 storeys, seven horses and stories",
        ] {
            assert_eq!(mended(prompt, &["en"]), none, "{prompt}");
        }
        assert_eq!(mended("Haus in Gerten für einen Gärtner", &["de", "en"]), none);
    }
}
