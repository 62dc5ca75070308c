//! Solids of revolution: cylinders, cones, balls, turned profiles and rings.

use std::f64::consts::{PI, TAU};

use super::{Detail, Frame, Hull, Made, along};
use crate::affine::{Vec3, add, unit};
use crate::surface::Surface;

/// Neighboring pieces of a profile that bend by less share one normal: cosine of 40 degrees.
const SMOOTH: f64 = 0.766;

/// Turns a profile of `[radius, height]` about the local z axis and closes its ends.
///
/// A profile that returns to its first point makes a ring. `stretch` are factors on the radius along local x and y.
fn revolve(profile: &[[f64; 2]], center: [f64; 2], stretch: [f64; 2], steps: usize, axis: usize) -> Surface {
    let mut surface = Surface::default();
    let ring = |[radius, height]: [f64; 2]| -> Vec<Vec3> {
        circle(steps)
            .map(|(cos, sin)| {
                let p = [center[0] + radius * stretch[0] * cos, center[1] + radius * stretch[1] * sin, height];
                along(axis, p)
            })
            .collect()
    };
    let lathe_normal = |[nr, nz]: [f64; 2], (cos, sin): (f64, f64)| {
        along(axis, unit([nr * cos / stretch[0], nr * sin / stretch[1], nz]))
    };
    let is_ring = profile.len() > 2 && profile[0] == profile[profile.len() - 1];
    let pieces = profile.len() - 1;
    let flat: Vec<[f64; 2]> = profile
        .windows(2)
        .map(|p| {
            let (dr, dz) = (p[1][0] - p[0][0], p[1][1] - p[0][1]);
            let length = dr.hypot(dz).max(1e-12);
            [dz / length, -dr / length]
        })
        .collect();
    let shared = |a: usize, b: usize| {
        let (p, q) = (flat[a], flat[b]);
        if p[0] * q[0] + p[1] * q[1] > SMOOTH { [p[0] + q[0], p[1] + q[1]] } else { [0.0, 0.0] }
    };
    let rings: Vec<Vec<Vec3>> = profile.iter().map(|p| ring(*p)).collect();
    for piece in 0..pieces {
        let mut ends = [flat[piece]; 2];
        let before = if piece > 0 { Some(piece - 1) } else { is_ring.then(|| pieces - 1) };
        let after = if piece + 1 < pieces { Some(piece + 1) } else { is_ring.then_some(0) };
        for (end, neighbor) in [(0, before), (1, after)] {
            if let Some(neighbor) = neighbor {
                let sum = shared(piece, neighbor);
                if sum != [0.0, 0.0] {
                    ends[end] = sum;
                }
            }
        }
        let rows = [0, 1].map(|end| {
            let corners = rings[piece + end].iter().zip(circle(steps));
            corners.map(|(p, turn)| surface.corner(*p, lathe_normal(ends[end], turn))).collect::<Vec<u32>>()
        });
        surface.strip(&rows[0], &rows[1], true);
    }
    if !is_ring {
        for (row, up) in [(0, false), (pieces, true)] {
            if profile[row][0] > 0.0 {
                let mut rim = rings[row].clone();
                if !up {
                    rim.reverse();
                }
                surface.face(&rim);
            }
        }
    }
    surface.outward()
}

/// Returns cosine and sine of the steps of a full turn, exact at quarter turns.
fn circle(steps: usize) -> impl Iterator<Item = (f64, f64)> {
    let clean = |v: f64| if v.abs() < 1e-9 { 0.0 } else { v };
    (0..steps).map(move |i| {
        let (sin, cos) = (TAU * i as f64 / steps as f64).sin_cos();
        (clean(cos), clean(sin))
    })
}

/// Returns the two directions across an axis in the order of the local frame, see [`along`].
fn across(axis: usize) -> (usize, usize) {
    ((axis + 1) % 3, (axis + 2) % 3)
}

/// Returns a round bar along an axis, tapered to `top` of its radius, with rims cut over `bevel` m.
pub(in crate::builds) fn cone(frame: &Frame, axis: usize, top: f64, bevel: f64, detail: Detail) -> Made {
    let (u, v) = across(axis);
    let (size, center) = (frame.size(), frame.center());
    let (ru, rv) = (size[u] / 2.0, size[v] / 2.0);
    let radius = ru.max(rv);
    let (low, high) = (frame.min[axis], frame.max[axis]);
    let (bottom, top) = if top > 1.0 { (1.0 / top, 1.0) } else { (1.0, top) };
    let cut = bevel.min(radius * 0.45 * bottom.min(top)).min((high - low) * 0.45);
    let share = cut / radius;
    let profile = if cut > 1e-9 {
        vec![[bottom - share, low], [bottom, low + cut], [top, high - cut], [top - share, high]]
    } else {
        vec![[bottom, low], [top, high]]
    };
    let surface = revolve(&profile, [center[u], center[v]], [ru, rv], detail.circle(radius), axis);
    let round = (ru - rv).abs() < 0.05 * radius;
    let hull = if round { Hull::Cylinder { center, radius, half: size[axis] / 2.0, axis } } else { frame.hull() };
    Made { surface, hulls: vec![hull] }
}

