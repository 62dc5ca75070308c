//! The figures of a constraint: from the polymorphic value to an interval, or to the sides of a rectangle.

use d3dgen_model::knowledge::{Constraint, Value};
use serde_json::Value as Json;

use crate::measure::Measure;
use d3dgen_model::expression;

/// Share by which an object may differ from the usual size that advice gives.
const USUAL: f64 = 0.1;

/// What formulas may ask about a building.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Facts {
    /// People at a time.
    pub persons: u32,
    /// Number of robots.
    pub robots: u32,
    /// Radius of the circle that the largest robot turns in, m.
    pub robot_radius: Option<f64>,
    /// Width and length of the largest body that is known, m.
    pub robot_body: [Option<f64>; 2],
    /// Rooms to sleep in.
    pub bedrooms: u32,
}

impl Facts {
    /// Returns the figure behind a name of a formula.
    ///
    /// A robot of which only the turning circle is known is round, or square where the formula asks for its length.
    fn figure(&self, name: &str, formula: &str) -> Option<f64> {
        let side = if formula.contains("robot_length") { std::f64::consts::SQRT_2 } else { 2.0 };
        match name {
            "N" => Some(f64::from(self.persons)),
            "N_robots" => Some(f64::from(self.robots)),
            "robot_width" | "vehicle_width" => self.robot_body[0].or(self.robot_radius.map(|r| r * side)),
            "robot_length" => self.robot_body[1].or(self.robot_body[0]).or(self.robot_radius.map(|r| r * side)),
            _ => None,
        }
    }
}

/// What is required: an interval, and for rectangles two sides.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Bounds {
    /// Least allowed value.
    pub min: Option<f64>,
    /// Largest allowed value.
    pub max: Option<f64>,
    /// Sides of the required rectangle, shorter first, m.
    pub sides: Option<[f64; 2]>,
}

impl Bounds {
    fn at_least(value: f64) -> Self {
        Self { min: Some(value), ..Self::default() }
    }

    fn at_most(value: f64) -> Self {
        Self { max: Some(value), ..Self::default() }
    }
}

/// Returns what a constraint requires of a quantity.
///
/// # Errors
/// Says why the value has no figure that the quantity can be held against.
pub(crate) fn bounds(c: &Constraint, measure: Measure, facts: &Facts) -> Result<Bounds, String> {
    match &c.value {
        _ if measure == Measure::ObjectExtents => extents(c).map(|_| Bounds::at_most(0.0)),
        Value::Number(v) if measure.is_extent() && !matches!(c.constraint_type.as_str(), "minimum" | "maximum") => {
            Ok(Bounds { min: Some(v * (1.0 - USUAL)), max: Some(v * (1.0 + USUAL)), sides: None })
        }
        Value::Number(v) => Ok(one(*v, c, measure)),
        Value::Flag(true) => Ok(Bounds::at_least(1.0)),
        Value::Flag(false) => Ok(Bounds::at_most(0.0)),
        Value::Range { min, .. } if measure.is_clearance() => Ok(Bounds::at_least(*min)),
        // less circulation than planners reckon with is no defect
        Value::Range { max, .. } if matches!(measure, Measure::PersonsPerRoom | Measure::CirculationShare) => {
            Ok(Bounds::at_most(*max))
        }
        Value::Range { min, max } => Ok(interval(*min, *max, c)),
        Value::Table(table) if table.contains_key("width") => {
            let figure = |key: &str| table.get(key).and_then(Json::as_f64);
            match (figure("width"), figure("length")) {
                (Some(w), Some(l)) if is_rectangle(measure) => {
                    Ok(Bounds { sides: Some([w.min(l), w.max(l)]), ..Bounds::at_least(w.min(l)) })
                }
                // doors and lanes: the width is what is passed
                (Some(w), _) => Ok(Bounds::at_least(w)),
                _ => Err("its dimensions are not figures".into()),
            }
        }
        Value::Table(table) => match table.values().filter_map(Json::as_f64).fold(None, least) {
            Some(v) if table.keys().any(|k| k.ends_with("_side")) => Ok(Bounds::at_least(v)),
            _ => by_persons(table.iter(), facts.persons)
                .or_else(|| by_bedrooms(table.iter(), facts.bedrooms))
                .map(|v| one(v, c, measure))
                .ok_or_else(|| "its table is not by number of people or bedrooms".into()),
        },
        Value::Expression { expr } => match expression::evaluate(expr, &|name| facts.figure(name, expr)) {
            Some(v) => Ok(one(v, c, measure)),
            None => Err(format!("its formula `{expr}` has quantities that the documents do not hold")),
        },
        Value::List(_) => Err("its value is a list".into()),
    }
}

/// The interval of one extent, m, by its name in the constraint.
pub(crate) type Extent<'a> = (&'a str, f64, f64);

/// Returns the extents of an object that a table gives, each with the interval that is meant.
///
/// # Errors
/// Says that the value is no table of extents.
pub(crate) fn extents(c: &Constraint) -> Result<Vec<Extent<'_>>, String> {
    let wrong = || "its dimensions are not figures".to_owned();
    let Value::Table(table) = &c.value else { return Err(wrong()) };
    let extent = |(key, value): (&'_ String, &Json)| {
        match value {
            Json::Number(n) => n.as_f64().map(|v| (v * (1.0 - USUAL), v * (1.0 + USUAL))),
            Json::Array(ends) => Some((ends.first()?.as_f64()?, ends.last()?.as_f64()?)),
            _ => None,
        }
        .filter(|_| matches!(key.as_str(), "width" | "length" | "depth" | "height"))
    };
    let found: Option<Vec<Extent>> =
        table.iter().map(|(k, v)| extent((k, v)).map(|(low, high)| (k.as_str(), low, high))).collect();
    found.filter(|f| !f.is_empty()).ok_or_else(wrong)
}

