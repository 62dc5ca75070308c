//! Rooms that follow from people: offices of those who work in them, rooms of groups, places that rooms are told to have.

use super::apiece;
use super::{groups, seated, seats, stations};
use crate::heard::Heard;
use crate::named::aside::Aside;
use crate::named::mention::Mention;
use crate::people::held::Held;
use crate::subject::site::Site;
use crate::tokens::text::Span;
use crate::wished::comparisons::{self, Comparison};

/// What people and places make of the rooms that are named.
#[derive(Default)]
pub(crate) struct Counted {
    /// Rooms with the desks of each.
    pub desks: Vec<Held>,
    /// True where the list of rooms says how many desks there are.
    pub counts_desks: bool,
    /// Those who have an office by their title.
    pub titled: u32,
    /// Rooms with the places to be treated at of each.
    pub stations: Vec<Held>,
    /// Rooms with the seats or counters of each.
    pub seats: Vec<Held>,
    /// Types of rooms that those who work there are shared out to.
    pub halves: Vec<String>,
    /// Rooms that groups have, and how many of each.
    pub of_groups: Vec<(String, u32)>,
    pub comparisons: Vec<Comparison>,
    /// Words that say so.
    pub words: Vec<Span>,
    /// Those of them that name no object either.
    pub not_things: Vec<Span>,
}

impl Counted {
    /// Counts rooms by people, and people by rooms; where nobody lives, rooms by their places too.
    pub(crate) fn of(heard: &Heard, site: &Site, aside: &Aside, mentions: &mut Vec<Mention>) -> Self {
        let Heard { tokens, numbers, spoken, .. } = heard;
        let Site { domain, program, lives, .. } = *site;
        let (mut desks, desk_words) =
            if lives { Default::default() } else { seated::read(tokens, mentions, (domain, program), spoken) };
        let list_from = site.building.list_from;
        let apiece = apiece::Reader { tokens, numbers, domain, program, spoken, list_from };
        let (titled_offices, titled) = apiece.by_title(mentions);
        desks.extend(titled_offices);
        desks.extend(apiece.by_number(mentions));
        let (single_offices, apiece_words) = apiece.each_an_office(mentions);
        desks.extend(single_offices);
        let (shared_offices, sharing_words) = apiece.one_for_all(mentions);
        desks.extend(shared_offices);
        let groups = groups::Reader { tokens, numbers, domain, program, spoken }.read(mentions);
        desks.extend(groups.held);
        let (comparisons, compared_words) = comparisons::read(tokens, mentions, spoken);
        let named = site.machines.spans.iter().chain(&site.places).chain(&site.building.head);
        let taken: Vec<Span> = named.copied().collect();
        let vocabulary = &aside.vocabulary;
        let words = stations::counted(domain, program, &heard.languages);
        let stations =
            stations::Reader { tokens, numbers, vocabulary, domain, program, spoken, taken: &taken, counted: &words };
        let station_words = if lives { Vec::new() } else { stations.read(mentions) };
        let seats = seats::Reader { tokens, numbers, domain, program, spoken, taken: &taken, seated: &desks };
        let seats = if lives { seats::Found::default() } else { seats.read(mentions) };
        let open_desks = apiece.desks_of_the_list(mentions, &desk_words);
        let counts_desks = open_desks.is_some();
        desks.extend(open_desks);
        desks.extend(seats.desks);
        let not_things = [&station_words[..], &seats.spans].concat();
        let words = [groups.spans, compared_words, apiece_words, sharing_words].concat();
        Self {
            desks,
            counts_desks,
            titled,
            stations: places_told(mentions),
            seats: seats.seats,
            halves: seats.halves,
            of_groups: groups.rooms,
            comparisons,
            words: [words, not_things.clone()].concat(),
            not_things,
        }
    }

    /// Returns how many desks the prompt gives its rooms.
    pub(crate) fn desks_told(&self) -> u32 {
        self.desks.iter().map(|s| s.count.saturating_mul(s.beds)).fold(0, u32::saturating_add)
    }
}

/// Returns rooms with the places that a prompt gives them.
fn places_told(mentions: &[Mention]) -> Vec<Held> {
    let told = mentions.iter().filter_map(|m| {
        let count = m.count.map_or(1, |n| n.max(1) as u32);
        Some(Held { room_type: m.room_type()?.to_owned(), count, beds: m.places? })
    });
    told.collect()
}
