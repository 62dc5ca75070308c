//! glTF 2.0: GLB, and JSON with its buffers in files or in the text itself.
//!
//! y is up and the unit is a meter by the format. Geometry is where the nodes of the default scene put it, at rest: skins
//! and animations are noted, not played.

pub use self::accessor::decoded;

mod accessor;
mod document;

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_mesh::Material as Surface;

use self::accessor::Buffers;
use self::document::{Document, Node, Primitive};
use super::builder::{Builder, Piece, fan};
use super::facts::{Feature, ReadModel, Refusal, TextureFact};
use super::folder::Folder;
use super::frame::{Extent, Matrix};
use super::{Reader, Source};

/// The most visits of nodes.
const MAX_VISITS: usize = 200_000;
/// Extensions that a file may require: they change nothing that is read, or are read.
const UNDERSTOOD: &[&str] =
    &["KHR_mesh_quantization", "EXT_meshopt_compression", "EXT_mesh_gpu_instancing", "KHR_node_visibility"];
/// Beginnings of names of extensions that only change surfaces, lights and the like.
const HARMLESS: &[&str] = &[
    "KHR_materials_",
    "KHR_texture_",
    "KHR_lights_",
    "KHR_xmp",
    "KHR_animation_",
    "KHR_accessor_float64",
    "EXT_texture_",
    "EXT_lights_",
    "MSFT_texture_",
    "ADOBE_materials_",
    "KHR_audio",
    "EXT_materials_",
];

/// Reads glTF.
pub struct Gltf;

impl Reader for Gltf {
    fn name(&self) -> &'static str {
        "gltf"
    }

    fn endings(&self) -> &'static [&'static str] {
        &["glb", "gltf", "vrm"]
    }

    fn recognizes(&self, head: &[u8], ending: &str) -> bool {
        let text = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).trim_ascii_start();
        head.starts_with(b"glTF") || matches!(ending, "gltf" | "glb") && text.starts_with(b"{")
    }

    fn read(&self, source: &Source) -> Result<ReadModel, Refusal> {
        let (document, binary) = parsed(source.bytes)?;
        let mut builder = Builder::new(if source.bytes.starts_with(b"glTF") { "glb" } else { "gltf" });
        let mut buffers = Buffers::new(&document, binary, source.folder);
        let result = builder.set_frame(("Y", true), (1.0, true));
        let result = result.and_then(|()| fill(&mut builder, &document, &mut buffers, &Matrix::IDENTITY, 0));
        match result {
            Ok(()) => builder.finish(&source.name),
            Err(refusal) => Err(builder.refuse(refusal)),
        }
    }
}

/// Reads a glTF file into a body of a builder whose z is up, put in place by a matrix: y of the file becomes z.
pub fn fill_into(
    builder: &mut Builder,
    bytes: &[u8],
    folder: &Folder,
    place: &Matrix,
    body: usize,
) -> Result<(), Refusal> {
    let (document, binary) = parsed(bytes)?;
    let mut buffers = Buffers::new(&document, binary, folder);
    fill(builder, &document, &mut buffers, &(*place * Matrix::zup_from(Some("Y"))), body)
}

fn parsed(bytes: &[u8]) -> Result<(Document, Option<&[u8]>), Refusal> {
    let (json, binary) = chunks(bytes)?;
    let document: Document =
        serde_json::from_slice(json.trim_ascii_end()).map_err(|e| format!("its JSON is not that of glTF 2.0: {e}"))?;
    if !document.asset.version.starts_with("2.") {
        return Err(format!("is glTF {}, only 2.0 is read", super::folder::shortened(&document.asset.version)).into());
    }
    Ok((document, binary))
}

