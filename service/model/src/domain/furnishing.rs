//! What stands in a room, how it is arranged, and which objects stand together.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Domain;
use crate::document::Problem;

/// One line of a room type's furniture list.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Furnishing {
    /// Group id or object id.
    pub item: String,
    /// How many at least.
    pub min: u32,
    /// How many at most.
    pub max: u32,
    /// One more for each so many m^2 of net floor, between `min` and `max`; 0 means `max` when it fits.
    #[serde(default)]
    pub area_per_item_m2: f64,
    /// True when a room without it is not that room (a bedroom without a bed).
    #[serde(default)]
    pub required: bool,
    /// How it is arranged.
    pub arrangement: Arrangement,
    /// Only where none of these items of earlier lines found a place (a small table where the large one does not fit). A
    /// required line is content with them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub instead_of: Vec<String>,
    /// Only in buildings without a room of these types (a dining table in the living room).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unless_rooms: Vec<String>,
    /// Only in buildings with beds for at least so many people.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub sleepers: u32,
    /// Only where step-free access is asked for.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub accessible: bool,
    /// Belongs to a way out: a piece of corridor that has none beside others has no such thing either.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub by_exit: bool,
}

impl Furnishing {
    /// Returns true when the line is for buildings with rooms of these types, with step-free access or without.
    pub fn is_for<'t>(&self, mut room_types: impl Iterator<Item = &'t str>, accessible: bool) -> bool {
        (accessible || !self.accessible) && !room_types.any(|t| self.unless_rooms.iter().any(|u| u == t))
    }
}

fn is_zero(n: &u32) -> bool {
    *n == 0
}

/// Where in the room an item goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Arrangement {
    /// Back to a wall, away from doors; windows only above low things.
    Wall,
    /// Back to a wall without a window if there is one (wardrobes, bed heads).
    SolidWall,
    /// Back to the outer wall, under the window.
    WindowWall,
    /// In a corner, back to a wall.
    Corner,
    /// In the middle of the largest free area.
    Center,
    /// In parallel rows with aisles, filling the room (desks, seats, racks, beds).
    Rows,
    /// Opposite the first item of the room, facing it (a TV and its sofa, a board and its tables).
    Facing,
    /// Beside the door, on the latch side (switch height things, dispensers, coat racks).
    BesideDoor,
    /// On a free surface of the room.
    OnSurface,
    /// On the ceiling, over the middle of the room or its center group.
    Overhead,
    /// In front of a window (curtains, blinds).
    AtWindow,
    /// Facing the door with its back to the far wall or free-standing (a reception counter).
    FacingDoor,
    /// Side by side in one line across the way out, each with a lane beside it: tills, ticket gates, security lanes.
    AtExit,
}

impl Arrangement {
    /// Returns the name that documents have for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Wall => "wall",
            Self::SolidWall => "solid_wall",
            Self::WindowWall => "window_wall",
            Self::Corner => "corner",
            Self::Center => "center",
            Self::Rows => "rows",
            Self::Facing => "facing",
            Self::BesideDoor => "beside_door",
            Self::OnSurface => "on_surface",
            Self::Overhead => "overhead",
            Self::AtWindow => "at_window",
            Self::FacingDoor => "facing_door",
            Self::AtExit => "at_exit",
        }
    }
}

/// Objects that stand together, laid out around an anchor and placed as one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Group {
    /// Snake-case id.
    pub id: String,
    /// Object id of the anchor; the group's front is the anchor's front.
    pub anchor: String,
    /// Free floor before the anchor, m, where the group needs more than the anchor's type does by itself: a passage at the
    /// foot of beds that several patients share.
    #[serde(default)]
    pub clearance_front_m: f64,
    /// Free floor behind the anchor, m: where staff stand at a counter, and the head of a chair that one treats from behind.
    #[serde(default, skip_serializing_if = "is_nothing")]
    pub clearance_back_m: f64,
    /// The others, in order.
    pub members: Vec<Member>,
}

