//! Where the robots of a world drive, as a graph of straight lanes on each storey: for route planners and fleet managers.
//!
//! Nodes are docks and places of the scenario, the two sides of every door, lifts, and corners where a way has to turn. No
//! point of a lane is nearer to anything than the robot's radius, measured exactly; lanes keep out of what robots are kept
//! out of. Nothing assumes walls along x and y.

use std::collections::{BTreeMap, VecDeque};

use d3dgen_model::floorplan::{Door, Floorplan};
use d3dgen_model::geometry::{Point, Rect, Segment, to_mm};
use d3dgen_model::obstacles::{Obstacles, clear_opening};
use d3dgen_model::occupancy::{Bitmap, CELL_M, FLAT_M, Occupancy, ROBOT_HEIGHT_M};
use d3dgen_model::scenario::{Poi, RoiKind};
use d3dgen_model::storeys::LinkKind;
use d3dgen_model::world::World;

/// Radius of the robot that ways are for where a world has none, m.
const USUAL_RADIUS_M: f64 = 0.25;
/// Play that lanes have beyond the robot's radius where there is floor for it, m.
const PLAY_M: f64 = 0.03;
/// How far before the faces of its wall a lane meets a door, beyond the robot's radius, m: the first that is free.
const BEFORE_DOOR_M: [f64; 4] = [0.2, 0.05, -0.1, -0.3];
/// How far a node may be from the cell that stands for it, m.
const NEAR_M: f64 = 0.35;
/// Distance beyond which it does not matter how far a thing is, m.
const FAR_M: f64 = 2.0;
/// Slack of comparisons, m.
const ROUNDING_M: f64 = 2e-3;
/// Distance between the points at which a lane is looked at for slow floor, m.
const STEP_M: f64 = 0.1;

/// The largest measures of the robots of a world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Radius of the disc that finds its way, m.
    pub radius_m: f64,
    /// That of the smallest of them, m.
    pub least_radius_m: f64,
    /// Height: what hangs above it does not stop it, m.
    pub height_m: f64,
}

impl Body {
    /// Returns the body that ways are for: that of a usual robot in a world without any.
    pub fn of(world: &World) -> Self {
        let robots = || world.scenario.robots.iter().map(|task| &task.robot);
        let largest = |of: fn(&d3dgen_model::scene_graph::Robot) -> f64| robots().map(of).reduce(f64::max);
        Self {
            radius_m: largest(|r| r.radius_m).unwrap_or(USUAL_RADIUS_M),
            least_radius_m: robots().map(|r| r.radius_m).reduce(f64::min).unwrap_or(USUAL_RADIUS_M),
            height_m: largest(|r| r.height_m).unwrap_or(ROBOT_HEIGHT_M),
        }
    }
}

/// The floor of a storey as a robot finds it.
pub struct Ground {
    /// Floor, and what of it nothing stands on that stops the robot.
    pub occupancy: Occupancy,
    /// Floor that robots are kept out of.
    pub kept_out: Bitmap,
    obstacles: Obstacles,
    body: Body,
}

impl Ground {
    /// Returns the floor of one storey; what hangs above the robot leaves it free.
    pub fn of(storey: &World, body: Body) -> Self {
        let (plan, placements) = (&storey.floorplan, &storey.placements);
        let mut occupancy = Occupancy::of_floorplan(plan);
        let stops = placements.placements.iter().filter(|p| p.top_m() > FLAT_M && p.pose.z < body.height_m);
        stops.for_each(|p| occupancy.block(&p.footprint()));
        let mut kept_out = Bitmap::new(occupancy.frame.nx, occupancy.frame.ny);
        let mut edges: Vec<Rect> = Vec::new();
        for roi in storey.scenario.rois.iter().filter(|r| r.kind == RoiKind::KeepOut) {
            occupancy.frame.paint(&mut kept_out, &roi.polygon, true);
            edges.extend(if roi.polygon.is_rectilinear() { roi.polygon.rects() } else { vec![roi.polygon.bounds()] });
        }
        let obstacles = Obstacles::with(plan, placements, body.height_m, &edges);
        Self { occupancy, kept_out, obstacles, body }
    }

