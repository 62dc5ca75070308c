//! Who sees people in a room of their own: a practice "for three doctors and a nurse" has three rooms to examine in and one to
//! treat in, where the prompt does not say otherwise.

use d3dgen_model::domain::{Domain, Practitioner, Program};
use d3dgen_model::scene_graph::Note;
use d3dgen_plugins::Registry;

use super::building::Building;
use crate::tokens::numbers::Number;
use crate::tokens::text::{Kind, Phrases, Span, Token};
use crate::tokens::words::{Spoken, Tag, is_tagged, tag_ends_at};
use crate::wished::wishes::{Wish, Wishes};

/// Most of one kind that are taken at their word.
const MOST: f64 = 40.0;

/// Wishes for the rooms of those whom the prompt counts; returns the words that name them.
pub(crate) fn house(
    (tokens, numbers): (&[Token], &[Number]),
    (languages, spoken): (&[&str], &[&Spoken]),
    (domain, program): (&Domain, &Program),
    wishes: &mut Wishes,
    assumptions: &mut Vec<Note>,
) -> Vec<Span> {
    if !program.practice || domain.practitioners.is_empty() {
        return Vec::new();
    }
    let tables: Vec<Phrases<usize>> = languages.iter().map(|l| table(&domain.practitioners, l)).collect();
    let mut people = vec![0u32; domain.practitioners.len()];
    let mut spans = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let found = tables.iter().filter_map(|t| t.longest_at(tokens, i)).max_by_key(|f| f.0);
        let Some((end, &who)) = found else {
            i += 1;
            continue;
        };
        // "four general practitioners", "two experienced nurses"
        let plain = |k: usize| tokens[k].kind == Kind::Word && !is_tagged(spoken, tokens, k, Tag::Joins);
        let of = |n: &&Number| n.span.end == i || n.span.end + 1 == i && plain(n.span.end);
        let number = numbers.iter().filter(|n| !n.vague && (1.0..=MOST).contains(&n.value)).find(of);
        // "doctor's office", "nurse station": these name rooms
        let names = tokens.get(end).is_some_and(|t| t.kind == Kind::Word && is_noun(tokens, end, spoken));
        // "two doctors and a nurse"
        let one = i.checked_sub(1).filter(|&k| tag_ends_at(spoken, tokens, k, Tag::Articles, i));
        let said = number.map(|n| (n.span.start, n.value as u32)).or(one.map(|start| (start, 1)));
        if let Some((start, count)) = said.filter(|_| !names) {
            people[who] += count;
            spans.push(Span { start, end });
        }
        i = end;
    }
    for (who, count) in domain.practitioners.iter().zip(people).filter(|(_, n)| *n > 0) {
        let id = program.means.get(&who.room_type).unwrap_or(&who.room_type);
        let Some(kind) = domain.room_type(id).filter(|_| !wishes.forbidden.contains(id)) else { continue };
        let label = kind.label.to_lowercase();
        let rooms = count.div_ceil(who.per_room.max(1));
        if wishes.wishes.iter().any(|w| &w.room_type == id) {
            continue;
        }
        wishes.wishes.push(Wish { count: rooms, exact: true, listed: true, ..Wish::one(id, &label) });
        let message = format!("{rooms} x {label} were planned for those {count} who work in one");
        assumptions.push(Note::new("rooms_of_practitioners", message));
    }
    spans
}

/// Returns the building of a prompt that names none, and only who sees people there: "practice for three GPs and a nurse".
pub(crate) fn practice_of(
    registry: &Registry,
    (tokens, numbers): (&[Token], &[Number]),
    languages: &[&str],
) -> Option<Building> {
    registry.iter().map(|p| p.domain()).filter(|d| !d.practitioners.is_empty()).find_map(|domain| {
        let tables: Vec<Phrases<usize>> = languages.iter().map(|l| table(&domain.practitioners, l)).collect();
        let counted = |k: usize| {
            let (end, who) = tables.iter().find_map(|t| t.longest_at(tokens, k).map(|f| (f.0, *f.1)))?;
            let number = |n: &&Number| n.span.end == k && !n.article && !n.vague && n.value > 1.0;
            let number = numbers.iter().find(number)?;
            Some((Span { start: number.span.start, end }, who))
        };
        let (head, who) = (0..tokens.len()).find_map(counted)?;
        let main = |p: &&Program| {
            p.practice && p.rooms.first().is_some_and(|r| r.room_type == domain.practitioners[who].room_type)
        };
        let program = domain.programs.iter().filter(main).min_by_key(|p| p.default_rooms)?;
        let kind = domain.building_types.iter().find(|b| b.program == program.id)?;
        let building_type = Some(kind.id.clone());
        Some(Building {
            building_type,
            head: Some(head),
            list_from: head.end,
            by_rooms: true,
            ..Building::none(&domain.id)
        })
    })
}

/// Returns true for a word for rooms behind people.
fn is_noun(tokens: &[Token], i: usize, spoken: &[&Spoken]) -> bool {
    [Tag::RoomWords, Tag::SpaceWords, Tag::Stations].iter().any(|&t| is_tagged(spoken, tokens, i, t))
}

fn table(all: &[Practitioner], language: &str) -> Phrases<usize> {
    let mut phrases = Phrases::new(language);
    for (k, who) in all.iter().enumerate() {
        who.keywords.get(language).into_iter().flatten().for_each(|p| phrases.insert(p, k));
    }
    phrases
}
