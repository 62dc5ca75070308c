//! The links and joints of a model with those of the models in it: nested ones, and those that it includes.
//!
//! A link of a nested model is called `model::link`, as in SDF.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::path::PathBuf;

use roxmltree::{Document, Node, ParsingOptions};

use super::frames::Frames;
use super::{child, children, text, uri, words};
use crate::readers::facts::Refusal;
use crate::readers::folder::{Folder, MAX_FILE_BYTES};
use crate::readers::frame::Matrix;

/// The most files that a model is made of.
const MAX_DOCUMENTS: usize = 256;
/// The deepest nesting of models.
const MAX_DEPTH: usize = 16;
/// The most links of a model with all that is in it.
const MAX_LINKS: usize = 4_000;
/// The most visits of models: those in models, and again to see how they lie.
const MAX_VISITS: usize = 20_000;

/// One SDF file.
pub struct Text {
    content: String,
    folder: Folder,
    /// The files that it includes, by the URI.
    includes: BTreeMap<String, usize>,
}

/// A link where it stands.
pub struct Link<'a> {
    /// Name with those of the models it is in.
    pub name: String,
    /// Its element.
    pub node: Node<'a, 'a>,
    /// From the link to the whole model.
    pub place: Matrix,
    /// Folder of its file.
    pub folder: &'a Folder,
    /// Which of the frames of the parts it is in.
    part: usize,
}

/// A joint where it stands.
pub struct JointPlace<'a> {
    /// Name with those of the models it is in.
    pub name: String,
    /// Its element.
    pub node: Node<'a, 'a>,
    /// Link that holds it, with the names of its models; `world` is none of them.
    pub parent: String,
    /// Link that moves.
    pub child: String,
    /// From the joint to the whole model.
    pub place: Matrix,
    /// Its axis in the whole model, of no particular length.
    pub axis: [f64; 3],
}

/// All links and joints of a model.
#[derive(Default)]
pub struct Tree<'a> {
    /// Links, each after those of the model it is in.
    pub links: Vec<Link<'a>>,
    /// Joints.
    pub joints: Vec<JointPlace<'a>>,
    /// Whether nothing of it moves.
    pub is_static: bool,
    frames: Vec<Frames>,
}

/// Reads a file and all that it includes, over any number of files.
pub fn texts(content: String, folder: &Folder) -> Result<Vec<Text>, Refusal> {
    let mut all = vec![Text { content, folder: folder.clone(), includes: BTreeMap::new() }];
    let mut by_path: BTreeMap<PathBuf, usize> = BTreeMap::new();
    let mut next = 0;
    while let Some(own) = all.get(next) {
        let own_folder = own.folder.clone();
        let document = parsed(&own.content)?;
        let includes = document.descendants().filter(|n| n.has_tag_name("include"));
        let uris: Vec<String> = includes.filter_map(|n| words(n, "uri").map(str::to_owned)).collect();
        drop(document);
        for uri in uris {
            let shown = crate::readers::folder::shortened(&uri);
            let path = uri::included(&own_folder, &uri);
            let path = path.ok_or_else(|| {
                format!("includes the model `{shown}`, which is not there or outside of its folder; read the folder that holds both")
            })?;
            let key = own_folder.resolve(&path).ok_or_else(|| format!("includes `{shown}`, which may not be read"))?;
            let index = match by_path.get(&key) {
                Some(index) => *index,
                None => {
                    if all.len() >= MAX_DOCUMENTS {
                        return Err(format!("includes more than {MAX_DOCUMENTS} models").into());
                    }
                    let content = text(&own_folder.read(&path, MAX_FILE_BYTES)?);
                    let folder = own_folder.of_named(&path).unwrap_or_else(|| own_folder.clone());
                    all.push(Text { content, folder, includes: BTreeMap::new() });
                    by_path.insert(key, all.len() - 1);
                    all.len() - 1
                }
            };
            if let Some(own) = all.get_mut(next) {
                own.includes.insert(uri, index);
            }
        }
        next += 1;
    }
    Ok(all)
}

