//! Ground, rooms, walls, windows and doors: what is seen, and boxes and convex parts that collide.

use std::collections::BTreeSet;

use d3dgen_mesh::dynamics::Drive;
use d3dgen_mesh::world3d::{Node, yaw};
use d3dgen_mesh::writers::usd::parts::{self, UsdJoint};
use d3dgen_mesh::writers::usd::prototype;
use d3dgen_mesh::writers::usd::text::{Text, identifier, schemas, triple};
use d3dgen_mesh::{JointKind, World3d};

use crate::error::Error;
use crate::scene::{SimBox, SimDoor, SimLeaf, SimScene, SimShape, SimZone};
use crate::view::{Part, handle_places, leaf_part, window_part};

/// Thickness of the ground that collides, m.
const GROUND_M: f64 = 0.1;
/// How far the ground goes on around the building, m.
const AROUND_M: f64 = 20.0;
/// Width of the line around a zone, and how far it is above the floor, m.
const ZONE_LINE_M: f64 = 0.03;
const ZONE_ABOVE_M: f64 = 0.01;
/// What bears a leaf with a counterweight, m/s^2.
const GRAVITY: f64 = 9.81;

/// The building of a stage.
pub(super) struct Building<'a> {
    pub scene: &'a SimScene,
    pub seen: &'a World3d,
    /// Paths of the materials of what is seen.
    pub looks: &'a [String],
}

/// Returns the materials of meshes that are written once and at their place: ground, floors, ceilings, walls, casings.
pub(super) fn materials(seen: &World3d) -> BTreeSet<usize> {
    let meshes = seen.nodes.iter().filter(|n| is_at_its_place(n)).filter_map(|n| seen.meshes.get(n.mesh?));
    meshes.flat_map(|m| m.visuals.iter().filter_map(|v| v.material)).collect()
}

fn is_at_its_place(node: &Node) -> bool {
    let category = node.facts.get("category").and_then(|c| c.as_str());
    matches!(category, Some("ground" | "room" | "ceiling" | "wall" | "door"))
}

impl Building<'_> {
    pub fn write(&self, text: &mut Text) -> Result<(), Error> {
        let parts = Shared::of(self.scene)?;
        parts.write(text);
        self.ground(text);
        self.rooms(text);
        self.walls(text);
        self.windows(text, &parts);
        self.doors(text, &parts);
        Ok(())
    }

    /// Writes the meshes that the view has under a name.
    fn meshes(&self, text: &mut Text, name: &str, class: &str) {
        let Some(node) = self.seen.nodes.iter().find(|n| n.name == name) else { return };
        let Some(mesh) = node.mesh.and_then(|m| self.seen.meshes.get(m)) else { return };
        for visual in &mesh.visuals {
            parts::mesh(text, visual, &self.seen.materials, &identifier(&visual.name), self.looks, class);
        }
    }

    fn ground(&self, text: &mut Text) {
        let bounds = self.scene.rooms.iter().map(|r| r.net.bounds()).reduce(|a, b| a.union(&b));
        let Some(bounds) = bounds else { return };
        let z = self.scene.ground_m() - GROUND_M / 2.0;
        let (middle, around) = (bounds.center(), bounds.grown(AROUND_M));
        text.prim("def Xform", "Ground", &component(), |text| {
            text.labels("class", &["ground"]);
            self.meshes(text, "ground", "ground");
            let half = [around.width() / 2.0, around.height() / 2.0, GROUND_M / 2.0];
            parts::cuboid(text, "collision", [middle.x, middle.y, z], half, None, "ground");
        });
    }

    fn rooms(&self, text: &mut Text) {
        text.prim("def Xform", "Rooms", &["kind = \"group\"".to_owned()], |text| {
            for room in &self.scene.rooms {
                text.prim("def Xform", &identifier(&room.id), &component(), |text| {
                    text.labels("class", &["room", &room.class]);
                    text.line(format_args!("custom string d3dgen:room_id = \"{}\"", room.room_id));
                    text.prim("def Xform", "floor", &[schemas(&["SemanticsLabelsAPI:class"])], |text| {
                        text.labels("class", &["floor"]);
                        self.meshes(text, &room.id, "floor");
                        shapes(text, room.floor.iter(), "floor");
                    });
                    if room.ceiling.is_empty() {
                        return;
                    }
                    // Switched off as a whole by who looks in from above.
                    text.prim("def Xform", "ceiling", &[schemas(&["SemanticsLabelsAPI:class"])], |text| {
                        text.labels("class", &["ceiling"]);
                        self.meshes(text, &format!("{}_ceiling", room.id), "ceiling");
                        shapes(text, room.ceiling.iter(), "ceiling");
                    });
                });
            }
        });
    }

    fn walls(&self, text: &mut Text) {
        text.prim("def Xform", "Walls", &["kind = \"group\"".to_owned()], |text| {
            for wall in &self.scene.walls {
                text.prim("def Xform", &identifier(&wall.id), &component(), |text| {
                    text.labels("class", &["wall"]);
                    self.meshes(text, &wall.id, "wall");
                    shapes(text, wall.pieces.iter().map(|p| &p.shape), "wall");
                });
            }
        });
    }

    fn windows(&self, text: &mut Text, parts: &Shared) {
        text.prim("def Xform", "Windows", &["kind = \"group\"".to_owned()], |text| {
            for window in &self.scene.windows {
                let (part, at) = window_part(window);
                text.prim("def Xform", &identifier(&window.id), &component(), |text| {
                    text.labels("class", &["window"]);
                    parts.instance(text, "visual", &part, at, yaw(window.glass.yaw_rad));
                    for (i, shape) in std::iter::once(&window.glass).chain(&window.frame).enumerate() {
                        upright(text, &format!("collision_{i}"), shape, "window");
                    }
                });
            }
        });
    }

    fn doors(&self, text: &mut Text, parts: &Shared) {
        text.prim("def Xform", "Doors", &["kind = \"group\"".to_owned()], |text| {
            for door in &self.scene.doors {
                text.prim("def Xform", &identifier(&door.id), &component(), |text| {
                    text.labels("class", &["door"]);
                    text.prim("def Xform", "frame", &[schemas(&["SemanticsLabelsAPI:class"])], |text| {
                        text.labels("class", &["door_frame"]);
                        self.meshes(text, &door.id, "door_frame");
                        if door.leaves.is_empty() {
                            marker(text, door);
                        }
                        for (i, jamb) in door.frame.iter().enumerate() {
                            upright(text, &format!("collision_{i}"), jamb, "door_frame");
                        }
                    });
                    for leaf in &door.leaves {
                        write_leaf(text, door, leaf, parts);
                    }
                });
            }
        });
    }
}

