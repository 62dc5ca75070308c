//! Documents into records: which files and addresses there are, what is known of each, and their passages.
//!
//! The order in which documents are named changes nothing. A document that cannot be had or read is left out and said.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::files::{listed, sha256};
use super::sidecar::{Facts, SIDECAR, Sidecar};
use super::{Context, Stop};
use crate::Error;
use crate::corpus::canonical_url;
use crate::corpus::record::{DocumentRecord, PassageRecord};
use crate::fetch::Fetcher;
use crate::read;
use crate::synthesis::slug::{hash, slug};

/// Endings of files that are read as documents.
const ENDINGS: [&str; 9] = ["html", "htm", "xhtml", "md", "markdown", "txt", "text", "pdf", "xht"];
/// The most files that are taken from a folder.
const MAX_FILES: usize = 20_000;
/// How deep folders are looked into.
const MAX_DEPTH: usize = 16;
/// Longest readable part of a document's id, in bytes.
const ID_WORDS: usize = 24;

/// Where a document is.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Place {
    /// A file.
    File {
        /// Its path.
        path: PathBuf,
        /// Its name below the folder that was given, with `/`.
        name: String,
        /// The folder that was given, or the file's own.
        root: PathBuf,
    },
    /// An address.
    Url(String),
}

impl Place {
    /// Returns the place of a file alone.
    pub fn of_file(path: PathBuf) -> Self {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let root = path.parent().map(Path::to_path_buf).unwrap_or_default();
        Self::File { path, name, root }
    }
}

/// What was gathered.
#[derive(Debug, Default)]
pub struct Gathered {
    /// In the order of their names.
    pub documents: Vec<DocumentRecord>,
    /// In the order of documents and text.
    pub passages: Vec<PassageRecord>,
    /// Documents that could not be had or read, and other things to know.
    pub warnings: Vec<String>,
    /// How many documents are missing.
    pub failed: usize,
}

/// Returns the documents that words name: addresses, files, and folders with all documents in them.
///
/// # Errors
/// `Problems` for words that name nothing, and folders that cannot be looked into.
pub fn places(words: &[String]) -> Result<Vec<Place>, Error> {
    let mut places = BTreeSet::new();
    let mut problems = Vec::new();
    for word in words {
        if word.starts_with("http://") || word.starts_with("https://") {
            match canonical_url(word) {
                Some(_) => _ = places.insert(Place::Url(word.clone())),
                None => problems.push(format!("{}: no address that can be asked", without_user(word))),
            }
            continue;
        }
        let path = Path::new(word);
        match std::fs::metadata(path) {
            Ok(found) if found.is_dir() => {
                if let Err(reason) = walk(path, path, 0, &mut places) {
                    problems.push(format!("{word}: {reason}"));
                }
            }
            Ok(_) => _ = places.insert(Place::of_file(path.to_path_buf())),
            Err(e) => problems.push(format!("{word}: {e}; --documents takes files, folders and http(s) addresses")),
        }
    }
    if problems.is_empty() { Ok(places.into_iter().collect()) } else { Err(listed(problems)) }
}

/// Returns an address without what stands before `@`, which may be a password.
fn without_user(url: &str) -> String {
    match url.split_once("://").and_then(|(s, rest)| rest.rsplit_once('@').map(|(_, host)| (s, host))) {
        Some((scheme, host)) => format!("{scheme}://{host}"),
        None => url.to_owned(),
    }
}

fn walk(folder: &Path, root: &Path, depth: usize, places: &mut BTreeSet<Place>) -> Result<(), String> {
    if depth > MAX_DEPTH {
        return Err(format!("folders are more than {MAX_DEPTH} deep"));
    }
    for entry in std::fs::read_dir(folder).map_err(|e| e.to_string())? {
        let entry = entry.map_err(|e| e.to_string())?;
        let (path, kind) = (entry.path(), entry.file_type().map_err(|e| e.to_string())?);
        let hidden = entry.file_name().to_string_lossy().starts_with('.');
        if kind.is_dir() && !hidden {
            walk(&path, root, depth + 1, places)?;
        } else if kind.is_file() && !hidden && is_document(&path) {
            let below = path.strip_prefix(root).unwrap_or(&path);
            let parts: Vec<String> = below.iter().map(|p| p.to_string_lossy().into_owned()).collect();
            places.insert(Place::File { name: parts.join("/"), path, root: root.to_path_buf() });
        }
        if places.len() > MAX_FILES {
            return Err(format!("holds more than {MAX_FILES} documents"));
        }
    }
    Ok(())
}

fn is_document(path: &Path) -> bool {
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    ending.is_some_and(|e| ENDINGS.contains(&e.as_str()))
}

/// The sidecars of all folders at hand.
#[derive(Debug, Default)]
struct Sidecars {
    by_folder: BTreeMap<PathBuf, Sidecar>,
    used: BTreeSet<(PathBuf, String)>,
}

