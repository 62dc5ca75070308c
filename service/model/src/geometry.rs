//! Points, polygons, rectangles, segments and poses in meters; x east, y north, yaw counter-clockwise.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Rounds a length to a whole millimeter, the resolution of every document.
pub fn to_mm(meters: f64) -> f64 {
    let rounded = (meters * 1000.0).round() / 1000.0;
    if rounded == 0.0 { 0.0 } else { rounded } // never write -0.0
}

/// A point on the floor, m.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Point {
    /// East, m.
    pub x: f64,
    /// North, m.
    pub y: f64,
}

impl Point {
    /// Returns a point.
    pub fn new(x: f64, y: f64) -> Self {
        Self { x, y }
    }

    /// Returns the distance to another point, m.
    pub fn distance(self, other: Self) -> f64 {
        (self.x - other.x).hypot(self.y - other.y)
    }
}

/// Position on the floor and heading.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pose {
    /// East, m.
    pub x: f64,
    /// North, m.
    pub y: f64,
    /// Height of the object's underside above the floor, m.
    #[serde(default)]
    pub z: f64,
    /// Heading of the object's own +x (its front), counter-clockwise from east, rad.
    pub yaw_rad: f64,
}

/// A straight piece between two points, m.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Segment {
    /// One end.
    pub start: Point,
    /// The other end.
    pub end: Point,
}

impl Segment {
    /// Returns the length, m.
    pub fn length(&self) -> f64 {
        self.start.distance(self.end)
    }

    /// Returns the point halfway.
    pub fn middle(&self) -> Point {
        Point::new((self.start.x + self.end.x) / 2.0, (self.start.y + self.end.y) / 2.0)
    }

    /// Returns true when the segment runs north-south rather than east-west.
    pub fn is_vertical(&self) -> bool {
        (self.start.x - self.end.x).abs() < (self.start.y - self.end.y).abs()
    }

    /// Returns where a segment across x or y runs: its coordinate, and its ends in order, m.
    pub fn span(&self) -> (f64, f64, f64) {
        let along = |p: Point| if self.is_vertical() { (p.x, p.y) } else { (p.y, p.x) };
        let ((at, a), (_, b)) = (along(self.start), along(self.end));
        (at, a.min(b), a.max(b))
    }

    /// Returns the segment moved, m.
    pub fn moved(&self, dx: f64, dy: f64) -> Self {
        let by = |p: Point| Point::new(p.x + dx, p.y + dy);
        Self { start: by(self.start), end: by(self.end) }
    }

    /// Returns the rectangle between the ends.
    pub fn bounds(&self) -> Rect {
        Rect::new(self.start.x, self.start.y, self.end.x, self.end.y)
    }
}

/// An axis-aligned rectangle, m.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rect {
    /// West edge, m.
    pub x0: f64,
    /// South edge, m.
    pub y0: f64,
    /// East edge, m.
    pub x1: f64,
    /// North edge, m.
    pub y1: f64,
}

impl Rect {
    /// Returns the rectangle between two corners in any order.
    pub fn new(x0: f64, y0: f64, x1: f64, y1: f64) -> Self {
        Self { x0: x0.min(x1), y0: y0.min(y1), x1: x0.max(x1), y1: y0.max(y1) }
    }

    /// Returns east-west extent, m.
    pub fn width(&self) -> f64 {
        self.x1 - self.x0
    }

    /// Returns north-south extent, m.
    pub fn height(&self) -> f64 {
        self.y1 - self.y0
    }

    /// Returns the area, m^2.
    pub fn area(&self) -> f64 {
        self.width() * self.height()
    }

    /// Returns the center.
    pub fn center(&self) -> Point {
        Point::new((self.x0 + self.x1) / 2.0, (self.y0 + self.y1) / 2.0)
    }

    /// Returns the least rectangle around both.
    pub fn union(&self, other: &Self) -> Self {
        Self {
            x0: self.x0.min(other.x0),
            y0: self.y0.min(other.y0),
            x1: self.x1.max(other.x1),
            y1: self.y1.max(other.y1),
        }
    }

