//! The order of rooms: what lies before what behind the entrance, and what sees what.
//!
//! The search for a layout knows the middle of the room with the entrance only (`cost`). The layout it has found is
//! changed a little more, from a low temperature, with the places in view where the entrance may be. A search that
//! weighed all of this from its start would end at the same few plans for small programs.

use d3dgen_model::domain::Zone;
use d3dgen_model::seed::Stream;
use d3dgen_model::stage::Stop;

use super::cost::{Judge, Weights, ill_placed};
use super::genome::Genome;
use super::hall::passed_bedrooms;
use super::lattice::{Cellbox, up};
use super::realize::{Layout, Scratch, realize};
use super::spec::{Brief, RoomSpec};
use crate::candidate::Candidate;
use crate::changes::{LOOK, mutate, patience};
use crate::lattice::between;

/// Changes tried per room, and at most.
const TRIES_PER_ROOM: usize = 50;
const MOST_TRIES: usize = 900;
/// Temperature at the start, in cost units; a plan that is sound is not taken apart.
const HEAT: f64 = 0.3;
/// Wall at a corridor from which on a room has its door there, on center lines, m.
const LEAST_FRONT_M: f64 = 1.2;
/// Cost of a ward none of whose bedroom doors its station sees.
const OUT_OF_SIGHT: f64 = 8.0;
/// How far along the wall across from a station one sees a door beyond the ends of the station, m.
const ALONG_M: f64 = 0.5;
/// Bedrooms from which on a station cannot face all doors, and how far it sees those in the wall across aslant, m.
const MANY_BEDS: usize = 9;
const ASLANT_M: f64 = 8.0;
/// What a way from the stations to the bedrooms as long as the building is wide costs.
const OFF_CENTER: f64 = 2.5;
/// Way from a station to a bedroom from which on it is too long, m, and what as much more counts beside its length.
const LONG_WAY_M: f64 = 18.0;
const LONG_WAY: f64 = 2.0;
/// Width up to which a part of a room is a neck, on center lines, m, and what it costs.
const NECK_M: f64 = 2.4;
const NECK: f64 = 0.8;
/// Longest piece of outer wall that is looked at as an end of a corridor, lattice units.
const END_WALL: i32 = 80;
/// Cost of a plan in which one comes to all rooms in the wrong order.
const MISPLACED: f64 = 4.0;
/// Area up to which a wet room is one for guests, who should find it by the entrance, m^2.
const WASHROOM_M2: f64 = 3.0;
/// Cost of a home in which one passes a bedroom on the way from the entrance to the living room, and how much more that
/// counts in the choice of the entrance than the distances of all rooms.
const PASSED: f64 = 1.5;
const BEFORE_ZONES: f64 = 1.0;
/// Disorder with which a plan is left as it was found.
const TOLERABLE: f64 = 0.2;

/// Changes a sound layout where that mends the order of its rooms more than it costs otherwise.
pub(crate) fn put_in_order(
    brief: &Brief,
    judge: &mut Judge<'_>,
    weights: &Weights,
    (genome, found): (Genome, Candidate),
    rng: &mut Stream,
    stop: Stop<'_>,
) -> Candidate {
    let (mut scratch, mut layout) = (Scratch::default(), Layout::default());
    let mut look = |genome: &Genome, layout: &mut Layout| {
        realize(brief, genome, &mut scratch, layout);
        let score = judge.score(layout);
        (score, judge.disorder(layout))
    };
    let (score, mut order) = look(&genome, &mut layout);
    if !score.is_sound() {
        return found;
    }
    let mut cost = score.total(weights) + order;
    let (mut least, mut best) = (cost, found);
    let (mut current, mut trial) = (genome.clone(), genome);
    let tries = (TRIES_PER_ROOM * brief.rooms.len()).min(MOST_TRIES);
    for n in 0..tries {
        if order <= TOLERABLE || n % LOOK == 0 && stop.is_set() {
            break;
        }
        trial.clone_from(&current);
        // first of all to the place from which one sees most
        let changed = if n == 0 { trial.set_station_in_bend(brief) } else { mutate(brief, &mut trial, rng) };
        if !changed {
            continue;
        }
        let (score, disorder) = look(&trial, &mut layout);
        let total = score.total(weights) + disorder;
        if total < cost + HEAT * (1.0 - n as f64 / tries as f64) * patience(rng) {
            std::mem::swap(&mut current, &mut trial);
            cost = total;
            if score.is_sound() && total < least {
                (least, order) = (total, disorder);
                best = Candidate { scheme: current.scheme, layout: layout.clone(), score };
            }
        }
    }
    best
}

