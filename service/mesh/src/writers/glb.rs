//! glTF 2.0 as one binary file: a node a body, at its joint, so that it can be turned; y up, front along +z.

mod world;

use std::collections::BTreeMap;

use serde_json::{Map, Value, json};

pub use world::world_glb;

use super::{check, picture_extension, plain};
use crate::affine::{Vec3, sub};
use crate::error::Error;
use crate::finish::Finish;
use crate::model3d::{Body, Joint, JointKind, Material, Model3d, Texture, Visual};

const ARRAY_BUFFER: u32 = 34_962;
const ELEMENT_ARRAY_BUFFER: u32 = 34_963;
const FLOAT: u32 = 5_126;
const UNSIGNED_SHORT: u32 = 5_123;
const UNSIGNED_INT: u32 = 5_125;
const REPEAT: u32 = 10_497;

/// Returns the file.
///
/// # Errors
/// `Model` when the model is broken.
pub fn glb(model: &Model3d) -> Result<Vec<u8>, Error> {
    check(model)?;
    let mut file = File::default();
    let materials = plain(&model.materials);
    file.materials(&materials, &model.textures);
    let mut nodes = vec![json!({"name": model.name})];
    for (b, body) in model.bodies.iter().enumerate() {
        let joint = joint_of(model, b);
        let pivot = joint.map_or([0.0; 3], |j| j.origin);
        let parent = joint.map_or([0.0; 3], |j| joint_of(model, j.parent).map_or([0.0; 3], |p| p.origin));
        let mut node = Map::new();
        node.insert("name".into(), body.name.clone().into());
        if let Some(mesh) = file.mesh(&body.name, &body.visuals, &materials, pivot) {
            node.insert("mesh".into(), mesh.into());
        }
        let way = y_up(sub(pivot, parent));
        if way != [0.0; 3] {
            node.insert("translation".into(), json!(way));
        }
        let children: Vec<usize> = model.joints.iter().filter(|j| j.parent == b).map(|j| j.child + 1).collect();
        if !children.is_empty() {
            node.insert("children".into(), json!(children));
        }
        node.insert("extras".into(), extras(body, joint));
        nodes.push(node.into());
    }
    let roots: Vec<usize> = (0..model.bodies.len()).filter(|b| joint_of(model, *b).is_none()).map(|b| b + 1).collect();
    nodes[0]["children"] = json!(roots);
    Ok(file.finish(json!({
        "asset": {"version": "2.0", "generator": "d3dgen"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": nodes,
    })))
}

fn joint_of(model: &Model3d, body: usize) -> Option<&Joint> {
    model.joints.iter().find(|j| j.child == body)
}

/// Returns what glTF has no word for: the mass and how the body moves.
fn extras(body: &Body, joint: Option<&Joint>) -> Value {
    let mut extras = json!({"mass_kg": body.mass_kg});
    if let Some(joint) = joint {
        let (kind, unit) = match joint.kind {
            JointKind::Revolute => ("revolute", "rad"),
            JointKind::Prismatic => ("prismatic", "m"),
            JointKind::Continuous => ("continuous", "rad"),
        };
        let mut value = json!({"name": joint.name, "kind": kind, "axis": y_up(joint.axis)});
        if let Some(limits) = joint.limits {
            value[format!("limits_{unit}")] = json!(limits);
        }
        extras["joint"] = value;
    }
    extras
}

/// Puts a vector of ours (z up, front -y) into the frame of glTF (y up, front +z).
fn y_up([x, y, z]: Vec3) -> Vec3 {
    [x, z, -y].map(|v| v + 0.0)
}

#[derive(Default)]
struct File {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    meshes: Vec<Value>,
    materials: Vec<Value>,
    images: Vec<Value>,
    textures: Vec<Value>,
    /// Textures of pictures that are there already: pictures of models by index, those of finishes by name.
    pictures: BTreeMap<String, usize>,
}

impl File {
    /// Returns the whole file; `root` has asset, scenes, nodes and what else is not of meshes.
    fn finish(mut self, mut root: Value) -> Vec<u8> {
        if !self.textures.is_empty() {
            root["samplers"] = json!([{"wrapS": REPEAT, "wrapT": REPEAT}]);
        }
        let lists = [
            ("meshes", std::mem::take(&mut self.meshes)),
            ("materials", std::mem::take(&mut self.materials)),
            ("textures", std::mem::take(&mut self.textures)),
            ("images", std::mem::take(&mut self.images)),
            ("accessors", std::mem::take(&mut self.accessors)),
            ("bufferViews", std::mem::take(&mut self.views)),
        ];
        for (key, list) in lists {
            if !list.is_empty() {
                root[key] = Value::Array(list);
            }
        }
        if !self.bytes.is_empty() {
            root["buffers"] = json!([{"byteLength": self.bytes.len()}]);
        }
        container(&root, self.bytes)
    }

    fn materials(&mut self, materials: &[Material], textures: &[Texture]) {
        for material in materials {
            let value = self.material(material, textures);
            self.materials.push(value);
        }
    }

    fn material(&mut self, material: &Material, textures: &[Texture]) -> Value {
        let own = material.texture.and_then(|t| Some((t, textures.get(t)?.bytes.as_deref()?)));
        let own = own.and_then(|(t, bytes)| self.picture(&format!("{t}"), bytes));
        let worn = material.worn();
        let [r, g, b] = if own.is_some() { [1.0; 3] } else { material.factor().map(|v| round(f64::from(v))) };
        let mut surface = json!({
            "baseColorFactor": [r, g, b, round(f64::from(material.opacity))],
            "metallicFactor": round(f64::from(material.metallic)),
            "roughnessFactor": round(f64::from(material.roughness)),
        });
        let color = own.or_else(|| worn.and_then(|f| self.picture(&f.id, &f.pictures().color)));
        if let Some(texture) = color {
            surface["baseColorTexture"] = json!({"index": texture});
        }
        let mut value = json!({"name": material.name, "pbrMetallicRoughness": surface});
        let normal = worn.and_then(|f| Some((f, f.pictures().normal.as_ref()?)));
        if let Some((finish, bytes)) = normal
            && let Some(texture) = self.picture(&format!("{}_normal", finish.id), bytes)
        {
            value["normalTexture"] = json!({"index": texture});
        }
        if material.emissive != [0.0; 3] {
            value["emissiveFactor"] = json!(material.emissive.map(|v| round(f64::from(v).clamp(0.0, 1.0))));
        }
        if material.opacity < 1.0 {
            value["alphaMode"] = "BLEND".into();
        }
        value
    }

    /// Returns the texture of a picture, which it adds when it is not there yet; none when glTF cannot hold it.
    fn picture(&mut self, key: &str, bytes: &[u8]) -> Option<usize> {
        if let Some(index) = self.pictures.get(key) {
            return Some(*index);
        }
        let mime = if picture_extension(bytes)? == "png" { "image/png" } else { "image/jpeg" };
        let view = self.view(bytes, None);
        self.images.push(json!({"bufferView": view, "mimeType": mime}));
        self.textures.push(json!({"sampler": 0, "source": self.images.len() - 1}));
        self.pictures.insert(key.to_owned(), self.textures.len() - 1);
        Some(self.textures.len() - 1)
    }

    /// Adds a mesh with its corners counted from the pivot; none when nothing is seen.
    fn mesh(&mut self, name: &str, visuals: &[Visual], materials: &[Material], pivot: Vec3) -> Option<usize> {
        let mut primitives = Vec::new();
        for visual in visuals.iter().filter(|v| !v.mesh.triangles.is_empty()) {
            let mesh = &visual.mesh;
            let place = |p: &[f32; 3]| y_up(sub(p.map(f64::from), pivot)).map(|v| v as f32);
            let positions: Vec<[f32; 3]> = mesh.positions.iter().map(place).collect();
            let mut attributes = json!({"POSITION": self.positions(&positions)});
            if !mesh.normals.is_empty() {
                let normals: Vec<[f32; 3]> =
                    mesh.normals.iter().map(|v| y_up(v.map(f64::from)).map(|v| v as f32)).collect();
                attributes["NORMAL"] = self.floats(&normals, "VEC3").into();
            }
            let material = visual.material.and_then(|m| materials.get(m));
            let worn = material.and_then(Material::worn);
            let textured = worn.is_some() || material.is_some_and(|m| m.texture.is_some());
            if textured && !mesh.uvs.is_empty() {
                let [width, height] = worn.map_or([1.0; 2], in_pictures);
                let flipped: Vec<[f32; 2]> = mesh.uvs.iter().map(|[u, v]| [u / width, 1.0 - v / height]).collect();
                attributes["TEXCOORD_0"] = self.floats(&flipped, "VEC2").into();
            }
            let mut primitive =
                json!({"attributes": attributes, "indices": self.indices(&mesh.triangles, positions.len())});
            if let Some(material) = visual.material {
                primitive["material"] = material.into();
            }
            primitives.push(primitive);
        }
        if primitives.is_empty() {
            return None;
        }
        self.meshes.push(json!({"name": name, "primitives": primitives}));
        Some(self.meshes.len() - 1)
    }

    fn positions(&mut self, list: &[[f32; 3]]) -> usize {
        let accessor = self.floats(list, "VEC3");
        let bound = |pick: fn(f32, f32) -> f32, start: f32| -> [f32; 3] {
            list.iter().fold([start; 3], |sum, p| std::array::from_fn(|i| pick(sum[i], p[i])))
        };
        self.accessors[accessor]["min"] = json!(bound(f32::min, f32::MAX));
        self.accessors[accessor]["max"] = json!(bound(f32::max, f32::MIN));
        accessor
    }

    /// Adds an attribute of corners.
    fn floats<const N: usize>(&mut self, list: &[[f32; N]], kind: &str) -> usize {
        self.list(list, kind, Some(ARRAY_BUFFER))
    }

    /// Adds values of an animation.
    fn values<const N: usize>(&mut self, list: &[[f32; N]], kind: &str) -> usize {
        self.list(list, kind, None)
    }

    fn list<const N: usize>(&mut self, list: &[[f32; N]], kind: &str, target: Option<u32>) -> usize {
        let bytes: Vec<u8> = list.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
        let view = self.view(&bytes, target);
        self.accessors.push(json!({"bufferView": view, "componentType": FLOAT, "count": list.len(), "type": kind}));
        self.accessors.len() - 1
    }

    fn indices(&mut self, triangles: &[[u32; 3]], corners: usize) -> usize {
        let (kind, bytes): (u32, Vec<u8>) = if corners < usize::from(u16::MAX) {
            (UNSIGNED_SHORT, triangles.iter().flatten().flat_map(|i| (*i as u16).to_le_bytes()).collect())
        } else {
            (UNSIGNED_INT, triangles.iter().flatten().flat_map(|i| i.to_le_bytes()).collect())
        };
        let view = self.view(&bytes, Some(ELEMENT_ARRAY_BUFFER));
        let count = triangles.len() * 3;
        self.accessors.push(json!({"bufferView": view, "componentType": kind, "count": count, "type": "SCALAR"}));
        self.accessors.len() - 1
    }

    fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut view = json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()});
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.bytes.extend(bytes);
        self.views.push(view);
        self.views.len() - 1
    }
}

/// Returns header, JSON chunk and binary chunk.
fn container(root: &Value, mut binary: Vec<u8>) -> Vec<u8> {
    let mut text = root.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    binary.resize(binary.len().next_multiple_of(4), 0);
    let tail = if binary.is_empty() { 0 } else { 8 + binary.len() };
    let mut out = Vec::with_capacity(20 + text.len() + tail);
    for v in [0x4654_6c67, 2, (20 + text.len() + tail) as u32, text.len() as u32, 0x4e4f_534a] {
        out.extend(v.to_le_bytes());
    }
    out.extend(text);
    if !binary.is_empty() {
        for v in [binary.len() as u32, 0x004e_4942] {
            out.extend(v.to_le_bytes());
        }
        out.extend(binary);
    }
    out
}

/// Returns what texture coordinates in m are divided by.
fn in_pictures(finish: &Finish) -> [f32; 2] {
    finish.size_m.map(|v| v as f32)
}

fn round(v: f64) -> f64 {
    (v * 1e6).round() / 1e6
}
