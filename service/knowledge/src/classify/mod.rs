//! What kind of building a list of room labels is of, and which room type each label means.
//!
//! The paper's first step of retrieval, by the words of the domains alone. What it is not for: reading prompts (the
//! pipeline's `scene_graph` stage does).

mod building;
mod text;
mod vocabulary;

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::domain::{Domain, GENERIC_ROOM_TYPE, RoomType};

pub use building::Building;
use text::Phrase;
use vocabulary::{Match, Vocabulary, rooms_of, shares};

/// A reading of room labels as rooms of one domain.
#[derive(Debug, Clone, PartialEq)]
pub struct Classified {
    /// Id of the domain.
    pub domain: String,
    /// How well the labels fit it, 0 to 1: words that few domains know count more, labels that name no kind of room nothing.
    pub score: f64,
    /// Building type inside the domain whose program has most of these rooms; none when no program has any.
    pub building_type: Option<String>,
    /// Each label with its room type there; none when the domain does not know it.
    pub rooms: Vec<(String, Option<String>)>,
}

/// Readings whose scores differ by no more than this are as good as each other.
const TIE: f64 = 0.03;
/// Part of the score that is how many of the labels one building of the domain has; the rest is how well each is known.
const TOGETHER: f64 = 0.2;
/// Part of what a label says that depends on how usual the room is in buildings of the domain.
const USUAL: f64 = 0.5;
/// What the words of a label say whose room nobody knows, against a label that is known.
const WORDS: f64 = 0.4;

/// What the rooms and buildings of some domains are called, made ready to read labels with: to be made once for many lists.
#[derive(Debug)]
pub struct Words {
    of: Vec<Vocabulary>,
}

impl Words {
    /// Makes ready what some domains call things.
    pub fn of(domains: &[&Domain]) -> Self {
        Self { of: domains.iter().map(|d| Vocabulary::new(d)).collect() }
    }

    /// Returns a reading of labels for every domain, the best first; equal ones in the order given.
    ///
    /// # Panics
    /// When the domains are not those, in their order, that the words were made of.
    pub fn classify(&self, labels: &[String], domains: &[&Domain]) -> Vec<Classified> {
        assert_eq!(self.of.len(), domains.len(), "words are asked with the domains that they are of");
        readings(labels, domains, &self.of.iter().collect::<Vec<_>>())
    }

    /// Returns a reading of labels for one of the domains, by its place.
    ///
    /// # Panics
    /// When the words are of fewer domains, or the domain is not that of this place.
    pub fn classify_in(&self, labels: &[String], at: usize, domain: &Domain) -> Vec<Classified> {
        readings(labels, &[domain], &[&self.of[at]])
    }
}

/// Returns a reading for every domain, the best first; equal ones in the order given.
pub fn classify(labels: &[String], domains: &[&Domain]) -> Vec<Classified> {
    Words::of(domains).classify(labels, domains)
}

fn readings(labels: &[String], domains: &[&Domain], vocabularies: &[&Vocabulary]) -> Vec<Classified> {
    let phrases: Vec<Phrase> = labels.iter().map(|l| Phrase::new(l)).collect();
    let language = spoken(&phrases, vocabularies);
    let meanings: Vec<Vec<Option<Match>>> =
        vocabularies.iter().map(|v| phrases.iter().map(|p| v.meaning(p, language)).collect()).collect();
    let evidence: Vec<Vec<f64>> = (0..phrases.len()).map(|n| said(&phrases[n], n, vocabularies, &meanings)).collect();
    let weights: Vec<f64> = evidence.iter().map(|e| rarity(e)).collect();
    let all: f64 = weights.iter().sum();
    let mut out: Vec<Classified> = (0..domains.len())
        .map(|at| {
            let domain = domains[at];
            let each: f64 = evidence.iter().zip(&weights).map(|(e, w)| e[at] * w).sum();
            let together = in_one_building(domain, &meanings[at], &weights);
            let score = ((1.0 - TOGETHER) * each + TOGETHER * together) / all;
            let types: Vec<Option<&RoomType>> =
                meanings[at].iter().map(|m| m.map(|m| &domain.room_types[m.at])).collect();
            Classified {
                domain: domain.id.clone(),
                score: if all > 0.0 { score } else { 0.0 },
                building_type: building_type(&types, domain),
                rooms: labels.iter().cloned().zip(types.iter().map(|t| t.map(|t| t.id.clone()))).collect(),
            }
        })
        .collect();
    // a room of no kind is one wherever the others are
    for reading in &mut out {
        for ((_, room_type), phrase) in reading.rooms.iter_mut().zip(&phrases) {
            if room_type.is_none() && phrase.says_nothing() && !phrase.words.is_empty() {
                *room_type = Some(GENERIC_ROOM_TYPE.to_owned());
            }
        }
    }
    out.sort_by(|a, b| b.score.total_cmp(&a.score)); // stable: equal ones keep their order
    out
}

