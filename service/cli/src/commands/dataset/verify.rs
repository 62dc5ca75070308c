//! `d3dgen dataset verify`: whether a data set is whole.

use std::path::PathBuf;

use d3dgen_dataset::verify::verify;

use super::{Talk, disk, go_on};
use crate::error::Error;
use crate::interrupt;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// Folder of the data set
    dataset: PathBuf,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        interrupt::listen();
        let talk = Talk::of(1);
        let verdict = verify(&self.dataset, &mut |file| {
            talk.progress.doing(file);
            go_on()
        });
        talk.progress.finish();
        let verdict = verdict?;
        eprintln!(
            "{} worlds, {} files summed, {} of shards read",
            verdict.worlds,
            verdict.files,
            disk::size(verdict.bytes)
        );
        if verdict.problems.is_empty() {
            return Ok(());
        }
        verdict.problems.iter().for_each(|problem| eprintln!("  {problem}"));
        let (count, first) = (verdict.problems.len(), &verdict.problems[0]);
        Err(Error::Unsound(format!("{} is not whole: {count} problem(s), first {first}", self.dataset.display())))
    }
}
