//! Frames: matrices of 4 by 4 that turn points of one frame into those of another, and boxes.

use super::facts::Bounds;

/// A matrix by rows; points are columns: `world = matrix * point`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Matrix(pub [[f64; 4]; 4]);

impl Matrix {
    /// Changes nothing.
    pub const IDENTITY: Self = Self([[1., 0., 0., 0.], [0., 1., 0., 0.], [0., 0., 1., 0.], [0., 0., 0., 1.]]);

    /// Returns the matrix of 16 numbers by columns, as glTF writes it, or by rows for row vectors, as USD does.
    pub fn from_columns(v: [f64; 16]) -> Self {
        Self(std::array::from_fn(|r| std::array::from_fn(|c| v[c * 4 + r])))
    }

    /// Returns the matrix of 16 numbers by rows, as COLLADA writes it.
    pub fn from_rows(v: [f64; 16]) -> Self {
        Self(std::array::from_fn(|r| std::array::from_fn(|c| v[r * 4 + c])))
    }

    /// Moves.
    pub fn translation(t: [f64; 3]) -> Self {
        let mut m = Self::IDENTITY;
        (0..3).for_each(|i| m.0[i][3] = t[i]);
        m
    }

    /// Stretches along the axes.
    pub fn scale(s: [f64; 3]) -> Self {
        let mut m = Self::IDENTITY;
        (0..3).for_each(|i| m.0[i][i] = s[i]);
        m
    }

    /// Turns by a quaternion x, y, z, w as it stands.
    pub fn rotation([x, y, z, w]: [f64; 4]) -> Self {
        Self([
            [1. - 2. * (y * y + z * z), 2. * (x * y - z * w), 2. * (x * z + y * w), 0.],
            [2. * (x * y + z * w), 1. - 2. * (x * x + z * z), 2. * (y * z - x * w), 0.],
            [2. * (x * z - y * w), 2. * (y * z + x * w), 1. - 2. * (x * x + y * y), 0.],
            [0., 0., 0., 1.],
        ])
    }

    /// Turns about an axis, which need not be of unit length, by an angle in rad.
    pub fn axis_angle(axis: [f64; 3], angle: f64) -> Self {
        let length = axis.iter().map(|v| v * v).sum::<f64>().sqrt();
        if length <= 0.0 || !length.is_finite() {
            return Self::IDENTITY;
        }
        let (s, c) = (angle / 2.0).sin_cos();
        let [x, y, z] = axis.map(|v| v / length * s);
        Self::rotation([x, y, z, c])
    }

    /// Turns by roll about x, then pitch about y, then yaw about z, in rad, as SDF poses do.
    pub fn roll_pitch_yaw([roll, pitch, yaw]: [f64; 3]) -> Self {
        Self::axis_angle([0., 0., 1.], yaw)
            * Self::axis_angle([0., 1., 0.], pitch)
            * Self::axis_angle([1., 0., 0.], roll)
    }

    /// Turns the axes of a file with this axis up to z up: as is common, y up by a quarter about x, x up about y.
    pub fn zup_from(up: Option<&str>) -> Self {
        match up {
            Some("Y") => Self([[1., 0., 0., 0.], [0., 0., -1., 0.], [0., 1., 0., 0.], [0., 0., 0., 1.]]),
            Some("X") => Self([[0., 0., -1., 0.], [0., 1., 0., 0.], [1., 0., 0., 0.], [0., 0., 0., 1.]]),
            _ => Self::IDENTITY,
        }
    }