impl Sidecars {
    fn read(places: &[Place], extra: Option<&Path>) -> Result<Self, Error> {
        let mut folders = BTreeSet::new();
        for place in places {
            let Place::File { path, root, .. } = place else { continue };
            folders.extend(path.ancestors().skip(1).take_while(|a| a.starts_with(root)).map(Path::to_path_buf));
        }
        let mut files: Vec<(PathBuf, PathBuf)> = folders.into_iter().map(|f| (f.join(SIDECAR), f)).collect();
        files.retain(|f| f.0.is_file());
        files.extend(extra.map(|e| (e.to_path_buf(), e.to_path_buf())));
        let mut sidecars = Self::default();
        let mut problems = Vec::new();
        for (file, folder) in files {
            let text = std::fs::read_to_string(&file).map_err(|e| Error::file("read", &file, &e))?;
            match Sidecar::parse(&text, &file.display().to_string()) {
                Ok(sidecar) => _ = sidecars.by_folder.insert(folder, sidecar),
                Err(found) => problems.extend(found),
            }
        }
        if problems.is_empty() { Ok(sidecars) } else { Err(listed(problems)) }
    }

    /// Returns the facts of a place, those of the nearest folder first.
    fn facts(&mut self, place: &Place) -> Facts {
        let mut facts = Facts::default();
        let mut used = Vec::new();
        for (folder, sidecar) in self.by_folder.iter().rev() {
            let name = match place {
                Place::Url(url) => url.clone(),
                Place::File { path, name, .. } => match path.strip_prefix(folder) {
                    Ok(below) => below.iter().map(|p| p.to_string_lossy()).collect::<Vec<_>>().join("/"),
                    Err(_) => name.clone(), // a sidecar named by a flag knows files by the name below their folder
                },
            };
            if let Some(found) = sidecar.facts(&name) {
                used.push((folder.clone(), name));
                facts = facts.or(found);
            }
        }
        self.used.extend(used);
        facts
    }

    fn unused(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        for (folder, sidecar) in &self.by_folder {
            let used = |name: &str| {
                self.used.iter().any(|(f, u)| {
                    f == folder && (u == name || canonical_url(u).is_some_and(|u| canonical_url(name) == Some(u)))
                })
            };
            for name in sidecar.documents.keys().filter(|n| !used(n)) {
                warnings.push(format!(
                    "{}: documents.\"{name}\" names no document of this run",
                    folder.join(SIDECAR).display()
                ));
            }
        }
        warnings
    }
}

/// Returns the records of documents.
///
/// # Errors
/// `Problems` in sidecars, `Interrupted`; documents that fail alone are left out and said.
pub async fn gather(
    context: &Context<'_>,
    places: &[Place],
    sources: Option<&Path>,
    flags: &Facts,
) -> Result<Gathered, Error> {
    let mut sidecars = Sidecars::read(places, sources)?;
    let mut out = Gathered::default();
    let mut seen: BTreeMap<String, String> = BTreeMap::new();
    for place in places {
        context.stop.check()?;
        let source = match place {
            Place::Url(url) => url.clone(),
            Place::File { name, .. } => name.clone(),
        };
        context.say(&format!("reading {source}"));
        let facts = sidecars.facts(place);
        let page = match get(context, place).await {
            Ok(page) => page,
            Err(Error::Interrupted) => return Err(Error::Interrupted),
            Err(e) => {
                out.failed += 1;
                out.warnings.push(left_out(&source, &e));
                continue;
            }
        };
        match record(context, &source, page, facts, flags) {
            Ok((document, passages, warnings)) => {
                out.warnings.extend(warnings);
                if let Some(first) = seen.insert(document.document_id.clone(), source.clone()) {
                    out.warnings.push(format!("{source}: holds the same as {first} and is read once"));
                    continue;
                }
                out.documents.push(document);
                out.passages.extend(passages);
            }
            Err(e) => {
                out.failed += 1;
                out.warnings.push(left_out(&source, &e));
            }
        }
    }
    out.warnings.extend(sidecars.unused());
    // Names of different folders can be in any order; what is written is in one.
    out.documents.sort_by(|a, b| (&a.source, &a.document_id).cmp(&(&b.source, &b.document_id)));
    let order: BTreeMap<&str, usize> =
        out.documents.iter().enumerate().map(|(i, d)| (d.document_id.as_str(), i)).collect();
    out.passages.sort_by_key(|p| order.get(p.document_id.as_str()).copied());
    Ok(out)
}

/// Says that a document is missing; most errors name it already.
fn left_out(source: &str, error: &Error) -> String {
    let said = error.to_string();
    let reason = said.strip_prefix(source).and_then(|r| r.strip_prefix(": ")).unwrap_or(&said);
    format!("{source}: left out: {reason}")
}

