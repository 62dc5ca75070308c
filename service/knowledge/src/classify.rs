//! What kind of building a list of room labels is of, and which room type each label means.
//!
//! The paper's first step of retrieval, by the words of the domains alone. What it is not for: reading prompts (the
//! pipeline's `scene_graph` stage does).

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::domain::{Domain, RoomType};
use d3dgen_model::scene_graph::Robot;

use crate::query::{Query, QueryRoom};

/// A reading of room labels as rooms of one domain.
#[derive(Debug, Clone, PartialEq)]
pub struct Classified {
    /// Id of the domain.
    pub domain: String,
    /// How well the labels fit it, 0 to 1: words that few domains know count more.
    pub score: f64,
    /// Building type inside the domain whose program has most of these rooms; none when no program has any.
    pub building_type: Option<String>,
    /// Each label with its room type there; none when the domain does not know it.
    pub rooms: Vec<(String, Option<String>)>,
}

/// Returns a reading for every domain, the best first; equal ones in the order given.
pub fn classify(labels: &[String], domains: &[&Domain]) -> Vec<Classified> {
    let readings: Vec<Vec<Option<&RoomType>>> =
        domains.iter().map(|d| labels.iter().map(|l| room_type(l, d)).collect()).collect();
    // a label that many domains know tells little about which one it is
    let weights: Vec<f64> =
        (0..labels.len()).map(|n| 1.0 / readings.iter().filter(|r| r[n].is_some()).count().max(1) as f64).collect();
    let all: f64 = weights.iter().sum();
    let mut out: Vec<Classified> = domains
        .iter()
        .zip(&readings)
        .map(|(domain, types)| {
            let known: f64 = types.iter().zip(&weights).filter(|(t, _)| t.is_some()).map(|(_, w)| w).sum();
            Classified {
                domain: domain.id.clone(),
                score: if all > 0.0 { known / all } else { 0.0 },
                building_type: building_type(types, domain),
                rooms: labels.iter().cloned().zip(types.iter().map(|t| t.map(|t| t.id.clone()))).collect(),
            }
        })
        .collect();
    out.sort_by(|a, b| b.score.total_cmp(&a.score)); // stable: equal ones keep their order
    out
}

/// Returns the building type whose program shares most rooms with these, weighed against what else it has.
fn building_type(rooms: &[Option<&RoomType>], domain: &Domain) -> Option<String> {
    let here: BTreeSet<&str> = rooms.iter().flatten().map(|t| t.id.as_str()).collect();
    let fit = |program: &str| {
        let wanted: BTreeSet<&str> = domain.program(program)?.rooms.iter().map(|r| r.room_type.as_str()).collect();
        let shared = here.intersection(&wanted).count();
        (shared > 0).then(|| shared as f64 / here.union(&wanted).count() as f64)
    };
    let candidates = domain.building_types.iter().filter_map(|b| Some((fit(&b.program)?, b)));
    // the first of the best
    candidates.rev().max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, b)| b.id.clone())
}

/// Returns the room type that a label names: the one with the longest word or phrase in it.
pub fn room_type<'a>(label: &str, domain: &'a Domain) -> Option<&'a RoomType> {
    let label = words(label);
    if label.is_empty() {
        return None;
    }
    let names = |t: &'a RoomType| {
        let own = [t.id.replace('_', " "), t.label.clone()];
        own.into_iter().chain(t.keywords.values().flatten().cloned())
    };
    let longest = |t: &'a RoomType| names(t).map(|n| words(&n)).filter(|n| holds(&label, n)).map(|n| n.len()).max();
    let found = domain.room_types.iter().filter_map(|t| Some((longest(t)?, t)));
    found.rev().max_by_key(|(length, _)| *length).map(|(_, t)| t)
}

fn holds(label: &[String], name: &[String]) -> bool {
    !name.is_empty() && label.windows(name.len()).any(|part| part.iter().zip(name).all(|(a, b)| same_word(a, b)))
}

/// Returns true for two forms of one word: `Büros` and `buro`, `offices` and `office`, `Betten` and `Bett`.
fn same_word(a: &str, b: &str) -> bool {
    let (short, long) = if a.len() <= b.len() { (a, b) } else { (b, a) };
    short == long
        || short.len() >= 3 && long.strip_prefix(short).is_some_and(|e| matches!(e, "s" | "es" | "n" | "en" | "e"))
}

/// Returns the words of a text in lower case without accents; numbers are left out.
fn words(text: &str) -> Vec<String> {
    let folded: String = text
        .to_lowercase()
        .chars()
        .map(|c| match c {
            'ä' | 'à' | 'á' | 'â' => 'a',
            'ö' | 'ò' | 'ó' | 'ô' => 'o',
            'ü' | 'ù' | 'ú' | 'û' => 'u',
            'é' | 'è' | 'ê' | 'ë' => 'e',
            'í' | 'ì' | 'î' | 'ï' => 'i',
            'ñ' => 'n',
            'ç' => 'c',
            c => c,
        })
        .collect();
    let parts = folded.split(|c: char| !c.is_alphanumeric());
    parts.filter(|w| !w.is_empty() && !w.bytes().all(|b| b.is_ascii_digit())).map(str::to_owned).collect()
}

/// A building known by its room types only.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Building {
    /// ISO 3166 code; absent means international rules only.
    pub country_code: Option<String>,
    /// Building type inside the domain, where known.
    pub building_type: Option<String>,
    /// True when wheelchair access is asked for.
    pub accessible: bool,
    /// Room types with how many there are of each.
    pub rooms: BTreeMap<String, u32>,
    /// People at a time; reckoned from usual areas when absent.
    pub persons: Option<u32>,
    /// Robots that work in it.
    pub robots: Vec<Robot>,
}

impl Building {
    /// Returns what to ask a knowledge base; room types that the domain does not know are taken as plain rooms.
    pub fn query(&self, domain: &Domain) -> Query {
        let rooms: Vec<QueryRoom> = self.rooms.iter().map(|(id, count)| QueryRoom::of(id, *count, domain)).collect();
        let usual = |id: &str| domain.room_type_or_generic(id).area_m2.target;
        let area: f64 = self.rooms.iter().map(|(id, count)| usual(id) * f64::from(*count)).sum();
        Query {
            country_code: self.country_code.clone(),
            domain: domain.id.clone(),
            building_type: self.building_type.clone(),
            accessible: self.accessible,
            rooms,
            persons: self.persons.unwrap_or_else(|| Query::persons_of_area(area)),
            persons_stated: self.persons.is_some(),
            robots: self.robots.clone(),
        }
    }
}
