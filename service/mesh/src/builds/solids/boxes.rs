//! Boxes: with cut edges, with round edges, and open with walls.

use std::f64::consts::FRAC_PI_2;

use d3dgen_model::domain::Side;

use super::{Detail, Frame, Made};
use crate::affine::Vec3;
use crate::surface::Surface;

/// Returns an upright box with edges cut at 45 degrees over `bevel` m.
pub(in crate::builds) fn upright_box(frame: &Frame, bevel: f64) -> Made {
    let size = frame.size();
    let bevel = bevel.min(size.iter().copied().fold(f64::MAX, f64::min) * 0.45);
    let mut surface = Surface::default();
    // The corner at (x, y, z) as it lies on the face across `axis`.
    let corner = |ends: [usize; 3], axis: usize| -> Vec3 {
        std::array::from_fn(|i| {
            let inset = if i == axis { 0.0 } else { bevel };
            if ends[i] == 0 { frame.min[i] + inset } else { frame.max[i] - inset }
        })
    };
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for end in 0..2 {
            let at = |a: usize, b: usize| {
                let mut ends = [0; 3];
                (ends[axis], ends[u], ends[v]) = (end, a, b);
                corner(ends, axis)
            };
            let face = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
            surface.face(&if end == 1 { face } else { [face[0], face[3], face[2], face[1]] });
        }
    }
    if bevel > 0.0 {
        cut_edges(&mut surface, &corner);
    }
    Made { surface: surface.outward(), hulls: vec![frame.hull()] }
}

fn cut_edges(surface: &mut Surface, corner: &dyn Fn([usize; 3], usize) -> Vec3) {
    for along in 0..3 {
        let (u, v) = ((along + 1) % 3, (along + 2) % 3);
        for (a, b) in [(0, 0), (1, 0), (1, 1), (0, 1)] {
            let at = |end: usize, face: usize| {
                let mut ends = [0; 3];
                (ends[along], ends[u], ends[v]) = (end, a, b);
                corner(ends, face)
            };
            let quad = [at(0, u), at(1, u), at(1, v), at(0, v)];
            surface.face(&if a == b { [quad[3], quad[2], quad[1], quad[0]] } else { quad });
        }
    }
    for x in 0..2 {
        for y in 0..2 {
            for z in 0..2 {
                let [p, q, r] = [0, 1, 2].map(|face| corner([x, y, z], face));
                surface.face(&if (x + y + z) % 2 == 1 { [p, q, r] } else { [p, r, q] });
            }
        }
    }
}

/// Returns a box whose edges are rounded over `round` m.
pub(in crate::builds) fn cushion(frame: &Frame, round: f64, detail: Detail) -> Made {
    let size = frame.size();
    let radius = round.min(size.iter().copied().fold(f64::MAX, f64::min) / 2.0).max(1e-5);
    let steps = if detail.0 < 0.7 || radius < 0.012 { 2 } else { 3 };
    let mut surface = Surface::default();
    let rows: Vec<Vec<u32>> = latitudes(steps)
        .into_iter()
        .map(|(latitude, upper)| {
            let mut row = Vec::new();
            for quadrant in 0..4 {
                let (right, back) = ([true, false, false, true][quadrant], [true, true, false, false][quadrant]);
                for step in 0..=steps {
                    let angle = (quadrant as f64 + step as f64 / steps as f64) * FRAC_PI_2;
                    let direction = direction(angle, latitude);
                    let far = [right, back, upper];
                    let position = std::array::from_fn(|i| {
                        let core = if far[i] { frame.max[i] - radius } else { frame.min[i] + radius };
                        core + radius * direction[i]
                    });
                    row.push(surface.corner(position, direction));
                }
            }
            row
        })
        .collect();
    for pair in rows.windows(2) {
        surface.strip(&pair[0], &pair[1], true);
    }
    let n = steps + 1;
    for (row, order) in [(0, [0, 3, 2, 1]), (rows.len() - 1, [0, 1, 2, 3])] {
        let ids = order.map(|quadrant| rows[row][quadrant * n]);
        surface.triangle(ids[0], ids[1], ids[2]);
        surface.triangle(ids[0], ids[2], ids[3]);
    }
    Made { surface: surface.outward(), hulls: vec![frame.hull()] }
}

