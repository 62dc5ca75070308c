//! Knowledge bases of others at the door: checked with every problem's path, figures in SI with the printed value kept.
//!
//! What it is not for: storing them (`database`).

use d3dgen_model::knowledge::{Constraint, KnowledgeBase, Value};
use d3dgen_model::plausible::{self, Quarantined};
use d3dgen_model::{Document, Problem, units};
use serde_json::Value as Json;

use crate::error::Error;
use d3dgen_model::expression;

/// A checked knowledge base, and what was done to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Imported {
    /// In SI.
    pub knowledge: KnowledgeBase,
    /// Number of constraints whose figures were converted.
    pub converted: usize,
    /// Rules that cannot mean what they say; `knowledge` is without them.
    pub quarantined: Vec<Quarantined>,
    /// Units that are not known, each once with the id of the first constraint that has it; their figures stay as printed.
    pub unknown_units: Vec<(String, String)>,
}

/// Reads `knowledge.json` or the paper's `rag_data.generated.json`.
///
/// # Errors
/// `Document` with every problem and its path, among them formulas that cannot be evaluated.
pub fn read(text: &str) -> Result<Imported, Error> {
    let mut knowledge = KnowledgeBase::from_json(text)?;
    let problems = formula_problems(&knowledge);
    if !problems.is_empty() {
        return Err(d3dgen_model::Error::Invalid { kind: KnowledgeBase::KIND, problems }.into());
    }
    let (mut converted, mut unknown_units) = (0, Vec::<(String, String)>::new());
    for constraint in knowledge.references.iter_mut().flat_map(|r| &mut r.constraints) {
        match units::conversion(&constraint.unit) {
            Some(to) if to.unit == constraint.unit && to.is_identity() => {}
            Some(to) => converted += usize::from(convert(constraint, &to)),
            None if unknown_units.iter().any(|(unit, _)| *unit == constraint.unit) => {}
            None => unknown_units.push((constraint.unit.clone(), constraint.constraint_id.clone())),
        }
    }
    let quarantined = plausible::quarantine(&mut knowledge);
    Ok(Imported { knowledge, converted, quarantined, unknown_units })
}

/// Returns a problem for every formula that is none; names of quantities are left open, a building gives them figures.
fn formula_problems(knowledge: &KnowledgeBase) -> Vec<Problem> {
    let mut problems = Vec::new();
    for (i, reference) in knowledge.references.iter().enumerate() {
        for (j, constraint) in reference.constraints.iter().enumerate() {
            let Value::Expression { expr } = &constraint.value else { continue };
            // an odd figure, so that no difference of two names is zero by chance only
            if expression::evaluate(expr, &|name| (!name.is_empty()).then_some(1.234_567)).is_none() {
                problems.push(Problem::new(
                    format!("/references/{i}/constraints/{j}/value/expr"),
                    format!("`{expr}` is no formula of figures, names, + - * / ^, brackets and sqrt()"),
                ));
            }
        }
    }
    problems
}

/// Turns a constraint's figures into SI; returns true when figures changed, not only the spelling of the unit.
fn convert(constraint: &mut Constraint, to: &units::Conversion) -> bool {
    let printed = format!("{} {}", constraint.value, constraint.unit);
    constraint.unit.clone_from(&to.unit);
    if to.is_identity() {
        return false;
    }
    if !scale(&mut constraint.value, to) {
        return false;
    }
    constraint.original_value.get_or_insert(printed);
    true
}

/// Turns figures into another unit; returns false for yes and no, which have none.
pub(crate) fn scale(value: &mut Value, to: &units::Conversion) -> bool {
    match value {
        Value::Flag(_) => return false,
        Value::Number(v) => *v = to.apply(*v),
        Value::Range { min, max } => (*min, *max) = (to.apply(*min), to.apply(*max)),
        Value::Expression { expr } if to.offset == 0.0 => *expr = format!("({expr}) * {}", to.factor),
        Value::Expression { expr } => *expr = format!("({expr}) * {} + {}", to.factor, to.offset),
        Value::List(list) => list.iter_mut().for_each(|v| convert_json(v, to)),
        Value::Table(table) => table.values_mut().for_each(|v| convert_json(v, to)),
    }
    true
}

