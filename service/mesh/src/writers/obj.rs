//! OBJ meshes with their materials: what Gazebo, Drake and MuJoCo all read beside an SDF file.

use std::collections::HashMap;
use std::fmt::Write;

use super::number::{n, push};
use super::{picture_extension, texture_of};
use crate::model3d::{Body, Mesh, Model3d, Visual};

/// Returns the OBJ text of a body.
pub(super) fn obj(model: &Model3d, body: &Body, library: &str) -> String {
    let mut out = format!("mtllib {library}\no {}\n", body.name);
    let mut faces = String::new();
    let (mut points, mut normals, mut uvs) = (Numbered::new("v"), Numbered::new("vn"), Numbered::new("vt"));
    for visual in &body.visuals {
        let mesh = &visual.mesh;
        if let Some(material) = visual.material {
            let _ = writeln!(faces, "usemtl {}", material_name(material));
        }
        let textured = visual.material.is_some_and(|m| texture_of(model, m).is_some()) && !mesh.uvs.is_empty();
        for triangle in &mesh.triangles {
            faces.push('f');
            for corner in triangle.map(|i| i as usize) {
                faces.push(' ');
                push(&mut faces, points.number(&mut out, &mesh.positions[corner], 6), 0);
                if textured {
                    faces.push('/');
                    push(&mut faces, uvs.number(&mut out, &mesh.uvs[corner], 5), 0);
                }
                if let Some(normal) = mesh.normals.get(corner) {
                    faces.push_str(if textured { "/" } else { "//" });
                    push(&mut faces, normals.number(&mut out, normal, 4), 0);
                }
            }
            faces.push('\n');
        }
    }
    out.push_str(&faces);
    out
}

/// Returns meshes of one material as OBJ text without materials, for readers that name the material elsewhere.
pub fn mesh_obj(name: &str, meshes: &[&Mesh]) -> String {
    let visual = |mesh: &&Mesh| Visual { mesh: (*mesh).clone(), ..Visual::default() };
    let body = Body { name: name.to_owned(), visuals: meshes.iter().map(visual).collect(), ..Body::default() };
    let text = obj(&Model3d::default(), &body, "");
    text.split_once('\n').map_or_else(String::new, |(_, rest)| rest.to_owned())
}

/// Returns the material library of a model.
pub(super) fn mtl(model: &Model3d) -> String {
    let mut out = String::new();
    for (i, material) in model.materials.iter().enumerate() {
        let color = |c: [f32; 3]| c.map(|v| n(f64::from(v))).join(" ");
        let shine = 1.0 - f64::from(material.roughness);
        let _ = write!(
            out,
            "newmtl {}\nKa {base}\nKd {base}\nKs {gloss} {gloss} {gloss}\nNs {}\nd {}\nillum 2\n",
            material_name(i),
            n(10.0 + 240.0 * shine * shine),
            n(f64::from(material.opacity)),
            base = color(material.base_color),
            gloss = n(0.04 + 0.4 * shine * shine),
        );
        if material.emissive != [0.0; 3] {
            let _ = writeln!(out, "Ke {}", color(material.emissive));
        }
        if let Some((texture, bytes)) = texture_of(model, i)
            && let Some(extension) = picture_extension(bytes)
        {
            let _ = writeln!(out, "map_Kd texture_{texture}.{extension}");
        }
    }
    out
}

fn material_name(index: usize) -> String {
    format!("material_{index}")
}

/// Vectors that are written once and named by their number.
struct Numbered<const N: usize> {
    word: &'static str,
    // Only looked up, never walked: its order shows nowhere.
    known: HashMap<[u32; N], usize>,
}

impl<const N: usize> Numbered<N> {
    fn new(word: &'static str) -> Self {
        Self { word, known: HashMap::new() }
    }

    /// Returns the number of a vector, counted from 1, after writing it when it is new.
    fn number(&mut self, out: &mut String, vector: &[f32; N], decimals: u32) -> f64 {
        let next = self.known.len() + 1;
        let number = *self.known.entry(vector.map(f32::to_bits)).or_insert_with(|| {
            out.push_str(self.word);
            for v in vector {
                out.push(' ');
                push(out, f64::from(*v), decimals);
            }
            out.push('\n');
            next
        });
        number as f64
    }
}
