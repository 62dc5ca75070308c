//! What a prompt is about, before any of its rooms is read: place, robots, building, and so the domain and its program.

use std::sync::Arc;

use d3dgen_model::domain::{Domain, Program};
use d3dgen_model::offer::Wet;
use d3dgen_model::scene_graph::Note;
use d3dgen_model::stage::Error;
use d3dgen_plugins::Registry;

use super::building::{self, Building};
use super::programs::{is_dwelling, program_of};
use super::{addresses, places, practitioners};
use crate::heard::{Heard, Notes};
use crate::machines::robots::{self, Robots};
use crate::people::beds;
use crate::request::{Request, refused};
use crate::tokens::text::{MAX_TOKENS, Span};
use crate::tokens::words::{Tag, words};
use crate::wished::unread;

/// What a prompt is about.
pub(crate) struct Site<'a> {
    /// Country of the request, else of the prompt.
    pub country_code: Option<String>,
    /// Words for places.
    pub places: Vec<Span>,
    pub machines: Robots,
    pub building: Building,
    pub domain: &'a Domain,
    pub program: &'a Program,
    /// Which rooms of the domain have a toilet.
    pub wet: Arc<Wet>,
    /// True for buildings that people live in.
    pub lives: bool,
    /// True for those that people share who have a room each.
    pub shared: bool,
}

impl<'a> Site<'a> {
    /// Reads what a prompt is about.
    ///
    /// # Errors
    /// `Refused` without any domain.
    pub(crate) fn of(
        heard: &Heard,
        request: &Request,
        registry: &'a Registry,
        notes: &mut Notes,
    ) -> Result<Self, Error> {
        let Heard { prompt, tokens, language, spoken, .. } = heard;
        let mut place = places::locate(tokens, prompt, spoken);
        place.spans.extend(addresses::find(tokens, spoken));
        notes.assumptions.append(&mut place.assumptions);
        notes.conflicts.append(&mut place.conflicts);
        if tokens.len() >= MAX_TOKENS {
            let message = format!("only the first {MAX_TOKENS} words of the prompt were read");
            notes.conflicts.push(Note::new("prompt_cut", message));
        }
        let flag_country = country_of(request, place.country_code.as_deref(), notes);
        let machines = robots::find(tokens, spoken, language);
        let docks_and_robots = machines.spans.iter().chain(&machines.docks);
        let elsewhere: Vec<Span> = place.spans.iter().chain(docks_and_robots).copied().collect();
        let building = building_of(heard, request, registry, &elsewhere, notes);
        if place.country_code.is_none() && notes.conflicts.iter().all(|n| !n.code.ends_with("_place")) {
            let told = (*language, &building.words[..]);
            let (code, span) = places::of_building(tokens, spoken, told, &mut notes.assumptions).unzip();
            place.country_code = code;
            place.spans.extend(span);
        }
        if let Some(name) = heard.strange {
            let message = format!(
                "the prompt seems to be in {name}, which is not read; only what looks like a language that is was taken from it (English, German, French, Spanish, Chinese, Korean)"
            );
            notes.assumptions.push(Note::new("language_not_read", message));
        }
        let plugin = registry.get(&building.domain).ok_or_else(|| refused("no domain is registered".into()))?;
        let domain = plugin.domain();
        let program = program_of(domain, building.building_type.as_deref());
        Ok(Self {
            country_code: flag_country.or(place.country_code),
            places: place.spans,
            machines,
            domain,
            program,
            wet: registry.digest(&domain.id, || Wet::of(domain)),
            lives: is_dwelling(program),
            shared: building.building_type.as_ref().is_some_and(|b| words().dwelling.shared.contains(b)),
            building,
        })
    }

    /// Returns what a brief is about.
    pub(crate) fn of_facts(
        domain: &'a Domain,
        program: &'a Program,
        building: Building,
        country_code: Option<String>,
        registry: &Registry,
    ) -> Self {
        Self {
            country_code,
            places: Vec::new(),
            machines: Robots::default(),
            domain,
            program,
            wet: registry.digest(&domain.id, || Wet::of(domain)),
            lives: is_dwelling(program),
            shared: building.building_type.as_ref().is_some_and(|b| words().dwelling.shared.contains(b)),
            building,
        }
    }

    /// Returns the words that name the building or others.
    pub(crate) fn building_words(&self) -> Vec<Span> {
        self.building.words.iter().chain(&self.building.head).copied().collect()
    }
}

