//! Routes of robots: from where one starts to its goals in turn, and to its dock.
//!
//! A route goes from door to door, each crossed straight in the middle of what is clear, and through every room between two
//! doors by a stretch of its own that is looked for once: straight where there is play enough, else along a lattice on which
//! floor near things costs more, pulled straight again as far as that leaves play. Distances are exact
//! ([`Obstacles`]): no part of a route is nearer to anything than the robot's radius.

use std::collections::BTreeMap;

use d3dgen_model::Point;
use d3dgen_model::floorplan::Door;
use d3dgen_model::geometry::to_mm;
use d3dgen_model::obstacles::{Obstacles, clear_opening};
use d3dgen_model::scenario::{Poi, RobotTask, Route};

use super::floor::{Floor, ROUNDING_M};
use super::lattice::{LINE_PLAY_M, Lattice, PLAY_M, Room, factor};

/// How far before the faces of its wall a robot turns to a door, beyond its radius, m: the first that is free.
const BEFORE_DOOR_M: [f64; 3] = [0.2, 0.05, -0.15];
/// Length of the ends of a stretch where there may be less play because of what it leads to, m.
const END_M: f64 = 0.4;
/// Distance between the places of a wide opening that are looked at, m.
const ABREAST_M: f64 = 0.25;
/// Most places of an opening on each side of its middle.
const MOST_ABREAST: u32 = 12;
/// How much longer a way may be that stays out of rooms where robots have no business.
const KEPT_OUT: f64 = 5.0;
/// What a corner adds to a way, times its length, where it is none, m^2.
const STRAIGHT_M2: f64 = 1e-4;
/// How much longer a stretch may be, as a factor and in m, that goes around chairs which somebody may push back.
const AROUND: f64 = 1.6;
const AROUND_M: f64 = 1.5;
/// Most times that a way is looked for again because a room on it has no stretch as short as its doors lie apart.
const MOST_TRIES: usize = 100;

/// Where routes begin, end and change from room to room.
struct Node {
    room: usize,
    at: Point,
    /// The other side of a door.
    through: Option<usize>,
}

/// Part of a route within a room.
struct Stretch {
    path: Vec<Point>,
    /// Length, m, with what little play adds.
    cost: f64,
}

/// Finds routes on one storey.
pub(crate) struct Router<'f, 'a> {
    floor: &'f Floor<'a>,
    obstacles: &'f Obstacles,
    /// The same with chairs pushed back and other robots at their docks.
    in_use: &'f Obstacles,
    radius: f64,
    /// Least distance of the robot's middle to anything, m.
    need: f64,
    nodes: Vec<Node>,
    /// Sides of doors by room.
    doors: Vec<Vec<usize>>,
    /// By nodes, the lower first; absent until looked for, `None` where there is none.
    stretches: BTreeMap<(usize, usize), Option<Stretch>>,
    lattices: BTreeMap<(usize, bool), Vec<Lattice>>,
}

impl<'f, 'a> Router<'f, 'a> {
    /// Returns the router of robots up to this radius, m, that go around what is there in use where that is not far.
    pub fn new(floor: &'f Floor<'a>, radius: f64, in_use: &'f Obstacles) -> Self {
        let mut out = Self {
            floor,
            obstacles: floor.obstacles(),
            in_use,
            radius,
            need: radius + ROUNDING_M,
            nodes: Vec::new(),
            doors: vec![Vec::new(); floor.rooms.len()],
            stretches: BTreeMap::new(),
            lattices: BTreeMap::new(),
        };
        let index: BTreeMap<&str, usize> =
            floor.rooms.iter().enumerate().map(|(i, r)| (r.plan.room_id.as_str(), i)).collect();
        for door in floor.plan.doors.iter().filter(|d| d.height_m >= floor.height) {
            if let [a, b] = &door.room_ids[..]
                && let (Some(&a), Some(&b)) = (index.get(a.as_str()), index.get(b.as_str()))
            {
                out.add_door(door, [a, b]);
            }
        }
        out
    }

