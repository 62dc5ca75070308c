//! What a 3D model is in memory, whichever file it came from or goes to.

use serde::{Deserialize, Serialize};

use crate::affine::{Vec3, cross, dot, length, scale, sub, unit};
use crate::finish::{self, Finish};

/// A direction closer than this to an axis is that axis.
const STRAIGHT: f64 = 0.9999;

/// A 3D model: bodies that joints move against each other, and what they look like.
///
/// All geometry is in the frame of the model (see the crate), with every joint at zero.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Model3d {
    /// Name, `[A-Za-z0-9_]`.
    pub name: String,
    /// Rigid bodies; the first is the root, which stands, hangs or is fixed.
    pub bodies: Vec<Body>,
    /// How the other bodies move; none for a model without moving parts.
    pub joints: Vec<Joint>,
    /// Materials that visuals name by index.
    pub materials: Vec<Material>,
    /// Pictures that materials name by index.
    pub textures: Vec<Texture>,
}

/// A rigid body.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Body {
    /// Name, unique in the model.
    pub name: String,
    /// What is seen.
    pub visuals: Vec<Visual>,
    /// What collides: convex shapes.
    pub collisions: Vec<Collision>,
    /// Mass, kg.
    pub mass_kg: f64,
}

/// A mesh with its material.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Visual {
    /// Name, unique in the body.
    pub name: String,
    /// Geometry.
    pub mesh: Mesh,
    /// Index into the model's materials.
    pub material: Option<usize>,
}

/// Triangles.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Mesh {
    /// Corners, m.
    pub positions: Vec<[f32; 3]>,
    /// One unit vector a position, or none at all.
    pub normals: Vec<[f32; 3]>,
    /// One texture coordinate a position, v up, or none at all.
    pub uvs: Vec<[f32; 2]>,
    /// Three indices into the positions a triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// A convex shape.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Collision {
    /// An upright box between two corners, m.
    Box {
        /// Least x, y, z.
        min: [f64; 3],
        /// Largest x, y, z.
        max: [f64; 3],
    },
    /// A round bar along x (0), y (1) or z (2), m.
    Cylinder {
        /// Middle of the axis.
        center: [f64; 3],
        /// Radius.
        radius: f64,
        /// Length along the axis.
        length: f64,
        /// Index of the axis.
        axis: usize,
    },
    /// A box whose axes are not those of the model, m.
    TurnedBox {
        /// Middle.
        center: [f64; 3],
        /// Half extents along its axes.
        half: [f64; 3],
        /// Its axes: unit vectors, right-handed.
        axes: [[f64; 3]; 3],
    },
    /// A ball, m.
    Sphere {
        /// Middle.
        center: [f64; 3],
        /// Radius.
        radius: f64,
    },
}

/// How one body moves against another.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Joint {
    /// Name, unique in the model.
    pub name: String,
    /// What moves.
    pub kind: JointKind,
    /// Index of the body it is fixed to.
    pub parent: usize,
    /// Index of the body that moves.
    pub child: usize,
    /// A point of the axis, m.
    pub origin: [f64; 3],
    /// Direction, unit length.
    pub axis: [f64; 3],
    /// Least and largest position: rad, or m for a prismatic joint; none for a continuous one.
    pub limits: Option<[f64; 2]>,
}

/// What a joint lets its body do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum JointKind {
    /// Turn between limits: doors, lids.
    Revolute,
    /// Slide between limits: drawers.
    Prismatic,
    /// Turn without end: wheels.
    Continuous,
}

/// A surface, in the metallic-roughness model of glTF and UsdPreviewSurface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// Name.
    pub name: String,
    /// Linear red, green, blue, 0 to 1.
    pub base_color: [f32; 3],
    /// 1 is solid.
    pub opacity: f32,
    /// 0 or 1 for real materials.
    pub metallic: f32,
    /// 0 is a mirror.
    pub roughness: f32,
    /// Light it gives off, linear red, green, blue.
    pub emissive: [f32; 3],
    /// Index of the texture that replaces the base color.
    pub texture: Option<usize>,
    /// Finish whose pictures it wears (`finish`), where it has no texture of its own.
    #[serde(default)] // never left out: the readers' frames (postcard) have no names of fields
    pub finish: Option<String>,
}

/// A picture file.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Texture {
    /// Path as the source names it, or the name it is written under.
    pub path: String,
    /// Content of the file, when it could be read.
    pub bytes: Option<Vec<u8>>,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: "Default".to_owned(),
            base_color: [0.8; 3],
            opacity: 1.0,
            metallic: 0.0,
            roughness: 0.6,
            emissive: [0.0; 3],
            texture: None,
            finish: None,
        }
    }
}

impl Material {
    /// Returns the finish that it wears; none where it has a texture of its own.
    pub fn worn(&self) -> Option<&'static Finish> {
        self.finish.as_deref().filter(|_| self.texture.is_none()).and_then(finish::get)
    }

    /// Returns what the picture that it wears is multiplied with, linear: under the gray grain of a finish its base color
    /// comes out; the base color itself where it wears none.
    pub fn factor(&self) -> [f32; 3] {
        match self.worn() {
            Some(worn) if worn.tints => {
                let mean = worn.mean();
                std::array::from_fn(|k| (self.base_color[k] / mean[k].max(0.05)).min(1.0))
            }
            _ => self.base_color,
        }
    }
}

