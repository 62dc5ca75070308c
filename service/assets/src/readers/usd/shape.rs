//! The shapes of a scene as triangles: meshes, and the simple ones such as boxes and cylinders.
//!
//! What it is not for: where they stand and what they wear.

use openusd::sdf::Value;
use openusd::usd::Prim;

use super::value::{integers, number_of, numbers, threes, token_of, twos, value};
use crate::readers::builder::{MAX_POINTS, MAX_TRIANGLES, fan};
use crate::readers::facts::{Bounds, Refusal};
use crate::readers::frame::Extent;

/// How many sides a round shape gets.
const SIDES: usize = 24;

/// The kinds of prims that have geometry of their own.
pub const GPRIMS: &[&str] = &[
    "Mesh",
    "Cube",
    "Sphere",
    "Cylinder",
    "Cylinder_1",
    "Cone",
    "Capsule",
    "Capsule_1",
    "Plane",
    "Points",
    "BasisCurves",
    "NurbsCurves",
    "HermiteCurves",
    "NurbsPatch",
    "TetMesh",
    "Volume",
];

/// A mesh as its attributes say.
#[derive(Debug, Default)]
pub struct MeshShape {
    /// Corners.
    pub points: Vec<[f32; 3]>,
    /// Corners of each face.
    pub counts: Vec<i64>,
    /// Indices of the corners of all faces.
    pub indices: Vec<i64>,
    /// Texture coordinates with how they belong to the corners.
    pub uvs: Option<Uvs>,
    /// Whether faces run clockwise.
    pub left_handed: bool,
}

/// Texture coordinates.
#[derive(Debug)]
pub struct Uvs {
    values: Vec<[f32; 2]>,
    indices: Option<Vec<i64>>,
    /// Whether each face has its own, and not each point.
    by_face: bool,
}

impl MeshShape {
    /// Reads a mesh.
    pub fn of(prim: &Prim) -> Self {
        Self {
            points: value(prim, "points").and_then(threes).unwrap_or_default(),
            counts: integers(value(prim, "faceVertexCounts")),
            indices: integers(value(prim, "faceVertexIndices")),
            uvs: uvs(prim),
            left_handed: token_of(prim, "orientation").as_deref() == Some("leftHanded"),
        }
    }

    /// Returns how many triangles the faces are cut into, by their counts alone.
    pub fn triangle_count(&self) -> u64 {
        self.counts.iter().map(|c| (c - 2).max(0) as u64).sum()
    }

    /// Tells whether all indices are there and fit the counts.
    pub fn is_whole(&self) -> bool {
        let sum = self.counts.iter().try_fold(0i64, |a, c| a.checked_add(*c));
        let there = |i: &i64| (0..self.points.len() as i64).contains(i);
        sum == Some(self.indices.len() as i64) && self.counts.iter().all(|c| *c >= 0) && self.indices.iter().all(there)
    }

    /// Returns the triangles of the faces for which `wanted` holds, with their corners and texture coordinates.
    ///
    /// # Errors
    ///
    /// When there are too many.
    pub fn triangles(&self, wanted: impl Fn(usize) -> bool) -> Result<Triangles, Refusal> {
        if self.points.len() > MAX_POINTS || self.indices.len() > 4 * MAX_POINTS {
            return Err(format!("has more than {MAX_POINTS} corners; simplify it first").into());
        }
        let by_face = self.uvs.as_ref().filter(|u| u.by_face);
        let mut out = Triangles::default();
        if by_face.is_none() {
            out.positions = self.points.clone();
            if let Some(uvs) = &self.uvs {
                out.uvs = (0..self.points.len()).map(|i| uvs.at(i)).collect();
            }
        }
        let mut at = 0usize;
        for (face, count) in self.counts.iter().enumerate() {
            let Ok(count) = usize::try_from(*count) else { break };
            let Some(corners) = at.checked_add(count).and_then(|end| self.indices.get(at..end)) else { break };
            let begin = at;
            at += count;
            if count < 3 || !wanted(face) {
                continue;
            }
            let index = |i: i64| u32::try_from(i).unwrap_or(u32::MAX);
            let corners: Vec<u32> = match by_face {
                None => corners.iter().map(|c| index(*c)).collect(),
                Some(uvs) => {
                    let first = out.positions.len() as u32;
                    for (offset, corner) in corners.iter().enumerate() {
                        let point = usize::try_from(*corner).ok().and_then(|c| self.points.get(c));
                        out.positions.push(point.copied().unwrap_or([f32::NAN; 3]));
                        out.uvs.push(uvs.at(begin + offset));
                    }
                    (first..first + count as u32).collect()
                }
            };
            let turned = |[a, b, c]: [u32; 3]| if self.left_handed { [a, c, b] } else { [a, b, c] };
            out.triangles.extend(fan(&corners).map(turned));
            if out.triangles.len() > MAX_TRIANGLES || out.positions.len() > 2 * MAX_POINTS {
                return Err(format!("has more than {MAX_TRIANGLES} triangles; simplify it first").into());
            }
        }
        Ok(out)
    }
}

