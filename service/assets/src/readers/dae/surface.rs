//! Materials and pictures of COLLADA.

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_mesh::Material;
use roxmltree::Node;

use super::{Ids, child, children, local};
use crate::readers::builder::Builder;
use crate::readers::facts::{Feature, TextureFact};
use crate::readers::folder::Folder;

/// The materials of a document.
#[derive(Default)]
pub struct Surfaces {
    /// Id, name, plain color and index, in the order of the document.
    all: Vec<(String, String, Option<[f64; 3]>, usize)>,
}

impl Surfaces {
    /// Returns the index of a material by its id.
    pub fn index(&self, id: &str) -> Option<usize> {
        self.all.iter().find(|m| m.0 == id).map(|m| m.3)
    }
}

/// Reads the materials, and notes the pictures.
pub fn read(builder: &mut Builder, root: Node, ids: &Ids, folder: &Folder) -> Surfaces {
    let mut pictures: BTreeMap<String, String> = BTreeMap::new();
    let mut windows = false;
    for image in children(root, "library_images").flat_map(|l| children(l, "image")) {
        let Some(from) = child(image, "init_from") else { continue };
        let path = from.text().map(str::trim).filter(|t| !t.is_empty());
        let path = path.or_else(|| child(from, "ref")?.text()).map(str::to_owned);
        windows |= path
            .as_deref()
            .is_some_and(|p| p.contains("file:///") || p.get(1..3).is_some_and(|d| d == ":\\" || d == ":/"));
        let resolves = path.as_deref().is_some_and(|p| folder.resolve(&on_disk(p)).is_some());
        if let (Some(id), Some(path)) = (image.attribute("id"), &path) {
            pictures.insert(id.to_owned(), path.clone());
        }
        builder.facts.textures.push(TextureFact { path, resolves, embedded: None });
    }
    builder.facts.feature("windows_texture_paths", Feature::Flag(windows));
    let mut surfaces = Surfaces::default();
    for element in children(root, "library_materials").flat_map(|l| children(l, "material")) {
        let Some(id) = element.attribute("id") else { continue };
        let name = element.attribute("name").filter(|n| !n.is_empty()).unwrap_or(id).to_owned();
        let effect = child(element, "instance_effect").and_then(|e| ids.get(local(e.attribute("url"))?).copied());
        let mut material = Material { name: name.clone(), ..Material::default() };
        let color = effect.and_then(|e| shade(&mut material, e, ids, &pictures, builder, folder));
        surfaces.all.push((id.to_owned(), name, color, builder.materials.len()));
        builder.materials.push(material);
    }
    surfaces
}

/// Notes which materials are worn.
pub fn note(builder: &mut Builder, surfaces: &Surfaces, worn: &[String]) {
    let worn: BTreeSet<&String> = worn.iter().collect();
    let all = || surfaces.all.iter().filter(|m| worn.contains(&m.0));
    let mut names: BTreeSet<String> = std::mem::take(&mut builder.facts.material_names).into_iter().collect();
    names.extend(all().map(|m| m.1.clone()));
    builder.facts.material_names = names.into_iter().collect();
    builder.facts.diffuse_colors.extend(all().filter_map(|m| m.2));
}

/// Returns a path as it may be on disk.
fn on_disk(path: &str) -> String {
    crate::readers::gltf::decoded(&path.replace("file://", ""))
}

/// Reads an effect into a material; returns its plain color.
fn shade(
    material: &mut Material,
    effect: Node,
    ids: &Ids,
    pictures: &BTreeMap<String, String>,
    builder: &mut Builder,
    folder: &Folder,
) -> Option<[f64; 3]> {
    let profile = child(effect, "profile_COMMON")?;
    let technique = child(profile, "technique")?;
    let model =
        technique.children().find(|c| matches!(c.tag_name().name(), "phong" | "lambert" | "blinn" | "constant"))?;
    let numbers = |name: &str| -> Option<[f64; 3]> {
        let numbers = child(child(model, name)?, "color")?.text()?.split_whitespace();
        let numbers: Vec<f64> = numbers.map_while(|w| w.parse().ok()).collect();
        Some([*numbers.first()?, *numbers.get(1)?, *numbers.get(2)?])
    };
    material.emissive = numbers("emission").unwrap_or_default().map(|v| v.clamp(0.0, 1.0) as f32);
    if let Some(color) = numbers("diffuse") {
        material.base_color = color.map(|v| v as f32);
        return Some(color);
    }
    let sampler = child(child(model, "diffuse")?, "texture")?.attribute("texture")?;
    let scope = |sid: &str| {
        let parameters =
            children(profile, "newparam").chain(children(technique, "newparam")).chain(children(effect, "newparam"));
        parameters.into_iter().find(|p| p.attribute("sid") == Some(sid))
    };
    let sampled = scope(sampler).and_then(|p| child(p, "sampler2D"));
    let surface = sampled
        .and_then(|s| child(s, "source"))
        .and_then(|s| scope(s.text()?.trim()))
        .and_then(|p| child(p, "surface"));
    let by_surface = surface.and_then(|s| child(s, "init_from")).and_then(|i| i.text()).map(str::trim);
    let by_instance = sampled.and_then(|s| child(s, "instance_image")).and_then(|i| local(i.attribute("url")));
    let image = by_surface.or(by_instance).unwrap_or(sampler);
    let path = pictures.get(image).filter(|_| ids.contains_key(image))?;
    let index = builder.picture_with(path, |most| folder.read(&on_disk(path), most).ok());
    material.texture = Some(index);
    None
}