impl Model3d {
    /// Returns the meshes of all bodies.
    pub fn meshes(&self) -> impl Iterator<Item = &Mesh> {
        self.bodies.iter().flat_map(|b| &b.visuals).map(|v| &v.mesh)
    }

    /// Returns the box around all corners that triangles use, m; none when there is no triangle.
    pub fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        self.meshes().filter_map(Mesh::bounds).reduce(|a, b| {
            [std::array::from_fn(|i| a[0][i].min(b[0][i])), std::array::from_fn(|i| a[1][i].max(b[1][i]))]
        })
    }

    /// Returns the number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.meshes().map(|m| m.triangles.len()).sum()
    }
}

/// Returns a model as one body: what joints hold is held fast, with every joint at zero.
pub fn welded(model: &Model3d) -> Model3d {
    let mut all = Body { name: model.name.clone(), ..Body::default() };
    for body in &model.bodies {
        all.visuals.extend(body.visuals.iter().cloned());
        all.collisions.extend(body.collisions.iter().cloned());
        all.mass_kg += body.mass_kg;
    }
    Model3d { bodies: vec![all], joints: Vec::new(), ..model.clone() }
}

impl Mesh {
    /// Returns the box around all corners that triangles use, m; none when there is no triangle.
    pub fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        let corner = |i: &u32| self.positions.get(*i as usize).map(|p| p.map(f64::from));
        self.triangles.iter().flatten().filter_map(corner).fold(None, |bounds, p| match bounds {
            None => Some([p, p]),
            Some([min, max]) => {
                Some([std::array::from_fn(|i| p[i].min(min[i])), std::array::from_fn(|i| p[i].max(max[i]))])
            }
        })
    }
}

impl Collision {
    /// Returns a box around a center with these axes, whose lengths stretch it: an upright one when they are those of the
    /// model.
    pub fn around(center: [f64; 3], half: [f64; 3], axes: [[f64; 3]; 3]) -> Self {
        let lengths = axes.map(length);
        let half = std::array::from_fn(|i| half[i] * lengths[i]);
        turned(center, half, axes.map(unit))
    }

    /// Returns an upright box whose third axis was that of a round bar as such a bar, and any other shape as it is.
    /// `radius` and `half` tell which of its axes that is.
    pub fn rounded(self, radius: f64, half: f64) -> Self {
        let Self::Box { min, max } = &self else { return self };
        let extent: [f64; 3] = std::array::from_fn(|i| max[i] - min[i]);
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-6 * (a + b);
        let along = (0..3).rev().find(|&i| {
            let across = extent[(i + 1) % 3];
            close(extent[i] * radius, across * half) && close(across, extent[(i + 2) % 3])
        });
        let center = std::array::from_fn(|i| (min[i] + max[i]) / 2.0);
        match along {
            Some(axis) => {
                let radius = extent[(axis + 1) % 3] / 2.0;
                Self::Cylinder { center, radius, length: extent[axis], axis }
            }
            None => self,
        }
    }

    /// Returns the upright box around the shape: least and largest corner, m.
    pub fn bounds(&self) -> [[f64; 3]; 2] {
        let around = |center: &[f64; 3], half: [f64; 3]| {
            [std::array::from_fn(|i| center[i] - half[i]), std::array::from_fn(|i| center[i] + half[i])]
        };
        match self {
            Self::Box { min, max } => [*min, *max],
            Self::Sphere { center, radius } => around(center, [*radius; 3]),
            Self::Cylinder { center, radius, length, axis } => {
                around(center, std::array::from_fn(|i| if i == *axis { length / 2.0 } else { *radius }))
            }
            Self::TurnedBox { center, half, axes } => {
                around(center, std::array::from_fn(|k| (0..3).map(|i| axes[i][k].abs() * half[i]).sum()))
            }
        }
    }
}

/// Returns a box with these unit axes: upright when they are the axes of the model.
fn turned(center: Vec3, half: Vec3, axes: [Vec3; 3]) -> Collision {
    let straight = axes.iter().all(|a| a.iter().any(|v| v.abs() > STRAIGHT));
    if straight {
        let extent: Vec3 = std::array::from_fn(|k| (0..3).map(|i| axes[i][k].abs() * half[i]).sum());
        return Collision::Box {
            min: std::array::from_fn(|k| center[k] - extent[k]),
            max: std::array::from_fn(|k| center[k] + extent[k]),
        };
    }
    // Where it was stretched by per milles, turned axes are not quite square to each other.
    let second = unit(sub(axes[1], scale(axes[0], dot(axes[0], axes[1]))));
    let axes = [axes[0], second, cross(axes[0], second)];
    Collision::TurnedBox { center, half, axes }
}
