//! Large buildings: rooms are dealt out to wings first, then each wing is searched by itself, then the wings are set
//! along a spine, on one side of it or on both.
//!
//! Time grows with the number of wings, not with the number of ways to mix all rooms; and what a wing cannot hold fails
//! in that wing only. Courtyards between wings give every room beside a corridor its outer wall.

use d3dgen_model::domain::{Scheme, Zone};
use d3dgen_model::scene_graph::Connector;
use d3dgen_model::seed::Stream;
use d3dgen_model::stage::Stop;
use d3dgen_model::style::Form;

use super::core::{Below, Comb, Slot, out_of_core};
use super::cost::{Judge, Weights};
use super::lattice::{Cellbox, Frame, meters, up};
use super::realize::{Layout, spine_units};
use super::search::search_with;
use super::spec::Brief;
use crate::candidate::Candidate;

/// Rooms from which on a building is composed of wings.
pub(crate) const LARGE: usize = 18;
/// Rooms of a wing at least and at most, where clusters allow it.
const WING_ROOMS: (f64, f64) = (9.0, 30.0);
/// Width of the courtyard between two wings, m.
const COURTYARD_M: f64 = 7.0;
/// Least width of a courtyard where wings stand on those of the storey below, m.
const LEAST_COURTYARD_M: f64 = 6.0;
/// Spine between the last wing and the second stairs, for upper storeys to grow into, m.
const SLACK_M: f64 = 1.5;
/// Depth of rooms along a corridor to reckon with, m.
const USUAL_DEPTH_M: f64 = 5.0;
/// Ways to deal out the rooms that are tried before the building is given up.
const DEALS: usize = 4;
/// Rooms that can be near one room; wishes of more than so many count less each.
const NEIGHBORS: f64 = 8.0;
/// Changes tried per cluster while dealing out.
const CHANGES: usize = 60;

/// Most rooms of a unit that has one wing.
const WHOLE_UNIT: usize = 28;

/// Rooms that must adjoin each other, directly or in a chain.
struct Cluster {
    rooms: Vec<usize>,
    /// Unit of the building that they belong to.
    unit: Option<usize>,
    /// Corridor wall that they take, m: what fills a wing is fronts, not areas.
    front: f64,
}

/// One wing on the lattice: its corridor runs east from x = 0, where the spine passes.
struct Wing {
    boxes: Vec<(usize, Cellbox)>,
    south: i32,
    north: i32,
    /// True when it keeps all hard rules by itself.
    sound: bool,
}

/// Returns the best building of wings; its `score.hard` is above 0 when none is sound.
pub(crate) fn compose(brief: &Brief, weights: &Weights, rng: &mut Stream, stop: Stop<'_>) -> Option<Candidate> {
    let spine = brief.spine?;
    let mut judge = Judge::new(brief);
    let mut best: Option<Candidate> = None;
    let core = brief.core.as_ref();
    let given = core.and_then(|c| c.below.as_ref()).and_then(|b| b.comb.as_ref());
    'deals: for deal in 0..DEALS {
        let rooms = brief.rooms.len() as f64;
        let each = (rooms.sqrt() * (1.2 + 0.5 * rng.unit())).clamp(WING_ROOMS.0, WING_ROOMS.1);
        // When a deal fails, shorter wings leave more choice.
        let count = ((rooms / each).round() as usize + deal / 2).max(2);
        // the wings of an upper storey stand on those below
        let count = given.map_or(count, |c| c.slots.len());
        let mut wings: Vec<Wing> = Vec::new();
        let mut stack = given.map(|c| (c, Yard::new(brief, c.first)));
        for rooms in &partition(brief, count, given.is_some(), rng) {
            let below = stack.as_ref().and_then(|(c, yard)| below_wing(brief, c, wings.len(), yard));
            let Some(found) = wing(brief, rooms, weights, below.as_ref(), rng, stop) else { continue };
            // one wing that cannot be built spoils the deal; the last deal is kept to say by how much
            if !found.sound && deal + 1 < DEALS {
                continue 'deals;
            }
            if let Some((comb, yard)) = &mut stack
                && let Some(slot) = comb.slots.get(wings.len())
            {
                yard.take(slot.side, slot.at, &found);
            }
            wings.push(found);
        }
        if stop.is_set() {
            break;
        }
        // two across from each other make a bar
        let two_sided = wings.len() > 3 || rng.chance(0.5) && (wings.len() > 2 || brief.form != Some(Form::Wings));
        let layout = along_spine(brief, spine, wings, two_sided, rng);
        let score = judge.score(&layout);
        let found = Candidate { scheme: Scheme::Comb, layout, score };
        let sound = score.is_sound();
        if best.as_ref().is_none_or(|b| score.hard < b.score.hard) {
            best = Some(found);
        }
        if sound {
            break;
        }
    }
    best
}

