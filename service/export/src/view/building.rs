//! Ground, floors, ceilings and walls, each face with the surface of the room that it bounds.

use d3dgen_mesh::Mesh;
use d3dgen_mesh::finish::{self, Pattern};
use d3dgen_mesh::world3d::Node;
use d3dgen_model::geometry::{Point, Polygon};
use serde_json::json;

use super::shapes::{Side, Sorted, add_face, faces, flat};
use super::{CEILING, GROUND, View, room_at};
use crate::scene::{SimPiece, SimShape, SimWall, WallPart};

/// Surfaces that no room names: of the outside, of cut walls seen from above, of skirting, of the ground.
const FACADE: &str = "Mortar_White";
const SECTION: [f32; 3] = [0.045, 0.05, 0.06];
const SKIRTING: [f32; 3] = [0.80, 0.79, 0.77];
const PAVING: &str = "Concrete_Paving";
/// How far from a wall it is looked for the room that it bounds, m.
const BESIDE_M: f64 = 0.04;
/// Height and thickness of skirting, m, and the shortest wall that has any.
const SKIRTING_M: [f64; 3] = [0.07, 0.012, 0.06];
/// How far the ground goes on around the building, m.
const AROUND_M: f64 = 4.0;

impl View<'_> {
    /// Adds the ground around the building, up to its outer walls.
    pub(super) fn ground(&mut self, root: usize) {
        let bounds = self.scene.rooms.iter().map(|r| r.net.bounds()).reduce(|a, b| a.union(&b));
        let Some(bounds) = bounds else { return };
        let material = self.finish(PAVING);
        let mut mesh = Sorted::default();
        mesh.add(material, &flat(&bounds.grown(AROUND_M).corners(), self.scene.ground_m(), true));
        let mut node = Node::new("ground", Some(root)).fact("category", "ground");
        node.mesh = self.world.mesh("ground", mesh.visuals());
        node.layer = GROUND.to_owned();
        self.world.nodes.push(node);
    }

    /// Adds a node for each room of a storey with its floor, and one below it with its ceiling.
    pub(super) fn rooms(&mut self, parent: usize, level: i32) {
        for room in self.scene.rooms.iter().filter(|r| r.level == level) {
            let mut node = Node::new(room.id.clone(), Some(parent))
                .fact("category", "room")
                .fact("class", room.class.clone())
                .fact("label", room.label.clone())
                .fact("outline", json!(outline(&room.net)));
            let floor = self.finish(&room.materials.floor);
            let edge = self.finish(FACADE);
            let mut mesh = Sorted::default();
            for (corners, side) in room.floor.iter().flat_map(faces) {
                match side {
                    Side::Top => add_face(mesh.of(floor), &corners),
                    Side::Bottom | Side::Upright { .. } => add_face(mesh.of(edge), &corners),
                }
            }
            node.mesh = self.world.mesh(format!("{}_floor", room.id), mesh.visuals());
            let at = self.world.node(node);
            let ceiling = self.finish(&room.materials.ceiling);
            let mut mesh = Sorted::default();
            for (corners, _) in room.ceiling.iter().flat_map(faces) {
                add_face(mesh.of(ceiling), &corners);
            }
            let mut node = Node::new(format!("{}_ceiling", room.id), Some(at)).fact("category", "ceiling");
            node.layer = CEILING.to_owned();
            node.mesh = self.world.mesh(format!("{}_ceiling", room.id), mesh.visuals());
            if node.mesh.is_some() {
                self.world.nodes.push(node);
            }
        }
    }

    /// Adds a node for each wall of a storey.
    pub(super) fn walls(&mut self, parent: usize, level: i32) {
        for wall in self.scene.walls.iter().filter(|w| w.level == level) {
            let mut mesh = Sorted::default();
            for piece in &wall.pieces {
                self.piece(wall, piece, &mut mesh);
            }
            let mut node =
                Node::new(wall.id.clone(), Some(parent)).fact("category", "wall").fact("rooms", wall.room_ids.clone());
            node.mesh = self.world.mesh(wall.id.clone(), mesh.visuals());
            self.world.nodes.push(node);
        }
    }

    fn piece(&mut self, wall: &SimWall, piece: &SimPiece, mesh: &mut Sorted) {
        let floor = self.scene.storeys.iter().find(|s| s.level == wall.level).map_or(0.0, |s| s.elevation_m);
        for (corners, side) in faces(&piece.shape) {
            let material = match side {
                Side::Top if piece.part != WallPart::Sill => self.plain("Wall_Section", SECTION),
                Side::Top | Side::Bottom => self.finish(&wall.material),
                Side::Upright { middle, outward, .. } => {
                    let beside = Point::new(middle.x + outward[0] * BESIDE_M, middle.y + outward[1] * BESIDE_M);
                    let room = room_at(self.scene, wall.level, beside);
                    let name = room.map(|r| r.materials.wall.clone());
                    let has_skirting = piece.part != WallPart::Lintel && piece.part != WallPart::Column;
                    if has_skirting
                        && let Some(name) = &name
                        && finish::named(name).pattern != Pattern::Tiles
                    {
                        self.skirting(&corners, side, floor, mesh);
                    }
                    let name =
                        name.unwrap_or_else(|| if wall.exterior { FACADE.to_owned() } else { wall.material.clone() });
                    self.finish(&name)
                }
            };
            add_face(mesh.of(material), &corners);
        }
    }

    /// Adds the skirting before a face that begins at the floor.
    fn skirting(&mut self, corners: &[[f64; 3]], side: Side, floor: f64, mesh: &mut Sorted) {
        let [height, thick, shortest] = SKIRTING_M;
        let Side::Upright { outward, length, .. } = side else { return };
        let low = corners.iter().map(|c| c[2]).fold(f64::MAX, f64::min);
        if length < shortest || low > floor + 0.01 {
            return;
        }
        let [a, b] = [corners[0], corners[1]];
        let out = |p: [f64; 3]| Point::new(p[0] + outward[0] * thick, p[1] + outward[1] * thick);
        // Counter-clockwise: along the wall, then back before it.
        let outline = vec![Point::new(b[0], b[1]), Point::new(a[0], a[1]), out(a), out(b)];
        let outline =
            if Polygon(outline.clone()).signed_area() < 0.0 { outline.into_iter().rev().collect() } else { outline };
        let shape = SimShape::Prism { outline, z_m: [floor, floor + height] };
        let material = self.plain("Skirting", SKIRTING);
        let mut strip = Mesh::default();
        faces(&shape).iter().filter(|(_, s)| *s != Side::Bottom).for_each(|(c, _)| add_face(&mut strip, c));
        mesh.add(material, &strip);
    }

    /// Returns a painted material.
    pub(super) fn plain(&mut self, name: &str, base_color: [f32; 3]) -> usize {
        self.world.material(&d3dgen_mesh::Material {
            name: name.to_owned(),
            base_color,
            roughness: 0.6,
            ..d3dgen_mesh::Material::default()
        })
    }
}

fn outline(polygon: &Polygon) -> Vec<[f64; 2]> {
    let round = |v: f64| (v * 1e4).round() / 1e4;
    polygon.corners().iter().map(|p| [round(p.x), round(p.y)]).collect()
}
