//! The clients against a loopback server: every provider's answers and errors, retries, budget, recordings, noise.

// A panic is how a test says no.
#![allow(clippy::unwrap_used)]

mod cases;
mod check;
mod fake_server;
mod fixtures;
mod limits;
mod mutations;
mod recordings;
mod retries;
mod server;
