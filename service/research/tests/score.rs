//! How many constraints are found: value and type, on the sentences kept here and on the open set where it is at hand.
//!
//! The sentences are self-written and quote no code. A figure counts when its SI value and its type are those expected.

use std::fs;
use std::path::Path;

use d3dgen_research::extract::{Extractor, Finding};
use serde_json::Value;

const LEAST_F1: f64 = 0.97;
/// The open set is small, so that one miss costs more.
const LEAST_OPEN_F1: f64 = 0.95;
/// What a unit ends with when its figure is given for each of these.
const BASES: &[&str] = &["/person", "/bed", "/unit", "/workstation", "/bay", "/robot"];
/// Units of the expected figures that are not SI, with their factor.
const FACTORS: &[(&str, f64)] = &[
    ("cm", 0.01),
    ("mm", 0.001),
    ("km", 1000.0),
    ("ft", 0.3048),
    ("in", 0.0254),
    ("ft^2", 0.092_903_04),
    ("cm^2", 0.0001),
    ("%", 0.01),
    ("min", 60.0),
    ("h", 3600.0),
    ("kN/m^2", 1000.0),
    ("L/s", 0.001),
    ("m^3/h", 0.000_277_777_778),
    ("cfm", 0.000_471_947),
    ("ppm", 0.000_001),
];

/// Returns the SI ends of an expected value.
fn si(value: &Value, unit: &str) -> Vec<f64> {
    let plain = BASES.iter().find_map(|b| unit.strip_suffix(b)).unwrap_or(unit);
    let factor = FACTORS.iter().find(|f| f.0 == plain).map_or(1.0, |f| f.1);
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

/// Whether the figure and the type are those expected.
fn is_hit(found: &Finding, expected: &Value) -> bool {
    let mut types = vec![expected["constraint_type"].clone()];
    types.extend(expected["alt_types"].as_array().cloned().unwrap_or_default());
    let ends = si(&expected["value"], expected["unit"].as_str().unwrap_or_default());
    same(&found.si, &ends) && types.contains(&serde_json::json!(found.constraint.constraint_type))
}

/// Whether one of two names of a space holds the other.
fn same_space(a: &str, b: &str) -> bool {
    let letters = |s: &str| s.chars().filter(char::is_ascii_lowercase).collect::<String>();
    let (a, b) = (letters(a), letters(b));
    !a.is_empty() && !b.is_empty() && (a.contains(&b) || b.contains(&a))
}

#[derive(Default)]
struct Score {
    hits: f64,
    wrong: f64,
    missed: f64,
    /// Sentences without a rule, and those of them in which none was found.
    negatives: usize,
    clean: usize,
    /// Hits whose sentence names a space, and those with the right one.
    spaces: usize,
    right_spaces: usize,
    said: Vec<String>,
}

impl Score {
    fn f1(&self) -> f64 {
        2.0 * self.hits / (2.0 * self.hits + self.wrong + self.missed)
    }

    fn add(&mut self, sentence: &Value) {
        let text = sentence["text"].as_str().expect("each line has a text");
        let mut found = Extractor::shared().extract(text, sentence["lang"].as_str().unwrap_or_default());
        let expected = sentence["expected"].as_array().expect("each line has a list");
        for rule in expected {
            let Some(at) = found.iter().position(|f| is_hit(f, rule)) else {
                if rule["optional"] != true {
                    self.missed += 1.0;
                    self.said.push(format!("missed {} {} in: {text}", rule["value"], rule["unit"]));
                }
                continue;
            };
            self.hits += 1.0;
            let hit = found.remove(at);
            if let Some(space) = rule["space"].as_str().filter(|s| !s.is_empty()) {
                self.spaces += 1;
                self.right_spaces += usize::from(same_space(&hit.constraint.space, space));
            }
        }
        self.wrong += found.len() as f64;
        if expected.is_empty() {
            self.negatives += 1;
            self.clean += usize::from(found.is_empty());
        }
        let wrong = |f: &Finding| format!("wrong {:?} {} in: {text}", f.constraint.value, f.constraint.unit);
        self.said.extend(found.iter().map(wrong));
    }
}

fn check(file: &Path, least: f64) {
    let mut score = Score::default();
    for line in fs::read_to_string(file).expect("the file is there").lines() {
        score.add(&serde_json::from_str(line).expect("each line is JSON"));
    }
    let f1 = score.f1();
    println!("F1 {f1:.3} (value and type), negatives clean {}/{}", score.clean, score.negatives);
    println!("spaces right {}/{}\n{}", score.right_spaces, score.spaces, score.said.join("\n"));
    assert!(f1 >= least, "F1 is {f1:.3}, needs {least}:\n{}", score.said.join("\n"));
    assert_eq!(score.clean, score.negatives, "a rule was found where none is:\n{}", score.said.join("\n"));
}

#[test]
fn own_sentences_are_read() {
    check(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/sentences.jsonl"), LEAST_F1);
}

#[test]
fn open_sentences_are_read_where_they_are_at_hand() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/llm/extraction_open.jsonl");
    if !file.exists() {
        println!("skipped: the open sentences are not beside the project");
        return;
    }
    check(&file, LEAST_OPEN_F1);
}

/// Sentences that were written with no word list at hand. Unseen the first batch scored 0.858, the second, after the words
/// had been mended by the first, 0.903, and the third 0.943; all are kept so that none gets worse.
#[test]
fn fresh_sentences_are_read() {
    let file = |name: &str| Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(name);
    check(&file("sentences_fresh_1.jsonl"), 0.97);
    check(&file("sentences_fresh_2.jsonl"), 0.91);
    check(&file("sentences_fresh_3.jsonl"), 0.94);
}
