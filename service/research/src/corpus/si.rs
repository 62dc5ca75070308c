//! Printed figures in SI units, and the form in which equal rules are equal.

use std::sync::OnceLock;

use d3dgen_model::knowledge::Value;
use d3dgen_model::units;
use serde::Deserialize;

/// Digits that a converted figure keeps: enough for an inch in meters, few enough that two ways of converting agree.
const DIGITS: i32 = 6;

#[derive(Deserialize)]
struct Table {
    unit: Vec<Unit>,
}

#[derive(Deserialize)]
struct Unit {
    id: String,
    to: String,
    factor: f64,
    #[serde(default)]
    names: Vec<String>,
}

fn table() -> &'static Table {
    static SHARED: OnceLock<Table> = OnceLock::new();
    SHARED.get_or_init(|| toml::from_str(include_str!("../../data/si_units.toml")).expect("shipped data is tested"))
}

/// A figure in SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct SiFigure {
    /// In `unit`.
    pub value: Value,
    /// SI unit, in the spelling of knowledge bases.
    pub unit: String,
    /// The figure with its printed unit, where `value` and `unit` differ from what was printed.
    pub original: Option<String>,
}

impl SiFigure {
    /// Returns the value as text that is equal for equal figures, whatever unit they were printed in.
    pub fn key(&self) -> String {
        format!("{} {}", value_key(&self.value), self.unit)
    }
}

/// Returns a printed figure of the quantity `name` in SI units.
pub fn si(value: &Value, unit: &str, name: &str) -> SiFigure {
    let (to, factor, offset) = way(unit, name);
    let scale = |n: f64| if factor == 1.0 && offset == 0.0 { n } else { rounded(n * factor + offset) };
    let (converted, to) = match value {
        Value::Expression { expr } => expression(expr, &to, factor, offset),
        other => (map(other, &scale), to),
    };
    let same = to == unit && converted == *value;
    let original = (!same).then(|| printed(value, unit));
    SiFigure { value: converted, unit: to, original }
}

fn way(unit: &str, name: &str) -> (String, f64, f64) {
    let own =
        table().unit.iter().find(|u| u.id == unit && (u.names.is_empty() || u.names.iter().any(|n| name.contains(n))));
    if let Some(own) = own {
        return (own.to.clone(), own.factor, 0.0);
    }
    match units::conversion(unit) {
        Some(way) => (way.unit, way.factor, way.offset),
        None => (unit.to_owned(), 1.0, 0.0),
    }
}

/// Reads the formulas of text: `1 per 10`, `1:12`, and `1.8 * n + 2`, which is scaled as a whole.
fn expression(expr: &str, unit: &str, factor: f64, offset: f64) -> (Value, String) {
    let number = |t: &str| t.trim().parse::<f64>().ok().filter(|n| n.is_finite() && *n > 0.0);
    if let Some((a, b)) = expr.split_once(" per ").and_then(|(a, b)| number(a).zip(number(b))) {
        return (Value::Number(rounded(b / a)), unit.to_owned());
    }
    if let Some((a, b)) = expr.split_once([':', '/']).and_then(|(a, b)| number(a).zip(number(b))) {
        return (Value::Number(rounded(a / b)), unit.to_owned());
    }
    let mut formula = if factor == 1.0 { expr.to_owned() } else { format!("{} * ({expr})", rounded(factor)) };
    if offset != 0.0 {
        formula = format!("{formula} + {}", rounded(offset));
    }
    (Value::Expression { expr: formula }, unit.to_owned())
}

fn map(value: &Value, scale: &dyn Fn(f64) -> f64) -> Value {
    let json = |v: &serde_json::Value| match v.as_f64() {
        Some(n) => serde_json::json!(scale(n)),
        None => v.clone(),
    };
    match value {
        Value::Number(n) => Value::Number(scale(*n)),
        Value::Range { min, max } => Value::Range { min: scale(*min), max: scale(*max) },
        Value::List(list) => Value::List(list.iter().map(json).collect()),
        Value::Table(table) => Value::Table(table.iter().map(|(k, v)| (k.clone(), json(v))).collect()),
        Value::Flag(_) | Value::Expression { .. } => value.clone(),
    }
}

