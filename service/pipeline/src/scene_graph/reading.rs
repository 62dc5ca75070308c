//! A prompt understood: every fact it states, before rooms are added or connected.

use std::sync::Arc;

use d3dgen_model::domain::{Domain, Program};
use d3dgen_model::scene_graph::{Note, Occupancy, Robot};
use d3dgen_model::style::Style;
use d3dgen_plugins::Registry;

use super::built::vital::Wet;
use super::draft::Draft;
use super::levels::storeys::Storeys;
use super::machines::{robot_rules, robots};
use super::named::objects::Thing;
use super::named::styles;
use super::people::beds::Held;
use super::people::seats::Called;
use super::subject::places;
use super::tokens::words::Tag;
use super::wished::wishes::Wishes;
use super::{MAX_AREA_M2, MAX_ROOMS, Request, refused};
use crate::Error;

/// Facts of a prompt.
#[derive(Clone)]
pub(super) struct Reading<'a> {
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
    check_flags(request, registry)?;
    let mut draft = Draft::of_words(request, registry)?;
    let called = draft.called();
    let doors = draft.doors();
    let stops = draft.stops_of_robots();
    let styles = draft.styles();
    let said = draft.said_of_rooms();
    let area_m2 = draft.wish(&said);
    let storeys = draft.storeys();
    draft.settle_types();
    let robots = draft.robots(&storeys);
    let orders = draft.orders_of_robots();
    let parts = draft.departments();
    let (people, held) = draft.people(&said, parts.beds);
    let total = draft.total()?;
    let style = styles::wished(&styles, request.style, &mut draft.notes.conflicts);
    let list = draft.list(&said, &storeys, total);
    draft.close(&list, &people, style.layout)?;
    let stays = draft.stays();
    draft.take_words(&called);
    let objects = draft.objects(&stops.docked);
    draft.state_unread(&objects.words, &doors, &parts);
    let Draft { heard, site, counted, wishes, named, notes, .. } = draft;
    Ok(Reading {
        language: heard.language,
        domain: site.domain,
        wet: site.wet,
        building_type: site.building.building_type,
        program: site.program,
        country_code: site.country_code,
        storeys,
        stays,
        objects: objects.things,
        wishes,
        total: list.total,
        closed: list.closed,
        may_join: list.may_join,
        named_first: list.named_first,
        only: list.only,
        single: list.single,
        held,
        stationed: counted.stations,
        seats: counted.seats,
        halves: counted.halves,
        called,
        habitable_fixed: named.habitable_fixed,
        area_m2,
        each_alone: site.lives && (site.shared || named.own_rooms),
        occupancy: people.occupancy,
        residents: people.residents,
        children: people.children,
        pair: people.pair,
        wheelchair: heard.says(Tag::Wheelchair),
        accessible: heard.says(Tag::Accessible) || site.lives && heard.says(Tag::Frail),
        robots,
        robot_rules: orders.rules,
        two_way: orders.two_way,
        docked: stops.docked,
        errand: stops.errand,
        style,
        assumptions: notes.assumptions,
        conflicts: notes.conflicts,
    })
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
        return Err(refused(format!(
            "country `{country}` is not known; give an ISO 3166 code such as DE or US-NC, or a name"
        )));
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
