//! `d3dgen dataset snapshot`: what worlds depend on beside their request, in one file.

use std::path::PathBuf;

use d3dgen_dataset::snapshot::Snapshot;

use crate::error::Error;
use crate::input::write_text;
use crate::registry::RegistryArgs;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// Folder to write it into; its name is that of its content
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let snapshot = Snapshot::take(&self.registry.load()?)?;
        std::fs::create_dir_all(&self.out).map_err(|source| Error::Write { path: self.out.clone(), source })?;
        let path = snapshot.write(&self.out)?;
        write_text(None, &format!("{}\n", path.display()))
    }
}
