//! What a domain does when an open or a cellular layout is asked for.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Domain;
use crate::document::Problem;
use crate::style::LayoutStyle;

/// Rooms that flow into each other in an open layout, and rooms that stand for others in either.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Layouts {
    /// Pairs of room types that an open layout joins by an opening.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub open_joins: Vec<[String; 2]>,
    /// Rooms of the program that give way to others; rooms that the prompt names never do.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub swaps: Vec<LayoutSwap>,
}

/// A room of the program that gives way to others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LayoutSwap {
    /// In which layout.
    pub layout: LayoutStyle,
    /// Room type that gives way.
    pub from: String,
    /// Room type that takes its place.
    pub to: String,
    /// People in each of the new rooms, where the old one holds some.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub occupants: Option<u32>,
    /// New rooms for each old one where no number of people is known.
    #[serde(default = "one")]
    pub rooms: u32,
}

fn one() -> u32 {
    1
}

impl Layouts {
    /// Returns true when the domain says nothing of either layout.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Returns true when the domain has something to do in a layout.
    pub fn knows(&self, layout: LayoutStyle) -> bool {
        self.swaps.iter().any(|s| s.layout == layout) || layout == LayoutStyle::Open && !self.open_joins.is_empty()
    }

    pub(super) fn check(&self, domain: &Domain, problems: &mut Vec<Problem>) {
        let mut room = |path: String, id: &str| {
            if domain.room_type(id).is_none() {
                problems.push(Problem::new(path, format!("room type `{id}` is not in room_types")));
            }
        };
        for (i, pair) in self.open_joins.iter().enumerate() {
            pair.iter().enumerate().for_each(|(j, id)| room(format!("/layouts/open_joins/{i}/{j}"), id));
        }
        for (i, swap) in self.swaps.iter().enumerate() {
            room(format!("/layouts/swaps/{i}/from"), &swap.from);
            room(format!("/layouts/swaps/{i}/to"), &swap.to);
        }
        for (i, swap) in self.swaps.iter().enumerate() {
            if swap.rooms == 0 || swap.occupants == Some(0) {
                problems.push(Problem::new(format!("/layouts/swaps/{i}"), "rooms and occupants are 1 at least"));
            }
        }
    }
}
