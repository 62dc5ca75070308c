//! SDF model folders: links with their poses and joints, meshes with their scale, and simple shapes.
//!
//! Meshes are taken as Gazebo takes them: in the axes of their files, whatever those say is up. The pose of the model
//! itself says where it stands in a world and is left aside.

mod frames;

use std::collections::BTreeMap;

use d3dgen_mesh::{Joint, JointKind, Material};
use roxmltree::{Document, Node, ParsingOptions};

use self::frames::Frames;
use super::builder::{Builder, Piece, identifier};
use super::facts::{Feature, ReadModel, Refusal};
use super::folder::{Folder, MAX_FILE_BYTES};
use super::frame::{Extent, Matrix};
use super::usd::{Triangles, cuboid, turned_solid};
use super::{Reader, Source};

/// The most visuals of a model.
const MAX_VISUALS: usize = 4_000;

/// Reads SDF.
pub struct Sdf;

impl Reader for Sdf {
    fn name(&self) -> &'static str {
        "sdf"
    }

    fn endings(&self) -> &'static [&'static str] {
        &["sdf"]
    }

    fn recognizes(&self, head: &[u8], ending: &str) -> bool {
        head.windows(4).any(|w| w == b"<sdf") && head.trim_ascii_start().starts_with(b"<")
            || ending == "sdf" && head.windows(6).any(|w| w == b"<model")
    }

    fn read(&self, source: &Source) -> Result<ReadModel, Refusal> {
        let mut builder = Builder::new("sdf");
        match fill(&mut builder, source) {
            Ok(name) => builder.finish(std::path::Path::new(&name)),
            Err(refusal) => Err(builder.refuse(refusal)),
        }
    }
}

/// Returns bytes as text: UTF-8, or UTF-16 with its mark.
pub fn text(bytes: &[u8]) -> String {
    let units = |read: fn([u8; 2]) -> u16| -> String {
        let units: Vec<u16> = bytes.chunks_exact(2).skip(1).map(|b| read([b[0], b[1]])).collect();
        String::from_utf16_lossy(&units)
    };
    match bytes {
        [0xff, 0xfe, ..] => units(u16::from_le_bytes),
        [0xfe, 0xff, ..] => units(u16::from_be_bytes),
        _ => String::from_utf8_lossy(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)).into_owned(),
    }
}

fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|c| c.tag_name().name() == name)
}

fn children<'a, 'i>(node: Node<'a, 'i>, name: &'static str) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(move |c| c.tag_name().name() == name)
}

fn words<'a>(node: Node<'a, '_>, name: &str) -> Option<&'a str> {
    child(node, name).and_then(|c| c.text()).map(str::trim).filter(|t| !t.is_empty())
}

fn numbers(text: &str) -> Vec<f64> {
    text.split_whitespace().filter_map(|w| w.parse().ok()).collect()
}

fn number(node: Node, name: &str) -> Option<f64> {
    words(node, name).and_then(|t| t.parse().ok())
}

fn three(node: Node, name: &str) -> Option<[f64; 3]> {
    words(node, name).map(numbers).and_then(|n| n.get(..3)?.try_into().ok())
}

fn fill(builder: &mut Builder, source: &Source) -> Result<String, Refusal> {
    let text = text(source.bytes);
    let options = ParsingOptions { allow_dtd: false, nodes_limit: 1_000_000, ..ParsingOptions::default() };
    let document = Document::parse_with_options(&text, options).map_err(|e| format!("its XML cannot be read: {e}"))?;
    let root = document.root_element();
    let model = if root.tag_name().name() == "model" { Some(root) } else { child(root, "model") };
    let model = model.ok_or("has no model: worlds and lights are not read")?;
    builder.set_frame(("Z", true), (1.0, true))?;
    let name = model.attribute("name").unwrap_or_default().trim().to_owned();
    for part in ["include", "model"] {
        if child(model, part).is_some() {
            builder.facts.warn(format!("has an `{part}` in its model, which is left out"));
        }
    }
    if words(model, "pose").is_some_and(|p| numbers(p).iter().any(|v| *v != 0.0)) {
        builder.facts.warn("its model has a pose, which is where it stands in a world and is left aside");
    }
    let frames = Frames::of(model);
    let bodies = bodies(builder, model, &frames);
    let mut visuals = 0;
    for link in children(model, "link") {
        let Some(&body) = link.attribute("name").and_then(|n| bodies.get(n)) else { continue };
        let place = frames.link(link.attribute("name").unwrap_or_default());
        for visual in children(link, "visual") {
            visuals += 1;
            if visuals > MAX_VISUALS {
                return Err(format!("has more than {MAX_VISUALS} visuals").into());
            }
            let place = place * frames.pose(visual, link.attribute("name"));
            shape(builder, source.folder, visual, &place, body)?;
        }
    }
    builder.facts.feature("links", Feature::Count(children(model, "link").count() as u64));
    builder.facts.feature("visuals", Feature::Count(visuals as u64));
    Ok(if name.is_empty() { "model".into() } else { name.replace('.', "_") })
}

