//! The building as bodies: slabs, walls, doors, windows; lamps; places of robots as sites.

use d3dgen_mesh::dynamics;
use d3dgen_mesh::writers::number::{n, small};

use super::{Rest, box_geom, list, shape_geom};
use crate::scene::{SimDoor, SimLeaf, SimScene, SimShape, SimWay};
use crate::xml::Xml;

/// Colors of the building, where its surfaces have no pictures.
const WALL: &str = "0.93 0.92 0.89 1";
const FLOOR: &str = "0.72 0.66 0.58 1";
const CEILING: &str = "0.97 0.97 0.96 1";
const LEAF: &str = "0.78 0.7 0.6 1";
const FRAME: &str = "0.85 0.84 0.82 1";
const GLASS: &str = "0.75 0.85 0.9 0.25";
const GROUND: &str = "0.45 0.5 0.42 1";
/// Half the size of a handle, m: its own x runs along the leaf.
const HANDLE_M: [f64; 3] = [0.06, 0.02, 0.01];

/// Writes materials, and the meshes of pieces that are no boxes.
pub(super) fn assets(xml: &mut Xml, scene: &SimScene) {
    let materials = [
        ("wall", WALL),
        ("floor", FLOOR),
        ("ceiling", CEILING),
        ("leaf", LEAF),
        ("frame", FRAME),
        ("glass", GLASS),
        ("ground", GROUND),
    ];
    for (name, rgba) in materials {
        let name = format!("building_{name}");
        xml.leaf("material", &[("name", name), ("rgba", rgba.to_owned()), ("specular", "0.1".to_owned())]);
    }
    for (name, shape) in pieces(scene) {
        if let SimShape::Prism { outline, z_m } = shape {
            let corners = z_m.iter().flat_map(|z| outline.iter().flat_map(move |p| [p.x, p.y, *z]));
            let corners: Vec<f64> = corners.collect();
            xml.leaf("mesh", &[("name", name), ("vertex", list(&corners))]);
        }
    }
}

