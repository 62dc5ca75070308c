//! Routes through a building: from door to door, and by stairs and lifts from storey to storey.
//!
//! Within a room each door knows its way to every other one, looked for once; a route is the cheapest chain of these. Who may
//! not enter a room goes around it.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

use d3dgen_model::Point;
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::storeys::LinkKind;

use crate::search::{Field, pull, search, shorten};
use crate::space::Space;

/// Time for a storey on stairs and in a lift with waiting, s: 0.25 m/s upward over 3.5 m (Fruin 1971), and doors and a stop.
pub const STAIRS_S: f64 = 14.0;
pub const LIFT_S: f64 = 12.0;
/// Distance that a second on stairs or in a lift is worth, m.
const M_PER_S: f64 = 1.2;
/// Distance of those who stand in a lift or on a landing, m.
const RIDERS_APART_M: f64 = 0.5;
/// Room around a place that any robot stands on, m.
const WIDE_M: f64 = 0.45;
/// Most who do.
const MOST_RIDERS: usize = 6;

/// A door, or the place in a stairwell or lift where one changes storeys.
struct Portal {
    level: usize,
    at: Point,
    rooms: Vec<usize>,
    /// The link, and which of its stops.
    stop: Option<(usize, usize)>,
}

/// Stairs or a lift.
pub struct Link {
    pub kind: LinkKind,
    /// By stop: index of the storey, and the places to stand there.
    pub stops: Vec<(usize, Vec<Point>)>,
}

/// A part of a route on one storey, and the link at its end.
#[derive(Debug, Clone)]
pub struct Leg {
    pub level: usize,
    pub way: Vec<Point>,
    /// Link and the stop it is left at.
    pub ride: Option<(usize, usize)>,
}

/// Who asks for a route.
pub struct Walker<'w> {
    /// By storey and room: may it be entered.
    pub allowed: &'w [Vec<bool>],
    pub stairs: bool,
}

type Stretch = Option<(f64, Vec<Point>)>;

/// Finds routes for walkers of one radius.
pub struct Router {
    radius: f64,
    portals: Vec<Portal>,
    of_room: BTreeMap<(usize, usize), Vec<usize>>,
    fields: BTreeMap<(usize, usize, usize), Field>,
    stretches: BTreeMap<(usize, usize, usize), Stretch>,
}

/// Returns the stairs and lifts of a building.
pub fn links(spaces: &[Space], plan: &Floorplan) -> Vec<Link> {
    let stop = |id: &String| {
        let level = plan.room(id)?.level;
        let at = spaces.iter().position(|s| s.level == level)?;
        let room = spaces[at].rooms.iter().position(|r| r == id)?;
        Some((at, slots(&spaces[at], room)))
    };
    let link = |link: &d3dgen_model::storeys::VerticalLink| Link {
        kind: link.kind,
        stops: link.room_ids.iter().filter_map(stop).filter(|(_, slots)| !slots.is_empty()).collect(),
    };
    plan.links.iter().map(link).collect()
}

/// Returns where people and robots stand in a stairwell or lift: on floor that one gets to from its door, where there is most
/// room first, and of that the farthest from the door.
fn slots(space: &Space, room: usize) -> Vec<Point> {
    let Some(door) = space.doors.iter().find(|d| d.rooms.contains(&room)) else { return Vec::new() };
    let radius = d3dgen_model::scenario::PERSON_RADIUS_M;
    let from = space.node(door.middle);
    let (field, _) = search(space, from, radius, |n| space.belongs(n, room), |_| false, f64::MAX);
    let mut all: Vec<(f64, usize)> = field.all().filter(|(_, n)| usize::from(space.zone(*n)) == room).collect();
    let wide = |n: usize| space.clear(n) >= WIDE_M;
    all.sort_by(|a, b| wide(b.1).cmp(&wide(a.1)).then(b.0.total_cmp(&a.0)).then(a.1.cmp(&b.1)));
    let mut out: Vec<Point> = Vec::new();
    for (_, n) in all {
        let p = space.point(n);
        if out.iter().all(|o| o.distance(p) >= RIDERS_APART_M) && out.len() < MOST_RIDERS {
            out.push(p);
        }
    }
    out
}

