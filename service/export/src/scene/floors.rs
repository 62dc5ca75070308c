//! Slabs of floors and ceilings, in convex pieces.

use d3dgen_model::geometry::{Point, Polygon};

use super::{SimBox, SimShape, convex};

/// Returns an outline between two heights as convex solids.
pub(super) fn slab(outline: &Polygon, z_m: [f64; 2]) -> Vec<SimShape> {
    convex::pieces(outline).into_iter().map(|piece| solid(piece, z_m)).collect()
}

/// Returns a convex outline between two heights: a box where it is a rectangle at any angle.
pub(super) fn solid(outline: Vec<Point>, z_m: [f64; 2]) -> SimShape {
    let [a, b, c, d] = outline[..] else { return SimShape::Prism { outline, z_m } };
    let (wide, deep) = ([b.x - a.x, b.y - a.y], [d.x - a.x, d.y - a.y]);
    let parts = (b.x + d.x - a.x - c.x).hypot(b.y + d.y - a.y - c.y);
    let square = wide[0] * deep[0] + wide[1] * deep[1];
    if parts > 1e-6 || square.abs() > 1e-6 {
        return SimShape::Prism { outline, z_m };
    }
    SimShape::Box(SimBox {
        center_m: [(a.x + c.x) / 2.0, (a.y + c.y) / 2.0, (z_m[0] + z_m[1]) / 2.0],
        half_m: [wide[0].hypot(wide[1]) / 2.0, deep[0].hypot(deep[1]) / 2.0, (z_m[1] - z_m[0]) / 2.0],
        yaw_rad: wide[1].atan2(wide[0]),
    })
}
