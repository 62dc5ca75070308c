//! Whether a figure stands in a text: the value with its unit, also converted (`36 in` for 0.914 m).
//!
//! What a model says is a proposal; only this decides whether the evidence holds it. It looks at every figure of a text,
//! rules or not, and reads `1,5` and `1.500` both ways, for the text says which was meant only to those who understand it.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::OnceLock;

use d3dgen_model::knowledge::Value;
use serde::Deserialize;

use crate::corpus::si;

/// How far a converted figure may be from the printed one, as a share of it: conversions are printed rounded.
const TOLERANCE: f64 = 0.006;
/// How far apart the figures of one ratio or formula may stand, in bytes.
const NEAR: usize = 60;

#[derive(Deserialize)]
struct UnitFile {
    unit: Vec<UnitEntry>,
}

#[derive(Deserialize)]
struct UnitEntry {
    id: String,
    spellings: Vec<String>,
}

/// Of the words that `extract` knows, those that join two figures of one unit.
#[derive(Deserialize)]
struct CueFile {
    ranges: Vec<String>,
    and: Vec<String>,
    by: Vec<String>,
}

#[derive(Deserialize)]
struct NumberFile {
    words: BTreeMap<String, f64>,
}

struct Words {
    /// Longest first; in lower case.
    units: Vec<(String, String)>,
    numbers: BTreeMap<String, f64>,
    joints: Vec<String>,
}

fn words() -> &'static Words {
    static SHARED: OnceLock<Words> = OnceLock::new();
    SHARED.get_or_init(|| {
        let file: UnitFile = toml::from_str(include_str!("../../../data/units.toml")).expect("shipped data is tested");
        let numbers: NumberFile =
            toml::from_str(include_str!("../../../data/numbers.toml")).expect("shipped data is tested");
        let cues: CueFile = toml::from_str(include_str!("../../../data/cues.toml")).expect("shipped data is tested");
        let mut units: Vec<(String, String)> = Vec::new();
        for unit in file.unit {
            units.extend(unit.spellings.iter().map(|s| (s.to_lowercase(), unit.id.clone())));
            units.push((unit.id.to_lowercase(), unit.id));
        }
        units.sort_by(|a, b| b.0.len().cmp(&a.0.len()).then(a.cmp(b)));
        Words { units, numbers: numbers.words, joints: [cues.ranges, cues.and, cues.by].concat() }
    })
}

/// Returns the unit that a word or sign means; `None` for what is none.
pub fn unit_id(text: &str) -> Option<&'static str> {
    let text = text.trim().to_lowercase();
    let plain = |s: &str| s.replace([' ', '.', '-'], "");
    words().units.iter().find(|(s, _)| *s == text || plain(s) == plain(&text)).map(|(_, id)| id.as_str())
}

/// A figure in a text.
#[derive(Debug, Clone, PartialEq)]
struct Figure {
    /// Bytes of the text.
    range: Range<usize>,
    /// What it may mean: `1.500` is 1.5 or 1500.
    readings: Vec<f64>,
    /// Unit right behind it.
    unit: Option<&'static str>,
}

/// Returns where a text holds a claimed figure; `None` where it does not.
///
/// `unit` is an id of `data/units.toml`, `count`, `ratio` or `boolean`; `name` tells shares from humidities.
pub fn find(text: &str, value: &Value, unit: &str, name: &str) -> Option<Range<usize>> {
    let figures = figures(text);
    let one = |claim: f64| (0..figures.len()).find(|i| means(*i, &figures, text, claim, unit, name));
    match value {
        Value::Number(n) => {
            let at = one(*n).and_then(|i| figures.get(i)).map(|f| f.range.clone());
            at.or_else(|| ratio(&figures, *n).filter(|_| unit == "ratio"))
        }
        Value::Range { min, max } => {
            let (a, b) = (figures.get(one(*min)?)?, figures.get(one(*max)?)?);
            Some(a.range.start.min(b.range.start)..a.range.end.max(b.range.end))
        }
        Value::Expression { expr } => expression(&figures, expr),
        Value::Flag(_) | Value::List(_) | Value::Table(_) => None,
    }
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= TOLERANCE * a.abs().max(b.abs())
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * a.abs().max(b.abs())
}

/// Whether a figure of the text is the claimed one.
fn means(index: usize, all: &[Figure], text: &str, claim: f64, unit: &str, name: &str) -> bool {
    let Some(figure) = all.get(index) else { return false };
    if matches!(unit, "count" | "boolean") {
        return figure.unit.is_none() && figure.readings.iter().any(|r| same(*r, claim));
    }
    let wanted = si(&Value::Number(claim), unit, name);
    let Value::Number(wanted_si) = wanted.value else { return false };
    let units: Vec<&str> = match figure.unit {
        Some(own) => vec![own],
        // "6 to 8 m", "1.2 x 1.5 m", and a cell below "Width (m)": the unit stands near, or anywhere above.
        None => borrowed(figure, all.get(index + 1..).unwrap_or_default(), text),
    };
    units.iter().any(|printed| {
        figure.readings.iter().any(|reading| {
            let printed_si = si(&Value::Number(*reading), printed, name);
            let Value::Number(found) = printed_si.value else { return false };
            let exact = same(*reading, claim) && *printed == unit;
            printed_si.unit == wanted.unit
                && (exact || same(found, wanted_si) || *printed != unit && close(found, wanted_si))
        })
    }) || unit == "ratio" && figure.unit.is_none() && figure.readings.iter().any(|r| same(*r, claim))
}

