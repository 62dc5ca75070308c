//! Windows: as much glass as the daylight rule asks, evenly on the longest outer walls.

use d3dgen_model::Segment;
use d3dgen_model::domain::{Daylight, Zone};
use d3dgen_model::floorplan::{Door, Window};

use super::lattice::{OUTER_HALF_M, meters};
use super::outline::Stretch;
use super::spec::{Brief, RoomSpec};
use crate::measures::{LEAST_WALL_M, MARGIN_M, PANE_M};

/// Glass per floor area; building codes ask for 1/10 to 1/7 (see the `window_to_floor_area` constraints).
const GLASS_PER_FLOOR: f64 = 0.145;
/// Sill of a normal window, of a bathroom window, and the usual head, m.
const SILL_M: f64 = 0.9;
const HIGH_SILL_M: f64 = 1.5;
const HEAD_M: f64 = 2.2;
/// Height of the balustrade of balconies and terraces, m.
const BALUSTRADE_M: f64 = 1.0;
/// Outer wall of a corridor with one window, and that window's width, m: nobody likes to walk along a blank wall.
const CORRIDOR_STEP_M: f64 = 5.0;
const CORRIDOR_PANE_M: f64 = 1.2;
/// Floor from which on a room by day has windows in every outer wall as long as this, m^2 and m, and the share of these walls
/// that is glass at least.
const LARGE_ROOM_M2: f64 = 40.0;
const LONG_WALL_M: f64 = 4.0;
const BLANK_SHARE: f64 = 0.35;
/// Share of its glass that a room for rows of desks may lack in the walls along its main facade: windows in the others would be
/// before or behind the screens (DIN EN 527, ASR A3.4: lines of sight run along the windows).
const SPARED_SHARE: f64 = 0.12;
/// Outer wall of a wet room that has a tall shower in one corner and its window in the middle, m; on shorter ones the
/// window makes room for it.
const SHOWER_AND_WINDOW_M: f64 = 2.9;
/// What a width in steps may lack by rounding.
const ROUNDING: f64 = 1e-6;

/// Returns the windows of all rooms.
pub(crate) fn place_windows(brief: &Brief, stretches: &[Stretch], net_m2: &[f64], doors: &[Door]) -> Vec<Window> {
    let mut windows = Vec::new();
    for (i, room) in brief.rooms.iter().enumerate() {
        let Some((sill, mut need)) = glass(room, net_m2[i]) else { continue };
        let pane = if room.zone == Zone::Outdoor { f64::MAX } else { PANE_M.0 };
        // nobody understands a large room by day with a long blank facade
        let wide = room.daylight == Daylight::Required && net_m2[i] >= LARGE_ROOM_M2;
        let open = |s: &&Stretch| !brief.party.is_some_and(|party| party.covers(s));
        let mut outer: Vec<&Stretch> = stretches.iter().filter(|s| s.only_room() == Some(i)).filter(open).collect();
        outer.sort_by_key(|s| (-s.len(), s.vertical, s.at, s.from));
        let along = room.desk_rows.then(|| main_facade(&outer)).flatten();
        let crosses = |s: &Stretch| along.is_some_and(|vertical| s.vertical != vertical);
        outer.sort_by_key(|s| crosses(s));
        let spared = SPARED_SHARE * need;
        for stretch in outer {
            if need < 0.05 && !room.circulation && !wide {
                break;
            }
            if crosses(stretch) && need <= spared {
                continue;
            }
            for (from, to) in free_parts(stretch, doors) {
                let usable = to - from - 2.0 * MARGIN_M;
                let count = ((to - from) / CORRIDOR_STEP_M).floor();
                if room.circulation && count >= 1.0 {
                    let total = count * CORRIDOR_PANE_M;
                    need -= total;
                    add_panes(stretch, from, to, (total, CORRIDOR_PANE_M), sill, room, &mut windows);
                    continue;
                }
                let least = if wide && !crosses(stretch) { (usable * BLANK_SHARE).min(usable) } else { 0.0 };
                let wanted = need.max(if usable >= LONG_WALL_M { least } else { 0.0 });
                if usable < PANE_M.1 || wanted < 0.05 {
                    continue;
                }
                let total = wanted.max(PANE_M.1).min(usable);
                need -= total;
                let cell = room.wet && room.daylight == Daylight::None;
                let (from, to) = if cell { beside_shower(room, stretch, (from, to), doors) } else { (from, to) };
                add_panes(stretch, from, to, (total, pane), sill, room, &mut windows);
            }
        }
    }
    for (i, window) in windows.iter_mut().enumerate() {
        window.window_id = format!("window_{}", i + 1);
    }
    windows
}

