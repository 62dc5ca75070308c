//! What makes a plan unbuildable, and what makes one better than another.
//!
//! Hard shortfalls are measured in meters or relative units, so that the search feels which way is out; a plan is
//! accepted only when they are zero. Soft terms are weighted sums, reported in the floorplan's `cost`.

use d3dgen_model::domain::{Daylight, Zone};
use d3dgen_model::measures::{JAMB_M, MOST_ELONGATED, MOST_OVERHANG};
use d3dgen_model::scene_graph::Connector;
use d3dgen_model::seed::Stream;

use super::core::{Below, in_core, overhang};
use super::hall;
use super::lattice::{CELL_M2, Cellbox, INNER_HALF_M, OUTER_HALF_M, meters, up};
use super::locked::{self, Cut};
use super::mirror;
use super::realize::{Layout, door_need};
use super::spec::{Brief, RoomSpec};
use crate::lattice::{between, distance};
use crate::measures::{GARDEN_DOOR_M, LEAST_WALL_M, MARGIN_M};

/// Cost of a room whose area is outside what is advised, beside that of how far.
const ILL_ADVISED: f64 = 0.8;
/// How much more both count for rooms to sleep in of other buildings than homes, up to so many rooms; in a long row of them
/// the corridor would pay for it.
const IN_WARDS: f64 = 2.5;
const FEW_ROOMS: usize = 14;
/// Cost of a room without the daylight that it is better with, beside those that take a facade and need none.
const DARK: f64 = 1.8;
/// Cost of a meter of outer wall that the room with the door to the garden lacks for that and a window.
const NO_GARDEN: f64 = 1.0;
/// Facade of a bedroom with windows in one wall, m: a bed with its head beside the window and the way past its foot, more where the
/// other walls are those of neighbors; and what a meter less costs.
const ACROSS_BED_M: f64 = 3.1;
const ACROSS_BED_IN_ROW_M: f64 = 3.4;
const ALONG_WINDOW: f64 = 4.0;
/// Share of the floor from which on a reviewer objects to circulation first, stairs with it; in a home it is less.
const MUCH_WAY: f64 = 0.20;
const MUCH_WAY_AT_HOME: f64 = 0.15;
/// What it costs that the stairs are right beside the door of a home, whose leaf sweeps before their first step.
const STAIRS_AT_DOOR: f64 = 6.0;
/// Share by which circulation beyond what is advised counts as larger.
const ILL_SHARED: f64 = 0.05;
/// Length from which on the hall of a home is a tunnel, m, what a meter more counts as share of circulation, and how many more
/// make it count double; the length from which on it is better lit by day, m, and what it counts that it is not.
const HALL_M: f64 = 9.0;
const TUNNEL: f64 = 0.02;
const LONG_TUNNEL_M: f64 = 10.0;
const DARK_HALL_M: f64 = 6.0;
const DARK_HALL: f64 = 0.03;
/// Share of the walls of a corridor behind which there is no room, beside its ends, from which on it serves one side only; and
/// what more of it counts as share of circulation.
const ONE_SIDED_FROM: f64 = 0.1;
const ONE_SIDED: f64 = 1.0;
/// What a meter of a corridor that is too long for its one way out counts as share of circulation.
const ONE_WAY: f64 = 0.1;
/// What a room that is wanted near the entrance loses by each side of the building that it is away from it.
const BY_ENTRANCE: f64 = 1.5;
/// The same for one that guests use, where there is no entrance hall to put it at.
const FOR_GUESTS: f64 = 1.8;
/// Way from a bedroom to the nearest station of a ward from which on it is far, m, and what a meter more of it counts.
const NEAR_STATION_M: f64 = 20.0;
const FAR_FROM_STATION: f64 = 0.15;
/// What a building that is to be compact pays for the share of the rectangle around it that it leaves open; the part of that which
/// one pays that stands between neighbors, and any other along one straight corridor.
const NOTCHED: f64 = 30.0;
const NOTCHED_IN_ROW: f64 = 1.0;
const NOTCHED_BAR: f64 = 0.4;
/// What each gate for vehicles costs that lies at another side of the building than most of its kind.
const GATES_APART: f64 = 8.0;
/// Number of soft terms.
const COUNT: usize = 12;
/// A weight for each soft term.
pub(crate) type Weights = [f64; COUNT];

/// Names of the soft terms, in the order of [`Score::soft`].
pub(crate) const TERMS: [&str; COUNT] = [
    "area_error",
    "proportion",
    "wished_adjacency",
    "daylight",
    "circulation_share",
    "wet_walls",
    "outline",
    "zoning",
    "narrow_parts",
    "latch_side",
    "wall_length",
    "robot_route",
];
/// Standard weights of the soft terms; each plan's search varies them by its taste.
pub(crate) const WEIGHTS: Weights = [1.0, 0.6, 1.2, 0.5, 10.0, 0.5, 0.8, 0.5, 0.4, 0.8, 0.1, 0.3];

/// Wall beside the latch of a door that people in wheelchairs pull open, beyond the least one, m (18 in together).
const LATCH_SIDE_M: f64 = 0.457 - JAMB_M;

