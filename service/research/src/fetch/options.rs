//! What the caller decides about fetching.
//!
//! What it is not for: defaults that depend on the machine; there are none, and no environment variable is read.

use std::net::IpAddr;
use std::time::Duration;

use super::address::{Network, refusal};

/// Where documents come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// From the cache when its copy is at most so old (`None`: however old), else from the network.
    Online {
        /// How old a copy may be.
        max_age: Option<Duration>,
    },
    /// From the cache alone.
    Offline,
}

/// What the caller decides about fetching.
#[derive(Debug, Clone)]
pub struct Options {
    /// Where documents come from.
    pub mode: Mode,
    /// The `User-Agent` sent; its part before the first `/` is what robots.txt files are searched for.
    pub user_agent: String,
    /// Ports that may be connected to.
    pub ports: Vec<u16>,
    /// Blocks that may be connected to although they are not public. For tests against servers on loopback.
    pub allow_addresses: Vec<Network>,
    /// The most redirects followed for one document.
    pub max_redirects: usize,
    /// The most bytes a document may have after decompression.
    pub max_bytes: usize,
    /// The longest that resolving a name, and making a connection, may take each.
    pub connect_timeout: Duration,
    /// The longest pause of a server within an answer.
    pub read_timeout: Duration,
    /// The longest that one request may take, to the last byte of its answer.
    pub total_timeout: Duration,
    /// The least time between two requests to one host.
    pub crawl_delay: Duration,
    /// The most that a robots.txt may raise this time to.
    pub max_crawl_delay: Duration,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            mode: Mode::Online { max_age: None },
            user_agent: concat!("d3dgen-research/", env!("CARGO_PKG_VERSION"), " (+https://github.com/d3dgen/d3dgen)")
                .into(),
            ports: vec![80, 443],
            allow_addresses: Vec::new(),
            max_redirects: 5,
            max_bytes: 20 << 20,
            connect_timeout: Duration::from_secs(10),
            read_timeout: Duration::from_secs(15),
            total_timeout: Duration::from_secs(60),
            crawl_delay: Duration::from_secs(1),
            max_crawl_delay: Duration::from_secs(10),
        }
    }
}

impl Options {
    /// Returns what kind of address it is when it may not be connected to.
    pub(super) fn refusal(&self, address: IpAddr) -> Option<&'static str> {
        let allowed = self.allow_addresses.iter().any(|n| n.contains(address.to_canonical()));
        if allowed { None } else { refusal(address) }
    }

    /// Returns the name that robots.txt files are searched for.
    pub(super) fn robot(&self) -> &str {
        self.user_agent.split(['/', ' ']).next().unwrap_or_default()
    }
}
