//! Conditions that every asset found must fulfill, and how people write them: `height<1.0`, `mount=wall`, `color=red`.

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_store::index::Filter;

use super::document::{FACETS, NUMBERS};
use crate::error::Error;

/// Limits of a number, themselves included.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Range {
    /// The least, if any.
    pub min: Option<f64>,
    /// The greatest, if any.
    pub max: Option<f64>,
}

/// Conditions; all must hold.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Filters {
    /// Values by facet ([`FACETS`]): one of each must be the asset's.
    pub facets: BTreeMap<String, BTreeSet<String>>,
    /// Values by facet that the asset must not have.
    pub not: BTreeMap<String, BTreeSet<String>>,
    /// Limits by number ([`NUMBERS`]): `width`, `depth`, `height` in m, `mass` in kg, `volume` in m^3, `triangles`.
    pub numbers: BTreeMap<String, Range>,
}

impl Filters {
    /// Adds a condition as people write it: `height<1.0`, `width>=0.6`, `mount=wall`, `color=red,blue`, `domain!=office`,
    /// `articulated`.
    ///
    /// # Errors
    /// `Input` with what would work.
    pub fn add(&mut self, text: &str) -> Result<(), Error> {
        let operators = ["<=", ">=", "!=", "==", "<", ">", "=", ":"];
        let cut = text.find(['<', '>', '=', '!', ':']);
        let Some(at) = cut else {
            let value = text.trim().to_lowercase();
            if value == "articulated" {
                self.facets.entry(value).or_default().insert("true".into());
                return Ok(());
            }
            return Err(refused(text));
        };
        let (name, rest) = text.split_at(at);
        let name = canonical(&name.trim().to_lowercase());
        let operator = operators.into_iter().find(|o| rest.starts_with(o)).ok_or_else(|| refused(text))?;
        let value = rest[operator.len()..].trim();
        if NUMBERS.contains(&name.as_str()) {
            let figure = length(value).ok_or_else(|| Error::Input(format!("`{text}`: `{value}` is no number")))?;
            let range = self.numbers.entry(name).or_default();
            let (low, high) = match operator {
                "<" | "<=" => (None, Some(figure)),
                ">" | ">=" => (Some(figure), None),
                "!=" => return Err(Error::Input(format!("`{text}`: a number is compared with <, > or ="))),
                _ => (Some(figure - 1e-6), Some(figure + 1e-6)),
            };
            range.min = low.or(range.min);
            range.max = high.or(range.max);
            return Ok(());
        }
        if !FACETS.contains(&name.as_str()) || matches!(operator, "<" | ">" | "<=" | ">=") || value.is_empty() {
            return Err(refused(text));
        }
        let side = if operator == "!=" { &mut self.not } else { &mut self.facets };
        let as_asked = name == "id";
        let values = value.split(',').map(|v| v.trim()).filter(|v| !v.is_empty());
        let values = values.map(|v| if as_asked { v.to_owned() } else { v.to_lowercase() });
        side.entry(name).or_default().extend(values);
        Ok(())
    }

    /// Adds the conditions of others where these have none on the same.
    pub fn merge(&mut self, other: &Self) {
        for (name, values) in &other.facets {
            self.facets.entry(name.clone()).or_insert_with(|| values.clone());
        }
        for (name, range) in &other.numbers {
            self.numbers.entry(name.clone()).or_insert(*range);
        }
    }

    /// Returns true without any condition.
    pub fn is_empty(&self) -> bool {
        self.facets.is_empty() && self.not.is_empty() && self.numbers.is_empty()
    }

    /// Returns the filter of the index.
    ///
    /// # Errors
    /// `Input` for a facet or number that assets do not have.
    pub fn to_filter(&self) -> Result<Filter, Error> {
        let mut filter = Filter::Everything;
        for (name, values) in &self.facets {
            filter = filter.and(Filter::facet(known(name, &FACETS)?, values));
        }
        for (name, values) in &self.not {
            filter = filter.and(Filter::facet(known(name, &FACETS)?, values).negate());
        }
        for (name, range) in &self.numbers {
            filter = filter.and(Filter::number(known(name, &NUMBERS)?, range.min, range.max));
        }
        Ok(filter)
    }
}

fn known<'a>(name: &'a str, all: &[&str]) -> Result<&'a str, Error> {
    if all.contains(&name) { Ok(name) } else { Err(refused(name)) }
}

fn refused(text: &str) -> Error {
    let (facets, numbers) = (FACETS.join(", "), NUMBERS.join(", "));
    Error::Input(format!(
        "`{text}` is no filter; write NAME=VALUE with one of {facets}, or NAME<NUMBER, NAME>NUMBER with one of {numbers}"
    ))
}

/// Returns the name of a facet or number for the words people use.
fn canonical(name: &str) -> String {
    match name {
        "colour" => "color",
        "hoi" => "affordance",
        "room_type" => "room",
        "tags" => "tag",
        "triangle_count" => "triangles",
        "size" => "volume",
        other => other,
    }
    .to_owned()
}

/// Returns a number, lengths with a unit in m.
fn length(text: &str) -> Option<f64> {
    let text = text.trim().to_lowercase();
    let digits = text.trim_end_matches(|c: char| c.is_alphabetic()).trim_end();
    let factor = match text[digits.len()..].trim() {
        "" | "m" | "kg" => 1.0,
        "cm" => 0.01,
        "mm" => 0.001,
        _ => return None,
    };
    digits.replace(',', ".").parse::<f64>().ok().filter(|v| v.is_finite()).map(|v| v * factor)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conditions_are_read_as_people_write_them() {
        let mut filters = Filters::default();
        for text in ["height<1.0", "width >= 60cm", "mount=wall", "colour=Red,blue", "articulated", "domain!=office"] {
            filters.add(text).unwrap_or_else(|e| panic!("{text}: {e}"));
        }
        assert_eq!(filters.numbers["height"], Range { min: None, max: Some(1.0) });
        assert_eq!(filters.numbers["width"], Range { min: Some(0.6), max: None });
        assert_eq!(filters.facets["color"].iter().collect::<Vec<_>>(), ["blue", "red"]);
        assert!(filters.facets["articulated"].contains("true") && filters.not["domain"].contains("office"));
        assert!(filters.to_filter().is_ok());
        for text in ["height<tall", "hight<1", "mount<wall", "color=", "", "<", "height!=1", "door"] {
            let message = Filters::default().add(text).expect_err(text).to_string();
            assert!(message.contains('`'), "{message}");
        }
    }
}
