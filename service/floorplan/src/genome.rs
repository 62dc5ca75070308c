//! The discrete description of a plan that the search changes: which scheme, which rooms in which band and order, which
//! small rooms nest beside whom, how deep the bands are.

use std::ops::RangeInclusive;

use d3dgen_model::domain::{Daylight, Scheme, Zone};
use d3dgen_model::seed::Stream;

use super::lattice::{INNER_HALF_M, up};
use super::spec::Brief;

/// Share of homes that begin with a bedroom, and not the largest room, at the end of the hall.
const AT_THE_END: f64 = 0.8;
/// Share of the starts of a storey whose rooms across from the core are as deep as those below.
const LIKE_BELOW: f64 = 0.6;
/// Least and greatest depth of a court to begin with, m.
const COURT_M: (f64, f64) = (6.0, 10.0);
/// Share of small rooms that look first for a room large enough to spare a corner.
const AT_LARGE: f64 = 0.8;
/// Small rooms at one end of a cell at most.
pub(crate) const MOST_NESTS: usize = 7;

/// Small rooms in a row; a list of its own size, for genomes are copied millions of times.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Nests {
    rooms: [u16; MOST_NESTS],
    len: u8,
}

impl Nests {
    pub(crate) fn len(&self) -> usize {
        usize::from(self.len)
    }

    pub(crate) fn is_full(&self) -> bool {
        self.len() == MOST_NESTS
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = usize> + '_ {
        self.rooms[..self.len()].iter().map(|&r| usize::from(r))
    }

    /// Adds a room at the end; the list must not be full.
    pub(crate) fn push(&mut self, room: usize) {
        self.rooms[self.len()] = room as u16;
        self.len += 1;
    }

    /// Adds a room at the start; the list must not be full.
    pub(crate) fn push_front(&mut self, room: usize) {
        self.push(room);
        self.rooms[..usize::from(self.len)].rotate_right(1);
    }

    pub(crate) fn pop(&mut self) -> Option<usize> {
        self.len = self.len.checked_sub(1)?;
        Some(usize::from(self.rooms[self.len()]))
    }
}

/// A stretch of a band: a room over the full depth, with small rooms cut out of its corridor side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cell {
    pub host: usize,
    /// Small rooms from the start of the cell, along the corridor.
    pub left: Nests,
    /// Small rooms up to the end of the cell.
    pub right: Nests,
    /// Depth of the small rooms, lattice units.
    pub nest_depth: i32,
}

impl Cell {
    pub(crate) fn new(host: usize) -> Self {
        Self { host, left: Nests::default(), right: Nests::default(), nest_depth: 0 }
    }

    pub(crate) fn nests(&self) -> impl Iterator<Item = usize> + '_ {
        self.left.iter().chain(self.right.iter())
    }

    pub(crate) fn has_nests(&self) -> bool {
        self.left.len() + self.right.len() > 0
    }
}

/// Band in which the stairs of a building with several storeys stand: all have it on the same side.
pub(crate) const CORE_BAND: usize = 0;

/// Rooms that begin on both sides of the corridors around a court: one row of so many would make it a field. More do in some of
/// the starts, as not all of them come to a plan.
const BOTH_SIDES: RangeInclusive<usize> = 20..=32;
/// Bands along the short sides of a court.
pub(crate) const WEST_BAND: usize = 4;
pub(crate) const EAST_BAND: usize = 5;

/// Band whose last cell lies in the inner corner of an angle.
const BEND_BAND: usize = 0;

/// A row of cells along one side of a corridor.
#[derive(Debug, PartialEq)]
pub(crate) struct Band {
    pub depth: i32,
    pub cells: Vec<Cell>,
}

impl Clone for Band {
    fn clone(&self) -> Self {
        Self { depth: self.depth, cells: self.cells.clone() }
    }

