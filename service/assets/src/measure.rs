//! What can be measured on the geometry of a model once it is known how it is to be taken.

use std::collections::BTreeMap;

use d3dgen_mesh::Model3d;

/// Parts of the height above which a back rest, a head board or a cistern stands.
const UPPER: f64 = 0.62;
/// Depth of what counts as the face of a side, of the extent.
const FACE: f64 = 0.12;
/// Corners of the outline at most.
const OUTLINE_MOST: usize = 16;

/// Measures of a model in its own frame: z up, meters, origin mid footprint on the underside.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Measured {
    /// Extents, m.
    pub size_m: [f64; 3],
    /// Triangles with an area.
    pub triangle_count: u64,
    /// Surface, m^2.
    pub area_m2: f64,
    /// Center of the surface, m.
    pub center_m: [f64; 3],
    /// Second moments of the surface about its center, `[xx, yy, zz, xy, xz, yz]`, m^2.
    pub moments_m2: [f64; 6],
    /// Surface by material, m^2.
    pub material_area_m2: BTreeMap<Option<usize>, f64>,
    /// How far the surface of the upper part leans from that of the lower one along x and y, of half the extent.
    pub lean: [f64; 2],
    /// The sides towards -x, +x, -y, +y.
    pub sides: [Side; 4],
    /// Convex outline on the floor, counter-clockwise, m.
    pub outline_m: Vec<[f64; 2]>,
    /// Volume that the surface encloses where it is closed, m^3.
    pub volume_m3: f64,
}

/// What one side of a model looks like.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Side {
    /// Triangles close to this side: handles, knobs, screens and drawers have many.
    pub triangles: u64,
    /// Share of the side's rectangle that is one flat face at its very end.
    pub flat: f64,
}

/// A map from the file's frame to the model's: turn, scale, shift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Map {
    /// Rows of a 3 x 4 matrix.
    pub rows: [[f64; 4]; 3],
}

impl Map {
    /// Returns the map that turns and scales, with no shift yet.
    pub fn new(turn: impl Fn([f64; 3]) -> [f64; 3], scale: [f64; 3]) -> Self {
        let columns = [turn([1.0, 0.0, 0.0]), turn([0.0, 1.0, 0.0]), turn([0.0, 0.0, 1.0])];
        let rows = std::array::from_fn(|r| {
            let cell = |c: usize| columns[c][r] * scale[r] + 0.0;
            [cell(0), cell(1), cell(2), 0.0]
        });
        Self { rows }
    }

    /// Returns where it puts a point.
    pub fn apply(&self, p: [f64; 3]) -> [f64; 3] {
        self.rows.map(|[a, b, c, d]| a * p[0] + b * p[1] + c * p[2] + d)
    }
}

/// Returns the box of a model under a map; none without a triangle.
pub fn bounds(model: &Model3d, map: &Map) -> Option<[[f64; 3]; 2]> {
    let mut found: Option<[[f64; 3]; 2]> = None;
    each_triangle(model, map, |corners, _| {
        for p in corners {
            let [min, max] = found.get_or_insert([p, p]);
            for i in 0..3 {
                min[i] = min[i].min(p[i]);
                max[i] = max[i].max(p[i]);
            }
        }
    });
    found
}

/// Measures a model. The map must put its box on the origin.
pub fn measure(model: &Model3d, map: &Map) -> Measured {
    let Some([min, max]) = bounds(model, map) else { return Measured::default() };
    let size: [f64; 3] = std::array::from_fn(|i| max[i] - min[i]);
    let mut m = Measured { size_m: size, ..Measured::default() };
    let (mut sum, mut products) = ([0.0; 3], [0.0; 6]);
    let (mut upper, mut lower) = ([0.0; 3], [0.0; 3]);
    let mut points: Vec<[f64; 2]> = Vec::new();
    each_triangle(model, map, |corners, material| {
        points.extend(corners.map(|p| [p[0], p[1]]));
        if points.len() > 1 << 16 {
            points = outline(std::mem::take(&mut points));
        }
        let (area, normal) = area_and_normal(corners);
        if area <= 0.0 {
            return;
        }
        m.triangle_count += 1;
        m.area_m2 += area;
        *m.material_area_m2.entry(material).or_default() += area;
        let c: [f64; 3] = std::array::from_fn(|i| (corners[0][i] + corners[1][i] + corners[2][i]) / 3.0);
        for i in 0..3 {
            sum[i] += area * c[i];
        }
        for (k, (i, j)) in PAIRS.into_iter().enumerate() {
            products[k] += area * mean_product(corners, i, j);
        }
        m.volume_m3 += corners[0][0] * (corners[1][1] * corners[2][2] - corners[1][2] * corners[2][1]) / 6.0
            + corners[0][1] * (corners[1][2] * corners[2][0] - corners[1][0] * corners[2][2]) / 6.0
            + corners[0][2] * (corners[1][0] * corners[2][1] - corners[1][1] * corners[2][0]) / 6.0;
        let cut = min[2] + UPPER * size[2];
        add_part(&mut upper, corners, |p| p[2] - cut);
        add_part(&mut lower, corners, |p| cut - p[2]);
        side(&mut m.sides, c, normal, area, [min, max]);
    });
    finish(&mut m, sum, products, upper, lower);
    m.outline_m = outline(points);
    m
}

