//! Doors and open passages: where in the shared wall, how wide, which way the leaf swings.

mod courts;
mod mirrored;
mod outdoors;
mod spot;

use d3dgen_model::domain::Zone;
use d3dgen_model::floorplan::{Door, DoorKind, Swing};
use d3dgen_model::geometry::{Rect, to_mm};
use d3dgen_model::measures::{DOOR_HEIGHT_M, JAMB_M};
use d3dgen_model::scene_graph::Connector;
use d3dgen_model::seed::Stream;
use d3dgen_model::{Point, Segment};

pub(super) use self::courts::shut_courts;
use self::spot::{Spot, View};
use super::hall;
use super::lattice::{Cellbox, INNER_HALF_M, OUTER_HALF_M, meters};
use super::outline::Stretch;
use super::realize::BED_DOOR_M;
use super::spec::Brief;
use crate::measures::DOUBLE_FROM_M;
use crate::numbers::highest;
/// A leaf whose square takes more than this share of the room slides instead.
const SLIDING_SHARE: f64 = 0.22;
/// Widest open passage, m, and the piece of wall left on each side of it.
const OPEN_MAX_M: f64 = 4.0;
const OPEN_JAMB_M: f64 = 0.3;
/// Wall that a room open to several others keeps in one piece beside each opening, as far as that leaves one, m.
const RUN_M: f64 = 2.7;
/// The same between rooms without a kitchen's run, m.
const SIDEBOARD_M: f64 = 1.4;
/// What a meter counts in a home by which the door of a bedroom is nearer to the entrance than it might be, and by which that
/// of a room of the day is further from it.
const FROM_ENTRANCE: f64 = 0.2;
const DAY_FROM_ENTRANCE: f64 = 0.4;
/// What a meter counts by which the door of an en suite is further from that of its ward room than it might be.
const FROM_ENTRY: f64 = 0.7;
/// What it costs a home that one passes the door of a bedroom or bathroom on the way to that of the living room.
const PASSED: f64 = 2.0;
/// Floor behind a door into which a bed is pushed straight ahead, m, and how much wider the door is where it has to turn.
const BED_AHEAD_M: f64 = 2.3;
const BED_ASIDE_M: f64 = 0.15;
/// Floor area of a room by day from which on it has a second door, m^2, and how far that is from the first at least, m (about
/// 60 people at 2.5 m^2: Approved Document B, table 2.2).
const SECOND_DOOR_M2: f64 = 150.0;
/// People up to whom one way out is enough, in a room and in a building (IBC 1006.2, office_us_single_exit_max_occupants).
const ONE_EXIT_PEOPLE: u32 = 49;
const BETWEEN_DOORS_M: f64 = 6.0;
/// Floor area of a station from which on it is open to two corridors, m^2, how far apart these are at least, and the widest
/// opening to the second, m.
const TWO_FRONTS_M2: f64 = 12.0;
const TWO_FRONTS_APART_M: f64 = 1.0;
const SECOND_FRONT_M: f64 = 2.4;
/// Floor kept free in front of a door, m.
const APPROACH_M: f64 = 0.6;
/// What it costs that a door slides.
const SLIDING: f64 = 0.5;
/// What a place for a door costs that is neither at an end of its wall nor in the middle.
const BETWEEN: f64 = 1.7;
/// How often doors that disturb each other are moved.
const MOST_SETTLING: usize = 4;
/// How far beside the floor of another one a door stands that keeps clear of it, m.
const ASIDE_M: f64 = 0.05;
/// What it costs that a door stands clear of the floor of another one rather than in its corner.
const STEPPED_ASIDE: f64 = 1.2;

/// The plan so far, as door placing sees it.
pub(super) struct Site<'a> {
    pub brief: &'a Brief,
    pub boxes: &'a [(usize, Cellbox)],
    pub stretches: &'a [Stretch],
    pub net_m2: &'a [f64],
    /// Doors of an earlier plan, to be kept where their wall still stands.
    pub standing: &'a [Door],
}

/// Doors placed so far.
#[derive(Default)]
struct Laid {
    spots: Vec<Spot>,
    /// For each, the places it may have.
    choices: Vec<Vec<Spot>>,
    /// Passages that found no place.
    missing: Vec<String>,
    /// What their places cost.
    cost: f64,
}

