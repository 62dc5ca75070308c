//! Finding documents by words, by meaning and by filters: an index that is derived from records and can always be made
//! anew from them.
//!
//! It does not hold the records, only their keys, and does not know what they mean: the caller says which texts,
//! facets and numbers a record has. It is never changed in place. Opened with the revision of the records it is either
//! exactly of this revision, or rebuilt.
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

struct Inner {
    parts: Parts,
    embedder: Arc<dyn Embedder>,
    revision: u64,
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
        let index = Self { inner: Arc::new(Inner { parts: found.parts, embedder, revision }) };
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
        Ok(Self { inner: Arc::new(Inner { parts, embedder, revision }) })
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
        let parts = &self.inner.parts;
        let allowed = match filter {
            Filter::Everything => None,
            filter => Some(parts.columns.matching(filter)?),
        };
        let limit = limit.min(parts.columns.rows() as usize);
        if text.trim().is_empty() {
            let allowed = allowed.unwrap_or_else(|| RowSet::all(parts.columns.rows()));
            return Ok(allowed.iter().take(limit).filter_map(|row| self.hit(row)).collect());
        }
        let depth = if mode == Mode::Hybrid && limit > 0 { limit.max(FUSED_DEPTH) } else { limit };
        let by_text = match mode {
            Mode::Vector => Vec::new(),
            _ => parts.text.search(text, depth, allowed.as_ref())?,
        };
        let by_vector = match mode {
            Mode::Text => Vec::new(),
            _ => self.nearest(text, depth, allowed.as_ref())?,
        };
        let fused = fuse(&by_text, &by_vector).into_iter().take(limit);
        let hits = fused.filter_map(|fused| {
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
        self.inner.parts.text.has_word(word)
    }

    /// Returns how many documents fulfill a filter.
    ///
    /// # Errors
    /// [`Error::UnknownField`] as [`Index::search`].
    pub fn count(&self, filter: &Filter) -> Result<usize> {
        Ok(self.inner.parts.columns.matching(filter)?.count() as usize)
    }

    /// Returns the values of a facet with how many documents have each; none when there is no such facet.
    #[must_use]
    pub fn facet_counts(&self, facet: &str) -> Option<BTreeMap<String, usize>> {
        self.inner.parts.columns.counts(facet)
    }

    /// Returns how many documents there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.inner.parts.columns.rows() as usize
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

    fn hit(&self, row: u32) -> Option<Hit> {
        let key = self.inner.parts.columns.key(row)?.to_owned();
        Some(Hit { key, score: 0.0, text_rank: None, vector_rank: None, similarity: None })
    }

    fn nearest(&self, text: &str, limit: usize, allowed: Option<&RowSet>) -> Result<Vec<Scored>> {
        let Some(question) = self.inner.embedder.embed(&[text])?.pop() else { return Ok(Vec::new()) };
        if question.iter().all(|x| *x == 0.0) || limit == 0 {
            return Ok(Vec::new());
        }
        let (parts, rows) = (&self.inner.parts, f64::from(self.inner.parts.columns.rows()));
        let wide = allowed.is_none_or(|allowed| f64::from(allowed.count()) >= rows * graph::LEAST_SHARE);
        if wide && let Some(graph) = parts.graph() {
            let near = graph.near(&question, limit, allowed);
            if near.len() >= limit {
                return Ok(parts.vectors.rank(&question, near.into_iter(), limit));
            }
        }
        Ok(parts.vectors.scan(&question, limit, allowed))
    }
}
