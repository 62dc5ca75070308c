//! Convex shapes that collide: those of the parts, moved with them, and merged when a body has too many.

use super::solids::Hull;
use crate::affine::{Affine, Vec3, cross, length, unit};
use crate::coarse;
use crate::model3d::Collision;

/// Most convex shapes of one body.
pub(super) const MOST: usize = 24;
/// A direction closer than this to an axis is that axis.
const STRAIGHT: f64 = 0.9999;

/// Returns the shape of a hull after a move that may stretch along the axes by a few per mille.
pub(super) fn moved(hull: &Hull, map: &Affine) -> Collision {
    let lengths = map.axes.map(length);
    let axes = map.axes.map(unit);
    match *hull {
        Hull::Box { center, half } => {
            Collision::around(map.point(center), std::array::from_fn(|i| half[i] * lengths[i]), axes)
        }
        Hull::Sphere { center, radius } => Collision::Sphere { center: map.point(center), radius: radius * lengths[0] },
        Hull::Cylinder { center, radius, half, axis } => {
            let middle = map.point(center);
            match (0..3).find(|k| axes[axis][*k].abs() > STRAIGHT) {
                Some(k) => {
                    let across = lengths[(axis + 1) % 3].min(lengths[(axis + 2) % 3]);
                    let length = 2.0 * half * lengths[axis];
                    Collision::Cylinder { center: middle, radius: radius * across, length, axis: k }
                }
                None => {
                    let half = std::array::from_fn(|i| if i == axis { half } else { radius } * lengths[i]);
                    Collision::around(middle, half, axes)
                }
            }
        }
        Hull::Bar { center, direction, half, radius } => {
            let along = map.vector(direction);
            let frame = frame_along(unit(along));
            Collision::around(
                map.point(center),
                [half * length(along), radius * lengths[0], radius * lengths[0]],
                frame,
            )
        }
    }
}

/// Returns a right-handed frame whose first axis is this direction.
fn frame_along(direction: Vec3) -> [Vec3; 3] {
    let least = (0..3).min_by(|a, b| direction[*a].abs().total_cmp(&direction[*b].abs())).unwrap_or(0);
    let mut side = [0.0; 3];
    side[least] = 1.0;
    let second = unit(cross(direction, side));
    [direction, second, cross(direction, second)]
}

/// Merges the shapes of a body until there are few enough.
pub(super) fn merged(shapes: Vec<Collision>) -> Vec<Collision> {
    coarse::merged(shapes, |count, _| count > MOST)
}
