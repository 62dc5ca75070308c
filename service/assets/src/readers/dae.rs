//! COLLADA 1.4 and 1.5: geometries where the nodes of the scene put them.
//!
//! Facts count what stands in the scene as plain geometry. The skin of a controller is part of the model, unposed, but
//! not of the counts and the box, as in the tools that others compare with.

mod geometry;
mod surface;

use std::collections::BTreeMap;

use roxmltree::{Document, Node, ParsingOptions};

use self::geometry::Geometry;
use super::builder::Builder;
use super::facts::{Feature, ReadModel, Refusal};
use super::folder::Folder;
use super::frame::Matrix;
use super::{Reader, Source};

/// The most visits of nodes.
const MAX_VISITS: usize = 100_000;
/// The deepest nesting of nodes.
const MAX_DEPTH: usize = 4_000;
/// The most elements of a document.
const MAX_ELEMENTS: u32 = 4_000_000;

/// Reads COLLADA.
pub struct Dae;

impl Reader for Dae {
    fn name(&self) -> &'static str {
        "dae"
    }

    fn endings(&self) -> &'static [&'static str] {
        &["dae"]
    }

    fn recognizes(&self, head: &[u8], ending: &str) -> bool {
        let text = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).trim_ascii_start();
        text.windows(8).any(|w| w == b"<COLLADA") || ending == "dae" && text.starts_with(b"<") && !is_page(text)
    }

    fn read(&self, source: &Source) -> Result<ReadModel, Refusal> {
        let mut builder = Builder::new("dae");
        match own(&mut builder, source) {
            Ok(()) => builder.finish(&source.name),
            Err(refusal) => Err(builder.refuse(refusal)),
        }
    }
}

fn is_page(text: &[u8]) -> bool {
    let head = text.get(..14.min(text.len())).unwrap_or_default().to_ascii_lowercase();
    head.starts_with(b"<!doctype html") || head.starts_with(b"<html")
}

fn own(builder: &mut Builder, source: &Source) -> Result<(), Refusal> {
    let text = super::sdf::text(source.bytes);
    let document = parsed(&text)?;
    let (unit, authored) = unit(&document)?;
    let up = child(document.root_element(), "asset").and_then(|a| child(a, "up_axis"));
    let axis = match up.and_then(|u| u.text()).map(str::trim) {
        Some("X_UP") => "X",
        Some("Z_UP") => "Z",
        _ => "Y",
    };
    builder.set_frame((axis, up.is_some()), (unit, authored))?;
    scene(builder, &document, source.folder, &Matrix::IDENTITY, 0)
}

/// Reads a COLLADA file as Gazebo does: its unit counts, its axis does not; put in place by a matrix.
pub fn fill(builder: &mut Builder, bytes: &[u8], folder: &Folder, place: &Matrix, body: usize) -> Result<(), Refusal> {
    let text = super::sdf::text(bytes);
    let document = parsed(&text)?;
    let (unit, _) = unit(&document)?;
    if !(unit.is_finite() && unit > 0.0) {
        return Err(format!("says that its unit is {unit} m").into());
    }
    scene(builder, &document, folder, &(*place * Matrix::scale([unit; 3])), body)
}

/// Parses XML without a document type, so that no entity can grow or name a file.
fn parsed(text: &str) -> Result<Document<'_>, Refusal> {
    let options = ParsingOptions { allow_dtd: false, nodes_limit: MAX_ELEMENTS, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options);
    let document = document.map_err(|e| format!("its XML cannot be read: {e}"))?;
    if document.root_element().tag_name().name() != "COLLADA" {
        return Err("is XML, but not COLLADA".into());
    }
    Ok(document)
}

fn unit(document: &Document) -> Result<(f64, bool), Refusal> {
    let unit = child(document.root_element(), "asset").and_then(|a| child(a, "unit"));
    match unit.and_then(|u| u.attribute("meter")) {
        Some(text) => {
            let value = text.trim().parse().map_err(|_| "its unit is no number of meters")?;
            Ok((value, true))
        }
        None => Ok((1.0, unit.is_some())),
    }
}

fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|c| c.tag_name().name() == name)
}

fn children<'a, 'i>(node: Node<'a, 'i>, name: &'static str) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(move |c| c.tag_name().name() == name)
}

/// Returns the id that an address within the document names.
fn local(url: Option<&str>) -> Option<&str> {
    url.map(|u| u.trim().trim_start_matches('#'))
}

/// Elements by their id.
type Ids<'a, 'i> = BTreeMap<&'a str, Node<'a, 'i>>;

fn scene(
    builder: &mut Builder,
    document: &Document,
    folder: &Folder,
    place: &Matrix,
    body: usize,
) -> Result<(), Refusal> {
    let root = document.root_element();
    let mut ids: Ids = BTreeMap::new();
    let (mut cameras, mut lights, mut animations, mut controllers) = (0, 0, 0, 0);
    for element in root.descendants().filter(Node::is_element) {
        if let Some(id) = element.attribute("id") {
            ids.entry(id).or_insert(element);
        }
        match element.tag_name().name() {
            "camera" => cameras += 1,
            "light" => lights += 1,
            "animation" => animations += 1,
            "controller" => controllers += 1,
            _ => {}
        }
    }
    note(builder, root, [animations, controllers, cameras, lights]);
    let surfaces = surface::read(builder, root, &ids, folder);
    let visual = child(root, "scene").and_then(|s| child(s, "instance_visual_scene"));
    let visual = visual.and_then(|v| ids.get(local(v.attribute("url"))?).copied());
    let visual = visual.ok_or("has no scene")?;
    let mut state =
        Walk { builder, ids: &ids, surfaces: &surfaces, geometries: BTreeMap::new(), body, worn: Vec::new() };
    let mut open: Vec<(Node, Matrix, usize)> = vec![(visual, *place, 0)];
    let mut visits = 0;
    while let Some((node, world, depth)) = open.pop() {
        visits += 1;
        if visits > MAX_VISITS || depth > MAX_DEPTH {
            return Err(format!("its nodes go round in a circle, or are more than {MAX_VISITS}").into());
        }
        let world = if node.tag_name().name() == "node" { world * matrix(node)? } else { world };
        let mut below = Vec::new();
        for part in node.children().filter(Node::is_element) {
            let url = local(part.attribute("url"));
            match part.tag_name().name() {
                "node" => below.push((part, world, depth + 1)),
                "instance_node" => {
                    let target = url.and_then(|u| ids.get(u)).filter(|n| n.tag_name().name() == "node");
                    below.extend(target.map(|n| (*n, world, depth + 1)));
                }
                "instance_geometry" if state.wants(node, url) => state.geometry(part, url, &world, true)?,
                "instance_controller" if state.wants(node, url) => state.controller(part, url, &world)?,
                _ => {}
            }
        }
        open.extend(below.into_iter().rev());
    }
    let worn = state.worn;
    surface::note(builder, &surfaces, &worn);
    Ok(())
}

fn note(builder: &mut Builder, root: Node, [animations, controllers, cameras, lights]: [u64; 4]) {
    let facts = &mut builder.facts;
    facts.feature("animated", Feature::Count(animations));
    facts.feature("skel", Feature::Count(controllers));
    facts.feature("cameras", Feature::Count(cameras));
    facts.feature("lights", Feature::Count(lights));
    let asset = child(root, "asset");
    let tool =
        asset.and_then(|a| child(a, "contributor")).and_then(|c| child(c, "authoring_tool")).and_then(|t| t.text());
    facts.feature("authoring_tool", Feature::Text(tool.unwrap_or_default().chars().take(200).collect()));
    facts.feature("version", Feature::Text(root.attribute("version").unwrap_or_default().chars().take(20).collect()));
}

