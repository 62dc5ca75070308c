//! MuJoCo's world: `mujoco/world.xml` with its meshes, `scene.py` that steps it with a robot, and what its checks read.
//!
//! In the manner of MolmoSpaces: default classes `visual`, `structural`, `dynamic` and `articulable`, walls as boxes with the
//! openings cut, things that can be moved on free joints, doors and drawers on hinges and slides. Body and joint names are the
//! ids of the scene; the joint of a thing is `<thing>_<joint of its model>`.

mod bodies;
mod building;
mod meshes;

use d3dgen_mesh::writers::number::n;

use super::Exporter;
use crate::error::Error;
use crate::file::File;
use crate::scene::{SimBox, SimScene, SimShape};
use crate::subject::Subject;
use crate::xml::Xml;

/// Step of the simulation, s.
const STEP_S: &str = "0.002";
/// How a stop of a joint gives: in two steps, the fewest that the engine can follow, without swinging back.
const HARD_STOP: &str = "0.004 1";

/// Writes the MuJoCo world.
pub struct Mujoco;

impl Exporter for Mujoco {
    fn name(&self) -> &'static str {
        "mujoco"
    }

    fn about(&self) -> &'static str {
        "MuJoCo world: MJCF with meshes, doors and things that move, a Gymnasium environment and paths to check it"
    }

    fn roots(&self) -> &'static [&'static str] {
        &["mujoco"]
    }

    fn export(&self, subject: &Subject<'_>) -> Result<Vec<File>, Error> {
        let scene = subject.scene()?;
        let mut files = meshes::files(scene);
        files.push(File::new("mujoco/world.xml", document(scene)));
        files.push(File::new("mujoco/scene.py", include_str!("../../data/mujoco/scene.py")));
        files.push(File::new("mujoco/paths.json", json_text(&scene.paths())));
        files.push(File::new("mujoco/manifest.json", json_text(&scene.world_manifest(|id| id.to_owned()))));
        files.sort_by(|a, b| a.path.cmp(&b.path));
        Ok(files)
    }

    fn places(&self, scene: &SimScene, _: &[File]) -> Vec<(String, String)> {
        scene.ids().into_iter().map(|(id, _)| (id.to_owned(), id.to_owned())).collect()
    }
}

/// Returns a document as indented JSON with a final line break.
pub(super) fn json_text(value: &serde_json::Value) -> String {
    let mut text = serde_json::to_string_pretty(value).unwrap_or_default();
    text.push('\n');
    text
}

/// What is written besides the bodies: pairs that do not collide, and the joint positions of a world whose doors are closed
/// and of one whose doors robots find open.
#[derive(Default)]
struct Rest {
    excludes: Vec<[String; 2]>,
    closed: Vec<f64>,
    open: Vec<f64>,
}

fn document(scene: &SimScene) -> String {
    let mut xml =
        Xml::new("Made by d3dgen. Bodies are named by the ids of manifest.json; lengths in m, angles in rad.");
    xml.begin("mujoco", &[("model", scene.name.clone())]);
    let compiler = [("angle", "radian"), ("autolimits", "true"), ("meshdir", "models"), ("texturedir", "models")];
    xml.leaf("compiler", &compiler.map(|(k, v)| (k, v.to_owned())));
    let option = [
        ("timestep", STEP_S),
        ("integrator", "implicitfast"),
        ("cone", "elliptic"),
        ("impratio", "10"),
        ("noslip_iterations", "3"),
    ];
    xml.leaf("option", &option.map(|(k, v)| (k, v.to_owned())));
    defaults(&mut xml);
    xml.begin("asset", &[]);
    building::assets(&mut xml, scene);
    meshes::assets(&mut xml, scene);
    xml.end();
    let mut rest = Rest::default();
    xml.begin("worldbody", &[]);
    building::lights(&mut xml, scene);
    building::bodies(&mut xml, scene, &mut rest);
    for object in &scene.objects {
        bodies::thing(&mut xml, scene, object, &mut rest);
    }
    bodies::passes(scene, &mut rest);
    building::sites(&mut xml, scene);
    xml.end();
    xml.begin("contact", &[]);
    for [a, b] in &rest.excludes {
        xml.leaf("exclude", &[("body1", a.clone()), ("body2", b.clone())]);
    }
    xml.end();
    if !rest.closed.is_empty() {
        xml.begin("keyframe", &[]);
        for (name, positions) in [("doors_closed", &rest.closed), ("doors_open", &rest.open)] {
            let positions: Vec<String> = positions.iter().map(|v| n(*v)).collect();
            xml.leaf("key", &[("name", name.to_owned()), ("qpos", positions.join(" "))]);
        }
        xml.end();
    }
    xml.finish()
}

