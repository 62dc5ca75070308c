//! How many constraints are found: value and type, on the sentences kept here and on the open set where it is at hand.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use d3dgen_research::extract::Extractor;
use serde_json::Value;

const LEAST_F1: f64 = 0.95;
/// Units of the expected figures that are not SI, with their factor.
const FACTORS: &[(&str, f64)] = &[
    ("cm", 0.01),
    ("mm", 0.001),
    ("ft", 0.3048),
    ("in", 0.0254),
    ("ft^2", 0.092_903_04),
    ("%", 0.01),
    ("min", 60.0),
    ("h", 3600.0),
    ("kN/m^2", 1000.0),
    ("L/s/person", 0.001),
    ("L/s", 0.001),
    ("m^3/h/person", 0.000_277_777_778),
];

/// Returns the SI ends of an expected or found value.
fn si(value: &Value, unit: &str) -> Vec<f64> {
    let factors: BTreeMap<&str, f64> = FACTORS.iter().copied().collect();
    let factor = factors.get(unit).copied().unwrap_or(1.0);
    if let Some(expr) = value.get("expr").and_then(Value::as_str) {
        let parts: Vec<f64> =
            expr.split(|c: char| !(c.is_ascii_digit() || c == '.')).filter_map(|p| p.parse().ok()).collect();
        return if parts.len() == 2 && !expr.contains('+') { vec![parts[0] / parts[1]] } else { parts };
    }
    [Some(value), value.get("min"), value.get("max")]
        .into_iter()
        .flatten()
        .filter_map(Value::as_f64)
        .map(|v| v * factor)
        .collect()
}

fn same(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len()
        && !a.is_empty()
        && a.iter().zip(b).all(|(x, y)| (x - y).abs() <= 0.005 * x.abs().max(y.abs()).max(1e-9))
}

/// Returns F1, and every miss and false find in words.
fn score(file: &Path) -> (f64, Vec<String>) {
    let (mut hits, mut wrong, mut missed, mut said) = (0.0, 0.0, 0.0, Vec::new());
    for line in fs::read_to_string(file).expect("the file is there").lines() {
        let sentence: Value = serde_json::from_str(line).expect("each line is JSON");
        let text = sentence["text"].as_str().expect("each line has a text");
        let mut found = Extractor::shared().extract(text, sentence["lang"].as_str().unwrap_or_default());
        for expected in sentence["expected"].as_array().expect("each line has a list") {
            let unit = expected["unit"].as_str().unwrap_or_default();
            let ends = si(&expected["value"], unit);
            let mut types = vec![expected["constraint_type"].clone()];
            types.extend(expected["alt_types"].as_array().cloned().unwrap_or_default());
            let hit = found
                .iter()
                .position(|f| same(&f.si, &ends) && types.contains(&serde_json::json!(f.constraint.constraint_type)));
            match hit {
                Some(at) => {
                    hits += 1.0;
                    found.remove(at);
                }
                None if expected["optional"] == true => {}
                None => {
                    missed += 1.0;
                    said.push(format!("missed {} {unit} in: {text}", expected["value"]));
                }
            }
        }
        wrong += found.len() as f64;
        let negative = sentence["expected"].as_array().is_some_and(Vec::is_empty);
        let kind = if negative { "no rule, but" } else { "wrong" };
        said.extend(found.iter().map(|f| format!("{kind} {:?} {} in: {text}", f.constraint.value, f.constraint.unit)));
    }
    (2.0 * hits / (2.0 * hits + wrong + missed), said)
}

fn check(file: &Path) {
    let (f1, said) = score(file);
    println!("F1 {f1:.3}\n{}", said.join("\n"));
    assert!(f1 >= LEAST_F1, "F1 is {f1:.3}, needs {LEAST_F1}:\n{}", said.join("\n"));
    assert!(!said.iter().any(|s| s.starts_with("no rule")), "{said:?}");
}

#[test]
fn own_sentences_are_read() {
    check(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/sentences.jsonl"));
}

#[test]
fn open_sentences_are_read_where_they_are_at_hand() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/llm/extraction_open.jsonl");
    if !file.exists() {
        println!("skipped: the open sentences are not beside the project");
        return;
    }
    check(&file);
}
