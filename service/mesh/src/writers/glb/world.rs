//! A whole world as glTF: nodes that share meshes, lamps (`KHR_lights_punctual`), and an animation of every thing that opens.

use std::collections::BTreeMap;

use serde_json::{Map, Value, json};

use super::{File, round, y_up};
use crate::error::Error;
use crate::model3d::JointKind;
use crate::world3d::{Lamp, LampKind, Motion, Node, World3d};

/// How long a thing takes to open, s.
const OPENS_S: f32 = 1.5;
/// Moments of an animation: a turn of more than half a circle needs them between its ends.
const MOMENTS: usize = 5;

/// Returns a world as one GLB file.
///
/// # Errors
/// `Model` when a mesh names a material that is not there.
pub fn world_glb(world: &World3d) -> Result<Vec<u8>, Error> {
    let materials = world.materials.len();
    let broken = |m: &&crate::world3d::SharedMesh| m.visuals.iter().any(|v| v.material.is_some_and(|i| i >= materials));
    if let Some(mesh) = world.meshes.iter().find(broken) {
        let reason = format!("{} has a material that is not there", mesh.name);
        return Err(Error::Model { model: world.name.clone(), reason });
    }
    let mut file = File::default();
    file.materials(&world.materials, &world.textures);
    let meshes: Vec<Option<usize>> =
        world.meshes.iter().map(|m| file.mesh(&m.name, &m.visuals, &world.materials, [0.0; 3])).collect();
    let mut lamps = Vec::new();
    let mut nodes: Vec<Value> = world.nodes.iter().map(|n| node(n, &meshes, &mut lamps)).collect();
    let mut children: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (i, node) in world.nodes.iter().enumerate() {
        if let Some(parent) = node.parent {
            children.entry(parent).or_default().push(i);
        }
    }
    for (parent, list) in children {
        nodes[parent]["children"] = json!(list);
    }
    let roots: Vec<usize> = (0..world.nodes.len()).filter(|i| world.nodes[*i].parent.is_none()).collect();
    let animations = animations(world, &mut file);
    let mut root = json!({
        "asset": {"version": "2.0", "generator": "d3dgen"},
        "scene": 0,
        "scenes": [{"name": world.name, "nodes": roots}],
        "nodes": nodes,
    });
    if !animations.is_empty() {
        root["animations"] = animations.into();
    }
    if !lamps.is_empty() {
        root["extensionsUsed"] = json!(["KHR_lights_punctual"]);
        root["extensions"] = json!({"KHR_lights_punctual": {"lights": lamps}});
    }
    Ok(file.finish(root))
}

/// Turns a quaternion w, x, y, z of ours into x, y, z, w of glTF's frame.
fn turned([w, x, y, z]: [f64; 4]) -> [f64; 4] {
    let [x, y, z] = y_up([x, y, z]);
    [x, y, z, w].map(round)
}

fn node(node: &Node, meshes: &[Option<usize>], lamps: &mut Vec<Value>) -> Value {
    let mut out = Map::new();
    out.insert("name".into(), node.name.clone().into());
    if let Some(mesh) = node.mesh.and_then(|m| meshes.get(m).copied().flatten()) {
        out.insert("mesh".into(), mesh.into());
    }
    if node.at != [0.0; 3] {
        out.insert("translation".into(), json!(y_up(node.at).map(round)));
    }
    if node.turn != [1.0, 0.0, 0.0, 0.0] {
        out.insert("rotation".into(), json!(turned(node.turn)));
    }
    if let Some(lamp) = &node.lamp {
        lamps.push(light(lamp));
        out.insert("extensions".into(), json!({"KHR_lights_punctual": {"light": lamps.len() - 1}}));
    }
    let mut extras = node.facts.clone();
    if let Some(motion) = &node.motion {
        extras.insert("joint".into(), joint(motion));
    }
    if !node.layer.is_empty() {
        extras.insert("layer".into(), node.layer.clone().into());
    }
    if !extras.is_empty() {
        out.insert("extras".into(), extras.into());
    }
    out.into()
}

fn joint(motion: &Motion) -> Value {
    let (kind, unit) = match motion.kind {
        JointKind::Prismatic => ("prismatic", "m"),
        JointKind::Revolute => ("revolute", "rad"),
        JointKind::Continuous => ("continuous", "rad"),
    };
    let mut value = json!({"name": motion.name, "kind": kind, "axis": y_up(motion.axis).map(round)});
    value[format!("limits_{unit}")] = json!(motion.limits.map(round));
    value
}

/// Returns a light: cd of a point, lx of the sun.
fn light(lamp: &Lamp) -> Value {
    let (kind, strength) = match lamp.kind {
        LampKind::Point => ("point", lamp.strength / (4.0 * std::f64::consts::PI)),
        LampKind::Sun => ("directional", lamp.strength),
    };
    json!({"type": kind, "color": lamp.color.map(|v| round(f64::from(v))), "intensity": round(strength)})
}

/// Returns an animation `open <name>` for every name that nodes move by.
fn animations(world: &World3d, file: &mut File) -> Vec<Value> {
    let mut groups: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (i, node) in world.nodes.iter().enumerate() {
        if let Some(motion) = &node.motion {
            groups.entry(&motion.name).or_default().push(i);
        }
    }
    if groups.is_empty() {
        return Vec::new();
    }
    let moments: Vec<[f32; 1]> = (0..MOMENTS).map(|i| [OPENS_S * i as f32 / (MOMENTS - 1) as f32]).collect();
    let times = file.values(&moments, "SCALAR");
    file.accessors[times]["min"] = json!([0.0]);
    file.accessors[times]["max"] = json!([OPENS_S]);
    let mut animations = Vec::new();
    for (name, list) in groups {
        let (mut samplers, mut channels) = (Vec::new(), Vec::new());
        for i in list {
            let node = &world.nodes[i];
            let Some(motion) = &node.motion else { continue };
            let (path, output) = if motion.kind == JointKind::Prismatic {
                ("translation", file.values(&ways(node, motion), "VEC3"))
            } else {
                ("rotation", file.values(&turns(node, motion), "VEC4"))
            };
            channels.push(json!({"sampler": samplers.len(), "target": {"node": i, "path": path}}));
            samplers.push(json!({"input": times, "output": output, "interpolation": "LINEAR"}));
        }
        animations.push(json!({"name": format!("open {name}"), "channels": channels, "samplers": samplers}));
    }
    animations
}

/// Returns how far a motion is at each moment: it starts and ends softly.
fn positions(motion: &Motion) -> impl Iterator<Item = f64> {
    let open = motion.open();
    (0..MOMENTS).map(move |i| {
        let t = i as f64 / (MOMENTS - 1) as f64;
        open * t * t * (3.0 - 2.0 * t)
    })
}

fn ways(node: &Node, motion: &Motion) -> Vec<[f32; 3]> {
    let place = crate::affine::Affine::placed(node.at, node.turn);
    positions(motion).map(|p| y_up(place.point(motion.to(p).1)).map(|v| v as f32)).collect()
}

fn turns(node: &Node, motion: &Motion) -> Vec<[f32; 4]> {
    let turn = |p: f64| {
        let q = crate::affine::product(node.turn, motion.to(p).0);
        let [x, y, z] = y_up([q[1], q[2], q[3]]);
        [x, y, z, q[0]].map(|v| v as f32)
    };
    positions(motion).map(turn).collect()
}
