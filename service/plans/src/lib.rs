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
mod evidence;
mod faces;
mod layout;
mod leaves;
mod levels;
mod links;
mod options;
mod pieces;
pub mod readers;
mod rooms;
mod shape;
mod snap;
mod solids;
mod straighten;
mod upright;
mod walls;
mod words;

pub use assemble::assemble;
pub use drawing::{
    Drawing, DrawnCabin, DrawnFloor, DrawnLabel, DrawnOpening, DrawnRoom, DrawnShape, DrawnSolid, DrawnWall, Evidence,
    OpeningKind, SolidKind,
};
pub use error::Error;
pub use layout::{LaidObstacle, LaidOpening, LaidRoom, Layout, lay_out};
pub use options::{LayerUse, Options};
pub use readers::{Plan, Source, read};
