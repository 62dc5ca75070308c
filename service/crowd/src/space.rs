//! The free floor of a storey: walkable outlines and what stands on them, exactly; and a fine lattice over it to search on.

use std::collections::BTreeMap;

use d3dgen_model::floorplan::{Door, Floorplan};
use d3dgen_model::obstacles::{Obstacles, clear_opening};
use d3dgen_model::occupancy::{FLAT_M, ROBOT_HEIGHT_M};
use d3dgen_model::placements::Placements;
use d3dgen_model::{Point, Polygon, Rect};

/// Distance of the nodes of the lattice, m.
pub const STEP_M: f64 = 0.1;
/// Distance to things up to which nodes know it, m.
const MOST_CLEAR_M: f64 = 1.2;
/// How far an opening reaches into the rooms on both sides, m.
const INTO_ROOM_M: f64 = 0.1;
/// How far inside an entrance people leave, m.
const INSIDE_M: f64 = 0.7;
/// Zone of nodes that are no floor.
pub const NOWHERE: u16 = u16::MAX;

/// A storey.
pub struct Space {
    pub level: i32,
    /// Ids of its rooms, in the order of the plan.
    pub rooms: Vec<String>,
    pub outlines: Vec<Polygon>,
    pub doors: Vec<Opening>,
    /// Outlines of what stands there.
    pub things: Vec<Polygon>,
    pub obstacles: Obstacles,
    /// Inside the main entrance, where there is one.
    pub exit: Option<Point>,
    origin: Point,
    pub nx: usize,
    pub ny: usize,
    /// By node: the room it lies in, or behind the rooms the door.
    zones: Vec<u16>,
    /// By node: distance to the nearest thing or wall, m.
    clear: Vec<f32>,
    /// By room: floor on which nothing stands, m2.
    free_floor_m2: Vec<f64>,
}

/// A passage between two rooms.
pub struct Opening {
    pub rooms: [usize; 2],
    pub middle: Point,
    pub outline: Polygon,
    pub clear_width_m: f64,
    /// True where a leaf must be opened by hand.
    pub by_hand: bool,
}

impl Space {
    pub fn new(level: i32, plan: &Floorplan, placements: &Placements) -> Self {
        let rooms: Vec<String> = plan.rooms.iter().map(|r| r.room_id.clone()).collect();
        let index: BTreeMap<&str, usize> = rooms.iter().enumerate().map(|(i, id)| (id.as_str(), i)).collect();
        let outlines: Vec<Polygon> = plan.rooms.iter().map(|r| r.net_polygon.clone()).collect();
        let doors: Vec<Opening> = plan.doors.iter().filter_map(|d| opening(d, &index)).collect();
        let stands = placements.placements.iter().filter(|p| p.top_m() > FLAT_M && p.pose.z < ROBOT_HEIGHT_M);
        let things: Vec<Polygon> =
            stands.map(|p| p.footprint()).chain(plan.obstacles.iter().map(|o| o.outline.clone())).collect();
        let obstacles = Obstacles::of_world(plan, placements, ROBOT_HEIGHT_M);
        let bounds = outlines.iter().map(Polygon::bounds).reduce(|a, b| a.union(&b));
        let bounds = bounds.unwrap_or(Rect::new(0.0, 0.0, 0.0, 0.0)).grown(STEP_M);
        let count = |length: f64| (length / STEP_M).ceil() as usize + 1;
        let (nx, ny) = (count(bounds.width()), count(bounds.height()));
        let origin = Point::new(bounds.x0, bounds.y0);
        let (zones, clear) = (vec![NOWHERE; nx * ny], vec![0.0; nx * ny]);
        let exit = exit(plan);
        let free_floor_m2 = vec![0.0; rooms.len()];
        let mut out = Self {
            level,
            rooms,
            outlines,
            doors,
            things,
            obstacles,
            exit,
            origin,
            nx,
            ny,
            zones,
            clear,
            free_floor_m2,
        };
        out.paint();
        out
    }

    /// Tells each node its room or door, and how far it is from things.
    fn paint(&mut self) {
        for (i, outline) in self.outlines.clone().iter().enumerate() {
            self.set_inside(outline, i as u16, NOWHERE);
        }
        let rooms = self.outlines.len();
        let openings: Vec<Polygon> = self.doors.iter().map(|d| d.outline.clone()).collect();
        for (k, outline) in openings.iter().enumerate() {
            self.set_inside(outline, (rooms + k) as u16, NOWHERE);
        }
        for thing in self.things.clone() {
            self.set_inside(&thing, NOWHERE, 0);
        }
        for n in 0..self.zones.len() {
            if self.zones[n] != NOWHERE {
                self.clear[n] = self.obstacles.distance(self.point(n), MOST_CLEAR_M) as f32;
            }
            if let Some(floor) = self.free_floor_m2.get_mut(usize::from(self.zones[n])) {
                *floor += STEP_M * STEP_M;
            }
        }
    }

    /// Sets the zone of the nodes in an outline, of those that have none yet where the zone is a room or door.
    fn set_inside(&mut self, outline: &Polygon, zone: u16, over: u16) {
        let b = outline.bounds();
        let (i0, j0) = self.column_row(Point::new(b.x0, b.y0));
        let (i1, j1) = self.column_row(Point::new(b.x1, b.y1));
        for j in j0..=(j1 + 1).min(self.ny - 1) {
            for i in i0..=(i1 + 1).min(self.nx - 1) {
                let n = j * self.nx + i;
                let open = over != NOWHERE || self.zones[n] == NOWHERE;
                if open && outline.contains(self.point(n)) {
                    self.zones[n] = zone;
                }
            }
        }
    }

