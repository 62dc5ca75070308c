//! The stages from prompt to checked world, in a row: `generate` drives them, `edit` changes what they made, `bring` begins
//! with a plan that somebody has, `variations` makes several of one request, `task` one of a run of many.
//!
//! Each stage is a crate of its own that knows none of the others; here they are under the names they have everywhere. Stages
//! take values and return documents; they read no file, clock or environment.

mod assemble;
pub mod brief;
pub mod bring;
pub mod edit;
mod fit;
pub mod generate;
mod give_way;
mod grow;
mod mend;
pub mod task;
pub mod variations;
mod ways_out;

pub use d3dgen_floorplan as floorplan;
pub use d3dgen_model::stage::{Error, Stop};
pub use d3dgen_placement as placement;
pub use d3dgen_program as scene_graph;
pub use d3dgen_scenario as scenario;

/// Stage `world`: the documents of all stages put together, and judged.
pub mod world {
    pub use d3dgen_check::check;

    pub use crate::assemble::assemble;
}
