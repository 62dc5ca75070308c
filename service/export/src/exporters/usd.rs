//! A world for Isaac Sim and others that read USD: `usd/world.usda` with the models that it places, the same in one file, and
//! beside it what Isaac Lab starts from.
//!
//! Colliders are boxes and convex parts only; what is seen of models are instances, bodies and joints are not.

mod building;
mod lab;
mod objects;

use std::collections::BTreeMap;

use d3dgen_mesh::writers::usd::parts::{self, Pictures};
use d3dgen_mesh::writers::usd::text::{Text, identifier, schemas};
use d3dgen_mesh::writers::{self, ModelFile};
use d3dgen_mesh::{World3d, finish};
use serde_json::Value;

use super::Exporter;
use crate::error::Error;
use crate::file::File;
use crate::scene::{SimDoor, SimLeaf, SimScene};
use crate::subject::Subject;
use crate::view;

/// The exporter.
pub struct Usd;

/// Folder of all files.
const ROOT: &str = "usd";
/// Folder of the pictures of floors and walls beside the layer.
const TEXTURES: &str = "./textures/";
/// Friction and restitution of the building.
const BUILDING_FRICTION: f64 = 0.8;
/// Groups of colliders: the building with what is fixed to it, its doors, and doors and drawers of what is fixed.
const STRUCTURAL: &str = "Structural";
const LEAVES: &str = "Leaves";
const ARTICULABLE: &str = "Articulable";

impl Exporter for Usd {
    fn name(&self) -> &'static str {
        "usd"
    }

    fn about(&self) -> &'static str {
        "USD for Isaac Sim: world with physics, joints, labels, materials and lamps; one-file usdz; Isaac Lab scene"
    }

    fn roots(&self) -> &'static [&'static str] {
        &[ROOT]
    }

    fn export(&self, subject: &Subject<'_>) -> Result<Vec<File>, Error> {
        let scene = subject.scene()?;
        let seen = view::world3d(scene)?;
        let assets = objects::Assets::of(scene);
        let mut layers =
            vec![ModelFile { name: "world.usda".to_owned(), bytes: layer(scene, &seen, &assets)?.into_bytes() }];
        layers.extend(pictures(&seen));
        let objects = assets.files(scene)?;
        // Thumbnails are for catalogs; a package holds what is loaded.
        let packed: Vec<ModelFile> =
            layers.iter().chain(objects.iter().filter(|f| !f.name.contains("/.thumbs/"))).cloned().collect();
        let mut files: Vec<File> =
            layers.into_iter().chain(objects).map(|f| File::new(format!("{ROOT}/{}", f.name), f.bytes)).collect();
        files.push(File::new(format!("{ROOT}/world.usdz"), writers::pack(&packed)));
        files.push(File::new(format!("{ROOT}/manifest.json"), json_text(&manifest(scene, &assets))));
        files.push(File::new(format!("{ROOT}/paths.json"), json_text(&scene.paths())));
        files.extend(lab::files(scene));
        files.sort_by(|a, b| a.path.cmp(&b.path));
        Ok(files)
    }

    fn places(&self, scene: &SimScene, _: &[File]) -> Vec<(String, String)> {
        places(scene).into_iter().map(|(id, path)| (id.to_owned(), path)).collect()
    }
}

fn json_text(value: &Value) -> String {
    serde_json::to_string_pretty(value).unwrap_or_default() + "\n"
}

/// Returns the pictures that the building wears.
fn pictures(seen: &World3d) -> Vec<ModelFile> {
    let mut files = BTreeMap::new();
    for finish in seen.materials.iter().filter_map(|m| m.finish.as_deref()).filter_map(finish::get) {
        let pictures = finish.pictures();
        let folder = TEXTURES.trim_start_matches("./");
        files.insert(format!("{folder}{}.png", finish.id), pictures.color.clone());
        if let Some(normal) = &pictures.normal {
            files.insert(format!("{folder}{}_normal.png", finish.id), normal.clone());
        }
    }
    files.into_iter().map(|(name, bytes)| ModelFile { name, bytes }).collect()
}

/// Returns the layer of the world.
fn layer(scene: &SimScene, seen: &World3d, assets: &objects::Assets) -> Result<String, Error> {
    let header = ["defaultPrim = \"World\"", "kilogramsPerUnit = 1", "metersPerUnit = 1", "upAxis = \"Z\""];
    let mut text = Text::layer(&header.map(str::to_owned));
    let apis = schemas(&["MaterialBindingAPI", "SemanticsLabelsAPI:class"]);
    let mut failed = None;
    text.prim("def Xform", "World", &[apis, "kind = \"assembly\"".to_owned()], |text| {
        text.labels("class", &["building"]);
        text.line("rel material:binding:physics = </World/Physics/Building>");
        physics(text, scene, assets);
        let looks = looks(text, seen);
        let building = building::Building { scene, seen, looks: &looks };
        failed = building.write(text).err();
        assets.write(text, scene);
        lamps(text, scene);
        zones(text, scene);
    });
    failed.map_or_else(|| Ok(text.finish()), Err)
}

