//! Why a document could not be fetched, as codes that stay the same from release to release.
//!
//! What it is not for: the sentence a person reads; that stands beside the code in `Error::Fetch`.

use serde::{Deserialize, Serialize};

/// Why a document could not be fetched.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Code {
    /// The address is no URL.
    InvalidUrl,
    /// The scheme is neither http nor https.
    UnsupportedScheme,
    /// The URL has a user name or password.
    CredentialsInUrl,
    /// The port is none of those allowed.
    BlockedPort,
    /// The host is, or resolves to, an address that is not public.
    BlockedAddress,
    /// The host's name does not resolve.
    UnresolvedHost,
    /// No connection, or no trusted one, could be made.
    ConnectFailed,
    /// The server was too slow.
    Timeout,
    /// More redirects than allowed, or a redirect without a target.
    BadRedirect,
    /// A redirect from https to http.
    InsecureRedirect,
    /// The server's robots.txt forbids it, or cannot be had because the server fails.
    Robots,
    /// The page that a citation names is not there (404 or 410).
    CitationUnresolved,
    /// Another status than 200.
    HttpStatus,
    /// The document is larger than allowed, counted after decompression.
    TooLarge,
    /// The document is not HTML, PDF, Markdown or text.
    UnsupportedType,
    /// The answer ended early or is damaged.
    Incomplete,
    /// The cache has no such document, and fetching is off.
    NotInCache,
    /// The cache's copy of the document does not match its hash or cannot be read.
    DamagedCache,
}

impl Code {
    /// Returns the code as it is written in files.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::InvalidUrl => "invalid_url",
            Self::UnsupportedScheme => "unsupported_scheme",
            Self::CredentialsInUrl => "credentials_in_url",
            Self::BlockedPort => "blocked_port",
            Self::BlockedAddress => "blocked_address",
            Self::UnresolvedHost => "unresolved_host",
            Self::ConnectFailed => "connect_failed",
            Self::Timeout => "timeout",
            Self::BadRedirect => "bad_redirect",
            Self::InsecureRedirect => "insecure_redirect",
            Self::Robots => "robots",
            Self::CitationUnresolved => "citation_unresolved",
            Self::HttpStatus => "http_status",
            Self::TooLarge => "too_large",
            Self::UnsupportedType => "unsupported_type",
            Self::Incomplete => "incomplete",
            Self::NotInCache => "not_in_cache",
            Self::DamagedCache => "damaged_cache",
        }
    }
}

/// A code with its sentence, before it is known which document it is about.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Fault {
    pub code: Code,
    pub reason: String,
}

impl Fault {
    pub fn new(code: Code, reason: impl Into<String>) -> Self {
        Self { code, reason: reason.into() }
    }

    /// Returns it as the error of a document.
    pub fn of(self, url: &str) -> crate::Error {
        crate::Error::Fetch { url: url.to_owned(), code: self.code, reason: self.reason }
    }
}