/// Returns all passages of the plan; the reason for each that finds no place.
pub(super) fn place_doors(site: &Site<'_>, rng: &mut Stream) -> Result<Vec<Door>, String> {
    // the entrance where it serves the rooms best, with the other doors clear of it, or the other way round
    let [first, last] = [true, false].map(|entrance_first| lay(site, entrance_first, rng));
    let worse = |l: &Laid| (l.missing.len(), l.cost);
    let Laid { spots, missing, .. } = if worse(&last) < worse(&first) { last } else { first };
    if !missing.is_empty() {
        return Err(format!("no wall long enough for the door from {}", missing.join(", ")));
    }
    let mut doors: Vec<Door> = spots.into_iter().map(|s| s.door).collect();
    doors.sort_by_key(|d| d.room_ids.len() == 1);
    let next = 1 + highest(site.standing.iter().map(|d| d.door_id.as_str()));
    for (n, door) in (next..).zip(doors.iter_mut().filter(|d| d.door_id.is_empty())) {
        door.door_id = format!("door_{n}");
    }
    Ok(doors)
}

/// Places doors one after the other, then moves those that the later ones disturb.
fn lay(site: &Site<'_>, entrance_first: bool, rng: &mut Stream) -> Laid {
    let mut laid = Laid::default();
    let entrances = site.entrances();
    let (before, after) = entrances.split_at(if entrance_first { entrances.len().min(1) } else { 0 });
    site.lay_entrances(before, &mut laid);
    site.lay_gates(&mut laid);
    site.lay_ring(&mut laid);
    site.lay_inner(&mut laid, rng);
    site.lay_second_fronts(&mut laid);
    site.lay_entrances(after, &mut laid);
    site.lay_exits(&mut laid);
    site.lay_room_exits(&mut laid);
    site.lay_garden_door(&mut laid);
    site.lay_second_doors(&mut laid, rng);
    site.lay_court_doors(&mut laid);
    laid.settle();
    site.mirror_doors(&mut laid);
    laid.cost = laid.disturbances() + PASSED * f64::from(site.passed(&laid));
    laid
}

impl Laid {
    /// Returns the middle of the building's entrance, once it is placed.
    fn entrance(&self) -> Option<Point> {
        self.spots.iter().find(|l| l.door.entrance).map(|l| l.door.line.middle())
    }

    /// Returns the opening between two rooms, by their ids.
    fn between(&self, ids: [&String; 2]) -> Option<Segment> {
        let found = self.spots.iter().find(|l| ids.iter().all(|id| l.door.room_ids.contains(id)));
        found.map(|l| l.door.line)
    }

    /// Takes the spot that disturbs the doors already placed least; returns false when there is none.
    fn take_best(&mut self, spots: Vec<Spot>) -> bool {
        let costs = spots.iter().map(|spot| self.disturbance(spot, usize::MAX));
        let Some((_, best)) = costs.zip(0..).min_by(|a: &(f64, usize), b| a.0.total_cmp(&b.0)) else { return false };
        self.spots.push(spots[best].clone());
        self.choices.push(spots);
        true
    }

    /// Moves doors that look into a bathroom, or out of one, and leaves without wall to go into, where a later door made it so.
    fn settle(&mut self) {
        for _ in 0..MOST_SETTLING {
            let moved = (0..self.spots.len()).filter(|&n| self.resettle(n)).count();
            if moved == 0 {
                break;
            }
        }
    }

    /// Returns what the places of all doors cost.
    fn disturbances(&self) -> f64 {
        (0..self.spots.len()).map(|n| self.disturbance(&self.spots[n], n)).sum()
    }

    /// Moves a door that others disturb so to the best of its places; returns true when that is another one.
    fn resettle(&mut self, n: usize) -> bool {
        let own = &self.spots[n];
        let disturbs = |other: &Spot| own.looks_into(other) || own.lacks_wall_beside(other) > 0.0;
        if !self.spots.iter().enumerate().any(|(k, other)| k != n && disturbs(other)) {
            return false;
        }
        let costs = self.choices[n].iter().map(|spot| self.disturbance(spot, n));
        let best = costs.zip(0..).min_by(|a: &(f64, usize), b| a.0.total_cmp(&b.0)).map(|(_, best)| best);
        let Some(best) = best.filter(|&b| self.choices[n][b].door.line != self.spots[n].door.line) else {
            return false;
        };
        self.spots[n] = self.choices[n][best].clone();
        true
    }

