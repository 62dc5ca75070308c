//! Which room goes on which storey, and the stairs and elevators that join them.

use d3dgen_knowledge::jurisdiction;
use d3dgen_model::domain::{Access, Domain, GENERIC_ROOM_TYPE, RoomType, Shape, Storeys as Rules, TwoStairs, Zone};
use d3dgen_model::offer;
use d3dgen_model::offer::sleeps;
use d3dgen_model::scene_graph::{BY_CIRCULATION, Connector, GraphEdge, GraphRoom, Note};
use d3dgen_model::storeys::{LinkKind, VerticalLink};

use super::carry;
use crate::built::edges::{self, Web};
use crate::built::planned::Planned;
use crate::built::rooms;
use crate::reading::Reading;
use crate::subject::programs::is_dwelling;
use crate::tokens::storey::Where;

/// How much fuller than the mean a storey gets with what belongs there.
const FULL: f64 = 1.3;
/// How much larger than the one below a storey may be before rooms move down.
const LARGER: f64 = 1.15;
/// How far areas are scaled so that storeys carry each other.
const LEAST_SCALE: f64 = 0.8;
const MOST_SCALE: f64 = 1.3;
/// How much larger than the one above a storey of a building of units may be for that one to grow with it.
const MOST_SPREAD: f64 = 1.2;
/// How much larger a storey of a home may be than the one below, and how often areas are scaled until it is not.
const EVEN: f64 = 0.01;
const ROUNDS: usize = 4;
/// Rooms of a storey from which on a building has two stairs whatever its domain says.
const TWO_STAIRS: usize = 16;
/// The least floor of such a storey beside its corridor, m^2: on less all rooms are within 35 m of one stair (ASR A2.3).
const TWO_STAIRS_M2: f64 = 300.0;
/// Rooms of a storey that two stairs stand at the ends of, where the prompt or a rule asks for two; and those of a storey of large
/// rooms, with their floor, m^2.
const LEAST_FOR_TWO: usize = 6;
const LEAST_LARGE: usize = 3;
const LARGE_ROOMS_M2: f64 = 120.0;

/// Ids of the elevators of a building, as many as stand in one core.
const LIFTS: [&str; 4] = ["elevator_a", "elevator_b", "elevator_c", "elevator_d"];

/// Rooms that stay together, with the storey they must or would be on.
pub(super) struct Cluster<'p> {
    rooms: Vec<usize>,
    /// Unit of a large building that they belong to.
    unit: Option<&'p str>,
    pub area: f64,
    fixed: Option<i32>,
    pub likes: Likes,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Likes {
    Ground,
    Upper,
    Each,
    Any,
}

/// Returns the storeys to plan: those of the prompt, where the domain knows stairs.
pub(crate) fn levels(reading: &mut Reading) -> Vec<i32> {
    let levels = reading.storeys.levels.clone();
    if levels.len() > 1 && reading.domain.circulation.storeys.is_none() {
        let message = format!(
            "{} storeys were asked for; domain {} says nothing of stairs, so all rooms were planned on one",
            levels.len(),
            reading.domain.id
        );
        reading.conflicts.push(Note::new("one_floor", message));
        return vec![0];
    }
    levels
}

