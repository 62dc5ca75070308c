//! Departments named beside the building: "emergency department, 3 operating theatres, ICU with 8 beds".
//!
//! A department of the same domain is planned by the first rooms of its program; what is none becomes an unread wish.

use d3dgen_model::domain::{Domain, Occupants, Program};
use d3dgen_model::offer;
use d3dgen_model::scene_graph::Note;

use super::building::Part;
use crate::named::mention::{Mention, What};
use crate::tokens::text::{Span, Token};
use crate::tokens::words::{Spoken, Tag, is_tagged};
use crate::wished::wishes::{Wish, Wishes};

/// Room types that a department is planned with, at most.
const MOST_TYPES: usize = 4;
/// Lines of its program that say how many rooms there are at least that it is for.
const USUAL: usize = 8;
/// Words between a department and its beds, at most: "with".
const MOST_TO_BEDS: usize = 2;

/// What became of the departments.
#[derive(Debug, Default)]
pub(crate) struct Parts {
    pub planned: Vec<Span>,
    pub left: Vec<Part>,
    /// Beds of the departments.
    pub beds: Option<u32>,
}

/// Adds the rooms of departments to the wishes; their beds are no longer those of the building.
pub(crate) fn plan(
    parts: &[Part],
    (tokens, spoken): (&[Token], &[&Spoken]),
    mentions: &mut [Mention],
    wishes: &mut Wishes,
    (domain, program): (&Domain, &Program),
    assumptions: &mut Vec<Note>,
) -> Parts {
    let mut out = Parts::default();
    for part in parts {
        if mentions.iter().any(|m| m.span.overlaps(part.span)) {
            continue;
        }
        let kind = domain.building_type(&part.building_type).filter(|_| part.domain == domain.id);
        let own = kind.and_then(|b| domain.program(&b.program)).filter(|p| p.id != program.id);
        let Some(own) = own else {
            let same = kind.is_some();
            out.left.extend((!same).then(|| part.clone()));
            continue;
        };
        // "a ward with 16 beds in double rooms" names the rooms that its beds are in
        let slept_in = own.rooms.iter().any(|e| e.occupants == Occupants::Beds)
            && are_in_rooms(part.span, (tokens, spoken), mentions, domain);
        let beds = if slept_in { None } else { beds_of(part.span, tokens, mentions) };
        let added = add_rooms(own, program, domain, (beds, slept_in), wishes);
        if added.is_empty() {
            let named = own.rooms.first().is_some_and(|e| wishes.wishes.iter().any(|w| w.room_type == e.room_type));
            if named || slept_in {
                out.planned.push(part.span)
            } else {
                out.left.push(part.clone())
            }
            continue;
        }
        out.beds = beds.map(|b| b + out.beds.unwrap_or(0)).or(out.beds);
        out.planned.push(part.span);
        let message = format!("the {} was planned as {}", own.title.to_lowercase(), added.join(", "));
        assumptions.push(Note::new("part_planned", message));
    }
    out
}

/// Returns true for the beds of a department.
fn are_beds(m: &Mention, span: Span, tokens: &[Token]) -> bool {
    let gap = span.end..m.from;
    let behind = m.from >= span.end && gap.len() <= MOST_TO_BEDS && !gap.into_iter().any(|i| tokens[i].is_mark());
    m.what == What::Beds && (behind || m.span.end == span.start)
}

/// Returns true for beds of a department that are said to be in rooms of a kind: "ward with 16 beds in double rooms".
fn are_in_rooms(span: Span, (tokens, spoken): (&[Token], &[&Spoken]), mentions: &[Mention], domain: &Domain) -> bool {
    let inside = |i: usize| is_tagged(spoken, tokens, i, Tag::Inside);
    mentions.windows(2).any(|pair| {
        let [beds, rooms] = pair else { return false };
        let kind = rooms.room_type().and_then(|id| domain.room_type(id));
        let mut gap = beds.span.end..rooms.from.min(rooms.span.start);
        let open = rooms.count.is_none() && gap.len() <= MOST_TO_BEDS;
        are_beds(beds, span, tokens)
            && open
            && gap.any(inside)
            && kind.is_some_and(|k| offer::sleeps(domain, k).is_some())
    })
}

/// Returns the beds named with a department, and takes them from the building.
fn beds_of(span: Span, tokens: &[Token], mentions: &mut [Mention]) -> Option<u32> {
    let count = mentions.iter_mut().find(|m| are_beds(m, span, tokens))?.count.take()?;
    u32::try_from(count).ok().filter(|n| (1..=500).contains(n))
}

/// Adds the first rooms of a department; those for its beds only where the prompt names none that these are in (`slept_in`).
fn add_rooms(
    own: &Program,
    main: &Program,
    domain: &Domain,
    (beds, slept_in): (Option<u32>, bool),
    wishes: &mut Wishes,
) -> Vec<String> {
    let mut seen: Vec<&str> = Vec::new();
    let mut out = Vec::new();
    for entry in &own.rooms {
        let id = entry.room_type.as_str();
        if seen.contains(&id) || seen.len() == MOST_TYPES {
            continue;
        }
        seen.push(id);
        // what the department is for is there whatever the building has
        let leads = seen.len() == 1;
        let known =
            !leads && main.rooms.iter().any(|e| e.room_type == id) || wishes.wishes.iter().any(|w| w.room_type == id);
        let known = known || slept_in && entry.occupants == Occupants::Beds;
        if known || wishes.forbidden.iter().any(|f| f == id) {
            continue;
        }
        let counted = beds.filter(|_| entry.occupants == Occupants::Beds);
        let usual = own.rooms.iter().take(USUAL).filter(|e| leads && e.room_type == id).map(|e| e.min).sum();
        let count = counted.map_or(entry.min.max(usual), |n| n.div_ceil(entry.occupants_per_room.unwrap_or(1).max(1)));
        let label = domain.room_type_or_generic(id).label.to_lowercase();
        out.push(format!("{count} x {label}"));
        wishes.wishes.push(Wish { count, ..Wish::one(id, &label) });
    }
    out
}
