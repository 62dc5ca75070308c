//! Pockets: free floor that furniture closes off from the rest of a room.
//!
//! `nav` keeps the floor of the robot at hand in one piece on a grid. Here the floor of a small robot, a square 0.2 m
//! wide, is held exactly, by the same definition as the measure NAV of finished worlds (SceneEval): everything whose
//! middle is no higher than 2 m is in its way. A gap at the limit of that width is open on one raster and closed on
//! another, and a slit between two rows of chairs may be open at one end and closed at the other, so it is looked at for
//! several widths around it and as several rasters see it.

use d3dgen_model::occupancy::Bitmap;

use super::geom::{Box2, FLAT, Solid};
use super::space::Space;
use super::state::Placed;

/// Ways to look at the floor: half widths of the robot of 0.2 m and what rasters of 4 cm make of it at least and at most,
/// then rasters of several cells and origins (and one that begins in the room's corner, `Pockets::new`). No half width is a multiple of 5 mm, so that no gap is exactly as wide. A
/// raster may make more of a slit and less of the turn into it: those of different widths east and north stand for that.
const VIEWS: [View; 13] = [
    View::Exact { east: 82, north: 82 },
    View::Exact { east: 88, north: 88 },
    View::Exact { east: 94, north: 94 },
    View::Exact { east: 99, north: 99 },
    View::Exact { east: 106, north: 106 },
    View::Exact { east: 112, north: 112 },
    View::Exact { east: 118, north: 118 },
    View::Exact { east: 82, north: 118 },
    View::Exact { east: 118, north: 82 },
    View::Raster { cell: 40, at: (23, 37) },
    View::Raster { cell: 50, at: (11, 31) },
    View::Raster { cell: 67, at: (29, 7) },
    View::Raster { cell: 83, at: (47, 61) },
];
/// Edge of the cells of the room's own raster, mm.
const OWN_CELL: i32 = 40;
/// Width of the robot that rasters look at, mm.
const ROBOT: i32 = 200;
/// Height up to which the middle of a thing makes it an obstacle, mm.
const OVERHEAD: i32 = 2000;
/// How far floor is looked at through the doors, mm; more than the widest robot.
const THRESHOLD: i32 = 300;
/// How far what is no floor reaches around the room, mm; beyond the thresholds.
const AROUND: i32 = 400;
/// What is not looked at of that, mm: more than the edge of a cell.
const EDGE: i32 = 90;

/// A way to look at the floor.
#[derive(Debug, Clone, Copy)]
enum View {
    /// To the millimeter, for half of the robot's widths, mm.
    Exact { east: i32, north: i32 },
    /// In cells of this edge, mm: a cell is taken when its center is. One center lies at `at`.
    Raster { cell: i32, at: (i32, i32) },
}

impl View {
    /// Returns where the robot's center cannot be because of an obstacle; `None` when no cell sees it.
    fn around(self, o: &Box2) -> Option<Box2> {
        match self {
            Self::Exact { east, north } => {
                Some(Box2 { x0: o.x0 - east, x1: o.x1 + east, y0: o.y0 - north, y1: o.y1 + north })
            }
            Self::Raster { cell, at } => {
                let side = |low: i32, high: i32, at: i32| {
                    let first = (low - at).div_euclid(cell) + i32::from((low - at).rem_euclid(cell) > 0);
                    let last = (high - at).div_euclid(cell);
                    // a robot of an even number of cells has one more on one side of its center than on the other
                    let cells = (ROBOT + cell / 2) / cell;
                    let (before, after) = ((cells - 1) / 2, cells / 2);
                    (first <= last)
                        .then(|| (cell * (first - before) + at - cell / 2, cell * (last + after + 1) + at - cell / 2))
                };
                let ((x0, x1), (y0, y1)) = (side(o.x0, o.x1, at.0)?, side(o.y0, o.y1, at.1)?);
                Some(Box2 { x0, y0, x1, y1 })
            }
        }
    }
}

