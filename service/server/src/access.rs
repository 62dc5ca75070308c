//! Who may do what: bearer tokens, kept as digests, with one of three scopes each.

use serde::Deserialize;
use sha2::{Digest, Sha256};
use subtle::ConstantTimeEq;

/// How much a token allows; each includes those before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Scope {
    /// Looking things up, making and checking worlds: nothing is kept.
    Read,
    /// Jobs, and changes of rules, assets and domains.
    Write,
    /// Backups, and the jobs of everybody.
    Admin,
}

impl Scope {
    /// All of them, the least first.
    pub const ALL: [Self; 3] = [Self::Read, Self::Write, Self::Admin];

    /// Returns the word that configurations use.
    pub fn name(self) -> &'static str {
        match self {
            Self::Read => "read",
            Self::Write => "write",
            Self::Admin => "admin",
        }
    }
}

/// A token by its digest; the token itself is nowhere.
#[derive(Clone, PartialEq, Eq)]
pub struct Token {
    /// Name for logs, and the client that jobs belong to.
    pub name: String,
    /// How much it allows.
    pub scope: Scope,
    /// SHA-256 of the token.
    pub digest: [u8; 32],
}

impl std::fmt::Debug for Token {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Token").field("name", &self.name).field("scope", &self.scope).finish_non_exhaustive()
    }
}

/// Who is calling.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Caller {
    /// Name of the token, or the address of a peer without one.
    pub name: String,
    /// How much they may do.
    pub scope: Scope,
}

/// The tokens of a server.
#[derive(Debug, Clone)]
pub struct Access {
    tokens: Vec<Token>,
}

impl Access {
    /// Returns the access that these tokens give; without any, everybody may do everything, which [`crate::Config`]
    /// allows on loopback only.
    pub fn new(tokens: Vec<Token>) -> Self {
        Self { tokens }
    }

    /// Returns who calls with this `authorization` header; none when the token is missing or wrong.
    ///
    /// All digests are compared, each in constant time.
    pub fn caller(&self, authorization: Option<&[u8]>, peer: &str) -> Option<Caller> {
        if self.tokens.is_empty() {
            return Some(Caller { name: peer.to_owned(), scope: Scope::Admin });
        }
        let (scheme, token) = authorization?.split_at_checked(7)?;
        if !scheme.eq_ignore_ascii_case(b"bearer ") {
            return None;
        }
        let digest = digest(token.trim_ascii());
        let mut found = None;
        for known in &self.tokens {
            if bool::from(known.digest.as_slice().ct_eq(digest.as_slice())) {
                found = Some(known);
            }
        }
        found.map(|t| Caller { name: t.name.clone(), scope: t.scope })
    }
}

/// Returns the digest under which a token is kept.
pub fn digest(token: &[u8]) -> [u8; 32] {
    Sha256::digest(token).into()
}

/// Returns a digest as configurations write it.
pub fn hex(bytes: &[u8]) -> String {
    data_encoding::HEXLOWER.encode(bytes)
}

/// Returns the digest that 64 hexadecimal digits say.
pub fn digest_from_hex(text: &str) -> Option<[u8; 32]> {
    data_encoding::HEXLOWER_PERMISSIVE.decode(text.as_bytes()).ok()?.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_right_token_opens() {
        let token = Token { name: "ci".into(), scope: Scope::Write, digest: digest(b"secret") };
        let access = Access::new(vec![token]);
        let with = |header: &str| access.caller(Some(header.as_bytes()), "1.2.3.4").map(|c| (c.name, c.scope));
        assert_eq!(with("Bearer secret"), Some(("ci".into(), Scope::Write)));
        assert_eq!(with("bearer secret"), Some(("ci".into(), Scope::Write)));
        for wrong in ["", "Bearer", "Bearer ", "Bearer secre", "Bearer secret2", "Basic secret", "secret"] {
            assert_eq!(with(wrong), None, "{wrong}");
        }
        assert_eq!(access.caller(None, "1.2.3.4"), None);
        assert_eq!(Access::new(Vec::new()).caller(None, "x").map(|c| c.scope), Some(Scope::Admin));
    }

    #[test]
    fn digests_are_read_as_they_are_written() {
        let digest = digest(b"x");
        assert_eq!(digest_from_hex(&hex(&digest)), Some(digest));
        assert_eq!(digest_from_hex(&"g".repeat(64)), None);
        assert_eq!(digest_from_hex("ab"), None);
    }
}
