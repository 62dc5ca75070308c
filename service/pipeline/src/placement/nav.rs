//! Room to move: which floor a robot's disc can use, kept up to date while furniture is placed.

use d3dgen_model::geometry::Rect;
use d3dgen_model::occupancy::{Bitmap, CELL_M, Frame};

use super::geom::Box2;
use super::space::Space;

/// Clear floor that may be cut off in a room before it counts as split, as a share of the whole.
const POCKET_SHARE: f64 = 0.03;
/// Clear floor a single pocket may have whatever the room's size: a quarter of this many cells is 1 dm^2.
const POCKET_CELLS: usize = 12;

/// Clear floor of one room for one radius.
#[derive(Debug, Clone)]
pub(super) struct Nav {
    frame: Frame,
    /// Net floor.
    inside: Bitmap,
    /// Cells where the disc's center can be; reaches through the doors.
    clear: Bitmap,
    /// A cell in each door, outside the wall.
    doors: Vec<(usize, usize)>,
    radius_m: f64,
}

/// Floor a robot can use after a move.
pub(super) struct Routes {
    /// Cells connected to the first door.
    pub main: Bitmap,
    /// Clear cells inside the room in `main`.
    pub area: usize,
}

fn rect_m(b: &Box2) -> Rect {
    let m = |v: i32| f64::from(v) / 1000.0;
    Rect { x0: m(b.x0), y0: m(b.y0), x1: m(b.x1), y1: m(b.y1) }
}

impl Nav {
    /// Returns the empty room for a disc of this radius, mm. Doors never limit it: their width is the plan's business.
    pub fn new(space: &Space, radius: i32) -> Self {
        let frame = Frame::around(rect_m(&space.bounds.grown(radius + 450)));
        let mut inside = Bitmap::new(frame.nx, frame.ny);
        for rect in space.floor_rects() {
            let (i0, i1, j0, j1) = frame.span(&rect_m(&rect));
            inside.fill(i0, i1, j0, j1, true);
        }
        let mut floor = inside.clone();
        let mut doors = Vec::new();
        for door in &space.doors {
            let wall = &space.walls[door.wall];
            let (mid, half) = ((door.v0 + door.v1) / 2, ((door.v1 - door.v0) / 2).max(radius + 75));
            let (i0, i1, j0, j1) = frame.span(&rect_m(&wall.strip(mid - half, mid + half, -(radius + 400), 50)));
            floor.fill(i0, i1, j0, j1, true);
            let seed = wall.strip(mid - 1, mid + 1, -220, -218);
            doors.extend(frame.cell(seed.center_m()));
        }
        let radius_m = f64::from(radius) / 1000.0;
        Self { clear: floor.eroded(radius_m / CELL_M), frame, inside, doors, radius_m }
    }

    /// Takes what an obstacle leaves no room for.
    pub fn block(&mut self, obstacle: &Box2) {
        let r = rect_m(obstacle);
        let (_, _, j0, j1) = self.frame.span(&r.grown(self.radius_m));
        for j in j0.max(0)..j1 {
            let y = self.frame.center(0, j as usize).y;
            let dy = (r.y0 - y).max(y - r.y1).max(0.0);
            let left = self.radius_m * self.radius_m - dy * dy;
            if left > 0.0 {
                let half = left.sqrt() - 1e-6;
                let row = Rect { x0: r.x0 - half, x1: r.x1 + half, ..r };
                let (i0, i1, _, _) = self.frame.span(&row);
                self.clear.fill(i0, i1, j, j + 1, false);
            }
        }
    }

    /// Returns the usable floor, or `None` when doors are cut off from each other or too much floor from the doors.
    pub fn routes(&self) -> Option<Routes> {
        let main = match self.doors.first() {
            Some(&(i, j)) => {
                let mut seed = Bitmap::new(self.frame.nx, self.frame.ny);
                seed.set(i, j);
                self.clear.flood(&seed)
            }
            None => self.clear.components().into_iter().next()?,
        };
        if self.doors.iter().any(|&(i, j)| !main.get(i, j)) {
            return None;
        }
        let (area, total) = (main.count_common(&self.inside), self.clear.count_common(&self.inside));
        let allowed = ((total as f64 * POCKET_SHARE) as usize).min(4 * POCKET_CELLS).max(POCKET_CELLS);
        (area > 0 && total - area <= allowed).then_some(Routes { main, area })
    }

    /// Returns true when the disc can come up to one of the rectangles.
    pub fn reaches(&self, routes: &Routes, targets: &[Box2]) -> bool {
        let margin = (self.radius_m * 1000.0) as i32 + 100;
        targets.iter().any(|t| {
            let (i0, i1, j0, j1) = self.frame.span(&rect_m(&t.grown(margin)));
            routes.main.any_in(i0, i1, j0, j1)
        })
    }
}
