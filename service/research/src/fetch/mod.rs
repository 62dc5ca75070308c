//! Gets documents from the network: safely (no address inside, nothing endless), politely (robots.txt, few requests), and
//! once (a cache on disk that can be replayed without a network).
//!
//! What it is not for: understanding what comes back (`read`), and following links: only addresses that the caller gives
//! are fetched, and where a server redirects them.

mod address;
mod cache;
mod code;
mod exchange;
mod options;
mod resolve;
mod robots;
mod target;

pub use address::{Network, refusal};
pub use cache::{Cache, Entry};
pub use code::Code;
pub use options::{Mode, Options};
pub use resolve::{Resolve, Resolved, SystemResolver};
pub use robots::Robots;

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use tokio::sync::Mutex;
use tokio::time::Instant;
use url::Url;

use crate::Error;
use crate::read::Kind;
use cache::Found;
use code::Fault;
use exchange::{Answer, Body};

/// Returns the present time in seconds since 1970 UTC; given by the caller, as this crate has no clock.
pub type Clock = Arc<dyn Fn() -> u64 + Send + Sync>;

/// A document as fetched.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fetched {
    /// Where it was asked for and found, when, and what it is.
    pub entry: Entry,
    /// Its bytes, decompressed.
    pub bytes: Vec<u8>,
    /// Whether it came from the cache.
    pub from_cache: bool,
}

/// Fetches documents. Cheap to share by reference; requests to one host wait for each other.
pub struct Fetcher {
    options: Options,
    cache: Option<Cache>,
    resolver: Arc<dyn Resolve>,
    clock: Clock,
    hosts: Mutex<BTreeMap<String, Arc<Mutex<Origin>>>>,
}

/// What is known about a server: its robots.txt once read, and when it was asked last.
#[derive(Default)]
struct Origin {
    robots: Option<Robots>,
    last: Option<Instant>,
}

impl Fetcher {
    /// Returns a fetcher that resolves names by the operating system.
    pub fn new(options: Options, cache: Option<Cache>, clock: Clock) -> Self {
        Self::with_resolver(options, cache, clock, Arc::new(SystemResolver))
    }

    /// The same with another way to resolve names.
    pub fn with_resolver(options: Options, cache: Option<Cache>, clock: Clock, resolver: Arc<dyn Resolve>) -> Self {
        Self { options, cache, resolver, clock, hosts: Mutex::default() }
    }

    /// Returns a document, from the cache or the network as the options say.
    ///
    /// # Errors
    ///
    /// [`Error::Fetch`] with a [`Code`] when the address leads where it may not, or no readable document comes back;
    /// [`Error::Cache`] when the document cannot be kept.
    pub async fn fetch(&self, address: &str) -> Result<Fetched, Error> {
        let url = target::check(address, &self.options).map_err(|f| f.of(address))?;
        let found = self.cache.as_ref().map_or(Found::Miss, |c| c.find(url.as_str()));
        match (self.options.mode, found) {
            (Mode::Offline, Found::Hit(entry, bytes)) => return Ok(Fetched { entry, bytes, from_cache: true }),
            (Mode::Offline, Found::Miss) => {
                let reason = "is not in the cache, and nothing is fetched offline; run once without --offline";
                return Err(Fault::new(Code::NotInCache, reason).of(address));
            }
            (Mode::Offline, Found::Damaged(reason)) => return Err(Fault::new(Code::DamagedCache, reason).of(address)),
            (Mode::Online { max_age }, Found::Hit(entry, bytes)) => {
                let age = Duration::from_secs((self.clock)().saturating_sub(entry.fetched_at_s));
                if max_age.is_none_or(|max| age <= max) {
                    return Ok(Fetched { entry, bytes, from_cache: true });
                }
            }
            // A damaged copy is replaced.
            (Mode::Online { .. }, Found::Miss | Found::Damaged(_)) => {}
        }
        let (last, answer) = self.follow(&url).await.map_err(|f| f.of(address))?;
        let content_type = answer.content_type;
        let kind = Kind::of(&answer.body, content_type.as_deref(), last.path());
        let kind = kind.map_err(|reason| Fault::new(Code::UnsupportedType, reason).of(address))?;
        let entry = Entry::new(url.as_str(), last.as_str(), (self.clock)(), content_type, kind, &answer.body);
        if let Some(cache) = &self.cache {
            cache.keep(&entry, &answer.body)?;
        }
        Ok(Fetched { entry, bytes: answer.body, from_cache: false })
    }

    /// Follows redirects, each checked like a new address, to a document.
    async fn follow(&self, url: &Url) -> Result<(Url, Answer), Fault> {
        let mut url = url.clone();
        for _ in 0..=self.options.max_redirects {
            let answer = self.polite(&url).await?;
            match answer.status {
                200 => return Ok((url, answer)),
                301 | 302 | 303 | 307 | 308 => url = self.redirected(&url, answer.location.as_deref())?,
                404 | 410 => {
                    let reason = format!("status {}: the document is not there (any more)", answer.status);
                    return Err(Fault::new(Code::CitationUnresolved, reason));
                }
                status => return Err(Fault::new(Code::HttpStatus, format!("the server answers with status {status}"))),
            }
        }
        let reason = format!("more than {} redirects", self.options.max_redirects);
        Err(Fault::new(Code::BadRedirect, reason))
    }

