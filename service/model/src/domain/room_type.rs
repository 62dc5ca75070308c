//! What a room of one type needs: size, daylight, access, doors, materials, furniture, robots.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Domain, Furnishing, Words};
use crate::document::Problem;

/// A kind of room.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RoomType {
    /// Snake-case id, singular: `patient_room`.
    pub id: String,
    /// Name on plans, English: `Patient room`.
    pub label: String,
    /// What the room is for, one sentence.
    pub description: String,
    /// Words that name the room in prompts, singular and plural where they differ.
    #[serde(default)]
    pub keywords: Words,
    /// `space_type` names under which the knowledge base speaks of this room, besides the id itself.
    #[serde(default)]
    pub spaces: Vec<String>,
    /// Which part of the building it belongs to.
    pub zone: Zone,
    /// Who may pass through it.
    pub privacy: Privacy,
    /// What the room is beside what the other fields say ([`super::tags::GIVEN`]): `treatment`, `wait`, `eat`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<String>,
    /// Net floor area, m^2.
    pub area_m2: AreaRange,
    /// Least clear extent in both directions, m.
    pub min_dimension_m: f64,
    /// Whether it needs an outer wall with a window.
    pub daylight: Daylight,
    /// True for windows above what stands at the outer wall: places to be treated at have their heads to it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub high_windows: bool,
    /// Where its door leads.
    pub access: Access,
    /// Room types it may be entered from when `access` is `host` (an en suite: `bedroom`).
    #[serde(default)]
    pub hosts: Vec<String>,
    /// How many rooms of one type are entered from it, each from one of its own where it is not said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub guests: Option<u32>,
    /// Room types that lie behind it wherever both are there, whether the prompt says so or not, those that need it most first: the
    /// isolation room behind an airlock, the live room behind a sound lock. They may be of other domains.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub locks: Vec<String>,
    /// True when it holds plumbing: such rooms are put back to back.
    #[serde(default)]
    pub wet: bool,
    /// Clear width of its door, m, before constraints raise it.
    pub door_width_m: f64,
    /// Net floor area that it has at least where step-free access is asked for, m^2; 0 where that changes nothing.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub step_free_m2: f64,
    /// Least clear extent in both directions where step-free access is asked for, m; 0 where that changes nothing.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub step_free_dimension_m: f64,
    /// True when its door slides: into small wet rooms, so that one gets to whoever has fallen behind it, and into galleys.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub sliding_door: bool,
    /// True when it opens to the circulation without a door leaf (a nurse station, a lobby).
    #[serde(default)]
    pub open_front: bool,
    /// Clear width of a door to outdoors that it has beside the building's entrance, m (an ambulance entrance); none where
    /// it is not said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outdoor_door_m: Option<f64>,
    /// Clear height, m.
    pub ceiling_height_m: f64,
    /// Surface materials, Arena names.
    pub materials: Materials,
    /// What robots do here.
    #[serde(default)]
    pub robot: Vec<RobotUse>,
    /// What robots bring there or take away: they visit rooms with clean goods first and those with soiled ones last.
    #[serde(default, skip_serializing_if = "Goods::is_usual")]
    pub goods: Goods,
    /// What stands in it, most important first.
    #[serde(default)]
    pub furnishing: Vec<Furnishing>,
    /// Words for what a prompt counts such a room by, singular and plural: "60 cars", "40 racks", "80 cows". The number is how many
    /// units of the first furnishing line there are, or the people who sit at them; the floor follows from it.
    #[serde(default, skip_serializing_if = "Words::is_empty")]
    pub places: Words,
    /// Words for rooms of this type where the building's program has them, and for nothing in others: "four gates" of an
    /// airport, "three engines" of a fire station.
    #[serde(default, skip_serializing_if = "Words::is_empty")]
    pub called: Words,
}

/// How clean what robots carry to and from a room is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Goods {
    /// Must not be soiled: linen, medicine, food, sterile supplies.
    Clean,
    /// Neither.
    #[default]
    Usual,
    /// Soils what comes after: waste, used linen, floors of toilets.
    Soiled,
}

impl Goods {
    fn is_usual(&self) -> bool {
        *self == Self::Usual
    }
}

/// Part of the building, used to group rooms and to color plans.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Zone {
    /// Living by day; work areas of offices.
    Day,
    /// Sleeping; patient care.
    Night,
    /// Visitors.
    Public,
    /// Staff only.
    Staff,
    /// Bathrooms, kitchens, stores and technical rooms.
    Service,
    /// Corridors and halls.
    Circulation,
    /// Balconies, loading yards.
    Outdoor,
}

/// Who may pass through a room on the way to another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Privacy {
    /// Anybody: halls, living rooms, lobbies, open-plan areas.
    Public,
    /// Only those who work there: a laboratory, a kitchen.
    Shared,
    /// Nobody: bedrooms, bathrooms, single offices, patient rooms, stores.
    Private,
}