impl Uvs {
    fn at(&self, corner: usize) -> [f32; 2] {
        let index = match &self.indices {
            Some(indices) => indices.get(corner).and_then(|i| usize::try_from(*i).ok()),
            None => Some(corner),
        };
        index.and_then(|i| self.values.get(i)).copied().unwrap_or_default()
    }
}

fn uvs(prim: &Prim) -> Option<Uvs> {
    let name = ["st", "UVMap", "st0", "st_0", "map1", "uv", "Texture_uv"].iter().map(|n| format!("primvars:{n}"));
    let (name, values) = name.into_iter().find_map(|n| Some((n.clone(), twos(value(prim, &n)?)?)))?;
    let interpolation = prim.attribute(name.as_str()).get_metadata::<Value>("interpolation").ok().flatten();
    let by_face = match interpolation.as_ref().and_then(super::value::token).as_deref() {
        Some("faceVarying") => true,
        Some("vertex" | "varying") => false,
        _ => return None,
    };
    let indices = value(prim, &format!("{name}:indices")).map(|v| integers(Some(v)));
    Some(Uvs { values, indices, by_face })
}

/// Triangles with their corners.
#[derive(Debug, Default, Clone)]
pub struct Triangles {
    /// Corners.
    pub positions: Vec<[f32; 3]>,
    /// One a corner or none.
    pub uvs: Vec<[f32; 2]>,
    /// Indices.
    pub triangles: Vec<[u32; 3]>,
}

/// Returns the box of a shape that is no mesh, as USD computes it, and its triangles, where it has a surface.
pub fn simple(prim: &Prim, kind: &str) -> (Option<Bounds>, Option<Triangles>) {
    let number = |name: &str, fallback: f64| number_of(prim, name).unwrap_or(fallback);
    let axis = match token_of(prim, "axis").as_deref() {
        Some("X") => 0,
        Some("Y") => 1,
        _ => 2,
    };
    let round = |radius: f64, half: f64, ends: [f64; 2], dome: bool| {
        let far = if dome { half + ends[0].max(ends[1]) } else { half };
        let corner: [f64; 3] = std::array::from_fn(|i| if i == axis { far } else { radius });
        (Some([corner.map(|v| -v), corner]), Some(turned_solid(half, ends, dome, axis)))
    };
    match kind {
        "Cube" => {
            let half = number("size", 2.0) / 2.0;
            (Some([[-half; 3], [half; 3]]), Some(cuboid([half; 3])))
        }
        "Sphere" => {
            let radius = number("radius", 1.0);
            (Some([[-radius; 3], [radius; 3]]), Some(turned_solid(0.0, [radius; 2], true, 2)))
        }
        "Cylinder" | "Cone" => {
            let (radius, half) = (number("radius", 1.0), number("height", 2.0) / 2.0);
            round(radius, half, [radius, if kind == "Cone" { 0.0 } else { radius }], false)
        }
        "Cylinder_1" => {
            let ends = [number("radiusBottom", 1.0), number("radiusTop", 1.0)];
            round(ends[0].max(ends[1]), number("height", 2.0) / 2.0, ends, false)
        }
        "Capsule" => {
            let radius = number("radius", 0.5);
            round(radius, number("height", 1.0) / 2.0, [radius; 2], true)
        }
        "Capsule_1" => {
            let ends = [number("radiusBottom", 0.5), number("radiusTop", 0.5)];
            let half = number("height", 1.0) / 2.0;
            // The domes go on along the slope of the side.
            let slope = if half > 0.0 { (ends[0] - ends[1]) / (2.0 * half) } else { 0.0 };
            let steep = slope.hypot(1.0);
            let radius = ends[0].max(ends[1]) * steep;
            let tips = [-half - ends[0] * (steep + slope), half + ends[1] * (steep - slope)];
            let corner = |end: usize, side: f64| -> [f64; 3] {
                std::array::from_fn(|i| if i == axis { tips[end] } else { side * radius })
            };
            (Some([corner(0, -1.0), corner(1, 1.0)]), round(radius, half, ends, true).1)
        }
        "Plane" => plane(number("width", 2.0) / 2.0, number("length", 2.0) / 2.0, axis),
        _ => (scattered(prim, kind), None),
    }
}

/// Returns the box of points and curves with their widths.
fn scattered(prim: &Prim, kind: &str) -> Option<Bounds> {
    let points = value(prim, "points").and_then(threes)?;
    let widths = numbers(value(prim, "widths"));
    let mut extent = Extent::default();
    let widest = widths.iter().copied().fold(0.0, f64::max) / 2.0;
    for (index, point) in points.iter().enumerate() {
        let half = match kind {
            "Points" if widths.len() == points.len() => widths[index] / 2.0,
            "BasisCurves" | "NurbsCurves" | "HermiteCurves" => widest,
            _ => 0.0,
        };
        for sign in [-half, half] {
            extent.add(point.map(|v| f64::from(v) + sign));
        }
    }
    extent.scaled(1.0)
}