/// Parses the files.
pub fn documents(texts: &[Text]) -> Result<Vec<Document<'_>>, Refusal> {
    texts.iter().map(|t| parsed(&t.content)).collect()
}

fn parsed(content: &str) -> Result<Document<'_>, Refusal> {
    let options = ParsingOptions { allow_dtd: false, nodes_limit: 1_000_000, ..ParsingOptions::default() };
    Ok(Document::parse_with_options(content, options).map_err(|e| format!("its XML cannot be read: {e}"))?)
}

/// Returns the model of a file.
pub fn model_of<'a>(document: &'a Document<'a>) -> Option<Node<'a, 'a>> {
    let root = document.root_element();
    if root.tag_name().name() == "model" { Some(root) } else { child(root, "model") }
}

/// Reads the first file as a model.
pub fn gather<'a>(
    texts: &'a [Text],
    documents: &'a [Document<'a>],
    visits: &'a Cell<usize>,
) -> Result<Tree<'a>, Refusal> {
    let mut tree = Tree::default();
    let model = documents.first().and_then(model_of).ok_or("has no model: worlds and lights are not read")?;
    tree.is_static = words(model, "static").is_some_and(is_true);
    let own = File { texts, documents, index: 0, visits };
    part(&mut tree, own, model, "", &Matrix::IDENTITY, 0)?;
    Ok(tree)
}

fn is_true(text: &str) -> bool {
    matches!(text, "1" | "true" | "True")
}

/// One of the files that a model is made of.
#[derive(Clone, Copy)]
struct File<'a> {
    texts: &'a [Text],
    documents: &'a [Document<'a>],
    index: usize,
    /// Visits so far.
    visits: &'a Cell<usize>,
}

/// A model in a model.
struct Inner<'a> {
    name: String,
    model: Node<'a, 'a>,
    /// The element whose pose and placement frame count: the model's own, or that of the include.
    posed: Node<'a, 'a>,
    /// Whether its links count as those of the model that includes it.
    merged: bool,
    file: File<'a>,
}

/// Adds the links and joints of a model; returns which frames are its own.
fn part<'a>(
    tree: &mut Tree<'a>,
    file: File<'a>,
    model: Node<'a, 'a>,
    scope: &str,
    place: &Matrix,
    depth: usize,
) -> Result<(), Refusal> {
    if depth > MAX_DEPTH {
        return Err(format!("its models are nested deeper than {MAX_DEPTH}, or include each other in a circle").into());
    }
    let inner = inner(file, model)?;
    let frames = frames(file, model, depth)?;
    let mine = tree.frames.len();
    let scoped = |name: &str| if scope.is_empty() { name.to_owned() } else { format!("{scope}::{name}") };
    let Some(own_folder) = file.texts.get(file.index).map(|t| &t.folder) else { return Ok(()) };
    for node in children(model, "link") {
        let Some(name) = node.attribute("name") else { continue };
        if tree.links.len() >= MAX_LINKS {
            return Err(format!("has more than {MAX_LINKS} links").into());
        }
        let place = *place * frames.place(name);
        tree.links.push(Link { name: scoped(name), node, place, folder: own_folder, part: mine });
    }
    for node in children(model, "joint") {
        let Some(name) = node.attribute("name") else { continue };
        let (Some(parent), Some(below)) = (words(node, "parent"), words(node, "child")) else { continue };
        let place = *place * frames.place(name);
        let parent = if parent == "world" { parent.to_owned() } else { scoped(parent) };
        let axis = axis(node, &frames, name, &place, version(file));
        tree.joints.push(JointPlace { name: scoped(name), node, parent, child: scoped(below), place, axis });
    }
    let places: Vec<Matrix> = inner.iter().map(|i| *place * frames.place(&i.name)).collect();
    tree.frames.push(frames);
    for (inner, place) in inner.into_iter().zip(places) {
        let scope = if inner.merged { scope.to_owned() } else { scoped(&inner.name) };
        part(tree, inner.file, inner.model, &scope, &place, depth + 1)?;
    }
    Ok(())
}

