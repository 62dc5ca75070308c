//! USD as text: one component of rigid bodies with meshes, collision shapes and joints; meters, z up.

pub mod parts;
pub mod text;

use text::{Text, identifier, names, quat, schemas, triple};

use super::number::{n, small};
use super::quaternion;
use super::{check, plain};
use crate::dynamics;
use crate::error::Error;
use crate::mass::{Inertia, whole};
use crate::model3d::{Body, Model3d};

/// First day of the format's year in which assets of this form were first written: a fixed date, as the same model is the
/// same bytes on every day.
const GENERATED: &str = "2026-11-27";

/// What the asset of a world's folder says beside its model.
#[derive(Debug, Clone, PartialEq)]
pub struct AssetFacts {
    /// What it is, a word: `hospital_bed`.
    pub class: String,
    /// For people.
    pub label: String,
    /// Coefficient of sliding friction.
    pub friction: f64,
    /// Coefficient of restitution.
    pub restitution: f64,
    /// License of the model.
    pub license: String,
}

/// How the prims of a model are laid out.
enum Form<'a> {
    /// Meshes in the bodies.
    Plain,
    /// Meshes in instances of prototypes, with labels and the metadata of SimReady.
    Asset(&'a AssetFacts),
}

/// Returns the text of the layer.
///
/// # Errors
/// `Model` when the model is broken.
pub fn usda(model: &Model3d) -> Result<String, Error> {
    write(model, &Form::Plain)
}

/// Returns the text of the layer of an asset that worlds place many times: what is seen of it are instances, bodies and
/// shapes are not; with the metadata that NVIDIA's SimReady profile Robotics-Prop asks for. Its pictures lie in `textures/`
/// beside the layer.
///
/// # Errors
/// `Model` when the model is broken.
pub fn asset_usda(model: &Model3d, facts: &AssetFacts) -> Result<String, Error> {
    write(model, &Form::Asset(facts))
}

fn write(model: &Model3d, form: &Form<'_>) -> Result<String, Error> {
    check(model)?;
    let stripped;
    let model = match form {
        Form::Plain => {
            stripped = Model3d { materials: plain(&model.materials), ..model.clone() };
            &stripped
        }
        Form::Asset(_) => model,
    };
    let root = identifier(&model.name);
    let [min, max] = model.bounds().unwrap_or([[0.0; 3]; 2]);
    let class = match form {
        Form::Plain => root.to_lowercase(),
        Form::Asset(facts) => facts.class.clone(),
    };
    let moving = !model.joints.is_empty();
    let mut header = match form {
        Form::Plain => Vec::new(),
        Form::Asset(facts) => metadata(model, facts, &root),
    };
    header.extend(
        [&format!("defaultPrim = \"{root}\""), "kilogramsPerUnit = 1", "metersPerUnit = 1", "upAxis = \"Z\""]
            .map(|s: &str| s.to_owned()),
    );
    let mut apis = vec!["GeomModelAPI", "SemanticsLabelsAPI:class"];
    if moving {
        apis.push("PhysicsArticulationRootAPI");
    }
    if let Form::Asset(_) = form {
        apis.extend(["MaterialBindingAPI", "SemanticsLabelsAPI:wikidata_qcode"]);
    }
    let mut text = Text::layer(&header);
    text.prim("def Xform", &root, &[schemas(&apis), "kind = \"component\"".to_owned()], |text| {
        text.labels("class", &[&class]);
        text.line(format_args!("float3[] extentsHint = [{}, {}]", triple(min), triple(max)));
        if moving {
            // Leaves of one cupboard pass each other closer than their boxes would.
            text.line("bool physxArticulation:enabledSelfCollisions = 0");
            text.line("bool newton:selfCollisionEnabled = 0");
        }
        if let Form::Asset(facts) = form {
            text.labels("wikidata_qcode", &[QCODE]);
            text.line(format_args!("rel material:binding:physics = </{root}/Physics/Surface>"));
            rubbing(text, facts);
            prototypes(text, model, &root, &class);
        } else {
            text.prim("def Scope", "Looks", &[], |text| {
                let (names, paths) = parts::looks(&model.materials, &format!("/{root}/Looks"));
                for ((material, name), path) in model.materials.iter().zip(&names).zip(&paths) {
                    let pictures = parts::Pictures { folder: "", relief: false };
                    parts::material(text, material, &model.textures, path, name, &pictures);
                }
            });
        }
        bodies_and_joints(text, model, form, &root, &class);
    });
    Ok(text.finish())
}

