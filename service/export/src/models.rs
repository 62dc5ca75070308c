//! The folder of a model as Arena and others read it: ASA annotation, USDZ, GLB, SDF with its meshes. A model is made of
//! a build, or one that an asset database keeps.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use d3dgen_mesh::{Library, Model3d, generate, writers};
use d3dgen_model::domain::{Mount, ObjectType};
use serde_json::{Value, json};

use crate::color::Rgb;
use crate::error::Error;
use crate::file::File;
use crate::yaml;

/// A model to be made.
#[derive(Debug, Clone, Copy)]
pub struct ModelRequest<'a> {
    /// First part of the reference `Domain/Name`: `Hospital`.
    pub domain: &'a str,
    /// Second part, `[A-Za-z0-9_]` and more that file names may have: `Patient_Bed`.
    pub name: &'a str,
    /// What it is a model of.
    pub object: &'a ObjectType,
    /// Width, depth, height, m.
    pub size_m: [f64; 3],
    /// Where it is fixed.
    pub mount: Mount,
    /// Seed of its variants.
    pub seed: u64,
}

/// A model that is kept, not made.
#[derive(Debug, Clone, PartialEq)]
pub struct KeptModel {
    /// The model, its front at -y, with masses and collision shapes.
    pub model: Model3d,
    /// What it is, for people.
    pub description: String,
    /// Tags of the ASA standard, `key::value`.
    pub tags: Vec<String>,
}

/// The models that an asset database keeps.
pub trait KeptModels: Sync {
    /// Returns the model of an asset; none when it is to be made of a build.
    ///
    /// # Errors
    /// `Kept` when the database cannot give it.
    fn model(&self, asset_id: &str) -> Result<Option<KeptModel>, Error>;
}

/// No database: every model is made.
pub struct NothingKept;

impl KeptModels for NothingKept {
    fn model(&self, _: &str) -> Result<Option<KeptModel>, Error> {
        Ok(None)
    }
}

/// Makes a model and returns its files, with paths that begin `<Domain>/Object/<Name>/`.
///
/// # Errors
/// `Model` when its build cannot be made at this size.
pub fn files(library: &Library, request: &ModelRequest<'_>) -> Result<Vec<File>, Error> {
    let model = generate(library, request.object, request.size_m, request.seed)?;
    let kind = library.of(request.object).map_or("", |b| b.kind.as_str());
    folder(request.domain, request.name, model, &annotation(request, kind))
}

/// Returns the files of a kept model, as [`files`] names them.
///
/// # Errors
/// `Model` when it holds what no file can.
pub fn kept_files(domain: &str, name: &str, kept: KeptModel) -> Result<Vec<File>, Error> {
    let round = |v: f64| (v * 1e4).round() / 1e4;
    let [min, max] = kept.model.bounds().unwrap_or_default();
    let span = |i: usize| [round(min[i]), round(max[i])];
    let annotation = json!({
        "asa": 1,
        "bounding_box": [span(0), span(1), span(2)],
        "desc": kept.description,
        "face": "-y",
        "name": name,
        "note": "Kept in the asset database of d3dgen",
        "path": format!("Object/{name}"),
        "tags": kept.tags,
    });
    folder(domain, name, kept.model, &annotation)
}

fn folder(domain: &str, name: &str, mut model: Model3d, annotation: &Value) -> Result<Vec<File>, Error> {
    // References may hold dots and dashes, names inside the files may not.
    model.name = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    let folder = format!("{domain}/Object/{name}");
    let mut files = vec![
        File::new(format!("{folder}/annotation.yaml"), yaml::to_string(annotation)),
        File::new(format!("{folder}/{name}.usdz"), writers::usdz(&model)?),
        File::new(format!("{folder}/{name}.glb"), writers::glb(&model)?),
    ];
    for file in writers::sdf(&model)? {
        // The model file is named as its folder is, whatever the model may be called inside.
        let own = if file.name == format!("{}.sdf", model.name) { format!("{name}.sdf") } else { file.name };
        files.push(File::new(format!("{folder}/{name}.sdf/{own}"), file.bytes));
    }
    Ok(files)
}

