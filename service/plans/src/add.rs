//! Doors and windows that a plan lacks, where the user asks for them.

use std::collections::BTreeSet;

use d3dgen_model::domain::{Daylight, Domain, Zone};

use crate::drawing::{OpeningKind, note};
use crate::layout::{LaidOpening, Layout};
use crate::links;

/// Wall left on each side of an added opening, mm.
const JAMB: i64 = 250;
/// Widest added window, mm, and how much wider than deep a room's glass must be: area of glass to floor.
const WIDEST_PANE: i64 = 3000;
const GLASS_PER_FLOOR: f64 = 0.15;
/// Height of an added window, m.
const PANE_HEIGHT_M: f64 = 1.2;
/// Added to the clear width of a door for its frame, mm.
const FRAME: i64 = 60;

/// Adds doors until every room is reached from outdoors: from the circulation where a wall with it is long enough.
pub(crate) fn doors(layout: &mut Layout, types: &[String], domain: &Domain) {
    let kind = |room: usize| domain.room_type_or_generic(&types[room]);
    let at_ground = |layout: &Layout, rooms: &[usize]| rooms.len() == 1 && layout.number_of(rooms[0]) == 0;
    if !layout.openings.iter().any(|o| o.kind != OpeningKind::Window && at_ground(layout, &o.rooms)) {
        let rank = |room: usize| {
            let listed = domain.circulation.entrance_room_types.iter().position(|t| *t == types[room]);
            (kind(room).zone != Zone::Circulation, listed.unwrap_or(usize::MAX))
        };
        let width = (domain.circulation.entrance_width_m * 1000.0) as i64 + FRAME;
        let mut spots = free_parts(layout, width, |s| at_ground(layout, s));
        spots.sort_by_key(|&(stretch, from, to)| {
            let room = layout.stretches[stretch].rooms().next().unwrap_or(0);
            (rank(room), from - to, stretch)
        });
        add_door(layout, spots.first().copied(), width, "an entrance to");
    }
    loop {
        let reached = reached(layout, |room| links::kind_of(&types[room], domain).is_some());
        let missing: Vec<usize> = (0..layout.rooms.len()).filter(|r| !reached.contains(r)).collect();
        if missing.is_empty() {
            return;
        }
        let private = |room: usize| kind(room).privacy == d3dgen_model::domain::Privacy::Private;
        let width = |a: usize, b: usize| {
            let narrow = kind(a).door_width_m.min(kind(b).door_width_m);
            (narrow.max(0.8) * 1000.0) as i64 + FRAME
        };
        let mut spots: Vec<(u8, i64, usize, i64, i64, i64)> = Vec::new();
        for (stretch, from, to) in free_parts(layout, 700, |s| s.len() == 2) {
            let pair: Vec<usize> = layout.stretches[stretch].rooms().collect();
            let [a, b] = pair[..] else { continue };
            if reached.contains(&a) == reached.contains(&b) {
                continue;
            }
            let (near, _) = if reached.contains(&a) { (a, b) } else { (b, a) };
            let wanted = width(a, b).min(to - from);
            let rank = if kind(near).zone == Zone::Circulation { 0 } else { 1 + u8::from(private(near)) };
            spots.push((rank, from - to, stretch, from, to, wanted));
        }
        spots.sort_unstable();
        let Some(&(.., stretch, from, to, wanted)) = spots.first() else {
            for room in missing {
                let name = layout.rooms[room].label.clone();
                layout
                    .notes
                    .push(note("no_door", format!("no wall takes a door for room `{name}`; it stays out of reach")));
            }
            return;
        };
        add_door(layout, Some((stretch, from, to)), wanted, "a door between");
    }
}

fn add_door(layout: &mut Layout, spot: Option<(usize, i64, i64)>, width: i64, what: &str) {
    let Some((stretch, from, to)) = spot else {
        layout.notes.push(note("no_entrance", "no outer wall takes an entrance"));
        return;
    };
    let width = width.min(to - from);
    let start = (from + to - width) / 2;
    let rooms: Vec<usize> = layout.stretches[stretch].rooms().collect();
    let names: Vec<String> = rooms.iter().map(|r| format!("`{}`", layout.rooms[*r].label)).collect();
    layout.notes.push(note("door_added", format!("{what} {} was added", names.join(" and "))));
    layout.openings.push(opening(OpeningKind::Door, rooms, stretch, start, start + width));
}

