//! Vectors and affine maps in three dimensions, as plain arrays.

/// A point or vector.
pub(crate) type Vec3 = [f64; 3];

pub(crate) fn add(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(crate) fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn scale(a: Vec3, by: f64) -> Vec3 {
    a.map(|v| v * by)
}

pub(crate) fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn length(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

/// Returns the unit vector of this direction; x for a vector of no length.
pub(crate) fn unit(a: Vec3) -> Vec3 {
    let length = length(a);
    if length > 1e-300 { scale(a, 1.0 / length) } else { [1.0, 0.0, 0.0] }
}

/// Returns the quaternion (w, x, y, z) of the turn `b`, then `a`.
pub(crate) fn product([aw, ax, ay, az]: [f64; 4], [bw, bx, by, bz]: [f64; 4]) -> [f64; 4] {
    [
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    ]
}

/// An affine map: a matrix by columns, then a shift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Affine {
    /// Where the three axes go.
    pub axes: [Vec3; 3],
    /// Where the origin goes.
    pub origin: Vec3,
}

impl Affine {
    pub const IDENTITY: Self = Self { axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], origin: [0.0; 3] };

    /// Returns the turn by a unit quaternion (w, x, y, z), then the shift.
    pub fn placed(by: Vec3, [w, x, y, z]: [f64; 4]) -> Self {
        Self {
            axes: [
                [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)],
                [2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)],
                [2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)],
            ],
            origin: by,
        }
    }

    /// Returns a shift.
    pub fn shift(by: Vec3) -> Self {
        Self { origin: by, ..Self::IDENTITY }
    }

    /// Returns a right-handed turn about an axis (0 x, 1 y, 2 z) through a point.
    pub fn turn(axis: usize, deg: f64, at: Vec3) -> Self {
        // Quarter turns are exact, so that turned parts touch their box.
        let (sin, cos) = match deg.rem_euclid(360.0) {
            0.0 => (0.0, 1.0),
            90.0 => (1.0, 0.0),
            180.0 => (0.0, -1.0),
            270.0 => (-1.0, 0.0),
            other => other.to_radians().sin_cos(),
        };
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut map = Self::IDENTITY;
        map.axes[u][u] = cos;
        map.axes[u][v] = sin;
        map.axes[v][u] = -sin;
        map.axes[v][v] = cos;
        map.origin = sub(at, map.vector(at));
        map
    }

    /// Returns the reflection that takes `extent - v` for `v` on an axis.
    pub fn mirror(axis: usize, extent: f64) -> Self {
        let mut map = Self::IDENTITY;
        map.axes[axis][axis] = -1.0;
        map.origin[axis] = extent;
        map
    }

    /// Returns a stretch by factors, then a shift.
    pub fn stretch(factors: Vec3, shift: Vec3) -> Self {
        let axes = std::array::from_fn(|i| std::array::from_fn(|j| if i == j { factors[i] } else { 0.0 }));
        Self { axes, origin: shift }
    }

    /// Returns the map that does `first`, then this.
    pub fn after(&self, first: &Self) -> Self {
        Self { axes: first.axes.map(|a| self.vector(a)), origin: self.point(first.origin) }
    }

    pub fn vector(&self, v: Vec3) -> Vec3 {
        std::array::from_fn(|i| self.axes[0][i] * v[0] + self.axes[1][i] * v[1] + self.axes[2][i] * v[2])
    }

    pub fn point(&self, p: Vec3) -> Vec3 {
        add(self.vector(p), self.origin)
    }

    /// Returns whether the map turns left hands into right ones.
    pub fn mirrors(&self) -> bool {
        dot(cross(self.axes[0], self.axes[1]), self.axes[2]) < 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_mirrors_and_their_order() {
        let close = |a: Vec3, b: Vec3| length(sub(a, b)) < 1e-12;
        let turn = Affine::turn(2, 90.0, [1.0, 0.0, 0.0]);
        assert_eq!(turn.point([2.0, 0.0, 5.0]), [1.0, 1.0, 5.0]);
        assert!(close(Affine::turn(0, 45.0, [0.0; 3]).point([0.0, 1.0, 0.0]), [0.0, 0.5_f64.sqrt(), 0.5_f64.sqrt()]));
        let mirror = Affine::mirror(0, 3.0);
        assert_eq!(mirror.point([1.0, 2.0, 0.0]), [2.0, 2.0, 0.0]);
        assert!(mirror.mirrors() && !turn.mirrors());
        let p = [0.3, -0.7, 0.2];
        assert!(close(turn.after(&mirror).point(p), turn.point(mirror.point(p))));
        assert!(close(Affine::stretch([2.0, 1.0, 1.0], [1.0, 0.0, 0.0]).point([1.0, 1.0, 1.0]), [3.0, 1.0, 1.0]));
    }
}