    fn column_row(&self, p: Point) -> (usize, usize) {
        // a float below zero becomes 0
        let at = |v: f64, o: f64, n: usize| (((v - o) / STEP_M) as usize).min(n - 1);
        (at(p.x, self.origin.x, self.nx), at(p.y, self.origin.y, self.ny))
    }

    /// Returns the place of a node.
    pub fn point(&self, n: usize) -> Point {
        let (i, j) = (n % self.nx, n / self.nx);
        Point::new(self.origin.x + i as f64 * STEP_M, self.origin.y + j as f64 * STEP_M)
    }

    /// Returns the room or door of a node.
    pub fn zone(&self, n: usize) -> u16 {
        self.zones[n]
    }

    /// Returns the floor of a room on which nothing stands, m2.
    pub fn free_floor_m2(&self, room: usize) -> f64 {
        self.free_floor_m2[room]
    }

    /// Returns how far a node is from things, m, up to a most.
    pub fn clear(&self, n: usize) -> f64 {
        f64::from(self.clear[n])
    }

    /// Returns the node nearest to a point.
    pub fn node(&self, p: Point) -> usize {
        let half = Point::new(p.x + STEP_M / 2.0, p.y + STEP_M / 2.0);
        let (i, j) = self.column_row(half);
        j * self.nx + i
    }

    /// Returns the eight nodes around one, with how far they are, m.
    pub fn around(&self, n: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let (i, j) = ((n % self.nx) as i64, (n / self.nx) as i64);
        const WAYS: [(i64, i64); 8] = [(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)];
        WAYS.into_iter().filter_map(move |(di, dj)| {
            let (i, j) = (i + di, j + dj);
            let inside = i >= 0 && j >= 0 && i < self.nx as i64 && j < self.ny as i64;
            let far = if di != 0 && dj != 0 { std::f64::consts::SQRT_2 * STEP_M } else { STEP_M };
            inside.then(|| (j as usize * self.nx + i as usize, far))
        })
    }

    /// Returns the room of a point: of a doorway one of the two that it joins.
    pub fn room_at(&self, p: Point) -> Option<usize> {
        let zone = self.zones[self.node(p)];
        if zone == NOWHERE {
            return self.outlines.iter().position(|o| o.contains(p));
        }
        let zone = usize::from(zone);
        Some(if zone < self.rooms.len() { zone } else { self.doors[zone - self.rooms.len()].rooms[0] })
    }

    /// Returns true for a node of a room, or of a doorway of it.
    pub fn belongs(&self, n: usize, room: usize) -> bool {
        let zone = self.zones[n];
        if zone == NOWHERE {
            return false;
        }
        let zone = usize::from(zone);
        zone == room || zone >= self.rooms.len() && self.doors[zone - self.rooms.len()].rooms.contains(&room)
    }

    /// Returns true for a point of the floor that is at least so far from walls and things, m.
    pub fn is_clear(&self, p: Point, least: f64) -> bool {
        let n = self.node(p);
        let known = f64::from(self.clear[n]) - self.point(n).distance(p);
        known >= least || self.is_open(p) && self.obstacles.distance(p, least) >= least - 1e-9
    }

    /// Returns true for a point with a node around it that is floor: far from all edges means inside something, too.
    fn is_open(&self, p: Point) -> bool {
        let n = self.node(p);
        self.zones[n] != NOWHERE || self.around(n).any(|(m, _)| self.zones[m] != NOWHERE)
    }
}

/// Returns a point inside the main entrance.
fn exit(plan: &Floorplan) -> Option<Point> {
    let out = || plan.doors.iter().filter(|d| d.room_ids.len() == 1);
    let door = out().find(|d| d.entrance).or_else(|| out().next())?;
    let room = plan.room(&door.room_ids[0])?;
    let (middle, line) = (door.line.middle(), &door.line);
    let length = line.length().max(1e-6);
    let (nx, ny) = (-(line.end.y - line.start.y) / length * INSIDE_M, (line.end.x - line.start.x) / length * INSIDE_M);
    let both = [Point::new(middle.x + nx, middle.y + ny), Point::new(middle.x - nx, middle.y - ny)];
    both.into_iter().find(|p| room.net_polygon.contains(*p))
}

/// Returns the passage of a door between two rooms.
fn opening(door: &Door, index: &BTreeMap<&str, usize>) -> Option<Opening> {
    let [a, b] = door.room_ids.as_slice() else { return None };
    let rooms = [*index.get(a.as_str())?, *index.get(b.as_str())?];
    let line = clear_opening(door);
    let length = line.length().max(1e-6);
    let normal = Point::new(-(line.end.y - line.start.y) / length, (line.end.x - line.start.x) / length);
    let deep = door.wall_thickness_m / 2.0 + INTO_ROOM_M;
    let (dx, dy) = (normal.x * deep, normal.y * deep);
    let (s, e) = (line.start, line.end);
    let outline = Polygon(vec![
        Point::new(s.x - dx, s.y - dy),
        Point::new(e.x - dx, e.y - dy),
        Point::new(e.x + dx, e.y + dy),
        Point::new(s.x + dx, s.y + dy),
    ]);
    let by_hand = door.swing.is_some() && !door.automatic;
    let clear_width_m = door.clear_width_m;
    Some(Opening { rooms, middle: line.middle(), outline, clear_width_m, by_hand })
}