impl Judge<'_> {
    /// Returns what the order of rooms costs in the layout that was judged last.
    pub(crate) fn disorder(&self, layout: &Layout) -> f64 {
        let (misplaced, passed) = self.misplaced(layout);
        MISPLACED * misplaced
            + PASSED * passed
            + OUT_OF_SIGHT * self.out_of_sight(layout)
            + OFF_CENTER * self.off_center(layout)
            + NECK * self.necks(layout) as f64
    }

    /// Returns how many rooms for visitors, for work or by day have a narrow part.
    fn necks(&self, layout: &Layout) -> usize {
        let (rooms, brief) = (&self.survey.rooms, self.brief);
        let narrow = |(room, b): &&(usize, Cellbox)| {
            let by_day = matches!(brief.rooms[*room].zone, Zone::Public | Zone::Day | Zone::Staff);
            by_day && rooms[*room].main != Some(*b) && b.width().min(b.height()) < up(NECK_M)
        };
        layout.boxes.iter().filter(narrow).count()
    }

    /// Returns the share of pairs of rooms of different rank in which the one that comes later lies nearer the entrance,
    /// larger rooms counting more; and what the bedrooms count that one passes. The entrance is where it serves the rooms best.
    fn misplaced(&self, layout: &Layout) -> (f64, f64) {
        let rooms = || self.brief.rooms.iter().zip(&self.survey.rooms).filter_map(|(spec, r)| Some((spec, r.main?)));
        let gates = self.gates(layout);
        let size = rooms().map(|(_, main)| main.area_m2()).sum::<f64>().sqrt().max(1.0);
        let far = |main: Cellbox, gate: (i32, i32)| between(main.center2(), gate);
        let lost =
            |gate: (i32, i32)| -> f64 { rooms().map(|(spec, main)| ill_placed(spec, far(main, gate) / size)).sum() };
        let judged = gates.into_iter().map(|gate| (gate, passed_bedrooms(self.brief, &layout.boxes, gate)));
        let worse = |(gate, passed): &((i32, i32), f64)| lost(*gate) + BEFORE_ZONES * passed;
        let Some((gate, passed)) = judged.min_by(|a, b| worse(a).total_cmp(&worse(b))) else { return (0.0, 0.0) };
        // of a single room to live or work in nobody minds what else opens to the hall
        let one_room = rooms().filter(|(spec, _)| rank(spec).is_some() && !spec.wet).count() == 1;
        let ranked: Vec<(u8, f64, f64)> = rooms()
            .filter(|(spec, _)| !(one_room && spec.wet))
            .filter_map(|(spec, main)| Some((rank(spec)?, spec.area_target, far(main, gate))))
            .collect();
        let (mut wrong, mut all) = (0.0, 0.0);
        for (before, area, way) in &ranked {
            for (_, _, other) in ranked.iter().filter(|(after, ..)| after > before) {
                all += area;
                wrong += if way > other { *area } else { 0.0 };
            }
        }
        (if all > 0.0 { wrong / all } else { 0.0 }, passed)
    }

    /// Returns where one may come in: the middles of outer walls of the room with the entrance that hold a door, of a
    /// corridor's its ends where it has some; the stairs on upper storeys. Twice the coordinates, lattice units.
    fn gates(&self, layout: &Layout) -> Vec<(i32, i32)> {
        let (brief, rooms) = (self.brief, &self.survey.rooms);
        let stairs = brief.core.as_ref().map(|c| c.host);
        let Some(entered) = brief.rooms.iter().position(|r| r.entrance).or(stairs) else { return Vec::new() };
        let Some(main) = rooms[entered].main else { return Vec::new() };
        let mut out: Vec<(i32, (i32, i32))> = Vec::new();
        let own = layout.boxes.iter().zip(&self.survey.side).filter(|((r, _), _)| *r == entered && !brief.upper);
        for ((_, b), sides) in own {
            let (cx, cy) = b.center2();
            let ends = [(2 * b.x0, cy), (2 * b.x1, cy), (cx, 2 * b.y0), (cx, 2 * b.y1)];
            for (s, at) in ends.into_iter().enumerate() {
                let free = if s < 2 { b.height() } else { b.width() } - sides[s][0];
                if free >= self.entrance_need {
                    out.push((free, at));
                }
            }
        }
        if entered == self.spine && out.iter().any(|(free, _)| *free <= END_WALL) {
            out.retain(|(free, _)| *free <= END_WALL);
        }
        if out.is_empty() {
            out.push((0, main.center2()));
        }
        out.into_iter().map(|(_, gate)| gate).collect()
    }

    /// Returns the mean way from a bedroom to the nearest station with an open front, in sides of the building; long ones
    /// count more.
    fn off_center(&self, layout: &Layout) -> f64 {
        let rooms = self.survey.rooms.iter().filter_map(|r| r.main);
        let size = rooms.map(|main| main.area_m2()).sum::<f64>().sqrt().max(1.0);
        let long = |way: f64| way / size + LONG_WAY * (way / LONG_WAY_M - 1.0).max(0.0);
        let ways: Vec<f64> = self.ways_to_stations(layout).map(long).collect();
        ways.iter().sum::<f64>() / ways.len().max(1) as f64
    }

    /// Returns the share of bedrooms that no station with an open front sees: from there one sees the doors not far along in the
    /// wall across each piece of corridor that it stands at, and in walls at its ends, of an L both arms where it stands in the
    /// corner.
    fn out_of_sight(&self, layout: &Layout) -> f64 {
        let brief = self.brief;
        let Some(spine) = brief.spine.filter(|_| !brief.hub) else { return 0.0 };
        let is_station = |spec: &RoomSpec| spec.on_spine && spec.zone == Zone::Staff && spec.open_front;
        let pieces: Vec<Cellbox> = layout.boxes.iter().filter(|b| b.0 == spine).map(|b| b.1).collect();
        let at = |piece: &Cellbox, wanted: &dyn Fn(usize) -> bool| -> Vec<Front> {
            let boxes = layout.boxes.iter().filter(|(room, _)| wanted(*room));
            boxes.filter_map(|(_, b)| front_of(piece, b)).collect()
        };
        let posts: Vec<Vec<Front>> = pieces.iter().map(|c| at(c, &|room| is_station(&brief.rooms[room]))).collect();
        if posts.iter().all(Vec::is_empty) {
            return 0.0;
        }
        let beds = brief.rooms.iter().filter(|s| s.on_spine && s.zone == Zone::Night).count();
        let reach = up(if beds >= MANY_BEDS { ASLANT_M } else { ALONG_M });
        let (mut all, mut hidden) = (0, 0);
        for (bed, _) in brief.rooms.iter().enumerate().filter(|(_, s)| s.on_spine && s.zone == Zone::Night) {
            all += 1;
            let seen = pieces.iter().zip(&posts).any(|(c, posts)| {
                !posts.is_empty()
                    && at(c, &|room| room == bed).iter().any(|bed| posts.iter().any(|post| sees(post, bed, reach)))
            });
            hidden += u32::from(!seen);
        }
        f64::from(hidden) / f64::from(all.max(1))
    }
}

