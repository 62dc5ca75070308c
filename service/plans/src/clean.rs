//! Outlines as drawn become outlines of right angles: no repeated or straight corners, no crossing, no slant.

use d3dgen_model::Point;

use crate::error::Error;
use crate::shape::edges;

/// Corners closer than this are one, and a corner this close to the line of its neighbors is none, m.
const SAME_M: f64 = 0.01;
/// An edge leans when its ends are this far apart across its direction, m, and by more than the next figure.
const LEAN_M: f64 = 0.02;
/// Least slope that counts as a slant; a drawn wall is rarely straighter.
const LEAN_SLOPE: f64 = 0.01;
/// Longest step that a slanted wall is made of, m.
const STEP_M: f64 = 0.5;
/// Most corners of one outline.
const MOST_CORNERS: usize = 2000;

/// Returns the corners counter-clockwise, without those that are not needed.
///
/// # Errors
/// `Refused` when nothing is left, or when the outline crosses itself.
pub(crate) fn ring(corners: &[Point], place: &str) -> Result<Vec<Point>, Error> {
    let out = without_doubles(corners);
    let mut kept: Vec<Point> = Vec::with_capacity(out.len());
    for (i, p) in out.iter().enumerate() {
        let before = kept.last().copied().unwrap_or(out[out.len() - 1]);
        let after = out[(i + 1) % out.len()];
        if off_line(*p, before, after) > SAME_M / 2.0 {
            kept.push(*p);
        }
    }
    let mut out = kept;
    if out.len() < 3 {
        return Err(Error::refused(place, "encloses no floor; an outline has three corners or more"));
    }
    if out.len() > MOST_CORNERS {
        return Err(Error::refused(place, format!("has {} corners, at most {MOST_CORNERS} are read", out.len())));
    }
    if let Some((i, j)) = crossing(&out) {
        let at = |k: usize| format!("({:.3}, {:.3})", out[k].x, out[k].y);
        return Err(Error::refused(
            place,
            format!("the outline crosses itself: the edge from {} meets the edge from {}, m", at(i), at(j)),
        ));
    }
    let area: f64 = edges(&out).map(|(a, b)| a.x * b.y - b.x * a.y).sum();
    if area < 0.0 {
        out.reverse();
    }
    Ok(out)
}

fn without_doubles(corners: &[Point]) -> Vec<Point> {
    let mut out: Vec<Point> = Vec::with_capacity(corners.len());
    for p in corners {
        if out.last().is_none_or(|q| q.distance(*p) > SAME_M) {
            out.push(*p);
        }
    }
    while out.len() > 1 && out[0].distance(out[out.len() - 1]) <= SAME_M {
        out.pop();
    }
    out
}

/// Returns how far a point lies from the line through two others, m; the distance to them when they are one.
fn off_line(p: Point, a: Point, b: Point) -> f64 {
    let length = a.distance(b);
    if length <= SAME_M {
        return p.distance(a);
    }
    let along = ((p.x - a.x) * (b.x - a.x) + (p.y - a.y) * (b.y - a.y)) / length;
    if !(0.0..=length).contains(&along) {
        return f64::MAX;
    }
    ((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x)).abs() / length
}

/// Returns two edges that cross or overlap, by their first corners.
fn crossing(ring: &[Point]) -> Option<(usize, usize)> {
    let n = ring.len();
    let side = |a: Point, b: Point, p: Point| (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
    let meet = |i: usize, j: usize| {
        let (a, b, c, d) = (ring[i], ring[(i + 1) % n], ring[j], ring[(j + 1) % n]);
        let apart = a.x.max(b.x) < c.x.min(d.x)
            || c.x.max(d.x) < a.x.min(b.x)
            || a.y.max(b.y) < c.y.min(d.y)
            || c.y.max(d.y) < a.y.min(b.y);
        !apart && side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
    };
    (0..n).find_map(|i| (i + 2..n).find(|&j| (j + 1) % n != i && meet(i, j)).map(|j| (i, j)))
}

/// Returns true when an edge leans.
fn leans(a: Point, b: Point) -> bool {
    let across = (a.x - b.x).abs().min((a.y - b.y).abs());
    across > LEAN_M && across > LEAN_SLOPE * a.distance(b)
}

/// Returns the points of a line made of right angles, its first end included and its last not; and how far they stray, m.
///
/// Both directions of a line give the same steps, so that the rooms on its two sides still meet.
pub(crate) fn upright_line(a: Point, b: Point, rectify: bool, place: &str) -> Result<(Vec<Point>, f64), Error> {
    if !leans(a, b) {
        return Ok((vec![a], 0.0));
    }
    if !rectify {
        let angle = (b.y - a.y).atan2(b.x - a.x).to_degrees();
        return Err(Error::refused(
            place,
            format!(
                "the edge from ({:.3}, {:.3}) to ({:.3}, {:.3}) m runs at {angle:.1} degrees; this release plans right \
                 angles only: draw it so, or let --rectify make steps of it",
                a.x, a.y, b.x, b.y
            ),
        ));
    }
    let backwards = (b.x, b.y) < (a.x, a.y);
    let (from, to) = if backwards { (b, a) } else { (a, b) };
    let (dx, dy) = (to.x - from.x, to.y - from.y);
    let steps = (dx.abs().min(dy.abs()) / STEP_M).ceil().clamp(1.0, 1000.0);
    let mut points = vec![from];
    for k in 0..steps as usize {
        let (s, m, e) = (k as f64 / steps, (k as f64 + 0.5) / steps, (k as f64 + 1.0) / steps);
        // half along x, the whole rise, the other half along x: the step stays centered on the line
        points.push(Point::new(from.x + m * dx, from.y + s * dy));
        points.push(Point::new(from.x + m * dx, from.y + e * dy));
    }
    points.push(to);
    let stray = (dx / steps / 2.0).abs() * dy.abs() / from.distance(to).max(SAME_M);
    if backwards {
        points.reverse();
    }
    points.pop();
    Ok((points, stray))
}

/// Returns an outline of right angles, and how far it strays from the drawn one, m.
///
/// # Errors
/// `Refused` naming the slanted edge, unless `rectify`.
pub(crate) fn upright_ring(ring: &[Point], rectify: bool, place: &str) -> Result<(Vec<Point>, f64), Error> {
    let (mut out, mut stray) = (Vec::with_capacity(ring.len()), 0.0_f64);
    for (a, b) in edges(ring) {
        let (points, off) = upright_line(a, b, rectify, place)?;
        out.extend(points);
        stray = stray.max(off);
    }
    Ok((out, stray))
}
