//! A whole world as it is seen: a tree of nodes that share meshes, with materials and lamps.
//!
//! What it is not for: what collides and weighs; simulators get that from models and from the world itself.

use serde_json::{Map, Value};

use crate::affine::{Affine, Vec3};
use crate::model3d::{JointKind, Material, Model3d, Texture, Visual};

/// A world as it is seen; meters, z up.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct World3d {
    /// Name.
    pub name: String,
    /// Nodes, parents before their children.
    pub nodes: Vec<Node>,
    /// Meshes that nodes show; several nodes may show one.
    pub meshes: Vec<SharedMesh>,
    /// Materials of all visuals.
    pub materials: Vec<Material>,
    /// Pictures that materials name.
    pub textures: Vec<Texture>,
}

/// What a node shows.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SharedMesh {
    /// Name.
    pub name: String,
    /// Its parts, in the frame of the node, with materials of the world.
    pub visuals: Vec<Visual>,
}

/// A thing in the tree.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Name, unique in the world.
    pub name: String,
    /// Node it is part of and moves with.
    pub parent: Option<usize>,
    /// Its origin in the frame of the parent, m.
    pub at: Vec3,
    /// Its turn against the parent, a unit quaternion w, x, y, z.
    pub turn: [f64; 4],
    /// What it shows.
    pub mesh: Option<usize>,
    /// Light that it gives.
    pub lamp: Option<Lamp>,
    /// How it can be moved.
    pub motion: Option<Motion>,
    /// What it hides or shows with others: `ceiling`; empty for what is always there.
    pub layer: String,
    /// What formats have no word for: ids, categories, masses.
    pub facts: Map<String, Value>,
}

/// How a node moves about its origin.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Name that all nodes share that move together: an id.
    pub name: String,
    /// Turn or slide.
    pub kind: JointKind,
    /// Direction in the node's frame, unit length.
    pub axis: Vec3,
    /// Least and largest position: rad or m.
    pub limits: [f64; 2],
}

/// Light that a node gives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lamp {
    /// What it is.
    pub kind: LampKind,
    /// Color, linear, its largest channel 1.
    pub color: [f32; 3],
    /// lm of a point, lx of the sun.
    pub strength: f64,
}

/// Form of a lamp.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LampKind {
    /// Shines in all directions from the origin of its node.
    Point,
    /// Far away, shines along -z of its node.
    Sun,
}

impl Node {
    /// Returns a node at the origin of its parent.
    pub fn new(name: impl Into<String>, parent: Option<usize>) -> Self {
        Self {
            name: name.into(),
            parent,
            at: [0.0; 3],
            turn: [1.0, 0.0, 0.0, 0.0],
            mesh: None,
            lamp: None,
            motion: None,
            layer: String::new(),
            facts: Map::new(),
        }
    }

    /// Returns it at a place, turned about the upright axis.
    pub fn at(mut self, at: Vec3, yaw_rad: f64) -> Self {
        self.at = at;
        self.turn = yaw(yaw_rad);
        self
    }

    /// Returns it with a fact.
    pub fn fact(mut self, key: &str, value: impl Into<Value>) -> Self {
        self.facts.insert(key.to_owned(), value.into());
        self
    }

    /// Returns it showing a mesh.
    pub fn showing(mut self, mesh: usize) -> Self {
        self.mesh = Some(mesh);
        self
    }
}

impl Motion {
    /// Returns the position in which it is open: the end of its range that is farther from rest.
    pub fn open(&self) -> f64 {
        let [low, high] = self.limits;
        if high.abs() >= low.abs() { high } else { low }
    }

    /// Returns the turn (w, x, y, z) and the way, m, that bring it to a position.
    pub fn to(&self, position: f64) -> ([f64; 4], Vec3) {
        match self.kind {
            JointKind::Prismatic => ([1.0, 0.0, 0.0, 0.0], self.axis.map(|v| v * position)),
            JointKind::Revolute | JointKind::Continuous => {
                let (sin, cos) = (position / 2.0).sin_cos();
                let [x, y, z] = self.axis.map(|v| v * sin);
                ([cos, x, y, z], [0.0; 3])
            }
        }
    }
}

impl World3d {
    /// Adds a node and returns its index.
    pub fn node(&mut self, node: Node) -> usize {
        self.nodes.push(node);
        self.nodes.len() - 1
    }

    /// Adds a mesh and returns its index; none when nothing of it is seen.
    pub fn mesh(&mut self, name: impl Into<String>, visuals: Vec<Visual>) -> Option<usize> {
        let visuals: Vec<Visual> = visuals.into_iter().filter(|v| !v.mesh.triangles.is_empty()).collect();
        if visuals.is_empty() {
            return None;
        }
        self.meshes.push(SharedMesh { name: name.into(), visuals });
        Some(self.meshes.len() - 1)
    }

    /// Returns the index of a material, which it adds when it is not there yet.
    pub fn material(&mut self, material: &Material) -> usize {
        if let Some(index) = self.materials.iter().position(|m| m == material) {
            return index;
        }
        self.materials.push(material.clone());
        self.materials.len() - 1
    }

    /// Adds the bodies of a model as meshes, each counted from the point it moves about, and returns one for each body.
    pub fn model(&mut self, model: &Model3d) -> Vec<Option<usize>> {
        let first = self.textures.len();
        self.textures.extend(model.textures.iter().cloned());
        let materials: Vec<usize> = model
            .materials
            .iter()
            .map(|m| self.material(&Material { texture: m.texture.map(|t| t + first), ..m.clone() }))
            .collect();
        let mut meshes = Vec::new();
        for (b, body) in model.bodies.iter().enumerate() {
            let pivot = pivot(model, b).map(|v| v as f32);
            let visuals = body.visuals.iter().map(|v| {
                let mut visual = v.clone();
                visual.material = v.material.and_then(|m| materials.get(m).copied());
                visual.mesh.positions.iter_mut().for_each(|p| *p = std::array::from_fn(|i| p[i] - pivot[i]));
                visual
            });
            let visuals = visuals.collect();
            meshes.push(self.mesh(format!("{}_{}", model.name, body.name), visuals));
        }
        meshes
    }

