//! The server as a process of its own, as clients and operators meet it: needs the `d3dgen` command, which is built by
//! these tests where it is missing.

mod access;
mod assets;
mod command;
mod data_sets;
#[cfg(unix)]
mod deploy;
mod edge;
mod fault;
mod hostile;
mod services;
mod support;
