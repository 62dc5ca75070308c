//! Records as JSON, for those who know what theirs mean; their errors hold those of the store.

use std::ops::ControlFlow;

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::View;
use crate::{Error, KeyRange};

/// Returns a payload.
///
/// # Panics
/// For records that JSON cannot hold: keys that are no strings.
pub fn encode(record: &impl Serialize) -> Vec<u8> {
    serde_json::to_vec(record).expect("records hold only finite numbers and string keys")
}

/// Returns the record of a payload.
///
/// # Errors
/// `Damaged` when it is of another form.
pub fn decode<T: DeserializeOwned>(table: &str, key: &str, payload: &[u8]) -> Result<T, Error> {
    serde_json::from_slice(payload).map_err(|e| {
        let reason = format!("not of the form of this table: {e}");
        Error::Damaged { table: table.into(), key: key.into(), reason }
    })
}

/// Returns one record.
///
/// # Errors
/// As [`decode`], and those of the store.
pub fn get<T: DeserializeOwned>(view: &View<'_>, table: &str, key: &str) -> Result<Option<T>, Error> {
    view.get(table, key)?.map(|payload| decode(table, key, &payload)).transpose()
}

/// Calls `visit` with each record of a range, in the order of keys.
///
/// # Errors
/// As [`decode`], and those of the store and of `visit`.
pub fn each<T: DeserializeOwned, E: From<Error>>(
    view: &View<'_>,
    table: &str,
    range: &KeyRange,
    mut visit: impl FnMut(&str, T) -> Result<(), E>,
) -> Result<(), E> {
    view.scan(table, range, |key, payload| {
        visit(key, decode(table, key, payload)?)?;
        Ok(ControlFlow::Continue(()))
    })
}