/// Returns the storey of each room.
pub(crate) fn deal(reading: &mut Reading, planned: &[Planned], areas: &[f64], levels: &[i32]) -> Vec<i32> {
    let Some(rules) = reading.domain.circulation.storeys.as_ref().filter(|_| levels.len() > 1) else {
        return vec![0; planned.len()];
    };
    let fixed = fixed_levels(reading, planned, levels);
    let mut clusters = clusters(reading, rules, planned, areas, &fixed);
    let mut at: Vec<Option<i32>> = clusters.iter().map(|c| c.fixed).collect();
    let told: Vec<bool> = at.iter().map(Option::is_some).collect();
    let above: Vec<i32> = levels.iter().copied().filter(|l| *l >= 0).collect();
    let total: f64 = clusters.iter().map(|c| c.area).sum();
    let mean = total / above.len() as f64;
    let load = |at: &[Option<i32>], clusters: &[Cluster], level: i32| -> f64 {
        clusters.iter().zip(at).filter(|(_, l)| **l == Some(level)).map(|(c, _)| c.area).sum()
    };
    let open = |at: &[Option<i32>], likes: Likes, clusters: &[Cluster]| -> Vec<usize> {
        (0..clusters.len()).filter(|&i| at[i].is_none() && clusters[i].likes == likes).collect()
    };
    let units = units(&clusters, &at);
    // as many on each: a storey that is a unit keeps what it needs at hand
    let own_storeys = !units.is_empty() && units.len().is_multiple_of(above.len());
    let each = units.len() / above.len();
    for (n, unit) in units.into_iter().enumerate() {
        let fits = |l: &&i32| load(&at, &clusters, **l) + 0.5 * unit.area <= mean;
        let level = if own_storeys { above.get(n / each) } else { above.iter().find(fits) }.copied();
        let level = level.unwrap_or_else(|| least_loaded(&above, |l| load(&at, &clusters, l)));
        for i in unit.clusters {
            at[i] = Some(level);
            clusters[i].fixed = clusters[i].fixed.or(own_storeys.then_some(level));
        }
    }
    let lives = is_dwelling(reading.program);
    let mut ground = open(&at, Likes::Ground, &clusters);
    if !lives {
        // the lobby before the seventh gallery
        let alike =
            |i: usize| planned.iter().filter(|p| p.room_type == planned[clusters[i].rooms[0]].room_type).count();
        ground.sort_by_cached_key(|&i| alike(i));
    }
    for i in ground {
        let full =
            |l: i32| load(&at, &clusters, l) > 0.0 && load(&at, &clusters, l) + 0.5 * clusters[i].area > FULL * mean;
        let next = if lives { None } else { above[1..].iter().copied().find(|l| !full(*l)) };
        let next = next.or(above.get(1).copied()).unwrap_or(0);
        at[i] = Some(if full(0) { next } else { 0 });
    }
    // a home has its bedrooms on all upper storeys alike
    let up: f64 = clusters
        .iter()
        .zip(&at)
        .filter(|(c, l)| l.map_or(c.likes == Likes::Upper, |l| l > 0))
        .map(|(c, _)| c.area)
        .sum();
    let shared = up / (above.len() - 1).max(1) as f64;
    let most = if lives { mean.min(shared) } else { mean };
    for i in open(&at, Likes::Upper, &clusters) {
        // one storey after the other, so that what is alike stays together
        let free = above.iter().skip(1).find(|&&l| load(&at, &clusters, l) + 0.5 * clusters[i].area <= most);
        // one of a few large rooms rather stands on the ground floor than two of them on one storey
        let large = !lives && clusters[i].area > 0.5 * mean;
        let least = || least_loaded(&above[usize::from(!large)..], |l| load(&at, &clusters, l));
        at[i] = Some(free.copied().unwrap_or_else(least));
    }
    for i in open(&at, Likes::Each, &clusters) {
        let room = &planned[clusters[i].rooms[0]];
        // toilets of every kind are one
        let alike = |other: &Planned| {
            other.room_type == room.room_type
                || [other, room].iter().all(|r| r.kind.access != Access::Host && reading.wet.has_toilet(r.kind))
        };
        let same =
            |l: i32| clusters.iter().zip(&at).filter(|(c, a)| **a == Some(l) && alike(&planned[c.rooms[0]])).count();
        let sleeps = |l: i32| {
            let here = clusters.iter().zip(&at).filter(|(_, a)| **a == Some(l)).flat_map(|(c, _)| &c.rooms);
            here.into_iter().any(|&r| planned[r].kind.zone == Zone::Night)
        };
        let wet = |l: i32| {
            let here = clusters.iter().zip(&at).filter(|(_, a)| **a == Some(l)).flat_map(|(c, _)| &c.rooms);
            here.filter(|&&r| planned[r].kind.wet).count()
        };
        let best = above.iter().copied().min_by_key(|&l| (same(l), wet(l), !sleeps(l), l));
        at[i] = best;
    }
    let mut rest = open(&at, Likes::Any, &clusters);
    rest.sort_by(|a, b| clusters[*b].area.total_cmp(&clusters[*a].area));
    for i in rest {
        at[i] = Some(least_loaded(&above, |l| load(&at, &clusters, l)));
    }
    let used: Vec<bool> = clusters.iter().map(|c| c.rooms.iter().any(|&r| is_used(planned[r].kind))).collect();
    settle(&mut at, &mut clusters, (&above, &used), &load);
    let moved = carry::stand_on_ground(&mut at, &clusters, (&above, &used), &load);
    for (i, to) in moved.into_iter().filter(|(i, _)| told[*i]) {
        let names: Vec<&str> = clusters[i].rooms.iter().map(|&r| planned[r].kind.label.as_str()).collect();
        let names = names.join(", ").to_lowercase();
        let message = format!("{names}: asked for on a storey that nothing would carry; planned on level {to}");
        reading.conflicts.push(Note::new("other_storey", message));
    }
    let mut out = vec![0; planned.len()];
    for (cluster, level) in clusters.iter().zip(at) {
        cluster.rooms.iter().for_each(|&r| out[r] = level.unwrap_or(0));
    }
    out
}

