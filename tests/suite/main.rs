//! Tests across crates, built as one binary.

mod arrows;
mod documents;
mod domain_guide;
mod errors;
mod goldens;
#[cfg(unix)]
mod interrupted;
mod pins;
mod same_bytes;
mod schemas;
