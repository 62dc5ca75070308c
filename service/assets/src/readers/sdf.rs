//! SDF model folders: links with their poses and joints, meshes with their scale, simple shapes, models in models.
//!
//! What is seen is the geometry; what collides becomes convex shapes, whatever mesh it is. Meshes are taken as Gazebo takes them: in the axes of their files, whatever those say is up. The pose of the model
//! itself says where it stands in a world and is left aside.

mod frames;
mod shape;
mod tree;
mod uri;

use std::cell::Cell;
use std::collections::BTreeMap;

use d3dgen_mesh::{Joint, JointKind};
use roxmltree::Node;

use self::tree::{JointPlace, Link, Tree};
use super::builder::{Builder, identifier};
use super::facts::{Feature, ReadModel, Refusal};
use super::{Reader, Source};
pub use uri::{Config, config_of, located};

/// The most visuals of a model, and the most shapes that collide.
const MAX_VISUALS: usize = 4_000;
/// How far shapes that collide may reach beyond what is seen, or stay behind, as a share of its extent and in m.
const BESIDE: (f64, f64) = (0.25, 0.05);

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
    builder.set_frame(("Z", true), (1.0, true))?;
    let texts = tree::texts(text(source.bytes), source.folder)?;
    let documents = tree::documents(&texts)?;
    let visits = Cell::new(0);
    let tree = tree::gather(&texts, &documents, &visits)?;
    let model = documents.first().and_then(tree::model_of).ok_or("has no model: worlds and lights are not read")?;
    let name = model.attribute("name").unwrap_or_default().trim().to_owned();
    if words(model, "pose").is_some_and(|p| numbers(p).iter().any(|v| *v != 0.0)) {
        builder.facts.warn("its model has a pose, which is where it stands in a world and is left aside");
    }
    let bodies = bodies(builder, &tree);
    let mut visuals = 0;
    for link in &tree.links {
        let Some(&body) = bodies.get(&link.name) else { continue };
        for visual in children(link.node, "visual") {
            visuals += 1;
            if visuals > MAX_VISUALS {
                return Err(format!("has more than {MAX_VISUALS} visuals").into());
            }
            // Gazebo does not draw what is wholly clear.
            if number(visual, "transparency").is_none_or(|t| t < 1.0) {
                shape::seen(builder, link.folder, visual, &tree.place(link, visual), body)?;
            }
        }
    }
    collisions(builder, &tree, &bodies);
    builder.facts.feature("links", Feature::Count(tree.links.len() as u64));
    builder.facts.feature("visuals", Feature::Count(visuals as u64));
    Ok(if name.is_empty() { "model".into() } else { name.replace('.', "_") })
}

/// Reads what collides. Shapes that do not lie where the model is seen are of another size or place than it, and are left
/// out as a whole.
fn collisions(builder: &mut Builder, tree: &Tree, bodies: &BTreeMap<String, usize>) {
    let mut count = 0;
    for link in &tree.links {
        let Some(&body) = bodies.get(&link.name) else { continue };
        for collision in children(link.node, "collision") {
            count += 1;
            if count <= MAX_VISUALS {
                shape::collides(builder, link.folder, collision, &tree.place(link, collision), body);
            }
        }
    }
    builder.facts.feature("collisions", Feature::Count(count as u64));
    if let (Some(seen), Some(found)) = (builder.extent.scaled(1.0), builder.collision_bounds()) {
        let off = |i: usize| (seen[0][i] - found[0][i]).abs().max((seen[1][i] - found[1][i]).abs());
        let most = |i: usize| BESIDE.0 * (seen[1][i] - seen[0][i]) + BESIDE.1;
        if (0..3).any(|i| off(i) > most(i)) {
            builder.facts.warn("its collision shapes are not where it is seen; they are left out");
            builder.clear_collisions();
        }
    }
}

