//! What is stored under which key. The tables of the knowledge base may be in the same store.
//!
//! | table | key | payload |
//! |---|---|---|
//! | `asset` | asset id | [`AssetRecord`] |
//! | `asset_content` | digest of the source, asset id | asset id |
//! | `asset_path` | path below the folder that was ingested | [`IngestedFile`] |
//! | `asset_removed` | object id | [`RemovedRecord`] |
//! | `asset_change` | ten digits | [`Change`] |

use std::collections::BTreeMap;

use d3dgen_store::records::json;
pub(super) use d3dgen_store::records::json::{decode, encode, get};
use d3dgen_store::{KeyRange, View};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::annotation::Annotation;
use crate::error::Error;

pub(super) const ASSETS: &str = "asset";
pub(super) const CONTENTS: &str = "asset_content";
pub(super) const PATHS: &str = "asset_path";
pub(super) const REMOVED: &str = "asset_removed";
pub(super) const CHANGES: &str = "asset_change";

/// An asset that is kept.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct AssetRecord {
    /// What is known of it.
    pub annotation: Annotation,
    /// Digest of its model's file, when it has one.
    pub model: Option<String>,
    /// Change that wrote it.
    pub change: u64,
}

/// A file that was ingested.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct IngestedFile {
    /// Digest of it and of what speaks of it.
    pub hash: String,
    /// The asset it became, or is a copy of.
    pub asset_id: String,
    /// Digests of the other files it is made of, by their paths below the folder that was ingested.
    #[serde(default)]
    pub companions: BTreeMap<String, String>,
}

/// An object of the library that is removed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct RemovedRecord {
    /// Change that removed it.
    pub change: u64,
}

/// Who changes the database, when and why; the clock and the user's name come from outside.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Provenance {
    /// Name of the person or program.
    pub who: String,
    /// Date and time in UTC, `2026-11-21T14:13:00Z`.
    pub when: String,
    /// Reason, in a sentence.
    pub why: String,
}

/// What sort of change it was.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Models read from files.
    Ingest,
    /// Models made here.
    Generate,
    /// Annotations changed by a person.
    Annotate,
    /// Assets removed.
    Remove,
    /// Removed objects of the library brought back.
    Restore,
}

/// One change.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Change {
    /// Number, from 1.
    pub seq: u64,
    /// What sort.
    pub kind: Kind,
    /// By whom, when, why.
    #[serde(flatten)]
    pub provenance: Provenance,
    /// Assets it concerns.
    pub assets: Vec<String>,
}

/// Calls `visit` with each record of a table, in the order of keys.
pub(super) fn each<T: DeserializeOwned>(
    view: &View<'_>,
    table: &str,
    visit: impl FnMut(&str, T) -> Result<(), Error>,
) -> Result<(), Error> {
    json::each(view, table, &KeyRange::all(), visit)
}