/// Cost of a sleeping room larger than the room of the day that is to be the largest, beside that of how much.
const WRONG_SIZES: f64 = 1.5;
/// What it costs that two rooms which the domain advises against putting wall to wall share one.
const TOUCHING: f64 = 0.35;

/// What it costs that all wet rooms stand over rooms that people live, sleep or work in.
const OVER_QUIET: f64 = 9.0;

/// How much more a wet room counts that lies beside no other in a home, where there are few of them.
const PIPES_AT_HOME: f64 = 2.6;

/// Length over width from which on a room looks like a slot, and what that costs beside its proportion.
const SLOT_FROM: f64 = 1.9;
const SLOT: f64 = 1.5;
/// Share of a bedroom beside a small room that was cut out of it from which on that is a waste, and what more of it costs.
const LEG_SHARE: f64 = 0.22;
const WASTED_LEG: f64 = 4.0;
/// Width between wall center lines below which a leg as long holds nothing, m, and what that costs a home.
const NECK_M: f64 = 2.0;
const DEAD_NECK: f64 = 4.0;
/// What a leg costs of a room of another building that cannot spare a corner, unless what was cut out is the room's own.
const CUT_CELL: f64 = 2.5;

/// A step in the outline shorter than this has no reason, m, and what it costs.
const STEP_M: f64 = 0.9;
const STEP: f64 = 0.4;

/// Area over the usual one from which on a room is bloated, as a factor, sooner one that serves the others; and what more of
/// it costs.
const BLOATED_FROM: [f64; 2] = [1.6, 1.5];
const BLOATED: f64 = 6.0;

/// Weight of what hangs in the air, and what more counts beyond the share of a storey that may.
pub(crate) const OVERHANG: f64 = 45.0;
const OVERHANG_BEYOND: f64 = 60.0;

/// What it costs a storey to be smaller than the rooms that stand on it, for the share that it lacks.
const TOO_SMALL_TO_CARRY: f64 = 25.0;

/// Weight of a meter by which a wing pushes others away that stand on those below.
const PUSHED: f64 = 8.0;

/// What sums of costs may lack by rounding.
const ROUNDING: f64 = 1e-9;

/// Wall for a window beside the door to the garden, m.
const GARDEN_PANE_M: f64 = 1.8 + 2.0 * MARGIN_M;

/// Share by which the whole may miss the area asked for before it costs.
const AREA_TOLERANCE: f64 = 0.03;
/// Share from which on the building is plainly not as large as asked for, and the cost beyond.
const AREA_MISSES: f64 = 0.08;
const AREA_MISSED: f64 = 100.0;

/// Verdict on a layout.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Score {
    /// Shortfalls against hard rules; 0 for a sound plan.
    pub hard: f64,
    /// Unweighted soft terms, in the order of [`TERMS`].
    pub soft: [f64; COUNT],
    /// Share of the storey that hangs in the air beyond the one below.
    pub overhang: f64,
    /// How far a wing reaches where others are to stand, m.
    pub pushed: f64,
    /// Share of the rectangle around it that a building leaves open, as far as that counts.
    pub open: f64,
    /// What the plan costs under a wish for symmetry or against it, weighted.
    pub symmetry: f64,
}

impl Score {
    /// Returns true when no hard rule is broken.
    pub(crate) fn is_sound(&self) -> bool {
        self.hard < 1e-9
    }

    /// Returns the figure the search minimizes, under the taste of one plan.
    pub(crate) fn total(&self, weights: &Weights) -> f64 {
        self.hard * 30.0
            + OVERHANG * self.overhang
            + OVERHANG_BEYOND * (self.overhang - MOST_OVERHANG).max(0.0)
            + PUSHED * self.pushed
            + NOTCHED * self.open
            + self.symmetry
            + self.soft.iter().zip(weights).map(|(s, w)| s * w).sum::<f64>()
    }

    /// Returns the soft terms under the standard weights, so that plans can be compared.
    pub(crate) fn weighted(&self) -> Weights {
        std::array::from_fn(|i| self.soft[i] * WEIGHTS[i])
    }
}

/// Returns the weights one plan is searched with: another architect for every seed. None has little regard for how large
/// the rooms of a home are.
pub(crate) fn taste(brief: &Brief, rng: &mut Stream) -> Weights {
    let mut weights = WEIGHTS.map(|w| w * (0.5 + rng.unit()));
    let largest = |zone: Zone| brief.rooms.iter().filter(|r| r.zone == zone).map(|r| r.area_target).fold(0.0, f64::max);
    if largest(Zone::Night) > 0.0 && largest(Zone::Day) > largest(Zone::Night) {
        weights[0] = weights[0].max(WEIGHTS[0]);
    }
    weights
}