/// Returns whether the outer walls that can take most windows of a room run north, of two headings; `None` where all run alike.
fn main_facade(outer: &[&Stretch]) -> Option<bool> {
    let length = |vertical: bool| -> f64 {
        let walls = outer.iter().filter(|s| s.vertical == vertical).map(|s| meters(s.len()) - 2.0 * MARGIN_M);
        walls.filter(|usable| *usable >= PANE_M.1).sum()
    };
    let (north, east) = (length(true), length(false));
    (north > 0.0 && east > 0.0).then_some(north > east)
}

/// Returns sill height and total width of glass a room wants, m.
fn glass(room: &RoomSpec, net_m2: f64) -> Option<(f64, f64)> {
    if room.zone == Zone::Outdoor {
        // a balustrade, open above: all there is
        return Some((BALUSTRADE_M, f64::MAX));
    }
    if room.elevator {
        return None;
    }
    let head = HEAD_M.min(room.ceiling_height - 0.2);
    match room.daylight {
        Daylight::Required | Daylight::Preferred | Daylight::Optional => {
            let sill = if room.high_windows { HIGH_SILL_M } else { SILL_M };
            Some((sill, net_m2 * GLASS_PER_FLOOR / (head - sill)))
        }
        Daylight::None if room.circulation => Some((SILL_M, 1.0)),
        Daylight::None if room.wet => Some((HIGH_SILL_M, PANE_M.1)),
        Daylight::None => None,
    }
}

/// Returns the pieces of an outer wall without its doors, m.
fn free_parts(stretch: &Stretch, doors: &[Door]) -> Vec<(f64, f64)> {
    let along = |p: d3dgen_model::Point| if stretch.vertical { p.y } else { p.x };
    let across = |p: d3dgen_model::Point| if stretch.vertical { p.x } else { p.y };
    let (mut from, end) = (meters(stretch.from), meters(stretch.to));
    let mut cuts: Vec<(f64, f64)> = doors
        .iter()
        .filter(|d| {
            d.line.is_vertical() == stretch.vertical && (across(d.line.start) - meters(stretch.at)).abs() < 1e-6
        })
        .map(|d| (along(d.line.start), along(d.line.end)))
        .filter(|(a, b)| *b > from && *a < end)
        .collect();
    cuts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut parts = Vec::new();
    for (a, b) in cuts {
        parts.push((from, a));
        from = b;
    }
    parts.push((from, end));
    parts
}

/// Returns the end of an outer wall of a wet cell that its window goes to, m: the one that is nearer to the door, for a
/// shower needs a corner without either. The whole wall where it is long enough for both.
fn beside_shower(room: &RoomSpec, stretch: &Stretch, (from, to): (f64, f64), doors: &[Door]) -> (f64, f64) {
    let width = LEAST_WALL_M;
    if to - from >= SHOWER_AND_WINDOW_M || to - from <= width {
        return (from, to);
    }
    let along = |p: d3dgen_model::Point| if stretch.vertical { p.y } else { p.x };
    let door = doors.iter().find(|d| d.room_ids.contains(&room.id));
    let at_end = door.is_some_and(|d| (along(d.line.start) + along(d.line.end)) / 2.0 > (from + to) / 2.0);
    if at_end { (to - width, to) } else { (from, from + width) }
}

fn add_panes(
    stretch: &Stretch,
    from: f64,
    to: f64,
    (total, pane): (f64, f64),
    sill: f64,
    room: &RoomSpec,
    windows: &mut Vec<Window>,
) {
    let count = (total / pane).ceil().max(1.0);
    // Steps of 5 cm keep the document readable: up to the glass it takes, down to the wall there is. Each pane sits in
    // the middle of its share of the wall.
    let share = (to - from) / count;
    let most = (share - 2.0 * MARGIN_M).max(PANE_M.1.min(share));
    let width =
        (total / count * 20.0 - ROUNDING).ceil().max(PANE_M.1 * 20.0).min((most * 20.0 + ROUNDING).floor()) / 20.0;
    for k in 0..count as usize {
        let start = from + share * (k as f64 + 0.5) - width / 2.0;
        windows.push(Window {
            window_id: String::new(),
            line: Segment { start: stretch.point(start), end: stretch.point(start + width) },
            sill_m: sill,
            head_m: HEAD_M.min(room.ceiling_height - 0.2),
            wall_thickness_m: 2.0 * OUTER_HALF_M,
            room_id: room.id.clone(),
            locked: false,
        });
    }
}