    fn clone_from(&mut self, source: &Self) {
        self.depth = source.depth;
        self.cells.clone_from(&source.cells);
    }
}

/// Which bands a room at the end of the corridor covers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Cover {
    Both,
    Top,
    Bottom,
}

/// A large room that closes one end of the corridor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Cap {
    pub room: usize,
    pub cover: Cover,
    /// True when the uncovered band goes on beside the cap; false leaves a notch in the outline.
    pub under: bool,
}

/// A plan as the search sees it.
#[derive(Debug, PartialEq)]
pub(crate) struct Genome {
    pub scheme: Scheme,
    pub bands: Vec<Band>,
    /// Rooms that close the start and the end of the corridor (straight schemes only).
    pub caps: [Option<Cap>; 2],
    /// Angle: true when the outer band fills the corner; racetrack: when the core began as one row of rooms; courtyard: when
    /// it began with rooms on both sides of its corridors, however many.
    pub corner: bool,
    /// Courtyard: depth of the court between the rooms on it, lattice units.
    pub court: i32,
}

impl Clone for Genome {
    fn clone(&self) -> Self {
        Self { bands: self.bands.clone(), ..*self }
    }

    /// Takes over `source` in the memory of `self`.
    fn clone_from(&mut self, source: &Self) {
        (self.scheme, self.caps) = (source.scheme, source.caps);
        (self.corner, self.court) = (source.corner, source.court);
        self.bands.clone_from(&source.bands);
    }
}

/// Returns the number of bands of a scheme.
fn band_count(scheme: Scheme) -> usize {
    match scheme {
        Scheme::Straight | Scheme::Capped => 2,
        Scheme::Angle | Scheme::Racetrack => 4,
        Scheme::Courtyard => 6,
        Scheme::Comb => 0,
    }
}

impl Genome {
    /// Returns a random start: large rooms as cells, small ones nested or on their own, en suites with their hosts.
    pub(crate) fn random(brief: &Brief, scheme: Scheme, rng: &mut Stream) -> Self {
        let count = band_count(scheme);
        let mut genome = Self {
            scheme,
            bands: (0..count).map(|_| Band { depth: 0, cells: Vec::new() }).collect(),
            caps: [None, None],
            corner: rng.chance(0.7),
            court: 0,
        };
        if scheme == Scheme::Courtyard {
            genome.court = up(COURT_M.0 + (COURT_M.1 - COURT_M.0) * rng.unit());
        }
        // the piece that closes a ring stands where the ring has it
        let ring = brief.ring.filter(|_| scheme.is_ring());
        let mut free: Vec<usize> =
            (0..brief.rooms.len()).filter(|i| ![brief.spine, ring].contains(&Some(*i)) && !brief.in_core(*i)).collect();
        rng.shuffle(&mut free);
        if scheme == Scheme::Capped {
            genome.choose_caps(brief, &mut free, rng);
        }
        let (nested, cells): (Vec<usize>, Vec<usize>) = free
            .into_iter()
            .partition(|&r| is_nestable(brief, r) && (brief.rooms[r].host.is_some() || rng.chance(0.6)));
        for room in cells {
            let lightest = genome.lightest_band(brief, room, rng);
            genome.bands[lightest].cells.push(Cell::new(room));
        }
        for room in nested {
            genome.nest_somewhere(brief, room, rng);
        }
        genome.spread_stations(brief, rng);
        for band in &mut genome.bands {
            let area: f64 = band.cells.iter().map(|c| brief.rooms[c.host].area_target).sum::<f64>();
            let mean = area / band.cells.len().max(1) as f64;
            band.depth = up((mean.sqrt() * (0.85 + 0.5 * rng.unit())).clamp(2.0, 9.0) + 0.18);
        }
        if let Some(core) = &brief.core
            && count > 0
        {
            // across the corridor a storey is best as deep as the one below
            let across = core.below.as_ref().filter(|b| b.by_core && count == 2).and_then(|b| b.depth_across(brief));
            if let Some(depth) = across.filter(|_| rng.chance(LIKE_BELOW)) {
                genome.bands[1 - CORE_BAND].depth = depth;
            }
            let band = &mut genome.bands[CORE_BAND];
            band.depth = core.depth;
            let at = rng.below(band.cells.len() + 1);
            let at = if core.gable { 0 } else { at };
            band.cells.insert(at, Cell::new(core.host));
        }
        genome
    }

