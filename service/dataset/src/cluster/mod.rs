//! One data set on many machines: a leader puts blocks into a queue, workers take them and lay results into a store of objects.
//!
//! The ledger in the store is the truth, the queue is a hint. A worker writes the result first, named by its digest and only if
//! it is not there; then the line of the ledger, also only if it is not there; then it answers the queue. What the queue loses
//! the leader puts in again; what it delivers twice is made twice, to the same bytes.

mod leader;
mod objects;
mod queue;
mod worker;

use serde::{Deserialize, Serialize};

pub use leader::{Leader, Standing};
pub use objects::Objects;
pub use queue::{Queue, QueueSettings};
pub use worker::{Counters, Worker};

use crate::digest::sha256;
use crate::error::Error;
use crate::part::Part;

/// What a worker must know of a run, beside its spec and snapshot.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Run {
    /// Name of the snapshot's file.
    pub snapshot: String,
    /// Tasks of a block.
    pub tasks_per_block: u64,
    /// Turns that workers give it for each turn of a run of priority 1.
    pub priority: u8,
}

/// A block that nobody could make, and why.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Poison {
    /// Number of the block.
    pub block: u64,
    /// What became of the last attempt.
    pub reason: String,
}

/// Returns the id of a run: the name of its spec and the digest of all that its bytes depend on.
pub fn run_id(part: &Part) -> String {
    let of = format!("{}\n{}\n{}", sha256(part.spec_text.as_bytes()), part.snapshot.digest(), part.tasks_per_block());
    format!("{}-{}", part.spec.name, &sha256(of.as_bytes())[..12])
}

/// Places in the store.
pub(crate) mod places {
    /// Returns where the spec of a run is.
    pub fn spec(run: &str) -> String {
        format!("runs/{run}/spec.toml")
    }

    /// Returns where is written what workers must know of a run.
    pub fn about(run: &str) -> String {
        format!("runs/{run}/run.json")
    }

    /// Returns where a snapshot is.
    pub fn snapshot(file_name: &str) -> String {
        format!("snapshots/{file_name}")
    }

    /// Returns where the lines of the ledger of a run are.
    pub fn ledger(run: &str) -> String {
        format!("runs/{run}/ledger")
    }

    /// Returns where the line of a block is.
    pub fn line(run: &str, block: u64) -> String {
        format!("runs/{run}/ledger/{block:08}.json")
    }

    /// Returns where blocks are set aside that nobody could make.
    pub fn poison(run: &str) -> String {
        format!("runs/{run}/poison")
    }

    /// Returns where a block is set aside.
    pub fn poisoned(run: &str, block: u64) -> String {
        format!("runs/{run}/poison/{block:08}.json")
    }

    /// Returns where a result is.
    pub fn blob(sha256: &str) -> String {
        format!("blobs/{}/{sha256}.tar", &sha256[..2])
    }

    /// Returns the number of the block that a line or a poison is of.
    pub fn block_of(place: &str) -> Option<u64> {
        place.rsplit('/').next()?.strip_suffix(".json")?.parse().ok()
    }
}

/// Returns a failure of queue or store.
pub(crate) fn failed(what: &str) -> impl Fn(&dyn std::fmt::Display) -> Error + use<> {
    let what = what.to_owned();
    move |error| Error::Cluster(format!("{what}: {error}"))
}
