//! Foliage: leaves on a spiral, each a thin closed blade.

use std::f64::consts::PI;

use d3dgen_model::seed::Stream;

use super::{Detail, Frame, Made};
use crate::affine::{Vec3, add, cross, scale, unit};
use crate::surface::Surface;

/// Turn from one leaf to the next, as plants have it.
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

/// Returns `count` leaves that fill the box, spread around its middle line.
pub(in crate::builds) fn leaves(frame: &Frame, count: usize, stream: &mut Stream, detail: Detail) -> Made {
    let count = ((count as f64 * detail.0.max(0.5)) as usize).clamp(3, 400);
    let mut surface = Surface::default();
    for i in 0..count {
        let share = (i as f64 + 0.5) / count as f64;
        let angle = i as f64 * GOLDEN_ANGLE + 0.5 * stream.unit();
        // Lower leaves reach out and hang, upper ones stand.
        let pitch = -0.35 + 1.6 * share.powf(1.2) + 0.35 * (stream.unit() - 0.5);
        let root = [0.0, 0.0, 0.75 * share];
        let reach = (0.55 + 0.45 * (share * PI).sin()) * (0.85 + 0.3 * stream.unit());
        let out = [angle.cos() * pitch.cos(), angle.sin() * pitch.cos(), 0.8 * pitch.sin()];
        blade(&mut surface, root, scale(out, reach), 0.2 + 0.6 / (count as f64).sqrt());
    }
    let surface = surface.outward().fitted(frame.min, frame.max);
    Made { surface, hulls: vec![frame.hull()] }
}

/// Adds a leaf from its root along `way`: a flat blade, creased and bent down at its tip.
fn blade(surface: &mut Surface, root: Vec3, way: Vec3, width: f64) {
    let side = unit(cross(way, [0.0, 0.0, 1.0]));
    let up = unit(cross(side, way));
    let reach = way.iter().map(|v| v * v).sum::<f64>().sqrt();
    let middle = add(root, add(scale(way, 0.5), scale(up, 0.08 * reach)));
    let tip = add(root, add(way, [0.0, 0.0, -0.12 * reach]));
    let half = scale(side, width * reach * 0.5);
    let (left, right) = (add(middle, half), add(middle, scale(half, -1.0)));
    let over = add(middle, scale(up, 0.02 * reach));
    let under = add(middle, scale(up, -0.05 * reach));
    for (a, b) in [(root, right), (right, tip), (tip, left), (left, root)] {
        surface.face(&[a, b, over]);
        surface.face(&[b, a, under]);
    }
}
