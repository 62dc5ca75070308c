//! Meshes and materials of the models: one mesh a body and material, as MuJoCo has one material a geom.

use std::collections::BTreeMap;

use d3dgen_mesh::writers;
use d3dgen_mesh::{Body, Material, Mesh};

use super::list;
use crate::file::File;
use crate::scene::{SimModel, SimScene};
use crate::xml::Xml;

/// What is seen of a body in one material.
pub(super) struct Look<'a> {
    /// Name of the mesh: `<model>_<body>_<material>`.
    pub name: String,
    /// Index of its material; none for a mesh without one.
    pub material: Option<usize>,
    meshes: Vec<&'a Mesh>,
}

/// Returns what is seen of each body of a model.
pub(super) fn looks(model: &SimModel) -> Vec<Vec<Look<'_>>> {
    model.model.bodies.iter().map(|body| looks_of(model, body)).collect()
}

fn looks_of<'a>(model: &SimModel, body: &'a Body) -> Vec<Look<'a>> {
    let mut by_material: BTreeMap<Option<usize>, Vec<&'a Mesh>> = BTreeMap::new();
    for visual in body.visuals.iter().filter(|v| !v.mesh.triangles.is_empty()) {
        by_material.entry(visual.material).or_default().push(&visual.mesh);
    }
    let look = |(material, meshes): (Option<usize>, Vec<&'a Mesh>)| {
        let number = material.map_or_else(|| "plain".to_owned(), |m| m.to_string());
        Look { name: format!("{}_{}_{number}", model.id, body.name), material, meshes }
    };
    by_material.into_iter().map(look).collect()
}

/// Returns the name of a material of a model.
pub(super) fn material(model: &SimModel, index: usize) -> String {
    format!("{}_material_{index}", model.id)
}

/// Returns the mesh files and pictures.
pub(super) fn files(scene: &SimScene) -> Vec<File> {
    let mut files = Vec::new();
    for model in &scene.models {
        for look in looks(model).into_iter().flatten() {
            let path = format!("mujoco/models/{}/{}.obj", model.id, look.name);
            files.push(File::new(path, writers::mesh_obj(&look.name, &look.meshes)));
        }
        for (k, bytes) in pictures(model) {
            files.push(File::new(format!("mujoco/models/{}", picture(model, k)), bytes.to_vec()));
        }
    }
    files
}

/// Returns the pictures of a model that MuJoCo reads: PNG.
fn pictures(model: &SimModel) -> impl Iterator<Item = (usize, &[u8])> {
    let all = model.model.textures.iter().enumerate();
    all.filter_map(|(k, t)| t.bytes.as_deref().filter(|b| b.starts_with(b"\x89PNG")).map(|b| (k, b)))
}

fn picture(model: &SimModel, index: usize) -> String {
    format!("{}/texture_{index}.png", model.id)
}

/// Writes the assets of all models.
pub(super) fn assets(xml: &mut Xml, scene: &SimScene) {
    for model in &scene.models {
        for (k, _) in pictures(model) {
            let name = format!("{}_texture_{k}", model.id);
            xml.leaf("texture", &[("name", name), ("type", "2d".to_owned()), ("file", picture(model, k))]);
        }
        for (index, own) in model.model.materials.iter().enumerate() {
            let mut attributes = look_of(own);
            attributes.insert(0, ("name", material(model, index)));
            if let Some(k) = own.texture.filter(|t| pictures(model).any(|(k, _)| k == *t)) {
                attributes.push(("texture", format!("{}_texture_{k}", model.id)));
            }
            xml.leaf("material", &attributes);
        }
        for look in looks(model).into_iter().flatten() {
            let file = format!("{}/{}.obj", model.id, look.name);
            // Thin sheets have no volume; only what collides needs one.
            xml.leaf("mesh", &[("name", look.name), ("file", file), ("inertia", "shell".to_owned())]);
        }
    }
}

/// Returns the attributes of a surface.
fn look_of(material: &Material) -> Vec<(&'static str, String)> {
    let shine = 1.0 - f64::from(material.roughness);
    let glow = material.emissive.iter().copied().fold(0.0, f32::max);
    let color = if glow > 0.0 { material.emissive } else { material.base_color };
    let [r, g, b] = color.map(|v| srgb(f64::from(v)));
    vec![
        ("rgba", list(&[r, g, b, f64::from(material.opacity)])),
        ("specular", list(&[shine * 0.5])),
        ("shininess", list(&[shine])),
        ("emission", list(&[if glow > 0.0 { 1.0 } else { 0.0 }])),
        ("metallic", list(&[f64::from(material.metallic)])),
        ("roughness", list(&[f64::from(material.roughness)])),
    ]
}

/// Returns a linear share of light as screens encode it.
pub(super) fn srgb(linear: f64) -> f64 {
    let v = linear.clamp(0.0, 1.0);
    let encoded = if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
    (encoded * 1e4).round() / 1e4
}
