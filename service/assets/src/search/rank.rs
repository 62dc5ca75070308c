//! How well an asset that was found fits the question, and why.

use std::collections::BTreeSet;

use d3dgen_store::index::Hit;

use super::question::Question;
use super::{Found, SearchQuery};
use crate::annotation::{Annotation, Origin};
use crate::catalog::{Catalog, CatalogObject};
use crate::plausibility::misfit;
use crate::words;

/// Constant of the reciprocal ranks; small, for the first places to count.
const K: f64 = 10.0;
const BY_WORDS: f64 = 5.0;
const BY_MEANING: f64 = 5.0;
/// A name of the asset that is the head of the question.
const NAMED: f64 = 0.55;
/// Share of the telling words that the asset explains.
const EXPLAINED: f64 = 0.45;
const SIMILAR: f64 = 0.5;
const ROOM: f64 = 0.12;
const ASKED_ROOM: f64 = 0.2;
const DOMAIN: f64 = 0.1;
const LOOK: f64 = 0.15;
const SIZE: f64 = 0.5;

/// Returns what counts as one thing where sizes of one object are shown once.
pub(super) fn group(a: &Annotation) -> String {
    match (&a.origin, &a.object) {
        (Origin::Library { .. }, Some(object)) => format!("library {object}"),
        _ => a.asset_id.clone(),
    }
}

/// Scores an asset and says why.
pub(super) fn judge(a: Annotation, hit: &Hit, question: &Question, query: &SearchQuery, catalog: &Catalog) -> Found {
    let object = a.object.as_deref().and_then(|o| catalog.object(o));
    let mut reasons = Vec::new();
    let rank = |rank: Option<usize>, weight: f64| rank.map_or(0.0, |r| weight / (K + r as f64));
    let mut score = rank(hit.text_rank, BY_WORDS) + rank(hit.vector_rank, BY_MEANING);
    if let Some(similarity) = hit.similarity {
        score += SIMILAR * f64::from(similarity.max(0.0));
        if similarity > 0.45 {
            reasons.push(format!("means much the same ({similarity:.2})"));
        }
    }
    if let Some((weight, name)) = named(question, &a, object) {
        score += NAMED * weight;
        reasons.push(format!("is called {name}"));
    }
    let explained = explained(question, &a, object, catalog);
    score += EXPLAINED * explained.len() as f64 / question.words.len().max(1) as f64;
    if !explained.is_empty() {
        reasons.push(format!("has the words {}", explained.join(", ")));
    }
    score += place(&a, question, query, catalog, &mut reasons);
    let look = a.palette.first().is_some_and(|s| question.colors.contains(&s.name))
        || a.materials.iter().any(|m| question.materials.contains(m));
    if look {
        score += LOOK;
        reasons.push("has the color or material asked for".to_owned());
    }
    if let Some(wanted) = query.size_m {
        let off = misfit(a.size_m, wanted);
        score += SIZE * (1.0 - off).max(-1.0);
        reasons.push(format!("its size is {:.0} % off", (off.exp() - 1.0) * 100.0));
    }
    Found { annotation: a, score, reasons }
}

/// Returns how much of the question one name of the asset is, and that name: the whole head counts fully.
fn named(question: &Question, a: &Annotation, object: Option<&CatalogObject>) -> Option<(f64, String)> {
    let own = Question::plain(&a.name).words;
    let head = question.words.get(..question.head).unwrap_or_default();
    let terms = object.map(CatalogObject::terms).unwrap_or_default();
    let mut best: Option<(f64, String)> = None;
    for (place, term) in std::iter::once(&own).chain(terms).enumerate() {
        let whole = term.concat();
        let together = |from: &[String]| {
            let have: BTreeSet<&str> = from.iter().map(String::as_str).collect();
            !term.is_empty() && term.iter().all(|w| have.contains(w.as_str()))
                || from.contains(&whole)
                || from.windows(2).any(|p| p.concat() == whole)
        };
        let share = |from: &[String]| (term.len() as f64 / from.len().max(1) as f64).min(1.0);
        // Other names are a little less sure than its own.
        let sure = if place < 3 { 1.0 } else { 0.92 };
        let weight = if term.len() == question.words.len() && together(&question.words) {
            sure
        } else if together(head) {
            let ends = head.last().is_some_and(|last| term.last() == Some(last) || *last == whole);
            sure * share(head) * if ends { 1.0 } else { 0.6 }
        } else if together(&question.words) {
            0.35 * sure * share(&question.words)
        } else {
            continue;
        };
        if best.as_ref().is_none_or(|(b, _)| weight > *b) {
            best = Some((weight, term.join(" ")));
        }
    }
    best
}

/// Returns the telling words of the question that the asset's names, purpose, tags or rooms have.
fn explained(question: &Question, a: &Annotation, object: Option<&CatalogObject>, catalog: &Catalog) -> Vec<String> {
    let mut own: BTreeSet<String> = BTreeSet::new();
    let mut add = |text: &str| own.extend(words::split(text).iter().map(|w| words::singular(w)));
    add(&a.name);
    add(&a.kind);
    a.tags.iter().chain(&a.affordances).chain(&a.materials).for_each(|t| add(t));
    let known = object.filter(|o| o.room_types == a.room_types);
    if known.is_none() {
        a.room_types.iter().filter_map(|r| catalog.room_label(r)).for_each(&mut add);
    }
    if object.is_none() {
        add(&a.description);
    }
    let none = BTreeSet::new();
    let sets = [&own, object.map_or(&none, CatalogObject::words), known.map_or(&none, CatalogObject::room_words)];
    let alike = |word: &String| {
        sets.iter().any(|set| set.contains(word))
            || word.len() >= 4 && sets.iter().any(|set| set.iter().any(|h| h.len() >= 4 && same_stem(word, h)))
    };
    question.words.iter().filter(|w| alike(w)).cloned().collect()
}

/// Tells whether two words differ only in their ending: `store` and `storage`, `cook` and `cooking`.
fn same_stem(a: &str, b: &str) -> bool {
    let common = a.bytes().zip(b.bytes()).take_while(|(x, y)| x == y).count();
    common >= 4 && a.len() - common <= 3 && b.len() - common <= 3
}

/// Scores rooms and domain.
fn place(
    a: &Annotation,
    question: &Question,
    query: &SearchQuery,
    catalog: &Catalog,
    reasons: &mut Vec<String>,
) -> f64 {
    let mut score = 0.0;
    if let Some(room) = a.room_types.iter().find(|r| question.room_types.contains(*r)) {
        score += ROOM;
        reasons.push(format!("belongs in {}", catalog.room_label(room).unwrap_or(room).to_lowercase()));
    }
    if let Some(room) = query.room_type.as_ref().filter(|r| a.room_types.contains(r)) {
        score += ASKED_ROOM;
        reasons.push(format!("belongs in {}", catalog.room_label(room).unwrap_or(room).to_lowercase()));
    }
    if let Some(domain) = query.domain.as_ref().filter(|d| a.domains.contains(d)) {
        score += DOMAIN;
        reasons.push(format!("is of domain {domain}"));
    }
    score
}