    /// Returns the radius of the largest robot that the floor is for, m.
    pub fn radius_m(&self) -> f64 {
        self.body.radius_m
    }

    /// Returns true where nothing stands and robots may be.
    fn is_open(&self, p: Point) -> bool {
        self.occupancy.frame.cell(p).is_some_and(|(i, j)| self.occupancy.free.get(i, j) && !self.kept_out.get(i, j))
    }

    /// Returns the distance to the nearest thing as far as it matters, m.
    pub fn clearance(&self, p: Point) -> f64 {
        if self.is_open(p) { self.obstacles.distance(p, FAR_M) } else { 0.0 }
    }

    /// Returns the least distance of anything to a straight lane as far as it matters, m; 0 where it is blocked.
    pub fn along(&self, a: Point, b: Point) -> f64 {
        let steps = (a.distance(b) / CELL_M).ceil().max(1.0);
        let at = |k: f64| Point::new(a.x + (b.x - a.x) * k / steps, a.y + (b.y - a.y) * k / steps);
        if (0..=steps as u32).all(|k| self.is_open(at(f64::from(k)))) { self.obstacles.along(a, b, FAR_M) } else { 0.0 }
    }
}

/// What a node of a roadmap is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// A point of the scenario, by its id.
    Poi(String),
    /// A side of a door, by the door's id.
    Door(String),
    /// The car of a lift, by the id of its link.
    Lift(String),
    /// The roomiest point of a room without any other, by the room's id.
    Room(String),
    /// Where a way turns.
    Corner,
}

/// A node of a roadmap.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Where it is.
    pub at: Point,
    /// What it is.
    pub place: Place,
}

/// A straight lane, driven in both directions.
#[derive(Debug, Clone, PartialEq)]
pub struct Lane {
    /// Nodes at its ends.
    pub ends: [usize; 2],
    /// The door that it goes through.
    pub door: Option<String>,
    /// Highest speed on it, where floor that it crosses is slow, m/s.
    pub max_speed_m_s: Option<f64>,
}

/// Nodes and lanes of one storey, all of which are reached from each other.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Roadmap {
    /// Nodes.
    pub nodes: Vec<Node>,
    /// Lanes.
    pub lanes: Vec<Lane>,
}

impl Roadmap {
    /// Returns the roadmap of one storey. Places that the robot does not fit at, and parts of the storey that it does not
    /// get to from the largest, are left out.
    pub fn of(storey: &World, ground: &Ground) -> Self {
        let (nodes, rooms, docks, lanes) = (Vec::new(), Vec::new(), Vec::new(), BTreeMap::new());
        let mut maker = Maker { ground, plan: &storey.floorplan, nodes, rooms, docks, lanes };
        maker.add_places(storey);
        maker.add_doors();
        maker.add_lifts();
        maker.add_rooms();
        maker.join_rooms();
        maker.join_parts();
        let mut out = maker.largest();
        for lane in &mut out.lanes {
            let [a, b] = lane.ends.map(|n| out.nodes[n].at);
            lane.max_speed_m_s = slowest(storey, a, b);
        }
        out
    }

    /// Returns the node of a point of the scenario.
    pub fn node_of(&self, poi_id: &str) -> Option<usize> {
        self.nodes.iter().position(|n| matches!(&n.place, Place::Poi(id) if id == poi_id))
    }
}

/// Returns the lowest limit of the slow floor that a line crosses, m/s.
fn slowest(storey: &World, a: Point, b: Point) -> Option<f64> {
    let steps = (a.distance(b) / STEP_M).ceil().max(1.0);
    let on = (0..=steps as u32).map(|k| f64::from(k) / steps);
    let points: Vec<Point> = on.map(|k| Point::new(a.x + (b.x - a.x) * k, a.y + (b.y - a.y) * k)).collect();
    let zones = storey.scenario.rois.iter().filter(|r| points.iter().any(|p| r.polygon.contains(*p)));
    zones.filter_map(|r| r.max_speed_m_s).reduce(f64::min)
}

