//! Names of places and how their storeys are counted: data that all share who read what people write.

use std::sync::LazyLock;

use serde::Deserialize;

/// Countries, their divisions and cities: a JSON object a line with `code` (or `codes`, where several share the name),
/// `names`, `city`, and `strict` for names that are common words too.
pub const PLACES: &str = include_str!("gazetteer/places.jsonl");

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct GroundFloor {
    countries: Vec<String>,
    languages: Vec<String>,
}

fn ground_floor() -> &'static GroundFloor {
    static FILE: LazyLock<GroundFloor> = LazyLock::new(|| {
        toml::from_str(include_str!("gazetteer/ground_floor.toml")).expect("a test reads ground_floor.toml")
    });
    &FILE
}

/// Returns true for countries, by ISO 3166-1 code, where the ground floor is the first floor.
///
/// ```
/// assert!(d3dgen_model::gazetteer::first_floor_is_ground("US"));
/// assert!(!d3dgen_model::gazetteer::first_floor_is_ground("GB"));
/// ```
pub fn first_floor_is_ground(country_code: &str) -> bool {
    ground_floor().countries.iter().any(|c| c == country_code)
}

/// Returns true for languages, by ISO 639-1 code, in most of whose countries the ground floor is the first floor.
pub fn first_floor_is_ground_in(language: &str) -> bool {
    ground_floor().languages.iter().any(|l| l == language)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn storeys_are_counted_as_in_the_country() {
        for (country, first) in [("RU", true), ("BY", true), ("KZ", true), ("DE", false), ("FR", false)] {
            assert_eq!(first_floor_is_ground(country), first, "{country}");
        }
        assert!(first_floor_is_ground_in("ja") && !first_floor_is_ground_in("en"));
        assert!(PLACES.lines().all(|l| l.starts_with('{')));
    }
}