impl Router {
    pub fn new(spaces: &[Space], links: &[Link], radius: f64) -> Self {
        let mut portals: Vec<Portal> = Vec::new();
        for (level, space) in spaces.iter().enumerate() {
            let wide = space.doors.iter().filter(|d| d.clear_width_m >= 2.0 * radius);
            portals.extend(wide.map(|d| Portal { level, at: d.middle, rooms: d.rooms.to_vec(), stop: None }));
        }
        for (k, link) in links.iter().enumerate() {
            for (s, (level, slots)) in link.stops.iter().enumerate() {
                let space = &spaces[*level];
                let Some(at) = slots.iter().copied().find(|p| space.clear(space.node(*p)) >= radius) else { continue };
                let rooms = space.room_at(at).into_iter().collect();
                portals.push(Portal { level: *level, at, rooms, stop: Some((k, s)) });
            }
        }
        let mut of_room: BTreeMap<(usize, usize), Vec<usize>> = BTreeMap::new();
        for (i, portal) in portals.iter().enumerate() {
            portal.rooms.iter().for_each(|r| of_room.entry((portal.level, *r)).or_default().push(i));
        }
        Self { radius, portals, of_room, fields: BTreeMap::new(), stretches: BTreeMap::new() }
    }

    /// Returns the route from one place to another; `None` where there is none for this walker.
    pub fn route(
        &mut self,
        (spaces, links): (&[Space], &[Link]),
        walker: &Walker,
        (from_level, from): (usize, Point),
        (to_level, to): (usize, Point),
    ) -> Option<Vec<Leg>> {
        let (a, b) = (spaces[from_level].room_at(from)?, spaces[to_level].room_at(to)?);
        if from_level == to_level
            && a == b
            && let Some((_, way)) = self.within(&spaces[from_level], a, from, to)
        {
            return Some(vec![Leg { level: from_level, way, ride: None }]);
        }
        let portals = self.chain((spaces, links), walker, (from_level, a, from), (to_level, b, to))?;
        self.legs(spaces, &portals, (from_level, a, from), (to_level, b, to))
    }

    /// Returns the way between two points of a room.
    fn within(&self, space: &Space, room: usize, from: Point, to: Point) -> Stretch {
        let (start, end) = (standing(space, room, from, self.radius)?, standing(space, room, to, self.radius)?);
        let may = |n: usize| space.belongs(n, room);
        let (field, found) = search(space, start, self.radius, may, |n| n == end, f64::MAX);
        let mut nodes = field.back(found?);
        nodes.reverse();
        Some((field.cost(end)?, ended(pull(space, &nodes, self.radius), from, to)))
    }

    /// Returns the field of a portal in one of its rooms.
    fn field(&mut self, space: &Space, portal: usize, level: usize, room: usize) -> &Field {
        let (at, radius) = (self.portals[portal].at, self.radius);
        self.fields.entry((portal, level, room)).or_insert_with(|| {
            let from = space.node(at);
            search(space, from, radius, |n| space.belongs(n, room), |_| false, f64::MAX).0
        })
    }

    /// Returns the way between two portals of a room.
    fn between(&mut self, space: &Space, level: usize, room: usize, a: usize, b: usize) -> &Stretch {
        let key = (room * 1000 + level, a.min(b), a.max(b));
        if !self.stretches.contains_key(&key) {
            let (target, radius) = (self.portals[key.2].at, self.radius);
            let field = self.field(space, key.1, level, room);
            let end = space.node(target);
            let found = field.cost(end).map(|cost| {
                let mut nodes = field.back(end);
                nodes.reverse();
                (cost, pull(space, &nodes, radius))
            });
            self.stretches.insert(key, found);
        }
        &self.stretches[&key]
    }

