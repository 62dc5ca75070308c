//! Builds: how the 3D model of a kind of thing is made, as data.
//!
//! A build gives named measures, parts (solids with a tone), rigid bodies and joints. Its frame: x from the left edge,
//! y from the front, z from the underside, m. `domains/builds/README.md` is the guide for authors.

mod check;

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::de::Visitor;
use serde::{Deserialize, Deserializer, Serialize};

use crate::expression;

/// The body that parts belong to when they name none: the one that stands or hangs.
pub const BASE: &str = "base";

/// How one kind of thing is made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Build {
    /// Snake-case id; objects of this id use it.
    pub id: String,
    /// Word of the `kind` vocabulary of asset annotations: `chair`, `cabinet`.
    pub kind: String,
    /// Further object ids that use it.
    #[serde(default, rename = "for")]
    pub objects: Vec<String>,
    /// What can be seen, in a sentence.
    #[serde(default)]
    pub description: String,
    /// Named measures over `w`, `d`, `h`, each other and the choices.
    #[serde(default, rename = "let")]
    pub measures: BTreeMap<String, Formula>,
    /// Seeded variants: one figure of each list is taken; the first for seed 0.
    #[serde(default)]
    pub choices: BTreeMap<String, Vec<f64>>,
    /// What it is made of.
    pub parts: Vec<Part>,
    /// How bodies move.
    #[serde(default)]
    pub joints: Vec<BuildJoint>,
    /// Mass of the whole, kg; else from volumes and tones.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mass_kg: Option<Formula>,
}

/// A figure or a formula (`model::expression`).
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Formula {
    /// A plain figure.
    Number(f64),
    /// A formula over the measures.
    Text(String),
}

/// A solid with its tone, body and copies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// Name, for people and messages.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub id: String,
    /// Form.
    pub solid: Solid,
    /// Range across the front, from the left edge.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub x: Option<[Formula; 2]>,
    /// Range from the front to the back.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub y: Option<[Formula; 2]>,
    /// Range from the underside up.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub z: Option<[Formula; 2]>,
    /// Role that gives its material.
    #[serde(default)]
    pub tone: Tone,
    /// Color `#rrggbb` in place of the tone's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub color: Option<String>,
    /// Left out when this is 0 or less.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub when: Option<Formula>,
    /// Rigid body it belongs to.
    #[serde(default = "base")]
    pub body: String,
    /// Also mirrored about the middle of the width, the depth or both.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mirror: Option<Mirror>,
    /// Copies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub repeat: Option<Repeat>,
    /// Turns the finished part about a point.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tilt: Option<Tilt>,
    /// False leaves it out of the collision shapes.
    #[serde(default = "yes")]
    pub collide: bool,
    /// Of a box or cylinder: width of its cut edges.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bevel: Option<Formula>,
    /// Of a cushion: radius of its edges.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub round: Option<Formula>,
    /// Of a cone: radius at the far end as a share of that at the near end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub top: Option<Formula>,
    /// Of a tube or torus: radius of the bar.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius: Option<Formula>,
    /// Of a shell: thickness of its walls.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wall: Option<Formula>,
    /// Of a shell: thickness of the side opposite its opening, when it is not `wall`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bottom: Option<Formula>,
    /// Of leaves: how many.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub count: Option<Formula>,
    /// Of cylinders, cones, prisms, tori and lathes: their direction, z when not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axis: Option<Axis>,
    /// Of a shell: its open side, the top when not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub open: Option<Side>,
    /// Of a tube: the points it runs through.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub path: Vec<[Formula; 3]>,
    /// Of a tube: rounds its bends.
    #[serde(default)]
    pub smooth: bool,
    /// Of a tube: returns to its first point.
    #[serde(default)]
    pub closed: bool,
    /// Of a lathe: radius and height of the points of its outline.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub profile: Vec<[Formula; 2]>,
    /// Of a lathe: where its axis stands.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at: Option<[Formula; 2]>,
    /// Of a lathe: factors on its radius in the two directions across its axis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stretch: Option<[Formula; 2]>,
    /// Of a prism: its outline, a simple polygon in the other two directions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outline: Vec<[Formula; 2]>,
}

/// Form of a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Solid {
    /// Upright box, `bevel` cuts its edges.
    Box,
    /// Box with round edges.
    Cushion,
    /// Round bar along `axis`, inscribed in its box; `bevel` cuts its rims.
    Cylinder,
    /// Like a cylinder, tapered to `top`.
    Cone,
    /// Ellipsoid inscribed in its box.
    Sphere,
    /// Round bar along `path`.
    Tube,
    /// `profile` turned about an axis.
    Lathe,
    /// `outline` pushed along `axis`.
    Prism,
    /// Ring inscribed in its box, about `axis`.
    Torus,
    /// Box with walls and one open side.
    Shell,
    /// Foliage inside its box.
    Leaves,
}