    /// Returns the area that both have in common, m^2.
    pub fn common_area(&self, other: &Self) -> f64 {
        let (w, h) = (self.x1.min(other.x1) - self.x0.max(other.x0), self.y1.min(other.y1) - self.y0.max(other.y0));
        if w > 0.0 && h > 0.0 { w * h } else { 0.0 }
    }

    /// Returns the gap to another rectangle along the axis that parts them more, m; 0 when they touch or overlap.
    pub fn gap(&self, other: &Self) -> f64 {
        let [x, y] = self.gaps(other);
        x.max(y)
    }

    /// Returns the distance to another rectangle, m; 0 when they touch or overlap.
    pub fn distance(&self, other: &Self) -> f64 {
        let [x, y] = self.gaps(other);
        x.hypot(y)
    }

    /// Returns the distance to a point, m; 0 inside.
    pub fn distance_to(&self, p: Point) -> f64 {
        self.distance(&Self { x0: p.x, y0: p.y, x1: p.x, y1: p.y })
    }

    fn gaps(&self, other: &Self) -> [f64; 2] {
        let x = (self.x0 - other.x1).max(other.x0 - self.x1);
        let y = (self.y0 - other.y1).max(other.y0 - self.y1);
        [x.max(0.0), y.max(0.0)]
    }

    /// Returns what is left of the rectangle without another one, in at most four pieces.
    pub fn without(&self, cut: &Self) -> Vec<Self> {
        if !self.overlaps(cut) {
            return vec![*self];
        }
        let (y0, y1) = (self.y0.max(cut.y0), self.y1.min(cut.y1));
        let pieces = [
            Self { y1: cut.y0, ..*self },
            Self { y0: cut.y1, ..*self },
            Self { x1: cut.x0, y0, y1, ..*self },
            Self { x0: cut.x1, y0, y1, ..*self },
        ];
        pieces.into_iter().filter(|p| p.x0 < p.x1 && p.y0 < p.y1).collect()
    }

    /// Returns true when the interiors share more than a contact line.
    pub fn overlaps(&self, other: &Self) -> bool {
        let e = crate::TOLERANCE_M;
        self.x0 < other.x1 - e && other.x0 < self.x1 - e && self.y0 < other.y1 - e && other.y0 < self.y1 - e
    }

    /// Returns true when the other rectangle lies inside, edges included.
    pub fn contains(&self, other: &Self) -> bool {
        let e = crate::TOLERANCE_M;
        other.x0 >= self.x0 - e && other.x1 <= self.x1 + e && other.y0 >= self.y0 - e && other.y1 <= self.y1 + e
    }

    /// Returns the rectangle grown by `margin` on all sides (shrunk when negative), m.
    pub fn grown(&self, margin: f64) -> Self {
        Self { x0: self.x0 - margin, y0: self.y0 - margin, x1: self.x1 + margin, y1: self.y1 + margin }
    }

    /// Returns the four corners counter-clockwise from south-west.
    pub fn corners(&self) -> [Point; 4] {
        [
            Point::new(self.x0, self.y0),
            Point::new(self.x1, self.y0),
            Point::new(self.x1, self.y1),
            Point::new(self.x0, self.y1),
        ]
    }
}

/// A simple polygon: counter-clockwise, first corner not repeated, m.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct Polygon(#[schemars(length(min = 3))] pub Vec<Point>);

impl Polygon {
    /// Returns the corners counter-clockwise.
    pub fn corners(&self) -> &[Point] {
        &self.0
    }

