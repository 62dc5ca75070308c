//! The solids of the language: closed surfaces with the convex shapes that collide for them.

mod boxes;
mod foliage;
mod prism;
mod round;
mod tube;

pub(super) use boxes::{cushion, shell, upright_box};
pub(super) use foliage::leaves;
pub(super) use prism::prism;
pub use prism::triangulate;
pub(super) use round::{cone, lathe, sphere, torus};
pub(super) use tube::tube;

use crate::affine::Vec3;
use crate::surface::Surface;

/// How finely round things are cut: 1 is the usual, less is coarser.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Detail(pub f64);

impl Detail {
    /// Returns into how many pieces a full circle of this radius is cut; a multiple of 4.
    pub fn circle(self, radius: f64) -> usize {
        let wish = (7.0 + 70.0 * radius).clamp(8.0, 32.0) * self.0;
        ((wish / 4.0).round() as usize).max(if self.0 < 0.5 { 1 } else { 2 }) * 4
    }
}

/// A convex shape that collides, before the part is moved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Hull {
    /// A box with half extents.
    Box { center: Vec3, half: Vec3 },
    /// A round bar along an axis.
    Cylinder { center: Vec3, radius: f64, half: f64, axis: usize },
    /// A ball.
    Sphere { center: Vec3, radius: f64 },
    /// A box along a direction that is no axis: half length along it, half extent across.
    Bar { center: Vec3, direction: Vec3, half: f64, radius: f64 },
}

/// A solid: what is seen and what collides.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Made {
    pub surface: Surface,
    pub hulls: Vec<Hull>,
}

/// The box of a part: least and largest corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Frame {
    pub min: Vec3,
    pub max: Vec3,
}

impl Frame {
    pub fn size(&self) -> Vec3 {
        std::array::from_fn(|i| self.max[i] - self.min[i])
    }

    pub fn center(&self) -> Vec3 {
        std::array::from_fn(|i| (self.max[i] + self.min[i]) / 2.0)
    }

    pub fn hull(&self) -> Hull {
        Hull::Box { center: self.center(), half: self.size().map(|v| v / 2.0) }
    }
}

/// Puts local coordinates with the axis along z into the frame of the part; keeps right hands right.
pub(super) fn along(axis: usize, [u, v, w]: Vec3) -> Vec3 {
    match axis {
        0 => [w, u, v],
        1 => [v, w, u],
        _ => [u, v, w],
    }
}

#[cfg(test)]
mod tests;
