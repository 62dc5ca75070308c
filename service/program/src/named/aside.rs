//! Words that name no room: measures, short forms, storeys, styles, places within rooms. Where these stand no room is looked
//! for; words for several rooms at once are found here too, for they are looked for first.

use std::sync::Arc;

use d3dgen_model::domain::Domain;
use d3dgen_model::style::{LayoutStyle, StyleWord};
use d3dgen_plugins::Registry;

use super::access;
use super::compounds::{self, Compound};
use super::mentions::Vocabulary;
use super::qualities::{self, Nook};
use super::styles;
use crate::heard::Heard;
use crate::levels::storeys;
use crate::machines::sizes::Sizes;
use crate::people::beds::{BedRoom, Choice};
use crate::people::dwelling;
use crate::people::short_form::ShortForm;
use crate::subject::single;
use crate::subject::site::Site;
use crate::tokens::measures::{self, Area};
use crate::tokens::text::Span;
use crate::tokens::words::{Tag, tag_ends_at, words};

/// Words that name no room.
pub(crate) struct Aside {
    pub vocabulary: Arc<Vocabulary>,
    pub areas: Vec<Area>,
    /// How large the robots are.
    pub sizes: Sizes,
    pub short_forms: Vec<ShortForm>,
    /// Rooms that are told by their beds.
    pub bed_rooms: Vec<BedRoom>,
    pub storeys: Vec<storeys::Phrase>,
    pub styles: Vec<styles::Said>,
    pub nooks: Vec<Nook>,
    pub compounds: Vec<Compound>,
    /// All of these words but those for rooms.
    pub taken: Vec<Span>,
    /// Those of them that a number before them counts.
    pub counted: Vec<Span>,
    /// Words that name no object: "cleaning robot", "wheelchair users".
    pub not_things: Vec<Span>,
}

impl Aside {
    /// Returns that of a brief, which has no such words.
    pub(crate) fn empty(heard: &Heard, domain: &Domain, registry: &Registry) -> Self {
        let languages = &heard.languages;
        let vocabulary =
            registry.digest(&format!("{languages:?}: {}", domain.id), || Vocabulary::new(domain, registry, languages));
        Self {
            vocabulary,
            areas: Vec::new(),
            sizes: Sizes::default(),
            short_forms: Vec::new(),
            bed_rooms: Vec::new(),
            storeys: Vec::new(),
            styles: Vec::new(),
            nooks: Vec::new(),
            compounds: Vec::new(),
            taken: Vec::new(),
            counted: Vec::new(),
            not_things: Vec::new(),
        }
    }

    /// Finds them; a building whose word turns out to be that of a room loses it.
    pub(crate) fn find(heard: &Heard, site: &mut Site, registry: &Registry) -> Self {
        let Heard { prompt, tokens, numbers, languages, spoken, .. } = heard;
        let (domain, lives) = (site.domain, site.lives);
        let vocabulary =
            registry.digest(&format!("{languages:?}: {}", domain.id), || Vocabulary::new(domain, registry, languages));
        let sizes = Sizes::read(tokens, numbers, spoken, &site.machines, |i| {
            heard.is_tagged(i, Tag::MeasuredParts) || vocabulary.names_room(tokens, i, numbers, spoken)
        });
        let mut areas = measures::areas(tokens, numbers);
        // "0.6 x 0.8 m" of a robot is no floor
        areas.retain(|a| !sizes.spans.iter().any(|s| s.overlaps(a.span)));
        let short_forms = dwelling::short_forms(tokens, numbers, domain, spoken, site.shared);
        let mut taken = site.places.clone();
        taken.extend(areas.iter().map(|a| a.span));
        taken.extend(short_forms.iter().map(|f| f.span));
        let mut counted: Vec<Span> = taken.iter().filter(|s| !site.places.contains(s)).copied().collect();
        counted.extend(site.machines.spans.iter().copied());
        taken.extend(site.machines.spans.iter().copied());
        taken.extend(sizes.spans.iter().copied());
        single::unname(&mut site.building, tokens, &vocabulary, numbers, spoken);
        let choice = Choice { domain, program: site.program, spoken };
        let own = |span| vocabulary.own_at(tokens, span);
        let bed_rooms = if lives { Vec::new() } else { choice.phrases(tokens, numbers, own) };
        let storeys = storey_phrases(heard, site, &vocabulary);
        taken.extend(storeys.iter().map(|p| p.span));
        let styles = styles_said(heard, site, &vocabulary);
        taken.extend(styles.iter().map(|s| s.span));
        // "home office corner": a place in a room
        let free = |i: usize| taken.iter().any(|s| s.contains(i));
        let nooks = if lives { qualities::nooks(tokens, spoken, domain, free) } else { Vec::new() };
        taken.extend(nooks.iter().map(|n| n.span));
        let mut not_things = site.machines.spans.clone();
        not_things.extend(styles.iter().map(|s| s.span));
        not_things.extend(nooks.iter().map(|n| n.span));
        not_things.extend(access::wishes(tokens, numbers, spoken));
        let names_room = |i: usize| vocabulary.names_room(tokens, i, numbers, spoken);
        let compounds = compounds::find(tokens, prompt, domain, spoken, names_room, |span| {
            taken.iter().chain(&site.building.head).any(|s| s.overlaps(span))
        });
        Self {
            vocabulary,
            areas,
            sizes,
            short_forms,
            bed_rooms,
            storeys,
            styles,
            nooks,
            compounds,
            taken,
            counted,
            not_things,
        }
    }
}

fn storey_phrases(heard: &Heard, site: &Site, vocabulary: &Vocabulary) -> Vec<storeys::Phrase> {
    let Heard { tokens, numbers, spoken, .. } = heard;
    let room_end = |i: usize| vocabulary.room_end(tokens, i, numbers, spoken);
    let within = |id: &String| words().dwelling.within_a_storey.contains(id);
    let basements = !site.building.building_type.as_ref().is_some_and(within);
    storeys::phrases(tokens, numbers, spoken, site.building.head, basements, room_end)
}

/// Returns the words of style that are no rooms: "an agency with open space for 20 people" lists one.
fn styles_said(heard: &Heard, site: &Site, vocabulary: &Vocabulary) -> Vec<styles::Said> {
    let Heard { tokens, languages, spoken, .. } = heard;
    let list_from = site.building.list_from;
    let is_room = |s: Span| list_from > 0 && s.start >= list_from && vocabulary.own_at(tokens, s).is_some();
    let mut said = styles::said(tokens, languages);
    said.retain(|s| !is_room(s.span));
    // "open-plan flat"
    if let Some(head) = site.building.head.filter(|_| site.lives) {
        let before = |i: &usize| tag_ends_at(spoken, tokens, *i, Tag::OpenPlan, head.start);
        let open = (0..head.start).find(before).map(|start| Span { start, end: head.start });
        said.extend(open.map(|span| styles::Said { span, word: StyleWord::Layout(LayoutStyle::Open) }));
    }
    said
}
