//! The server's own records, as JSON in a store of their own: jobs, registered domains, answered requests.

use std::ops::ControlFlow;

use d3dgen_store::{Batch, KeyRange, Store};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::Error;

/// Registered domains, by id.
pub const DOMAINS: &str = "domains";
/// Every version of registered domains, by id and number.
pub const DOMAIN_VERSIONS: &str = "domain_versions";
/// The version of each registered domain whose rules are in the database of rules.
pub const DOMAIN_RULES: &str = "domain_rules";
/// Jobs, by id.
pub const JOBS: &str = "jobs";
/// Lines of the logs of jobs, by id and number.
pub const JOB_LOGS: &str = "job_logs";
/// Kept worlds, by id.
pub const WORLDS: &str = "worlds";
/// How many worlds were kept so far: ids are never used again.
pub const WORLDS_COUNTED: &str = "worlds_counted";
/// What is said of the states of kept worlds, by id and number.
pub const WORLD_REVISIONS: &str = "world_revisions";
/// The states of kept worlds, by id and number.
pub const WORLD_STATES: &str = "world_states";
/// Requests that changed something, by client, method and the client's id.
pub const REQUESTS: &str = "requests";

/// Puts a record into a batch.
pub fn put<T: Serialize>(batch: &mut Batch, table: &'static str, key: &str, value: &T) {
    let bytes = serde_json::to_vec(value).expect("records hold only finite numbers and string keys");
    batch.put(table, key, bytes);
}

/// Returns a record.
///
/// # Errors
/// `Store`; `Record` when it is not what it should be.
pub fn get<T: DeserializeOwned>(store: &Store, table: &'static str, key: &str) -> Result<Option<T>, Error> {
    store.get(table, key)?.map(|bytes| decode(table, key, &bytes)).transpose()
}

/// Calls `visit` with the records of a range of keys.
///
/// # Errors
/// As [`get`]; those of `visit`.
pub fn each<T: DeserializeOwned>(
    store: &Store,
    table: &'static str,
    range: &KeyRange,
    mut visit: impl FnMut(&str, T) -> Result<ControlFlow<()>, Error>,
) -> Result<(), Error> {
    store.view()?.scan(table, range, |key, bytes| visit(key, decode(table, key, bytes)?))
}

fn decode<T: DeserializeOwned>(table: &'static str, key: &str, bytes: &[u8]) -> Result<T, Error> {
    serde_json::from_slice(bytes).map_err(|e| Error::Record { table, key: key.to_owned(), reason: e.to_string() })
}