/// Returns the country of the request, which goes before that of the prompt.
fn country_of(request: &Request, named: Option<&str>, notes: &mut Notes) -> Option<String> {
    let flag = request.country.as_deref().and_then(places::code_of)?;
    let nearer = named.and_then(|named| places::nearer(&flag, named)).map(str::to_owned);
    if let Some(named) = named.filter(|_| nearer.is_none()) {
        let message = format!("the prompt says {named}, the request {flag}; {flag} was used");
        notes.conflicts.push(Note::new("country_flag", message));
    }
    notes.conflicts.retain(|n| n.code != "ambiguous_place" && n.code != "unknown_place");
    // the prompt may say where in that country
    Some(nearer.unwrap_or(flag))
}

/// Returns the building that a prompt or its request names, else what its rooms suggest.
///
/// `elsewhere` are the words for places, robots and their docks, which do not say what is built.
fn building_of(
    heard: &Heard,
    request: &Request,
    registry: &Registry,
    elsewhere: &[Span],
    notes: &mut Notes,
) -> Building {
    let Heard { tokens, numbers, languages, spoken, .. } = heard;
    let recognize = |only| building::recognize(tokens, registry, languages, spoken, numbers, elsewhere, only);
    let mut found = recognize(None);
    if found.as_ref().is_none_or(|b| b.by_rooms) {
        // "a 4-bed room" is no home, and who has staff works there
        let by_words = by_beds_or_staff(heard, registry, found.is_none());
        found = by_words.map(|domain| Building { by_rooms: true, ..Building::none(domain) }).or(found);
        found = practitioners::practice_of(registry, (tokens, numbers), languages).or(found);
    }
    if let Some(id) = &request.domain {
        if let Some(other) = found.as_ref().filter(|b| &b.domain != id && !b.by_rooms) {
            let message =
                format!("the prompt reads like domain {}, the request says {id}; {id} was used", other.domain);
            notes.conflicts.push(Note::new("domain_flag", message));
        }
        let head = found.as_ref().and_then(|b| b.head);
        let list_from = found.as_ref().map_or(0, |b| b.list_from);
        return match recognize(Some(id)) {
            Some(b) => b,
            None => Building { head, list_from, ..Building::none(id) },
        };
    }
    match found {
        Some(building) => {
            if building.by_rooms {
                let message = format!("the prompt names no building; its rooms suggest domain {}", building.domain);
                notes.assumptions.push(Note::new("domain_from_rooms", message));
            }
            building
        }
        None => {
            let id = registry.iter().next().map_or(String::new(), |p| p.id().to_owned());
            let title = registry.get(&id).map_or(String::new(), |p| p.domain().title.to_lowercase());
            let message = format!("the prompt does not say what to build; domain {id} was taken");
            notes.assumptions.push(Note::new("default_domain", message));
            let unread: Vec<&str> = unread::nouns(tokens, numbers, spoken, elsewhere)
                .into_iter()
                .filter_map(|t| heard.prompt.get(t.start..t.end))
                .collect();
            if !unread.is_empty() {
                let message = format!(
                    "of `{}` no word names a building or room that is known; the usual {title} building was planned, say what it is (a flat, an office, a ward, a school)",
                    unread.join("`, `")
                );
                notes.conflicts.push(Note::new("unknown_building", message));
            }
            Building::none(&id)
        }
    }
}

/// Returns the domain of rooms that are told by their beds, and where nothing else tells one that of people who work.
fn by_beds_or_staff<'a>(heard: &Heard, registry: &'a Registry, nothing: bool) -> Option<&'a str> {
    let domains =
        || registry.iter().map(|p| p.domain()).filter(|d| d.programs.first().is_some_and(|p| !is_dwelling(p)));
    if let Some(count) = beds::told(&heard.tokens, &heard.numbers, &heard.spoken) {
        return domains().find(|d| beds::has_room_for(d, count)).map(|d| d.id.as_str());
    }
    let works = nothing && [Tag::Staff, Tag::StaffBefore, Tag::Desks].into_iter().any(|tag| heard.says(tag));
    let seats =
        |d: &&Domain| d.programs.first().is_some_and(|p| p.rooms.iter().any(|r| r.area_per_occupant_m2.is_some()));
    domains().find(seats).filter(|_| works).map(|d| d.id.as_str())
}
