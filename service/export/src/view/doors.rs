//! Doors and windows: casings, leaves that move, handles, frames with panes.

use d3dgen_mesh::JointKind;
use d3dgen_mesh::world3d::{Motion, Node, yaw};
use d3dgen_model::floorplan::DoorKind;

use super::shapes::{Sorted, boxed};
use super::{Part, View};
use crate::error::Error;
use crate::scene::{SimBox, SimDoor, SimLeaf, SimWindow};

/// Width of a casing, and how far it stands out of the wall, m.
const CASING_M: [f64; 2] = [0.06, 0.012];
const CASING: [f32; 3] = [0.78, 0.77, 0.75];
/// Height of a threshold, m: what a wheel does not feel.
const THRESHOLD_M: f64 = 0.003;
const THRESHOLD: [f32; 3] = [0.35, 0.35, 0.36];

impl View<'_> {
    /// Adds a node for each window of a storey.
    pub(super) fn windows(&mut self, parent: usize, level: i32) -> Result<(), Error> {
        for window in self.scene.windows.iter().filter(|w| w.level == level) {
            let (part, at) = window_part(window);
            let mesh = self.parts.mesh(&mut self.world, &part)?;
            let mut node = Node::new(window.id.clone(), Some(parent))
                .at(at, window.glass.yaw_rad)
                .fact("category", "window")
                .fact("room", window.room_id.clone());
            node.mesh = mesh;
            self.world.nodes.push(node);
        }
        Ok(())
    }

    /// Adds a node for each door of a storey, and below it its leaves.
    pub(super) fn doors(&mut self, parent: usize, level: i32) -> Result<(), Error> {
        for door in self.scene.doors.iter().filter(|d| d.level == level) {
            let mut node = Node::new(door.id.clone(), Some(parent))
                .fact("category", "door")
                .fact("kind", kind(door.kind))
                .fact("rooms", door.room_ids.clone());
            let casing = self.casing(door);
            node.mesh = self.world.mesh(format!("{}_frame", door.id), casing);
            let node = self.world.node(node);
            for leaf in &door.leaves {
                self.leaf(node, door, leaf)?;
            }
        }
        Ok(())
    }

    /// Returns jambs, head and threshold around the opening; an open passage has none.
    fn casing(&mut self, door: &SimDoor) -> Vec<d3dgen_mesh::Visual> {
        let mut mesh = Sorted::default();
        if door.leaves.is_empty() {
            return Vec::new();
        }
        let (sin, cos) = door.yaw_rad.sin_cos();
        let [x, y, floor] = door.at_m;
        let along = |b: &SimBox| cos * (b.center_m[0] - x) + sin * (b.center_m[1] - y);
        // Jambs end where the opening begins; without any it is as wide as it is clear.
        let half = door.clear_m[0] / 2.0;
        let end = |sign: f64| {
            let ends = door.frame.iter().filter(|b| along(b) * sign > 0.0).map(|b| along(b) * sign - b.half_m[0]);
            ends.fold(f64::NAN, f64::min)
        };
        let [right, left] = [end(1.0), end(-1.0)].map(|e| if e.is_finite() { e } else { half });
        let height = door.clear_m[1];
        let deep = door.thickness_m / 2.0 + CASING_M[1];
        let piece = |from: f64, to: f64, deep: f64, z: [f64; 2]| {
            let middle = (from + to) / 2.0;
            boxed(&SimBox {
                center_m: [x + cos * middle, y + sin * middle, floor + (z[0] + z[1]) / 2.0],
                half_m: [(to - from) / 2.0, deep, (z[1] - z[0]) / 2.0],
                yaw_rad: door.yaw_rad,
            })
        };
        let casing = self.plain("Door_Casing", CASING);
        let wide = CASING_M[0];
        mesh.add(casing, &piece(right, right + wide, deep, [0.0, height]));
        mesh.add(casing, &piece(-left - wide, -left, deep, [0.0, height]));
        mesh.add(casing, &piece(-left - wide, right + wide, deep, [height, height + wide]));
        let metal = self.plain("Threshold", THRESHOLD);
        mesh.add(metal, &piece(-left, right, door.thickness_m / 2.0, [0.0, THRESHOLD_M]));
        mesh.visuals()
    }

    /// Adds a leaf: a node at a point of its axis that turns or slides, and its handles below it.
    fn leaf(&mut self, parent: usize, door: &SimDoor, leaf: &SimLeaf) -> Result<(), Error> {
        let (closed, joint) = (&leaf.closed, &leaf.joint);
        let part = leaf_part(door, leaf);
        let shown = self.parts.mesh(&mut self.world, &part)?;
        let pivot = if joint.hinge { joint.origin_m } else { closed.center_m };
        let mut node = Node::new(leaf.id.clone(), Some(parent)).fact("category", "leaf").fact("mass_kg", leaf.mass_kg);
        node.at = pivot;
        node.motion = Some(Motion {
            name: door.id.clone(),
            kind: if joint.hinge { JointKind::Revolute } else { JointKind::Prismatic },
            axis: joint.axis,
            limits: joint.limits,
        });
        let node = self.world.node(node);
        // The panel hangs in the frame of the axis, whose directions are those of the world.
        let way: [f64; 3] = std::array::from_fn(|i| closed.center_m[i] - pivot[i]);
        let mut panel = Node::new(format!("{}_panel", leaf.id), Some(node));
        panel.at = [way[0], way[1], way[2] - closed.half_m[2]];
        panel.turn = yaw(closed.yaw_rad);
        panel.mesh = shown;
        let panel = self.world.node(panel);
        let shown = self.parts.mesh(&mut self.world, &Part::HANDLE)?;
        for (i, (at, turn)) in handle_places(leaf).into_iter().enumerate() {
            // Counted from the foot of the panel.
            let mut node = Node::new(format!("{}_handle_{}", leaf.id, i + 1), Some(panel));
            node.at = [at[0], at[1], at[2] + closed.half_m[2]];
            node.turn = turn;
            node.mesh = shown;
            self.world.nodes.push(node);
        }
        Ok(())
    }
}

