//! Which rooms a building has, how they hang together, and how one moves between them.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::style::Form;

/// The rooms of one archetype, in the order in which they are added when a room count is asked for.
///
/// Rooms are taken from the top: first `min` of every entry (an entry with `min = 0` is skipped), then one more of each
/// entry below its `max` in order, round after round, until the count is reached.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Program {
    /// Snake-case id.
    pub id: String,
    /// Name for people, English.
    pub title: String,
    /// Rooms when the prompt gives no count, without circulation.
    pub default_rooms: u32,
    /// Entries, most important first.
    pub rooms: Vec<ProgramRoom>,
    /// Room types that no such building is without; one toilet stands for another. They join a list of rooms that lacks them;
    /// where the number of rooms is fixed the program's order decides.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub vital: Vec<String>,
    /// Rooms that serve the others: they join a list of rooms that names none of them, and
    /// give way where the number of rooms is fixed or nothing else is wanted.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub support: Vec<SupportRoom>,
    /// Rooms to be treated in from which on staff have a toilet of their own beside that of patients, in such a list; 0 for
    /// never.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub staff_toilet_from: u32,
    /// What large buildings are made of; without it they have more of the same.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub units: Option<Units>,
    /// What large buildings have besides, once for all: where people arrive, what feeds and serves so many.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub large: Vec<Large>,
    /// What words for rooms of other buildings mean in this one: the treatment room of a dental practice is one with a
    /// dental chair. Room type or name as the prompt has it, and the room type that it is here.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub means: BTreeMap<String, String>,
    /// Room types of which there is one where robots work and the rooms are left open, best first: they live there.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub robot_rooms: Vec<String>,
    /// True where everyone of the domain's practitioners has a room to see people in: practices and outpatient clinics.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub practice: bool,
    /// Where the program comes from.
    #[serde(default)]
    pub source: String,
}

/// A room that serves others, and what can stand for it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SupportRoom {
    /// Its room type.
    pub room_type: String,
    /// Room types that do as well.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub or: Vec<String>,
}

impl SupportRoom {
    /// Returns all room types that do, the usual one first.
    pub fn room_types(&self) -> impl Iterator<Item = &String> {
        std::iter::once(&self.room_type).chain(&self.or)
    }
}

/// The units of a large building: wards of a hospital, departments of an office, each with what it needs at hand.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Units {
    /// Rooms of a building from which on it is made of units; those entered from another room are not counted.
    pub from_rooms: u32,
    /// Rooms of a unit, about.
    pub rooms: u32,
    /// Ids of the programs of the second unit and of those after it, again from the first when there are more; the first unit
    /// has the program that these belong to.
    pub programs: Vec<String>,
}

/// Rooms that a building has from a size on, where the prompt leaves its rooms open.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Large {
    /// Rooms of the building from which on it has them; those entered from another room are not counted.
    pub from_rooms: u32,
    /// They, each with what can stand for it.
    pub rooms: Vec<SupportRoom>,
}

/// One line of a program.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProgramRoom {
    /// Room type id.
    pub room_type: String,
    /// How many before any entry gets more.
    pub min: u32,
    /// Never more than this.
    pub max: u32,
    /// Rooms that come with each one (a patient room's en suite); counted as rooms of their own.
    #[serde(default)]
    pub with: Vec<String>,
    /// Whose number `occupants_per_room` and `area_per_occupant_m2` count.
    #[serde(default, skip_serializing_if = "Occupants::is_staff")]
    pub occupants: Occupants,
    /// Adds rooms so that there is one per this many occupants, as the prompt gives them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub occupants_per_room: Option<u32>,
    /// Floor area per occupant, m^2, for rooms that grow with the head count (an open office).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub area_per_occupant_m2: Option<f64>,
    /// Floor area for every person who works there, m^2, of a room that serves them all (a kitchenette, a break room).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub area_per_person_m2: Option<f64>,
    /// In buildings that are to be accessible it comes after so many entries already (the toilet for wheelchairs).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub accessible_after: Option<u32>,
}

/// A head count of a prompt.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Occupants {
    /// Those who work there, or their desks.
    #[default]
    Staff,
    /// Guests, pupils, customers.
    Visitors,
    /// Patients' beds.
    Beds,
    /// Those who live there.
    Residents,
}

impl Occupants {
    fn is_staff(&self) -> bool {
        *self == Self::Staff
    }
}

/// How two room types relate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Adjacency {
    /// Room type id.
    pub a: String,
    /// Room type id.
    pub b: String,
    /// How strong.
    pub relation: AdjacencyRelation,
    /// Connector for `must` and `should`: `door`, `open`, `wall` or `near`. For `must_not`: what is forbidden, `door` or `wall`.
    pub via: String,
    /// Why, one phrase.
    pub reason: String,
    /// Where the rule comes from.
    pub source: String,
    /// Countries where it holds; empty means everywhere.
    #[serde(default)]
    pub jurisdictions: Vec<String>,
}

