//! The database of assets: what was ingested, made or changed, beside the library that needs no database.
//!
//! Records and the files of the models are kept in one folder: a model's file is whole before its record names it, and
//! goes after its record went. What is removed from the shipped library is remembered as removed.

mod files;
mod records;
mod shelf;
mod write;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use d3dgen_mesh::Model3d;
use d3dgen_model::Document;
use d3dgen_store::{Access, KeyRange, Options, Store};
use serde::{Deserialize, Serialize};

use crate::annotation::Annotation;
use crate::error::Error;
use crate::placed::placed;
use records::{ASSETS, AssetRecord, CHANGES, PATHS, REMOVED, RemovedRecord, each, get};

pub use records::{Change, IngestedFile, Kind, Provenance};
pub use shelf::{Searcher, Shelf};
pub use write::NewAsset;

/// An open database. Clones share it.
#[derive(Debug, Clone)]
pub struct Database {
    store: Store,
    /// Held by whoever makes a change: its number is the count of those before it.
    changing: Arc<Mutex<()>>,
}

/// Something wrong in the database, and where.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Damage {
    /// Table and key, or file.
    pub place: String,
    /// What is wrong.
    pub reason: String,
}

/// What the database holds, in figures.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stats {
    /// Assets kept.
    pub assets: u64,
    /// Files that were ingested, copies included.
    pub paths: u64,
    /// Objects of the shipped library that are removed.
    pub removed: u64,
    /// Changes so far.
    pub changes: u64,
    /// Models kept, bytes.
    pub model_bytes: u64,
}

impl Database {
    /// Opens the database in a folder.
    ///
    /// # Errors
    /// `Store`: there is none, another process writes it, it is damaged or of a later release.
    pub fn open(dir: &Path, access: Access, options: &Options) -> Result<Self, Error> {
        Ok(Self::of_store(Store::open(dir, access, options)?))
    }

    /// Opens the database in a folder for changes; makes one when the folder is missing or empty.
    ///
    /// # Errors
    /// As [`Database::open`].
    pub fn open_or_create(dir: &Path, options: &Options) -> Result<Self, Error> {
        Ok(Self::of_store(Store::open_or_create(dir, options)?))
    }

    /// Returns the database of assets in a store that is open, which may hold others too.
    pub fn of_store(store: Store) -> Self {
        Self { store, changing: Arc::default() }
    }

    /// Returns the store below.
    pub fn store(&self) -> &Store {
        &self.store
    }

    /// Returns what is known of an asset that is kept here.
    ///
    /// # Errors
    /// `Store` when its record is damaged.
    pub fn get(&self, asset_id: &str) -> Result<Option<Annotation>, Error> {
        Ok(get::<AssetRecord>(&self.store.view()?, ASSETS, asset_id)?.map(|r| r.annotation))
    }

    /// Returns how many assets are kept here.
    ///
    /// # Errors
    /// `Store`.
    pub fn count(&self) -> Result<usize, Error> {
        Ok(usize::try_from(self.store.count(ASSETS)?).unwrap_or(usize::MAX))
    }

    /// Returns the ids of all assets kept here, sorted.
    ///
    /// # Errors
    /// `Store`.
    pub fn ids(&self) -> Result<Vec<String>, Error> {
        let mut ids = Vec::new();
        each(&self.store.view()?, ASSETS, |id, _: serde::de::IgnoredAny| {
            ids.push(id.to_owned());
            Ok(())
        })?;
        Ok(ids)
    }

    /// Calls `visit` with all assets kept here, by id.
    ///
    /// # Errors
    /// `Store`; those of `visit`.
    pub fn each(&self, mut visit: impl FnMut(Annotation) -> Result<(), Error>) -> Result<(), Error> {
        each(&self.store.view()?, ASSETS, |_, record: AssetRecord| visit(record.annotation))
    }

    /// Returns the model of an asset kept here, in its own frame; none for such as have no file.
    ///
    /// # Errors
    /// `Store`; `File` when the file is missing or damaged.
    pub fn model(&self, asset_id: &str) -> Result<Option<Model3d>, Error> {
        let record = get::<AssetRecord>(&self.store.view()?, ASSETS, asset_id)?;
        record.and_then(|r| r.model).map(|hash| files::read(&self.files_dir(), &hash)).transpose()
    }

    /// Returns the model of an asset kept here as worlds place it, with what is known of it; none for such as have no file.
    ///
    /// # Errors
    /// As [`Self::model`].
    pub fn placed_model(&self, asset_id: &str) -> Result<Option<(Model3d, Annotation)>, Error> {
        let Some(annotation) = self.get(asset_id)? else { return Ok(None) };
        let Some(model) = self.model(asset_id)? else { return Ok(None) };
        Ok(Some((placed(model, &annotation), annotation)))
    }

