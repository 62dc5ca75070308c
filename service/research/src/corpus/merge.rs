//! Documents merged by address, equal rules of one place merged; nothing here depends on the order of its input.

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::knowledge::CONFIDENCES;

use super::record::{ConstraintRecord, DocumentRecord};
use super::{Corpus, CorpusConstraint, CorpusDocument, SiFigure, canonical_url, si};
use crate::synthesis::slug::{hash, slug};

/// Longest readable part of an id, in bytes.
const ID_WORDS: usize = 40;

/// Returns the corpus of what was found; rules of documents that are not listed are left out.
pub fn merge(
    domain: &str,
    date: &str,
    generated_by: &str,
    documents: &[DocumentRecord],
    constraints: &[ConstraintRecord],
) -> Corpus {
    let (documents, ids) = merge_documents(documents);
    let place: BTreeMap<&str, Option<&str>> =
        documents.iter().map(|d| (d.document_id.as_str(), d.jurisdiction.as_deref())).collect();
    let mut groups: BTreeMap<String, Vec<(SiFigure, ConstraintRecord)>> = BTreeMap::new();
    for constraint in constraints.iter().filter(|c| !constraints.iter().any(|other| narrows(other, c))) {
        let Some(id) = ids.get(constraint.evidence.document_id.as_str()) else { continue };
        let mut constraint = constraint.clone();
        constraint.evidence.document_id.clone_from(id);
        let figure = si(&constraint.value, &constraint.unit, &constraint.name);
        let jurisdiction = place.get(id.as_str()).copied().flatten().unwrap_or_default();
        groups.entry(key(jurisdiction, &figure, &constraint)).or_default().push((figure, constraint));
    }
    let mut merged: Vec<CorpusConstraint> = groups
        .into_iter()
        .filter_map(|(key, group)| {
            let id = group.first().map(|g| g.1.evidence.document_id.clone())?;
            let jurisdiction = place.get(id.as_str()).copied().flatten().map(str::to_owned);
            merge_group(&key, jurisdiction, group)
        })
        .collect();
    merged.sort_by(|a, b| a.constraint_id.cmp(&b.constraint_id));
    Corpus {
        version: 1,
        domain: domain.to_owned(),
        date: date.to_owned(),
        generated_by: generated_by.to_owned(),
        documents,
        constraints: merged,
    }
}

/// Finder of the patterns; any other is a model.
const BY_PATTERN: &str = "rules";

/// Returns true where a model read in the same words what a pattern read too widely: a double patient room is not every
/// patient room.
fn narrows(model: &ConstraintRecord, pattern: &ConstraintRecord) -> bool {
    let (m, p) = (&model.evidence, &pattern.evidence);
    let same_words = m.document_id == p.document_id
        && m.passage_id == p.passage_id
        && m.span[0] < p.span[1]
        && p.span[0] < m.span[1];
    let same_figure = || {
        let of = |c: &ConstraintRecord| si(&c.value, &c.unit, &c.name).key();
        model.constraint_type == pattern.constraint_type && of(model) == of(pattern)
    };
    let words = |c: &ConstraintRecord| -> BTreeSet<String> {
        let said = [c.space.as_str()].into_iter().chain(c.conditions.iter().map(String::as_str));
        let words = said.flat_map(|s| s.split(|c: char| !c.is_alphanumeric()));
        words.filter(|w| !w.is_empty()).map(str::to_lowercase).collect()
    };
    let by_both = model.found_by != BY_PATTERN && pattern.found_by == BY_PATTERN;
    let narrower = || {
        let (own, wide) = (words(model), words(pattern));
        own.len() > wide.len() && wide.is_subset(&own)
    };
    by_both && same_words && same_figure() && narrower()
}