/// Returns the units that a bare figure may have.
fn borrowed(figure: &Figure, behind: &[Figure], text: &str) -> Vec<&'static str> {
    let next = behind.first().and_then(|f| {
        let between = text.get(figure.range.end..f.range.start)?.trim().to_lowercase();
        words().joints.contains(&between).then_some(f.unit).flatten()
    });
    if let Some(unit) = next {
        return vec![unit];
    }
    let line_start = text.get(..figure.range.start).and_then(|t| t.rfind('\n')).map_or(0, |i| i + 1);
    if !text.get(line_start..).unwrap_or_default().lines().next().unwrap_or_default().contains('|') {
        return Vec::new();
    }
    // A table: units in brackets or behind "in" in the lines above, and in the row's own label.
    let above = text.get(..figure.range.start).unwrap_or_default();
    let opened = above.match_indices(['(', '[', ',', '/']).map(|(i, s)| i + s.len());
    let named = above.match_indices(" in ").map(|(i, s)| i + s.len());
    opened.chain(named).filter_map(|at| unit_at(above, at).map(|u| u.0)).collect()
}

/// Finds a claimed quotient among the text's ratios: `1:12`, `1 in 12`, `1/12`.
fn ratio(figures: &[Figure], claim: f64) -> Option<Range<usize>> {
    figures.windows(2).find_map(|pair| {
        let [a, b] = pair else { return None };
        let fits = a.readings.iter().any(|x| b.readings.iter().any(|y| *y != 0.0 && close(x / y, claim)));
        (fits && b.range.start.saturating_sub(a.range.end) <= 6).then_some(a.range.start..b.range.end)
    })
}

/// Finds all numbers of a formula near each other.
fn expression(figures: &[Figure], expr: &str) -> Option<Range<usize>> {
    let claims: Vec<f64> = self::figures(expr).into_iter().filter_map(|f| f.readings.first().copied()).collect();
    if claims.is_empty() {
        return None;
    }
    figures.iter().find_map(|first| {
        let near: Vec<&Figure> = figures
            .iter()
            .filter(|f| f.range.start >= first.range.start && f.range.start < first.range.end + NEAR)
            .collect();
        let all = claims.iter().all(|c| near.iter().any(|f| f.readings.iter().any(|r| same(*r, *c))));
        let starts = first.readings.iter().any(|r| claims.iter().any(|c| same(*r, *c)));
        (all && starts).then(|| first.range.start..near.last().map_or(first.range.end, |f| f.range.end))
    })
}

/// Returns the figures of a text in their order.
fn figures(text: &str) -> Vec<Figure> {
    let mut out = Vec::new();
    let mut at = 0;
    while let Some(rest) = text.get(at..) {
        let Some((offset, c)) = rest.char_indices().find(|(_, c)| c.is_alphanumeric()) else { break };
        let start = at + offset;
        let word: usize = if c.is_ascii_digit() {
            let digits = |(_, c): &(usize, char)| {
                c.is_ascii_digit() || matches!(c, '.' | ',' | '\u{a0}' | '\u{202f}' | '\'' | '’')
            };
            let len = rest
                .get(offset..)
                .unwrap_or_default()
                .char_indices()
                .take_while(digits)
                .map(|(i, c)| i + c.len_utf8())
                .last();
            let printed = text.get(start..start + len.unwrap_or(1)).unwrap_or_default();
            let printed = printed.trim_end_matches(|c: char| !c.is_ascii_digit());
            let end = start + printed.len();
            let unit = unit_at(text, end);
            out.push(Figure {
                range: start..unit.map_or(end, |u| u.1),
                readings: readings(printed),
                unit: unit.map(|u| u.0),
            });
            printed.len()
        } else {
            let word: String =
                rest.get(offset..).unwrap_or_default().chars().take_while(|c| c.is_alphanumeric()).collect();
            if let Some(value) = words().numbers.get(&word.to_lowercase()) {
                let unit = unit_at(text, start + word.len());
                let end = unit.map_or(start + word.len(), |u| u.1);
                out.push(Figure { range: start..end, readings: vec![*value], unit: unit.map(|u| u.0) });
            }
            word.len()
        };
        at = start + word.max(1);
    }
    out
}

