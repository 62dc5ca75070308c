//! Planning a part anew: rooms that are kept stay to the millimeter, the others are planned again around them.
//!
//! The start is a plan that stands, so a sound one is never lost: walls slide, neighbors are cut anew, rooms change
//! places, and the outline moves where no kept room has its outer wall. The corridor stays where it is.

use d3dgen_model::seed::Stream;
use d3dgen_model::stage::Stop;

use super::board::{Board, units};
use super::cost::{Judge, Weights};
use super::lattice::{Cellbox, up};
use super::realize::Layout;
use super::spec::Brief;
use crate::changes::patience;

/// Steps per free room, and at least and at most in all.
const STEPS_PER_ROOM: usize = 700;
const STEPS: (usize, usize) = (2_000, 20_000);
/// Temperature at the start of a plan made anew, of a repair, and at the end, in cost units.
const HEAT_ANEW: f64 = 2.0;
const HEAT_REPAIR: f64 = 0.4;
const HEAT_END: f64 = 0.02;
/// Rooms that change places before a plan is made anew, per free room.
const SHUFFLES_PER_ROOM: usize = 2;
/// Free air that an outer wall keeps to the next building part, m.
const AIR_M: f64 = 3.0;
/// What a square meter that changes hands costs in a repair.
const CHANGE: f64 = 0.4;
/// What a hard rule missed costs beyond its share in the total, by how far and at all: sound plans come first.
const MISSED: f64 = 30.0;
const UNSOUND: f64 = 1.5;
/// Chance that a change may leave a room with one corner more.
const CORNERS: f64 = 0.1;
/// What a room in pieces costs: like a hard rule missed by a meter.
const IN_PIECES: f64 = 30.0;

/// What the revision aims for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Aim {
    /// Another good plan of the rooms that are free.
    Anew,
    /// The least change that makes the plan sound.
    Repair,
}

/// The task: which rooms are free, and what must stay where.
pub(crate) struct Task<'a> {
    pub brief: &'a Brief,
    /// By room: true for those that keep their cells.
    pub kept: &'a [bool],
    /// Rectangles that a room must own in the end (a wall that was just moved).
    pub pins: &'a [(usize, Cellbox)],
    pub aim: Aim,
    /// True when the corridor moves like the other rooms.
    pub moves_spine: bool,
}

impl Task<'_> {
    /// Returns the better plan found; its score says whether it is sound.
    pub(crate) fn revise(&self, start: &Board, weights: &Weights, rng: &mut Stream, stop: Stop<'_>) -> Board {
        let free: Vec<usize> =
            (0..start.rooms.len()).filter(|&r| self.is_free(r) && !start.rooms[r].is_empty()).collect();
        if free.is_empty() {
            return start.clone();
        }
        let (outdoors, indoors) = start.rims(self.kept);
        let hand = Hand { task: self, free: &free, outdoors, indoors };
        let mut judge = Judge::new(self.brief);
        let mut layout = Layout::default();
        let mut value = |board: &Board| self.cost(board, start, &mut judge, &mut layout, weights);
        let mut current = start.clone();
        if self.aim == Aim::Anew {
            for _ in 0..SHUFFLES_PER_ROOM * free.len() {
                hand.swap(&mut current, rng);
            }
        }
        let mut cost = value(&current);
        let (mut best, mut least) = (current.clone(), cost);
        let steps = (STEPS_PER_ROOM * free.len()).clamp(STEPS.0, STEPS.1);
        let first = if self.aim == Aim::Anew { HEAT_ANEW } else { HEAT_REPAIR };
        for step in 0..steps {
            if stop.is_set() {
                break;
            }
            let left = 1.0 - step as f64 / steps as f64;
            let heat = HEAT_END + (first - HEAT_END) * left * left * left;
            let mut trial = current.clone();
            if !hand.change(&mut trial, rng) {
                continue;
            }
            let next = value(&trial);
            if next <= cost || next - cost < heat * patience(rng) {
                current = trial;
                cost = next;
                if cost < least {
                    best.clone_from(&current);
                    least = cost;
                }
            }
        }
        best
    }

    /// Returns true when a board breaks no hard rule and moves no pin.
    pub(crate) fn accepts(&self, board: &Board) -> bool {
        let whole = (0..board.rooms.len()).all(|r| board.is_whole(r));
        let pinned = self.pins.iter().all(|(room, pin)| board.owners(pin) == [(*room, units(pin))]);
        whole && pinned && Judge::new(self.brief).score(&board.layout()).is_sound()
    }

    fn is_free(&self, room: usize) -> bool {
        !self.kept[room] && (self.moves_spine || self.brief.hub || Some(room) != self.brief.spine)
    }

    fn cost(&self, board: &Board, start: &Board, judge: &mut Judge<'_>, layout: &mut Layout, weights: &Weights) -> f64 {
        board.write(layout);
        let score = judge.score(layout);
        let mut cost = score.total(weights) + score.hard * MISSED;
        if !score.is_sound() {
            cost += UNSOUND;
        }
        cost += IN_PIECES * (0..board.rooms.len()).filter(|&r| !board.is_whole(r)).count() as f64;
        for (room, pin) in self.pins {
            let owned: i64 = board.owners(pin).iter().filter(|(r, _)| r == room).map(|(_, n)| n).sum();
            cost += IN_PIECES * (1.0 - owned as f64 / units(pin) as f64);
        }
        if self.aim == Aim::Repair {
            cost += CHANGE * board.changed_m2(start);
        }
        cost
    }
}

