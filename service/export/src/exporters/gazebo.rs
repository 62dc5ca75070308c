//! Gazebo's world: `gazebo/world.sdf` (SDF 1.9) with `model://` folders, doors that a controller opens, labels, lights, and a
//! launch file with a bridge for ROS 2.
//!
//! Walls and floors are one static model with few collisions, ceilings another that can be hidden. A door has a joint and a
//! controller where the route of a robot passes it; other doors inside stand open and those that lead out are shut. In a world
//! without routes every door has its joint. Things keep their drawers and doors shut.

mod building;
mod doors;
mod ros;

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_mesh::coarse;
use d3dgen_mesh::writers;
use d3dgen_mesh::writers::number::n;
use serde_json::json;

use super::Exporter;
use super::mujoco::json_text;
use crate::error::Error;
use crate::file::File;
use crate::scene::{Mobility, SimModel, SimObject, SimScene};
use crate::subject::Subject;
use crate::xml::Xml;

/// The first label of things; 0 is what has none, 1 to 4 is the building.
const FIRST_LABEL: usize = 10;

/// Writes the Gazebo world.
pub struct Gazebo;

impl Exporter for Gazebo {
    fn name(&self) -> &'static str {
        "gazebo"
    }

    fn about(&self) -> &'static str {
        "Gazebo world: SDF 1.9 with model folders, doors with controllers, labels, lights, launch file and bridge for ROS 2"
    }

    fn roots(&self) -> &'static [&'static str] {
        &["gazebo"]
    }

    fn export(&self, subject: &Subject<'_>) -> Result<Vec<File>, Error> {
        let scene = subject.scene()?;
        let labels = labels(scene);
        let mut files = Vec::new();
        for model in &scene.models {
            files.extend(folder(model, scene)?);
        }
        files.extend(building::meshes(scene));
        files.push(File::new("gazebo/world.sdf", document(scene, &labels)));
        let named: BTreeMap<String, &str> = labels.iter().map(|(class, label)| (label.to_string(), *class)).collect();
        files.push(File::new("gazebo/labels.json", json_text(&json!(named))));
        files.push(File::new("gazebo/paths.json", json_text(&scene.paths())));
        files.push(File::new("gazebo/manifest.json", json_text(&scene.world_manifest(|id| place(scene, id)))));
        files.extend(ros::files(scene));
        files.sort_by(|a, b| a.path.cmp(&b.path));
        Ok(files)
    }

    fn places(&self, scene: &SimScene, _: &[File]) -> Vec<(String, String)> {
        let ids = scene.ids().into_iter().filter(|(_, kind)| !matches!(*kind, "zone" | "robot"));
        ids.map(|(id, _)| (id.to_owned(), place(scene, id))).collect()
    }
}

/// Returns where the world has what an id names: a model, or a visual of one.
fn place(scene: &SimScene, id: &str) -> String {
    let own = scene.doors.iter().any(|d| d.id == id) || scene.objects.iter().any(|o| o.id == id);
    let light = scene.lights.iter().any(|l| l.id == id);
    if own || light { id.to_owned() } else { format!("building::{id}") }
}

/// Returns the number that a segmentation camera sees for each class.
fn labels(scene: &SimScene) -> BTreeMap<&str, usize> {
    let building = [("floor", 1), ("wall", 2), ("ceiling", 3), ("door", 4), ("window", 5)];
    let mut classes: Vec<&str> = scene.objects.iter().map(|o| o.class.as_str()).collect();
    classes.sort_unstable();
    classes.dedup();
    building.into_iter().chain(classes.into_iter().enumerate().map(|(i, class)| (class, FIRST_LABEL + i))).collect()
}

