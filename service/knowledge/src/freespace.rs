//! Exact free floor among right angles: the maximal free rectangles of a room, what fits in it, and how wide one can pass.

use d3dgen_model::floorplan::Door;
use d3dgen_model::occupancy::Bitmap;
use d3dgen_model::{Polygon, Rect, TOLERANCE_M};

/// How far beyond the wall faces a door's opening is looked for, m: it must meet the floor on both sides.
const REACH_M: f64 = 0.02;

/// The free floor of a room, as all rectangles in it that cannot be made larger.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeSpace {
    /// Maximal rectangles; they overlap.
    pub rects: Vec<Rect>,
}

impl FreeSpace {
    /// Returns the free floor of a rectilinear outline with axis-aligned obstacles in it.
    pub fn new(outline: &Polygon, obstacles: &[Rect]) -> Self {
        let bounds = outline.bounds();
        let inside: Vec<&Rect> = obstacles.iter().filter(|o| o.overlaps(&bounds)).collect();
        let cuts = |corner: fn(&d3dgen_model::Point) -> f64, lo: fn(&Rect) -> f64, hi: fn(&Rect) -> f64| {
            let corners = outline.corners();
            let mut v = Vec::with_capacity(corners.len() + 2 * inside.len());
            v.extend(corners.iter().map(corner));
            v.extend(inside.iter().flat_map(|o| [lo(o), hi(o)]).filter(|c| *c > lo(&bounds) && *c < hi(&bounds)));
            v.sort_by(f64::total_cmp);
            v.dedup_by(|a, b| (*a - *b).abs() < TOLERANCE_M);
            v
        };
        let xs = cuts(|p| p.x, |r| r.x0, |r| r.x1);
        let ys = cuts(|p| p.y, |r| r.y0, |r| r.y1);
        let mut free = Bitmap::new(xs.len().saturating_sub(1), ys.len().saturating_sub(1));
        // cells belong to what their middle lies in
        let span = |cuts: &[f64], low: f64, high: f64| {
            let middles = || cuts.windows(2).map(|c| (c[0] + c[1]) / 2.0);
            [middles().take_while(|m| *m <= low).count() as i64, middles().take_while(|m| *m < high).count() as i64]
        };
        let mut set = |r: &Rect, is_free: bool| {
            let ([i0, i1], [j0, j1]) = (span(&xs, r.x0, r.x1), span(&ys, r.y0, r.y1));
            free.fill(i0, i1, j0, j1, is_free);
        };
        outline.rects().iter().for_each(|r| set(r, true));
        inside.iter().for_each(|o| set(o, false));
        let rect = |[i0, i1, j0, j1]: [usize; 4]| Rect { x0: xs[i0], x1: xs[i1], y0: ys[j0], y1: ys[j1] };
        Self { rects: free.maximal_rectangles().into_iter().map(rect).collect() }
    }

    /// Returns the side of the largest free square, m; 0 without free floor.
    pub fn largest_square(&self) -> f64 {
        self.rects.iter().map(short_side).fold(0.0, f64::max)
    }

    /// Returns length over width of the largest free rectangle; infinite without free floor.
    pub fn proportion(&self) -> f64 {
        let largest = self.rects.iter().max_by(|a, b| a.area().total_cmp(&b.area()));
        largest.map_or(f64::INFINITY, |r| r.width().max(r.height()) / short_side(r).max(TOLERANCE_M))
    }

    /// Returns the largest width of a free rectangle that is at least `length` long, m; 0 when there is none.
    pub fn width_at_length(&self, length: f64) -> f64 {
        let long = |r: &&Rect| r.width().max(r.height()) >= length - TOLERANCE_M;
        self.rects.iter().filter(long).map(short_side).fold(0.0, f64::max)
    }

    /// Returns the width of the widest square that can be pushed between all these doors, m.
    ///
    /// At a door itself only the door's own clear width is asked for. 0 when two doors are cut off from each other.
    pub fn passage(&self, doors: &[&Door]) -> f64 {
        let gates = gates(doors);
        let mut widths: Vec<f64> = self.rects.iter().map(short_side).collect();
        for (i, a) in self.rects.iter().enumerate() {
            widths.extend(self.rects[i + 1..].iter().map(|b| short_side(&common(a, b))).filter(|w| *w > 0.0));
        }
        // what is free of an opening that is wider than that
        for (gate, vertical, clear) in &gates {
            let along =
                self.rects.iter().map(|r| common(r, gate)).map(|c| if *vertical { c.height() } else { c.width() });
            widths.extend(along.filter(|w| 0.0 < *w && w < clear));
        }
        widths.sort_by(f64::total_cmp);
        widths.dedup_by(|a, b| (*a - *b).abs() < TOLERANCE_M);
        let passes = |w: f64| self.connects(&gates, w);
        // the wider, the fewer ways: search for the last width that passes
        let cut = widths.partition_point(|w| passes(*w));
        cut.checked_sub(1).map_or(0.0, |i| widths[i])
    }

