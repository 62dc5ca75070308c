//! Checked types of every artifact that passes between stages, with the units and geometry they are written in.
//!
//! What it is not for: producing artifacts (`pipeline`), reading other people's formats (`export`), finding domains on
//! disk (`plugins`). Nothing here reads a clock, the environment or the network.
//!
//! Lengths are meters, areas square meters, angles radians; x east, y north, z up; yaw counter-clockwise from +x.
//! An object's own frame has x forward (the side its user stands on), y left, z up (ROS REP 103).

pub mod brief;
pub mod courts;
pub mod document;
pub mod domain;
pub mod edits;
pub mod error;
pub mod expression;
pub mod floorplan;
pub mod gazetteer;
pub mod geometry;
pub mod hours;
pub mod knowledge;
mod levels;
pub mod measures;
pub mod obstacles;
pub mod occupancy;
pub mod offer;
pub mod passage;
pub mod placements;
pub mod plausible;
pub mod proposal;
pub mod report;
pub mod robot_body;
pub mod robot_kind;
pub mod sanitary;
pub mod scenario;
pub mod scene_graph;
pub mod seed;
pub mod slides;
pub mod stage;
pub mod storeys;
pub mod style;
pub mod trajectory;
pub mod units;
pub mod way_in;
pub mod world;

pub use document::{Document, Problem};
pub use error::Error;
pub use geometry::{Point, Polygon, Pose, Rect, Segment};

/// Contact tolerance in meters: two lengths closer than this are the same length.
pub const TOLERANCE_M: f64 = 0.001;
