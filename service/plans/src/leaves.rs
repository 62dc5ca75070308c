//! Doors drawn with their leaf: a quarter circle from hinge to wall, with or without the leaf itself, in one piece or in two.

use d3dgen_model::Point;

use crate::drawing::{DrawnOpening, OpeningKind, extent};
use crate::shape::distance;

/// Leaves are this wide, m.
const LEAF_M: std::ops::RangeInclusive<f64> = 0.45..=1.6;
/// Two sides are alike when they differ by this share at most.
const ALIKE: f64 = 0.2;
/// The leaf begins this close to the hinge, m.
const AT_HINGE_M: f64 = 0.15;

/// Turns outlines of leaf and swing into arcs, pairs of leaves into the line that they close, and drops leaves drawn apart.
pub(crate) fn pair(openings: &mut Vec<DrawnOpening>) {
    for o in openings.iter_mut().filter(|o| o.kind == OpeningKind::Door && o.arc.is_none() && o.points.len() > 3) {
        if let Some(arc) = swing(&o.points) {
            o.arc = Some(arc);
            o.points.clear();
        } else if let Some(line) = double(&o.points) {
            o.points = line.to_vec();
        }
    }
    // those of two leaves too, which are one door from here on
    let arcs: Vec<[Point; 3]> = openings.iter().filter_map(|o| o.arc).collect();
    meet(openings);
    let is_leaf = |o: &DrawnOpening| {
        let Some((a, b)) = o.arc.is_none().then(|| axis(&o.points)).flatten() else { return false };
        arcs.iter().any(|[hinge, from, to]| {
            let radius = hinge.distance(*from);
            let near = |p: Point, q: Point| p.distance(q) <= AT_HINGE_M;
            let leaf = |end: Point| (near(a, *hinge) && near(b, end)) || (near(b, *hinge) && near(a, end));
            (a.distance(b) - radius).abs() <= ALIKE * radius && (leaf(*from) || leaf(*to))
        })
    };
    let keep: Vec<bool> = openings.iter().map(|o| o.kind != OpeningKind::Door || !is_leaf(o)).collect();
    let mut at = 0;
    openings.retain(|_| {
        at += 1;
        keep[at - 1]
    });
}

/// Makes one door of two swings whose leaves meet.
fn meet(openings: &mut Vec<DrawnOpening>) {
    let mut at = 0;
    while at < openings.len() {
        let partner = openings[at].arc.and_then(|[hinge, a, b]| {
            let joins = |o: &DrawnOpening| {
                let Some([other, c, d]) = o.arc else { return false };
                let wide = hinge.distance(other);
                let both = hinge.distance(a) + other.distance(c);
                (wide - both).abs() <= ALIKE * both
                    && [a, b].iter().any(|p| [c, d].iter().any(|q| p.distance(*q) <= AT_HINGE_M))
            };
            openings.iter().skip(at + 1).position(joins).map(|k| (at + 1 + k, hinge))
        });
        if let Some((k, hinge)) = partner {
            let other = openings.remove(k);
            let ends = other.arc.map_or(hinge, |a| a[0]);
            openings[at].points = vec![hinge, ends];
            openings[at].arc = None;
        }
        at += 1;
    }
}

/// Returns the middle line of a thin shape.
fn axis(points: &[Point]) -> Option<(Point, Point)> {
    let [x0, y0, x1, y1] = extent(points.iter().copied())?;
    let (w, h) = (x1 - x0, y1 - y0);
    match points {
        [a, b] => Some((*a, *b)),
        _ if h < 0.15 * w => Some((Point::new(x0, (y0 + y1) / 2.0), Point::new(x1, (y0 + y1) / 2.0))),
        _ if w < 0.15 * h => Some((Point::new((x0 + x1) / 2.0, y0), Point::new((x0 + x1) / 2.0, y1))),
        _ => None,
    }
}

