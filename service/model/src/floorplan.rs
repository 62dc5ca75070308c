//! Room polygons, wall segments, doors and windows; no furniture.
//!
//! Room polygons run on wall center lines, so that neighbors share edges exactly and the polygons tile the building.
//! A room's net floor is its polygon less half the thickness of each wall around it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::document::{Document, Problem, check_unique};
use crate::domain::Materials;
use crate::geometry::{Polygon, Rect, Segment};
use crate::levels::{Level, VerticalLink, check_links, is_ground};

/// Height of the slices in which what stands at an angle is covered by rectangles, m.
const COVER_STEP_M: f64 = 0.05;

/// A plan of one storey or several; all storeys share one frame, so what has the same coordinates lies above each other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Floorplan {
    /// Format version; 1.
    pub version: u32,
    /// Seed it was made with.
    pub seed: u64,
    /// Which family of plans it belongs to (`straight`, `capped`, `angle`, ...); `given` for a plan that somebody brought.
    pub scheme: String,
    /// Rooms in scene-graph order.
    pub rooms: Vec<PlanRoom>,
    /// Straight wall pieces with doors cut out; windows leave the wall below and above them, so it goes on.
    pub walls: Vec<Wall>,
    /// Doors and open passages.
    pub doors: Vec<Door>,
    /// Windows.
    pub windows: Vec<Window>,
    /// What stands in rooms from floor to ceiling: columns, and walls that stand free.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub obstacles: Vec<FixedObstacle>,
    /// Cost terms of the layout search, weighted, for those who compare plans.
    #[serde(default)]
    pub cost: Vec<CostTerm>,
    /// Requests the plan could not honor, and the least change that was made.
    #[serde(default)]
    pub conflicts: Vec<crate::scene_graph::Note>,
    /// Storeys from the lowest to the highest; empty for a plan of one storey.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub levels: Vec<Level>,
    /// Stairs and elevators, whose rooms have the same outline on every storey.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub links: Vec<VerticalLink>,
}

/// A room with its outline.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlanRoom {
    /// Id from the scene graph.
    pub room_id: String,
    /// Room type id.
    pub room_type: String,
    /// Name on the plan.
    pub name: String,
    /// True for corridors and halls added to connect rooms.
    #[serde(default)]
    pub circulation: bool,
    /// Outline on wall center lines, counter-clockwise.
    pub polygon: Polygon,
    /// Outline on wall faces, counter-clockwise: where furniture can stand.
    pub net_polygon: Polygon,
    /// Area of `net_polygon`, m^2.
    pub net_area_m2: f64,
    /// Clear height, m.
    pub ceiling_height_m: f64,
    /// Surface materials.
    pub materials: Materials,
    /// True keeps the room as it is when the plan is fed back.
    #[serde(default)]
    pub locked: bool,
    /// Storey it lies on: 0 at the ground, 1 above it, -1 below it.
    #[serde(default, skip_serializing_if = "is_ground")]
    pub level: i32,
}

/// A straight piece of wall.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Wall {
    /// Unique id: `wall_12`.
    pub wall_id: String,
    /// Center line, m.
    pub line: Segment,
    /// Thickness, m.
    pub thickness_m: f64,
    /// Rooms on its sides: two, or one for an outer wall.
    pub room_ids: Vec<String>,
    /// True when one side is outdoors.
    pub exterior: bool,
    /// True keeps it when the plan is fed back.
    #[serde(default)]
    pub locked: bool,
}

/// A passage: a door, or an opening without a leaf.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Door {
    /// Unique id: `door_3`.
    pub door_id: String,
    /// What fills the opening.
    pub kind: DoorKind,
    /// The opening on the wall's center line; its length is the structural opening, m.
    pub line: Segment,
    /// Clear width when open, m.
    pub clear_width_m: f64,
    /// Clear height, m.
    pub height_m: f64,
    /// Thickness of the wall it stands in, m.
    pub wall_thickness_m: f64,
    /// Rooms it connects: two, or one for an entrance or exit.
    pub room_ids: Vec<String>,
    /// True for the building's main entrance.
    #[serde(default)]
    pub entrance: bool,
    /// How the leaf swings; absent for sliding doors and open passages.
    #[serde(default)]
    pub swing: Option<Swing>,
    /// Where the leaf of a sliding door goes when it opens; absent for all others.
    #[serde(default)]
    pub slide: Option<Slide>,
    /// True for a door that opens by itself for who comes near it: a robot opens none.
    #[serde(default)]
    pub automatic: bool,
    /// True keeps it when the plan is fed back.
    #[serde(default)]
    pub locked: bool,
}