/// Returns the matrix of a node: its transformations in their order.
fn matrix(node: Node) -> Result<Matrix, Refusal> {
    let mut matrix = Matrix::IDENTITY;
    for part in node.children().filter(Node::is_element) {
        let name = part.tag_name().name();
        if !matches!(name, "matrix" | "translate" | "rotate" | "scale" | "lookat") {
            continue;
        }
        let numbers: Vec<f64> =
            part.text().unwrap_or_default().split_whitespace().map(|w| w.parse().unwrap_or(f64::NAN)).collect();
        let one = match (name, numbers.as_slice()) {
            ("matrix", all) => all.try_into().ok().map(Matrix::from_rows),
            ("translate", &[x, y, z]) => Some(Matrix::translation([x, y, z])),
            ("scale", &[x, y, z]) => Some(Matrix::scale([x, y, z])),
            ("rotate", &[x, y, z, degrees]) => Some(Matrix::axis_angle([x, y, z], degrees.to_radians())),
            // Only cameras look at something.
            ("lookat", _) => Some(Matrix::IDENTITY),
            _ => None,
        };
        matrix = matrix * one.ok_or_else(|| format!("a `{name}` of its nodes has {} numbers", numbers.len()))?;
    }
    Ok(matrix)
}

struct Walk<'b, 'a, 'i> {
    builder: &'b mut Builder,
    ids: &'b Ids<'a, 'i>,
    surfaces: &'b surface::Surfaces,
    geometries: BTreeMap<String, Geometry>,
    body: usize,
    /// Ids of the materials that something wears.
    worn: Vec<String>,
}

impl Walk<'_, '_, '_> {
    /// Tells whether the geometry at a node is asked for, by the names of either.
    fn wants(&mut self, node: Node, url: Option<&str>) -> bool {
        let named = url.and_then(|u| self.ids.get(u)).and_then(|g| g.attribute("name"));
        let names = [node.attribute("name"), node.attribute("id"), named, url];
        self.builder.wants(&names.map(Option::unwrap_or_default))
    }

    fn geometry(&mut self, instance: Node, url: Option<&str>, place: &Matrix, counted: bool) -> Result<(), Refusal> {
        let Some(url) = url else { return Ok(()) };
        if !self.geometries.contains_key(url) {
            let element = self.ids.get(url).filter(|n| n.tag_name().name() == "geometry");
            let Some(mesh) = element.and_then(|g| child(*g, "mesh")) else {
                self.builder.facts.warn("names a geometry that is not there or no mesh");
                return Ok(());
            };
            let geometry = Geometry::read(mesh, self.ids, &mut self.builder.facts)?;
            self.geometries.insert(url.to_owned(), geometry);
        }
        let Some(geometry) = self.geometries.get(url) else { return Ok(()) };
        let bound: BTreeMap<&str, &str> = instance
            .descendants()
            .filter(|n| n.tag_name().name() == "instance_material")
            .filter_map(|n| Some((n.attribute("symbol")?, local(n.attribute("target"))?)))
            .collect();
        if counted {
            self.builder.facts.mesh_count += 1;
        }
        for part in &geometry.parts {
            let material = part.material.as_deref().and_then(|symbol| bound.get(symbol)).copied();
            if counted {
                self.builder.facts.triangle_count += part.triangles.len() as u64;
                for index in &part.used {
                    if let Some(point) = geometry.points.get(*index as usize) {
                        self.builder.extent.add(place.point(*point));
                    }
                }
                self.worn.extend(material.map(str::to_owned));
            }
            let material = material.and_then(|m| self.surfaces.index(m));
            self.builder.add(self.body, geometry.piece(part, url, material), place)?;
        }
        Ok(())
    }

    fn controller(&mut self, instance: Node, url: Option<&str>, place: &Matrix) -> Result<(), Refusal> {
        let skin = url.and_then(|u| self.ids.get(u)).and_then(|c| child(*c, "skin").or_else(|| child(*c, "morph")));
        let Some(skin) = skin else { return Ok(()) };
        let shape = child(skin, "bind_shape_matrix").and_then(|m| m.text());
        let numbers: Vec<f64> = shape.unwrap_or_default().split_whitespace().filter_map(|w| w.parse().ok()).collect();
        let shape = numbers.as_slice().try_into().map_or(Matrix::IDENTITY, Matrix::from_rows);
        self.geometry(instance, local(skin.attribute("source")), &(*place * shape), false)
    }
}