/// Least, usual and largest net floor area, m^2.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AreaRange {
    /// Least, m^2.
    pub min: f64,
    /// Usual, m^2.
    pub target: f64,
    /// Largest, m^2.
    pub max: f64,
}

/// Need for an outer wall with a window.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Daylight {
    /// A hard rule.
    Required,
    /// Good to have.
    Preferred,
    /// Works inside, with windows where it lies at an outer wall anyway.
    Optional,
    /// Better inside: dark rooms, stores, wet cells.
    None,
}

/// Where a room's door leads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Access {
    /// To the corridor, the hall or the hub room.
    Circulation,
    /// To the room it belongs to (en suite, walk-in closet, anteroom of an isolation room).
    Host,
}

/// Arena material names (`Concrete_Smooth`, `Oak_Planks`, ...).
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Materials {
    /// Floor.
    pub floor: String,
    /// Walls.
    pub wall: String,
    /// Ceiling.
    pub ceiling: String,
}

/// What a robot does in a room.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RobotUse {
    /// Cleaned often.
    CleaningHigh,
    /// Cleaned seldom.
    CleaningLow,
    /// Delivers or serves here.
    Service,
    /// Suits a charging dock.
    Charging,
    /// Has floor for goods that robots put down and take up.
    Staging,
    /// Robots stay out.
    KeepOut,
}

impl RoomType {
    /// Returns true where a room of this type may be entered through one of another type alone, because it is given to that one: its
    /// en suite, its closet, its balcony, and what lies behind its anteroom. Nobody goes to the preparation through the operating
    /// room, which is private, nor anywhere through a bathroom.
    pub fn may_hang_on(&self, host: &Self) -> bool {
        let by_type = |inner: &Self, outer: &Self| inner.access == Access::Host && inner.hosts.contains(&outer.id);
        let closet = self.zone == Zone::Night && self.daylight == Daylight::None;
        let own = (self.wet || closet || self.zone == Zone::Outdoor) && !host.wet;
        let locked = host.locks.contains(&self.id);
        by_type(self, host) || by_type(host, self) || host.privacy != Privacy::Private || own || locked
    }

    pub(super) fn check(&self, path: &str, domain: &Domain, problems: &mut Vec<Problem>) {
        let a = self.area_m2;
        if !(0.0 < a.min && a.min <= a.target && a.target <= a.max) {
            problems.push(Problem::new(
                format!("{path}/area_m2"),
                format!("needs 0 < min <= target <= max, has {} / {} / {} m2", a.min, a.target, a.max),
            ));
        }
        if self.min_dimension_m <= 0.0 || self.min_dimension_m.powi(2) > a.max {
            problems.push(Problem::new(
                format!("{path}/min_dimension_m"),
                format!("{} m squared must be above 0 and fit in area_m2.max ({} m2)", self.min_dimension_m, a.max),
            ));
        }
        if !(0.6..=4.0).contains(&self.door_width_m) {
            problems.push(Problem::new(
                format!("{path}/door_width_m"),
                format!("{} m is outside 0.6-4.0 m", self.door_width_m),
            ));
        }
        if !(2.0..=20.0).contains(&self.ceiling_height_m) {
            problems.push(Problem::new(
                format!("{path}/ceiling_height_m"),
                format!("{} m is outside 2.0-20.0 m", self.ceiling_height_m),
            ));
        }
        if (self.access == Access::Host) == self.hosts.is_empty() {
            problems.push(Problem::new(
                format!("{path}/hosts"),
                "access `host` names its hosts, access `circulation` has none",
            ));
        }
        for (i, tag) in self.tags.iter().enumerate().filter(|(_, tag)| !super::tags::is_known(tag)) {
            let message = format!("`{tag}` is no tag; those that are given are {}", super::tags::GIVEN.join(", "));
            problems.push(Problem::new(format!("{path}/tags/{i}"), message));
        }
        for (i, host) in self.hosts.iter().enumerate() {
            if domain.room_type(host).is_none() {
                problems.push(Problem::new(
                    format!("{path}/hosts/{i}"),
                    format!("room type `{host}` is not in room_types"),
                ));
            }
        }
        let counted = self.furnishing.first().is_some_and(|f| f.required && f.max > 1 && f.area_per_item_m2 > 0.0);
        if !self.places.is_empty() && !counted {
            problems.push(Problem::new(
                format!("{path}/places"),
                "counts the units of the first furnishing line, which has to be required, to have a max above 1 and an area_per_item_m2",
            ));
        }
        for (i, f) in self.furnishing.iter().enumerate() {
            f.check(&format!("{path}/furnishing/{i}"), domain, problems);
        }
    }
}

fn is_zero(area: &f64) -> bool {
    *area == 0.0
}