    fn redirected(&self, from: &Url, location: Option<&str>) -> Result<Url, Fault> {
        let location = location.ok_or_else(|| Fault::new(Code::BadRedirect, "a redirect names no address"))?;
        let to = from.join(location);
        let to = to.map_err(|e| Fault::new(Code::BadRedirect, format!("a redirect to {location:?}: {e}")))?;
        let to = target::check_url(to, &self.options)
            .map_err(|f| Fault { reason: format!("a redirect: {}", f.reason), ..f })?;
        if from.scheme() == "https" && to.scheme() == "http" {
            return Err(Fault::new(Code::InsecureRedirect, format!("a redirect from https to {to}")));
        }
        Ok(to)
    }

    /// Gets one URL if robots.txt allows it, and not too soon after the last request to the same server.
    async fn polite(&self, url: &Url) -> Result<Answer, Fault> {
        // Before robots.txt, so that a refused host is called refused, not unreachable.
        target::addresses(url, &self.options, self.resolver.as_ref()).await?;
        let name = url.origin().ascii_serialization();
        let origin = Arc::clone(self.hosts.lock().await.entry(name).or_default());
        let mut origin = origin.lock().await;
        let robots = match &origin.robots {
            Some(robots) => robots.clone(),
            None => {
                let robots = self.robots(url).await?;
                origin.last = Some(Instant::now());
                origin.robots.insert(robots).clone()
            }
        };
        let path = url.query().map_or_else(|| url.path().to_owned(), |query| format!("{}?{query}", url.path()));
        if !robots.allows(&path) {
            let reason = if robots.is_failure() { "cannot be had, which counts as forbidden" } else { "forbids it" };
            return Err(Fault::new(Code::Robots, format!("robots.txt of {} {reason}", url.authority())));
        }
        let delay =
            robots.crawl_delay().unwrap_or_default().min(self.options.max_crawl_delay).max(self.options.crawl_delay);
        if let Some(last) = origin.last {
            tokio::time::sleep_until(last + delay).await;
        }
        let answer = self.get(url, Body::Document).await;
        origin.last = Some(Instant::now());
        answer
    }

    /// Returns what the robots.txt of a server says: nothing there allows all, a failing server forbids all.
    async fn robots(&self, url: &Url) -> Result<Robots, Fault> {
        let unusable = |_| Fault::new(Code::InvalidUrl, "has no robots.txt");
        let mut at = url.join("/robots.txt").map_err(unusable)?;
        for _ in 0..=self.options.max_redirects {
            let answer = match self.get(&at, Body::FirstBytes(robots::MAX_BYTES)).await {
                Ok(answer) => answer,
                // A name that leads elsewhere than a moment ago is an attack, not a failing server.
                Err(fault) if fault.code == Code::BlockedAddress => return Err(fault),
                Err(_) => return Ok(Robots::disallow_all()),
            };
            match answer.status {
                200 => return Ok(Robots::parse(&answer.body, self.options.robot())),
                301 | 302 | 303 | 307 | 308 => match self.redirected(&at, answer.location.as_deref()) {
                    Ok(to) => at = to,
                    Err(_) => return Ok(Robots::disallow_all()),
                },
                400..=499 => return Ok(Robots::allow_all()),
                _ => return Ok(Robots::disallow_all()),
            }
        }
        // The RFC: after too many redirects, as if there were none.
        Ok(Robots::allow_all())
    }

    async fn get(&self, url: &Url, body: Body) -> Result<Answer, Fault> {
        let addresses = target::addresses(url, &self.options, self.resolver.as_ref()).await?;
        exchange::get(url, &addresses, &self.options, body).await
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn redirects_are_checked_like_new_addresses() {
        let fetcher = Fetcher::new(Options::default(), None, Arc::new(|| 0));
        let cases = [
            ("https://a.test/x", Some("/y"), Ok("https://a.test/y")),
            ("http://a.test/x", Some("https://b.test/#part"), Ok("https://b.test/")),
            ("https://a.test/x", Some("http://a.test/y"), Err(Code::InsecureRedirect)),
            ("http://a.test/x", Some("//10.0.0.1/"), Err(Code::BlockedAddress)),
            ("http://a.test/x", Some("http://0x7f.1/"), Err(Code::BlockedAddress)),
            ("http://a.test/x", Some("file:///etc/passwd"), Err(Code::UnsupportedScheme)),
            ("http://a.test/x", Some("http://u:p@b.test/"), Err(Code::CredentialsInUrl)),
            ("http://a.test/x", Some("http://b.test:22/"), Err(Code::BlockedPort)),
            ("http://a.test/x", Some("http://[::bad"), Err(Code::BadRedirect)),
            ("http://a.test/x", None, Err(Code::BadRedirect)),
        ];
        for (from, location, expected) in cases {
            let found = fetcher.redirected(&Url::parse(from).expect("cases are valid"), location);
            let found = found.as_ref().map(Url::as_str).map_err(|f| f.code);
            assert_eq!(found, expected, "{from} to {location:?}");
        }
    }
}
