//! The word lists of the crate: names and use of each object, mass and use of each kind.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use d3dgen_model::domain::Shape;
use serde::Deserialize;

/// One line of `data/words_*.txt`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry {
    /// Kind word, or empty.
    pub kind: &'static str,
    /// English names, by commas.
    pub names: &'static str,
    /// German names, by commas.
    pub german: &'static str,
    /// What it is for.
    pub purpose: &'static str,
}

#[derive(Deserialize)]
struct Kinds {
    kinds: BTreeMap<String, Kind>,
    shapes: BTreeMap<Shape, String>,
}

#[derive(Deserialize)]
struct Kind {
    density: f64,
    affordances: Vec<String>,
    #[serde(default)]
    fits_people: bool,
}

/// Density of a kind that no list knows, kg/m^3 of its box.
const USUAL_DENSITY: f64 = 80.0;

/// Returns what is known of an object id.
pub fn entry(object_id: &str) -> Option<&'static Entry> {
    static ENTRIES: OnceLock<BTreeMap<&'static str, Entry>> = OnceLock::new();
    let read = || {
        let lines = [include_str!("../../data/words_1.txt"), include_str!("../../data/words_2.txt")];
        lines.into_iter().flat_map(str::lines).filter(|l| !l.starts_with('#')).filter_map(line).collect()
    };
    ENTRIES.get_or_init(read).get(object_id)
}

fn line(text: &'static str) -> Option<(&'static str, Entry)> {
    let mut cells = text.split('|');
    let mut cell = || cells.next().map(str::trim);
    Some((cell()?, Entry { kind: cell()?, names: cell()?, german: cell()?, purpose: cell()? }))
}

fn tables() -> &'static Kinds {
    static KINDS: OnceLock<Kinds> = OnceLock::new();
    KINDS.get_or_init(|| toml::from_str(include_str!("../../data/kinds.toml")).expect("a test reads the shipped table"))
}

/// Returns the kind words there are.
pub fn kinds() -> impl Iterator<Item = &'static str> {
    tables().kinds.keys().map(String::as_str)
}

/// Returns the kind of objects of a shape.
pub fn kind_of_shape(shape: Shape) -> &'static str {
    tables().shapes.get(&shape).map_or("equipment", String::as_str)
}

/// Returns the usual mass of things of a kind, kg per m^3 of the box around them.
pub fn kind_density(kind: &str) -> f64 {
    tables().kinds.get(kind).map_or(USUAL_DENSITY, |k| k.density)
}

/// Tells whether things of a kind are about as large everywhere, because people fit into or onto them.
pub fn kind_fits_people(kind: &str) -> bool {
    tables().kinds.get(kind).is_some_and(|k| k.fits_people)
}

/// Returns what a person does with things of a kind.
pub fn kind_affordances(kind: &str) -> Vec<&'static str> {
    tables().kinds.get(kind).into_iter().flat_map(|k| k.affordances.iter().map(String::as_str)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lists_are_whole_and_use_known_kinds() {
        let known: Vec<&str> = kinds().collect();
        assert_eq!(known.len(), 31);
        let mut lines = 0;
        for text in [include_str!("../../data/words_1.txt"), include_str!("../../data/words_2.txt")] {
            for text in text.lines().filter(|l| !l.starts_with('#')) {
                assert_eq!(text.split('|').count(), 5, "{text}");
                let (id, entry) = line(text).expect("five cells");
                assert!(known.contains(&entry.kind) && !entry.purpose.is_empty(), "{id}: {}", entry.kind);
                lines += 1;
            }
        }
        assert!(lines > 500);
        assert_eq!(kind_of_shape(Shape::RoundTable), "table");
    }
}
