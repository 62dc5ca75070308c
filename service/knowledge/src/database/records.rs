//! What is stored under which key, and how it becomes a knowledge base again.
//!
//! | table | key | payload |
//! |---|---|---|
//! | `domain` | domain | [`DomainRecord`] |
//! | `reference` | domain `/` ref_id | [`ReferenceRecord`]: the document without its constraints |
//! | `constraint` | domain `/` constraint_id | [`ConstraintRecord`] |
//! | `change` | ten digits | [`Change`](super::Change) |
//! | `edit` | ten digits `/` six digits | a page of [`Edit`](super::Edit)s |

use std::collections::BTreeMap;

use d3dgen_model::knowledge::{Constraint, KnowledgeBase, Metadata, Reference};
use d3dgen_store::records::json;
pub(super) use d3dgen_store::records::json::{decode, encode, get};
use d3dgen_store::{KeyRange, View};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::error::Error;

pub(super) const DOMAINS: &str = "domain";
pub(super) const REFERENCES: &str = "reference";
pub(super) const CONSTRAINTS: &str = "constraint";
pub(super) const CHANGES: &str = "change";
pub(super) const EDITS: &str = "edit";

/// A domain that the database holds rules of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct DomainRecord {
    /// Head of its file.
    pub metadata: Metadata,
    /// Digest of the shipped knowledge base it began as; none when it came from elsewhere.
    pub shipped: Option<String>,
    /// Number of changes in force beside the shipped text.
    pub changes: u64,
    /// Place that the next new reference or constraint gets.
    pub next_place: u64,
}

/// A reference without its constraints.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct ReferenceRecord {
    /// Order in the file.
    pub place: u64,
    /// Change that wrote it.
    pub change: u64,
    /// The document; its list of constraints is empty.
    pub reference: Reference,
}

/// A constraint and the reference it belongs to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct ConstraintRecord {
    /// Order in the file.
    pub place: u64,
    /// Change that wrote it.
    pub change: u64,
    /// Its document.
    pub ref_id: String,
    /// The rule.
    pub constraint: Constraint,
}

/// Returns the key of a record of a domain.
pub(super) fn key(domain: &str, id: &str) -> String {
    format!("{domain}/{id}")
}

/// Returns the keys of a domain.
pub(super) fn of_domain(domain: &str) -> KeyRange {
    KeyRange::prefix(format!("{domain}/"))
}

/// Calls `visit` with each record of a range, in the order of keys.
pub(super) fn each<T: DeserializeOwned>(
    view: &View<'_>,
    table: &str,
    range: &KeyRange,
    visit: impl FnMut(&str, T) -> Result<(), Error>,
) -> Result<(), Error> {
    json::each(view, table, range, visit)
}

/// Everything stored of a domain, by id.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stored {
    pub domain: DomainRecord,
    pub references: BTreeMap<String, ReferenceRecord>,
    pub constraints: BTreeMap<String, ConstraintRecord>,
}

impl Stored {
    /// Reads a domain; `None` when the database has none of that name.
    pub fn read(view: &View<'_>, domain: &str) -> Result<Option<Self>, Error> {
        let Some(record) = get(view, DOMAINS, domain)? else { return Ok(None) };
        let (mut references, mut constraints) = (BTreeMap::new(), BTreeMap::new());
        each(view, REFERENCES, &of_domain(domain), |_, r: ReferenceRecord| {
            references.insert(r.reference.ref_id.clone(), r);
            Ok(())
        })?;
        each(view, CONSTRAINTS, &of_domain(domain), |_, c: ConstraintRecord| {
            constraints.insert(c.constraint.constraint_id.clone(), c);
            Ok(())
        })?;
        Ok(Some(Self { domain: record, references, constraints }))
    }

    /// Returns the knowledge base that the records come to, in the order of its file.
    pub fn assemble(&self) -> KnowledgeBase {
        let mut by_reference: BTreeMap<&str, Vec<&ConstraintRecord>> = BTreeMap::new();
        for record in self.constraints.values() {
            by_reference.entry(record.ref_id.as_str()).or_default().push(record);
        }
        let mut references: Vec<&ReferenceRecord> = self.references.values().collect();
        references.sort_by_key(|r| r.place);
        let whole = references.into_iter().map(|r| {
            let mut of_it = by_reference.remove(r.reference.ref_id.as_str()).unwrap_or_default();
            of_it.sort_by_key(|c| c.place);
            Reference { constraints: of_it.into_iter().map(|c| c.constraint.clone()).collect(), ..r.reference.clone() }
        });
        KnowledgeBase { metadata: self.domain.metadata.clone(), references: whole.collect() }
    }
}
