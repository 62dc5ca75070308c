//! Corridors behind a lock: the part of a corridor that only those come to whose work it is.
//!
//! The search knows one straight corridor. What is behind the lock lies at one end of it, which costs as long as it does not;
//! the finished layout is then cut where no door is, and a door across the corridor parts both.

use d3dgen_model::scene_graph::Connector;

use super::lattice::{Cellbox, INNER_HALF_M, up};
use super::spec::{Brief, Link};

/// What a layout misses whose corridor is none that one wall parts, m.
const NOT_STRAIGHT: f64 = 10.0;
/// Least length of each part of the corridor, lattice units: 2.4 m, a bed and who pushes it.
const LEAST: i32 = 48;

/// A place for the wall across a corridor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Cut {
    /// Where it is along the corridor.
    at: i32,
    /// True where what is locked lies beyond it, to the east or north.
    beyond: bool,
}

/// Returns the task with both parts as one corridor, as the search looks for it; `None` where nothing is locked.
pub(crate) fn joined(brief: &Brief) -> Option<Brief> {
    let (spine, inner) = (brief.spine?, brief.locked?);
    if inner + 1 != brief.rooms.len() {
        return None;
    }
    let mut out = brief.clone();
    out.rooms.pop();
    let ends = |l: &Link| [(l.a, l.b), (l.b, l.a)].into_iter().find(|(_, other)| *other == inner).map(|(room, _)| room);
    for link in &brief.links {
        let Some(room) = ends(link).filter(|room| *room != spine && link.required) else { continue };
        let spec = &mut out.rooms[room];
        (spec.on_spine, spec.locked) = (true, true);
        spec.open_front |= link.connector == Connector::Open;
    }
    out.rooms.iter_mut().filter(|r| r.host == Some(inner)).for_each(|r| r.host = None);
    out.links.retain(|l| ends(l).is_none());
    out.apart.retain(|pair| !pair.contains(&inner));
    out.aloof.retain(|pair| !pair.contains(&inner));
    out.locked = None;
    out.find_guests();
    Some(out)
}

/// Returns what rooms before and behind a lock miss of lying at two ends of the corridor, m, and where the wall between is best.
pub(crate) fn cut(brief: &Brief, boxes: &[(usize, Cellbox)], needs: &[i32]) -> (f64, Option<Cut>) {
    let Some(spine) = brief.spine else { return (NOT_STRAIGHT, None) };
    let mut parts = boxes.iter().filter(|(room, _)| *room == spine).map(|(_, b)| *b);
    let (Some(corridor), None) = (parts.next(), parts.next()) else { return (NOT_STRAIGHT, None) };
    let (from, to) = along(&corridor, corridor.width() >= corridor.height());
    let (from, to) = (from + LEAST, to - LEAST);
    // by side of the wall: the furthest east that a door before it needs, the furthest west that one behind it leaves
    let mut ends = [[from, to], [from, to]];
    for (room, spec) in brief.rooms.iter().enumerate().filter(|(room, r)| r.on_spine && *room != spine) {
        let Some((low, high)) = front(boxes, room, &corridor) else { continue };
        let need = needs[room].min(high - low);
        let side = usize::from(spec.locked);
        ends[side][0] = ends[side][0].max(low + need);
        ends[side][1] = ends[side][1].min(high - need);
    }
    let [before, behind] = ends;
    let wall = up(2.0 * INNER_HALF_M);
    // locked to the east, or to the west
    let ways = [(true, before[0], behind[1]), (false, behind[0], before[1])];
    let best = ways.into_iter().map(|(beyond, low, high)| ((low + wall - high).max(0), low, high, beyond));
    let Some((short, low, high, beyond)) = best.min_by_key(|way| way.0) else { return (NOT_STRAIGHT, None) };
    let cut = (short == 0).then(|| Cut { at: (low + high) / 2, beyond });
    (super::lattice::meters(short), cut)
}

/// Cuts the corridor of a layout in two.
pub(crate) fn part(brief: &Brief, boxes: &mut Vec<(usize, Cellbox)>, cut: Cut) {
    let Some((spine, inner)) = brief.spine.zip(brief.locked) else { return };
    let Some(corridor) = boxes.iter().position(|(room, _)| *room == spine) else { return };
    let b = boxes[corridor].1;
    let [west, east] = if b.width() >= b.height() {
        [Cellbox::new(b.x0, b.y0, cut.at, b.y1), Cellbox::new(cut.at, b.y0, b.x1, b.y1)]
    } else {
        [Cellbox::new(b.x0, b.y0, b.x1, cut.at), Cellbox::new(b.x0, cut.at, b.x1, b.y1)]
    };
    let (open, shut) = if cut.beyond { (west, east) } else { (east, west) };
    boxes[corridor].1 = open;
    boxes.push((inner, shut));
}

fn along(b: &Cellbox, horizontal: bool) -> (i32, i32) {
    if horizontal { (b.x0, b.x1) } else { (b.y0, b.y1) }
}

/// Returns the longest piece of the corridor that a room lies at, along it; the end where it closes the corridor.
fn front(boxes: &[(usize, Cellbox)], room: usize, corridor: &Cellbox) -> Option<(i32, i32)> {
    let horizontal = corridor.width() >= corridor.height();
    let own = boxes.iter().filter(|(r, _)| *r == room);
    let fronts = own.filter_map(|(_, b)| {
        let (side, from, to) = b.contact(corridor)?;
        let closes = (side < 2) == horizontal;
        let (low, high) = along(b, horizontal);
        let (start, _) = along(corridor, horizontal);
        let end = if low < start { high } else { low };
        Some(if closes { (end, end) } else { (from, to) })
    });
    fronts.max_by_key(|(from, to)| to - from)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{ward, with_locked};

    fn row(rooms: &[(usize, i32, i32)]) -> Vec<(usize, Cellbox)> {
        rooms.iter().map(|&(room, from, to)| (room, Cellbox::new(from, 60, to, 160))).collect()
    }

    #[test]
    fn rooms_behind_a_lock_lie_at_one_end_of_the_corridor() {
        // rooms 0 and 1 before the lock, 2 and 3 behind it
        let brief = with_locked(ward(0), &[2, 3]);
        let search = joined(&brief).expect("two rooms are locked");
        let spine = search.spine.expect("there is a corridor");
        let needs = vec![25; search.rooms.len()];
        let corridor = (spine, Cellbox::new(0, 0, 400, 60));
        let mut good = row(&[(0, 0, 100), (1, 100, 200), (2, 200, 300), (3, 300, 400)]);
        good.push(corridor);
        let (short, found) = cut(&search, &good, &needs);
        assert_eq!(short, 0.0);
        let found = found.expect("the corridor can be cut");
        let mut mixed = row(&[(2, 0, 100), (0, 100, 200), (3, 200, 300), (1, 300, 400)]);
        mixed.push(corridor);
        assert!(cut(&search, &mixed, &needs).0 > 1.0);
        part(&brief, &mut good, found);
        let of = |room: usize| good.iter().find(|(r, _)| *r == room).map(|(_, b)| *b).expect("both parts are there");
        let (open, shut) = (of(spine), of(brief.locked.expect("it is locked")));
        assert_eq!((open.x0, open.x1, shut.x1), (0, shut.x0, 400));
        assert!((150..250).contains(&shut.x0));
    }
}
