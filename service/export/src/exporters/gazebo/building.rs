//! The building: static models `ground`, `building` and `ceilings`, and lamps.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::fmt::Write;

use d3dgen_mesh::writers::number::n;
use d3dgen_model::geometry::Point;

use super::label;
use crate::file::File;
use crate::scene::{SimBox, SimScene, SimShape, merged};
use crate::xml::Xml;

/// Colors of surfaces without pictures.
pub(super) const WALL: &str = "0.93 0.92 0.89 1";
pub(super) const FRAME: &str = "0.85 0.84 0.82 1";
const FLOOR: &str = "0.72 0.66 0.58 1";
const CEILING: &str = "0.97 0.97 0.96 1";
const GLASS: &str = "0.75 0.85 0.9 0.3";
const GROUND: &str = "0.45 0.5 0.42 1";
/// Where the meshes of pieces are that are no boxes.
const FOLDER: &str = "building";

/// Writes the sun, the sky and the lamps.
pub(super) fn lights(xml: &mut Xml, scene: &SimScene) {
    xml.begin("scene", &[]);
    xml.text("ambient", &[], "0.5 0.5 0.5 1");
    xml.text("background", &[], "0.7 0.8 0.9 1");
    xml.text("shadows", &[], "true");
    xml.end();
    xml.begin("light", &[("type", "directional".to_owned()), ("name", "sun".to_owned())]);
    xml.text("cast_shadows", &[], "true");
    xml.text("pose", &[], "0 0 30 0 0 0");
    xml.text("diffuse", &[], "0.8 0.8 0.78 1");
    xml.text("specular", &[], "0.2 0.2 0.2 1");
    xml.text("direction", &[], "-0.4 0.3 -0.87");
    xml.end();
    for light in &scene.lights {
        xml.begin("light", &[("type", "point".to_owned()), ("name", light.id.clone())]);
        let [x, y, z] = light.at_m.map(n);
        xml.text("pose", &[], &format!("{x} {y} {z} 0 0 0"));
        let [r, g, b] = light.white();
        xml.text("diffuse", &[], &format!("{} {} {} 1", n(r), n(g), n(b)));
        xml.text("cast_shadows", &[], "false");
        // luminous flux over the whole sphere, cd, against the 255 cd that make a room of usual size bright
        xml.text("intensity", &[], &n(light.lumens / (4.0 * PI) / 255.0));
        xml.begin("attenuation", &[]);
        for (name, value) in [("range", "8"), ("constant", "0.5"), ("linear", "0.1"), ("quadratic", "0.03")] {
            xml.text(name, &[], value);
        }
        xml.end();
        xml.end();
    }
}

/// Writes the static models.
pub(super) fn models(xml: &mut Xml, scene: &SimScene, labels: &BTreeMap<&str, usize>) {
    ground(xml, scene);
    begin(xml, "building");
    let mut solid: Vec<SimBox> = Vec::new();
    let mut others = Vec::new();
    for room in &scene.rooms {
        sort(&room.floor, &format!("{}_floor", room.id), &mut solid, &mut others);
        shown(xml, &room.id, &room.floor, FLOOR, labels.get("floor"));
    }
    for wall in &scene.walls {
        let shapes: Vec<SimShape> = wall.pieces.iter().map(|p| p.shape.clone()).collect();
        sort(&shapes, &wall.id, &mut solid, &mut others);
        shown(xml, &wall.id, &shapes, WALL, labels.get("wall"));
    }
    for window in &scene.windows {
        solid.push(window.whole());
        let frame: Vec<SimShape> = window.frame.iter().copied().map(SimShape::Box).collect();
        shown(xml, &format!("{}_frame", window.id), &frame, FRAME, labels.get("window"));
        shown(xml, &window.id, &[SimShape::Box(window.glass)], GLASS, labels.get("window"));
    }
    for (k, own) in merged(&solid).iter().enumerate() {
        collision(xml, &format!("solid_{k}"), &SimShape::Box(*own), "");
    }
    for (name, shape) in &others {
        collision(xml, name, shape, name);
    }
    end(xml);
    begin(xml, "ceilings");
    let mut boards = Vec::new();
    let mut slanted = Vec::new();
    for room in &scene.rooms {
        let name = format!("{}_ceiling", room.id);
        sort(&room.ceiling, &name, &mut boards, &mut slanted);
        shown(xml, &name, &room.ceiling, CEILING, labels.get("ceiling"));
    }
    for (k, own) in merged(&boards).iter().enumerate() {
        collision(xml, &format!("board_{k}"), &SimShape::Box(*own), "");
    }
    for (name, shape) in &slanted {
        collision(xml, name, shape, name);
    }
    end(xml);
}

fn ground(xml: &mut Xml, scene: &SimScene) {
    begin(xml, "ground");
    let pose = format!("0 0 {} 0 0 0", n(scene.ground_m()));
    let plane = |xml: &mut Xml| {
        xml.text("pose", &[], &pose);
        xml.begin("geometry", &[]);
        xml.begin("plane", &[]);
        xml.text("normal", &[], "0 0 1");
        xml.text("size", &[], "200 200");
        xml.end();
        xml.end();
    };
    xml.begin("collision", &[("name", "ground_col".to_owned())]);
    plane(xml);
    xml.end();
    xml.begin("visual", &[("name", "ground_vis".to_owned())]);
    plane(xml);
    material(xml, GROUND);
    xml.end();
    end(xml);
}

