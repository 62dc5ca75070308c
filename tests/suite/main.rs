//! Tests across crates, built as one binary.

mod arrows;
mod documents;
mod schemas;