/// Changes boards within what the task allows.
struct Hand<'a> {
    task: &'a Task<'a>,
    free: &'a [usize],
    /// Outside of kept rooms: what stays free of buildings, and what stays built on.
    outdoors: Vec<Cellbox>,
    indoors: Vec<Cellbox>,
}

impl Hand<'_> {
    /// Changes one thing; returns false when the drawn change does not apply.
    fn change(&self, board: &mut Board, rng: &mut Stream) -> bool {
        match rng.below(100) {
            0..64 => self.slide(board, rng),
            64..78 => self.cut_anew(board, rng),
            78..90 => self.swap(board, rng),
            _ => self.retreat(board, rng),
        }
    }

    fn any(&self, rng: &mut Stream) -> usize {
        self.free[rng.below(self.free.len())]
    }

    /// Moves one side of a room outwards, into its neighbors or the open.
    fn slide(&self, board: &mut Board, rng: &mut Stream) -> bool {
        let room = self.any(rng);
        let cells = &board.rooms[room];
        if cells.is_empty() {
            return false;
        }
        let side = rng.below(4);
        let strip = cells[rng.below(cells.len())].strip(side, 1 + rng.below(8) as i32);
        let owners = board.owners(&strip);
        let taken: i64 = owners.iter().map(|(_, n)| n).sum();
        if taken == 0 {
            // The open: not before a kept room's windows, not into a slit.
            let air = strip.strip(side, up(AIR_M));
            let blocked = self.outdoors.iter().any(|r| r.overlap(&strip).is_some()) || !board.owners(&air).is_empty();
            if blocked {
                return false;
            }
        } else if taken < units(&strip) || owners.iter().any(|(r, _)| *r == room || !self.task.is_free(*r)) {
            return false;
        }
        let pieces = |b: &Board| owners.iter().map(|(r, _)| b.rooms[*r].len()).sum::<usize>() + b.rooms[room].len();
        let before = pieces(board);
        board.give(room, &strip);
        pieces(board) <= before || rng.chance(CORNERS)
    }

    /// Moves an outer side of a room inwards.
    fn retreat(&self, board: &mut Board, rng: &mut Stream) -> bool {
        let room = self.any(rng);
        let cells = &board.rooms[room];
        if cells.is_empty() {
            return false;
        }
        let (side, deep) = (rng.below(4), 1 + rng.below(6) as i32);
        let cell = cells[rng.below(cells.len())];
        let strip = cell.strip(side, -deep);
        let beyond = cell.strip(side, 1);
        let wide = if side < 2 { cell.width() } else { cell.height() };
        if wide <= deep || !board.owners(&beyond).is_empty() || self.indoors.iter().any(|r| r.overlap(&strip).is_some())
        {
            return false;
        }
        board.clear(&strip);
        true
    }

    /// Exchanges the places of two rooms.
    fn swap(&self, board: &mut Board, rng: &mut Stream) -> bool {
        let (a, b) = (self.any(rng), self.any(rng));
        board.rooms.swap(a, b);
        a != b
    }

    /// Cuts the rectangle of two neighbors anew, by their areas, along or across.
    fn cut_anew(&self, board: &mut Board, rng: &mut Stream) -> bool {
        let (a, b) = (self.any(rng), self.any(rng));
        let ([first], [second]) = (board.rooms[a].as_slice(), board.rooms[b].as_slice()) else { return false };
        let whole = first.union(second);
        if a == b || units(&whole) != units(first) + units(second) {
            return false;
        }
        let [wants_a, wants_b] = [a, b].map(|r| self.task.brief.rooms[r].area_target);
        let share = wants_a / (wants_a + wants_b);
        let (low, high) = if rng.chance(0.5) { (a, b) } else { (b, a) };
        let share = if low == a { share } else { 1.0 - share };
        let along_x = rng.chance(0.5);
        let length = if along_x { whole.width() } else { whole.height() };
        let cut = (f64::from(length) * share) as i32;
        if cut <= 0 || cut >= length {
            return false;
        }
        let (one, other) = if along_x {
            (Cellbox { x1: whole.x0 + cut, ..whole }, Cellbox { x0: whole.x0 + cut, ..whole })
        } else {
            (Cellbox { y1: whole.y0 + cut, ..whole }, Cellbox { y0: whole.y0 + cut, ..whole })
        };
        board.rooms[low] = vec![one];
        board.rooms[high] = vec![other];
        true
    }
}
