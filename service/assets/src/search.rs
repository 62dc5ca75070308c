//! Finding assets by what they are for: words and meaning ranked together, then what the question says of size, place
//! and use.
//!
//! What it is not for: keeping assets (`database`) and putting them into rooms.

mod document;
mod filters;
mod question;
mod rank;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

use d3dgen_store::embed::Embedder;
use d3dgen_store::index::{Document, Filter, Hit, Index, Mode, Opened, Reason, Take, Watch};
use serde::Serialize;

use crate::annotation::Annotation;
use crate::catalog::Catalog;
use crate::error::Error;
pub use document::{FACETS, NUMBERS, document};
pub use filters::{Filters, Range};
pub use question::Question;

/// What to find.
#[derive(Debug, Clone, Default)]
pub struct SearchQuery {
    /// Words in any form; empty lists what the filters leave.
    pub text: String,
    /// What every asset found must be.
    pub filters: Filters,
    /// Room type it is for: assets that belong there come first.
    pub room_type: Option<String>,
    /// Domain it is for: assets of it come first.
    pub domain: Option<String>,
    /// `[width, depth, height]` it should have about, m.
    pub size_m: Option<[f64; 3]>,
    /// How many at most.
    pub limit: usize,
    /// By words, by meaning, or both.
    pub mode: Mode,
    /// Show each object of the library in one size only.
    pub one_per_object: bool,
}

/// An asset that was found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Found {
    /// What is known of it.
    pub annotation: Annotation,
    /// How well it fits; only good for comparing answers to one question.
    pub score: f64,
    /// Why, for people: words that match, meaning, size, room.
    pub reasons: Vec<String>,
}

/// Where annotations come from while searching.
pub trait Assets {
    /// Returns the annotation of a key of the index; none when it is gone.
    ///
    /// # Errors
    /// When it cannot be read.
    fn annotation(&self, key: &str) -> Result<Option<Annotation>, Error>;
}

/// An index of assets that is open.
#[derive(Debug)]
pub struct AssetIndex {
    index: Index,
    /// Why it was made anew, if it was.
    pub rebuilt: Option<Reason>,
    /// Why it could not be kept, if so.
    pub unsaved: Option<String>,
}

/// Candidates looked at for each asset asked for, and at least.
const DEEPER: usize = 4;
const DEPTH_LEAST: usize = 48;

impl AssetIndex {
    /// Makes an index in memory.
    ///
    /// # Errors
    /// `Store`.
    pub fn in_memory(
        embedder: Arc<dyn Embedder>,
        documents: impl IntoIterator<Item = Document>,
        watch: Watch<'_>,
    ) -> Result<Self, Error> {
        let index = Index::in_memory(&document::spec(), embedder, 0, documents, watch)?;
        Ok(Self { index, rebuilt: None, unsaved: None })
    }

