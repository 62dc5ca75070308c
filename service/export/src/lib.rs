//! Files of a checked world: pure functions from a [`World`](d3dgen_model::world::World) to bytes, one exporter per target.
//!
//! What it is not for: checking worlds (`pipeline::world`) and touching the disk; callers write the files. Nothing here
//! reads a clock, the environment or installed fonts, so the same world gives the same bytes everywhere.

pub mod error;
pub mod exporters;
pub mod file;
pub mod film;
pub mod manifest;
pub mod models;
pub mod render;
pub mod roadmap;
pub mod scene;
pub mod subject;
pub mod view;
pub mod yaml;

mod color;
mod font;
mod picture;
mod used;
mod xml;

pub use error::Error;
pub use exporters::Exporter;
pub use file::File;
pub use subject::Subject;

#[cfg(test)]
mod sample;
