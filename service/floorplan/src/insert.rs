//! A room more or a room less in a plan that stands: the ways to do it, and the one that disturbs least.

use std::collections::BTreeMap;

use super::board::{Board, units};
use super::cost::{Judge, Weights};
use super::lattice::{Cellbox, INNER_HALF_M, OUTER_HALF_M, meters, up};
use super::outline::{Mosaic, Stretch};
use super::realize::door_need;
use super::spec::Brief;

/// Shapes tried for a new room: front over depth.
const SHAPES: [f64; 5] = [1.0, 1.35, 0.75, 1.8, 0.55];
/// What a square meter taken from a room that was there costs.
const TAKEN: f64 = 0.05;
/// What a way out of keeping costs: kept rooms touched, rooms in pieces, a hole without a way out.
const OUT_OF_KEEPING: f64 = 1000.0;

/// A way to do it, and its kind: outside, beside a longer corridor, or cut off a room (and which).
type Way = (usize, Board);
const OUTSIDE: usize = 0;
const LONGER_CORRIDOR: usize = 1;
const CUT_OFF: usize = 2;

/// Chooses among boards by what they cost.
pub(crate) struct Chooser<'a> {
    brief: &'a Brief,
    judge: Judge<'a>,
    weights: &'a Weights,
    kept: &'a [bool],
    before: Board,
    outdoors: Vec<Cellbox>,
    indoors: Vec<Cellbox>,
}

impl<'a> Chooser<'a> {
    /// Returns a chooser that keeps the walls of the rooms chosen as they are on a board; rooms that the new plan lacks
    /// stand there still, as `gone`.
    pub(crate) fn new(
        brief: &'a Brief,
        weights: &'a Weights,
        kept: &'a [bool],
        before: &Board,
        gone: &[Vec<Cellbox>],
    ) -> Self {
        let mut stood = before.clone();
        stood.rooms.extend_from_slice(gone);
        let mut chosen = kept.to_vec();
        chosen.resize(stood.rooms.len(), false);
        let (outdoors, indoors) = stood.rims(&chosen);
        Self { brief, judge: Judge::new(brief), weights, kept, before: before.clone(), outdoors, indoors }
    }

    /// Closes the hole that a room leaves: a neighbor takes it, or it falls to the outdoors.
    pub(crate) fn close(&mut self, board: &Board, hole: &[Cellbox], enclosed: bool) -> Board {
        let mut ways = Vec::new();
        for room in (0..board.rooms.len()).filter(|&r| !self.kept[r]) {
            let touches = board.rooms[room].iter().any(|b| hole.iter().any(|h| h.contact(b).is_some()));
            if touches {
                let mut way = board.clone();
                hole.iter().for_each(|h| way.give(room, h));
                ways.push((CUT_OFF + room, way));
            }
        }
        if !enclosed || ways.is_empty() {
            ways.push((OUTSIDE, board.clone()));
        }
        self.best(ways, 0).unwrap_or_else(|| board.clone())
    }

    /// Returns the board with cells for a room that has none, in the way that is `nth` best (0: the best); `None` when
    /// there are not so many places.
    pub(crate) fn insert(&mut self, board: &Board, room: usize, nth: usize) -> Option<Board> {
        let spec = &self.brief.rooms[room];
        let mut hosts: Vec<usize> = spec.host.into_iter().collect();
        hosts.extend(self.brief.spine.filter(|s| *s != room && (spec.on_spine || hosts.is_empty())));
        let mut ways = Vec::new();
        let stretches = Mosaic::new(&board.layout().boxes).stretches();
        for s in stretches.iter().filter(|s| s.only_room().is_some_and(|r| hosts.contains(&r))) {
            for shape in SHAPES {
                outside(board, room, s, size(spec.area_target, shape), &mut ways);
                if s.only_room() == self.brief.spine && !self.brief.hub {
                    self.beside_longer_corridor(board, room, s, size(spec.area_target, shape), &mut ways);
                }
            }
        }
        for other in (0..board.rooms.len()).filter(|&r| r != room && !self.kept[r] && Some(r) != self.brief.spine) {
            carved(board, room, other, spec.area_target, &mut ways);
        }
        if let Some(spine) = self.brief.spine.filter(|s| hosts.contains(s)) {
            between(board, room, spine, spec.area_target, &mut ways);
        }
        self.best(ways, nth)
    }