/// Returns a window as a part, and where the middle of its foot is.
pub(crate) fn window_part(window: &SimWindow) -> (Part<'static>, [f64; 3]) {
    let SimBox { center_m: [x, y, z], half_m: half, .. } = window.whole();
    let part = Part { object: "window", size_m: half.map(|v| 2.0 * v), color: "#f2f1ee", material: "plastic" };
    (part, [x, y, z - half[2]])
}

/// Returns the panel of a leaf as a part.
pub(crate) fn leaf_part(door: &SimDoor, leaf: &SimLeaf) -> Part<'static> {
    let size_m = leaf.closed.half_m.map(|v| 2.0 * v);
    Part { object: object(door, leaf), size_m, color: "#c9a67a", material: "wood" }
}

/// Returns where the handles of a leaf are, from its middle, and how they are turned: each with its back to its face.
pub(crate) fn handle_places(leaf: &SimLeaf) -> Vec<([f64; 3], [f64; 4])> {
    let [_, deep, high] = Part::HANDLE.size_m;
    let place = |at: &[f64; 3]| {
        let front = at[1] < 0.0;
        let out = leaf.closed.half_m[1] + deep / 2.0;
        let turn = if front { 0.0 } else { std::f64::consts::PI };
        ([at[0], if front { -out } else { out }, at[2] - high * 0.72], yaw(turn))
    };
    leaf.handles_m.iter().map(place).collect()
}

/// Returns the object id by which the build of a leaf is found.
fn object(door: &SimDoor, leaf: &SimLeaf) -> &'static str {
    match door.kind {
        _ if leaf.joint.axis[2].abs() > 0.5 && !leaf.joint.hinge => "door_leaf_gate",
        DoorKind::Hinged | DoorKind::Open => "door_leaf_hinged",
        DoorKind::DoubleHinged => "door_leaf_double_hinged",
        DoorKind::Sliding => "door_leaf_sliding",
    }
}

/// Returns the word of a kind of door.
fn kind(kind: DoorKind) -> &'static str {
    match kind {
        DoorKind::Hinged => "hinged",
        DoorKind::DoubleHinged => "double_hinged",
        DoorKind::Sliding => "sliding",
        DoorKind::Open => "open",
    }
}