/// What fills a passage.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DoorKind {
    /// One leaf.
    Hinged,
    /// Two leaves.
    DoubleHinged,
    /// Slides, and is out of the way when it is open: see [`Slide`].
    Sliding,
    /// No leaf.
    Open,
}

/// How a door leaf moves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Swing {
    /// Room the leaf opens into; absent when it opens outdoors.
    pub into_room_id: Option<String>,
    /// End of `line` that carries the hinge: true for `start`, false for `end` (both for double leaves).
    pub hinge_at_start: bool,
}

/// Where the leaf of a sliding door goes when it opens: into a pocket inside the wall, so that things may stand and hang
/// beside the door, or up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Slide {
    /// Into the wall beyond `start` of its line.
    BeyondStart,
    /// Into the wall beyond `end` of its line.
    BeyondEnd,
    /// Two leaves, one into the wall beyond each end.
    Apart,
    /// Two leaves, one behind the other, into half as much wall beyond `start` of its line.
    StackedBeyondStart,
    /// Two leaves, one behind the other, into half as much wall beyond `end` of its line.
    StackedBeyondEnd,
    /// Up, as the gate of a garage.
    Up,
}

/// A window in an outer wall.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Window {
    /// Unique id: `window_7`.
    pub window_id: String,
    /// The opening on the wall's center line, m.
    pub line: Segment,
    /// Height of the sill above the floor, m.
    pub sill_m: f64,
    /// Height of the head above the floor, m.
    pub head_m: f64,
    /// Thickness of the wall it stands in, m.
    pub wall_thickness_m: f64,
    /// Room it lights.
    pub room_id: String,
    /// True keeps it when the plan is fed back.
    #[serde(default)]
    pub locked: bool,
}

/// Part of the building that stands in a room from floor to ceiling and bounds none: its floor is no floor of the room.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FixedObstacle {
    /// Unique id: `obstacle_2`.
    pub obstacle_id: String,
    /// What it is.
    pub kind: ObstacleKind,
    /// Outline, counter-clockwise, at any angle.
    pub outline: Polygon,
    /// Room it stands in.
    pub room_id: String,
    /// True keeps it when the plan is fed back.
    #[serde(default)]
    pub locked: bool,
}

/// What stands in a room and is no furniture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ObstacleKind {
    /// Holds up the building.
    Column,
    /// Ends at no other wall, or at one only.
    Wall,
}

/// One term of the layout cost.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CostTerm {
    /// Name of the term (`area_error`, `proportion`, ...).
    pub term: String,
    /// Weighted cost; lower is better.
    pub cost: f64,
}

impl Floorplan {
    /// Scheme of plans that people brought, which nothing may change.
    pub const GIVEN: &str = "given";

    /// Returns true for a plan that was brought rather than made here: what is wrong with it is reported, not mended.
    pub fn is_given(&self) -> bool {
        self.scheme == Self::GIVEN
    }

    /// Returns the room with this id.
    pub fn room(&self, id: &str) -> Option<&PlanRoom> {
        self.rooms.iter().find(|r| r.room_id == id)
    }

    /// Returns the doors and open passages of a room.
    pub fn doors_of<'a>(&'a self, id: &'a str) -> impl Iterator<Item = &'a Door> + 'a {
        self.doors.iter().filter(move |d| d.room_ids.iter().any(|r| r == id))
    }

    /// Returns the columns and free walls of a room.
    pub fn obstacles_of<'a>(&'a self, id: &'a str) -> impl Iterator<Item = &'a FixedObstacle> + 'a {
        self.obstacles.iter().filter(move |o| o.room_id == id)
    }

    /// Returns rectangles that cover the columns and free walls of a room.
    pub fn taken_in(&self, id: &str) -> Vec<Rect> {
        self.obstacles_of(id).flat_map(|o| o.outline.cover(COVER_STEP_M)).collect()
    }
}

