//! Pages of lists: where one goes on, as a token that fits its own request only.

use prost::Message;
use sha2::{Digest, Sha256};
use tonic::Status;

use crate::status::invalid;

/// Entries of a page when the client does not say.
const USUAL: usize = 50;
/// Entries of a page at most.
const MOST: usize = 1000;
/// How far lists go.
const DEPTH: usize = 1_000_000;

/// A page of a list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Page {
    /// Entries before it.
    pub offset: usize,
    /// Entries of it at most.
    pub size: usize,
    digest: String,
}

impl Page {
    /// Reads size and token; `request` is the request with both cleared.
    ///
    /// # Errors
    /// `INVALID_ARGUMENT` for a negative size and for a token of another request.
    pub fn new(size: i32, token: &str, request: &impl Message) -> Result<Self, Status> {
        let size = usize::try_from(size).map_err(|_| invalid("page_size", format!("is {size}, needs 0 or more")))?;
        let size = if size == 0 { USUAL } else { size.min(MOST) };
        let digest = crate::access::hex(&Sha256::digest(request.encode_to_vec())[..8]);
        let offset = if token.is_empty() {
            0
        } else {
            let parts = token.split_once('-').filter(|(_, of)| *of == digest);
            let offset = parts.and_then(|(at, _)| usize::from_str_radix(at, 16).ok()).filter(|at| *at <= DEPTH);
            offset.ok_or_else(|| invalid("page_token", "is not of this request: repeat it as it was, or begin anew"))?
        };
        Ok(Self { offset, size, digest })
    }

    /// Returns how many entries to find, to know whether there are more.
    pub fn wanted(&self) -> usize {
        self.offset + self.size + 1
    }

    /// Returns the entries of this page of a list from its beginning, and the token of the next page.
    pub fn cut<T>(&self, all: impl IntoIterator<Item = T>) -> (Vec<T>, String) {
        let mut rest = all.into_iter().skip(self.offset);
        let page: Vec<T> = rest.by_ref().take(self.size).collect();
        let next = rest.next().map_or_else(String::new, |_| format!("{:x}-{}", self.offset + self.size, self.digest));
        (page, next)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_make_up_the_list_and_tokens_fit_their_request() {
        let (request, other) = ("a".to_owned(), "b".to_owned());
        let (mut token, mut seen) = (String::new(), Vec::new());
        for _ in 0..4 {
            let page = Page::new(3, &token, &request).unwrap();
            let (part, next) = page.cut(0..10);
            seen.extend(part);
            if !next.is_empty() {
                assert!(Page::new(3, &next, &other).is_err());
            }
            token = next;
        }
        assert_eq!((seen, token.as_str()), ((0..10).collect(), ""));
        for wrong in ["x", "-", "zz-00", "1", "../"] {
            assert!(Page::new(0, wrong, &request).is_err(), "{wrong}");
        }
        assert!(Page::new(-1, "", &request).is_err());
        assert_eq!(Page::new(i32::MAX, "", &request).unwrap().size, MOST);
    }
}
