//! Data sets of worlds: a spec (`spec`) becomes tasks (`tasks`), each task a world under a pinned snapshot (`maker`, `snapshot`),
//! tasks in a row a block with a line in a ledger (`part`), and all blocks a data set that people can train on (`assemble`).
//!
//! Every file is a function of spec and snapshot: shards made anywhere in any order come to the same bytes as one run. With the
//! feature `cluster` blocks are made by workers that take them from a queue and lay them into a store of objects.
//!
//! What it is not for: how worlds are made (`pipeline`), flags, clock and environment (the command).

pub mod assemble;
#[cfg(feature = "cluster")]
pub mod cluster;
pub mod digest;
pub mod error;
pub mod maker;
pub mod part;
pub mod row;
pub mod shelf;
pub mod snapshot;
pub mod spec;
pub mod standing;
pub mod tasks;
pub mod verify;

mod held_out;
mod pack;
mod physics;

pub use error::Error;
