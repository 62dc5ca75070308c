//! The parts of an index and their files: made of documents, written to a folder, read back from it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use super::columns::Columns;
use super::document::{Document, IndexSpec, Phase, Watch};
use super::graph::Graph;
use super::lifecycle::Wanted;
use super::manifest::Sum;
use super::text::TextIndex;
use super::vectors::Vectors;
use crate::embed::Embedder;
use crate::error::{Error, Result};
use crate::files::sync_folder;

const COLUMNS: &str = "columns.postcard";
const VECTORS: &str = "vectors.f32";
const TEXT: &str = "text";
const GRAPH: &str = "graph";

/// Documents embedded at a time.
const EMBED_BATCH: usize = 256;

/// All that answers a search.
#[derive(Debug)]
pub(crate) struct Parts {
    pub(crate) columns: Columns,
    pub(crate) text: TextIndex,
    pub(crate) vectors: Vectors,
    graph: LazyGraph,
}

/// A graph is read when it is first asked: most questions are filtered and never need it.
#[derive(Debug)]
struct LazyGraph {
    files: Option<(PathBuf, BTreeMap<String, Sum>)>,
    graph: OnceLock<Option<Graph>>,
}

impl Parts {
    /// Makes the parts of documents that are sorted by key.
    pub(super) fn new(wanted: &Wanted<'_>, documents: &[Document], watch: Watch<'_>) -> Result<Self> {
        let (spec, embedder) = (wanted.spec, wanted.embedder.as_ref());
        // Words and vectors are made side by side; neither sees the other, so the result is the same.
        let (text, vectors) = std::thread::scope(|scope| {
            let text = scope.spawn(|| TextIndex::new(spec, documents, watch));
            let vectors = embed(embedder, documents, watch);
            let text = text.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            (text, vectors)
        });
        let (text, vectors, columns) = (text?, vectors?, Columns::new(spec, documents));
        let rows = columns.rows();
        let graph = if rows >= wanted.graph_from { Some(Graph::new(&vectors, rows, watch)?) } else { None };
        Ok(Self { columns, text, vectors, graph: LazyGraph { files: None, graph: OnceLock::from(graph) } })
    }

    /// Returns the graph of neighbors, if the index is large enough to have one and its files are still whole.
    pub(crate) fn graph(&self) -> Option<&Graph> {
        let load = || {
            let (dir, sums) = self.graph.files.as_ref()?;
            let whole = sums.iter().all(|(name, sum)| read_checked(dir, name, sum).is_ok());
            if whole { Graph::read(&dir.join(GRAPH)).ok() } else { None }
        };
        self.graph.graph.get_or_init(load).as_ref()
    }

    /// Writes all files into an empty folder and makes them durable; returns their names and checksums.
    pub(crate) fn write(&self, dir: &Path, watch: Watch<'_>) -> Result<BTreeMap<String, Sum>> {
        watch.step(Phase::Writing, 0, 0)?;
        let columns = postcard::to_stdvec(&self.columns).map_err(|e| corrupt(&dir.join(COLUMNS), &e))?;
        for (name, content) in [(COLUMNS, columns), (VECTORS, self.vectors.bytes())] {
            let path = dir.join(name);
            std::fs::write(&path, content).map_err(Error::io(&path))?;
        }
        let text = dir.join(TEXT);
        std::fs::create_dir(&text).map_err(Error::io(&text))?;
        self.text.write(&text)?;
        if let Some(graph) = self.graph() {
            let path = dir.join(GRAPH);
            std::fs::create_dir(&path).map_err(Error::io(&path))?;
            graph.write(&path)?;
        }
        let mut sums = BTreeMap::new();
        for (name, path) in files_below(dir)? {
            watch.step(Phase::Writing, sums.len(), 0)?;
            let content = std::fs::read(&path).map_err(Error::io(&path))?;
            std::fs::File::open(&path).and_then(|f| f.sync_all()).map_err(Error::io(&path))?;
            sums.insert(name, Sum::of(&content));
        }
        sync_folder(&text)?;
        sync_folder(dir)?;
        Ok(sums)
    }