    /// Sets the stations of a ring of corridors in the middle of its long sides in turn, in half of the starts: together they are
    /// near every bed.
    fn spread_stations(&mut self, brief: &Brief, rng: &mut Stream) {
        let is_station = |c: &Cell| brief.rooms[c.host].zone == Zone::Staff && brief.rooms[c.host].open_front;
        let stations: Vec<Cell> = self.bands.iter().flat_map(|b| &b.cells).copied().filter(is_station).collect();
        if !self.scheme.is_ring() || stations.len() < 2 || rng.chance(0.5) {
            return;
        }
        self.bands.iter_mut().for_each(|band| band.cells.retain(|c| !is_station(c)));
        for (n, station) in stations.into_iter().enumerate() {
            let cells = &mut self.bands[n % 2].cells;
            cells.insert(cells.len() / 2, station);
        }
    }

    /// Moves the one station of a plan with two arms to the inner corner of its corridor, from where one sees along both; returns
    /// false where there is no such station, or it is there.
    pub(crate) fn set_station_in_bend(&mut self, brief: &Brief) -> bool {
        let is_station = |c: &Cell| brief.rooms[c.host].zone == Zone::Staff && brief.rooms[c.host].open_front;
        let mut stations = self.bands.iter().enumerate().flat_map(|(b, band)| {
            band.cells.iter().enumerate().filter(|(_, c)| is_station(c)).map(move |(c, _)| (b, c))
        });
        let (Scheme::Angle, Some((band, at)), None) = (self.scheme, stations.next(), stations.next()) else {
            return false;
        };
        if band == BEND_BAND && at + 1 == self.bands[band].cells.len() {
            return false;
        }
        let station = self.bands[band].cells.remove(at);
        self.bands[BEND_BAND].cells.push(station);
        true
    }

    fn choose_caps(&mut self, brief: &Brief, free: &mut Vec<usize>, rng: &mut Stream) {
        let entrance = free.iter().position(|&r| brief.rooms[r].entrance && brief.rooms[r].area_target >= 8.0);
        if let Some(i) = entrance
            && rng.chance(0.7)
            && !brief.stem
        {
            self.caps[0] = Some(random_cap(free.remove(i), rng));
        }
        // where a hall ends in a large room, that is seldom the one to which everybody goes
        let retired = brief.is_home() && rng.chance(AT_THE_END);
        let largest = |zone: Option<Zone>| {
            free.iter()
                .enumerate()
                .map(|(i, &r)| (i, &brief.rooms[r]))
                .filter(|(_, r)| r.on_spine && r.area_target >= 9.0 && zone.is_none_or(|z| r.zone == z))
                .max_by(|a, b| a.1.area_target.total_cmp(&b.1.area_target))
                .map(|(i, _)| i)
        };
        let largest = largest(retired.then_some(Zone::Night)).or_else(|| largest(None));
        if let Some(i) = largest {
            self.caps[1] = Some(random_cap(free.remove(i), rng));
        }
    }

