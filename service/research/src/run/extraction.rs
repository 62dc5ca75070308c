//! Rules out of passages, without a language model.

use std::collections::BTreeMap;

use crate::corpus::record::{ConstraintRecord, DocumentRecord, Evidence, PassageRecord};
use crate::extract::{Extractor, Finding};

/// Headings that are read with a passage: the nearest ones say what a bare sentence is about.
const HEADINGS: usize = 2;
/// How rules found here are marked.
pub const RULES: &str = "rules";

/// Returns the rules of passages in their order; passages of documents that are not listed are read as of no language.
pub fn constraints(documents: &[DocumentRecord], passages: &[PassageRecord]) -> Vec<ConstraintRecord> {
    let by_id: BTreeMap<&str, &DocumentRecord> = documents.iter().map(|d| (d.document_id.as_str(), d)).collect();
    let extractor = Extractor::shared();
    passages.iter().flat_map(|p| of_passage(&extractor, by_id.get(p.document_id.as_str()).copied(), p)).collect()
}

fn of_passage(
    extractor: &Extractor,
    document: Option<&DocumentRecord>,
    passage: &PassageRecord,
) -> Vec<ConstraintRecord> {
    let skipped = passage.heading.len().saturating_sub(HEADINGS);
    let mut text: String = passage.heading.iter().skip(skipped).map(|h| format!("{}\n\n", h.trim())).collect();
    let lead = text.len();
    text += &passage.text;
    let language = document.map_or("", |d| d.language.as_str());
    let source = document.map_or("", |d| d.source.as_str());
    // A passage that names its space itself is not overruled by its heading.
    let alone = extractor.extract(&passage.text, language);
    let own_space = |f: &Finding| {
        let same =
            alone.iter().find(|a| a.printed.start + lead == f.printed.start && a.constraint.name == f.constraint.name);
        same.map(|a| a.constraint.space.clone()).filter(|s| !s.is_empty())
    };
    extractor
        .extract(&text, language)
        .into_iter()
        .filter(|f| f.evidence.start >= lead && f.printed.start >= lead)
        .filter_map(|mut f| {
            if let Some(space) = own_space(&f) {
                f.constraint.space = space;
            }
            record(f, &text, lead, source, passage)
        })
        .collect()
}

fn record(
    finding: Finding,
    text: &str,
    lead: usize,
    source: &str,
    passage: &PassageRecord,
) -> Option<ConstraintRecord> {
    let found = finding.constraint;
    let (unit, basis) = split_basis(&found.unit);
    Some(ConstraintRecord {
        name: found.name,
        constraint_type: found.constraint_type.name().to_owned(),
        value: found.value,
        unit,
        basis,
        space: found.space,
        conditions: found.conditions,
        confidence: found.confidence.name().to_owned(),
        topic: passage.topic.clone(),
        found_by: RULES.to_owned(),
        evidence: Evidence {
            document_id: passage.document_id.clone(),
            source: source.to_owned(),
            passage_id: passage.passage_id.clone(),
            page: passage.page,
            span: [finding.evidence.start - lead, finding.evidence.end - lead],
            quote: text.get(finding.evidence.clone())?.trim().to_owned(),
            printed: text.get(finding.printed.clone())?.trim().to_owned(),
        },
    })
}

/// Parts `m^2/person` into unit and basis; `m/s` stays one unit.
fn split_basis(unit: &str) -> (String, String) {
    let thing = unit.rsplit_once('/').filter(|(plain, thing)| {
        !plain.is_empty() && thing.len() > 2 && thing.bytes().all(|b| b.is_ascii_lowercase() || b == b'_')
    });
    match thing.filter(|(_, thing)| *thing != "min") {
        Some((plain, thing)) => (plain.to_owned(), format!("per_{thing}")),
        None => (unit.to_owned(), String::new()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn passage(heading: &[&str], text: &str) -> PassageRecord {
        PassageRecord {
            passage_id: "p1".into(),
            document_id: "d".into(),
            heading: heading.iter().map(|h| (*h).to_owned()).collect(),
            kind: "prose".into(),
            page: None,
            topic: None,
            text: text.into(),
        }
    }

    #[test]
    fn the_span_is_the_quoted_sentence_in_the_passage() {
        let text = "This part is about doors. Doors shall be at least 0.9 m wide. It ends here.";
        let found = constraints(&[], &[passage(&["4 Doors"], text)]);
        assert_eq!(found.len(), 1, "{found:?}");
        let evidence = &found[0].evidence;
        assert_eq!(text.get(evidence.span[0]..evidence.span[1]).unwrap().trim(), evidence.quote);
        assert_eq!(
            (evidence.quote.as_str(), evidence.printed.as_str()),
            ("Doors shall be at least 0.9 m wide.", "0.9 m")
        );
    }

    #[test]
    fn a_heading_says_what_a_sentence_is_about_and_is_no_rule_itself() {
        let found =
            constraints(&[], &[passage(&["Corridors at least 9 m long"], "The clear width must be at least 1.5 m.")]);
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(found[0].space, "corridor");
    }

    #[test]
    fn what_a_figure_is_given_for_is_not_its_unit() {
        for (unit, expected) in [
            ("m^2/person", ("m^2", "per_person")),
            ("L/s/person", ("L/s", "per_person")),
            ("m/s", ("m/s", "")),
            ("m^3/h", ("m^3/h", "")),
            ("count/bed", ("count", "per_bed")),
            ("W/m^2", ("W/m^2", "")),
        ] {
            let (plain, basis) = split_basis(unit);
            assert_eq!((plain.as_str(), basis.as_str()), expected);
        }
    }
}
