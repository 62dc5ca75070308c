//! Round bars along a path.

use std::f64::consts::TAU;

use super::{Detail, Hull, Made};
use crate::affine::{Vec3, add, cross, dot, length, scale, sub, unit};
use crate::surface::Surface;

/// Bends sharper than this many cosines of half their angle would grow spikes.
const SHARPEST: f64 = 0.25;

/// Returns a round bar of `radius` m through the points; `smooth` rounds its bends, `closed` joins its ends.
///
/// # Errors
/// When the radius or a piece of the path has no length.
pub(in crate::builds) fn tube(
    path: &[Vec3],
    radius: f64,
    smooth: bool,
    closed: bool,
    detail: Detail,
) -> Result<Made, String> {
    if radius <= 0.0 {
        return Err(format!("the radius {radius:.4} m is not above 0"));
    }
    let mut points = path.to_vec();
    points.dedup_by(|a, b| length(sub(*a, *b)) < 1e-6);
    if closed && points.len() > 2 && length(sub(points[0], points[points.len() - 1])) < 1e-6 {
        points.pop();
    }
    if points.len() < 2 || (closed && points.len() < 3) {
        return Err("the path has too few different points".to_owned());
    }
    let line = if smooth { rounded(&points, closed, radius, detail) } else { points.clone() };
    let sides = if radius < 0.03 || detail.0 < 0.7 { 8 } else { 12 };
    let surface = sweep(&line, radius, sides, closed);
    Ok(Made { surface, hulls: hulls(&points, radius, closed) })
}

/// Replaces each bend by a curve.
fn rounded(points: &[Vec3], closed: bool, radius: f64, detail: Detail) -> Vec<Vec3> {
    let count = points.len();
    let steps = if detail.0 < 0.7 { 2 } else { 4 };
    let mut line = Vec::new();
    for (i, point) in points.iter().enumerate() {
        let ends = i == 0 || i + 1 == count;
        if ends && !closed {
            line.push(*point);
            continue;
        }
        let (before, after) = (points[(i + count - 1) % count], points[(i + 1) % count]);
        let (a, b) = (sub(before, *point), sub(after, *point));
        let reach = (4.0 * radius).max(0.03).min(0.45 * length(a)).min(0.45 * length(b));
        let (from, to) = (add(*point, scale(unit(a), reach)), add(*point, scale(unit(b), reach)));
        for step in 0..=steps {
            let t = step as f64 / steps as f64;
            let curve = |k: usize| from[k] * (1.0 - t).powi(2) + point[k] * 2.0 * t * (1.0 - t) + to[k] * t * t;
            line.push(std::array::from_fn(curve));
        }
    }
    line
}

/// Sweeps a circle along a line, mitered at its bends.
fn sweep(line: &[Vec3], radius: f64, sides: usize, closed: bool) -> Surface {
    let count = line.len();
    let pieces = if closed { count } else { count - 1 };
    let direction = |i: usize| unit(sub(line[(i + 1) % count], line[i % count]));
    let first = direction(0);
    // The circle starts along an axis where it can, so that straight bars touch their box.
    let least = (0..3).min_by(|a, b| first[*a].abs().total_cmp(&first[*b].abs())).unwrap_or(0);
    let mut side = [0.0; 3];
    side[least] = 1.0;
    let mut side = unit(sub(side, scale(first, dot(side, first))));
    let mut rings: Vec<Vec<Vec3>> = Vec::new();
    let mut normals: Vec<Vec<Vec3>> = Vec::new();
    for (i, middle) in line.iter().enumerate() {
        let before = if i > 0 { Some(direction(i - 1)) } else { closed.then(|| direction(count - 1)) };
        let after = if i < pieces { Some(direction(i)) } else { None };
        let along = before.or(after).unwrap_or(first);
        side = unit(sub(side, scale(along, dot(side, along))));
        let up = cross(along, side);
        let miter = match (before, after) {
            (Some(a), Some(b)) if length(add(a, b)) > 2.0 * SHARPEST => unit(add(a, b)),
            _ => along,
        };
        let stretch = dot(along, miter).max(SHARPEST);
        let mut ring = Vec::new();
        let mut normal = Vec::new();
        for k in 0..sides {
            let (sin, cos) = (TAU * k as f64 / sides as f64).sin_cos();
            let clean = |v: f64| if v.abs() < 1e-9 { 0.0 } else { v };
            let out = add(scale(side, clean(cos)), scale(up, clean(sin)));
            // Slides the corner along the bar onto the miter plane.
            let slide = -dot(out, miter) * radius / stretch;
            ring.push(add(*middle, add(scale(out, radius), scale(along, slide))));
            normal.push(unit(sub(out, scale(miter, dot(out, miter)))));
        }
        rings.push(ring);
        normals.push(normal);
        if let Some(after) = after {
            // Carries the start of the circle around the bend.
            if before.is_some() {
                side = carry(side, along, after);
            }
        }
    }
    let mut surface = Surface::default();
    let rows: Vec<Vec<u32>> = rings
        .iter()
        .zip(&normals)
        .map(|(ring, normal)| ring.iter().zip(normal).map(|(p, n)| surface.corner(*p, *n)).collect())
        .collect();
    for i in 0..count - 1 {
        surface.strip(&rows[i], &rows[i + 1], true);
    }
    if closed {
        close(&mut surface, &rows, sides);
    } else {
        let mut low = rings[0].clone();
        low.reverse();
        surface.face(&low);
        surface.face(&rings[count - 1]);
    }
    surface.outward()
}

/// Turns a vector across `from` by the least turn that takes `from` to `to`.
fn carry(vector: Vec3, from: Vec3, to: Vec3) -> Vec3 {
    let axis = cross(from, to);
    let (sin, cos) = (length(axis), dot(from, to));
    if sin < 1e-9 {
        return vector;
    }
    let axis = unit(axis);
    let turned =
        add(add(scale(vector, cos), scale(cross(axis, vector), sin)), scale(axis, dot(axis, vector) * (1.0 - cos)));
    unit(sub(turned, scale(to, dot(turned, to))))
}

/// Joins the last circle to the first at the offset where they fit best.
fn close(surface: &mut Surface, rows: &[Vec<u32>], sides: usize) {
    let (last, first) = (&rows[rows.len() - 1], &rows[0]);
    let away = |offset: usize| -> f64 {
        (0..sides)
            .map(|k| {
                let (a, b) = (last[k] as usize, first[(k + offset) % sides] as usize);
                length(sub(surface.normals[a], surface.normals[b]))
            })
            .sum()
    };
    let offset = (0..sides).min_by(|a, b| away(*a).total_cmp(&away(*b))).unwrap_or(0);
    let turned: Vec<u32> = (0..sides).map(|k| first[(k + offset) % sides]).collect();
    surface.strip(&last.clone(), &turned, true);
}

fn hulls(points: &[Vec3], radius: f64, closed: bool) -> Vec<Hull> {
    let count = points.len();
    let pieces = if closed { count } else { count - 1 };
    (0..pieces)
        .map(|i| {
            let (a, b) = (points[i], points[(i + 1) % count]);
            let way = sub(b, a);
            let center = scale(add(a, b), 0.5);
            let half = length(way) / 2.0;
            let direction = unit(way);
            match (0..3).find(|k| direction[*k].abs() > 0.999) {
                Some(axis) => Hull::Cylinder { center, radius, half, axis },
                None => Hull::Bar { center, direction, half, radius },
            }
        })
        .collect()
}
