//! Pockets: the piece of wall beside an opening that a sliding leaf is drawn into.
//!
//! A leaf that slides along the face of a wall takes the floor there from furniture, and stands in the next opening when it is
//! open. In a wall it takes nothing, so a wall has to go on beside the opening, without another opening in it.

use d3dgen_model::floorplan::Door;

use super::lattice::{INNER_HALF_M, meters};
use super::outline::Stretch;

/// What a sliding door costs that finds no pocket, what it costs that its leaf parts into two halves, and that both halves slide
/// into the same short wall.
const NONE: f64 = 3.0;
const PARTED: f64 = 0.6;
const TELESCOPE: f64 = 1.2;
/// What may lack of the length of a leaf, m: the frame.
const FRAME_M: f64 = 0.05;

/// An opening in a wall, and how far the wall goes on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pocket {
    vertical: bool,
    at: f64,
    /// The opening along the wall, m.
    from: f64,
    to: f64,
    /// How far the wall goes on before and after it, m.
    runs: [f64; 2],
}

impl Pocket {
    /// Returns where the leaf of a door in a stretch of wall may go.
    pub(super) fn new(s: &Stretch, stretches: &[Stretch], start: f64, width: f64) -> Self {
        let in_line = |t: &&Stretch| t.vertical == s.vertical && t.at == s.at && !t.is_outer();
        let (mut low, mut high) = (s.from, s.to);
        loop {
            let touches = |t: &&Stretch| t.from < low && t.to >= low || t.to > high && t.from <= high;
            let Some(next) = stretches.iter().filter(in_line).find(touches) else { break };
            (low, high) = (low.min(next.from), high.max(next.to));
        }
        let runs = [start - meters(low) - INNER_HALF_M, meters(high) - start - width - INNER_HALF_M];
        Self { vertical: s.vertical, at: meters(s.at), from: start, to: start + width, runs }
    }

    /// Returns what it costs that the leaf has no place beside the opening, whatever other openings are there.
    pub(super) fn cost(&self) -> f64 {
        self.cost_of(self.runs)
    }

    /// Returns what more it costs that another opening is in the same wall; `other` has the pocket of that, where it has one.
    pub(super) fn cost_beside(&self, door: &Door, other: Option<&Self>) -> f64 {
        let (a, b) = (door.line.start, door.line.end);
        let (at, low, high) =
            if self.vertical { (a.x, a.y.min(b.y), a.y.max(b.y)) } else { (a.y, a.x.min(b.x), a.x.max(b.x)) };
        if door.line.is_vertical() != self.vertical || (at - self.at).abs() > INNER_HALF_M {
            return 0.0;
        }
        let after = low >= self.to;
        let between = if after { low - self.to } else { self.from - high };
        // the other leaf goes first where it has no other way
        let theirs = other.map_or(0.0, |o| {
            let width = o.to - o.from;
            let away = o.runs[usize::from(after)];
            if away < width - FRAME_M && between >= width - FRAME_M { width } else { 0.0 }
        });
        let mut runs = self.runs;
        runs[usize::from(after)] = runs[usize::from(after)].min((between - theirs).max(0.0));
        (self.cost_of(runs) - self.cost()).max(0.0)
    }

    fn cost_of(&self, runs: [f64; 2]) -> f64 {
        let width = self.to - self.from;
        if runs[0].max(runs[1]) >= width - FRAME_M {
            0.0
        } else if runs[0].min(runs[1]) >= width / 2.0 {
            PARTED
        } else if runs[0].max(runs[1]) >= width / 2.0 {
            TELESCOPE
        } else {
            NONE
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_leaf_needs_a_wall_without_another_opening() {
        let wall = |from, to, high| Stretch { vertical: false, at: 0, from, to, low: Some(0), high: Some(high) };
        // two rooms of 3 m in a row along a hall
        let walls = [wall(0, 60, 1), wall(60, 120, 2)];
        let corner = Pocket::new(&walls[0], &walls, 0.2, 1.0);
        assert!(corner.cost() < 0.1, "the wall goes on to the east");
        let alone = Pocket::new(&walls[0], &walls[..1], 0.9, 1.2);
        assert!((alone.cost() - PARTED).abs() < 1e-9, "half a leaf to each side");
        let narrow = Pocket::new(&walls[0], &walls[..1], 0.3, 2.0);
        assert!((narrow.cost() - NONE).abs() < 1e-9);
    }
}
