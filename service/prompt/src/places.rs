//! Countries and cities, as words.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::LazyLock;

use d3dgen_language::fold;
use d3dgen_model::gazetteer::PLACES;
use serde::Deserialize;

#[derive(Debug, Deserialize)]
struct Line {
    #[serde(default)]
    code: Option<String>,
    #[serde(default)]
    codes: Vec<String>,
    names: Vec<String>,
    #[serde(default)]
    strict: bool,
    #[serde(default)]
    city: bool,
}

/// A name, and the place that it is of.
pub(crate) struct Place {
    pub name: String,
    /// Country, division and whether it is a city, as [`parts`] reads it.
    pub value: String,
}

/// Returns all names of places; those of places in several countries have no country.
pub(crate) fn places() -> Vec<Place> {
    let mut found: BTreeMap<String, Line> = BTreeMap::new();
    for line in PLACES.lines() {
        let Ok(line) = serde_json::from_str::<Line>(line) else { continue };
        for name in &line.names {
            let one = Line { names: Vec::new(), codes: line.codes.clone(), code: line.code.clone(), ..line };
            match found.get(&name.to_lowercase()) {
                // a country wins over a city of the same name, a listed ambiguity over both
                Some(old) if old.codes.len() >= one.codes.len() && (!old.city || one.city) => {}
                _ => {
                    found.insert(name.to_lowercase(), one);
                }
            }
        }
    }
    let value = |l: &Line| {
        let code = l.code.clone().filter(|_| l.codes.is_empty()).unwrap_or_default();
        // "AT-9": a division of a country
        let country = code.split('-').next().unwrap_or_default();
        let division = if code.contains('-') { code.as_str() } else { "" };
        format!("{country}|{division}|{}|{}", u8::from(l.city), u8::from(l.strict))
    };
    found.into_iter().map(|(name, line)| Place { value: value(&line), name }).collect()
}

/// Returns true for the name of a place as it is listed, and no other form of it.
pub(crate) fn is_name(text: &str) -> bool {
    static NAMES: LazyLock<BTreeSet<String>> = LazyLock::new(|| places().iter().map(|p| fold(&p.name)).collect());
    NAMES.contains(&fold(text))
}

/// What the value of a place says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Parts<'v> {
    /// Code of the country; none for a name that several countries have.
    pub country: Option<&'v str>,
    pub division: Option<&'v str>,
    pub city: bool,
    /// True for names that are also common words.
    pub strict: bool,
}

/// Returns what a value says.
pub(crate) fn parts(value: &str) -> Parts<'_> {
    let mut parts = value.split('|');
    let mut next = || parts.next().filter(|p| !p.is_empty());
    Parts { country: next(), division: next(), city: next() == Some("1"), strict: next() == Some("1") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_is_read() {
        for line in PLACES.lines() {
            let line: Line = serde_json::from_str(line).unwrap_or_else(|e| panic!("{e}: {line}"));
            assert!(!line.names.is_empty());
        }
        let places = places();
        let of = |name: &str| places.iter().find(|p| p.name == name).map(|p| parts(&p.value));
        assert_eq!(of("wien").map(|p| p.country), Some(Some("AT")));
        assert_eq!(of("lyon").map(|p| (p.country, p.city)), Some((Some("FR"), true)));
        assert_eq!(of("germany").map(|p| (p.country, p.city)), Some((Some("DE"), false)));
    }
}