fn is_rectangle(measure: Measure) -> bool {
    matches!(
        measure,
        Measure::InnerRectangle | Measure::FreeRectangle | Measure::ObjectSize | Measure::ClearFloorAtObject
    )
}

fn one(value: f64, c: &Constraint, measure: Measure) -> Bounds {
    let maximum = match c.constraint_type.as_str() {
        "maximum" => true,
        "minimum" => false,
        _ => measure.advice_is_maximum(),
    };
    if maximum { Bounds::at_most(value) } else { Bounds::at_least(value) }
}

fn interval(min: f64, max: f64, c: &Constraint) -> Bounds {
    match c.constraint_type.as_str() {
        "minimum" => Bounds::at_least(min),
        "maximum" => Bounds::at_most(max),
        _ => Bounds { min: Some(min), max: Some(max), sides: None },
    }
}

fn least(a: Option<f64>, b: f64) -> Option<f64> {
    Some(a.map_or(b, |a: f64| a.min(b)))
}

/// Returns the entry of a table by head count: keys `<=50`, `26-50`, `>220`.
fn by_persons<'a>(entries: impl Iterator<Item = (&'a String, &'a Json)>, persons: u32) -> Option<f64> {
    let mut rows: Vec<(u32, f64)> = Vec::new();
    for (key, value) in entries {
        let upper = match (key.strip_prefix("<="), key.split_once('-')) {
            (Some(n), _) => n.trim().parse().ok()?,
            (_, Some((_, n))) => n.trim().parse().ok()?,
            _ if key.starts_with('>') => continue,
            _ => return None,
        };
        rows.push((upper, value.as_f64()?));
    }
    rows.sort_by_key(|r| r.0);
    rows.iter().find(|(upper, _)| persons <= *upper).map(|r| r.1)
}

/// Returns the least entry of a table by bedrooms: keys `2b`, `2b3p`, and `3-room`, which counts the living room too.
fn by_bedrooms<'a>(entries: impl Iterator<Item = (&'a String, &'a Json)>, bedrooms: u32) -> Option<f64> {
    let rooms = |key: &str| -> Option<u32> {
        match (key.strip_suffix("-room"), key.split_once('b')) {
            (Some(n), _) => n.parse::<u32>().ok()?.checked_sub(1),
            (_, Some((n, _))) => n.parse().ok(),
            _ => None,
        }
    };
    let fits = entries.filter(|(key, _)| rooms(key) == Some(bedrooms));
    fits.filter_map(|(_, value)| value.as_f64()).fold(None, least)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    fn constraint(constraint_type: &str, value: Value) -> Constraint {
        Constraint {
            constraint_id: "c".into(),
            name: "n".into(),
            topic: "t".into(),
            constraint_type: constraint_type.into(),
            value,
            unit: "m".into(),
            measurement_basis: "clear_width".into(),
            space_type: "corridor".into(),
            conditions: Vec::new(),
            confidence: "high".into(),
            verified: "seen".into(),
            original_value: None,
            note: String::new(),
            source_ids: Vec::new(),
            seen_at: None,
            clause: None,
            quotation: None,
            in_force_from: None,
            in_force_until: None,
            superseded_by: None,
        }
    }

    #[test]
    fn tables_by_head_count() {
        let table: BTreeMap<String, Json> =
            [("<=5", 0.9), ("<=20", 1.0), ("<=300", 1.8)].map(|(k, v)| (k.to_owned(), v.into())).into();
        let c = constraint("table", Value::Table(table));
        for (persons, width) in [(3, Some(0.9)), (20, Some(1.0)), (21, Some(1.8)), (999, None)] {
            let found =
                bounds(&c, Measure::CirculationWidth, &Facts { persons, ..Facts::default() }).ok().and_then(|b| b.min);
            assert_eq!(found, width, "{persons} people");
        }
    }

    #[test]
    fn tables_by_bedrooms() {
        let storage = [("1b1p", 1.0), ("1b2p", 1.5), ("2b", 2.0)];
        let bathrooms = [("2-room", 1.0), ("3-room", 2.0), ("3Gen", 3.0)];
        for (rows, bedrooms, value) in [
            (storage.as_slice(), 1, Some(1.0)),
            (&storage, 2, Some(2.0)),
            (&storage, 3, None),
            (&bathrooms, 1, Some(1.0)),
            (&bathrooms, 2, Some(2.0)),
            (&bathrooms, 0, None),
        ] {
            let table = rows.iter().map(|(k, v)| ((*k).to_owned(), (*v).into())).collect();
            let c = constraint("table", Value::Table(table));
            let found = bounds(&c, Measure::RoomsCounted, &Facts { bedrooms, ..Facts::default() });
            assert_eq!(found.ok().and_then(|b| b.min), value, "{bedrooms} bedrooms");
        }
    }

    #[test]
    fn advice_goes_the_way_of_its_quantity() {
        let c = constraint("recommendation", Value::Number(2.0));
        assert_eq!(bounds(&c, Measure::CirculationWidth, &Facts::default()), Ok(Bounds::at_least(2.0)));
        assert_eq!(bounds(&c, Measure::Proportion, &Facts::default()), Ok(Bounds::at_most(2.0)));
        let c = constraint("maximum", Value::Number(2.0));
        assert_eq!(bounds(&c, Measure::CirculationWidth, &Facts::default()), Ok(Bounds::at_most(2.0)));
    }
}
