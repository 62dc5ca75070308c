//! Checks where a URL leads before anything is sent: its scheme, its port, and every address of its host.
//!
//! What it is not for: connecting. `exchange` connects to the addresses checked here and to no others.

use std::net::{IpAddr, SocketAddr};

use url::{Host, Url};

use super::code::{Code, Fault};
use super::options::Options;
use super::resolve::Resolve;

/// The longest URL that is worked on.
const MAX_URL_BYTES: usize = 4096;

/// Returns a URL that may be fetched as far as its text shows, without its fragment.
pub fn check(text: &str, options: &Options) -> Result<Url, Fault> {
    if text.len() > MAX_URL_BYTES {
        let reason = format!("the address has {} bytes, the limit is {MAX_URL_BYTES}", text.len());
        return Err(Fault::new(Code::InvalidUrl, reason));
    }
    let url =
        Url::parse(text).map_err(|e| Fault::new(Code::InvalidUrl, format!("is no address of a document: {e}")))?;
    check_url(url, options)
}

/// The same for a URL that is parsed already, such as the target of a redirect.
pub fn check_url(mut url: Url, options: &Options) -> Result<Url, Fault> {
    url.set_fragment(None);
    if !matches!(url.scheme(), "http" | "https") {
        let reason = format!("only http and https are fetched, not {}", url.scheme());
        return Err(Fault::new(Code::UnsupportedScheme, reason));
    }
    if !url.username().is_empty() || url.password().is_some() {
        return Err(Fault::new(Code::CredentialsInUrl, "the address has a user name or password; leave it out"));
    }
    let port = url.port_or_known_default().unwrap_or_default();
    if !options.ports.contains(&port) {
        let allowed = options.ports.iter().map(u16::to_string).collect::<Vec<_>>().join(", ");
        return Err(Fault::new(Code::BlockedPort, format!("port {port} is not fetched from, only {allowed}")));
    }
    // `url` has turned every odd form (octal, hexadecimal, one number) into a plain address.
    let literal = match url.host() {
        None => return Err(Fault::new(Code::InvalidUrl, "the address has no host")),
        Some(Host::Domain(name)) if name.trim_end_matches('.').is_empty() => {
            return Err(Fault::new(Code::InvalidUrl, "the address has no host"));
        }
        Some(Host::Domain(_)) => None,
        Some(Host::Ipv4(v4)) => Some(IpAddr::V4(v4)),
        Some(Host::Ipv6(v6)) => Some(IpAddr::V6(v6)),
    };
    if let Some(address) = literal {
        permit(address, options)?;
    }
    Ok(url)
}

/// Returns the addresses that the host of a checked URL has now, all of them public.
pub async fn addresses(url: &Url, options: &Options, resolver: &dyn Resolve) -> Result<Vec<SocketAddr>, Fault> {
    let port = url.port_or_known_default().unwrap_or_default();
    let found = match url.host() {
        Some(Host::Ipv4(v4)) => vec![IpAddr::V4(v4)],
        Some(Host::Ipv6(v6)) => vec![IpAddr::V6(v6)],
        Some(Host::Domain(name)) => {
            let lookup = tokio::time::timeout(options.connect_timeout, resolver.resolve(name)).await;
            let lookup = lookup.map_err(|_| Fault::new(Code::Timeout, format!("resolving {name} took too long")))?;
            lookup.map_err(|e| Fault::new(Code::UnresolvedHost, format!("{name} does not resolve: {e}")))?
        }
        None => Vec::new(),
    };
    if found.is_empty() {
        return Err(Fault::new(Code::UnresolvedHost, "the host has no address"));
    }
    // One address inside is enough to refuse: which one is connected to is up to chance.
    found.iter().try_for_each(|a| permit(*a, options))?;
    Ok(found.into_iter().map(|a| SocketAddr::new(a, port)).collect())
}

fn permit(address: IpAddr, options: &Options) -> Result<(), Fault> {
    let Some(kind) = options.refusal(address) else { return Ok(()) };
    Err(Fault::new(Code::BlockedAddress, format!("leads to {address}, {kind}; only public addresses are fetched from")))
}