/// Returns the convex pieces of slabs and walls with the names of their geoms.
fn pieces(scene: &SimScene) -> Vec<(String, &SimShape)> {
    let mut out = Vec::new();
    for room in &scene.rooms {
        for (part, shapes) in [("floor", &room.floor), ("ceiling", &room.ceiling)] {
            out.extend(shapes.iter().enumerate().map(|(k, s)| (format!("{}_{part}_{k}", room.id), s)));
        }
    }
    for wall in &scene.walls {
        let named = |(k, p): (usize, &'_ crate::scene::SimPiece)| format!("{}_{}_{k}", wall.id, p.part.name());
        out.extend(wall.pieces.iter().enumerate().map(|(k, p)| (named((k, p)), &p.shape)));
    }
    out
}

/// Writes the sun and the lamps.
pub(super) fn lights(xml: &mut Xml, scene: &SimScene) {
    let sun = [
        ("name", "sun"),
        ("type", "directional"),
        ("pos", "0 0 30"),
        ("dir", "-0.4 0.3 -0.87"),
        ("diffuse", "0.5 0.5 0.48"),
        ("castshadow", "false"),
    ];
    xml.leaf("light", &sun.map(|(k, v)| (k, v.to_owned())));
    for light in &scene.lights {
        // MuJoCo's lights have no unit: a ceiling lamp of 3,200 lm lights a room of usual size by itself.
        let share = (light.lumens / 3200.0).min(1.0) * 0.35;
        let attributes = [
            ("name", light.id.clone()),
            ("pos", list(&light.at_m)),
            ("dir", "0 0 -1".to_owned()),
            ("cutoff", "80".to_owned()),
            ("attenuation", "0.5 0.2 0.1".to_owned()),
            ("diffuse", list(&light.white().map(|v| v * share))),
            ("castshadow", "false".to_owned()),
        ];
        xml.leaf("light", &attributes);
    }
}

/// Writes slabs, walls, windows and doors.
pub(super) fn bodies(xml: &mut Xml, scene: &SimScene, rest: &mut Rest) {
    let material = |name: &str| ("material", format!("building_{name}"));
    let structural = || ("class", "structural".to_owned());
    let ground = [
        ("name", "ground".to_owned()),
        structural(),
        ("type", "plane".to_owned()),
        ("pos", list(&[0.0, 0.0, scene.ground_m()])),
        ("size", "0 0 1".to_owned()),
        material("ground"),
    ];
    xml.leaf("geom", &ground);
    let piece = |xml: &mut Xml, name: String, shape: &SimShape, look: &str| {
        let mut attributes = vec![("name", name.clone()), structural(), material(look)];
        attributes.extend(shape_geom(shape, &name));
        xml.leaf("geom", &attributes);
    };
    for room in &scene.rooms {
        xml.begin("body", &[("name", room.id.clone())]);
        for (part, shapes) in [("floor", &room.floor), ("ceiling", &room.ceiling)] {
            for (k, shape) in shapes.iter().enumerate() {
                piece(xml, format!("{}_{part}_{k}", room.id), shape, part);
            }
        }
        xml.end();
    }
    for wall in &scene.walls {
        xml.begin("body", &[("name", wall.id.clone())]);
        for (k, own) in wall.pieces.iter().enumerate() {
            piece(xml, format!("{}_{}_{k}", wall.id, own.part.name()), &own.shape, "wall");
        }
        xml.end();
    }
    for window in &scene.windows {
        xml.begin("body", &[("name", window.id.clone())]);
        let bars = window.frame.iter().map(|b| (b, "frame"));
        for (k, (own, look)) in bars.chain([(&window.glass, "glass")]).enumerate() {
            piece(xml, format!("{}_{look}_{k}", window.id), &SimShape::Box(*own), look);
        }
        xml.end();
    }
    for door in &scene.doors {
        xml.begin("body", &[("name", door.id.clone())]);
        for (k, jamb) in door.frame.iter().enumerate() {
            piece(xml, format!("{}_jamb_{k}", door.id), &SimShape::Box(*jamb), "frame");
        }
        for own in &door.leaves {
            rest.excludes.push([door.id.clone(), own.id.clone()]);
            leaf(xml, door, own, rest);
        }
        xml.end();
    }
}

fn leaf(xml: &mut Xml, door: &SimDoor, leaf: &SimLeaf, rest: &mut Rest) {
    let joint = &leaf.joint;
    let mut body = vec![("name", leaf.id.clone()), ("pos", list(&joint.origin_m))];
    if leaf.balanced {
        body.push(("gravcomp", "1".to_owned()));
    }
    xml.begin("body", &body);
    let attributes = [
        ("name", joint.id.clone()),
        ("class", "articulable".to_owned()),
        ("type", if joint.hinge { "hinge" } else { "slide" }.to_owned()),
        ("axis", list(&joint.axis)),
        ("range", list(&joint.limits)),
        ("armature", n(dynamics::armature(Some(joint.limits)))),
        ("damping", n(joint.damping)),
        ("frictionloss", n(joint.friction)),
    ];
    xml.leaf("joint", &attributes);
    let mut geom = vec![
        ("name", format!("{}_panel", leaf.id)),
        ("class", "articulable".to_owned()),
        ("material", "building_leaf".to_owned()),
        ("group", "0".to_owned()),
        // The leaf of a room's door meets what stands fast too, but not the doors of furniture.
        ("conaffinity", "4".to_owned()),
        ("mass", small(leaf.mass_kg)),
    ];
    geom.extend(box_geom(&leaf.closed, joint.origin_m));
    xml.leaf("geom", &geom);
    let (sin, cos) = leaf.closed.yaw_rad.sin_cos();
    for handle in &leaf.handles_m {
        // Half of it stands out of the face.
        let [u, v, z] = *handle;
        let at = [cos * u - sin * v, sin * u + cos * v, z];
        let at: Vec<f64> = (0..3).map(|i| leaf.closed.center_m[i] - joint.origin_m[i] + at[i]).collect();
        let quat = super::about_z(leaf.closed.yaw_rad);
        let attributes = [
            ("class", "visual".to_owned()),
            ("type", "box".to_owned()),
            ("pos", list(&at)),
            ("size", list(&HANDLE_M)),
            ("quat", list(&quat)),
            ("rgba", "0.4 0.4 0.42 1".to_owned()),
        ];
        xml.leaf("geom", &attributes);
    }
    xml.end();
    rest.closed.push(0.0);
    // Who opens no doors finds those on the way of robots open.
    rest.open.push(if door.on_route { joint.limits[1] } else { 0.0 });
}

/// Writes rooms, zones, robots and the corners of their routes as sites.
pub(super) fn sites(xml: &mut Xml, scene: &SimScene) {
    let mut site = |name: String, at: [f64; 3], size: f64, rgba: &str| {
        let attributes = [
            ("name", name),
            ("pos", list(&at)),
            ("size", n(size)),
            ("group", "4".to_owned()),
            ("rgba", rgba.to_owned()),
        ];
        xml.leaf("site", &attributes);
    };
    for zone in &scene.zones {
        let middle = zone.outline.bounds().center();
        site(zone.id.clone(), [middle.x, middle.y, zone.floor_m], 0.05, "0.1 0.5 0.8 0.4");
    }
    for robot in &scene.robots {
        site(robot.id.clone(), robot.start_m, 0.05, "0.8 0.4 0.1 0.6");
        for SimWay { name, points_m, .. } in &robot.routes {
            for (k, at) in points_m.iter().enumerate() {
                site(format!("{name}_point_{k}"), *at, 0.02, "0.8 0.4 0.1 0.4");
            }
        }
    }
}
