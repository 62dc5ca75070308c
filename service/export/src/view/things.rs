//! Things that stand in rooms, and parts of the building that are made of builds as they are.

use std::collections::BTreeMap;

use d3dgen_mesh::world3d::Node;
use d3dgen_mesh::{Library, Model3d, World3d, generate};
use d3dgen_model::domain::{Mount, ObjectType};

use super::{CEILING, View};
use crate::error::Error;
use crate::scene::SimObject;
use crate::used::plain;

/// Height that people pass below, m.
const HEAD_M: f64 = 1.5;

/// A part of the building by the object that its build is for.
pub(crate) struct Part<'a> {
    pub object: &'a str,
    pub size_m: [f64; 3],
    pub color: &'a str,
    pub material: &'a str,
}

impl Part<'_> {
    /// The handle of a leaf.
    pub const HANDLE: Part<'static> =
        Part { object: "door_handle", size_m: [0.13, 0.055, 0.17], color: "#b0b2b5", material: "metal" };

    /// Returns a name for it: what it is and its size, mm.
    pub fn name(&self) -> String {
        let [w, d, h] = self.size_m.map(|v| (v * 1e3).round() as i64);
        format!("{}_{w}x{d}x{h}", self.object)
    }

    /// Returns its model.
    ///
    /// # Errors
    /// `Model` when its build cannot be made at this size.
    pub fn model(&self) -> Result<Model3d, Error> {
        let object = ObjectType {
            color: self.color.to_owned(),
            material: self.material.to_owned(),
            ..plain(self.object, self.size_m, Mount::Floor)
        };
        Ok(generate(Library::shipped(), &object, self.size_m, 0)?)
    }
}

/// Meshes of parts that are there already, by part and size.
#[derive(Default)]
pub(crate) struct Parts(BTreeMap<(String, [i64; 3]), Option<usize>>);

impl Parts {
    /// Returns the mesh of a part, made when it is the first of its size.
    ///
    /// # Errors
    /// `Model` when its build cannot be made at this size.
    pub fn mesh(&mut self, world: &mut World3d, part: &Part<'_>) -> Result<Option<usize>, Error> {
        let key = (part.object.to_owned(), part.size_m.map(|v| (v * 1e4).round() as i64));
        if let Some(mesh) = self.0.get(&key) {
            return Ok(*mesh);
        }
        let mesh = world.model(&part.model()?).first().copied().flatten();
        self.0.insert(key, mesh);
        Ok(mesh)
    }
}

impl View<'_> {
    /// Adds a node for each thing of a storey, with its bodies below it; things of one model share its meshes.
    pub(super) fn things(&mut self, parent: usize, level: i32) {
        for object in self.scene.objects.iter().filter(|o| o.level == level) {
            let Some(model) = self.scene.models.get(object.model) else { continue };
            let world = &mut self.world;
            let shown = self.shown.entry(object.model).or_insert_with(|| world.model(&model.model)).clone();
            let mut node = Node::new(object.id.clone(), Some(parent))
                .at(object.at_m, object.yaw_rad)
                .fact("category", "object")
                .fact("class", object.class.clone())
                .fact("label", object.label.clone())
                .fact("room", object.room_id.clone())
                .fact("model", model.reference.clone())
                .fact("mobility", object.mobility.name())
                .fact("mass_kg", object.mass_kg);
            if self.hangs(object) {
                node.layer = CEILING.to_owned();
            }
            let root = self.world.node(node);
            self.world.bodies(&model.model, &shown, root, &object.id);
        }
    }

    /// Returns whether a thing hangs from the ceiling: it ends there, and begins above the heads of people.
    fn hangs(&self, object: &SimObject) -> bool {
        let room = self.scene.rooms.iter().find(|r| r.room_id == object.room_id);
        let top = self.scene.models.get(object.model).and_then(|m| m.model.bounds()).map_or(0.0, |b| b[1][2]);
        room.is_some_and(|r| {
            let low = object.at_m[2] - r.floor_m;
            low > HEAD_M && low + top > r.ceiling_m - 0.05
        })
    }
}