/// A room's floor with what stands in the way of a small robot.
#[derive(Debug, Clone)]
pub(crate) struct Pockets {
    /// Around the room and the thresholds.
    frame: Box2,
    /// What is no floor, then what stands on it or hangs over it.
    obstacles: Vec<Box2>,
    /// The cells of a grid over this room alone, as NAV has them.
    own_raster: View,
}

impl Pockets {
    /// Returns the empty room with the floor in its doors.
    pub fn new(space: &Space) -> Self {
        let b = space.bounds;
        let frame = b.grown(AROUND);
        // NAV counts a cell whose center lies on the very edge of a room as floor
        let edge = b.grown(1);
        let mut solid = vec![
            Box2 { y1: edge.y0, ..frame },
            Box2 { y0: edge.y1, ..frame },
            Box2 { x0: frame.x0, x1: edge.x0, ..edge },
            Box2 { x0: edge.x1, x1: frame.x1, ..edge },
        ];
        solid.extend(space.holes());
        for door in &space.doors {
            let middle = (door.v0 + door.v1) / 2;
            let half = door.clear_width.min(door.v1 - door.v0) / 2;
            let floor = space.walls[door.wall].strip(middle - half, middle + half, -THRESHOLD, 0);
            solid = solid.iter().flat_map(|s| s.without(&floor)).collect();
        }
        Self { frame, obstacles: solid, own_raster: own_raster(&b) }
    }

    /// Returns the outlines of what units put in the way.
    pub fn boxes(units: &[Placed]) -> Vec<Box2> {
        let mut out = Vec::new();
        for p in units.iter().filter(|p| p.support.is_none()) {
            // what stands on a top is in the way no more than what carries it
            let own = p.unit.parts.iter().filter(|part| part.support.is_none());
            out.extend(own.map(|part| p.solid(part)).filter(is_drawn).map(|s| s.rect));
        }
        out
    }

    /// Takes the floor of units that stay.
    pub fn add(&mut self, unit: &Placed) {
        self.obstacles.extend(Self::boxes(std::slice::from_ref(unit)));
    }

    /// Returns true when more things close off floor that is open without them.
    pub fn is_closed_by(&self, more: &[Box2]) -> bool {
        self.views().filter(|view| self.may_part(more, *view)).any(|view| {
            let closed = self.closed_off(more, view);
            closed > 0 && closed > self.closed_off(&[], view)
        })
    }

    /// Returns the floor that is closed off, mm^2 of places for a robot's center, summed over the views.
    pub fn area(&self) -> i64 {
        self.views().map(|view| self.closed_off(&[], view)).sum()
    }

    fn views(&self) -> impl Iterator<Item = View> {
        VIEWS.into_iter().chain([self.own_raster])
    }

    /// Returns true when the free floor along the edge of something new is in several pieces: it may part them.
    fn may_part(&self, more: &[Box2], view: View) -> bool {
        let mut blocked: Vec<(i32, i32)> = Vec::new();
        more.iter().enumerate().any(|(n, new)| {
            let Some(ring) = view.around(new) else { return false };
            blocked.clear();
            for o in self.obstacles.iter().chain(&more[..n]).filter_map(|o| view.around(o)) {
                if o.x0 <= ring.x1 && o.x1 >= ring.x0 && o.y0 <= ring.y1 && o.y1 >= ring.y0 {
                    along_ring(&ring, &o, &mut blocked);
                }
            }
            pieces(&mut blocked, 2 * (ring.width() + ring.height())) > 1
        })
    }

