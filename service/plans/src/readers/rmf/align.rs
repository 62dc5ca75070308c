//! Two levels become one frame: a turn, a scale and a shift that bring the points of one on those of the other.

use d3dgen_model::Point;

/// Scales further from 1 than this are no rounding: the points are not the same ones.
const ODD_SCALE: f64 = 0.2;
/// Points that lie farther from one another than this afterwards are not the same ones, m.
const FAR_M: f64 = 2.0;

/// x' = a x - b y + e, y' = b x + a y + f.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shift {
    a: f64,
    b: f64,
    e: f64,
    f: f64,
}

impl Default for Shift {
    fn default() -> Self {
        Self { a: 1.0, b: 0.0, e: 0.0, f: 0.0 }
    }
}

impl Shift {
    pub(super) fn of(&self, p: Point) -> Point {
        Point::new(self.a * p.x - self.b * p.y + self.e, self.b * p.x + self.a * p.y + self.f)
    }

    /// Returns the angle that it turns by, rad.
    pub(super) fn angle_rad(&self) -> f64 {
        self.b.atan2(self.a)
    }
}

/// Returns what brings the first points of pairs nearest to the second ones, and how far apart they are then at most, m.
/// One pair shifts only.
pub(super) fn shift(pairs: &[(Point, Point)]) -> Option<(Shift, f64)> {
    let n = pairs.len() as f64;
    let mean = |of: fn(&(Point, Point)) -> Point| {
        let sum = pairs.iter().map(of).fold((0.0, 0.0), |s, p| (s.0 + p.x, s.1 + p.y));
        Point::new(sum.0 / n, sum.1 / n)
    };
    if pairs.is_empty() {
        return None;
    }
    let (from, to) = (mean(|p| p.0), mean(|p| p.1));
    let (mut square, mut along, mut across) = (0.0, 0.0, 0.0);
    for (p, q) in pairs {
        let (px, py, qx, qy) = (p.x - from.x, p.y - from.y, q.x - to.x, q.y - to.y);
        square += px * px + py * py;
        along += px * qx + py * qy;
        across += px * qy - py * qx;
    }
    let (a, b) = if square > 1e-6 { (along / square, across / square) } else { (1.0, 0.0) };
    let shift = Shift { a, b, e: to.x - a * from.x + b * from.y, f: to.y - b * from.x - a * from.y };
    let off = pairs.iter().map(|(p, q)| shift.of(*p).distance(*q)).fold(0.0, f64::max);
    ((a.hypot(b) - 1.0).abs() <= ODD_SCALE && off <= FAR_M).then_some((shift, off))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_turned_and_shifted_come_back() {
        let points = [(0.0, 0.0), (8.0, 0.0), (8.0, 5.0)].map(|(x, y)| Point::new(x, y));
        let turned = |p: Point| Point::new(3.0 - 1.02 * p.y, -7.0 + 1.02 * p.x);
        let pairs: Vec<(Point, Point)> = points.iter().map(|p| (*p, turned(*p))).collect();
        let (found, off) = shift(&pairs).expect("the same points");
        assert!(off < 1e-9 && (found.angle_rad() - std::f64::consts::FRAC_PI_2).abs() < 1e-9, "{found:?}");
        let (one, _) = shift(&pairs[1..2]).expect("a shift");
        assert_eq!((one.angle_rad(), one.of(points[1])), (0.0, turned(points[1])));
        let wrong = [(points[0], points[0]), (points[1], points[0]), (points[2], points[1])];
        assert_eq!((shift(&wrong), shift(&[])), (None, None));
    }
}
