//! The JSON of glTF 2.0, as far as it is read. An index that is negative or too large is no number of ours.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde_json::Value;

use crate::readers::facts::{Bounds, Refusal};
use crate::readers::frame::Matrix;

/// The whole document.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Document {
    pub asset: Asset,
    pub scene: Option<usize>,
    pub scenes: Vec<Scene>,
    pub nodes: Vec<Node>,
    pub meshes: Vec<Mesh>,
    pub accessors: Vec<Accessor>,
    pub buffer_views: Vec<View>,
    pub buffers: Vec<Buffer>,
    pub materials: Vec<Material>,
    pub textures: Vec<Texture>,
    pub images: Vec<Image>,
    pub animations: Vec<Ignored>,
    pub skins: Vec<Ignored>,
    pub cameras: Vec<Ignored>,
    pub extensions_used: Vec<String>,
    pub extensions_required: Vec<String>,
}

/// Something of which only the number counts.
#[derive(Debug, Default, Deserialize)]
pub struct Ignored {}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Asset {
    pub version: String,
    pub generator: Option<String>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Scene {
    pub nodes: Vec<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Node {
    pub name: Option<String>,
    pub children: Vec<usize>,
    pub mesh: Option<usize>,
    pub skin: Option<usize>,
    matrix: Option<Vec<f64>>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Mesh {
    pub name: Option<String>,
    pub primitives: Vec<Primitive>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Primitive {
    pub attributes: BTreeMap<String, usize>,
    pub indices: Option<usize>,
    pub material: Option<usize>,
    pub mode: Option<u32>,
    pub targets: Vec<Value>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Accessor {
    pub buffer_view: Option<usize>,
    pub byte_offset: usize,
    pub component_type: u32,
    pub normalized: bool,
    pub count: usize,
    #[serde(rename = "type")]
    pub shape: String,
    pub min: Option<Vec<f64>>,
    pub max: Option<Vec<f64>>,
    pub sparse: Option<Sparse>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Sparse {
    pub count: usize,
    pub indices: SparseList,
    pub values: SparseList,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct SparseList {
    pub buffer_view: usize,
    pub byte_offset: usize,
    pub component_type: u32,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct View {
    pub buffer: usize,
    pub byte_offset: usize,
    pub byte_length: usize,
    pub byte_stride: Option<usize>,
    pub extensions: ViewExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct ViewExtensions {
    #[serde(rename = "EXT_meshopt_compression")]
    pub meshopt: Option<Meshopt>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Meshopt {
    pub buffer: usize,
    pub byte_offset: usize,
    pub byte_length: usize,
    pub byte_stride: usize,
    pub count: usize,
    pub mode: String,
    pub filter: Option<String>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Buffer {
    pub byte_length: usize,
    pub uri: Option<String>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Texture {
    source: Option<usize>,
    extensions: BTreeMap<String, Value>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Image {
    pub uri: Option<String>,
    pub mime_type: Option<String>,
    pub buffer_view: Option<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Material {
    pub name: Option<String>,
    #[serde(rename = "pbrMetallicRoughness")]
    pub pbr: Pbr,
    #[serde(rename = "emissiveFactor")]
    pub emissive: Option<[f64; 3]>,
    extensions: BTreeMap<String, Value>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Pbr {
    #[serde(rename = "baseColorFactor")]
    color: Option<Vec<f64>>,
    #[serde(rename = "baseColorTexture")]
    texture: Option<TextureRef>,
    #[serde(rename = "metallicFactor")]
    pub metallic: Option<f64>,
    #[serde(rename = "roughnessFactor")]
    pub roughness: Option<f64>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct TextureRef {
    pub index: usize,
}

impl Node {
    /// Returns the matrix from the node to its parent.
    pub fn matrix(&self) -> Result<Matrix, Refusal> {
        if let Some(matrix) = &self.matrix {
            let matrix: [f64; 16] = matrix.as_slice().try_into().map_err(|_| "a matrix of it has not 16 numbers")?;
            return Ok(Matrix::from_columns(matrix));
        }
        let rotation = Matrix::rotation(self.rotation.unwrap_or([0., 0., 0., 1.]));
        let moved = Matrix::translation(self.translation.unwrap_or_default());
        Ok(moved * rotation * Matrix::scale(self.scale.unwrap_or([1.0; 3])))
    }
}

impl Accessor {
    /// Returns the box that it says its numbers have.
    pub fn claimed(&self) -> Option<Bounds> {
        let three = |v: &Option<Vec<f64>>| -> Option<[f64; 3]> { v.as_ref()?.as_slice().try_into().ok() };
        let full = if self.normalized { super::accessor::full_scale(self.component_type) } else { 1.0 };
        Some([three(&self.min)?.map(|v| v / full), three(&self.max)?.map(|v| v / full)])
    }
}

impl Texture {
    /// Returns the index of its picture: the plain one, or that of an extension for other formats of pictures.
    pub fn image(&self) -> Option<usize> {
        let other = || self.extensions.values().find_map(|e| e.get("source")?.as_u64()).map(|v| v as usize);
        self.source.or_else(other)
    }
}

impl Material {
    /// Returns the plain color of the metallic-roughness model, red, green, blue.
    pub fn color(&self) -> [f64; 3] {
        let color = self.pbr.color.as_deref().unwrap_or_default();
        std::array::from_fn(|i| color.get(i).copied().filter(|v| v.is_finite()).unwrap_or(1.0))
    }

    /// Returns the color of whichever model the material has.
    pub fn shown_color(&self) -> [f64; 3] {
        let old = self.extensions.get("KHR_materials_pbrSpecularGlossiness").and_then(|e| e.get("diffuseFactor"));
        let number = |i: usize| old.and_then(|f| f.get(i)).and_then(Value::as_f64);
        let own = self.color();
        std::array::from_fn(|i| number(i).unwrap_or(own[i]))
    }

    /// Returns how solid it is, 0 to 1.
    pub fn opacity(&self) -> f64 {
        self.pbr.color.as_deref().and_then(|c| c.get(3)).copied().unwrap_or(1.0).clamp(0.0, 1.0)
    }

    /// Returns the index of the texture of its color.
    pub fn base_texture(&self) -> Option<usize> {
        let old = || {
            let gloss = self.extensions.get("KHR_materials_pbrSpecularGlossiness")?;
            gloss.get("diffuseTexture")?.get("index")?.as_u64().map(|v| v as usize)
        };
        self.pbr.texture.as_ref().map(|t| t.index).or_else(old)
    }
}