impl Document for Floorplan {
    const KIND: &'static str = "floorplan";

    fn check(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        if self.version != 1 {
            problems.push(Problem::new("/version", format!("is {}, this release reads version 1", self.version)));
        }
        check_unique("/rooms", self.rooms.iter().map(|r| r.room_id.as_str()), &mut problems);
        check_unique("/walls", self.walls.iter().map(|w| w.wall_id.as_str()), &mut problems);
        check_unique("/doors", self.doors.iter().map(|d| d.door_id.as_str()), &mut problems);
        check_unique("/windows", self.windows.iter().map(|w| w.window_id.as_str()), &mut problems);
        for (i, room) in self.rooms.iter().enumerate() {
            for (name, polygon) in [("polygon", &room.polygon), ("net_polygon", &room.net_polygon)] {
                if polygon.signed_area() <= 0.0 {
                    problems.push(Problem::new(
                        format!("/rooms/{i}/{name}"),
                        format!("has signed area {:.3} m2; corners run counter-clockwise", polygon.signed_area()),
                    ));
                }
                if !polygon.is_rectilinear() {
                    problems.push(Problem::new(
                        format!("/rooms/{i}/{name}"),
                        "has an edge that is not along x or y; this release plans right angles only",
                    ));
                }
            }
        }
        check_unique("/obstacles", self.obstacles.iter().map(|o| o.obstacle_id.as_str()), &mut problems);
        for (i, obstacle) in self.obstacles.iter().enumerate() {
            if obstacle.outline.0.len() < 3 || obstacle.outline.signed_area() <= 0.0 {
                let path = format!("/obstacles/{i}/outline");
                problems.push(Problem::new(path, "needs three corners or more, counter-clockwise"));
            }
            if self.room(&obstacle.room_id).is_none() {
                let path = format!("/obstacles/{i}/room_id");
                problems.push(Problem::new(path, format!("room `{}` is not in rooms", obstacle.room_id)));
            }
        }
        check_links(&self.links, |id| self.room(id).map(|r| r.level), &mut problems);
        self.check_levels(&mut problems);
        let known = |id: &String| self.room(id).is_some();
        for (i, wall) in self.walls.iter().enumerate() {
            if wall.room_ids.is_empty() || wall.room_ids.len() > 2 || !wall.room_ids.iter().all(known) {
                problems
                    .push(Problem::new(format!("/walls/{i}/room_ids"), "needs one or two ids of rooms in this plan"));
            }
        }
        for (i, door) in self.doors.iter().enumerate() {
            if door.room_ids.is_empty() || door.room_ids.len() > 2 || !door.room_ids.iter().all(known) {
                problems
                    .push(Problem::new(format!("/doors/{i}/room_ids"), "needs one or two ids of rooms in this plan"));
            }
            if door.slide.is_some() && door.kind != DoorKind::Sliding {
                problems.push(Problem::new(format!("/doors/{i}/slide"), "is for doors of the kind `sliding`"));
            }
            if door.clear_width_m > door.line.length() + crate::TOLERANCE_M {
                problems.push(Problem::new(
                    format!("/doors/{i}/clear_width_m"),
                    format!("{} m is more than the opening of {:.3} m", door.clear_width_m, door.line.length()),
                ));
            }
        }
        for (i, window) in self.windows.iter().enumerate() {
            if !known(&window.room_id) {
                problems.push(Problem::new(
                    format!("/windows/{i}/room_id"),
                    format!("room `{}` is not in rooms", window.room_id),
                ));
            }
            if window.sill_m >= window.head_m {
                problems.push(Problem::new(
                    format!("/windows/{i}/sill_m"),
                    format!("{} m is not below the head at {} m", window.sill_m, window.head_m),
                ));
            }
        }
        problems
    }
}