/// Searches one wing; `None` for a wing without rooms.
fn wing(
    brief: &Brief,
    rooms: &[usize],
    weights: &Weights,
    below: Option<&Below>,
    rng: &mut Stream,
    stop: Stop<'_>,
) -> Option<Wing> {
    if rooms.is_empty() || stop.is_set() {
        return None;
    }
    let part = brief.wing(rooms);
    // a room at the end of a wing closes the way out there
    let ends_free = brief.second_exit && !brief.upper;
    let capped = rng.chance(0.5) && !ends_free;
    let schemes = if capped { [Scheme::Capped, Scheme::Straight] } else { [Scheme::Straight, Scheme::Capped] };
    let schemes = if rooms.len() < 5 { &[Scheme::Straight][..] } else { &schemes };
    let found = search_with(&part, schemes, (weights, 1), below, rng, stop)?;
    let w = spine_units(brief);
    let stem = |(room, b): &(usize, Cellbox)| Some(*room) == part.spine && b.x1 <= 0;
    let boxes: Vec<(usize, Cellbox)> = found.layout.boxes.iter().copied().filter(|b| !stem(b)).collect();
    let (south, north) = boxes.iter().fold((0, w), |(s, n), (_, b)| (s.min(b.y0), n.max(b.y1)));
    let whole = |room: usize| if Some(room) == part.spine { brief.spine.unwrap_or(room) } else { rooms[room] };
    let sound = found.score.is_sound();
    Some(Wing { sound, boxes: boxes.into_iter().map(|(room, b)| (whole(room), b)).collect(), south, north })
}

/// Returns what is below a wing, as the wing sees it, and where it may reach between the others.
fn below_wing(brief: &Brief, comb: &Comb, wing: usize, yard: &Yard) -> Option<Below> {
    let slot = comb.slots.get(wing)?;
    let core = brief.core.as_ref()?;
    let w = spine_units(brief);
    let outline = out_of_core(&core.below.as_ref()?.outline, &core_frame(comb.first, w));
    let seen = |b: &Cellbox| {
        let (x0, x1) = if slot.side == 0 { (b.x0, b.x1) } else { (-w - b.x1, -w - b.x0) };
        Cellbox::new(x0, b.y0 - slot.at, x1, b.y1 - slot.at)
    };
    let next = comb.slots[wing + 1..].iter().find(|s| s.side == slot.side).map(|s| s.at + s.south - yard.courtyard);
    let end = next.or(comb.far.filter(|_| slot.side != comb.first)).unwrap_or(i32::MAX / 2);
    let between = Some((yard.next[slot.side] - slot.at, end - slot.at));
    Some(Below { outline: outline.iter().map(seen).collect(), between, ..Below::default() })
}

/// The sides of a spine while wings are set along it.
struct Yard {
    /// Where the next wing of each side may begin.
    next: [i32; 2],
    /// Width of a courtyard.
    courtyard: i32,
}

impl Yard {
    /// Returns the spine with the core across from the first wing.
    fn new(brief: &Brief, first: usize) -> Self {
        let core = brief.core.as_ref();
        let stacked = core.and_then(|c| c.below.as_ref()).is_some_and(|b| b.comb.is_some());
        let courtyard = up(if stacked { LEAST_COURTYARD_M } else { COURTYARD_M });
        let mut next = [0, 0];
        next[1 - first] = core.map_or(0, |c| c.width + courtyard);
        Self { next, courtyard }
    }

