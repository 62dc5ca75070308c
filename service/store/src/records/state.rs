//! What a store says about itself beside its records, in the same batches: how often it was changed, and for each
//! table how many keys there are and the sum of their hashes, so that records which vanish are missed.

use std::collections::BTreeMap;

use super::envelope;
use crate::error::{Error, Result};
use crate::kv::{self, Batch, KeyRange};

/// The table for it; callers cannot name it.
pub(crate) const TABLE: &str = "_store";

const REVISION: &[u8] = b"revision";
const TALLY: &str = "tally/";

/// Keys of one table.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Tally {
    pub(crate) count: u64,
    /// Wrapping sum of the keys' hashes: it does not depend on their order.
    pub(crate) keys: u64,
}

impl Tally {
    pub(crate) fn add(&mut self, table: &str, key: &[u8]) {
        self.count = self.count.wrapping_add(1);
        self.keys = self.keys.wrapping_add(envelope::key_hash(table, key));
    }

    pub(crate) fn remove(&mut self, table: &str, key: &[u8]) {
        self.count = self.count.wrapping_sub(1);
        self.keys = self.keys.wrapping_sub(envelope::key_hash(table, key));
    }
}

/// All of it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct State {
    /// Grows by one with each batch.
    pub(crate) revision: u64,
    pub(crate) tallies: BTreeMap<String, Tally>,
}

impl State {
    /// Reads it.
    ///
    /// # Errors
    /// [`Error::Damaged`] names what of it cannot be read.
    pub(crate) fn read(view: &dyn kv::View) -> Result<Self> {
        let mut state = Self { revision: revision(view)?, tallies: BTreeMap::new() };
        view.scan(TABLE, &KeyRange::prefix(TALLY), &mut |key, value| {
            let table = String::from_utf8_lossy(key.get(TALLY.len()..).unwrap_or_default()).into_owned();
            state.tallies.insert(table, tally_of(key, value)?);
            Ok(std::ops::ControlFlow::Continue(()))
        })?;
        Ok(state)
    }

    /// Adds all of it to `batch`.
    pub(crate) fn put(&self, batch: &mut Batch) {
        for table in self.tallies.keys() {
            self.put_tally(table, batch);
        }
        self.put_revision(batch);
    }

    pub(crate) fn put_revision(&self, batch: &mut Batch) {
        batch.put(TABLE, REVISION, envelope::wrap(TABLE, REVISION, &self.revision.to_le_bytes()));
    }

    pub(crate) fn put_tally(&self, table: &str, batch: &mut Batch) {
        let key = format!("{TALLY}{table}");
        let tally = self.tallies.get(table).copied().unwrap_or_default();
        let value = [tally.count.to_le_bytes(), tally.keys.to_le_bytes()].concat();
        batch.put(TABLE, key.as_bytes(), envelope::wrap(TABLE, key.as_bytes(), &value));
    }
}

/// Reads how often the records were changed.
pub(crate) fn revision(view: &dyn kv::View) -> Result<u64> {
    let bytes = view.get(TABLE, REVISION)?.ok_or_else(|| damaged(REVISION, "it is missing".to_owned()))?;
    let payload = envelope::unwrap(TABLE, REVISION, &bytes).map_err(|reason| damaged(REVISION, reason))?;
    let number = payload.try_into().map_err(|_| damaged(REVISION, "it is no number".to_owned()))?;
    Ok(u64::from_le_bytes(number))
}

/// Reads how many keys a table has.
pub(crate) fn tally(view: &dyn kv::View, table: &str) -> Result<Tally> {
    let key = format!("{TALLY}{table}");
    match view.get(TABLE, key.as_bytes())? {
        Some(bytes) => tally_of(key.as_bytes(), &bytes),
        None => Ok(Tally::default()),
    }
}

fn tally_of(key: &[u8], bytes: &[u8]) -> Result<Tally> {
    let payload = envelope::unwrap(TABLE, key, bytes).map_err(|reason| damaged(key, reason))?;
    match payload.split_first_chunk::<8>() {
        Some((count, keys)) if keys.len() == 8 => Ok(Tally {
            count: u64::from_le_bytes(*count),
            keys: keys.try_into().map(u64::from_le_bytes).unwrap_or_default(),
        }),
        _ => Err(damaged(key, "it is no tally".to_owned())),
    }
}

fn damaged(key: &[u8], reason: String) -> Error {
    Error::Damaged { table: TABLE.to_owned(), key: String::from_utf8_lossy(key).into_owned(), reason }
}
