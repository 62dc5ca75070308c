//! Whether a rule of a building can mean what it says: a table of the figures that each quantity can have.
//!
//! What is outside is misread, planted or mistyped, and is kept apart where rules come in. What it is not for: judging worlds.

use std::sync::LazyLock;

use serde::Deserialize;

use crate::knowledge::{Constraint, KnowledgeBase, Value};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    row: Vec<Row>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    unit: String,
    #[serde(default)]
    words: Vec<String>,
    min: f64,
    max: f64,
}

static TABLE: LazyLock<Table> = LazyLock::new(|| {
    toml::from_str(include_str!("../data/plausible.toml"))
        .expect("data/plausible.toml is part of the crate and read by its tests")
});

/// A rule that was kept apart because it cannot mean what it says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Quarantined {
    /// Its id.
    pub constraint_id: String,
    /// Why: the figure, and between which such figures lie.
    pub reason: String,
}

/// Returns why a figure in SI units cannot be that of a rule; `None` where it can.
///
/// `words` say what is limited: name, basis and space of the rule.
pub fn doubt(words: &[&str], unit: &str, value: &Value) -> Option<String> {
    if let Value::Range { min, max } = value
        && min > max
    {
        return Some(format!("its least figure {min} is above its largest {max}"));
    }
    let figures = figures(value);
    if let Some(wrong) = figures.iter().find(|v| !v.is_finite()) {
        return Some(format!("{wrong} is no figure"));
    }
    let row = row_of(words, unit)?;
    let wrong = figures.iter().find(|v| **v < row.min || **v > row.max)?;
    Some(format!("{wrong} {unit} cannot be: such figures lie between {} and {} {unit}", row.min, row.max))
}

/// Returns why a rule cannot mean what it says; `None` where it can.
pub fn doubt_of(rule: &Constraint) -> Option<String> {
    let (name, space) = (rule.name.as_str(), rule.space_type.as_str());
    // name and space say what is limited, the basis how it is measured: "clear width, at every point along the path"
    let told = row_of(&[name, space], &rule.unit).is_some_and(|row| !row.words.is_empty());
    let words = if told { vec![name, space] } else { vec![name, &rule.measurement_basis, space] };
    doubt(&words, &rule.unit, &rule.value)
}

/// Returns the first row of a unit that words are about, or that is for all others of the unit.
fn row_of(words: &[&str], unit: &str) -> Option<&'static Row> {
    let said: Vec<&str> = words.iter().flat_map(|w| w.split(|c: char| !c.is_alphanumeric())).collect();
    let speaks = |row: &Row| row.words.is_empty() || row.words.iter().any(|w| said.contains(&w.as_str()));
    TABLE.row.iter().find(|row| row.unit == unit && speaks(row))
}

/// Takes out of a knowledge base what cannot mean what it says.
pub fn quarantine(knowledge: &mut KnowledgeBase) -> Vec<Quarantined> {
    let mut out = Vec::new();
    for reference in &mut knowledge.references {
        reference.constraints.retain(|c| match doubt_of(c) {
            None => true,
            Some(reason) => {
                out.push(Quarantined { constraint_id: c.constraint_id.clone(), reason });
                false
            }
        });
    }
    out
}

/// Returns the figures of a value; words and formulas have none.
fn figures(value: &Value) -> Vec<f64> {
    match value {
        Value::Number(v) => vec![*v],
        Value::Range { min, max } => vec![*min, *max],
        Value::List(items) => items.iter().filter_map(serde_json::Value::as_f64).collect(),
        Value::Table(table) => table.values().filter_map(serde_json::Value::as_f64).collect(),
        Value::Flag(_) | Value::Expression { .. } => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_that_no_building_has_are_doubted() {
        let range = |min, max| Value::Range { min, max };
        for (words, unit, value, doubted) in [
            ("corridor_width", "m", Value::Number(500.0), true),
            ("corridor_width", "m", Value::Number(99.0), true),
            ("clear_width", "m", Value::Number(-5.0), true),
            ("room_area", "m^2", range(20.0, 10.0), true),
            ("door_width", "m", Value::Number(f64::NAN), true),
            ("corridor_width", "m", Value::Number(2.25), false),
            ("escape_travel_distance corridor", "m", Value::Number(120.0), false),
            ("room_temperature", "degC", range(-5.0, 26.0), false),
            ("room_area", "m^2", range(10.0, 20.0), false),
            ("anything", "words per page", Value::Number(1e9), false),
        ] {
            let words: Vec<&str> = words.split(' ').collect();
            assert_eq!(doubt(&words, unit, &value).is_some(), doubted, "{words:?} {value} {unit}");
        }
    }
}
