//! Room to move: which floor a robot's disc can use, kept up to date while furniture is placed.

use std::rc::Rc;

use d3dgen_model::occupancy::{Bitmap, Frame};

use super::geom::{Box2, mm};
use super::space::Space;

/// Half the edge of a grid cell, mm.
const HALF: i32 = 25;
/// Clear floor that may be cut off in a room before it counts as split, as a share of the whole.
const POCKET_SHARE: f64 = 0.03;
/// Clear floor a single pocket may have whatever the room's size: a quarter of this many cells is 1 dm^2.
const POCKET_CELLS: usize = 12;

/// Clear floor of one room for one radius.
#[derive(Debug)]
pub(crate) struct Nav {
    shared: Rc<Ground>,
    /// Cells where the disc's center can be; reaches through the doors.
    clear: Bitmap,
    /// Those of them connected to the first door.
    main: Bitmap,
    /// How many of `main` and of `clear` lie in the room.
    area: usize,
    total: usize,
    /// True when `main` is what can really be reached.
    whole: bool,
}

impl Clone for Nav {
    fn clone(&self) -> Self {
        Self { shared: Rc::clone(&self.shared), clear: self.clear.clone(), main: self.main.clone(), ..*self }
    }

    /// Takes over `source` in the memory of `self`: routes are tested thousands of times.
    fn clone_from(&mut self, source: &Self) {
        if !Rc::ptr_eq(&self.shared, &source.shared) {
            self.shared = Rc::clone(&source.shared);
        }
        self.clear.clone_from(&source.clear);
        self.main.clone_from(&source.main);
        (self.area, self.total, self.whole) = (source.area, source.total, source.whole);
    }
}

/// What does not change while a room is furnished.
#[derive(Debug)]
struct Ground {
    frame: Frame,
    /// Net floor.
    inside: Bitmap,
    /// A cell in each door, outside the wall.
    doors: Vec<(usize, usize)>,
    radius: i32,
    /// South-west corner of the grid, mm.
    origin: (i32, i32),
}

impl Nav {
    /// Returns the empty room for a disc of this radius, mm. Doors never limit it: their width is the plan's business.
    pub fn new(space: &Space, radius: i32) -> Self {
        let frame = Frame::around(space.bounds.grown(radius + 450).meters());
        let mut inside = Bitmap::new(frame.nx, frame.ny);
        for rect in space.floor_rects() {
            let (i0, i1, j0, j1) = frame.span(&rect.meters());
            inside.fill(i0, i1, j0, j1, true);
        }
        let mut floor = inside.clone();
        let mut doors = Vec::new();
        for door in &space.doors {
            let wall = &space.walls[door.wall];
            let (mid, half) = ((door.v0 + door.v1) / 2, ((door.v1 - door.v0) / 2).max(radius + 75));
            let (i0, i1, j0, j1) = frame.span(&wall.strip(mid - half, mid + half, -(radius + 400), 50).meters());
            floor.fill(i0, i1, j0, j1, true);
            let seed = wall.strip(mid - 1, mid + 1, -220, -218);
            doors.extend(frame.cell(seed.center_m()));
        }
        let clear = floor.eroded(f64::from(radius) / f64::from(2 * HALF));
        let total = clear.count_common(&inside);
        let origin = (mm(frame.origin.x), mm(frame.origin.y));
        let ground = Ground { frame, inside, doors, radius, origin };
        let main = clear.clone();
        let mut out = Self { main, clear, area: total, total, whole: false, shared: Rc::new(ground) };
        out.settle();
        out
    }