const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

fn finish(m: &mut Measured, sum: [f64; 3], products: [f64; 6], upper: [f64; 3], lower: [f64; 3]) {
    let area = m.area_m2;
    if area <= 0.0 {
        return;
    }
    m.center_m = sum.map(|s| s / area);
    m.moments_m2 = std::array::from_fn(|k| {
        let (i, j) = PAIRS[k];
        products[k] / area - m.center_m[i] * m.center_m[j]
    });
    if upper[2] > 0.02 * area && lower[2] > 0.0 {
        m.lean = std::array::from_fn(|i| {
            let half = m.size_m[i] / 2.0;
            if half > 0.0 { (upper[i] / upper[2] - lower[i] / lower[2]) / half } else { 0.0 }
        });
    }
    m.volume_m3 = m.volume_m3.abs();
    for (k, side) in m.sides.iter_mut().enumerate() {
        let rectangle = m.size_m[1 - k / 2] * m.size_m[2];
        side.flat = if rectangle > 0.0 { (side.flat / rectangle).min(1.0) } else { 0.0 };
    }
}

/// Counts a triangle with the sides it is at; flat areas are summed up in m^2 first.
fn side(sides: &mut [Side; 4], c: [f64; 3], normal: [f64; 3], area: f64, [min, max]: [[f64; 3]; 2]) {
    for axis in 0..2 {
        let extent = max[axis] - min[axis];
        if extent <= 0.0 {
            continue;
        }
        let at = (c[axis] - min[axis]) / extent;
        for (k, depth) in [(2 * axis, at), (2 * axis + 1, 1.0 - at)] {
            if depth < FACE {
                sides[k].triangles += 1;
                sides[k].flat += if depth < 0.04 && normal[axis].abs() > 0.97 { area } else { 0.0 };
            }
        }
    }
}

fn each_triangle(model: &Model3d, map: &Map, mut visit: impl FnMut([[f64; 3]; 3], Option<usize>)) {
    for visual in model.bodies.iter().flat_map(|b| &b.visuals) {
        let corner = |i: u32| {
            let p = visual.mesh.positions.get(i as usize)?.map(f64::from);
            p.iter().all(|v| v.is_finite()).then(|| map.apply(p))
        };
        for [a, b, c] in &visual.mesh.triangles {
            if let (Some(a), Some(b), Some(c)) = (corner(*a), corner(*b), corner(*c)) {
                visit([a, b, c], visual.material);
            }
        }
    }
}

/// Adds area and moments of the part of a triangle on which `above` is positive.
fn add_part(sum: &mut [f64; 3], corners: [[f64; 3]; 3], above: impl Fn([f64; 3]) -> f64) {
    let mut part: Vec<[f64; 3]> = Vec::with_capacity(4);
    for i in 0..3 {
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        let (ha, hb) = (above(a), above(b));
        if ha >= 0.0 {
            part.push(a);
        }
        if (ha > 0.0 && hb < 0.0) || (ha < 0.0 && hb > 0.0) {
            let t = ha / (ha - hb);
            part.push(std::array::from_fn(|k| a[k] + t * (b[k] - a[k])));
        }
    }
    for pair in part.get(1..).unwrap_or_default().windows(2) {
        let piece = [part[0], pair[0], pair[1]];
        let (area, _) = area_and_normal(piece);
        sum[0] += area * (piece[0][0] + piece[1][0] + piece[2][0]) / 3.0;
        sum[1] += area * (piece[0][1] + piece[1][1] + piece[2][1]) / 3.0;
        sum[2] += area;
    }
}