/// Rounds to the digits that matter; whole and decimal figures print as a person would write them.
fn rounded(n: f64) -> f64 {
    if n == 0.0 || !n.is_finite() {
        return n;
    }
    let digits = DIGITS - 1 - n.abs().log10().floor() as i32;
    let power = 10f64.powi(digits.abs());
    if digits >= 0 { (n * power).round() / power } else { (n / power).round() * power }
}

fn printed(value: &Value, unit: &str) -> String {
    if matches!(unit, "count" | "ratio" | "boolean") { value.to_string() } else { format!("{value} {unit}") }
}

fn value_key(value: &Value) -> String {
    let number = |n: f64| format!("{:e}", rounded(n) + 0.0);
    let json = |v: &serde_json::Value| v.as_f64().map_or_else(|| v.to_string(), number);
    match value {
        Value::Flag(flag) => flag.to_string(),
        Value::Number(n) => number(*n),
        Value::Range { min, max } => format!("{}..{}", number(*min), number(*max)),
        Value::Expression { expr } => expr.split_whitespace().collect(),
        Value::List(list) => list.iter().map(json).collect::<Vec<_>>().join(","),
        Value::Table(table) => table.iter().map(|(k, v)| format!("{k}={}", json(v))).collect::<Vec<_>>().join(","),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn printed_figures_become_si() {
        let expr = |e: &str| Value::Expression { expr: e.into() };
        for (value, unit, name, expected, to, original) in [
            (Value::Number(1.5), "m", "width", Value::Number(1.5), "m", None),
            (Value::Number(150.0), "cm", "width", Value::Number(1.5), "m", Some("150 cm")),
            (Value::Number(36.0), "in", "width", Value::Number(0.9144), "m", Some("36 in")),
            (Value::Number(100.0), "ft^2", "floor_area", Value::Number(9.2903), "m^2", Some("100 ft^2")),
            (Value::Number(68.0), "degF", "temperature", Value::Number(20.0), "degC", Some("68 degF")),
            (Value::Number(10.0), "%", "area_share", Value::Number(0.1), "ratio", Some("10 %")),
            (Value::Number(40.0), "%", "relative_humidity", Value::Number(40.0), "percent", Some("40 %")),
            (
                Value::Range { min: 6.0, max: 8.0 },
                "ft",
                "width",
                Value::Range { min: 1.8288, max: 2.4384 },
                "m",
                Some("6 to 8 ft"),
            ),
            (expr("1 per 10"), "count", "toilets", Value::Number(10.0), "count", Some("1 per 10")),
            (expr("1:12"), "ratio", "slope", Value::Number(0.0833333), "ratio", Some("1:12")),
            (expr("1.8 * n + 2"), "m", "width", expr("1.8 * n + 2"), "m", None),
            (expr("6 * n"), "ft", "width", expr("0.3048 * (6 * n)"), "m", Some("6 * n ft")),
        ] {
            let figure = si(&value, unit, name);
            assert_eq!((figure.value, figure.unit.as_str()), (expected, to), "{value:?} {unit}");
            assert_eq!(figure.original.as_deref(), original, "{value:?} {unit}");
        }
    }

    #[test]
    fn equal_figures_have_one_key() {
        let key = |n: f64, unit: &str| si(&Value::Number(n), unit, "width").key();
        assert_eq!(key(1.5, "m"), key(150.0, "cm"));
        assert_eq!(key(1.5, "m"), key(1500.0, "mm"));
        assert_ne!(key(1.5, "m"), key(1.51, "m"));
        assert_eq!(si(&Value::Number(1.0), "h", "duration").key(), si(&Value::Number(60.0), "min", "duration").key());
    }
}
