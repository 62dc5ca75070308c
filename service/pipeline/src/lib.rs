//! The stages from prompt to checked world, one folder each; `generate` drives them.
//!
//! Stages take values and return documents; they read no file, clock or environment.

pub mod bring;
pub mod edit;
mod fit;
pub mod floorplan;
pub mod generate;
pub mod placement;
pub mod scenario;
pub mod scene_graph;
pub mod variations;
mod ways_out;
pub mod world;

pub use d3dgen_model::stage::{Error, Stop};
