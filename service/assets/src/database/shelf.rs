//! All assets as one: those kept in a database, if there is one, and the shipped library without what was removed.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use d3dgen_store::embed::Embedder;
use d3dgen_store::index::{Reason, Take, Watch};
use sha2::{Digest, Sha256};

use super::Database;
use crate::annotation::Annotation;
use crate::catalog::Catalog;
use crate::error::Error;
use crate::library::{Library, LibraryAsset};
use crate::search::{AssetIndex, Assets, Filters, Found, SearchQuery, document};

/// What the index holds of the library, in which form, and by which release.
const LIBRARY_FORM: &str = concat!("of models, ", env!("CARGO_PKG_VERSION"));

/// All assets there are.
#[derive(Debug, Clone)]
pub struct Shelf<'c> {
    database: Option<Database>,
    library: Library<'c>,
    removed: BTreeMap<String, u64>,
}

impl<'c> Shelf<'c> {
    /// Returns the thumbnail that is kept with an asset, PNG; none of the shipped library, which is drawn when asked for.
    ///
    /// # Errors
    /// `Store`; `File` when it cannot be read.
    pub fn thumbnail(&self, asset_id: &str) -> Result<Option<Vec<u8>>, Error> {
        Ok(self.database.as_ref().map(|d| d.thumbnail(asset_id)).transpose()?.flatten())
    }

    /// Puts the library of a catalog beside a database.
    ///
    /// # Errors
    /// `Store`.
    pub fn new(database: Option<Database>, catalog: &'c Catalog) -> Result<Self, Error> {
        let removed = database.as_ref().map(Database::removed).transpose()?.unwrap_or_default();
        Ok(Self { database, library: Library::new(catalog), removed })
    }

    /// Returns the catalog of the library.
    pub fn catalog(&self) -> &'c Catalog {
        self.library.catalog()
    }

    /// Returns the database, if there is one.
    pub fn database(&self) -> Option<&Database> {
        self.database.as_ref()
    }

    /// Returns an asset of the library by its reference, unless it was removed.
    pub fn of_library(&self, asset_id: &str) -> Option<LibraryAsset<'c>> {
        self.library.get(asset_id).filter(|a| !self.removed.contains_key(&a.object.object_id))
    }

    /// Returns true when an object of the library was removed.
    pub fn is_removed(&self, object_id: &str) -> bool {
        self.removed.contains_key(object_id)
    }

    /// Returns what is known of an asset.
    ///
    /// # Errors
    /// `NoAsset` with ids that are spelled alike; `Store`.
    pub fn get(&self, asset_id: &str) -> Result<Annotation, Error> {
        match self.annotation(asset_id)? {
            Some(annotation) => Ok(annotation),
            None => Err(Error::NoAsset { asset_id: asset_id.to_owned(), known: self.alike(asset_id)? }),
        }
    }

    /// Returns a few ids that contain the name asked for, or are named like it.
    fn alike(&self, asset_id: &str) -> Result<Vec<String>, Error> {
        let name = asset_id.rsplit('/').next().unwrap_or_default().to_lowercase();
        let own = self.database.as_ref().map(Database::ids).transpose()?.unwrap_or_default();
        let library = self.library.assets().filter(|a| a.size == 0 && !self.is_removed(&a.object.object_id));
        let all = own.into_iter().chain(library.map(|a| a.asset_id()));
        let close = |id: &String| {
            let other = id.rsplit('/').next().unwrap_or_default().to_lowercase();
            name.len() >= 3 && (other.contains(&name) || name.contains(&other))
        };
        Ok(all.filter(close).take(3).collect())
    }

    /// Gives the entries of all assets to an index, one by one.
    fn documents(&self, take: Take<'_>) -> Result<(), Error> {
        let catalog = self.catalog();
        let shipped: BTreeSet<String> = self.library.assets().map(|a| a.asset_id()).collect();
        let mut own = BTreeSet::new();
        if let Some(database) = &self.database {
            database.each(|a| {
                take(document(&a.asset_id, &a, catalog))?;
                // Only what hides an asset of the library has to be known afterwards.
                if shipped.contains(&a.asset_id) {
                    own.insert(a.asset_id);
                }
                Ok(())
            })?;
        }
        let assets = self.library.assets().filter(|a| !self.is_removed(&a.object.object_id));
        for asset in assets.map(|a| a.annotation(catalog)).filter(|a| !own.contains(&a.asset_id)) {
            take(document(&asset.asset_id, &asset, catalog))?;
        }
        Ok(())
    }

    /// Returns how many assets there are at most: some of the library may be hidden by others of their name.
    fn count(&self) -> Result<usize, Error> {
        let own = self.database.as_ref().map(Database::count).transpose()?.unwrap_or_default();
        Ok(own + self.library.assets().count())
    }

    /// Opens the index of these assets; it is kept beside the database and made anew when it is stale. Without a database
    /// it lives in memory.
    ///
    /// # Errors
    /// `Store`: cancelled, or not readable.
    pub fn open_index(&self, embedder: Arc<dyn Embedder>, watch: Watch<'_>) -> Result<AssetIndex, Error> {
        match &self.database {
            Some(database) => {
                let dir = database.store().index_dir().join("assets");
                let feed = |take: Take<'_>| self.documents(take);
                AssetIndex::open(&dir, embedder, self.revision()?, self.count()?, feed, watch)
            }
            None => {
                let mut documents = Vec::new();
                self.documents(&mut |document| {
                    documents.push(document);
                    Ok(())
                })?;
                AssetIndex::in_memory(embedder, documents, watch)
            }
        }
    }

    /// Returns the index of these assets after some have changed, without making it anew: kept ones by their ids, objects of the
    /// library by theirs. None when too much has changed since it was made.
    ///
    /// # Errors
    /// `Store`.
    pub fn changed_index<'i>(
        &self,
        index: &AssetIndex,
        changed: impl IntoIterator<Item = &'i String>,
    ) -> Result<Option<AssetIndex>, Error> {
        let mut keys = BTreeSet::new();
        for id in changed {
            match self.catalog().object(id) {
                Some(object) => keys.extend(Library::sizes_of(object).map(|asset| asset.asset_id())),
                None => drop(keys.insert(id.clone())),
            }
        }
        let mut changes = Vec::with_capacity(keys.len());
        for key in keys {
            let now = self.annotation(&key)?.map(|a| document(&a.asset_id, &a, self.catalog()));
            changes.push((key, now));
        }
        index.changed(self.revision()?, changes)
    }

    /// Returns a number that changes with the database and with the objects of the domains.
    fn revision(&self) -> Result<u64, Error> {
        let mut hash = Sha256::new();
        // Another release may make other models of the same objects.
        hash.update(LIBRARY_FORM);
        for object in self.catalog().objects() {
            hash.update(format!("{object:?}\n"));
        }
        let store = self.database.as_ref().map(|d| d.store().revision()).transpose()?.unwrap_or_default();
        hash.update(store.to_le_bytes());
        let first: [u8; 8] = hash.finalize()[..8].try_into().unwrap_or_default();
        Ok(u64::from_le_bytes(first))
    }
}

