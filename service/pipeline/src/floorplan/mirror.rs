//! How alike a layout is on both sides of an axis through the room one enters by.

use d3dgen_model::style::Symmetry;

use super::cost::distance;
use super::lattice::{Cellbox, meters};

/// Weight of what is not alike, where a symmetric plan is asked for.
const WEIGHT: f64 = 15.0;

/// Returns what a layout costs under a wish, from the largest box of each room, its area, and the box of the room one
/// enters by.
pub(super) fn cost(wish: Symmetry, rooms: &[(Cellbox, f64)], entrance: Cellbox) -> f64 {
    let (cx, cy) = entrance.center2();
    let upright = unlike(rooms, |b| Cellbox { x0: cx - b.x1, x1: cx - b.x0, ..b });
    let level = unlike(rooms, |b| Cellbox { y0: cy - b.y1, y1: cy - b.y0, ..b });
    let unlike = upright.min(level);
    match wish {
        Symmetry::Symmetric => WEIGHT * unlike,
        // unlike enough is unlike: no plan is torn apart for it
        Symmetry::Asymmetric => WEIGHT * (0.25 - unlike).max(0.0),
    }
}

/// Returns how far the mirrored rooms lie from those nearest to them in place and size, over the size of the whole.
fn unlike(rooms: &[(Cellbox, f64)], mirrored: impl Fn(Cellbox) -> Cellbox) -> f64 {
    let total: f64 = rooms.iter().map(|r| r.1).sum();
    let far = |(shape, area): &(Cellbox, f64)| {
        let image = mirrored(*shape);
        let apart = |other: &(Cellbox, f64)| {
            let sizes = (image.width() - other.0.width()).abs() + (image.height() - other.0.height()).abs();
            distance(image, other.0) + 0.5 * meters(sizes)
        };
        area * rooms.iter().map(apart).fold(f64::MAX, f64::min)
    };
    rooms.iter().map(far).sum::<f64>() / (total * total.sqrt()).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mirrored_plan_costs_nothing_and_a_lopsided_one_does() {
        let shape = |x0, x1, y0, y1| (Cellbox { x0, x1, y0, y1 }, f64::from((x1 - x0) * (y1 - y0)) * 0.0025);
        let hall = shape(0, 200, 90, 120);
        let alike =
            [hall, shape(0, 100, 0, 90), shape(100, 200, 0, 90), shape(0, 100, 120, 210), shape(100, 200, 120, 210)];
        assert_eq!(cost(Symmetry::Symmetric, &alike, hall.0), 0.0);
        assert!(cost(Symmetry::Asymmetric, &alike, hall.0) > 3.0);
        let lopsided =
            [hall, shape(0, 150, 0, 90), shape(150, 200, 0, 90), shape(0, 60, 120, 180), shape(60, 200, 120, 180)];
        assert!(cost(Symmetry::Symmetric, &lopsided, hall.0) > 0.5);
    }
}
