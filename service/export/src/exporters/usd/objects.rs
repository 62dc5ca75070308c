//! Things: an asset for each model, with its metadata, pictures and thumbnail, and a place in the world for each thing.

use std::collections::BTreeMap;

use d3dgen_mesh::picture::{Ground, View, render};
use d3dgen_mesh::world3d::yaw;
use d3dgen_mesh::writers::ModelFile;
use d3dgen_mesh::writers::usd::text::{Text, identifier, quoted, schemas};
use d3dgen_mesh::writers::usd::{AssetFacts, asset_usda, base_name, body_names, pictures};
use d3dgen_mesh::{Body, Model3d, dynamics};

use crate::error::Error;
use crate::scene::{Mobility, SimObject, SimScene};

/// Side of a thumbnail, px: what SimReady asks for.
const THUMBNAIL_PX: usize = 256;
/// Lightest body with a joint of its own, kg.
const LEAST_KG: f64 = 0.3;
/// License of models that are made; of those that a database keeps nothing is claimed: theirs is that of their source.
const LICENSE: &str = "CC0-1.0";
const LICENSE_OF_SOURCE: &str = "NOASSERTION";

/// The models of a scene as assets, in its order.
pub(super) struct Assets(Vec<Model3d>);

impl Assets {
    /// Returns the assets of a scene.
    pub fn of(scene: &SimScene) -> Self {
        Self(scene.models.iter().map(|m| Model3d { name: identifier(&m.id), ..welded(&m.model) }).collect())
    }

    /// Returns the models as they are written.
    #[cfg(test)]
    pub fn models(&self) -> &[Model3d] {
        &self.0
    }

    /// Returns the files of all models, below `models/`.
    ///
    /// # Errors
    /// `Model` when a model cannot be written.
    pub fn files(&self, scene: &SimScene) -> Result<Vec<ModelFile>, Error> {
        let mut files = Vec::new();
        for (i, (known, own)) in scene.models.iter().zip(&self.0).enumerate() {
            let object = scene.objects.iter().find(|o| o.model == i);
            let facts = AssetFacts {
                class: known.object.clone(),
                label: object.map_or(known.object.clone(), |o| o.label.clone()),
                friction: object.map_or(0.5, |o| o.friction),
                restitution: object.map_or(0.1, |o| o.restitution),
                license: if known.is_kept { LICENSE_OF_SOURCE } else { LICENSE }.to_owned(),
            };
            let name = &own.name;
            let folder = format!("models/{name}/usd");
            let layer = asset_usda(own, &facts)?;
            files.push(ModelFile { name: format!("{folder}/{name}.usda"), bytes: layer.into_bytes() });
            let picture = render(own, THUMBNAIL_PX, &View { ground: Ground::White, ..View::default() });
            files.push(ModelFile {
                name: format!("{folder}/.thumbs/{THUMBNAIL_PX}x{THUMBNAIL_PX}/{name}.usda.png"),
                bytes: picture.png()?,
            });
            let worn = pictures(own).into_iter();
            files.extend(worn.map(|p| ModelFile { name: format!("{folder}/textures/{}", p.name), bytes: p.bytes }));
        }
        Ok(files)
    }

    /// Returns whether anything of a thing can move.
    pub fn has_bodies(&self, object: &SimObject) -> bool {
        object.mobility != Mobility::Fixed || self.is_articulated(object)
    }

    fn is_articulated(&self, object: &SimObject) -> bool {
        self.0.get(object.model).is_some_and(|m| !m.joints.is_empty())
    }

    /// Returns the paths of what stands fast, and those of doors, drawers, lids and lifts of all things.
    pub fn fixed(&self, scene: &SimScene) -> [Vec<String>; 2] {
        let [mut still, mut moving] = [Vec::new(), Vec::new()];
        for object in &scene.objects {
            let Some(model) = self.0.get(object.model) else { continue };
            let (place, is_fixed) =
                (format!("/World/Objects/{}", identifier(&object.id)), object.mobility == Mobility::Fixed);
            if model.joints.is_empty() {
                still.extend(is_fixed.then_some(place));
                continue;
            }
            let bearing = dynamics::bearing(model);
            for (k, body) in body_names(model).into_iter().enumerate() {
                let path = format!("{place}/{body}");
                match (k, is_fixed) {
                    (0, true) => still.push(path),
                    (_, false) if bearing.contains(&k) => {}
                    (_, _) => moving.push(path),
                }
            }
        }
        [still, moving]
    }

