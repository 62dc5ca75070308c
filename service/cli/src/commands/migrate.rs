//! `d3dgen migrate`: documents and databases of earlier releases in the form of this one.
//!
//! Every command reads documents of earlier versions as they are; this writes them anew, so that other programs find one form.

use std::fs;
use std::path::{Path, PathBuf};

use d3dgen_assets::annotation::Annotation;
use d3dgen_eval::Evaluation;
use d3dgen_model::brief::Brief;
use d3dgen_model::document::Document;
use d3dgen_model::domain::Domain;
use d3dgen_model::edits::Edits;
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::knowledge::KnowledgeBase;
use d3dgen_model::placements::Placements;
use d3dgen_model::proposal::Proposal;
use d3dgen_model::report::Report;
use d3dgen_model::scenario::Scenario;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::world::World;
use d3dgen_store::{Access, FORMAT, Options, Store};
use serde_json::Value;

use crate::error::Error;
use crate::input::{text, write_text};
use crate::interrupt;
use crate::table::table;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// A document (JSON), a database, or a folder with any number of both in it
    #[arg(value_name = "PATH", required = true)]
    paths: Vec<PathBuf>,
    /// Say what would be done, and do nothing
    #[arg(long)]
    dry_run: bool,
}

/// A kind of document.
struct Kind {
    name: &'static str,
    /// Returns whether JSON has every field that such a document must have.
    fits: fn(&Value) -> bool,
    read: fn(Value) -> Result<Read, d3dgen_model::Error>,
}

/// A document that was read.
struct Read {
    found: u64,
    current: u64,
    /// The written form of today, of an earlier version.
    rewritten: Option<String>,
}

/// One thing that was found, in the order it is listed.
struct Found {
    path: PathBuf,
    kind: &'static str,
    from: u64,
    to: u64,
    work: Work,
}

enum Work {
    None,
    Write(String),
    Open,
}

fn kind<D: Document>() -> Kind {
    Kind { name: D::KIND, fits: fits::<D>, read: read::<D> }
}

/// All kinds of document that have versions.
fn kinds() -> Vec<Kind> {
    vec![
        kind::<World>(),
        kind::<SceneGraph>(),
        kind::<Floorplan>(),
        kind::<Placements>(),
        kind::<Scenario>(),
        kind::<Report>(),
        kind::<Brief>(),
        kind::<Edits>(),
        kind::<Proposal>(),
        kind::<KnowledgeBase>(),
        kind::<Domain>(),
        kind::<Annotation>(),
        kind::<Evaluation>(),
    ]
}

fn fits<D: Document>(value: &Value) -> bool {
    let mut value = value.clone();
    if D::version_of(&value).is_none() || D::upgrade(&mut value).is_err() {
        return false;
    }
    let has = |name: &Value| name.as_str().is_some_and(|name| value.get(name).is_some());
    D::schema()["required"].as_array().is_some_and(|names| names.iter().all(has))
}

fn read<D: Document>(value: Value) -> Result<Read, d3dgen_model::Error> {
    let (found, current) = (D::version_of(&value).unwrap_or_default(), D::current_version());
    let document = D::from_value(value)?;
    Ok(Read { found, current, rewritten: (found < current).then(|| document.to_json()) })
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        interrupt::listen();
        let mut found = Vec::new();
        for path in &self.paths {
            look(path, true, &kinds(), &mut found)?;
        }
        let waiting = found.iter().filter(|f| !matches!(f.work, Work::None)).count();
        if !self.dry_run {
            found.iter().try_for_each(Found::bring)?;
        }
        let rows: Vec<Vec<String>> = found.iter().map(|f| f.row(self.dry_run)).collect();
        write_text(None, &table(&["path", "kind", "version", ""], &rows))?;
        let (verb, rest) = (if self.dry_run { "to bring" } else { "brought" }, found.len() - waiting);
        eprintln!("{waiting} {verb} to the form of d3dgen {}, {rest} in it already", env!("CARGO_PKG_VERSION"));
        Ok(())
    }
}