fn area_and_normal([a, b, c]: [[f64; 3]; 3]) -> (f64, [f64; 3]) {
    let (u, v): ([f64; 3], [f64; 3]) = (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| c[i] - a[i]));
    let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = n.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 { (length / 2.0, n.map(|x| x / length)) } else { (0.0, [0.0; 3]) }
}

/// Returns the mean of the product of two coordinates over a triangle.
fn mean_product(corners: [[f64; 3]; 3], i: usize, j: usize) -> f64 {
    let [a, b, c] = corners;
    let (si, sj) = (a[i] + b[i] + c[i], a[j] + b[j] + c[j]);
    (si * sj + a[i] * a[j] + b[i] * b[j] + c[i] * c[j]) / 12.0
}

/// Returns the convex outline of points, counter-clockwise, thinned out to a few corners.
fn outline(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let half = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut hull: Vec<[f64; 2]> = Vec::new();
        for p in points {
            while let [.., a, b] = hull[..]
                && (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) <= 1e-12
            {
                hull.pop();
            }
            hull.push(p);
        }
        hull.pop();
        hull
    };
    let mut hull = half(&mut points.iter().copied());
    hull.extend(half(&mut points.iter().rev().copied()));
    thin(hull)
}

/// Takes out the corners that matter least until few are left.
fn thin(mut hull: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    while hull.len() > OUTLINE_MOST {
        let n = hull.len();
        let area = |i: usize| {
            let (a, b, c) = (hull[(i + n - 1) % n], hull[i], hull[(i + 1) % n]);
            ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs()
        };
        let least = (0..n).min_by(|&i, &j| area(i).total_cmp(&area(j))).unwrap_or(0);
        hull.remove(least);
    }
    hull
}

#[cfg(test)]
pub(crate) mod tests {
    use d3dgen_mesh::{Body, Mesh, Visual};

    use super::*;

    /// Returns a model of upright boxes, each from a least to a largest corner.
    pub fn boxes(list: &[[[f32; 3]; 2]]) -> Model3d {
        let visual = |[min, max]: &[[f32; 3]; 2]| {
            let positions: Vec<[f32; 3]> =
                (0..8).map(|k| std::array::from_fn(|i| if k >> i & 1 == 0 { min[i] } else { max[i] })).collect();
            let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
            let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
            Visual { name: "part".into(), mesh: Mesh { positions, triangles, ..Mesh::default() }, material: Some(0) }
        };
        let visuals = list.iter().map(visual).collect();
        Model3d { name: "model".into(), bodies: vec![Body { visuals, ..Body::default() }], ..Model3d::default() }
    }

    #[test]
    fn a_box_measures_as_it_should() {
        let map = Map::new(|p| p, [1.0; 3]);
        let m = measure(&boxes(&[[[-0.5, -0.25, 0.0], [0.5, 0.25, 2.0]]]), &map);
        assert_eq!((m.size_m, m.triangle_count), ([1.0, 0.5, 2.0], 12));
        assert!((m.area_m2 - 7.0).abs() < 1e-9 && (m.volume_m3 - 1.0).abs() < 1e-9, "{m:?}");
        assert!(m.center_m[0].abs() < 1e-9 && (m.center_m[2] - 1.0).abs() < 1e-9);
        assert!(m.sides.iter().all(|s| (s.flat - 1.0).abs() < 1e-6), "{:?}", m.sides);
        assert_eq!(m.outline_m, [[-0.5, -0.25], [0.5, -0.25], [0.5, 0.25], [-0.5, 0.25]]);
        assert!(m.lean.iter().all(|l| l.abs() < 1e-9), "{:?}", m.lean);
        assert_eq!(measure(&Model3d::default(), &map), Measured::default());
    }

    #[test]
    fn a_back_rest_leans_back() {
        let chair = boxes(&[[[-0.25, -0.25, 0.0], [0.25, 0.25, 0.45]], [[-0.25, 0.2, 0.45], [0.25, 0.25, 0.9]]]);
        let m = measure(&chair, &Map::new(|p| p, [1.0; 3]));
        assert!(m.lean[1] > 0.5 && m.lean[0].abs() < 1e-9, "{:?}", m.lean);
    }
}