    /// Writes the things.
    pub fn write(&self, text: &mut Text, scene: &SimScene) {
        text.prim("def Xform", "Objects", &["kind = \"group\"".to_owned()], |text| {
            for (i, object) in scene.objects.iter().enumerate() {
                self.place(text, object, &self.passes(scene, i));
            }
        });
    }

    /// Returns the bodies of a thing that pass others, and the paths of these.
    fn passes(&self, scene: &SimScene, index: usize) -> BTreeMap<String, Vec<String>> {
        let prim = |object: &SimObject, body: &str| {
            let model = self.0.get(object.model)?;
            let at = model.bodies.iter().position(|b| b.name == body)?;
            body_names(model).into_iter().nth(at)
        };
        let mut passes: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for pass in scene.passes.iter().filter(|p| p.object == index) {
            let (own, other) = (&scene.objects[pass.object], &scene.objects[pass.other]);
            let (Some(own), Some(model)) = (prim(own, &pass.body), self.0.get(other.model)) else { continue };
            let place = format!("/World/Objects/{}", identifier(&other.id));
            passes.entry(own).or_default().extend(body_names(model).iter().map(|body| format!("{place}/{body}")));
        }
        passes
    }

    fn place(&self, text: &mut Text, object: &SimObject, passes: &BTreeMap<String, Vec<String>>) {
        let Some(model) = self.0.get(object.model) else { return };
        let payload = format!("prepend payload = @./models/{0}/usd/{0}.usda@", model.name);
        let apis = schemas(&["SemanticsLabelsAPI:class"]);
        text.prim("def Xform", &identifier(&object.id), &[apis, payload], |text| {
            text.labels("class", &[&object.class]);
            text.line(format_args!("custom string d3dgen:label = {}", quoted(&object.label)));
            text.line(format_args!("custom string d3dgen:room_id = {}", quoted(&object.room_id)));
            text.line(format_args!("custom string d3dgen:mobility = \"{}\"", object.mobility.name()));
            text.placed(object.at_m, Some(yaw(object.yaw_rad)));
            match (object.mobility == Mobility::Fixed, self.is_articulated(object)) {
                // Part of the building: its shapes collide, nothing of it has a mass.
                (true, false) => {
                    let delete = "delete apiSchemas = [\"PhysicsRigidBodyAPI\", \"PhysicsMassAPI\"]".to_owned();
                    text.prim("over", &base_name(model), &[delete], |_| {});
                }
                // It may roll away: nothing holds its base.
                (false, true) => text.prim("over", "root_joint", &["active = false".to_owned()], |_| {}),
                (true, true) | (false, false) => {}
            }
            for (body, others) in passes {
                let api = "prepend apiSchemas = [\"PhysicsFilteredPairsAPI\"]".to_owned();
                text.prim("over", body, &[api], |text| {
                    let others: Vec<String> = others.iter().map(|path| format!("<{path}>")).collect();
                    text.line(format_args!("rel physics:filteredPairs = [{}]", others.join(", ")));
                });
            }
        });
    }
}

/// Returns a model whose bodies that nothing can touch (hands of a clock), and those so light that no solver of worlds holds
/// them (knobs, valves, switches), are part of what they hang on.
fn welded(model: &Model3d) -> Model3d {
    let mut out = model.clone();
    let is_part = |body: &Body| body.collisions.is_empty() || body.mass_kg < LEAST_KG;
    while let Some(at) = (1..out.bodies.len()).find(|b| is_part(&out.bodies[*b])) {
        let parent = out.joints.iter().find(|j| j.child == at).map_or(0, |j| j.parent);
        let body = out.bodies.remove(at);
        let moved = |b: usize| if b > at { b - 1 } else { b };
        out.joints.retain(|j| j.child != at);
        for joint in &mut out.joints {
            let own = if joint.parent == at { parent } else { joint.parent };
            (joint.parent, joint.child) = (moved(own), moved(joint.child));
        }
        let parent = &mut out.bodies[moved(parent)];
        parent.visuals.extend(body.visuals);
        parent.collisions.extend(body.collisions);
        parent.mass_kg += body.mass_kg;
    }
    out
}