/// The bytes of a document.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Page {
    /// What was sent.
    pub bytes: Vec<u8>,
    /// As the server says.
    pub content_type: Option<String>,
    /// Where it really came from, for addresses.
    pub url: Option<String>,
    /// `YYYY-MM-DD`.
    pub retrieved_at: String,
}

async fn get(context: &Context<'_>, place: &Place) -> Result<Page, Error> {
    match place {
        Place::Url(url) => context.stop.race(context.fetch.get(url)).await?,
        Place::File { path, .. } => {
            let found = std::fs::metadata(path).map_err(|e| Error::file("read", path, &e))?;
            if found.len() > context.read.max_bytes as u64 {
                let reason = format!("has {} bytes, the limit is {}", found.len(), context.read.max_bytes);
                return Err(Error::Problems(vec![reason]));
            }
            let bytes = std::fs::read(path).map_err(|e| Error::file("read", path, &e))?;
            Ok(Page { bytes, content_type: None, url: None, retrieved_at: context.date.to_owned() })
        }
    }
}

type Read = (DocumentRecord, Vec<PassageRecord>, Vec<String>);

fn record(context: &Context<'_>, source: &str, page: Page, known: Facts, flags: &Facts) -> Result<Read, Error> {
    let name = page.url.as_deref().unwrap_or(source);
    let document = read::read(&page.bytes, page.content_type.as_deref(), name, context.read)?;
    let (mut own, problems) =
        Facts::of_document(document.title.as_deref(), document.language.as_deref(), &document.meta);
    let mut warnings: Vec<String> =
        problems.into_iter().map(|p| format!("{source}: says of itself {p}; left out")).collect();
    warnings.extend(document.warnings.iter().map(|w| format!("{source}: {w}")));
    let mut by_host = None;
    if let Some(url) = &page.url {
        // A page does not say where it is; the one who asked knows.
        own.url = canonical_url(url);
        own.source_type = None; // nor can a page of the network make itself law
        by_host = Facts::source_type_of(url);
    }
    let host = Facts { source_type: by_host, ..Facts::default() };
    let facts = known.or(&own).or(flags).or(&host);
    if document.passages.is_empty() {
        warnings.push(format!("{source}: holds no text"));
    }
    let sha = sha256(&page.bytes);
    let stem = source.trim_end_matches('/').rsplit('/').next().unwrap_or(source);
    let stem = stem.rsplit_once('.').map_or(stem, |(s, _)| s);
    let identity = format!("{}\n{sha}", facts.url.as_deref().unwrap_or_default());
    let document_id = format!("{}_{}", slug(stem, ID_WORDS), hash(&identity)).trim_start_matches('_').to_owned();
    let passages = document.passages.into_iter().map(|p| passage(&document_id, p)).collect();
    let record = DocumentRecord {
        document_id,
        source: source.to_owned(),
        url: facts.url,
        sha256: sha,
        title: facts.title,
        publisher: facts.publisher,
        edition: facts.edition,
        jurisdiction: facts.jurisdiction,
        source_type: facts.source_type,
        language: facts.language.unwrap_or_default(),
        retrieved_at: page.retrieved_at,
        quoted_only: false,
        warnings: document.warnings,
    };
    Ok((record, passages, warnings))
}

fn passage(document_id: &str, passage: read::Passage) -> PassageRecord {
    PassageRecord {
        passage_id: passage.id,
        document_id: document_id.to_owned(),
        heading: passage.heading,
        kind: match passage.kind {
            read::PassageKind::Prose => "prose",
            read::PassageKind::Table => "table",
            read::PassageKind::List => "list",
        }
        .to_owned(),
        page: passage.page,
        topic: None,
        text: passage.text,
    }
}

/// Gets pages; the program fetches them, tests bring their own.
pub trait Fetch: Send + Sync {
    /// Returns the page at an address.
    fn get<'a>(&'a self, url: &'a str) -> super::BoxFuture<'a, Result<Page, Error>>;
}

impl Fetch for Fetcher {
    fn get<'a>(&'a self, url: &'a str) -> super::BoxFuture<'a, Result<Page, Error>> {
        Box::pin(async move {
            let fetched = self.fetch(url).await?;
            let retrieved_at = fetched.entry.fetched_at.get(..10).unwrap_or_default().to_owned();
            Ok(Page {
                bytes: fetched.bytes,
                content_type: fetched.entry.content_type,
                url: Some(fetched.entry.final_url),
                retrieved_at,
            })
        })
    }
}

impl Stop<'_> {
    /// Returns what the future gives, or drops it when the user stops.
    ///
    /// # Errors
    /// `Interrupted`.
    pub async fn race<T>(&self, future: impl Future<Output = T>) -> Result<T, Error> {
        let mut future = std::pin::pin!(future);
        loop {
            self.check()?;
            tokio::select! {
                out = &mut future => return Ok(out),
                () = tokio::time::sleep(super::STOP_POLL) => {}
            }
        }
    }
}