    /// Reads the files of an index, each compared with its checksum.
    ///
    /// # Errors
    /// [`Error::Corrupt`] or [`Error::Io`] with the file that is not as it was written.
    pub(crate) fn read(spec: &IndexSpec, dim: usize, dir: &Path, sums: &BTreeMap<String, Sum>) -> Result<Self> {
        let mut contents = BTreeMap::new();
        for (name, sum) in sums {
            let content = read_checked(dir, name, sum)?;
            if !name.starts_with(GRAPH) {
                contents.insert(name.as_str(), content);
            }
        }
        let take = |name: &str| contents.get(name).ok_or_else(|| corrupt(&dir.join(name), &"not in the manifest"));
        let columns: Columns = postcard::from_bytes(take(COLUMNS)?).map_err(|e| corrupt(&dir.join(COLUMNS), &e))?;
        let vectors = Vectors::from_bytes(dim, columns.rows(), take(VECTORS)?, &dir.join(VECTORS))?;
        let texts = contents.iter().filter_map(|(name, content)| {
            let name = name.strip_prefix(TEXT)?.strip_prefix('/')?;
            Some((name, content.as_slice()))
        });
        let text = TextIndex::read(spec, texts)?;
        if text.rows() != u64::from(columns.rows()) {
            return Err(corrupt(dir, &format!("{} texts of {} documents", text.rows(), columns.rows())));
        }
        let graph_sums: BTreeMap<String, Sum> =
            sums.iter().filter(|(name, _)| name.starts_with(GRAPH)).map(|(n, s)| (n.clone(), s.clone())).collect();
        let files = (!graph_sums.is_empty()).then(|| (dir.to_path_buf(), graph_sums));
        Ok(Self { columns, text, vectors, graph: LazyGraph { files, graph: OnceLock::new() } })
    }
}

fn embed(embedder: &dyn Embedder, documents: &[Document], watch: Watch<'_>) -> Result<Vectors> {
    let dim = embedder.dim();
    let mut full = Vec::with_capacity(documents.len() * dim);
    for (batch, documents_left) in documents.chunks(EMBED_BATCH).enumerate() {
        watch.step(Phase::Meaning, batch * EMBED_BATCH, documents.len())?;
        let texts: Vec<&str> = documents_left.iter().map(|d| d.embed_text.as_str()).collect();
        let vectors = embedder.embed(&texts)?;
        let fits = vectors.len() == texts.len() && vectors.iter().all(|v| v.len() == dim);
        if !fits {
            let what = format!("{} vectors for {} texts, or of another length than {dim}", vectors.len(), texts.len());
            return Err(Error::Embedder { id: embedder.id().to_owned(), what });
        }
        for (text, vector) in texts.iter().zip(vectors) {
            // A transformer has a vector for the empty text too, near to anything.
            let kept = !text.trim().is_empty();
            full.extend(vector.into_iter().map(|x| if kept { x } else { 0.0 }));
        }
    }
    Ok(Vectors::new(dim, full))
}

fn read_checked(dir: &Path, name: &str, sum: &Sum) -> Result<Vec<u8>> {
    let path = dir.join(name);
    let content = std::fs::read(&path).map_err(Error::io(&path))?;
    if Sum::of(&content) == *sum { Ok(content) } else { Err(corrupt(&path, &"its checksum differs")) }
}

fn files_below(dir: &Path) -> Result<Vec<(String, PathBuf)>> {
    let mut files = Vec::new();
    let mut folders = vec![(String::new(), dir.to_path_buf())];
    while let Some((prefix, folder)) = folders.pop() {
        for entry in std::fs::read_dir(&folder).map_err(Error::io(&folder))? {
            let path = entry.map_err(Error::io(&folder))?.path();
            let Some(name) = path.file_name().and_then(|n| n.to_str()) else { continue };
            if path.is_dir() {
                folders.push((format!("{prefix}{name}/"), path));
            } else if !name.ends_with(".lock") {
                files.push((format!("{prefix}{name}"), path));
            }
        }
    }
    files.sort();
    Ok(files)
}

fn corrupt(path: &Path, reason: &dyn std::fmt::Display) -> Error {
    Error::Corrupt { path: path.to_path_buf(), reason: reason.to_string() }
}
