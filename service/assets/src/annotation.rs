//! What is known of an asset: its document, with where each statement comes from.
//!
//! A superset of the ASA annotation of Arena, see [`asa`]. Model frame: meters, z up, origin in the middle of the
//! footprint on the underside. The front stays where it was found; [`Front::axis`] says where.

pub mod asa;

use std::collections::BTreeMap;

use d3dgen_model::domain::Mount;
use d3dgen_model::{Document, Problem};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Everything known of one asset.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Annotation {
    /// Format version; 1.
    pub version: u32,
    /// Reference under which worlds name it: `Domain/Name`.
    #[schemars(regex(pattern = "^[A-Za-z0-9_]+/[A-Za-z0-9_]+$"))]
    pub asset_id: String,
    /// Name for people: `Swivel chair`.
    pub name: String,
    /// What it is and what it is for, in a few sentences.
    pub description: String,
    /// `[[xmin, xmax], [ymin, ymax], [zmin, zmax]]` in the model frame, m.
    pub bounding_box_m: [[f64; 2]; 3],
    /// Extents along x, y, z, m.
    pub size_m: [f64; 3],
    /// Which side faces the user.
    pub front: Front,
    /// Where it is fixed.
    pub mount: Mount,
    /// Height of its underside above the floor when mounted, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mount_height_m: Option<f64>,
    /// Kind word of the ASA tag standard: `chair`, `appliance`.
    pub kind: String,
    /// Object of the catalogs that it is one of; none when nothing fits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub object: Option<String>,
    /// Domains it belongs in, by id.
    #[serde(default)]
    pub domains: Vec<String>,
    /// Room types it belongs in, by id.
    #[serde(default)]
    pub room_types: Vec<String>,
    /// Further tags, `key::value` or bare.
    #[serde(default)]
    pub tags: Vec<String>,
    /// Material words: `wood`, `metal`.
    #[serde(default)]
    pub materials: Vec<String>,
    /// Main colors, largest share first.
    #[serde(default)]
    pub palette: Vec<Swatch>,
    /// What a person does with it: `sit`, `lie`, `operate`, `touch`, `see`; the main one first.
    #[serde(default)]
    pub affordances: Vec<String>,
    /// Outline on the floor in the model frame, counter-clockwise, m.
    #[serde(default)]
    pub footprint_m: Vec<[f64; 2]>,
    /// Number of triangles.
    pub triangle_count: u64,
    /// Mass and how it is spread.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mass: Option<Mass>,
    /// Parts that move.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub joints: Vec<JointNote>,
    /// A small picture of it, kept beside the model; none of the shipped library, whose pictures are drawn when asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thumbnail: Option<Thumbnail>,
    /// Where the model comes from.
    pub origin: Origin,
    /// How the file's coordinates, turned z up and to meters as it declares, become the model frame: rows of a 3 x 4
    /// matrix.
    pub model_from_file: [[f64; 4]; 3],
    /// For each field that is not given by the geometry itself, how it is known.
    #[serde(default)]
    pub basis: BTreeMap<String, Basis>,
    /// What was repaired.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub changes: Vec<Change>,
}

/// A small square picture of a model: PNG with a transparent ground.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Thumbnail {
    /// Side, px.
    pub size_px: u32,
    /// SHA-256 of the file, hexadecimal.
    pub sha256: String,
}

/// The side that faces the user.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Front {
    /// Its direction in the model frame.
    pub axis: FrontAxis,
    /// What showed it, for people.
    pub found_by: String,
}

/// A horizontal direction of the model frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
pub enum FrontAxis {
    /// Towards -y, as models made here have it.
    #[serde(rename = "-y")]
    MinusY,
    /// Towards +y.
    #[serde(rename = "+y")]
    PlusY,
    /// Towards -x.
    #[serde(rename = "-x")]
    MinusX,
    /// Towards +x.
    #[serde(rename = "+x")]
    PlusX,
    /// It has no front: round tables, balls.
    #[serde(rename = "xy")]
    Any,
}

/// A color and how much of the surface has it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Swatch {
    /// Color word of the ASA tag standard.
    pub name: String,
    /// `#rrggbb`, sRGB.
    pub hex: String,
    /// Share of the surface, 0 to 1.
    pub share: f64,
}

/// Mass, center and inertia, with every joint at zero.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Mass {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Center of mass in the model frame, m.
    pub center_m: [f64; 3],
    /// `[xx, yy, zz, xy, xz, yz]` about the center of mass, kg m^2.
    pub inertia_kg_m2: [f64; 6],
    /// Density of the whole box around it that the mass was estimated with, kg/m^3.
    pub density_kg_m3: f64,
}

/// A part that moves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JointNote {
    /// Name in the model.
    pub name: String,
    /// `revolute`, `prismatic` or `continuous`.
    pub kind: String,
    /// Least and largest position, rad or m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits: Option<[f64; 2]>,
}