    /// Sets the next wing of a side, where its corridor is at `least` if that leaves room.
    fn take(&mut self, side: usize, least: i32, wing: &Wing) -> Slot {
        let at = (self.next[side] - wing.south).max(least);
        self.next[side] = at + wing.north + self.courtyard;
        Slot { side, at, south: wing.south, north: wing.north }
    }
}

/// Returns where the core stands: at the start of the spine, across from the first wing.
fn core_frame(first: usize, w: i32) -> Frame {
    if first == 1 {
        Frame { origin: (0, 0), u: (0, 1), v: (1, 0) }
    } else {
        Frame { origin: (-w, 0), u: (0, 1), v: (-1, 0) }
    }
}

/// Sets the wings along a spine that runs north.
fn along_spine(brief: &Brief, spine: usize, wings: Vec<Wing>, two_sided: bool, rng: &mut Stream) -> Layout {
    let w = spine_units(brief);
    let mut layout = Layout::default();
    let (mut low, mut high) = (i32::MAX, i32::MIN);
    let first = rng.below(2);
    let core = brief.core.as_ref();
    let given = core.and_then(|c| c.below.as_ref()).and_then(|b| b.comb.as_ref());
    let first = given.map_or(first, |c| c.first);
    layout.comb.first = first;
    let mut yard = Yard::new(brief, first);
    if let Some(core) = core {
        let frame = core_frame(first, w);
        layout.boxes.extend(core.boxes.iter().map(|(r, b)| (*r, frame.place(b.x0, b.x1, b.y0, b.y1))));
        layout.core = Some(frame);
        (low, high) = (0, core.width);
    }
    // without stairs that take a place, wings across from each other share one straight corridor
    let across = two_sided && core.is_none();
    let souths: Vec<i32> = wings.iter().map(|wing| wing.south).collect();
    let mut level = i32::MIN;
    for (i, wing) in wings.into_iter().enumerate() {
        let side = match (i, two_sided) {
            (0, _) | (_, false) => first,
            _ if across => [first, 1 - first][i % 2],
            _ => usize::from(yard.next[1] < yard.next[0]),
        };
        if across && i % 2 == 0 {
            let lowest = |side: usize, i: usize| souths.get(i).map_or(i32::MIN, |south| yard.next[side] - south);
            level = lowest(first, i).max(lowest(1 - first, i + 1));
        }
        let below = given.and_then(|c| c.slots.get(i));
        let least = if across { level } else { below.map_or(i32::MIN, |s| s.at) };
        let slot = yard.take(below.map_or(side, |s| s.side), least, &wing);
        for (room, b) in wing.boxes {
            let (x0, x1) = if slot.side == 0 { (b.x0, b.x1) } else { (-w - b.x1, -w - b.x0) };
            layout.boxes.push((room, Cellbox::new(x0, b.y0 + slot.at, x1, b.y1 + slot.at)));
        }
        (low, high) = (low.min(slot.at + slot.south), high.max(slot.at + slot.north));
        layout.comb.slots.push(slot);
    }
    if let Some((stairs, width)) = core.and_then(|c| c.far) {
        // across from the first stairs' end of the spine, clear of the last wing
        let free = yard.next[1 - first] - yard.courtyard + up(SLACK_M);
        let from = given.and_then(|c| c.far).unwrap_or_else(|| free.max(high - width));
        layout.misfit += meters((free - up(SLACK_M) - from).max(0));
        let frame = core_frame(first, w);
        let depth = core.map_or(0, |c| c.depth);
        layout.boxes.push((stairs, frame.place(from, from + width, 0, depth)));
        layout.comb.far = Some(from);
        high = high.max(from + width);
    }
    layout.boxes.push((spine, Cellbox::new(-w, low, 0, high)));
    layout
}

