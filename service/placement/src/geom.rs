//! Rectangles and heights in whole millimeters, turned by quarters: exact tests without tolerance.

use d3dgen_model::{Point, Rect};

/// Forward and left of the four headings (quarter turns counter-clockwise from east).
pub(crate) const DIR: [(i32, i32); 4] = [(1, 0), (0, 1), (-1, 0), (0, -1)];

/// Returns meters as whole millimeters.
pub(crate) fn mm(meters: f64) -> i32 {
    (meters * 1000.0).round() as i32
}

/// Returns a point turned by quarter turns about the origin.
pub(crate) fn turn(q: u8, x: i32, y: i32) -> (i32, i32) {
    match q % 4 {
        0 => (x, y),
        1 => (-y, x),
        2 => (-x, -y),
        _ => (y, -x),
    }
}

/// An axis-aligned rectangle, mm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Box2 {
    pub x0: i32,
    pub y0: i32,
    pub x1: i32,
    pub y1: i32,
}

impl Box2 {
    /// Returns what is left of a rectangle without another one.
    pub fn without(&self, cut: &Self) -> Vec<Self> {
        if !self.overlaps(cut) {
            return vec![*self];
        }
        let (y0, y1) = (self.y0.max(cut.y0), self.y1.min(cut.y1));
        let parts = [
            Self { y1: cut.y0, ..*self },
            Self { y0: cut.y1, ..*self },
            Self { x0: self.x0, y0, x1: cut.x0, y1 },
            Self { x0: cut.x1, y0, x1: self.x1, y1 },
        ];
        parts.into_iter().filter(|p| p.x0 < p.x1 && p.y0 < p.y1).collect()
    }

    pub fn new(x0: i32, y0: i32, x1: i32, y1: i32) -> Self {
        Self { x0: x0.min(x1), y0: y0.min(y1), x1: x0.max(x1), y1: y0.max(y1) }
    }

    pub fn from_rect(r: &Rect) -> Self {
        Self { x0: mm(r.x0), y0: mm(r.y0), x1: mm(r.x1), y1: mm(r.y1) }
    }

    /// Returns the rectangle in meters.
    pub fn meters(&self) -> Rect {
        let m = |v: i32| f64::from(v) / 1000.0;
        Rect { x0: m(self.x0), y0: m(self.y0), x1: m(self.x1), y1: m(self.y1) }
    }

    pub fn width(&self) -> i32 {
        self.x1 - self.x0
    }

    pub fn height(&self) -> i32 {
        self.y1 - self.y0
    }

    pub fn area(&self) -> i64 {
        i64::from(self.width()) * i64::from(self.height())
    }

    /// Returns true when the straight line between two points meets it.
    pub fn meets(&self, a: (i32, i32), b: (i32, i32)) -> bool {
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        for (p, q, low, high) in [(a.0, b.0, self.x0, self.x1), (a.1, b.1, self.y0, self.y1)] {
            let (p, d) = (f64::from(p), f64::from(q - p));
            let (low, high) = (f64::from(low) - p, f64::from(high) - p);
            if d == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return false;
                }
                continue;
            }
            let (s, t) = ((low / d).min(high / d), (low / d).max(high / d));
            (from, to) = (from.max(s), to.min(t));
        }
        from < to
    }

    pub fn center(&self) -> (i32, i32) {
        ((self.x0 + self.x1) / 2, (self.y0 + self.y1) / 2)
    }

    /// Returns the center in meters, to half a millimeter.
    pub fn center_m(&self) -> Point {
        Point::new(f64::from(self.x0 + self.x1) / 2000.0, f64::from(self.y0 + self.y1) / 2000.0)
    }

    pub fn overlaps(&self, o: &Self) -> bool {
        self.x0 < o.x1 && o.x0 < self.x1 && self.y0 < o.y1 && o.y0 < self.y1
    }

    pub fn contains(&self, o: &Self) -> bool {
        o.x0 >= self.x0 && o.x1 <= self.x1 && o.y0 >= self.y0 && o.y1 <= self.y1
    }

    pub fn union(&self, o: &Self) -> Self {
        Self { x0: self.x0.min(o.x0), y0: self.y0.min(o.y0), x1: self.x1.max(o.x1), y1: self.y1.max(o.y1) }
    }

    pub fn grown(&self, m: i32) -> Self {
        Self { x0: self.x0 - m, y0: self.y0 - m, x1: self.x1 + m, y1: self.y1 + m }
    }

    pub fn shifted(&self, dx: i32, dy: i32) -> Self {
        Self { x0: self.x0 + dx, y0: self.y0 + dy, x1: self.x1 + dx, y1: self.y1 + dy }
    }

    /// Returns the rectangle turned by quarter turns about the origin.
    pub fn turned(&self, q: u8) -> Self {
        let ((ax, ay), (bx, by)) = (turn(q, self.x0, self.y0), turn(q, self.x1, self.y1));
        Self::new(ax, ay, bx, by)
    }

    /// Returns the rectangle mirrored left to right of a front along +x.
    pub fn mirrored(&self) -> Self {
        Self { x0: self.x0, y0: -self.y1, x1: self.x1, y1: -self.y0 }
    }

    /// Returns the gap between two rectangles along the worse axis, mm; 0 when they touch or overlap.
    pub fn gap(&self, o: &Self) -> i32 {
        let dx = (self.x0 - o.x1).max(o.x0 - self.x1);
        let dy = (self.y0 - o.y1).max(o.y0 - self.y1);
        dx.max(dy).max(0)
    }

    /// Returns how far apart two rectangles are, mm; 0 when they touch or overlap.
    pub fn distance(&self, o: &Self) -> i32 {
        let dx = f64::from((self.x0 - o.x1).max(o.x0 - self.x1).max(0));
        let dy = f64::from((self.y0 - o.y1).max(o.y0 - self.y1).max(0));
        (dx * dx + dy * dy).sqrt() as i32
    }
}

/// A rectangle over a height interval, mm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Solid {
    pub rect: Box2,
    pub z0: i32,
    pub z1: i32,
}

impl Solid {
    pub fn overlaps(&self, o: &Self) -> bool {
        self.z0 < o.z1 && o.z0 < self.z1 && self.rect.overlaps(&o.rect)
    }

    /// Returns true for floor covering, which things may stand on.
    pub fn is_flat(&self) -> bool {
        self.z1 - self.z0 <= FLAT
    }

    /// Returns true when a robot cannot pass: not flat on the floor, not above its head.
    pub fn stops_robot(&self) -> bool {
        self.z1 > FLAT && self.z0 < ROBOT_HEIGHT
    }
}

/// As [`d3dgen_model::occupancy::FLAT_M`], mm.
pub(crate) const FLAT: i32 = 30;
/// As [`d3dgen_model::occupancy::ROBOT_HEIGHT_M`], mm.
pub(crate) const ROBOT_HEIGHT: i32 = 1200;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turning_four_times_is_nothing_and_headings_agree() {
        let b = Box2::new(-100, -300, 500, 200);
        assert_eq!((0..4).fold(b, |b, _| b.turned(1)), b);
        for q in 0..4 {
            assert_eq!(turn(q, 1, 0), DIR[q as usize]);
            assert_eq!(turn(q, 0, 1), DIR[(q as usize + 1) % 4]);
            assert_eq!(b.turned(q).turned((4 - q) % 4), b);
        }
    }
}
