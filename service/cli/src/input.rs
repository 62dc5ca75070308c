//! Documents from files and standard input.

use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use d3dgen_knowledge::import::{self, Imported};
use d3dgen_model::brief::Brief;
use d3dgen_model::document::Document;
use d3dgen_model::scene_graph::{Note, SceneGraph};
use d3dgen_model::world::World;
use serde::Serialize;

use crate::error::Error;

/// Returns the text of a file, of standard input for `-`, or of `default` inside a folder.
///
/// # Errors
/// `Read` with the file's path.
pub fn text(path: &Path, default: &str) -> Result<(PathBuf, String), Error> {
    let file = if path.is_dir() { path.join(default) } else { path.to_path_buf() };
    let read = if file == Path::new("-") {
        let mut text = String::new();
        io::stdin().read_to_string(&mut text).map(|_| text)
    } else {
        fs::read_to_string(&file)
    };
    match read {
        Ok(text) => Ok((file, text)),
        Err(source) => Err(Error::Read { path: file, source }),
    }
}

/// Returns a checked document; a folder stands for the file of that kind in it.
///
/// # Errors
/// `Read`, or `Document` with every problem.
pub fn document<D: Document>(path: &Path) -> Result<D, Error> {
    let (path, text) = text(path, &format!("{}.json", D::KIND))?;
    D::from_json(&text).map_err(|source| Error::Document { path, source })
}

/// Returns the scene graph in a scene graph's or a world's file.
///
/// # Errors
/// As [`document`].
pub fn scene_graph(path: &Path) -> Result<SceneGraph, Error> {
    let (path, text) = text(path, "scene_graph.json")?;
    let is_world = serde_json::from_str::<serde_json::Value>(&text).is_ok_and(|v| v.get("scene_graph").is_some());
    let graph = if is_world { World::from_json(&text).map(|w| w.scene_graph) } else { SceneGraph::from_json(&text) };
    graph.map_err(|source| Error::Document { path, source })
}

/// Returns a checked brief; a folder stands for its `brief.json`.
///
/// # Errors
/// As [`document`].
pub fn brief(path: &Path) -> Result<Brief, Error> {
    let (path, text) = text(path, "brief.json")?;
    Brief::from_json(&text).map_err(|source| Error::Document { path, source })
}

/// Returns a checked knowledge base in SI with the shared rules it uses, and the file it is in; a folder stands for its `knowledge.json`.
///
/// # Errors
/// `Read`, or `Document` with every problem.
pub fn knowledge_base(path: &Path) -> Result<(PathBuf, Imported), Error> {
    let (path, text) = text(path, "knowledge.json")?;
    match import::read(&text) {
        Ok(mut imported) => match d3dgen_plugins::complete(&mut imported.knowledge) {
            Ok(()) => Ok((path, imported)),
            Err(source) => Err(Error::Document { path, source }),
        },
        Err(d3dgen_knowledge::Error::Document(source)) => Err(Error::Document { path, source }),
        Err(other) => Err(other.into()),
    }
}

/// Writes one JSON line for each item to standard output.
///
/// # Errors
/// `Write`.
pub fn write_lines<T: Serialize>(items: impl IntoIterator<Item = T>) -> Result<(), Error> {
    let line = |item: T| serde_json::to_string(&item).map(|line| line + "\n");
    let lines: Result<String, _> = items.into_iter().map(line).collect();
    write_text(None, &lines.map_err(|e| Error::Input(e.to_string()))?)
}

/// Says on standard error what is not as it was asked for.
pub fn tell(conflicts: &[Note]) {
    conflicts.iter().for_each(|c| eprintln!("changed: {}", c.message));
}

/// Writes data to standard output, or to a file when one is named; a reader that has gone away is no error.
///
/// # Errors
/// `Write`.
pub fn write_text(out: Option<&Path>, text: &str) -> Result<(), Error> {
    let Some(path) = out.filter(|p| *p != Path::new("-")) else {
        return match io::Write::write_all(&mut io::stdout().lock(), text.as_bytes()) {
            Err(e) if e.kind() != io::ErrorKind::BrokenPipe => {
                Err(Error::Write { path: "standard output".into(), source: e })
            }
            _ => Ok(()),
        };
    };
    let refused = |source| Error::Write { path: path.to_path_buf(), source };
    if path.exists() && !path.is_file() {
        return fs::write(path, text).map_err(refused); // a pipe or a device
    }
    // Beside it, then a rename: a full disk leaves the old file as it was.
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(".d3dgen.tmp");
    let fresh = path.with_file_name(name);
    let folder = path.parent().map_or(Ok(()), fs::create_dir_all);
    let written = folder.and_then(|()| fs::write(&fresh, text)).and_then(|()| fs::rename(&fresh, path));
    if written.is_err() {
        let _ = fs::remove_file(&fresh); // the error above is the one to report
    }
    written.map_err(refused)
}
