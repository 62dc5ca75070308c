//! Fetching documents from servers on loopback that behave well, badly and dishonestly. Nothing here needs a network.

mod addresses;
mod cache;
mod limits;
mod robots;
mod server;
mod shared;