/// One member of a group.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Member {
    /// Object id.
    pub object: String,
    /// Where it stands, in the anchor's own frame (x forward, y left).
    pub relation: Relation,
    /// Distance between the two, m; negative means tucked under (a chair under its table).
    #[serde(default)]
    pub gap_m: f64,
    /// Shift from the default position, m: along the anchor's left (+) for front, back, above; along its front (+) for left, right.
    #[serde(default)]
    pub offset_m: f64,
    /// Which way it faces.
    #[serde(default)]
    pub facing: FacingRule,
    /// How many (for `around`: spread over the long sides first).
    #[serde(default = "one")]
    pub count: u32,
    /// True when the group is useless without it.
    #[serde(default)]
    pub required: bool,
}

fn is_nothing(m: &f64) -> bool {
    *m == 0.0
}

fn one() -> u32 {
    1
}

/// Where a member stands relative to its anchor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Relation {
    /// At the anchor's left side, backs in line.
    Left,
    /// At the anchor's right side, backs in line.
    Right,
    /// Centered in front.
    Front,
    /// Centered behind.
    Back,
    /// On its top, centered; `offset_m` shifts to the left, `gap_m` towards the front.
    On,
    /// On the wall behind it, at its own mount height.
    Above,
    /// Around it, each facing it.
    Around,
    /// On the ceiling over it.
    Over,
    /// On the floor under it, centered (a rug).
    Under,
}

/// Which way a member faces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FacingRule {
    /// As the anchor.
    #[default]
    Same,
    /// Towards the anchor.
    Toward,
    /// Opposite to the anchor.
    Opposite,
}

impl Furnishing {
    /// Returns how many units the line asks for in a room of this net floor area, m^2.
    pub fn units(&self, area_m2: f64) -> u32 {
        if self.area_per_item_m2 <= 0.0 {
            return self.max;
        }
        ((area_m2 / self.area_per_item_m2) as u32).clamp(self.min, self.max)
    }

    pub(super) fn check(&self, path: &str, domain: &Domain, problems: &mut Vec<Problem>) {
        if domain.group(&self.item).is_none() && domain.object(&self.item).is_none() {
            problems.push(Problem::new(
                format!("{path}/item"),
                format!("`{}` is neither in groups nor in objects", self.item),
            ));
        }
        for (i, room_type) in self.unless_rooms.iter().enumerate() {
            if domain.room_type(room_type).is_none() {
                problems.push(Problem::new(
                    format!("{path}/unless_rooms/{i}"),
                    format!("room type `{room_type}` is not in room_types"),
                ));
            }
        }
        for (i, item) in self.instead_of.iter().enumerate() {
            if domain.group(item).is_none() && domain.object(item).is_none() {
                problems.push(Problem::new(
                    format!("{path}/instead_of/{i}"),
                    format!("`{item}` is neither in groups nor in objects"),
                ));
            }
        }
        if self.min > self.max || self.max == 0 {
            problems
                .push(Problem::new(path, format!("needs min <= max and max > 0, has {} and {}", self.min, self.max)));
        }
        if self.required && self.min == 0 {
            problems.push(Problem::new(format!("{path}/min"), "is 0 though the item is required"));
        }
    }
}

impl Group {
    pub(super) fn check(&self, path: &str, domain: &Domain, problems: &mut Vec<Problem>) {
        if domain.object(&self.anchor).is_none() {
            problems
                .push(Problem::new(format!("{path}/anchor"), format!("object `{}` is not in objects", self.anchor)));
        }
        if domain.object(&self.id).is_some() {
            problems.push(Problem::new(
                format!("{path}/id"),
                format!("`{}` is an object too; furnishing could not tell them apart", self.id),
            ));
        }
        for (i, member) in self.members.iter().enumerate() {
            if domain.object(&member.object).is_none() {
                problems.push(Problem::new(
                    format!("{path}/members/{i}/object"),
                    format!("object `{}` is not in objects", member.object),
                ));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrangements_are_called_as_in_documents() {
        let names = "wall solid_wall window_wall corner center rows facing beside_door on_surface overhead at_window facing_door at_exit";
        for name in names.split(' ') {
            let arrangement: Arrangement = serde_json::from_value(name.into()).expect("it is one");
            assert_eq!(arrangement.name(), name);
        }
    }
}