    /// Lengthens the corridor at its end and sets the room beside the new piece.
    fn beside_longer_corridor(
        &self,
        board: &Board,
        room: usize,
        s: &Stretch,
        (front, depth): (i32, i32),
        ways: &mut Vec<Way>,
    ) {
        let front = front.max(door_need(self.brief.rooms[room].door_width));
        let piece = beyond(s, s.from, s.to, front);
        if !board.owners(&piece).is_empty() {
            return;
        }
        let mut longer = board.clone();
        let Some(corridor) = s.only_room() else { return };
        longer.give(corridor, &piece);
        for side in if s.vertical { [2, 3] } else { [0, 1] } {
            let place = piece.strip(side, depth);
            if board.owners(&place).is_empty() {
                let mut way = longer.clone();
                way.give(room, &place);
                ways.push((LONGER_CORRIDOR, way));
            }
        }
    }

    /// Returns the cheapest of several boards, or the one that is `nth` after it; `None` when those are out of keeping.
    fn best(&mut self, ways: Vec<Way>, nth: usize) -> Option<Board> {
        let mut ranked: Vec<(usize, f64, Board)> = ways.into_iter().map(|(k, way)| (k, self.cost(&way), way)).collect();
        ranked.retain(|(_, cost, _)| *cost < OUT_OF_KEEPING);
        ranked.sort_by(|a, b| a.1.total_cmp(&b.1));
        // The best of each kind come first: what one kind cannot do, its second best cannot do either.
        let mut seen: BTreeMap<usize, usize> = BTreeMap::new();
        for (kind, _, _) in &mut ranked {
            let turn = seen.entry(*kind).or_default();
            *kind = std::mem::replace(turn, *turn + 1);
        }
        ranked.sort_by_key(|(turn, _, _)| *turn);
        ranked.into_iter().nth(nth).map(|(_, _, way)| way)
    }

    fn cost(&mut self, way: &Board) -> f64 {
        let touched = self.outdoors.iter().any(|rim| !way.owners(rim).is_empty())
            || self.indoors.iter().any(|rim| way.owners(rim).iter().map(|(_, n)| n).sum::<i64>() < units(rim));
        let moved = (0..way.rooms.len()).any(|r| self.kept[r] && way.rooms[r] != self.before.rooms[r]);
        let pieces = (0..way.rooms.len()).any(|r| !way.rooms[r].is_empty() && !way.is_whole(r));
        let mut cost = if touched || moved || pieces { OUT_OF_KEEPING } else { 0.0 };
        // Rooms that wait for their place weigh the same in every way.
        cost += self.judge.score(&way.layout()).total(self.weights).min(OUT_OF_KEEPING / 2.0);
        cost + TAKEN * way.changed_m2(&self.before)
    }
}

/// Returns front and depth of a room between wall center lines, lattice units.
fn size(net_m2: f64, shape: f64) -> (i32, i32) {
    let walls = INNER_HALF_M + OUTER_HALF_M;
    let front = (net_m2 * shape).sqrt();
    (up(front + walls), up(net_m2 / front + walls))
}

/// Returns the rectangle outside a stretch between two positions along it.
fn beyond(s: &Stretch, from: i32, to: i32, deep: i32) -> Cellbox {
    let (near, far) = if s.low.is_none() { (s.at - deep, s.at) } else { (s.at, s.at + deep) };
    if s.vertical { Cellbox::new(near, from, far, to) } else { Cellbox::new(from, near, to, far) }
}

