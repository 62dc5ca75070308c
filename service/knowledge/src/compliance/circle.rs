//! The largest circle on the free floor of a room, for wheelchairs and robots that turn on the spot.

use d3dgen_model::{Point, Polygon, Rect, Segment};

/// Step of the first look, m.
const STEP_M: f64 = 0.05;
/// Step at which the search for a better middle ends, m.
const FINEST_M: f64 = 0.002;

/// Returns the diameter of the largest circle within an outline that meets no obstacle, m; 0 when there is none.
pub(super) fn largest(outline: &Polygon, obstacles: &[Rect]) -> f64 {
    let bounds = outline.bounds();
    let walls: Vec<Segment> = outline.edges().collect();
    let radius = |p: Point| {
        let to_walls = walls.iter().map(|w| to_segment(p, w)).fold(f64::MAX, f64::min);
        obstacles.iter().map(|o| to_rect(p, o)).fold(to_walls, f64::min)
    };
    let mut best: Option<(Point, f64)> = None;
    let steps = |length: f64| 1..(length / STEP_M).ceil().max(1.0) as usize;
    for i in steps(bounds.width()) {
        for j in steps(bounds.height()) {
            let p = Point::new(bounds.x0 + i as f64 * STEP_M, bounds.y0 + j as f64 * STEP_M);
            let r = radius(p);
            if best.is_none_or(|b| r > b.1) && outline.contains(p) {
                best = Some((p, r));
            }
        }
    }
    let Some((mut middle, mut found)) = best else { return 0.0 };
    let mut step = STEP_M / 2.0;
    while step > FINEST_M {
        let around = [(step, 0.0), (-step, 0.0), (0.0, step), (0.0, -step), (step, step), (-step, -step)];
        let tried = around.map(|(dx, dy)| Point::new(middle.x + dx, middle.y + dy)).map(|p| (p, radius(p)));
        match tried.into_iter().max_by(|x, y| x.1.total_cmp(&y.1)) {
            Some((p, r)) if r > found => (middle, found) = (p, r),
            _ => step /= 2.0,
        }
    }
    2.0 * found
}

/// Returns the distance of a point from an axis-aligned segment, m.
fn to_segment(p: Point, s: &Segment) -> f64 {
    to_rect(p, &Rect::new(s.start.x, s.start.y, s.end.x, s.end.y))
}

/// Returns the distance of a point from a rectangle, m; 0 inside.
fn to_rect(p: Point, r: &Rect) -> f64 {
    let dx = (r.x0 - p.x).max(p.x - r.x1).max(0.0);
    let dy = (r.y0 - p.y).max(p.y - r.y1).max(0.0);
    dx.hypot(dy)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn circles_pass_corners_that_squares_do_not() {
        let room = Polygon(Rect::new(0.0, 0.0, 2.0, 2.0).corners().to_vec());
        assert!((largest(&room, &[]) - 2.0).abs() < 0.01);
        // a square beside the box in the corner is 1.6 m wide; the circle may reach around its corner
        let boxed = largest(&room, &[Rect::new(0.0, 0.0, 0.4, 0.4)]);
        assert!((1.86..1.90).contains(&boxed), "{boxed}");
        assert_eq!(largest(&room, &[Rect::new(-1.0, -1.0, 3.0, 3.0)]), 0.0);
    }
}