/// Writes the floor of an open passage as a guide: a door prim has something to see.
fn marker(text: &mut Text, door: &SimDoor) {
    let [x, y, z] = door.at_m;
    let half = [door.clear_m[0] / 2.0, door.thickness_m / 2.0, 0.001];
    text.prim("def Cube", "passage", &[schemas(&["SemanticsLabelsAPI:class"])], |text| {
        text.labels("class", &["passage"]);
        text.line("uniform token purpose = \"guide\"");
        text.line("double size = 1");
        text.line("float3[] extent = [(-0.5, -0.5, -0.5), (0.5, 0.5, 0.5)]");
        text.line(format_args!("double3 xformOp:translate = {}", triple([x, y, z + 0.002])));
        text.line(format_args!("double xformOp:rotateZ = {}", door.yaw_rad.to_degrees()));
        text.line(format_args!("float3 xformOp:scale = {}", triple(half.map(|v| 2.0 * v))));
        text.line("uniform token[] xformOpOrder = [\"xformOp:translate\", \"xformOp:rotateZ\", \"xformOp:scale\"]");
    });
}

/// Writes a leaf as a body at the middle of its closed place, and the joint that holds it.
fn write_leaf(text: &mut Text, door: &SimDoor, leaf: &SimLeaf, parts: &Shared) {
    let (closed, joint) = (&leaf.closed, &leaf.joint);
    let name = identifier(&leaf.id);
    let path = format!("/World/Doors/{}/{name}", identifier(&door.id));
    let turn = yaw(closed.yaw_rad);
    let apis = ["PhysicsRigidBodyAPI", "PhysicsMassAPI", "SemanticsLabelsAPI:class"];
    text.prim("def Xform", &name, &[schemas(&apis)], |text| {
        text.labels("class", &["door_leaf"]);
        text.line(format_args!("float physics:mass = {}", leaf.mass_kg));
        text.placed(closed.center_m, Some(turn));
        let part = leaf_part(door, leaf);
        parts.instance(text, "visual", &part, [0.0, 0.0, -closed.half_m[2]], yaw(0.0));
        for (i, (at, turn)) in handle_places(leaf).into_iter().enumerate() {
            parts.instance(text, &format!("handle_{}", i + 1), &Part::HANDLE, at, turn);
        }
        let slab = SimBox { center_m: [0.0; 3], yaw_rad: 0.0, ..*closed };
        upright(text, "collision", &slab, "door_leaf");
    });
    let in_world = parts::turn_to(joint.axis);
    let (sin, cos) = closed.yaw_rad.sin_cos();
    let [dx, dy, dz]: [f64; 3] = std::array::from_fn(|i| joint.origin_m[i] - closed.center_m[i]);
    let joint = UsdJoint {
        name: &identifier(&joint.id),
        kind: if joint.hinge { JointKind::Revolute } else { JointKind::Prismatic },
        parent: None,
        child: &path,
        at: [joint.origin_m, [cos * dx + sin * dy, cos * dy - sin * dx, dz]],
        turn: [in_world, parts::turn_within(turn, in_world)],
        limits: Some([joint.limits[0].min(joint.limits[1]), joint.limits[0].max(joint.limits[1])]),
        resists: Drive {
            push: if leaf.balanced { leaf.mass_kg * GRAVITY } else { 0.0 },
            friction: joint.friction,
            damping: joint.damping,
        },
    };
    joint.write(text);
}

