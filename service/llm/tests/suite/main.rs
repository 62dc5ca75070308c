//! The clients against a loopback server: every provider's answers and errors, retries, budget, recordings, noise.

mod cases;
mod check;
mod fixtures;
mod limits;
mod mutations;
mod recordings;
mod retries;
mod server;
