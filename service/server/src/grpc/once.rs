//! Changes that a client may repeat: the answer to a request id is kept, and given again.
//!
//! A change of the server's own records goes to the disk together with its answer. For other databases the intention is
//! kept before the change and the answer after it; what was cut short in between is found again by its provenance.

use std::cell::Cell;
use std::ops::ControlFlow;

use d3dgen_store::{Batch, KeyRange};
use prost::Message;
use serde::{Deserialize, Serialize};
use tonic::Status;

use crate::core::Core;
use crate::error::Error;
use crate::own::{self, REQUESTS};
use crate::status::{self, invalid};

/// How long an answer is kept for a repeat, ms: a week.
const KEPT_MS: u64 = 7 * 24 * 3600 * 1000;
/// Records that are forgotten with one batch.
const FORGOTTEN: usize = 1000;

/// A request that changes something.
pub(in crate::grpc) struct Once {
    /// Where its id stands.
    field: &'static str,
    /// None without a request id: a repeat is another request.
    key: Option<String>,
    digest: String,
    kept: Cell<bool>,
    /// When an earlier attempt began that was cut short.
    earlier: Cell<Option<u64>>,
}

/// What is kept of a request.
#[derive(Serialize, Deserialize)]
struct Record {
    /// SHA-256 of the request.
    digest: String,
    /// When, ms since 1970.
    at_ms: u64,
    /// The answer as bytes in hexadecimal digits; none while the change is being made.
    answer: Option<String>,
}

impl Once {
    /// Returns what protects a request.
    ///
    /// # Errors
    /// `INVALID_ARGUMENT` for an id that is no id.
    pub fn new(client: &str, method: &str, id: &str, request: &impl Message) -> Result<Self, Status> {
        Self::of("request_id", client, method, id, &crate::access::digest(&request.encode_to_vec()))
    }

    /// Returns what protects a request whose id stands in a field, by the digest of all that it says.
    ///
    /// # Errors
    /// `INVALID_ARGUMENT` for an id that is no id.
    pub fn of(field: &'static str, client: &str, method: &str, id: &str, digest: &[u8; 32]) -> Result<Self, Status> {
        if id.chars().any(|c| c.is_control() || c == '/') {
            return Err(invalid(field, "is an id without / and control characters"));
        }
        let key = (!id.is_empty()).then(|| format!("{client}/{method}/{id}"));
        let digest = crate::access::hex(digest);
        Ok(Self { field, key, digest, kept: Cell::new(false), earlier: Cell::new(None) })
    }

    /// Returns the answer that was given to this request before.
    ///
    /// # Errors
    /// `INVALID_ARGUMENT` when the id was used for another request.
    pub fn answered<T: Message + Default>(&self, core: &Core) -> Result<Option<T>, Status> {
        let Some(key) = &self.key else { return Ok(None) };
        let record: Option<Record> = own::get(&core.databases.own, REQUESTS, key).map_err(status::own)?;
        let Some(record) = record.filter(|r| !r.is_old(core.clock.now_ms())) else { return Ok(None) };
        if record.digest != self.digest {
            return Err(invalid(self.field, "was used for another request"));
        }
        let Some(answer) = record.answer else {
            self.earlier.set(Some(record.at_ms));
            return Ok(None);
        };
        let bytes: Option<Vec<u8>> = (0..answer.len() / 2)
            .map(|i| answer.get(2 * i..2 * i + 2).and_then(|pair| u8::from_str_radix(pair, 16).ok()))
            .collect();
        let answer = bytes.and_then(|b| T::decode(b.as_slice()).ok());
        answer.map(Some).ok_or_else(|| status::internal(&format!("request {key} is damaged")))
    }

    /// Keeps that the change is about to be made, and returns the time for its provenance: that of an earlier attempt, when
    /// there was one.
    ///
    /// # Errors
    /// `INTERNAL` when it cannot be kept.
    pub fn intend(&self, core: &Core) -> Result<(u64, bool), Status> {
        if let Some(earlier) = self.earlier.get() {
            return Ok((earlier, true));
        }
        let at_ms = core.clock.now_ms();
        if let Some(key) = &self.key {
            let mut batch = Batch::new();
            own::put(&mut batch, REQUESTS, key, &Record { digest: self.digest.clone(), at_ms, answer: None });
            core.databases.own.apply(batch).map_err(status::store)?;
        }
        Ok((at_ms, false))
    }

    /// Puts the answer into the batch of the change.
    pub fn also(&self, core: &Core, answer: &impl Message, batch: &mut Batch) {
        if let Some(key) = &self.key {
            let answer = Some(crate::access::hex(&answer.encode_to_vec()));
            let record = Record { digest: self.digest.clone(), at_ms: core.clock.now_ms(), answer };
            own::put(batch, REQUESTS, key, &record);
        }
        self.kept.set(true);
    }

    /// Keeps the answer, unless it went with the change.
    ///
    /// # Errors
    /// `INTERNAL` when it cannot be kept.
    pub fn keep(&self, core: &Core, answer: &impl Message) -> Result<(), Status> {
        if self.kept.get() || self.key.is_none() {
            return Ok(());
        }
        let mut batch = Batch::new();
        self.also(core, answer, &mut batch);
        core.databases.own.apply(batch).map(drop).map_err(status::store)
    }
}

impl Record {
    fn is_old(&self, now_ms: u64) -> bool {
        now_ms.saturating_sub(self.at_ms) > KEPT_MS
    }
}

/// Forgets the answers that nobody will ask for again; returns how many.
///
/// # Errors
/// `Store`; `Record`.
pub fn forget_old(core: &Core) -> Result<usize, Error> {
    let (store, now_ms) = (&core.databases.own, core.clock.now_ms());
    let mut count = 0;
    loop {
        let mut old = Vec::new();
        own::each(store, REQUESTS, &KeyRange::all(), |key, record: Record| {
            if record.is_old(now_ms) {
                old.push(key.to_owned());
            }
            Ok(if old.len() < FORGOTTEN { ControlFlow::Continue(()) } else { ControlFlow::Break(()) })
        })?;
        count += old.len();
        let is_last = old.len() < FORGOTTEN;
        let mut batch = Batch::new();
        for key in old {
            batch.delete(REQUESTS, key);
        }
        store.apply(batch)?;
        if is_last {
            return Ok(count);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_are_kept_for_a_week() {
        let record = Record { digest: String::new(), at_ms: 1000, answer: None };
        assert!(!record.is_old(1000 + KEPT_MS) && record.is_old(1001 + KEPT_MS) && !record.is_old(0));
    }
}
