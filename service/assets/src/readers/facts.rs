//! What a file says about itself, in the words of the format, before anybody judges it.
//!
//! What it is not for: what the object is or how large it really is; that is the annotation.

use std::collections::BTreeMap;
use std::path::PathBuf;

use d3dgen_mesh::Model3d;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// A box between its least and its largest corner.
pub type Bounds = [[f64; 3]; 2];

/// A model with what its file says about itself.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ReadModel {
    /// The geometry that is seen, turned to z up and in meters, where the file puts it: not moved to any origin. Files
    /// without an axis or a unit are taken as z up and in meters.
    pub model: Model3d,
    /// What the file says.
    pub facts: Facts,
    /// The other files that it is made of: materials, buffers, pictures, layers.
    pub companions: Vec<PathBuf>,
}

/// What a file says about itself.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Facts {
    /// `usda`, `usdc`, `usdz`, `glb`, `gltf`, `obj`, `dae`, `stl` or `sdf`: what the content is, whatever its name.
    pub format: String,
    /// The axis that points up, `X`, `Y` or `Z`; none where the format has no such thing.
    pub up_axis: Option<String>,
    /// Whether the file says so, or its format does for it.
    pub up_axis_authored: bool,
    /// How long the unit of the file is; none where the format has no such thing.
    pub meters_per_unit: Option<f64>,
    /// Whether the file says so, or its format does for it.
    pub meters_per_unit_authored: bool,
    /// The box of what is seen in the axes of the file, m.
    pub bbox_stage: Option<Bounds>,
    /// The same turned to z up, m; none for a format without an axis.
    pub bbox_zup: Option<Bounds>,
    /// Meshes with their repetitions.
    pub mesh_count: u64,
    /// Triangles of all meshes, seen or not, polygons cut into fans.
    pub triangle_count: u64,
    /// Names of the materials that something wears; sorted but for OBJ, which lists them as they come.
    pub material_names: Vec<String>,
    /// Plain colors of these materials, red, green, blue.
    pub diffuse_colors: Vec<[f64; 3]>,
    /// Pictures that the file names.
    pub textures: Vec<TextureFact>,
    /// What else the file has, by the words of its format.
    pub features: BTreeMap<String, Feature>,
    /// What is odd about the file without being a reason to refuse it.
    pub warnings: Vec<String>,
}

/// A picture that a file names.
#[derive(Debug, Clone, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct TextureFact {
    /// As the file names it; `data:` for one inside the text, none for one inside the file without a name.
    pub path: Option<String>,
    /// Whether it is there and may be read.
    pub resolves: bool,
    /// Its type and whether it is inside the file, where the format tells (glTF).
    pub embedded: Option<(Option<String>, bool)>,
}

/// One thing that a file has.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Feature {
    /// Whether it has it.
    Flag(bool),
    /// How many.
    Count(u64),
    /// A text.
    Text(String),
    /// Texts.
    Names(Vec<String>),
    /// Counts by name.
    Counts(BTreeMap<String, u64>),
    /// Numbers.
    Numbers(Vec<f64>),
}

impl Facts {
    /// Returns the extents along x, y and z of the box that is turned to z up, m.
    pub fn size_zup(&self) -> Option<[f64; 3]> {
        self.bbox_zup.map(|[min, max]| std::array::from_fn(|i| max[i] - min[i]))
    }

    /// Adds a feature.
    pub fn feature(&mut self, name: &str, value: Feature) {
        self.features.insert(name.to_owned(), value);
    }

    /// Adds a warning, each once.
    pub fn warn(&mut self, text: impl Into<String>) {
        let text = text.into();
        if !self.warnings.contains(&text) {
            self.warnings.push(text);
        }
    }
}

impl Feature {
    /// Returns it as JSON.
    pub fn to_json(&self) -> Value {
        match self {
            Self::Flag(flag) => json!(flag),
            Self::Count(count) => json!(count),
            Self::Text(text) => json!(text),
            Self::Names(names) => json!(names),
            Self::Counts(counts) => json!(counts),
            Self::Numbers(numbers) => json!(numbers),
        }
    }
}

impl TextureFact {
    /// Returns it as JSON, with the keys that its format has.
    pub fn to_json(&self) -> Value {
        match &self.embedded {
            Some((mime, embedded)) => json!({ "path": self.path, "mime": mime, "embedded": embedded }),
            None => json!({ "path": self.path, "resolves": self.resolves }),
        }
    }
}

/// Why a file is refused, with what could be found out about it all the same.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Refusal {
    /// What is wrong, and what would help; without the name of the file.
    pub reason: String,
    /// What the file says, as far as it was understood.
    pub facts: Option<Box<Facts>>,
}

impl Refusal {
    /// Returns a refusal with its reason alone.
    pub fn new(reason: impl Into<String>) -> Self {
        Self { reason: reason.into(), facts: None }
    }
}

impl From<String> for Refusal {
    fn from(reason: String) -> Self {
        Self::new(reason)
    }
}

impl From<&str> for Refusal {
    fn from(reason: &str) -> Self {
        Self::new(reason)
    }
}

impl std::fmt::Display for Refusal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.reason)
    }
}
