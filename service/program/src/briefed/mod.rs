//! From a brief to what the building of its rooms starts from: the door for everyone who states facts and writes no sentence.
//!
//! Facts become the same [`Draft`] that the words of a prompt become: each named room or head count is a mention of its own,
//! and how they lie is said of mentions. All that follows from who sleeps, works and lives there is then as ever. Facts that
//! nothing here plans are left to the report, which answers each.

mod lost;
mod machines;
mod site;
mod unknown;
mod wishes;

use std::sync::LazyLock;

use d3dgen_model::brief::{Brief, Fact, PeopleAsk};
use d3dgen_model::domain::{Domain, GENERIC_ROOM_TYPE};
use d3dgen_model::scene_graph::Note;
use d3dgen_model::stage::Error;
use d3dgen_plugins::Registry;
use serde::Deserialize;

pub(crate) use self::lost::restore;
pub use self::unknown::says_nothing;
use self::wishes::Facts;
use super::draft::{Draft, List};
use super::heard::{Heard, Notes};
use super::named::aside::Aside;
use super::named::mention::{Mention, What};
use super::named::objects::Thing;
use super::named::rooms_named::Named;
use super::named::styles;
use super::people::counted::Counted;
use super::people::held::Held;
use super::read::check_flags;
use super::reading::Reading;
use super::request::{MAX_AREA_M2, Request, refused};
use super::subject::building::Building;
use super::subject::places;
use super::subject::programs::{is_dwelling, program_of};
use super::subject::site::Site;
use super::tokens::text::Span;
use super::wished::closed;
use super::wished::relations::Said;
use super::wished::wishes::{Wish, Wishes};

/// Rooms that make a list of a building of which no word says what it is.
const LEAST_LISTED: usize = 3;

/// Roles of people, from `roles.toml`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Roles {
    visitors: Vec<String>,
    patients: Vec<String>,
    anybody: Vec<String>,
    children: Vec<String>,
    all_rooms_counted_in: Vec<String>,
    unknown_building: UnknownBuilding,
}

/// What an unknown kind of building is planned as.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct UnknownBuilding {
    domain: String,
    building_type: String,
}

fn roles() -> &'static Roles {
    static ALL: LazyLock<Roles> =
        LazyLock::new(|| toml::from_str(include_str!("roles.toml")).expect("a test reads roles.toml"));
    &ALL
}

/// Reads a brief.
///
/// # Errors
/// `Refused` for a kind of building that no domain knows, absurd sizes, unknown domains and countries in the request.
pub(crate) fn read<'a>(brief: &Brief, request: &Request, registry: &'a Registry) -> Result<Reading<'a>, Error> {
    check_flags(request, registry)?;
    let mut notes = Notes::default();
    let site = site_of(brief, request, registry, &mut notes)?;
    let facts = Facts::of(brief, site.domain, registry);
    let mentions = mentions_of(&facts);
    let heard = Heard::of_facts(brief, mentions.len());
    let aside = Aside::empty(&heard, site.domain, registry);
    let counted = Counted { seats: facts.seats.clone(), desks: facts.desks.clone(), ..Counted::default() };
    let named = Named { mentions, words: Vec::new(), no_things: Vec::new(), own_rooms: false, habitable_fixed: false };
    let (wishes, on_each) = (facts.wishes.clone(), Vec::new());
    let mut draft = Draft { request, registry, heard, notes, site, aside, named, counted, wishes, on_each };
    let said = Said::default();
    let mut storeys = facts.storeys(&mut draft.notes.conflicts);
    draft.furnish_storeys(&mut storeys);
    draft.settle_types();
    let robots = machines::robots(brief, request, &draft.wishes, &mut draft.notes);
    let (people, held) = draft.people(&said, None);
    let total = draft.total()?;
    let style = styles::wished(&facts.styles, request.style, &mut draft.notes.conflicts);
    let list = list_of(&facts, &draft, total);
    draft.close(&list, &people, style.layout)?;
    let area_m2 = request.area_m2.or(facts.area_m2).filter(|a| (5.0..=MAX_AREA_M2).contains(a));
    let Draft { heard, site, counted, wishes, notes, .. } = draft;
    let language = heard.language;
    let keep_out = machines::keep_out(brief, &facts);
    let errands = machines::errands(brief, &facts);
    Ok(Reading {
        language,
        domain: site.domain,
        wet: site.wet,
        building_type: site.building.building_type,
        program: site.program,
        country_code: site.country_code,
        storeys,
        stays: false,
        objects: facts.things,
        wishes,
        total: list.total,
        closed: list.closed,
        may_join: list.may_join,
        named_first: list.named_first,
        only: list.only,
        single: list.single,
        held: [held, facts.beds].concat(),
        stationed: facts.stations,
        seats: counted.seats,
        halves: Vec::new(),
        called: Vec::new(),
        names: facts.called,
        unread: Vec::new(),
        understood: Vec::new(),
        habitable_fixed: false,
        area_m2,
        each_alone: site.lives && site.shared,
        occupancy: people.occupancy,
        residents: people.residents,
        children: facts.children,
        pair: false,
        accessible: facts.accessible,
        wheelchair: false,
        robots,
        robot_rules: keep_out,
        two_way: false,
        docked: Vec::new(),
        errands,
        style,
        assumptions: notes.assumptions,
        conflicts: notes.conflicts,
    })
}

