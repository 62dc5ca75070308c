//! The databases of a server: its own records, rules and assets, and the indexes over the last two.
//!
//! Rules and assets lie in one store, as the command keeps them, so that a server can take over a command's database.
//! Indexes are opened, or made anew, beside the answers to other calls; searches wait for them.

use std::path::Path;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

use d3dgen_assets::catalog::Catalog;
use d3dgen_assets::database::Shelf;
use d3dgen_assets::search::{AssetIndex, Found, SearchQuery};
use d3dgen_knowledge::database::{Change, Searcher};
use d3dgen_store::embed::Embedder;
use d3dgen_store::index::{Progress, Watch};
use d3dgen_store::{Options, Store};
use tonic::Status;

use crate::error::Error;
use crate::status;

/// Longest wait of a search for an index that is being made.
const WAIT: Duration = Duration::from_secs(8);
/// Memory for pages of each store, bytes.
const CACHE: u64 = 16 << 20;

/// The databases.
pub struct Databases {
    /// The server's own records.
    pub own: Store,
    /// Rules.
    pub rules: d3dgen_knowledge::database::Database,
    /// Assets.
    pub assets: d3dgen_assets::database::Database,
    embedder: Arc<dyn Embedder>,
    rules_index: Slot<Searcher>,
    asset_index: Slot<AssetSearch>,
}

/// An index of assets with the catalog it was made of.
pub struct AssetSearch {
    catalog: Arc<Catalog>,
    index: AssetIndex,
    /// How far the store was when the index was begun: it holds that and perhaps more.
    revision: u64,
}

/// What is there after a while, and is replaced now and then.
struct Slot<T> {
    value: Mutex<Option<Arc<T>>>,
    filled: Condvar,
}

impl<T> Slot<T> {
    fn empty() -> Self {
        Self { value: Mutex::new(None), filled: Condvar::new() }
    }

    /// Puts a value in its place, unless what is there is of a later revision: what was begun beside a change may not know it.
    fn fill(&self, revision: fn(&T) -> u64, value: T) {
        let mut there = self.value.lock().unwrap_or_else(PoisonError::into_inner);
        if there.as_ref().is_none_or(|now| revision(now) <= revision(&value)) {
            *there = Some(Arc::new(value));
            self.filled.notify_all();
        }
    }

    fn get(&self) -> Option<Arc<T>> {
        self.value.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn is_filled(&self) -> bool {
        self.get().is_some()
    }

    fn wait(&self) -> Result<Arc<T>, Status> {
        let guard = self.value.lock().unwrap_or_else(PoisonError::into_inner);
        let waited = self.filled.wait_timeout_while(guard, WAIT, |v| v.is_none());
        let (guard, _) = waited.unwrap_or_else(PoisonError::into_inner);
        guard.clone().ok_or_else(|| Status::unavailable("the index is being made; try again in some seconds"))
    }
}

impl Databases {
    /// Opens the databases below a folder, made where they are missing.
    ///
    /// # Errors
    /// `Store`: another process has them open, or they are damaged; `File`.
    pub fn open(dir: &Path, embedder: Arc<dyn Embedder>) -> Result<Self, Error> {
        std::fs::create_dir_all(dir).map_err(|source| Error::File { path: dir.to_path_buf(), source })?;
        let options = Options { cache_bytes: CACHE, ..Options::default() };
        let own = Store::open_or_create(dir.join("server"), &options)?;
        let shared = Store::open_or_create(dir.join("knowledge"), &options)?;
        Ok(Self {
            own,
            rules: d3dgen_knowledge::database::Database::of_store(shared.clone()),
            assets: d3dgen_assets::database::Database::of_store(shared),
            embedder,
            rules_index: Slot::empty(),
            asset_index: Slot::empty(),
        })
    }

    /// Returns an error while nothing can be stored; what a full disk has broken is mended first, when there is room.
    ///
    /// # Errors
    /// `Store`.
    pub fn check_writable(&self) -> Result<(), Error> {
        self.own.check_writable()?;
        Ok(self.shared().check_writable()?)
    }

    /// Returns true once searches are answered.
    pub fn is_indexed(&self) -> bool {
        self.rules_index.is_filled() && self.asset_index.is_filled()
    }

    /// Returns the store of rules and assets.
    pub fn shared(&self) -> &Store {
        self.rules.store()
    }

    /// Opens the index of rules anew, so that searches find what was changed.
    ///
    /// # Errors
    /// `Knowledge`.
    pub fn index_rules(&self) -> Result<(), Error> {
        let searcher = Searcher::open(&self.rules, Arc::clone(&self.embedder), watch("rules"))?;
        if let Some(reason) = &searcher.rebuilt {
            tracing::info!(what = "rules", %reason, "index made anew");
        }
        for damage in &searcher.damaged {
            tracing::error!(place = damage.place, reason = damage.reason, "damaged record left out of the index");
        }
        self.rules_index.fill(Searcher::revision, searcher);
        Ok(())
    }

