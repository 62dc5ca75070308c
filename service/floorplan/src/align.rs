//! Walls of a storey over those of the one below: lines that miss each other by a hand's breadth, or facades by a step, are
//! moved onto each other where the plan is no worse for it.

use std::collections::BTreeSet;

use super::core::{out_of_core, overhang};
use super::cost::{Judge, WEIGHTS};
use super::lattice::{CELL_M2, Cellbox};
use super::spec::Brief;
use crate::candidate::Candidate;

/// How far an inner wall moves onto one below, how far a facade does, and how far one that has nothing below it, lattice units.
const INNER_REACH: i32 = 5;
const OUTER_REACH: i32 = 18;
const JUTTING_REACH: i32 = 60;
/// What a share of the storey costs that juts out or steps back, beside what jutting out costs anyway.
const RAGGED: f64 = 12.0;
/// What a plan may cost more for walls in line, for each that moves.
const WORTH: f64 = 0.12;

/// Coordinates along one axis.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Axis {
    X,
    Y,
}

impl Axis {
    fn ends(self, b: &Cellbox) -> [i32; 2] {
        match self {
            Self::X => [b.x0, b.x1],
            Self::Y => [b.y0, b.y1],
        }
    }

    /// Returns a box whose edges on one line are on another one.
    fn moved(self, b: &Cellbox, from: i32, to: i32) -> Cellbox {
        let at = |v: i32| if v == from { to } else { v };
        match self {
            Self::X => Cellbox { x0: at(b.x0), x1: at(b.x1), ..*b },
            Self::Y => Cellbox { y0: at(b.y0), y1: at(b.y1), ..*b },
        }
    }
}

/// Puts walls of a storey over those of the one below it, where there is one.
pub(crate) fn align(brief: &Brief, found: &mut Candidate) {
    let Some(below) = brief.core.as_ref().and_then(|c| c.below.as_ref()).filter(|b| !b.boxes.is_empty()) else {
        return;
    };
    let Some(frame) = found.layout.core else { return };
    let boxes = if below.by_core { out_of_core(&below.boxes, &frame) } else { below.boxes.clone() };
    let lower: Vec<(usize, Cellbox)> = boxes.into_iter().map(|b| (0, b)).collect();
    let outline: Vec<Cellbox> = lower.iter().map(|b| b.1).collect();
    let edges = [Axis::X, Axis::Y].map(|axis| {
        let ends = outline.iter().flat_map(|b| axis.ends(b));
        ends.fold([i32::MAX, i32::MIN], |[low, high], at| [low.min(at), high.max(at)])
    });
    let mut judge = Judge::new(brief);
    let cost = |found: &Candidate| {
        let own: Vec<Cellbox> = found.layout.boxes.iter().map(|b| b.1).collect();
        let area: f64 = own.iter().map(Cellbox::area_m2).sum();
        let apart = overhang(&found.layout.boxes, &outline, (0, 0)) + overhang(&lower, &own, (0, 0));
        found.score.total(&WEIGHTS) + RAGGED * apart as f64 * CELL_M2 / area.max(1.0)
    };
    for axis in [Axis::X, Axis::Y] {
        let fixed = fixed(brief, found, axis);
        let below: BTreeSet<i32> = outline.iter().flat_map(|b| axis.ends(b)).collect();
        let lines: BTreeSet<i32> = found.layout.boxes.iter().flat_map(|(_, b)| axis.ends(b)).collect();
        for from in lines.into_iter().filter(|l| !fixed.contains(l)) {
            let outer = is_outer(&found.layout.boxes, axis, from);
            let [low, high] = edges[axis as usize];
            let reach = match outer {
                true if from < low || from > high => JUTTING_REACH,
                true => OUTER_REACH,
                false => INNER_REACH,
            };
            let mut targets: Vec<i32> = below.range(from - reach..=from + reach).copied().collect();
            targets.sort_by_key(|t| ((t - from).abs(), *t));
            if targets.first() == Some(&from) {
                continue;
            }
            let before = cost(found);
            for to in targets {
                if !keeps_order(&found.layout.boxes, axis, (from, to)) {
                    continue;
                }
                let mut other = found.clone();
                other.layout.boxes.iter_mut().for_each(|(_, b)| *b = axis.moved(b, from, to));
                other.score = judge.score(&other.layout);
                if other.score.is_sound() && cost(&other) <= before + WORTH {
                    *found = other;
                    break;
                }
            }
        }
    }
}

/// Returns the lines that stay: those of the core, which is where it is on every storey, and the long walls of the corridor,
/// whose width is settled.
fn fixed(brief: &Brief, found: &Candidate, axis: Axis) -> BTreeSet<i32> {
    let mut out = BTreeSet::new();
    for (room, b) in &found.layout.boxes {
        let long = if b.width() >= b.height() { Axis::Y } else { Axis::X };
        if brief.in_core(*room) || Some(*room) == brief.spine && long == axis {
            out.extend(axis.ends(b));
        }
    }
    out
}

/// Returns true for a line on which an outer wall stands.
fn is_outer(boxes: &[(usize, Cellbox)], axis: Axis, line: i32) -> bool {
    let across = |b: &Cellbox| if axis == Axis::X { [b.y0, b.y1] } else { [b.x0, b.x1] };
    let side = |k: usize| {
        boxes.iter().filter(move |(_, b)| axis.ends(b)[k] == line).map(|(_, b)| across(b)).collect::<Vec<[i32; 2]>>()
    };
    let (ends, begins) = (side(1), side(0));
    let length = |all: &[[i32; 2]]| all.iter().map(|s| s[1] - s[0]).sum::<i32>();
    let shared: i32 =
        ends.iter().flat_map(|a| begins.iter().map(move |b| (a[1].min(b[1]) - a[0].max(b[0])).max(0))).sum();
    length(&ends) > shared || length(&begins) > shared
}

/// Returns true where no other wall stands between a line and where it is to be.
fn keeps_order(boxes: &[(usize, Cellbox)], axis: Axis, (from, to): (i32, i32)) -> bool {
    let between = if to > from { from + 1..=to } else { to..=from - 1 };
    boxes.iter().flat_map(|(_, b)| axis.ends(b)).all(|line| !between.contains(&line))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_with_outer_walls_are_told_from_those_between_rooms() {
        let boxes =
            [(0, Cellbox::new(0, 0, 10, 10)), (1, Cellbox::new(10, 0, 20, 10)), (2, Cellbox::new(0, 10, 10, 20))];
        assert!(is_outer(&boxes, Axis::X, 0) && is_outer(&boxes, Axis::X, 10) && is_outer(&boxes, Axis::X, 20));
        assert!(!is_outer(&boxes[..2], Axis::X, 10));
    }

    #[test]
    fn no_line_passes_another() {
        let boxes = [(0, Cellbox::new(0, 0, 10, 10)), (1, Cellbox::new(10, 0, 20, 10))];
        assert!(keeps_order(&boxes, Axis::X, (20, 24)) && !keeps_order(&boxes, Axis::X, (20, 10)));
        let moved: Vec<Cellbox> = boxes.iter().map(|(_, b)| Axis::X.moved(b, 10, 12)).collect();
        assert_eq!(moved, [Cellbox::new(0, 0, 12, 10), Cellbox::new(12, 0, 20, 10)]);
    }
}