    /// Returns the floor that cannot be reached from the largest part, mm^2 of places for the robot's center.
    fn closed_off(&self, more: &[Box2], view: View) -> i64 {
        let grown: Vec<Box2> = self.obstacles.iter().chain(more).filter_map(|o| view.around(o)).collect();
        // cells at the very edge may lie half outside
        let f = self.frame.grown(-EDGE);
        let marks = |low: i32, high: i32, edges: &dyn Fn(&Box2) -> [i32; 2]| {
            let mut out: Vec<i32> = grown.iter().flat_map(edges).filter(|v| low < *v && *v < high).collect();
            out.extend([low, high]);
            out.sort_unstable();
            out.dedup();
            out
        };
        let xs = marks(f.x0, f.x1, &|b| [b.x0, b.x1]);
        let ys = marks(f.y0, f.y1, &|b| [b.y0, b.y1]);
        let mut free = Bitmap::new(xs.len() - 1, ys.len() - 1);
        free.fill(0, free.nx() as i64, 0, free.ny() as i64, true);
        let at = |list: &[i32], v: i32| list.partition_point(|m| *m < v) as i64;
        for g in &grown {
            free.fill(at(&xs, g.x0), at(&xs, g.x1), at(&ys, g.y0), at(&ys, g.y1), false);
        }
        let Some((i, j)) = free.cells().next() else { return 0 };
        let mut seed = Bitmap::new(free.nx(), free.ny());
        seed.set(i, j);
        let first = free.flood(&seed);
        if first.count() == free.count() {
            return 0;
        }
        let area = |part: &Bitmap| -> i64 {
            part.cells().map(|(i, j)| i64::from(xs[i + 1] - xs[i]) * i64::from(ys[j + 1] - ys[j])).sum()
        };
        let largest = free.components().iter().map(area).max().unwrap_or(0);
        area(&free) - largest
    }
}

/// Returns the raster that NAV lays over a room with these bounds.
fn own_raster(bounds: &Box2) -> View {
    View::Raster { cell: OWN_CELL, at: (bounds.x0 + OWN_CELL / 2, bounds.y0 + OWN_CELL / 2) }
}

/// Returns true for what is in the way of a small robot by the definition.
fn is_drawn(s: &Solid) -> bool {
    !(s.z0 <= FLAT && s.z1 <= FLAT) && s.z0 + s.z1 <= 2 * OVERHEAD
}

/// Adds where a rectangle covers the way once around another one, just outside it: from its south-west corner east.
fn along_ring(ring: &Box2, o: &Box2, out: &mut Vec<(i32, i32)>) {
    let (w, h) = (ring.width(), ring.height());
    let (x0, x1) = (o.x0.max(ring.x0) - ring.x0, o.x1.min(ring.x1) - ring.x0);
    let (y0, y1) = (o.y0.max(ring.y0) - ring.y0, o.y1.min(ring.y1) - ring.y0);
    if o.y0 < ring.y0 && x0 < x1 {
        out.push((x0, x1));
    }
    if o.x1 > ring.x1 && y0 < y1 {
        out.push((w + y0, w + y1));
    }
    if o.y1 > ring.y1 && x0 < x1 {
        out.push((2 * w + h - x1, 2 * w + h - x0));
    }
    if o.x0 < ring.x0 && y0 < y1 {
        out.push((2 * w + 2 * h - y1, 2 * w + 2 * h - y0));
    }
}