/// A roadmap under construction.
struct Maker<'a> {
    ground: &'a Ground,
    plan: &'a Floorplan,
    nodes: Vec<Node>,
    /// By node: the room that it is in.
    rooms: Vec<usize>,
    /// Nodes of docks: a lane leads to one and not from one to the next.
    docks: Vec<usize>,
    /// Lanes by their ends, the lower first, with the door that they go through.
    lanes: BTreeMap<(usize, usize), Option<String>>,
}

impl Maker<'_> {
    fn add(&mut self, at: Point, place: Place) -> Option<usize> {
        let at = Point::new(to_mm(at.x), to_mm(at.y));
        let room = self.plan.rooms.iter().position(|r| r.net_polygon.contains(at));
        // a turn in the thickness of a wall is no room's
        let room = room.or_else(|| self.plan.rooms.iter().position(|r| r.polygon.contains(at)))?;
        self.nodes.push(Node { at, place });
        self.rooms.push(room);
        Some(self.nodes.len() - 1)
    }

    fn fits(&self, p: Point, radius: f64) -> bool {
        self.ground.clearance(p) >= radius - ROUNDING_M
    }

    fn add_places(&mut self, storey: &World) {
        for poi in &storey.scenario.pois {
            let at = Point::new(poi.pose.x, poi.pose.y);
            let taken = self.nodes.iter().any(|n| n.at.distance(at) < CELL_M);
            if !taken && self.fits(at, self.ground.body.least_radius_m) {
                let node = self.add(at, Place::Poi(poi.poi_id.clone()));
                self.docks.extend(node.filter(|_| poi.kind == Poi::DOCK));
            }
        }
    }

    /// Adds both sides of every door between two rooms that the robot passes, and the lane between them.
    fn add_doors(&mut self) {
        let body = self.ground.body;
        for door in self.plan.doors.iter().filter(|d| d.room_ids.len() == 2 && d.height_m >= body.height_m) {
            if let Some([a, b]) = self.sides(door) {
                let ends = [a, b].map(|at| self.add(at, Place::Door(door.door_id.clone())));
                if let [Some(a), Some(b)] = ends {
                    self.lanes.insert((a, b), Some(door.door_id.clone()));
                }
            }
        }
    }

    /// Returns the points before and behind the middle of what is clear of a door, as far from it as there is floor.
    fn sides(&self, door: &Door) -> Option<[Point; 2]> {
        let (clear, radius) = (clear_opening(door), self.ground.body.radius_m);
        let (length, middle) = (clear.length(), clear.middle());
        if length < 2.0 * (radius - ROUNDING_M) {
            return None;
        }
        let n = (-(clear.end.y - clear.start.y) / length, (clear.end.x - clear.start.x) / length);
        let side = |sign: f64| {
            BEFORE_DOOR_M.into_iter().find_map(|beyond| {
                let out = sign * (door.wall_thickness_m / 2.0 + (radius + beyond).max(0.05));
                let at = Point::new(middle.x + n.0 * out, middle.y + n.1 * out);
                (self.ground.along(middle, at) >= radius - ROUNDING_M).then_some(at)
            })
        };
        Some([side(1.0)?, side(-1.0)?])
    }

    fn add_lifts(&mut self) {
        for link in self.plan.links.iter().filter(|l| l.kind == LinkKind::Elevator) {
            let Some(room) = link.room_ids.iter().find_map(|id| self.plan.room(id)) else { continue };
            let at = room.net_polygon.bounds().center();
            if self.fits(at, self.ground.body.radius_m) {
                self.add(at, Place::Lift(link.link_id.clone()));
            }
        }
    }

    /// Adds the roomiest point of rooms that have no node but at doors.
    fn add_rooms(&mut self) {
        for (k, room) in self.plan.rooms.iter().enumerate() {
            let named = |n: &usize| !matches!(self.nodes[*n].place, Place::Door(_)) && self.rooms[*n] == k;
            if (0..self.nodes.len()).any(|n| named(&n)) {
                continue;
            }
            let b = room.net_polygon.bounds();
            let lattice = (1..12).flat_map(|i| (1..12).map(move |j| (f64::from(i) / 12.0, f64::from(j) / 12.0)));
            let points = lattice.map(|(i, j)| Point::new(b.x0 + i * b.width(), b.y0 + j * b.height()));
            let inside = points.filter(|p| room.net_polygon.contains(*p)).map(|p| (self.ground.clearance(p), p));
            let best = inside.max_by(|a, b| a.0.total_cmp(&b.0));
            if let Some((_, at)) = best.filter(|(clear, _)| *clear >= self.ground.body.radius_m) {
                self.add(at, Place::Room(room.room_id.clone()));
            }
        }
    }

    /// Returns the least distance that a lane between two nodes needs: the radius with some play, less where a node has less.
    fn need(&self, ends: [usize; 2]) -> f64 {
        let body = self.ground.body;
        let own =
            ends.map(|n| self.ground.clearance(self.nodes[n].at)).into_iter().fold(body.radius_m + PLAY_M, f64::min);
        own.max(body.least_radius_m) - ROUNDING_M
    }

    /// Joins the nodes of each room by straight lanes, none of which another pair of them makes needless.
    fn join_rooms(&mut self) {
        for room in 0..self.plan.rooms.len() {
            let own: Vec<usize> = (0..self.nodes.len()).filter(|n| self.rooms[*n] == room).collect();
            let mut seen: BTreeMap<(usize, usize), f64> = BTreeMap::new();
            for (k, &a) in own.iter().enumerate() {
                for &b in &own[k + 1..] {
                    let (p, q) = (self.nodes[a].at, self.nodes[b].at);
                    let berths = self.docks.contains(&a) && self.docks.contains(&b);
                    if !berths && self.ground.along(p, q) >= self.need([a, b]) && self.doors_on(p, q).is_empty() {
                        seen.insert((a, b), p.distance(q));
                    }
                }
            }
            let length = |a: usize, b: usize| seen.get(&(a.min(b), a.max(b))).copied();
            for (&(a, b), &long) in &seen {
                let shorter = |c: &usize| {
                    *c != a && *c != b && length(a, *c).zip(length(*c, b)).is_some_and(|(p, q)| p.max(q) < long)
                };
                if !own.iter().any(shorter) {
                    self.lanes.insert((a, b), None);
                }
            }
        }
    }

    /// Returns the doors that a straight line goes through.
    fn doors_on(&self, a: Point, b: Point) -> Vec<&str> {
        let line = Segment { start: a, end: b };
        let through = |d: &&Door| d.room_ids.len() == 2 && meet(&line, &d.line);
        self.plan.doors.iter().filter(through).map(|d| d.door_id.as_str()).collect()
    }

    /// Returns by node which part of the roadmap it is in.
    fn parts(&self) -> Vec<usize> {
        let mut part: Vec<usize> = (0..self.nodes.len()).collect();
        self.lanes.keys().for_each(|(a, b)| unite(&mut part, *a, *b));
        (0..part.len()).map(|n| root(&part, n)).collect()
    }

    /// Joins the parts of the roadmap along the free floor, the shortest way first; from one dock straight to another only where
    /// there is no other way to it.
    fn join_parts(&mut self) {
        let mut part = self.parts();
        let meetings = self.meetings();
        for between_docks in [false, true] {
            for (a, b, path) in &meetings {
                if root(&part, *a) == root(&part, *b) {
                    continue;
                }
                let Some(mut corners) = self.pulled(path) else { continue };
                let straight = corners.len() == 2 && self.docks.contains(a) && self.docks.contains(b);
                if straight != between_docks {
                    continue;
                }
                if straight {
                    // a lane has a dock at one end at most
                    let middle = Point::new((corners[0].x + corners[1].x) / 2.0, (corners[0].y + corners[1].y) / 2.0);
                    corners.insert(1, middle);
                }
                self.join(&corners, [*a, *b], &mut part);
            }
        }
    }

    /// Adds the lanes along a way between two nodes, with a node at each of its corners.
    fn join(&mut self, corners: &[Point], [a, b]: [usize; 2], part: &mut Vec<usize>) {
        let mut last = a;
        for at in &corners[1..corners.len() - 1] {
            let Some(next) = self.add(*at, Place::Corner) else { return };
            part.push(next);
            self.lane(last, next, part);
            last = next;
        }
        self.lane(last, b, part);
    }

    fn lane(&mut self, a: usize, b: usize, part: &mut [usize]) {
        let door = self.doors_on(self.nodes[a].at, self.nodes[b].at).first().map(|d| (*d).to_owned());
        self.lanes.insert((a.min(b), a.max(b)), door);
        unite(part, a, b);
    }

    /// Spreads over the free floor from all nodes at once; returns where two parts meet, with the way between their nodes.
    fn meetings(&self) -> Vec<(usize, usize, Vec<Point>)> {
        let Occupancy { frame, free, .. } = &self.ground.occupancy;
        let mut open = free.clone();
        open.subtract(&self.ground.kept_out);
        let clear = open.eroded((self.ground.body.radius_m + PLAY_M) / CELL_M);
        let index = |(i, j): (usize, usize)| j * frame.nx + i;
        let part = self.parts();
        let mut from: Vec<Option<(usize, usize, u32)>> = vec![None; frame.nx * frame.ny];
        let mut queue = VecDeque::new();
        for (n, node) in self.nodes.iter().enumerate() {
            let near = frame.cells(&Rect::new(node.at.x, node.at.y, node.at.x, node.at.y).grown(NEAR_M));
            let reached = |c: &(usize, usize)| {
                let at = frame.center(c.0, c.1);
                clear.get(c.0, c.1) && self.ground.along(node.at, at) >= self.ground.body.least_radius_m - ROUNDING_M
            };
            let distance = |c: &(usize, usize)| frame.center(c.0, c.1).distance(node.at);
            let cell = near.filter(reached).min_by(|a, b| distance(a).total_cmp(&distance(b)));
            if let Some(cell) = cell.filter(|c| from[index(*c)].is_none()) {
                from[index(cell)] = Some((n, index(cell), 0));
                queue.push_back(cell);
            }
        }
        let mut met: BTreeMap<(usize, usize), (u32, [usize; 2])> = BTreeMap::new();
        while let Some((i, j)) = queue.pop_front() {
            let here = index((i, j));
            let Some((node, _, steps)) = from[here] else { continue };
            let around = [(1, 0), (0, 1), (-1, 0), (0, -1)];
            let next = around.iter().filter_map(|(x, y)| Some((i.checked_add_signed(*x)?, j.checked_add_signed(*y)?)));
            for cell in next.filter(|c| clear.get(c.0, c.1)) {
                let there = index(cell);
                match from[there] {
                    None => {
                        from[there] = Some((node, here, steps + 1));
                        queue.push_back(cell);
                    }
                    Some((other, _, more)) if part[other] != part[node] => {
                        let key = (part[node].min(part[other]), part[node].max(part[other]));
                        let best = met.entry(key).or_insert((u32::MAX, [here, there]));
                        if steps + more < best.0 {
                            *best = (steps + more, [here, there]);
                        }
                    }
                    Some(_) => {}
                }
            }
        }
        let mut found: Vec<(u32, [usize; 2])> = met.into_values().collect();
        found.sort_unstable();
        let trace = |mut at: usize| {
            let mut way = Vec::new();
            while let Some((node, before, steps)) = from[at] {
                way.push(frame.center(at % frame.nx, at / frame.nx));
                if steps == 0 {
                    way.push(self.nodes[node].at);
                    return (node, way);
                }
                at = before;
            }
            (0, way)
        };
        let ways = found.into_iter().map(|(_, [here, there])| {
            let ((a, mut way), (b, rest)) = (trace(here), trace(there));
            way.reverse();
            way.extend(rest);
            (a, b, way)
        });
        ways.collect()
    }

    /// Returns the corners of a way of cells, pulled straight as far as its lanes stay clear and go through one door each.
    fn pulled(&self, way: &[Point]) -> Option<Vec<Point>> {
        let least = self.ground.body.least_radius_m - ROUNDING_M;
        let mut out = vec![*way.first()?];
        let mut at = 0;
        while at + 1 < way.len() {
            let ends = [way[0], way[way.len() - 1]];
            let straight = |to: &usize| {
                let own = [way[at], way[*to]].map(|p| self.ground.clearance(p)).into_iter().fold(f64::MAX, f64::min);
                let tight = [way[at], way[*to]].iter().any(|p| ends.contains(p));
                let need = if tight { own.min(self.ground.body.radius_m) } else { self.ground.body.radius_m };
                self.ground.along(way[at], way[*to]) >= need.max(least + ROUNDING_M) - ROUNDING_M
                    && self.doors_on(way[at], way[*to]).len() <= 1
            };
            // halving finds a far one quickly; whether a nearer one is clear says nothing certain of a farther one
            let last = way.len() - 1;
            let mut step = last - at;
            let next = loop {
                if straight(&(at + step)) {
                    break at + step;
                }
                if step == 1 {
                    return None;
                }
                step = (step * 2 / 3).max(1);
            };
            out.push(way[next]);
            at = next;
        }
        Some(out)
    }

    /// Returns the part of the roadmap with the most places of the scenario, of equal ones that with the most nodes.
    fn largest(self) -> Roadmap {
        let part = self.parts();
        let mut counts: BTreeMap<usize, (usize, usize)> = BTreeMap::new();
        for (n, node) in self.nodes.iter().enumerate() {
            let count = counts.entry(part[n]).or_default();
            count.0 += usize::from(matches!(node.place, Place::Poi(_)));
            count.1 += 1;
        }
        let best = counts.into_iter().max_by_key(|(part, count)| (*count, usize::MAX - part)).map(|(part, _)| part);
        let kept: Vec<usize> = (0..self.nodes.len()).filter(|n| Some(part[*n]) == best).collect();
        let place = |n: usize| kept.binary_search(&n).ok();
        let lanes = self
            .lanes
            .into_iter()
            .filter_map(|((a, b), door)| Some(Lane { ends: [place(a)?, place(b)?], door, max_speed_m_s: None }));
        Roadmap { lanes: lanes.collect(), nodes: kept.iter().map(|n| self.nodes[*n].clone()).collect() }
    }
}