/// Returns the documents by id, and the id of each record's document.
fn merge_documents(records: &[DocumentRecord]) -> (Vec<CorpusDocument>, BTreeMap<&str, String>) {
    let mut groups: BTreeMap<String, Vec<(Option<String>, &DocumentRecord)>> = BTreeMap::new();
    for record in records {
        let url = record.url.as_deref().and_then(canonical_url);
        let identity = url.clone().unwrap_or_else(|| record.document_id.clone());
        groups.entry(identity).or_default().push((url, record));
    }
    let mut ids = BTreeMap::new();
    let mut documents: Vec<CorpusDocument> = groups
        .into_values()
        .filter_map(|mut group| {
            // A page that was read knows more of itself than what was quoted of it.
            group.sort_by(|a, b| order(a.1).cmp(&order(b.1)));
            let (url, first) = group.first()?;
            let document_id = url.as_deref().map_or_else(|| first.document_id.clone(), document_id_of_url);
            for (_, record) in &group {
                ids.insert(record.document_id.as_str(), document_id.clone());
            }
            let known = |field: fn(&DocumentRecord) -> Option<&String>| group.iter().find_map(|g| field(g.1)).cloned();
            Some(CorpusDocument {
                document_id,
                url: url.clone(),
                read_from: group.iter().map(|g| g.1.source.clone()).collect::<BTreeSet<_>>().into_iter().collect(),
                title: known(|r| r.title.as_ref()),
                publisher: known(|r| r.publisher.as_ref()),
                edition: known(|r| r.edition.as_ref()),
                jurisdiction: known(|r| r.jurisdiction.as_ref()),
                source_type: known(|r| r.source_type.as_ref()),
                language: first.language.clone(),
                retrieved_at: group.iter().map(|g| g.1.retrieved_at.clone()).max().unwrap_or_default(),
                quoted_only: group.iter().all(|g| g.1.quoted_only),
            })
        })
        .collect();
    documents.sort_by(|a, b| a.document_id.cmp(&b.document_id));
    (documents, ids)
}

fn order(record: &DocumentRecord) -> (bool, &str, &str) {
    (record.quoted_only, &record.source, &record.document_id)
}

/// Returns the id of a document with an address.
pub fn document_id_of_url(url: &str) -> String {
    let words = url.trim_start_matches("https://").trim_start_matches("www.");
    format!("{}_{}", slug(words, ID_WORDS), hash(url))
}

/// Returns what makes two rules one.
fn key(jurisdiction: &str, figure: &SiFigure, constraint: &ConstraintRecord) -> String {
    let plain = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ").to_lowercase();
    let conditions: BTreeSet<String> = constraint.conditions.iter().map(|c| plain(c)).collect();
    let parts = [
        jurisdiction.to_owned(),
        constraint.name.clone(),
        constraint.constraint_type.clone(),
        figure.key(),
        constraint.basis.clone(),
        constraint.space.clone(),
        conditions.into_iter().collect::<Vec<_>>().join("; "),
    ];
    parts.join("\n")
}

fn merge_group(
    key: &str,
    jurisdiction: Option<String>,
    mut group: Vec<(SiFigure, ConstraintRecord)>,
) -> Option<CorpusConstraint> {
    // A figure that was printed in SI units is exact.
    group.sort_by(|a, b| {
        let order = |g: &(SiFigure, ConstraintRecord)| (g.0.original.clone(), g.1.evidence.clone());
        order(a).cmp(&order(b))
    });
    let (figure, first) = group.first()?.clone();
    let words = if first.space.is_empty() { first.name.clone() } else { format!("{}_{}", first.space, first.name) };
    let place = jurisdiction.as_deref().unwrap_or("zz");
    let rank = |c: &str| CONFIDENCES.iter().position(|known| *known == c).unwrap_or(CONFIDENCES.len());
    let mut topics: Vec<&String> = group.iter().filter_map(|g| g.1.topic.as_ref()).collect();
    topics.sort_unstable();
    Some(CorpusConstraint {
        constraint_id: format!("{}_{}_{}", slug(place, 8), slug(&words, ID_WORDS), hash(key)),
        jurisdiction,
        name: first.name,
        constraint_type: first.constraint_type,
        value: figure.value,
        unit: figure.unit,
        basis: first.basis,
        space: first.space,
        conditions: first.conditions,
        confidence: group.iter().map(|g| g.1.confidence.clone()).min_by_key(|c| rank(c))?,
        topic: topics.first().map(|t| (*t).clone()),
        original_value: figure.original,
        found_by: group.iter().map(|g| g.1.found_by.clone()).collect::<BTreeSet<_>>().into_iter().collect(),
        evidence: group.iter().map(|g| g.1.evidence.clone()).collect::<BTreeSet<_>>().into_iter().collect(),
    })
}

#[cfg(test)]
mod tests {
    use d3dgen_model::document::Document;
    use d3dgen_model::knowledge::Value;

    use super::*;
    use crate::corpus::record::Evidence;

    fn document(id: &str, url: Option<&str>, jurisdiction: Option<&str>) -> DocumentRecord {
        DocumentRecord {
            document_id: id.into(),
            source: format!("{id}.html"),
            url: url.map(str::to_owned),
            sha256: String::new(),
            title: None,
            publisher: None,
            edition: None,
            jurisdiction: jurisdiction.map(str::to_owned),
            source_type: None,
            language: "en".into(),
            retrieved_at: "2026-11-21".into(),
            quoted_only: false,
            warnings: Vec::new(),
        }
    }

