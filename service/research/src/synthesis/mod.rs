//! A knowledge base out of a corpus: deterministic, with ids that other documents do not change, every rule with its source.
//!
//! What it is not for: judging rules. It changes no figure, and what is not known stays unknown: jurisdiction `ZZ` applies
//! nowhere until `sources.toml` says better.

pub mod slug;
mod vocabulary;

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::document::Document;
use d3dgen_model::knowledge::{CONFIDENCES, Constraint, KnowledgeBase, Metadata, Reference, Source};

use crate::Error;
use crate::corpus::{Corpus, CorpusConstraint, CorpusDocument};
use slug::{slug, whole_slug};
pub use vocabulary::{Topic, source_type, source_type_of_host, source_types, topics};
use vocabulary::{Traits, rank_and_confidence, space_type};

/// Code for places nobody has named; ISO 3166 leaves it to users, and no building stands there.
pub const UNKNOWN_PLACE: &str = "ZZ";
/// Longest readable part of a reference's id, in bytes.
const TITLE_WORDS: usize = 48;
/// Longest quotation in a note, in characters.
const QUOTE: usize = 240;
const UNKNOWN: &str = "unknown";

/// Returns the knowledge base of a corpus.
///
/// # Errors
/// `Document` when the result breaks the rules of knowledge bases: an edited corpus can hold what they refuse.
pub fn synthesize(corpus: &Corpus) -> Result<KnowledgeBase, Error> {
    let documents: BTreeMap<&str, &CorpusDocument> =
        corpus.documents.iter().map(|d| (d.document_id.as_str(), d)).collect();
    let ref_ids: BTreeMap<&str, String> =
        documents.iter().map(|(id, d)| (*id, reference_id(&corpus.domain, d))).collect();
    let mut references: BTreeMap<&str, (BTreeSet<&str>, Vec<Constraint>)> = BTreeMap::new();
    for constraint in &corpus.constraints {
        // A rule lives with the most binding of its sources and cites the others as well.
        let ids: BTreeSet<&str> = constraint.evidence.iter().map(|e| e.document_id.as_str()).collect();
        let mut cited: Vec<&CorpusDocument> = ids.iter().filter_map(|id| documents.get(id).copied()).collect();
        cited.sort_by_key(|d| (rank_and_confidence(d.source_type.as_deref()).0, ref_ids.get(d.document_id.as_str())));
        let Some(home) = cited.first().and_then(|d| ref_ids.get(d.document_id.as_str())) else { continue };
        let (sources, constraints) = references.entry(home).or_default();
        sources.extend(cited.iter().map(|d| d.document_id.as_str()));
        constraints.push(constraint_of(&corpus.domain, constraint, &cited));
    }
    let references = references
        .into_iter()
        .map(|(id, (sources, constraints))| {
            let sources: Vec<&CorpusDocument> = sources.iter().filter_map(|s| documents.get(s).copied()).collect();
            reference(&corpus.domain, id, sources, &ref_ids, constraints)
        })
        .collect();
    let knowledge = KnowledgeBase { metadata: metadata(corpus), references };
    let value = serde_json::to_value(&knowledge).expect("knowledge bases hold only finite numbers and string keys");
    KnowledgeBase::from_value(value).map_err(|e| Error::of_document("knowledge.json", e))
}

/// Returns the id of the reference a document belongs to: editions of one standard in one place are one reference.
fn reference_id(domain: &str, document: &CorpusDocument) -> String {
    let place = slug(document.jurisdiction.as_deref().unwrap_or(UNKNOWN_PLACE), 8);
    let Some(title) = document.title.as_deref().filter(|t| !slug(t, 8).is_empty()) else {
        return format!("{domain}_{place}_{}", document.document_id);
    };
    let edition = document.edition.as_deref().map_or_else(|| UNKNOWN.to_owned(), |e| whole_slug(e, 12));
    format!("{domain}_{place}_{}_{edition}", whole_slug(title, TITLE_WORDS))
}

fn reference(
    domain: &str,
    ref_id: &str,
    mut sources: Vec<&CorpusDocument>,
    ref_ids: &BTreeMap<&str, String>,
    mut constraints: Vec<Constraint>,
) -> Reference {
    let own = |d: &CorpusDocument| ref_ids.get(d.document_id.as_str()).is_some_and(|id| id == ref_id);
    sources.sort_by_key(|d| (!own(d), rank_and_confidence(d.source_type.as_deref()).0, d.document_id.as_str()));
    constraints.sort_by(|a, b| a.constraint_id.cmp(&b.constraint_id));
    let retrieved = sources.iter().filter(|d| own(d)).map(|d| d.retrieved_at.clone()).max();
    Reference {
        ref_id: ref_id.to_owned(),
        building_type: domain.to_owned(),
        jurisdiction: sources.first().and_then(|d| d.jurisdiction.clone()).unwrap_or_else(|| UNKNOWN_PLACE.to_owned()),
        retrieved_at: retrieved.unwrap_or_default(),
        sources: sources.into_iter().map(source).collect(),
        constraints,
    }
}

