//! The d3dgen service: one process that owns the databases of rules and assets and answers clients in any language.
//!
//! | module | what |
//! |---|---|
//! | [`config`] | what a server is told: file, variables and flags in layers |
//! | [`access`], [`methods`], [`gate`] | who may call what, how much and how long |
//! | [`connection`] | TCP and TLS |
//! | [`pool`] | threads for what takes the processor, with cancellation |
//! | [`status`], [`metrics`] | answers when something goes wrong; counters |
//!
//! What it is not for: files, environment and the clock of a command. It measures times and listens; the date comes from
//! its caller.

pub mod access;
pub mod config;
pub mod connection;
pub mod error;
pub mod gate;
pub mod methods;
pub mod metrics;
pub mod pool;
pub mod status;

pub use config::Config;
pub use error::Error;
