//! What the tools of one server share: the domains, and the folder of its worlds.

use std::path::PathBuf;

use d3dgen_model::document::Document;
use d3dgen_model::report::Report;
use d3dgen_model::world::World;
use d3dgen_plugins::{Plugin, Registry};

use crate::commands::world_name;
use crate::error::Error;
use crate::input::document;
use crate::registry::{RegistryArgs, domain};

/// Domains, and a folder of worlds.
pub struct Workshop {
    /// The flags it was started with.
    pub args: RegistryArgs,
    /// The domains, read once.
    pub registry: Registry,
    folder: PathBuf,
}

impl Workshop {
    /// Returns a workshop over a folder, which need not exist.
    ///
    /// # Errors
    /// As [`RegistryArgs::load`].
    pub fn new(args: RegistryArgs, folder: PathBuf) -> Result<Self, Error> {
        Ok(Self { registry: args.load()?, args, folder })
    }

    /// Returns the folder of a world, whether it is there or not.
    ///
    /// # Errors
    /// `Input` for what is no name of a world: no other folder can be reached.
    pub fn path(&self, name: &str) -> Result<PathBuf, Error> {
        let name = world_name(name).map_err(|why| Error::Input(format!("world `{name}`: {why}")))?;
        Ok(self.folder.join(name))
    }

    /// Returns a world of the folder.
    ///
    /// # Errors
    /// `Input` with the worlds there are when there is none of that name; `Document` when it was damaged.
    pub fn world(&self, name: &str) -> Result<World, Error> {
        self.kept(name)
    }

    /// Returns the report that a world was written with.
    ///
    /// # Errors
    /// As [`Workshop::world`].
    pub fn report(&self, name: &str) -> Result<Report, Error> {
        self.kept(name)
    }

    fn kept<D: Document>(&self, name: &str) -> Result<D, Error> {
        let path = self.path(name)?;
        if !path.join(format!("{}.json", D::KIND)).is_file() {
            let there = self.names();
            let there = if there.is_empty() { "none yet".into() } else { there.join(", ") };
            return Err(Error::Input(format!("there is no world `{name}`; there are {there}")));
        }
        document(&path)
    }

    /// Returns the domain of a world.
    ///
    /// # Errors
    /// `Input` when it is not known.
    pub fn plugin(&self, world: &World) -> Result<&dyn Plugin, Error> {
        domain(&self.registry, &world.scene_graph.domain)
    }

    /// Returns the names of the worlds, sorted.
    pub fn names(&self) -> Vec<String> {
        let Ok(entries) = std::fs::read_dir(&self.folder) else { return Vec::new() };
        let worlds = entries.filter_map(Result::ok).filter(|e| e.path().join("world.json").is_file());
        let mut names: Vec<String> = worlds.filter_map(|e| e.file_name().into_string().ok()).collect();
        names.sort();
        names
    }
}