    /// Returns true when a square of this width (m) can be pushed between all these doors, as [`FreeSpace::passage`].
    pub fn passes(&self, doors: &[&Door], width: f64) -> bool {
        self.connects(&gates(doors), width)
    }

    /// Returns true when a square of this width (m) can be pushed from a door to where a rectangle of floor lies; at the
    /// door as [`FreeSpace::passage`], at the rectangle half of its shorter side is enough.
    pub fn leads(&self, door: &Door, to: &Rect, width: f64) -> bool {
        let goal = (*to, to.height() > to.width(), short_side(to) / 2.0);
        let gates: Vec<_> = gates(&[door]).into_iter().chain([goal]).collect();
        self.connects(&gates, width)
    }

    /// Returns true when something long on wheels, `length` x `width` (m), gets in or out by a door: straight ahead, or
    /// around the corner into floor that runs along the door's wall.
    ///
    /// Around the corner the floor is taken as a corridor that meets one as wide as the door; the longest rectangle of a
    /// width that turns from one into the other is the least of (a cos t + b sin t - width) / (sin t cos t) over all angles
    /// t, with the widths a and b of the corridors (the moving sofa's elementary bound, turned about the inner corner).
    pub fn turns_in(&self, door: &Door, length: f64, width: f64) -> bool {
        let vertical = door.line.is_vertical();
        let gate = gate(door);
        self.rects.iter().any(|r| {
            let c = common(r, &gate);
            let (along, across, depth) =
                if vertical { ([c.y0, c.y1], c.width(), r.width()) } else { ([c.x0, c.x1], c.height(), r.height()) };
            let clear = (along[1] - along[0]).min(door.clear_width_m);
            if across <= 0.0 || clear < width - TOLERANCE_M {
                return false;
            }
            let [low, high] = if vertical { [r.y0, r.y1] } else { [r.x0, r.x1] };
            let run = (high - along[0]).max(along[1] - low);
            depth >= length - TOLERANCE_M
                || depth >= width
                    && run >= length - TOLERANCE_M
                    && longest_turned(clear, depth, width) >= length - TOLERANCE_M
        })
    }

    fn connects(&self, gates: &[(Rect, bool, f64)], width: f64) -> bool {
        let wide: Vec<&Rect> = self.rects.iter().filter(|r| short_side(r) >= width - TOLERANCE_M).collect();
        let mut group: Vec<usize> = (0..wide.len()).collect();
        for i in 0..wide.len() {
            for j in i + 1..wide.len() {
                if short_side(&common(wide[i], wide[j])) >= width - TOLERANCE_M {
                    let (a, b) = (group[i], group[j]);
                    group.iter_mut().filter(|g| **g == b).for_each(|g| *g = a);
                }
            }
        }
        let serves = |r: &Rect, (gate, vertical, clear): &(Rect, bool, f64)| {
            let c = common(r, gate);
            let along = if *vertical { c.height() } else { c.width() };
            let across = if *vertical { c.width() } else { c.height() };
            across > 0.0 && along >= clear.min(width) - TOLERANCE_M
        };
        let mut parts: Vec<usize> = group.clone();
        parts.sort_unstable();
        parts.dedup();
        parts
            .iter()
            .any(|part| gates.iter().all(|gate| wide.iter().zip(&group).any(|(r, g)| g == part && serves(r, gate))))
    }
}

/// Returns the length of the longest rectangle of a width that turns from a corridor of width `a` into one of width `b`, m.
fn longest_turned(a: f64, b: f64, width: f64) -> f64 {
    let length = |degrees: i32| {
        let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
        (a * cos + b * sin - width) / (sin * cos)
    };
    (3..88).map(length).fold(f64::MAX, f64::min)
}

fn short_side(r: &Rect) -> f64 {
    r.width().min(r.height())
}

/// Returns the common part of two rectangles; an extent is negative when they do not meet.
fn common(a: &Rect, b: &Rect) -> Rect {
    Rect { x0: a.x0.max(b.x0), y0: a.y0.max(b.y0), x1: a.x1.min(b.x1), y1: a.y1.min(b.y1) }
}

fn gates(doors: &[&Door]) -> Vec<(Rect, bool, f64)> {
    doors.iter().map(|d| (gate(d), d.line.is_vertical(), d.clear_width_m)).collect()
}