    /// Returns what a spot costs beside the doors placed so far, except one.
    fn disturbance(&self, spot: &Spot, except: usize) -> f64 {
        let others = self.spots.iter().enumerate().filter(|(n, _)| *n != except).map(|(_, other)| other);
        spot.penalty + others.map(|other| spot.disturbs(other)).sum::<f64>()
    }
}

impl Site<'_> {
    /// Places the doors between rooms.
    fn lay_inner(&self, laid: &mut Laid, rng: &mut Stream) {
        let brief = self.brief;
        let mut wanted: Vec<(usize, usize, Connector, bool)> = Vec::new();
        if let Some(spine) = brief.spine {
            let by_door = |i: usize| i != spine && Some(i) != brief.ring;
            for (i, room) in brief.rooms.iter().enumerate().filter(|(i, r)| r.on_spine && by_door(*i)) {
                let connector = if room.open_front { Connector::Open } else { Connector::Door };
                wanted.push((i, spine, connector, true));
            }
        }
        let walkable = |c: Connector| matches!(c, Connector::Door | Connector::Open);
        wanted
            .extend(brief.links.iter().filter(|l| walkable(l.connector)).map(|l| (l.a, l.b, l.connector, l.required)));
        // wide openings have one place; leaves keep clear of them
        wanted.sort_by_key(|w| w.2 != Connector::Open);
        for (a, b, connector, required) in wanted {
            let stretches = self.stretches.iter().filter(|s| s.joins(a, b) && self.is_front(s, a));
            let spots: Vec<Spot> = match self.standing_spot(&[a, b], false) {
                Some(spot) => vec![spot],
                None => {
                    let mut spots: Vec<Spot> =
                        stretches.clone().flat_map(|s| self.spots(s, a, b, connector, rng)).collect();
                    if connector == Connector::Door && self.brief.is_home() {
                        spots.extend(stretches.flat_map(|s| self.spots_aside(s, [a, b], laid)));
                    }
                    self.prefer_order(&mut spots, a, b, laid);
                    self.prefer_entry(&mut spots, [a, b], laid);
                    spots
                }
            };
            if !laid.take_best(spots) && required {
                laid.missing.push(format!("{} to {}", brief.rooms[a].id, brief.rooms[b].id));
            }
        }
    }

    /// Opens the piece that closes a ring of corridors to them over its full width, at both of its ends.
    fn lay_ring(&self, laid: &mut Laid) {
        let Some((ring, spine)) = self.brief.ring.zip(self.brief.spine) else { return };
        let before = laid.spots.len();
        // stairs are open at the end of their flights only
        for s in self.stretches.iter().filter(|s| s.joins(ring, spine) && self.is_front(s, ring)) {
            let start = meters(s.from) + self.half_across(s, s.from);
            let width = meters(s.to) - self.half_across(s, s.to) - start;
            if width >= self.brief.spine_width - 1e-9 {
                let spot = self.open_spot(s, ring, spine, start, width);
                let known = self.standing.iter().find(|d| d.line == spot.door.line).cloned();
                laid.take_best(vec![Spot { door: known.unwrap_or_else(|| spot.door.clone()), ..spot }]);
            }
        }
        if laid.spots.len() == before {
            laid.missing.push(format!("{} to {}", self.brief.rooms[ring].id, self.brief.rooms[spine].id));
        }
    }

    /// Makes doors to the hall of a home dearer that are far from its entrance for a room of the day, near it for a bedroom;
    /// the best of them costs what it did.
    fn prefer_order(&self, spots: &mut [Spot], room: usize, other: usize, laid: &Laid) {
        if !self.brief.is_home() || Some(other) != self.brief.spine {
            return;
        }
        let Some(entrance) = laid.entrance() else { return };
        let sign = match self.brief.rooms[room].zone {
            Zone::Day | Zone::Public => DAY_FROM_ENTRANCE,
            Zone::Night => -FROM_ENTRANCE,
            _ => return,
        };
        let way = |spot: &Spot| {
            let p = spot.door.line.middle();
            sign * ((p.x - entrance.x).abs() + (p.y - entrance.y).abs())
        };
        let least = spots.iter().map(way).fold(f64::MAX, f64::min);
        for spot in spots {
            spot.penalty += way(spot) - least;
        }
    }

    /// Makes the door of an en suite dearer that is far from where its ward room is entered: one reaches it past no other bed.
    fn prefer_entry(&self, spots: &mut [Spot], [a, b]: [usize; 2], laid: &Laid) {
        let rooms = &self.brief.rooms;
        let hosted = |guest: usize, host: usize| {
            rooms[guest].host == Some(host) && rooms[guest].wet && rooms[host].zone == Zone::Night
        };
        let Some(host) = [(a, b), (b, a)].into_iter().find(|&(g, h)| hosted(g, h)).map(|(_, h)| h) else { return };
        let entry = self.brief.spine.and_then(|spine| laid.between([&rooms[host].id, &rooms[spine].id]));
        let Some(entry) = entry.filter(|_| !self.brief.is_home()).map(|line| line.middle()) else { return };
        let way = |spot: &Spot| {
            let p = spot.door.line.middle();
            FROM_ENTRY * ((p.x - entry.x).abs() + (p.y - entry.y).abs())
        };
        let least = spots.iter().map(way).fold(f64::MAX, f64::min);
        for spot in spots {
            spot.penalty += way(spot) - least;
        }
    }

    /// Returns how many doors of bedrooms and bathrooms are nearer to the entrance than that of the living room, in a home.
    fn passed(&self, laid: &Laid) -> u32 {
        let brief = self.brief;
        let Some((spine, living)) = brief.spine.zip(hall::room_of_guests(brief)) else { return 0 };
        let Some(entrance) = laid.entrance() else { return 0 };
        let way = |room: usize| {
            let p = laid.between([room, spine].map(|r| &brief.rooms[r].id))?.middle();
            Some((p.x - entrance.x).abs() + (p.y - entrance.y).abs())
        };
        let Some(to_living) = way(living) else { return 0 };
        let retreats = (0..brief.rooms.len()).filter(|r| {
            let room = &brief.rooms[*r];
            room.zone == Zone::Night || room.wet && room.private && !room.for_guests
        });
        retreats.filter_map(way).filter(|bed| *bed < to_living - hall::PLAINLY_M).count() as u32
    }

    /// Opens stations that lie between two corridors, or in the corner of one, to the second as well: those there watch the
    /// rooms on both.
    fn lay_second_fronts(&self, laid: &mut Laid) {
        let brief = self.brief;
        let Some(spine) = brief.spine.filter(|_| !brief.hub && brief.rooms.iter().any(|r| r.zone == Zone::Night))
        else {
            return;
        };
        let posts = |r: &usize| {
            let spec = &brief.rooms[*r];
            spec.on_spine && spec.open_front && spec.zone == Zone::Staff && self.net_m2[*r] >= TWO_FRONTS_M2
        };
        for room in (0..brief.rooms.len()).filter(posts) {
            let Some(first) = laid.between([room, spine].map(|r| &brief.rooms[r].id)) else { continue };
            let (vertical, middle) = (first.is_vertical(), first.middle());
            let other = |s: &&Stretch| {
                let across = if vertical { middle.x } else { middle.y };
                s.joins(room, spine) && (s.vertical != vertical || (meters(s.at) - across).abs() > TWO_FRONTS_APART_M)
            };
            let spots = self.stretches.iter().filter(other).flat_map(|s| {
                let (from, to) = self.usable(s);
                let width = ((to - from) / 2.0).min(SECOND_FRONT_M);
                let enough = width >= Brief::opening(brief.door_width(room, spine));
                let starts = [from, to - width].into_iter().filter(move |_| enough);
                starts.map(move |start| self.open_spot(s, room, spine, start, width))
            });
            laid.take_best(spots.collect());
        }
    }

    /// Places second doors from the corridor into large rooms, and into those of more people than may share one, as far from the first as the wall between them allows.
    fn lay_second_doors(&self, laid: &mut Laid, rng: &mut Stream) {
        let brief = self.brief;
        let Some(spine) = brief.spine.filter(|_| brief.second_exit && !brief.hub) else { return };
        let large = |r: &usize| self.net_m2[*r] >= SECOND_DOOR_M2 || brief.rooms[*r].people > ONE_EXIT_PEOPLE;
        let opens = |r: &usize| brief.rooms[*r].on_spine && *r != spine;
        for room in (0..brief.rooms.len()).filter(opens).filter(large) {
            let ids = [room, spine].map(|r| &brief.rooms[r].id);
            let first = laid.spots.iter().find(|l| ids.iter().all(|id| l.door.room_ids.contains(id)));
            let Some(first) = first.map(|l| l.door.clone()).filter(|d| d.kind != DoorKind::Open) else { continue };
            let own_way_out = laid.spots.iter().any(|l| l.door.room_ids == [ids[0].clone()]);
            if own_way_out && self.net_m2[room] < SECOND_DOOR_M2 {
                continue;
            }
            let away = |spot: &Spot| spot.door.line.middle().distance(first.line.middle());
            let stretches = self.stretches.iter().filter(|s| s.joins(room, spine));
            let mut spots: Vec<Spot> =
                stretches.flat_map(|s| self.spots(s, room, spine, Connector::Door, rng)).collect();
            spots.retain(|spot| away(spot) >= BETWEEN_DOORS_M);
            let most = spots.iter().map(away).fold(0.0, f64::max);
            spots.iter_mut().for_each(|spot| spot.penalty += most - away(spot));
            laid.take_best(spots);
        }
    }

    /// Returns the place of an earlier door between these rooms (of one: out of the building) when its wall still stands.
    fn standing_spot(&self, rooms: &[usize], main: bool) -> Option<Spot> {
        self.standing_spots(rooms, main, None).next()
    }

    /// Returns the places of earlier doors between these rooms (of one: to outdoors, or to this court) whose walls still stand.
    fn standing_spots(&self, rooms: &[usize], main: bool, court: Option<usize>) -> impl Iterator<Item = Spot> {
        let ids: Vec<&str> = rooms.iter().map(|&r| self.brief.rooms[r].id.as_str()).collect();
        let between = move |s: &&Stretch| match rooms {
            [a, b] => s.joins(*a, *b),
            _ => s.only_room() == rooms.first().copied() && s.court == court,
        };
        let same = move |d: &&Door| {
            d.room_ids.len() == ids.len() && d.entrance == main && d.room_ids.iter().all(|r| ids.contains(&r.as_str()))
        };
        self.standing.iter().filter(same).filter_map(move |door| {
            let (at, start, end) = door.line.span();
            let stands = |s: &&Stretch| {
                let (from, to) = self.usable(s);
                s.vertical == door.line.is_vertical()
                    && (meters(s.at) - at).abs() < 1e-6
                    && from - 1e-6 <= start
                    && end <= to + 1e-6
            };
            let s = self.stretches.iter().filter(between).find(stands)?;
            let leaf = if door.kind == DoorKind::DoubleHinged { (end - start) / 2.0 } else { end - start };
            let mut zones: Vec<(usize, Rect)> =
                rooms.iter().map(|&r| (r, self.zone(s, r, start, end - start, APPROACH_M))).collect();
            let into = door.swing.as_ref().and_then(|w| w.into_room_id.as_deref());
            if let Some(&room) = rooms.iter().find(|&&r| Some(self.brief.rooms[r].id.as_str()) == into) {
                let swept = self.zone(s, room, start, end - start, leaf.max(APPROACH_M));
                if !self.inside(room, &swept) {
                    return None;
                }
                zones.push((room, swept));
            }
            rooms.iter().all(|&r| self.inside(r, &self.zone(s, r, start, end - start, 0.5))).then(|| Spot {
                door: door.clone(),
                wall: (door.kind == DoorKind::Sliding).then(|| self.wall_along(s)),
                view: View::Other,
                zones,
                penalty: 0.0,
            })
        })
    }

    /// Returns true for walls where a room may have its door: a stairwell has it at the end of its flights, an elevator at the
    /// alcove beside them, wherever else a corridor passes it.
    fn is_front(&self, s: &Stretch, room: usize) -> bool {
        let spec = &self.brief.rooms[room];
        let shape = |room: usize| self.boxes.iter().find(|b| b.0 == room).map(|b| b.1);
        let across = |stairs: &Cellbox| s.vertical == (stairs.height() < stairs.width());
        if spec.elevator {
            let stairs = self.brief.core.as_ref().and_then(|core| shape(core.host));
            return stairs.is_none_or(|b| {
                let (low, high) = if s.vertical { (b.x0, b.x1) } else { (b.y0, b.y1) };
                across(&b) && low < s.at && s.at < high
            });
        }
        !spec.fixed || shape(room).is_none_or(|b| across(&b))
    }

    /// Returns the free part of a stretch in meters: clear of the walls that meet its ends.
    fn usable(&self, s: &Stretch) -> (f64, f64) {
        let end = |at: i32| JAMB_M + self.half_across(s, at);
        (meters(s.from) + end(s.from), meters(s.to) - end(s.to))
    }

    /// Returns the ends of the inner wall that a stretch is part of, whatever rooms it parts, along it, m.
    fn wall_along(&self, s: &Stretch) -> (f64, f64) {
        let inner = || self.stretches.iter().filter(|t| t.vertical == s.vertical && t.at == s.at && !t.is_outer());
        let (mut from, mut to) = (s.from, s.to);
        while let Some(before) = inner().find(|t| t.to == from) {
            from = before.from;
        }
        while let Some(after) = inner().find(|t| t.from == to) {
            to = after.to;
        }
        let half = |at: i32| self.half_across(s, at);
        (meters(from) + half(from), meters(to) - half(to))
    }

    /// Returns half the thickness of the thickest wall that meets the line of a stretch at a point of it, m.
    fn half_across(&self, s: &Stretch, at: i32) -> f64 {
        let meets = |t: &&Stretch| t.vertical != s.vertical && t.from <= s.at && s.at <= t.to && t.at == at;
        let outer = self.stretches.iter().filter(meets).any(Stretch::is_outer);
        if outer { OUTER_HALF_M } else { INNER_HALF_M }
    }

    fn spots(&self, s: &Stretch, a: usize, b: usize, connector: Connector, rng: &mut Stream) -> Vec<Spot> {
        let clear = self.brief.door_width(a, b);
        let opening = Brief::opening(clear);
        let (from, to) = self.usable(s);
        if to - from < opening - 1e-9 {
            return Vec::new();
        }
        if connector == Connector::Open {
            let whole = (meters(s.len()) - 2.0 * (OPEN_JAMB_M + INNER_HALF_M)).clamp(opening, OPEN_MAX_M.max(opening));
            if !self.is_open_to_several(a, b) {
                let start = (from + to - whole) / 2.0;
                return vec![self.open_spot(s, a, b, start, whole)];
            }
            // what stands in the smaller room needs walls too: half of this one, in one piece, or what a kitchen's run takes; between
            // rooms to sit in a sideboard's length is enough
            let length = meters(s.len());
            let width = if [a, b].iter().any(|&r| self.brief.rooms[r].wet) {
                (length / 2.0).min(length - RUN_M)
            } else {
                (length / 2.0).max(length - SIDEBOARD_M)
            };
            let width = width.clamp(opening, whole);
            return [from, to - width].map(|start| self.open_spot(s, a, b, start, width)).into();
        }
        let into = self.swing_room(a, b);
        // beds that cannot go straight in turn in a wider door
        let straight = clear < BED_DOOR_M || self.inside(into, &self.zone(s, into, from, to - from, BED_AHEAD_M));
        let wider = if straight { clear } else { clear + BED_ASIDE_M };
        let (clear, opening) = match Brief::opening(wider) {
            wide if to - from >= wide => (wider, wide),
            _ => (clear, opening),
        };
        let first = if rng.chance(0.5) { 0.0 } else { 0.2 };
        let mut spots = Vec::new();
        let middle = (from + to - opening) / 2.0;
        if [a, b].iter().any(|&r| self.brief.rooms[r].elevator) {
            // a car has its door in one place for all storeys
            return self.leaf_spot(s, [a, b], into, middle, clear, true, 0.0).into_iter().collect();
        }
        for (start, hinge_at_start, penalty) in
            [(from, true, first), (to - opening, false, 0.2 - first), (middle, true, 1.5)]
        {
            spots.extend(self.leaf_spot(s, [a, b], into, start, clear, hinge_at_start, penalty));
        }
        if spots.iter().any(|spot| spot.wall.is_some()) {
            // a leaf that slides finds wall in other places too
            let between = [(from + middle) / 2.0, (middle + to - opening) / 2.0];
            spots.extend(between.iter().filter_map(|&x| self.leaf_spot(s, [a, b], into, x, clear, true, BETWEEN)));
        }
        spots
    }

    /// Returns places for a door right beside the floor that the doors to outdoors need: where one comes in the leaf swings.
    fn spots_aside(&self, s: &Stretch, rooms: [usize; 2], laid: &Laid) -> Vec<Spot> {
        let [a, b] = rooms;
        let clear = self.brief.door_width(a, b);
        let opening = Brief::opening(clear);
        let (from, to) = self.usable(s);
        let outer = laid.spots.iter().filter(|l| l.door.room_ids.len() == 1);
        let zones = outer.flat_map(|l| &l.zones).filter(|(room, _)| rooms.contains(room)).map(|(_, zone)| zone);
        let ends = zones.map(|z| if s.vertical { (z.y0, z.y1) } else { (z.x0, z.x1) });
        let starts = ends.flat_map(|(low, high)| [(high + ASIDE_M, true), (low - ASIDE_M - opening, false)]);
        let into = self.swing_room(a, b);
        let fitting = starts.filter(|(start, _)| *start >= from - 1e-9 && start + opening <= to + 1e-9);
        fitting
            .filter_map(|(start, at_start)| self.leaf_spot(s, rooms, into, start, clear, at_start, STEPPED_ASIDE))
            .collect()
    }

    /// Returns true when the smaller of two rooms is open to others as well.
    fn is_open_to_several(&self, a: usize, b: usize) -> bool {
        let smaller = if self.net_m2[a] < self.net_m2[b] { a } else { b };
        let links = self.brief.links.iter().filter(|l| l.connector == Connector::Open);
        links.filter(|l| l.a == smaller || l.b == smaller).count() > 1
    }

    /// Returns the room a leaf opens into: never the corridor; of two rooms the one that hangs on the other, else the larger.
    fn swing_room(&self, a: usize, b: usize) -> usize {
        let brief = self.brief;
        if Some(a) == brief.spine || brief.rooms[b].host == Some(a) {
            return b;
        }
        if Some(b) == brief.spine || brief.rooms[a].host == Some(b) {
            return a;
        }
        if self.net_m2[a] >= self.net_m2[b] { a } else { b }
    }

    fn open_spot(&self, s: &Stretch, a: usize, b: usize, start: f64, width: f64) -> Spot {
        let line = Segment { start: s.point(start), end: s.point(start + width) };
        let zones = [a, b].map(|r| (r, self.zone(s, r, start, width, APPROACH_M))).to_vec();
        let door = self.door(line, DoorKind::Open, width, s, &[a, b], None);
        Spot { door, wall: None, view: self.view([a, b]), zones, penalty: 0.0 }
    }

    /// Returns what one looks into through a door between two rooms from where people pass.
    fn view(&self, rooms: [usize; 2]) -> View {
        let [a, b] = rooms.map(|r| &self.brief.rooms[r]);
        let Some(room) = [(a, b), (b, a)].into_iter().find(|(_, from)| from.circulation).map(|(room, _)| room) else {
            return View::Other;
        };
        match room.zone {
            _ if room.wet && room.private => View::Retreat,
            Zone::Day | Zone::Public => View::Company,
            _ if room.wet => View::Company,
            _ => View::Other,
        }
    }

    #[expect(clippy::too_many_arguments, reason = "one door is where, between whom, how wide, which way")]
    fn leaf_spot(
        &self,
        s: &Stretch,
        rooms: [usize; 2],
        into: usize,
        start: f64,
        clear: f64,
        hinge_at_start: bool,
        penalty: f64,
    ) -> Option<Spot> {
        let opening = Brief::opening(clear);
        let line = Segment { start: s.point(start), end: s.point(start + opening) };
        let double = clear >= DOUBLE_FROM_M;
        let leaf = if double { opening / 2.0 } else { opening };
        let swept = self.zone(s, into, start, opening, leaf.max(APPROACH_M));
        let elevator = rooms.iter().any(|&r| self.brief.rooms[r].elevator);
        // robots open no leaf
        let docks = rooms.iter().any(|&r| self.brief.rooms[r].docks && !self.brief.rooms[r].circulation);
        // nobody wants the door of a stairwell to open to a robot that passes
        let kept_out = rooms.iter().any(|&r| self.brief.rooms[r].kept_out);
        let works = rooms.iter().any(|&r| self.brief.rooms[r].automatic) && !kept_out;
        let by_hand = rooms.iter().any(|&r| self.brief.rooms[r].by_hand);
        let automatic = elevator || (docks || works) && !by_hand;
        let slides = automatic
            || self.brief.rooms[into].slides
            || leaf * leaf > SLIDING_SHARE * self.net_m2[into]
            || !self.inside(into, &swept);
        let mut zones: Vec<(usize, Rect)> =
            rooms.iter().map(|&r| (r, self.zone(s, r, start, opening, APPROACH_M))).collect();
        let (kind, swing) = if slides {
            (DoorKind::Sliding, None)
        } else {
            zones.push((into, swept));
            let kind = if double { DoorKind::DoubleHinged } else { DoorKind::Hinged };
            (kind, Some(Swing { into_room_id: Some(self.brief.rooms[into].id.clone()), hinge_at_start }))
        };
        if !rooms.iter().all(|&r| self.inside(r, &self.zone(s, r, start, opening, 0.5))) {
            return None;
        }
        let door = Door { automatic, ..self.door(line, kind, clear, s, &rooms, swing) };
        let wall = slides.then(|| self.wall_along(s));
        let spot = Spot { door, wall, view: self.view(rooms), zones, penalty };
        let sliding = if slides { SLIDING + spot.lacks_pocket() } else { 0.0 };
        Some(Spot { penalty: penalty + sliding, ..spot })
    }

    fn door(
        &self,
        line: Segment,
        kind: DoorKind,
        clear: f64,
        s: &Stretch,
        rooms: &[usize],
        swing: Option<Swing>,
    ) -> Door {
        Door {
            door_id: String::new(),
            kind,
            line,
            clear_width_m: to_mm(clear),
            height_m: DOOR_HEIGHT_M,
            wall_thickness_m: if s.is_outer() { 2.0 * OUTER_HALF_M } else { 2.0 * INNER_HALF_M },
            room_ids: rooms.iter().map(|&r| self.brief.rooms[r].id.clone()).collect(),
            entrance: false,
            swing,
            slide: None,
            automatic: false,
            locked: false,
        }
    }

    /// Returns the floor of `room` in front of an opening, `deep` meters from the wall's face.
    fn zone(&self, s: &Stretch, room: usize, start: f64, width: f64, deep: f64) -> Rect {
        let at = meters(s.at);
        let half = if s.is_outer() { OUTER_HALF_M } else { INNER_HALF_M };
        let (near, far) =
            if s.low == Some(room) { (at - half - deep, at - half) } else { (at + half, at + half + deep) };
        if s.vertical { Rect::new(near, start, far, start + width) } else { Rect::new(start, near, start + width, far) }
    }

    /// Returns true when a rectangle lies in a room, probed on a 3 x 3 grid of points.
    fn inside(&self, room: usize, zone: &Rect) -> bool {
        let zone = zone.grown(-0.01);
        let probe = |p: Point| {
            self.boxes.iter().any(|(r, b)| {
                let b = b.to_rect();
                *r == room && (b.x0..=b.x1).contains(&p.x) && (b.y0..=b.y1).contains(&p.y)
            })
        };
        (0..9).all(|k| {
            let (i, j) = (f64::from(k % 3) / 2.0, f64::from(k / 3) / 2.0);
            probe(Point::new(zone.x0 + i * zone.width(), zone.y0 + j * zone.height()))
        })
    }
}
