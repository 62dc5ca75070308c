//! The largest circle on the free floor of a room, for wheelchairs and robots that turn on the spot.

use std::collections::BinaryHeap;

use d3dgen_model::geometry::Segment;
use d3dgen_model::{Point, Polygon};

/// A square is not looked into for a gain in radius below this, m.
const GAIN_M: f64 = 0.004;
/// Step at which the search for a better middle ends, m.
const FINEST_M: f64 = 0.000_5;

/// A square that may hold the middle of a larger circle than is known.
#[derive(Debug, Clone, Copy)]
struct Square {
    /// No circle with its middle in the square is larger, m.
    most: f64,
    middle: Point,
    half: f64,
}

impl PartialEq for Square {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Square {}

impl PartialOrd for Square {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Square {
    /// The most promising square is the greatest; of equals the one further south-west.
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let place = |s: &Self| (s.middle.y, s.middle.x);
        let ((y, x), (v, u)) = (place(self), place(other));
        self.most.total_cmp(&other.most).then(v.total_cmp(&y)).then(u.total_cmp(&x))
    }
}

/// Returns the diameter of the largest circle within an outline that meets no obstacle, m; 0 when there is none.
///
/// Squares are split in four while one of them may hold something better: the radius around a point is at most that
/// around another point and the way between them.
pub(super) fn largest(outline: &Polygon, obstacles: &[Polygon]) -> f64 {
    let walls: Vec<Segment> = outline.edges().collect();
    let nearest = |p: Point, lines: &[Segment]| lines.iter().map(|l| squared(p, l)).fold(f64::MAX, f64::min);
    let sides: Vec<Segment> = obstacles.iter().flat_map(Polygon::edges).collect();
    let is_taken = |p: Point| obstacles.iter().any(|o| o.contains(p));
    // below 0 outside of the outline and within an obstacle
    let radius = |p: Point| match (outline.contains(p), is_taken(p)) {
        (true, false) => nearest(p, &sides).min(nearest(p, &walls)).sqrt(),
        (false, _) => -nearest(p, &walls).sqrt(),
        (true, true) => -nearest(p, &sides).sqrt(),
    };
    let bounds = outline.bounds();
    let size = bounds.width().min(bounds.height());
    if size <= 0.0 {
        return 0.0;
    }
    let mut open = BinaryHeap::new();
    let mut best = (Point::new(0.0, 0.0), 0.0);
    let look = |middle: Point, half: f64, open: &mut BinaryHeap<Square>, best: &mut (Point, f64)| {
        let r = radius(middle);
        if r > best.1 {
            *best = (middle, r);
        }
        let most = r + half * std::f64::consts::SQRT_2;
        if most > best.1 + GAIN_M {
            open.push(Square { most, middle, half });
        }
    };
    let half = size / 2.0;
    let count = |length: f64| (length / size).ceil() as usize;
    for i in 0..count(bounds.width()) {
        for j in 0..count(bounds.height()) {
            let middle = Point::new(bounds.x0 + (i as f64 + 0.5) * size, bounds.y0 + (j as f64 + 0.5) * size);
            look(middle, half, &mut open, &mut best);
        }
    }
    while let Some(square) = open.pop() {
        if square.most <= best.1 + GAIN_M {
            break;
        }
        let half = square.half / 2.0;
        for (dx, dy) in [(-half, -half), (half, -half), (-half, half), (half, half)] {
            look(Point::new(square.middle.x + dx, square.middle.y + dy), half, &mut open, &mut best);
        }
    }
    let (mut middle, mut found) = best;
    let mut step = 2.0 * GAIN_M;
    while found > 0.0 && step > FINEST_M {
        let around = [(step, 0.0), (-step, 0.0), (0.0, step), (0.0, -step), (step, step), (-step, -step)];
        let tried = around.map(|(dx, dy)| Point::new(middle.x + dx, middle.y + dy)).map(|p| (p, radius(p)));
        match tried.into_iter().max_by(|x, y| x.1.total_cmp(&y.1)) {
            Some((p, r)) if r > found => (middle, found) = (p, r),
            _ => step /= 2.0,
        }
    }
    2.0 * found
}

/// Returns the square of the distance of a point from a line, m^2.
fn squared(p: Point, line: &Segment) -> f64 {
    let (dx, dy) = (line.end.x - line.start.x, line.end.y - line.start.y);
    let length = dx * dx + dy * dy;
    let along = if length > 0.0 { ((p.x - line.start.x) * dx + (p.y - line.start.y) * dy) / length } else { 0.0 };
    let at = along.clamp(0.0, 1.0);
    let (x, y) = (line.start.x + at * dx - p.x, line.start.y + at * dy - p.y);
    x * x + y * y
}

#[cfg(test)]
mod tests {
    use d3dgen_model::Rect;

    use super::*;

    fn boxed(x0: f64, y0: f64, x1: f64, y1: f64) -> Polygon {
        Polygon(Rect::new(x0, y0, x1, y1).corners().to_vec())
    }

    #[test]
    fn circles_pass_corners_that_squares_do_not() {
        let room = boxed(0.0, 0.0, 2.0, 2.0);
        assert!((largest(&room, &[]) - 2.0).abs() < 0.01);
        // a square beside the box in the corner is 1.6 m wide; the circle may reach around its corner
        let beside = largest(&room, &[boxed(0.0, 0.0, 0.4, 0.4)]);
        assert!((1.86..1.90).contains(&beside), "{beside}");
        assert_eq!(largest(&room, &[boxed(-1.0, -1.0, 3.0, 3.0)]), 0.0);
    }

    #[test]
    fn walls_and_things_at_an_angle_take_no_more_than_their_own_floor() {
        // a square on its corner, 2 m a side: the bounding boxes of its walls fill it
        let d = 2.0_f64.sqrt();
        let turned = Polygon([(0.0, -d), (d, 0.0), (0.0, d), (-d, 0.0)].map(|(x, y)| Point::new(x, y)).to_vec());
        assert!((largest(&turned, &[]) - 2.0).abs() < 0.01, "{}", largest(&turned, &[]));
        // a board across the corner of a room: what is before it is free
        let room = boxed(0.0, 0.0, 3.0, 3.0);
        let board = Polygon([(0.0, 1.0), (1.0, 0.0), (1.1, 0.1), (0.1, 1.1)].map(|(x, y)| Point::new(x, y)).to_vec());
        let before = largest(&room, &[board]);
        assert!((2.6..3.0).contains(&before), "{before}");
    }
}
