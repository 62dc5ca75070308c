//! Small everyday things on furniture, for buildings that are to look lived in.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Domain;
use crate::document::Problem;

/// One line of what stands on furniture when clutter is asked for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ClutterLine {
    /// Object ids of the furniture; things may stand on their tops whatever their `surface` says.
    pub on: Vec<String>,
    /// Room types it holds in; empty means all but `except`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rooms: Vec<String>,
    /// Room types it does not hold in.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub except: Vec<String>,
    /// Object ids of the things, in the order they are put down; after the last comes the first again.
    pub items: Vec<String>,
    /// How they are arranged.
    pub pattern: ClutterPattern,
    /// How many at least on one piece of furniture (`by_seat`: for each seat).
    pub min: u32,
    /// How many at most.
    pub max: u32,
}

/// How small things are arranged on a top.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ClutterPattern {
    /// Side by side along the back edge, from one end.
    Row,
    /// One on the other at the back, near an end.
    Stack,
    /// Before each seat at the top, beside each other at the edge; before the front where nobody sits.
    BySeat,
    /// One at each end.
    Ends,
    /// Side by side about the middle.
    Middle,
}

impl ClutterPattern {
    /// Returns its snake-case name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Row => "row",
            Self::Stack => "stack",
            Self::BySeat => "by_seat",
            Self::Ends => "ends",
            Self::Middle => "middle",
        }
    }
}

impl ClutterLine {
    /// Returns true when the line holds in rooms of a type.
    pub fn holds_in(&self, room_type: &str) -> bool {
        let named = |list: &[String]| list.iter().any(|r| r == room_type);
        (self.rooms.is_empty() || named(&self.rooms)) && !named(&self.except)
    }

    pub(super) fn check(&self, path: &str, domain: &Domain, problems: &mut Vec<Problem>) {
        for (key, list) in [("on", &self.on), ("items", &self.items)] {
            if list.is_empty() {
                problems.push(Problem::new(format!("{path}/{key}"), "is empty; name at least one object"));
            }
            for (i, id) in list.iter().enumerate().filter(|(_, id)| domain.object(id).is_none()) {
                problems.push(Problem::new(format!("{path}/{key}/{i}"), format!("object `{id}` is not in objects")));
            }
        }
        for (key, list) in [("rooms", &self.rooms), ("except", &self.except)] {
            for (i, id) in list.iter().enumerate().filter(|(_, id)| domain.room_type(id).is_none()) {
                let message = format!("room type `{id}` is not in room_types");
                problems.push(Problem::new(format!("{path}/{key}/{i}"), message));
            }
        }
        if self.min > self.max || self.max == 0 {
            problems
                .push(Problem::new(path, format!("needs min <= max and max > 0, has {} and {}", self.min, self.max)));
        }
    }
}
