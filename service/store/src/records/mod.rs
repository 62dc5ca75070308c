//! Records: payloads under text keys in named tables, checked whenever they are read.
//!
//! What a payload means is not known here, and neither is what is derived from it ([`crate::index`] is told a
//! [`Store::revision`] to compare with).

mod envelope;
pub mod json;
mod loader;
mod open;
mod state;
mod store;
mod verify;
mod view;
mod witness;

pub(crate) use envelope::wrap;
pub(crate) use loader::Loader;
pub(crate) use open::fill;
pub use store::{Access, Options, Store};
pub(crate) use verify::Steps;
pub use verify::{Problem, Progress};
pub use view::{Record, Records, View};
pub(crate) use witness::FILE as WITNESS;

use crate::error::{Error, Result};

/// Longest key, bytes.
pub const KEY_LIMIT: usize = 1024;

/// Longest payload, bytes.
pub const PAYLOAD_LIMIT: usize = 16 << 20;

/// Longest name of a table, bytes.
pub const TABLE_LIMIT: usize = 64;

/// Checks a table's name: lower-case letters, digits and `_`, beginning with a letter.
pub(crate) fn check_table(table: &str) -> Result<()> {
    let plain = table.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_');
    let begins = table.bytes().next().is_some_and(|b| b.is_ascii_lowercase());
    if plain && begins && table.len() <= TABLE_LIMIT {
        return Ok(());
    }
    let what = format!(
        "{table:?} names no table: needs 1 to {TABLE_LIMIT} lower-case letters, digits and underscores, a letter first"
    );
    Err(Error::Limit { what })
}

/// Checks key and size of a record that is to be stored.
pub(crate) fn check_record(table: &str, key: &[u8], payload: Option<&[u8]>) -> Result<()> {
    let size = payload.map_or(0, <[u8]>::len);
    let what = if key.is_empty() || key.len() > KEY_LIMIT {
        format!("key of table {table} has {} bytes, needs 1 to {KEY_LIMIT}", key.len())
    } else if std::str::from_utf8(key).is_err() {
        format!("key {} of table {table} is no UTF-8 text", key.escape_ascii())
    } else if size > PAYLOAD_LIMIT {
        format!("record {} of table {table} has {size} bytes, limit {PAYLOAD_LIMIT}", key.escape_ascii())
    } else {
        return Ok(());
    };
    Err(Error::Limit { what })
}

/// Checks a value as it is stored, with its envelope.
pub(crate) fn checked(table: &str, key: &[u8], value: &[u8]) -> Result<()> {
    envelope::unwrap(table, key, value).map(drop).map_err(|reason| view::damaged(table, key, reason))
}