    /// Returns the portals of the cheapest route, each with the room that it is left into.
    fn chain(
        &mut self,
        (spaces, links): (&[Space], &[Link]),
        walker: &Walker,
        (from_level, a, from): (usize, usize, Point),
        (to_level, b, to): (usize, usize, Point),
    ) -> Option<Vec<usize>> {
        let mut best: BTreeMap<usize, (f64, Option<usize>)> = BTreeMap::new();
        let mut open: BinaryHeap<Reverse<(u64, usize)>> = BinaryHeap::new();
        let key = |cost: f64| (cost * 1e4) as u64;
        for portal in self.of_room.get(&(from_level, a)).cloned().unwrap_or_default() {
            let space = &spaces[from_level];
            let field = self.field(space, portal, from_level, a);
            let cost = field.nearest(space, from).and_then(|n| field.cost(n));
            if let Some(cost) = cost {
                best.insert(portal, (cost, None));
                open.push(Reverse((key(cost), portal)));
            }
        }
        let mut last: Option<(f64, usize)> = None;
        let mut done: BTreeSet<usize> = BTreeSet::new();
        while let Some(Reverse((_, p))) = open.pop() {
            if !done.insert(p) {
                continue;
            }
            let so_far = best[&p].0;
            if last.is_some_and(|(known, _)| known <= so_far) {
                break;
            }
            let level = self.portals[p].level;
            let mut next: Vec<(usize, f64)> = Vec::new();
            for room in self.portals[p].rooms.clone() {
                let space = &spaces[level];
                if level == to_level && room == b {
                    let field = self.field(space, p, level, room);
                    let cost = field.nearest(space, to).and_then(|n| field.cost(n));
                    if let Some(total) = cost.map(|c| c + so_far).filter(|t| last.is_none_or(|(known, _)| *t < known)) {
                        last = Some((total, p));
                    }
                }
                if !(walker.allowed[level][room] || level == from_level && room == a) {
                    continue;
                }
                // dead ends lead nowhere
                let others = self.of_room.get(&(level, room)).cloned().unwrap_or_default();
                for other in others.into_iter().filter(|o| *o != p && !done.contains(o)) {
                    let leads = self.portals[other].stop.is_some() || self.leads_on(other, level, room, (to_level, b));
                    if leads && let Some((cost, _)) = self.between(space, level, room, p, other) {
                        next.push((other, *cost));
                    }
                }
            }
            if let Some((link, stop)) = self.portals[p].stop {
                next.extend(self.rides(links, walker, link, stop));
            }
            for (other, step) in next {
                let cost = so_far + step;
                if best.get(&other).is_none_or(|(known, _)| cost < *known) {
                    best.insert(other, (cost, Some(p)));
                    open.push(Reverse((key(cost), other)));
                }
            }
        }
        let mut out = vec![last?.1];
        while let Some(before) = best[&out[out.len() - 1]].1 {
            out.push(before);
        }
        out.reverse();
        Some(out)
    }

    /// Returns true when the room behind a portal is the goal, or leads on.
    fn leads_on(&self, portal: usize, level: usize, room: usize, goal: (usize, usize)) -> bool {
        let behind = self.portals[portal].rooms.iter().filter(|r| **r != room);
        behind.into_iter().any(|r| (level, *r) == goal || self.of_room.get(&(level, *r)).is_some_and(|p| p.len() > 1))
    }

    /// Returns the other stops of a link, with what the way there costs.
    fn rides(&self, links: &[Link], walker: &Walker, link: usize, stop: usize) -> Vec<(usize, f64)> {
        let stairs = links[link].kind == LinkKind::Stairs;
        if stairs && !walker.stairs {
            return Vec::new();
        }
        let others = self.portals.iter().enumerate();
        let others = others.filter_map(|(i, p)| p.stop.filter(|(l, s)| *l == link && *s != stop).map(|(_, s)| (i, s)));
        others.map(|(i, s)| (i, ride_s(links, link, stop, s) * M_PER_S)).collect()
    }

