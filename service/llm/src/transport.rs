//! HTTP with limits: one POST or GET, a size limit on the unpacked body, no redirects, no proxy from the surroundings.
//! It does not retry and does not read what comes back.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use reqwest::header::{CONTENT_TYPE, HeaderName, HeaderValue};
use reqwest::redirect;
use serde_json::Value;

use crate::error::Error;
use crate::secret::Secret;

/// Time to connect, within the time of the whole call.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(15);

/// One call. Keys are in headers only.
#[derive(Debug, Clone)]
pub(crate) struct Call {
    /// Where to; holds nothing secret.
    pub url: String,
    /// Beside the content type.
    pub headers: Vec<(HeaderName, HeaderValue)>,
    /// Sent by POST; without one it is a GET.
    pub body: Option<Value>,
}

impl Call {
    /// Makes a call without headers.
    pub fn new(url: String, body: Option<Value>) -> Self {
        Self { url, headers: Vec::new(), body }
    }

    /// Adds a plain header.
    pub fn header(mut self, name: &'static str, value: &'static str) -> Self {
        self.headers.push((HeaderName::from_static(name), HeaderValue::from_static(value)));
        self
    }

    /// Adds a header with the key after `prefix`, unless there is no key.
    ///
    /// # Errors
    /// [`Error::Config`] if the key has characters that no header takes.
    pub fn key(mut self, name: &'static str, prefix: &str, key: Option<&Secret>) -> Result<Self, Error> {
        if let Some(key) = key.filter(|k| !k.is_empty()) {
            let value = HeaderValue::from_str(&format!("{prefix}{}", key.expose()));
            let mut value =
                value.map_err(|_| Error::config("the key has line breaks or other characters that no key has"))?;
            value.set_sensitive(true);
            self.headers.push((HeaderName::from_static(name), value));
        }
        Ok(self)
    }
}

/// What came back.
#[derive(Debug, Clone)]
pub(crate) struct Response {
    /// HTTP status.
    pub status: u16,
    /// Names in lower case.
    pub headers: BTreeMap<String, String>,
    /// Unpacked.
    pub body: Vec<u8>,
}

impl Response {
    /// Returns a header by its name in lower case.
    pub fn header(&self, name: &str) -> Option<&str> {
        self.headers.get(name).map(String::as_str)
    }

    /// Returns the body as text; broken characters are replaced.
    pub fn text(&self) -> Cow<'_, str> {
        String::from_utf8_lossy(&self.body)
    }
}

/// A client with its pool of connections.
pub(crate) struct Transport {
    http: reqwest::Client,
    limit_bytes: u64,
}

impl Transport {
    /// Makes a client for one base URL.
    ///
    /// # Errors
    /// [`Error::Config`] if the system has no root certificates for https.
    pub fn new(base_url: &str, limit_bytes: u64) -> Result<Self, Error> {
        // Another crate may have chosen a provider before; either will do.
        let _ = rustls::crypto::ring::default_provider().install_default();
        let mut builder = reqwest::Client::builder()
            .user_agent(concat!("d3dgen/", env!("CARGO_PKG_VERSION")))
            .redirect(redirect::Policy::none())
            .no_proxy()
            .referer(false)
            .connect_timeout(CONNECT_TIMEOUT);
        if base_url.starts_with("http://") {
            // A machine without root certificates can still speak to a local server.
            builder = builder.tls_certs_only([]);
        }
        let http = builder.build().map_err(|e| {
            Error::config(format!("https cannot be set up: {}; install the system's root certificates", chain(&e)))
        })?;
        Ok(Self { http, limit_bytes })
    }

    /// Makes the call.
    ///
    /// # Errors
    /// [`Error::Timeout`], [`Error::Unavailable`] if the connection fails or breaks off, [`Error::TooLarge`].
    pub async fn send(&self, call: &Call, timeout: Duration) -> Result<Response, Error> {
        let start = Instant::now();
        let mut request = match &call.body {
            Some(body) => self.http.post(&call.url).header(CONTENT_TYPE, "application/json").body(body.to_string()),
            None => self.http.get(&call.url),
        };
        for (name, value) in &call.headers {
            request = request.header(name, value);
        }
        let timed_out = |before_first_byte| Error::Timeout { after_ms: timeout.as_millis() as u64, before_first_byte };
        let sent = tokio::time::timeout(timeout, request.send()).await.map_err(|_| timed_out(true))?;
        let response = sent.map_err(|e| unavailable(None, &e))?;
        let left = timeout.saturating_sub(start.elapsed());
        tokio::time::timeout(left, self.receive(response)).await.map_err(|_| timed_out(false))?
    }

    async fn receive(&self, mut response: reqwest::Response) -> Result<Response, Error> {
        let status = response.status().as_u16();
        let text = |v: &HeaderValue| String::from_utf8_lossy(v.as_bytes()).into_owned();
        let headers = response.headers().iter().map(|(k, v)| (k.as_str().to_owned(), text(v))).collect();
        let mut body = Vec::new();
        while let Some(chunk) = response.chunk().await.map_err(|e| unavailable(Some(status), &e))? {
            if (body.len() + chunk.len()) as u64 > self.limit_bytes {
                return Err(Error::TooLarge { limit_bytes: self.limit_bytes });
            }
            body.extend_from_slice(&chunk);
        }
        Ok(Response { status, headers, body })
    }
}

fn unavailable(status: Option<u16>, error: &reqwest::Error) -> Error {
    let message = if error.is_connect() { format!("cannot connect: {}", chain(error)) } else { chain(error) };
    Error::Unavailable { status, retry_after_ms: None, message }
}

/// Returns the innermost reason: the outer ones repeat the URL and say little.
fn chain(error: &reqwest::Error) -> String {
    let mut reason: &dyn std::error::Error = error;
    while let Some(source) = reason.source() {
        reason = source;
    }
    reason.to_string()
}