/// Item of Wikidata for a physical object, which every prop is.
const QCODE: &str = "Q223557";

fn metadata(model: &Model3d, facts: &AssetFacts, root: &str) -> Vec<String> {
    let [min, max] = model.bounds().unwrap_or_default();
    let size = std::array::from_fn(|i| max[i] - min[i]);
    let shared = [
        parts::string("asset_name", root),
        parts::string("asset_type", "Prop"),
        parts::string("source_file", &format!("{root}.usda")),
        parts::string("usd_date_generated", GENERATED),
    ];
    let own = [
        parts::string("author", "d3dgen"),
        parts::string("asset_license", &facts.license),
        parts::string("category", &facts.class),
        parts::string("description", &facts.label),
        parts::string("qcode", QCODE),
        format!("int rigid_body_count = {}", model.bodies.len()),
        format!("double3 asset_extents = {}", triple(size)),
        format!("double mass = {}", small(whole(model).mass_kg)),
    ];
    let mut lines = vec!["customLayerData = {".to_owned()];
    lines.extend(shared.iter().map(|l| format!("    {l}")));
    lines.push("    dictionary SimReady_Metadata = {".to_owned());
    lines.extend(shared.iter().chain(&own).map(|l| format!("        {l}")));
    lines.extend(["    }".to_owned(), "}".to_owned()]);
    lines
}

/// Writes how its surface rubs.
fn rubbing(text: &mut Text, facts: &AssetFacts) {
    text.prim("def Scope", "Physics", &[], |text| {
        let api = schemas(&["PhysicsMaterialAPI", "SemanticsLabelsAPI:material"]);
        text.prim("def Material", "Surface", &[api], |text| {
            text.labels("material", &["surface"]);
            text.line(format_args!("float physics:staticFriction = {}", n(facts.friction)));
            text.line(format_args!("float physics:dynamicFriction = {}", n(facts.friction)));
            text.line(format_args!("float physics:restitution = {}", n(facts.restitution)));
        });
    });
}

/// Writes what is seen of each body, with its materials, once for all instances.
fn prototypes(text: &mut Text, model: &Model3d, root: &str, class: &str) {
    let bodies = body_names(model);
    text.prim("class Scope", "Prototypes", &[], |text| {
        for (body, name) in model.bodies.iter().zip(&bodies) {
            prototype(text, model, body, &format!("/{root}/Prototypes/{name}"), class, "./textures/");
        }
    });
}

/// Writes what is seen of a body with its materials, as a prim that instances refer to; `path` is its own path, its pictures
/// lie in `folder`.
pub fn prototype(text: &mut Text, model: &Model3d, body: &Body, path: &str, class: &str, folder: &str) {
    let used: std::collections::BTreeSet<usize> = body.visuals.iter().filter_map(|v| v.material).collect();
    let name = path.rsplit('/').next().unwrap_or(path);
    text.prim("def Xform", name, &[], |text| {
        let (names, paths) = parts::looks(&model.materials, &format!("{path}/Looks"));
        text.prim("def Scope", "Looks", &[], |text| {
            for i in used {
                let pictures = parts::Pictures { folder, relief: false };
                parts::material(text, &model.materials[i], &model.textures, &paths[i], &names[i], &pictures);
            }
        });
        let meshes = names_of(body);
        for (visual, name) in body.visuals.iter().zip(&meshes) {
            parts::mesh(text, visual, &model.materials, name, &paths, class);
        }
    });
}

fn names_of(body: &Body) -> Vec<String> {
    names("Looks", body.visuals.iter().map(|v| v.name.as_str()))
}