/// Measures layouts of one brief and judges them, in memory of its own that every layout uses again.
pub(crate) struct Judge<'b> {
    pub(crate) brief: &'b Brief,
    /// The spine, or a number that no room has.
    pub(crate) spine: usize,
    /// By room: wall that its door to the spine needs, 0 for none, lattice units.
    spine_need: Vec<i32>,
    /// By room times number of rooms plus room: which pair of interest they are, counted from 1; 0 for none.
    pair_of: Vec<u16>,
    /// By link: its pair and the wall it needs, lattice units.
    link_needs: Vec<(usize, i32)>,
    apart_pairs: Vec<usize>,
    aloof_pairs: Vec<usize>,
    /// What the doors to outdoors need, lattice units.
    pub(crate) entrance_need: i32,
    garden_need: i32,
    /// True where rooms are behind a lock.
    locks: bool,
    wet_rooms: usize,
    /// Rooms along corridors that people sleep in, and stations with an open front for those who see to them.
    pub(crate) beds: Vec<usize>,
    pub(crate) stations: Vec<usize>,
    home: bool,
    /// Rooms of one type with gates for vehicles, where there are several.
    docks: Vec<Vec<usize>>,
    /// By room: whether another one belongs to it.
    hosts: Vec<bool>,
    pub(crate) survey: Survey,
    /// The storey below, for one that stands on another.
    pub(crate) below: Option<&'b Below>,
}

/// Lengths of walls per room and pair of one layout.
#[derive(Default)]
pub(crate) struct Survey {
    /// Boxes from west to east: west edge and index.
    by_west: Vec<(i32, usize)>,
    /// Per box and side: wall shared with any box, and with boxes of the same room.
    pub(crate) side: Vec<[[i32; 2]; 4]>,
    /// Boxes of one room that touch: their indices, and where, as [`Cellbox::contact`] has it.
    joined: Vec<(usize, usize, (usize, i32, i32))>,
    /// Steps in the outline without a reason.
    steps: usize,
    /// By pair of interest: the longest shared wall, lattice units.
    pair: Vec<i32>,
    pub(crate) rooms: Vec<Measured>,
}

/// One room of a layout.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Measured {
    /// Longest wall shared with the spine, lattice units.
    spine: i32,
    /// Outer wall: the longest straight piece that a window can be in, and the sum.
    outer: (i32, i32),
    /// The longest straight piece that a door to outdoors can be in.
    way_in: i32,
    /// Outer wall on each side, the longest straight piece of it.
    facades: [i32; 4],
    gross_m2: f64,
    pub(crate) net_m2: f64,
    /// Largest box.
    pub(crate) main: Option<Cellbox>,
    /// Clear width and height of that box, m.
    clear: (f64, f64),
    /// The same of the largest rectangle, which may go through several boxes.
    largest: (f64, f64),
    /// True for a wet room beside another.
    wet_beside: bool,
}

impl<'b> Judge<'b> {
    pub(crate) fn new(brief: &'b Brief) -> Self {
        let n = brief.rooms.len();
        let mut out = Self {
            brief,
            spine: brief.spine.unwrap_or(usize::MAX),
            spine_need: brief.rooms.iter().map(|r| if r.on_spine { door_need(r.door_width) } else { 0 }).collect(),
            pair_of: vec![0; n * n],
            link_needs: Vec::new(),
            apart_pairs: Vec::new(),
            aloof_pairs: Vec::new(),
            entrance_need: door_need(brief.entrance_width),
            garden_need: door_need(GARDEN_DOOR_M) + up(GARDEN_PANE_M),
            locks: brief.rooms.iter().any(|r| r.locked),
            wet_rooms: brief.rooms.iter().filter(|r| r.wet).count(),
            beds: (0..n).filter(|&r| brief.rooms[r].zone == Zone::Night && brief.rooms[r].on_spine).collect(),
            stations: (0..n).filter(|&r| brief.rooms[r].zone == Zone::Staff && brief.rooms[r].open_front).collect(),
            home: brief.is_home(),
            docks: brief.docks(),
            hosts: (0..n).map(|i| brief.rooms.iter().any(|r| r.host == Some(i))).collect(),
            survey: Survey { rooms: vec![Measured::default(); n], ..Survey::default() },
            below: brief.core.as_ref().and_then(|c| c.below.as_ref()),
        };
        for link in &brief.links {
            let need = match link.connector {
                Connector::Door | Connector::Open => door_need(brief.door_width(link.a, link.b)),
                Connector::Wall | Connector::Near => up(0.6),
            };
            let pair = out.pair(link.a, link.b);
            out.link_needs.push((pair, need));
        }
        for [a, b] in &brief.apart {
            let pair = out.pair(*a, *b);
            out.apart_pairs.push(pair);
        }
        for [a, b] in &brief.aloof {
            let pair = out.pair(*a, *b);
            out.aloof_pairs.push(pair);
        }
        out
    }

    /// Returns the number of a pair of interest.
    fn pair(&mut self, a: usize, b: usize) -> usize {
        let n = self.brief.rooms.len();
        if self.pair_of[a * n + b] == 0 {
            self.survey.pair.push(0);
            let number = self.survey.pair.len() as u16;
            (self.pair_of[a * n + b], self.pair_of[b * n + a]) = (number, number);
        }
        usize::from(self.pair_of[a * n + b]) - 1
    }

    /// Judges a layout.
    pub(crate) fn score(&mut self, layout: &Layout) -> Score {
        let mut score = Score { hard: layout.misfit, ..Score::default() };
        self.judge(layout, &mut score, |_| true);
        score
    }