/// Writes convex solids as colliders.
fn shapes<'a>(text: &mut Text, shapes: impl Iterator<Item = &'a SimShape>, class: &str) {
    for (i, shape) in shapes.enumerate() {
        let name = format!("collision_{i}");
        match shape {
            SimShape::Box(b) => upright(text, &name, b, class),
            SimShape::Prism { outline, z_m } => {
                let corners: Vec<[f64; 2]> = outline.iter().map(|p| [p.x, p.y]).collect();
                parts::convex_prism(text, &name, &corners, *z_m, class);
            }
        }
    }
}

fn upright(text: &mut Text, name: &str, b: &SimBox, class: &str) {
    let turn = (b.yaw_rad.abs() > 1e-9).then(|| yaw(b.yaw_rad));
    parts::cuboid(text, name, b.center_m, b.half_m, turn, class);
}

/// Returns the metadata of a labelled part of the building.
fn component() -> [String; 2] {
    [schemas(&["SemanticsLabelsAPI:class"]), "kind = \"component\"".to_owned()]
}

/// Returns how far the line around a zone reaches, in single precision as USD works it out and with all its digits: validators
/// compare the figures.
fn zone_extent(zone: &SimZone, z: f64) -> String {
    let (around, half) = (zone.outline.bounds(), ZONE_LINE_M as f32 / 2.0);
    let corner = |p: [f64; 3], by: f32| p.map(|v| (v as f32 + by).to_string()).join(", ");
    format!("({}), ({})", corner([around.x0, around.y0, z], -half), corner([around.x1, around.y1, z], half))
}

/// Writes a zone as an outline on the floor.
pub(super) fn zone(text: &mut Text, zone: &SimZone) {
    let z = zone.floor_m + ZONE_ABOVE_M;
    let points: Vec<String> = zone.outline.corners().iter().map(|p| triple([p.x, p.y, z])).collect();
    let extent = zone_extent(zone, z);
    let kind = serde_json::to_value(zone.kind).ok().and_then(|k| k.as_str().map(str::to_owned)).unwrap_or_default();
    text.prim("def BasisCurves", &identifier(&zone.id), &[schemas(&["SemanticsLabelsAPI:class"])], |text| {
        text.labels("class", &[&kind]);
        text.line("uniform token purpose = \"guide\"");
        text.line("uniform token type = \"linear\"");
        text.line("uniform token wrap = \"periodic\"");
        text.line(format_args!("int[] curveVertexCounts = [{}]", points.len()));
        text.line(format_args!("point3f[] points = [{}]", points.join(", ")));
        text.line(format_args!("float[] widths = [{ZONE_LINE_M}] (\n    interpolation = \"constant\"\n)"));
        text.line(format_args!("float3[] extent = [{extent}]"));
        text.line(format_args!("custom string d3dgen:room_id = \"{}\"", zone.room_id));
    });
}

/// Parts of the building that are seen many times: each is written once.
pub(super) struct Shared(Vec<(String, d3dgen_mesh::Model3d)>);

impl Shared {
    /// Returns the parts that doors and windows need.
    ///
    /// # Errors
    /// `Model` when a part cannot be made.
    pub fn of(scene: &SimScene) -> Result<Self, Error> {
        let mut all = vec![Part::HANDLE];
        all.extend(scene.windows.iter().map(|w| window_part(w).0));
        all.extend(scene.doors.iter().flat_map(|d| d.leaves.iter().map(|l| leaf_part(d, l))));
        let mut made: Vec<(String, d3dgen_mesh::Model3d)> = Vec::new();
        for part in all {
            if made.iter().all(|(name, _)| *name != part.name()) {
                made.push((part.name(), part.model()?));
            }
        }
        Ok(Self(made))
    }

    fn write(&self, text: &mut Text) {
        text.prim("class Scope", "Prototypes", &[], |text| {
            for (name, model) in &self.0 {
                let class = model.name.to_lowercase();
                if let Some(body) = model.bodies.first() {
                    prototype(text, model, body, &format!("/World/Prototypes/{name}"), &class, super::TEXTURES);
                }
            }
        });
    }

    fn instance(&self, text: &mut Text, name: &str, part: &Part<'_>, at: [f64; 3], turn: [f64; 4]) {
        let reference = format!("prepend references = </World/Prototypes/{}>", part.name());
        text.prim("def Xform", name, &["instanceable = true".to_owned(), reference], |text| {
            text.placed(at, Some(turn));
        });
    }
}