/// Models that are remembered for the next world: a few hundred objects of about 0.1 MB.
const REMEMBERED: usize = 256;

/// Things made of requests, the last few hundred of them: the next world of a domain uses mostly the same ones.
type Remembered<T> = Mutex<BTreeMap<String, Arc<T>>>;

/// Returns what is remembered for a request, else what is made.
fn remembered<T>(
    made: &Remembered<T>,
    request: &ModelRequest<'_>,
    make: impl FnOnce() -> Result<T, Error>,
) -> Result<Arc<T>, Error> {
    let object = serde_json::to_string(request.object).unwrap_or_default();
    let key = format!(
        "{}/{} {:?} {:?} {} {object}",
        request.domain, request.name, request.size_m, request.mount, request.seed
    );
    if let Some(known) = made.lock().unwrap_or_else(PoisonError::into_inner).get(&key) {
        return Ok(Arc::clone(known));
    }
    let own = Arc::new(make()?);
    let mut made = made.lock().unwrap_or_else(PoisonError::into_inner);
    if made.len() >= REMEMBERED {
        made.clear();
    }
    made.insert(key, Arc::clone(&own));
    Ok(own)
}

/// Returns the files of a model made by the shipped builds.
///
/// # Errors
/// As [`files`].
pub(crate) fn remembered_files(request: &ModelRequest<'_>) -> Result<Arc<Vec<File>>, Error> {
    static MADE: Remembered<Vec<File>> = Mutex::new(BTreeMap::new());
    remembered(&MADE, request, || files(Library::shipped(), request))
}

/// Returns a model made by the shipped builds.
///
/// # Errors
/// `Model` when its build cannot be made at this size.
pub(crate) fn remembered_model(request: &ModelRequest<'_>) -> Result<Arc<Model3d>, Error> {
    static MADE: Remembered<Model3d> = Mutex::new(BTreeMap::new());
    remembered(&MADE, request, || Ok(generate(Library::shipped(), request.object, request.size_m, request.seed)?))
}

/// Returns the ASA annotation; the model's front is -y.
fn annotation(request: &ModelRequest<'_>, kind: &str) -> Value {
    let [w, d, h] = request.size_m;
    let object = request.object;
    let round = |v: f64| (v * 1e4).round() / 1e4;
    let mut tags = vec![format!("domain::{}", request.domain.to_lowercase())];
    if !kind.is_empty() {
        tags.push(format!("kind::{kind}"));
    }
    tags.push(format!("mount::{}", mount(request.mount)));
    tags.extend(object.affordances.iter().map(|a| format!("hoi::{}", snake(a))));
    if !object.color.is_empty() {
        tags.push(format!("color::{}", Rgb::from_css(&object.color).word()));
    }
    if !object.material.is_empty() {
        tags.push(format!("material::{}", snake(&object.material)));
    }
    json!({
        "asa": 1,
        "bounding_box": [[round(-w / 2.0), round(w / 2.0)], [round(-d / 2.0), round(d / 2.0)], [0.0, round(h)]],
        "desc": object.label,
        "face": "-y",
        "name": request.name,
        "note": "Generated by d3dgen",
        "path": format!("Object/{}", request.name),
        "tags": tags,
    })
}

fn mount(mount: Mount) -> &'static str {
    match mount {
        Mount::Floor => "floor",
        Mount::Wall => "wall",
        Mount::Ceiling => "ceiling",
        Mount::Surface => "surface",
    }
}

/// Returns the text as a lower-case name that Arena accepts (`^[a-z0-9_]+$`).
pub(crate) fn snake(text: &str) -> String {
    text.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' }).collect()
}
