//! The widest way to every place of a storey: how wide its narrowest place is, and where that is.
//!
//! On the 5 cm grid of [`crate::occupancy`]. The width of a place is the diameter of the largest disc whose center can be
//! there; in a door it is no more than the door's clear width. A long robot ([`crate::robot_body`]) goes as its body does:
//! straight through what is narrow, turned where there is room for that. What is lower than a robot stops it, doors too.

mod long;

use std::collections::BinaryHeap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::floorplan::{Door, Floorplan};
use crate::geometry::{Point, Rect};
use crate::occupancy::{Bitmap, CELL_M, FLAT_M, Occupancy, opening};
use crate::placements::Placements;
use crate::scene_graph::Robot;

/// How far from a point its best cell may lie, m.
const NEAR_M: f64 = 0.25;
/// Slack when a width is compared with a robot's, mm.
const SLACK_MM: u32 = 1;
/// Width that stands for a door lower than the robot: such ways are found, to be named, where there is no other one, mm.
const LOW_DOOR_MM: u32 = 1;
/// Slack when a robot's height is compared with a door's, m.
const SLACK_M: f64 = 1e-6;

/// The way of a robot to a room or point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotWay {
    /// Room id or POI id it leads to.
    pub to: String,
    /// True when the robot gets there.
    pub reachable: bool,
    /// Clear width of the narrowest place on the widest way there, m; 0 when there is no way at all.
    pub clear_width_m: f64,
    /// Door in which the narrowest place is, else the room it lies in; empty when there is no way at all.
    pub narrowest: String,
    /// Height of the lowest door on the way where the robot is higher and there is no way around, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clear_height_m: Option<f64>,
}

impl RobotWay {
    /// Returns that no way leads there.
    pub fn none(to: &str) -> Self {
        let (narrowest, clear_height_m) = (String::new(), None);
        Self { to: to.to_owned(), reachable: false, clear_width_m: 0.0, narrowest, clear_height_m }
    }
}

/// Widest ways from one place of a storey.
#[derive(Debug)]
pub struct Passages<'a> {
    plan: &'a Floorplan,
    map: Occupancy,
    /// By cell: diameter of the largest disc there, mm.
    wide: Vec<u32>,
    /// By cell: the narrowest width on the widest way, mm (0: no way), and the cell where it is.
    best: Vec<(u32, u32)>,
    /// Of a long robot: the cells where its middle gets to, and half its length, m.
    driven: Option<(Bitmap, f64)>,
}

impl<'a> Passages<'a> {
    /// Finds the ways from a point for a robot: it passes under what hangs above its height and over what is no higher than
    /// it climbs.
    pub fn new(plan: &'a Floorplan, placements: &Placements, robot: &Robot, from: Point) -> Self {
        let mut map = Occupancy::of_floorplan(plan);
        let low = robot.body.and_then(|b| b.climb_m).unwrap_or(0.0).max(FLAT_M);
        let stops = placements.placements.iter().filter(|p| p.top_m() > low && p.pose.z < robot.height_m);
        stops.for_each(|p| map.block(&p.footprint()));
        let mut wide = clear_widths(&map, plan);
        for door in plan.doors.iter().filter(|d| d.height_m < robot.height_m - SLACK_M) {
            for (i, j) in map.frame.cells(&opening(door)) {
                let cell = &mut wide[j * map.frame.nx + i];
                *cell = (*cell).min(LOW_DOOR_MM);
            }
        }
        let mut out = Self { plan, best: vec![(0, 0); wide.len()], wide, map, driven: None };
        out.spread(from);
        if let Some([width, length]) = robot.body.and_then(|b| b.long_m()) {
            let starts = out.within(from, length / 2.0);
            out.driven = Some((long::driven(&out.map.frame, &out.wide, (width, length), &starts), length / 2.0));
        }
        out
    }

    /// Returns the floor of a point's room up to this far from it, m: a long robot stops at it with one end.
    fn within(&self, p: Point, far: f64) -> Vec<Rect> {
        let near = Rect::new(p.x - far, p.y - far, p.x + far, p.y + far);
        let Some(room) = self.plan.rooms.iter().find(|r| r.net_polygon.contains(p)) else { return vec![around(p)] };
        let common = |r: Rect| Rect {
            x0: r.x0.max(near.x0),
            y0: r.y0.max(near.y0),
            x1: r.x1.min(near.x1),
            y1: r.y1.min(near.y1),
        };
        room.net_polygon.rects().into_iter().map(common).filter(|r| r.x1 > r.x0 && r.y1 > r.y0).collect()
    }