    /// Returns where it puts a point.
    pub fn point(&self, p: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|r| {
            let row = self.0[r];
            row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3]
        })
    }

    /// Returns the determinant of its upper left 3 by 3: below zero when it mirrors.
    pub fn determinant(&self) -> f64 {
        let m = &self.0;
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
            + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    }

    /// Returns what undoes it, for matrices whose last row is 0, 0, 0, 1; none when it flattens.
    pub fn inverse(&self) -> Option<Self> {
        let m = &self.0;
        let det = self.determinant();
        if det == 0.0 || !det.is_finite() {
            return None;
        }
        let minor = |r: usize, c: usize| {
            let (a, b) = ((r + 1) % 3, (r + 2) % 3);
            let (d, e) = ((c + 1) % 3, (c + 2) % 3);
            m[a][d] * m[b][e] - m[a][e] * m[b][d]
        };
        let mut out = Self::IDENTITY;
        for r in 0..3 {
            for c in 0..3 {
                out.0[r][c] = minor(c, r) / det;
            }
        }
        let moved = out.point([m[0][3], m[1][3], m[2][3]]);
        (0..3).for_each(|i| out.0[i][3] = -moved[i]);
        Some(out)
    }
}

impl std::ops::Mul for Matrix {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self(std::array::from_fn(|r| std::array::from_fn(|c| (0..4).map(|k| self.0[r][k] * other.0[k][c]).sum())))
    }
}

/// A box that grows; points with a coordinate that is no number are counted and left out.
#[derive(Debug, Clone, Copy, Default)]
pub struct Extent {
    bounds: Option<Bounds>,
    /// Points left out.
    pub not_finite: u64,
}

impl Extent {
    /// Takes a point in.
    pub fn add(&mut self, p: [f64; 3]) {
        if !p.iter().all(|v| v.is_finite()) {
            self.not_finite += 1;
            return;
        }
        self.bounds = Some(match self.bounds {
            None => [p, p],
            Some([min, max]) => [std::array::from_fn(|i| min[i].min(p[i])), std::array::from_fn(|i| max[i].max(p[i]))],
        });
    }

    /// Takes the corners of a box in, put in place by a matrix.
    pub fn add_box(&mut self, [min, max]: Bounds, place: &Matrix) {
        for corner in 0..8 {
            self.add(place.point(std::array::from_fn(|i| if corner >> i & 1 == 0 { min[i] } else { max[i] })));
        }
    }

    /// Returns the box, its lengths multiplied.
    pub fn scaled(&self, factor: f64) -> Option<Bounds> {
        self.bounds.map(|b| b.map(|p| p.map(|v| v * factor))).filter(|b| b.iter().flatten().all(|v| v.is_finite()))
    }
}

/// Returns a box turned by a matrix that only exchanges axes.
pub fn turned(bounds: Bounds, matrix: &Matrix) -> Bounds {
    let mut extent = Extent::default();
    extent.add_box(bounds, matrix);
    extent.scaled(1.0).unwrap_or(bounds)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matrices_compose_invert_and_turn_axes_up() {
        let m =
            Matrix::translation([1., 2., 3.]) * Matrix::axis_angle([0., 0., 2.], 0.3) * Matrix::scale([2., 3., -4.]);
        assert!(m.determinant() < 0.0);
        let back = m.inverse().unwrap().point(m.point([0.4, -5., 6.]));
        [0.4, -5., 6.].iter().zip(back).for_each(|(a, b)| assert!((a - b).abs() < 1e-12));
        assert_eq!(Matrix::scale([1., 0., 1.]).inverse(), None);
        assert_eq!(Matrix::zup_from(Some("Y")).point([1., 2., 3.]), [1., -3., 2.]);
        assert_eq!(Matrix::zup_from(Some("X")).point([1., 2., 3.]), [-3., 2., 1.]);
        let turn = Matrix::roll_pitch_yaw([0.0, 0.0, std::f64::consts::FRAC_PI_2]).point([1., 0., 0.]);
        assert!((turn[1] - 1.0).abs() < 1e-12);
    }

    #[test]
    fn boxes_leave_out_what_is_no_number() {
        let mut extent = Extent::default();
        extent.add([f64::NAN, 0., 0.]);
        assert_eq!((extent.scaled(1.0), extent.not_finite), (None, 1));
        extent.add_box([[0.; 3], [1., 2., 3.]], &Matrix::translation([1., 0., 0.]));
        assert_eq!(extent.scaled(2.0), Some([[2., 0., 0.], [4., 4., 6.]]));
    }
}
