//! Doors: a model each, with its frame and leaves.

use std::collections::BTreeMap;

use d3dgen_mesh::writers::number::{n, small};

use super::building::{FRAME, collision, visual};
use crate::scene::{SimBox, SimDoor, SimLeaf, SimScene, SimShape};
use crate::xml::Xml;

/// Color of leaves.
const LEAF: &str = "0.78 0.7 0.6 1";
/// How a controller moves a leaf: gains by its mass, and its strongest push, N m or N.
const GAIN_P: f64 = 20.0;
const GAIN_D: f64 = 8.0;
const MOST: f64 = 100.0;

/// Returns true for a door whose leaves move in the world.
pub(super) fn moves(scene: &SimScene, door: &SimDoor) -> bool {
    let has_routes = scene.robots.iter().any(|r| !r.routes.is_empty());
    door.on_route || !has_routes
}

/// Writes a door that has a frame or leaves.
pub(super) fn model(xml: &mut Xml, scene: &SimScene, door: &SimDoor, labels: &BTreeMap<&str, usize>) {
    if door.frame.is_empty() && door.leaves.is_empty() {
        return;
    }
    let number = labels.get("door");
    let moves = moves(scene, door);
    xml.begin("model", &[("name", door.id.clone())]);
    if !moves || door.leaves.is_empty() {
        xml.text("static", &[], "true");
    }
    xml.begin("link", &[("name", "frame".to_owned())]);
    for (k, jamb) in door.frame.iter().enumerate() {
        let (name, shape) = (format!("jamb_{k}"), SimShape::Box(*jamb));
        visual(xml, &name, &shape, "", FRAME, number);
        collision(xml, &name, &shape, "");
    }
    if !moves {
        let at = |leaf: &SimLeaf| leaf.at(if door.leads_out() { 0.0 } else { leaf.joint.limits[1] });
        for leaf in &door.leaves {
            let shape = SimShape::Box(at(leaf));
            visual(xml, &leaf.id, &shape, "", LEAF, number);
            collision(xml, &leaf.id, &shape, "");
        }
    }
    xml.end();
    if moves && !door.leaves.is_empty() {
        xml.begin("joint", &[("name", "frame_joint".to_owned()), ("type", "fixed".to_owned())]);
        xml.text("parent", &[], "world");
        xml.text("child", &[], "frame");
        xml.end();
        for leaf in &door.leaves {
            link(xml, leaf, number);
            joint(xml, leaf);
            if door.on_route {
                controller(xml, door, leaf);
            }
        }
    }
    xml.end();
}

fn link(xml: &mut Xml, leaf: &SimLeaf, number: Option<&usize>) {
    let own = &leaf.closed;
    xml.begin("link", &[("name", leaf.id.clone())]);
    let [x, y, z] = own.center_m.map(n);
    xml.text("pose", &[], &format!("{x} {y} {z} 0 0 {}", n(own.yaw_rad)));
    if leaf.balanced {
        xml.text("gravity", &[], "false");
    }
    xml.begin("inertial", &[]);
    xml.text("mass", &[], &small(leaf.mass_kg));
    xml.begin("inertia", &[]);
    let square = own.half_m.map(|h| h * h);
    for (name, [a, b]) in [("ixx", [1, 2]), ("iyy", [0, 2]), ("izz", [0, 1])] {
        xml.text(name, &[], &small(leaf.mass_kg / 3.0 * (square[a] + square[b])));
    }
    for name in ["ixy", "ixz", "iyz"] {
        xml.text(name, &[], "0");
    }
    xml.end();
    xml.end();
    let shape = SimShape::Box(SimBox { center_m: [0.0; 3], yaw_rad: 0.0, ..*own });
    visual(xml, "panel", &shape, "", LEAF, number);
    collision(xml, "panel", &shape, "");
    for (k, handle) in leaf.handles_m.iter().enumerate() {
        let bar = SimShape::Box(SimBox { center_m: *handle, half_m: [0.06, 0.02, 0.01], yaw_rad: 0.0 });
        visual(xml, &format!("handle_{k}"), &bar, "", "0.4 0.4 0.42 1", number);
    }
    xml.end();
}

fn joint(xml: &mut Xml, leaf: &SimLeaf) {
    let joint = &leaf.joint;
    let kind = if joint.hinge { "revolute" } else { "prismatic" };
    xml.begin("joint", &[("name", joint.id.clone()), ("type", kind.to_owned())]);
    xml.text("parent", &[], "frame");
    xml.text("child", &[], &leaf.id);
    let [x, y, z] = joint.origin_m.map(n);
    xml.text("pose", &[("relative_to", "__model__".to_owned())], &format!("{x} {y} {z} 0 0 0"));
    xml.begin("axis", &[]);
    xml.text("xyz", &[("expressed_in", "__model__".to_owned())], &joint.axis.map(n).join(" "));
    xml.begin("limit", &[]);
    xml.text("lower", &[], &n(joint.limits[0]));
    xml.text("upper", &[], &n(joint.limits[1]));
    xml.text("effort", &[], "200");
    xml.text("velocity", &[], "10");
    xml.end();
    xml.begin("dynamics", &[]);
    xml.text("damping", &[], &n(joint.damping));
    xml.text("friction", &[], &n(joint.friction));
    xml.end();
    xml.end();
    xml.end();
}

/// Writes the controller, which opens the door when the world begins: robots open none.
fn controller(xml: &mut Xml, door: &SimDoor, leaf: &SimLeaf) {
    let name = "gz::sim::systems::JointPositionController".to_owned();
    xml.begin("plugin", &[("filename", "gz-sim-joint-position-controller-system".to_owned()), ("name", name)]);
    xml.text("joint_name", &[], &leaf.joint.id);
    xml.text("topic", &[], &topic(door, leaf));
    let [p, d] = [GAIN_P, GAIN_D].map(|gain| n(gain * leaf.mass_kg));
    for (name, value) in [("p_gain", p), ("i_gain", "0".to_owned()), ("d_gain", d)] {
        xml.text(name, &[], &value);
    }
    xml.text("cmd_max", &[], &n(MOST));
    xml.text("cmd_min", &[], &n(-MOST));
    xml.text("initial_position", &[], &n(leaf.joint.limits[1]));
    xml.end();
}

/// Returns the topic that takes the position of a leaf.
pub(super) fn topic(door: &SimDoor, leaf: &SimLeaf) -> String {
    match door.leaves.len() {
        1 => format!("/{}/position", door.id),
        _ => format!("/{}/{}/position", door.id, leaf.id),
    }
}
