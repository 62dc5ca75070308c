//! Tests across crates, built as one binary.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on panics where it stands")]

mod arrows;
mod assets;
mod crowd;
mod dataset;
mod documents;
mod domain_guide;
mod errors;
mod eval;
mod fit_robot;
mod free_floor;
mod goldens;
#[cfg(unix)]
mod interrupted;
mod knowledge;
mod own_plan;
mod pins;
mod proposals;
mod readme;
mod same_bytes;
mod samples;
mod schemas;
