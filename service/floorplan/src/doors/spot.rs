//! A place for one door, and what it costs beside another one.

use d3dgen_model::Rect;
use d3dgen_model::floorplan::Door;

/// What it costs that the doors of a bathroom and of a room where one sits or eats face each other, how far apart they may
/// be for that, m, and from which shared width on, m.
const IN_VIEW: f64 = 1.3;
const VIEW_M: f64 = 3.0;
const SEEN_M: f64 = 0.2;
/// What it costs that a sliding leaf has wall only for two halves behind each other, and none to go into.
const TWO_LEAVES: f64 = 1.0;
const NO_POCKET: f64 = 6.0;

/// What one looks into through a door.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum View {
    /// A bathroom or toilet.
    Retreat,
    /// A room where people sit, eat, cook or come in.
    Company,
    Other,
}

/// A place for one door.
#[derive(Clone)]
pub(super) struct Spot {
    pub door: Door,
    /// Ends of the wall that a sliding leaf goes into, along it, m.
    pub wall: Option<(f64, f64)>,
    pub view: View,
    /// Floor the leaf sweeps and floor to stand on, by room.
    pub zones: Vec<(usize, Rect)>,
    pub penalty: f64,
}

impl Spot {
    /// Returns what it costs that two doors need the same floor or the same wall, or that one looks from a room into a
    /// bathroom.
    pub fn disturbs(&self, other: &Self) -> f64 {
        let clashes =
            |(room, zone): &(usize, Rect)| other.zones.iter().filter(|(r, z)| r == room && z.overlaps(zone)).count();
        10.0 * self.zones.iter().map(clashes).sum::<usize>() as f64
            + if self.looks_into(other) { IN_VIEW } else { 0.0 }
            + self.lacks_wall_beside(other)
    }

    /// Returns what it costs that the leaves of two doors in one wall do not both find wall to go into, in one piece or in two.
    pub fn lacks_wall_beside(&self, other: &Self) -> f64 {
        match (self.finds_wall_beside(other, 1.0), self.finds_wall_beside(other, 0.5)) {
            (true, _) => 0.0,
            (false, true) => TWO_LEAVES,
            (false, false) => NO_POCKET,
        }
    }

    /// Returns true for doors of different walls, and for those in one wall whose leaves, where they slide, find wall for this
    /// share of their width each.
    fn finds_wall_beside(&self, other: &Self, share: f64) -> bool {
        let (own, theirs) = (self.door.line.span(), other.door.line.span());
        let in_line = self.door.line.is_vertical() == other.door.line.is_vertical() && (own.0 - theirs.0).abs() < 1e-6;
        if !in_line || self.wall.is_none() && other.wall.is_none() {
            return true;
        }
        let (first, second) = if own.1 < theirs.1 { (self, other) } else { (other, self) };
        let ((_, from, to), (_, low, high)) = (first.door.line.span(), second.door.line.span());
        // how much of the wall between them each of its two ways takes, for those that fit
        let ways = |wall: Option<(f64, f64)>, takes: f64, outer: f64| match wall {
            None => vec![0.0],
            Some(_) => [(outer >= takes).then_some(0.0), Some(takes)].into_iter().flatten().collect(),
        };
        let left = ways(first.wall, share * first.door.clear_width_m, first.wall.map_or(0.0, |w| from - w.0));
        let right = ways(second.wall, share * second.door.clear_width_m, second.wall.map_or(0.0, |w| w.1 - high));
        left.iter().any(|a| right.iter().any(|b| a + b <= low - to))
    }

    /// Returns what it costs that the wall of a sliding door is too short for its leaf on both sides.
    pub fn lacks_pocket(&self) -> f64 {
        let (_, from, to) = self.door.line.span();
        let short =
            |share: f64| self.wall.is_some_and(|(low, high)| (from - low).max(high - to) < share * (to - from) - 1e-6);
        if short(0.5) {
            NO_POCKET
        } else if short(1.0) {
            TWO_LEAVES
        } else {
            0.0
        }
    }

    /// Returns true when the doors of a bathroom and of a room with people face each other.
    pub fn looks_into(&self, other: &Self) -> bool {
        let views = (self.view, other.view);
        matches!(views, (View::Retreat, View::Company) | (View::Company, View::Retreat))
            && faces(&self.door, &other.door)
    }
}

/// Returns true for doors in opposite walls of one room that are not far apart.
fn faces(a: &Door, b: &Door) -> bool {
    let ((at, from, to), (other, low, high)) = (a.line.span(), b.line.span());
    a.line.is_vertical() == b.line.is_vertical()
        && (SEEN_M..VIEW_M).contains(&(at - other).abs())
        && to.min(high) - from.max(low) > SEEN_M
        && a.room_ids.iter().any(|r| b.room_ids.contains(r))
}
