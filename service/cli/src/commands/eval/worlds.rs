//! The worlds below a folder: found, read, measured; what cannot be read is told and left out.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use d3dgen_eval::evaluation::{BrokenFile, WorldMeasures};
use d3dgen_eval::{Known, measure, picture};
use d3dgen_model::report::Report;
use d3dgen_model::world::World;
use d3dgen_pipeline::generate::{Event, Settings, furnish_and_check};
use d3dgen_plugins::Registry;

use crate::error::Error;
use crate::input::document;
use crate::interrupt;
use crate::parallel;
use crate::stage_clock::StageClock;

/// What was found below a folder.
pub struct Found {
    /// Measures of every world that could be read, by path.
    pub worlds: Vec<WorldMeasures>,
    /// Files that could not.
    pub broken: Vec<BrokenFile>,
}

/// Measures every world below a folder; with the kinds of building, each is made once more and timed.
///
/// # Errors
/// `Read` when a folder cannot be looked into, `Input` when there is no world at all, `Interrupted`.
pub fn measured(folder: &Path, threads: usize, makers: Option<&Registry>) -> Result<Found, Error> {
    let mut files = Vec::new();
    below(folder, &mut files)?;
    if files.is_empty() {
        return Err(Error::Input(format!("{} holds no world: no world.json in it or below it", folder.display())));
    }
    let mut found = Found { worlds: Vec::new(), broken: Vec::new() };
    for (world, broken) in parallel::map(&files, threads, |file| one(folder, file, makers))? {
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
fn one(
    folder: &Path,
    file: &Path,
    makers: Option<&Registry>,
) -> Result<(Option<WorldMeasures>, Vec<BrokenFile>), Error> {
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
    let world = match document::<World>(file) {
        Ok(world) => world,
        Err(error) => {
            tell(file, error);
            return Ok((None, broken));
        }
    };
    let stage_ms = match makers.map(|registry| stage_ms(&world, registry)).transpose() {
        Err(Error::Interrupted) => return Err(Error::Interrupted),
        Err(error) => {
            tell(file, error);
            None
        }
        Ok(times) => times,
    };
    let known = Known { stage_ms: stage_ms.unwrap_or_default(), ..Known::default() };
    Ok((Some(measure(&world, report.as_ref(), &short(home), &known)), broken))
}

/// Makes a world of the same scene graph and returns the times of its stages, ms; nothing for plans that were brought.
fn stage_ms(world: &World, registry: &Registry) -> Result<BTreeMap<String, f64>, Error> {
    let mut clock = StageClock::default();
    if world.floorplan.is_given() {
        return Ok(clock.stage_ms());
    }
    let mut hear = |event: Event<'_>| clock.hear(&event);
    match furnish_and_check(&world.scene_graph, registry, &Settings::default(), &mut hear, interrupt::flag()) {
        Ok(_) => Ok(clock.stage_ms()),
        Err(d3dgen_pipeline::Error::Cancelled) => Err(Error::Interrupted),
        Err(error) => Err(error.into()),
    }
}
