//! Which object stands where, on what, and which rule put it there.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::document::{Document, Problem, check_unique};
use crate::domain::Mount;
use crate::geometry::{Point, Polygon, Pose};

/// All objects of a building.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Placements {
    /// Format version; 1.
    pub version: u32,
    /// Seed they were made with.
    pub seed: u64,
    /// Objects, room by room in floorplan order.
    pub placements: Vec<Placement>,
    /// Wishes that could not be met, with the rule that stopped each.
    #[serde(default)]
    pub unplaced: Vec<Unplaced>,
}

/// The decision that an object stands at a pose in a room.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Placement {
    /// Unique, snake case: `patient_room_3_hospital_bed_1`; the entity name in `world.yaml`.
    #[schemars(regex(pattern = "^[a-z0-9_]+$"))]
    pub placement_id: String,
    /// Room it stands in.
    pub room_id: String,
    /// Object id of the domain's catalog.
    pub object: String,
    /// Model reference `Domain/Name`, one for all simulators.
    pub asset: String,
    /// Where the model comes from, when a database of assets has a say; else it is the library's own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub asset_choice: Option<AssetChoice>,
    /// Center of the footprint, underside height, heading of the front.
    pub pose: Pose,
    /// `[width, depth, height]`, m; width across the front.
    pub size_m: [f64; 3],
    /// Where it is fixed.
    pub mount: Mount,
    /// Placement it stands on, for `surface` mounts.
    #[serde(default)]
    pub support: Option<String>,
    /// Group instance it belongs to: `patient_room_3_bed_place_1`.
    #[serde(default)]
    pub group: Option<String>,
    /// The furnishing line and arrangement that put it there, for people.
    pub rule: String,
    /// True keeps it when the document is fed back.
    #[serde(default)]
    pub locked: bool,
}

/// The choice of a model among those of a database of assets.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AssetChoice {
    /// Where the model comes from.
    pub source: AssetSource,
    /// Why it was chosen, for people.
    pub reason: String,
}

/// Where the model of a placement comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AssetSource {
    /// An asset of the database.
    Database,
    /// Made, for want of an asset that fits.
    Generated,
}

impl Placement {
    /// Returns the outline on the floor, counter-clockwise.
    pub fn footprint(&self) -> Polygon {
        let (sin, cos) = self.pose.yaw_rad.sin_cos();
        let (hw, hd) = (self.size_m[0] / 2.0, self.size_m[1] / 2.0);
        let at = |forward: f64, left: f64| {
            Point::new(self.pose.x + cos * forward - sin * left, self.pose.y + sin * forward + cos * left)
        };
        Polygon(vec![at(-hd, -hw), at(hd, -hw), at(hd, hw), at(-hd, hw)])
    }

    /// Returns the height of the top above the floor, m.
    pub fn top_m(&self) -> f64 {
        self.pose.z + self.size_m[2]
    }
}

/// A wish that could not be met.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Unplaced {
    /// Room.
    pub room_id: String,
    /// Group or object id.
    pub item: String,
    /// True when the room type requires it.
    pub required: bool,
    /// Which rule stopped it, for people.
    pub reason: String,
}

impl Document for Placements {
    const KIND: &'static str = "placements";

    fn check(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        if self.version != 1 {
            problems.push(Problem::new("/version", format!("is {}, this release reads version 1", self.version)));
        }
        check_unique("/placements", self.placements.iter().map(|p| p.placement_id.as_str()), &mut problems);
        for (i, p) in self.placements.iter().enumerate() {
            if p.size_m.iter().any(|v| *v <= 0.0) {
                problems.push(Problem::new(
                    format!("/placements/{i}/size_m"),
                    format!("{:?} m has an extent that is not positive", p.size_m),
                ));
            }
            if (p.mount == Mount::Surface) != p.support.is_some() {
                problems.push(Problem::new(
                    format!("/placements/{i}/support"),
                    "names what a surface-mounted object stands on, and only that",
                ));
            }
            if let Some(id) = &p.support
                && !self.placements.iter().any(|q| &q.placement_id == id)
            {
                problems.push(Problem::new(
                    format!("/placements/{i}/support"),
                    format!("placement `{id}` is not in this document"),
                ));
            }
        }
        problems
    }
}