/// Returns the JSON and the binary chunk.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), Refusal> {
    if !bytes.starts_with(b"glTF") {
        return Ok((bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), None));
    }
    let word = |at: usize| {
        bytes.get(at..at + 4).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes).ok_or("its GLB header is cut off")
    };
    let version = word(4)?;
    if version != 2 {
        return Err(format!("is GLB version {version}, only 2 is read").into());
    }
    if word(8)? as usize > bytes.len() {
        return Err(format!("says that it has {} bytes and has {}: it is cut off", word(8)?, bytes.len()).into());
    }
    let chunk = |at: usize| -> Result<(&[u8], &[u8], usize), Refusal> {
        let end = (word(at)? as usize).checked_add(at + 8);
        let end = end.filter(|e| *e <= bytes.len()).ok_or("a chunk of it is longer than the file: it is cut off")?;
        Ok((&bytes[at + 4..at + 8], &bytes[at + 8..end], end))
    };
    let (kind, json, mut next) = chunk(12)?;
    if kind != b"JSON" {
        return Err("its first chunk is not JSON".into());
    }
    while next + 8 <= bytes.len() {
        let (kind, content, end) = chunk(next)?;
        if kind == b"BIN\0" {
            return Ok((json, Some(content)));
        }
        next = end;
    }
    Ok((json, None))
}

fn fill(
    builder: &mut Builder,
    document: &Document,
    buffers: &mut Buffers,
    place: &Matrix,
    body: usize,
) -> Result<(), Refusal> {
    let places = places(document, place)?;
    let first = builder.materials.len();
    note(builder, document, buffers, &places)?;
    let unknown: Vec<&str> =
        document.extensions_required.iter().map(String::as_str).filter(|e| !understood(e)).collect();
    surfaces(builder, document, buffers);
    if !unknown.is_empty() {
        corners(builder, document, &places);
        let names = super::folder::shortened(&unknown.join(", "));
        let hint = if unknown.contains(&"KHR_draco_mesh_compression") {
            "; Draco is not decoded: convert it without (gltf-transform copy)"
        } else {
            ""
        };
        return Err(format!("needs extensions that are not read: {names}{hint}").into());
    }
    for (node, place) in places {
        let Some(mesh) = node.mesh.and_then(|m| document.meshes.get(m)) else { continue };
        if !builder.wants(&[&node.name, &mesh.name].map(|n| n.as_deref().unwrap_or_default())) {
            continue;
        }
        for primitive in &mesh.primitives {
            let name = mesh.name.as_deref().unwrap_or_default();
            add(builder, buffers, primitive, (name, body, first), &place)?;
        }
    }
    Ok(())
}

fn understood(name: &str) -> bool {
    UNDERSTOOD.contains(&name) || HARMLESS.iter().any(|h| name.starts_with(h))
}

/// Returns the nodes of the scene that have a mesh, each with where it is.
fn places<'d>(document: &'d Document, place: &Matrix) -> Result<Vec<(&'d Node, Matrix)>, Refusal> {
    let roots: Vec<usize> = if document.scenes.is_empty() {
        let children: BTreeSet<usize> = document.nodes.iter().flat_map(|n| n.children.iter().copied()).collect();
        (0..document.nodes.len()).filter(|i| !children.contains(i)).collect()
    } else {
        let scene = document.scenes.get(document.scene.unwrap_or(0)).ok_or("its default scene is not there")?;
        scene.nodes.clone()
    };
    let mut out = Vec::new();
    let mut visits = 0;
    let mut open: Vec<(usize, Matrix, usize)> = roots.into_iter().rev().map(|i| (i, *place, 0)).collect();
    while let Some((index, parent, depth)) = open.pop() {
        visits += 1;
        if depth > document.nodes.len() {
            return Err("its nodes go round in a circle".into());
        }
        if visits > MAX_VISITS {
            return Err(format!("its scene has more than {MAX_VISITS} nodes").into());
        }
        let node = document.nodes.get(index).ok_or_else(|| format!("names node {index}, which is not there"))?;
        let place = parent * node.matrix()?;
        if let Some(mesh) = node.mesh {
            if mesh >= document.meshes.len() {
                return Err(format!("names mesh {mesh}, which is not there").into());
            }
            out.push((node, place));
        }
        open.extend(node.children.iter().rev().map(|c| (*c, place, depth + 1)));
    }
    Ok(out)
}