fn plane(width: f64, length: f64, axis: usize) -> (Option<Bounds>, Option<Triangles>) {
    let half = match axis {
        0 => [0.0, length, width],
        1 => [width, 0.0, length],
        _ => [width, length, 0.0],
    };
    let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
    let corner = |x: f64, y: f64| -> [f32; 3] {
        std::array::from_fn(|i| {
            if i == a {
                (x * half[a]) as f32
            } else if i == b {
                (y * half[b]) as f32
            } else {
                0.0
            }
        })
    };
    let positions = vec![corner(-1., -1.), corner(1., -1.), corner(1., 1.), corner(-1., 1.)];
    let shape = Triangles { positions, uvs: Vec::new(), triangles: vec![[0, 1, 2], [0, 2, 3]] };
    (Some([half.map(|v| -v), half]), Some(shape))
}

/// Returns a box around the origin by half its lengths.
pub fn cuboid(half: [f64; 3]) -> Triangles {
    let positions = (0..8).map(|c| std::array::from_fn(|i| if c >> i & 1 == 0 { -half[i] } else { half[i] } as f32));
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = faces.iter().flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]).collect();
    Triangles { positions: positions.collect(), uvs: Vec::new(), triangles }
}

/// Returns a solid that is round about an axis: from `-half` with the first radius to `half` with the second, closed by
/// flat ends or by domes.
pub fn turned_solid(half: f64, ends: [f64; 2], dome: bool, axis: usize) -> Triangles {
    // The outline from the lower to the upper point of the axis: distance from the axis, and height.
    let mut outline = vec![(0.0, if dome { -half - ends[0] } else { -half })];
    let steps = SIDES / 4;
    let quarter = |i: usize| std::f64::consts::FRAC_PI_2 * i as f64 / steps as f64;
    if dome {
        outline.extend((1..=steps).map(|i| (ends[0] * quarter(i).sin(), -half - ends[0] * quarter(i).cos())));
        let skip = usize::from(half == 0.0 && ends[0] == ends[1]);
        outline.extend((skip..steps).map(|i| (ends[1] * quarter(i).cos(), half + ends[1] * quarter(i).sin())));
        outline.push((0.0, half + ends[1]));
    } else {
        outline.extend([(ends[0], -half), (ends[1], half), (0.0, half)]);
    }
    let mut shape = Triangles::default();
    let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
    for (radius, height) in &outline {
        for side in 0..SIDES {
            let (sin, cos) = (std::f64::consts::TAU * side as f64 / SIDES as f64).sin_cos();
            let mut point = [0f32; 3];
            (point[a], point[b], point[axis]) = ((radius * cos) as f32, (radius * sin) as f32, *height as f32);
            shape.positions.push(point);
        }
    }
    for ring in 0..outline.len() - 1 {
        for side in 0..SIDES {
            let next = (side + 1) % SIDES;
            let at = |ring: usize, side: usize| (ring * SIDES + side) as u32;
            // A ring of no radius is a point, where one of the two triangles is none.
            if outline[ring].0 > 0.0 {
                shape.triangles.push([at(ring, side), at(ring, next), at(ring + 1, next)]);
            }
            if outline[ring + 1].0 > 0.0 {
                shape.triangles.push([at(ring, side), at(ring + 1, next), at(ring + 1, side)]);
            }
        }
    }
    shape
}

#[cfg(test)]
mod tests {
    use super::*;

    fn volume(shape: &Triangles) -> f64 {
        let point = |i: u32| shape.positions[i as usize].map(f64::from);
        let six = shape.triangles.iter().map(|t| {
            let [a, b, c] = t.map(point);
            a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
        });
        six.sum::<f64>() / 6.0
    }

    #[test]
    fn solids_are_closed_and_face_outward() {
        assert!((volume(&cuboid([0.5, 1.0, 1.5])) - 6.0).abs() < 1e-5);
        for axis in 0..3 {
            let cylinder = volume(&turned_solid(1.0, [1.0; 2], false, axis)) / (2.0 * std::f64::consts::PI);
            assert!((0.97..1.0).contains(&cylinder), "{cylinder}");
            let sphere = volume(&turned_solid(0.0, [1.0; 2], true, axis)) / (4.0 / 3.0 * std::f64::consts::PI);
            assert!((0.95..1.0).contains(&sphere), "{sphere}");
            let cone = volume(&turned_solid(1.0, [1.0, 0.0], false, axis)) / (2.0 / 3.0 * std::f64::consts::PI);
            assert!((0.97..1.0).contains(&cone), "{cone}");
        }
    }
}
