//! What a link shows, and what of it collides: simple shapes, and meshes in files.

use d3dgen_mesh::{Collision, Material, parts};
use roxmltree::Node;

use super::{child, number, numbers, three, uri, words};
use crate::readers::builder::{Builder, Piece};
use crate::readers::facts::{Refusal, TextureFact};
use crate::readers::folder::{Folder, MAX_FILE_BYTES, shortened};
use crate::readers::frame::{Extent, Matrix};
use crate::readers::usd::{Triangles, cuboid, turned_solid};
use crate::readers::{dae, gltf, obj, stl};

/// Half the thickness of a plane that collides, m.
const THIN_M: f64 = 0.001;

fn geometry<'a, 'i>(element: Node<'a, 'i>) -> Option<Node<'a, 'i>> {
    child(element, "geometry").and_then(|g| g.children().find(Node::is_element))
}

/// Adds what a visual shows to a body.
pub fn seen(builder: &mut Builder, folder: &Folder, visual: Node, place: &Matrix, body: usize) -> Result<(), Refusal> {
    let Some(geometry) = geometry(visual) else { return Ok(()) };
    if geometry.tag_name().name() == "mesh" {
        let before = builder.piece_count(body);
        mesh(builder, folder, geometry, place, body)?;
        // The material of a visual is for meshes that bring none.
        if let Some(material) = child(visual, "material") {
            let material = surface(builder, folder, material, visual.attribute("name"));
            builder.paint(body, before, material);
        }
        return Ok(());
    }
    let Some(Triangles { positions, uvs, triangles }) = solid(builder, geometry) else { return Ok(()) };
    builder.facts.mesh_count += 1;
    builder.facts.triangle_count += triangles.len() as u64;
    let mut own = Extent::default();
    positions.iter().for_each(|p| own.add(p.map(f64::from)));
    if let Some(bounds) = own.scaled(1.0) {
        builder.extent.add_box(bounds, place);
    }
    let material = child(visual, "material").map(|m| surface(builder, folder, m, visual.attribute("name")));
    let name = visual.attribute("name").unwrap_or("visual").to_owned();
    builder.add(body, Piece { name, positions, uvs, triangles, material }, place)
}

fn solid(builder: &mut Builder, geometry: Node) -> Option<Triangles> {
    let (radius, half) = round(geometry);
    match geometry.tag_name().name() {
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
        "plane" => Some(cuboid(plane(geometry, 0.0))),
        other => {
            builder.facts.warn(format!("a visual is a {}, which is not read", shortened(other)));
            None
        }
    }
}

/// Returns the radius and half the length of a round shape.
fn round(geometry: Node) -> (f64, f64) {
    (number(geometry, "radius").unwrap_or(0.5), number(geometry, "length").unwrap_or(1.0) / 2.0)
}

fn plane(geometry: Node, thickness: f64) -> [f64; 3] {
    let size = words(geometry, "size").map(numbers).unwrap_or_default();
    let side = |i: usize| size.get(i).copied().unwrap_or(1.0) / 2.0;
    [side(0), side(1), thickness]
}

/// Adds the convex shapes of a collision to a body: a mesh becomes boxes around its parts. What cannot be read collides
/// with nothing and is told.
pub fn collides(builder: &mut Builder, folder: &Folder, collision: Node, place: &Matrix, body: usize) {
    let Some(geometry) = geometry(collision) else { return };
    let (radius, half) = round(geometry);
    let axes = |half: [f64; 3]| {
        let along = |i: usize| {
            let (from, to) = (place.point([0.; 3]), place.point(std::array::from_fn(|k| f64::from(k == i))));
            std::array::from_fn(|k| to[k] - from[k])
        };
        Collision::around(place.point([0.; 3]), half, [along(0), along(1), along(2)])
    };
    let shape = match geometry.tag_name().name() {
        "box" => axes(three(geometry, "size").unwrap_or([1.0; 3]).map(|v| v / 2.0)),
        "sphere" => Collision::Sphere { center: place.point([0.; 3]), radius },
        "ellipsoid" => axes(three(geometry, "radii").unwrap_or([1.0; 3])),
        "cylinder" | "cone" => axes([radius, radius, half]).rounded(radius, half),
        "capsule" => axes([radius, radius, half + radius]).rounded(radius, half + radius),
        "plane" => axes(plane(geometry, THIN_M)),
        "mesh" => {
            let mut shape = Builder::new("sdf");
            match mesh(&mut shape, folder, geometry, place, 0) {
                Ok(()) => parts::boxes(&shape.meshes(0)).into_iter().for_each(|b| builder.collide(body, b)),
                Err(refusal) => builder.facts.warn(format!("a collision shape is left out: {refusal}")),
            }
            return;
        }
        _ => return,
    };
    if shape.bounds().iter().flatten().all(|v| v.is_finite()) {
        builder.collide(body, shape);
    }
}

