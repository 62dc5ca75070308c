//! Object types: real sizes, where they go, what they need around them.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Words;
use crate::document::Problem;

/// A kind of object with real dimensions.
///
/// `width` runs left to right of the front, `depth` front to back, `height` up.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ObjectType {
    /// Snake-case id.
    pub id: String,
    /// Name for people, English.
    pub label: String,
    /// Words that name it in prompts.
    #[serde(default)]
    pub keywords: Words,
    /// Sizes it comes in, `[width, depth, height]` in m, most common first; the seed picks one.
    pub sizes_m: Vec<[f64; 3]>,
    /// Where it is fixed.
    pub mount: Mount,
    /// Height of its underside above the floor, m, for wall and ceiling mounts (ceiling: counted from the floor too).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mount_height_m: Option<f64>,
    /// Free floor in front, m.
    #[serde(default)]
    pub clearance_front_m: f64,
    /// Free floor at each side that needs it, m.
    #[serde(default)]
    pub clearance_side_m: f64,
    /// Which sides need `clearance_side_m`: 0, 1 or 2.
    #[serde(default)]
    pub clear_sides: u8,
    /// Free room at both sides that it has wherever the room holds it, m: for the elbows of who washes.
    #[serde(default)]
    pub elbow_room_m: f64,
    /// Free floor on all four sides, m, without which it is not there: one works around an island.
    #[serde(default)]
    pub free_around_m: f64,
    /// True when things can stand on its top.
    #[serde(default)]
    pub surface: bool,
    /// Stretches of its top that are taken, as shares of its width from the left of who stands before it: a bowl, rings.
    /// Nothing stands there.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub top_taken: Vec<[f64; 2]>,
    /// Outline and build of the simple model and of the plan symbol.
    pub shape: Shape,
    /// Build of its 3D model (`domains/builds/`, or the domain's own); else the one of its id, or of its shape.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub build: Option<String>,
    /// CSS color of the main part.
    pub color: String,
    /// Main material word (`wood`, `metal`, `fabric`, `ceramic`, `plastic`, `glass`).
    pub material: String,
    /// What a person does with it: `sit`, `lie`, `operate`, `touch`, `see`.
    #[serde(default)]
    pub affordances: Vec<String>,
    /// Free tags for search.
    #[serde(default)]
    pub tags: Vec<String>,
    /// Where the dimensions come from.
    #[serde(default)]
    pub source: String,
    /// Anything else a later release or a custom domain wants to say about it.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub extra: BTreeMap<String, String>,
    /// What a database of assets says of it while worlds are furnished; never part of a manifest.
    #[serde(skip)]
    pub stock: Stock,
}

/// Which assets of a database stand for an object.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Stock {
    /// The asset of each size that one has; sizes that none has are made.
    pub assets: Vec<StockedAsset>,
    /// Why the object is made, when the library's own is removed and no asset fits.
    pub made_because: Option<String>,
}

/// An asset that stands for an object of a size.
#[derive(Debug, Clone, PartialEq)]
pub struct StockedAsset {
    /// The size, one of the object's.
    pub size_m: [f64; 3],
    /// Model reference of the asset.
    pub asset: String,
    /// Why it was chosen, for people.
    pub reason: String,
}

/// Where an object is fixed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Mount {
    /// Stands on the floor.
    Floor,
    /// Hangs on a wall at `mount_height_m`.
    Wall,
    /// Hangs from the ceiling.
    Ceiling,
    /// Stands on another object.
    Surface,
}

/// Build of the simple model and symbol of an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// A plain body.
    Box,
    /// A body with doors or drawers in front.
    Cabinet,
    /// Open shelves.
    Shelf,
    /// A top on four legs.
    Table,
    /// A round top on a column.
    RoundTable,
    /// A top on panels with a user side.
    Desk,
    /// Seat, back, four legs.
    Chair,
    /// Seat, back, column and star base.
    SwivelChair,
    /// A round seat.
    Stool,
    /// Seat, back and arms for one or more.
    Sofa,
    /// A row of seats on a beam.
    Bench,
    /// Mattress, pillow, headboard.
    Bed,
    /// Mattress, rails, panels, wheels.
    HospitalBed,
    /// A counter with a front panel.
    Counter,
    /// A counter with a bowl.
    Sink,
    /// A bowl on the wall or a pedestal.
    Basin,
    /// Water closet.
    Toilet,
    /// Tub.
    Bathtub,
    /// Tray, screen, head.
    Shower,
    /// A toilet between partitions, with a door.
    Cubicle,
    /// A thin upright panel on a foot or wall (screen, board, mirror).
    Panel,
    /// A body on wheels with a handle.
    Trolley,
    /// A pole on a star foot.
    Pole,
    /// Foliage in a pot.
    Plant,
    /// A lamp on a stand or cord.
    Lamp,
    /// A machine with a front and a panel (washer, printer, vending machine).
    Appliance,
    /// A hob with rings.
    Stove,
    /// A thin cover on the floor.
    Rug,
    /// A cloth on a rail.
    Curtain,
    /// A robot dock with contacts.
    Dock,
    /// A cylinder.
    Cylinder,
    /// A car or truck.
    Vehicle,
    /// A ring-shaped scanner with a table.
    Scanner,
    /// Pallet racking.
    Rack,
    /// Two flights of steps side by side.
    Stairs,
    /// A basin full of water.
    Pool,
    /// A railway track; its platform is at the front.
    Track,
    /// A place for an animal between rails, open at the front.
    Stall,
}