    /// Returns what a layout costs under the weights. Of one that costs more than `most` some costs are left out, so that
    /// what is returned is too little, yet more than `most`: nothing has a negative cost.
    pub(crate) fn cost_up_to(&mut self, layout: &Layout, weights: &Weights, most: f64) -> f64 {
        let mut score = Score { hard: layout.misfit, ..Score::default() };
        self.judge(layout, &mut score, |so_far| so_far.total(weights) <= most + ROUNDING);
        score.total(weights)
    }

    /// Adds up what a layout costs while `go_on`, what is cheap to know first.
    fn judge(&mut self, layout: &Layout, score: &mut Score, go_on: impl Fn(&Score) -> bool) {
        if !go_on(score) {
            return;
        }
        self.measure(&layout.boxes);
        self.rooms(score);
        if !go_on(score) {
            return;
        }
        self.links(score);
        score.hard += self.cut(&layout.boxes).0;
        if !go_on(score) {
            return;
        }
        self.whole(layout, score);
        if let Some(below) = &self.below {
            let total: f64 = self.survey.rooms.iter().map(|r| r.gross_m2).sum();
            // what of some boxes has nothing of others below it, m^2
            let free = |boxes: &[(usize, Cellbox)], outline: &[Cellbox]| {
                let units = match layout.core.filter(|_| below.by_core) {
                    Some(core) if core.u == (1, 0) => overhang(boxes, outline, core.origin),
                    Some(core) => overhang(&in_core(boxes, &core), outline, (0, 0)),
                    None => overhang(boxes, outline, (0, 0)),
                };
                units as f64 * CELL_M2
            };
            score.overhang = free(&layout.boxes, &below.outline) / total.max(1.0);
            if !below.quiet.is_empty() {
                let wet = layout.boxes.iter().filter(|(room, _)| self.brief.rooms[*room].wet).copied();
                let wet: Vec<(usize, Cellbox)> = wet.collect();
                let all: f64 = wet.iter().map(|(_, b)| b.area_m2()).sum();
                score.soft[5] += OVER_QUIET * (all - free(&wet, &below.quiet)).max(0.0) / all.max(1.0);
            }
            if let Some((south, north)) = below.between {
                let low = layout.boxes.iter().map(|(_, b)| b.y0).min().unwrap_or(south);
                let high = layout.boxes.iter().map(|(_, b)| b.y1).max().unwrap_or(north);
                score.pushed = meters((south - low).max(0)) + meters((high - north).max(0));
            }
        }
    }

    fn measure(&mut self, boxes: &[(usize, Cellbox)]) {
        let n = self.brief.rooms.len();
        let survey = &mut self.survey;
        survey.pair.fill(0);
        survey.rooms.fill(Measured::default());
        survey.side.clear();
        survey.side.resize(boxes.len(), [[0; 2]; 4]);
        // A sweep from west to east: only boxes that begin before this one ends can touch it.
        survey.joined.clear();
        survey.steps = 0;
        survey.by_west.clear();
        survey.by_west.extend(boxes.iter().enumerate().map(|(i, (_, b))| (b.x0, i)));
        survey.by_west.sort_unstable();
        for (k, &(_, i)) in survey.by_west.iter().enumerate() {
            let (a, first) = boxes[i];
            for &(x0, j) in &survey.by_west[k + 1..] {
                if x0 > first.x1 {
                    break;
                }
                let (b, second) = boxes[j];
                let Some((s, from, to)) = first.contact_eastward(&second) else { continue };
                let len = to - from;
                survey.side[i][s][0] += len;
                survey.side[j][s ^ 1][0] += len;
                if a == b {
                    survey.side[i][s][1] += len;
                    survey.side[j][s ^ 1][1] += len;
                    survey.joined.push((i, j, (s, from, to)));
                    continue;
                }
                if a == self.spine || b == self.spine {
                    let room = &mut survey.rooms[if a == self.spine { b } else { a }];
                    room.spine = room.spine.max(len);
                }
                let pair = usize::from(self.pair_of[a * n + b]);
                if pair > 0 {
                    survey.pair[pair - 1] = survey.pair[pair - 1].max(len);
                }
                if self.brief.rooms[a].wet && self.brief.rooms[b].wet {
                    (survey.rooms[a].wet_beside, survey.rooms[b].wet_beside) = (true, true);
                }
            }
        }
        let party = self.brief.party;
        for ((room, shape), side) in boxes.iter().zip(&survey.side) {
            let room = &mut survey.rooms[*room];
            let area = shape.area_m2();
            room.gross_m2 += area;
            let mut net = area;
            let mut walls = [0.0; 2];
            // mean of the walls on both sides together, east and west, north and south: what they share at the corners
            let mut taken = [0.0; 2];
            for (axis, sides) in [[side[0], side[1]], [side[2], side[3]]].into_iter().enumerate() {
                let len = if axis == 0 { shape.height() } else { shape.width() };
                let (mut outer, mut inner) = (0, 0);
                for (end, [shared, own]) in sides.into_iter().enumerate() {
                    let free = len - shared;
                    let facade = &mut room.facades[2 * axis + end];
                    *facade = free.max(*facade);
                    survey.steps += usize::from(shared > 0 && (1..up(STEP_M)).contains(&free));
                    room.outer.1 += free;
                    // a wall of neighbors has no window; the way in may be there
                    let shut = party.filter(|p| p.vertical == (axis == 0));
                    if shut.is_none() {
                        room.outer.0 = room.outer.0.max(free);
                    }
                    if shut.is_none_or(|p| p.entered) {
                        room.way_in = room.way_in.max(free);
                    }
                    (outer, inner) = (outer + free, inner + shared - own);
                    // the clear extent ends at the thickest wall of a side
                    let half = if free > 0 { OUTER_HALF_M } else { INNER_HALF_M };
                    walls[axis] += if own == len { 0.0 } else { half };
                }
                let lost = meters(outer) * OUTER_HALF_M + meters(inner) * INNER_HALF_M;
                net -= lost;
                taken[axis] = lost / meters(len);
            }
            room.net_m2 += net + taken[0] * taken[1];
            if room.main.is_none_or(|m| m.area_m2() < area) {
                room.main = Some(*shape);
                room.clear = (meters(shape.width()) - walls[0], meters(shape.height()) - walls[1]);
                room.largest = room.clear;
            }
        }
        self.measure_joined(boxes);
    }

