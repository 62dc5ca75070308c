//! Which rooms of a symmetric plan stand across from each other: those of one type first, then those that are nearest in
//! kind and size. What is left stands on the axis.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use d3dgen_model::domain::Daylight;
use d3dgen_model::seed::Stream;

use super::genome::{Cell, MOST_NESTS, guest_of, is_nestable, nest_depth};
use super::mirror::same_kind;
use super::realize::span;
use super::spec::{Brief, RoomSpec};

/// What two rooms of different kinds count as differing in size, when a room looks for one to stand across from.
const OTHER_KIND: f64 = 1.0;
/// Share of rooms that nothing is like which stand across from another all the same, where one is of a size.
const PAIRED_ALL_THE_SAME: f64 = 0.85;
/// What a room with another that is entered from it counts as a room to stand on the axis.
const CUT: f64 = 0.3;
/// Depths of rows that are looked at for whether a room fits, lattice units.
const DEPTHS: RangeInclusive<i32> = 30..=200;
const DEPTH_STEP: usize = 4;
/// Least range of areas that two rooms share, as a share of the area.
const LEAST_RANGE: f64 = 0.05;

/// The rooms of a plan in pairs.
pub(crate) struct Twins {
    /// By room: the other one, for the room of each pair that stands for both in one half of the plan.
    pub other: Vec<Option<usize>>,
    /// By room: true for those that have no twin.
    pub single: Vec<bool>,
    /// The task with one size for both rooms of each pair.
    pub even: Brief,
}

impl Twins {
    /// Pairs the rooms of a task, by chance where there is a choice; `seats` of those without their like stand on the axis.
    pub(crate) fn draw(brief: &Brief, seats: usize, rng: &mut Stream) -> Self {
        let count = brief.rooms.len();
        let mut twins = Self { other: vec![None; count], single: vec![false; count], even: brief.clone() };
        let mut free: Vec<usize> = (0..count).filter(|&r| is_free(brief, r) && tie(brief, r).is_none()).collect();
        rng.shuffle(&mut free);
        let mut by_type: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        for &room in &free {
            by_type.entry(&brief.rooms[room].room_type).or_default().push(room);
        }
        let mut left = Vec::new();
        for rooms in by_type.into_values() {
            left.extend(twins.pair_alike(brief, rooms, rng));
        }
        twins.pair_left(brief, left, seats, rng);
        for room in (0..count).filter(|&r| is_free(brief, r)) {
            let paired = twins.other[room].is_some() || twins.other.contains(&Some(room));
            twins.single[room] = !paired;
        }
        twins
    }

    /// Pairs rooms of one type with those next in size; returns those that are left.
    fn pair_alike(&mut self, brief: &Brief, mut rooms: Vec<usize>, rng: &mut Stream) -> Vec<usize> {
        rooms.sort_by(|a, b| brief.rooms[*a].area_target.total_cmp(&brief.rooms[*b].area_target));
        let mut left = Vec::new();
        if rooms.len() % 2 == 1 {
            // the one on the axis is rather the largest
            let at = if rng.chance(0.6) { rooms.len() - 1 } else { rng.below(rooms.len()) };
            left.push(rooms.remove(at));
        }
        for pair in rooms.chunks(2) {
            if !self.pair(brief, pair[0], pair[1]) {
                left.extend(pair);
            }
        }
        left
    }

    /// Gives the largest of the rooms that are left the seats on the axis, and pairs the others with the nearest in kind and
    /// size.
    fn pair_left(&mut self, brief: &Brief, mut left: Vec<usize>, seats: usize, rng: &mut Stream) {
        let weight = |r: &usize, rng: &mut Stream| {
            let entered = if brief.rooms[*r].entrance { 1000.0 } else { 0.0 };
            // what has a room cut out on one side is no longer alike on both
            let whole = if company(brief, *r).len() > 1 { CUT } else { 1.0 };
            entered + whole * brief.rooms[*r].area_target * (0.6 + 0.8 * rng.unit())
        };
        let mut weighed: Vec<(f64, usize)> = left.drain(..).map(|r| (weight(&r, rng), r)).collect();
        weighed.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut rest: Vec<usize> = weighed.into_iter().skip(seats).map(|(_, r)| r).collect();
        while let Some(room) = rest.first().copied() {
            rest.remove(0);
            let apart = |other: usize| {
                let [a, b] = [room, other].map(|r| brief.rooms[r].area_target);
                a.max(b) / a.min(b).max(0.1) - 1.0 + if same_kind(brief, room, other) { 0.0 } else { OTHER_KIND }
            };
            let mut others = rest.clone();
            others.sort_by(|a, b| apart(*a).total_cmp(&apart(*b)));
            if !rng.chance(PAIRED_ALL_THE_SAME) {
                continue;
            }
            if let Some(other) = others.into_iter().find(|&other| self.pair(brief, room, other)) {
                rest.retain(|r| *r != other);
            }
        }
    }

