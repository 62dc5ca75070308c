//! A world as it is seen: the scene for simulators with surfaces, frames, leaves and lamps, as one tree of meshes.
//!
//! What formats that show worlds share (glTF, USD, pictures). What it is not for: what collides; that is the scene's.

mod building;
mod doors;
mod shapes;
mod things;

use std::collections::BTreeMap;

use d3dgen_mesh::world3d::{Lamp, LampKind, Node, lamp_color};
use d3dgen_mesh::{World3d, finish};
use d3dgen_model::geometry::Point;

use crate::error::Error;
use crate::scene::{SimRoom, SimScene};

pub(crate) use doors::{handle_places, leaf_part, window_part};
pub(crate) use things::{Part, Parts};

/// Layer of ceilings: hidden by who looks in from above.
pub const CEILING: &str = "ceiling";
/// Layer of the ground around the building.
pub const GROUND: &str = "ground";
/// Illuminance of a clear day, lx, and the color of its light, K.
const SUN: (f64, f64) = (20_000.0, 5_600.0);

/// Returns the layer of a storey: hidden by who looks at one below it.
pub fn storey_layer(level: i32) -> String {
    format!("storey_{level}")
}

/// Returns a world as it is seen. Nodes have the ids of the scene; each storey is a node with its rooms, walls, windows,
/// doors and things below it.
///
/// # Errors
/// `Model` when a part of the building cannot be made.
pub fn world3d(scene: &SimScene) -> Result<World3d, Error> {
    let mut view = View {
        scene,
        world: World3d { name: scene.name.clone(), ..World3d::default() },
        parts: Parts::default(),
        shown: BTreeMap::new(),
    };
    let root = view.world.node(Node::new(scene.name.clone(), None).fact("units", "m"));
    view.ground(root);
    for storey in &scene.storeys {
        let mut node = Node::new(storey_layer(storey.level), Some(root));
        node.layer = storey_layer(storey.level);
        node.facts.insert("elevation_m".to_owned(), storey.elevation_m.into());
        let node = view.world.node(node);
        view.rooms(node, storey.level);
        view.walls(node, storey.level);
        view.windows(node, storey.level)?;
        view.doors(node, storey.level)?;
        view.things(node, storey.level);
        view.lamps(node, storey.level);
    }
    view.sun(root);
    Ok(view.world)
}

/// A world while it is made visible.
pub(crate) struct View<'a> {
    scene: &'a SimScene,
    world: World3d,
    parts: Parts,
    /// Meshes of the bodies of models that are there already.
    shown: BTreeMap<usize, Vec<Option<usize>>>,
}

impl View<'_> {
    /// Returns the material of a surface by its name.
    fn finish(&mut self, name: &str) -> usize {
        self.world.material(&finish::named(name).material(name))
    }

    fn lamps(&mut self, parent: usize, level: i32) {
        let here = |room_id: &str| self.scene.rooms.iter().any(|r| r.level == level && r.room_id == room_id);
        for light in self.scene.lights.iter().filter(|l| here(&l.room_id)) {
            let mut node = Node::new(light.id.clone(), Some(parent))
                .at(light.at_m, 0.0)
                .fact("object", light.object.clone())
                .fact("kelvin", light.kelvin);
            node.lamp = Some(Lamp { kind: LampKind::Point, color: lamp_color(light.kelvin), strength: light.lumens });
            self.world.nodes.push(node);
        }
    }

    fn sun(&mut self, root: usize) {
        let mut node = Node::new("sun", Some(root));
        // Shines along -z of the node, tilted from the zenith to the south-west.
        node.turn = SUN_TURN;
        node.lamp = Some(Lamp { kind: LampKind::Sun, color: lamp_color(SUN.1), strength: SUN.0 });
        self.world.nodes.push(node);
    }
}

/// A turn of 40 degrees about the line from north-west to south-east.
const SUN_TURN: [f64; 4] = [0.939_692_6, 0.241_844_8, -0.241_844_8, 0.0];

/// Returns the room of a storey that a point lies in.
fn room_at(scene: &SimScene, level: i32, p: Point) -> Option<&SimRoom> {
    scene.rooms.iter().find(|r| r.level == level && r.net.contains(p))
}

#[cfg(test)]
mod tests;