/// Returns the readings after the first that are as good as it.
pub fn ties(readings: &[Classified]) -> Vec<&Classified> {
    let Some((best, others)) = readings.split_first() else { return Vec::new() };
    others.iter().take_while(|r| r.score > 0.0 && best.score - r.score <= TIE).collect()
}

/// Returns the room type that a label names in a domain.
pub fn room_type<'a>(label: &str, domain: &'a Domain) -> Option<&'a RoomType> {
    let phrase = Phrase::new(label);
    let found = Vocabulary::new(domain).meaning(&phrase, None).map(|m| &domain.room_types[m.at]);
    let generic = || domain.room_type(GENERIC_ROOM_TYPE).filter(|_| !phrase.words.is_empty() && phrase.says_nothing());
    found.or_else(generic)
}

/// Returns the language in which most of the labels are names of rooms.
fn spoken<'a>(phrases: &[Phrase], vocabularies: &[&'a Vocabulary]) -> Option<&'a str> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for phrase in phrases {
        let languages: BTreeSet<&str> = vocabularies.iter().flat_map(|v| v.languages(phrase)).collect();
        languages.into_iter().for_each(|l| *counts.entry(l).or_insert(0) += 1);
    }
    counts.into_iter().rev().max_by_key(|(_, n)| *n).map(|(l, _)| l)
}

/// Returns for each domain how much a label speaks for it, 0 to 1.
fn said(phrase: &Phrase, n: usize, vocabularies: &[&Vocabulary], meanings: &[Vec<Option<Match>>]) -> Vec<f64> {
    let words = shares(phrase, vocabularies);
    let known = meanings.iter().filter_map(|m| m[n]).map(|m| m.grade).fold(0.0, f64::max);
    let each = vocabularies.iter().zip(meanings).zip(words);
    each.map(|((vocabulary, own), words)| {
        let name = own[n].map_or(0.0, |m| m.grade * (1.0 - USUAL + USUAL * vocabulary.usual(m.at)));
        // where one domain knows the label, its words are no longer a guess
        name.max(WORDS * words * (1.0 - known)).max(if known < 1.0 { WORDS * words * name } else { 0.0 })
    })
    .collect()
}

/// Returns the weight of a label: 1 where it speaks for one domain only, little where it speaks for all alike.
fn rarity(evidence: &[f64]) -> f64 {
    let most = evidence.iter().copied().fold(0.0, f64::max);
    if most == 0.0 {
        return 0.0;
    }
    let count = evidence.len() as f64 + 1.0;
    let alike = evidence.iter().map(|e| e / most).sum::<f64>();
    most * (count / alike).ln() / count.ln()
}

/// Returns the weight of those labels whose rooms one building of a domain has together, at most.
fn in_one_building(domain: &Domain, meanings: &[Option<Match>], weights: &[f64]) -> f64 {
    let share = |rooms: BTreeSet<&str>| -> f64 {
        let here = |m: &Match| {
            let id = &domain.room_types[m.at].id;
            rooms.contains(id.as_str()) || domain.circulation.room_type == *id
        };
        let known = meanings.iter().zip(weights).filter_map(|(m, w)| m.filter(here).map(|m| m.grade * w));
        known.sum()
    };
    domain.programs.iter().map(|p| share(rooms_of(p))).fold(0.0, f64::max)
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