/// What of a unit is still free.
struct Unit<'p> {
    id: &'p str,
    clusters: Vec<usize>,
    area: f64,
}

/// Returns the units as they are to stand above each other: the first one below, then those that people come to by day.
fn units<'p>(clusters: &[Cluster<'p>], at: &[Option<i32>]) -> Vec<Unit<'p>> {
    let mut out: Vec<Unit> = Vec::new();
    for (i, cluster) in clusters.iter().enumerate().filter(|(i, _)| at[*i].is_none()) {
        let Some(id) = cluster.unit else { continue };
        match out.iter_mut().find(|u| u.id == id) {
            Some(known) => {
                known.clusters.push(i);
                known.area += cluster.area;
            }
            None => out.push(Unit { id, clusters: vec![i], area: cluster.area }),
        }
    }
    let ground = |unit: &Unit| {
        let below = unit.clusters.iter().filter(|&&c| clusters[c].likes == Likes::Ground);
        below.map(|&c| clusters[c].area).sum::<f64>() / unit.area.max(1.0)
    };
    if let Some((_, others)) = out.split_first_mut() {
        others.sort_by(|a, b| ground(b).total_cmp(&ground(a)));
    }
    out
}

fn least_loaded(levels: &[i32], load: impl Fn(i32) -> f64) -> i32 {
    levels.iter().copied().min_by(|a, b| load(*a).total_cmp(&load(*b))).unwrap_or(0)
}

/// Makes the rooms of a storey larger and those above it smaller where the upper one would jut out, within what their types
/// and the prompt allow.
pub(crate) fn even_out(planned: &[Planned], rooms: &mut [GraphRoom], levels: &[i32], lives: bool) {
    let above: Vec<i32> = levels.iter().copied().filter(|l| *l >= 0).collect();
    // from the top down: what a storey carries is settled before it is asked to carry it
    for pair in above.windows(2).rev() {
        for _ in 0..if lives { ROUNDS } else { 1 } {
            let (lower, upper) = (area_on(rooms, pair[0]), area_on(rooms, pair[1]));
            if upper <= lower * if lives { 1.0 + EVEN } else { 1.0 } || lower <= 0.0 {
                break;
            }
            let middle = 0.5 * (lower + upper);
            for (level, factor) in [(pair[0], middle / lower), (pair[1], middle / upper)] {
                scale(planned, rooms, level, factor.clamp(LEAST_SCALE, MOST_SCALE), lives);
            }
        }
    }
    for pair in above.windows(2).rev() {
        carry::grow(planned, rooms, (pair[0], pair[1]));
    }
    // a storey that is a unit is to leave no roof beside its corridor
    for pair in above.windows(2).filter(|_| !lives && planned.iter().any(|p| p.unit.is_some())) {
        let (lower, upper) = (area_on(rooms, pair[0]), area_on(rooms, pair[1]));
        if upper > 0.0 && (1.0..MOST_SPREAD).contains(&(lower / upper)) {
            scale(planned, rooms, pair[1], lower / upper, lives);
        }
    }
}