fn begin(xml: &mut Xml, name: &str) {
    xml.begin("model", &[("name", name.to_owned())]);
    xml.text("static", &[], "true");
    xml.begin("link", &[("name", "link".to_owned())]);
}

fn end(xml: &mut Xml) {
    xml.end();
    xml.end();
}

/// Deals shapes to boxes, and those that need a mesh with its name.
fn sort(shapes: &[SimShape], name: &str, boxes: &mut Vec<SimBox>, others: &mut Vec<(String, SimShape)>) {
    for (k, shape) in shapes.iter().enumerate() {
        match shape {
            SimShape::Box(own) => boxes.push(*own),
            SimShape::Prism { .. } => others.push((format!("{name}_{k}"), shape.clone())),
        }
    }
}

/// Writes what is seen of a part of the building; the first piece has its id.
fn shown(xml: &mut Xml, id: &str, shapes: &[SimShape], color: &str, number: Option<&usize>) {
    for (k, shape) in shapes.iter().enumerate() {
        let name = if k == 0 { id.to_owned() } else { format!("{id}_piece_{k}") };
        visual(xml, &name, shape, &format!("{id}_{k}"), color, number);
    }
}

/// Writes a visual with its color and label.
pub(super) fn visual(xml: &mut Xml, name: &str, shape: &SimShape, mesh: &str, color: &str, number: Option<&usize>) {
    xml.begin("visual", &[("name", name.to_owned())]);
    geometry(xml, shape, mesh);
    material(xml, color);
    if let Some(number) = number {
        label(xml, *number);
    }
    xml.end();
}

/// Writes a collision; `mesh` is the name of its mesh where it is no box.
pub(super) fn collision(xml: &mut Xml, name: &str, shape: &SimShape, mesh: &str) {
    xml.begin("collision", &[("name", format!("{name}_col"))]);
    geometry(xml, shape, mesh);
    xml.end();
}

fn geometry(xml: &mut Xml, shape: &SimShape, mesh: &str) {
    match shape {
        SimShape::Box(own) => {
            let [x, y, z] = own.center_m.map(n);
            xml.text("pose", &[], &format!("{x} {y} {z} 0 0 {}", n(own.yaw_rad)));
            xml.begin("geometry", &[]);
            xml.begin("box", &[]);
            xml.text("size", &[], &own.half_m.map(|h| n(2.0 * h)).join(" "));
        }
        SimShape::Prism { .. } => {
            xml.begin("geometry", &[]);
            xml.begin("mesh", &[]);
            xml.text("uri", &[], &format!("model://{FOLDER}/meshes/{mesh}.obj"));
        }
    }
    xml.end();
    xml.end();
}

pub(super) fn material(xml: &mut Xml, color: &str) {
    xml.begin("material", &[]);
    xml.text("ambient", &[], color);
    xml.text("diffuse", &[], color);
    xml.text("specular", &[], "0.1 0.1 0.1 1");
    xml.end();
}

/// Returns the meshes of pieces that are no boxes.
pub(super) fn meshes(scene: &SimScene) -> Vec<File> {
    let mut named = Vec::new();
    for room in &scene.rooms {
        sort(&room.floor, &room.id, &mut Vec::new(), &mut named);
        // the same pieces for what collides
        sort(&room.floor, &format!("{}_floor", room.id), &mut Vec::new(), &mut named);
        sort(&room.ceiling, &format!("{}_ceiling", room.id), &mut Vec::new(), &mut named);
    }
    for wall in &scene.walls {
        let shapes: Vec<SimShape> = wall.pieces.iter().map(|p| p.shape.clone()).collect();
        sort(&shapes, &wall.id, &mut Vec::new(), &mut named);
    }
    let file = |(name, shape): (String, SimShape)| match shape {
        SimShape::Prism { outline, z_m } => {
            Some(File::new(format!("gazebo/models/{FOLDER}/meshes/{name}.obj"), prism(&outline, z_m)))
        }
        SimShape::Box(_) => None,
    };
    named.into_iter().filter_map(file).collect()
}

/// Returns a convex outline between two heights as OBJ text.
fn prism(outline: &[Point], z_m: [f64; 2]) -> String {
    let mut out = "o piece\n".to_owned();
    for z in z_m {
        for p in outline {
            let _ = writeln!(out, "v {} {} {}", n(p.x), n(p.y), n(z));
        }
    }
    let count = outline.len();
    let _ = writeln!(out, "f {}", (1..=count).rev().map(|k| k.to_string()).collect::<Vec<_>>().join(" "));
    let _ = writeln!(out, "f {}", (count + 1..=2 * count).map(|k| k.to_string()).collect::<Vec<_>>().join(" "));
    for k in 0..count {
        let next = (k + 1) % count;
        let _ = writeln!(out, "f {} {} {} {}", k + 1, next + 1, count + next + 1, count + k + 1);
    }
    out
}