    /// Returns the thumbnail of an asset kept here, PNG; none for such as have no model.
    ///
    /// # Errors
    /// `Store`; `File` when it cannot be read.
    pub fn thumbnail(&self, asset_id: &str) -> Result<Option<Vec<u8>>, Error> {
        let record = get::<AssetRecord>(&self.store.view()?, ASSETS, asset_id)?;
        let hash = record.and_then(|r| r.model);
        Ok(hash.map(|hash| files::picture(&self.files_dir(), &hash)).transpose()?.flatten())
    }

    /// Returns the objects of the library that are removed, with the change that did it.
    ///
    /// # Errors
    /// `Store`.
    pub fn removed(&self) -> Result<BTreeMap<String, u64>, Error> {
        let mut found = BTreeMap::new();
        each(&self.store.view()?, REMOVED, |object, record: RemovedRecord| {
            found.insert(object.to_owned(), record.change);
            Ok(())
        })?;
        Ok(found)
    }

    /// Returns what was ingested from a path before: digest and asset.
    ///
    /// # Errors
    /// `Store`.
    pub fn ingested(&self, path: &str) -> Result<Option<IngestedFile>, Error> {
        Ok(get(&self.store.view()?, PATHS, path)?)
    }

    /// Returns true when no asset is kept and none of the library removed.
    ///
    /// # Errors
    /// `Store`.
    pub fn is_empty(&self) -> Result<bool, Error> {
        Ok(self.store.count(ASSETS)? == 0 && self.store.count(REMOVED)? == 0)
    }

    /// Returns the changes, oldest first.
    ///
    /// # Errors
    /// `Store`.
    pub fn history(&self) -> Result<Vec<Change>, Error> {
        let mut found = Vec::new();
        each(&self.store.view()?, CHANGES, |_, change| {
            found.push(change);
            Ok(())
        })?;
        Ok(found)
    }

    /// Returns the database in figures.
    ///
    /// # Errors
    /// `Store`; `File`.
    pub fn stats(&self) -> Result<Stats, Error> {
        Ok(Stats {
            assets: self.store.count(ASSETS)?,
            paths: self.store.count(PATHS)?,
            removed: self.store.count(REMOVED)?,
            changes: self.store.count(CHANGES)?,
            model_bytes: files::list(&self.files_dir())?.iter().map(|(_, bytes)| bytes).sum(),
        })
    }

    /// Looks at every record, every annotation and every file.
    ///
    /// # Errors
    /// `Store`: cancelled, or not readable at all.
    pub fn verify(&self, observe: &mut dyn FnMut(u64, u64), cancelled: &AtomicBool) -> Result<Vec<Damage>, Error> {
        let problems = self.store.verify(&mut |p| observe(p.done, p.total), cancelled)?;
        let place = |p: &d3dgen_store::Problem| format!("{} {}", p.table, p.key.clone().unwrap_or_default());
        let mut damage: Vec<Damage> =
            problems.iter().map(|p| Damage { place: place(p), reason: p.reason.clone() }).collect();
        if !damage.is_empty() {
            return Ok(damage);
        }
        let mut wanted = std::collections::BTreeSet::new();
        let mut records: Vec<(String, AssetRecord)> = Vec::new();
        each(&self.store.view()?, ASSETS, |id, record| {
            records.push((id.to_owned(), record));
            Ok(())
        })?;
        for (id, record) in records {
            if cancelled.load(Ordering::SeqCst) {
                return Err(d3dgen_store::Error::Cancelled.into());
            }
            let problems = record.annotation.check();
            damage.extend(
                problems.into_iter().map(|p| Damage { place: format!("asset {id} {}", p.path), reason: p.message }),
            );
            if let Some(hash) = record.model {
                if let Err(error) = files::read(&self.files_dir(), &hash) {
                    damage.push(Damage { place: format!("asset {id}"), reason: error.to_string() });
                }
                let picture = files::picture(&self.files_dir(), &hash)?.map(|png| files::digest(&png));
                if picture.as_ref() != record.annotation.thumbnail.as_ref().map(|t| &t.sha256) {
                    let reason =
                        "its thumbnail is not the one that was drawn; remove the asset and ingest its file again"
                            .into();
                    damage.push(Damage { place: format!("asset {id}"), reason });
                }
                wanted.insert(hash);
            }
        }
        for (hash, _) in files::list(&self.files_dir())?.into_iter().filter(|(hash, _)| !wanted.contains(hash)) {
            damage.push(Damage { place: format!("file {hash}"), reason: "no asset names it".into() });
        }
        Ok(damage)
    }

    /// Waits until no other thread makes a change.
    fn changing(&self) -> MutexGuard<'_, ()> {
        self.changing.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn files_dir(&self) -> PathBuf {
        self.store.dir().join("models")
    }

    /// Returns the keys of a table that begin with a text.
    fn with_prefix(&self, table: &str, prefix: &str) -> Result<Vec<String>, Error> {
        let mut keys = Vec::new();
        self.store.view()?.scan(table, &KeyRange::prefix(prefix), |key, _| {
            keys.push(key.to_owned());
            Ok::<_, Error>(std::ops::ControlFlow::Continue(()))
        })?;
        Ok(keys)
    }
}

#[cfg(test)]
mod tests;