/// Strength of an adjacency.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AdjacencyRelation {
    /// Hard: every `a` connects to a `b` when the building has one.
    Must,
    /// Wished.
    Should,
    /// Better not.
    ShouldNot,
    /// Hard: no `a` connects so to a `b`.
    MustNot,
}

/// How one moves between rooms.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Circulation {
    /// Room type of the corridor or hall that the engine adds.
    pub room_type: String,
    /// Clear width, m, before constraints raise it.
    pub width_m: f64,
    /// Rooms that serve as the hub instead of a corridor when the program has one (a warehouse hall, a sales floor, a studio).
    #[serde(default)]
    pub hub_room_types: Vec<String>,
    /// Net floor area from which on a home of one storey has a hall, m^2: in a smaller one the room to live in is the way to the
    /// others. Every building has one where it is not said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hall_from_m2: Option<f64>,
    /// Where that figure is from.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub hall_source: String,
    /// Rooms through which one enters the building, best first; without one the corridor has the entrance.
    #[serde(default)]
    pub entrance_room_types: Vec<String>,
    /// Clear width of the entrance door, m.
    pub entrance_width_m: f64,
    /// The two widths of a building through which no bed rolls; those above where it is not said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub without_beds: Option<Ways>,
    /// True when a corridor needs a second way out at its far end.
    #[serde(default)]
    pub second_exit: bool,
    /// Longest way from any place to a way out, m, where the country is not known whose law says it; see `way_out_source`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub way_out_m: Option<f64>,
    /// Where that figure is from.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub way_out_source: String,
    /// Least width of open ground with the building all around that rooms have their light from, m: a narrower hole is a shaft,
    /// without windows or doors. As it is: light falls in at 45 degrees over a wall of one storey across it (3 m), and there is
    /// room to walk; IBC 1205.3.1 is content with 1.83 m.
    #[serde(default = "court_width_m")]
    pub court_width_m: f64,
    /// True where doors to the rooms that robots work in open by themselves, when there are robots; in homes they stand open.
    #[serde(default)]
    pub automatic_doors: bool,
    /// Parts of a building that only those come to whose work it is, through a door across the corridor.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub locked: Vec<LockedPart>,
    /// Layout schemes that suit the domain, best first.
    pub schemes: Vec<Scheme>,
    /// How buildings with several storeys are made; without it the domain has one storey only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub storeys: Option<Storeys>,
}

/// How wide the ways of a building are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ways {
    /// Clear width of circulation, m, before constraints raise it.
    pub width_m: f64,
    /// Clear width of the entrance door, m.
    pub entrance_width_m: f64,
    /// The rule and where it is from.
    pub source: String,
}

impl Circulation {
    /// Returns the clear width of circulation of a building with beds on wheels or without, m, before constraints raise it.
    pub fn width_m(&self, beds: bool) -> f64 {
        self.without_beds.as_ref().filter(|_| !beds).map_or(self.width_m, |w| w.width_m)
    }

    /// Returns the clear width of the entrance door of a building with beds on wheels or without, m, before constraints raise it.
    pub fn entrance_width_m(&self, beds: bool) -> f64 {
        self.without_beds.as_ref().filter(|_| !beds).map_or(self.entrance_width_m, |w| w.entrance_width_m)
    }
}

/// A part of a building behind a lock, with a corridor of its own.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LockedPart {
    /// Name of its corridor on plans, English: `Restricted corridor`.
    pub corridor: String,
    /// Room types that make a building have it; one of them is enough.
    pub because: Vec<String>,
    /// Room types behind the lock that open to a corridor, those of `because` among them where they do.
    pub rooms: Vec<String>,
    /// Room types through which one goes in: they have a door to each side, where the plan allows it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub locks: Vec<String>,
    /// The rule and where it is from, as a reader is told.
    pub source: String,
}

fn court_width_m() -> f64 {
    5.0
}

/// How a building with several storeys is divided and joined.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Storeys {
    /// Stairs, on every storey.
    pub stairs: Stairs,
    /// Elevator, where one is needed.
    #[serde(default)]
    pub elevator: Option<Elevator>,
    /// Floor structure between a ceiling and the floor above it, m.
    pub slab_m: f64,
    /// Room types that belong on the ground floor.
    #[serde(default)]
    pub ground_room_types: Vec<String>,
    /// Room types that belong on the upper floors.
    #[serde(default)]
    pub upper_room_types: Vec<String>,
    /// Room types that every storey should have one of before any has two (toilets).
    #[serde(default)]
    pub each_level_room_types: Vec<String>,
    /// Rooms that a storey gets which would be smaller than the one that stands on it, best first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub carrying_room_types: Vec<String>,
    /// Which buildings have two stairs: those of which one of these speaks that holds in their country.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub two_stairs: Vec<TwoStairs>,
}