fn source(document: &CorpusDocument) -> Source {
    let or_unknown = |field: &Option<String>| field.clone().unwrap_or_else(|| UNKNOWN.to_owned());
    let read_from = || document.read_from.first().cloned().unwrap_or_else(|| document.document_id.clone());
    Source {
        source_id: document.document_id.clone(),
        title: document.title.clone().unwrap_or_else(read_from),
        publisher: or_unknown(&document.publisher),
        edition_or_year: or_unknown(&document.edition),
        url: document.url.clone(),
        source_type: document.source_type.clone().unwrap_or_else(|| "web_page".to_owned()),
    }
}

fn constraint_of(domain: &str, found: &CorpusConstraint, cited: &[&CorpusDocument]) -> Constraint {
    let (space, said_by_space) = space_type(domain, &found.space);
    let name = if found.space.is_empty() || found.name.starts_with(&found.space) {
        found.name.clone()
    } else {
        format!("{}_{}", found.space, found.name)
    };
    let words: Vec<&str> = found.evidence.iter().map(|e| e.quote.as_str()).collect();
    let words = words.join("\n");
    let per = found.basis.strip_prefix("per_").unwrap_or_default();
    let traits = Traits { name: &found.name, spaces: [&found.space, space], unit: &found.unit, per, words: &words };
    let own_basis = !found.basis.is_empty() && per.is_empty();
    let mut conditions = found.conditions.clone();
    conditions.extend(said_by_space.map(str::to_owned));
    let page_read = cited.iter().any(|d| !d.quoted_only);
    Constraint {
        constraint_id: format!("{domain}_{}", found.constraint_id),
        name,
        topic: found.topic.clone().unwrap_or_else(|| traits.topic().to_owned()),
        constraint_type: found.constraint_type.clone(),
        value: found.value.clone(),
        unit: found.unit.clone(),
        measurement_basis: if own_basis { found.basis.clone() } else { traits.basis() },
        space_type: space.to_owned(),
        conditions,
        confidence: confidence(found, cited).to_owned(),
        verified: if page_read { "seen" } else { "partly_seen" }.to_owned(),
        original_value: found.original_value.clone(),
        note: note(found),
        source_ids: cited.iter().map(|d| d.document_id.clone()).collect(),
        seen_at: found.evidence.first().map(|e| e.source.clone()),
        clause: None,
        quotation: None,
        in_force_from: None,
        in_force_until: None,
        superseded_by: None,
    }
}

/// Returns the least of what the words, the kind of source and the way of finding allow.
fn confidence(found: &CorpusConstraint, cited: &[&CorpusDocument]) -> &'static str {
    let index = |word: &str| CONFIDENCES.iter().position(|c| *c == word).unwrap_or(CONFIDENCES.len() - 1);
    let by_source = cited.first().map_or("low", |d| rank_and_confidence(d.source_type.as_deref()).1);
    let only_quoted = cited.iter().all(|d| d.quoted_only);
    let only_model = found.found_by.iter().all(|f| f != "rules");
    let by_way = if only_quoted || only_model { "medium" } else { "high" };
    let least = index(&found.confidence).max(index(by_source)).max(index(by_way));
    CONFIDENCES.get(least).copied().unwrap_or("low")
}

/// Returns the quoted sentence and where it stands.
fn note(found: &CorpusConstraint) -> String {
    let Some(first) = found.evidence.first() else { return String::new() };
    let mut quote: String = first.quote.split_whitespace().collect::<Vec<_>>().join(" ");
    if let Some((at, _)) = quote.char_indices().nth(QUOTE) {
        quote.truncate(at);
        quote.push('…');
    }
    let page = first.page.map_or_else(String::new, |p| format!(", page {p}"));
    let more = match found.evidence.len() - 1 {
        0 => String::new(),
        1 => "; one more place says so".to_owned(),
        n => format!("; {n} more places say so"),
    };
    format!("\"{quote}\" ({}{page}, {}){more}", first.source, first.passage_id)
}

fn metadata(corpus: &Corpus) -> Metadata {
    let mut notes = vec![
        "Figures in SI units; original_value keeps the printed figure. The note of a rule quotes the sentence it was read in."
            .to_owned(),
        "Kinds of source are those the documents or sources.toml name; where nothing does, a page counts as web_page, which \
         makes no rule mandatory."
            .to_owned(),
    ];
    let missing = [
        ("jurisdiction", corpus.documents.iter().filter(|d| d.jurisdiction.is_none()).count()),
        ("title", corpus.documents.iter().filter(|d| d.title.is_none()).count()),
        ("publisher", corpus.documents.iter().filter(|d| d.publisher.is_none()).count()),
        ("edition", corpus.documents.iter().filter(|d| d.edition.is_none()).count()),
        ("kind of source", corpus.documents.iter().filter(|d| d.source_type.is_none()).count()),
    ];
    for (what, count) in missing.into_iter().filter(|m| m.1 > 0) {
        let place = if what == "jurisdiction" { "; their rules have ZZ and apply nowhere" } else { "" };
        notes.push(format!("Not known: {what} of {count} of {} documents{place}.", corpus.documents.len()));
    }
    Metadata {
        version: 1,
        domain: corpus.domain.clone(),
        uses: Vec::new(),
        generated_by: corpus.generated_by.clone(),
        date: corpus.date.clone(),
        notes,
    }
}

#[cfg(test)]
mod tests;