/// Returns the areas that the rooms of a storey are to have together, net m^2.
pub(super) fn area_on(rooms: &[GraphRoom], level: i32) -> f64 {
    rooms.iter().filter(|r| r.level == level).map(|r| r.target_area_m2).sum()
}

/// Scales the rooms of a storey whose areas neither the prompt nor their people fix, within what their types allow.
fn scale(planned: &[Planned], rooms: &mut [GraphRoom], level: i32, factor: f64, lives: bool) {
    // rooms for so many people may have more floor, never less
    let free =
        planned.iter().zip(rooms).filter(|(p, _)| p.area_m2.is_none() && (p.people_area_m2.is_none() || factor > 1.0));
    for (p, room) in free.filter(|(_, r)| r.level == level) {
        let [min, max] = room.area_range_m2;
        // nobody wants a garage as large as the bedrooms above it
        let serves = lives && p.kind.zone == Zone::Service;
        let most = if serves { (0.9 * max).min(rooms::MOST_TO_SERVE * p.kind.area_m2.target) } else { 0.9 * max };
        let (low, high) = (room.target_area_m2.min(1.08 * min), room.target_area_m2.max(most));
        room.target_area_m2 = (room.target_area_m2 * factor * 10.0).round().clamp(10.0 * low, 10.0 * high) / 10.0;
    }
}

/// Moves rooms down from storeys that would jut out over the one below, and into storeys without rooms.
fn settle(at: &mut [Option<i32>], clusters: &mut [Cluster], (above, used): (&[i32], &[bool]), load: &Load<'_>) {
    for _ in 0..clusters.len() {
        let empty = above.iter().copied().find(|&l| !is_in_use(at, used, l));
        let heavy = above.windows(2).find(|w| load(at, clusters, w[1]) > LARGER * load(at, clusters, w[0]));
        let (from, to) = match (empty, heavy) {
            (Some(to), _) => {
                let most =
                    above.iter().copied().max_by(|a, b| load(at, clusters, *a).total_cmp(&load(at, clusters, *b)));
                (most.unwrap_or(0), to)
            }
            (None, Some(w)) => (w[1], w[0]),
            (None, None) => return,
        };
        let gap = load(at, clusters, from) - load(at, clusters, to);
        let movable = (0..clusters.len()).filter(|&i| {
            let several = at.iter().filter(|l| **l == Some(from)).count() > 1;
            // what every storey has is not there by chance
            let free = clusters[i].fixed.is_none() && clusters[i].likes != Likes::Each;
            at[i] == Some(from) && free && clusters[i].area < gap && several
        });
        // what has no reason to be there goes first, and the piece that evens out best
        let best = movable.min_by(|&a, &b| {
            let key = |i: usize| (clusters[i].likes != Likes::Any, (clusters[i].area - gap / 2.0).abs());
            let (x, y) = (key(a), key(b));
            x.0.cmp(&y.0).then(x.1.total_cmp(&y.1))
        });
        let Some(i) = best else { return };
        at[i] = Some(to);
        clusters[i].fixed = Some(to);
    }
}

/// Adds up the areas of a storey.
pub(super) type Load<'f> = dyn Fn(&[Option<i32>], &[Cluster], i32) -> f64 + 'f;