    /// Takes what an obstacle leaves no room for.
    ///
    /// What stays is connected still when the edge of the lost part meets the reachable floor in one piece; otherwise
    /// [`Nav::settle`] has to look.
    pub fn block(&mut self, obstacle: &Box2) {
        let ground = Rc::clone(&self.shared);
        let (o, radius) = (obstacle, ground.radius);
        // first cell whose center is at or beyond a coordinate, and one past the last at or before it
        let first = |v: i32, origin: i32| i64::from((v - origin + HALF - 1).div_euclid(2 * HALF));
        let last = |v: i32, origin: i32| i64::from((v - origin + HALF).div_euclid(2 * HALF));
        let (j0, j1) = (first(o.y0 - radius, ground.origin.1), last(o.y1 + radius, ground.origin.1));
        let (i0, i1) = (first(o.x0 - radius, ground.origin.0), last(o.x1 + radius, ground.origin.0));
        let mut remove = |a, b, j0, j1| {
            self.total -= self.clear.remove_counting(a, b, j0, j1, &ground.inside);
            self.area -= self.main.remove_counting(a, b, j0, j1, &ground.inside);
        };
        // beside the obstacle the lost part is straight, before and behind it round
        let (beside0, beside1) = (first(o.y0, ground.origin.1), last(o.y1, ground.origin.1));
        remove(i0, i1, beside0, beside1);
        for j in (j0..beside0).chain(beside1..j1) {
            let y = i64::from(ground.origin.1) + (2 * j + 1) * i64::from(HALF);
            let dy = (i64::from(o.y0) - y).max(y - i64::from(o.y1)) as i32;
            let half = f64::from(radius * radius - dy * dy).max(0.0).sqrt() as i32;
            let (a, b) = (first(o.x0 - half, ground.origin.0), last(o.x1 + half, ground.origin.0));
            remove(a, b, j, j + 1);
        }
        if self.whole {
            self.whole = self.main.pieces_around(i0 - 1, i1 + 1, j0 - 1, j1 + 1) <= 1;
        }
    }

    /// Brings the reachable floor up to date after obstacles; returns true when every door and nearly all clear floor
    /// belongs to it.
    pub fn settle(&mut self) -> bool {
        let ground = Rc::clone(&self.shared);
        if !self.whole {
            let mut seed = Bitmap::new(ground.frame.nx, ground.frame.ny);
            match ground.doors.first() {
                Some(&(i, j)) => seed.set(i, j),
                None => {
                    let largest = self.clear.components().into_iter().next();
                    seed = largest.unwrap_or(seed);
                }
            }
            self.main = self.clear.flood(&seed);
            self.whole = true;
            self.area = self.main.count_common(&ground.inside);
        }
        let allowed = ((self.total as f64 * POCKET_SHARE) as usize).clamp(POCKET_CELLS, 4 * POCKET_CELLS);
        let doors = ground.doors.iter().all(|&(i, j)| self.main.get(i, j));
        doors && self.area > 0 && self.total - self.area <= allowed
    }

    /// Returns the narrowest gap that the disc passes, mm.
    pub fn gap(&self) -> i32 {
        2 * self.shared.radius + 2 * HALF
    }

    /// Returns true when a robot can leave each of these spots while others stand on all the rest, mm.
    pub fn passes_parked(&self, spots: &[Box2]) -> bool {
        let leaves = |own: usize| {
            let mut nav = self.clone();
            let parked = spots.iter().enumerate().filter(|(k, _)| *k != own).map(|(_, spot)| spot);
            parked.for_each(|spot| nav.block(&spot.grown(nav.shared.radius)));
            nav.whole = false;
            nav.settle();
            nav.reaches(&spots[own..=own])
        };
        spots.len() < 2 || (0..spots.len()).all(leaves)
    }

    /// Returns the number of cells in the room that the disc's center can reach.
    pub fn area(&self) -> usize {
        self.area
    }

    /// Returns true when the disc can come up to one of the rectangles.
    pub fn reaches(&self, targets: &[Box2]) -> bool {
        let margin = self.shared.radius + 100;
        targets.iter().any(|t| {
            let (i0, i1, j0, j1) = self.shared.frame.span(&t.grown(margin).meters());
            self.main.any_in(i0, i1, j0, j1)
        })
    }
}
