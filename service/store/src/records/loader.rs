//! Fills records that nobody else can see yet: for upgrades and restored snapshots.

use super::state::State;
use crate::error::Result;
use crate::kv::{Batch, KeyValue};

/// A batch is stored when it has this many bytes or records.
const BATCH_BYTES: usize = 4 << 20;
const BATCH_RECORDS: usize = 4096;

/// Stores records in batches of bounded size; nothing counts before [`Loader::finish`].
pub(crate) struct Loader<'a> {
    records: &'a dyn KeyValue,
    batch: Batch,
    bytes: usize,
    state: State,
}

impl<'a> Loader<'a> {
    pub(crate) fn new(records: &'a dyn KeyValue) -> Self {
        Self { records, batch: Batch::new(), bytes: 0, state: State::default() }
    }

    /// Adds a record that is new, with its envelope.
    pub(crate) fn add(&mut self, table: &str, key: &[u8], enveloped: Vec<u8>) -> Result<()> {
        match self.state.tallies.get_mut(table) {
            Some(tally) => tally.add(table, key),
            None => self.state.tallies.entry(table.to_owned()).or_default().add(table, key),
        }
        self.bytes += key.len() + enveloped.len();
        self.batch.put(table, key, enveloped);
        if self.bytes >= BATCH_BYTES || self.batch.len() >= BATCH_RECORDS {
            self.records.apply(&std::mem::take(&mut self.batch))?;
            self.bytes = 0;
        }
        Ok(())
    }

    /// Stores the rest, and what the store says about itself.
    pub(crate) fn finish(mut self, revision: u64) -> Result<()> {
        self.state.revision = revision;
        self.state.put(&mut self.batch);
        self.records.apply(&self.batch)
    }
}
