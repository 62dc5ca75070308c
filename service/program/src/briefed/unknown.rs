//! Kinds of buildings that no domain knows: their rooms where the brief lists them, else a refusal with the nearest kinds.

use d3dgen_model::brief::{Ask, Brief, Fact};
use d3dgen_model::domain::Domain;
use d3dgen_model::scene_graph::Note;
use d3dgen_model::stage::Error;
use d3dgen_plugins::Registry;

use super::{Notes, roles};

/// Kinds that a refusal names.
const NEAREST: usize = 3;
/// Rooms that a brief lists at least before they are planned without knowing what for.
const LEAST_ROOMS: usize = 2;

/// What an unknown kind is planned as.
pub(super) struct Stand {
    pub domain: String,
    pub building_type: String,
}

/// Returns what the rooms of a building are planned as of which nobody knows the kind; `name` is what the brief calls it.
///
/// # Errors
/// `UnknownBuilding` with the kinds that are called most alike, where too few rooms are listed to make a building.
pub(super) fn stand_in(name: &str, brief: &Brief, registry: &Registry, notes: &mut Notes) -> Result<Stand, Error> {
    let stand = &roles().unknown_building;
    let rooms = brief.asks.iter().filter(|a| matches!(a.fact, Fact::Rooms(_))).count();
    if rooms < LEAST_ROOMS || registry.get(&stand.domain).is_none() {
        return Err(unknown(name, brief, registry));
    }
    let what = stand.building_type.replace('_', " ");
    let message = format!("`{name}` is no kind of building that is known; its rooms were planned as those of a {what}");
    notes.assumptions.push(Note::new("unknown_building", message));
    Ok(Stand { domain: stand.domain.clone(), building_type: stand.building_type.clone() })
}

/// Returns true for a brief in which nothing says what to plan: no kind of building, no room, nobody who is there.
pub fn says_nothing(brief: &Brief) -> bool {
    // the range of a "shooting range" says nothing of cooking
    let part_of_a_name = |ask: &Ask| {
        let before = |at: u32| brief.not_understood.iter().any(|w| w.end <= at && at <= w.end + 1);
        matches!(ask.fact, Fact::Objects(_)) && ask.words.first().is_some_and(|w| before(w.start))
    };
    let told = |ask: &Ask| {
        let aside =
            matches!(ask.fact, Fact::Other(_) | Fact::Style(_) | Fact::Site(_) | Fact::Accessible(_) | Fact::Robots(_));
        !aside && !part_of_a_name(ask)
    };
    let named = brief.building.as_ref().is_some_and(|b| !b.words.is_empty() || b.confidence >= 1.0);
    !named && !brief.asks.iter().any(told) && !brief.not_understood.is_empty()
}

/// Says of words that nothing was made of, in a brief that names no building, which kinds are called alike.
pub(super) fn guessed(brief: &Brief, registry: &Registry) -> Option<Note> {
    let words = &brief.not_understood.iter().min_by_key(|w| w.start)?.text;
    let language = brief.languages.first().map_or("en", String::as_str);
    let kinds: Vec<String> = nearest(words, language, registry).into_iter().take(NEAREST).collect();
    let message = format!(
        "no kind of building is called `{words}`; the nearest are {}; the rooms were planned by themselves",
        kinds.join(", ")
    );
    Some(Note::new("unknown_building", message))
}

/// Returns the refusal of a brief that says nothing.
pub(super) fn nothing_said(brief: &Brief, registry: &Registry) -> Error {
    let words: Vec<&str> = brief.not_understood.iter().map(|w| w.text.as_str()).collect();
    unknown(&words.join(" "), brief, registry)
}

fn unknown(name: &str, brief: &Brief, registry: &Registry) -> Error {
    let language = brief.languages.first().map_or("en", String::as_str);
    let named = brief.other_buildings.iter().filter(|b| b.domain.is_some()).map(|b| b.name.clone());
    let mut kinds: Vec<String> = named.take(NEAREST).collect();
    for kind in nearest(name, language, registry) {
        if kinds.len() < NEAREST && !kinds.contains(&kind) {
            kinds.push(kind);
        }
    }
    Error::UnknownBuilding {
        name: name.to_owned(),
        nearest: kinds,
        domains: registry.iter().map(|p| p.id().to_owned()).collect(),
        fallback: roles().unknown_building.domain.clone(),
    }
}

/// Returns the kinds of buildings that are called most alike, one name each, in a language or else in English.
fn nearest(name: &str, language: &str, registry: &Registry) -> Vec<String> {
    let name = name.to_lowercase();
    let mut found: Vec<(f64, String)> =
        registry.iter().flat_map(|p| kinds(p.domain(), language)).map(|kind| (likeness(&name, &kind), kind)).collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(&b.1)));
    found.into_iter().map(|f| f.1).collect()
}

/// Returns the first name of each kind of building of a domain.
fn kinds(domain: &Domain, language: &str) -> Vec<String> {
    let first =
        |words: &d3dgen_model::domain::Words| words.get(language).or(words.get("en")).and_then(|w| w.first()).cloned();
    domain.building_types.iter().filter_map(|b| first(&b.keywords)).collect()
}

/// Returns how alike two names are, 0 to 1: by their last words too, for "boathouse" is a kind of house.
fn likeness(a: &str, b: &str) -> f64 {
    let reversed = |s: &str| s.chars().rev().collect::<String>();
    strsim::jaro_winkler(a, b).max(strsim::jaro_winkler(&reversed(a), &reversed(b)))
}