/// Writes gravity, how the building rubs, and what does not collide.
///
/// As within one articulation, what stands beside a cupboard does not jam its doors and drawers: they meet what can be moved and
/// robots, not the building with its doors, what stands fast, and each other.
fn physics(text: &mut Text, scene: &SimScene, assets: &objects::Assets) {
    text.prim("def PhysicsScene", "PhysicsScene", &[], |text| {
        text.line("vector3f physics:gravityDirection = (0, 0, -1)");
        text.line("float physics:gravityMagnitude = 9.81");
    });
    text.prim("def Scope", "Physics", &[], |text| {
        let api = schemas(&["PhysicsMaterialAPI", "SemanticsLabelsAPI:material"]);
        text.prim("def Material", "Building", &[api], |text| {
            text.labels("material", &["building"]);
            text.line(format_args!("float physics:staticFriction = {BUILDING_FRICTION}"));
            text.line(format_args!("float physics:dynamicFriction = {BUILDING_FRICTION}"));
            text.line("float physics:restitution = 0.1");
        });
        let [mut still, moving] = assets.fixed(scene);
        let frames = scene.doors.iter().map(|d| format!("/World/Doors/{}/frame", identifier(&d.id)));
        let parts = ["Ground", "Rooms", "Walls", "Windows"].map(|part| format!("/World/{part}"));
        still.extend(parts.into_iter().chain(frames));
        // What stands fast never meets itself; engines that count groups need to be told.
        collision_group(text, STRUCTURAL, &still, &[STRUCTURAL]);
        let leaf =
            |door: &SimDoor, leaf: &SimLeaf| format!("/World/Doors/{}/{}", identifier(&door.id), identifier(&leaf.id));
        let leaves: Vec<String> = scene.doors.iter().flat_map(|d| d.leaves.iter().map(move |l| leaf(d, l))).collect();
        collision_group(text, LEAVES, &leaves, &[]);
        collision_group(text, ARTICULABLE, &moving, &[ARTICULABLE, LEAVES, STRUCTURAL]);
    });
}

/// Writes a group of colliders and the groups that it does not meet.
fn collision_group(text: &mut Text, name: &str, paths: &[String], passes: &[&str]) {
    let targets =
        |paths: &mut dyn Iterator<Item = String>| paths.map(|p| format!("<{p}>")).collect::<Vec<_>>().join(", ");
    text.prim("def PhysicsCollisionGroup", name, &[schemas(&["CollectionAPI:colliders"])], |text| {
        text.line(format_args!("rel collection:colliders:includes = [{}]", targets(&mut paths.iter().cloned())));
        if !passes.is_empty() {
            let groups = &mut passes.iter().map(|group| format!("/World/Physics/{group}"));
            text.line(format_args!("rel physics:filteredGroups = [{}]", targets(groups)));
        }
    });
}

/// Writes the materials that meshes of the building wear, and returns the path of every material of the view.
fn looks(text: &mut Text, seen: &World3d) -> Vec<String> {
    let (names, paths) = parts::looks(&seen.materials, "/World/Looks");
    let used = building::materials(seen);
    text.prim("def Scope", "Looks", &[], |text| {
        for (i, material) in seen.materials.iter().enumerate().filter(|(i, _)| used.contains(i)) {
            let pictures = Pictures { folder: TEXTURES, relief: true };
            parts::material(text, material, &seen.textures, &paths[i], &names[i], &pictures);
        }
    });
    paths
}

/// Writes lamps, the sun and the sky.
fn lamps(text: &mut Text, scene: &SimScene) {
    text.prim("def Scope", "Lights", &[], |text| {
        text.prim("def DistantLight", "sun", &[], |text| {
            text.line("float inputs:angle = 0.53");
            text.line("float inputs:intensity = 1500");
            text.line("bool inputs:enableColorTemperature = 1");
            text.line("float inputs:colorTemperature = 5600");
            text.line("float3 xformOp:rotateXYZ = (35, 25, 0)");
            text.line("uniform token[] xformOpOrder = [\"xformOp:rotateXYZ\"]");
        });
        text.prim("def DomeLight", "sky", &[], |text| {
            text.line("float inputs:intensity = 600");
            text.line("color3f inputs:color = (0.85, 0.92, 1)");
        });
        for light in &scene.lights {
            text.prim("def SphereLight", &identifier(&light.id), &[], |text| {
                let radius = 0.06_f64;
                // UsdLux gives luminance: flux over the surface of the sphere and over pi.
                let luminance = light.lumens / (4.0 * std::f64::consts::PI * radius * radius * std::f64::consts::PI);
                text.line(format_args!("float inputs:radius = {radius}"));
                text.line(format_args!("float inputs:intensity = {}", luminance.round()));
                text.line("bool inputs:enableColorTemperature = 1");
                text.line(format_args!("float inputs:colorTemperature = {}", light.kelvin.round()));
                text.placed(light.at_m, None);
            });
        }
    });
}

/// Writes the zones of robots, which only people who ask for guides see.
fn zones(text: &mut Text, scene: &SimScene) {
    text.prim("def Scope", "Zones", &[], |text| {
        for zone in &scene.zones {
            building::zone(text, zone);
        }
    });
}

/// Returns where the stage has what an id names.
fn places(scene: &SimScene) -> BTreeMap<&str, String> {
    let scope = |kind: &str| match kind {
        "room" => Some("Rooms"),
        "wall" => Some("Walls"),
        "door" => Some("Doors"),
        "window" => Some("Windows"),
        "object" => Some("Objects"),
        "light" => Some("Lights"),
        "zone" => Some("Zones"),
        _ => None,
    };
    let place = |(id, kind)| Some((id, format!("/World/{}/{}", scope(kind)?, identifier(id))));
    scene.ids().into_iter().filter_map(place).collect()
}

/// Returns what the stage holds, in the form in which checks of simulators read it.
fn manifest(scene: &SimScene, assets: &objects::Assets) -> Value {
    let places = places(scene);
    let mut manifest = scene.world_manifest(|id| places.get(id).cloned().unwrap_or_default());
    // What is fixed but has doors or drawers has bodies that move.
    if let Some(objects) = manifest["objects"].as_array_mut() {
        for (entry, object) in objects.iter_mut().zip(&scene.objects) {
            entry["dynamic"] = assets.has_bodies(object).into();
        }
    }
    manifest
}

#[cfg(test)]
mod tests;
