//! From a request to what it says: the steps of the reading in their order.

use d3dgen_model::stage::Error;
use d3dgen_plugins::Registry;

use super::draft::Draft;
use super::named::styles;
use super::reading::Reading;
use super::request::{MAX_AREA_M2, MAX_ROOMS, Request, refused};
use super::subject::places;
use super::tokens::words::Tag;

/// Reads a request.
///
/// # Errors
/// `Refused` for prompts without words, absurd sizes, unknown domains and countries.
pub(crate) fn read<'a>(request: &Request, registry: &'a Registry) -> Result<Reading<'a>, Error> {
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
    let unread = draft.state_unread(&objects.words, &doors, &parts);
    let understood = draft.understood(&[&objects.words, &doors]);
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
        names: Vec::new(),
        unread,
        understood,
        habitable_fixed: named.habitable_fixed,
        area_m2,
        each_alone: site.lives && (site.shared || named.own_rooms),
        occupancy: people.occupancy,
        residents: people.residents,
        children: people.children,
        pair: people.pair,
        wheelchair: heard.says(Tag::Wheelchair),
        accessible: heard.says(Tag::Accessible) || site.lives && heard.says(Tag::Frail),
        // one robot has one errand
        errands: if robots.len() == 1 { vec![stops.errand] } else { Vec::new() },
        robots,
        robot_rules: orders.rules,
        two_way: orders.two_way,
        docked: stops.docked,
        style,
        assumptions: notes.assumptions,
        conflicts: notes.conflicts,
    })
}

pub(super) fn check_flags(request: &Request, registry: &Registry) -> Result<(), Error> {
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