/// Returns an ellipsoid.
pub(in crate::builds) fn sphere(frame: &Frame, detail: Detail) -> Made {
    let (size, center) = (frame.size(), frame.center());
    let steps = detail.circle(size.iter().copied().fold(0.0, f64::max) / 2.0);
    let rows = steps / 2;
    let profile: Vec<[f64; 2]> = (0..=rows)
        .map(|i| {
            let angle = PI * i as f64 / rows as f64;
            let radius = if i == 0 || i == rows { 0.0 } else { angle.sin() };
            let height = if 2 * i == rows { 0.0 } else { -angle.cos() };
            [radius, center[2] + height * size[2] / 2.0]
        })
        .collect();
    let mut surface = revolve(&profile, [center[0], center[1]], [size[0] / 2.0, size[1] / 2.0], steps, 2);
    // The profile is round in shares of the radius only: normals of an ellipsoid are exact and easy.
    for (p, n) in surface.positions.iter().zip(&mut surface.normals) {
        *n = unit(std::array::from_fn(|i| (p[i] - center[i]) / (size[i] * size[i])));
    }
    let radius = size[0] / 2.0;
    let round = size.iter().all(|v| (v - size[0]).abs() < 0.05 * size[0]);
    let hull = if round { Hull::Sphere { center, radius } } else { frame.hull() };
    Made { surface, hulls: vec![hull] }
}

/// Returns a profile of `[radius, height]` turned about an axis through `at`.
///
/// # Errors
/// When a radius is negative or all of them are 0.
pub(in crate::builds) fn lathe(
    profile: &[[f64; 2]],
    at: [f64; 2],
    stretch: [f64; 2],
    axis: usize,
    detail: Detail,
) -> Result<Made, String> {
    let radius = profile.iter().map(|p| p[0]).fold(0.0, f64::max);
    if let Some(wrong) = profile.iter().find(|p| p[0] < 0.0) {
        return Err(format!("the radius {:.4} m is negative", wrong[0]));
    }
    if radius <= 0.0 || stretch.iter().any(|s| *s <= 0.0) {
        return Err("has no radius".to_owned());
    }
    let mut points = profile.to_vec();
    points.dedup();
    if points.len() < 2 {
        return Err("has one point only".to_owned());
    }
    // Across y the two directions are given as x and z, the local frame has them as z and x.
    let (center, stretch) = if axis == 1 { ([at[1], at[0]], [stretch[1], stretch[0]]) } else { (at, stretch) };
    let surface = revolve(&points, center, stretch, detail.circle(radius * stretch[0].max(stretch[1])), axis);
    let (low, high) = points.iter().fold((f64::MAX, f64::MIN), |(a, b), p| (a.min(p[1]), b.max(p[1])));
    let middle = along(axis, [center[0], center[1], (low + high) / 2.0]);
    let half = (high - low) / 2.0;
    let hull = if (stretch[0] - stretch[1]).abs() < 0.05 * stretch[0] {
        Hull::Cylinder { center: middle, radius: radius * stretch[0], half, axis }
    } else {
        Hull::Box { center: middle, half: along(axis, [radius * stretch[0], radius * stretch[1], half]) }
    };
    Ok(Made { surface, hulls: vec![hull] })
}

/// Returns a ring about an axis with a bar of `radius` m, inscribed in the box.
///
/// # Errors
/// When the bar is thicker than the ring.
pub(in crate::builds) fn torus(frame: &Frame, radius: f64, axis: usize, detail: Detail) -> Result<Made, String> {
    let (u, v) = across(axis);
    let (size, center) = (frame.size(), frame.center());
    let (ru, rv) = (size[u] / 2.0 - radius, size[v] / 2.0 - radius);
    if radius <= 0.0 || ru <= 0.0 || rv <= 0.0 {
        return Err(format!("a bar of radius {radius:.4} m does not fit the ring"));
    }
    let (around, bar) = (detail.circle(ru.max(rv)).max(16), if detail.0 < 0.7 { 4 } else { 8 });
    let mut surface = Surface::default();
    let rows: Vec<Vec<u32>> = circle(around)
        .map(|(cos, sin)| {
            let outward = unit([cos / ru, sin / rv, 0.0]);
            circle(bar)
                .map(|(across, up)| {
                    let middle = [center[u] + ru * cos, center[v] + rv * sin, center[axis]];
                    let half = size[axis] / 2.0;
                    let offset = [outward[0] * across * radius, outward[1] * across * radius, up * half];
                    let normal = unit([outward[0] * across / radius, outward[1] * across / radius, up / half]);
                    surface.corner(along(axis, add(middle, offset)), along(axis, normal))
                })
                .collect()
        })
        .collect();
    for i in 0..rows.len() {
        surface.strip(&rows[i], &rows[(i + 1) % rows.len()], true);
    }
    let hulls = ring_hulls(frame, axis, radius);
    Ok(Made { surface: surface.outward(), hulls })
}

/// Returns four boxes around the hole of a ring.
fn ring_hulls(frame: &Frame, axis: usize, radius: f64) -> Vec<Hull> {
    let (u, v) = across(axis);
    let mut hulls = Vec::new();
    for side in [u, v] {
        for end in 0..2 {
            let mut part = *frame;
            let inner = frame.size()[side] * 0.15 + radius;
            if end == 0 {
                part.max[side] = part.min[side] + inner.min(frame.size()[side] / 2.0);
            } else {
                part.min[side] = part.max[side] - inner.min(frame.size()[side] / 2.0);
            }
            hulls.push(part.hull());
        }
    }
    hulls
}