fn note(
    builder: &mut Builder,
    document: &Document,
    buffers: &Buffers,
    places: &[(&Node, Matrix)],
) -> Result<(), Refusal> {
    let facts = &mut builder.facts;
    let used: BTreeSet<usize> = places.iter().filter_map(|(n, _)| n.mesh).collect();
    facts.mesh_count += places.len() as u64;
    let (mut skinned, mut morphs) = (0, 0);
    for (node, _) in places {
        skinned += u64::from(node.skin.is_some());
        for primitive in node.mesh.and_then(|m| document.meshes.get(m)).map_or(&[][..], |m| &m.primitives) {
            morphs += u64::from(!primitive.targets.is_empty());
            let count = |index: usize| buffers.accessor(index).map(|a| a.count);
            let corners = match (primitive.indices, primitive.attributes.get("POSITION")) {
                (Some(index), _) | (None, Some(&index)) => count(index)?,
                (None, None) => 0,
            };
            facts.triangle_count += match primitive.mode.unwrap_or(4) {
                4 => corners as u64 / 3,
                5 | 6 => corners.saturating_sub(2) as u64,
                _ => 0,
            };
        }
    }
    let primitives = || document.meshes.iter().flat_map(|m| &m.primitives);
    if document.extensions_used.iter().any(|e| e == "EXT_mesh_gpu_instancing") {
        facts.warn("repeats meshes by EXT_mesh_gpu_instancing; each is read once");
    }
    let flag = |f: bool| Feature::Flag(f);
    facts.feature("animated", Feature::Count(document.animations.len() as u64));
    facts.feature("skel", flag(!document.skins.is_empty()));
    facts.feature("skinned_meshes", Feature::Count(skinned));
    facts.feature("morph_targets", Feature::Count(morphs));
    facts.feature("cameras", Feature::Count(document.cameras.len() as u64));
    facts.feature("extensionsUsed", Feature::Names(document.extensions_used.clone()));
    facts.feature("extensionsRequired", Feature::Names(document.extensions_required.clone()));
    if let Some(generator) = &document.asset.generator {
        facts.feature("generator", Feature::Text(generator.chars().take(200).collect()));
    }
    facts.feature("scenes", Feature::Count(document.scenes.len() as u64));
    facts.feature("default_scene", flag(document.scene.is_some()));
    facts.feature("meshes_without_normals", flag(primitives().any(|p| !p.attributes.contains_key("NORMAL"))));
    facts.feature("non_indexed", flag(primitives().any(|p| p.indices.is_none())));
    facts.feature("vertex_colors", flag(primitives().any(|p| p.attributes.contains_key("COLOR_0"))));
    let mirrored = document.nodes.iter().filter_map(|n| n.matrix().ok()).any(|m| m.determinant() < 0.0);
    facts.feature("negative_scale", flag(mirrored));
    facts.feature("instanced_meshes", flag(places.len() > used.len()));
    let worn: BTreeSet<usize> = used
        .iter()
        .filter_map(|m| document.meshes.get(*m))
        .flat_map(|m| m.primitives.iter().filter_map(|p| p.material))
        .collect();
    let mut names = BTreeSet::new();
    for index in worn {
        let material =
            document.materials.get(index).ok_or_else(|| format!("names material {index}, which is not there"))?;
        names.insert(material.name.clone().filter(|n| !n.is_empty()).unwrap_or_else(|| format!("#{index}")));
        facts.diffuse_colors.push(material.color());
    }
    names.extend(std::mem::take(&mut facts.material_names));
    facts.material_names = names.into_iter().collect();
    Ok(())
}

