//! The worlds below a folder: found, read, measured; what cannot be read is told and left out.

use std::fs;
use std::path::{Path, PathBuf};

use d3dgen_eval::evaluation::{BrokenFile, WorldMeasures};
use d3dgen_eval::{measure, picture};
use d3dgen_model::report::Report;
use d3dgen_model::world::World;

use crate::error::Error;
use crate::input::document;
use crate::parallel;

/// What was found below a folder.
pub struct Found {
    /// Measures of every world that could be read, by path.
    pub worlds: Vec<WorldMeasures>,
    /// Files that could not.
    pub broken: Vec<BrokenFile>,
}

/// Measures every world below a folder.
///
/// # Errors
/// `Read` when a folder cannot be looked into, `Input` when there is no world at all.
pub fn measured(folder: &Path, threads: usize) -> Result<Found, Error> {
    let mut files = Vec::new();
    below(folder, &mut files)?;
    if files.is_empty() {
        return Err(Error::Input(format!("{} holds no world: no world.json in it or below it", folder.display())));
    }
    let mut found = Found { worlds: Vec::new(), broken: Vec::new() };
    for (world, broken) in parallel::map(&files, threads, |file| Ok(one(folder, file)))? {
        found.worlds.extend(world);
        found.broken.extend(broken);
    }
    Ok(found)
}

/// Draws the plan of a world that was measured.
///
/// # Errors
/// `Read` or `Document` when its file has changed since.
pub fn picture(folder: &Path, measures: &WorldMeasures) -> Result<String, Error> {
    let home = if measures.path == "." { folder.to_path_buf() } else { folder.join(&measures.path) };
    Ok(picture::svg(&document::<World>(&home)?, measures))
}

/// Adds the world files in a folder and below it, in order of their paths; links to folders are not followed.
fn below(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), Error> {
    let refused = |source| Error::Read { path: folder.to_path_buf(), source };
    let mut entries = fs::read_dir(folder).map_err(refused)?.collect::<Result<Vec<_>, _>>().map_err(refused)?;
    entries.sort_by_key(fs::DirEntry::file_name);
    for entry in entries {
        let name = entry.file_name();
        let kind = entry.file_type().map_err(refused)?;
        if name == "world.json" && !kind.is_dir() {
            files.push(entry.path());
        } else if kind.is_dir() && !name.to_string_lossy().starts_with(".d3dgen-") {
            below(&entry.path(), files)?;
        }
    }
    Ok(())
}

/// Measures a world; a broken report is told, and the world measured without it.
fn one(folder: &Path, file: &Path) -> (Option<WorldMeasures>, Vec<BrokenFile>) {
    let home = file.parent().unwrap_or(folder);
    let short = |path: &Path| {
        let below = path.strip_prefix(folder).unwrap_or(path).to_string_lossy().replace('\\', "/");
        if below.is_empty() { ".".to_owned() } else { below }
    };
    let mut broken = Vec::new();
    let mut tell = |path: &Path, error: Error| {
        // the path stands beside the message already
        let message = match error {
            Error::Document { source, .. } => source.to_string(),
            Error::Read { source, .. } => source.to_string(),
            other => other.to_string(),
        };
        broken.push(BrokenFile { path: short(path), message });
    };
    let report = home.join("report.json");
    let report = match report.exists().then(|| document::<Report>(&report)) {
        Some(Err(error)) => {
            tell(&report, error);
            None
        }
        read => read.and_then(Result::ok),
    };
    match document::<World>(file) {
        Ok(world) => (Some(measure(&world, report.as_ref(), &short(home), &Default::default())), broken),
        Err(error) => {
            tell(file, error);
            (None, broken)
        }
    }
}