    /// Puts a small room beside its host, or beside a random large room.
    pub(crate) fn nest_somewhere(&mut self, brief: &Brief, room: usize, rng: &mut Stream) {
        let host = brief.rooms[room].host.or_else(|| guest_of(brief, room));
        // One of those that fit, each as likely; rather one that stays useful without its corner.
        let roomy = host.is_none() && !brief.is_home() && rng.chance(AT_LARGE);
        let (mut place, mut count, mut spares) = (None, 0, false);
        for (b, band) in self.bands.iter().enumerate() {
            for (c, cell) in band.cells.iter().enumerate() {
                let fits = match host {
                    Some(h) => cell.host == h,
                    None => {
                        // a vehicle needs the whole room
                        !brief.in_core(cell.host)
                            && brief.rooms[cell.host].gate.is_none()
                            && brief.rooms[cell.host].area_target >= 1.8 * brief.rooms[room].area_target
                    }
                };
                if fits && !(cell.left.is_full() && cell.right.is_full()) {
                    let spared = roomy && brief.rooms[cell.host].spares_a_corner();
                    if spares && !spared {
                        continue;
                    }
                    count = if spared && !spares { 1 } else { count + 1 };
                    spares |= spared;
                    if rng.below(count) == 0 {
                        place = Some((b, c));
                    }
                }
            }
        }
        let Some((b, c)) = place else {
            let b = rng.below(self.bands.len());
            let at = rng.below(self.bands[b].cells.len() + 1);
            self.bands[b].cells.insert(at, Cell::new(room));
            return;
        };
        let cell = &mut self.bands[b].cells[c];
        if cell.nest_depth == 0 {
            cell.nest_depth = nest_depth(brief, room);
        }
        if rng.chance(0.5) && !cell.left.is_full() || cell.right.is_full() {
            cell.left.push(room);
        } else {
            cell.right.push_front(room);
        }
    }

    fn lightest_band(&self, brief: &Brief, room: usize, rng: &mut Stream) -> usize {
        let load = |b: usize| self.bands[b].cells.iter().map(|c| brief.rooms[c.host].area_target).sum::<f64>();
        let spec = &brief.rooms[room];
        let dark = matches!(spec.daylight, Daylight::None | Daylight::Optional);
        // from the core those at an open counter see the doors on both sides of it
        let inner = dark || spec.open_front && spec.zone == Zone::Staff;
        let count = brief.rooms.len();
        let both_sides = BOTH_SIDES.contains(&count) || count > *BOTH_SIDES.end() && self.corner;
        let candidates: Vec<usize> = match self.scheme {
            // Bands 2 and 3 of a racetrack are its core.
            Scheme::Racetrack if inner && self.corner => vec![2],
            Scheme::Racetrack if inner => vec![2, 3],
            Scheme::Racetrack => vec![0, 1],
            Scheme::Courtyard if !both_sides => vec![0, 1, WEST_BAND, EAST_BAND],
            _ => (0..self.bands.len()).collect(),
        };
        let best = candidates.iter().copied().min_by(|a, b| load(*a).total_cmp(&load(*b))).unwrap_or(0);
        if rng.chance(0.75) { best } else { *rng.pick(&candidates).unwrap_or(&best) }
    }
}

fn random_cap(room: usize, rng: &mut Stream) -> Cap {
    let cover = *rng.pick(&[Cover::Both, Cover::Top, Cover::Bottom]).unwrap_or(&Cover::Both);
    Cap { room, cover, under: rng.chance(0.5) }
}

/// Returns true for rooms small enough to be cut out of a larger one's corridor side.
pub(crate) fn is_nestable(brief: &Brief, room: usize) -> bool {
    let spec = &brief.rooms[room];
    spec.area_target <= 9.0 && !spec.fixed && !spec.circulation && !spec.needs_outer_wall() && !spec.entrance
}

/// Returns the room that is entered through `room` (an isolation room through its anteroom), if any.
pub(crate) fn guest_of(brief: &Brief, room: usize) -> Option<usize> {
    brief.guests[room]
}

/// Returns a depth that gives a small room a good proportion, lattice units.
pub(crate) fn nest_depth(brief: &Brief, room: usize) -> i32 {
    up((brief.rooms[room].area_target * 1.25).sqrt() + 2.0 * INNER_HALF_M)
}