/// Makes a body of each link, and joints between them; a link that is fixed to another is part of its body, and so is one
/// of a static model that no joint moves.
fn bodies(builder: &mut Builder, tree: &Tree) -> BTreeMap<String, usize> {
    let mut fixed: BTreeMap<&str, &str> = BTreeMap::new();
    for joint in tree.joints.iter().filter(|j| j.node.attribute("type") == Some("fixed") && j.parent != "world") {
        fixed.insert(&joint.child, &joint.parent);
    }
    let moves =
        |link: &Link| tree.joints.iter().any(|j| is_moving(j) && (j.child == link.name || j.parent == link.name));
    let links: Vec<&str> = tree.links.iter().map(|l| l.name.as_str()).collect();
    let mut bodies: BTreeMap<String, usize> = BTreeMap::new();
    let mut first = true;
    for link in &tree.links {
        let name = &link.name;
        if fixed.get(name.as_str()).is_some_and(|parent| links.contains(parent)) || bodies.contains_key(name) {
            continue;
        }
        let mass = child(link.node, "inertial").and_then(|i| number(i, "mass"));
        let mass = mass.filter(|m| m.is_finite() && *m > 0.0).unwrap_or(0.0);
        if !first && tree.is_static && !moves(link) {
            builder.add_mass(0, mass);
            bodies.insert(name.clone(), 0);
            continue;
        }
        let label = identifier(name, "link");
        let index = if std::mem::take(&mut first) { 0 } else { builder.body(&label) };
        builder.set_body(index, &label, mass);
        bodies.insert(name.clone(), index);
    }
    for link in &tree.links {
        // Over any number of fixed joints; a circle of them ends at the first body.
        let mut at = link.name.as_str();
        for _ in 0..links.len() {
            match fixed.get(at) {
                Some(parent) if !bodies.contains_key(at) => at = parent,
                _ => break,
            }
        }
        let index = bodies.get(at).copied().unwrap_or(0);
        if !bodies.contains_key(&link.name) {
            let mass = child(link.node, "inertial").and_then(|i| number(i, "mass"));
            builder.add_mass(index, mass.filter(|m| m.is_finite() && *m > 0.0).unwrap_or(0.0));
            bodies.insert(link.name.clone(), index);
        }
    }
    for joint in &tree.joints {
        builder.joints.extend(moving(joint, &bodies));
    }
    bodies
}

fn kind(joint: &JointPlace) -> Option<JointKind> {
    match joint.node.attribute("type")? {
        "revolute" => Some(JointKind::Revolute),
        "continuous" => Some(JointKind::Continuous),
        "prismatic" => Some(JointKind::Prismatic),
        _ => None,
    }
}

fn is_moving(joint: &JointPlace) -> bool {
    kind(joint).is_some()
}

fn moving(joint: &JointPlace, bodies: &BTreeMap<String, usize>) -> Option<Joint> {
    let kind = kind(joint)?;
    let (parent, below) = (*bodies.get(&joint.parent)?, *bodies.get(&joint.child)?);
    let from = joint.place.point([0.; 3]);
    let length = joint.axis.iter().map(|v| v * v).sum::<f64>().sqrt();
    if parent == below || !length.is_finite() || length == 0.0 {
        return None;
    }
    let limit = child(joint.node, "axis").and_then(|a| child(a, "limit"));
    let bound = |name: &str| limit.and_then(|l| number(l, name)).filter(|v| v.abs() < 1e6);
    let limits = bound("lower").zip(bound("upper")).map(|(a, b)| [a, b]).filter(|[a, b]| a <= b);
    let limits = limits.filter(|_| kind != JointKind::Continuous);
    // Without limits a hinge turns without end.
    let kind = if kind == JointKind::Revolute && limits.is_none() { JointKind::Continuous } else { kind };
    let name = identifier(&joint.name, "joint");
    Some(Joint { name, kind, parent, child: below, origin: from, axis: joint.axis.map(|v| v / length), limits })
}
