//! Meshes of boxes and prisms, with texture coordinates in meters.

use d3dgen_mesh::{Mesh, Visual, triangulate};
use d3dgen_model::geometry::Point;

use crate::scene::{SimBox, SimShape};

/// A side of a convex solid of the building.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Side {
    /// Upper face.
    Top,
    /// Lower face.
    Bottom,
    /// An upright face: its middle on the floor plan, its outward direction and its length.
    Upright { middle: Point, outward: [f64; 2], length: f64 },
}

/// Returns the faces of a solid: corners counter-clockwise seen from outside, and which side it is.
pub(super) fn faces(shape: &SimShape) -> Vec<(Vec<[f64; 3]>, Side)> {
    let (outline, [low, high]) = match shape {
        SimShape::Box(b) => (b.outline().to_vec(), [b.center_m[2] - b.half_m[2], b.center_m[2] + b.half_m[2]]),
        SimShape::Prism { outline, z_m } => (outline.clone(), *z_m),
    };
    let at = |p: &Point, z: f64| [p.x, p.y, z];
    let mut faces = vec![
        (outline.iter().map(|p| at(p, high)).collect(), Side::Top),
        (outline.iter().rev().map(|p| at(p, low)).collect(), Side::Bottom),
    ];
    for (i, a) in outline.iter().enumerate() {
        let b = &outline[(i + 1) % outline.len()];
        let length = a.distance(*b);
        if length > 1e-9 {
            let outward = [(b.y - a.y) / length, (a.x - b.x) / length];
            let middle = Point::new((a.x + b.x) / 2.0, (a.y + b.y) / 2.0);
            faces.push((
                vec![at(a, low), at(b, low), at(b, high), at(a, high)],
                Side::Upright { middle, outward, length },
            ));
        }
    }
    faces
}

/// Adds a flat convex face. Its texture runs along the floor, or along the wall and up.
pub(super) fn add_face(mesh: &mut Mesh, corners: &[[f64; 3]]) {
    let [a, b, c] = [corners[0], corners[1], corners[2]];
    let (u, v) = (minus(b, a), minus(c, a));
    let normal = unit([u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]);
    let first = mesh.positions.len() as u32;
    // Along an upright face to the right of who looks at it.
    let along = if normal[2].abs() > 0.7 { [1.0, 0.0] } else { unit2([-normal[1], normal[0]]) };
    for p in corners {
        mesh.positions.push(p.map(|v| v as f32));
        mesh.normals.push(normal.map(|v| (v + 0.0) as f32));
        let uv = if normal[2].abs() > 0.7 { [p[0], p[1]] } else { [p[0] * along[0] + p[1] * along[1], p[2]] };
        mesh.uvs.push(uv.map(|v| v as f32));
    }
    for i in 1..corners.len() as u32 - 1 {
        mesh.triangles.push([first, first + i, first + i + 1]);
    }
}

/// Returns all faces of a box as a mesh.
pub(super) fn boxed(b: &SimBox) -> Mesh {
    let mut mesh = Mesh::default();
    faces(&SimShape::Box(*b)).iter().for_each(|(corners, _)| add_face(&mut mesh, corners));
    mesh
}

/// Returns a flat floor or ceiling at a height; it faces up, or down.
pub(super) fn flat(outline: &[Point], z: f64, faces_up: bool) -> Mesh {
    let corners: Vec<[f64; 2]> = outline.iter().map(|p| [p.x, p.y]).collect();
    let triangles = triangulate(&corners).unwrap_or_default();
    let up = if faces_up { 1.0 } else { -1.0 };
    let turned = |[a, b, c]: [usize; 3]| if faces_up { [a, b, c] } else { [a, c, b] }.map(|i| i as u32);
    Mesh {
        positions: corners.iter().map(|p| [p[0] as f32, p[1] as f32, z as f32]).collect(),
        normals: vec![[0.0, 0.0, up]; corners.len()],
        uvs: corners.iter().map(|p| p.map(|v| v as f32)).collect(),
        triangles: triangles.into_iter().map(turned).collect(),
    }
}

/// Meshes by their material.
#[derive(Default)]
pub(super) struct Sorted(Vec<(usize, Mesh)>);

impl Sorted {
    /// Returns the mesh of a material.
    pub fn of(&mut self, material: usize) -> &mut Mesh {
        let at = match self.0.iter().position(|(m, _)| *m == material) {
            Some(at) => at,
            None => {
                self.0.push((material, Mesh::default()));
                self.0.len() - 1
            }
        };
        &mut self.0[at].1
    }

    /// Adds a whole mesh.
    pub fn add(&mut self, material: usize, other: &Mesh) {
        let mesh = self.of(material);
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(&other.positions);
        mesh.normals.extend(&other.normals);
        mesh.uvs.extend(&other.uvs);
        mesh.triangles.extend(other.triangles.iter().map(|t| t.map(|i| i + first)));
    }

    /// Returns the visuals, named by the number of their material.
    pub fn visuals(self) -> Vec<Visual> {
        let named = |(m, mesh): (usize, Mesh)| Visual { name: format!("surface_{m}"), mesh, material: Some(m) };
        self.0.into_iter().map(named).collect()
    }
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = v.iter().map(|c| c * c).sum::<f64>().sqrt().max(1e-300);
    v.map(|c| c / length)
}

fn unit2(v: [f64; 2]) -> [f64; 2] {
    let length = v[0].hypot(v[1]).max(1e-300);
    v.map(|c| c / length)
}
