//! Finding documents by words, by meaning and by filters: an index that is derived from records and can always be made
//! anew from them.
//!
//! It does not hold the records, only their keys, and does not know what they mean: the caller says which texts,
//! facets and numbers a record has. It is never changed in place. Opened with the revision of the records it is either
//! exactly of this revision, or rebuilt. After a change of a few records, [`Index::changed`] gives the index of the new
//! revision at once: the old one with a small one beside it, for as long as both are in memory.
//!
//! # Examples
//! ```
//! use std::sync::Arc;
//! use d3dgen_store::embed::StaticTable;
//! use d3dgen_store::index::{Document, Filter, Index, IndexSpec, Mode, Watch};
//!
//! let folder = tempfile::tempdir().unwrap();
//! let spec = IndexSpec::default().field("name", 2.0).field("text", 1.0).facets(&["country"]);
//! let documents = || Ok::<_, d3dgen_store::Error>([("corridor width", "DE"), ("door height", "AT")].map(|(name, country)| Document {
//!     key: name.replace(' ', "_"),
//!     texts: [("name".to_owned(), name.to_owned())].into(),
//!     facets: [("country".to_owned(), vec![country.to_owned()])].into(),
//!     embed_text: name.to_owned(),
//!     ..Document::default()
//! }));
//! let opened = Index::open_or_rebuild(folder.path(), &spec, Arc::new(StaticTable::new()), 7, documents, Watch::nobody())?;
//! assert!(opened.rebuilt.is_some() && opened.unsaved.is_none());
//! let hits = opened.index.search("width of a hallway", &Filter::facet("country", ["DE"]), 10, Mode::Hybrid)?;
//! assert_eq!(hits[0].key, "corridor_width");
//! # Ok::<(), d3dgen_store::Error>(())
//! ```

mod analyze;
mod columns;
mod document;
mod filter;
mod fuse;
mod gather;
mod graph;
mod guess;
mod lifecycle;
mod manifest;
#[doc(hidden)]
pub mod measuring;
mod parts;
mod row_set;
#[cfg(test)]
mod tests;
mod text;
mod top;
mod vectors;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

pub use document::{Document, Hit, IndexSpec, Mode, Phase, Progress, TextField, Watch};
pub use filter::Filter;
pub use lifecycle::Reason;

use crate::embed::Embedder;
use crate::error::{Error, Result};
use fuse::{Fused, fuse};
use lifecycle::Wanted;
use parts::Parts;
use row_set::RowSet;
use top::Scored;

/// How deep both rankings are looked at before they are fused, at least.
const FUSED_DEPTH: usize = 50;

/// An index that is open for searching. Clones share it; any number of threads may search.
#[derive(Clone)]
pub struct Index {
    inner: Arc<Inner>,
}

/// Takes a document into an index; what it returns ends the giving.
pub type Take<'a> = &'a mut dyn FnMut(Document) -> Result<()>;

/// Documents that an index can have beside those it was made of; with more it is made anew.
const BESIDE: usize = 400;

struct Inner {
    parts: Arc<Parts>,
    changed: Option<Changed>,
    embedder: Arc<dyn Embedder>,
    revision: u64,
}

/// What has changed since the parts of an index were made.
struct Changed {
    /// Rows that are not there any more, or are in another form among the documents.
    gone: RowSet,
    documents: BTreeMap<String, Document>,
    /// Of these documents; their rows follow those of the index.
    parts: Parts,
}

impl std::fmt::Debug for Index {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Index of {} documents at revision {}", self.len(), self.revision())
    }
}

/// An open index, and how it came to be.
#[derive(Debug)]
pub struct Opened {
    /// The index.
    pub index: Index,
    /// Why it was made anew, if it was.
    pub rebuilt: Option<Reason>,
    /// Why it could not be kept in its folder, if so: it then lives in memory and is made anew next time.
    pub unsaved: Option<Error>,
}

