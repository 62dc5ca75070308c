//! How many people live, work and sleep in a building, and how many visit it, as the prompt counts them.

use d3dgen_model::domain::{Domain, Occupants, Program, ProgramRoom};
use d3dgen_model::scene_graph::{Note, Occupancy};

use super::counted::Counted;
use super::dwelling;
use crate::named::mention::{Mention, What};
use crate::subject::programs::is_dwelling;
use crate::tokens::numbers::Number;
use crate::tokens::text::Token;
use crate::tokens::words::{Spoken, Tag, is_tagged, words};

/// Largest head count that is taken at its word.
const MAX_HEADS: i64 = 5000;

/// Head counts of a prompt.
pub(crate) struct People {
    pub occupancy: Occupancy,
    pub residents: Option<u32>,
    pub children: u32,
    /// True where two are a couple.
    pub pair: bool,
}

impl People {
    pub(crate) fn read(mentions: &[Mention], program: &Program, domain: &Domain, conflicts: &mut Vec<Note>) -> Self {
        let mut count = |what: &What| {
            let n = mentions.iter().filter(|m| &m.what == what && !m.article).filter_map(|m| m.count).max()?;
            if !(1..=MAX_HEADS).contains(&n) {
                conflicts.push(Note::new(
                    "impossible_count",
                    format!("a head count of {n} was left out; 1 to {MAX_HEADS} can be planned"),
                ));
                return None;
            }
            u32::try_from(n).ok()
        };
        let people = count(&What::People);
        let mut occupancy = Occupancy {
            staff: count(&What::Staff),
            beds: count(&What::Beds),
            desks: count(&What::Desks),
            visitors: count(&What::Visitors),
            residents: None,
        };
        let mut residents = count(&What::Residents);
        // "for 40 people": those who live in a dwelling, work where the program seats staff, visit anywhere else
        let lives = domain.room_type(&words().dwelling.bedroom).is_some() && is_dwelling(program);
        let seats = |r: &ProgramRoom| r.area_per_occupant_m2.is_some() || r.occupants_per_room.is_some();
        let works = program.rooms.iter().any(|r| r.occupants == Occupants::Staff && seats(r));
        match people {
            Some(n) if lives => residents = residents.or(Some(n)),
            Some(n) if works => occupancy.staff = occupancy.staff.or(Some(n)),
            Some(n) => occupancy.visitors = occupancy.visitors.or(Some(n)),
            None => {}
        }
        Self { occupancy, residents, children: 0, pair: false }
    }

    /// Counts those who share a home: "couple", "family of five", "two adults and three children".
    pub(crate) fn share_a_home(
        &mut self,
        tokens: &[Token],
        numbers: &[Number],
        mentions: &[Mention],
        spoken: &[&Spoken],
    ) {
        let tagged = |m: &&Mention, tag| is_tagged(spoken, tokens, m.span.start, tag);
        let sum = |tag| {
            let all = mentions.iter().filter(|m| !matches!(m.what, What::Room(_))).filter(|m| tagged(m, tag));
            let counted = all.filter_map(|m| m.count).filter(|n| (1..=MAX_HEADS).contains(n)).sum::<i64>();
            u32::try_from(counted).ok().filter(|n| *n > 0)
        };
        let (adults, children) = (sum(Tag::Adults), sum(Tag::Children));
        // "a couple with one child": the singular is no number of visitors
        let one = |i: usize| {
            let inside = mentions.iter().any(|m| matches!(m.what, What::Room(_)) && m.span.contains(i));
            let article =
                i.checked_sub(1).is_some_and(|k| numbers.iter().any(|n| n.span.contains(k) && n.value == 1.0));
            article && !inside && is_tagged(spoken, tokens, i, Tag::Children)
        };
        let children = children.or_else(|| (0..tokens.len()).any(one).then_some(1));
        if children.or(adults).is_some() {
            self.occupancy.visitors = None;
        }
        let household = dwelling::household(tokens, numbers, spoken, children);
        self.children = children.unwrap_or(0);
        self.pair = household.is_some_and(|n| n > 1) || self.children > 0;
        self.residents = adults.zip(children).map(|(a, c)| a + c).or(self.residents).or(adults).or(household);
    }

    /// Counts those who work at the desks that the prompt gives its rooms.
    pub(crate) fn work_at(&mut self, counted: &Counted) {
        let heads = &mut self.occupancy;
        if counted.titled > 0 {
            heads.staff = heads.staff.max(Some(counted.titled));
        }
        let told = if heads.desks.is_some() || counted.counts_desks { &mut heads.desks } else { &mut heads.staff };
        if told.is_some() || counted.counts_desks {
            *told = (*told).max(Some(counted.desks_told()));
        }
    }
}