    /// Returns the way to a room: to the place in it that is reached best.
    pub fn to_room(&self, room_id: &str, radius_m: f64) -> RobotWay {
        // the middle of a door sill is not yet the room
        let rects = self.plan.room(room_id).map_or(Vec::new(), |room| room.net_polygon.rects());
        self.way(room_id, &rects, &rects, radius_m)
    }

    /// Returns the way to a point.
    pub fn to_point(&self, name: &str, p: Point, radius_m: f64) -> RobotWay {
        let ends = self.driven.as_ref().map_or(Vec::new(), |(_, half)| self.within(p, *half));
        self.way(name, &[around(p)], &ends, radius_m)
    }

    /// Returns the way to the best place in some floor; a long robot's middle gets to that in `ends`.
    fn way(&self, to: &str, rects: &[Rect], ends: &[Rect], radius_m: f64) -> RobotWay {
        let (width, at) = rects.iter().map(|r| self.best_in(r)).max().unwrap_or((0, 0));
        if width == 0 {
            return RobotWay::none(to);
        }
        let place = self.place(at);
        let low = self.door_at(place).filter(|_| width == LOW_DOOR_MM);
        let needed = (2000.0 * radius_m).round() as u32;
        let reachable = match &self.driven {
            Some((driven, _)) => ends.iter().flat_map(|r| self.map.frame.cells(r)).any(|(i, j)| driven.get(i, j)),
            None => width + SLACK_MM >= needed && low.is_none(),
        };
        RobotWay {
            to: to.to_owned(),
            reachable,
            clear_width_m: low.map_or(f64::from(width) / 1000.0, |d| d.clear_width_m),
            narrowest: self.name(place),
            clear_height_m: low.map(|d| d.height_m),
        }
    }

    fn best_in(&self, rect: &Rect) -> (u32, u32) {
        let frame = &self.map.frame;
        frame.cells(rect).map(|(i, j)| self.best[j * frame.nx + i]).max_by_key(|b| b.0).unwrap_or((0, 0))
    }

    fn place(&self, cell: u32) -> Point {
        let nx = self.map.frame.nx;
        self.map.frame.center(cell as usize % nx, cell as usize / nx)
    }

    fn door_at(&self, p: Point) -> Option<&'a Door> {
        let inside = |r: &Rect| r.x0 <= p.x && p.x <= r.x1 && r.y0 <= p.y && p.y <= r.y1;
        self.plan.doors.iter().find(|d| inside(&opening(d)))
    }

    /// Returns the door or the room that a place lies in.
    fn name(&self, p: Point) -> String {
        let room = || self.plan.rooms.iter().find(|r| r.net_polygon.contains(p));
        self.door_at(p).map(|d| d.door_id.clone()).or_else(|| room().map(|r| r.room_id.clone())).unwrap_or_default()
    }

    /// Goes out from a point, the widest place first.
    fn spread(&mut self, from: Point) {
        let (nx, ny) = (self.map.frame.nx as i64, self.map.frame.ny as i64);
        let cells = self.map.frame.cells(&around(from)).map(|(i, j)| j * self.map.frame.nx + i);
        let Some(start) = cells.max_by_key(|k| (self.wide[*k], usize::MAX - k)).filter(|k| self.wide[*k] > 0) else {
            return;
        };
        let mut open = BinaryHeap::from([(self.wide[start], start as u32)]);
        self.best[start] = (self.wide[start], start as u32);
        while let Some((width, cell)) = open.pop() {
            let (best, at) = self.best[cell as usize];
            if width < best {
                continue;
            }
            let (i, j) = (i64::from(cell) % nx, i64::from(cell) / nx);
            for (x, y) in [(i - 1, j), (i + 1, j), (i, j - 1), (i, j + 1)] {
                if x < 0 || y < 0 || x >= nx || y >= ny {
                    continue;
                }
                let next = (y * nx + x) as usize;
                let narrow = self.wide[next].min(width);
                if narrow > self.best[next].0 {
                    self.best[next] = (narrow, if self.wide[next] < width { next as u32 } else { at });
                    open.push((narrow, next as u32));
                }
            }
        }
    }
}

/// Returns the floor near a point.
fn around(p: Point) -> Rect {
    Rect::new(p.x - NEAR_M, p.y - NEAR_M, p.x + NEAR_M, p.y + NEAR_M)
}