/// Deals the rooms out to wings: what must adjoin stays together, what should be near does where it can, the wings are
/// of one size, and public rooms come first, where the entrance is. The units of a building have wings of their own, unless
/// their number is `given`.
fn partition(brief: &Brief, count: usize, given: bool, rng: &mut Stream) -> Vec<Vec<usize>> {
    let mut clusters = clusters(brief);
    rng.shuffle(&mut clusters);
    clusters.sort_by_cached_key(|c| (c.unit, rank(brief, c, rng)));
    let units = || clusters.chunk_by(|a, b| given || a.unit == b.unit);
    let whole = units().count() == 1;
    let mut wing_of: Vec<usize> = Vec::with_capacity(clusters.len());
    let mut wings_before = 0;
    for unit in units() {
        let rooms: usize = unit.iter().map(|c| c.rooms.len()).sum();
        let count = if whole { count } else { rooms.div_ceil(WHOLE_UNIT) };
        let mean = unit.iter().map(|c| c.front).sum::<f64>() / count as f64;
        let mut before = 0.0;
        for cluster in unit {
            wing_of.push(wings_before + (((before + cluster.front / 2.0) / mean) as usize).min(count - 1));
            before += cluster.front;
        }
        wings_before += count;
    }
    let count = wings_before;
    let mean = clusters.iter().map(|c| c.front).sum::<f64>() / count as f64;
    improve(brief, &clusters, &mut wing_of, (count, mean), rng);
    share_stations(brief, &clusters, &mut wing_of, count);
    let mut wings = vec![Vec::new(); count];
    for (cluster, wing) in clusters.iter().zip(wing_of) {
        wings[wing].extend_from_slice(&cluster.rooms);
    }
    wings
}

/// Moves clusters between wings while fewer wishes are cut and the wings stay of one size.
fn improve(brief: &Brief, clusters: &[Cluster], wing_of: &mut [usize], (count, mean): (usize, f64), rng: &mut Stream) {
    let mut cluster_of = vec![usize::MAX; brief.rooms.len()];
    for (c, cluster) in clusters.iter().enumerate() {
        cluster.rooms.iter().for_each(|&r| cluster_of[r] = c);
    }
    let mut wishes: Vec<Vec<usize>> = vec![Vec::new(); clusters.len()];
    for link in brief.links.iter().filter(|l| !l.required || l.connector == Connector::Near) {
        let (a, b) = (cluster_of[link.a], cluster_of[link.b]);
        if a != b && a != usize::MAX && b != usize::MAX {
            wishes[a].push(b);
            wishes[b].push(a);
        }
    }
    let mut home = vec![None; count];
    clusters.iter().zip(&*wing_of).for_each(|(c, &w)| home[w] = c.unit);
    let mut load = vec![0.0; count];
    clusters.iter().zip(&*wing_of).for_each(|(c, &w)| load[w] += c.front);
    let uneven = |load: f64| 6.0 * (load / mean - 1.0).powi(2);
    // of a hundred stores that are wished near one kitchen, few can be
    let crowd = |c: usize, o: usize| wishes[c].len().max(wishes[o].len());
    let weight = |c: usize, o: usize| (NEIGHBORS / crowd(c, o) as f64).min(1.0);
    for _ in 0..CHANGES * clusters.len() {
        let (c, to) = (rng.below(clusters.len()), rng.below(count));
        let from = wing_of[c];
        // A near neighbor in rank is exchanged, or the cluster moves alone.
        let swap = Some((c + 1 + rng.below(6)) % clusters.len()).filter(|&d| d != c && rng.chance(0.5));
        let to = swap.map_or(to, |d| wing_of[d]);
        let apart = |d: usize| clusters[d].unit != clusters[c].unit;
        if to == from || swap.is_some_and(apart) || swap.is_none() && home[to] != clusters[c].unit {
            continue;
        }
        let cut = |wing_of: &[usize]| -> f64 {
            let of = |c: usize| -> f64 {
                wishes[c].iter().filter(|&&o| wing_of[o] != wing_of[c]).map(|&o| weight(c, o)).sum()
            };
            of(c) + swap.map_or(0.0, of)
        };
        let gain = clusters[c].front - swap.map_or(0.0, |d| clusters[d].front);
        let sizes = |change: f64| uneven(load[from] - change) + uneven(load[to] + change);
        let before = cut(wing_of) + sizes(0.0);
        let exchange = |wing_of: &mut [usize], c_to: usize, d_to: usize| {
            wing_of[c] = c_to;
            if let Some(d) = swap {
                wing_of[d] = d_to;
            }
        };
        exchange(wing_of, to, from);
        if cut(wing_of) + sizes(gain) < before {
            load[from] -= gain;
            load[to] += gain;
        } else {
            exchange(wing_of, from, to);
        }
    }
}

