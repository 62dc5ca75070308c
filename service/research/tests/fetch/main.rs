//! Fetching documents from servers on loopback that behave well, badly and dishonestly. Nothing here needs a network.

#![allow(clippy::unwrap_used)] // helpers of tests are tests

mod addresses;
mod cache;
mod limits;
mod robots;
mod server;
mod shared;
