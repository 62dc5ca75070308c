//! The rooms that a prompt names: all that sound like one, and then what these words mean in such a building.

use d3dgen_model::domain::Zone;
use d3dgen_plugins::Registry;

use super::aside::Aside;
use super::mentions::mentions;
use super::{compounds, fixtures, objects, senses};
use crate::heard::Heard;
use crate::machines::docks;
use crate::named::mention::Mention;
use crate::named::taken::Taken;
use crate::people::beds::{self, Choice};
use crate::people::{homes, sharing};
use crate::subject::site::Site;
use crate::tokens::text::Span;
use crate::tokens::words::{Tag, words};
use crate::wished::{subsets, unread};

/// The rooms and people that a prompt names.
pub(crate) struct Named {
    pub mentions: Vec<Mention>,
    /// Words that say more about these.
    pub words: Vec<Span>,
    /// Words for objects that are ruled out.
    pub no_things: Vec<Span>,
    /// True where everybody has a room of their own.
    pub own_rooms: bool,
    /// True when the prompt counts the rooms to live in ("3-Zimmer-Wohnung", "2BHK").
    pub habitable_fixed: bool,
}

impl Named {
    /// Finds them.
    pub(crate) fn find(heard: &Heard, site: &Site, aside: &mut Aside, registry: &Registry) -> Self {
        let Heard { tokens, numbers, spoken, .. } = heard;
        let (domain, program) = (site.domain, site.program);
        let mut mentions = sounding_like_rooms(heard, site, aside);
        let mut words = compounds::hold_own(tokens, heard.prompt, &aside.compounds, &mut mentions, domain, spoken);
        let languages = (heard.language, &heard.languages[..], &spoken[..]);
        let no_things = objects::ruled_out(tokens, &mut mentions, (domain, registry), languages);
        words.extend(no_things.iter().copied());
        let mut own_rooms = None;
        if site.lives {
            words.extend(in_homes(heard, site, &mut mentions, registry));
            own_rooms = rooms_of_their_own(heard, site, &mut mentions);
            words.extend(own_rooms);
        }
        let habitable_fixed = settle_short_forms(site, aside, &mentions);
        if !site.lives {
            let choice = Choice { domain, program, spoken };
            choice.read_lists(tokens, &mut mentions);
            choice.adopt(&mut mentions);
            beds::of_several_wards((tokens, spoken), &mut mentions, numbers, &site.building_words());
        }
        senses::settle(tokens, &mut mentions, &aside.vocabulary, spoken, (domain, program));
        subsets::settle(tokens, numbers, spoken, &mut mentions, domain);
        Self { mentions, words, no_things, own_rooms: own_rooms.is_some(), habitable_fixed }
    }
}

/// Returns all that sounds like a room, and the people that are counted.
fn sounding_like_rooms(heard: &Heard, site: &Site, aside: &Aside) -> Vec<Mention> {
    let Heard { tokens, numbers, language, spoken, .. } = heard;
    let taken = Taken {
        spans: &aside.taken,
        head: site.building.head,
        buildings: &site.building.words,
        list_from: site.building.list_from,
        counted: &aside.counted,
        docks: &site.machines.docks,
        bed_rooms: &aside.bed_rooms,
        compounds: &aside.compounds,
        unread: heard.strange.is_some(),
    };
    let mut mentions = mentions(tokens, numbers, &aside.vocabulary, spoken, language, &taken);
    docks::not_of_goods(tokens, &mut mentions, site.domain, spoken);
    unread::uncount_measures(tokens, &mut mentions, spoken);
    mentions
}

/// Takes words for what they mean in a home; returns those that are read so.
fn in_homes(heard: &Heard, site: &Site, mentions: &mut Vec<Mention>, registry: &Registry) -> Vec<Span> {
    let Heard { prompt, tokens, languages, spoken, .. } = heard;
    let Site { domain, program, .. } = *site;
    let mut read = fixtures::settle(tokens, prompt, mentions, domain, &site.wet, spoken);
    read.extend(objects::of_bedrooms(tokens, mentions, (domain, registry), (languages, spoken)));
    read.extend(homes::sleep_where_one_lives(tokens, mentions, (domain, program), spoken));
    homes::halve_bathrooms((tokens, spoken), &heard.numbers, mentions, domain);
    homes::not_of_things(tokens, mentions, (domain, registry), (languages, spoken));
    read
}

/// Returns the words for "everybody has a private room", which names no room of another kind.
fn rooms_of_their_own(heard: &Heard, site: &Site, mentions: &mut Vec<Mention>) -> Option<Span> {
    let sleeps = |id: &str| site.domain.room_type(id).is_some_and(|k| k.zone == Zone::Night);
    let span = sharing::each_has_a_room(&heard.tokens, mentions, &heard.spoken, sleeps)?;
    let own = |m: &Mention| heard.is_tagged(m.span.start, Tag::Own);
    let said = |m: &Mention| m.room_type().is_some_and(|id| sleeps(id) || own(m));
    mentions.retain(|m| !(span.contains(m.span.start) && said(m)));
    Some(span)
}

/// Counts rooms that short forms count and the list names once; returns true where they count the rooms to live in.
fn settle_short_forms(site: &Site, aside: &mut Aside, mentions: &[Mention]) -> bool {
    let d = &words().dwelling;
    homes::count_listed(&mut aside.short_forms, mentions, site.domain);
    let fixed = aside.short_forms.iter().any(|f| f.rooms.contains_key(&d.living));
    // "three-room flat: living room with kitchen corner": it is the one that the number counts
    let named = |id: &String| mentions.iter().any(|m| m.room_type() == Some(id));
    if named(&d.living_kitchen) && !named(&d.living) {
        aside.short_forms.iter_mut().for_each(|f| {
            f.rooms.remove(&d.living);
        });
    }
    fixed
}