fn root(part: &[usize], mut n: usize) -> usize {
    while part[n] != n {
        n = part[n];
    }
    n
}

fn unite(part: &mut [usize], a: usize, b: usize) {
    let (a, b) = (root(part, a), root(part, b));
    part[a.max(b)] = a.min(b);
}

/// Returns true when two segments meet.
fn meet(a: &Segment, b: &Segment) -> bool {
    let turn = |p: Point, q: Point, r: Point| (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
    turn(a.start, a.end, b.start) * turn(a.start, a.end, b.end) <= 0.0
        && turn(b.start, b.end, a.start) * turn(b.start, b.end, a.end) <= 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn every_room_is_reached_by_lanes_that_keep_clear() {
        let world = sample::world();
        let body = Body::of(&world);
        let ground = Ground::of(&world, body);
        let map = Roadmap::of(&world, &ground);
        assert!(!map.lanes.is_empty());
        for lane in &map.lanes {
            let [a, b] = lane.ends.map(|n| map.nodes[n].at);
            let clear = ground.along(a, b);
            assert!(clear >= body.least_radius_m - 2.0 * ROUNDING_M, "{a:?} to {b:?} has {clear} m");
        }
        let mut part: Vec<usize> = (0..map.nodes.len()).collect();
        map.lanes.iter().for_each(|l| unite(&mut part, l.ends[0], l.ends[1]));
        assert!((0..part.len()).all(|n| root(&part, n) == 0), "all in one part");
        let reached = |id: &str| {
            let room = world.floorplan.room(id).expect("a room");
            map.nodes.iter().any(|n| room.net_polygon.contains(n.at))
        };
        let missed: Vec<&str> =
            world.floorplan.rooms.iter().map(|r| r.room_id.as_str()).filter(|id| !reached(id)).collect();
        assert!(missed.len() <= 1, "{missed:?}");
        assert!(map.lanes.iter().filter(|l| l.door.is_some()).count() >= 3);
        assert_eq!(map, Roadmap::of(&world, &Ground::of(&world, body)), "the same each time");
    }
}
