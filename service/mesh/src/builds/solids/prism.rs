//! Outlines pushed along an axis.

use super::{Frame, Hull, Made};
use crate::affine::Vec3;
use crate::surface::Surface;

/// Neighboring edges that bend by less share one normal: cosine of 32 degrees.
const SMOOTH: f64 = 0.848;
/// Most boxes that collide for one prism.
const SLABS: usize = 4;

/// Returns a simple polygon pushed along an axis (0 x: outline in y and z; 1 y: x and z; 2 z: x and y).
///
/// # Errors
/// When the outline crosses itself or has no area.
pub(in crate::builds) fn prism(outline: &[[f64; 2]], axis: usize, range: [f64; 2]) -> Result<Made, String> {
    let mut points: Vec<[f64; 2]> = outline.to_vec();
    points.dedup();
    if points.len() > 1 && points[0] == points[points.len() - 1] {
        points.pop();
    }
    if area(&points) < 0.0 {
        points.reverse();
    }
    if points.len() < 3 || area(&points) < 1e-12 {
        return Err("the outline has no area".to_owned());
    }
    let caps = triangulate(&points).ok_or("the outline crosses itself")?;
    let (u, v) = match axis {
        0 => (1, 2),
        1 => (0, 2),
        _ => (0, 1),
    };
    let place = |p: [f64; 2], level: f64| -> Vec3 {
        let mut out = [0.0; 3];
        (out[axis], out[u], out[v]) = (level, p[0], p[1]);
        out
    };
    let across = |p: [f64; 2]| -> Vec3 { place(p, 0.0) };
    let mut surface = Surface::default();
    for (level, sign) in [(range[0], -1.0), (range[1], 1.0)] {
        let mut normal = [0.0; 3];
        normal[axis] = sign;
        let ids: Vec<u32> = points.iter().map(|p| surface.corner(place(*p, level), normal)).collect();
        for [a, b, c] in &caps {
            let (b, c) = if sign < 0.0 { (c, b) } else { (b, c) };
            surface.triangle(ids[*a], ids[*b], ids[*c]);
        }
    }
    let count = points.len();
    let flat: Vec<[f64; 2]> = (0..count).map(|i| edge_normal(points[i], points[(i + 1) % count])).collect();
    let corner_normal = |edge: usize, neighbor: usize| {
        let (a, b) = (flat[edge], flat[neighbor]);
        if a[0] * b[0] + a[1] * b[1] > SMOOTH {
            let sum = [a[0] + b[0], a[1] + b[1]];
            let length = sum[0].hypot(sum[1]);
            [sum[0] / length, sum[1] / length]
        } else {
            a
        }
    };
    for i in 0..count {
        let j = (i + 1) % count;
        let from = across(corner_normal(i, (i + count - 1) % count));
        let to = across(corner_normal(i, j));
        let ids = [
            surface.corner(place(points[i], range[0]), from),
            surface.corner(place(points[j], range[0]), to),
            surface.corner(place(points[j], range[1]), to),
            surface.corner(place(points[i], range[1]), from),
        ];
        surface.triangle(ids[0], ids[1], ids[2]);
        surface.triangle(ids[0], ids[2], ids[3]);
    }
    let hulls = slabs(&points)
        .into_iter()
        .map(|[min, max]| Frame { min: place(min, range[0]), max: place(max, range[1]) }.hull());
    let hulls: Vec<Hull> = hulls.collect();
    // Outlines across y are left-handed as seen along the axis.
    if axis == 1 {
        surface.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    Ok(Made { surface: surface.outward(), hulls })
}

fn area(points: &[[f64; 2]]) -> f64 {
    let count = points.len();
    (0..count)
        .map(|i| {
            let (a, b) = (points[i], points[(i + 1) % count]);
            a[0] * b[1] - a[1] * b[0]
        })
        .sum::<f64>()
        / 2.0
}

fn edge_normal(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let length = dx.hypot(dy).max(1e-12);
    [dy / length, -dx / length]
}

/// Returns the triangles of a simple counter-clockwise polygon by cutting ears; none when it crosses itself.
pub fn triangulate(points: &[[f64; 2]]) -> Option<Vec<[usize; 3]>> {
    let turn = |a: usize, b: usize, c: usize| {
        let (p, q, r) = (points[a], points[b], points[c]);
        (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
    };
    let mut left: Vec<usize> = (0..points.len()).collect();
    let mut triangles = Vec::new();
    while left.len() > 3 {
        let count = left.len();
        let inside = |[a, b, c]: [usize; 3]| {
            left.iter().any(|p| {
                *p != a
                    && *p != b
                    && *p != c
                    && ![a, b, c].iter().any(|q| points[*q] == points[*p])
                    && turn(a, b, *p) >= 0.0
                    && turn(b, c, *p) >= 0.0
                    && turn(c, a, *p) >= 0.0
            })
        };
        let ears = (0..count).map(|i| [left[(i + count - 1) % count], left[i], left[(i + 1) % count]]);
        let ear = ears.enumerate().find(|(_, t)| turn(t[0], t[1], t[2]) > 1e-14 && !inside(*t));
        match ear {
            Some((i, triangle)) => {
                triangles.push(triangle);
                left.remove(i);
            }
            None => {
                // A corner on a straight line closes without area.
                let straight = (0..count)
                    .find(|i| turn(left[(i + count - 1) % count], left[*i], left[(i + 1) % count]).abs() <= 1e-14)?;
                let triangle = [left[(straight + count - 1) % count], left[straight], left[(straight + 1) % count]];
                triangles.push(triangle);
                left.remove(straight);
            }
        }
    }
    triangles.push([left[0], left[1], left[2]]);
    (turn(left[0], left[1], left[2]) > -1e-9).then_some(triangles)
}

/// Returns boxes that cover an outline, cut across its longer side.
fn slabs(points: &[[f64; 2]]) -> Vec<[[f64; 2]; 2]> {
    let bound = |k: usize| points.iter().fold((f64::MAX, f64::MIN), |(a, b), p| (a.min(p[k]), b.max(p[k])));
    let (u, v) = (bound(0), bound(1));
    let full = (u.1 - u.0) * (v.1 - v.0);
    if area(points) > 0.9 * full {
        return vec![[[u.0, v.0], [u.1, v.1]]];
    }
    let long = if u.1 - u.0 >= v.1 - v.0 { 0 } else { 1 };
    let (low, high) = if long == 0 { u } else { v };
    (0..SLABS)
        .filter_map(|i| {
            let at = |i: usize| low + (high - low) * i as f64 / SLABS as f64;
            let (from, to) = (at(i), at(i + 1));
            let inside = clip(&clip(points, long, from, false), long, to, true);
            if inside.is_empty() {
                return None;
            }
            let other = inside.iter().fold((f64::MAX, f64::MIN), |(a, b), p| (a.min(p[1 - long]), b.max(p[1 - long])));
            if other.1 - other.0 < 1e-6 {
                return None;
            }
            Some(if long == 0 { [[from, other.0], [to, other.1]] } else { [[other.0, from], [other.1, to]] })
        })
        .collect()
}

/// Returns the part of a polygon below (or above) a line across one coordinate.
fn clip(points: &[[f64; 2]], k: usize, at: f64, below: bool) -> Vec<[f64; 2]> {
    let keeps = |p: &[f64; 2]| if below { p[k] <= at } else { p[k] >= at };
    let mut out = Vec::new();
    for (i, p) in points.iter().enumerate() {
        let q = &points[(i + 1) % points.len()];
        if keeps(p) {
            out.push(*p);
        }
        if keeps(p) != keeps(q) {
            let t = (at - p[k]) / (q[k] - p[k]);
            out.push(std::array::from_fn(|j| p[j] + t * (q[j] - p[j])));
        }
    }
    out
}
