//! Which side of a model faces its user: rules on the geometry, the sure ones first.

use crate::annotation::{Front, FrontAxis};
use crate::catalog::CatalogObject;
use crate::measure::Measured;

/// Lean of the upper part from which it is a back.
const LEAN: f64 = 0.14;
/// How much flatter a back is than a front.
const FLATTER: f64 = 0.2;
/// How many times as much detail a front has.
const DETAIL: f64 = 1.35;
/// Sides of a square differ at most by this factor.
const SQUARE: f64 = 1.04;

/// Returns the front of a model.
pub fn front(m: &Measured, object: Option<&CatalogObject>, affordances: &[String]) -> Front {
    let found = |axis, found_by: &str| Front { axis, found_by: found_by.to_owned() };
    let is_for = |what: &str| affordances.iter().any(|a| a == what);
    let axes = likely_axes(m, object);
    if is_round(m) {
        return found(FrontAxis::Any, "it looks alike from all sides");
    }
    if is_for("sit") || is_for("lie") {
        let leaning = axes.iter().copied().filter(|&a| m.lean[a].abs() >= LEAN);
        if let Some(axis) = leaning.max_by(|&a, &b| m.lean[a].abs().total_cmp(&m.lean[b].abs())) {
            let what = if is_for("lie") { "the head board is at the back" } else { "the back rest is at the back" };
            return found(towards(axis, -m.lean[axis]), what);
        }
    }
    for &axis in &axes {
        let [low, high] = [m.sides[2 * axis], m.sides[2 * axis + 1]];
        let flatter = low.flat - high.flat;
        if flatter.abs() >= FLATTER {
            return found(towards(axis, flatter), "its back is flat, as of things that stand or hang at walls");
        }
    }
    for &axis in &axes {
        let [low, high] = [m.sides[2 * axis], m.sides[2 * axis + 1]].map(|s| s.triangles as f64 + 4.0);
        if low.max(high) / low.min(high) >= DETAIL {
            return found(towards(axis, high - low), "one side has more detail: handles, knobs or a screen");
        }
    }
    match axes.first() {
        Some(0) => found(FrontAxis::MinusX, "its width runs along y; which side is the front is a convention"),
        _ => found(FrontAxis::MinusY, "a convention: nothing tells its front"),
    }
}

/// Returns the axes (0 is x) along which the front may look, the likelier first, by how width and depth of such objects
/// compare.
fn likely_axes(m: &Measured, object: Option<&CatalogObject>) -> Vec<usize> {
    let [x, y, _] = m.size_m;
    let long = if x > y { 0 } else { 1 };
    let clearly = x.max(y) > 1.12 * x.min(y);
    let widths = object.and_then(|o| o.sizes_m.first()).map(|[w, d, _]| w / d);
    match widths {
        Some(ratio) if ratio > 1.15 && clearly => vec![1 - long],
        Some(ratio) if ratio < 0.87 && clearly => vec![long],
        None if x.max(y) > 1.5 * x.min(y) => vec![1 - long],
        _ => vec![1, 0],
    }
}

fn towards(axis: usize, sign: f64) -> FrontAxis {
    match (axis, sign >= 0.0) {
        (0, false) => FrontAxis::MinusX,
        (0, true) => FrontAxis::PlusX,
        (_, false) => FrontAxis::MinusY,
        (_, true) => FrontAxis::PlusY,
    }
}

/// Tells whether a model looks alike from all sides.
fn is_round(m: &Measured) -> bool {
    let [x, y, _] = m.size_m;
    let square = x.max(y) <= SQUARE * x.min(y) && x > 0.0;
    let detail = m.sides.map(|s| s.triangles as f64 + 4.0);
    let alike = detail.iter().copied().fold(0.0, f64::max) <= DETAIL * detail.iter().copied().fold(f64::MAX, f64::min);
    let flats = m.sides.map(|s| s.flat);
    let flat = flats.iter().copied().fold(0.0, f64::max) - flats.iter().copied().fold(1.0, f64::min) < FLATTER;
    square && alike && flat && m.lean.iter().all(|l| l.abs() < LEAN / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::tests::boxes;
    use crate::measure::{Map, measure};
    use crate::sample;

    #[track_caller]
    fn check(list: &[[[f32; 3]; 2]], object: &str, expected: FrontAxis) {
        let m = measure(&boxes(list), &Map::new(|p| p, [1.0; 3]));
        let object = sample::catalog().object(object);
        let affordances = object.map(|o| o.affordances.clone()).unwrap_or_default();
        let found = front(&m, object, &affordances);
        assert_eq!(found.axis, expected, "{}", found.found_by);
    }

    #[test]
    fn backs_tell_fronts() {
        let seat = [[-0.25, -0.25, 0.0], [0.25, 0.25, 0.45]];
        check(&[seat, [[-0.25, 0.2, 0.45], [0.25, 0.25, 0.9]]], "dining_chair", FrontAxis::MinusY);
        check(&[seat, [[-0.25, -0.25, 0.45], [0.25, -0.2, 0.9]]], "dining_chair", FrontAxis::PlusY);
        check(&[seat, [[0.2, -0.25, 0.45], [0.25, 0.25, 0.9]]], "dining_chair", FrontAxis::MinusX);
        let bed = [[-1.0, -0.8, 0.0], [1.0, 0.8, 0.5]];
        check(&[bed, [[0.95, -0.8, 0.5], [1.0, 0.8, 1.1]]], "double_bed", FrontAxis::MinusX);
    }

    #[test]
    fn flat_backs_and_handles_tell_fronts() {
        let body = [[-0.5, -0.3, 0.0], [0.5, 0.3, 2.0]];
        let handle = |x: f32| [[x, -0.34, 1.0], [x + 0.03, -0.3, 1.2]];
        check(&[body, handle(-0.1), handle(0.1)], "wardrobe", FrontAxis::MinusY);
        check(&[[[-0.2, -0.2, 0.0], [0.2, 0.2, 0.5]]], "stool", FrontAxis::Any);
        check(&[[[-0.2, -0.9, 0.0], [0.2, 0.9, 0.5]]], "sideboard", FrontAxis::MinusX);
    }
}