/// Makes a body of each link, and joints between them; a link that is fixed to another is part of its body.
fn bodies(builder: &mut Builder, model: Node, frames: &Frames) -> BTreeMap<String, usize> {
    let mut fixed: BTreeMap<&str, &str> = BTreeMap::new();
    let joints: Vec<Node> = children(model, "joint").collect();
    for joint in joints.iter().filter(|j| j.attribute("type") == Some("fixed")) {
        if let (Some(parent), Some(child)) = (words(*joint, "parent"), words(*joint, "child"))
            && parent != "world"
        {
            fixed.insert(child, parent);
        }
    }
    let links: Vec<&str> = children(model, "link").filter_map(|l| l.attribute("name")).collect();
    let mut bodies: BTreeMap<String, usize> = BTreeMap::new();
    let mut first = true;
    for link in children(model, "link") {
        let Some(name) = link.attribute("name") else { continue };
        if fixed.get(name).is_some_and(|parent| links.contains(parent)) || bodies.contains_key(name) {
            continue;
        }
        let mass = child(link, "inertial").and_then(|i| number(i, "mass")).filter(|m| m.is_finite() && *m > 0.0);
        let label = identifier(name, "link");
        let index = if std::mem::take(&mut first) { 0 } else { builder.body(&label) };
        builder.set_body(index, &label, mass.unwrap_or(0.0));
        bodies.insert(name.to_owned(), index);
    }
    for name in &links {
        // Over any number of fixed joints; a circle of them ends at the first body.
        let mut at = *name;
        for _ in 0..links.len() {
            match fixed.get(at) {
                Some(parent) if !bodies.contains_key(at) => at = parent,
                _ => break,
            }
        }
        let index = bodies.get(at).copied().unwrap_or(0);
        bodies.entry((*name).to_owned()).or_insert(index);
    }
    for joint in joints {
        builder.joints.extend(moving(joint, &bodies, frames));
    }
    bodies
}

fn moving(joint: Node, bodies: &BTreeMap<String, usize>, frames: &Frames) -> Option<Joint> {
    let kind = match joint.attribute("type")? {
        "revolute" => JointKind::Revolute,
        "continuous" => JointKind::Continuous,
        "prismatic" => JointKind::Prismatic,
        _ => return None,
    };
    let index = |name: &str| bodies.get(words(joint, name)?).copied();
    let (parent, below) = (index("parent")?, index("child")?);
    let name = joint.attribute("name")?;
    let place = frames.joint(name);
    let axis = child(joint, "axis");
    let direction = axis.and_then(|a| three(a, "xyz")).unwrap_or([0., 0., 1.]);
    let (from, to) = (place.point([0.; 3]), place.point(direction));
    let direction: [f64; 3] = std::array::from_fn(|i| to[i] - from[i]);
    let length = direction.iter().map(|v| v * v).sum::<f64>().sqrt();
    if parent == below || !length.is_finite() || length == 0.0 {
        return None;
    }
    let limit = axis.and_then(|a| child(a, "limit"));
    let bound = |name: &str| limit.and_then(|l| number(l, name)).filter(|v| v.abs() < 1e6);
    let limits = bound("lower").zip(bound("upper")).map(|(a, b)| [a, b]).filter(|_| kind != JointKind::Continuous);
    // Without limits a hinge turns without end.
    let kind = if kind == JointKind::Revolute && limits.is_none() { JointKind::Continuous } else { kind };
    let name = identifier(name, "joint");
    Some(Joint { name, kind, parent, child: below, origin: from, axis: direction.map(|v| v / length), limits })
}

