//! Turns a plan that is drawn at an angle upright, so that most of its walls run along x and y.

use d3dgen_model::Point;

use crate::drawing::{Drawing, note};
use crate::shape::edges;

/// Angles below this are drawn that way by accident or not at all, rad.
const LEAST_RAD: f64 = 0.0005;
/// Bins that a quarter turn is divided into when the main direction is looked for.
const BINS: usize = 180;

/// Turns the drawing about its first point, and says so.
pub(crate) fn turn(drawing: &mut Drawing) {
    let rooms = drawing.rooms.iter().flat_map(|r| edges(&r.corners));
    let lines: Vec<(Point, Point)> = rooms.chain(drawing.walls.iter().map(|w| (w.line[0], w.line[1]))).collect();
    let Some(angle) = main_angle(&lines) else { return };
    if angle.abs() < LEAST_RAD {
        return;
    }
    let Some(&(about, _)) = lines.first() else { return };
    let (sin, cos) = (-angle).sin_cos();
    for p in drawing.points_mut() {
        let (x, y) = (p.x - about.x, p.y - about.y);
        *p = Point::new(about.x + x * cos - y * sin, about.y + x * sin + y * cos);
    }
    let message = format!(
        "the plan is drawn at {:.2} degrees; it was turned upright about ({:.3}, {:.3}) m",
        angle.to_degrees(),
        about.x,
        about.y
    );
    drawing.notes.push(note("turned", message));
}

/// Returns the direction most wall meters run in, modulo a quarter turn, rad in (-pi/4, pi/4].
fn main_angle(lines: &[(Point, Point)]) -> Option<f64> {
    let quarter = std::f64::consts::FRAC_PI_2;
    let polar = |a: &Point, b: &Point| {
        let angle = (b.y - a.y).atan2(b.x - a.x).rem_euclid(quarter);
        (angle, a.distance(*b))
    };
    let mut bins = [0.0; BINS];
    let bin = |angle: f64| ((angle / quarter * BINS as f64).round() as usize) % BINS;
    for (a, b) in lines {
        let (angle, length) = polar(a, b);
        bins[bin(angle)] += length;
    }
    let best = (0..BINS).max_by(|&i, &j| bins[i].total_cmp(&bins[j]).then(j.cmp(&i)))?;
    let center = best as f64 * quarter / BINS as f64;
    let (mut sum, mut weight) = (0.0, 0.0);
    for (a, b) in lines {
        let (angle, length) = polar(a, b);
        let off = (angle - center + quarter / 2.0).rem_euclid(quarter) - quarter / 2.0;
        if off.abs() <= 1.5 * quarter / BINS as f64 {
            sum += off * length;
            weight += length;
        }
    }
    let angle = center + if weight > 0.0 { sum / weight } else { 0.0 };
    Some(if angle > quarter / 2.0 { angle - quarter } else { angle })
}
