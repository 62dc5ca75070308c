//! Occupancy of a floorplan on a 5 cm grid: where a robot of a given radius can be.
//!
//! A cell is named by the position of its center. Floor is the net polygons of the rooms and the openings of the doors;
//! what stands on it blocks it when it is lower than [`ROBOT_HEIGHT_M`] and higher than [`FLAT_M`]. A cell is clear for
//! a radius when no cell that is not free floor is nearer than that radius.

mod bitmap;

use std::collections::BTreeMap;

pub use bitmap::Bitmap;

use crate::floorplan::{Door, Floorplan};
use crate::geometry::{Point, Polygon, Rect};
use crate::placements::{Placement, Placements};

/// Edge of a grid cell, m.
pub const CELL_M: f64 = 0.05;
/// Things no higher than this are floor covering: one can drive over them, m.
pub const FLAT_M: f64 = 0.03;
/// Things that begin at this height or above do not stop a robot, m.
pub const ROBOT_HEIGHT_M: f64 = 1.2;

/// Where a grid lies in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// South-west corner of cell (0, 0).
    pub origin: Point,
    /// Columns, west to east.
    pub nx: usize,
    /// Rows, south to north.
    pub ny: usize,
}

impl Frame {
    /// Returns the grid that covers a rectangle.
    pub fn around(rect: Rect) -> Self {
        let cells = |length: f64| (length / CELL_M).ceil().max(1.0) as usize + 1;
        Self { origin: Point::new(rect.x0, rect.y0), nx: cells(rect.width()), ny: cells(rect.height()) }
    }

    /// Returns the center of a cell.
    pub fn center(&self, i: usize, j: usize) -> Point {
        Point::new(self.origin.x + (i as f64 + 0.5) * CELL_M, self.origin.y + (j as f64 + 0.5) * CELL_M)
    }

    /// Returns the cell around a point; `None` outside the grid.
    pub fn cell(&self, p: Point) -> Option<(usize, usize)> {
        let (i, j) = ((p.x - self.origin.x) / CELL_M, (p.y - self.origin.y) / CELL_M);
        (i >= 0.0 && j >= 0.0 && i < self.nx as f64 && j < self.ny as f64).then_some((i as usize, j as usize))
    }

    /// Returns the columns and rows `(i0, i1, j0, j1)`, ends excluded, of the cells whose centers lie in the rectangle;
    /// they may reach outside the grid.
    pub fn span(&self, rect: &Rect) -> (i64, i64, i64, i64) {
        // 1e-6: a center exactly on the edge counts as inside whatever the rounding of the division
        let first = |v: f64, o: f64| ((v - o) / CELL_M - 0.5 - 1e-6).ceil() as i64;
        let last = |v: f64, o: f64| ((v - o) / CELL_M - 0.5 + 1e-6).floor() as i64 + 1;
        let (o, r) = (self.origin, rect);
        (first(r.x0, o.x), last(r.x1, o.x), first(r.y0, o.y), last(r.y1, o.y))
    }

    /// Returns the columns and rows of the cells of the grid whose centers lie in the rectangle, row after row.
    pub fn cells(&self, rect: &Rect) -> impl Iterator<Item = (usize, usize)> + use<> {
        let (i0, i1, j0, j1) = self.span(rect);
        let within = |v: i64, n: usize| v.clamp(0, n as i64) as usize;
        let (columns, rows) = (within(i0, self.nx)..within(i1, self.nx), within(j0, self.ny)..within(j1, self.ny));
        rows.flat_map(move |j| columns.clone().map(move |i| (i, j)))
    }

    /// Adds to (`value` true) or removes from a bitmap the cells whose centers lie in the polygon.
    pub fn paint(&self, map: &mut Bitmap, polygon: &Polygon, value: bool) {
        if polygon.is_rectilinear() {
            for rect in polygon.rects() {
                let (i0, i1, j0, j1) = self.span(&rect);
                map.fill(i0, i1, j0, j1, value);
            }
            return;
        }
        let (i0, i1, j0, j1) = self.span(&polygon.bounds());
        for j in j0.max(0)..j1 {
            for i in i0.max(0)..i1 {
                if polygon.contains(self.center(i as usize, j as usize)) {
                    map.fill(i, i + 1, j, j + 1, value);
                }
            }
        }
    }
}