impl Assets for Shelf<'_> {
    fn annotation(&self, key: &str) -> Result<Option<Annotation>, Error> {
        if let Some(database) = &self.database
            && let Some(found) = database.get(key)?
        {
            return Ok(Some(found));
        }
        Ok(self.of_library(key).map(|a| a.annotation(self.catalog())))
    }
}

/// All assets with their index open.
#[derive(Debug)]
pub struct Searcher<'c> {
    shelf: Shelf<'c>,
    index: AssetIndex,
}

impl<'c> Searcher<'c> {
    /// Opens the index, see [`Shelf::open_index`].
    ///
    /// # Errors
    /// As it does.
    pub fn open(shelf: Shelf<'c>, embedder: Arc<dyn Embedder>, watch: Watch<'_>) -> Result<Self, Error> {
        let index = shelf.open_index(embedder, watch)?;
        Ok(Self { shelf, index })
    }

    /// Returns the assets searched in.
    pub fn shelf(&self) -> &Shelf<'c> {
        &self.shelf
    }

    /// Returns why the index was made anew, if it was, and why it could not be kept, if so.
    pub fn news(&self) -> (Option<&Reason>, Option<&str>) {
        (self.index.rebuilt.as_ref(), self.index.unsaved.as_deref())
    }

    /// Returns the assets that fit best, best first.
    ///
    /// # Errors
    /// `Input` for a filter that is none; `Store`.
    pub fn search(&self, query: &SearchQuery) -> Result<Vec<Found>, Error> {
        self.index.search(query, self.shelf.catalog(), &self.shelf)
    }

    /// Returns the assets most like one.
    ///
    /// # Errors
    /// As [`Searcher::search`]; `NoAsset`.
    pub fn like(&self, asset_id: &str, query: &SearchQuery) -> Result<Vec<Found>, Error> {
        let one = self.shelf.get(asset_id)?;
        self.index.like(&one, query, self.shelf.catalog(), &self.shelf)
    }

    /// Returns how many assets fulfill a filter.
    ///
    /// # Errors
    /// `Input` for a filter that is none.
    pub fn count(&self, filters: &Filters) -> Result<usize, Error> {
        self.index.count(filters)
    }

    /// Returns the values of a facet with how many assets have each.
    pub fn values(&self, facet: &str) -> BTreeMap<String, usize> {
        self.index.values(facet)
    }

    /// Returns how many assets there are.
    pub fn len(&self) -> usize {
        self.index.len()
    }

    /// Returns true when there is none.
    pub fn is_empty(&self) -> bool {
        self.index.is_empty()
    }
}
