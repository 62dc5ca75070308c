//! The words of buildings: those of the domains, and the names of places.

use std::collections::BTreeMap;

use d3dgen_language::Lexicon;
use d3dgen_plugins::Registry;

use crate::places::places;

/// Returns the lexicon of the language crate with the words of all domains.
pub(crate) fn lexicon(registry: &Registry) -> Lexicon {
    let shipped = Lexicon::shipped();
    let mut lexicon = shipped.clone();
    // "两室": a number and what it counts, which the grammar reads
    let counts = |phrase: &str| {
        let reading = shipped.read(phrase);
        let chunks = reading.chunks();
        let counted = chunks.iter().any(|c| c.has("shorthand"));
        chunks.len() > 1 && counted && chunks.iter().all(|c| c.number.is_some() || c.has("shorthand"))
    };
    let add = |lexicon: &mut Lexicon, class: &str, value: &str, words: &BTreeMap<String, Vec<String>>| {
        for (language, phrases) in words {
            let told = phrases.iter().filter(|p| class != "domain" || !counts(p));
            told.for_each(|p| lexicon.add(language, class, value, p));
        }
    };
    for plugin in registry.iter() {
        let domain = plugin.domain();
        for kind in &domain.building_types {
            add(&mut lexicon, "kind", &format!("{}:{}", domain.id, kind.id), &kind.keywords);
        }
        add(&mut lexicon, "domain", &domain.id, &domain.keywords);
        for room in &domain.room_types {
            add(&mut lexicon, "room", &room.id, &room.keywords);
        }
        for object in &domain.objects {
            add(&mut lexicon, "object", &object.id, &object.keywords);
        }
        for who in &domain.practitioners {
            add(&mut lexicon, "person", &who.room_type, &who.keywords);
        }
    }
    for place in places() {
        lexicon.add_name("place", &place.value, &place.name);
    }
    lexicon
}
