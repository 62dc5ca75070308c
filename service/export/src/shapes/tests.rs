use super::*;
use crate::sample::ALL_SHAPES;

/// Sizes from small to large, flat and tall: builds must hold at any of them.
const SIZES: [[f64; 3]; 6] =
    [[0.6, 0.6, 0.9], [2.0, 0.9, 0.8], [0.3, 0.2, 0.1], [0.5, 0.05, 1.2], [1.4, 2.1, 2.4], [5.0, 1.1, 6.0]];

#[test]
fn parts_fill_the_bounding_box_exactly() {
    for shape in ALL_SHAPES {
        for size in SIZES {
            let parts = parts(shape, size);
            assert!(!parts.is_empty(), "{shape:?} has no part at {size:?}");
            let expected = [[-size[0] / 2.0, -size[1] / 2.0, 0.0], [size[0] / 2.0, size[1] / 2.0, size[2]]];
            let bounds = |end: usize, axis: usize| parts.iter().map(move |p| p.solid.bounds()[end][axis]);
            for (axis, (low, high)) in std::iter::zip(expected[0], expected[1]).enumerate() {
                let (least, most) =
                    (bounds(0, axis).fold(f64::MAX, f64::min), bounds(1, axis).fold(f64::MIN, f64::max));
                assert!((least - low).abs() < 1e-6, "{shape:?} {size:?} axis {axis}: {least}");
                assert!((most - high).abs() < 1e-6, "{shape:?} {size:?} axis {axis}: {most}");
            }
            assert!(parts.iter().all(|p| p.solid.size().iter().all(|v| *v > 0.0)), "{shape:?} has a flat part");
        }
    }
}

#[test]
fn builds_are_recognizable() {
    let count = |shape, size| parts(shape, size).len();
    assert!(count(Shape::Chair, [0.5, 0.5, 0.9]) >= 6, "four legs, seat and back");
    assert!(count(Shape::Bed, [0.9, 2.0, 0.9]) >= 5, "frame, mattress, blanket, pillow, headboard");
    let pillows = |w| count(Shape::Bed, [w, 2.0, 0.9]);
    assert_eq!(pillows(1.6), pillows(0.9) + 1, "a double bed has two pillows");
    let back = parts(Shape::Chair, [0.5, 0.5, 0.9])
        .iter()
        .map(|p| p.solid.bounds())
        .filter(|b| b[1][2] > 0.85)
        .all(|b| b[0][1] > 0.2);
    assert!(back, "the back of a chair is at +y, its front at -y");
}

#[test]
fn masses_are_sensible() {
    for (shape, size, material, range) in [
        (Shape::Chair, [0.45, 0.5, 0.9], "wood", 0.5..10.0),
        (Shape::Cabinet, [1.0, 0.6, 2.0], "wood", 40.0..200.0),
        (Shape::Toilet, [0.4, 0.7, 0.8], "ceramic", 10.0..60.0),
        (Shape::HospitalBed, [1.0, 2.1, 1.0], "metal", 50.0..250.0),
    ] {
        let mass = mass_kg(&parts(shape, size), material);
        assert!(range.contains(&mass), "{shape:?} weighs {mass} kg");
    }
}
