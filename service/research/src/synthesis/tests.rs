use d3dgen_model::knowledge::{KnowledgeBase, Value};

use super::*;
use crate::corpus::record::Evidence;

fn document(id: &str, title: Option<&str>, jurisdiction: Option<&str>, kind: Option<&str>) -> CorpusDocument {
    CorpusDocument {
        document_id: id.into(),
        url: Some(format!("https://example.org/{id}")),
        read_from: vec![format!("{id}.html")],
        title: title.map(str::to_owned),
        publisher: Some("Ministry".into()),
        edition: Some("2024".into()),
        jurisdiction: jurisdiction.map(str::to_owned),
        source_type: kind.map(str::to_owned),
        language: "en".into(),
        retrieved_at: "2026-11-21".into(),
        quoted_only: false,
    }
}

fn rule(id: &str, documents: &[&str], confidence: &str) -> CorpusConstraint {
    let evidence = |document_id: &&str| Evidence {
        document_id: (*document_id).to_owned(),
        source: format!("{document_id}.html"),
        passage_id: "p3".into(),
        page: Some(2),
        span: [0, 10],
        quote: "Corridors shall be at least 150 cm wide.".into(),
        printed: "150 cm".into(),
    };
    CorpusConstraint {
        constraint_id: id.into(),
        jurisdiction: Some("DE".into()),
        name: "width".into(),
        constraint_type: "minimum".into(),
        value: Value::Number(1.5),
        unit: "m".into(),
        basis: String::new(),
        space: "corridor".into(),
        conditions: Vec::new(),
        confidence: confidence.into(),
        topic: None,
        original_value: Some("150 cm".into()),
        found_by: vec!["rules".into()],
        evidence: documents.iter().map(evidence).collect(),
    }
}

fn corpus(documents: Vec<CorpusDocument>, constraints: Vec<CorpusConstraint>) -> Corpus {
    Corpus {
        version: 1,
        domain: "office".into(),
        date: "2026-11-21".into(),
        generated_by: "test".into(),
        documents,
        constraints,
    }
}

fn knowledge(documents: Vec<CorpusDocument>, constraints: Vec<CorpusConstraint>) -> KnowledgeBase {
    synthesize(&corpus(documents, constraints)).expect("a valid knowledge base")
}

#[test]
fn a_rule_keeps_its_source_its_words_and_its_printed_figure() {
    let base = knowledge(
        vec![document("a", Some("Workplace Rules"), Some("DE"), Some("regulation"))],
        vec![rule("de_corridor_width_1", &["a"], "high")],
    );
    let reference = &base.references[0];
    assert_eq!((reference.ref_id.as_str(), reference.jurisdiction.as_str()), ("office_de_workplace_rules_2024", "DE"));
    let constraint = &reference.constraints[0];
    assert_eq!(constraint.name, "corridor_width");
    assert_eq!((constraint.measurement_basis.as_str(), constraint.verified.as_str()), ("clear_width", "seen"));
    assert_eq!(constraint.original_value.as_deref(), Some("150 cm"));
    assert_eq!(constraint.note, "\"Corridors shall be at least 150 cm wide.\" (a.html, page 2, p3)");
    assert_eq!(constraint.source_ids, ["a"]);
}

#[test]
fn the_most_binding_source_owns_a_rule_and_the_others_are_cited() {
    let base = knowledge(
        vec![
            document("blog", Some("Corridors explained"), Some("DE"), None),
            document("law", Some("Workplace Rules"), Some("DE"), Some("regulation")),
        ],
        vec![rule("c", &["blog", "law"], "high")],
    );
    assert_eq!(base.references.len(), 1);
    assert_eq!(base.references[0].constraints[0].source_ids, ["law", "blog"]);
    assert_eq!(base.references[0].sources[0].source_id, "law");
    assert_eq!(base.references[0].sources[1].source_type, "web_page");
}

#[test]
fn confidence_is_the_least_of_words_and_source() {
    for (kind, words, expected) in [
        (Some("regulation"), "high", "high"),
        (Some("regulation"), "medium", "medium"),
        (Some("guideline"), "high", "medium"),
        (None, "high", "medium"),
        (None, "low", "low"),
    ] {
        let base = knowledge(vec![document("a", None, None, kind)], vec![rule("c", &["a"], words)]);
        assert_eq!(base.references[0].constraints[0].confidence, expected, "{kind:?} {words}");
    }
    let mut quoted = document("a", None, None, Some("regulation"));
    quoted.quoted_only = true;
    let base = knowledge(vec![quoted], vec![rule("c", &["a"], "high")]);
    let constraint = &base.references[0].constraints[0];
    assert_eq!((constraint.confidence.as_str(), constraint.verified.as_str()), ("medium", "partly_seen"));
}

#[test]
fn what_is_not_known_is_said() {
    let base = knowledge(vec![document("a", None, None, None)], vec![rule("c", &["a"], "high")]);
    let reference = &base.references[0];
    assert_eq!((reference.jurisdiction.as_str(), reference.sources[0].title.as_str()), ("ZZ", "a.html"));
    let notes = base.metadata.notes.join("\n");
    for what in ["jurisdiction of 1 of 1 documents; their rules have ZZ", "title of 1", "kind of source of 1"] {
        assert!(notes.contains(what), "{notes}");
    }
}

#[test]
fn ids_do_not_change_when_documents_are_added() {
    let first = document("a", Some("Workplace Rules"), Some("DE"), Some("regulation"));
    let alone = knowledge(vec![first.clone()], vec![rule("c1", &["a"], "high")]);
    let more = knowledge(
        vec![first, document("b", Some("Workplace Rules"), Some("AT"), None), document("z", None, Some("DE"), None)],
        vec![rule("c1", &["a"], "high"), rule("c2", &["b"], "high"), rule("c3", &["z"], "high")],
    );
    assert_eq!(more.references.len(), 3);
    assert!(more.references.iter().any(|r| r == &alone.references[0]));
}