    /// Looks for the largest rectangle of each room among those that go through two of its boxes.
    fn measure_joined(&mut self, boxes: &[(usize, Cellbox)]) {
        let survey = &mut self.survey;
        for &(i, j, (s, from, to)) in &survey.joined {
            let ((room, first), (_, second)) = (boxes[i], boxes[j]);
            let half = |k: usize, s: usize| {
                let len = if s < 2 { boxes[k].1.height() } else { boxes[k].1.width() };
                if len > survey.side[k][s][0] { OUTER_HALF_M } else { INNER_HALF_M }
            };
            // the first box lies west or south of the other where it touches it with its east or north side
            let (low, high) = if s % 2 == 1 { (i, j) } else { (j, i) };
            let (axis, other) = (s / 2 * 2, 2 - s / 2 * 2);
            let ends = half(low, axis) + half(high, axis + 1);
            let sides = half(i, other).max(half(j, other)) + half(i, other + 1).max(half(j, other + 1));
            let length = if axis == 0 { first.width() + second.width() } else { first.height() + second.height() };
            let (length, width) = (meters(length) - ends, meters(to - from) - sides);
            let measured = &mut survey.rooms[room];
            if length * width > measured.largest.0 * measured.largest.1 {
                measured.largest = (length, width);
            }
        }
    }

    fn rooms(&self, score: &mut Score) {
        let small = !self.brief.is_home() && self.brief.rooms.len() <= FEW_ROOMS;
        for (i, (spec, room)) in self.brief.rooms.iter().zip(&self.survey.rooms).enumerate() {
            if room.main.is_none() {
                score.hard += 5.0;
                continue;
            }
            let corridor = i == self.spine && !self.brief.hub || Some(i) == self.brief.ring;
            let net = room.net_m2;
            score.hard += ((spec.area_min - net) / spec.area_min).max(0.0) * 4.0;
            if !corridor {
                score.hard += ((net - spec.area_max) / spec.area_max).max(0.0) * 4.0;
                // Readers who measure on center lines should find the area in range too.
                let over = ((room.gross_m2 - spec.area_max) / spec.area_max).max(0.0);
                // half the area is as wrong as double the area
                let off = (net - spec.area_target) / net.min(spec.area_target).max(0.1);
                let [least, most] = spec.limits.area_advised.unwrap_or([0.0, f64::MAX]);
                let ill_advised = ((least - net).max(net - most) / spec.area_target).max(0.0);
                // patients' rooms take nothing of what a small plan has left over
                let wards = if spec.zone == Zone::Night && small { IN_WARDS } else { 1.0 };
                let serving = matches!(spec.zone, Zone::Service | Zone::Staff);
                let bloated = (net / spec.area_target - BLOATED_FROM[usize::from(serving)]).max(0.0);
                score.soft[0] += BLOATED * bloated
                    + off.powi(2)
                    + 3.0 * over
                    + wards * (5.0 * ill_advised + if ill_advised > 0.0 { ILL_ADVISED } else { 0.0 });
                let (w, h) = room.clear;
                score.hard += (spec.min_dimension - w.min(h)).max(0.0);
                let (w, h) = room.largest;
                let proportion = w.max(h) / w.min(h).max(0.1);
                // the flights of a high storey are as long as they are
                if !spec.fixed {
                    score.hard += (proportion - MOST_ELONGATED).max(0.0);
                }
                score.soft[1] += (proportion - 1.5).max(0.0).powi(2) + SLOT * (proportion - SLOT_FROM).max(0.0);
            }
            if i != self.spine {
                score.hard += meters((self.spine_need[i] - room.spine).max(0));
                if self.spine_need[i] > 0 && !spec.open_front {
                    score.soft[9] += meters((self.spine_need[i] + up(LATCH_SIDE_M) - room.spine).max(0));
                }
            }
            let (longest, total) = room.outer;
            match spec.daylight {
                _ if spec.needs_outer_wall() => {
                    score.hard += meters((up(spec.least_outer_wall()) - longest).max(0));
                }
                Daylight::Preferred if longest < up(LEAST_WALL_M) && !corridor => score.soft[3] += DARK,
                Daylight::None | Daylight::Optional if !spec.circulation => {
                    score.soft[3] += 0.03 * meters(total).min(6.0)
                }
                _ => {}
            }
            // with windows in one wall only the bed stands along it
            let lit_once = longest == total || self.brief.party.is_some();
            if self.home && lit_once && spec.zone == Zone::Night && spec.on_spine {
                let across = if self.brief.party.is_some() { ACROSS_BED_IN_ROW_M } else { ACROSS_BED_M };
                score.soft[1] += ALONG_WINDOW * meters((up(across) - longest).max(0));
            }
            if spec.entrance {
                score.hard += meters((self.entrance_need - room.way_in).max(0));
            }
            if self.brief.garden.first() == Some(&i) {
                score.soft[3] += NO_GARDEN * meters((self.garden_need - total).max(0));
            }
        }
    }

