//! A prompt understood: every fact it states, before rooms are added or connected.

use std::sync::Arc;

use d3dgen_model::domain::{Domain, GENERIC_ROOM_TYPE, Program, Shape};
use d3dgen_model::scene_graph::{Note, Occupancy, Robot};
use d3dgen_model::style::Style;
use d3dgen_plugins::Registry;

use super::built::vital::{self, Wet};
use super::built::workers;
use super::heard::{Heard, Notes};
use super::levels::storeys::{self, Storeys};
use super::levels::wished;
use super::machines::{docks, keeps, robot_rules, robots};
use super::named::aside::Aside;
use super::named::mentions::Mention;
use super::named::objects::Thing;
use super::named::rooms_named::Named;
use super::named::things;
use super::named::{compounds, styles};
use super::people::beds::{self, Held};
use super::people::counted::Counted;
use super::people::heads::People;
use super::people::seats::{self, Called};
use super::people::{ensuites, groups, homes, sharing, stays};
use super::subject::places::{self, note};
use super::subject::programs::program_by_bedrooms;
use super::subject::site::Site;
use super::subject::{parts, practitioners, single};
use super::tokens::text::Span;
use super::tokens::words::{Tag, tag_ends_at, words};
use super::wished::relations::{self, Said};
use super::wished::wishes::{self, Text, Wish, Wishes};
use super::wished::{closed, comparisons, totals, unread};
use super::{MAX_AREA_M2, MAX_ROOMS, Request, refused};
use crate::Error;

/// Robots that fetch and bring: corridors are only their way.
const CARRIES: [&str; 2] = ["delivery", "transport"];

/// Facts of a prompt.
#[derive(Clone)]
pub(super) struct Reading<'a> {
    pub language: &'static str,
    pub domain: &'a Domain,
    /// Which of its rooms have a toilet.
    pub wet: Arc<Wet>,
    pub building_type: Option<String>,
    pub program: &'a Program,
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
    pub style: Style,
    pub robots: Vec<Robot>,
    /// What is asked of robots in rooms.
    pub robot_rules: Vec<robot_rules::Rule>,
    /// True where they pass each other in the corridors.
    pub two_way: bool,
    /// Types of the rooms that a dock is to stand in.
    pub docked: Vec<String>,
    /// Where the robot is to go.
    pub errand: robots::Errand,
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

/// Reads a request.
///
/// # Errors
/// `Refused` for prompts without words, absurd sizes, unknown domains and countries.
pub(super) fn read<'a>(request: &Request, registry: &'a Registry) -> Result<Reading<'a>, Error> {
}

fn check_flags(request: &Request, registry: &Registry) -> Result<(), Error> {
    if let Some(id) = &request.domain
        && registry.get(id).is_none()
    {
        let known: Vec<&str> = registry.iter().map(|p| p.id()).collect();
        return Err(refused(format!("domain `{id}` is not known; known are {}", known.join(", "))));
    }
    if let Some(country) = &request.country
        && places::code_of(country).is_none()
    {
        return Err(refused(format!("country `{country}` is not known; give an ISO 3166-1 code such as DE or US")));
    }
    if let Some(problem) = request.robot.problems().into_iter().next() {
        return Err(refused(problem));
    }
    if let Some(n) = request.rooms.filter(|n| !(1..=MAX_ROOMS).contains(n)) {
        return Err(refused(format!("{n} rooms were asked for; one world has 1 to {MAX_ROOMS} rooms")));
    }
    if let Some(area) = request.area_m2.filter(|a| !(a.is_finite() && (5.0..=MAX_AREA_M2).contains(a))) {
        return Err(refused(format!("an area of {area} m2 was asked for; one world has 5 to {MAX_AREA_M2} m2")));
    }
    if let Some(radius) = request.robot_radius_m.filter(|r| !(r.is_finite() && (0.05..=2.0).contains(r))) {
        return Err(refused(format!("a robot radius of {radius} m was asked for; it must be 0.05 to 2 m")));
    }
    Ok(())
}
