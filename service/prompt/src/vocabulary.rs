//! The words of buildings: those of the domains, and the names of places.

use std::collections::BTreeMap;

use d3dgen_language::{Lexicon, Words};
use d3dgen_plugins::Registry;

use crate::places::places;

/// Returns the lexicon of the language crate with the words of all domains.
pub(crate) fn lexicon(registry: &Registry) -> Lexicon {
    let mut lexicon = Lexicon::shipped();
    // "两室": a number and what it counts, which the grammar reads
    let counts = |phrase: &str| {
        let reading = lexicon.read(phrase);
        let chunks = reading.chunks();
        let counted = chunks.iter().any(|c| c.has("shorthand"));
        chunks.len() > 1 && counted && chunks.iter().all(|c| c.number.is_some() || c.has("shorthand"))
    };
    let mut words: Vec<(String, Words)> = Vec::new();
    let mut add = |class: &str, value: &str, of: &BTreeMap<String, Vec<String>>| {
        for (language, phrases) in of {
            let told = phrases.iter().filter(|p| class != DOMAIN || !counts(p));
            words.extend(told.map(|p| (language.clone(), word(class, value, p))));
        }
    };
    for plugin in registry.iter() {
        let domain = plugin.domain();
        for kind in &domain.building_types {
            add("kind", &format!("{}:{}", domain.id, kind.id), &kind.keywords);
        }
        add(DOMAIN, &domain.id, &domain.keywords);
        domain.room_types.iter().for_each(|room| add("room", &room.id, &room.keywords));
        domain.objects.iter().for_each(|object| add("object", &object.id, &object.keywords));
        domain.practitioners.iter().for_each(|who| add("person", &who.room_type, &who.keywords));
    }
    let places = places();
    for language in lexicon.languages_of_names() {
        words.extend(places.iter().map(|p| (language.clone(), word("place", &p.value, &p.name))));
    }
    lexicon.add_all(words);
    lexicon
}

/// Class of the words that name a domain and no kind of building in it.
const DOMAIN: &str = "domain";

fn word(class: &str, value: &str, phrase: &str) -> Words {
    Words { class: class.to_owned(), value: value.to_owned(), phrase: phrase.to_owned() }
}