    fn links(&self, score: &mut Score) {
        for (link, &(pair, need)) in self.brief.links.iter().zip(&self.link_needs) {
            let short = meters((need - self.survey.pair[pair]).max(0));
            if link.required && link.connector != Connector::Near {
                score.hard += short;
            } else if short > 0.0 {
                let far = match (self.survey.rooms[link.a].main, self.survey.rooms[link.b].main) {
                    (Some(a), Some(b)) => distance(a, b),
                    _ => 10.0,
                };
                score.soft[2] += 0.3 + 0.04 * far;
            }
        }
        for &pair in &self.apart_pairs {
            score.hard += meters(self.survey.pair[pair]) * 0.5;
        }
        let touching = self.aloof_pairs.iter().filter(|&&pair| self.survey.pair[pair] > 0).count();
        score.soft[2] += TOUCHING * touching as f64;
        if self.wet_rooms > 1 {
            let paired = self.survey.rooms.iter().filter(|r| r.wet_beside).count();
            let alone = (self.wet_rooms - paired) as f64;
            score.soft[5] += if self.home { PIPES_AT_HOME * alone } else { alone };
        }
    }

    fn whole(&self, layout: &Layout, score: &mut Score) {
        let (brief, rooms) = (self.brief, &self.survey.rooms);
        let total: f64 = rooms.iter().map(|r| r.gross_m2).sum();
        let home = self.home;
        if let Some(spine) = brief.spine
            && !brief.hub
        {
            // stairs are of the way too, wherever they stand
            let stairs = (0..rooms.len()).filter(|&i| home && brief.in_core(i)).map(|i| rooms[i].gross_m2).sum::<f64>();
            let way = |area: fn(&Measured) -> f64| area(&rooms[spine]) + brief.ring.map_or(0.0, |r| area(&rooms[r]));
            let share = (way(|r| r.gross_m2) + stairs) / total;
            let much = if home { MUCH_WAY_AT_HOME } else { MUCH_WAY };
            score.soft[4] += (share - 0.10).max(0.0) + 5.0 * (share - much).max(0.0);
            score.soft[4] += ONE_WAY * layout.one_way;
            score.soft[7] += if layout.stairs_at_door { STAIRS_AT_DOOR } else { 0.0 };
            if home {
                let longest = layout.boxes.iter().filter(|(r, _)| *r == spine);
                let longest = longest.map(|(_, b)| meters(b.width().max(b.height()))).fold(0.0, f64::max);
                let over = (longest - HALL_M).max(0.0);
                score.soft[4] += TUNNEL * over * (1.0 + over / LONG_TUNNEL_M);
                let dark = longest > DARK_HALL_M && rooms[spine].outer.0 < up(LEAST_WALL_M);
                score.soft[4] += if dark { DARK_HALL } else { 0.0 };
            } else {
                score.soft[4] += ONE_SIDED * (self.one_sided(layout) - ONE_SIDED_FROM).max(0.0);
            }
            if let Some(most) = brief.share_advised {
                let share = way(|r| r.net_m2) / rooms.iter().map(|r| r.net_m2).sum::<f64>();
                score.soft[4] += if share > most { ILL_SHARED + 4.0 * (share - most) } else { 0.0 };
            }
        }
        if let Some(area) = brief.area {
            let net: f64 = rooms.iter().map(|r| r.net_m2).sum();
            let miss = (net - area).abs() / area;
            score.soft[0] += 20.0 * (miss - AREA_TOLERANCE).max(0.0) + AREA_MISSED * (miss - AREA_MISSES).max(0.0);
        }
        if brief.carries > 0.0 {
            let own = brief.rooms.iter().zip(rooms).filter(|(spec, _)| !spec.circulation).map(|(_, r)| r.net_m2);
            score.soft[0] += TOO_SMALL_TO_CARRY * (1.0 - own.sum::<f64>() / brief.carries).max(0.0);
        }
        score.soft[0] += self.wrong_sizes();
        let perimeter: f64 = rooms.iter().map(|r| meters(r.outer.1)).sum();
        score.soft[6] += perimeter / (4.0 * total.sqrt()) - 1.0 + 0.02 * layout.notch;
        score.soft[6] += STEP * self.survey.steps as f64;
        // where robots come from
        let base = brief.rooms.iter().position(|r| r.docks).and_then(|i| rooms[i].main);
        // one comes up the stairs
        let stairs = brief.core.as_ref().map(|c| c.host);
        let entrance = brief.rooms.iter().position(|r| r.entrance).or(stairs).and_then(|i| rooms[i].main);
        if let Some((wish, door)) = brief.symmetry.zip(entrance) {
            let boxes: Vec<_> = rooms.iter().filter_map(|r| Some((r.main?, r.gross_m2))).collect();
            score.symmetry = mirror::cost(wish, &boxes, door);
        }
        score.open = self.rectangular(layout) * open_share(&layout.boxes);
        // one station stands where it sees most doors; several share the beds out
        if self.stations.len() > 1 {
            let far = self.ways_to_stations(layout).map(|way| (way - NEAR_STATION_M).max(0.0));
            score.soft[7] += FAR_FROM_STATION * far.sum::<f64>();
        }
        score.soft[7] += GATES_APART * self.gates_apart() as f64;
        let size = total.sqrt().max(1.0);
        // from a hall guests go to the room where they sit: at which end of it one comes in is not known yet
        let in_hall = brief.rooms.iter().position(|r| r.entrance) == brief.spine;
        let seated = if in_hall { hall::room_of_guests(brief).and_then(|i| rooms[i].main) } else { None };
        let (mut round, mut visited) = (0.0, 0);
        for (spec, room) in brief.rooms.iter().zip(rooms) {
            let (Some(main), Some(door)) = (room.main, entrance) else { continue };
            let from = seated.filter(|_| spec.for_guests).unwrap_or(door);
            score.soft[7] += ill_placed(spec, distance(main, from) / size);
            if spec.on_spine {
                round += distance(main, base.unwrap_or(door)) / size;
                visited += 1;
            }
        }
        score.soft[11] += round / f64::from(visited.max(1));
        // walls: outer ones once, inner ones by half for each of the two rooms, against a square cut into squares
        let walls: f64 = self.survey.side.iter().zip(&layout.boxes).map(|(side, (_, b))| wall_length(side, b)).sum();
        score.soft[10] += walls / (2.0 * size * ((rooms.len() as f64).sqrt() + 1.0)) - 0.5;
        for (room, shape) in &layout.boxes {
            if Some(*room) != brief.spine && rooms[*room].main != Some(*shape) {
                // A leg beside a small room: fine as a lobby, a waste as a corridor.
                let (w, h) = (meters(shape.width()), meters(shape.height()));
                score.soft[8] += (w.max(h) / w.min(h).max(0.1) - 1.6).max(0.0) + 0.15;
                if !home && !self.hosts[*room] && !brief.rooms[*room].spares_a_corner() {
                    score.soft[8] += CUT_CELL;
                }
                let lived_in = matches!(brief.rooms[*room].zone, Zone::Night | Zone::Day);
                score.soft[8] +=
                    if home && lived_in && w.min(h) < NECK_M && w.max(h) > NECK_M { DEAD_NECK } else { 0.0 };
                if home && brief.rooms[*room].zone == Zone::Night {
                    let share = shape.area_m2() / rooms[*room].gross_m2.max(1.0);
                    score.soft[8] += WASTED_LEG * (share - LEG_SHARE).max(0.0);
                }
            }
        }
    }