/// Floor and free floor of a building.
#[derive(Debug, Clone)]
pub struct Occupancy {
    /// Where the bitmaps lie.
    pub frame: Frame,
    /// Net floor of all rooms and door openings.
    pub floor: Bitmap,
    /// Floor that nothing blocks.
    pub free: Bitmap,
}

/// How much of the free floor a robot can use.
#[derive(Debug, Clone)]
pub struct Reach {
    /// Cells the robot's center can be at, connected to most of the others: the largest component, or the one asked for.
    pub main: Bitmap,
    /// Share of all clear cells that lie in `main`, 0 to 1; 0 when no cell is clear.
    pub largest_share: f64,
    /// By room id: share of the room's clear cells that lie in `main`, 0 to 1; 0 when the room has none.
    pub room_share: BTreeMap<String, f64>,
}

impl Occupancy {
    /// Returns the empty building.
    pub fn of_floorplan(plan: &Floorplan) -> Self {
        let bounds = plan.rooms.iter().map(|r| r.polygon.bounds()).reduce(|a, b| a.union(&b));
        let bounds = bounds.unwrap_or(Rect::new(0.0, 0.0, 0.0, 0.0));
        let frame = Frame::around(bounds.grown(0.5));
        let mut floor = Bitmap::new(frame.nx, frame.ny);
        for room in &plan.rooms {
            frame.paint(&mut floor, &room.net_polygon, true);
        }
        for obstacle in &plan.obstacles {
            frame.paint(&mut floor, &obstacle.outline, false);
        }
        for door in &plan.doors {
            let (i0, i1, j0, j1) = frame.span(&opening(door));
            floor.fill(i0, i1, j0, j1, true);
        }
        Self { frame, free: floor.clone(), floor }
    }

    /// Returns the furnished building.
    pub fn of_world(plan: &Floorplan, placements: &Placements) -> Self {
        let mut out = Self::of_floorplan(plan);
        placements.placements.iter().filter(|p| stops_robot(p)).for_each(|p| out.block(&p.footprint()));
        out
    }

    /// Takes the cells of an outline from the free floor.
    pub fn block(&mut self, outline: &Polygon) {
        self.frame.paint(&mut self.free, outline, false);
    }

    /// Returns the cells where the center of a disc of this radius (m) can be.
    pub fn clear(&self, radius_m: f64) -> Bitmap {
        self.free.eroded(radius_m / CELL_M)
    }

    /// Returns the center of the cell of `map` nearest to a point; `None` when the map is empty.
    ///
    /// Ties go to the southern, then the western cell.
    pub fn nearest(&self, map: &Bitmap, p: Point) -> Option<Point> {
        let squared = |c: Point| (c.x - p.x).powi(2) + (c.y - p.y).powi(2);
        map.cells().map(|(i, j)| self.frame.center(i, j)).min_by(|a, b| squared(*a).total_cmp(&squared(*b)))
    }

    /// Returns what a disc of this radius (m) can reach, over all and room by room.
    pub fn reach(&self, plan: &Floorplan, radius_m: f64) -> Reach {
        self.reach_around(plan, radius_m, &Bitmap::new(self.frame.nx, self.frame.ny))
    }

    /// Returns what a disc of this radius (m) can reach from any of these cells; the largest part, where it stands on none.
    pub fn reach_around(&self, plan: &Floorplan, radius_m: f64, start: &Bitmap) -> Reach {
        let clear = self.clear(radius_m);
        let around = clear.flood(start);
        let main = if around.is_empty() { clear.largest().unwrap_or(around) } else { around };
        let share = |part: usize, whole: usize| if whole == 0 { 0.0 } else { part as f64 / whole as f64 };
        // one room after the other in one set: nothing is gone through but the floor around each
        let mut cells = Bitmap::new(self.frame.nx, self.frame.ny);
        let room_share = plan.rooms.iter().map(|room| {
            let (i0, i1, j0, j1) = self.frame.span(&room.net_polygon.bounds());
            self.frame.paint(&mut cells, &room.net_polygon, true);
            let count = |map: &Bitmap| map.count_common_in(&cells, i0, i1, j0, j1);
            let found = (room.room_id.clone(), share(count(&main), count(&clear)));
            cells.fill(i0, i1, j0, j1, false);
            found
        });
        let room_share = room_share.collect();
        Reach { largest_share: share(main.count(), clear.count()), room_share, main }
    }
}