impl Shape {
    /// Returns its snake-case name, which is also the id of the build that stands in for objects without their own.
    pub fn name(self) -> &'static str {
        match self {
            Self::Box => "box",
            Self::Cabinet => "cabinet",
            Self::Shelf => "shelf",
            Self::Table => "table",
            Self::RoundTable => "round_table",
            Self::Desk => "desk",
            Self::Chair => "chair",
            Self::SwivelChair => "swivel_chair",
            Self::Stool => "stool",
            Self::Sofa => "sofa",
            Self::Bench => "bench",
            Self::Bed => "bed",
            Self::HospitalBed => "hospital_bed",
            Self::Counter => "counter",
            Self::Sink => "sink",
            Self::Basin => "basin",
            Self::Toilet => "toilet",
            Self::Bathtub => "bathtub",
            Self::Shower => "shower",
            Self::Cubicle => "cubicle",
            Self::Panel => "panel",
            Self::Trolley => "trolley",
            Self::Pole => "pole",
            Self::Plant => "plant",
            Self::Lamp => "lamp",
            Self::Appliance => "appliance",
            Self::Stove => "stove",
            Self::Rug => "rug",
            Self::Curtain => "curtain",
            Self::Dock => "dock",
            Self::Cylinder => "cylinder",
            Self::Vehicle => "vehicle",
            Self::Scanner => "scanner",
            Self::Rack => "rack",
            Self::Stairs => "stairs",
            Self::Pool => "pool",
            Self::Track => "track",
            Self::Stall => "stall",
        }
    }

    /// Returns every shape.
    pub fn all() -> impl Iterator<Item = Self> {
        use Shape::*;
        [
            Box,
            Cabinet,
            Shelf,
            Table,
            RoundTable,
            Desk,
            Chair,
            SwivelChair,
            Stool,
            Sofa,
            Bench,
            Bed,
            HospitalBed,
            Counter,
            Sink,
            Basin,
            Toilet,
            Bathtub,
            Shower,
            Cubicle,
            Panel,
            Trolley,
            Pole,
            Plant,
            Lamp,
            Appliance,
            Stove,
            Rug,
            Curtain,
            Dock,
            Cylinder,
            Vehicle,
            Scanner,
            Rack,
            Stairs,
            Pool,
            Track,
            Stall,
        ]
        .into_iter()
    }
}

impl ObjectType {
    pub(super) fn check(&self, path: &str, problems: &mut Vec<Problem>) {
        if self.sizes_m.is_empty() {
            problems
                .push(Problem::new(format!("{path}/sizes_m"), "is empty; give at least one [width, depth, height]"));
        }
        for (i, size) in self.sizes_m.iter().enumerate() {
            if size.iter().any(|v| !(0.002..=30.0).contains(v)) {
                problems.push(Problem::new(
                    format!("{path}/sizes_m/{i}"),
                    format!("{size:?} m has an extent outside 0.002-30 m"),
                ));
            }
        }
        if matches!(self.mount, Mount::Wall | Mount::Ceiling) && self.mount_height_m.is_none() {
            problems.push(Problem::new(
                format!("{path}/mount_height_m"),
                "is missing; wall and ceiling mounts need a height above the floor",
            ));
        }
        for (i, [from, to]) in self.top_taken.iter().enumerate() {
            if !(0.0 <= *from && from < to && *to <= 1.0) {
                problems.push(Problem::new(
                    format!("{path}/top_taken/{i}"),
                    format!("goes from {from} to {to}, needs 0 <= from < to <= 1"),
                ));
            }
        }
        if self.clear_sides > 2 {
            problems.push(Problem::new(
                format!("{path}/clear_sides"),
                format!("is {}, an object has 2 sides", self.clear_sides),
            ));
        }
    }
}