/// Returns the picture files that the materials of a model wear, by name.
pub fn pictures(model: &Model3d) -> Vec<super::ModelFile> {
    let mut files: Vec<super::ModelFile> = Vec::new();
    for picture in model.materials.iter().filter_map(|m| super::picture_of(m, &model.textures)) {
        if files.iter().all(|f| f.name != picture.name) {
            files.push(super::ModelFile { name: picture.name, bytes: picture.bytes.to_vec() });
        }
    }
    files
}

/// Returns the name of the prim of a model's first body, the one that stands.
pub fn base_name(model: &Model3d) -> String {
    body_names(model).into_iter().next().unwrap_or_default()
}

/// Returns the names of the prims of a model's bodies, in their order.
pub fn body_names(model: &Model3d) -> Vec<String> {
    let all = names("Looks", model.bodies.iter().map(|b| b.name.as_str()));
    let scopes = ["Physics", "Prototypes"];
    all.into_iter().map(|n| if scopes.contains(&n.as_str()) { format!("{n}_body") } else { n }).collect()
}

fn bodies_and_joints(text: &mut Text, model: &Model3d, form: &Form<'_>, root: &str, class: &str) {
    let bodies = body_names(model);
    let borne = dynamics::borne(model);
    for ((body, inertia), name) in model.bodies.iter().zip(&borne.bodies).zip(&bodies) {
        write_body(text, model, (body, inertia), name, form, root, class);
    }
    if model.joints.is_empty() {
        return;
    }
    // To the root prim and not to the world: the joint moves with the model that a scene places.
    text.prim("def PhysicsFixedJoint", "root_joint", &[], |text| {
        text.line(format_args!("rel physics:body0 = </{root}>"));
        text.line(format_args!("rel physics:body1 = </{root}/{}>", bodies[0]));
    });
    let paths: Vec<String> = bodies.iter().map(|b| format!("/{root}/{b}")).collect();
    let joints = names("root_joint", model.joints.iter().map(|j| j.name.as_str()));
    for ((joint, resists), name) in model.joints.iter().zip(borne.joints).zip(&joints) {
        parts::joint(text, joint, resists, name, &paths);
    }
}

fn write_body(
    text: &mut Text,
    model: &Model3d,
    (body, inertia): (&Body, &Inertia),
    name: &str,
    form: &Form<'_>,
    root: &str,
    class: &str,
) {
    let (moments, axes) = inertia.principal();
    let moments = moments.map(|v| small(v.max(1e-9)));
    let apis = schemas(&["PhysicsRigidBodyAPI", "PhysicsMassAPI", "SemanticsLabelsAPI:class"]);
    text.prim("def Xform", name, &[apis], |text| {
        text.labels("class", &[class]);
        if model.joints.is_empty() && matches!(form, Form::Plain) {
            // Stands where it is put, as furniture does for a robot; set to 0 to let it be pushed.
            text.line("bool physics:kinematicEnabled = 1");
        }
        text.line(format_args!("float physics:mass = {}", small(inertia.mass_kg)));
        text.line(format_args!("point3f physics:centerOfMass = {}", triple(inertia.center_m)));
        text.line(format_args!("float3 physics:diagonalInertia = ({}, {}, {})", moments[0], moments[1], moments[2]));
        text.line(format_args!("quatf physics:principalAxes = {}", quat(quaternion(axes))));
        let taken = (0..body.collisions.len()).map(|i| format!("collision_{i}"));
        let all: Vec<String> = taken.chain(body.visuals.iter().map(|v| v.name.clone())).collect();
        let all = names("visual", all.iter().map(String::as_str));
        let (shapes, visuals) = all.split_at(body.collisions.len());
        if let Form::Asset(_) = form {
            let reference = format!("prepend references = </{root}/Prototypes/{name}>");
            text.prim("def Xform", "visual", &["instanceable = true".to_owned(), reference], |_| {});
        } else {
            let (_, paths) = parts::looks(&model.materials, &format!("/{root}/Looks"));
            for (visual, name) in body.visuals.iter().zip(visuals) {
                parts::mesh(text, visual, &model.materials, name, &paths, class);
            }
        }
        for (shape, name) in body.collisions.iter().zip(shapes) {
            parts::collision(text, shape, name, class);
        }
    });
}
