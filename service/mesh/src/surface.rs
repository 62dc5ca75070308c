//! Closed surfaces while they are made: double precision, one normal a corner.

use crate::affine::{Affine, Vec3, add, cross, dot, length, scale, sub, unit};

/// Triangles of a closed surface.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Surface {
    pub positions: Vec<Vec3>,
    pub normals: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
}

impl Surface {
    /// Adds a corner and returns its index.
    pub fn corner(&mut self, position: Vec3, normal: Vec3) -> u32 {
        self.positions.push(position);
        self.normals.push(normal);
        self.positions.len() as u32 - 1
    }

    /// Adds a triangle, unless two of its corners are one point.
    pub fn triangle(&mut self, a: u32, b: u32, c: u32) {
        let [p, q, r] = [a, b, c].map(|i| self.positions[i as usize]);
        if p != q && q != r && r != p {
            self.triangles.push([a, b, c]);
        }
    }

    /// Adds a flat convex face with these corners in order.
    pub fn face(&mut self, corners: &[Vec3]) {
        let middle = corners[0];
        let normal = (1..corners.len() - 1)
            .fold([0.0; 3], |sum, i| add(sum, cross(sub(corners[i], middle), sub(corners[i + 1], middle))));
        if length(normal) < 1e-18 {
            return self.sliver(corners);
        }
        let normal = unit(normal);
        let ids: Vec<u32> = corners.iter().map(|p| self.corner(*p, normal)).collect();
        for i in 1..ids.len() - 1 {
            self.triangle(ids[0], ids[i], ids[i + 1]);
        }
    }

    /// Adds a face without area that others need to close.
    fn sliver(&mut self, corners: &[Vec3]) {
        let ids: Vec<u32> = corners.iter().map(|p| self.corner(*p, [0.0, 0.0, 1.0])).collect();
        for i in 1..ids.len() - 1 {
            self.triangle(ids[0], ids[i], ids[i + 1]);
        }
    }

    /// Joins two rows of corners of the same length by triangles; `around` joins their ends too.
    pub fn strip(&mut self, low: &[u32], high: &[u32], around: bool) {
        let count = low.len();
        let steps = if around { count } else { count - 1 };
        for i in 0..steps {
            let j = (i + 1) % count;
            self.triangle(low[i], low[j], high[j]);
            self.triangle(low[i], high[j], high[i]);
        }
    }

    /// Turns triangles and normals outward.
    pub fn outward(mut self) -> Self {
        if self.volume() < 0.0 {
            self.flip();
        }
        let agree: f64 = self
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|i| self.positions[i as usize]);
                let face = cross(sub(b, a), sub(c, a));
                t.iter().map(|i| dot(face, self.normals[*i as usize])).sum::<f64>()
            })
            .sum();
        if agree < 0.0 {
            self.normals.iter_mut().for_each(|n| *n = scale(*n, -1.0));
        }
        self
    }

    fn flip(&mut self) {
        self.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }

    /// Moves the surface; the map may turn, shift and mirror, and stretch along the axes.
    pub fn moved(mut self, map: &Affine) -> Self {
        self.positions.iter_mut().for_each(|p| *p = map.point(*p));
        self.normals.iter_mut().for_each(|n| *n = unit(map.vector(*n)));
        if map.mirrors() {
            self.flip();
        }
        self
    }

    /// Appends another surface.
    pub fn append(&mut self, other: &Self) {
        let first = self.positions.len() as u32;
        self.positions.extend(&other.positions);
        self.normals.extend(&other.normals);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|i| i + first)));
    }

    /// Returns the enclosed volume, m^3; negative when it is inside out.
    pub fn volume(&self) -> f64 {
        let six: f64 = self
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|i| self.positions[i as usize]);
                dot(a, cross(b, c))
            })
            .sum();
        six / 6.0
    }

    /// Returns the area, m^2.
    pub fn area(&self) -> f64 {
        let twice: f64 = self
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|i| self.positions[i as usize]);
                length(cross(sub(b, a), sub(c, a)))
            })
            .sum();
        twice / 2.0
    }

    /// Returns least and largest corners of the triangles.
    pub fn bounds(&self) -> [Vec3; 2] {
        let used = self.triangles.iter().flatten().map(|i| self.positions[*i as usize]);
        used.fold([[f64::MAX; 3], [f64::MIN; 3]], |[min, max], p| {
            [std::array::from_fn(|i| min[i].min(p[i])), std::array::from_fn(|i| max[i].max(p[i]))]
        })
    }

    /// Stretches the surface to this box, which keeps it closed.
    pub fn fitted(self, min: Vec3, max: Vec3) -> Self {
        let [low, high] = self.bounds();
        let factors =
            std::array::from_fn(
                |i| {
                    if high[i] - low[i] > 1e-12 { (max[i] - min[i]) / (high[i] - low[i]) } else { 1.0 }
                },
            );
        let shift = std::array::from_fn(|i| min[i] - low[i] * factors[i]);
        self.moved(&Affine::stretch(factors, shift))
    }
}