/// Role of a part that gives its material.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Tone {
    /// The object's own color and material.
    #[default]
    Main,
    /// A darker shade of it.
    Dark,
    /// A lighter tint of it.
    Light,
    /// Brushed steel.
    Metal,
    /// Polished metal.
    Chrome,
    /// Wood; of a wooden object, its color.
    Wood,
    /// Enamel, sheets, painted plates.
    White,
    /// Dark plastic, hobs.
    Black,
    /// Clear glass.
    Glass,
    /// A mirror.
    Mirror,
    /// A screen that is on.
    Screen,
    /// Cloth; of an object of fabric, its color.
    Fabric,
    /// Leather; of an object of leather, its color.
    Leather,
    /// Plastic; of an object of plastic, its color.
    Plastic,
    /// Tires, bumpers, grips.
    Rubber,
    /// Sanitary ware; of a ceramic object, its color.
    Ceramic,
    /// Foliage.
    Green,
    /// Paper and card.
    Paper,
    /// Red paint.
    Red,
    /// Blue paint.
    Blue,
    /// Yellow paint.
    Yellow,
    /// Orange paint.
    Orange,
    /// Bright signal color that glows: pilot lamps, exit signs.
    Signal,
    /// Skin.
    Skin,
    /// A lamp that is lit.
    Warm,
}

/// About which middle a part is mirrored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Mirror {
    /// Left and right.
    X,
    /// Front and back.
    Y,
    /// Both: four copies.
    Xy,
}

/// Copies of a part or joint; `i` counts them from 0, `n` is how many.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Repeat {
    /// How many, the first included; rounded.
    pub count: Formula,
    /// Way from one copy to the next.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step: Option<[Formula; 3]>,
    /// Copies are turned about the upright line through this x and y.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub around: Option<[Formula; 2]>,
    /// Turn of the first copy, degrees counter-clockwise seen from above.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_deg: Option<Formula>,
    /// Turn that the copies are spread over, degrees; 360 when not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub span_deg: Option<Formula>,
}

/// A turn of a finished part.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Tilt {
    /// Direction of the axis.
    pub axis: Axis,
    /// Angle, degrees, right-handed.
    pub deg: Formula,
    /// A point of the axis.
    pub at: [Formula; 3],
}

/// A direction of the build's frame.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    /// Across the front.
    X,
    /// Front to back.
    Y,
    /// Up.
    #[default]
    Z,
}

/// A side of a box.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Up.
    #[default]
    Top,
    /// Down.
    Bottom,
    /// Least y.
    Front,
    /// Largest y.
    Back,
    /// Least x.
    Left,
    /// Largest x.
    Right,
}

/// How a body moves against its parent.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BuildJoint {
    /// The body that moves.
    pub body: String,
    /// The body it is fixed to.
    #[serde(default = "base")]
    pub parent: String,
    /// What it may do.
    pub kind: BuildJointKind,
    /// A point of its axis.
    pub at: [Formula; 3],
    /// Direction of its axis.
    pub axis: [f64; 3],
    /// Least and largest position: degrees, m for a prismatic joint.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits: Option<[Formula; 2]>,
    /// When 0 or less the body does not move: its parts belong to the parent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub when: Option<Formula>,
    /// Copies of the body: `drawer_0`, `drawer_1`; its parts follow.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub repeat: Option<Repeat>,
    /// Mirrored copies of the body; its parts follow.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mirror: Option<Mirror>,
}

/// What a joint of a build may do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BuildJointKind {
    /// Turn between limits.
    Revolute,
    /// Slide between limits.
    Prismatic,
    /// Turn without end.
    Continuous,
}

impl Formula {
    /// Returns its value; `None` when it is no formula, a name has no figure or the value is not finite.
    pub fn evaluate(&self, figure: &dyn Fn(&str) -> Option<f64>) -> Option<f64> {
        match self {
            Self::Number(value) => value.is_finite().then_some(*value),
            Self::Text(text) => expression::evaluate(text, figure),
        }
    }
}

/// By hand: the derived reader of untagged enums copies everything first, and builds hold thousands of formulas.
impl<'de> Deserialize<'de> for Formula {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader;
        impl Visitor<'_> for Reader {
            type Value = Formula;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a figure or a formula in quotes")
            }

            fn visit_f64<E>(self, value: f64) -> Result<Formula, E> {
                Ok(Formula::Number(value))
            }

            fn visit_i64<E>(self, value: i64) -> Result<Formula, E> {
                Ok(Formula::Number(value as f64))
            }

            fn visit_u64<E>(self, value: u64) -> Result<Formula, E> {
                Ok(Formula::Number(value as f64))
            }

            fn visit_str<E>(self, text: &str) -> Result<Formula, E> {
                Ok(Formula::Text(text.to_owned()))
            }
        }
        deserializer.deserialize_any(Reader)
    }
}

impl std::fmt::Display for Formula {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(value) => write!(f, "{value}"),
            Self::Text(text) => f.write_str(text),
        }
    }
}

impl Axis {
    /// Returns 0 for x, 1 for y, 2 for z.
    pub fn index(self) -> usize {
        self as usize
    }
}

fn base() -> String {
    BASE.to_owned()
}

fn yes() -> bool {
    true
}