fn shape(builder: &mut Builder, folder: &Folder, visual: Node, place: &Matrix, body: usize) -> Result<(), Refusal> {
    let Some(geometry) = child(visual, "geometry").and_then(|g| g.children().find(Node::is_element)) else {
        return Ok(());
    };
    if geometry.tag_name().name() == "mesh" {
        return mesh(builder, folder, geometry, place, body);
    }
    let radius = number(geometry, "radius").unwrap_or(0.5);
    let half = number(geometry, "length").unwrap_or(1.0) / 2.0;
    let solid = match geometry.tag_name().name() {
        "box" => Some(cuboid(three(geometry, "size").unwrap_or([1.0; 3]).map(|v| v / 2.0))),
        "cylinder" => Some(turned_solid(half, [radius; 2], false, 2)),
        "cone" => Some(turned_solid(half, [radius, 0.0], false, 2)),
        "capsule" => Some(turned_solid(half, [radius; 2], true, 2)),
        "sphere" => Some(turned_solid(0.0, [radius; 2], true, 2)),
        "ellipsoid" => {
            let radii = three(geometry, "radii").unwrap_or([1.0; 3]);
            let mut ball = turned_solid(0.0, [1.0; 2], true, 2);
            ball.positions.iter_mut().for_each(|p| *p = std::array::from_fn(|i| p[i] * radii[i] as f32));
            Some(ball)
        }
        "plane" => {
            let size = words(geometry, "size").map(numbers).unwrap_or_default();
            let side = |i: usize| size.get(i).copied().unwrap_or(1.0) / 2.0;
            Some(cuboid([side(0), side(1), 0.0]))
        }
        other => {
            builder.facts.warn(format!("a visual is a {}, which is not read", super::folder::shortened(other)));
            None
        }
    };
    let Some(Triangles { positions, uvs, triangles }) = solid else { return Ok(()) };
    builder.facts.mesh_count += 1;
    builder.facts.triangle_count += triangles.len() as u64;
    let mut own = Extent::default();
    positions.iter().for_each(|p| own.add(p.map(f64::from)));
    if let Some(bounds) = own.scaled(1.0) {
        builder.extent.add_box(bounds, place);
    }
    let material = child(visual, "material").map(|m| surface(builder, m, visual.attribute("name")));
    let name = visual.attribute("name").unwrap_or("visual").to_owned();
    builder.add(body, Piece { name, positions, uvs, triangles, material }, place)
}

fn surface(builder: &mut Builder, material: Node, name: Option<&str>) -> usize {
    let color = words(material, "diffuse").map(numbers).unwrap_or_default();
    let part = |i: usize, fallback: f64| color.get(i).copied().unwrap_or(fallback).clamp(0.0, 1.0);
    let base = [part(0, 0.8), part(1, 0.8), part(2, 0.8)];
    let name = name.unwrap_or("visual").to_owned();
    if color.len() >= 3 {
        builder.facts.diffuse_colors.push(base);
    }
    builder.facts.material_names.push(name.clone());
    builder.facts.material_names.sort();
    builder.facts.material_names.dedup();
    let emissive = words(material, "emissive").map(numbers).unwrap_or_default();
    builder.materials.push(Material {
        name,
        base_color: base.map(|v| v as f32),
        opacity: part(3, 1.0) as f32,
        emissive: std::array::from_fn(|i| emissive.get(i).copied().unwrap_or(0.0).clamp(0.0, 1.0) as f32),
        ..Material::default()
    });
    builder.materials.len() - 1
}

fn mesh(builder: &mut Builder, folder: &Folder, geometry: Node, place: &Matrix, body: usize) -> Result<(), Refusal> {
    let uri = words(geometry, "uri").ok_or("a mesh of it has no uri")?;
    if child(geometry, "submesh").is_some() {
        builder.facts.warn("a visual names a part of a mesh; the whole mesh is read");
    }
    let path = located(folder, uri).ok_or_else(|| {
        format!("names the mesh `{}`, which is not there or outside of its folder", super::folder::shortened(uri))
    })?;
    let bytes = folder.read(&path, MAX_FILE_BYTES)?;
    let inner = folder.of_named(&path).unwrap_or_else(|| folder.clone());
    let place = *place * Matrix::scale(three(geometry, "scale").unwrap_or([1.0; 3]));
    let ending = path.rsplit_once('.').map(|(_, e)| e.to_ascii_lowercase()).unwrap_or_default();
    let result = match ending.as_str() {
        "dae" => super::dae::fill(builder, &bytes, &inner, &place, body),
        "obj" => super::obj::fill(builder, &bytes, &inner, &place, body),
        "stl" => super::stl::fill(builder, &bytes, &place, body),
        "glb" | "gltf" => super::gltf::fill_into(builder, &bytes, &inner, &place, body),
        other => Err(format!("has the ending .{}, which is not read in SDF", super::folder::shortened(other)).into()),
    };
    result.map_err(|r| format!("its mesh `{}`: {}", super::folder::shortened(uri), r.reason).into())
}

/// Returns the path of a mesh: `model://name/path` is in the folder of that name, which is this one or beside it.
fn located(folder: &Folder, uri: &str) -> Option<String> {
    let Some(rest) = uri.strip_prefix("model://").or_else(|| uri.strip_prefix("package://")) else {
        return folder.resolve(uri).map(|_| uri.to_owned());
    };
    let (name, path) = rest.split_once('/')?;
    let own = folder.base().file_name().is_some_and(|f| f.to_str() == Some(name));
    let beside = format!("../{name}/{path}");
    let order = if own { [path.to_owned(), beside] } else { [beside, path.to_owned()] };
    order.into_iter().find(|p| folder.resolve(p).is_some())
}