/// Puts each station into the wing of its unit where the most beds have the fewest stations: nobody is watched from another wing.
fn share_stations(brief: &Brief, clusters: &[Cluster], wing_of: &mut [usize], count: usize) {
    let is_station = |&room: &usize| brief.rooms[room].zone == Zone::Staff && brief.rooms[room].open_front;
    let sleeps = |room: &&usize| brief.rooms[**room].zone == Zone::Night;
    let mut stations = vec![0; count];
    for c in (0..clusters.len()).filter(|&c| clusters[c].rooms.iter().any(is_station)) {
        let mut beds = vec![0; count];
        for (other, &wing) in clusters.iter().zip(&*wing_of).filter(|(other, _)| other.unit == clusters[c].unit) {
            beds[wing] += other.rooms.iter().filter(sleeps).count();
        }
        // beds to each station, had the wing one more; of equal ones where it is
        let share =
            |&wing: &usize| (beds[wing] * clusters.len() / (stations[wing] + 1), wing == wing_of[c], count - wing);
        let Some(best) = (0..count).max_by_key(share).filter(|&wing| beds[wing] > 0) else { continue };
        wing_of[c] = best;
        stations[best] += 1;
    }
}

/// Returns the rooms in clusters of those that must adjoin.
fn clusters(brief: &Brief) -> Vec<Cluster> {
    fn root(leader: &mut [usize], mut i: usize) -> usize {
        while leader[i] != i {
            leader[i] = leader[leader[i]];
            i = leader[i];
        }
        i
    }
    let n = brief.rooms.len();
    let mut leader: Vec<usize> = (0..n).collect();
    let hard = brief.links.iter().filter(|l| l.required && l.connector != Connector::Near).map(|l| (l.a, l.b));
    let hosted = brief.rooms.iter().enumerate().filter_map(|(i, r)| r.host.map(|h| (i, h)));
    for (a, b) in hard.chain(hosted).filter(|(a, b)| Some(*a) != brief.spine && Some(*b) != brief.spine) {
        let (a, b) = (root(&mut leader, a), root(&mut leader, b));
        leader[a.max(b)] = a.min(b);
    }
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); n];
    for room in (0..n).filter(|i| Some(*i) != brief.spine && !brief.in_core(*i)) {
        members[root(&mut leader, room)].push(room);
    }
    let front = |rooms: &[usize]| rooms.iter().map(|&r| 0.8 + brief.rooms[r].area_target / USUAL_DEPTH_M).sum();
    let unit = |rooms: &[usize]| rooms.iter().find_map(|&r| brief.rooms[r].unit);
    let used = members.into_iter().filter(|m| !m.is_empty());
    used.map(|rooms| Cluster { front: front(&rooms), unit: unit(&rooms), rooms }).collect()
}

/// Returns where a cluster belongs along the way from the entrance; service rooms belong everywhere.
fn rank(brief: &Brief, cluster: &Cluster, rng: &mut Stream) -> usize {
    let of = |room: usize| match brief.rooms[room].zone {
        Zone::Public => 1,
        Zone::Day => 2,
        Zone::Staff => 3,
        Zone::Outdoor | Zone::Night => 4,
        Zone::Circulation | Zone::Service => 1 + rng.below(4),
    };
    // what the cluster is about is its largest room
    let largest = cluster
        .rooms
        .iter()
        .copied()
        .max_by(|&a, &b| brief.rooms[a].area_target.total_cmp(&brief.rooms[b].area_target));
    let entered = cluster.rooms.iter().any(|&r| brief.rooms[r].entrance);
    if entered { 0 } else { largest.map_or(4, of) }
}