    /// Opens the index in a folder if it is of this revision, else makes it anew of the about `expected` documents that
    /// `feed` gives it.
    ///
    /// # Errors
    /// `Store`; those of `feed`.
    pub fn open(
        dir: &Path,
        embedder: Arc<dyn Embedder>,
        revision: u64,
        expected: usize,
        feed: impl FnMut(Take<'_>) -> Result<(), Error>,
        watch: Watch<'_>,
    ) -> Result<Self, Error> {
        let opened = Index::open_or_rebuild_from(dir, &document::spec(), embedder, revision, expected, feed, watch)?;
        let Opened { index, rebuilt, unsaved } = opened;
        Ok(Self { index, rebuilt, unsaved: unsaved.map(|e| e.to_string()) })
    }

    /// Returns the index after some assets have changed, each by its key as it is now; none when too many have changed since it
    /// was made, see [`Index::changed`].
    ///
    /// # Errors
    /// `Store`.
    pub fn changed(
        &self,
        revision: u64,
        changes: impl IntoIterator<Item = (String, Option<Document>)>,
    ) -> Result<Option<Self>, Error> {
        let index = self.index.changed(&document::spec(), revision, changes)?;
        Ok(index.map(|index| Self { index, rebuilt: None, unsaved: None }))
    }

    /// Returns the assets that fit best, best first.
    ///
    /// # Errors
    /// `Input` for a filter that is none; `Store`.
    pub fn search(&self, query: &SearchQuery, catalog: &Catalog, assets: &dyn Assets) -> Result<Vec<Found>, Error> {
        let question = Question::read(&query.text, catalog);
        let mut query = query.clone();
        query.filters.merge(&question.filters);
        let filter = query.filters.to_filter()?;
        if question.words.is_empty() {
            return self.list(&query, &filter, assets);
        }
        let depth = (query.limit * DEEPER).max(DEPTH_LEAST);
        let hits = self.index.search(&question.text, &filter, depth, query.mode)?;
        self.finish(hits, &question, &query, catalog, assets)
    }

    /// Returns the assets most like one.
    ///
    /// # Errors
    /// As [`AssetIndex::search`].
    pub fn like(
        &self,
        one: &Annotation,
        query: &SearchQuery,
        catalog: &Catalog,
        assets: &dyn Assets,
    ) -> Result<Vec<Found>, Error> {
        let text = document::embed_text(one, one.object.as_deref().and_then(|o| catalog.object(o)));
        let question = Question::plain(&text);
        let mut query = SearchQuery { size_m: Some(query.size_m.unwrap_or(one.width_depth_height())), ..query.clone() };
        let filter = query.filters.to_filter()?;
        let depth = (query.limit * DEEPER).max(DEPTH_LEAST);
        let hits = self.index.search(&text, &filter, depth, Mode::Hybrid)?;
        query.limit += 1;
        let mut found = self.finish(hits, &question, &query, catalog, assets)?;
        found.retain(|f| f.annotation.asset_id != one.asset_id);
        found.truncate(query.limit - 1);
        Ok(found)
    }

    /// Returns how many assets fulfill a filter.
    ///
    /// # Errors
    /// `Input` for a filter that is none.
    pub fn count(&self, filters: &Filters) -> Result<usize, Error> {
        Ok(self.index.count(&filters.to_filter()?)?)
    }

    /// Returns the values of a facet with how many assets have each.
    pub fn values(&self, facet: &str) -> BTreeMap<String, usize> {
        self.index.facet_counts(facet).unwrap_or_default()
    }

    /// Returns how many assets there are.
    pub fn len(&self) -> usize {
        self.index.len()
    }

    /// Returns true when there is none.
    pub fn is_empty(&self) -> bool {
        self.index.is_empty()
    }

    /// Lists what a filter leaves, in the order of keys.
    fn list(&self, query: &SearchQuery, filter: &Filter, assets: &dyn Assets) -> Result<Vec<Found>, Error> {
        let hits =
            self.index.search("", filter, if query.one_per_object { usize::MAX } else { query.limit }, Mode::Text)?;
        let (mut found, mut seen) = (Vec::new(), BTreeSet::new());
        for hit in hits {
            if found.len() >= query.limit {
                break;
            }
            let Some(annotation) = assets.annotation(&hit.key)? else { continue };
            if query.one_per_object && !seen.insert(rank::group(&annotation)) {
                continue;
            }
            found.push(Found { annotation, score: 0.0, reasons: Vec::new() });
        }
        Ok(found)
    }

    fn finish(
        &self,
        hits: Vec<Hit>,
        question: &Question,
        query: &SearchQuery,
        catalog: &Catalog,
        assets: &dyn Assets,
    ) -> Result<Vec<Found>, Error> {
        let mut found = Vec::with_capacity(hits.len());
        for hit in hits {
            let Some(annotation) = assets.annotation(&hit.key)? else { continue };
            found.push(rank::judge(annotation, &hit, question, query, catalog));
        }
        found.sort_by(|a, b| {
            b.score.total_cmp(&a.score).then_with(|| a.annotation.asset_id.cmp(&b.annotation.asset_id))
        });
        if query.one_per_object {
            let mut seen = BTreeSet::new();
            found.retain(|f| seen.insert(rank::group(&f.annotation)));
        }
        found.truncate(query.limit);
        Ok(found)
    }
}

#[cfg(test)]
mod tests;