/// Returns the `model://` folder of a model: one rigid body that an include may fix.
fn folder(model: &SimModel, scene: &SimScene) -> Result<Vec<File>, Error> {
    let id = &model.id;
    let mut own = d3dgen_mesh::model3d::welded(&model.model);
    own.name.clone_from(id);
    own.bodies.iter_mut().for_each(|b| b.name.clone_from(id));
    let index = scene.models.iter().position(|m| m.id == *id);
    if !index.is_some_and(|i| bears_things(scene, i)) {
        // The parser and the engine take their time for each shape.
        own.bodies.iter_mut().for_each(|b| b.collisions = coarse::few(std::mem::take(&mut b.collisions)));
    }
    let first = scene.objects.iter().find(|o| Some(o.model) == index);
    let friction = first.map_or(0.5, |o| o.friction);
    if first.is_some_and(|o| !o.collides) {
        own.bodies.iter_mut().for_each(|b| b.collisions.clear());
    }
    let (text, meshes) = writers::sdf_body(&own, &format!("model://{id}/meshes"), friction)
        .map_err(|source| Error::Asset { asset: model.reference.clone(), source })?;
    let mut xml = Xml::new("A model of d3dgen.");
    xml.begin("model", &[]);
    xml.text("name", &[], id);
    xml.text("version", &[], "1.0");
    xml.text("sdf", &[("version", "1.9".to_owned())], "model.sdf");
    xml.text("description", &[], &format!("{} ({})", model.object, model.reference));
    let at = format!("gazebo/models/{id}");
    let mut files =
        vec![File::new(format!("{at}/model.config"), xml.finish()), File::new(format!("{at}/model.sdf"), text)];
    files.extend(meshes.into_iter().map(|f| File::new(format!("{at}/meshes/{}", f.name), f.bytes)));
    Ok(files)
}

/// Returns whether anything stands on an instance of a model, whose top then is where it is.
fn bears_things(scene: &SimScene, model: usize) -> bool {
    let supports: BTreeSet<&str> = scene.objects.iter().filter_map(|o| o.support.as_deref()).collect();
    scene.objects.iter().any(|o| o.model == model && supports.contains(o.id.as_str()))
}

fn document(scene: &SimScene, labels: &BTreeMap<&str, usize>) -> String {
    let mut xml =
        Xml::new("Made by d3dgen. Models are named by the ids of manifest.json; hide the model `ceilings` to look in.");
    xml.begin("sdf", &[("version", "1.9".to_owned())]);
    xml.begin("world", &[("name", scene.name.clone())]);
    xml.text("gravity", &[], "0 0 -9.81");
    xml.begin("physics", &[("name", "default".to_owned()), ("type", "ignored".to_owned())]);
    xml.text("max_step_size", &[], "0.001");
    xml.text("real_time_factor", &[], "1.0");
    xml.end();
    for (file, class) in [
        ("gz-sim-physics-system", "Physics"),
        ("gz-sim-user-commands-system", "UserCommands"),
        ("gz-sim-scene-broadcaster-system", "SceneBroadcaster"),
        ("gz-sim-contact-system", "Contact"),
    ] {
        xml.leaf("plugin", &[("filename", file.to_owned()), ("name", format!("gz::sim::systems::{class}"))]);
    }
    xml.begin("plugin", &[("filename", "gz-sim-sensors-system".into()), ("name", "gz::sim::systems::Sensors".into())]);
    xml.text("render_engine", &[], "ogre2");
    xml.end();
    building::lights(&mut xml, scene);
    building::models(&mut xml, scene, labels);
    for door in &scene.doors {
        doors::model(&mut xml, scene, door, labels);
    }
    for object in &scene.objects {
        thing(&mut xml, scene, object, labels);
    }
    xml.finish()
}

fn thing(xml: &mut Xml, scene: &SimScene, object: &SimObject, labels: &BTreeMap<&str, usize>) {
    let Some(model) = scene.models.get(object.model) else { return };
    xml.begin("include", &[]);
    xml.text("uri", &[], &format!("model://{}", model.id));
    xml.text("name", &[], &object.id);
    if object.mobility == Mobility::Fixed {
        xml.text("static", &[], "true");
    }
    let [x, y, z] = object.at_m.map(n);
    xml.text("pose", &[], &format!("{x} {y} {z} 0 0 {}", n(object.yaw_rad)));
    if let Some(number) = labels.get(object.class.as_str()) {
        label(xml, *number);
    }
    xml.end();
}

/// Writes the label that segmentation cameras see.
fn label(xml: &mut Xml, number: usize) {
    xml.begin("plugin", &[("filename", "gz-sim-label-system".into()), ("name", "gz::sim::systems::Label".into())]);
    xml.text("label", &[], &number.to_string());
    xml.end();
}

#[cfg(test)]
mod tests;