impl Found {
    /// Does what is to be done; a file is written whole or not at all, a database is upgraded in steps that can be interrupted.
    fn bring(&self) -> Result<(), Error> {
        interrupt::check()?;
        match &self.work {
            Work::None => Ok(()),
            Work::Write(text) => write_text(Some(&self.path), text),
            Work::Open => {
                let opened = Store::open(&self.path, Access::Write, &Options::default());
                opened.map(drop).map_err(|e| Error::Knowledge(e.into()))
            }
        }
    }

    fn row(&self, dry_run: bool) -> Vec<String> {
        let outcome = match self.work {
            Work::None => "current".to_owned(),
            _ if dry_run => format!("would become {}", self.to),
            _ => format!("now {}", self.to),
        };
        vec![self.path.display().to_string(), self.kind.into(), self.from.to_string(), outcome]
    }
}

/// Adds what is at a path: a file, a database, or everything below a folder. Nothing is changed.
///
/// # Errors
/// `Read`; `Document` for a document that cannot be read; `Input` for a `named` file that is none; `Knowledge` for a database
/// of a later release.
fn look(path: &Path, named: bool, kinds: &[Kind], found: &mut Vec<Found>) -> Result<(), Error> {
    interrupt::check()?;
    if !path.is_dir() {
        if let Some(document) = document(path, named, kinds)? {
            found.push(document);
        }
        return Ok(());
    }
    if path.join(STORE).is_file() {
        found.push(store(path)?);
        return Ok(());
    }
    let refused = |source| Error::Read { path: path.to_path_buf(), source };
    let entries = fs::read_dir(path).map_err(refused)?.collect::<Result<Vec<_>, _>>().map_err(refused)?;
    let mut inside: Vec<PathBuf> = entries.into_iter().map(|e| e.path()).filter(|p| is_searched(p)).collect();
    inside.sort();
    inside.iter().try_for_each(|path| look(path, false, kinds, found))
}

/// The file that a database's folder has.
const STORE: &str = "store.json";

/// Returns whether a path found in a folder is looked into: no link, nothing hidden, of files only JSON.
fn is_searched(path: &Path) -> bool {
    let hidden = path.file_name().is_some_and(|n| n.to_string_lossy().starts_with('.'));
    !hidden && !path.is_symlink() && (path.is_dir() || path.extension().is_some_and(|e| e == "json"))
}

fn document(path: &Path, named: bool, kinds: &[Kind]) -> Result<Option<Found>, Error> {
    let (path, text) = text(path, "")?;
    let value: Value = match serde_json::from_str(&text) {
        Ok(value) => value,
        Err(_) if !named => return Ok(None),
        Err(e) => {
            let source = d3dgen_model::Error::NotJson { kind: "file", reason: e.to_string() };
            return Err(Error::Document { path, source });
        }
    };
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let by_name = kinds.iter().find(|k| k.name == stem && value.get("version").is_some());
    let Some(kind) = by_name.or_else(|| kinds.iter().find(|k| (k.fits)(&value))) else {
        return match named {
            true => {
                Err(Error::Input(format!("{}: no document of d3dgen has such fields; see schemas/", path.display())))
            }
            false => Ok(None),
        };
    };
    match (kind.read)(value) {
        Ok(read) => {
            let work = read.rewritten.map_or(Work::None, Work::Write);
            Ok(Some(Found { path, kind: kind.name, from: read.found, to: read.current, work }))
        }
        Err(source) => Err(Error::Document { path, source }),
    }
}

fn store(folder: &Path) -> Result<Found, Error> {
    let (path, text) = text(&folder.join(STORE), "")?;
    let format = serde_json::from_str(&text).ok().and_then(|v: Value| v.get("format").and_then(Value::as_u64));
    let from =
        format.ok_or_else(|| Error::Input(format!("{}: names no format; restore a snapshot", path.display())))?;
    let to = u64::from(FORMAT);
    if from > to {
        // says which release wrote it
        Store::open(folder, Access::Read, &Options::default()).map_err(|e| Error::Knowledge(e.into()))?;
    }
    let work = if from < to { Work::Open } else { Work::None };
    Ok(Found { path: folder.to_path_buf(), kind: "database", from, to, work })
}
