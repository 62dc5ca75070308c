//! From where web pages may call.
//!
//! A server on loopback trusts whoever reaches it, and a browser reaches it for any page that is open: by its address from a
//! foreign origin, or by a name of the page's own that is made to mean 127.0.0.1. Both say what they are in their headers.

use std::net::IpAddr;

use http::uri::Authority;
use http::{HeaderMap, HeaderValue, Uri, header};
use tonic::Status;

use crate::config::Config;
use crate::status::{self, reason};

/// Which names and origins are answered.
#[derive(Debug)]
pub(super) struct Origins {
    /// True when only loopback names, and those of `hosts`, are this server.
    loopback: bool,
    hosts: Vec<String>,
    allowed: Vec<String>,
}

impl Origins {
    pub(super) fn new(config: &Config) -> Self {
        Self {
            loopback: config.listen.ip().is_loopback(),
            hosts: config.hosts.iter().map(|h| h.to_ascii_lowercase()).collect(),
            allowed: config.cors_origins.clone(),
        }
    }

    /// Refuses a call under a name that is not this server's, and one of a page from elsewhere.
    ///
    /// # Errors
    /// `PERMISSION_DENIED`.
    pub(super) fn check(&self, uri: &Uri, headers: &HeaderMap) -> Result<(), Status> {
        let host = headers.get(header::HOST);
        let named = uri.authority().cloned().into_iter().map(Ok);
        let named = named.chain(host.map(|h| Authority::try_from(h.as_bytes()).map_err(drop)));
        for name in named {
            let known = name.as_ref().is_ok_and(|name| !name.as_str().contains('@') && self.is_own(name.host()));
            if self.loopback && !known {
                let message = "this server is asked by a name that is not its own: use localhost, or put the name of a \
                               proxy into the setting `hosts`";
                return Err(status::because(reason::HOST, &Status::permission_denied(message)));
            }
        }
        let Some(origin) = headers.get(header::ORIGIN) else { return Ok(()) };
        let own = uri.authority().map(Authority::as_str).or(host.and_then(|h| h.to_str().ok()));
        match self.is_allowed(origin, own) {
            true => Ok(()),
            false => {
                let message = "pages of this origin may not call: cors_origins has those that may";
                Err(status::because(reason::ORIGIN, &Status::permission_denied(message)))
            }
        }
    }

    fn is_own(&self, host: &str) -> bool {
        let host = host.trim_start_matches('[').trim_end_matches(']').trim_end_matches('.').to_ascii_lowercase();
        host == "localhost"
            || host.ends_with(".localhost")
            || host.parse::<IpAddr>().is_ok_and(|address| address.to_canonical().is_loopback())
            || self.hosts.contains(&host)
    }

    fn is_allowed(&self, origin: &HeaderValue, own: Option<&str>) -> bool {
        let Ok(origin) = origin.to_str() else { return false };
        let of_own =
            origin.split_once("://").is_some_and(|(_, host)| own.is_some_and(|o| o.eq_ignore_ascii_case(host)));
        of_own || self.allowed.iter().any(|a| a == origin)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answer(origins: &Origins, host: &str, origin: &str) -> bool {
        let mut headers = HeaderMap::new();
        for (name, value) in [(header::HOST, host), (header::ORIGIN, origin)] {
            if !value.is_empty() {
                headers.insert(name, HeaderValue::from_str(value).unwrap());
            }
        }
        origins.check(&Uri::from_static("/x"), &headers).is_ok()
    }

    #[test]
    fn loopback_is_asked_by_its_own_names_and_by_listed_pages_only() {
        let origins = Origins {
            loopback: true,
            hosts: vec!["worlds.example".into()],
            allowed: vec!["https://studio.example".into()],
        };
        for host in ["localhost", "LOCALHOST:50051", "127.0.0.1:1", "[::1]:1", "app.localhost", "worlds.example", ""] {
            assert!(answer(&origins, host, ""), "{host}");
        }
        for host in
            ["evil.org", "localhost.evil.org", "127.0.0.1.nip.io:50051", "10.0.0.1", "x", "a b", "evil.org@localhost"]
        {
            assert!(!answer(&origins, host, ""), "{host}");
        }
        for (origin, allowed) in [
            ("https://studio.example", true),
            ("http://localhost:50051", true), // a page of this server itself
            ("http://localhost:8080", false),
            ("http://studio.example", false),
            ("https://studio.example.evil.org", false),
            ("null", false),
        ] {
            assert_eq!(answer(&origins, "localhost:50051", origin), allowed, "{origin}");
        }
        let open = Origins { loopback: false, hosts: Vec::new(), allowed: Vec::new() };
        assert!(answer(&open, "worlds.example", "") && !answer(&open, "worlds.example", "https://evil.org"));
    }

    #[test]
    fn the_name_of_a_request_over_http2_is_looked_at_too() {
        let origins = Origins { loopback: true, hosts: Vec::new(), allowed: Vec::new() };
        let asked = |uri: &'static str| origins.check(&Uri::from_static(uri), &HeaderMap::new()).is_ok();
        assert!(asked("http://127.0.0.1:50051/x") && !asked("http://evil.org:50051/x"));
    }
}