    fn rule(document_id: &str, value: f64, unit: &str, conditions: &[&str]) -> ConstraintRecord {
        ConstraintRecord {
            name: "width".into(),
            constraint_type: "minimum".into(),
            value: Value::Number(value),
            unit: unit.into(),
            basis: String::new(),
            space: "corridor".into(),
            conditions: conditions.iter().map(|c| (*c).to_owned()).collect(),
            confidence: "medium".into(),
            topic: None,
            found_by: "rules".into(),
            evidence: Evidence {
                document_id: document_id.into(),
                source: format!("{document_id}.html"),
                passage_id: "p1".into(),
                page: None,
                span: [0, 3],
                quote: "xyz".into(),
                printed: format!("{value} {unit}"),
            },
        }
    }

    fn corpus(documents: &[DocumentRecord], rules: &[ConstraintRecord]) -> Corpus {
        let corpus = merge("office", "2026-11-21", "test", documents, rules);
        assert_eq!(corpus.check(), Vec::new());
        corpus
    }

    #[test]
    fn copies_of_a_page_are_one_document() {
        let documents = [
            document("a", Some("http://example.org/rules/?utm_source=x"), None),
            document("b", Some("https://example.org/rules#s2"), Some("DE")),
            document("c", None, None),
        ];
        let corpus = corpus(&documents, &[]);
        assert_eq!(corpus.documents.len(), 2);
        let page = corpus.documents.iter().find(|d| d.url.is_some()).unwrap();
        assert_eq!((page.read_from.len(), page.jurisdiction.as_deref()), (2, Some("DE")));
    }

    #[test]
    fn equal_rules_are_one_with_all_their_evidence() {
        let documents =
            [document("a", None, Some("DE")), document("b", None, Some("DE")), document("c", None, Some("AT"))];
        let rules = [
            rule("a", 1.5, "m", &[]),
            rule("b", 150.0, "cm", &[]),
            rule("b", 1.5, "m", &["where beds are moved"]),
            rule("c", 1.5, "m", &[]),
            rule("a", 1.6, "m", &[]),
        ];
        let merged = corpus(&documents, &rules);
        assert_eq!(merged.constraints.len(), 4, "{merged:#?}");
        let both = merged.constraints.iter().find(|c| c.evidence.len() == 2).unwrap();
        assert_eq!((both.original_value.as_deref(), both.unit.as_str()), (None, "m"));
        let mut backwards = rules.to_vec();
        backwards.reverse();
        let mut shuffled = documents.to_vec();
        shuffled.rotate_left(1);
        assert_eq!(corpus(&shuffled, &backwards), merged);
    }

    #[test]
    fn a_narrower_reading_of_the_same_words_wins() {
        let documents = [document("a", None, Some("DE"))];
        let wide = ConstraintRecord { space: "patient_room".into(), ..rule("a", 24.0, "m", &[]) };
        let double = ConstraintRecord { space: "patient_room_double".into(), found_by: "model".into(), ..wide.clone() };
        let conditioned =
            ConstraintRecord { conditions: vec!["two beds".into()], found_by: "model".into(), ..wide.clone() };
        let elsewhere = ConstraintRecord {
            evidence: Evidence { passage_id: "p2".into(), ..double.evidence.clone() },
            ..double.clone()
        };
        let other = ConstraintRecord { value: Value::Number(20.0), ..double.clone() };
        for (model, left) in [(&double, 1), (&conditioned, 1), (&elsewhere, 2), (&other, 2)] {
            let merged = corpus(&documents, &[wide.clone(), model.clone()]);
            assert_eq!(merged.constraints.len(), left, "{merged:#?}");
            assert!(merged.constraints.iter().any(|c| c.found_by == ["model"]), "{merged:#?}");
        }
    }

    #[test]
    fn what_no_building_has_is_kept_apart() {
        let documents = [document("a", None, Some("DE"))];
        let planted = [rule("a", 99.0, "m", &[]), rule("a", -5.0, "m", &[]), rule("a", 1.5, "m", &[])];
        let (kept, apart) = corpus(&documents, &planted).without_doubtful();
        assert_eq!((kept.constraints.len(), apart.len()), (1, 2), "{apart:?}");
    }

    #[test]
    fn ids_do_not_depend_on_other_documents() {
        let documents = [document("a", None, Some("DE")), document("b", None, Some("DE"))];
        let alone = corpus(&documents[..1], &[rule("a", 1.5, "m", &[])]);
        let more = corpus(&documents, &[rule("a", 1.5, "m", &[]), rule("b", 1.5, "m", &[]), rule("b", 1.2, "m", &[])]);
        assert!(more.constraints.iter().any(|c| c.constraint_id == alone.constraints[0].constraint_id));
    }
}