fn surface(builder: &mut Builder, folder: &Folder, material: Node, name: Option<&str>) -> usize {
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
    let metal = child(material, "pbr").and_then(|p| child(p, "metal").or_else(|| child(p, "specular")));
    let figure = |name: &str| metal.and_then(|m| number(m, name)).map(|v| v.clamp(0.0, 1.0) as f32);
    let plain = Material::default();
    let texture = metal.and_then(|m| words(m, "albedo_map")).map(|uri| {
        let path = uri::located(folder, uri);
        let fact = TextureFact { path: Some(uri.to_owned()), resolves: path.is_some(), embedded: None };
        if !builder.facts.textures.contains(&fact) {
            builder.facts.textures.push(fact);
        }
        builder.picture(folder, path.as_deref().unwrap_or(uri))
    });
    builder.materials.push(Material {
        name,
        base_color: base.map(|v| v as f32),
        opacity: part(3, 1.0) as f32,
        emissive: std::array::from_fn(|i| emissive.get(i).copied().unwrap_or(0.0).clamp(0.0, 1.0) as f32),
        metallic: figure("metalness").unwrap_or(plain.metallic),
        roughness: figure("roughness").unwrap_or(plain.roughness),
        texture,
        finish: None,
    });
    builder.materials.len() - 1
}

fn mesh(builder: &mut Builder, folder: &Folder, geometry: Node, place: &Matrix, body: usize) -> Result<(), Refusal> {
    let uri = words(geometry, "uri").ok_or("a mesh of it has no uri")?;
    let path = uri::located(folder, uri).ok_or_else(|| {
        format!(
            "names the mesh `{}`, which is not there or outside of its folder; read the folder that holds both",
            shortened(uri)
        )
    })?;
    let bytes = folder.read(&path, MAX_FILE_BYTES)?;
    let inner = folder.of_named(&path).unwrap_or_else(|| folder.clone());
    let place = *place * Matrix::scale(three(geometry, "scale").unwrap_or([1.0; 3]));
    let part = child(geometry, "submesh");
    let Some((name, part)) = part.and_then(|p| Some((words(p, "name")?, p))) else {
        return whole(builder, uri, &path, &bytes, &inner, &place, body);
    };
    let mut center = Matrix::IDENTITY;
    if words(part, "center").is_some_and(|c| matches!(c, "1" | "true")) {
        // Read once to see where it is, and again to put its middle on the origin.
        let mut alone = Builder::new("sdf");
        alone.want_part(Some(name));
        whole(&mut alone, uri, &path, &bytes, &inner, &Matrix::IDENTITY, 0)?;
        if let Some([min, max]) = alone.extent.scaled(1.0) {
            center = Matrix::translation(std::array::from_fn(|i| -(min[i] + max[i]) / 2.0));
        }
    }
    builder.want_part(Some(name));
    let result = whole(builder, uri, &path, &bytes, &inner, &(place * center), body);
    let found = builder.want_part(None);
    result?;
    match found {
        Some((false, others)) if !others.is_empty() => Err(format!(
            "names the part `{}` of the mesh `{}`, which has {}",
            shortened(name),
            shortened(uri),
            others.join(", ")
        )
        .into()),
        _ => Ok(()),
    }
}

/// Reads a mesh file, or the one part of it that is asked for.
fn whole(
    builder: &mut Builder,
    uri: &str,
    path: &str,
    bytes: &[u8],
    folder: &Folder,
    place: &Matrix,
    body: usize,
) -> Result<(), Refusal> {
    let ending = path.rsplit_once('.').map(|(_, e)| e.to_ascii_lowercase()).unwrap_or_default();
    let result = match ending.as_str() {
        "dae" => dae::fill(builder, bytes, folder, place, body),
        "obj" => obj::fill(builder, bytes, folder, place, body),
        "stl" => stl::fill(builder, bytes, place, body),
        "glb" | "gltf" => gltf::fill_into(builder, bytes, folder, place, body),
        other => Err(format!("has the ending .{}, which is not read in SDF", shortened(other)).into()),
    };
    result.map_err(|r| format!("its mesh `{}`: {}", shortened(uri), r.reason).into())
}