    /// Has searches find what a change of rules was about, without making the index anew where little has changed.
    ///
    /// # Errors
    /// `Knowledge`.
    pub fn index_change(&self, change: &Change) -> Result<(), Error> {
        let Some(now) = self.rules_index.get() else { return self.index_rules() };
        match now.after(&change.domain, &self.rules.edits(change.seq)?)? {
            Some(searcher) => self.rules_index.fill(Searcher::revision, searcher),
            None => self.index_rules()?,
        }
        Ok(())
    }

    /// Opens the index of assets anew, for the objects of a catalog.
    ///
    /// # Errors
    /// `Assets`.
    pub fn index_assets(&self, catalog: &Arc<Catalog>) -> Result<(), Error> {
        let revision = self.shared().revision()?;
        let shelf = Shelf::new(Some(self.assets.clone()), catalog)?;
        let index = shelf.open_index(Arc::clone(&self.embedder), watch("assets"))?;
        if let Some(reason) = &index.rebuilt {
            tracing::info!(what = "assets", %reason, "index made anew");
        }
        self.fill_asset_index(catalog, index, revision);
        Ok(())
    }

    fn fill_asset_index(&self, catalog: &Arc<Catalog>, index: AssetIndex, revision: u64) {
        let search = AssetSearch { catalog: Arc::clone(catalog), index, revision };
        self.asset_index.fill(|search| search.revision, search);
    }

    /// Has searches find what a change of assets was about, without making the index anew where little has changed: kept
    /// assets by their ids, objects of the library by theirs. The catalog is that of the index.
    ///
    /// # Errors
    /// `Assets`.
    pub fn index_changed_assets(&self, catalog: &Arc<Catalog>, changed: &[String]) -> Result<(), Error> {
        let Some(now) = self.asset_index.get() else { return self.index_assets(catalog) };
        let revision = self.shared().revision()?;
        let shelf = Shelf::new(Some(self.assets.clone()), catalog)?;
        match shelf.changed_index(&now.index, changed)? {
            Some(index) => self.fill_asset_index(catalog, index, revision),
            None => self.index_assets(catalog)?,
        }
        Ok(())
    }

    /// Returns the index of rules; waits for the first.
    ///
    /// # Errors
    /// `UNAVAILABLE` when it takes long.
    pub fn searcher(&self) -> Result<Arc<Searcher>, Status> {
        self.rules_index.wait()
    }

    /// Returns the assets that fit best, best first; waits for the first index.
    ///
    /// # Errors
    /// `UNAVAILABLE` when the index takes long; `INVALID_ARGUMENT` for a filter that is none.
    pub fn search_assets(&self, query: &SearchQuery) -> Result<Vec<Found>, Status> {
        let search = self.asset_index.wait()?;
        let shelf = Shelf::new(Some(self.assets.clone()), &search.catalog).map_err(status::assets)?;
        search.index.search(query, &search.catalog, &shelf).map_err(status::assets)
    }

    /// Returns how many assets there are, and the values of facets with how many assets have each.
    ///
    /// # Errors
    /// `UNAVAILABLE` when the index takes long.
    #[allow(clippy::type_complexity)]
    pub fn asset_values(
        &self,
        facets: &[&'static str],
    ) -> Result<(u64, Vec<(&'static str, std::collections::BTreeMap<String, usize>)>), Status> {
        let search = self.asset_index.wait()?;
        let values = facets.iter().map(|f| (*f, search.index.values(f))).collect();
        Ok((search.index.len() as u64, values))
    }

    /// Returns the assets most like one.
    ///
    /// # Errors
    /// As [`Databases::search_assets`]; `NOT_FOUND`.
    pub fn like(&self, asset_id: &str, query: &SearchQuery) -> Result<Vec<Found>, Status> {
        let search = self.asset_index.wait()?;
        let shelf = Shelf::new(Some(self.assets.clone()), &search.catalog).map_err(status::assets)?;
        let one = shelf.get(asset_id).map_err(status::assets)?;
        search.index.like(&one, query, &search.catalog, &shelf).map_err(status::assets)
    }
}

fn watch(what: &'static str) -> Watch<'static> {
    fn say(what: &str, p: Progress) {
        tracing::debug!(what, done = p.done, total = p.total, "indexing");
    }
    let progress: &'static (dyn Fn(Progress) + Sync) = match what {
        "rules" => &|p| say("rules", p),
        _ => &|p| say("assets", p),
    };
    Watch { progress, cancel: &|| false }
}

#[cfg(test)]
mod tests {
    use super::Slot;

    #[test]
    fn what_was_begun_before_a_change_does_not_replace_what_knows_it() {
        let slot: Slot<(u64, &str)> = Slot::empty();
        for index in [(7, "with the change"), (6, "begun before it"), (7, "again")] {
            slot.fill(|index| index.0, index);
            assert_eq!(slot.get().unwrap().0, 7, "{index:?}");
        }
        assert_eq!(slot.get().unwrap().1, "again");
    }
}
