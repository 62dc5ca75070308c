//! A builder that keeps parts inside the bounding box.

use super::{Axis, Part, Solid, Tone};

/// Parts of one model under construction.
pub(super) struct Body {
    /// Width, m.
    pub w: f64,
    /// Depth, m.
    pub d: f64,
    /// Height, m.
    pub h: f64,
    parts: Vec<Part>,
}

impl Body {
    pub fn new([w, d, h]: [f64; 3]) -> Self {
        Self { w, d, h, parts: Vec::new() }
    }

    /// Adds a box between x, y and z ranges: x from the left edge, y from the front, z from the underside, m.
    ///
    /// What would stick out of the bounding box is cut off, so that builds may use real thicknesses at any size.
    pub fn block(&mut self, x: [f64; 2], y: [f64; 2], z: [f64; 2], tone: Tone) {
        let range = |[a, b]: [f64; 2], extent: f64| [a.min(b).clamp(0.0, extent), a.max(b).clamp(0.0, extent)];
        let (x, y, z) = (range(x, self.w), range(y, self.d), range(z, self.h));
        if [x, y, z].iter().any(|[a, b]| b - a < 1e-4) {
            return;
        }
        let (left, front) = (self.w / 2.0, self.d / 2.0);
        let min = [x[0] - left, y[0] - front, z[0]];
        let max = [x[1] - left, y[1] - front, z[1]];
        self.parts.push(Part { solid: Solid::Box { min, max }, tone });
    }

    /// Adds an upright cylinder around a point, shrunk to stay inside.
    pub fn post(&mut self, x: f64, y: f64, radius: f64, z: [f64; 2], tone: Tone) {
        let radius = radius.min(x).min(y).min(self.w - x).min(self.d - y);
        let (z0, z1) = (z[0].clamp(0.0, self.h), z[1].clamp(0.0, self.h));
        if radius < 1e-3 || z1 - z0 < 1e-4 {
            return;
        }
        let center = [x - self.w / 2.0, y - self.d / 2.0, (z0 + z1) / 2.0];
        self.parts.push(Part { solid: Solid::Cylinder { center, radius, length: z1 - z0, axis: Axis::Z }, tone });
    }

    /// Adds a cylinder lying along the width (`Axis::X`) or the depth (`Axis::Y`), shrunk to stay inside.
    pub fn bar(&mut self, center: [f64; 3], radius: f64, length: f64, axis: Axis, tone: Tone) {
        let [x, y, z] = center;
        let (across, along) = if axis == Axis::X { ((y, self.d), (x, self.w)) } else { ((x, self.w), (y, self.d)) };
        let radius = radius.min(across.0).min(across.1 - across.0).min(z).min(self.h - z);
        let length = length.min(2.0 * along.0).min(2.0 * (along.1 - along.0));
        if radius < 1e-3 || length < 1e-3 {
            return;
        }
        let center = [x - self.w / 2.0, y - self.d / 2.0, z];
        self.parts.push(Part { solid: Solid::Cylinder { center, radius, length, axis }, tone });
    }

    /// Adds a ball around a point, shrunk to stay inside.
    pub fn ball(&mut self, x: f64, y: f64, z: f64, radius: f64, tone: Tone) {
        let radius = radius.min(x).min(y).min(z).min(self.w - x).min(self.d - y).min(self.h - z);
        if radius >= 1e-3 {
            let center = [x - self.w / 2.0, y - self.d / 2.0, z];
            self.parts.push(Part { solid: Solid::Sphere { center, radius }, tone });
        }
    }

    /// Adds an upright round body over the whole footprint: a cylinder where width and depth agree, else a box.
    pub fn round(&mut self, inset: f64, z: [f64; 2], tone: Tone) {
        if (self.w - self.d).abs() < 0.001 {
            self.post(self.w / 2.0, self.d / 2.0, self.w / 2.0 - inset, z, tone);
        } else {
            self.block([inset, self.w - inset], [inset, self.d - inset], z, tone);
        }
    }

    /// Adds four square legs at the corners.
    pub fn legs(&mut self, side: f64, inset: f64, z: [f64; 2], tone: Tone) {
        let side = side.min(self.w / 4.0).min(self.d / 4.0);
        for x in [inset, self.w - inset - side] {
            for y in [inset, self.d - inset - side] {
                self.block([x, x + side], [y, y + side], z, tone);
            }
        }
    }

    /// Adds four wheels under the corners; returns the height they take.
    pub fn wheels(&mut self, diameter: f64) -> f64 {
        let diameter = diameter.min(self.h / 5.0).min(self.d / 4.0).min(self.w / 4.0);
        let r = diameter / 2.0;
        for x in [r, self.w - r] {
            for y in [r, self.d - r] {
                self.bar([x, y, r], r, diameter * 0.4, Axis::X, Tone::Black);
            }
        }
        diameter
    }

    pub fn finish(self) -> Vec<Part> {
        self.parts
    }
}