/// Returns true for rooms that a storey is there for: all but those that serve others.
pub(super) fn is_used(kind: &RoomType) -> bool {
    !kind.wet && matches!(kind.zone, Zone::Day | Zone::Night | Zone::Public | Zone::Staff)
}

/// Returns true for a storey with a room that it is there for.
fn is_in_use(at: &[Option<i32>], used: &[bool], level: i32) -> bool {
    at.iter().zip(used).any(|(l, used)| *used && *l == Some(level))
}

/// Returns the storey of each room that the prompt puts on one.
fn fixed_levels(reading: &mut Reading, planned: &[Planned], levels: &[i32]) -> Vec<Option<i32>> {
    let mut fixed: Vec<Option<i32>> = vec![None; planned.len()];
    let mut short = Vec::new();
    // "on the second a bedroom with its own bathroom": that bathroom is entered from the bedroom there
    let wants = |room_type: &str, n: i32| {
        let mut wanted = reading.storeys.wanted.iter();
        wanted.any(|w| w.room_type == room_type && w.at == Where::Level(n))
    };
    let mut ahead: Vec<usize> = Vec::new();
    for wanted in &reading.storeys.wanted {
        let Where::Level(n) = wanted.at else { continue };
        let hung = |i: &usize| planned[*i].room_type == wanted.room_type && fixed[*i].is_none();
        let guests: Vec<usize> = (0..planned.len()).filter(hung).take(wanted.count as usize).collect();
        for i in guests {
            if let Some(host) = planned[i].host.filter(|&h| fixed[h].is_none() && wants(&planned[h].room_type, n)) {
                (fixed[i], fixed[host]) = (Some(n), Some(n));
                ahead.extend([i, host]);
            }
        }
    }
    for wanted in &reading.storeys.wanted {
        let upper: Vec<i32> = levels.iter().copied().filter(|l| *l > 0).collect();
        let targets: Vec<i32> = match wanted.at {
            Where::Level(n) => vec![n],
            Where::Upper => upper,
            Where::Each => levels.iter().copied().filter(|l| *l >= 0).collect(),
            Where::Nth(_) | Where::Top => continue,
        };
        let each = matches!(wanted.at, Where::Each);
        let count = if each { wanted.count as usize * targets.len() } else { wanted.count as usize };
        let mut rest = count;
        ahead.retain(|&i| {
            let here = rest > 0 && planned[i].room_type == wanted.room_type && fixed[i].is_some_and(|l| targets == [l]);
            rest -= usize::from(here);
            !here
        });
        let count = rest;
        let open: Vec<usize> =
            (0..planned.len()).filter(|&i| planned[i].room_type == wanted.room_type && fixed[i].is_none()).collect();
        if open.len() < count {
            short.push(wanted.room_type.clone());
        }
        for (k, &i) in open.iter().take(count).enumerate() {
            let share =
                if each { k / wanted.count.max(1) as usize } else { k * targets.len() / count.min(open.len()).max(1) };
            fixed[i] = targets.get(share).copied();
        }
    }
    for room_type in short {
        let message = format!("fewer rooms of type {room_type} were planned than the prompt puts on its storeys");
        reading.conflicts.push(Note::new("fewer_than_on_storeys", message));
    }
    fixed
}