impl Storeys {
    /// Returns true for the room types that join storeys: stairwells and elevators.
    pub fn joins(&self, room_type: &str) -> bool {
        self.stairs.room_type == room_type || self.elevator.as_ref().is_some_and(|e| e.room_type == room_type)
    }
}

/// Buildings with a second staircase. Of what is given all must be so; a figure counts for the storeys off the ground.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TwoStairs {
    /// Storeys above ground, the ground floor among them, at least.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from_storeys: Option<u32>,
    /// Floor of the rooms of a storey, at least, m^2.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from_area_m2: Option<f64>,
    /// People on a storey, at least: who works, learns or sleeps there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from_people: Option<u32>,
    /// True where only storeys count that people sleep on.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub asleep: bool,
    /// Where the rule holds, as ISO codes; everywhere when empty.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub jurisdictions: Vec<String>,
    /// The rule and where it is from, as a reader is told.
    pub source: String,
}

/// Stairs of two flights side by side with a landing between.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stairs {
    /// Room type of the stairwell.
    pub room_type: String,
    /// Object that stands for both flights.
    pub object: String,
    /// Clear width of a flight, m.
    pub flight_width_m: f64,
    /// Depth of the landings, m.
    pub landing_m: f64,
    /// Depth of the stairwell's own floor before the first step, m: less than a landing where it is open to a hall that serves as
    /// one; a landing when absent.
    #[serde(default)]
    pub before_m: Option<f64>,
    /// Greatest rise of a step, m.
    pub rise_m: f64,
    /// Going of a step, m.
    pub going_m: f64,
    /// Where the figures come from.
    pub source: String,
}

/// An elevator.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Elevator {
    /// Room type of the shaft.
    pub room_type: String,
    /// Clear width of the shaft, along the wall with the door, m.
    pub shaft_width_m: f64,
    /// Clear depth of the shaft, m.
    pub shaft_depth_m: f64,
    /// Storeys from which on a building has one even unasked; absent where it must be asked for.
    #[serde(default)]
    pub from_levels: Option<u32>,
    /// Where the figures come from.
    pub source: String,
}

impl Stairs {
    /// Returns the number of rises between two floors, always even: two flights of the same length.
    pub fn rises(&self, height_m: f64) -> u32 {
        2 * (height_m / (2.0 * self.rise_m) - 1e-6).ceil().max(1.0) as u32
    }

    /// Returns the clear width of each of two flights that are `width_m` together.
    pub fn flight_width_of(&self, width_m: f64) -> f64 {
        (width_m - WELL_M) / 2.0
    }

    /// Returns the clear width and depth of the stairwell for floors this far apart, m.
    pub fn size_m(&self, height_m: f64) -> (f64, f64) {
        let treads = f64::from(self.rises(height_m) / 2 - 1);
        (2.0 * self.flight_width_m + WELL_M, self.floor_before_m() + self.landing_m + treads * self.going_m)
    }

    /// Returns the depth of the floor between the way into the stairwell and its first step, m.
    pub fn floor_before_m(&self) -> f64 {
        self.before_m.unwrap_or(self.landing_m)
    }
}

/// Gap between two flights, m.
const WELL_M: f64 = 0.1;

/// A family of plans.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Scheme {
    /// Rooms on both sides of a straight corridor, or of a hub room.
    Straight,
    /// A straight corridor that ends in a large room at the facade.
    Capped,
    /// Two wings at a right angle.
    Angle,
    /// A ring of corridors around a core of service rooms.
    Racetrack,
    /// A ring of corridors around an open court, with rooms outside of it and on the court.
    Courtyard,
    /// Several wings off one spine, with courtyards between.
    Comb,
}

impl Scheme {
    /// Rooms up to which a building stays in one body.
    pub const MOST_WHOLE: usize = 50;

    /// Returns the scheme of a form, and from how many rooms to how many on a storey it can be built.
    pub fn of(form: Form) -> (Self, [usize; 2]) {
        match form {
            Form::Linear => (Self::Straight, [1, Self::MOST_WHOLE]),
            Form::LShaped => (Self::Angle, [5, Self::MOST_WHOLE]),
            Form::Racetrack => (Self::Racetrack, [10, Self::MOST_WHOLE + 30]),
            Form::Courtyard => (Self::Courtyard, [6, Self::MOST_WHOLE + 30]),
            Form::Wings => (Self::Comb, [10, usize::MAX]),
        }
    }

    /// Returns true for a form that is a ring of corridors, and can be built with this many rooms on a storey.
    pub fn runs_around(form: Form, rooms: usize) -> bool {
        let (scheme, [least, most]) = Self::of(form);
        scheme.is_ring() && (least..=most).contains(&rooms)
    }

    /// Returns true where the corridors run all the way round.
    pub fn is_ring(self) -> bool {
        matches!(self, Self::Racetrack | Self::Courtyard)
    }
}

fn is_zero(n: &u32) -> bool {
    *n == 0
}