    /// Returns what rooms before and behind a lock miss of lying at two ends of the corridor, m, and where the wall between is best.
    pub(crate) fn cut(&self, boxes: &[(usize, Cellbox)]) -> (f64, Option<Cut>) {
        if self.locks { locked::cut(self.brief, boxes, &self.spine_need) } else { (0.0, None) }
    }

    /// Returns how far it is from each bedroom to the nearest station, m; nothing where there is no station.
    pub(crate) fn ways_to_stations<'a>(&'a self, layout: &'a Layout) -> impl Iterator<Item = f64> + 'a {
        let place = |room: &usize| Some(self.survey.rooms[*room].main?.center2());
        let round = layout.round.as_ref().filter(|_| self.stations.len() > 1);
        let beds = self.beds.iter().filter_map(place);
        beds.filter_map(move |bed| {
            let stations = self.stations.iter().filter_map(place);
            stations.map(|station| walk(round, bed, station)).reduce(f64::min)
        })
    }

    /// Returns how much it counts that a layout leaves open a part of the rectangle around it, 0 to 1.
    fn rectangular(&self, layout: &Layout) -> f64 {
        match (self.brief.form, self.brief.compact, self.brief.party) {
            (Some(_), ..) => 0.0,
            (_, true, _) => 1.0,
            (.., Some(_)) => NOTCHED_IN_ROW,
            _ if layout.bar => NOTCHED_BAR,
            _ => 0.0,
        }
    }