/// Returns the rooms in clusters: what hangs on a room, and what the prompt wants beside it, stays with it.
fn clusters<'p>(
    reading: &Reading,
    rules: &Rules,
    planned: &'p [Planned],
    areas: &[f64],
    fixed: &[Option<i32>],
) -> Vec<Cluster<'p>> {
    let mut leader: Vec<usize> = (0..planned.len()).collect();
    fn root(leader: &[usize], mut i: usize) -> usize {
        while leader[i] != i {
            i = leader[i];
        }
        i
    }
    let mut join = |a: usize, b: usize| {
        let (a, b) = (root(&leader, a), root(&leader, b));
        leader[a.max(b)] = a.min(b);
    };
    for (i, room) in planned.iter().enumerate() {
        if let Some(host) = room.host {
            join(i, host);
        }
    }
    let of = |kind: &str| (0..planned.len()).filter(|&i| planned[i].room_type == kind).collect::<Vec<usize>>();
    for pair in reading.wishes.pairs.iter().filter(|p| p.connector != Connector::Near) {
        let (a, b) = (of(&pair.a), of(&pair.b));
        for (k, &i) in a.iter().enumerate() {
            if let Some(&j) = b.get(k * b.len().min(a.len()) / a.len().max(1)) {
                let apart = fixed[i].is_some() && fixed[j].is_some() && fixed[i] != fixed[j];
                if i != j && !apart {
                    join(i, j);
                }
            }
        }
    }
    let mut out: Vec<Cluster> = Vec::new();
    for first in (0..planned.len()).filter(|&i| root(&leader, i) == i) {
        let rooms: Vec<usize> = (0..planned.len()).filter(|&i| root(&leader, i) == first).collect();
        let main = rooms.iter().copied().max_by(|a, b| areas[*a].total_cmp(&areas[*b])).unwrap_or(first);
        let entrance = &reading.domain.circulation.entrance_room_types;
        let has = |list: &[String]| rooms.iter().any(|&r| list.contains(&planned[r].room_type));
        // what nobody knows is entered from the street rather than past the bedrooms: a workshop, a place for prams
        let unknown = rooms.iter().any(|&r| {
            planned[r].kind.id == GENERIC_ROOM_TYPE && planned[r].room_type != GENERIC_ROOM_TYPE && planned[r].requested
        });
        let by_entrance = has(&reading.wishes.by_entrance);
        let likes =
            if has(&rules.ground_room_types) || has(entrance) || by_entrance || unknown && is_dwelling(reading.program)
            {
                Likes::Ground
            } else if has(&rules.each_level_room_types) && rooms.len() == 1 {
                Likes::Each
            } else if rules.upper_room_types.contains(&planned[main].room_type) {
                Likes::Upper
            } else {
                match planned[main].kind.zone {
                    Zone::Public => Likes::Ground,
                    Zone::Night => Likes::Upper,
                    _ => Likes::Any,
                }
            };
        let area = rooms.iter().map(|&r| areas[r]).sum();
        let at_street = rooms.iter().any(|&r| comes_from_street(reading.domain, planned[r].kind));
        let fixed = rooms.iter().find_map(|&r| fixed[r]).or_else(|| at_street.then_some(0));
        let unit = planned[main].unit.as_deref();
        out.push(Cluster { rooms, unit, area, fixed, likes });
    }
    out
}

/// Returns true for rooms that vehicles stand in, or that have a door of their own for what comes from the street.
fn comes_from_street(domain: &Domain, kind: &RoomType) -> bool {
    kind.outdoor_door_m.is_some() || offer::has_shape(domain, kind, &[Shape::Vehicle])
}

/// Connects the rooms of each storey and joins the storeys.
pub(crate) fn connect(
    reading: &mut Reading,
    planned: &[Planned],
    rooms: Vec<GraphRoom>,
    levels: &[i32],
) -> (Vec<GraphRoom>, Web, Vec<VerticalLink>) {
    let mut web = Web::default();
    let mut out: Vec<GraphRoom> = Vec::new();
    let corridors: Vec<GraphRoom> = levels.iter().enumerate().map(|(i, &l)| corridor(reading, i, l)).collect();
    let stays: Vec<usize> = (0..rooms.len()).collect();
    let mut halls: Vec<GraphRoom> = Vec::new();
    for (&level, corridor) in levels.iter().zip(corridors) {
        let here: Vec<usize> = stays.iter().copied().filter(|&i| rooms[i].level == level).collect();
        let index = |i: usize| here.iter().position(|&h| h == i);
        let part: Vec<Planned> =
            here.iter().map(|&i| Planned { host: planned[i].host.and_then(index), ..planned[i].clone() }).collect();
        let mut storey: Vec<GraphRoom> = here.iter().map(|&i| rooms[i].clone()).collect();
        let found = edges::connect_storey(reading, &part, &mut storey, corridor, level == 0);
        halls.extend(storey.pop());
        web.edges.extend(found.edges);
        web.apart.extend(found.apart);
        for room in storey {
            out.push(room);
        }
    }
    let order = |id: &str| rooms.iter().position(|r| r.id == id);
    out.sort_by_key(|r| order(&r.id));
    let links = links(reading, &mut halls, levels, &out, &mut web);
    out.extend(halls);
    (out, web, links)
}