/// Returns the diameter of the largest disc at each cell, mm, row after row from the south; in a door no more than its
/// clear width.
pub fn clear_widths(map: &Occupancy, plan: &Floorplan) -> Vec<u32> {
    let (nx, ny) = (map.frame.nx, map.frame.ny);
    let mut wide: Vec<u32> = squared_distances(nx, ny, |i, j| map.free.get(i, j))
        .into_iter()
        .map(|d| (2.0 * CELL_M * 1000.0 * f64::from(d).sqrt()) as u32)
        .collect();
    for door in &plan.doors {
        let most = (door.clear_width_m * 1000.0).round() as u32;
        for (i, j) in map.frame.cells(&opening(door)) {
            wide[j * nx + i] = wide[j * nx + i].min(most);
        }
    }
    wide
}

/// Returns the squared distance of each cell to the nearest one that is not free, in cells: exact, in two sweeps.
fn squared_distances(nx: usize, ny: usize, free: impl Fn(usize, usize) -> bool) -> Vec<u32> {
    let far = (nx + ny) as i32;
    // rows one after the other, as they lie in memory
    let mut up = vec![0_i32; nx * ny];
    for j in 0..ny {
        for i in 0..nx {
            let before = if j == 0 { 0 } else { up[(j - 1) * nx + i] };
            up[j * nx + i] = if free(i, j) { (before + 1).min(far) } else { 0 };
        }
    }
    for j in (0..ny).rev() {
        for i in 0..nx {
            let before = if j + 1 == ny { 0 } else { up[(j + 1) * nx + i] };
            up[j * nx + i] = up[j * nx + i].min(before + 1);
        }
    }
    let mut out = vec![0_u32; nx * ny];
    // lower envelope of the parabolas of one row, stretch by stretch between cells that are not free
    let (mut sites, mut starts) = (vec![0_usize; nx], vec![0_i32; nx]);
    for j in 0..ny {
        let g = &up[j * nx..(j + 1) * nx];
        let row = &mut out[j * nx..(j + 1) * nx];
        let mut end = 0;
        while let Some(first) = (end..nx).find(|&i| g[i] > 0) {
            end = (first..nx).find(|&i| g[i] == 0).unwrap_or(nx);
            stretch(g, row, (first.saturating_sub(1), (end + 1).min(nx)), (&mut sites, &mut starts));
        }
    }
    out
}

/// Fills in the squared distances of the cells `low..high` of a row whose cells lie `g` away from what is not free along
/// their columns.
fn stretch(g: &[i32], row: &mut [u32], (low, high): (usize, usize), (sites, starts): (&mut [usize], &mut [i32])) {
    let at = |x: i32, i: usize| (x - i as i32).pow(2) + g[i] * g[i];
    let mut q = 0_usize;
    (sites[0], starts[0]) = (low, low as i32);
    let mut count = 1;
    for u in low + 1..high {
        while count > 0 && at(starts[q], sites[q]) > at(starts[q], u) {
            count -= 1;
            q = q.saturating_sub(1);
        }
        if count == 0 {
            (q, count) = (0, 1);
            (sites[0], starts[0]) = (u, low as i32);
        } else {
            let i = sites[q] as i32;
            let (v, gi) = (u as i32, g[sites[q]]);
            let w = 1 + (v * v - i * i + g[u] * g[u] - gi * gi).div_euclid(2 * (v - i));
            if w < high as i32 {
                q += 1;
                count += 1;
                (sites[q], starts[q]) = (u, w);
            }
        }
    }
    for u in (low..high).rev() {
        row[u] = at(u as i32, sites[q]) as u32;
        if u as i32 == starts[q] && q > 0 {
            q -= 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_of_looking_at_every_cell() {
        let (nx, ny) = (23, 17);
        let free = |i: usize, j: usize| {
            i > 0 && j > 0 && i < nx - 1 && j < ny - 1 && !(i * 7 + j * 13).is_multiple_of(41) && !(i == 11 && j > 5)
        };
        let found = squared_distances(nx, ny, free);
        for j in 0..ny {
            for i in 0..nx {
                let blocked = (0..nx * ny).map(|k| (k % nx, k / nx)).filter(|&(x, y)| !free(x, y));
                let least = blocked.map(|(x, y)| (x.abs_diff(i).pow(2) + y.abs_diff(j).pow(2)) as u32).min();
                assert_eq!(Some(found[j * nx + i]), least, "({i}, {j})");
            }
        }
    }
}