/// The default classes; group 2 is seen, group 3 collides.
///
/// Drawers and doors of furniture (`articulable`) meet what can be moved and robots, not the building, doors of rooms, other
/// furniture and each other: as within one body of an articulation, what stands beside a cupboard does not jam it. Doors of
/// rooms meet the building and furniture too. By the engine's rule two shapes meet when the type of one is among the affinities
/// of the other.
fn defaults(xml: &mut Xml) {
    let geom = |pairs: &[(&'static str, &str)]| pairs.iter().map(|(k, v)| (*k, (*v).to_owned())).collect::<Vec<_>>();
    let classes = [
        ("visual", geom(&[("type", "mesh"), ("group", "2"), ("contype", "0"), ("conaffinity", "0"), ("mass", "0")])),
        (
            "structural",
            geom(&[
                ("type", "box"),
                ("group", "0"),
                ("contype", "5"),
                ("conaffinity", "2"),
                ("friction", "0.8 0.005 0.0001"),
            ]),
        ),
        ("dynamic", geom(&[("type", "box"), ("group", "3"), ("condim", "4"), ("rgba", "0.6 0.6 0.6 1")])),
        (
            "articulable",
            geom(&[("type", "box"), ("group", "3"), ("contype", "1"), ("conaffinity", "0"), ("rgba", "0.6 0.6 0.6 1")]),
        ),
    ];
    xml.begin("default", &[]);
    for (class, attributes) in classes {
        xml.begin("default", &[("class", class.to_owned())]);
        xml.leaf("geom", &attributes);
        if class == "articulable" {
            // Friction of joints is dry, and their stops are hard: the engine's usual ones let them creep, and light lids go on.
            let dry = ("solimpfriction", "0.9999 0.9999 0.001 0.5 2".to_owned());
            let hard = [("solimplimit", "0.99 0.999 0.001 0.5 2"), ("solreflimit", HARD_STOP)];
            xml.leaf("joint", &[dry].into_iter().chain(hard.map(|(k, v)| (k, v.to_owned()))).collect::<Vec<_>>());
        }
        xml.end();
    }
    xml.end();
}

/// Returns figures with spaces between them.
fn list(values: &[f64]) -> String {
    values.iter().map(|v| n(*v)).collect::<Vec<_>>().join(" ")
}

/// Returns the quaternion of a turn about z.
fn about_z(yaw_rad: f64) -> [f64; 4] {
    let (sin, cos) = (yaw_rad / 2.0).sin_cos();
    [cos, 0.0, 0.0, sin]
}

/// Returns the attributes of a box as a geom, moved by `-origin`.
fn box_geom(b: &SimBox, origin: [f64; 3]) -> Vec<(&'static str, String)> {
    let at: Vec<f64> = (0..3).map(|i| b.center_m[i] - origin[i]).collect();
    let mut attributes = vec![("pos", list(&at)), ("size", list(&b.half_m))];
    if b.yaw_rad.abs() > 1e-12 {
        attributes.push(("quat", list(&about_z(b.yaw_rad))));
    }
    attributes
}

/// Returns the attributes of a convex piece of the building: a box, or the mesh of this name.
fn shape_geom(shape: &SimShape, mesh: &str) -> Vec<(&'static str, String)> {
    match shape {
        SimShape::Box(b) => box_geom(b, [0.0; 3]),
        SimShape::Prism { .. } => vec![("type", "mesh".to_owned()), ("mesh", mesh.to_owned())],
    }
}

#[cfg(test)]
mod tests;