    /// Adds the two sides of a door where the robot passes it.
    fn add_door(&mut self, door: &Door, rooms: [usize; 2]) {
        let clear = clear_opening(door);
        let (length, middle) = (clear.length(), clear.middle());
        if length < 2.0 * (self.need - 2.0 * ROUNDING_M) {
            return;
        }
        let along = ((clear.end.x - clear.start.x) / length, (clear.end.y - clear.start.y) / length);
        let spare = length / 2.0 - self.need;
        let count = ((spare / ABREAST_M) as u32).min(MOST_ABREAST);
        let offsets = (0..=count).map(f64::from).flat_map(|k| if k == 0.0 { vec![0.0] } else { vec![k, -k] });
        let mut best: Option<(f64, [Point; 2])> = None;
        for offset in offsets.map(|k| k * ABREAST_M) {
            let at = Point::new(middle.x + offset * along.0, middle.y + offset * along.1);
            let Some((play, sides)) = self.crossing(door, (at, (-along.1, along.0))) else { continue };
            // the middle of what is clear unless another place has more room
            if best.as_ref().is_none_or(|b| play > b.0 + ROUNDING_M) {
                best = Some((play, sides));
            }
        }
        let Some((_, mut sides)) = best else { return };
        let in_room = |room: usize, p: Point| self.floor.rooms[room].plan.net_polygon.contains(p);
        if in_room(rooms[0], sides[1]) || in_room(rooms[1], sides[0]) {
            sides.reverse();
        }
        for (k, (room, at)) in rooms.into_iter().zip(sides).enumerate() {
            let id = self.nodes.len();
            self.nodes.push(Node { room, at, through: Some(if k == 0 { id + 1 } else { id - 1 }) });
            self.doors[room].push(id);
        }
    }

    /// Returns the least distance to anything on the way straight through a wall, as far as that counts, and its ends.
    fn crossing(&self, door: &Door, (at, normal): (Point, (f64, f64))) -> Option<(f64, [Point; 2])> {
        let most = self.need + PLAY_M;
        let mut play = most;
        let mut sides = [at; 2];
        for (side, sign) in sides.iter_mut().zip([1.0, -1.0]) {
            let end = |beyond: f64| {
                let far = sign * (door.wall_thickness_m / 2.0 + (self.need + beyond).max(0.0));
                Point::new(to_mm(at.x + far * normal.0), to_mm(at.y + far * normal.1))
            };
            let tried = BEFORE_DOOR_M.into_iter().chain([-self.need]).map(|beyond| {
                let end = end(beyond);
                (self.obstacles.along(at, end, most), end)
            });
            // as far before the door as leaves the play that the door itself has
            let own = self.obstacles.along(at, end(-self.need), most);
            let found = tried.into_iter().find(|(d, _)| *d >= own - ROUNDING_M)?;
            (play, *side) = (play.min(found.0), found.1);
        }
        (play >= self.need - 2.0 * ROUNDING_M).then_some((play, sides))
    }

    /// Returns the radius of the robots it is for, m.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Returns the legs of a robot's round in turn; `None` for what cannot be driven.
    pub fn round(&mut self, task: &RobotTask, pois: &[Poi]) -> Vec<Option<Route>> {
        let start = Point::new(task.start.x, task.start.y);
        let mut here = (String::new(), self.stop(start));
        let mut out = Vec::new();
        for id in task.goals.iter().chain(&task.dock) {
            let Some(poi) = pois.iter().find(|p| &p.poi_id == id) else { continue };
            let there = self.stop(Point::new(poi.pose.x, poi.pose.y));
            let leg = here.1.zip(there).and_then(|(a, b)| self.leg((&here.0, a), (id, b)));
            out.push(leg);
            here = (id.clone(), there);
        }
        out
    }

