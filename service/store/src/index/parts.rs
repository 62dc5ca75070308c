//! The parts of an index and their files: made of documents, written to a folder, read back from it.

use std::collections::BTreeMap;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use super::columns::Columns;
use super::document::{IndexSpec, Phase, Watch};
use super::gather::{Feed, Gathered, gather};
use super::graph::Graph;
use super::lifecycle::Wanted;
use super::manifest::Sum;
use super::text::TextIndex;
use super::vectors::Vectors;
use crate::error::{Error, Result};
use crate::files::sync_folder;

const COLUMNS: &str = "columns.postcard";
const VECTORS: &str = "vectors.f32";
const TEXT: &str = "text";
const GRAPH: &str = "graph";

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
    /// Makes the parts of documents.
    ///
    /// # Errors
    /// Those of [`gather`]; [`Error::Index`].
    pub(super) fn new<E: From<Error>>(
        wanted: &Wanted<'_>,
        expected: usize,
        feed: Feed<'_, E>,
        watch: Watch<'_>,
    ) -> Result<Self, E> {
        let gathered = gather(wanted.spec, wanted.embedder.as_ref(), expected, feed, watch)?;
        let Gathered { columns, vectors, texts } = gathered;
        let text = TextIndex::new(wanted.spec, texts, watch)?;
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
        let path = dir.join(COLUMNS);
        std::fs::write(&path, columns).map_err(Error::io(&path))?;
        let path = dir.join(VECTORS);
        let file = std::fs::File::create(&path).map(BufWriter::new);
        file.and_then(|mut file| self.vectors.write(&mut file).and_then(|()| file.flush()))
            .map_err(Error::io(&path))?;
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