/// Sets a room outside, against an outer wall: at both ends of it, and in its middle.
fn outside(board: &Board, room: usize, s: &Stretch, (front, depth): (i32, i32), ways: &mut Vec<Way>) {
    for from in [s.from, s.to - front, (s.from + s.to - front) / 2] {
        let place = beyond(s, from, from + front, depth);
        if board.owners(&place).is_empty() {
            let mut way = board.clone();
            way.give(room, &place);
            ways.push((OUTSIDE, way));
        }
    }
}

/// Pushes the building apart at a wall beside the corridor, and sets the room into the gap. Rooms move whole; across the
/// corridor the gap stays open.
fn between(board: &Board, room: usize, spine: usize, net_m2: f64, ways: &mut Vec<Way>) {
    let Some(&main) = board.rooms[spine].first() else { return };
    let along_x = main.width() >= main.height();
    // With the corridor from west to east.
    let lay = |b: &Cellbox| if along_x { *b } else { Cellbox { x0: b.y0, y0: b.x0, x1: b.y1, y1: b.x1 } };
    let corridor = lay(&main);
    let laid: Vec<Vec<Cellbox>> = board.rooms.iter().map(|cells| cells.iter().map(lay).collect()).collect();
    let mut kind = CUT_OFF + board.rooms.len();
    for beside in laid.iter().enumerate().filter(|(r, _)| *r != spine).flat_map(|(_, cells)| cells) {
        let north = beside.y0 == corridor.y1;
        if !north && beside.y1 != corridor.y0 {
            continue;
        }
        let deep = beside.height();
        let wide = up(net_m2 / (meters(deep) - INNER_HALF_M - OUTER_HALF_M).max(0.1) + 2.0 * INNER_HALF_M);
        for cut in [beside.x0, beside.x1].into_iter().filter(|c| (corridor.x0 + 1..corridor.x1).contains(c)) {
            let by = |b: &Cellbox, by: i32| Cellbox { x0: b.x0 + by, x1: b.x1 + by, ..*b };
            let pushed = |(r, cells): (usize, &Vec<Cellbox>)| -> Vec<Cellbox> {
                let middle =
                    cells.iter().map(|b| b.x0).min().unwrap_or(0) + cells.iter().map(|b| b.x1).max().unwrap_or(0);
                cells
                    .iter()
                    .map(|b| match r == spine {
                        true if b.x0 < cut && cut < b.x1 => Cellbox { x1: b.x1 + wide, ..*b },
                        true => by(b, if b.x0 >= cut { wide } else { 0 }),
                        false => by(b, if middle > 2 * cut { wide } else { 0 }),
                    })
                    .collect()
            };
            let mut rooms: Vec<Vec<Cellbox>> = laid.iter().enumerate().map(pushed).collect();
            let (y0, y1) = if north { (corridor.y1, corridor.y1 + deep) } else { (corridor.y0 - deep, corridor.y0) };
            rooms[room] = vec![Cellbox { x0: cut, y0, x1: cut + wide, y1 }];
            let all: Vec<Cellbox> = rooms.iter().flatten().copied().collect();
            let clash = all.iter().enumerate().any(|(i, a)| all[i + 1..].iter().any(|b| a.overlap(b).is_some()));
            if !clash {
                let rooms = rooms.iter().map(|cells| cells.iter().map(lay).collect()).collect();
                ways.push((kind, Board { rooms }));
                kind += 1;
            }
        }
    }
}

/// Cuts a room off another: along each of its sides.
fn carved(board: &Board, room: usize, other: usize, net_m2: f64, ways: &mut Vec<Way>) {
    let Some(&main) = board.rooms[other].first() else { return };
    for side in 0..4 {
        let (length, across) = if side < 2 { (main.height(), main.width()) } else { (main.width(), main.height()) };
        let deep = up(net_m2 / (meters(length) - 2.0 * INNER_HALF_M).max(0.1) + 2.0 * INNER_HALF_M);
        if deep < across {
            let mut way = board.clone();
            way.give(room, &main.strip(side, -deep));
            ways.push((CUT_OFF + other, way));
        }
    }
}
