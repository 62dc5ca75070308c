//! The database of building rules: whole knowledge bases in and out, single rules changed with who, when and why, every
//! change listed and taken back.
//!
//! What it is not for: what a rule means for a building (`retrieve`) and where the files lie (the command).

mod answer;
mod change;
mod records;
mod search;
mod write;

use std::path::Path;
use std::sync::atomic::AtomicBool;

use d3dgen_model::Document;
use d3dgen_model::knowledge::{KnowledgeBase, Metadata};
use d3dgen_store::{Access, KeyRange, Options, Store};

use crate::error::Error;
use records::{CHANGES, DOMAINS, DomainRecord, EDITS, REFERENCES, Stored, each, get};

pub use answer::Answer;
pub use change::{Change, Edit, Entry, FieldChange, Kind, Provenance, Target, apply, difference};
pub use search::{Found, SearchQuery, Searcher, filter_names};
pub use write::digest;

/// An open database. Clones share it.
#[derive(Clone)]
pub struct Database {
    store: Store,
}

/// A domain in the database.
#[derive(Debug, Clone, PartialEq)]
pub struct DomainEntry {
    /// Id.
    pub domain: String,
    /// Head of its file.
    pub metadata: Metadata,
    /// Digest of the shipped knowledge base it began as; none when it came from elsewhere.
    pub shipped: Option<String>,
    /// Number of changes in force beside the shipped text.
    pub changes: u64,
}

/// One thing wrong in the database, and where.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Damage {
    /// Table and key, or domain and path in its document.
    pub place: String,
    /// What is wrong.
    pub reason: String,
}

impl Database {
    /// Opens the database in a folder.
    ///
    /// # Errors
    /// `Store`: there is none, another process writes it, it is damaged or of a later release.
    pub fn open(dir: &Path, access: Access, options: &Options) -> Result<Self, Error> {
        Ok(Self { store: Store::open(dir, access, options)? })
    }

    /// Opens the database in a folder for changes; makes one when the folder is missing or empty.
    ///
    /// # Errors
    /// As [`Database::open`].
    pub fn open_or_create(dir: &Path, options: &Options) -> Result<Self, Error> {
        Ok(Self { store: Store::open_or_create(dir, options)? })
    }

    /// Returns the database of rules in a store that is open, which may hold others too.
    pub fn of_store(store: Store) -> Self {
        Self { store }
    }

    /// Returns the store below, for snapshots.
    pub fn store(&self) -> &Store {
        &self.store
    }

    /// Returns the domains, by id.
    ///
    /// # Errors
    /// `Store` when a record is damaged.
    pub fn domains(&self) -> Result<Vec<DomainEntry>, Error> {
        let mut found = Vec::new();
        each(&self.store.view()?, DOMAINS, &KeyRange::all(), |domain, record: DomainRecord| {
            let DomainRecord { metadata, shipped, changes, .. } = record;
            found.push(DomainEntry { domain: domain.to_owned(), metadata, shipped, changes });
            Ok(())
        })?;
        Ok(found)
    }

    /// Returns the knowledge base of a domain with every change in force, as it is exported.
    ///
    /// # Errors
    /// `NoDomain`; `Store` when a record is damaged: a knowledge base is served whole or not at all.
    pub fn knowledge_base(&self, domain: &str) -> Result<KnowledgeBase, Error> {
        match Stored::read(&self.store.view()?, domain)? {
            Some(stored) => Ok(stored.assemble()),
            None => Err(self.no_domain(domain)),
        }
    }

    /// Returns the changes, oldest first.
    ///
    /// # Errors
    /// `Store` when a record is damaged.
    pub fn history(&self) -> Result<Vec<Change>, Error> {
        let mut found = Vec::new();
        each(&self.store.view()?, CHANGES, &KeyRange::all(), |_, change| {
            found.push(change);
            Ok(())
        })?;
        Ok(found)
    }

    /// Returns what a change did, entry by entry.
    ///
    /// # Errors
    /// `NoChange`; `Store`.
    pub fn edits(&self, seq: u64) -> Result<Vec<Edit>, Error> {
        let view = self.store.view()?;
        if get::<Change>(&view, CHANGES, &write::seq_key(seq))?.is_none() {
            return Err(Error::NoChange { seq });
        }
        let mut found = Vec::new();
        each(&view, EDITS, &KeyRange::prefix(format!("{}/", write::seq_key(seq))), |_, page: Vec<Edit>| {
            found.extend(page);
            Ok(())
        })?;
        Ok(found)
    }

    /// Looks at every record and every document: damaged records, rules without a document, broken knowledge bases.
    ///
    /// `observe` hears how many of how many records are done.
    ///
    /// # Errors
    /// `Store`: cancelled, or not readable at all.
    pub fn verify(&self, observe: &mut dyn FnMut(u64, u64), cancelled: &AtomicBool) -> Result<Vec<Damage>, Error> {
        let problems = self.store.verify(&mut |p| observe(p.done, p.total), cancelled)?;
        let mut damage: Vec<Damage> = problems
            .into_iter()
            .map(|p| Damage { place: format!("{} {}", p.table, p.key.unwrap_or_default()), reason: p.reason })
            .collect();
        if !damage.is_empty() {
            return Ok(damage); // documents with holes would only repeat it
        }
        for entry in self.domains()? {
            let view = self.store.view()?;
            let Some(stored) = Stored::read(&view, &entry.domain)? else { continue };
            for orphan in stored.constraints.values().filter(|c| !stored.references.contains_key(&c.ref_id)) {
                let place = format!("constraint {}/{}", entry.domain, orphan.constraint.constraint_id);
                damage.push(Damage { place, reason: format!("its document {} is not there", orphan.ref_id) });
            }
            let problems = stored.assemble().check();
            damage.extend(
                problems
                    .into_iter()
                    .map(|p| Damage { place: format!("domain {} {}", entry.domain, p.path), reason: p.message }),
            );
        }
        Ok(damage)
    }

    /// Returns how many rules and documents there are in all.
    ///
    /// # Errors
    /// `Store`.
    pub fn counts(&self) -> Result<(u64, u64), Error> {
        Ok((self.store.count(records::CONSTRAINTS)?, self.store.count(REFERENCES)?))
    }

    fn no_domain(&self, domain: &str) -> Error {
        let known = self.domains().map(|all| all.into_iter().map(|d| d.domain).collect());
        Error::NoDomain { domain: domain.into(), known: known.unwrap_or_default() }
    }
}

#[cfg(test)]
mod tests;