/// Returns a rule of the building's country by which it has two stairs; without a country, one that holds everywhere.
fn two_stairs<'r>(reading: &Reading, rules: &'r Rules, rooms: &[GraphRoom]) -> Option<&'r TwoStairs> {
    let domain = reading.domain;
    let storeys = reading.storeys.above_ground() as u32;
    let country = reading.country_code.as_deref();
    let people = |room: &GraphRoom| {
        let kind = domain.room_type_or_generic(&room.room_type);
        let usual = || sleeps(domain, kind).or_else(|| offer::desks(domain, kind)).map(|n| n[0]);
        room.occupants.or_else(usual).unwrap_or_else(|| offer::seated_in(domain, kind, room.target_area_m2))
    };
    let speaks = |rule: &&TwoStairs| {
        let storey = |level: i32| {
            let here = || rooms.iter().filter(move |r| r.level == level);
            let asleep = || here().any(|r| domain.room_type_or_generic(&r.room_type).zone == Zone::Night);
            rule.from_area_m2.is_none_or(|least| here().map(|r| r.target_area_m2).sum::<f64>() >= least)
                && rule.from_people.is_none_or(|least| here().map(people).sum::<u32>() >= least)
                && (!rule.asleep || asleep())
        };
        jurisdiction::holds(&rule.jurisdictions, country)
            && rule.from_storeys.is_none_or(|least| storeys >= least)
            && reading.storeys.levels.iter().any(|&level| level != 0 && storey(level))
    };
    rules.two_stairs.iter().find(speaks)
}

fn corridor(reading: &Reading, i: usize, level: i32) -> GraphRoom {
    let mut room = rooms::circulation(reading);
    room.id = format!("{}_{}", room.room_type, i + 1);
    room.name = format!("{} {}", room.name, i + 1);
    room.level = level;
    room
}

/// Returns what is said of an elevator that nobody asked for.
fn added_elevator(reading: &Reading, room_type: &str, usual: bool) -> Option<Note> {
    let why = if usual { "as buildings of so many storeys have one" } else { "for access without steps" };
    let asked = reading.storeys.elevator.is_some() || reading.wishes.wishes.iter().any(|w| w.room_type == room_type);
    (!asked).then(|| Note::new("elevator_added", format!("an elevator was added, {why}")))
}

