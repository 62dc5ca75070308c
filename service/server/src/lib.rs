//! The d3dgen service: one process that owns the databases of rules and assets and answers clients in any language.
//!
//! | module | what |
//! |---|---|
//! | [`config`] | what a server is told: file, variables and flags in layers |
//! | [`access`], [`methods`], [`gate`] | who may call what, how much and how long |
//! | [`connection`] | TCP and TLS |
//! | [`databases`], [`own`] | rules, assets, indexes; the server's own records |
//! | [`domains`] | the domains at run time |
//! | [`core`] | what all services work with |
//! | [`library`] | worlds that clients keep |
//! | [`page`], [`pictures`] | the web page, and pictures by address |
//! | [`jobs`] | long work that survives a restart |
//! | [`data_sets`] | data sets that others make, among the jobs |
//! | [`grpc`], [`convert`] | the services of the contract |
//! | [`serve`], [`backup`] | a running server, and copies of its databases |
//! | [`names`] | names and paths that clients send |
//! | [`pool`] | threads for what takes the processor, with cancellation |
//! | [`status`], [`metrics`], [`health`] | answers when something goes wrong; counters; what is well |
//!
//! What it is not for: files, environment and the clock of a command. It measures times and listens; the date comes from
//! its caller.

pub mod access;
pub mod backup;
pub mod clock;
pub mod config;
pub mod connection;
pub mod convert;
pub mod core;
pub mod data_sets;
pub mod databases;
pub mod domains;
pub mod error;
pub mod gate;
pub mod grpc;
pub mod health;
pub mod jobs;
pub mod library;
pub mod methods;
pub mod metrics;
pub mod names;
pub mod own;
pub mod page;
pub mod pictures;
pub mod pool;
pub mod serve;
pub mod status;

pub use config::Config;
pub use error::Error;