/// Returns the version of the format that a file is written in, such as 1.7.
fn version(file: File) -> f64 {
    let root = file.documents.get(file.index).map(|d| d.root_element());
    root.and_then(|r| r.attribute("version")).and_then(|v| v.trim().parse().ok()).unwrap_or(1.7)
}

/// Returns the axis of a joint in the whole model.
fn axis(node: Node, frames: &Frames, joint: &str, place: &Matrix, version: f64) -> [f64; 3] {
    let axis = child(node, "axis");
    let xyz = axis.and_then(|a| child(a, "xyz"));
    let direction = axis.and_then(|a| super::three(a, "xyz")).unwrap_or([0., 0., 1.]);
    let by_model = axis.and_then(|a| words(a, "use_parent_model_frame")).is_some_and(is_true) || version < 1.45;
    let model = *place * frames.place(joint).inverse().unwrap_or(Matrix::IDENTITY);
    let frame = match xyz.and_then(|x| x.attribute("expressed_in")).filter(|f| !f.is_empty()) {
        Some("__model__") => model,
        Some(other) => model * frames.place(other),
        None if by_model => model,
        None => *place,
    };
    let (from, to) = (frame.point([0.; 3]), frame.point(direction));
    std::array::from_fn(|i| to[i] - from[i])
}

/// Returns the models in a model.
fn inner<'a>(file: File<'a>, model: Node<'a, 'a>) -> Result<Vec<Inner<'a>>, Refusal> {
    file.visits.set(file.visits.get() + 1);
    if file.visits.get() > MAX_VISITS {
        return Err("has more models in it than any model has, or they include each other in a circle".into());
    }
    let mut all = Vec::new();
    for node in children(model, "model") {
        let name = node.attribute("name").unwrap_or_default().to_owned();
        all.push(Inner { name, model: node, posed: node, merged: false, file });
    }
    for node in children(model, "include") {
        let uri = words(node, "uri").ok_or("an include of it has no uri")?;
        let index = file.texts.get(file.index).and_then(|t| t.includes.get(uri)).copied();
        let found = index.and_then(|i| Some((i, model_of(file.documents.get(i)?)?)));
        let shown = crate::readers::folder::shortened(uri);
        let (index, model) = found.ok_or_else(|| format!("includes `{shown}`, which holds no model"))?;
        let name = words(node, "name").or(model.attribute("name")).unwrap_or_default().to_owned();
        let posed = if child(node, "pose").is_some() { node } else { model };
        let merged = node.attribute("merge").is_some_and(is_true);
        all.push(Inner { name, model, posed, merged, file: File { index, ..file } });
    }
    Ok(all)
}

/// Returns the frames of a model with those of the models in it.
fn frames<'a>(file: File<'a>, model: Node<'a, 'a>, depth: usize) -> Result<Frames, Refusal> {
    let mut frames = Frames::of(model);
    if depth > MAX_DEPTH {
        return Ok(frames);
    }
    for inner in inner(file, model)? {
        let below = self::frames(inner.file, inner.model, depth + 1)?;
        let by = words(inner.posed, "placement_frame").or(inner.posed.attribute("placement_frame"));
        let back = by.and_then(|frame| below.place(frame).inverse()).unwrap_or(Matrix::IDENTITY);
        frames.add_model(&inner.name, inner.posed, &back, below);
    }
    Ok(frames)
}

impl<'a> Tree<'a> {
    /// Returns the matrix from an element of a link, such as a visual, to the whole model.
    pub fn place(&self, link: &Link<'a>, element: Node) -> Matrix {
        let pose = self.frames.get(link.part).map(|f| f.pose(element, link.node.attribute("name")));
        link.place * pose.unwrap_or(Matrix::IDENTITY)
    }
}