    /// Returns the node at a point that routes begin and end at; `None` outside of all rooms.
    fn stop(&mut self, at: Point) -> Option<usize> {
        if let Some(known) = self.nodes.iter().position(|n| n.through.is_none() && n.at == at) {
            return Some(known);
        }
        let room = self.floor.rooms.iter().position(|r| r.plan.net_polygon.contains(at))?;
        self.nodes.push(Node { room, at, through: None });
        Some(self.nodes.len() - 1)
    }

    fn leg(&mut self, (from, a): (&str, usize), (to, b): (&str, usize)) -> Option<Route> {
        let mut path: Vec<Point> = self.way(a, b)?;
        self.shorten(&mut path);
        if path.len() == 1 {
            path.push(path[0]);
        }
        let most = self.need + self.floor.occupancy.frame.nx.max(self.floor.occupancy.frame.ny) as f64;
        let clear = self.obstacles.along_path(&path, most);
        Some(Route {
            from: from.to_owned(),
            to: to.to_owned(),
            length_m: to_mm(path.windows(2).map(|w| w[0].distance(w[1])).sum()),
            clear_width_m: (2000.0 * clear + 1e-6).floor() / 1000.0,
            path,
        })
    }

    /// Returns the corners of the cheapest way. Rooms on it are looked at one after the other, until one is found of which all
    /// stretches are known.
    fn way(&mut self, a: usize, b: usize) -> Option<Vec<Point>> {
        for _ in 0..MOST_TRIES {
            let nodes = self.nodes_between(a, b)?;
            let mut all_known = true;
            for pair in nodes.windows(2) {
                if self.nodes[pair[0]].through == Some(pair[1]) {
                    continue;
                }
                let key = (pair[0].min(pair[1]), pair[0].max(pair[1]));
                if !self.stretches.contains_key(&key) {
                    let found = self.stretch(key.0, key.1);
                    all_known = false;
                    self.stretches.insert(key, found);
                }
            }
            if all_known {
                return Some(self.path_of(&nodes));
            }
        }
        None
    }

    fn path_of(&self, nodes: &[usize]) -> Vec<Point> {
        let mut out = vec![self.nodes[nodes[0]].at];
        for pair in nodes.windows(2) {
            let key = (pair[0].min(pair[1]), pair[0].max(pair[1]));
            match self.stretches.get(&key).and_then(Option::as_ref) {
                Some(s) if pair[0] < pair[1] => out.extend(&s.path),
                Some(s) => out.extend(s.path.iter().rev()),
                None => out.push(self.nodes[pair[1]].at),
            }
        }
        out.dedup();
        out
    }

    /// Returns the nodes of the cheapest way by what is known: stretches not looked for are taken for straight lines.
    fn nodes_between(&self, a: usize, b: usize) -> Option<Vec<usize>> {
        let left = |n: usize| self.nodes[n].at.distance(self.nodes[b].at);
        let mut open: Vec<(f64, usize)> = vec![(left(a), a)];
        let mut reached: Vec<(f64, usize)> = vec![(f64::INFINITY, a); self.nodes.len()];
        reached[a].0 = 0.0;
        while let Some(at) = (0..open.len()).min_by(|i, j| open[*i].0.total_cmp(&open[*j].0)) {
            let (least, n) = open.swap_remove(at);
            if n == b {
                let mut out = vec![b];
                while out[out.len() - 1] != a {
                    out.push(reached[out[out.len() - 1]].1);
                }
                out.reverse();
                return Some(out);
            }
            let here = &self.nodes[n];
            let (cost, before) = reached[n];
            if least > cost + left(n) + 1e-9 {
                continue;
            }
            let mut to = |m: usize, step: f64| {
                if cost + step < reached[m].0 - 1e-9 {
                    reached[m] = (cost + step, n);
                    open.push((cost + step + left(m), m));
                }
            };
            if let Some(m) = here.through.filter(|m| self.leads_on(*m, b)) {
                to(m, here.at.distance(self.nodes[m].at));
            }
            // who crossed the room to get here goes on through the door: on to others the way straight there is no longer
            if n != a && self.nodes[before].room == here.room {
                continue;
            }
            let ends = [b].into_iter().filter(|m| self.nodes[*m].room == here.room);
            for m in self.doors[here.room].iter().copied().chain(ends).filter(|m| *m != n) {
                let kept_out = self.floor.rooms[here.room].keep_out;
                let factor = if kept_out { KEPT_OUT } else { 1.0 };
                match self.stretches.get(&(n.min(m), n.max(m))) {
                    None => to(m, factor * here.at.distance(self.nodes[m].at)),
                    Some(Some(known)) => to(m, factor * known.cost),
                    Some(None) => {}
                }
            }
        }
        None
    }

