//! Names to addresses. A trait, so that tests can say where a name leads.
//!
//! What it is not for: judging addresses (`address`).

use std::io;
use std::net::IpAddr;
use std::pin::Pin;

/// What resolving a name ends in.
pub type Resolved<'a> = Pin<Box<dyn Future<Output = io::Result<Vec<IpAddr>>> + Send + 'a>>;

/// Finds the addresses of a name.
pub trait Resolve: Send + Sync {
    /// Returns all addresses of a name.
    ///
    /// # Errors
    ///
    /// When the name is not known or no name server answers.
    fn resolve<'a>(&'a self, host: &'a str) -> Resolved<'a>;
}

/// Asks the operating system.
#[derive(Debug, Clone, Copy, Default)]
pub struct SystemResolver;

impl Resolve for SystemResolver {
    fn resolve<'a>(&'a self, host: &'a str) -> Resolved<'a> {
        Box::pin(async move {
            let mut addresses: Vec<IpAddr> = tokio::net::lookup_host((host, 0)).await?.map(|a| a.ip()).collect();
            addresses.dedup();
            Ok(addresses)
        })
    }
}