/// Where a room lies along a piece of corridor: the side of the piece, and from where to where, in lattice units.
type Front = (usize, i32, i32);

/// Returns true for a room whose door one sees from a station: never in the station's own wall, in the wall across as far
/// along as its opening lets one look, `reach`.
fn sees((side, from, to): &Front, (other, low, high): &Front, reach: i32) -> bool {
    let along = (low - to).max(from - high);
    side != other && (side / 2 != other / 2 || along <= reach)
}

/// Returns where a room lies along a piece of corridor, with wall enough for its door.
fn front_of(piece: &Cellbox, b: &Cellbox) -> Option<Front> {
    piece.contact(b).filter(|(_, from, to)| to - from >= up(LEAST_FRONT_M))
}

/// Returns when one comes to a room, behind the entrance: nobody passes bathrooms on the way to the living room; `None`
/// where that does not matter.
fn rank(spec: &RoomSpec) -> Option<u8> {
    match spec.zone {
        Zone::Public => Some(0),
        Zone::Day => Some(1),
        // one passes no isolation room on the way to the others
        Zone::Night if spec.host.is_some() => Some(3),
        Zone::Night => Some(2),
        Zone::Service if spec.wet && spec.private && spec.area_target > WASHROOM_M2 => Some(2),
        Zone::Staff | Zone::Service | Zone::Circulation | Zone::Outdoor => None,
    }
}