    /// Returns how many gates for vehicles are not at the side of the building that most of their kind are at: lorries have one yard.
    fn gates_apart(&self) -> usize {
        let holds = |room: usize, side: usize| {
            self.survey.rooms[room].facades[side] >= up(self.brief.rooms[room].least_outer_wall())
        };
        let most = |rooms: &Vec<usize>| {
            let at = |side| rooms.iter().filter(|room| holds(**room, side)).count();
            rooms.len() - (0..4).map(at).max().unwrap_or(0)
        };
        self.docks.iter().map(most).sum()
    }

    /// Returns the share of the long walls of the corridor that are outer walls.
    fn one_sided(&self, layout: &Layout) -> f64 {
        let (mut idle, mut all) = (0, 0);
        for ((_, b), sides) in layout.boxes.iter().zip(&self.survey.side).filter(|((room, _), _)| *room == self.spine) {
            let (len, long) = if b.width() >= b.height() { (b.width(), [2, 3]) } else { (b.height(), [0, 1]) };
            idle += long.iter().map(|&s| len - sides[s][0]).sum::<i32>();
            all += 2 * len - long.iter().map(|&s| sides[s][1]).sum::<i32>();
        }
        f64::from(idle) / f64::from(all.max(1))
    }

    /// Returns what it costs that a sleeping room or the hall has become larger than the room of the day that was to be
    /// the largest.
    fn wrong_sizes(&self) -> f64 {
        let of = |zone: Zone| self.brief.rooms.iter().zip(&self.survey.rooms).filter(move |(s, _)| s.zone == zone);
        let Some((day, living)) = of(Zone::Day).max_by(|a, b| a.0.area_target.total_cmp(&b.0.area_target)) else {
            return 0.0;
        };
        let Some((night, bedroom)) = of(Zone::Night).max_by(|a, b| a.1.net_m2.total_cmp(&b.1.net_m2)) else {
            return 0.0;
        };
        if night.area_target >= day.area_target {
            return 0.0;
        }
        let hall = self.survey.rooms.get(self.spine).filter(|_| !self.brief.hub);
        let larger = [Some(bedroom), hall].into_iter().flatten().filter(|room| room.net_m2 > living.net_m2);
        larger.map(|room| WRONG_SIZES + 2.0 * (room.net_m2 / living.net_m2.max(1.0) - 1.0)).sum()
    }
}

/// Returns the share of the rectangle around some boxes that they leave open.
pub(crate) fn open_share(boxes: &[(usize, Cellbox)]) -> f64 {
    let around = boxes.iter().map(|b| b.1).reduce(Cellbox::around).map_or(1.0, |all| all.area_m2());
    1.0 - boxes.iter().map(|b| b.1.area_m2()).sum::<f64>() / around
}

/// Returns the wall of a box that counts as its own, m.
fn wall_length(side: &[[i32; 2]; 4], shape: &Cellbox) -> f64 {
    let of = |(s, [shared, own]): (usize, &[i32; 2])| {
        let len = if s < 2 { shape.height() } else { shape.width() };
        meters(len - shared) + 0.5 * meters(shared - own)
    };
    side.iter().enumerate().map(of).sum()
}

/// Returns what a room loses by its distance from the entrance, in sides of the building.
pub(crate) fn ill_placed(spec: &RoomSpec, far: f64) -> f64 {
    if spec.by_entrance {
        return BY_ENTRANCE * far;
    }
    if spec.for_guests {
        return FOR_GUESTS * far;
    }
    match spec.zone {
        Zone::Public | Zone::Day => 0.25 * far,
        Zone::Night => 0.4 * (1.2 - far).max(0.0),
        Zone::Staff | Zone::Service | Zone::Circulation | Zone::Outdoor => 0.0,
    }
}

/// Returns how far it is on foot between two places given by twice their coordinates, m: along a ring of corridors where there
/// is one, for nobody walks through what it goes around.
fn walk(round: Option<&Cellbox>, a: (i32, i32), b: (i32, i32)) -> f64 {
    let Some(round) = round else { return between(a, b) };
    let (width, height) = (2 * round.width(), 2 * round.height());
    // where along the ring a place is, from its south-west corner on
    let along = |(x, y): (i32, i32)| {
        let (x, y) = ((x - 2 * round.x0).clamp(0, width), (y - 2 * round.y0).clamp(0, height));
        let sides =
            [(y, x), (width - x, width + y), (height - y, 2 * width + height - x), (x, 2 * (width + height) - y)];
        sides.into_iter().min().map_or(0, |(_, at)| at)
    };
    let way = (along(a) - along(b)).abs();
    f64::from(way.min(2 * (width + height) - way)) * 0.025
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_walks_around_what_a_ring_of_corridors_goes_around() {
        let ring = Cellbox::new(0, 0, 800, 200);
        let way = |a, b| walk(Some(&ring), a, b);
        // 10 m along one side; from one long side to the other around the nearer end
        assert_eq!(way((400, -50), (800, -50)), 10.0);
        assert_eq!(way((400, -50), (400, 450)), 10.0 + 10.0 + 10.0);
        assert_eq!(way((1500, -50), (1500, 450)), 2.5 + 10.0 + 2.5);
        assert_eq!(walk(None, (400, -50), (400, 450)), 12.5);
    }
}
