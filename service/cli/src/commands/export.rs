//! `d3dgen export`: an existing world in other formats.

use std::path::{Path, PathBuf};

use d3dgen_model::world::World;

use super::formats;
use crate::error::Error;
use crate::input::document;
use crate::output::Output;
use crate::registry::{RegistryArgs, domain};

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// world.json, or a world's folder
    #[arg(value_name = "WORLD")]
    world: PathBuf,
    #[command(flatten)]
    formats: formats::FormatArgs,
    /// Folder to write into; otherwise the world's own
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let formats = self.formats.chosen(&self.registry.store)?;
        let folder = self.out.clone().unwrap_or_else(|| own_folder(&self.world));
        let world: World = document(&self.world)?;
        let registry = self.registry.load()?;
        let plugin = domain(&registry, &world.scene_graph.domain)?;
        let output = Output::adding_to(&folder)?;
        formats.write(&world, plugin.domain(), &output)?;
        output.commit()?;
        eprintln!("wrote {} into {}", world.name, folder.display());
        Ok(())
    }
}

/// Returns the folder of a world that is given by itself or by its document.
pub fn own_folder(world: &Path) -> PathBuf {
    let own = if world.is_dir() { Some(world) } else { world.parent() };
    own.filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new(".")).to_path_buf()
}
