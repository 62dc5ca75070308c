//! Measures of finished worlds: those of the paper, those of the field, compliance, adjacency, diversity, robot fit.
//!
//! A world is judged from its documents alone (`world.json`, and `report.json` for what the rules said of it), by
//! geometry of this crate's own: nothing here knows how a world was made, and no check of the generator is called.
//! Every measure is in a file of `metrics/` that says where its definition comes from.
//!
//! What it is not for: making worlds, reading files, measuring time (callers hand in what they measured).

pub mod bench;
pub mod compare;
pub mod error;
pub mod evaluation;
pub mod figures;
pub mod html;
pub mod kinds;
pub mod measure;
pub mod metrics;
pub mod picture;

mod grid;
mod solid;
mod storeys;

#[cfg(test)]
mod sample;

pub use error::Error;
pub use evaluation::{Evaluation, WorldMeasures};
pub use measure::{Known, measure};