/// Returns the rows from the lower to the upper pole, the equator twice, each with its half.
fn latitudes(steps: usize) -> Vec<(f64, bool)> {
    let at = |i: usize| FRAC_PI_2 * i as f64 / steps as f64;
    (0..=steps).rev().map(|i| (-at(i), false)).chain((0..=steps).map(|i| (at(i), true))).collect()
}

/// Returns a unit vector whose parts are exact at quarter turns.
fn direction(angle: f64, latitude: f64) -> Vec3 {
    let clean = |v: f64| if v.abs() < 1e-9 { 0.0 } else { v };
    let (level, up) = (clean(latitude.cos()), clean(latitude.sin()));
    [clean(angle.cos()) * level, clean(angle.sin()) * level, up]
}

/// Returns a box with one open side, walls of `wall` m and a bottom of `bottom` m.
///
/// # Errors
/// When the walls leave no room inside.
pub(in crate::builds) fn shell(frame: &Frame, wall: f64, bottom: f64, open: Side) -> Result<Made, String> {
    // Made with the opening at the top, then turned: `deep` is the axis of the opening, `up` which end is open.
    let (deep, up) = match open {
        Side::Top => (2, true),
        Side::Bottom => (2, false),
        Side::Front => (1, false),
        Side::Back => (1, true),
        Side::Left => (0, false),
        Side::Right => (0, true),
    };
    let (u, v) = ((deep + 1) % 3, (deep + 2) % 3);
    let size = frame.size();
    if wall <= 0.0 || bottom <= 0.0 || 2.0 * wall >= size[u].min(size[v]) || bottom >= size[deep] {
        return Err(format!("walls of {wall:.4} m and a bottom of {bottom:.4} m leave no room inside"));
    }
    let (floor, rim) =
        if up { (frame.min[deep] + bottom, frame.max[deep]) } else { (frame.max[deep] - bottom, frame.min[deep]) };
    let under = if up { frame.min[deep] } else { frame.max[deep] };
    let ring = |inset: f64, level: f64| -> [Vec3; 4] {
        [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(a, b)| {
            let mut p = [0.0; 3];
            p[deep] = level;
            p[u] = if a == 0 { frame.min[u] + inset } else { frame.max[u] - inset };
            p[v] = if b == 0 { frame.min[v] + inset } else { frame.max[v] - inset };
            p
        })
    };
    let (outer_low, outer_high, inner_high, inner_low) =
        (ring(0.0, under), ring(0.0, rim), ring(wall, rim), ring(wall, floor));
    let mut surface = Surface::default();
    let mut reversed = outer_low;
    reversed.reverse();
    surface.face(&reversed);
    surface.face(&inner_low);
    for i in 0..4 {
        let j = (i + 1) % 4;
        surface.face(&[outer_low[i], outer_low[j], outer_high[j], outer_high[i]]);
        surface.face(&[outer_high[i], outer_high[j], inner_high[j], inner_high[i]]);
        surface.face(&[inner_high[i], inner_high[j], inner_low[j], inner_low[i]]);
    }
    let mut hulls = Vec::new();
    let mut plate = |min: Vec3, max: Vec3| hulls.push(Frame { min, max }.hull());
    let mut floor_max = frame.max;
    let mut floor_min = frame.min;
    if up {
        floor_max[deep] = floor;
    } else {
        floor_min[deep] = floor;
    }
    plate(floor_min, floor_max);
    for axis in [u, v] {
        for end in 0..2 {
            let (mut min, mut max) = (frame.min, frame.max);
            if end == 0 {
                max[axis] = min[axis] + wall;
            } else {
                min[axis] = max[axis] - wall;
            }
            plate(min, max);
        }
    }
    Ok(Made { surface: surface.outward(), hulls })
}
