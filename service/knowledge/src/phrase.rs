//! Constraints in one sentence each, for prompts and for people: what, how much, when, and who says so.

use d3dgen_model::knowledge::{Constraint, Value};
use serde_json::Value as Json;

use crate::retrieve::{Applicable, Retrieval};

/// Returns the constraints of a retrieval as list items, those that bind first, each with its citation and id.
pub fn bullets(retrieval: &Retrieval) -> Vec<String> {
    let (binding, advice): (Vec<&Applicable>, Vec<&Applicable>) =
        retrieval.constraints.iter().partition(|a| a.mandatory);
    binding.into_iter().chain(advice).map(bullet).collect()
}

fn bullet(a: &Applicable) -> String {
    let force = match (&a.superseded_by, a.mandatory) {
        (Some(id), _) => format!("gives way to {id}"),
        (None, true) => "mandatory".to_owned(),
        (None, false) => "advice".to_owned(),
    };
    let source = &a.citation.source;
    format!(
        "- {} ({force}; {}, {} {}) [{}]",
        sentence(&a.constraint),
        a.citation.jurisdiction,
        source.title,
        source.edition_or_year,
        a.constraint.constraint_id
    )
}

/// Returns what a constraint requires: `corridor: clear width at least 2.4 m, when beds are moved`.
pub fn sentence(c: &Constraint) -> String {
    let mut text = format!("{}: {} {}", words(&c.space_type), quantity(c), requirement(c));
    if !c.conditions.is_empty() {
        text += &format!(", when {}", c.conditions.iter().map(|w| words(w)).collect::<Vec<_>>().join(" and "));
    }
    text
}

/// Returns the quantity: how it is measured, with the rule's name where that says more.
fn quantity(c: &Constraint) -> String {
    let (name, basis) = (words(&c.name), words(&c.measurement_basis));
    if basis.is_empty() || name.contains(&basis) {
        name
    } else if name.is_empty() || basis.contains(&name) {
        basis
    } else {
        format!("{name} ({basis})")
    }
}

/// Returns the figure with its direction and unit: `at least 2.4 m`, `between 16 and 18 m^2`.
pub fn requirement(c: &Constraint) -> String {
    let unit = match c.unit.as_str() {
        "count" | "boolean" | "ratio" | "other" | "rooms" => String::new(),
        "percent" => " %".to_owned(),
        unit => format!(" {unit}"),
    };
    let direction = match c.constraint_type.as_str() {
        "minimum" => "at least ",
        "maximum" => "at most ",
        "recommendation" | "rule_of_thumb" => "about ",
        _ => "",
    };
    match &c.value {
        Value::Flag(true) => "required".to_owned(),
        Value::Flag(false) => "not allowed".to_owned(),
        Value::Number(v) if c.constraint_type == "ratio" && c.unit == "count" => format!("one for each {v}"),
        Value::Number(v) => format!("{direction}{v}{unit}"),
        Value::Range { min, max } => format!("between {min} and {max}{unit}"),
        Value::Expression { expr } => format!("{direction}{expr}{unit}"),
        Value::List(list) => list.iter().map(plain).collect::<Vec<_>>().join(", "),
        Value::Table(table) => match (table.get("width"), table.get("length"), table.len()) {
            (Some(w), Some(l), 2) => format!("{direction}{} x {}{unit}", plain(w), plain(l)),
            _ => {
                let rows = table.iter().map(|(k, v)| format!("{} {}{unit}", words(k), plain(v)));
                format!("{direction}{}", rows.collect::<Vec<_>>().join("; "))
            }
        },
    }
}

fn plain(value: &Json) -> String {
    match value {
        Json::String(text) => text.clone(),
        Json::Array(items) => items.iter().map(plain).collect::<Vec<_>>().join(" to "),
        other => other.to_string(),
    }
}

fn words(name: &str) -> String {
    name.replace('_', " ").trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_read_as_people_say_them() {
        let figure = |kind: &str, value: Json, unit: &str| {
            let c: Constraint = serde_json::from_value(serde_json::json!({
                "constraint_id": "c", "name": "clear_width", "topic": "room_size", "constraint_type": kind,
                "value": value, "unit": unit, "measurement_basis": "clear_width", "space_type": "escape_route",
                "conditions": ["beds_moved"], "confidence": "high", "verified": "seen", "source_ids": ["s"]
            }))
            .expect("a constraint");
            sentence(&c)
        };
        let cases = [
            ("minimum", 2.4.into(), "m", "at least 2.4 m"),
            ("maximum", 6.into(), "percent", "at most 6 %"),
            ("range", serde_json::json!({"min": 16.0, "max": 18.0}), "m^2", "between 16 and 18 m^2"),
            ("ratio", 20.into(), "count", "one for each 20"),
            ("minimum", true.into(), "boolean", "required"),
            ("minimum", serde_json::json!({"width": 0.9, "length": 1.5}), "m", "at least 0.9 x 1.5 m"),
            ("table", serde_json::json!({"<=5": 0.9, "<=20": 1.0}), "m", "<=20 1.0 m; <=5 0.9 m"),
            ("minimum", serde_json::json!({"expr": "1.8 * n + 2"}), "m", "at least 1.8 * n + 2 m"),
            ("table", serde_json::json!(["lobby", "office"]), "rooms", "lobby, office"),
        ];
        for (kind, value, unit, expected) in cases {
            assert_eq!(figure(kind, value, unit), format!("escape route: clear width {expected}, when beds moved"));
        }
    }
}
