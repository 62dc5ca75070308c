//! `d3dgen dataset extend`: more seeds of the same prompts; the worlds that are there are taken as they are.

use std::path::{Path, PathBuf};

use d3dgen_dataset::assemble;
use d3dgen_dataset::part::{SPEC, Shard};
use d3dgen_dataset::shelf::Shelf;
use d3dgen_dataset::snapshot::Snapshot;
use d3dgen_dataset::spec::Spec;
use d3dgen_dataset::tasks::Tasks;

use super::make::{MOST_OF_A_BLOCK, RunArgs};
use super::{WORK, check_new, clear_work, finish, tell};
use crate::error::Error;
use crate::input::text;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// A finished data set
    dataset: PathBuf,
    /// Number of seeds of each prompt that the new one has
    #[arg(long, value_name = "N")]
    seeds: u64,
    /// Folder of the new data set
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    run: RunArgs,
}

impl Args {
    pub fn run(mut self) -> Result<(), Error> {
        if !assemble::is_finished(&self.dataset) {
            return Err(Error::Input(format!("{} is no finished data set", self.dataset.display())));
        }
        check_new(&self.out)?;
        let (path, spec_text) = text(&self.dataset.join(SPEC), SPEC)?;
        let spec = Spec::from_toml(&spec_text, &path.display().to_string())?;
        if self.seeds < spec.seeds {
            return Err(Error::Input(format!("--seeds {}: the data set has {} already", self.seeds, spec.seeds)));
        }
        let (wanted, text) = with_seeds(&spec_text, self.seeds, &spec)?;
        self.run.snapshot.get_or_insert(pinned(&self.dataset)?);
        let mut shelf = Shelf::default();
        shelf.add_dataset(&self.dataset)?;
        let work = self.out.join(WORK);
        // a block that begins among the worlds that are there would make some of them again
        let there = Tasks::of(&spec).map_err(Error::Input)?.len();
        self.run.block.get_or_insert((1..=MOST_OF_A_BLOCK).rev().find(|n| there.is_multiple_of(*n)).unwrap_or(1));
        let part = self.run.part(&work, (&wanted, &text), Shard::WHOLE)?.taking(|task| shelf.has(task.id));
        self.run.make(&part)?;
        shelf.add_part(&part)?;
        let made = finish(&part, &shelf, &self.out)?;
        clear_work(&work)?;
        tell(&made, &self.out);
        Ok(())
    }
}

/// Returns the snapshot of a data set.
fn pinned(dataset: &Path) -> Result<PathBuf, Error> {
    let refused = |source| Error::Read { path: dataset.to_path_buf(), source };
    let entries = std::fs::read_dir(dataset).map_err(refused)?;
    let paths = entries.map(|e| e.map(|e| e.path())).collect::<std::io::Result<Vec<_>>>().map_err(refused)?;
    let is_snapshot = |p: &PathBuf| p.file_name().is_some_and(|n| n.to_string_lossy().starts_with("snapshot-"));
    let found = paths.into_iter().find(is_snapshot);
    let found = found.ok_or_else(|| Error::Input(format!("{} has no snapshot", dataset.display())))?;
    Snapshot::read(&found)?;
    Ok(found)
}

/// Returns the spec and its text with another number of seeds, the rest of it as it was written.
fn with_seeds(text: &str, seeds: u64, spec: &Spec) -> Result<(Spec, String), Error> {
    let is_seeds = |line: &&str| line.split_once('=').is_some_and(|(key, _)| key.trim() == "seeds");
    let line = text.split_inclusive('\n').find(is_seeds).unwrap_or_default();
    let end = if line.ends_with('\n') { "\n" } else { "" };
    let changed = text.replacen(line, &format!("seeds = {seeds}{end}"), 1);
    let wanted = Spec { seeds, ..spec.clone() };
    match Spec::from_toml(&changed, SPEC) {
        Ok(read) if read == wanted => Ok((wanted, changed)),
        _ => Err(Error::Input(
            "the spec has its seeds on no line of their own; write `seeds = N` on one and make it anew".into(),
        )),
    }
}