/// Returns how many pieces of a way around, of this length, are not blocked.
fn pieces(blocked: &mut [(i32, i32)], length: i32) -> usize {
    blocked.sort_unstable();
    let (mut gaps, mut reached) = (0, 0);
    for (from, to) in blocked.iter() {
        gaps += usize::from(*from > reached);
        reached = reached.max(*to);
    }
    let starts_free = blocked.first().is_none_or(|b| b.0 > 0);
    match (starts_free, reached < length) {
        // the piece at the end goes on at the start
        (true, true) => gaps.max(1),
        (_, ends_free) => gaps + usize::from(ends_free),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn room() -> Pockets {
        let b = Box2::new(0, 0, 3000, 3000);
        let frame = b.grown(AROUND);
        let solid =
            [Box2 { y1: 0, ..frame }, Box2 { y0: 3000, ..frame }, Box2 { x1: 0, ..frame }, Box2 { x0: 3000, ..frame }];
        // a door in the south, 0.9 m wide
        let door = Box2::new(1000, -THRESHOLD, 1900, 0);
        let obstacles = solid.iter().flat_map(|s| s.without(&door)).collect();
        Pockets { frame, obstacles, own_raster: own_raster(&b) }
    }

    #[test]
    fn an_empty_room_is_one_piece_with_its_door() {
        assert_eq!(room().area(), 0);
        assert!(!room().is_closed_by(&[Box2::new(1000, 1000, 2000, 2000)]), "one can walk around it");
        assert!(!room().is_closed_by(&[Box2::new(0, 0, 600, 600)]), "a corner is no pocket");
        assert!(room().is_closed_by(&[Box2::new(900, 0, 2000, 300)]), "the door is");
    }

    #[test]
    fn two_things_close_off_what_each_alone_leaves_open() {
        let (bed, table) = (Box2::new(0, 500, 2000, 2000), Box2::new(2050, 0, 2500, 700));
        let mut room = room();
        assert!(!room.is_closed_by(&[bed]) && !room.is_closed_by(&[table]));
        room.obstacles.push(bed);
        // between the bed and the wall with the door
        assert!(!room.is_closed_by(&[Box2::new(2600, 1000, 3000, 1400)]));
        assert!(room.is_closed_by(&[Box2::new(0, 0, 800, 300), Box2::new(1950, 0, 2300, 700)]));
    }

    #[test]
    fn gaps_about_as_wide_as_the_robot_count_as_closed() {
        let wall = |gap: i32| [Box2::new(0, 1500, 3000 - gap, 1600)];
        assert!(!room().is_closed_by(&wall(240)) && room().is_closed_by(&wall(230)) && room().is_closed_by(&wall(170)));
        // nobody stands in a slit
        assert!(!room().is_closed_by(&[Box2::new(150, 300, 200, 2000), Box2::new(0, 2000, 200, 2100)]));
    }

    #[test]
    fn a_slit_that_narrows_is_seen_by_some_raster() {
        // 0.195 m wide at its mouth and 0.215 m behind it: the robot of 0.2 m stands inside on some rasters, enters on fewer
        let slit =
            [Box2::new(0, 1000, 1000, 1200), Box2::new(1195, 1000, 3000, 1200), Box2::new(1215, 1200, 3000, 3000)];
        let room = room();
        assert!(room.is_closed_by(&[&slit[..], &[Box2::new(0, 1200, 1000, 3000)]].concat()));
        let view = View::Raster { cell: 40, at: (0, 0) };
        assert_eq!(view.around(&Box2::new(-10, -10, 90, 10)), Some(Box2::new(-100, -100, 180, 100)));
        assert_eq!(view.around(&Box2::new(5, 5, 35, 35)), None, "no center of a cell lies in it");
    }

    #[test]
    fn the_way_around_a_thing_is_counted_in_pieces() {
        assert_eq!(pieces(&mut [], 100), 1);
        assert_eq!(pieces(&mut [(0, 100)], 100), 0);
        assert_eq!(pieces(&mut [(10, 20)], 100), 1);
        assert_eq!(pieces(&mut [(0, 20), (50, 60)], 100), 2);
        assert_eq!(pieces(&mut [(10, 20), (50, 60)], 100), 2);
        assert_eq!(pieces(&mut [(0, 20), (10, 60), (90, 100)], 100), 1);
        let ring = Box2::new(0, 0, 10, 20);
        let mut all = Vec::new();
        along_ring(&ring, &Box2::new(-5, -5, 15, 25), &mut all);
        assert_eq!(pieces(&mut all, 60), 0);
        let mut corner = Vec::new();
        along_ring(&ring, &Box2::new(-5, -5, 5, 5), &mut corner);
        assert_eq!(corner, [(0, 5), (55, 60)]);
        assert_eq!(pieces(&mut corner, 60), 1);
    }
}