    /// Returns the edges in order, the closing one last.
    pub fn edges(&self) -> impl Iterator<Item = Segment> + '_ {
        (0..self.0.len()).map(|i| Segment { start: self.0[i], end: self.0[(i + 1) % self.0.len()] })
    }

    /// Returns the signed area by the shoelace formula, m^2: positive when counter-clockwise.
    pub fn signed_area(&self) -> f64 {
        self.edges().map(|e| e.start.x * e.end.y - e.end.x * e.start.y).sum::<f64>() / 2.0
    }

    /// Returns the area, m^2.
    pub fn area(&self) -> f64 {
        self.signed_area().abs()
    }

    /// Returns the smallest rectangle around the polygon.
    pub fn bounds(&self) -> Rect {
        let mut b = Rect { x0: f64::MAX, y0: f64::MAX, x1: f64::MIN, y1: f64::MIN };
        for p in &self.0 {
            b = Rect { x0: b.x0.min(p.x), y0: b.y0.min(p.y), x1: b.x1.max(p.x), y1: b.y1.max(p.y) };
        }
        b
    }

    /// Returns true when the point lies inside (boundary points may go either way).
    pub fn contains(&self, p: Point) -> bool {
        let mut inside = false;
        for e in self.edges() {
            if (e.start.y > p.y) != (e.end.y > p.y) {
                let x = e.start.x + (p.y - e.start.y) / (e.end.y - e.start.y) * (e.end.x - e.start.x);
                if p.x < x {
                    inside = !inside;
                }
            }
        }
        inside
    }

    /// Returns true when no two edges meet except neighbors at their common corner.
    pub fn is_simple(&self) -> bool {
        let edges: Vec<Segment> = self.edges().collect();
        let n = edges.len();
        (0..n).all(|i| {
            (i + 1..n).all(|j| {
                let neighbors = j == i + 1 || (i == 0 && j == n - 1);
                if neighbors { !folds_back(&edges[i], &edges[j]) } else { !cross(&edges[i], &edges[j]) }
            })
        })
    }

    /// Returns true when every edge runs along an axis.
    pub fn is_rectilinear(&self) -> bool {
        let e = crate::TOLERANCE_M;
        self.edges().all(|s| (s.start.x - s.end.x).abs() < e || (s.start.y - s.end.y).abs() < e)
    }

    /// Returns rectangles that cover the polygon: exactly where it is rectilinear, else in slices of at most `step` m along y,
    /// each as wide as the polygon is there.
    pub fn cover(&self, step: f64) -> Vec<Rect> {
        if self.is_rectilinear() {
            return self.rects();
        }
        let bounds = self.bounds();
        let count = (bounds.height() / step).ceil().max(1.0);
        let at = |k: f64| bounds.y0 + bounds.height() * k / count;
        let slice = |k: u32| {
            let (y0, y1) = (at(f64::from(k)), at(f64::from(k + 1)));
            let ends = self.edges().filter_map(|e| {
                let (low, high) = if e.start.y <= e.end.y { (e.start, e.end) } else { (e.end, e.start) };
                let rise = high.y - low.y;
                let x = |y: f64| {
                    let share = if rise > 0.0 { (y - low.y) / rise } else { 0.0 };
                    low.x + share.clamp(0.0, 1.0) * (high.x - low.x)
                };
                (low.y <= y1 && high.y >= y0).then(|| [x(y0), x(y1)])
            });
            let (x0, x1) = ends.flatten().fold((f64::MAX, f64::MIN), |b, x| (b.0.min(x), b.1.max(x)));
            Rect { x0, y0, x1, y1 }
        };
        (0..count as u32).map(slice).filter(|r| r.x1 > r.x0).collect()
    }

    /// Returns non-overlapping rectangles that together cover a rectilinear polygon, by slabs between corner heights.
    pub fn rects(&self) -> Vec<Rect> {
        let mut ys: Vec<f64> = self.0.iter().map(|p| p.y).collect();
        ys.sort_by(f64::total_cmp);
        ys.dedup_by(|a, b| (*a - *b).abs() < crate::TOLERANCE_M);
        let mut open: Vec<Rect> = Vec::new();
        let mut done = Vec::new();
        for pair in ys.windows(2) {
            let y = (pair[0] + pair[1]) / 2.0;
            let mut xs: Vec<f64> =
                self.edges().filter(|e| (e.start.y > y) != (e.end.y > y)).map(|e| e.start.x).collect();
            xs.sort_by(f64::total_cmp);
            let slabs: Vec<(f64, f64)> = xs.chunks_exact(2).map(|c| (c[0], c[1])).collect();
            let (kept, closed): (Vec<Rect>, Vec<Rect>) = open.into_iter().partition(|r| slabs.contains(&(r.x0, r.x1)));
            done.extend(closed);
            open = slabs
                .into_iter()
                .map(|(x0, x1)| {
                    let y0 = kept.iter().find(|r| (r.x0, r.x1) == (x0, x1)).map_or(pair[0], |r| r.y0);
                    Rect { x0, y0, x1, y1: pair[1] }
                })
                .collect();
        }
        done.extend(open);
        done
    }
}