fn convert_json(value: &mut Json, to: &units::Conversion) {
    match value {
        Json::Number(n) => {
            if let Some(figure) = n.as_f64() {
                *value = to.apply(figure).into();
            }
        }
        Json::Array(items) => items.iter_mut().for_each(|v| convert_json(v, to)),
        Json::Object(map) => map.values_mut().for_each(|v| convert_json(v, to)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(value: Json, unit: &str) -> String {
        serde_json::json!({
            "metadata": {"version": 1, "domain": "office", "generated_by": "test", "date": "2026-11-21"},
            "references": [{
                "ref_id": "r", "building_type": "office", "jurisdiction": "US", "retrieved_at": "2026-11-21",
                "sources": [{"source_id": "s", "title": "T", "publisher": "P", "edition_or_year": "2020", "type": "regulation"}],
                "constraints": [{
                    "constraint_id": "c", "name": "n", "topic": "room_size", "constraint_type": "minimum",
                    "value": value, "unit": unit, "measurement_basis": "clear_width", "space_type": "corridor",
                    "confidence": "high", "verified": "seen", "source_ids": ["s"]
                }]
            }]
        })
        .to_string()
    }

    fn constraint(value: Json, unit: &str) -> Constraint {
        read(&text(value, unit)).unwrap_or_else(|e| panic!("{unit}: {e}")).knowledge.references[0].constraints[0]
            .clone()
    }

    #[test]
    fn figures_come_in_si_with_the_printed_value_kept() {
        let c = constraint(36.into(), "in");
        assert_eq!(
            (c.value, c.unit.as_str(), c.original_value.as_deref()),
            (Value::Number(0.9144), "m", Some("36 in"))
        );
        let c = constraint(serde_json::json!({"min": 50.0, "max": 68.0}), "degF");
        assert_eq!((c.value, c.unit.as_str()), (Value::Range { min: 10.0, max: 20.0 }, "degC"));
        let c = constraint(serde_json::json!({"width": 5, "length": 7}), "ft");
        assert_eq!(serde_json::to_value(&c.value).ok(), Some(serde_json::json!({"length": 2.1336, "width": 1.524})));
        let c = constraint(serde_json::json!({"expr": "2 * n + 1"}), "ft");
        assert_eq!(c.value, Value::Expression { expr: "(2 * n + 1) * 0.3048".into() });
        let c = constraint(7.5.into(), "m²");
        assert_eq!((c.value, c.unit.as_str(), c.original_value), (Value::Number(7.5), "m^2", None));
    }

    #[test]
    fn unknown_units_stay_and_are_told() {
        let imported = read(&text(3.into(), "persons per bench")).expect("valid");
        assert_eq!(imported.converted, 0);
        assert_eq!(imported.unknown_units, [("persons per bench".to_owned(), "c".to_owned())]);
    }

    #[test]
    fn what_no_building_has_is_kept_apart_with_the_reason() {
        for (value, unit, kept) in
            [(500.into(), "m", false), ((-5).into(), "m", false), (9900.into(), "cm", false), (2.4.into(), "m", true)]
        {
            let imported = read(&text(value, unit)).expect("valid");
            assert_eq!(imported.knowledge.references[0].constraints.len(), usize::from(kept), "{unit}");
            assert_eq!(imported.quarantined.len(), usize::from(!kept), "{:?}", imported.quarantined);
            assert!(imported.quarantined.iter().all(|q| q.constraint_id == "c" && q.reason.contains("lie between")));
        }
    }

    #[test]
    fn formulas_are_read_at_the_door() {
        let wrong = read(&text(serde_json::json!({"expr": "system('rm')"}), "m"));
        let message = wrong.err().map(|e| e.to_string()).unwrap_or_default();
        assert!(message.contains("/references/0/constraints/0/value/expr"), "{message}");
    }
}
