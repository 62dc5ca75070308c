//! Open and cellular layouts: what the domain's program changes for them, as its `layouts` say.

use d3dgen_model::domain::{Domain, LayoutSwap, Occupants, RoomType};
use d3dgen_model::scene_graph::Note;
use d3dgen_model::style::LayoutStyle;

use super::occupants::head_count;
use crate::built::planned::Planned;
use crate::reading::Reading;

/// Most rooms that stand for one.
const MOST_ROOMS: u32 = 40;

/// Returns the rooms of a layout that stand for one which a list takes for granted, and how many of them so many people need:
/// shared offices in place of the open one of "no open-plan office".
pub(crate) fn in_place_of<'a>(
    domain: &'a Domain,
    room_type: &str,
    layout: LayoutStyle,
    people: u32,
) -> Option<(&'a RoomType, u32)> {
    let swap = domain.layouts.swaps.iter().find(|s| s.layout == layout && s.from == room_type)?;
    Some((domain.room_type(&swap.to)?, people.div_ceil(swap.occupants?.max(1)).clamp(1, MOST_ROOMS)))
}

/// Lets rooms of the program give way to those of the layout that is asked for.
pub(crate) fn follow<'a>(reading: &mut Reading<'a>, rooms: &mut Vec<Planned<'a>>) {
    let Some(layout) = reading.style.layout else { return };
    let domain = reading.domain;
    if layout == LayoutStyle::Open && !domain.layouts.knows(layout) {
        let message = format!("{} has no open layout; the usual one was planned", domain.title);
        reading.assumptions.push(Note::new("style_without_effect", message));
    }
    if reading.closed {
        return;
    }
    for swap in domain.layouts.swaps.iter().filter(|s| s.layout == layout) {
        let forbidden = reading.wishes.forbidden.contains(&swap.to);
        if let Some(kind) = domain.room_type(&swap.to).filter(|_| !forbidden) {
            make(reading, swap, kind, rooms);
        }
    }
}

fn make<'a>(reading: &mut Reading<'a>, swap: &LayoutSwap, kind: &'a RoomType, rooms: &mut Vec<Planned<'a>>) {
    let gives_way = |r: &Planned| !r.requested && r.room_type == swap.from;
    let places = rooms.iter().filter(|r| gives_way(r)).count() as u32;
    if places == 0 {
        return;
    }
    let people = head_count(reading, Occupants::Staff).zip(swap.occupants);
    let needed = match people {
        Some((people, each)) => people.div_ceil(each.max(1)).div_ceil(places),
        None => swap.rooms,
    };
    if reading.total.is_some() && people.is_some() && needed > 1 {
        let (from, to) = (swap.from.replace('_', " "), swap.to.replace('_', " "));
        let message = format!(
            "the number of rooms is fixed, and {needed} x {to} would have to stand for each {from}; it stayed as it is"
        );
        reading.conflicts.push(Note::new("style_needs_rooms", message));
        return;
    }
    let each = if reading.total.is_some() { 1 } else { needed.clamp(1, MOST_ROOMS) };
    let mut left = people.map(|p| p.0);
    let mut out = Vec::with_capacity(rooms.len());
    for room in rooms.drain(..) {
        if !gives_way(&room) {
            out.push(room);
            continue;
        }
        for _ in 0..each {
            let mut new = Planned { unit: room.unit.clone(), ..Planned::new(&kind.id, kind) };
            if let Some((left, (_, most))) = left.as_mut().zip(people) {
                new.occupants = Some((*left).min(most)).filter(|n| *n > 0);
                *left -= (*left).min(most);
            }
            out.push(new);
        }
    }
    *rooms = out;
    let message =
        format!("{} {} in place of {places} {}", each * places, kind.label.to_lowercase(), swap.from.replace('_', " "));
    reading.assumptions.push(Note::new("style_layout", message));
}