impl Index {
    /// Opens the index in `dir` if it is whole, and of this revision, specification and embedder; otherwise makes it
    /// anew of `documents`, which is only called then. Other processes may open or rebuild the same index meanwhile,
    /// and whoever has the old one open keeps it.
    ///
    /// `revision` and `documents` must belong together: read both in one view of the records. The documents may come in
    /// any order. Where `dir` cannot be written, or not within a minute because another process rebuilds it, the index
    /// is made in memory and [`Opened::unsaved`] says why.
    ///
    /// # Errors
    /// What `documents` returns; [`Error::Cancelled`]; [`Error::UnknownField`] when a document has a field that is not
    /// in `spec`; [`Error::Index`] when two have one key; [`Error::Embedder`].
    pub fn open_or_rebuild<D, E>(
        dir: &Path,
        spec: &IndexSpec,
        embedder: Arc<dyn Embedder>,
        revision: u64,
        documents: impl FnOnce() -> Result<D, E>,
        watch: Watch<'_>,
    ) -> Result<Opened, E>
    where
        D: IntoIterator<Item = Document>,
        E: From<Error>,
    {
        let mut documents = Some(documents);
        let feed = |take: Take<'_>| match documents.take() {
            Some(documents) => Ok(documents()?.into_iter().try_for_each(take)?),
            None => Ok(()),
        };
        Self::open_or_rebuild_from(dir, spec, embedder, revision, 0, feed, watch)
    }

    /// As [`Index::open_or_rebuild`], for more documents than should be in memory at once: `feed` gives them to the
    /// index one by one, and ends with the error that this returns. `expected` is how many there will be, for progress;
    /// 0 when that is not known.
    ///
    /// # Errors
    /// As [`Index::open_or_rebuild`]; those of `feed`.
    pub fn open_or_rebuild_from<E: From<Error>>(
        dir: &Path,
        spec: &IndexSpec,
        embedder: Arc<dyn Embedder>,
        revision: u64,
        expected: usize,
        mut feed: impl FnMut(Take<'_>) -> Result<(), E>,
        watch: Watch<'_>,
    ) -> Result<Opened, E> {
        let wanted = Wanted { spec, embedder: &embedder, revision, graph_from: graph::FROM_ROWS };
        let found = lifecycle::open_or_rebuild(dir, &wanted, expected, &mut feed, watch)?;
        let inner = Inner { parts: Arc::new(found.parts), changed: None, embedder, revision };
        let index = Self { inner: Arc::new(inner) };
        Ok(Opened { index, rebuilt: found.rebuilt, unsaved: found.unsaved })
    }

    /// Makes an index that lives in memory only.
    ///
    /// # Errors
    /// As [`Index::open_or_rebuild`].
    pub fn in_memory(
        spec: &IndexSpec,
        embedder: Arc<dyn Embedder>,
        revision: u64,
        documents: impl IntoIterator<Item = Document>,
        watch: Watch<'_>,
    ) -> Result<Self> {
        let wanted = Wanted { spec, embedder: &embedder, revision, graph_from: graph::FROM_ROWS };
        let mut documents = documents.into_iter();
        let expected = documents.size_hint().0;
        let parts = Parts::new(&wanted, expected, &mut |take: Take<'_>| documents.try_for_each(take), watch)?;
        Ok(Self { inner: Arc::new(Inner { parts: Arc::new(parts), changed: None, embedder, revision }) })
    }

    /// Returns the index at a later revision, after some documents have changed: each by its key as it is now, none when it
    /// is not there any more. It takes as long as the changed documents take, and lives in memory. Returns none when too
    /// many have changed since the index was made: it is then to be made anew.
    ///
    /// # Errors
    /// As [`Index::open_or_rebuild`].
    pub fn changed(
        &self,
        spec: &IndexSpec,
        revision: u64,
        changes: impl IntoIterator<Item = (String, Option<Document>)>,
    ) -> Result<Option<Self>> {
        let inner = &*self.inner;
        let (mut gone, mut documents) = match &inner.changed {
            Some(changed) => (changed.gone.clone(), changed.documents.clone()),
            None => (RowSet::none(inner.parts.columns.rows()), BTreeMap::new()),
        };
        for (key, document) in changes {
            if let Some(row) = inner.parts.columns.row(&key) {
                gone.insert(row);
            }
            match document {
                Some(document) => drop(documents.insert(key, document)),
                None => drop(documents.remove(&key)),
            }
        }
        if documents.len() > BESIDE || inner.parts.columns.rows() == 0 {
            return Ok(None);
        }
        let wanted = Wanted { spec, embedder: &inner.embedder, revision, graph_from: graph::FROM_ROWS };
        let mut feed = |take: Take<'_>| documents.values().cloned().try_for_each(take);
        let parts = Parts::new::<Error>(&wanted, documents.len(), &mut feed, Watch::nobody())?;
        let changed = Some(Changed { gone, documents, parts });
        let (parts, embedder) = (Arc::clone(&inner.parts), Arc::clone(&inner.embedder));
        Ok(Some(Self { inner: Arc::new(Inner { parts, changed, embedder, revision }) }))
    }

    /// Returns the `limit` documents that fulfill the filter and fit the text best, best first; equal ones in the order
    /// of keys. An empty text lists all that fulfill the filter, in the order of keys.
    ///
    /// Any text can be asked for: it is words, never syntax. The same index and question give the same answer.
    ///
    /// # Errors
    /// [`Error::UnknownField`] when the filter names a facet or number that the index does not have;
    /// [`Error::Embedder`] when the embedder fails.
    pub fn search(&self, text: &str, filter: &Filter, limit: usize, mode: Mode) -> Result<Vec<Hit>> {
        let (parts, changed) = (&*self.inner.parts, self.inner.changed.as_ref());
        let allowed =
            Allowed { first: self.allowed(filter)?, beside: changed.map(|c| matching(&c.parts, filter)).transpose()? };
        let limit = limit.min(self.len());
        if text.trim().is_empty() {
            return Ok(self.all(&allowed, limit));
        }
        let depth = if mode == Mode::Hybrid && limit > 0 { limit.max(FUSED_DEPTH) } else { limit };
        let by_text = match mode {
            Mode::Vector => Vec::new(),
            _ => {
                let first = parts.text.search(text, depth, allowed.first.as_ref(), None)?;
                let beside = changed.map(|c| c.parts.text.search(text, depth, allowed.of_beside(), Some(&parts.text)));
                self.merged(first, beside.transpose()?, depth)
            }
        };
        let by_vector = match mode {
            Mode::Text => Vec::new(),
            _ => self.nearest(text, depth, &allowed)?,
        };
        let mut fused = fuse(&by_text, &by_vector);
        if changed.is_some() {
            // rows are in the order of keys in each part, but not in both
            fused.sort_by(|a, b| b.score.total_cmp(&a.score).then_with(|| self.key(a.row).cmp(&self.key(b.row))));
        }
        let hits = fused.into_iter().take(limit).filter_map(|fused| {
            let Fused { row, score, text_rank, vector_rank, similarity } = fused;
            Some(Hit { score, text_rank, vector_rank, similarity, ..self.hit(row)? })
        });
        Ok(hits.collect())
    }

    /// Returns whether any document has a word, in any of its forms.
    ///
    /// # Errors
    /// [`Error::Index`] when the full text cannot be read.
    pub fn has_word(&self, word: &str) -> Result<bool> {
        let beside = self.inner.changed.as_ref();
        let beside = beside.map_or(Ok(false), |changed| changed.parts.text.has_word(word))?;
        Ok(beside || self.inner.parts.text.has_word(word)?)
    }

    /// Returns how many documents fulfill a filter.
    ///
    /// # Errors
    /// [`Error::UnknownField`] as [`Index::search`].
    pub fn count(&self, filter: &Filter) -> Result<usize> {
        let first = self.allowed(filter)?.map_or(self.first_len(), |rows| rows.count() as usize);
        let Some(changed) = &self.inner.changed else { return Ok(first) };
        Ok(first + changed.parts.columns.matching(filter)?.count() as usize)
    }

    /// Returns the values of a facet with how many documents have each; none when there is no such facet.
    #[must_use]
    pub fn facet_counts(&self, facet: &str) -> Option<BTreeMap<String, usize>> {
        let changed = self.inner.changed.as_ref();
        let mut counts = self.inner.parts.columns.counts(facet, changed.map(|c| &c.gone))?;
        for (value, count) in changed.and_then(|c| c.parts.columns.counts(facet, None)).unwrap_or_default() {
            *counts.entry(value).or_default() += count;
        }
        Some(counts)
    }

    /// Returns how many documents there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.first_len() + self.inner.changed.as_ref().map_or(0, |c| c.documents.len())
    }

    /// Returns whether there is no document.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the revision of the records that the index was made of.
    #[must_use]
    pub fn revision(&self) -> u64 {
        self.inner.revision
    }

    /// Returns how many documents are as they were when the index was made.
    fn first_len(&self) -> usize {
        let gone = self.inner.changed.as_ref().map_or(0, |c| c.gone.count());
        (self.inner.parts.columns.rows() - gone) as usize
    }

    /// Returns the rows of the first parts that are there and fulfill a filter; none for all.
    fn allowed(&self, filter: &Filter) -> Result<Option<RowSet>> {
        let allowed = matching(&self.inner.parts, filter)?;
        let Some(changed) = &self.inner.changed else { return Ok(allowed) };
        let mut there = changed.gone.clone();
        there.invert();
        if let Some(allowed) = allowed {
            there.intersect(&allowed);
        }
        Ok(Some(there))
    }

    /// Returns the first of all documents that are allowed, in the order of keys.
    fn all(&self, allowed: &Allowed, limit: usize) -> Vec<Hit> {
        let rows = |set: Option<&RowSet>, count: u32| set.cloned().unwrap_or_else(|| RowSet::all(count));
        let first = self.inner.parts.columns.rows();
        let set = rows(allowed.first.as_ref(), first);
        let mut hits: Vec<Hit> = set.iter().take(limit).filter_map(|row| self.hit(row)).collect();
        if let Some(changed) = &self.inner.changed {
            let beside = rows(allowed.of_beside(), changed.parts.columns.rows());
            hits.extend(beside.iter().filter_map(|row| self.hit(first + row)));
            hits.sort_by(|a, b| a.key.cmp(&b.key));
            hits.truncate(limit);
        }
        hits
    }

    /// Returns the best of both parts, best first; equal ones in the order of keys.
    fn merged(&self, mut first: Vec<Scored>, beside: Option<Vec<Scored>>, limit: usize) -> Vec<Scored> {
        let Some(beside) = beside else { return first };
        let offset = self.inner.parts.columns.rows();
        first.extend(beside.into_iter().map(|s| Scored { row: s.row + offset, ..s }));
        first.sort_by(|a, b| b.score.total_cmp(&a.score).then_with(|| self.key(a.row).cmp(&self.key(b.row))));
        first.truncate(limit);
        first
    }

    fn key(&self, row: u32) -> Option<&str> {
        let first = &self.inner.parts.columns;
        match row.checked_sub(first.rows()) {
            None => first.key(row),
            Some(beside) => self.inner.changed.as_ref()?.parts.columns.key(beside),
        }
    }

    fn hit(&self, row: u32) -> Option<Hit> {
        let key = self.key(row)?.to_owned();
        Some(Hit { key, score: 0.0, text_rank: None, vector_rank: None, similarity: None })
    }

    fn nearest(&self, text: &str, limit: usize, allowed: &Allowed) -> Result<Vec<Scored>> {
        let Some(question) = self.inner.embedder.embed(&[text])?.pop() else { return Ok(Vec::new()) };
        if question.iter().all(|x| *x == 0.0) || limit == 0 {
            return Ok(Vec::new());
        }
        let first = self.nearest_of_first(&question, limit, allowed.first.as_ref());
        let changed = self.inner.changed.as_ref();
        let beside = changed.map(|c| c.parts.vectors.scan(&question, limit, allowed.of_beside()));
        Ok(self.merged(first, beside, limit))
    }

    fn nearest_of_first(&self, question: &[f32], limit: usize, allowed: Option<&RowSet>) -> Vec<Scored> {
        let (parts, rows) = (&self.inner.parts, f64::from(self.inner.parts.columns.rows()));
        let wide = allowed.is_none_or(|allowed| f64::from(allowed.count()) >= rows * graph::LEAST_SHARE);
        if wide && let Some(graph) = parts.graph() {
            let near = graph.near(question, limit, allowed);
            if near.len() >= limit {
                return parts.vectors.rank(question, near.into_iter(), limit);
            }
        }
        parts.vectors.scan(question, limit, allowed)
    }
}

/// Which rows may be found: of the first parts, and of those beside them; none for all.
struct Allowed {
    first: Option<RowSet>,
    beside: Option<Option<RowSet>>,
}

impl Allowed {
    fn of_beside(&self) -> Option<&RowSet> {
        self.beside.as_ref()?.as_ref()
    }
}

/// Returns the rows that fulfill a filter; none for all.
fn matching(parts: &Parts, filter: &Filter) -> Result<Option<RowSet>> {
    match filter {
        Filter::Everything => Ok(None),
        filter => parts.columns.matching(filter).map(Some),
    }
}
