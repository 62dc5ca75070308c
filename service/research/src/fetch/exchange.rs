//! One request to checked addresses, and its answer with every limit kept.
//!
//! What it is not for: redirects, robots.txt and the cache, which are the fetcher's.

use std::net::SocketAddr;
use std::sync::Once;

use reqwest::dns::{Addrs, Name, Resolve, Resolving};
use reqwest::header::{ACCEPT, CONTENT_TYPE, HeaderMap, LOCATION};
use reqwest::{Client, Response, redirect};
use url::Url;

use super::code::{Code, Fault};
use super::options::Options;
use crate::read::Kind;

/// What is asked for.
const ACCEPTED: &str = "text/html,application/xhtml+xml,application/pdf,text/markdown,text/plain;q=0.9,*/*;q=0.1";

/// What to do with a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Body {
    /// A document: of a known type, whole, at most as large as the options say.
    Document,
    /// At most so many bytes of any type; the rest is left.
    FirstBytes(usize),
}

/// An answer of a server.
#[derive(Debug)]
pub struct Answer {
    pub status: u16,
    pub location: Option<String>,
    pub content_type: Option<String>,
    pub body: Vec<u8>,
}

/// Sends a GET to one of the addresses, and returns the answer. The body is read for status 200 only.
pub async fn get(url: &Url, addresses: &[SocketAddr], options: &Options, body: Body) -> Result<Answer, Fault> {
    match tokio::time::timeout(options.total_timeout, exchange(url, addresses, options, body)).await {
        Ok(answer) => answer,
        Err(_) => Err(Fault::new(Code::Timeout, format!("took more than {} s", options.total_timeout.as_secs_f32()))),
    }
}

async fn exchange(url: &Url, addresses: &[SocketAddr], options: &Options, body: Body) -> Result<Answer, Fault> {
    let client = client(addresses, options)?;
    let response = client.get(url.clone()).header(ACCEPT, ACCEPTED).send().await.map_err(|e| fault(&e))?;
    // Pinning makes this so; a change of the library below must not undo it unseen.
    if response.remote_addr().is_some_and(|a| !addresses.contains(&a)) {
        return Err(Fault::new(Code::BlockedAddress, "the connection went to another address than the checked one"));
    }
    let status = response.status().as_u16();
    let location = text(response.headers(), LOCATION.as_str());
    let content_type = text(response.headers(), CONTENT_TYPE.as_str());
    let body = if status != 200 {
        Vec::new()
    } else if let Body::FirstBytes(limit) = body {
        first_bytes(response, limit).await?
    } else {
        if Kind::declared(content_type.as_deref()) == crate::read::Declared::Unsupported {
            let found = content_type.as_deref().unwrap_or_default();
            return Err(Fault::new(Code::UnsupportedType, format!("is {found}, not HTML, PDF, Markdown or text")));
        }
        whole(response, options.max_bytes).await?
    };
    Ok(Answer { status, location, content_type, body })
}

/// Answers for every name with the checked addresses, so that no spelling of a name is looked up a second time.
struct Pinned(Vec<SocketAddr>);

impl Resolve for Pinned {
    fn resolve(&self, _: Name) -> Resolving {
        let addresses: Addrs = Box::new(self.0.clone().into_iter());
        Box::pin(std::future::ready(Ok(addresses)))
    }
}

/// Returns a client that can reach the checked addresses and nothing else.
fn client(addresses: &[SocketAddr], options: &Options) -> Result<Client, Fault> {
    static TLS: Once = Once::new();
    // Fails when another crate has installed it before, which is as good.
    TLS.call_once(|| drop(rustls::crypto::ring::default_provider().install_default()));
    let builder = Client::builder()
        .user_agent(&options.user_agent)
        .redirect(redirect::Policy::none())
        .referer(false)
        .no_proxy()
        .pool_max_idle_per_host(0)
        .connect_timeout(options.connect_timeout)
        .read_timeout(options.read_timeout)
        // For an address as host the resolver is not asked; that address is the checked one.
        .dns_resolver(Pinned(addresses.to_vec()));
    builder.build().map_err(|e| Fault::new(Code::ConnectFailed, format!("no client can be made: {}", chain(&e))))
}

fn text(headers: &HeaderMap, name: &str) -> Option<String> {
    headers.get(name).map(|v| String::from_utf8_lossy(v.as_bytes()).into_owned())
}

/// Returns the whole body, counted as it comes out of decompression.
async fn whole(mut response: Response, limit: usize) -> Result<Vec<u8>, Fault> {
    let too_large = || Fault::new(Code::TooLarge, format!("is larger than {limit} bytes"));
    if response.content_length().is_some_and(|n| n > limit as u64) {
        return Err(too_large());
    }
    let mut body = Vec::new();
    while let Some(chunk) = response.chunk().await.map_err(|e| fault(&e))? {
        if body.len() + chunk.len() > limit {
            return Err(too_large());
        }
        body.extend_from_slice(&chunk);
    }
    Ok(body)
}

async fn first_bytes(mut response: Response, limit: usize) -> Result<Vec<u8>, Fault> {
    let mut body = Vec::new();
    while let Some(chunk) = response.chunk().await.map_err(|e| fault(&e))? {
        body.extend(chunk.iter().take(limit - body.len()));
        if body.len() >= limit {
            break;
        }
    }
    Ok(body)
}

fn fault(error: &reqwest::Error) -> Fault {
    if error.is_timeout() {
        Fault::new(Code::Timeout, "the server takes too long to answer")
    } else if error.is_connect() {
        Fault::new(Code::ConnectFailed, format!("no connection: {}", chain(error)))
    } else {
        Fault::new(Code::Incomplete, format!("the answer is damaged or ended early: {}", chain(error)))
    }
}

/// Returns the innermost cause; the outer ones say only that a request failed.
fn chain(error: &dyn std::error::Error) -> String {
    let mut innermost = error;
    while let Some(source) = innermost.source() {
        innermost = source;
    }
    innermost.to_string()
}