fn turn(a: Point, b: Point, p: Point) -> f64 {
    (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x)
}

/// Returns true when the edges share a point.
fn cross(s: &Segment, t: &Segment) -> bool {
    let on = |a: Point, b: Point, p: Point| {
        p.x >= a.x.min(b.x) && p.x <= a.x.max(b.x) && p.y >= a.y.min(b.y) && p.y <= a.y.max(b.y)
    };
    let (d1, d2) = (turn(s.start, s.end, t.start), turn(s.start, s.end, t.end));
    let (d3, d4) = (turn(t.start, t.end, s.start), turn(t.start, t.end, s.end));
    (d1 * d2 < 0.0 && d3 * d4 < 0.0)
        || (d1 == 0.0 && on(s.start, s.end, t.start))
        || (d2 == 0.0 && on(s.start, s.end, t.end))
        || (d3 == 0.0 && on(t.start, t.end, s.start))
        || (d4 == 0.0 && on(t.start, t.end, s.end))
}

/// Returns true when an edge runs back over the one before it, or has no length.
fn folds_back(s: &Segment, t: &Segment) -> bool {
    let dot = (s.end.x - s.start.x) * (t.end.x - t.start.x) + (s.end.y - s.start.y) * (t.end.y - t.start.y);
    let parallel = turn(s.start, s.end, t.end).abs() + turn(s.start, s.end, t.start).abs() < 1e-9;
    s.length() < 1e-6 || t.length() < 1e-6 || (parallel && dot < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stands_at_an_angle_is_covered_by_narrow_slices() {
        let lozenge = Polygon([(1.0, 0.0), (2.0, 1.0), (1.0, 2.0), (0.0, 1.0)].map(|(x, y)| Point::new(x, y)).to_vec());
        let cover = lozenge.cover(0.1);
        let area: f64 = cover.iter().map(Rect::area).sum();
        assert!((2.0..2.3).contains(&area), "{area} m2 for 2 m2");
        assert!(cover.iter().any(|r| r.x0 < 0.001) && cover.iter().all(|r| r.height() < 0.101));
        let square = Polygon([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| Point::new(x, y)).to_vec());
        assert_eq!(square.cover(0.1), square.rects());
    }

    #[test]
    fn rects_cover_an_l_shape_exactly() {
        let l = Polygon(
            [(0., 0.), (4., 0.), (4., 2.), (2., 2.), (2., 5.), (0., 5.)].map(|(x, y)| Point::new(x, y)).to_vec(),
        );
        let rects = l.rects();
        assert_eq!(rects, vec![Rect::new(0., 0., 4., 2.), Rect::new(0., 2., 2., 5.)]);
        assert_eq!(rects.iter().map(Rect::area).sum::<f64>(), l.area());
    }

    #[test]
    fn rectangles_are_apart_as_far_as_their_sides() {
        let a = Rect::new(0., 0., 2., 2.);
        let cases = [
            (Rect::new(5., 6., 7., 8.), 4.0, 5.0),
            (Rect::new(3., 1., 4., 2.), 1.0, 1.0),
            (Rect::new(2., 0., 3., 1.), 0.0, 0.0),
            (Rect::new(0.5, 0.5, 1., 1.), 0.0, 0.0),
        ];
        for (b, gap, distance) in cases {
            assert_eq!((a.gap(&b), a.distance(&b)), (gap, distance), "{b:?}");
            assert_eq!((b.gap(&a), b.distance(&a)), (gap, distance), "{b:?}");
        }
        assert_eq!((a.distance_to(Point::new(5., 6.)), a.distance_to(Point::new(1., 1.))), (5.0, 0.0));
    }
}