/// Returns true when the object stops a robot: not flat on the floor, not above its head.
pub fn stops_robot(p: &Placement) -> bool {
    p.top_m() > FLAT_M && p.pose.z < ROBOT_HEIGHT_M
}

/// Returns the floor of a door's opening through its wall, a cell deeper on both sides so that it joins the rooms.
pub(crate) fn opening(door: &Door) -> Rect {
    let (a, b) = (door.line.start, door.line.end);
    let half = door.wall_thickness_m / 2.0 + CELL_M;
    let r = Rect::new(a.x, a.y, b.x, b.y);
    if door.line.is_vertical() {
        Rect { x0: r.x0 - half, x1: r.x1 + half, ..r }
    } else {
        Rect { y0: r.y0 - half, y1: r.y1 + half, ..r }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::Materials;
    use crate::floorplan::{DoorKind, PlanRoom};
    use crate::geometry::Segment;

    fn room(id: &str, x0: f64, x1: f64) -> PlanRoom {
        let polygon = Polygon(Rect::new(x0, 0.0, x1, 4.0).corners().to_vec());
        let net = Rect::new(x0 + 0.06, 0.06, x1 - 0.06, 3.94);
        PlanRoom {
            room_id: id.into(),
            room_type: "room".into(),
            name: id.into(),
            circulation: false,
            polygon,
            net_area_m2: net.area(),
            net_polygon: Polygon(net.corners().to_vec()),
            ceiling_height_m: 2.5,
            materials: Materials { floor: String::new(), wall: String::new(), ceiling: String::new() },
            locked: false,
            level: 0,
        }
    }

    fn two_rooms(door_width: f64) -> Floorplan {
        Floorplan {
            version: 1,
            seed: 0,
            scheme: "test".into(),
            rooms: vec![room("a_1", 0.0, 4.0), room("b_1", 4.0, 8.0)],
            walls: Vec::new(),
            doors: vec![Door {
                door_id: "door_1".into(),
                kind: DoorKind::Open,
                line: Segment { start: Point::new(4.0, 1.0), end: Point::new(4.0, 1.0 + door_width) },
                clear_width_m: door_width,
                height_m: 2.1,
                wall_thickness_m: 0.12,
                room_ids: vec!["a_1".into(), "b_1".into()],
                entrance: false,
                swing: None,
                slide: None,
                automatic: false,
                locked: false,
            }],
            windows: Vec::new(),
            obstacles: Vec::new(),
            cost: Vec::new(),
            conflicts: Vec::new(),
            levels: Vec::new(),
            links: Vec::new(),
        }
    }

    #[test]
    fn a_door_lets_through_what_fits() {
        let plan = two_rooms(0.9);
        let map = Occupancy::of_floorplan(&plan);
        assert_eq!(map.reach(&plan, 0.3).largest_share, 1.0);
        let wide = map.reach(&plan, 0.5);
        assert!(wide.largest_share < 0.6, "a disc of 1 m cannot pass a door of 0.9 m: {}", wide.largest_share);
    }

    #[test]
    fn furniture_blocks_and_nearest_avoids_it() {
        let plan = two_rooms(0.9);
        let mut map = Occupancy::of_floorplan(&plan);
        let before = map.free.count();
        map.block(&Polygon(Rect::new(1.0, 1.0, 2.0, 2.0).corners().to_vec()));
        assert_eq!(before - map.free.count(), 400);
        let p = map.nearest(&map.clear(0.3), Point::new(1.1, 1.5)).expect("most of the floor is free");
        assert!((p.x - 0.7).abs() < 0.06 && (p.y - 1.5).abs() < 0.06, "{p:?}");
        assert_eq!(map.frame.cell(map.frame.center(3, 7)), Some((3, 7)));
    }
}
