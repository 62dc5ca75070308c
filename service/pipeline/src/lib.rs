//! The stages from prompt to checked world. Each stage folder reads alike: `retrieve.rs` (what the databases say),
//! the engine, `check.rs` (hard constraints), `assemble.rs` (build the model type).
//!
//! Stages take values and return documents; they read no file, clock or environment.

pub mod error;
pub mod floorplan;
pub mod generate;
pub mod placement;
pub mod scenario;
pub mod scene_graph;
pub mod world;

pub use error::Error;
