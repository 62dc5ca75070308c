//! A prompt understood: every fact it states, before rooms are added or connected.

use std::ops::Range;
use std::sync::Arc;

use d3dgen_model::domain::{Domain, Program};
use d3dgen_model::offer::Wet;
use d3dgen_model::scene_graph::{Note, Occupancy, Robot};
use d3dgen_model::style::Style;

use super::levels::storeys::Storeys;
use super::machines::{robot_rules, robots};
use super::named::objects::Thing;
use super::people::seats::Called;
use super::wished::unread::Unread;
use super::wished::wishes::Wishes;
use crate::people::held::Held;

/// Words that something was made of.
#[derive(Debug, Clone)]
pub(crate) struct Understood {
    /// Where they stand in the prompt.
    pub bytes: Range<usize>,
    /// Type of the room that they name, where they name one.
    pub room_type: Option<String>,
}

/// Facts of a prompt.
#[derive(Clone)]
pub(crate) struct Reading<'a> {
    pub language: &'static str,
    pub domain: &'a Domain,
    /// Which of its rooms have a toilet.
    pub wet: Arc<Wet>,
    pub building_type: Option<String>,
    pub program: &'a Program,
    /// Code of the country, or of the division where one is known (`DE`, `CA-ON`).
    pub country_code: Option<String>,
    pub wishes: Wishes,
    /// Rooms in total, where fixed.
    pub total: Option<u32>,
    /// True when the prompt lists all rooms there are to be.
    pub closed: bool,
    /// True for a list behind the name of a building ("ward with ..."), which what such a building is not without may join.
    pub may_join: bool,
    /// True when the prompt names the building, and the rooms behind that: lists that name none are taken at their word.
    pub named_first: bool,
    /// True when the prompt says that its list is all there is to be: "only".
    pub only: bool,
    /// True when the prompt asks for one room and no building.
    pub single: bool,
    /// Rooms of which the prompt says the beds.
    pub held: Vec<Held>,
    /// Rooms of which it says the places to be treated at.
    pub stationed: Vec<Held>,
    /// Rooms of which it says the seats or counters.
    pub seats: Vec<Held>,
    /// Types of rooms that those who work there are shared out to.
    pub halves: Vec<String>,
    /// What the prompt calls its rooms.
    pub called: Vec<Called>,
    /// What a brief calls its rooms, in buildings of any kind.
    pub names: Vec<Called>,
    /// Words that nothing was made of.
    pub unread: Vec<Unread>,
    /// Where the words stand in the prompt that something was made of.
    pub understood: Vec<Understood>,
    /// True when the prompt counts the rooms to live in ("3-Zimmer-Wohnung", "2BHK").
    pub habitable_fixed: bool,
    pub area_m2: Option<f64>,
    pub occupancy: Occupancy,
    /// People who live there.
    pub residents: Option<u32>,
    /// True when all of them have a room of their own.
    pub each_alone: bool,
    /// True where two of them are a couple.
    pub pair: bool,
    pub accessible: bool,
    pub wheelchair: bool,
    pub style: Style,
    pub robots: Vec<Robot>,
    /// What is asked of robots in rooms.
    pub robot_rules: Vec<robot_rules::Rule>,
    /// True where they pass each other in the corridors.
    pub two_way: bool,
    /// Types of the rooms that a dock is to stand in.
    pub docked: Vec<String>,
    /// Where each of the robots is to go, in their order; none where nothing is said of that.
    pub errands: Vec<robots::Errand>,
    pub storeys: Storeys,
    /// True where someone stays overnight with every patient.
    pub stays: bool,
    /// Objects that the prompt names, each with the room type it is named with.
    pub objects: Vec<Thing>,
    /// Children who live there.
    pub children: u32,
    pub assumptions: Vec<Note>,
    pub conflicts: Vec<Note>,
}

impl Reading<'_> {
    /// Returns true for rooms that the prompt does not rule out.
    pub(crate) fn may_add(&self, room_type: &str) -> bool {
        !self.wishes.forbidden.iter().any(|f| f == room_type)
    }
}