    /// Returns the legs along a chain of portals.
    fn legs(
        &mut self,
        spaces: &[Space],
        chain: &[usize],
        (from_level, a, from): (usize, usize, Point),
        (to_level, b, to): (usize, usize, Point),
    ) -> Option<Vec<Leg>> {
        let mut out: Vec<Leg> = Vec::new();
        let mut way: Vec<Point> = self.end(&spaces[from_level], from_level, a, chain[0], from)?;
        way.reverse();
        let mut level = from_level;
        for pair in chain.windows(2) {
            let (p, q) = (&self.portals[pair[0]], &self.portals[pair[1]]);
            if p.level != q.level {
                let ride = p.stop.zip(q.stop).map(|((link, _), (_, stop))| (link, stop));
                out.push(Leg { level, way: std::mem::take(&mut way), ride });
                level = q.level;
                way = vec![q.at];
                continue;
            }
            let room = *p.rooms.iter().filter(|r| q.rooms.contains(r)).min_by(|x, y| {
                let cost = |r: &usize| {
                    self.stretches
                        .get(&(r * 1000 + level, pair[0].min(pair[1]), pair[0].max(pair[1])))
                        .and_then(|s| s.as_ref())
                        .map_or(f64::MAX, |s| s.0)
                };
                cost(x).total_cmp(&cost(y))
            })?;
            let mut part = self.between(&spaces[level], level, room, pair[0], pair[1]).as_ref()?.1.clone();
            if pair[0] > pair[1] {
                part.reverse();
            }
            way.extend(part.into_iter().skip(1));
        }
        let end = self.end(&spaces[to_level], to_level, b, chain[chain.len() - 1], to)?;
        way.extend(end.into_iter().skip(1));
        out.push(Leg { level, way, ride: None });
        for leg in &mut out {
            leg.way.dedup_by(|a, b| a.distance(*b) < 1e-6);
            shorten(&spaces[leg.level], &mut leg.way, self.radius);
        }
        Some(out)
    }

    /// Returns the way from a portal to a point of one of its rooms.
    fn end(&mut self, space: &Space, level: usize, room: usize, portal: usize, p: Point) -> Option<Vec<Point>> {
        let (radius, at) = (self.radius, self.portals[portal].at);
        let field = self.field(space, portal, level, room);
        let n = field.nearest(space, p)?;
        let mut nodes = field.back(n);
        nodes.reverse();
        Some(ended(pull(space, &nodes, radius), at, p))
    }
}

/// Returns how long the way from one stop of a link to another takes, s.
pub fn ride_s(links: &[Link], link: usize, from: usize, to: usize) -> f64 {
    let storeys = from.abs_diff(to) as f64;
    match links[link].kind {
        LinkKind::Stairs => STAIRS_S * storeys,
        LinkKind::Elevator => LIFT_S + storeys * 4.0,
    }
}

/// Returns a way that ends exactly at two points: its own ends are the nodes nearest to them.
fn ended(mut way: Vec<Point>, from: Point, to: Point) -> Vec<Point> {
    if way.first().is_some_and(|p| p.distance(from) > 1e-6) {
        way.insert(0, from);
    }
    if way.last().is_some_and(|p| p.distance(to) > 1e-6) {
        way.push(to);
    }
    way
}

/// Returns the node of a room near a point that one of this radius stands on.
pub fn standing(space: &Space, room: usize, p: Point, radius: f64) -> Option<usize> {
    let fits = |n: usize| space.belongs(n, room) && space.clear(n) >= radius;
    let n = space.node(p);
    if fits(n) {
        return Some(n);
    }
    let reach = 8_i64;
    let (i, j) = ((n % space.nx) as i64, (n / space.nx) as i64);
    let mut best: Option<(f64, usize)> = None;
    for dj in -reach..=reach {
        for di in -reach..=reach {
            let (i, j) = (i + di, j + dj);
            if i < 0 || j < 0 || i >= space.nx as i64 || j >= space.ny as i64 {
                continue;
            }
            let m = j as usize * space.nx + i as usize;
            let off = space.point(m).distance(p);
            if fits(m) && best.is_none_or(|(known, _)| off < known) {
                best = Some((off, m));
            }
        }
    }
    best.map(|(_, n)| n)
}
