//! The objects of a prompt: those it names, those that the name of a room says ("eat-in kitchen"), and those of places within
//! rooms ("home office corner").

use d3dgen_plugins::Registry;

use super::aside::Aside;
use super::objects::{self, Thing};
use super::qualities;
use crate::heard::Heard;
use crate::named::mention::Mention;
use crate::people::{dwelling, homes};
use crate::subject::site::Site;
use crate::tokens::text::Span;
use crate::tokens::words::words;
use crate::wished::wishes::Wishes;

/// Factor on the usual area of a kitchen that one eats in.
const EATING: f64 = 1.45;

pub(crate) struct Reader<'a> {
    pub heard: &'a Heard<'a>,
    pub site: &'a Site<'a>,
    pub aside: &'a Aside,
    pub mentions: &'a [Mention],
    pub registry: &'a Registry,
}

pub(crate) struct Things {
    pub things: Vec<Thing>,
    /// All words that are read by now.
    pub words: Vec<Span>,
}

impl Reader<'_> {
    /// Returns the objects that the prompt names.
    pub(crate) fn read(&self, wishes: &mut Wishes) -> Things {
        let Heard { tokens, languages, spoken, .. } = self.heard;
        let Site { domain, lives, ref machines, ref building, .. } = *self.site;
        let mut words: Vec<Span> =
            self.aside.taken.iter().chain(&machines.docks).chain(&building.words).copied().collect();
        // "ein Geschoss"
        let storeys_told = |start: usize| {
            spoken.iter().find_map(|s| s.storey_counts.longest_at(tokens, start)).map(|f| Span { start, end: f.0 })
        };
        words.extend((0..tokens.len()).filter_map(storeys_told));
        let (here, said) = ((domain, self.registry), (&languages[..], &spoken[..]));
        let mut things = objects::named(tokens, self.mentions, here, said, &self.aside.not_things, &mut words);
        if lives {
            homes::furnish_entrance(&things, wishes, domain);
        }
        self.of_names(wishes, &mut things, &mut words);
        self.of_nooks(wishes, &mut things);
        if lives {
            let beside = (domain, &things[..]);
            things.extend(dwelling::cradle(tokens, self.mentions, wishes, beside, spoken, &mut words));
        }
        Things { things, words }
    }

    /// Adds what the names of rooms say that stands in them.
    fn of_names(&self, wishes: &mut Wishes, things: &mut Vec<Thing>, words_read: &mut Vec<Span>) {
        let Heard { tokens, spoken, .. } = self.heard;
        let free = |i: usize| !self.aside.taken.iter().chain(&self.site.building.head).any(|s| s.contains(i));
        let mut furnished = qualities::furnished(tokens, spoken, free);
        // who shares a home eats in its kitchen
        let [kitchen, table] = &words().dwelling.shared_meals;
        let nowhere = Span { start: 0, end: 0 };
        furnished.extend(self.site.shared.then(|| (table.clone(), kitchen.clone(), nowhere)));
        let dines = wishes.wishes.iter().any(|w| w.room_type == words().dwelling.dining);
        for (object, room_type, span) in furnished {
            let wished = wishes.wishes.iter().any(|w| w.room_type == room_type);
            let here = self.site.domain.object(&object).is_some() && wished;
            if here && !things.iter().any(|t| t.object == object) {
                words_read.push(span);
                let wish = wishes.wishes.iter_mut().find(|w| w.room_type == room_type);
                wish.into_iter().filter(|_| !dines).for_each(|w| w.size = w.size.or(Some(EATING)));
                things.push(Thing::of_one(&object, Some(room_type)));
            }
        }
    }

    /// Adds what stands in places within rooms.
    fn of_nooks(&self, wishes: &Wishes, things: &mut Vec<Thing>) {
        let wished = |id: &&String| wishes.wishes.iter().any(|w| w.room_type == **id);
        for nook in &self.aside.nooks {
            let said = homes::room_of_nook(&self.heard.tokens, self.mentions, nook, &self.heard.spoken);
            let room_type = said.or(nook.room_types.iter().find(wished)).or(nook.room_types.first()).cloned();
            if !things.iter().any(|t| t.object == nook.object) {
                things.push(Thing::of_one(&nook.object, room_type));
            }
        }
    }
}