/// Where a model comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", tag = "from", deny_unknown_fields)]
pub enum Origin {
    /// Read from a file.
    Ingested {
        /// Path below the folder that was ingested.
        path: String,
        /// SHA-256 of the model and the files it needs, hexadecimal.
        hash: String,
    },
    /// Made here.
    Generated {
        /// Domain of the object.
        domain: String,
        /// Object it is one of.
        object: String,
        /// Seed of its variant.
        seed: u64,
    },
    /// Part of the library shipped with the program, made when it is needed.
    Library {
        /// Domain of the object.
        domain: String,
        /// Object it is one of.
        object: String,
    },
}

/// How a statement is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Basis {
    /// Somebody said so: a metadata file, a catalog, a person.
    Given,
    /// Measured on the geometry or the pictures.
    Measured,
    /// Concluded from names, proportions or rules; may be wrong.
    Guessed,
}

/// Something that was repaired.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Change {
    /// What: `up_axis`, `scale`.
    pub what: String,
    /// As the file has it.
    pub from: String,
    /// As it is taken.
    pub to: String,
    /// Why, in a sentence.
    pub why: String,
}

impl FrontAxis {
    /// Returns `-y`, `+y`, `-x`, `+x` or `xy`.
    pub fn name(self) -> &'static str {
        match self {
            Self::MinusY => "-y",
            Self::PlusY => "+y",
            Self::MinusX => "-x",
            Self::PlusX => "+x",
            Self::Any => "xy",
        }
    }

    /// Returns the axis of a name as ASA files write it, legacy angles in degrees included; unknown ones are none.
    pub fn from_name(name: &str) -> Option<Self> {
        let angle = |degrees: f64| match degrees.rem_euclid(360.0).round() as i64 {
            0 => Some(Self::MinusX),
            90 => Some(Self::MinusY),
            180 => Some(Self::PlusX),
            270 => Some(Self::PlusY),
            135 | 225 => Some(Self::Any),
            _ => None,
        };
        match name.trim() {
            "-y" => Some(Self::MinusY),
            "+y" | "y" => Some(Self::PlusY),
            "-x" => Some(Self::MinusX),
            "+x" | "x" => Some(Self::PlusX),
            "xy" | "any" => Some(Self::Any),
            other => other.parse().ok().and_then(angle),
        }
    }

    /// Returns true when the width across the front runs along y.
    pub fn is_along_x(self) -> bool {
        matches!(self, Self::MinusX | Self::PlusX)
    }
}

impl Annotation {
    /// Returns `[width, depth, height]` with the width across the front, m.
    pub fn width_depth_height(&self) -> [f64; 3] {
        let [x, y, z] = self.size_m;
        if self.front.axis.is_along_x() { [y, x, z] } else { [x, y, z] }
    }

    /// Returns the domain part of the id, as worlds write it.
    pub fn domain_name(&self) -> &str {
        self.asset_id.split('/').next().unwrap_or_default()
    }

    /// Returns true when parts of it move.
    pub fn is_articulated(&self) -> bool {
        !self.joints.is_empty()
    }
}

impl Document for Annotation {
    const KIND: &'static str = "asset_annotation";

    fn check(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        if self.version != 1 {
            problems.push(Problem::new("/version", format!("is {}, this release reads version 1", self.version)));
        }
        for (i, ([low, high], size)) in self.bounding_box_m.iter().zip(self.size_m).enumerate() {
            let off = (high - low - size).abs();
            if low > high || off.is_nan() || off > d3dgen_model::TOLERANCE_M {
                problems.push(Problem::new(
                    format!("/bounding_box_m/{i}"),
                    format!("is {low} to {high} m, size_m says {size} m"),
                ));
            }
        }
        let share: f64 = self.palette.iter().map(|s| s.share).sum();
        if share > 1.01 {
            problems.push(Problem::new("/palette", format!("shares add up to {share:.2}, at most 1 is possible")));
        }
        for (i, swatch) in self.palette.iter().enumerate() {
            let digits = swatch.hex.strip_prefix('#').unwrap_or_default();
            if digits.len() != 6 || !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
                let path = format!("/palette/{i}/hex");
                problems.push(Problem::new(path, format!("is `{}`, should be like #a02525", swatch.hex)));
            }
        }
        for (i, joint) in self.joints.iter().enumerate() {
            if let Some([least, most]) = joint.limits
                && least > most
            {
                problems.push(Problem::new(format!("/joints/{i}/limits"), format!("{least} is above {most}")));
            }
        }
        if let Some(mass) = self.mass.as_ref().filter(|m| m.mass_kg < 0.0) {
            problems.push(Problem::new("/mass/mass_kg", format!("is {} kg, must not be below 0", mass.mass_kg)));
        }
        problems
    }
}
