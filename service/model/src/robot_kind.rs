//! Kinds of robots, from `data/robot_kinds.toml`: their usual body and what they do in rooms.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use serde::Deserialize;

/// A typical robot of a kind.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotKind {
    /// Radius of the circle it turns in, m.
    pub radius_m: f64,
    /// Height, m.
    pub height_m: f64,
    /// Time it works with a full battery, s.
    charge_s: f64,
    /// It visits rooms to clean their floor.
    #[serde(default)]
    cleans: bool,
    /// It brings things to where it stops.
    #[serde(default = "yes")]
    brings: bool,
}

fn yes() -> bool {
    true
}

static KINDS: LazyLock<BTreeMap<String, RobotKind>> =
    LazyLock::new(|| toml::from_str(include_str!("../data/robot_kinds.toml")).expect("a test reads robot_kinds.toml"));

/// Returns the typical robot of a kind that is known.
pub fn typical(kind: &str) -> Option<&'static RobotKind> {
    KINDS.get(kind)
}

/// Returns the kinds that are known, in the order of the alphabet.
pub fn names() -> Vec<&'static str> {
    KINDS.keys().map(String::as_str).collect()
}

/// How fast robots drive among people, m/s (the usual limit of indoor service robots, EN 1525 and ISO 3691-4 give 0.3 to 1.2).
pub const WORK_M_S: f64 = 0.8;

/// Returns how long a robot of a kind works with a full battery, s; that of robots that carry things where the kind is not known.
pub fn charge_s(kind: &str) -> f64 {
    typical(kind).or_else(|| typical("delivery")).map_or(f64::INFINITY, |body| body.charge_s)
}

/// Returns true for a kind of robot that visits rooms to clean their floor.
pub fn cleans(kind: &str) -> bool {
    typical(kind).is_some_and(|body| body.cleans)
}

/// Returns true for a kind of robot that brings things to where it stops, as one does that nothing is known of.
pub fn brings(kind: &str) -> bool {
    typical(kind).is_none_or(|body| body.brings)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_say_what_they_do() {
        assert_eq!(names(), ["cleaning", "delivery", "disinfection", "service", "transport"]);
        for (kind, does) in [("cleaning", [true, false]), ("delivery", [false, true]), ("guide", [false, true])] {
            assert_eq!([cleans(kind), brings(kind)], does, "{kind}");
            assert!((3600.0..=43_200.0).contains(&charge_s(kind)), "{kind}");
        }
    }
}
