//! Plans that people bring: files of other programs become rooms, walls and openings, as they are.
//!
//! `readers` has one file a format; each makes a [`Drawing`]. [`lay_out`] turns a drawing upright, joins its rooms at
//! their walls and puts the openings into them; [`assemble`] makes the floorplan document. What is wrong with a building
//! (a narrow door, a room without a window) is none of this crate's business: the hard rules report it. What is no
//! building at all (rooms on top of each other, outlines that cross themselves) is refused with its place.
//!
//! It knows no domain's words and no files on disk: bytes in, documents out.

mod add;
mod assemble;
mod attach;
mod cabins;
mod cells;
mod clean;
mod drawing;
mod error;
mod faces;
mod layout;
mod leaves;
mod levels;
mod links;
mod pieces;
pub mod readers;
mod rooms;
mod snap;
mod straighten;
mod upright;
mod walls;
mod words;

pub use assemble::assemble;
pub use drawing::{Drawing, DrawnCabin, DrawnFloor, DrawnLabel, DrawnOpening, DrawnRoom, DrawnWall, OpeningKind};
pub use error::Error;
pub use layout::{LaidOpening, LaidRoom, Layout, lay_out};
pub use readers::{Plan, Source, read};

/// How a plan is read, beside the file itself.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Options {
    /// Name of the format; recognized from the file when absent.
    pub format: Option<String>,
    /// Length of one unit of the drawing, m, where the file does not say it or says it wrong.
    pub meters_per_unit: Option<f64>,
    /// Storey to read alone; all of them otherwise.
    pub level: Option<String>,
    /// Makes outlines with slanted walls of steps instead of refusing them; walls drawn as lines are in any case.
    pub rectify: bool,
    /// Thickness of walls that are drawn as lines, m: inner and outer ones.
    pub inner_wall_m: Option<f64>,
    /// See `inner_wall_m`.
    pub outer_wall_m: Option<f64>,
    /// Adds doors where rooms cannot be reached.
    pub add_doors: bool,
    /// Adds a window to each room that needs daylight and has none.
    pub add_windows: bool,
}
