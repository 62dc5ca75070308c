//! Models as files: USD (text, and packed as USDZ), glTF binary, SDF with its meshes.
//!
//! Same model, same bytes. What it is not for: the annotation beside a model, which says what it is (`export`, `assets`).

mod glb;
pub mod number;
mod obj;
mod sdf;
pub mod usd;
mod usdz;

pub use glb::{glb, world_glb};
pub use obj::mesh_obj;
pub use sdf::{sdf, sdf_body};
pub use usd::{asset_usda, usda};
pub use usdz::{pack, usdz};

use crate::affine::{Vec3, cross, dot, unit};
use crate::error::Error;
use crate::model3d::{Material, Model3d, Texture};

/// A file beside others, by its name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ModelFile {
    /// Name without folders.
    pub name: String,
    /// Content.
    pub bytes: Vec<u8>,
}

/// Checks what all writers rely on.
///
/// # Errors
/// `Model` with the first index out of range or figure that is none.
pub fn check(model: &Model3d) -> Result<(), Error> {
    let wrong = |reason: String| Err(Error::Model { model: model.name.clone(), reason });
    if model.name.is_empty() || !model.name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
        return wrong("its name is not of letters, digits and underscores".to_owned());
    }
    if model.bodies.is_empty() {
        return wrong("it has no body".to_owned());
    }
    for body in &model.bodies {
        for visual in &body.visuals {
            let (mesh, count) = (&visual.mesh, visual.mesh.positions.len());
            let place = format!("{}/{}", body.name, visual.name);
            if mesh.triangles.iter().flatten().any(|i| *i as usize >= count) {
                return wrong(format!("{place} has a triangle of a corner that is not there"));
            }
            if (!mesh.normals.is_empty() && mesh.normals.len() != count)
                || (!mesh.uvs.is_empty() && mesh.uvs.len() != count)
            {
                return wrong(format!("{place} has not one normal and texture coordinate a corner"));
            }
            if !mesh
                .positions
                .iter()
                .chain(&mesh.normals)
                .flatten()
                .chain(mesh.uvs.iter().flatten())
                .all(|v| v.is_finite())
            {
                return wrong(format!("{place} has a coordinate that is no figure"));
            }
            if visual.material.is_some_and(|m| m >= model.materials.len()) {
                return wrong(format!("{place} has a material that is not there"));
            }
        }
    }
    if model.materials.iter().any(|m| m.texture.is_some_and(|t| t >= model.textures.len())) {
        return wrong("a material has a texture that is not there".to_owned());
    }
    let bodies = model.bodies.len();
    match model.joints.iter().find(|j| j.parent >= bodies || j.child >= bodies || j.parent == j.child || j.child == 0) {
        Some(joint) => wrong(format!("{} joins bodies that are not there, or moves the root", joint.name)),
        None => Ok(()),
    }
}

/// Returns the texture file of a material that can be written: its index and content.
fn texture_of(model: &Model3d, material: usize) -> Option<(usize, &[u8])> {
    let index = model.materials.get(material)?.texture?;
    model.textures.get(index)?.bytes.as_deref().map(|bytes| (index, bytes))
}

/// Returns materials without finishes: the files of single models have no pictures but their own, so that they stay small,
/// and programs that read them see the color itself.
fn plain(materials: &[Material]) -> Vec<Material> {
    materials.iter().map(|m| Material { finish: None, ..m.clone() }).collect()
}

/// A picture that a material wears, as a file beside its model.
struct Picture<'a> {
    name: String,
    bytes: &'a [u8],
    /// What its color is multiplied with.
    factor: [f32; 3],
}

/// Returns the picture of a material: its own, or that of its finish; none when nobody could read it.
fn picture_of<'a>(material: &Material, textures: &'a [Texture]) -> Option<Picture<'a>> {
    if let Some(finish) = material.worn() {
        return Some(Picture {
            name: format!("{}.png", finish.id),
            bytes: &finish.pictures().color,
            factor: material.factor(),
        });
    }
    let index = material.texture?;
    let bytes = textures.get(index)?.bytes.as_deref()?;
    let extension = picture_extension(bytes)?;
    Some(Picture { name: format!("texture_{index}.{extension}"), bytes, factor: [1.0; 3] })
}

/// Returns the file extension of a picture by its first bytes; none when simulators read it nowhere.
fn picture_extension(bytes: &[u8]) -> Option<&'static str> {
    if bytes.starts_with(b"\x89PNG") {
        Some("png")
    } else if bytes.starts_with(b"\xff\xd8\xff") {
        Some("jpg")
    } else {
        None
    }
}

/// Returns the unit quaternion (w, x, y, z) of a right-handed frame given by its axes.
pub fn quaternion(axes: [Vec3; 3]) -> [f64; 4] {
    let m = |row: usize, column: usize| axes[column][row];
    let trace = m(0, 0) + m(1, 1) + m(2, 2);
    let q = if trace > 0.0 {
        let s = 2.0 * (trace + 1.0).sqrt();
        [s / 4.0, (m(2, 1) - m(1, 2)) / s, (m(0, 2) - m(2, 0)) / s, (m(1, 0) - m(0, 1)) / s]
    } else {
        let i = (0..3).max_by(|a, b| m(*a, *a).total_cmp(&m(*b, *b))).unwrap_or(0);
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let s = 2.0 * (1.0 + m(i, i) - m(j, j) - m(k, k)).max(0.0).sqrt();
        let mut q = [0.0; 4];
        q[0] = (m(k, j) - m(j, k)) / s;
        q[1 + i] = s / 4.0;
        q[1 + j] = (m(j, i) + m(i, j)) / s;
        q[1 + k] = (m(k, i) + m(i, k)) / s;
        q
    };
    let length = q.iter().map(|v| v * v).sum::<f64>().sqrt();
    q.map(|v| v / length)
}

/// Returns a right-handed frame whose first axis is this direction.
fn frame_along(direction: Vec3) -> [Vec3; 3] {
    let first = unit(direction);
    let least = (0..3).min_by(|a, b| first[*a].abs().total_cmp(&first[*b].abs())).unwrap_or(0);
    let mut side = [0.0; 3];
    side[least] = 1.0;
    let third = unit(cross(first, side));
    let second = cross(third, first);
    debug_assert!(dot(cross(first, second), third) > 0.99);
    [first, second, third]
}

/// Returns roll, pitch and yaw of a frame, as SDF reads them.
fn roll_pitch_yaw(axes: [Vec3; 3]) -> [f64; 3] {
    let [x, y, z] = axes;
    let pitch = (-x[2]).clamp(-1.0, 1.0).asin();
    if x[2].abs() > 0.999_999 {
        return [(-z[1]).atan2(y[1]), pitch, 0.0];
    }
    [y[2].atan2(z[2]), pitch, x[1].atan2(x[0])]
}

#[cfg(test)]
mod tests;