/// Returns the opening of a door through its wall and a little beyond.
fn gate(door: &Door) -> Rect {
    let (a, b) = (door.line.start, door.line.end);
    let r = Rect::new(a.x, a.y, b.x, b.y);
    let half = door.wall_thickness_m / 2.0 + REACH_M;
    if door.line.is_vertical() {
        Rect { x0: r.x0 - half, x1: r.x1 + half, ..r }
    } else {
        Rect { y0: r.y0 - half, y1: r.y1 + half, ..r }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use d3dgen_model::floorplan::DoorKind;
    use d3dgen_model::{Point, Segment};

    fn door(x0: f64, y0: f64, x1: f64, y1: f64) -> Door {
        let line = Segment { start: Point::new(x0, y0), end: Point::new(x1, y1) };
        Door {
            door_id: "d".into(),
            kind: DoorKind::Open,
            clear_width_m: line.length(),
            line,
            height_m: 2.1,
            wall_thickness_m: 0.12,
            room_ids: Vec::new(),
            entrance: false,
            swing: None,
            slide: None,
            automatic: false,
            locked: false,
        }
    }

    /// An L-shaped corridor: 10 m east at 1.5 m wide, then 6 m north at 1.2 m wide.
    fn corridor() -> Polygon {
        Polygon(
            [(0., 0.), (10., 0.), (10., 7.5), (8.8, 7.5), (8.8, 1.5), (0., 1.5)]
                .map(|(x, y)| Point::new(x, y))
                .to_vec(),
        )
    }

    #[test]
    fn the_narrower_arm_rules_an_l() {
        let space = FreeSpace::new(&corridor(), &[]);
        assert_eq!(space.rects.len(), 2);
        let ends = [door(-0.06, 0.2, -0.06, 1.2), door(8.9, 7.56, 9.9, 7.56)];
        let width = space.passage(&ends.iter().collect::<Vec<_>>());
        assert!((width - 1.2).abs() < 1e-6, "{width}");
        assert!((space.largest_square() - 1.5).abs() < 1e-6);
    }

    #[test]
    fn a_planter_at_the_end_of_a_wide_opening_takes_no_more_than_its_floor() {
        let hall = Polygon(Rect::new(0.0, 0.0, 10.0, 2.8).corners().to_vec());
        let ends = [door(-0.06, 0.4, -0.06, 1.4), door(7.0, 2.86, 9.7, 2.86)];
        let ends: Vec<&Door> = ends.iter().collect();
        let space = FreeSpace::new(&hall, &[Rect::new(9.6, 0.0, 10.0, 0.8)]);
        assert!((space.passage(&ends) - 2.6).abs() < 1e-6, "{}", space.passage(&ends));
    }

    #[test]
    fn a_square_is_pushed_from_a_door_to_a_piece_of_floor() {
        let space = FreeSpace::new(&corridor(), &[]);
        let (door, bed) = (door(-0.06, 0.2, -0.06, 1.2), Rect::new(8.9, 5.0, 9.9, 7.1));
        assert!(space.leads(&door, &bed, 1.1) && !space.leads(&door, &bed, 1.3), "the arm is 1.2 m wide");
        let narrowed = FreeSpace::new(&corridor(), &[Rect::new(9.6, 3.0, 10.0, 3.5)]);
        assert!(!narrowed.leads(&door, &bed, 1.1) && narrowed.leads(&door, &bed, 0.8));
    }

    #[test]
    fn a_bed_turns_through_a_door_where_floor_and_door_are_wide_enough() {
        // a lobby 4 m long behind a door in its long side
        let lobby = |depth: f64| FreeSpace::new(&Polygon(Rect::new(0.0, 0.0, 4.0, depth).corners().to_vec()), &[]);
        let narrow = door(0.1, -0.06, 1.3, -0.06);
        let wide = door(0.1, -0.06, 1.5, -0.06);
        assert!(lobby(2.3).turns_in(&narrow, 2.2, 1.0), "straight ahead");
        assert!(!lobby(1.6).turns_in(&narrow, 2.2, 1.0) && lobby(1.6).turns_in(&wide, 2.2, 1.0));
        assert!(!lobby(1.4).turns_in(&wide, 2.2, 1.0) && !lobby(2.3).turns_in(&narrow, 2.2, 1.25));
        // equal corridors: 45 degrees are the worst, 2 (sqrt(2) a - w)
        assert!((longest_turned(1.5, 1.5, 1.0) - 2.0 * (2.0_f64.sqrt() * 1.5 - 1.0)).abs() < 1e-9);
    }

    #[test]
    fn furniture_narrows_the_way_and_may_close_it() {
        let ends = [door(-0.06, 0.2, -0.06, 1.2), door(8.9, 7.56, 9.9, 7.56)];
        let ends: Vec<&Door> = ends.iter().collect();
        let bench = Rect::new(3.0, 0.0, 4.0, 0.5);
        let furnished = FreeSpace::new(&corridor(), &[bench]);
        assert!((furnished.passage(&ends) - 1.0).abs() < 1e-6);
        assert!(furnished.passes(&ends, 1.0) && !furnished.passes(&ends, 1.05));
        let wall = Rect::new(3.0, 0.0, 3.2, 1.5);
        assert_eq!(FreeSpace::new(&corridor(), &[wall]).passage(&ends), 0.0);
    }

    #[test]
    fn rectangles_fit_or_not() {
        let room = Polygon(Rect::new(0.0, 0.0, 2.2, 1.6).corners().to_vec());
        let space = FreeSpace::new(&room, &[Rect::new(0.0, 0.0, 0.5, 0.5)]);
        assert!((space.width_at_length(2.2) - 1.1).abs() < 1e-6);
        assert!((space.width_at_length(1.7) - 1.6).abs() < 1e-6);
        assert_eq!(space.width_at_length(2.3), 0.0);
    }
}