fn opening(kind: OpeningKind, rooms: Vec<usize>, stretch: usize, from: i64, to: i64) -> LaidOpening {
    LaidOpening { kind, rooms, stretch, from, to, sill_m: None, head_m: None, sliding: false, swing: None }
}

/// Returns the rooms that openings join to outdoors, or on other storeys than the ground floor to stairs and lifts, step by step.
fn reached(layout: &Layout, joins_storeys: impl Fn(usize) -> bool) -> BTreeSet<usize> {
    let walkable: Vec<&LaidOpening> = layout.openings.iter().filter(|o| o.kind != OpeningKind::Window).collect();
    let mut found: BTreeSet<usize> =
        walkable.iter().filter(|o| o.rooms.len() == 1).flat_map(|o| o.rooms.iter().copied()).collect();
    found.extend((0..layout.rooms.len()).filter(|r| layout.number_of(*r) != 0 && joins_storeys(*r)));
    // on a storey without any way in, one begins where there is a door
    for storey in 0..=layout.levels.len().saturating_sub(1) {
        let here = |room: &usize| layout.rooms[*room].storey == storey;
        if !found.iter().any(here) {
            let opened = walkable.iter().flat_map(|o| o.rooms.iter().copied()).find(here);
            found.extend(opened.or_else(|| (0..layout.rooms.len()).find(here)));
        }
    }
    loop {
        let before = found.len();
        for o in &walkable {
            if o.rooms.iter().any(|r| found.contains(r)) {
                found.extend(o.rooms.iter().copied());
            }
        }
        if found.len() == before {
            return found;
        }
    }
}

/// Returns the pieces of stretches with this many rooms that are long enough, without openings and the walls at their ends.
fn free_parts(layout: &Layout, width: i64, wanted: impl Fn(&[usize]) -> bool) -> Vec<(usize, i64, i64)> {
    let mut out = Vec::new();
    for (k, s) in layout.stretches.iter().enumerate() {
        let rooms: Vec<usize> = s.rooms().collect();
        if !wanted(&rooms) {
            continue;
        }
        let mut cuts: Vec<(i64, i64)> =
            layout.openings.iter().filter(|o| o.stretch == k).map(|o| (o.from, o.to)).collect();
        cuts.sort_unstable();
        cuts.push((s.to, s.to));
        let mut from = s.from;
        for (a, b) in cuts {
            if a - from - 2 * JAMB >= width {
                out.push((k, from + JAMB, a - JAMB));
            }
            from = b;
        }
    }
    out
}

/// Adds a window to each room that is better with daylight, has an outer wall and no window.
pub(crate) fn windows(layout: &mut Layout, types: &[String], domain: &Domain) {
    for (room, room_type) in types.iter().enumerate() {
        let kind = domain.room_type_or_generic(room_type);
        let lit = layout.openings.iter().any(|o| o.kind == OpeningKind::Window && o.rooms.contains(&room));
        let wanted = matches!(kind.daylight, Daylight::Required | Daylight::Preferred);
        if lit || !wanted || kind.zone == Zone::Outdoor {
            continue;
        }
        let area = layout.rooms[room].net_polygon.area();
        let wish = ((area * GLASS_PER_FLOOR / PANE_HEIGHT_M * 1000.0) as i64).clamp(600, WIDEST_PANE);
        let mut spots = free_parts(layout, 600, |s| s == [room]);
        spots.sort_by_key(|&(stretch, from, to)| (from - to, stretch));
        match spots.first() {
            Some(&(stretch, from, to)) => {
                let width = wish.min(to - from);
                let start = (from + to - width) / 2;
                layout.openings.push(opening(OpeningKind::Window, vec![room], stretch, start, start + width));
                let name = &layout.rooms[room].label;
                layout.notes.push(note("window_added", format!("a window was added to room `{name}`")));
            }
            // only a room that must have daylight lacks something without
            None if kind.daylight != Daylight::Required => {}
            None => {
                let name = &layout.rooms[room].label;
                layout.notes.push(note("no_window", format!("no outer wall of room `{name}` takes a window")));
            }
        }
    }
}
