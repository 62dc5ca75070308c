//! Walking distances over the free floor, on every second cell of the occupancy grid (10 cm), eight directions.

use std::collections::VecDeque;

use d3dgen_model::Point;
use d3dgen_model::floorplan::PlanRoom;
use d3dgen_model::occupancy::{CELL_M, Occupancy};

/// Fine cells a step spans: inner walls (12 cm) are thicker than a step, so that none is stepped over.
const STEP: usize = 2;
/// Cost of a straight and of a diagonal step; 5 to 7 is 1 to 1.4.
const COSTS: (u32, u32) = (5, 7);

/// Distances from the nearest of several points.
pub struct Distances {
    nx: usize,
    ny: usize,
    cost: Vec<u32>,
}

impl Distances {
    /// Measures from these points, each taken at the nearest free spot within a step.
    pub fn from(map: &Occupancy, starts: &[Point]) -> Self {
        let (nx, ny) = (map.frame.nx.div_ceil(STEP), map.frame.ny.div_ceil(STEP));
        let mut out = Self { nx, ny, cost: vec![u32::MAX; nx * ny] };
        // a bucket for each cost modulo the largest step: Dial's form of Dijkstra's search
        let mut buckets: Vec<VecDeque<usize>> = vec![VecDeque::new(); COSTS.1 as usize + 1];
        for start in starts {
            for (i, j) in out.around(map, *start) {
                out.cost[j * nx + i] = 0;
                buckets[0].push_back(j * nx + i);
            }
        }
        let free = |i: usize, j: usize| map.free.get(i * STEP, j * STEP);
        let (mut now, mut idle) = (0_u32, 0);
        while idle <= buckets.len() {
            let slot = now as usize % buckets.len();
            let Some(cell) = buckets[slot].pop_front() else {
                now += 1;
                idle += 1;
                continue;
            };
            idle = 0;
            if out.cost[cell] != now {
                continue;
            }
            let (i, j) = (cell % nx, cell / nx);
            for dj in [-1_isize, 0, 1] {
                for di in [-1_isize, 0, 1] {
                    let (Some(x), Some(y)) = (i.checked_add_signed(di), j.checked_add_signed(dj)) else { continue };
                    if x >= nx || y >= ny || !free(x, y) {
                        continue;
                    }
                    let cost = now + if di == 0 || dj == 0 { COSTS.0 } else { COSTS.1 };
                    if cost < out.cost[y * nx + x] {
                        out.cost[y * nx + x] = cost;
                        let slot = cost as usize % buckets.len();
                        buckets[slot].push_back(y * nx + x);
                    }
                }
            }
        }
        out
    }

    /// Returns the way from a point, m; `None` when there is none.
    pub fn at(&self, map: &Occupancy, p: Point) -> Option<f64> {
        self.around(map, p).into_iter().map(|(i, j)| self.cost[j * self.nx + i]).min().and_then(meters)
    }

    /// Returns the longest way from the free floor of a room, m; `None` when none of it is connected.
    pub fn largest_in(&self, map: &Occupancy, room: &PlanRoom) -> Option<f64> {
        self.farthest_in(map, room).map(|(_, way)| way)
    }

    /// Returns the free floor of a room with the longest way, and that way, m; `None` when none of it is connected.
    pub fn farthest_in(&self, map: &Occupancy, room: &PlanRoom) -> Option<(Point, f64)> {
        let mut largest: Option<(u32, usize, usize)> = None;
        for rect in room.net_polygon.rects() {
            let (i0, i1, j0, j1) = map.frame.span(&rect);
            let steps = |a: i64, b: i64| (a.max(0) as usize).div_ceil(STEP)..(b.max(0) as usize).div_ceil(STEP);
            for j in steps(j0, j1) {
                for i in steps(i0, i1) {
                    let here = self.cost.get(j * self.nx + i).copied().filter(|c| *c != u32::MAX);
                    if here.is_some_and(|c| largest.is_none_or(|l| c > l.0)) {
                        largest = here.map(|c| (c, i, j));
                    }
                }
            }
        }
        let (cost, i, j) = largest?;
        Some((map.frame.center(i * STEP, j * STEP), meters(cost)?))
    }

    fn around(&self, map: &Occupancy, p: Point) -> Vec<(usize, usize)> {
        let Some((i, j)) = map.frame.cell(p) else { return Vec::new() };
        let near = |v: usize, n: usize| (v / STEP).saturating_sub(1)..=(v / STEP + 1).min(n.saturating_sub(1));
        near(j, self.ny)
            .flat_map(|y| near(i, self.nx).map(move |x| (x, y)))
            .filter(|(x, y)| map.free.get(x * STEP, y * STEP))
            .collect()
    }
}

fn meters(cost: u32) -> Option<f64> {
    (cost != u32::MAX).then(|| f64::from(cost) * CELL_M * STEP as f64 / f64::from(COSTS.0))
}