/// Returns what the brief is about: the domain of the request, else of the brief, else the one that knows most of its rooms.
fn site_of<'a>(brief: &Brief, request: &Request, registry: &'a Registry, notes: &mut Notes) -> Result<Site<'a>, Error> {
    let named = brief.building.as_ref();
    let free = request.domain.is_none();
    let stand = match named.filter(|b| free && b.domain.is_none()) {
        Some(unknown) => Some(unknown::stand_in(&unknown.name, brief, registry, notes)?),
        None if free && says_nothing(brief) => return Err(unknown::nothing_said(brief, registry)),
        None => None,
    };
    let known = named.and_then(|b| b.domain.as_deref()).or(stand.as_ref().map(|s| s.domain.as_str()));
    let wanted = request.domain.as_deref().or(known);
    let id = match wanted {
        Some(id) => id.to_owned(),
        None => {
            let id = domain_by_rooms(brief, registry).ok_or_else(|| refused("no domain is registered".into()))?;
            let message = format!("the prompt names no building; its rooms suggest domain {id}");
            notes.assumptions.push(Note::new("domain_from_rooms", message));
            id
        }
    };
    if free && !facts_name_a_building(brief) {
        notes.assumptions.extend(unknown::guessed(brief, registry));
    }
    let plugin = registry.get(&id).ok_or_else(|| refused(format!("domain `{id}` is not registered")))?;
    let domain = plugin.domain();
    let own_type = named.filter(|b| b.domain.as_deref() == Some(&id)).and_then(|b| b.building_type.clone());
    let own_type = own_type.or(stand.map(|s| s.building_type));
    let own_type = site::in_a_row(brief, domain, own_type.as_deref()).or(own_type);
    let building = Building { building_type: own_type, ..Building::none(&id) };
    let program = program_of(domain, building.building_type.as_deref());
    let flag = request.country.as_deref().and_then(places::code_of);
    let country_code = flag
        .or_else(|| brief.place.as_ref().map(|p| p.division_code.clone().unwrap_or_else(|| p.country_code.clone())));
    Ok(Site::of_facts(domain, program, building, country_code, registry))
}

/// Returns true for a brief that says what is built, and does not leave that to be guessed from the rooms.
fn facts_name_a_building(brief: &Brief) -> bool {
    brief.building.as_ref().is_some_and(|b| !b.words.is_empty() || b.confidence >= 1.0)
}

/// Returns the domain that knows most of the rooms of a brief, the first of equals.
fn domain_by_rooms(brief: &Brief, registry: &Registry) -> Option<String> {
    let ids: Vec<&str> = brief.asks.iter().filter_map(|a| room_id(&a.fact)).collect();
    let known = |d: &Domain| ids.iter().filter(|id| d.room_type(id).is_some()).count();
    let domains = registry.iter().map(|p| p.domain());
    domains.min_by_key(|d| std::cmp::Reverse(known(d))).map(|d| d.id.clone())
}

fn room_id(fact: &Fact) -> Option<&str> {
    if let Fact::Rooms(rooms) = fact { rooms.room.id.as_deref() } else { None }
}

/// Returns a mention for each room and each head count of the facts.
fn mentions_of(facts: &Facts) -> Vec<Mention> {
    let counted = |w: &Wish| (!facts.open.contains(&w.room_type)).then_some(w.count);
    let rooms = facts.wishes.wishes.iter();
    let rooms = rooms.map(|w| (What::Room(w.room_type.clone()), counted(w), facts.beds_of(&w.room_type)));
    let heads = facts.heads.iter().map(|(what, n)| (what.clone(), Some(*n), None));
    let mention = |(i, (what, count, beds)): (usize, (What, Option<u32>, Option<u32>))| {
        let at = Heard::place_of(i);
        let span = Span { start: at, end: at + 1 };
        let plural = count.is_none_or(|n| n > 1);
        Mention { count: count.map(i64::from), plural, beds, ..Mention::plain(span, what) }
    };
    rooms.chain(heads).enumerate().map(mention).collect()
}

/// Returns what the list of rooms says of those it does not name. A list adds to what such a building has unless the brief
/// says that it is all.
fn list_of(facts: &Facts, draft: &Draft, total: Option<u32>) -> List {
    let wishes = &draft.wishes.wishes;
    let single = facts.single && wishes.len() == 1 && wishes[0].count == 1 && total.is_none_or(|n| n == 1);
    let whole = || closed::is_whole(&draft.wishes, false, (draft.site.domain, draft.site.lives));
    // a list of rooms of a kind of building that nobody knows is all there is: no other kind's rooms join it
    let alone = || !facts.named && wishes.iter().filter(|w| w.listed).count() >= LEAST_LISTED;
    let closed = single || facts.closed || facts.named && whole() || alone();
    List {
        total: total.filter(|_| !single),
        single,
        closed,
        only: facts.closed,
        may_join: !facts.closed && facts.named,
        named_first: facts.named,
        main_joins: facts.named || !facts.heads.is_empty(),
    }
}

/// Returns what a head count is of in a building.
fn what_of(people: &PeopleAsk, lives: bool) -> What {
    let among = |list: &[String]| list.contains(&people.role);
    if lives {
        return What::Residents;
    }
    let roles = roles();
    let kinds = [(&roles.visitors, What::Visitors), (&roles.patients, What::Beds), (&roles.anybody, What::People)];
    kinds.into_iter().find(|(list, _)| among(list)).map_or(What::Staff, |(_, what)| what)
}

#[cfg(test)]
mod tests;