    /// Returns true when a room one enters has another door, or is where one wants to go.
    fn leads_on(&self, side: usize, b: usize) -> bool {
        let room = self.nodes[side].room;
        room == self.nodes[b].room || self.doors[room].len() > 1
    }

    /// Looks for the stretch between two nodes of a room: around chairs that somebody may push back and robots that charge, where
    /// that is not far.
    fn stretch(&mut self, a: usize, b: usize) -> Option<Stretch> {
        let near = self.stretch_past(a, b, self.obstacles, false, f64::MAX)?;
        if self.in_use.along_path(&near.path, self.need) >= self.need - ROUNDING_M {
            return Some(near);
        }
        let most = AROUND * near.cost + AROUND_M;
        let around = self.stretch_past(a, b, self.in_use, true, most);
        around.filter(|s| s.cost <= most).or(Some(near))
    }

    /// Looks for the stretch between two nodes of a room past some obstacles that costs at most so much, m.
    fn stretch_past(
        &mut self,
        a: usize,
        b: usize,
        obstacles: &Obstacles,
        in_use: bool,
        most_m: f64,
    ) -> Option<Stretch> {
        let (room, a, b) = (self.nodes[a].room, self.nodes[a].at, self.nodes[b].at);
        let most = self.need + PLAY_M;
        let ends = obstacles.distance(a, most).min(obstacles.distance(b, most));
        let straight = obstacles.along(a, b, most);
        // little play at the ends is no reason for little play between them
        let inner = (END_M / a.distance(b).max(END_M)).min(0.5);
        let at = |t: f64| Point::new(a.x + t * (b.x - a.x), a.y + t * (b.y - a.y));
        let between = || obstacles.along(at(inner), at(1.0 - inner), most) >= self.need + LINE_PLAY_M;
        if straight >= ends.max(self.need) - ROUNDING_M && (straight >= self.need + LINE_PLAY_M || between()) {
            let cost = a.distance(b) * factor(straight - self.need);
            return Some(Stretch { path: vec![a, b], cost });
        }
        let bounds = self.floor.rooms[room].plan.net_polygon.bounds();
        let lattices = self.lattices.entry((room, in_use)).or_insert_with(|| Lattice::all(&bounds));
        let inside = Room { obstacles, need: self.need };
        lattices.iter_mut().find_map(|l| l.path(&inside, a, b, most_m)).map(|(path, cost)| Stretch { path, cost })
    }

    /// Leaves out corners that the way does without and loses no play that counts.
    fn shorten(&self, path: &mut Vec<Point>) {
        let most = self.need + PLAY_M;
        let mut k = 1;
        while k + 1 < path.len() {
            let (before, here, after) = (path[k - 1], path[k], path[k + 1]);
            let now = self.obstacles.along(before, here, most).min(self.obstacles.along(here, after, most));
            let direct = self.obstacles.along(before, after, now);
            let aside =
                (before.distance(here) + here.distance(after) - before.distance(after)) * before.distance(after);
            // a little play at one end is no reason to have no more all along
            let chairs = |a: Point, b: Point| self.in_use.along(a, b, self.need);
            let disturbs = || chairs(before, after) < chairs(before, here).min(chairs(here, after)) - 1e-9;
            if direct >= now - 1e-9 && !disturbs() && (direct >= self.need + LINE_PLAY_M || aside < STRAIGHT_M2) {
                path.remove(k);
                k = k.saturating_sub(1).max(1);
            } else {
                k += 1;
            }
        }
    }
}