    /// Adds the nodes of a model's bodies under a node that stands where the model does; `meshes` are those of
    /// [`Self::model`]. What moves is named `<name>`, its bodies `<name>/<body>`.
    pub fn bodies(&mut self, model: &Model3d, meshes: &[Option<usize>], root: usize, name: &str) {
        let mut nodes: Vec<Option<usize>> = vec![None; model.bodies.len()];
        // A body comes after the one it hangs on.
        let mut open: Vec<usize> = (0..model.bodies.len()).collect();
        while let Some(at) = open.iter().position(|b| parent(model, *b).is_none_or(|p| nodes[p].is_some())) {
            let b = open.remove(at);
            let joint = model.joints.iter().find(|j| j.child == b);
            let (own, base) = (pivot(model, b), parent(model, b).map_or([0.0; 3], |p| pivot(model, p)));
            let mut node = Node::new(
                format!("{name}/{}", model.bodies[b].name),
                parent(model, b).and_then(|p| nodes[p]).or(Some(root)),
            );
            node.at = std::array::from_fn(|i| own[i] - base[i]);
            node.mesh = meshes.get(b).copied().flatten();
            node.facts.insert("mass_kg".to_owned(), model.bodies[b].mass_kg.into());
            node.motion = joint.and_then(|j| {
                let limits = j.limits?;
                Some(Motion { name: name.to_owned(), kind: j.kind, axis: j.axis, limits })
            });
            nodes[b] = Some(self.node(node));
        }
    }

    /// Returns the place of every node in the world, with what moves at these positions of its range: 0 at rest, 1 open.
    pub(crate) fn places(&self, openness: &dyn Fn(&Node) -> f64) -> Vec<Affine> {
        let mut places: Vec<Affine> = Vec::with_capacity(self.nodes.len());
        for node in &self.nodes {
            let mut own = Affine::placed(node.at, node.turn);
            if let Some(motion) = &node.motion {
                let (turn, way) = motion.to(motion.open() * openness(node));
                own = own.after(&Affine::placed(way, turn));
            }
            places.push(match node.parent.and_then(|p| places.get(p)) {
                Some(parent) => parent.after(&own),
                None => own,
            });
        }
        places
    }
}

/// Returns the quaternion (w, x, y, z) of a turn about the upright axis.
pub fn yaw(rad: f64) -> [f64; 4] {
    let (sin, cos) = (rad / 2.0).sin_cos();
    [cos, 0.0, 0.0, sin]
}

/// Returns the color of a lamp at a temperature in K, linear with its largest channel 1: Planck's locus in sRGB by the fit
/// of Tanner Helland (2012), 1,000 to 15,000 K.
pub fn lamp_color(kelvin: f64) -> [f32; 3] {
    let t = kelvin.clamp(1_000.0, 15_000.0) / 100.0;
    let red = if t <= 66.0 { 255.0 } else { 329.698_727_446 * (t - 60.0).powf(-0.133_204_759_2) };
    let green = if t <= 66.0 {
        99.470_802_586_1 * t.ln() - 161.119_568_166_1
    } else {
        288.122_169_528_3 * (t - 60.0).powf(-0.075_514_849_2)
    };
    let blue = if t >= 66.0 {
        255.0
    } else if t <= 19.0 {
        0.0
    } else {
        138.517_731_223_1 * (t - 10.0).ln() - 305.044_792_730_7
    };
    let color = [red, green, blue].map(|v| crate::builds::tones::linear(v.clamp(0.0, 255.0) / 255.0));
    let most = color.into_iter().fold(1e-6, f64::max);
    color.map(|v| (v / most) as f32)
}

fn parent(model: &Model3d, body: usize) -> Option<usize> {
    model.joints.iter().find(|j| j.child == body).map(|j| j.parent)
}

fn pivot(model: &Model3d, body: usize) -> Vec3 {
    model.joints.iter().find(|j| j.child == body).map_or([0.0; 3], |j| j.origin)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lamps_are_warm_at_2700_k_and_white_at_6500_k() {
        let [r, g, b] = lamp_color(2_700.0);
        assert!(r > 0.99 && g < 0.6 && b < 0.3, "{r} {g} {b}");
        assert!(lamp_color(6_500.0).iter().all(|v| *v > 0.9));
    }

    #[test]
    fn a_leaf_opens_with_its_children() {
        let mut world = World3d::default();
        let mut leaf = Node::new("leaf", None).at([1.0, 0.0, 0.0], 0.0);
        let quarter = std::f64::consts::FRAC_PI_2;
        leaf.motion = Some(Motion {
            name: "door".into(),
            kind: JointKind::Revolute,
            axis: [0.0, 0.0, 1.0],
            limits: [0.0, quarter],
        });
        let leaf = world.node(leaf);
        world.node(Node::new("handle", Some(leaf)).at([0.8, 0.0, 1.0], 0.0));
        let at = |open: f64| world.places(&|_| open)[1].origin;
        assert!((at(0.0)[0] - 1.8).abs() < 1e-9);
        let open = at(1.0);
        assert!((open[0] - 1.0).abs() < 1e-9 && (open[1] - 0.8).abs() < 1e-9, "{open:?}");
    }
}
