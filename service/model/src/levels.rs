//! Levels of a building and what joins them: the words that documents of every stage have for storeys.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::document::Problem;

/// A storey.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Level {
    /// Its number: 0 at the ground, 1 above it, -1 below it.
    pub level: i32,
    /// Height of its floor above the ground floor's, m.
    pub elevation_m: f64,
    /// From its floor to the floor above, m.
    pub height_m: f64,
}

/// Stairs or an elevator: rooms that lie above each other.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VerticalLink {
    /// Unique id: `stairs_a`.
    #[schemars(regex(pattern = "^[a-z0-9_]+$"))]
    pub link_id: String,
    /// What it is.
    pub kind: LinkKind,
    /// Its rooms from the lowest storey to the highest, one on each.
    pub room_ids: Vec<String>,
}

/// What joins storeys.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LinkKind {
    /// Flights of steps.
    Stairs,
    /// A car in a shaft.
    Elevator,
}

/// Returns true for the number of the ground floor, which documents leave out.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "the form serde calls")]
pub(crate) fn is_ground(level: &i32) -> bool {
    *level == 0
}

/// Checks that links name rooms of `level_of`, each on a storey of its own, one above the other.
pub(crate) fn check_links(links: &[VerticalLink], level_of: impl Fn(&str) -> Option<i32>, problems: &mut Vec<Problem>) {
    crate::document::check_unique("/links", links.iter().map(|l| l.link_id.as_str()), problems);
    for (i, link) in links.iter().enumerate() {
        let mut before: Option<i32> = None;
        for (j, id) in link.room_ids.iter().enumerate() {
            let path = format!("/links/{i}/room_ids/{j}");
            match level_of(id) {
                None => problems.push(Problem::new(path, format!("room `{id}` is not in rooms"))),
                Some(level) if before.is_some_and(|b| level <= b) => {
                    problems.push(Problem::new(path, "is not on a higher storey than the room before it"));
                }
                Some(level) => before = Some(level),
            }
        }
        if link.room_ids.len() < 2 {
            problems.push(Problem::new(format!("/links/{i}/room_ids"), "needs rooms on two storeys or more"));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn link(room_ids: &[&str]) -> VerticalLink {
        let room_ids = room_ids.iter().map(|r| (*r).to_owned()).collect();
        VerticalLink { link_id: "stairs_a".into(), kind: LinkKind::Stairs, room_ids }
    }

    fn problems(room_ids: &[&str]) -> Vec<String> {
        let level_of = |id: &str| match id {
            "stair_1" => Some(0),
            "stair_2" => Some(1),
            _ => None,
        };
        let mut out = Vec::new();
        check_links(&[link(room_ids)], level_of, &mut out);
        out.into_iter().map(|p| format!("{p}")).collect()
    }

    #[test]
    fn links_name_rooms_of_rising_storeys() {
        assert_eq!(problems(&["stair_1", "stair_2"]), Vec::<String>::new());
        let cases = [
            (&["stair_2", "stair_1"][..], "is not on a higher storey"),
            (&["stair_1", "stair_9"], "`stair_9` is not in rooms"),
            (&["stair_1"], "rooms on two storeys"),
        ];
        for (rooms, expected) in cases {
            let found = problems(rooms);
            assert!(found.iter().any(|p| p.contains(expected)), "{rooms:?}: {found:?}");
        }
    }
}