fn surfaces(builder: &mut Builder, document: &Document, buffers: &mut Buffers) {
    let mut pictures = BTreeMap::new();
    for (index, image) in document.images.iter().enumerate() {
        let inside = image.buffer_view.is_some();
        let data = image.uri.as_deref().is_some_and(|u| u.starts_with("data:"));
        let path = if data { Some("data:".to_owned()) } else { image.uri.clone() };
        let name = match (&image.uri, inside || data) {
            (Some(uri), false) => uri.clone(),
            _ => format!("{index}.{}", image.mime_type.as_deref().and_then(|m| m.split('/').nth(1)).unwrap_or("png")),
        };
        let picture = builder.picture_with(&name, |most| buffers.image(image, most));
        let resolves = inside || data || image.uri.as_deref().is_some_and(|u| buffers.is_there(u));
        if !resolves {
            builder.facts.warn(format!("picture {index} is not there: {}", super::folder::shortened(&name)));
        }
        builder.facts.textures.push(TextureFact { path, resolves, embedded: Some((image.mime_type.clone(), inside)) });
        pictures.insert(index, picture);
    }
    for (index, material) in document.materials.iter().enumerate() {
        let texture = material.base_texture().and_then(|t| document.textures.get(t)).and_then(|t| t.image());
        builder.materials.push(Surface {
            name: material.name.clone().filter(|n| !n.is_empty()).unwrap_or_else(|| format!("#{index}")),
            base_color: material.shown_color().map(|v| v as f32),
            opacity: material.opacity() as f32,
            metallic: material.pbr.metallic.unwrap_or(1.0) as f32,
            roughness: material.pbr.roughness.unwrap_or(1.0) as f32,
            emissive: material.emissive.unwrap_or_default().map(|v| v as f32),
            texture: texture.and_then(|t| pictures.get(&t).copied()),
            finish: None,
        });
    }
}

/// Takes the boxes that the accessors claim, for a file whose corners cannot be read.
fn corners(builder: &mut Builder, document: &Document, places: &[(&Node, Matrix)]) {
    for (node, place) in places {
        for primitive in node.mesh.and_then(|m| document.meshes.get(m)).map_or(&[][..], |m| &m.primitives) {
            let accessor = primitive.attributes.get("POSITION").and_then(|a| document.accessors.get(*a));
            if let Some(bounds) = accessor.and_then(|a| a.claimed()) {
                builder.extent.add_box(bounds, place);
            }
        }
    }
}

fn add(
    builder: &mut Builder,
    buffers: &mut Buffers,
    primitive: &Primitive,
    (name, body, first): (&str, usize, usize),
    place: &Matrix,
) -> Result<(), Refusal> {
    let Some(&position) = primitive.attributes.get("POSITION") else { return Ok(()) };
    let positions: Vec<[f32; 3]> = buffers.floats(position)?;
    let mut own = Extent::default();
    for point in &positions {
        let point = point.map(f64::from);
        own.add(point);
        builder.extent.add(place.point(point));
    }
    let claimed = buffers.document().accessors.get(position).and_then(|a| a.claimed());
    if let (Some(claimed), Some(found)) = (claimed, own.scaled(1.0)) {
        let size = (0..3).map(|i| found[1][i] - found[0][i]).fold(0.0, f64::max);
        let off = (0..6).map(|i| (claimed[i / 3][i % 3] - found[i / 3][i % 3]).abs()).fold(0.0, f64::max);
        if off > 0.01 * size.max(1e-6) {
            builder.facts.warn("says another box of its corners than they have");
        }
    }
    let mode = primitive.mode.unwrap_or(4);
    if !matches!(mode, 4..=6) {
        return Ok(());
    }
    let corners: Vec<u32> = match primitive.indices {
        Some(index) => buffers.indices(index)?,
        None => (0..positions.len() as u32).collect(),
    };
    let triangles = match mode {
        4 => corners.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
        5 => {
            let strip = corners.windows(3).enumerate();
            strip.map(|(i, t)| if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] }).collect()
        }
        _ => fan(&corners).collect(),
    };
    // glTF counts v from above.
    let uvs = match primitive.attributes.get("TEXCOORD_0") {
        Some(&index) => buffers.floats::<2>(index).unwrap_or_default().into_iter().map(|[u, v]| [u, 1.0 - v]).collect(),
        None => Vec::new(),
    };
    let material = primitive.material.map(|m| first + m);
    builder.add(body, Piece { name: name.to_owned(), positions, uvs, triangles, material }, place)
}