/// Adds stairs, and an elevator where the building needs one, beside the corridor of every storey.
fn links(
    reading: &mut Reading,
    halls: &mut Vec<GraphRoom>,
    levels: &[i32],
    rooms: &[GraphRoom],
    web: &mut Web,
) -> Vec<VerticalLink> {
    let domain: &Domain = reading.domain;
    let Some(rules) = &domain.circulation.storeys else { return Vec::new() };
    let here = |level: i32| rooms.iter().filter(move |r| r.level == level);
    let most = levels.iter().map(|l| here(*l).count()).max().unwrap_or(0);
    // many small rooms are no long way
    let large = levels
        .iter()
        .any(|l| here(*l).count() >= TWO_STAIRS && here(*l).map(|r| r.target_area_m2).sum::<f64>() >= TWO_STAIRS_M2);
    let mut wanted = vec![(LinkKind::Stairs, &rules.stairs.room_type, "stairs_a")];
    let asked = reading.storeys.stairs;
    let ruled = two_stairs(reading, rules, rooms);
    let along =
        |level: i32| here(level).filter(|r| domain.room_type_or_generic(&r.room_type).access != Access::Host).count();
    let longest = levels.iter().map(|l| along(*l)).max().unwrap_or(0);
    let spacious = |level: i32| here(level).map(|r| r.target_area_m2).sum::<f64>() >= LARGE_ROOMS_M2;
    let of_large = levels.iter().any(|l| along(*l) >= LEAST_LARGE && spacious(*l));
    let holds_two = if ruled.is_some() { longest >= LEAST_FOR_TWO || of_large } else { most >= LEAST_FOR_TWO };
    if large || (asked > 1 || ruled.is_some()) && holds_two {
        wanted.push((LinkKind::Stairs, &rules.stairs.room_type, "stairs_b"));
    } else if let Some(rule) = ruled {
        let message = format!(
            "the building needs two stairs ({}); on storeys of up to {longest} rooms they would be one beside the other, and one was planned",
            rule.source
        );
        reading.conflicts.push(Note::new("one_stair", message));
    }
    let planned = wanted.len() as u32;
    if asked > planned {
        let message =
            format!("{asked} staircases were asked for; storeys of up to {most} rooms were planned with {planned}");
        reading.conflicts.push(Note::new("fewer_stairs", message));
    }
    if let Some(elevator) = &rules.elevator {
        let usual = elevator.from_levels.is_some_and(|n| levels.len() >= n as usize);
        let lift = reading.storeys.elevator.unwrap_or(usual || reading.accessible);
        let asked = reading.storeys.lifts;
        if lift {
            let added = added_elevator(reading, &elevator.room_type, usual);
            reading.conflicts.extend(added);
            let planned = asked.clamp(1, LIFTS.len() as u32);
            wanted.extend(LIFTS[..planned as usize].iter().map(|id| (LinkKind::Elevator, &elevator.room_type, *id)));
            if asked > planned {
                let message =
                    format!("{asked} elevators were asked for; a core has room for {planned}, which were planned");
                reading.conflicts.push(Note::new("fewer_elevators", message));
            }
        } else if usual && !reading.accessible {
            let message =
                format!("the prompt wants no elevator, which a building of {} storeys usually has", levels.len());
            reading.assumptions.push(Note::new("no_elevator", message));
        }
        if !lift && !reading.robots.is_empty() {
            let message = "there is no elevator; robots stay on the storey they start on".to_owned();
            reading.assumptions.push(Note::new("robots_stay", message));
        }
    }
    let corridors: Vec<GraphRoom> = halls.clone();
    let mut out = Vec::new();
    for (kind, room_type, link_id) in wanted {
        let kind_of = domain.room_type_or_generic(room_type);
        let mut room_ids = Vec::new();
        for corridor in &corridors {
            let number = 1 + halls.iter().filter(|r| &r.room_type == room_type).count();
            let room = GraphRoom {
                id: format!("{room_type}_{number}"),
                room_type: room_type.clone(),
                name: kind_of.label.clone(),
                description: kind_of.description.clone(),
                target_area_m2: kind_of.area_m2.target,
                area_range_m2: [kind_of.area_m2.min, kind_of.area_m2.max],
                requested: kind == LinkKind::Elevator && reading.storeys.elevator == Some(true),
                entrance: false,
                wished_assets: Vec::new(),
                ..corridor.clone()
            };
            let connector = if kind_of.open_front { Connector::Open } else { Connector::Door };
            web.edges.push(GraphEdge {
                a: room.id.clone(),
                b: corridor.id.clone(),
                connector,
                required: true,
                reason: BY_CIRCULATION.into(),
            });
            room_ids.push(room.id.clone());
            halls.push(room);
        }
        out.push(VerticalLink { link_id: link_id.into(), kind, room_ids });
    }
    out
}