    /// Makes twins of two rooms and of those that belong to them; returns false where they cannot be of one size.
    fn pair(&mut self, brief: &Brief, a: usize, b: usize) -> bool {
        let [own, theirs] = [a, b].map(|room| company(brief, room));
        if own.len() != theirs.len() {
            return false;
        }
        let evened = own.iter().zip(&theirs).map(|(a, b)| evened(&brief.rooms[*a], &brief.rooms[*b]));
        let Some(evened) = evened.collect::<Option<Vec<RoomSpec>>>() else { return false };
        let before: Vec<RoomSpec> = own.iter().map(|&room| self.even.rooms[room].clone()).collect();
        own.iter().zip(evened).for_each(|(&room, spec)| self.even.rooms[room] = spec);
        if !self.has_shape(&own) {
            own.into_iter().zip(before).for_each(|(room, spec)| self.even.rooms[room] = spec);
            return false;
        }
        own.into_iter().zip(theirs).for_each(|(a, b)| self.other[a] = Some(b));
        true
    }

    /// Returns true for a room that has all that belongs to it in a row of some depth, of the size that suits its twin too.
    fn has_shape(&self, company: &[usize]) -> bool {
        let [host, tied @ ..] = company else { return false };
        let mut cell = Cell::new(*host);
        tied.iter().take(MOST_NESTS).for_each(|&room| cell.left.push(room));
        cell.nest_depth = tied.first().map_or(0, |&room| nest_depth(&self.even, room));
        DEPTHS.step_by(DEPTH_STEP).any(|depth| {
            let mut misfit = 0.0;
            span(&self.even, &cell, depth, &mut misfit);
            misfit == 0.0
        })
    }
}

/// Returns true for rooms that may stand anywhere.
fn is_free(brief: &Brief, room: usize) -> bool {
    ![brief.spine, brief.ring].contains(&Some(room))
}

/// Returns the room that another is cut out of because one enters it from there, or is entered through it.
pub(crate) fn tie(brief: &Brief, room: usize) -> Option<usize> {
    is_nestable(brief, room).then(|| brief.rooms[room].host.or_else(|| guest_of(brief, room))).flatten()
}

/// Returns a room and those that are tied to it, by type.
fn company(brief: &Brief, room: usize) -> Vec<usize> {
    let mut tied: Vec<usize> = (0..brief.rooms.len()).filter(|&r| tie(brief, r) == Some(room)).collect();
    tied.sort_by_key(|&r| &brief.rooms[r].room_type);
    std::iter::once(room).chain(tied).collect()
}

/// Returns what holds for two rooms of one size; `None` where no size suits both.
fn evened(a: &RoomSpec, b: &RoomSpec) -> Option<RoomSpec> {
    let differ = a.on_spine != b.on_spine || a.gate != b.gate || a.zone != b.zone && a.gate.is_some();
    if differ || a.entrance || b.entrance || a.fixed || b.fixed || a.circulation || b.circulation {
        return None;
    }
    let (least, most) = (a.area_min.max(b.area_min), a.area_max.min(b.area_max));
    let min_dimension = a.min_dimension.max(b.min_dimension);
    if least.max(min_dimension * min_dimension) * (1.0 + LEAST_RANGE) > most {
        return None;
    }
    let lit = a.needs_outer_wall() || b.needs_outer_wall();
    Some(RoomSpec {
        area_min: least,
        area_target: ((a.area_target + b.area_target) / 2.0).clamp(least, most),
        area_max: most,
        min_dimension,
        door_width: a.door_width.max(b.door_width),
        daylight: if lit { Daylight::Required } else { a.daylight },
        ..a.clone()
    })
}
