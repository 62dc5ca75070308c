//! What a server is told before it starts: places, addresses, tokens, limits.
//!
//! [`read`] makes a checked [`Config`] of a TOML text, of variables and of flags. Reading the file and the environment is
//! the caller's.

mod read;

use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;

use crate::access::Token;

pub use read::{PREFIX, read};

/// A checked configuration.
#[derive(Debug, Clone)]
pub struct Config {
    /// Folder of the databases, jobs and registered domains.
    pub data_dir: PathBuf,
    /// Address to listen on; port 0 takes a free one.
    pub listen: SocketAddr,
    /// Certificate chain and key, PEM; plain text when absent.
    pub tls: Option<Tls>,
    /// Who may do what; empty for everybody on loopback.
    pub tokens: Vec<Token>,
    /// Origins of web pages that may call.
    pub cors_origins: Vec<String>,
    /// Names beside loopback ones under which a server on loopback is asked: those of a proxy before it.
    pub hosts: Vec<String>,
    /// Folders from which clients may have the server read.
    pub read_roots: Vec<PathBuf>,
    /// Folders in which data sets are made: they are among the jobs of administrators.
    pub data_sets: Vec<PathBuf>,
    /// Whether clients may have the server fetch documents from public addresses.
    pub fetch_documents: bool,
    /// Bounds of what one client and all clients may use.
    pub limits: Limits,
    /// Long work.
    pub jobs: Jobs,
    /// How long a stop waits for calls and jobs, at most.
    pub drain: Duration,
    /// Level of the log: `error`, `warn`, `info`, `debug`.
    pub log_level: String,
}

/// Files of TLS.
#[derive(Clone)]
pub struct Tls {
    /// Certificate chain, PEM.
    pub certificate_file: PathBuf,
    /// Private key, PEM.
    pub key_file: PathBuf,
}

impl std::fmt::Debug for Tls {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Tls").field("certificate_file", &self.certificate_file).finish_non_exhaustive()
    }
}

/// Bounds of what one client and all clients may use.
#[derive(Debug, Clone, PartialEq)]
pub struct Limits {
    /// Largest message of a client, bytes.
    pub message_bytes: usize,
    /// Largest upload of a client in all its messages, bytes.
    pub upload_bytes: u64,
    /// Connections at a time.
    pub connections: usize,
    /// Connections of one address at a time.
    pub connections_per_address: usize,
    /// Calls at a time.
    pub calls: usize,
    /// Calls of one client at a time.
    pub calls_per_client: usize,
    /// Calls of one client in a second, on average.
    pub rate_per_s: f64,
    /// Calls of one client at once, beyond the average.
    pub burst: f64,
    /// Threads that search and generate.
    pub threads: usize,
    /// Calls that wait for such a thread.
    pub waiting: usize,
    /// Longest time of calls that look something up.
    pub lookup: Duration,
    /// Longest time of calls that make or check something.
    pub work: Duration,
    /// Longest time of streams.
    pub stream: Duration,
}

/// Bounds of long work.
#[derive(Debug, Clone, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Jobs {
    /// Jobs that run at a time.
    pub workers: usize,
    /// Jobs that wait, all clients together.
    pub waiting: usize,
    /// Jobs that wait of one client.
    pub waiting_per_client: usize,
    /// Ended jobs that are kept, with logs and results.
    pub kept: usize,
    /// Worlds of one batch.
    pub batch_worlds: u32,
}