/// Returns what digits with points and commas may mean.
fn readings(printed: &str) -> Vec<f64> {
    let plain: String = printed.chars().filter(|c| c.is_ascii_digit() || matches!(c, '.' | ',')).collect();
    let without = |c: char| plain.replace(c, "");
    let mut out: Vec<f64> = Vec::new();
    for text in [without(','), without('.').replace(',', "."), plain.replace(['.', ','], "")] {
        // "1.234.567" is no number, and 1.5 is never 15.
        let grouped = text.contains('.') || plain.split(['.', ',']).skip(1).all(|group| group.len() == 3);
        if let Some(value) = text.parse::<f64>().ok().filter(|v| v.is_finite() && grouped && !out.contains(v)) {
            out.push(value);
        }
    }
    out
}

/// Returns the unit that begins at a byte, after blanks or a hyphen, and its end.
fn unit_at(text: &str, at: usize) -> Option<(&'static str, usize)> {
    let rest = text.get(at..)?;
    let skipped = rest.len() - rest.trim_start_matches([' ', '\u{a0}', '\u{202f}', '-', '‑']).len();
    let rest = rest.get(skipped..)?;
    if skipped > 3 {
        return None;
    }
    let head: String = rest.chars().take(24).flat_map(char::to_lowercase).collect();
    words().units.iter().find_map(|(spelling, id)| {
        let ends = |end: usize| !head.get(end..).unwrap_or_default().starts_with(char::is_alphanumeric);
        let symbol = !spelling.ends_with(char::is_alphanumeric);
        let fits = head.starts_with(spelling.as_str()) && (symbol || ends(spelling.len()));
        // "in" is a unit right behind a figure only before a stop or a dimension; elsewhere a preposition.
        let preposition = spelling == "in"
            && head.get(2..).is_some_and(|t| {
                t.trim_start().starts_with("the ") || t.trim_start().starts_with(|c: char| c.is_ascii_digit())
            });
        let printed = rest.chars().take(spelling.chars().count()).map(char::len_utf8).sum::<usize>();
        (fits && !preposition).then(|| (id.as_str(), at + skipped + printed))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn held(text: &str, value: Value, unit: &str) -> Option<String> {
        find(text, &value, unit, "width").and_then(|r| text.get(r)).map(str::to_owned)
    }

    #[test]
    fn printed_figures_are_found_in_their_unit_and_converted() {
        let number = Value::Number;
        let range = |min, max| Value::Range { min, max };
        let expr = |e: &str| Value::Expression { expr: e.into() };
        for (text, value, unit, expected) in [
            ("A clear width of 1.5 m is needed.", number(1.5), "m", Some("1.5 m")),
            ("A clear width of 1.5 m is needed.", number(150.0), "cm", Some("1.5 m")),
            ("Doors must be 36 inches wide.", number(0.914), "m", Some("36 inches")),
            ("Doors must be 36 inches wide.", number(0.95), "m", None),
            ("mindestens 1,50 m breit", number(1.5), "m", Some("1,50 m")),
            ("mindestens 1.500 mm breit", number(1500.0), "mm", Some("1.500 mm")),
            ("at least 8 m² of floor area", number(8.0), "m^2", Some("8 m²")),
            ("at least 8 m² of floor area", number(8.0), "m", None),
            ("at least 8 m of floor", number(8.0), "m^2", None),
            ("section 99 says 1.5 m", number(99.0), "m", None),
            ("between 6 and 8 m", range(6.0, 8.0), "m", Some("6 and 8 m")),
            ("between 6 and 8 m", range(6.0, 9.0), "m", None),
            ("a slope of 1:12", expr("1:12"), "ratio", Some("1:12")),
            ("a slope of 1:12", number(0.0833), "ratio", Some("1:12")),
            ("a slope of 1:12", expr("1:20"), "ratio", None),
            ("two exits are needed", number(2.0), "count", Some("two")),
            ("2 m are needed", number(2.0), "count", None),
            ("at least 10 % of the floor", number(10.0), "%", Some("10 %")),
            ("at least 10 % of the floor", number(0.1), "ratio", Some("10 %")),
            ("Room | Width (m)\nCorridor | 1.8", number(1.8), "m", Some("1.8")),
            ("Room | Width (m)\nCorridor | 1.8", number(1.8), "m^2", None),
            ("The width is 1.8 * n + 2 m.", expr("1.8 * n + 2"), "m", Some("1.8 * n + 2 m")),
            ("in 2024 the hall got 24 m menus", number(24.0), "m", Some("24 m")),
        ] {
            assert_eq!(held(text, value.clone(), unit).as_deref(), expected, "{text} / {value:?} {unit}");
        }
    }

    #[test]
    fn units_are_known_by_their_spellings() {
        for (text, id) in [("m2", "m^2"), ("sq. ft", "ft^2"), ("Meter", "m"), ("%", "%"), ("inches", "in")] {
            assert_eq!(unit_id(text), Some(id), "{text}");
        }
        assert_eq!(unit_id("bananas"), None);
    }

    #[test]
    fn any_text_is_read_in_time_of_its_length() {
        let text = "1.2.3,4 m² ½ \u{0} 9'9\" ".repeat(20_000);
        assert!(!figures(&text).is_empty());
    }
}