/// Returns hinge and ends of the arc of a shape as wide as high.
///
/// A quarter circle keeps off the corner across from its hinge by 0.41 of its radius; alone, without the leaf, it keeps off the
/// hinge by the whole radius.
fn swing(points: &[Point]) -> Option<[Point; 3]> {
    let [x0, y0, x1, y1] = extent(points.iter().copied())?;
    let (w, h) = (x1 - x0, y1 - y0);
    let radius = w.max(h);
    if !LEAF_M.contains(&radius) || (w - h).abs() > ALIKE * radius {
        return None;
    }
    let corners = [Point::new(x0, y0), Point::new(x1, y0), Point::new(x1, y1), Point::new(x0, y1)];
    let off = corners.map(|c| distance(points, c) / radius);
    let far = (0..4).max_by(|a, b| off[*a].total_cmp(&off[*b]))?;
    // a box keeps off no corner
    let hinge = match off[far] {
        d if d > 0.8 => far,
        d if d > 0.25 => (far + 2) % 4,
        _ => return None,
    };
    Some([corners[hinge], corners[(hinge + 1) % 4], corners[(hinge + 3) % 4]])
}

/// Returns the line that two leaves close: the long side of a shape twice as wide as high whose middle they meet in.
fn double(points: &[Point]) -> Option<[Point; 2]> {
    let [x0, y0, x1, y1] = extent(points.iter().copied())?;
    let (w, h) = (x1 - x0, y1 - y0);
    let leaf = w.min(h);
    if !LEAF_M.contains(&leaf) || (w.max(h) - 2.0 * leaf).abs() > 2.0 * ALIKE * leaf {
        return None;
    }
    let sides = if w > h {
        [[Point::new(x0, y0), Point::new(x1, y0)], [Point::new(x0, y1), Point::new(x1, y1)]]
    } else {
        [[Point::new(x0, y0), Point::new(x0, y1)], [Point::new(x1, y0), Point::new(x1, y1)]]
    };
    let off = sides.map(|[a, b]| distance(points, Point::new((a.x + b.x) / 2.0, (a.y + b.y) / 2.0)) / leaf);
    let near = usize::from(off[1] < off[0]);
    (off[1 - near] > 0.25).then(|| sides[near])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quarter(hinge: Point, radius: f64, from: f64) -> Vec<Point> {
        (0..=8)
            .map(|k| {
                let (sin, cos) = (from + f64::from(k) / 8.0 * std::f64::consts::FRAC_PI_2).sin_cos();
                Point::new(hinge.x + radius * cos, hinge.y + radius * sin)
            })
            .collect()
    }

    fn door(points: Vec<Point>) -> DrawnOpening {
        DrawnOpening::new(OpeningKind::Door, points, None, String::new())
    }

    #[test]
    fn a_leaf_and_its_swing_are_one_door() {
        let hinge = Point::new(2.0, 3.0);
        let arc = quarter(hinge, 0.9, 0.0);
        let one_piece = [vec![hinge], arc.clone()].concat();
        let leaf = vec![hinge, Point::new(2.0, 3.9)];
        for drawn in [vec![one_piece], vec![arc.clone(), leaf.clone()], vec![leaf, arc]] {
            let mut openings: Vec<DrawnOpening> = drawn.into_iter().map(door).collect();
            pair(&mut openings);
            assert_eq!(openings.len(), 1);
            assert!(openings[0].arc.is_some_and(|a| a[0].distance(hinge) < 0.01), "{:?}", openings[0].arc);
        }
        let mut boxed = vec![door(
            [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)].map(|p| Point::new(p.0, p.1)).to_vec(),
        )];
        pair(&mut boxed);
        assert_eq!(boxed[0].arc, None);
    }

    #[test]
    fn two_leaves_close_the_line_of_their_hinges() {
        let left =
            [vec![Point::new(0.0, 0.0)], quarter(Point::new(0.0, 0.0), 0.8, 0.0).into_iter().rev().collect()].concat();
        let right =
            quarter(Point::new(1.6, 0.0), 0.8, std::f64::consts::FRAC_PI_2).into_iter().rev().collect::<Vec<_>>();
        let mut openings = vec![door([left, right, vec![Point::new(1.6, 0.0)]].concat())];
        pair(&mut openings);
        assert_eq!(openings[0].points, [Point::new(0.0, 0.0), Point::new(1.6, 0.0)]);
    }
}
