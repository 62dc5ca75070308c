//! `d3dgen dataset merge`: the parts of several machines as one data set.

use std::path::PathBuf;

use d3dgen_dataset::part::{Part, Shard};
use d3dgen_dataset::shelf::Shelf;

use super::{WORK, check_new, clear_work, finish, parts, tell};
use crate::error::Error;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// Folders of the shards, in any order
    #[arg(required = true, value_name = "DIR")]
    parts: Vec<PathBuf>,
    /// Folder of the data set, new or empty
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        check_new(&self.out)?;
        let parts = parts(&self.parts)?;
        let (first, others) =
            parts.split_first().ok_or_else(|| Error::Input("name the folders of the shards".into()))?;
        if let Some(reason) = others.iter().find_map(|other| first.differs_from(other)) {
            return Err(Error::Input(reason));
        }
        let mut shelf = Shelf::default();
        for part in &parts {
            part.check()?;
            shelf.add_part(part)?;
        }
        let work = self.out.join(WORK);
        let whole = Part::begin(&work, &first.spec_text, &first.snapshot, Shard::WHOLE, 1)?;
        let made = finish(&whole, &shelf, &self.out);
        if made.is_err() {
            clear_work(&work)?;
        }
        let made = made?;
        clear_work(&work)?;
        tell(&made, &self.out);
        Ok(())
    }
}
